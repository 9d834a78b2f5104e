/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/summary.h"

#include <math.h>
#include <stdio.h>

#include "base/units.h"
#include "engine/tiers.h"
#include "measure/lowpass.h"
#include "measure/unjudged.h"
#include "run/causes.h"
#include "run/listed_measure.h"
#include "run/sections.h"
#include "run/table.h"
#include "run/version.h"

enum {
  DIGITS = 12,
  POLE_DIGITS = 6 /* those of an observer follow from eigenvalues, whose last digits are rounding */
};

static void add_event_to_summary(vs_json *json, const vs_scene_event *e, bool built) {
  vs_json_object(json, e->name, VS_JSON_ROW);
  vs_json_number(json, "starts_s", e->start_s, DIGITS);
  if (!built) vs_json_bool(json, "built", false);
  for (size_t f = 0; f < e->kind->n_fields; f++) {
    vs_json_key(json, e->kind->fields[f].key);
    vs_field_json(&e->kind->fields[f], &e->v, json->text);
  }
  vs_json_end(json);
}

/* Each with its keys, and when it begins; those that are not built last. */
static void add_events_to_summary(vs_json *json, const vs_events *events) {
  bool any = events->count || events->n_unbuilt;
  vs_json_object(json, "events", any ? VS_JSON_LINES : VS_JSON_ROW);
  for (size_t k = 0; k < events->count; k++) add_event_to_summary(json, &events->item[k], true);
  for (size_t k = 0; k < events->n_unbuilt; k++)
    add_event_to_summary(json, &events->unbuilt[k], false);
  vs_json_end(json);
}

/* What generators have on the line, and since when. */
static void add_on_line(vs_json *json, const vs_scene *s) {
  const vs_events *events = &s->setup.timeline.events;
  char network[VS_DECK_TEXT];
  bool any = false;
  for (size_t k = 0; k < events->count; k++) {
    const vs_scene_event *e = &events->item[k];
    if (!vs_scene_event_network(e, network, sizeof network)) continue;
    if (!any) vs_json_array(json, "on_line", VS_JSON_LINES);
    any = true;
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_json_text(json, "event", e->name);
    vs_json_text(json, "kind", e->kind->name);
    vs_json_number(json, "from_s", e->on_line_s, DIGITS);
    vs_json_text(json, "network", network);
    if (e->v.times > 1) vs_json_whole(json, "times", e->v.times);
    if (e->v.times > 1) vs_json_number(json, "every_s", e->v.every_s, DIGITS);
    vs_json_end(json);
  }
  if (any) vs_json_end(json);
}

/* The keys of the set, then each instrument with its keys and with what it makes of a sine of the
 * frequency at which the machine works. */
static void add_instruments_to_summary(vs_json *json, const vs_instruments *all,
                                       double frequency_hz) {
  const vs_section *common = &vs_instruments_section;
  if (!all->count) return;
  vs_json_object(json, common->name, VS_JSON_LINES);
  for (size_t f = 0; f < common->count; f++) {
    vs_json_key(json, common->fields[f].key);
    vs_field_json(&common->fields[f], &all->v, json->text);
  }
  for (int k = 0; k < all->count; k++) {
    const vs_instrument *i = &all->item[k];
    const vs_lowpass p = vs_lowpass_make(i->v.bandwidth_hz, i->v.order, i->v.damping);
    double gain, phase_rad;
    vs_lowpass_response(&p, frequency_hz, &gain, &phase_rad);
    vs_json_object(json, i->name, VS_JSON_ROW);
    for (size_t f = 0; f < i->section.count; f++) {
      vs_json_key(json, i->section.fields[f].key);
      vs_field_json(&i->section.fields[f], &i->v, json->text);
    }
    vs_json_number(json, "at_hz", frequency_hz, DIGITS);
    vs_json_number(json, "gain", gain, DIGITS);
    vs_json_number(json, "phase_deg", phase_rad / vs_units_factor("deg"), DIGITS);
    vs_json_end(json);
  }
  vs_json_end(json);
}

/* Its keys, what it measures with, and the poles that its error has. */
static void add_observing(vs_json *json, const vs_state_observer *o) {
  vs_json_object(json, "observer", VS_JSON_ROW);
  for (size_t k = 0; k < vs_state_observer_section.count; k++) {
    vs_json_key(json, vs_state_observer_section.fields[k].key);
    vs_field_json(&vs_state_observer_section.fields[k], &o->v, json->text);
  }
  vs_json_array(json, "sensors", VS_JSON_ROW);
  for (int k = 0; k < o->system->sensors; k++)
    vs_json_text(json, NULL, o->system->sensor[k].instrument->name);
  vs_json_end(json);
  vs_json_array(json, "poles", VS_JSON_ROW);
  for (int k = 0; k < o->system->states; k++) {
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_json_number(json, "re_1_s", o->pole[k].re_1_s, POLE_DIGITS);
    vs_json_number(json, "im_rad_s", o->pole[k].im_rad_s, POLE_DIGITS);
    vs_json_end(json);
  }
  vs_json_end(json);
  vs_json_number(json, "settling_s", o->settling_s, POLE_DIGITS);
  vs_json_end(json);
}

static void add_control_to_summary(vs_json *json, const vs_control *c) {
  if (!c->regulator) return;
  vs_json_object(json, c->section.name, VS_JSON_LINES);
  for (size_t k = 0; k < c->section.count; k++) {
    vs_json_key(json, c->section.fields[k].key);
    vs_field_json(&c->section.fields[k], &c->v, json->text);
  }
  if (c->observing.system) add_observing(json, &c->observing);
  vs_json_end(json);
}

void vs_summary_scene(vs_json *json, const vs_scene *s) {
  vs_json_object(json, "scene", VS_JSON_LINES);
  for (int p = 0; p < VS_SECTIONS; p++) {
    if (!vs_section_counts(&s->setup, p)) continue;
    vs_filled_section part = vs_section_at(&s->setup, p);
    vs_json_object(json, part.section->name, VS_JSON_LINES);
    for (size_t k = 0; k < part.section->count; k++) {
      if (vs_field_is_idle(&part.section->fields[k], part.values)) continue;
      vs_json_key(json, part.section->fields[k].key);
      vs_field_json(&part.section->fields[k], part.values, json->text);
    }
    vs_json_end(json);
  }
  if (s->setup.steady) vs_json_bool(json, "steady", true);
  add_events_to_summary(json, &s->setup.timeline.events);
  add_instruments_to_summary(json, &s->instruments, vs_instruments_working_hz(&s->setup));
  add_control_to_summary(json, &s->control);
  vs_ratings_json(&s->ratings, json);
  vs_cooling_json(&s->setup.cooling, &s->setup.deck, json);
  vs_json_end(json);
}

void vs_summary_measure(vs_json *json, const char *name, vs_value v, const char *unit) {
  vs_json_object(json, name, VS_JSON_ROW);
  vs_json_number(json, "value", v.value, DIGITS);
  vs_json_text(json, "unit", unit);
  if (!isnan(v.at_s)) vs_json_number(json, "at_s", v.at_s, DIGITS);
  vs_json_end(json);
}

/* "over": {"value": 120, "unit": "V"}: how far the stretch rises that a rate is the mean of. */
static void add_over(vs_json *json, double over_v) {
  if (!(over_v > 0)) return;
  vs_json_object(json, "over", VS_JSON_ROW);
  vs_json_number(json, "value", over_v, DIGITS);
  vs_json_text(json, "unit", "V");
  vs_json_end(json);
}

static void add_measures_to_summary(vs_json *json, const vs_scene *s, const vs_result *r,
                                    const vs_summary_more *more) {
  vs_listed_measure m;
  int standard = vs_measures_count(&s->setup.model);
  vs_json_object(json, "measures", VS_JSON_LINES);
  for (int k = 0; vs_listed_measure_at(&s->frame, r, k, &m); k++) {
    if (!m.value.known) continue;
    vs_json_object(json, m.name, VS_JSON_ROW);
    vs_json_number(json, "value", m.value.value, DIGITS);
    vs_json_text(json, "unit", m.unit);
    if (!isnan(m.value.at_s)) vs_json_number(json, "at_s", m.value.at_s, DIGITS);
    if (k < standard && s->measured[k].known)
      vs_json_number(json, "measured", s->measured[k].value, DIGITS);
    add_over(json, m.over_v);
    if (m.unjudged) vs_json_text(json, "unjudged", m.unjudged);
    vs_json_end(json);
  }
  if (more && more->measures) more->measures(more->ctx, json);
  vs_json_end(json);
}

void vs_summary_limit(vs_json *json, int worst, double part) {
  if (isnan(part)) {
    vs_json_number(json, "held", NAN, DIGITS); /* null */
    vs_json_number(json, "worst", NAN, DIGITS);
  } else {
    vs_json_bool(json, "held", part <= 1);
    vs_json_whole(json, "worst", worst);
  }
  vs_json_number(json, "worst_part", part, DIGITS);
}

void vs_summary_groups(vs_json *json, const char *key, const vs_spectrum *s) {
  if (!s->grouping.told) return;
  vs_json_array(json, key, VS_JSON_ROW);
  vs_json_number(json, NULL, NAN, DIGITS); /* there is no group of the direct part */
  for (int n = 1; n < VS_SPECTRUM_LINES; n++)
    vs_json_number(json, NULL, vs_spectrum_judged(s, n), DIGITS);
  vs_json_end(json);
  vs_json_object(json, "windows", VS_JSON_ROW);
  vs_json_whole(json, "number", vs_spectrum_windows(s));
  vs_json_whole(json, "cycles", s->grouping.each);
  vs_json_end(json);
}

/* What limits each class of apparatus sets for the current. */
static void add_limits_to_summary(vs_json *json, const vs_drawn_current *drawn) {
  vs_json_array(json, "classes", VS_JSON_LINES);
  for (const vs_harmonic_class *c = vs_harmonic_classes_all; c->name; c++) {
    double part;
    int worst = vs_harmonic_classes_worst(c, drawn, &part);
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_json_text(json, "class", c->name);
    vs_json_text(json, "text", c->text);
    vs_json_text(json, "source", c->source);
    vs_summary_limit(json, worst, part);
    vs_json_array(json, "limits_A", VS_JSON_ROW);
    for (int n = 0; n < VS_SPECTRUM_LINES; n++)
      vs_json_number(json, NULL, c->limit(drawn, n), DIGITS);
    vs_json_end(json);
    vs_json_end(json);
  }
  vs_json_end(json);
}

/* The quality of the currents that the scene names; their scalars are measures. */
static void add_quality(vs_json *json, const vs_result *r) {
  if (!r->n_quality) return;
  vs_json_object(json, "quality", VS_JSON_LINES);
  for (int k = 0; k < r->n_quality; k++) {
    const vs_quality *q = &r->quality[k];
    const vs_drawn_current drawn = vs_quality_drawn(q);
    vs_json_object(json, q->name, VS_JSON_LINES);
    vs_json_whole(json, "cycles", q->cycles);
    vs_json_array(json, "harmonics_A", VS_JSON_ROW);
    for (int n = 0; n < VS_SPECTRUM_LINES; n++)
      vs_json_number(json, NULL, vs_spectrum_harmonic(&q->current, n), DIGITS);
    vs_json_end(json);
    vs_summary_groups(json, "groups_A", &q->current);
    vs_json_array(json, "phases_deg", VS_JSON_ROW);
    for (int n = 0; n < VS_SPECTRUM_LINES; n++)
      vs_json_number(json, NULL, vs_quality_phase(q, n) / vs_units_factor("deg"), DIGITS);
    vs_json_end(json);
    add_limits_to_summary(json, &drawn);
    vs_json_end(json);
  }
  vs_json_end(json);
}

/* What load.fraction: auto came to. */
static void add_fraction(vs_json *json, const vs_scene *scene) {
  const vs_setup *s = &scene->setup;
  if (!vs_setup_found_fraction(s)) return;
  vs_json_object(json, "load_fraction", VS_JSON_ROW);
  vs_json_number(json, "value", s->model.riding, DIGITS);
  vs_json_number(json, "throw_coefficient", s->throw_coefficient, DIGITS);
  vs_json_text(json, "from", "empirical: the paper's range, below Eq. 88, on the scene's orbit");
  vs_json_text(json, "orbit_tier", vs_tiers_of_orbit(scene->tier)->name);
  vs_json_bool(json, "held",
               vs_model_load_range.least_k > s->throw_coefficient ||
                   vs_model_load_range.most_k < s->throw_coefficient);
  if (!isnan(s->other_fraction)) vs_json_number(json, "other", s->other_fraction, DIGITS);
  if (s->other_on_ideal) vs_json_bool(json, "other_on_ideal_tier_alone", true);
  vs_json_end(json);
}

/* A member whose name is `name` and an ending. */
static void add_joined(vs_json *json, const char *name, const char *ending, double value) {
  char key[VS_NAME_SIZE];
  snprintf(key, sizeof key, "%s%s", name, ending);
  vs_json_number(json, key, value, DIGITS);
}

/* {"r1": 0.0655, ...}: the deck's own accounts, J */
static void add_accounts_to_summary(vs_json *json, const char *key, const vs_accounts *accounts,
                                    const double *joule) {
  vs_json_object(json, key, VS_JSON_ROW);
  for (size_t k = 0; k < accounts->count; k++)
    vs_json_number(json, accounts->item[k].name, joule[k], DIGITS);
  vs_json_end(json);
}

static void add_energy_to_summary(vs_json *json, const vs_scene *s, const vs_energy *e,
                                  const char *books) {
  vs_json_object(json, "energy", VS_JSON_ROW);
  for (int k = 0; k < VS_ENERGIES; k++)
    if (vs_energy_has(s->frame.model, k)) add_joined(json, vs_energy_names[k], "_J", e->joule[k]);
  if (s->frame.deck) {
    add_accounts_to_summary(json, "losses_J", &s->frame.deck->losses, e->loss_j);
    add_accounts_to_summary(json, "stores_J", &s->frame.deck->stores, e->store_j);
  }
  if (s->frame.gap_at_rest) vs_json_number(json, "unsupplied_J", e->joule[VS_E_WORK], DIGITS);
  for (int b = 0; b < VS_BALANCES; b++)
    add_joined(json, vs_energy_balance_names[b], "_residual",
               e->balanced[b] ? e->residual[b] : NAN);
  vs_json_number(json, "residual", e->worst, DIGITS);
  vs_json_text(json, "audit", *books ? books : "the books close");
  vs_json_end(json);
}

static void add_extreme_to_summary(vs_json *json, const char *name, vs_value v, double unit) {
  vs_json_number(json, name, v.value / unit, DIGITS);
  add_joined(json, name, "_at_s", v.at_s);
}

static void add_rating(vs_json *json, const vs_judgement *j) {
  double unit = vs_units_factor(j->rating->unit);
  char name[VS_JUDGED_NAME];
  vs_json_text(json, "rating", vs_verdict_name(j, name));
  if (j->name) vs_json_text(json, "of", "scene");
  vs_json_text(json, "unit", j->rating->unit);
  vs_json_text(json, "text", j->rating->text);
  vs_json_number(json, "min", j->rating->min / unit, DIGITS);
  vs_json_number(json, "max", j->rating->max / unit, DIGITS);
  add_extreme_to_summary(json, "least", j->least, unit);
  add_extreme_to_summary(json, "largest", j->largest, unit);
  vs_json_bool(json, "assumed", j->unsure & VS_ASSUMED);
  if (j->unsure & VS_TYPICAL) vs_json_bool(json, "typical", true);
  if (j->unknown) vs_json_text(json, "unknown", j->unknown);
}

static void add_device_to_summary(vs_json *json, const vs_judgement *j) {
  double unit = vs_units_factor(vs_verdict_unit(j));
  char why[2 * VS_DECK_NAME + 16];
  vs_json_text(json, "device", j->device->name);
  vs_json_text(json, "measure", j->measure->name);
  vs_json_text(json, "unit", vs_verdict_unit(j));
  vs_json_text(json, "text", j->limit ? j->limit->text : "");
  vs_json_number(json, "stress", j->stress.value / unit, DIGITS);
  vs_json_number(json, "at_s", j->stress.at_s, DIGITS);
  vs_json_number(json, "limit", j->limit ? j->limit->value / unit : NAN, DIGITS);
  if (j->lacks) vs_json_text(json, "unknown", vs_verdict_unknown(j, why, sizeof why));
  add_over(json, j->over_v);
  if (!isnan(j->over_from_s)) vs_json_number(json, "over_from_s", j->over_from_s, DIGITS);
  if (j->ward) vs_json_text(json, "limit_of", j->ward->name);
  vs_json_bool(json, "assumed", j->unsure & VS_ASSUMED);
  if (j->unsure & VS_TYPICAL) vs_json_bool(json, "typical", true);
}

/* How far the models that the line hangs on are from their data sheets, as a part of the sheet's
 * figure. Nothing where no part says so. */
static void add_models(vs_json *json, const vs_judgement *j) {
  char name[2 * VS_DECK_NAME];
  if (!j->n_models) return;
  vs_json_object(json, "model_deviation", VS_JSON_ROW);
  for (size_t k = 0; k < j->n_models; k++)
    vs_json_number(json, vs_verdict_model_name(&j->model[k], name), j->model[k].line->deviation,
                   DIGITS);
  vs_json_end(json);
}

static void add_judged(vs_json *json, const char *key, const vs_judgement *j) {
  char name[VS_JUDGED_NAME];
  vs_json_text(json, key, j ? vs_verdict_name(j, name) : NULL);
}

static void add_verdict_to_summary(vs_json *json, const vs_verdict *v, const vs_causes *causes) {
  vs_json_array(json, "verdict", v->count ? VS_JSON_LINES : VS_JSON_ROW);
  for (size_t k = 0; k < v->count; k++) {
    const vs_judgement *j = &v->item[k];
    vs_json_object(json, NULL, VS_JSON_ROW);
    if (j->device)
      add_device_to_summary(json, j);
    else
      add_rating(json, j);
    vs_json_number(json, "margin", j->margin, DIGITS);
    vs_json_number(json, "margin_error", j->margin_error, DIGITS);
    add_models(json, j);
    vs_json_text(json, "word", vs_verdict_words[vs_verdict_word(j)]);
    if (j->torn) vs_json_text(json, "why", "the sequence of firings depends on the tolerance");
    vs_json_bool(json, "violated", j->margin < 0 && !j->waived);
    vs_json_number(json, "failed_at_s", j->failed_s, DIGITS);
    vs_causes_json(causes, j, json);
    vs_json_end(json);
  }
  vs_json_end(json);
  add_judged(json, "weakest", v->weakest);
  add_judged(json, "first_to_fail", v->first_to_fail);
}

/* What happened, and what did not though it was expected. */
static void add_happenings_to_summary(vs_json *json, const vs_verdict *v) {
  for (int happened = 1; happened >= 0; happened--) {
    vs_json_array(json, happened ? "happened" : "did_not_happen", VS_JSON_ROW);
    for (size_t k = 0; k < v->count; k++) {
      const vs_judgement *j = &v->item[k];
      if (!vs_verdict_is_happening(j) || (j->stress.value > 0) != happened) continue;
      vs_json_object(json, NULL, VS_JSON_ROW);
      vs_json_text(json, "what", vs_kinds_happening(j->measure)->what);
      vs_json_text(json, "device", j->device->name);
      if (happened) {
        vs_json_number(json, "at_s", j->stress.at_s, DIGITS);
        vs_json_whole(json, "times", (int)j->stress.value);
        vs_json_text(json, "cause", j->cause);
      }
      vs_json_bool(json, "expected", j->expected);
      vs_json_text(json, "word", vs_verdict_words[vs_verdict_word(j)]);
      vs_json_end(json);
    }
    vs_json_end(json);
  }
}

/* What the verdict leaves out: by itself, and by the scene's key waive. */
static void add_not_judged_to_summary(vs_json *json, const vs_result *r) {
  const vs_expects *expects = &r->scene->expects;
  vs_unjudged entry;
  vs_json_array(json, "not_judged", VS_JSON_ROW);
  for (size_t k = 0; vs_unjudged_at(r->watchers.devices, &r->verdict, k, &entry); k++)
    vs_json_text(json, NULL, entry.name);
  vs_json_end(json);
  vs_json_array(json, "waived", VS_JSON_ROW);
  for (size_t k = 0; k < expects->n_waivers; k++) {
    char name[2 * VS_DECK_NAME];
    vs_json_text(json, NULL, vs_expect_waiver_name(&expects->waiver[k], name));
  }
  vs_json_end(json);
}

/* What each column of run.csv is. */
static void add_columns(vs_json *json, const vs_scene *s) {
  const vs_table table = vs_table_of(s);
  vs_column column;
  vs_json_array(json, "columns", VS_JSON_LINES);
  for (int k = 0; vs_table_column_at(&table, k, &column); k++) {
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_channel_column_json(&column, json);
    vs_json_end(json);
  }
  vs_json_end(json);
}

/* Adds corner number k: where it is, and its worst line or why it failed. */
static void add_corner_to_summary(vs_json *json, const char *name, const vs_corners *c, size_t k) {
  const vs_corner *one = &c->item[k];
  vs_json_object(json, name, VS_JSON_ROW);
  vs_json_object(json, "at", VS_JSON_ROW);
  for (size_t n = 0; n < c->spread.count; n++) {
    vs_json_object(json, c->spread.item[n].key, VS_JSON_ROW);
    vs_json_number(json, "value", vs_key_spread_at(&c->spread, n, k), DIGITS);
    vs_json_text(json, "unit", c->spread.item[n].unit);
    vs_json_end(json);
  }
  vs_json_end(json);
  vs_json_text(json, "line", *one->line ? one->line : NULL);
  vs_json_number(json, "margin", one->margin, DIGITS);
  vs_json_number(json, "margin_error", one->error, DIGITS);
  vs_json_text(json, "word", *one->line ? vs_verdict_words[one->word] : NULL);
  if (*one->note) vs_json_text(json, "note", one->note);
  if (*one->failed) vs_json_text(json, "failed", one->failed);
  vs_json_end(json);
}

/* What was varied: nothing (null), or the corners. */
static void add_corners(vs_json *json, const vs_corners *c) {
  if (!c) {
    vs_json_text(json, "corners", NULL);
    return;
  }
  vs_json_object(json, "corners", VS_JSON_LINES);
  vs_json_whole(json, "of", (int)c->count);
  vs_json_whole(json, "held", (int)c->held);
  vs_json_whole(json, "failed", (int)c->failed);
  if (c->worst < c->count)
    add_corner_to_summary(json, "worst", c, c->worst);
  else
    vs_json_text(json, "worst", NULL);
  vs_json_array(json, "each", VS_JSON_LINES);
  for (size_t k = 0; k < c->count; k++) add_corner_to_summary(json, NULL, c, k);
  vs_json_end(json);
  vs_json_end(json);
}

static void add_warning_to_summary(void *ctx, const char *text) {
  vs_json_text(ctx, NULL, text);
}

static void add_rung(vs_json *json, const vs_ladder *ladder) {
  vs_json_object(json, "rung", VS_JSON_ROW);
  vs_json_whole(json, "number", ladder->rung);
  vs_json_text(json, "text", vs_ladder_text(ladder->rung));
  vs_json_text(json, "failed", ladder->failed);
  vs_json_end(json);
}

static void add_quiet(vs_json *json, const vs_result *r) {
  const vs_absence *absence = &r->watchers.absence;
  const char *declined = vs_result_declined(r);
  vs_json_object(json, "quiet", VS_JSON_ROW);
  vs_json_whole(json, "times", absence->times);
  vs_json_number(json, "first_at_s", absence->times ? absence->first_s : NAN, DIGITS);
  vs_json_number(json, "total_s", absence->total_s, DIGITS);
  vs_json_number(json, "bound", absence->bound, DIGITS);
  if (declined) vs_json_text(json, "declined", declined);
  vs_json_end(json);
}

/* How far the observer's estimates were from the true motion, in their units. */
static void add_estimates(vs_json *json, const vs_result *r) {
  const vs_state_observer *o = &r->scene->control.observing;
  if (!r->loop || !o->system) return;
  const vs_estimator_errors *e = &r->loop->estimator.errors;
  vs_json_object(json, "estimates", VS_JSON_LINES);
  for (int k = 0; k < o->estimates; k++) {
    double settled = e->after ? e->settled[k] : NAN;
    vs_json_object(json, o->estimate[k].column, VS_JSON_ROW);
    vs_json_text(json, "unit", o->estimate[k].unit);
    vs_json_number(json, "peak", e->peak[k], DIGITS);
    vs_json_number(json, "error", e->all[k], POLE_DIGITS);
    vs_json_number(json, "error_settled", settled, POLE_DIGITS);
    vs_json_number(json, "of_peak", e->peak[k] > 0 ? settled / e->peak[k] : NAN, POLE_DIGITS);
    vs_json_end(json);
  }
  vs_json_end(json);
}

static void add_cost(vs_json *json, const vs_result *r) {
  vs_json_object(json, "cost", VS_JSON_ROW);
  vs_json_number(json, "wall_s", r->wall_s, 6);
  vs_json_number(json, "second_run_s", r->second.wall_s, 6);
  vs_json_whole(json, "steps", r->steps);
  char text[512];
  if (vs_result_steps_are_short(r, text, sizeof text)) vs_json_text(json, "hint", text);
  vs_json_end(json);
}

static void add_second(vs_json *json, const vs_second_run *second) {
  vs_json_object(json, "second_run", VS_JSON_ROW);
  vs_json_number(json, "tolerance", second->done ? second->tolerance : NAN, DIGITS);
  vs_json_number(json, "decides", second->decides > 0 ? second->decides : NAN, DIGITS);
  vs_json_text(json, "failed", second->failed);
  vs_json_end(json);
}

/* What the control has decided, and what it shows at the run's end. */
static void add_loop(vs_json *json, const vs_loop *loop) {
  vs_control_column column;
  char name[VS_NAME_SIZE], suffix[32];
  if (!loop) return;
  vs_json_object(json, "control", VS_JSON_ROW);
  vs_json_text(json, "law", loop->control->regulator->name);
  vs_json_whole(json, "firings", (int)loop->program.count);
  vs_json_whole(json, "left_out", (int)loop->left_out);
  vs_json_whole(json, "at_limit", (int)loop->at_limit);
  for (int k = 0; k <= vs_control_outputs(loop->control); k++) {
    vs_control_column_at(loop->control, k, &column);
    vs_units_suffix(column.unit, suffix, sizeof suffix);
    snprintf(name, sizeof name, "%s%s%s", column.name, *suffix ? "_" : "", suffix);
    vs_json_number(json, name, vs_loop_shows(loop, k), DIGITS);
  }
  vs_json_end(json);
}

void vs_summary_json(const vs_result *r, bool with_cost, const vs_summary_more *more,
                     vs_text *text) {
  const vs_scene *s = r->scene;
  vs_json json = vs_json_new(text);
  vs_json_object(&json, NULL, VS_JSON_LINES);
  vs_version_json(&json);
  vs_summary_scene(&json, s);
  vs_json_text(&json, "tier", s->tier->name);
  vs_json_text(&json, "why", s->why);
  add_rung(&json, &r->ladder);
  add_quiet(&json, r);
  add_on_line(&json, s);
  vs_json_array(&json, "warnings", VS_JSON_ROW);
  vs_result_warnings(r, add_warning_to_summary, &json);
  vs_json_end(&json);
  vs_json_object(&json, "measure", VS_JSON_ROW);
  vs_json_number(&json, "from_s", s->setup.means.from_s, DIGITS);
  vs_json_number(&json, "to_s", s->setup.means.to_s, DIGITS);
  vs_json_end(&json);
  add_measures_to_summary(&json, s, r, more);
  add_estimates(&json, r);
  if (more && more->members) more->members(more->ctx, &json);
  add_loop(&json, r->loop);
  add_quality(&json, r);
  add_fraction(&json, s);
  add_energy_to_summary(&json, s, &r->watchers.energy, r->books);
  if (with_cost) add_cost(&json, r);
  add_second(&json, &r->second);
  add_verdict_to_summary(&json, &r->verdict, r->causes);
  add_happenings_to_summary(&json, &r->verdict);
  add_not_judged_to_summary(&json, r);
  add_columns(&json, s);
  add_corners(&json, r->corners);
  vs_json_end(&json);
  vs_text_add(text, "\n");
}
