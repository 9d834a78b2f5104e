/* SPDX-License-Identifier: GPL-3.0-or-later
 * The numbers of tools/stability_map, as CSV on standard output: what becomes of the periodic orbit
 * under firing in every cycle when machine and circuit are coupled by a scheme of
 * tests/support/schemes.h in macro steps of H, over H and the strength of the coupling. */
#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "floquet.h"
#include "run/scene.h"

static const char *const SCHEMES[] = {"i_jacobi",    "7c_jacobi",   "i_seidel",      "7c_force",
                                      "flux_jacobi", "flux_seidel", "flux_condensed"};
enum { N_SCHEMES = sizeof SCHEMES / sizeof *SCHEMES, STRENGTHS = 22, STEPS = 28 };

/* Two ways to strength: the supply's voltage, given as the peak i0 of the current that it would
 * drive at the gap at rest (Eq. 91), and the gap. At their ends the exact orbit is about to reach
 * the pole cover. */
static const struct {
  const char *name, *key, *unit;
  double from, to;
} AXES[] = {{"i0", "supply.voltage", "V", 180, 640}, {"gap", "actuator.gap", "mm", 12, 4.2}};

static const double PEAK_PER_VOLT_A = 0.879912533701 / 440;
static const double SHORTEST_S = 10e-6, LONGEST_S = 2e-3, ACCURATE = 0.01;
static const long FINE = 2000; /* macro steps in a period of the orbit that counts as exact */

static vs_scene *read_scene(int axis, double value) {
  char set[64], *sets[] = {(char[]){"firing.every=1"}, (char[]){"firing.angle=100deg"}, set};
  vs_scene *scene = calloc(1, sizeof *scene);
  vs_error err = {0};
  snprintf(set, sizeof set, "%s=%.9g %s", AXES[axis].key, value, AXES[axis].unit);
  if (!scene || vs_scene_read("paper", sets, 3, "switched", scene, &err)) {
    fprintf(stderr, "stability_map: %s\n", err.text);
    exit(1);
  }
  return scene;
}

/* s: stable; i: inaccurate, the swing of p is off by more than ACCURATE; u: unstable, a multiplier
 * beyond 1 or no orbit at all. */
static char state_of(const orbit *exact, const orbit *o) {
  double error = (o->p_max_m - o->p_min_m) / (exact->p_max_m - exact->p_min_m) - 1;
  if (!(o->largest <= 1 + 1e-6)) return 'u';
  return fabs(error) <= ACCURATE ? 's' : 'i';
}

static void add_row(int axis, double value, const scheme *s, const orbit *exact,
                    const char *states) {
  double limit = exact->damping_ns_m / (-s->kappa * exact->force_over_z_n_m);
  printf("%s,%s,%.5g,%.5g,%.5g,%.5g,", AXES[axis].name, s->name,
         PEAK_PER_VOLT_A * (axis ? 440 : value), axis ? value : 6, exact->force_over_z_n_m,
         exact->damping_ns_m);
  if (limit > 0 && isfinite(limit)) printf("%.4g", 1e6 * limit);
  printf(",%s\n", states);
}

static void add_strength(int axis, double value, double start[VS_STATES]) {
  vs_scene *scene = read_scene(axis, value);
  const vs_model *m = &scene->setup.model;
  const vs_timeline *t = &scene->setup.timeline;
  orbit exact = {.multiplier = NAN};
  memcpy(exact.x, start, sizeof exact.x);
  if (!floquet_orbit(scheme_find("flux_condensed"), m, t, FINE, &exact)) {
    fprintf(stderr, "stability_map: %s %g %s: no orbit\n", AXES[axis].key, value, AXES[axis].unit);
    exit(1);
  }
  memcpy(start, exact.x, sizeof exact.x);
  for (int s = 0; s < N_SCHEMES; s++) {
    const scheme *of = scheme_find(SCHEMES[s]);
    char states[STEPS + 1] = "";
    orbit near = exact;
    for (int k = 0; k < STEPS; k++) {
      double h = SHORTEST_S * pow(LONGEST_S / SHORTEST_S, (double)k / (STEPS - 1));
      orbit o = near;
      bool good = floquet_orbit(of, m, t, lround(t->period_s / h), &o);
      if (good) near = o;
      states[k] = good ? state_of(&exact, &o) : 'u';
    }
    add_row(axis, value, of, &exact, states);
  }
  vs_scene_free(scene);
  free(scene);
}

int main(int argc, char **argv) {
  gsl_set_error_handler_off();
  int axis = 0;
  while (argc == 2 && axis < 2 && strcmp(argv[1], AXES[axis].name)) axis++;
  if (argc != 2 || axis == 2) {
    fputs("usage: stability_map i0|gap\n", stderr);
    return 2;
  }
  double start[VS_STATES] = {0}; /* of the weakest; the next one begins with what came of it */
  for (int k = 0; k < STRENGTHS; k++) {
    double part = (double)k / (STRENGTHS - 1);
    add_strength(axis, AXES[axis].from + part * (AXES[axis].to - AXES[axis].from), start);
  }
  return 0;
}
