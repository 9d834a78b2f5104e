/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/summary.h"

#include <gsl/gsl_version.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "circuit/wave.h"

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
    m->value.value /= vs_unit_factor(m->unit);
    if (r->limit) m->limit = r->limit->value / vs_unit_factor(m->unit);
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

bool vs_shown_at(const vs_frame *frame, const vs_result *r, int k, vs_shown *m) {
  m->limit = NAN;
  m->at_least = false;
  m->unjudged = NULL;
  if (k < VS_MEASURES) {
    snprintf(m->name, sizeof m->name, "%s", vs_measures_known[k].name);
    m->unit = vs_measures_known[k].unit;
    m->value = r->values[k];
    set_text(m, "%s", vs_measures_known[k].text);
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
    m->limit = rating_of(frame->deck, e->channel - VS_CH_DECK, e->sense) / vs_unit_factor(m->unit);
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
  bool asked = !deck || has_port(deck, VS_DRIVE_GATE, VS_DRIVE_BURST);
  if (!asked || !nothing_conducts(s, r)) return false;
  double until_s = s->setup.run.until_s;
  double first_s = vs_wave_conduction(&s->setup.timeline, 0, until_s);
  if (!(first_s < until_s) && !s->setup.timeline.events.count)
    first_s = vs_next_conduction(&s->setup.timeline, 0);
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
  vs_word word = vs_judgement_word(j);
  fprintf(out, "  %s%s", word == VS_UNVERIFIED && j->margin < 0 ? "violated, " : "",
          vs_words[word]);
}

/* "undecided: v_ak, thyristor.i2t" */
static void print_undecided(const vs_verdict *v, FILE *out) {
  char name[VS_JUDGED_NAME];
  size_t n = 0;
  for (size_t k = 0; k < v->count; k++)
    if (vs_judgement_word(&v->item[k]) == VS_UNDECIDED)
      fprintf(out, "%s%s", n++ ? ", " : "undecided: ", vs_judgement_name(&v->item[k], name));
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
    double unit = vs_unit_factor(j->rating->unit);
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
    double unit = vs_unit_factor(j->limit->unit);
    fprintf(out, "%-*s %12.6g %12.6g %-5s ", width, vs_judgement_name(j, name),
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
    fprintf(out, "\nweakest: %s, margin ", vs_judgement_name(v->weakest, name));
    print_margin(v->weakest, out);
    fputc('\n', out);
  }
  print_undecided(v, out);
  if (v->first_to_fail)
    fprintf(out, "first to fail: %s, at %.9g s\n", vs_judgement_name(v->first_to_fail, name),
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
  for (int k = 0; vs_shown_at(&s->frame, r, k, &m); k++)
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
  for (int k = 0; vs_shown_at(&s->frame, r, k, &m); k++)
    print_measure(&m, width, k < VS_MEASURES ? &s->measured[k] : NULL, out);
  if (s->frame.gap_at_rest && r->energy.joule[VS_E_WORK] != 0)
    fprintf(out, "\nthe one-way force of this tier did %.4f J of work that nothing supplied\n",
            r->energy.joule[VS_E_WORK]);
  print_verdict(&r->verdict, width, out);
  print_second(r, out);
  fprintf(out, "\n%ld steps in %.3g s\n", r->steps, r->wall_s);
}

static void add_number(vs_text *json, double value) {
  if (isfinite(value))
    vs_text_add(json, "%.12g", value);
  else
    vs_text_add(json, "null");
}

/* Each with its keys, and when it begins. */
static void add_events(vs_text *json, const vs_events *events) {
  vs_text_add(json, ",\n    \"events\": {");
  for (size_t k = 0; k < events->count; k++) {
    const vs_occurrence *e = &events->item[k];
    vs_text_add(json, "%s\n      ", k ? "," : "");
    vs_text_json(json, e->name);
    vs_text_add(json, ": {\"starts_s\": ");
    add_number(json, e->start_s);
    for (size_t f = 0; f < e->kind->n_fields; f++) {
      vs_text_add(json, ", \"%s\": ", e->kind->fields[f].key);
      vs_field_json(&e->kind->fields[f], &e->v, json);
    }
    vs_text_add(json, "}");
  }
  vs_text_add(json, "%s}", events->count ? "\n    " : "");
}

static void add_scene(vs_text *json, const vs_scene *s) {
  vs_text_add(json, "  \"scene\": {");
  for (int p = 0; p < VS_SCENE_PARTS; p++) {
    vs_scene_part part = vs_scene_part_at(s, p);
    vs_text_add(json, "%s\n    \"%s\": {", p ? "," : "", part.section->name);
    for (size_t k = 0; k < part.section->count; k++) {
      vs_text_add(json, "%s\n      \"%s\": ", k ? "," : "", part.section->fields[k].key);
      vs_field_json(&part.section->fields[k], part.values, json);
    }
    vs_text_add(json, "\n    }");
  }
  add_events(json, &s->setup.timeline.events);
  vs_text_add(json, "\n  },\n");
}

static void add_measures(vs_text *json, const vs_scene *s, const vs_result *r) {
  vs_shown m;
  bool first = true;
  vs_text_add(json, "  \"measures\": {");
  for (int k = 0; vs_shown_at(&s->frame, r, k, &m); k++) {
    if (!m.value.known) continue;
    vs_text_add(json, "%s\n    \"%s\": {\"value\": ", first ? "" : ",", m.name);
    add_number(json, m.value.value);
    vs_text_add(json, ", \"unit\": \"%s\"", m.unit);
    if (!isnan(m.value.at_s)) vs_text_add(json, ", \"at_s\": %.12g", m.value.at_s);
    if (k < VS_MEASURES && s->measured[k].known)
      vs_text_add(json, ", \"measured\": %.12g", s->measured[k].value);
    if (m.unjudged) vs_text_add(json, ", \"unjudged\": \"%s\"", m.unjudged);
    vs_text_add(json, "}");
    first = false;
  }
  vs_text_add(json, "\n  },\n");
}

/* {"r1": 0.0655, ...}: the deck's own accounts, J */
static void add_accounts(vs_text *json, const char *name, const vs_accounts *accounts,
                         const double *joule) {
  vs_text_add(json, "\"%s_J\": {", name);
  for (size_t k = 0; k < accounts->count; k++) {
    vs_text_add(json, "%s\"%s\": ", k ? ", " : "", accounts->item[k].name);
    add_number(json, joule[k]);
  }
  vs_text_add(json, "}, ");
}

static void add_energy(vs_text *json, const vs_scene *s, const vs_energy *e, const char *books) {
  vs_text_add(json, "  \"energy\": {");
  for (int k = 0; k < VS_ENERGIES; k++) {
    vs_text_add(json, "\"%s_J\": ", vs_energy_names[k]);
    add_number(json, e->joule[k]);
    vs_text_add(json, ", ");
  }
  if (s->frame.deck) {
    add_accounts(json, "losses", &s->frame.deck->losses, e->loss_j);
    add_accounts(json, "stores", &s->frame.deck->stores, e->store_j);
  }
  if (s->frame.gap_at_rest) vs_text_add(json, "\"unsupplied_J\": %.12g, ", e->joule[VS_E_WORK]);
  for (int b = 0; b < VS_BALANCES; b++) {
    vs_text_add(json, "\"%s_residual\": ", vs_balance_names[b]);
    add_number(json, e->balanced[b] ? e->residual[b] : NAN);
    vs_text_add(json, ", ");
  }
  vs_text_add(json, "\"residual\": ");
  add_number(json, e->worst);
  vs_text_add(json, ", \"audit\": ");
  vs_text_json(json, *books ? books : "the books close");
  vs_text_add(json, "},\n");
}

static void add_extreme(vs_text *json, const char *name, vs_value v, double unit) {
  vs_text_add(json, ", \"%s\": ", name);
  add_number(json, v.value / unit);
  vs_text_add(json, ", \"%s_at_s\": ", name);
  add_number(json, v.at_s);
}

static void add_rating(vs_text *json, const vs_judgement *j) {
  double unit = vs_unit_factor(j->rating->unit);
  vs_text_add(json, "{\"rating\": \"%s\", \"unit\": \"%s\", \"text\": ", j->probe->name,
              j->rating->unit);
  vs_text_json(json, j->rating->text);
  vs_text_add(json, ", \"min\": ");
  add_number(json, j->rating->min / unit);
  vs_text_add(json, ", \"max\": ");
  add_number(json, j->rating->max / unit);
  add_extreme(json, "least", j->least, unit);
  add_extreme(json, "largest", j->largest, unit);
}

static void add_device(vs_text *json, const vs_judgement *j) {
  double unit = vs_unit_factor(j->limit->unit);
  vs_text_add(json, "{\"device\": \"%s\", \"measure\": \"%s\", \"unit\": \"%s\", \"text\": ",
              j->device->name, j->measure->name, j->limit->unit);
  vs_text_json(json, j->limit->text);
  vs_text_add(json, ", \"stress\": ");
  add_number(json, j->stress.value / unit);
  vs_text_add(json, ", \"at_s\": ");
  add_number(json, j->stress.at_s);
  vs_text_add(json, ", \"limit\": ");
  add_number(json, j->limit->value / unit);
  if (j->ward) vs_text_add(json, ", \"limit_of\": \"%s\"", j->ward->name);
  vs_text_add(json, ", \"assumed\": %s", j->limit->assumed ? "true" : "false");
}

static void add_judged(vs_text *json, const char *key, const vs_judgement *j) {
  char name[VS_JUDGED_NAME];
  vs_text_add(json, ",\n  \"%s\": ", key);
  if (j)
    vs_text_json(json, vs_judgement_name(j, name));
  else
    vs_text_add(json, "null");
}

static void add_verdict(vs_text *json, const vs_verdict *v) {
  vs_text_add(json, "  \"verdict\": [");
  for (size_t k = 0; k < v->count; k++) {
    const vs_judgement *j = &v->item[k];
    vs_text_add(json, "%s\n    ", k ? "," : "");
    if (j->device)
      add_device(json, j);
    else
      add_rating(json, j);
    vs_text_add(json, ", \"margin\": ");
    add_number(json, j->margin);
    vs_text_add(json, ", \"margin_error\": ");
    add_number(json, j->margin_error);
    vs_text_add(json, ", \"word\": \"%s\"", vs_words[vs_judgement_word(j)]);
    vs_text_add(json, ", \"violated\": %s", j->margin < 0 ? "true" : "false");
    vs_text_add(json, ", \"failed_at_s\": ");
    add_number(json, j->failed_s);
    vs_text_add(json, "}");
  }
  vs_text_add(json, v->count ? "\n  ]" : "]");
  add_judged(json, "weakest", v->weakest);
  add_judged(json, "first_to_fail", v->first_to_fail);
  vs_text_add(json, "\n}\n");
}

/* One of a list of texts that ends with no comma. */
static void add_warning(void *ctx, const char *text) {
  vs_text *json = ctx;
  if (json->text[json->length - 1] != '[') vs_text_add(json, ", ");
  vs_text_json(json, text);
}

static void add_second(vs_text *json, const vs_result *r) {
  const vs_second_run *second = &r->second;
  vs_text_add(json, "  \"second_run\": {\"tolerance\": ");
  add_number(json, second->done ? second->tolerance : NAN);
  vs_text_add(json, ", \"decides\": ");
  add_number(json, second->decides > 0 ? second->decides : NAN);
  vs_text_add(json, ", \"failed\": ");
  vs_text_json(json, second->failed);
  vs_text_add(json, "},\n");
}

void vs_summary_json(const vs_result *r, bool with_cost, vs_text *json) {
  const vs_scene *s = r->scene;
  vs_text_add(json,
              "{\n  \"program\": {\"version\": \"%s\", \"ngspice\": \"%s\", \"gsl\": \"%s\"},\n",
              VS_VERSION, vs_ngspice_version(), gsl_version);
  add_scene(json, s);
  vs_text_add(json, "  \"tier\": \"%s\",\n  \"why\": ", s->tier->name);
  vs_text_json(json, s->why);
  vs_text_add(json, ",\n");
  vs_text_add(json, "  \"rung\": {\"number\": %d, \"text\": ", r->ladder.rung);
  vs_text_json(json, vs_ladder_text(r->ladder.rung));
  vs_text_add(json, ", \"failed\": ");
  vs_text_json(json, r->ladder.failed);
  vs_text_add(json, "},\n  \"quiet\": {\"times\": %d, \"first_at_s\": ", r->absence.times);
  add_number(json, r->absence.times ? r->absence.first_s : NAN);
  vs_text_add(json, ", \"total_s\": ");
  add_number(json, r->absence.total_s);
  vs_text_add(json, ", \"bound\": ");
  add_number(json, r->absence.bound);
  vs_text_add(json, "},\n  \"warnings\": [");
  vs_result_warnings(r, add_warning, json);
  vs_text_add(json, "],\n");
  vs_text_add(json, "  \"measure\": {\"from_s\": %.12g, \"to_s\": %.12g},\n", s->setup.means.from_s,
              s->setup.means.to_s);
  add_measures(json, s, r);
  add_energy(json, s, &r->energy, r->books);
  if (with_cost)
    vs_text_add(json, "  \"cost\": {\"wall_s\": %.6g, \"second_run_s\": %.6g, \"steps\": %ld},\n",
                r->wall_s, r->second.wall_s, r->steps);
  add_second(json, r);
  add_verdict(json, &r->verdict);
}
