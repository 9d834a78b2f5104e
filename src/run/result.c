/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/conduction.h"
#include "engine/pace.h"
#include "ngspice/self_test.h"

void vs_result_finish(vs_result *r) {
  /* The measures; and what an expected opening of a fuse has to pass is not judged. */
  vs_watchers_finish(&r->watchers, r->scene->setup.run.until_s, r->values);
  vs_expect_excuse(&r->scene->expects, r->watchers.devices);

  /* The verdict: a line for each rating of the deck and each limit of a device, and for each rating
   * of the scene. */
  vs_verdict_make(r->watchers.measures, r->watchers.devices, &r->scene->expects, &r->verdict);
  if (!r->watchers.measures ||
      !vs_pull_in_lacks(&r->watchers.measures->pull_in, r->watchers.measures->frame->model,
                        r->no_pull_in, sizeof r->no_pull_in))
    *r->no_pull_in = '\0';
  if (!r->watchers.measures ||
      !vs_pull_in_drops(&r->watchers.measures->pull_in, r->lets_go, sizeof r->lets_go))
    *r->lets_go = '\0';
  const vs_ratings_seen seen = {.values = r->values,
                                .watchers = &r->watchers,
                                .quality = r->quality,
                                .n_quality = r->n_quality,
                                .no_pull_in = r->no_pull_in,
                                .lets_go = r->lets_go,
                                .until_s = r->scene->setup.run.until_s};
  vs_ratings_judge(&r->scene->ratings, &seen, &r->verdict);
}

const char *vs_result_corner(const vs_corners *c, size_t k, char *text, size_t size) {
  size_t at = 0;
  *text = '\0';
  for (size_t n = 0; n < c->spread.count && at < size; n++) {
    const char *unit = c->spread.item[n].unit;
    at += (size_t)snprintf(text + at, size - at, "%s%s = %.6g%s%s", n ? ", " : "",
                           c->spread.item[n].key, vs_key_spread_at(&c->spread, n, k),
                           *unit ? " " : "", unit);
  }
  return text;
}

void vs_result_end_loop(vs_result *r) {
  if (r->loop) vs_loop_end(r->loop);
  free(r->loop);
  r->loop = NULL;
}

static void end_quality(vs_result *r) {
  for (int k = 0; k < r->n_quality; k++) vs_quality_end(&r->quality[k]);
  free(r->quality);
  r->quality = NULL;
  r->n_quality = 0;
}

void vs_result_begin_quality(vs_result *r, const vs_scene *s) {
  end_quality(r);
  if (!s->quality.count) return;
  r->quality = vs_alloc((size_t)s->quality.count, sizeof *r->quality);
  for (; r->n_quality < s->quality.count; r->n_quality++)
    vs_quality_begin(&r->quality[r->n_quality], &s->quality.item[r->n_quality], &s->setup);
}

void vs_result_free(vs_result *r) {
  vs_verdict_free(&r->verdict);
  vs_watchers_free(&r->watchers);
  vs_result_end_loop(r);
  free(r->meters);
  r->meters = NULL;
  end_quality(r);
  if (r->climbed) vs_scene_free(r->climbed);
  free(r->climbed);
  r->climbed = NULL;
}

/* ---- warnings ---- */

/* True: nothing has conducted, as far as the deck shows it. Its probe i_thyristor, from which the
 * firing is taken, and its devices that conduct or block can tell; without either it is false. */
static bool nothing_conducts(const vs_scene *s, const vs_result *r) {
  const vs_deck *deck = s->frame.deck;
  bool told = !deck || vs_channel_find(&s->frame, "i_thyristor") >= 0;
  if (r->values[VS_M_T_FIRE].known) return false;
  for (size_t k = 0; r->watchers.devices && k < r->watchers.devices->count; k++) {
    const vs_watched *w = &r->watchers.devices->item[k];
    const vs_switch *states = w->device->kind->gated ? w->states : NULL;
    told = told || states;
    if (states && !isnan(states->fired_s)) return false;
  }
  return told;
}

/* Where nothing conducts though firing is asked for, writes what is to be said of it. False:
 * nothing is to be said. */
static bool nothing_fires(const vs_result *r, char *text, size_t size) {
  const vs_scene *s = r->scene;
  if (s->setup.timeline.firing.no_valve || !nothing_conducts(s, r)) return false;
  const vs_timeline *t = &s->setup.timeline;
  const char *no_chance = vs_warnings_no_chance(&s->frame);
  double until_s = s->setup.run.until_s, first_s;
  /* without events pulses are alike: one whole pulse behind the run tells of all */
  double more_s = t->events.count ? 0 : (t->firing.first_cycle + t->firing.every + 1) * t->period_s;
  first_s = vs_warnings_first_chance(&s->setup, &s->frame, until_s + more_s);
  if (isnan(first_s)) return false;
  if (first_s < until_s)
    snprintf(text, size,
             "nothing fires: no thyristor is seen to conduct in this run (largest "
             "coil current: %.3g A), though a gate pulse meets forward mains voltage at %.9g s",
             r->values[VS_M_I_PEAK].value, first_s);
  else if (isfinite(first_s))
    snprintf(text, size,
             "nothing fires: %s before run.until = %.9g s; the first would do so at %.9g s",
             no_chance, until_s, first_s);
  else
    snprintf(text, size, "nothing fires: %s; look at firing.angle and firing.pulse_width",
             no_chance);
  return true;
}

/* Where the two runs of the scene have another sequence of firings, writes what is to be said of
 * it. False: nothing is to be said. */
static bool sequence_differs(const vs_result *r, char *text, size_t size) {
  char name[VS_JUDGED_NAME];
  int torn = 0;
  if (!*r->second.sequence) return false;
  int n = snprintf(text, size, "the sequence of firings depends on the tolerance: %s; ",
                   r->second.sequence);
  for (size_t k = 0; k < r->verdict.count && n < (int)size; k++)
    if (r->verdict.item[k].torn)
      n += snprintf(text + n, size - (size_t)n, "%s%s", torn++ ? ", " : "undecided for its sake: ",
                    vs_verdict_name(&r->verdict.item[k], name));
  if (n < (int)size)
    snprintf(text + n, size - (size_t)n,
             "%swhat else follows from it is known less well than run.tolerance says, and a finer "
             "one may settle it",
             torn ? "; " : "");
  return true;
}

/* Where the channel of an instrument was beyond its range, writes what is to be said of it. False:
 * nothing is to be said. */
static bool is_meter_beyond(const vs_meter *m, char *text, size_t size) {
  const vs_instrument *i = m->instrument;
  if (!m->beyond) return false;
  snprintf(
      text, size,
      "%s: %ld of %ld samples are of a channel beyond its range, first at %.6g s: it shows the "
      "range's end there",
      i->path, m->beyond, m->samples, m->beyond_s);
  return true;
}

/* Where load.fraction: auto is held at an end of its range, writes what is to be said of it. */
static bool fraction_is_held(const vs_result *r, char *text, size_t size) {
  const vs_setup *s = &r->scene->setup;
  const vs_load_range *range = &vs_model_load_range;
  double k = s->throw_coefficient;
  if (!vs_setup_found_fraction(s) || (k >= range->least_k && k <= range->most_k)) return false;
  snprintf(text, size,
           "load.fraction: auto is held at %g: the throw coefficient on the orbit, K = %.4g, is "
           "outside of the range that the paper states, %g to %g",
           s->model.riding, k, range->least_k, range->most_k);
  return true;
}

/* Where more than one share answers load.fraction: auto, writes what is to be said of it. */
static bool fraction_is_one_of_two(const vs_result *r, char *text, size_t size) {
  const vs_setup *s = &r->scene->setup;
  if (!vs_setup_found_fraction(s) || isnan(s->other_fraction)) return false;
  snprintf(text, size,
           "load.fraction: auto is %.6g, and %.6g would do as well: each rides where the trough "
           "throws as it does with it; a number at load.fraction decides",
           s->model.riding, s->other_fraction);
  return true;
}

/* A run with a thyristor of two transistors took 4 times as many steps as the largest step asks
 * for, those that crawled 39 times and more (tests/cli/test_hints.c). A short run is no trouble,
 * however it went. */
static const double CRAWLS = 20;
static const long FEW_STEPS = 20000;

bool vs_result_steps_are_short(const vs_result *r, char *text, size_t size) {
  const vs_setup *s = &r->scene->setup;
  double solved_s = s->run.until_s - r->watchers.absence.total_s;
  double asked = solved_s / vs_pace_largest_step(s);
  const bool direct = s->timeline.supply.direct; /* edges of a carrier ask for steps of their own */
  if (direct || !r->scene->tier->by_ngspice || s->run.gear || r->steps < FEW_STEPS) return false;
  if ((double)r->steps < CRAWLS * asked) return false;
  snprintf(text, size,
           "%ld steps, %.3g in a cycle of the mains, where the mains and run.tolerance ask for "
           "%.3g: 'vibrospice check --deep %.300s' tries run.method: gear",
           r->steps, (double)r->steps / solved_s * s->timeline.period_s,
           asked / solved_s * s->timeline.period_s, r->scene->path);
  return true;
}

static void warn_of_signs(const vs_result *r, void (*each)(void *ctx, const char *text),
                          void *ctx) {
  const vs_devices *d = r->watchers.devices;
  char text[VS_DECK_TEXT];
  for (size_t k = 0; d && k < d->count; k++)
    if (vs_devices_sign_is_wrong(&d->item[k], vs_energy_whole(&r->watchers.energy), text,
                                 sizeof text))
      each(ctx, text);
}

static void warn_of_unknown(const vs_result *r, void (*each)(void *ctx, const char *text),
                            void *ctx) {
  char text[VS_DECK_TEXT + VS_JUDGED_NAME], name[VS_JUDGED_NAME];
  for (size_t k = 0; k < r->verdict.count; k++) {
    const vs_judgement *j = &r->verdict.item[k];
    if (!j->unknown || j->waived) continue;
    snprintf(text, sizeof text, "ratings: %s has no value, as %s; its line is undecided",
             vs_verdict_name(j, name), j->unknown);
    each(ctx, text);
  }
}

/* An error of up to so many times run.tolerance needs no warning (docs/accuracy.md). */
static const double PROMISED = 2.4;

/* A thyristor of transistors lets go this part of run.tolerance of its turn-off time early or late:
 * 2.5 ns of 110 us at 1e-4. The charge of its base is off by that from before, so that shorter
 * steps at the end of its gate's pulse took nothing off it. */
static const double LETS_GO = 0.25;

/* True: the coil got so little that this instant may be an error of it beyond what is promised. The
 * mains' peak over that time is one of the flux linkage, which the most of the current stands for.
 */
static bool hangs_on_letting_go(const vs_result *r, char *text, size_t size) {
  const vs_devices *d = r->watchers.devices;
  const vs_setup *s = &r->scene->setup;
  double flux_wb = fabs(r->values[VS_M_I_PEAK].value) * s->model.coil.rest_h;
  if (!r->values[VS_M_I_PEAK].known) return false;
  for (size_t k = 0; d && k < d->count; k++) {
    const vs_watched *i = &d->item[k];
    double t_q_s = vs_conduction_turn_off(&s->deck, i->device);
    if (!i->sequence.edge || LETS_GO * t_q_s * s->timeline.peak_v <= PROMISED * flux_wb) continue;
    snprintf(text, size,
             "i and force, and p, u, w and phi by them, may be off by more than run.tolerance: the "
             "coil got %.3g A at most, and some nanoseconds of when %s lets go count in that",
             fabs(r->values[VS_M_I_PEAK].value), i->device->name);
    return true;
  }
  return false;
}

/* True: the flux linkage was larger than the iron is known to be linear for, and the law has no
 * saturation. */
static bool leaves_linear_iron(const vs_result *r, char *text, size_t size) {
  const vs_actuator_values *a = &r->scene->setup.model.actuator;
  const double most_wb = a->linear_to_wb, flux_wb = r->watchers.flux_wb;
  if (a->saturation.present || !(flux_wb > most_wb)) return false;
  snprintf(text, size,
           "the flux linkage reaches %.4g Wb, and the iron is known to be linear up to %.4g Wb "
           "(actuator.linear_to): the current beyond is too small; give actuator.saturation",
           flux_wb, most_wb);
  return true;
}

/* True: the winding became hotter than any bears. */
static bool burns(const vs_result *r, char *text, size_t size) {
  const vs_watchers *w = &r->watchers;
  if (!r->values[VS_M_COIL_T].known || isnan(w->burnt_s)) return false;
  snprintf(text, size,
           "the winding runs away, or is driven too hard: it passes %d degC at %.4g s and reaches "
           "%.4g degC; look at actuator.winding, or drive less",
           VS_WINDING_BURNT_DEGC, w->burnt_s, w->hottest_degc);
  return true;
}

/* True: the winding became so much warmer or colder that its resistance, which this run kept, would
 * be another. */
static bool warms_up(const vs_result *r, char *text, size_t size) {
  static const double MUCH = 0.01;
  const vs_model *m = &r->scene->setup.model;
  const vs_winding_values *w = &m->actuator.winding;
  const double from_degc = m->coil.heat.winding_degc, hot_degc = r->watchers.hottest_degc,
               cold_degc = r->watchers.heat.winding_degc;
  const double to_degc = hot_degc - from_degc > from_degc - cold_degc ? hot_degc : cold_degc;
  const double more = vs_winding_ohm(w, m->coil.cold_ohm, to_degc) / m->coil.resistance_ohm - 1;
  if (r->watchers.warming.model) {
    snprintf(text, size,
             "the winding's resistance changes by up to %.2g %% while current flows, and the run "
             "keeps it from one firing to the next",
             100 * r->watchers.lag);
    return r->watchers.lag > MUCH;
  }
  if (!w->present || !r->values[VS_M_COIL_T].known || !(fabs(more) > MUCH)) return false;
  snprintf(
      text, size,
      "the winding goes from %.4g to %.4g degC, where its resistance is %.2g %% %s, and the "
      "run keeps that of the beginning: give actuator.winding.temperature, take `steady`, or an "
      "ideal tier, whose resistance follows from firing to firing",
      from_degc, to_degc, 100 * fabs(more), more > 0 ? "larger" : "smaller");
  return true;
}

/* Where the scene has no rating of pull_in, the verdict may hold all the same. */
static void warn_of_no_pull_in(const vs_result *r, void (*each)(void *ctx, const char *text),
                               void *ctx) {
  const vs_ratings *own = &r->scene->ratings;
  char text[sizeof r->no_pull_in + 80];
  bool rated = false;
  for (int k = 0; k < own->count; k++) rated = rated || !strcmp(own->item[k].name, "pull_in");
  snprintf(text, sizeof text, "%s%s", r->no_pull_in,
           rated ? "" : "; the verdict judges it by a rating, as ratings: {pull_in: .. 20 ms}");
  if (*r->no_pull_in) each(ctx, text);
}

/* The warnings that are known only once the run is over; of_firing: that nothing fires, too. */
static void warn_after(const vs_result *r, bool of_firing,
                       void (*each)(void *ctx, const char *text), void *ctx) {
  char text[VS_DECK_TEXT + sizeof r->second.failed];
  if (of_firing && nothing_fires(r, text, sizeof text)) each(ctx, text);
  if (sequence_differs(r, text, sizeof text)) each(ctx, text);
  if (*r->second.unsure) {
    snprintf(text, sizeof text,
             "a signal's extreme hangs on the steps: %s; a finer run.tolerance, or a capacitance "
             "beside the switch, may settle it",
             r->second.unsure);
    each(ctx, text);
  }
  if (hangs_on_letting_go(r, text, sizeof text)) each(ctx, text);
  warn_of_no_pull_in(r, each, ctx);
  if (*r->lets_go) each(ctx, r->lets_go);
  if (leaves_linear_iron(r, text, sizeof text)) each(ctx, text);
  if (burns(r, text, sizeof text)) each(ctx, text);
  if (warms_up(r, text, sizeof text)) each(ctx, text);
  const vs_devices *devices = r->watchers.devices;
  for (size_t k = 0; devices && k < devices->count; k++)
    if (vs_devices_fails_to_clear(devices, k, text, sizeof text)) each(ctx, text);
  if (r->watchers.strays > PROMISED && r->scene->setup.run.gear) {
    snprintf(text, sizeof text,
             "p, u, w, phi, i and force may be off by %.2g times run.tolerance: the coil rings for "
             "long, and run.method: gear makes an error of its phase; run.method: trap follows it",
             r->watchers.strays);
    each(ctx, text);
  } else if (r->watchers.strays > PROMISED)
    each(ctx, "p, u, w, phi, i and force may be off by more than run.tolerance: a thyristor's "
              "voltage is back within its turn-off time, and what charge is left in it decides "
              "whether and when it fires again");
  warn_of_unknown(r, each, ctx);
  if (fraction_is_held(r, text, sizeof text)) each(ctx, text);
  if (fraction_is_one_of_two(r, text, sizeof text)) each(ctx, text);
  if (*r->books) each(ctx, r->books);
  if (r->watchers.measures && vs_measures_are_sharp(r->watchers.measures, text, sizeof text))
    each(ctx, text);
  warn_of_signs(r, each, ctx);
  for (int k = 0; r->meters && k < r->scene->instruments.count; k++)
    if (is_meter_beyond(&r->meters[k], text, sizeof text)) each(ctx, text);
  for (int k = 0; k < r->n_quality; k++)
    if (vs_quality_warning(&r->quality[k], &r->scene->setup, text, sizeof text)) each(ctx, text);
  if (!*r->second.failed) return;
  snprintf(text, sizeof text, "no margin's error is known, as the second run %s: %s",
           r->second.stopped ? "was stopped" : "failed", r->second.failed);
  each(ctx, text);
}

const char *vs_result_declined(const vs_result *r) {
  const vs_scene *s = r->scene;
  if (s->tier->by_ngspice && r->loop && !s->setup.run.stays)
    return "a control decides the firings, so that the next one is not known";
  if (!s->tier->by_ngspice || s->setup.run.stays) return NULL;
  return vs_sim_why_stays(&s->order, &s->setup);
}

void vs_result_warnings(const vs_result *r, void (*each)(void *ctx, const char *text), void *ctx) {
  char text[VS_DECK_TEXT + sizeof r->ladder.failed];
  const vs_scene *s = r->scene;
  for (size_t k = 0; k < s->warnings.count; k++) each(ctx, vs_warnings_text(&s->warnings.item[k]));
  if (r->ladder.rung) {
    snprintf(text, sizeof text, "got on rung %d of the ladder, %s; before, %s", r->ladder.rung,
             vs_ladder_text(r->ladder.rung), r->ladder.failed);
    each(ctx, text);
  }
  if (s->tier->by_ngspice && *vs_self_test_text()) each(ctx, vs_self_test_text());
  warn_after(r, true, each, ctx);
}

static void print_warning_of_result(void *ctx, const char *text) {
  (void)ctx;
  fprintf(stderr, "vibrospice: warning: %s\n", text);
}

void vs_result_warn(const vs_result *r) {
  bool whole_cycle = r->scene->setup.run.until_s >= r->scene->setup.timeline.period_s;
  warn_after(r, whole_cycle, print_warning_of_result, NULL);
}
