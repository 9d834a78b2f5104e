/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/watchers.h"

#include <math.h>
#include <stdlib.h>

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

/* ---- the early end of a free swing ----
 * Once the machine swings freely to the end of the run, some values cannot change any more: it is
 * known how far the machine can still go. Where those are all that is wanted, the rest of the run
 * is left out. */

/* True if the value is the least (sense -1) or the largest (+1), whatever the rest brings. */
static bool is_beyond_range(const vs_value *v, int sense, const vs_range *range) {
  return v->known && sense * v->value > sense * range->middle + range->way;
}

/* True if no extremum of the rest makes a ripple of the first motion peak. */
static bool is_a_peak(const vs_measures *m, const vs_swing_rest *rest) {
  double most = fabs(rest->travel.middle) + rest->travel.way;
  return m->first.known && fabs(m->first.value) > vs_measures_ripple * most;
}

/* What follows from the current, the firing and the energy drawn does not change any more; what is
 * left over by a balance is still to be found. */
static void find_settled(const vs_measures *m, const vs_swing_rest *rest, vs_measure_set *s) {
  const vs_model *model = m->frame->model;
  const bool peak = is_a_peak(m, rest), swung = rest->from_s > vs_measures_swing_ends_s;
  vs_value v[VS_MEASURES];
  vs_measures_finish(m, v);
  for (int k = 0; k < VS_MEASURES; k++) s->has[k] = true;
  s->has[VS_M_GAP_FIRST] = peak;
  s->has[VS_M_GAP_SECOND] = peak && m->second.known;
  s->has[VS_M_GAP_MIN] = is_beyond_range(&v[VS_M_GAP_MIN], -1, &rest->travel);
  s->has[VS_M_GAP_MAX] = is_beyond_range(&v[VS_M_GAP_MAX], 1, &rest->travel);
  s->has[VS_M_STROKE] = s->has[VS_M_GAP_MIN] && s->has[VS_M_GAP_MAX];
  s->has[VS_M_F_RESONANCE] = s->has[VS_M_TAU_GAP] = swung;
  s->has[VS_M_ENERGY_RESIDUAL] = false;
  for (int k = 0; k < VS_PULL_IN_MEASURES && model->pulls_in; k++) s->has[VS_M_PULL_IN + k] = false;
  for (int i = 0; i < model->dof; i++) {
    const vs_value *of = &v[VS_M_OF_COORDINATE(i, 0)];
    const vs_range rate2 = {0, rest->rate2[i]};
    s->has[VS_M_OF_COORDINATE(i, VS_LEAST)] = is_beyond_range(&of[VS_LEAST], -1, &rest->q[i]);
    s->has[VS_M_OF_COORDINATE(i, VS_LARGEST)] = is_beyond_range(&of[VS_LARGEST], 1, &rest->q[i]);
    s->has[VS_M_OF_COORDINATE(i, VS_PEAK)] = is_beyond_range(&of[VS_PEAK], 1, &rate2);
  }
}

/* True if all values that are wanted are settled. */
static bool are_all_settled(const vs_measure_set *s, const vs_measure_set *wanted) {
  for (int k = 0; k < VS_MEASURES; k++)
    if (wanted->has[k] && !s->has[k]) return false;
  return true;
}

/* ---- all of them ---- */

void vs_watchers_begin(vs_watchers *w, const vs_frame *frame, const vs_measure_set *wants) {
  if (w->measures) vs_watchers_free(w);
  w->measures = vs_measures_new(frame, wants);
  w->devices = vs_devices_new(frame);
  if (frame->deck) w->batch = vs_alloc(1, sizeof *w->batch);
  w->prompt = frame->timeline->program != NULL;
  w->energy.frame = frame;
  w->heat = frame->model->coil.heat;
  w->hottest_degc = w->heat.winding_degc;
  w->burnt_s = NAN;
}

const vs_warming *vs_watchers_warm(vs_watchers *w, const vs_setup *setup) {
  const vs_winding_values *winding = &setup->model.actuator.winding;
  if (!winding->present || !(winding->c_th[0] > 0) || !(winding->r_th[0] + winding->r_th[1] > 0) ||
      w->heat.settled || setup->timeline.firing.no_valve || setup->loads.count ||
      w->energy.frame->deck)
    return NULL;
  w->warming = (vs_warming){&w->heat, vs_alloc(1, sizeof *w->warming.model)};
  *w->warming.model = setup->model;
  return &w->warming;
}

bool vs_watchers_may_end_early(vs_watchers *w, const vs_swing_rest *rest,
                               const vs_measure_set *wanted) {
  find_settled(w->measures, rest, &w->settled);
  return are_all_settled(&w->settled, wanted);
}

/* True where the step brings what is told of the run: no step waits behind that. */
static bool is_told(const vs_step *step) {
  const vs_events *events = &step->frame->timeline->events;
  bool told = step->event[0] != VS_EV_NONE || step->event[1] != VS_EV_NONE;
  for (size_t k = 0; k < events->count && !told; k++)
    told = events->item[k].start_s >= step->from->t_s && events->item[k].start_s < step->to->t_s;
  return told;
}

/* Shows the steps that wait; `all`: the last one that was accepted is among them. */
static void look_at_batch(vs_watchers *w, bool all) {
  vs_devices_follow(w->devices, w->batch);
  vs_energy_take_losses(&w->energy, w->batch, all);
  w->batch->count = 0;
}

/* The energies, and what the losses of the step make of the winding. */
static inline void follow_energy(vs_watchers *w, const vs_step *step) {
  const vs_winding_values *winding = &step->frame->model->actuator.winding;
  if (!winding->present) {
    vs_energy_accept(&w->energy, step);
    return;
  }
  const double *joule = w->energy.joule, copper_j = joule[VS_E_COPPER], eddy_j = joule[VS_E_EDDY],
               by_s = step->to->t_s - step->from->t_s;
  vs_energy_accept(&w->energy, step);
  if (!(by_s > 0)) return;
  vs_winding_go(winding, (joule[VS_E_COPPER] - copper_j) / by_s, (joule[VS_E_EDDY] - eddy_j) / by_s,
                by_s, &w->heat);
  w->hottest_degc = fmax(w->hottest_degc, w->heat.winding_degc);
  if (isnan(w->burnt_s) && w->heat.winding_degc > VS_WINDING_BURNT_DEGC) w->burnt_s = step->to->t_s;
  if (!w->warming.model || vs_step_is_quiet(step)) return;
  const vs_coil *coil = &w->warming.model->coil;
  const double ohm = vs_winding_ohm(winding, coil->cold_ohm, w->heat.winding_degc);
  w->lag = fmax(w->lag, fabs(ohm / coil->resistance_ohm - 1));
}

/* lambda may turn between two knots. */
static void follow_flux(vs_watchers *w, const vs_step *step) {
  enum { PARTS = 8 };
  const double from_s = step->from->t_s, part_s = (step->to->t_s - from_s) / PARTS;
  for (int k = 0; k <= PARTS; k++)
    w->flux_wb = fmax(w->flux_wb, fabs(vs_step_channel(step, from_s + k * part_s, VS_CH_LAMBDA)));
}

void vs_watchers_accept(vs_watchers *w, const vs_step *step) {
  /* From where the rest is left out on, only the books of energy go on: what is settled stays. */
  if (step->glides && !w->left) w->left_s = step->from->t_s;
  w->left = w->left || step->glides;
  if (w->left) {
    follow_energy(w, step);
    return;
  }

  /* Those that look at each step at once, as they need its dense output. */
  w->strays = step->strays;
  follow_absence(&w->absence, step);
  follow_sequence(&w->sequence, step);
  vs_measures_accept(w->measures, step);
  if (!isnan(step->frame->model->actuator.linear_to_wb)) follow_flux(w, step);
  follow_energy(w, step);

  /* Those that evaluate the deck's formulas look at some steps at a time, which costs less. */
  if (!w->batch) return;
  if (!w->began) vs_devices_begin(w->devices, step);
  w->began = true;
  vs_devices_tell_anew(w->devices);
  if (w->batch->count + (size_t)step->parts >= VS_BATCH_STEPS) look_at_batch(w, false);
  vs_batch_take(w->batch, step);
  if (w->prompt || vs_energy_is_due(&w->energy) || is_told(step)) look_at_batch(w, true);
}

/* What is no more than the rounding of what it was made of is told as 0, by all who tell it. */
static void round_off_watched(vs_watchers *w, vs_value values[VS_MEASURES]) {
  vs_measures *m = w->measures;
  vs_energy_round_off(&w->energy);
  for (int k = 0; k < VS_MEASURES; k++) values[k].value = vs_extreme_told(values[k].value, 0);
  for (int k = m->of_probes; k + 1 < m->n_extremes; k += 2) {
    vs_value *least = &m->extremes[k].best, *largest = &m->extremes[k + 1].best;
    const double size = fmax(fabs(least->value), fabs(largest->value));
    least->value = vs_extreme_told(least->value, size);
    largest->value = vs_extreme_told(largest->value, size);
  }
}

double vs_watchers_heat_doubt(const vs_watchers *w) {
  const vs_model *m = w->energy.frame->model;
  const double kept = vs_winding_ohm(&m->actuator.winding, m->coil.cold_ohm, w->hottest_degc) /
                          m->coil.resistance_ohm -
                      1;
  /* while it follows, it is off by the lag at the end of a conduction alone */
  const double share = w->warming.model ? w->lag / 2 : fabs(kept);
  if (w->heat.settled) return 0;
  if (share >= 1) return INFINITY;
  return (w->hottest_degc - m->coil.heat.winding_degc) * share / (1 - share);
}

void vs_watchers_finish(vs_watchers *w, double until_s, vs_value values[VS_MEASURES]) {
  /* What waits is looked at; then each completes what only the end of the run tells. */
  end_absence(&w->absence, until_s);
  vs_devices_tell_anew(w->devices);
  if (w->batch && w->batch->count) look_at_batch(w, true);
  vs_measures_finish(w->measures, values);
  vs_energy_finish(&w->energy);
  round_off_watched(w, values);

  /* The energies are measures of every run. */
  const double *joule = w->energy.joule;
  values[VS_M_ENERGY_IN] = (vs_value){true, joule[VS_E_SOURCE], NAN};
  values[VS_M_ENERGY_COPPER] = (vs_value){true, joule[VS_E_COPPER], NAN};
  values[VS_M_WORK_FORCE] = (vs_value){true, joule[VS_E_WORK], NAN};
  values[VS_M_ENERGY_RESIDUAL] = (vs_value){true, w->energy.worst, NAN};
  const vs_model *model = w->energy.frame->model;
  const vs_winding_values *winding = &model->actuator.winding;
  if (w->heat.settled || (winding->c_th[0] > 0 && winding->r_th[0] + winding->r_th[1] > 0))
    values[VS_M_COIL_T] = (vs_value){true, w->hottest_degc, NAN};

  /* What the rest could have changed is not known. */
  for (int k = 0; w->left && k < VS_MEASURES; k++)
    if (!w->settled.has[k]) values[k] = (vs_value){.at_s = NAN};
  vs_devices_finish(w->devices);
}

void vs_watchers_free(vs_watchers *w) {
  vs_measures_free(w->measures);
  vs_devices_free(w->devices);
  free(w->batch);
  free(w->warming.model);
  *w = (vs_watchers){0};
}
