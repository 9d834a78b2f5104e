/* SPDX-License-Identifier: GPL-3.0-or-later
 * Observers: their sampled system, pole placement and Riccati equation against closed forms and
 * other ways of computing; how their errors decay; how near they are to runs on several tiers. */
#include <gsl/gsl_blas.h>
#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "control/estimator.h"
#include "control/pole_placement.h"
#include "control/riccati.h"
#include "measure/meter.h"
#include "program.h"

/* ---- any matrices ---- */

/* Evenly distributed in -1 .. 1, the same in each run. */
static double any(void) {
  static unsigned long state = 7;
  state = (state * 1103515245UL + 12345UL) & 0x7fffffffUL;
  return 2 * (double)state / 0x7fffffff - 1;
}

static gsl_matrix *any_matrix(size_t rows, size_t columns) {
  gsl_matrix *m = gsl_matrix_alloc(rows, columns);
  for (size_t k = 0; k < rows * columns; k++) gsl_matrix_set(m, k / columns, k % columns, any());
  return m;
}

/* How far the eigenvalues of m, which is overwritten, are from those wanted: the largest distance
 * to the nearest that is left. */
static double eigenvalues_off(gsl_matrix *m, const gsl_complex *wanted) {
  size_t n = m->size1;
  gsl_vector_complex *found = gsl_vector_complex_alloc(n);
  gsl_eigen_nonsymm_workspace *work = gsl_eigen_nonsymm_alloc(n);
  double worst = 0;
  gsl_eigen_nonsymm(m, found, work);
  for (size_t k = 0; k < n; k++) {
    size_t nearest = 0;
    double least = INFINITY;
    for (size_t j = 0; j < n; j++) {
      double off = gsl_complex_abs(gsl_complex_sub(gsl_vector_complex_get(found, j), wanted[k]));
      if (off < least) least = off, nearest = j;
    }
    gsl_vector_complex_set(found, nearest, gsl_complex_rect(1e9, 0)); /* each counts once */
    worst = fmax(worst, least);
  }
  gsl_eigen_nonsymm_free(work);
  gsl_vector_complex_free(found);
  return worst;
}

/* ---- pole placement ---- */

/* x" = u has A = [0 1; 0 0], B = (0, 1): the poles s1 and s2 want K = (s1 s2, -(s1 + s2)). With one
 * column in B there is one gain alone. */
static void double_integrator(void) {
  const double a[] = {0, 1, 0, 0}, b[] = {0, 1};
  const gsl_complex poles[][2] = {{{{-2, 3}}, {{-2, -3}}}, {{{-1, 0}}, {{-5, 0}}}};
  double k[2];
  gsl_matrix_const_view av = gsl_matrix_const_view_array(a, 2, 2),
                        bv = gsl_matrix_const_view_array(b, 2, 1);
  gsl_matrix_view kv = gsl_matrix_view_array(k, 1, 2);
  for (size_t n = 0; n < COUNT(poles); n++) {
    EXPECT(vs_pole_placement(&av.matrix, &bv.matrix, poles[n], &kv.matrix), "no gain");
    gsl_complex product = gsl_complex_mul(poles[n][0], poles[n][1]),
                sum = gsl_complex_add(poles[n][0], poles[n][1]);
    CLOSE(k[0], GSL_REAL(product), 1e-13);
    CLOSE(k[1], -GSL_REAL(sum), 1e-13);
  }
}

/* Poles from -1 to -2, pairs and single ones, some of A's own among them and one of them twice.
 * With one input there is no choice of eigenvectors, which are the closer together the more there
 * are; so these cases end at 8 states. */
static void any_poles(void) {
  for (size_t n = 3; n <= 14; n++)
    for (size_t m = n < 9 ? 1 : 2; m <= 3 && m < n; m++) {
      gsl_matrix *a = any_matrix(n, n), *b = any_matrix(n, m), *k = gsl_matrix_alloc(m, n);
      gsl_complex poles[14];
      for (size_t i = 0; i < n; i++) {
        double re = -1.5 + any() / 2, im = 1 + any() / 2;
        poles[i] = gsl_complex_rect(re, i % 3 == 2 ? 0 : i + 1 < n || i % 3 == 1 ? im : 0);
        if (i % 3 == 1) poles[i] = gsl_complex_conjugate(poles[i - 1]);
      }
      if (n % 3 == 1) poles[n - 1] = gsl_complex_rect(-1.7, 0);
      if (m > 1 && n > 5) poles[5] = poles[2];
      EXPECT(vs_pole_placement(a, b, poles, k), "%zu states, %zu inputs: no gain", n, m);
      gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, -1, b, k, 1, a);
      double off = eigenvalues_off(a, poles);
      EXPECT(off < 1e-5, "%zu states, %zu inputs: off by %g", n, m, off);
      gsl_matrix_free(a);
      gsl_matrix_free(b);
      gsl_matrix_free(k);
    }
}

/* Of two uncoupled states the input moves one: that with the eigenvalue 1, not that with 2. */
static void reach(void) {
  const double a[] = {1, 0, 0, 2}, b[] = {1, 0}, both[] = {1, 2, 2, 4};
  gsl_matrix_const_view av = gsl_matrix_const_view_array(a, 2, 2),
                        bv = gsl_matrix_const_view_array(b, 2, 1),
                        same = gsl_matrix_const_view_array(both, 2, 2);
  CLOSE(vs_pole_placement_reach(&av.matrix, &bv.matrix, gsl_complex_rect(1, 0)), 1, 1e-14);
  EXPECT(vs_pole_placement_reach(&av.matrix, &bv.matrix, gsl_complex_rect(2, 0)) < 1e-15,
         "2 is moved");
  CLOSE(vs_pole_placement_reach(&av.matrix, &bv.matrix, gsl_complex_rect(2, 0.5)), 0.5, 1e-14);
  EXPECT(vs_pole_placement_independence(&same.matrix) < 1e-15 &&
             vs_pole_placement_independence(&av.matrix) > 0.4,
         "independence");
}

/* ---- the Riccati equation ---- */

/* Of one state p = a^2 p r/(c^2 p + r) + q is quadratic in p. */
static void one_state(void) {
  static const double A[] = {0.5, 0.999999, 1, 1.3};
  for (size_t n = 0; n < COUNT(A); n++) {
    double a = A[n], c = 0.7, q = 0.3, r = 2, p, gain;
    gsl_matrix_view av = gsl_matrix_view_array(&a, 1, 1), cv = gsl_matrix_view_array(&c, 1, 1),
                    qv = gsl_matrix_view_array(&q, 1, 1), rv = gsl_matrix_view_array(&r, 1, 1),
                    pv = gsl_matrix_view_array(&p, 1, 1), gv = gsl_matrix_view_array(&gain, 1, 1);
    double linear = r * (1 - a * a) - q * c * c;
    double expected = (-linear + sqrt(linear * linear + 4 * c * c * q * r)) / (2 * c * c);
    EXPECT(vs_riccati(&av.matrix, &cv.matrix, &qv.matrix, &rv.matrix, &pv.matrix), "a = %g", a);
    vs_riccati_gain(&pv.matrix, &cv.matrix, &rv.matrix, &gv.matrix);
    CLOSE(p, expected, 1e-13);
    CLOSE(gain, p * c / (c * p * c + r), 1e-14);
  }
}

enum { STATES = 6, SIGHTS = 2 };

/* One period of the covariance: p = A (I - L C) p (I - L C)^T A^T + A L R L^T A^T + Q, element by
 * element (Joseph's form). L of two sensors is written out. */
static void pass_period(double p[STATES][STATES], const gsl_matrix *a, const gsl_matrix *c,
                        const gsl_matrix *q, const gsl_matrix *r) {
  double pc[STATES][SIGHTS], s[SIGHTS][SIGHTS], l[STATES][SIGHTS], f[STATES][STATES],
      al[STATES][SIGHTS], next[STATES][STATES];
  for (size_t i = 0; i < STATES; i++)
    for (size_t k = 0; k < SIGHTS; k++) {
      pc[i][k] = 0;
      for (size_t j = 0; j < STATES; j++) pc[i][k] += p[i][j] * gsl_matrix_get(c, k, j);
    }
  for (size_t k = 0; k < SIGHTS; k++)
    for (size_t h = 0; h < SIGHTS; h++) {
      s[k][h] = gsl_matrix_get(r, k, h);
      for (size_t j = 0; j < STATES; j++) s[k][h] += gsl_matrix_get(c, k, j) * pc[j][h];
    }
  double det = s[0][0] * s[1][1] - s[0][1] * s[1][0];
  for (size_t i = 0; i < STATES; i++) {
    l[i][0] = (pc[i][0] * s[1][1] - pc[i][1] * s[1][0]) / det;
    l[i][1] = (pc[i][1] * s[0][0] - pc[i][0] * s[0][1]) / det;
  }
  for (size_t i = 0; i < STATES; i++) {
    for (size_t k = 0; k < SIGHTS; k++) {
      al[i][k] = 0;
      for (size_t j = 0; j < STATES; j++) al[i][k] += gsl_matrix_get(a, i, j) * l[j][k];
    }
    for (size_t j = 0; j < STATES; j++)
      f[i][j] = gsl_matrix_get(a, i, j) - al[i][0] * gsl_matrix_get(c, 0, j) -
                al[i][1] * gsl_matrix_get(c, 1, j);
  }
  for (size_t i = 0; i < STATES; i++)
    for (size_t j = 0; j < STATES; j++) {
      next[i][j] = gsl_matrix_get(q, i, j);
      for (size_t g = 0; g < STATES; g++)
        for (size_t h = 0; h < STATES; h++) next[i][j] += f[i][g] * p[g][h] * f[j][h];
      for (size_t k = 0; k < SIGHTS; k++)
        for (size_t h = 0; h < SIGHTS; h++)
          next[i][j] += al[i][k] * gsl_matrix_get(r, k, h) * al[j][h];
    }
  memcpy(p, next, sizeof next);
}

/* The doubling algorithm against period after period, also with motions that grow by themselves. */
static void period_after_period(void) {
  for (int n = 0; n < 20; n++) {
    gsl_matrix *a = any_matrix(STATES, STATES), *c = any_matrix(SIGHTS, STATES),
               *root = any_matrix(STATES, STATES), *q = gsl_matrix_alloc(STATES, STATES),
               *r = gsl_matrix_alloc(SIGHTS, SIGHTS), *solved = gsl_matrix_alloc(STATES, STATES);
    double p[STATES][STATES] = {{0}}, worst = 0, size = 0;
    gsl_matrix_scale(a, 0.5);
    gsl_blas_dgemm(CblasNoTrans, CblasTrans, 1, root, root, 0, q);
    gsl_matrix_set_identity(r);
    gsl_matrix_set(r, 0, 1, 0.3);
    gsl_matrix_set(r, 1, 0, 0.3);
    EXPECT(vs_riccati(a, c, q, r, solved), "no solution");
    for (int k = 0; k < 5000; k++) pass_period(p, a, c, q, r);
    for (size_t i = 0; i < STATES; i++)
      for (size_t j = 0; j < STATES; j++) {
        worst = fmax(worst, fabs(p[i][j] - gsl_matrix_get(solved, i, j)));
        size = fmax(size, fabs(p[i][j]));
      }
    EXPECT(worst < 1e-10 * size, "off by %g of %g", worst, size);
    gsl_matrix *room[] = {a, c, root, q, r, solved};
    for (size_t k = 0; k < COUNT(room); k++) gsl_matrix_free(room[k]);
  }
}

/* ---- an observer beside a run ---- */

typedef struct watch {
  vs_tree tree; /* of the observer's map */
  vs_state_observer observing;
  vs_estimator estimator;
  vs_meter current, sensor[VS_SENSOR_MOST];
  double rate_hz;
  const vs_scene *scene;
  vs_error err;
  vs_status status;
  double *off; /* of the first coordinate at each sample, up to `most` of them; NULL: nobody asks */
  long most;
} watch;

static vs_status look(void *ctx, const vs_step *step, vs_error *err) {
  watch *w = ctx;
  const vs_sampled_system *p = w->observing.system;
  double y[VS_SENSOR_MOST], all[VS_CH_MOST];
  (void)err;
  if (step->to->t_s == step->from->t_s) return VS_OK;
  double last_s = step->to->t_s + 1e-9 / w->rate_hz;
  for (double t; (t = (double)w->estimator.samples / w->rate_hz) <= last_s;) {
    double within = fmin(t, step->to->t_s);
    vs_meter_to(&w->current, step, within);
    for (int k = 0; k < p->sensors; k++) {
      vs_meter_to(&w->sensor[k], step, within);
      y[k] = w->sensor[k].value;
    }
    vs_estimator_sample(&w->estimator, w->current.value, y);
    vs_step_at(step, within, all);
    vs_estimator_compare(&w->estimator, all + VS_CH_Q);
    if (w->off && w->estimator.samples <= w->most)
      w->off[w->estimator.samples - 1] = w->estimator.x[0] - all[VS_CH_Q];
  }
  vs_meter_accept(&w->current, step);
  for (int k = 0; k < p->sensors; k++) vs_meter_accept(&w->sensor[k], step);
  return VS_OK;
}

static void begin_watch(watch *w, const char *map) {
  char text[2048];
  snprintf(text, sizeof text, "observer: %s\n", map);
  write_file("observer.yaml", text);
  w->status = vs_tree_read("observer.yaml", &w->tree, &w->err);
  const vs_node *node = vs_tree_child(w->tree.root, "observer");
  if (!w->status)
    w->status = vs_state_observer_read(node, &w->scene->setup.model, &w->scene->instruments,
                                       w->rate_hz, &w->observing, &w->err);
  if (w->status) return;
  const vs_sampled_system *p = w->observing.system;
  vs_meter_begin(&w->current, w->observing.current, w->scene->instruments.v.seed);
  for (int k = 0; k < p->sensors; k++)
    vs_meter_begin(&w->sensor[k], p->sensor[k].instrument, w->scene->instruments.v.seed);
  vs_estimator_begin(&w->estimator, &w->observing, &w->scene->frame, w->scene->setup.start.x);
}

static void end_watch(watch *w, vs_trial *t) {
  vs_state_observer_free(&w->observing);
  vs_tree_free(&w->tree);
  vs_trial_free(t);
}

/* Reads a scene and makes the observer of that map for it. */
static vs_trial *read_watched(watch *w, const char *scene, const char *tier,
                              const char *const *sets, const char *map) {
  vs_trial *t = vs_trial_read(scene, tier, sets);
  EXPECT(!t->status, "%s", t->err.text);
  w->scene = &t->scene;
  begin_watch(w, map);
  return t;
}

/* ---- the sampled system ---- */

/* Runge's and Kutta's integration of the motion and of the low-passes, with F straight from f[0] to
 * f[1] in the period; far finer than the period. */
static void slopes(const vs_sampled_system *p, const vs_model *m, double force, const double *x,
                   double *d) {
  int dof = m->dof;
  memcpy(d, x + dof, (size_t)dof * sizeof *d);
  double a[VS_MOST_DOF];
  vs_mechanics_accelerations(m, x, x + dof, force, a);
  memcpy(d + dof, a, (size_t)dof * sizeof *d);
  for (int k = 0; k < p->sensors; k++) {
    const vs_sensor *s = &p->sensor[k];
    const vs_lowpass *l = &s->lowpass;
    int channel = s->instrument->channel - VS_CH_Q;
    double u = channel < 0            ? vs_mechanics_gap(m, x)
               : channel < 2 * m->dof ? x[channel]
                                      : a[channel - 2 * m->dof];
    for (int i = 0; i < s->states; i++) {
      d[s->at + i] = i == l->works_on ? l->rate * u : 0;
      for (int j = 0; j < s->states; j++) d[s->at + i] += l->rate * l->m[i][j] * x[s->at + j];
    }
  }
}

static void integrate(const vs_sampled_system *p, const vs_model *m, const double f[2], double *x) {
  static const double AT[] = {0, 0.5, 0.5, 1}, WEIGHT[] = {1, 2, 2, 1};
  enum { PIECES = 400 };
  double h = p->period_s / PIECES;
  for (int n = 0; n < PIECES; n++) {
    double d[VS_SAMPLED_MOST] = {0}, sum[VS_SAMPLED_MOST] = {0}, at[VS_SAMPLED_MOST];
    for (int k = 0; k < 4; k++) {
      for (int i = 0; i < p->states; i++) at[i] = x[i] + AT[k] * h * d[i];
      slopes(p, m, f[0] + (f[1] - f[0]) * (n + AT[k]) / PIECES, at, d);
      for (int i = 0; i < p->states; i++) sum[i] += WEIGHT[k] * h / 6 * d[i];
    }
    for (int i = 0; i < p->states; i++) x[i] += sum[i];
  }
}

static void one_period(const char *scene, const char *const *sets, const char *map) {
  watch w = {.rate_hz = 2000};
  vs_trial *t = read_watched(&w, scene, "switched", sets, map);
  const vs_sampled_system *p = w.observing.system;
  const double f[] = {30, 50};
  double x[VS_SAMPLED_MOST], next[VS_SAMPLED_MOST];
  EXPECT(!w.status, "%s", w.err.text);
  if (!w.status) {
    for (int i = 0; i < p->states; i++) x[i] = p->scale[i] * any();
    for (int i = 0; i < p->states; i++) {
      next[i] = p->b[0][i] * f[0] + p->b[1][i] * f[1] + p->constant[i];
      for (int j = 0; j < p->states; j++) next[i] += p->a[i][j] * x[j];
    }
    integrate(p, &t->scene.setup.model, f, x);
    for (int i = 0; i < p->states; i++) CLOSE_OF(next[i], x[i], p->scale[i], 1e-9);
  }
  end_watch(&w, t);
}

/* The matrix A of `vibrospice modes` (mechanics' state space, which has the rates first) makes the
 * same of a period without a force: exp(A T) by its series, of T in 64 parts. */
static void as_of_modes(void) {
  static const char *const SETS[] = {"instruments={}", NULL};
  watch w = {.rate_hz = 2000};
  vs_trial *t = read_watched(&w, "paper", "switched", SETS, "{}");
  const vs_sampled_system *p = w.observing.system;
  vs_state_space space;
  vs_mechanics_state_space(&t->scene.setup.model, &space);
  enum { N = 8, PARTS = 64 };
  for (int j = 0; j < N && p; j++) {
    double x[N] = {0};
    x[(j + N / 2) % N] = 1;
    for (int part = 0; part < PARTS; part++) {
      double term[N], next[N];
      memcpy(term, x, sizeof x);
      for (int k = 1; k < 20; k++) {
        for (int i = 0; i < N; i++) {
          next[i] = 0;
          for (int h = 0; h < N; h++) next[i] += space.a[i][h] * term[h] * p->period_s / PARTS / k;
        }
        memcpy(term, next, sizeof term);
        for (int i = 0; i < N; i++) x[i] += term[i];
      }
    }
    for (int i = 0; i < N; i++)
      CLOSE_OF(p->a[i][j], x[(i + N / 2) % N], p->scale[i] / p->scale[j], 1e-12);
  }
  end_watch(&w, t);
}

/* Low-passes of both orders and none, on coordinates, rates, accelerations and the gap; a machine
 * with constant forces. */
static void periods(void) {
  static const char *const PAPER[] = {
      "instruments={z: {range: [0 m, 1 m], bandwidth: 300 Hz}, vu: {range: [-1 m/s, 1 m/s]}}",
      NULL};
  one_period("paper", PAPER, "{sensors: [p, ap, aw, z, vu]}");
  static const char *const HANGS[] = {
      "instruments={x: {range: [-1 m, 1 m], bandwidth: 100 Hz, order: 2, damping: 1}, ax: {range: "
      "[-1 m/s2, 1 m/s2]}, i: {range: [-1 A, 1 A]}}",
      NULL};
  write_file("hangs.yaml",
             "title: hanging\ncoordinates: {x: {unit: m, text: down}}\n"
             "mass: 2 kg\ndamping: 3 N.s/m\nstiffness: 1e4 N/m\n"
             "forces: {x: 19.62 N}\ngap: {along: {x: -1}}\n"
             "actuator: {gap: 6 mm, pole_cover: 0 mm, inductance: 1 H, resistance: 90 ohm}\n");
  write_file("hanging.yaml", "machine: {model: hangs.yaml}\nsupply: {voltage: 440 V}\n"
                             "firing: {angle: 100 deg}\n");
  one_period("hanging.yaml", HANGS, "{sensors: [x, ax]}");
}

/* ---- how errors decay ---- */

/* Instruments without noise and steps, in ranges that are not left. */
#define IDEAL                                                                                      \
  "instruments={set: none, p: {range: [-0.1 m, 0.1 m], bandwidth: 100 Hz, bits: none}, ap: "       \
  "{range: "                                                                                       \
  "[-1e3 m/s2, 1e3 m/s2], bandwidth: 200 Hz, order: 2, bits: none}, i: {range: [-9 A, 9 A], "      \
  "bits: none}}"

/* Tier analytic has a force that follows from the current alone, so that the observer's machine is
 * linear. Each state of the estimate is moved by itself: the differences one sample later are the
 * columns of (I - L C) A, whose eigenvalues are to be exp(s T) of the poles that the scene states.
 */
static void stated_poles(void) {
  static const char *const SETS[] = {IDEAL, NULL};
  static const double POLES[][2] = {{-25, 52},   {-25, -52},  {-40, 105},  {-40, -105},
                                    {-60, 200},  {-60, -200}, {-150, 350}, {-150, -350},
                                    {-628.3, 0}, {-700, 0},   {-900, 0}};
  char map[512] = "{kind: luenberger, sensors: [p, ap], poles: [";
  gsl_complex wanted[COUNT(POLES)];
  watch w = {.rate_hz = 5000};
  for (size_t k = 0; k < COUNT(POLES); k++) {
    double re = POLES[k][0] / w.rate_hz, im = POLES[k][1] / w.rate_hz;
    size_t n = strlen(map);
    snprintf(map + n, sizeof map - n, k < 8 ? "[%g, %g], " : "%g, ", POLES[k][0], POLES[k][1]);
    wanted[k] = gsl_complex_exp(gsl_complex_rect(re, im));
  }
  strcat(map, "]}");
  vs_trial *t = read_watched(&w, "paper", "analytic", SETS, map);
  EXPECT(!w.status, "%s", w.err.text);
  if (!w.status) {
    const vs_sampled_system *p = w.observing.system;
    size_t n = COUNT(POLES);
    double y[] = {1e-4, -3};
    gsl_matrix *m = gsl_matrix_alloc(n, n);
    vs_estimator_sample(&w.estimator, 0.5, y);
    for (size_t j = 0; j < n; j++) {
      vs_estimator moved = w.estimator, plain = w.estimator;
      moved.x[j] += p->scale[j];
      vs_estimator_sample(&plain, 0.6, y);
      vs_estimator_sample(&moved, 0.6, y);
      for (size_t i = 0; i < n; i++)
        gsl_matrix_set(m, i, j, (moved.x[i] - plain.x[i]) / p->scale[i]);
    }
    double off = eigenvalues_off(m, wanted) * w.rate_hz; /* of s, 1/s, to first order */
    EXPECT(off < 0.02 * 57, "poles are off by %g 1/s; the slowest is of 57 1/s", off);
    EXPECT(off < 1e-3, "poles are off by %g 1/s, more than by rounding", off);
    gsl_matrix_free(m);
  }
  end_watch(&w, t);
}

/* Finds s from samples of sum c exp(s t) of one pole or of a pair, by the recursion that they
 * follow: e(k) = g e(k-1) - h e(k-2) with the least squares. */
static vs_pole decay_of(const double *e, int count, double period_s) {
  double aa = 0, ab = 0, bb = 0, ac = 0, bc = 0;
  for (int k = 2; k < count; k++) {
    aa += e[k - 1] * e[k - 1];
    ab += e[k - 1] * e[k - 2];
    bb += e[k - 2] * e[k - 2];
    ac += e[k - 1] * e[k];
    bc += e[k - 2] * e[k];
  }
  double det = aa * bb - ab * ab, g = (ac * bb - bc * ab) / det, h = -(aa * bc - ab * ac) / det;
  vs_pole s = {log(h) / 2 / period_s, acos(g / 2 / sqrt(h)) / period_s};
  return s;
}

/* A run that begins elsewhere than at rest, where the estimate begins. All poles but one pair are
 * fast, so that the pair is what is left: its decay and its frequency are to be those stated,
 * within 2 %; what is seen of them is better than 0.1 %. */
static void decay_in_a_run(void) {
  static const double SLOW[][2] = {{-20, 60}, {-10, 350}, {-35, 150}};
  for (size_t k = 0; k < COUNT(SLOW); k++) {
    static const char *const SETS[] = {IDEAL,
                                       "start={p: 1 mm, u: -0.2 mm, w: 0.1 mm, phi: 1e-3 rad}",
                                       "firing.first_cycle=1000",
                                       "run.until=0.5s",
                                       "run.sample=0.2ms",
                                       NULL};
    double off[2600];
    watch w = {.rate_hz = 5000, .off = off, .most = COUNT(off)};
    char map[512];
    snprintf(map, sizeof map,
             "{kind: luenberger, sensors: [p, ap], poles: [[%g, %g], [%g, %g], [-150, 300], [-150, "
             "-300], [-160, 200], [-160, -200], [-170, 100], [-170, -100]]}",
             SLOW[k][0], SLOW[k][1], SLOW[k][0], -SLOW[k][1]);
    vs_trial *t = read_watched(&w, "paper", "analytic", SETS, map);
    EXPECT(!w.status, "%s", w.err.text);
    const vs_observer observer = {&w, look};
    if (!w.status) vs_trial_go(t, &observer);
    EXPECT(!t->status && w.estimator.samples == 2501, "%ld samples: %s", w.estimator.samples,
           t->err.text);
    enum { FROM = 1000, COUNTED = 900 };
    vs_pole s = decay_of(off + FROM, COUNTED, 1 / w.rate_hz);
    EXPECT(fabs(s.re_1_s - SLOW[k][0]) < 0.02 * -SLOW[k][0], "decays with %g 1/s", s.re_1_s);
    EXPECT(fabs(s.im_rad_s - SLOW[k][1]) < 0.02 * SLOW[k][1], "swings with %g rad/s", s.im_rad_s);
    CLOSE(s.re_1_s, SLOW[k][0], 1e-3);
    CLOSE(s.im_rad_s, SLOW[k][1], 1e-3);
    end_watch(&w, t);
  }
}

/* ---- on runs of the full model ---- */

/* Runs the scene with an observer and expects errors from the settling on of at most these parts of
 * each coordinate's peak: of the first coordinate and of all. */
static vs_estimator_errors observe(const char *tier, const char *const *sets, const char *map,
                                   double first, double any_other) {
  watch w = {.rate_hz = 5000};
  vs_trial *t = read_watched(&w, "paper", tier, sets, map);
  EXPECT(!w.status, "%s", w.err.text);
  const vs_observer observer = {&w, look};
  if (!w.status) vs_trial_go(t, &observer);
  EXPECT(!t->status, "%s", t->err.text);
  vs_estimator_errors e = w.estimator.errors;
  EXPECT(e.after > 500, "%ld samples once it has settled", e.after);
  for (int k = 0; k < 8; k++) {
    double part = e.settled[k] / e.peak[k], most = k ? any_other : first;
    EXPECT(part < most, "%s, %s: %s is off by %.3g %% of its peak", tier, map,
           vs_channel_at(&t->scene.frame, VS_CH_Q + k).name, 100 * part);
  }
  end_watch(&w, t);
  return e;
}

/* The paper's instruments with noise and 12 bits. The force of 0.84 A, known to a step of 2.4 mA
 * and a noise of 2.5 mA, is known to about 1 %; the coordinates that no sensor shows, to what
 * follows. */
static void on_tiers(void) {
  static const char *const TIERS[] = {"analytic", "switched", "circuit"};
  static const char *const SETS[] = {"instruments={}", "circuit.deck=halfwave_bare",
                                     "run.until=0.6s", NULL},
                           *const IDEAL_TIER[] = {"instruments={}", "run.until=0.6s", NULL};
  for (size_t k = 0; k < COUNT(TIERS); k++)
    observe(TIERS[k], k < 2 ? IDEAL_TIER : SETS, "{}", 0.003, 0.05);
}

/* The run begins elsewhere than the estimate: this is wrong at first, by all there is, and right
 * once it has settled; unless it is told where the run begins. */
static void from_elsewhere(void) {
  static const char *const SETS[] = {"instruments={}", "start={p: 1 mm, vw: 0.02 m/s}",
                                     "run.until=0.6s", NULL};
  vs_estimator_errors wrong = observe("switched", SETS, "{}", 0.01, 0.05),
                      told = observe("switched", SETS, "{start: run}", 0.01, 0.05);
  EXPECT(wrong.all[0] > 0.3 * wrong.peak[0], "off by %g m at first", wrong.all[0]);
  EXPECT(told.all[0] < 0.01 * told.peak[0], "off by %g m though told", told.all[0]);
}

/* Fired in each cycle, p leaves the range of its sensor, and ap that of its own: the observer knows
 * that a sensor shows no more than its range. */
static void beyond_ranges(void) {
  static const char *const SETS[] = {"instruments={}", "firing.every=1", "run.until=0.6s", NULL};
  vs_estimator_errors e = observe("switched", SETS, "{}", 0.03, 0.1);
  EXPECT(e.peak[0] > 3.3e-3, "p has its peak at %g m", e.peak[0]);
}

/* ---- what is refused ---- */

typedef struct refusal {
  const char *scene, *instruments, *map;
  int column; /* in "observer: MAP" */
  const char *says;
} refusal;

#define EIGHT "[-9, 50], [-9, -50], [-9, 90], [-9, -90], [-9, 180], [-9, -180]"
static const refusal REFUSALS[] = {
    {"paper", "{}", "{sensors: [p, apu]}", 25, "no instrument 'apu'; did you mean 'ap'?"},
    {"paper", "{}", "{sensors: [p, v_eva]}", 25, "v_eva does not show the motion"},
    {"paper", "{}", "{sensors: [p, p]}", 25, "p stands twice"},
    {"paper", "{}", "{current: p}", 21, "no instrument measures the coil's current"},
    {"paper", "{}", "{current: j}", 21, "no instrument 'j'"},
    {"paper", "{i: none}", "{}", 1, "no instrument measures the coil's current"},
    {"paper", "{set: none, i: {range: [-5 A, 5 A]}}", "{}", 1, "no instrument shows the motion"},
    {"paper",
     "{q: {channel: ap, range: [-1 m/s2, 1 m/s2]}, r: {channel: ap, range: [-1 m/s2, 1 m/s2]}}",
     "{sensors: [q, r]}", 12, "one of them shows nothing that the others do not"},
    {"apart.yaml", "{x: {range: [-1 m, 1 m]}, i: {range: [-5 A, 5 A]}}", "{}", 1,
     "they do not see the mode at 15.92 Hz"},
    {"apart.yaml", "{y: {range: [-1 m, 1 m]}, i: {range: [-5 A, 5 A]}}", "{}", 1,
     "they do not see the mode at 7.958 Hz"},
    {"paper", "{}", "{kind: luenberger, sensors: [p]}", 1, "0 given; wanted are 8"},
    {"paper", "{}", "{kind: luenberger, sensors: [p], poles: [-9, -10]}", 44,
     "2 given; wanted are 8"},
    {"paper", "{}", "{kind: luenberger, sensors: [p], poles: [" EIGHT ", [-9, 300], -20]}", 44,
     "not a conjugate set: [-9, 300] stands without [-9, -300]"},
    {"paper", "{}", "{kind: luenberger, sensors: [p], poles: [" EIGHT ", 9, -20]}", 117,
     "with 9 1/s an error does not decay"},
    {"paper", "{}", "{kind: luenberger, sensors: [p], poles: [" EIGHT ", -9 Hz, -20]}", 117,
     "a pole is a number in 1/s"},
    {"paper", "{}", "{kind: luenberger, sensors: [p], poles: [" EIGHT ", [-9, 2e4], -20]}", 118,
     "is beyond what control.rate = 5000 Hz can tell"},
    {"paper", "{}", "{kind: luenberger, sensors: [p], poles: [" EIGHT ", -20, -20]}", 44,
     "[-20, 0] stands 2 times; with 1 sensor a pole can stand 1 time"},
    {"paper", "{}", "{kind: luenberger, force_noise: 1 N}", 43, "is of kind: kalman"},
    {"paper", "{}", "{poles: [-1]}", 12, "is of kind: luenberger"},
    {"paper", "{}", "{force_noise: 1 m}", 25, "force_noise"},
    {"paper", "{}", "{kind: luenburger}", 18, "kind"},
    {"paper", "{}", "{sensor: p}", 12, "did you mean 'sensors'?"},
    {"paper", "{}", "kalman", 11, "a map is wanted"}};

static void refusals(void) {
  write_file("apart_machine.yaml",
             "title: two masses that know nothing of each other\n"
             "coordinates: {x: {unit: m, text: one}, y: {unit: m, text: other}}\n"
             "mass: [[1 kg, 0], [0, 1 kg]]\ndamping: [[1 N.s/m, 0], [0, 1 N.s/m]]\n"
             "stiffness: [[2500 N/m, 0], [0, 10000 N/m]]\ngap: {along: {x: 1}}\n"
             "actuator: {gap: 6 mm, pole_cover: 0 mm, inductance: 1 H, resistance: 90 ohm}\n");
  write_file("apart.yaml", "machine: {model: apart_machine.yaml}\nsupply: {voltage: 440 V}\n"
                           "firing: {angle: 100 deg}\n");
  for (size_t k = 0; k < COUNT(REFUSALS); k++) {
    const refusal *r = &REFUSALS[k];
    char instruments[256], at[64];
    const char *const sets[] = {instruments, NULL};
    snprintf(instruments, sizeof instruments, "instruments=%s", r->instruments);
    snprintf(at, sizeof at, "observer.yaml:1:%d: control.observer", r->column);
    watch w = {.rate_hz = 5000};
    vs_trial *t = read_watched(&w, r->scene, "switched", sets, r->map);
    EXPECT(w.status == VS_INPUT, "%s is taken", r->map);
    EXPECT(!strncmp(w.err.text, at, strlen(at)), "%s: %s", at, w.err.text);
    EXPECT(strstr(w.err.text, r->says) != NULL, "'%s' is not in: %s", r->says, w.err.text);
    end_watch(&w, t);
  }
}

/* What is said of an observer that cannot know all. */
static void notes(void) {
  static const char *const SETS[] = {"instruments={p: {rate: 8 kHz}, i: {bandwidth: 1 kHz}}",
                                     "actuator.stop={stiffness: 1e6 N/m, damping: 10 N.s/m}", NULL},
                           *const PLAIN[] = {"instruments={}", NULL};
  char text[512];
  for (int k = 0; k < 2; k++) {
    watch w = {.rate_hz = 5000};
    vs_trial *t = read_watched(&w, "paper", "switched", k ? PLAIN : SETS, "{}");
    EXPECT(!w.status, "%s", w.err.text);
    const char *said = vs_state_observer_note(&w.observing, &t->scene.setup, text, sizeof text);
    EXPECT(k ? !said
             : said && strstr(said, "samples of p are up to 0.125 ms old") &&
                   strstr(said, "late by 0.159 ms") && strstr(said, "without a stop") &&
                   !strstr(said, "load"),
           "%s", said ? said : "nothing is said");
    end_watch(&w, t);
  }
}

/* ---- as a user sees it ---- */

static const char SCENE[] = "instruments: {}\n"
                            "firing: {every: 1, angle: 120 deg}\n"
                            "run: {until: 0.5 s}\n"
                            "circuit: {deck: halfwave_bare}\n"
                            "control:\n"
                            "  observer: {%s}\n";

static void write_scene(const char *keys) {
  char text[1024];
  snprintf(text, sizeof text, SCENE, keys);
  write_file("observed.yaml", text);
}

static void refused(const char *keys, int column, const char *says) {
  char words[] = "run observed.yaml -o out", at[64];
  const char *const all[] = {says, NULL};
  snprintf(at, sizeof at, "observed.yaml:6:%d: control.observer", column);
  write_scene(keys);
  refuse(words, keys, at, all, __LINE__);
}

static void refused_from_a_file(void) {
  refused("sensors: [p, apu]", 27, "did you mean 'ap'?");
  refused("current: v_eva", 23, "no instrument measures the coil's current");
  refused("kind: luenberger, poles: [-1, -2]", 32, "2 given");
  refused("kind: luenberger, poles: [[-9, 9], -1, -2, -3, -4, -5, -6, -7]", 32, "conjugate");
  refused("kind: luenberger, poles: [2, -1, -2, -3, -4, -5, -6, -7]", 40, "does not decay");
}

/* What summary.json says of p behind that name. */
static double said_of_p(const char *path, const char *name) {
  char *text = read_file(path), *p = strstr(text, "\"p_est\""), *at = p ? strstr(p, name) : NULL;
  EXPECT(at != NULL, "%s: no %s of p_est", path, name);
  double value = at ? strtod(at + strlen(name), NULL) : NAN;
  free(text);
  return value;
}

/* The last number of a column of run.csv. */
static double last_of(const char *path, const char *name) {
  char *csv = read_file(path), *row = csv + strlen(csv), *head = csv, *cell;
  int which = 0;
  while (row > csv + 1 && row[-2] != '\n') row--;
  if (row > csv) row--;
  strsep(&head, "\n");
  for (head = csv; (cell = strsep(&head, ",")) && strcmp(cell, name);) which++;
  EXPECT(cell != NULL, "%s: no column %s", path, name);
  for (int k = 0; k <= which; k++) cell = strsep(&row, ",");
  double value = cell ? strtod(cell, NULL) : NAN;
  free(csv);
  return value;
}

/* The same on both tiers: columns, the table, the bound; and a law whose sensor is an estimate,
 * which holds the true amplitude where it is told to. */
static void tables_and_files(void) {
  static const char *const TIERS[] = {"switched", "circuit"};
  write_scene("force_noise: 2 N");
  for (size_t k = 0; k < COUNT(TIERS); k++) {
    ran r = run("run observed.yaml --tier %s -o %s --set control.observer.spread=0.2 --all",
                TIERS[k], TIERS[k]);
    EXPECT(r.status == 0, "%s", r.err);
    EXPECT(strstr(r.out, "\np_est ") && strstr(r.out, "\nvphi_est "), "%s", r.out);
    free_ran(&r);
    char path[64];
    snprintf(path, sizeof path, "%s/run.csv", TIERS[k]);
    char *csv = read_file(path);
    csv[strcspn(csv, "\n")] = '\0';
    EXPECT(strstr(csv, ",p_est_m,u_est_m,w_est_m,phi_est_rad,vp_est_m_s,") != NULL, "%s", csv);
    free(csv);
    snprintf(path, sizeof path, "%s/summary.json", TIERS[k]);
    double part = said_of_p(path, "\"of_peak\": ");
    EXPECT(part > 0 && part < 0.003, "%s: p is off by %g of its peak", TIERS[k], part);
  }
}

/* The shipped set-point step with the estimate of p for its sensor: what a low-pass makes of the
 * amplitude need not be known. The amplitude is that of the true p within 0.3 %, as the estimate is
 * right to 0.15 % of the peak. */
static void law_with_an_estimate(void) {
  RUN_GOOD("run control_setpoint --set control.sensor=p_est --set control.sensor_gain=auto --set "
           "control.observer.start=run --set 'instruments.i={rate: 300 kHz}' -o held --quiet");
  double part = said_of_p("held/summary.json", "\"of_peak\": ");
  double held_m = last_of("held/run.csv", "amplitude_meas_m");
  EXPECT(part > 0 && part < 0.003, "p is off by %g of its peak", part);
  EXPECT(fabs(held_m - 1e-3) < 5e-6, "it holds %g m", held_m);
}

static const vs_test TESTS[] = {{"placement: a double integrator", double_integrator},
                                {"placement: any matrices", any_poles},
                                {"placement: what can be moved", reach},
                                {"Riccati: one state", one_state},
                                {"Riccati: period after period", period_after_period},
                                {"one period against an integration", periods},
                                {"the matrices of modes", as_of_modes},
                                {"the poles that are stated", stated_poles},
                                {"decay in a run", decay_in_a_run},
                                {"tiers", on_tiers},
                                {"a start elsewhere", from_elsewhere},
                                {"beyond the ranges", beyond_ranges},
                                {"refusals", refusals},
                                {"notes", notes},
                                {"refused from a file", refused_from_a_file},
                                {"tables and files", tables_and_files},
                                {"a law with an estimate", law_with_an_estimate}};

int main(void) {
  return program_suite("estimator", TESTS, COUNT(TESTS));
}
