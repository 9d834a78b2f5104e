/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stress/told.h"

#include <math.h>

#include "base/text.h"

/* ---- news of a device that conducts or blocks ---- */

static void take_rise(vs_reduced *r, const vs_switch_news *news) {
  vs_reducer_offer(r, news->rise, vs_reducer_is_held_from_below(r));
}

static void take_off_rate(vs_reduced *r, const vs_switch_news *news) {
  vs_reducer_offer(r, news->off_rate, vs_reducer_is_held_from_below(r));
}

static void take_on_rate(vs_reduced *r, const vs_switch_news *news) {
  vs_reducer_offer(r, news->on_rate, vs_reducer_is_held_from_below(r));
}

/* The limit of the time offered is the part's t_q, by which a commutation failure is told. */
static void prepare_offered(vs_watched *w, vs_reduced *r) {
  if (w->states && r->limit) w->states->t_q_s = r->limit->value;
}

static void take_offered(vs_reduced *r, const vs_switch_news *news) {
  vs_reducer_offer(r, news->offered, vs_reducer_is_held_from_below(r));
  if (!news->offered.known || r->value.at_s != news->offered.at_s) return;
  r->doubt = news->doubt_s;
  r->spread = news->spread_s;
}

static void take_misfire(vs_reduced *r, const vs_switch_news *news) {
  vs_reducer_count(r, news->misfire.known, news->misfire.at_s);
}

static void take_unintended(vs_reduced *r, const vs_switch_news *news) {
  vs_reducer_count(r, news->unintended.known, news->unintended.at_s);
}

static void take_commutation_failure(vs_reduced *r, const vs_switch_news *news) {
  vs_reducer_count(r, news->commutation_failure, news->unintended.at_s);
}

static void take_return_rise(vs_reduced *r, const vs_switch_news *news) {
  vs_reducer_offer(r, news->return_rise, false);
}

static void take_fall(vs_reduced *r, const vs_switch_news *news) {
  vs_reducer_offer(r, news->fall, false);
}

const vs_reducer
    vs_told_rise = {.is_rate = true, .makes_fire = true, .take_news = take_rise},
    vs_told_off_rate = {.is_rate = true, .take_news = take_off_rate},
    vs_told_on_rate = {.is_rate = true, .hangs_on_sequence = true, .take_news = take_on_rate},
    vs_told_return_rise = {.is_rate = true,
                           .hangs_on_sequence = true,
                           .makes_fire = true,
                           .take_news = take_return_rise},
    vs_told_fall = {.is_rate = true, .hangs_on_sequence = true, .take_news = take_fall},
    vs_told_offered = {.hangs_on_sequence = true,
                       .makes_fire = true,
                       .prepare = prepare_offered,
                       .take_news = take_offered},
    vs_told_misfire = {.counts = true, .hangs_on_sequence = true, .take_news = take_misfire},
    vs_told_unintended = {.counts = true, .hangs_on_sequence = true, .take_news = take_unintended},
    vs_told_commutation_failure = {
        .counts = true, .hangs_on_sequence = true, .take_news = take_commutation_failure};

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

const vs_reducer vs_told_gate_least = {
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

static void finish_turned_off(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  finish_value(r, w->losses->turned_off, end);
}

const vs_reducer vs_told_conduction = {.prepare = prepare_losses, .finish = finish_conduction},
                 vs_told_switching = {.prepare = prepare_losses, .finish = finish_switching},
                 vs_told_recovery = {.prepare = prepare_losses, .finish = finish_recovery},
                 vs_told_blocking = {.prepare = prepare_losses, .finish = finish_blocking},
                 vs_told_e_on = {.prepare = prepare_losses, .finish = finish_e_on},
                 vs_told_e_off = {.prepare = prepare_losses, .finish = finish_e_off},
                 vs_told_e_recovery = {.prepare = prepare_losses, .finish = finish_e_recovery},
                 vs_told_turned_off = {.prepare = prepare_losses, .finish = finish_turned_off};
