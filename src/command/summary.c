/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "command/summary.h"

#include <gsl/gsl_version.h>
#include <math.h>

#include "base/units.h"
#include "scene/sections.h"
#include "scene/shown.h"

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
    vs_json_string(json, e->name);
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
  for (int p = 0; p < VS_SECTIONS; p++) {
    vs_filled_section part = vs_section_at(&s->setup, p);
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
    vs_text_add(json, "\"%s_residual\": ", vs_energy_balance_names[b]);
    add_number(json, e->balanced[b] ? e->residual[b] : NAN);
    vs_text_add(json, ", ");
  }
  vs_text_add(json, "\"residual\": ");
  add_number(json, e->worst);
  vs_text_add(json, ", \"audit\": ");
  vs_json_string(json, *books ? books : "the books close");
  vs_text_add(json, "},\n");
}

static void add_extreme(vs_text *json, const char *name, vs_value v, double unit) {
  vs_text_add(json, ", \"%s\": ", name);
  add_number(json, v.value / unit);
  vs_text_add(json, ", \"%s_at_s\": ", name);
  add_number(json, v.at_s);
}

static void add_rating(vs_text *json, const vs_judgement *j) {
  double unit = vs_units_factor(j->rating->unit);
  vs_text_add(json, "{\"rating\": \"%s\", \"unit\": \"%s\", \"text\": ", j->probe->name,
              j->rating->unit);
  vs_json_string(json, j->rating->text);
  vs_text_add(json, ", \"min\": ");
  add_number(json, j->rating->min / unit);
  vs_text_add(json, ", \"max\": ");
  add_number(json, j->rating->max / unit);
  add_extreme(json, "least", j->least, unit);
  add_extreme(json, "largest", j->largest, unit);
}

static void add_device(vs_text *json, const vs_judgement *j) {
  double unit = vs_units_factor(j->limit->unit);
  vs_text_add(json, "{\"device\": \"%s\", \"measure\": \"%s\", \"unit\": \"%s\", \"text\": ",
              j->device->name, j->measure->name, j->limit->unit);
  vs_json_string(json, j->limit->text);
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
    vs_json_string(json, vs_verdict_name(j, name));
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
    vs_text_add(json, ", \"word\": \"%s\"", vs_verdict_words[vs_verdict_word(j)]);
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
  vs_json_string(json, text);
}

static void add_second(vs_text *json, const vs_result *r) {
  const vs_second_run *second = &r->second;
  vs_text_add(json, "  \"second_run\": {\"tolerance\": ");
  add_number(json, second->done ? second->tolerance : NAN);
  vs_text_add(json, ", \"decides\": ");
  add_number(json, second->decides > 0 ? second->decides : NAN);
  vs_text_add(json, ", \"failed\": ");
  vs_json_string(json, second->failed);
  vs_text_add(json, "},\n");
}

void vs_summary_json(const vs_result *r, bool with_cost, vs_text *json) {
  const vs_scene *s = r->scene;
  vs_text_add(json,
              "{\n  \"program\": {\"version\": \"%s\", \"ngspice\": \"%s\", \"gsl\": \"%s\"},\n",
              VS_VERSION, vs_ng_version(), gsl_version);
  add_scene(json, s);
  vs_text_add(json, "  \"tier\": \"%s\",\n  \"why\": ", s->tier->name);
  vs_json_string(json, s->why);
  vs_text_add(json, ",\n");
  vs_text_add(json, "  \"rung\": {\"number\": %d, \"text\": ", r->ladder.rung);
  vs_json_string(json, vs_ladder_text(r->ladder.rung));
  vs_text_add(json, ", \"failed\": ");
  vs_json_string(json, r->ladder.failed);
  vs_text_add(json, "},\n  \"quiet\": {\"times\": %d, \"first_at_s\": ", r->watchers.absence.times);
  add_number(json, r->watchers.absence.times ? r->watchers.absence.first_s : NAN);
  vs_text_add(json, ", \"total_s\": ");
  add_number(json, r->watchers.absence.total_s);
  vs_text_add(json, ", \"bound\": ");
  add_number(json, r->watchers.absence.bound);
  vs_text_add(json, "},\n  \"warnings\": [");
  vs_result_warnings(r, add_warning, json);
  vs_text_add(json, "],\n");
  vs_text_add(json, "  \"measure\": {\"from_s\": %.12g, \"to_s\": %.12g},\n", s->setup.means.from_s,
              s->setup.means.to_s);
  add_measures(json, s, r);
  add_energy(json, s, &r->watchers.energy, r->books);
  if (with_cost)
    vs_text_add(json, "  \"cost\": {\"wall_s\": %.6g, \"second_run_s\": %.6g, \"steps\": %ld},\n",
                r->wall_s, r->second.wall_s, r->steps);
  add_second(json, r);
  add_verdict(json, &r->verdict);
}
