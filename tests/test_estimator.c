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
#include <unistd.h>

#include "observe/estimator.h"
#include "observe/place.h"
#include "observe/riccati.h"
#include "instrument/meter.h"
#include "suite.h"

/* ---- an observer beside a run ---- */

typedef struct watch {
  vs_tree tree; /* of the observer's map */
  vs_observing observing;
  vs_estimator estimator;
  vs_meter current, sensor[VS_SENSOR_MOST];
  double rate_hz;
  const vs_scene *scene;
  vs_error err;
  vs_status status;
  FILE *log;
} watch;

static vs_status look(void *ctx, const vs_step *step, vs_error *err) {
  watch *w = ctx;
  const vs_sampled *p = w->observing.system;
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
    if (w->log) {
      fprintf(w->log, "%.9g", t);
      for (int k = 0; k < 2 * p->dof; k++)
        fprintf(w->log, ",%.9g,%.9g", all[VS_CH_Q + k], w->estimator.x[k]);
      fprintf(w->log, ",%.9g,%.9g\n", all[VS_CH_FORCE], w->estimator.force_n);
    }
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
    w->status = vs_observing_read(node, &w->scene->frame, &w->scene->instruments, w->rate_hz,
                                  &w->observing, &w->err);
  if (w->status) return;
  const vs_sampled *p = w->observing.system;
  vs_meter_begin(&w->current, w->observing.current, w->scene->instruments.v.seed);
  for (int k = 0; k < p->sensors; k++)
    vs_meter_begin(&w->sensor[k], p->sensor[k].instrument, w->scene->instruments.v.seed);
  vs_estimator_begin(&w->estimator, &w->observing, &w->scene->frame, w->scene->setup.start.x);
}

static void try_out(void) {
  const char *scene = getenv("TRY_SCENE") ? getenv("TRY_SCENE") : "paper";
  const char *tier = getenv("TRY_TIER") ? getenv("TRY_TIER") : "switched";
  const char *map = getenv("TRY_MAP") ? getenv("TRY_MAP") : "{}";
  char *all = strdup(getenv("TRY_SETS") ? getenv("TRY_SETS") : "instruments={}"), *rest = all;
  const char *sets[32] = {0};
  int n = 0;
  while (rest) sets[n++] = strsep(&rest, ";");
  watch w = {.rate_hz = getenv("TRY_RATE") ? atof(getenv("TRY_RATE")) : 5000};
  vs_trial *t = vs_trial_read(scene, tier, sets);
  if (t->status) puts(t->err.text);
  w.scene = &t->scene;
  if (getenv("TRY_LOG")) w.log = fopen(getenv("TRY_LOG"), "w");
  begin_watch(&w, map);
  if (w.status) {
    puts(w.err.text);
    return;
  }
  const vs_observer observer = {&w, look};
  vs_trial_go(t, &observer);
  if (t->status) puts(t->err.text);
  printf("settling %g s\n", w.observing.settling_s);
  for (int k = 0; k < w.observing.system->states; k++)
    printf("pole %g %g\n", w.observing.pole[k].re_1_s, w.observing.pole[k].im_rad_s);
  for (int k = 0; k < 2 * w.observing.system->dof; k++) {
    const vs_estimator_errors *e = &w.estimator.errors;
    printf("%s: peak %g, all %.4g %%, settled %.4g %%\n",
           vs_channel_at(&t->scene.frame, VS_CH_Q + k).name, e->peak[k],
           100 * e->all[k] / e->peak[k], 100 * e->settled[k] / e->peak[k]);
  }
  if (w.log) fclose(w.log);
  vs_observing_free(&w.observing);
  vs_tree_free(&w.tree);
  vs_trial_free(t);
  free(all);
}

static const vs_test TESTS[] = {{"try", try_out}};
VS_SUITE_MAIN("estimator", TESTS)
