/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/units.h"
#include "drive/gate.h"
#include "drive/wave.h"
#include "scene/version.h"
#include "solver/ng.h"

static void set_text(vs_shown *m, const char *format, const char *word) {
  snprintf(m->text, sizeof m->text, format, word);
}

/* Measure k of the devices', in the unit of its kind; false: there are no more. */
static bool device_measure_at(const vs_devices *devices, size_t k, vs_shown *m) {
  for (size_t d = 0; devices && d < devices->count; k -= devices->item[d++].count) {
    const vs_watched *w = &devices->item[d];
    if (k >= w->count) continue;
    const vs_reduced *r = &w->reduced[k];
    snprintf(m->name, sizeof m->name, "%s.%s", w->device->name, r->measure->name);
    m->unit = r->measure->unit;
    m->value = r->value;
    m->value.value /= vs_units_factor(m->unit);
    if (r->limit) m->limit = r->limit->value / vs_units_factor(m->unit);
    m->at_least = r->measure->held == VS_AT_LEAST;
    m->unjudged = r->unjudged;
    set_text(m, "%s", r->measure->text);
    return true;
  }
  return false;
}

static double rating_of(const vs_deck *deck, int probe, int sense) {
  for (size_t k = 0; k < deck->n_ratings; k++)
    if (deck->ratings[k].probe == probe)
      return sense < 0 ? deck->ratings[k].min : deck->ratings[k].max;
  return NAN;
}

bool vs_result_shown_at(const vs_frame *frame, const vs_result *r, int k, vs_shown *m) {
  m->limit = NAN;
  m->at_least = false;
  m->unjudged = NULL;
  if (k < VS_MEASURES) {
    snprintf(m->name, sizeof m->name, "%s", vs_measures_standard[k].name);
    m->unit = vs_measures_standard[k].unit;
    m->value = r->values[k];
    set_text(m, "%s", vs_measures_standard[k].text);
    return true;
  }
  k += VS_STANDARD_EXTREMES - VS_MEASURES;
  if (k >= r->measures->n_extremes)
    return device_measure_at(r->devices, (size_t)(k - r->measures->n_extremes), m);
  const vs_extreme *e = &r->measures->extremes[k];
  vs_channel channel = vs_channel_at(frame, e->channel);
  snprintf(m->name, sizeof m->name, "%s_%s", channel.name, e->sense < 0 ? "min" : "max");
  m->unit = channel.unit;
  m->value = e->best;
  m->at_least = e->sense < 0;
  if (frame->deck)
    m->limit = rating_of(frame->deck, e->channel - VS_CH_DECK, e->sense) / vs_units_factor(m->unit);
  set_text(m, e->sense < 0 ? "least %s" : "largest %s", channel.text);
  return true;
}

void vs_result_finish(vs_result *r) {
  vs_measures_finish(r->measures, r->values);
  vs_energy_finish(&r->energy);
  const double *joule = r->energy.joule;
  r->values[VS_M_ENERGY_IN] = (vs_value){true, joule[VS_E_SOURCE], NAN};
  r->values[VS_M_ENERGY_COPPER] = (vs_value){true, joule[VS_E_COPPER], NAN};
  r->values[VS_M_WORK_FORCE] = (vs_value){true, joule[VS_E_WORK], NAN};
  r->values[VS_M_ENERGY_RESIDUAL] = (vs_value){true, r->energy.worst, NAN};
  vs_devices_finish(r->devices);
  vs_verdict_reach(r->measures, r->devices, &r->verdict);
}

void vs_result_free(vs_result *r) {
  vs_measures_free(r->measures);
  vs_devices_free(r->devices);
  vs_verdict_free(&r->verdict);
  if (r->climbed) vs_scene_free(r->climbed);
  free(r->climbed);
  r->measures = NULL;
  r->devices = NULL;
  r->climbed = NULL;
}

/* Has anything conducted? Only what the deck shows can tell: its probe i_thyristor, of which the
 * firing is taken, and its devices that conduct or block. */
static bool nothing_conducts(const vs_scene *s, const vs_result *r) {
  const vs_deck *deck = s->frame.deck;
  bool told = !deck || vs_channel_find(&s->frame, "i_thyristor") >= 0;
  if (r->values[VS_M_T_FIRE].known) return false;
  for (size_t k = 0; r->devices && k < r->devices->count; k++) {
    const vs_switch *states = r->devices->item[k].states;
    told = told || states;
    if (states && !isnan(states->fired_s)) return false;
  }
  return told;
}

static bool has_port(const vs_deck *deck, int drive, int other) {
  for (size_t k = 0; k < deck->n_ports; k++)
    if (deck->ports[k].signal.drive == drive || deck->ports[k].signal.drive == other) return true;
  return false;
}

/* What is to be said where nothing conducts though firing is asked for; false: nothing is. */
static bool nothing_fires(const vs_result *r, char *text, size_t size) {
  const vs_scene *s = r->scene;
  const vs_deck *deck = s->frame.deck;
  bool asked = !deck || has_port(deck, VS_PORT_GATE, VS_PORT_BURST);
  if (!asked || !nothing_conducts(s, r)) return false;
  double until_s = s->setup.run.until_s;
  double first_s = vs_wave_conduction(&s->setup.timeline, 0, until_s);
  if (!(first_s < until_s) && !s->setup.timeline.events.count)
    first_s = vs_gate_next_conduction(&s->setup.timeline, 0);
  if (first_s < until_s)
    snprintf(text, size,
             "nothing fires: no thyristor is seen to conduct in this run (largest "
             "coil current: %.3g A), though a gate pulse meets forward mains voltage at %.9g s",
             r->values[VS_M_I_PEAK].value, first_s);
  else if (isfinite(first_s))
    snprintf(text, size,
             "nothing fires: no gate pulse meets forward mains voltage before run.until = %.9g s; "
             "the first would do so at %.9g s",
             until_s, first_s);
  else
    snprintf(text, size,
             "nothing fires: no gate pulse meets forward mains voltage; look at firing.angle and "
             "firing.pulse_width");
  return true;
}

/* What is known only once the run is over. */
static void warn_after(const vs_result *r, void (*each)(void *ctx, const char *text), void *ctx) {
  char text[VS_DECK_TEXT + sizeof r->second.failed];
  if (nothing_fires(r, text, sizeof text)) each(ctx, text);
  if (*r->books) each(ctx, r->books);
  if (!*r->second.failed) return;
  snprintf(text, sizeof text, "no margin's error is known, as the second run %s: %s",
           r->second.stopped ? "was stopped" : "failed", r->second.failed);
  each(ctx, text);
}

void vs_result_warnings(const vs_result *r, void (*each)(void *ctx, const char *text), void *ctx) {
  char text[VS_DECK_TEXT + sizeof r->ladder.failed];
  const vs_scene *s = r->scene;
  for (size_t k = 0; k < s->n_warnings; k++)
    each(ctx, s->warnings[k].text + s->warnings[k].place_size);
  if (r->ladder.rung) {
    snprintf(text, sizeof text, "got on rung %d of the ladder, %s; before, %s", r->ladder.rung,
             vs_ladder_text(r->ladder.rung), r->ladder.failed);
    each(ctx, text);
  }
  warn_after(r, each, ctx);
}

static void print_warning(void *ctx, const char *text) {
  const vs_result *r = ctx;
  bool short_run = r->scene->setup.run.until_s < r->scene->setup.timeline.period_s;
  if (!(short_run && strstr(text, "nothing fires")))
    fprintf(stderr, "vibrospice: warning: %s\n", text);
}

void vs_result_warn(const vs_result *r) {
  warn_after(r, print_warning, (void *)(size_t)r);
}

void vs_absence_accept(vs_absence *a, const vs_step *step) {
  if (step->event[1] == VS_EV_QUIET) {
    a->since_s = step->event_s[1];
    if (!a->times++) a->first_s = a->since_s;
    a->bound = fmax(a->bound, step->bound);
    a->now = true;
  } else if (step->event[1] == VS_EV_BACK) {
    a->bound = fmax(a->bound, step->bound);
    vs_absence_finish(a, step->event_s[1]);
  }
}

void vs_absence_finish(vs_absence *a, double until_s) {
  if (a->now) a->total_s += until_s - a->since_s;
  a->now = false;
}

/* "  12.3 % +- 0.04 %  held" */
static void print_margin(const vs_judgement *j, FILE *out) {
  if (isfinite(j->margin_error))
    fprintf(out, "%7.1f %% +- %-6.2g %%", 100 * j->margin, 100 * j->margin_error);
  else
    fprintf(out, "%7.1f %% %11s", 100 * j->margin, isnan(j->margin_error) ? "" : "+- ?");
  vs_word word = vs_verdict_word(j);
  fprintf(out, "  %s%s", word == VS_UNVERIFIED && j->margin < 0 ? "violated, " : "",
          vs_verdict_words[word]);
}

/* "undecided: v_ak, thyristor.i2t" */
static void print_undecided(const vs_verdict *v, FILE *out) {
  char name[VS_JUDGED_NAME];
  size_t n = 0;
  for (size_t k = 0; k < v->count; k++)
    if (vs_verdict_word(&v->item[k]) == VS_UNDECIDED)
      fprintf(out, "%s%s", n++ ? ", " : "undecided: ", vs_verdict_name(&v->item[k], name));
  if (n) fputc('\n', out);
}

/* Limits and stresses are shown in the unit of the rating's or limit's line. */
static void print_verdict(const vs_verdict *v, int width, FILE *out) {
  char name[VS_JUDGED_NAME];
  size_t k = 0;
  if (v->count && v->item[0].rating)
    fprintf(out, "\n%-*s %12s %12s %12s %12s %-5s %8s\n", width, "rating", "min", "least",
            "largest", "max", "", "margin +- its numerical error");
  for (; k < v->count && v->item[k].rating; k++) {
    const vs_judgement *j = &v->item[k];
    double unit = vs_units_factor(j->rating->unit);
    fprintf(out, "%-*s %12.6g %12.6g %12.6g %12.6g %-5s ", width, j->probe->name,
            j->rating->min / unit, j->least.value / unit, j->largest.value / unit,
            j->rating->max / unit, j->rating->unit);
    print_margin(j, out);
    fputc('\n', out);
  }
  if (k < v->count)
    fprintf(out, "\n%-*s %12s %12s %-5s %14s %8s\n", width, "device", "stress", "limit", "", "at",
            "margin +- its numerical error");
  for (; k < v->count; k++) {
    const vs_judgement *j = &v->item[k];
    double unit = vs_units_factor(j->limit->unit);
    fprintf(out, "%-*s %12.6g %12.6g %-5s ", width, vs_verdict_name(j, name),
            j->stress.value / unit, j->limit->value / unit, j->limit->unit);
    if (isnan(j->stress.at_s))
      fprintf(out, "%14s ", "");
    else
      fprintf(out, "%12.7g s ", j->stress.at_s);
    print_margin(j, out);
    if (j->ward) fprintf(out, "  limit of %s", j->ward->name);
    fprintf(out, "%s\n", j->limit->assumed ? "  assumed" : "");
  }
  if (v->weakest) {
    fprintf(out, "\nweakest: %s, margin ", vs_verdict_name(v->weakest, name));
    print_margin(v->weakest, out);
    fputc('\n', out);
  }
  print_undecided(v, out);
  if (v->first_to_fail)
    fprintf(out, "first to fail: %s, at %.9g s\n", vs_verdict_name(v->first_to_fail, name),
            v->first_to_fail->failed_s);
}

static void print_measure(const vs_shown *m, int width, const vs_value *measured, FILE *out) {
  fprintf(out, "%-*s ", width, m->name);
  if (!m->value.known) {
    fprintf(out, "%16s\n", "-");
    return;
  }
  fprintf(out, "%16.9g %-5s ", m->value.value, m->unit);
  if (isnan(m->value.at_s))
    fprintf(out, "%14s", "");
  else
    fprintf(out, "%12.7g s", m->value.at_s);
  if (measured && measured->known) {
    fprintf(out, " %16.6g", measured->value);
    if (measured->value != 0)
      fprintf(out, "   computed is %+.1f %%", 100 * (m->value.value / measured->value - 1));
  }
  if (m->unjudged) fprintf(out, "  %s", m->unjudged);
  fputc('\n', out);
}

/* How the errors of the margins were found, and what would decide those that are not. */
static void print_second(const vs_result *r, FILE *out) {
  const vs_second_run *second = &r->second;
  if (second->done)
    fprintf(out, "errors of margins: by a second run at run.tolerance = %.3g", second->tolerance);
  else if (r->verdict.count)
    fprintf(out, "errors of margins: not computed (%s)",
            second->stopped   ? "the second run was stopped by a signal"
            : *second->failed ? "the second run failed"
                              : "run.verify");
  if (second->decides > 0)
    fprintf(out, "; run.tolerance = %.1g may decide what is undecided", second->decides);
  if (second->done || r->verdict.count) fputc('\n', out);
}

void vs_summary_table(const vs_result *r, FILE *out) {
  const vs_scene *s = r->scene;
  vs_shown m;
  int width = 18;
  bool any = false;
  for (int k = 0; k < VS_MEASURES; k++) any = any || s->measured[k].known;
  for (int k = 0; vs_result_shown_at(&s->frame, r, k, &m); k++)
    if ((int)strlen(m.name) > width) width = (int)strlen(m.name);
  fprintf(out, "scene  %s\ntier   %s (%s)\n", s->path, s->tier->name, s->why);
  if (r->ladder.rung)
    fprintf(out, "rung   %d: %s; before, %s\n", r->ladder.rung, vs_ladder_text(r->ladder.rung),
            r->ladder.failed);
  const vs_absence *absence = &r->absence;
  if (absence->times)
    fprintf(
        out,
        "quiet  %.4g s of it without ngspice, from %.6g s on, %d time%s; errors by that: at most "
        "%.2g of each peak\n",
        absence->total_s, absence->first_s, absence->times, absence->times > 1 ? "s" : "",
        absence->bound);
  if (r->devices)
    fprintf(out, "means over %.9g..%.9g s\n", s->setup.means.from_s, s->setup.means.to_s);
  fputc('\n', out);
  fprintf(out, "%-*s %16s %-5s %14s%s\n", width, "measure", "computed", "", "at",
          any ? "         measured" : "");
  for (int k = 0; vs_result_shown_at(&s->frame, r, k, &m); k++)
    print_measure(&m, width, k < VS_MEASURES ? &s->measured[k] : NULL, out);
  if (s->frame.gap_at_rest && r->energy.joule[VS_E_WORK] != 0)
    fprintf(out, "\nthe one-way force of this tier did %.4f J of work that nothing supplied\n",
            r->energy.joule[VS_E_WORK]);
  print_verdict(&r->verdict, width, out);
  print_second(r, out);
  fprintf(out, "\n%ld steps in %.3g s\n", r->steps, r->wall_s);
}

enum { DIGITS = 12 };

/* Each with its keys, and when it begins. */
static void add_events(vs_json *json, const vs_events *events) {
  vs_json_object(json, "events", events->count ? VS_JSON_LINES : VS_JSON_ROW);
  for (size_t k = 0; k < events->count; k++) {
    const vs_occurrence *e = &events->item[k];
    vs_json_object(json, e->name, VS_JSON_ROW);
    vs_json_number(json, "starts_s", e->start_s, DIGITS);
    for (size_t f = 0; f < e->kind->n_fields; f++) {
      vs_json_key(json, e->kind->fields[f].key);
      vs_field_json(&e->kind->fields[f], &e->v, json->text);
    }
    vs_json_end(json);
  }
  vs_json_end(json);
}

static void add_scene(vs_json *json, const vs_scene *s) {
  vs_json_object(json, "scene", VS_JSON_LINES);
  for (int p = 0; p < VS_SCENE_SECTIONS; p++) {
    vs_scene_section part = vs_scene_section_at(s, p);
    vs_json_object(json, part.section->name, VS_JSON_LINES);
    for (size_t k = 0; k < part.section->count; k++) {
      vs_json_key(json, part.section->fields[k].key);
      vs_field_json(&part.section->fields[k], part.values, json->text);
    }
    vs_json_end(json);
  }
  add_events(json, &s->setup.timeline.events);
  vs_json_end(json);
}

static void add_measures(vs_json *json, const vs_scene *s, const vs_result *r) {
  vs_shown m;
  vs_json_object(json, "measures", VS_JSON_LINES);
  for (int k = 0; vs_result_shown_at(&s->frame, r, k, &m); k++) {
    if (!m.value.known) continue;
    vs_json_object(json, m.name, VS_JSON_ROW);
    vs_json_number(json, "value", m.value.value, DIGITS);
    vs_json_text(json, "unit", m.unit);
    if (!isnan(m.value.at_s)) vs_json_number(json, "at_s", m.value.at_s, DIGITS);
    if (k < VS_MEASURES && s->measured[k].known)
      vs_json_number(json, "measured", s->measured[k].value, DIGITS);
    if (m.unjudged) vs_json_text(json, "unjudged", m.unjudged);
    vs_json_end(json);
  }
  vs_json_end(json);
}

/* A member whose name is `name` and an ending. */
static void add_joined(vs_json *json, const char *name, const char *ending, double value) {
  char key[VS_NAME_SIZE];
  snprintf(key, sizeof key, "%s%s", name, ending);
  vs_json_number(json, key, value, DIGITS);
}

/* {"r1": 0.0655, ...}: the deck's own accounts, J */
static void add_accounts(vs_json *json, const char *key, const vs_accounts *accounts,
                         const double *joule) {
  vs_json_object(json, key, VS_JSON_ROW);
  for (size_t k = 0; k < accounts->count; k++)
    vs_json_number(json, accounts->item[k].name, joule[k], DIGITS);
  vs_json_end(json);
}

static void add_energy(vs_json *json, const vs_scene *s, const vs_energy *e, const char *books) {
  vs_json_object(json, "energy", VS_JSON_ROW);
  for (int k = 0; k < VS_ENERGIES; k++) add_joined(json, vs_energy_names[k], "_J", e->joule[k]);
  if (s->frame.deck) {
    add_accounts(json, "losses_J", &s->frame.deck->losses, e->loss_j);
    add_accounts(json, "stores_J", &s->frame.deck->stores, e->store_j);
  }
  if (s->frame.gap_at_rest) vs_json_number(json, "unsupplied_J", e->joule[VS_E_WORK], DIGITS);
  for (int b = 0; b < VS_BALANCES; b++)
    add_joined(json, vs_energy_balance_names[b], "_residual",
               e->balanced[b] ? e->residual[b] : NAN);
  vs_json_number(json, "residual", e->worst, DIGITS);
  vs_json_text(json, "audit", *books ? books : "the books close");
  vs_json_end(json);
}

static void add_extreme(vs_json *json, const char *name, vs_value v, double unit) {
  vs_json_number(json, name, v.value / unit, DIGITS);
  add_joined(json, name, "_at_s", v.at_s);
}

static void add_rating(vs_json *json, const vs_judgement *j) {
  double unit = vs_units_factor(j->rating->unit);
  vs_json_text(json, "rating", j->probe->name);
  vs_json_text(json, "unit", j->rating->unit);
  vs_json_text(json, "text", j->rating->text);
  vs_json_number(json, "min", j->rating->min / unit, DIGITS);
  vs_json_number(json, "max", j->rating->max / unit, DIGITS);
  add_extreme(json, "least", j->least, unit);
  add_extreme(json, "largest", j->largest, unit);
}

static void add_device(vs_json *json, const vs_judgement *j) {
  double unit = vs_units_factor(j->limit->unit);
  vs_json_text(json, "device", j->device->name);
  vs_json_text(json, "measure", j->measure->name);
  vs_json_text(json, "unit", j->limit->unit);
  vs_json_text(json, "text", j->limit->text);
  vs_json_number(json, "stress", j->stress.value / unit, DIGITS);
  vs_json_number(json, "at_s", j->stress.at_s, DIGITS);
  vs_json_number(json, "limit", j->limit->value / unit, DIGITS);
  if (j->ward) vs_json_text(json, "limit_of", j->ward->name);
  vs_json_bool(json, "assumed", j->limit->assumed);
}

static void add_judged(vs_json *json, const char *key, const vs_judgement *j) {
  char name[VS_JUDGED_NAME];
  vs_json_text(json, key, j ? vs_verdict_name(j, name) : NULL);
}

static void add_verdict(vs_json *json, const vs_verdict *v) {
  vs_json_array(json, "verdict", v->count ? VS_JSON_LINES : VS_JSON_ROW);
  for (size_t k = 0; k < v->count; k++) {
    const vs_judgement *j = &v->item[k];
    vs_json_object(json, NULL, VS_JSON_ROW);
    if (j->device)
      add_device(json, j);
    else
      add_rating(json, j);
    vs_json_number(json, "margin", j->margin, DIGITS);
    vs_json_number(json, "margin_error", j->margin_error, DIGITS);
    vs_json_text(json, "word", vs_verdict_words[vs_verdict_word(j)]);
    vs_json_bool(json, "violated", j->margin < 0);
    vs_json_number(json, "failed_at_s", j->failed_s, DIGITS);
    vs_json_end(json);
  }
  vs_json_end(json);
  add_judged(json, "weakest", v->weakest);
  add_judged(json, "first_to_fail", v->first_to_fail);
}

static void add_warning(void *ctx, const char *text) {
  vs_json_text(ctx, NULL, text);
}

static void add_rung(vs_json *json, const vs_ladder *ladder) {
  vs_json_object(json, "rung", VS_JSON_ROW);
  vs_json_whole(json, "number", ladder->rung);
  vs_json_text(json, "text", vs_ladder_text(ladder->rung));
  vs_json_text(json, "failed", ladder->failed);
  vs_json_end(json);
}

static void add_quiet(vs_json *json, const vs_absence *absence) {
  vs_json_object(json, "quiet", VS_JSON_ROW);
  vs_json_whole(json, "times", absence->times);
  vs_json_number(json, "first_at_s", absence->times ? absence->first_s : NAN, DIGITS);
  vs_json_number(json, "total_s", absence->total_s, DIGITS);
  vs_json_number(json, "bound", absence->bound, DIGITS);
  vs_json_end(json);
}

static void add_cost(vs_json *json, const vs_result *r) {
  vs_json_object(json, "cost", VS_JSON_ROW);
  vs_json_number(json, "wall_s", r->wall_s, 6);
  vs_json_number(json, "second_run_s", r->second.wall_s, 6);
  vs_json_whole(json, "steps", r->steps);
  vs_json_end(json);
}

static void add_second(vs_json *json, const vs_second_run *second) {
  vs_json_object(json, "second_run", VS_JSON_ROW);
  vs_json_number(json, "tolerance", second->done ? second->tolerance : NAN, DIGITS);
  vs_json_number(json, "decides", second->decides > 0 ? second->decides : NAN, DIGITS);
  vs_json_text(json, "failed", second->failed);
  vs_json_end(json);
}

void vs_summary_json(const vs_result *r, bool with_cost, vs_text *text) {
  const vs_scene *s = r->scene;
  vs_json json = vs_json_new(text);
  vs_json_object(&json, NULL, VS_JSON_LINES);
  vs_version_json(&json);
  add_scene(&json, s);
  vs_json_text(&json, "tier", s->tier->name);
  vs_json_text(&json, "why", s->why);
  add_rung(&json, &r->ladder);
  add_quiet(&json, &r->absence);
  vs_json_array(&json, "warnings", VS_JSON_ROW);
  vs_result_warnings(r, add_warning, &json);
  vs_json_end(&json);
  vs_json_object(&json, "measure", VS_JSON_ROW);
  vs_json_number(&json, "from_s", s->setup.means.from_s, DIGITS);
  vs_json_number(&json, "to_s", s->setup.means.to_s, DIGITS);
  vs_json_end(&json);
  add_measures(&json, s, r);
  add_energy(&json, s, &r->energy, r->books);
  if (with_cost) add_cost(&json, r);
  add_second(&json, &r->second);
  add_verdict(&json, &r->verdict);
  vs_json_end(&json);
  vs_text_add(text, "\n");
}
