/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/watchers.h"

#include <math.h>
#include <stdlib.h>

#include "base/text.h"

/* ---- absence ---- */

static void end_absence(vs_absence *a, double until_s) {
  if (a->now) a->total_s += until_s - a->since_s;
  a->now = false;
}

static void follow_absence(vs_absence *a, const vs_step *step) {
  if (step->event[1] == VS_EV_QUIET) {
    a->since_s = step->event_s[1];
    if (!a->times++) a->first_s = a->since_s;
    a->bound = fmax(a->bound, step->bound);
    a->now = true;
  } else if (step->event[1] == VS_EV_BACK) {
    a->bound = fmax(a->bound, step->bound);
    end_absence(a, step->event_s[1]);
  }
}

/* ---- firings ---- */

static void follow_sequence(vs_sequence *sequence, const vs_step *step) {
  for (int k = 0; k < 2; k++) {
    if (step->event[k] == VS_EV_FIRES)
      vs_reducer_add_deed(sequence, VS_DEED_FIRES, step->event_s[k]);
    if (step->event[k] == VS_EV_EXTINCT)
      vs_reducer_add_deed(sequence, VS_DEED_GOES_OUT, step->event_s[k]);
  }
}

/* ---- all of them ---- */

void vs_watchers_begin(vs_watchers *w, const vs_frame *frame, const vs_measure_set *wants) {
  vs_watchers_free(w);
  w->measures = vs_measures_new(frame, wants);
  w->devices = vs_devices_new(frame);
  if (frame->deck) w->batch = vs_alloc(1, sizeof *w->batch);
  w->prompt = frame->timeline->program != NULL;
  w->energy.frame = frame;
}

bool vs_watchers_leave(vs_watchers *w, const vs_rest *rest, const vs_measure_set *wanted) {
  vs_settled_find(w->measures, rest, &w->settled);
  return vs_settled_all(&w->settled, wanted);
}

/* Shows the steps that wait. */
static void look_at_batch(vs_watchers *w) {
  vs_devices_follow(w->devices, w->batch);
  vs_energy_lose(&w->energy, w->batch);
  w->batch->count = 0;
}

void vs_watchers_accept(vs_watchers *w, const vs_step *step) {
  w->left = w->left || step->glides;
  if (w->left) { /* what is settled stays */
    vs_energy_accept(&w->energy, step);
    return;
  }
  w->strays = step->strays;
  follow_absence(&w->absence, step);
  follow_sequence(&w->sequence, step);
  vs_measures_accept(w->measures, step);
  vs_energy_accept(&w->energy, step);
  if (!w->batch) return;
  if (!w->began) vs_devices_begin(w->devices, step);
  w->began = true;
  vs_batch_take(w->batch, step);
  if (w->prompt || vs_energy_is_due(&w->energy)) look_at_batch(w);
}

/* What is no more than the rounding of what it was made of is told as 0, by all who tell it. */
static void round_off(vs_watchers *w, vs_value values[VS_MEASURES]) {
  vs_measures *m = w->measures;
  vs_energy_round_off(&w->energy);
  for (int k = 0; k < VS_MEASURES; k++) values[k].value = vs_value_told(values[k].value, 0);
  for (int k = m->of_probes; k + 1 < m->n_extremes; k += 2) {
    vs_value *least = &m->extremes[k].best, *largest = &m->extremes[k + 1].best;
    const double size = fmax(fabs(least->value), fabs(largest->value));
    least->value = vs_value_told(least->value, size);
    largest->value = vs_value_told(largest->value, size);
  }
}

void vs_watchers_finish(vs_watchers *w, double until_s, vs_value values[VS_MEASURES]) {
  end_absence(&w->absence, until_s);
  if (w->batch && w->batch->count) look_at_batch(w);
  vs_measures_finish(w->measures, values);
  vs_energy_finish(&w->energy);
  round_off(w, values);
  const double *joule = w->energy.joule;
  values[VS_M_ENERGY_IN] = (vs_value){true, joule[VS_E_SOURCE], NAN};
  values[VS_M_ENERGY_COPPER] = (vs_value){true, joule[VS_E_COPPER], NAN};
  values[VS_M_WORK_FORCE] = (vs_value){true, joule[VS_E_WORK], NAN};
  values[VS_M_ENERGY_RESIDUAL] = (vs_value){true, w->energy.worst, NAN};
  for (int k = 0; w->left && k < VS_MEASURES; k++)
    if (!w->settled.has[k]) values[k] = (vs_value){.at_s = NAN};
  vs_devices_finish(w->devices);
}

void vs_watchers_free(vs_watchers *w) {
  vs_measures_free(w->measures);
  vs_devices_free(w->devices);
  free(w->batch);
  *w = (vs_watchers){0};
}
