/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/measured.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "alike.h"
#include "run/listed_line.h"

void vs_measured_begin(vs_measured *m, const vs_scene *scene, const vs_orbit *orbit) {
  vs_watchers_begin(&m->result.watchers, &scene->frame, NULL);
  m->result.scene = scene;
  m->period = orbit != NULL;
  if (orbit) vs_steady_follow(&m->steady, orbit, &scene->setup);
}

void vs_measured_accept(vs_measured *m, const vs_step *step) {
  m->result.steps++;
  vs_watchers_accept(&m->result.watchers, step);
  if (m->period) vs_steady_accept(&m->steady, step);
}

void vs_measured_finish(vs_measured *m) {
  vs_result_finish(&m->result);
  if (m->period) vs_steady_finish(&m->steady, &m->result);
}

void vs_measured_free(vs_measured *m) {
  vs_result_free(&m->result);
  if (m->period) vs_steady_end(&m->steady);
}

/* ---- a run of its own ---- */

static vs_status begin_run_of_measures(void *ctx, vs_scene *scene, vs_error *err) {
  vs_measured *m = ctx;
  (void)err;
  vs_steady_again(&m->steady, scene);
  return VS_OK;
}

static vs_status accept_step_of_measures(void *ctx, const vs_step *step, const vs_result *result,
                                         vs_error *err) {
  vs_measured *m = ctx;
  (void)result, (void)err;
  vs_steady_accept(&m->steady, step);
  return VS_OK;
}

vs_status vs_measured_run(vs_measured *m, vs_scene *scene, int periods, const vs_session *session,
                          vs_error *err) {
  const vs_session_listener guest = {
      .ctx = m, .begin = begin_run_of_measures, .accept = accept_step_of_measures};
  vs_session along = *session;
  m->period = periods > 0;
  if (m->period) along.guest = &guest;
  scene->warnings =
      (vs_warnings){0}; /* those of the scene that it was copied from are not its own */
  vs_status status = m->period ? vs_steady_begin(&m->steady, scene, periods, err) : VS_OK;
  if (!status && m->alike) vs_alike_take(m->alike, m->steady.picard);
  if (!status) status = vs_session_charge_budget(scene, err);
  if (!status) status = vs_steady_run(&along, scene, &m->result, err);
  if (!status && m->period) vs_steady_finish(&m->steady, &m->result);
  vs_warnings_free(&scene->warnings);
  return status;
}

/* ---- measures ---- */

static void put_listed(const vs_listed_measure *shown, vs_measured_value *v) {
  snprintf(v->name, sizeof v->name, "%s", shown->name);
  snprintf(v->unit, sizeof v->unit, "%s", shown->unit);
  v->value = shown->value;
}

static bool steady_measure_at(const vs_measured *m, int k, vs_measured_value *v) {
  vs_steady_measure own;
  if (!m->period || !vs_steady_at(&m->steady, k, &own)) return false;
  snprintf(v->name, sizeof v->name, "%s", own.name);
  snprintf(v->unit, sizeof v->unit, "%s", own.unit);
  v->value = own.value;
  return true;
}

/* First the least margin of the verdict, then the numbers of its lines. */
static bool margin_at(const vs_measured *m, int k, vs_measured_value *v) {
  const vs_judgement *weakest = m->result.verdict.weakest;
  vs_listed_measure shown;
  if (k == 0) {
    *v = (vs_measured_value){.name = "margin_least"};
    v->value = (vs_value){weakest, weakest ? weakest->margin : NAN, NAN};
    return true;
  }
  if (!vs_listed_line_at(&m->result.scene->frame, &m->result, k - 1, &shown)) return false;
  put_listed(&shown, v);
  v->value.known = isfinite(v->value.value);
  return true;
}

bool vs_measured_at(const vs_measured *m, int k, vs_measured_value *v) {
  const vs_frame *frame = &m->result.scene->frame;
  vs_listed_measure shown;
  int listed = 0, steady = 0;
  if (vs_listed_measure_at(frame, &m->result, k, &shown)) {
    put_listed(&shown, v);
    return true;
  }
  while (vs_listed_measure_at(frame, &m->result, listed, &shown)) listed++;
  if (steady_measure_at(m, k - listed, v)) return true;
  while (steady_measure_at(m, steady, v)) steady++;
  return margin_at(m, k - listed - steady, v);
}

int vs_measured_find(const vs_measured *m, const char *name) {
  vs_measured_value v;
  for (int k = 0; vs_measured_at(m, k, &v); k++)
    if (!strcmp(v.name, name)) return k;
  return -1;
}
