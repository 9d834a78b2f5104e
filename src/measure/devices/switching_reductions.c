/* SPDX-License-Identifier: GPL-3.0-or-later
 * Reductions of what those tell who follow a device: what it did (measure/switching.h), what its
 * gate pulses were, and what its loss is made of (measure/devices/losses.h). */
#include "devices/reductions.h"

#include <math.h>
#include <stdio.h>

#include "base/units.h"
#include "devices/losses.h"

/* ---- news of a device that conducts or blocks ---- */

static void prepare_rise(vs_watched *w, vs_reduced *r) {
  r->over_v = vs_devices_dv_dt_over(w->deck, w->device);
  if (w->states) w->states->rise.over_v = r->over_v;
}

static void take_told_stretch(vs_reduced *r, const vs_rise_rate *rose) {
  vs_reducer_offer(r, rose->rate, false);
  if (!rose->rate.known || r->value.at_s != rose->rate.at_s || r->value.value != rose->rate.value)
    return;
  r->over_v = rose->over_v;
  r->doubt = rose->error;
}

static void take_rise(const vs_watched *w, vs_reduced *r, const vs_switch_news *news) {
  (void)w;
  take_told_stretch(r, &news->rise);
}

static void take_return_rise(const vs_watched *w, vs_reduced *r, const vs_switch_news *news) {
  (void)w;
  take_told_stretch(r, &news->return_rise);
}

/* The last step of the run may be its steepest. */
static void finish_rise(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  vs_switch_news news;
  (void)end;
  if (!w->states) return;
  vs_switching_finish(w->states, &news);
  (r->measure->how == VS_R_RISE ? take_rise : take_return_rise)(w, r, &news);
}

/* Where the part states the limit at a second temperature, the limit at the junction's own largest
 * one is between the two: on a straight line where it is the least that is allowed, on a power law
 * where it is the most, as that is the stricter of the two. Beyond the two it is the nearer one's;
 * where the junction's temperature is not known it is that at t_j_max. */
typedef struct at_temperature {
  vs_limit limit;
} at_temperature;

static double limit_between(const vs_limit_at *cold, double hot_degc, const vs_reduced *r,
                            double degc) {
  double part = (degc - cold->at_degc) / (hot_degc - cold->at_degc);
  part = fmin(fmax(part, 0), 1);
  if (r->measure->held == VS_AT_LEAST) return cold->value + part * (r->limit->value - cold->value);
  return cold->value * pow(r->limit->value / cold->value, part);
}

static void settle_at_temperature(const vs_watched *w, vs_reduced *r) {
  at_temperature *own = r->state;
  double hot_degc;
  const vs_limit_at *cold =
      r->limit ? vs_devices_limit_at(w->deck, w->device, r->limit->name, &hot_degc) : NULL;
  const vs_reduced *t_j = vs_reducer_of(w, VS_R_HOTTEST);
  if (!cold || !t_j || !t_j->value.known || t_j->mean) return;
  own->limit = *r->limit;
  own->limit.value = limit_between(cold, hot_degc, r, t_j->value.value);
  own->limit.unsure = r->limit->unsure | cold->unsure | t_j->unsure;
  snprintf(own->limit.written, sizeof own->limit.written, "%.4g %s",
           own->limit.value / vs_units_factor(own->limit.unit), own->limit.unit);
  snprintf(own->limit.text, sizeof own->limit.text, "junction at %.4g degC", t_j->value.value);
  r->limit = &own->limit;
  const bool least = r->measure->held == VS_AT_LEAST;
  const double v = r->value.value, limit = r->limit->value;
  r->failed_s = r->value.known && (least ? v < limit : v > limit) ? r->value.at_s : NAN;
}

static void take_off_rate(const vs_watched *w, vs_reduced *r, const vs_switch_news *news) {
  (void)w;
  vs_reducer_offer(r, news->off_rate, vs_reducer_is_held_from_below(r));
}

static void take_on_rate(const vs_watched *w, vs_reduced *r, const vs_switch_news *news) {
  (void)w;
  vs_reducer_offer(r, news->on_rate, vs_reducer_is_held_from_below(r));
}

/* The limit of the time offered is the part's t_q, by which a commutation failure is told. */
static void prepare_offered(vs_watched *w, vs_reduced *r) {
  if (w->states && r->limit) w->states->t_q_s = r->limit->value;
}

static void take_offered(const vs_watched *w, vs_reduced *r, const vs_switch_news *news) {
  (void)w;
  vs_reducer_offer(r, news->offered, vs_reducer_is_held_from_below(r));
  if (!news->offered.known || r->value.at_s != news->offered.at_s) return;
  r->doubt = news->doubt_s;
  r->spread = news->spread_s;
}

/* ---- what must not happen ---- */

static void take_misfire(const vs_watched *w, vs_reduced *r, const vs_switch_news *news) {
  (void)w;
  if (!news->misfire.known) return;
  vs_reducer_count(r, news->misfire.at_s);
  char *cause = vs_reducer_happens(r, news->misfire.at_s);
  if (cause)
    snprintf(cause, VS_CAUSE_SIZE, "%s",
             news->lost        ? "the last half cycle's current outlasted its gate pulse"
             : news->unlatched ? "its current did not reach latching"
                               : "no current followed its gate pulse");
}

/* Whether a pulse that the run's end cuts off is answered is not known; that of an orbit goes on at
 * its beginning. */
static void finish_misfire(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  const vs_switch *s = w->states;
  (void)end;
  if (s && !w->at_work && s->gate.gates.count && s->gate.on && s->forward && !s->conducted)
    r->unjudged = "not judged: a gate pulse without current goes on as the run ends";
}

/* A limit of the device's part in SI; NAN: its file states none. */
static double limit_of_part(const vs_watched *w, const char *name) {
  const vs_limit *limit = vs_devices_own_limit(w->deck, w->device, name);
  return limit ? limit->value : NAN;
}

/* Significant digits that a value is told with: three, and more where it would else have an
 * exponent. */
static int digits_of_value(double value) {
  return 1 + (int)fmax(2, log10(fabs(value) + 0.5));
}

/* A thyristor that blocks is turned on by its forward voltage where that is beyond what its part
 * bears, else by the rise of it, whose displacement current acts as a gate current. */
static void take_unintended(const vs_watched *w, vs_reduced *r, const vs_switch_news *news) {
  if (!news->unintended.known) return;
  vs_reducer_count(r, news->unintended.at_s);
  char *cause = news->commutation_failure ? NULL : vs_reducer_happens(r, news->unintended.at_s);
  if (!cause) return;
  const double most_v = limit_of_part(w, "v_drm");
  if (news->fired_v > most_v)
    snprintf(cause, VS_CAUSE_SIZE, "breakover at %.4g V, beyond V_DRM of %.4g V", news->fired_v,
             most_v);
  else if (news->fired_rate > 0)
    snprintf(cause, VS_CAUSE_SIZE, "dv/dt of %.*g V/us over %.*g V, up to %.*g V",
             digits_of_value(1e-6 * news->fired_rate), 1e-6 * news->fired_rate,
             digits_of_value(news->fired_over_v), news->fired_over_v,
             digits_of_value(news->fired_v), news->fired_v);
  else
    snprintf(cause, VS_CAUSE_SIZE, "at %.*g V, without a rise", digits_of_value(news->fired_v),
             news->fired_v);
}

static void take_commutation_failure(const vs_watched *w, vs_reduced *r,
                                     const vs_switch_news *news) {
  if (!news->commutation_failure) return;
  vs_reducer_count(r, news->unintended.at_s);
  char *cause = vs_reducer_happens(r, news->unintended.at_s);
  if (!cause) return;
  int length = snprintf(cause, VS_CAUSE_SIZE, "forward voltage was back %.4g us after its current",
                        1e6 * w->states->offered_s);
  if (isfinite(w->states->t_q_s))
    snprintf(cause + length, VS_CAUSE_SIZE - (size_t)length, ", t_q is %.4g us",
             1e6 * w->states->t_q_s);
}

/* A device that is lost fires within its own decay, which the run may not come to see. */
static void finish_commutation_failure(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  if (w->states && vs_switching_may_fail(w->states, end->now_s))
    r->unjudged = "not judged: forward voltage is back just before the run ends";
}

static void settle_rise_error(const vs_watched *w, vs_reduced *r) {
  const vs_reduced *rise = vs_reducer_of(w, VS_R_RISE);
  if (rise && rise->value.known) r->value = (vs_value){true, rise->doubt, NAN};
}

static void take_fall(const vs_watched *w, vs_reduced *r, const vs_switch_news *news) {
  vs_reducer_offer(r, news->fall, false);
  if (news->fall.known && r->value.at_s == news->fall.at_s)
    r->unsure = w->states->fell_last ? VS_ASSUMED : 0;
}

static void finish_fall(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  (void)end;
  vs_switch_news news;
  if (!w->states) return;
  vs_switching_finish(w->states, &news);
  take_fall(w, r, &news);
}

#define HAPPENS .hangs_on_sequence = true, .state_size = sizeof(vs_happening)
const vs_reducer vs_switching_reductions_rise = {.is_rate = true,
                                                 .makes_fire = true,
                                                 .state_size = sizeof(at_temperature),
                                                 .prepare = prepare_rise,
                                                 .take_news = take_rise,
                                                 .finish = finish_rise,
                                                 .settle = settle_at_temperature},
                 vs_switching_reductions_rise_error = {.settle = settle_rise_error},
                 vs_switching_reductions_off_rate = {.is_rate = true, .take_news = take_off_rate},
                 vs_switching_reductions_on_rate = {.is_rate = true,
                                                    .hangs_on_sequence = true,
                                                    .take_news = take_on_rate},
                 vs_switching_reductions_return_rise = {.is_rate = true,
                                                        .hangs_on_sequence = true,
                                                        .makes_fire = true,
                                                        .state_size = sizeof(at_temperature),
                                                        .prepare = prepare_rise,
                                                        .take_news = take_return_rise,
                                                        .finish = finish_rise,
                                                        .settle = settle_at_temperature},
                 vs_switching_reductions_fall = {.is_rate = true,
                                                 .hangs_on_sequence = true,
                                                 .take_news = take_fall,
                                                 .finish = finish_fall},
                 vs_switching_reductions_offered = {.hangs_on_sequence = true,
                                                    .makes_fire = true,
                                                    .state_size = sizeof(at_temperature),
                                                    .prepare = prepare_offered,
                                                    .take_news = take_offered,
                                                    .settle = settle_at_temperature},
                 vs_switching_reductions_misfire = {HAPPENS, .counts = true,
                                                    .take_news = take_misfire,
                                                    .finish = finish_misfire},
                 vs_switching_reductions_unintended = {HAPPENS, .counts = true,
                                                       .take_news = take_unintended},
                 vs_switching_reductions_commutation_failure = {
                     HAPPENS, .counts = true, .take_news = take_commutation_failure,
                     .finish = finish_commutation_failure};
#undef HAPPENS

/* ---- gate pulses ---- */

typedef struct gate_pulses {
  vs_gate_watch gate;
  double peak_a; /* in the present pulse */
} gate_pulses;

static void prepare_gate(vs_watched *w, vs_reduced *r) {
  gate_pulses *g = r->state;
  vs_switching_gate_begin(&g->gate, w->timeline, &w->device->gates);
}

static void follow_gate(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  gate_pulses *g = r->state;
  (void)w;
  vs_switching_gate_follow(&g->gate, c);
  if (g->gate.ended) vs_reducer_offer(r, (vs_value){true, g->peak_a, c->t0_s}, true);
  if (g->gate.begins) g->peak_a = 0;
  g->peak_a = fmax(g->peak_a, c->to[VS_OF_I]);
}

const vs_reducer vs_switching_reductions_gate_least = {
    .state_size = sizeof(gate_pulses), .prepare = prepare_gate, .follow = follow_gate};

/* ---- what the loss is made of ---- */

static void prepare_losses(vs_watched *w, vs_reduced *r) {
  (void)r;
  if (w->losses) return;
  w->losses = vs_alloc(1, sizeof *w->losses);
  vs_losses_begin(w->losses, w->device->kind->rectifies);
}

/* Takes a value that is known once the run is over. */
static void finish_value(vs_reduced *r, vs_value v, const vs_run_end *end) {
  r->value = v;
  bool passes = r->limit && v.known && v.value > r->limit->value;
  if (passes) r->failed_s = isnan(v.at_s) ? end->now_s : v.at_s;
}

static void finish_conduction(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  finish_value(r, (vs_value){true, w->losses->joule[VS_LOSS_CONDUCTION], NAN}, end);
}

static void finish_switching(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  const double *joule = w->losses->joule;
  finish_value(r, (vs_value){true, joule[VS_LOSS_ON] + joule[VS_LOSS_OFF], NAN}, end);
}

static void finish_recovery(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  finish_value(r, (vs_value){true, w->losses->joule[VS_LOSS_RECOVERY], NAN}, end);
}

static void finish_blocking(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  finish_value(r, (vs_value){true, w->losses->joule[VS_LOSS_BLOCKING], NAN}, end);
}

static void finish_e_on(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  finish_value(r, w->losses->largest[VS_LOSS_ON], end);
}

static void finish_e_off(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  finish_value(r, w->losses->largest[VS_LOSS_OFF], end);
}

static void finish_e_recovery(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  finish_value(r, w->losses->largest[VS_LOSS_RECOVERY], end);
}

/* ---- avalanche ---- */

/* The stretch above V_DSS: its energy so far. */
typedef struct avalanche {
  double v_dss_v, joule;
} avalanche;

static void prepare_avalanche(vs_watched *w, vs_reduced *r) {
  ((avalanche *)r->state)->v_dss_v = limit_of_part(w, "v_dss");
}

/* The part of a step, from 0 to 1, at which its straight voltage is at v. */
static double part_at(const vs_course_step *c, double v) {
  const double v0 = c->from[VS_OF_V], v1 = c->to[VS_OF_V];
  return fmin(fmax((v - v0) / (v1 - v0), 0), 1);
}

static void follow_avalanche(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  avalanche *a = r->state;
  const double v0 = c->from[VS_OF_V], v1 = c->to[VS_OF_V];
  (void)w;
  if (!(fmax(v0, v1) > a->v_dss_v)) { /* also without v_dss */
    a->joule = 0;
    return;
  }
  const double from = v0 < a->v_dss_v ? part_at(c, a->v_dss_v) : 0,
               to = v1 < a->v_dss_v ? part_at(c, a->v_dss_v) : 1;
  if (from > 0) a->joule = 0;
  a->joule += vs_losses_at(c, to) - vs_losses_at(c, from);
  vs_reducer_offer(r, (vs_value){true, a->joule, c->t0_s + to * c->h_s}, false);
}

static void finish_avalanche(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  (void)w;
  (void)end;
  r->idle = !r->value.known;
}

static void finish_turned_off(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  finish_value(r, w->losses->turned_off, end);
}

const vs_reducer
    vs_switching_reductions_conduction = {.prepare = prepare_losses, .finish = finish_conduction},
    vs_switching_reductions_switching = {.prepare = prepare_losses, .finish = finish_switching},
    vs_switching_reductions_recovery = {.prepare = prepare_losses, .finish = finish_recovery},
    vs_switching_reductions_blocking = {.prepare = prepare_losses, .finish = finish_blocking},
    vs_switching_reductions_e_on = {.prepare = prepare_losses, .finish = finish_e_on},
    vs_switching_reductions_e_off = {.prepare = prepare_losses, .finish = finish_e_off},
    vs_switching_reductions_e_recovery = {.prepare = prepare_losses, .finish = finish_e_recovery},
    vs_switching_reductions_turned_off = {.prepare = prepare_losses, .finish = finish_turned_off},
    vs_switching_reductions_avalanche = {.state_size = sizeof(avalanche),
                                         .prepare = prepare_avalanche,
                                         .follow = follow_avalanche,
                                         .finish = finish_avalanche};
