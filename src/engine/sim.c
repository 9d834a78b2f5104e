/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/sim.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "macromodel/macromodel.h"
#include "plant/coil.h"

vs_frame vs_sim_frame(const vs_tier *tier, const vs_setup *setup) {
  return (vs_frame){.model = &setup->model,
                    .timeline = &setup->timeline,
                    .cooling = &setup->cooling,
                    .deck = tier->has_circuit ? &setup->deck : NULL,
                    .gap_at_rest = tier->gap_at_rest,
                    .means = setup->means,
                    .at_work = setup->at_work,
                    .from_work = setup->steady && !setup->at_work,
                    .on_orbit = setup->steady,
                    .tolerance = setup->run.tolerance,
                    .source_is_coil = !tier->has_circuit};
}

vs_knot vs_sim_start(const vs_setup *setup, const vs_frame *frame) {
  vs_knot k = {0};
  memcpy(k.x, setup->start.x, sizeof k.x);
  const vs_model *m = &setup->model;
  k.flux_wb = vs_coil_idle_flux(&m->coil, vs_mechanics_gap(m, k.x)) + setup->start.flux_wb;
  for (int n = 0; n < m->coil.rungs; n++)
    k.psi_wb[n] =
        m->coil.rung[n].share * (k.flux_wb - setup->start.flux_wb) + setup->start.psi_wb[n];
  vs_step_complete_knot(frame, &k, vs_stops_touched(&m->stops, vs_mechanics_travel(m, k.x)));
  return k;
}

/* Returns the first instant in the step at which the armature is through the pole cover, by
 * bisection. At the step's end it is. */
static double contact_time(const vs_step *step) {
  const vs_model *m = step->frame->model;
  double lo = step->from->t_s, hi = step->to->t_s;
  for (int n = 0; n < 60; n++) {
    double mid = (lo + hi) / 2;
    double y[VS_CH_MOST];
    vs_step_groups_at(step, mid, 0, y);
    if (vs_mechanics_closed(m, y[VS_CH_TRAVEL]))
      hi = mid;
    else
      lo = mid;
  }
  return hi;
}

vs_status vs_sim_refuse_endless(const vs_setup *setup, double step_s, vs_error *err) {
  double steps = setup->run.until_s / step_s;
  return steps < 1e10
             ? VS_OK
             : vs_fail(err, VS_INPUT,
                       "run: %.2g steps of %.2g s would be needed to run.until; look at "
                       "run.max_step and at masses, stiffness and damping%s",
                       steps, step_s, setup->model.coil.rungs ? ", and at actuator.eddy" : "");
}

enum { MOST_AMPERES = 1000000 }; /* the coils that this model is for carry some amperes */

vs_status vs_sim_check(const vs_step *step, vs_error *err) {
  const vs_model *m = step->frame->model;
  const vs_knot *k = step->to;
  double sum = k->flux_wb;
  for (int n = 0; n < m->coil.rungs; n++) sum += k->psi_wb[n];
  for (int n = 0; n < 2 * m->dof; n++) sum += k->x[n];
  for (size_t n = 0; step->frame->deck && n < step->frame->deck->n_terms; n++) sum += k->terms[n];
  if (!isfinite(sum))
    return vs_fail(err, VS_RUN, "t = %.9g s: the state is not a number any more", k->t_s);
  double g = vs_mechanics_travel(m, k->x), z = vs_coil_gap(&m->coil, g);
  if (vs_mechanics_closed(m, g))
    return vs_fail(
        err, VS_RUN,
        "t = %.9g s: the armature meets the pole cover (%s = -D = %g mm%s) and the scene has no "
        "actuator.stop; what would follow is not physical; fire later (firing.angle), end earlier "
        "(run.until), or give a stop, as actuator.stop: {stiffness: 1e7 N/m, damping: 300 N.s/m}",
        contact_time(step), vs_mechanics_travel_name(m), -1e3 * m->actuator.gap_m,
        z <= 0 ? ", even z <= 0" : "");
  if (z <= 0 && m->coil.law->poles)
    return vs_fail(err, VS_RUN,
                   "t = %.9g s: the gap is closed (z = %.3g mm): the stop has given way", k->t_s,
                   1e3 * z);
  char text[256];
  const vs_law *law = m->coil.law;
  const char *beyond = law->beyond ? law->beyond(&m->coil, k->flux_wb, z, text, sizeof text) : NULL;
  if (beyond)
    return vs_fail(err, VS_RUN, "t = %.9g s: the law %s is left: %s", k->t_s, law->name, beyond);
  double i = vs_coil_current(&m->coil, k->flux_wb, z);
  if (fabs(i) > MOST_AMPERES)
    return vs_fail(err, VS_RUN, "t = %.9g s: coil current of %.3g A is beyond sense", k->t_s, i);
  return VS_OK;
}

/* The observer of a guarded run: checks the step, then shows it to the run's own observer. */
static vs_status accept_checked_step(void *ctx, const vs_step *step, vs_error *err) {
  const vs_observer *observer = ctx;
  vs_status status = vs_sim_check(step, err);
  return status ? status : observer->accept(observer->ctx, step, err);
}

vs_status vs_sim_run(const vs_tier *tier, const vs_setup *setup, const vs_run_order *order,
                     const vs_observer *observer, vs_error *err) {
  const vs_observer guarded = {(void *)(size_t)observer, accept_checked_step};
  return tier->run(setup, order, &guarded, err);
}

const char *vs_sim_why_stays(const vs_run_order *order, const vs_setup *setup) {
  return order->stand_in ? order->stand_in->declines(setup) : NULL;
}
