/* SPDX-License-Identifier: GPL-3.0-or-later
 * The reductions of a course alone: its peak, its mean or rms value, its integral, its rate; and
 * the table of all reductions, most of which stand in files of their own. */
#include "devices/reductions.h"

#include <math.h>

#include "devices/means.h"
#include "netlist/devices.h"

/* ---- peaks ---- */

static double value_in_sense(double value, int sense) {
  return (sense ? sense * value : fabs(value)) + 0.0; /* no -0 */
}

static bool has_measured_course(const vs_watched *w, const vs_reduced *r) {
  return r->measure->of != VS_OF_FLUX || w->device->has_flux;
}

static void begin_peak(const vs_watched *w, vs_reduced *r, double t_s) {
  const vs_device_measure *m = r->measure;
  r->value = (vs_value){true, value_in_sense(w->last[m->of], m->sense), t_s};
}

static void follow_peak(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  const vs_device_measure *m = r->measure;
  double to = value_in_sense(c->to[m->of], m->sense);
  (void)w;
  if (to > r->value.value) r->value = (vs_value){true, to, c->t1_s};
  if (r->limit) vs_reducer_watch(r, c, value_in_sense(c->from[m->of], m->sense), to);
}

/* No step ends above the peak so far, nor above a limit that was not passed yet. */
static bool peak_rests(const vs_watched *w, const vs_reduced *r, const vs_courses *c) {
  const vs_device_measure *m = r->measure;
  const vs_pair *y = c->of[m->of];
  double most = -INFINITY;
  bool watched = r->limit && isnan(r->failed_s);
  (void)w;
  for (size_t n = 0; n < c->count; n++) {
    double to = value_in_sense(y[n][1], m->sense);
    if (to > most) most = to;
  }
  return most <= r->value.value && !(watched && !(most <= r->limit->value));
}

static const vs_reducer peak = {.is_busy = has_measured_course,
                                .begin = begin_peak,
                                .follow = follow_peak,
                                .rests = peak_rests};

/* ---- means, as measure/devices/means.h judges them ---- */

static void finish_mean(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  double span_s = end->to_s - end->from_s;
  if (!(span_s > 0)) return;
  r->value = (vs_value){true, w->sum_meant[r->measure->of] / span_s, NAN};
  vs_means_judge(w, r, end->to_s);
}

static void finish_rms(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  double span_s = end->to_s - end->from_s;
  if (!(span_s > 0)) return;
  r->value = (vs_value){true, sqrt(w->sum_meant[r->measure->of] / span_s), NAN};
  vs_means_judge(w, r, end->to_s);
}

/* A voltage is direct where its mean is more than the rms value of the rest, over the stretch that
 * the measure is judged over. Data sheets give both an rms value, of a sine, and a direct voltage,
 * which is higher: 510 V and 670 V. */
static bool is_direct(const vs_watched *w, const vs_reduced *r, const vs_run_end *end) {
  const vs_parts *p = &w->parts;
  const double from_s = vs_means_from_s(w, r, end), span_s = end->to_s - from_s;
  double v_s = w->sum_meant[VS_OF_V], v2_s = w->sum_meant[VS_OF_V2];
  if (from_s > end->from_s) {
    v_s = v2_s = 0;
    for (size_t k = (size_t)lround((from_s - p->from_s) / p->part_s); k < p->count; k++) {
      v_s += p->sum[k][VS_OF_V];
      v2_s += p->sum[k][VS_OF_V2];
    }
  }
  return 2 * v_s * v_s > v2_s * span_s;
}

/* The part states that limit, and it is a number. */
static bool is_stated(const vs_watched *w, const char *name) {
  const vs_limit *limit = vs_devices_own_limit(w->deck, w->device, name);
  return limit && isfinite(limit->value);
}

/* Not judged, and no word of it: the part states no such limit, or the other one of v_rms and v_dc
 * is the one that holds. */
static void leave_out_rms_or_dc(vs_reduced *r) {
  r->limit = NULL;
  r->idle = true;
}

static void finish_alternating(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  const bool direct = end->to_s > end->from_s && is_direct(w, r, end);
  if (!r->limit || (direct && is_stated(w, "v_dc"))) leave_out_rms_or_dc(r);
  finish_rms(w, r, end);
  if (direct || !is_stated(w, "v_dc") || is_stated(w, "v_rms")) return;
  r->idle = false;
  r->unjudged = "not judged: v_rms not stated";
}

/* One of the two holds in any case, also where they are judged over different stretches. A kind may
 * have the direct one alone. */
static void finish_direct(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  const vs_reduced *alternating = vs_reducer_of(w, VS_R_ALTERNATING);
  const double span_s = end->to_s - end->from_s;
  const bool other_is_left = alternating && alternating->idle && is_stated(w, "v_rms"),
             direct = span_s > 0 && (other_is_left || is_direct(w, r, end));
  if (!r->limit || (!direct && alternating)) leave_out_rms_or_dc(r);
  if (!(span_s > 0)) return;
  r->value = (vs_value){true, fabs(w->sum_meant[VS_OF_V] / span_s), NAN};
  vs_means_judge(w, r, end->to_s);
  if (!direct && !alternating && r->limit) {
    r->limit = NULL;
    r->unjudged = "not judged: not a direct voltage";
  }
  if (!direct || !is_stated(w, "v_rms") || is_stated(w, "v_dc")) return;
  r->idle = false;
  r->unjudged = "not judged: v_dc not stated";
}

static const vs_reducer mean = {.continuous = true, .finish = finish_mean},
                        rms = {.continuous = true, .finish = finish_rms},
                        carried = {.continuous = true, .until_opens = true, .finish = finish_rms},
                        alternating = {.continuous = true, .finish = finish_alternating},
                        direct = {.continuous = true, .finish = finish_direct};

/* ---- integrals ---- */

static void follow_integral(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  int of = r->measure->of;
  vs_reducer_watch(r, c, w->sum[of] - c->more[of], w->sum[of]);
}

static void finish_integral(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  (void)end;
  r->value = (vs_value){true, w->sum[r->measure->of], NAN};
}

static const vs_reducer integral = {
    .is_busy = vs_reducer_has_limit, .follow = follow_integral, .finish = finish_integral};

/* The state is the integral over the present conduction. */
static void follow_conduction_integral(const vs_watched *w, vs_reduced *r,
                                       const vs_course_step *c) {
  double *present = r->state;
  (void)w;
  if (!c->was_on && !c->on) return;
  double before = c->was_on ? *present : 0;
  *present = before + c->more[r->measure->of];
  vs_reducer_take_largest(r, c, before, *present);
}

/* However the run's current is cut into conductions, no conduction has more than the whole. */
static void finish_conduction_integral(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  (void)end;
  r->most = w->sum[r->measure->of];
}

static const vs_reducer pulse = {.state_size = sizeof(double),
                                 .across = true,
                                 .hangs_on_sequence = true,
                                 .begin = vs_reducer_begin_at_zero,
                                 .follow = follow_conduction_integral,
                                 .finish = finish_conduction_integral};

/* ---- means of what is repeated ----
 * The integral over the run, divided by the time from one pulse to the next. Not known where no
 * event repeats the run. */

static void finish_repeated(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  const vs_scene_event *e = vs_scene_event_repeated(&w->timeline->events);
  r->idle = !e;
  if (!e) return;
  r->value = (vs_value){true, w->sum[r->measure->of] / e->v.every_s, NAN};
  if (r->limit && r->value.value > r->limit->value) r->failed_s = end->now_s;
}

static const vs_reducer repeated = {.finish = finish_repeated};

/* ---- rates ---- */

static void follow_slope(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  int of = r->measure->of;
  (void)w;
  double rate =
      vs_slope_rate(r->state, c->t0_s, c->from[of], c->t1_s, c->to[of], r->measure->sense);
  vs_reducer_offer(r, (vs_value){rate >= 0, rate, c->t1_s}, vs_reducer_is_held_from_below(r));
}

static const vs_reducer steepest = {
    .state_size = sizeof(vs_slope), .is_rate = true, .follow = follow_slope};

/* ---- the table ---- */

const vs_reducer *const vs_reductions_all[VS_REDUCTIONS] = {
#define VS_REDUCTION_ROW(id, plug) [id] = &plug,
    VS_REDUCTION_LIST(VS_REDUCTION_ROW)
#undef VS_REDUCTION_ROW
};
