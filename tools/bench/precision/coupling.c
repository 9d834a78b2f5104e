/* SPDX-License-Identifier: GPL-3.0-or-later
 * Part c of tools/bench/work_precision: schemes that couple machine and circuit at fixed macro
 * steps (tests/support/schemes.h), and the product's switched tier beside them. Scene `paper` fired
 * in every cycle, 0.2 s; error: run.tolerance's norm, against an independent solution. */
#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdlib.h>

#include "base/text.h"
#include "race.h"
#include "schemes.h"

static const char *const SETS[] = {"run.until=0.2s", "firing.every=1", NULL};
static const double STEPS_US[] = {5000, 2000, 1000, 500, 200, 100, 50, 20, 10, 5, 2, 1};
enum { STEPS = sizeof STEPS_US / sizeof *STEPS_US };

static const vs_scene *scene;
static comparison *reference;

static void show(void *ctx, const vs_knot *from, const vs_knot *to) {
  vs_step step = {.frame = ctx, .from = from, .to = to, .cubic_flux = true};
  compare_accept(reference, &step, NULL);
}

static void run_scheme(attempt *self) {
  const vs_setup *s = &scene->setup;
  cosim c;
  cosim_begin(&c, self->with, &s->model, &s->timeline, self->value);
  c.show = show;
  c.ctx = (void *)(size_t)&scene->frame;
  compare_again(reference);
  bool good = cosim_run(&c, s->run.until_s);
  self->error = good ? compare_error(reference, NULL) : INFINITY;
  self->steps = c.iterations ? c.iterations : c.n;
  cosim_end(&c);
}

static void run_product(attempt *self) {
  vs_scene copy = *scene;
  copy.setup.run.tolerance = self->value;
  self->error = race_compare(&copy, reference, &self->steps);
}

int main(void) {
  gsl_set_error_handler_off();
  vs_scene *own = race_scene("switched", SETS);
  scene = own;
  oracle_scene o = oracle_of(&own->setup, ORACLE_SWITCHED);
  reference = compare_with(&o);
  if (!reference) race_give_up("the reference has no solution");
  size_t n = 0;
  attempt *list = vs_alloc((n_schemes + 1) * STEPS, sizeof *list);
  for (size_t k = 0; k < n_schemes; k++)
    for (size_t h = 0; h < STEPS; h++)
      list[n++] = (attempt){.method = schemes[k].name,
                            .value = 1e-6 * STEPS_US[h],
                            .varied = "macro_step_s",
                            .with = &schemes[k],
                            .run = run_scheme};
  for (int decade = -4; decade >= -10; decade -= 2)
    list[n++] = (attempt){.method = "product switched",
                          .value = pow(10, decade),
                          .varied = "run.tolerance",
                          .run = run_product};
  race r = {"c", list, n, 5, 1, 3};
  race_run(&r);
  race_print(&r);
  free(list);
  compare_free(reference);
  vs_scene_free(own);
  free(own);
  return 0;
}
