/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/summary.h"

#include <gsl/gsl_version.h>
#include <math.h>
#include <string.h>

#include "base/units.h"

/* Each measure there is, the energies' and the probes' extremes included; name[64] is filled. */
static bool measure_at(const vs_scene *s, const vs_result *r, int k, char name[VS_DECK_NAME + 4],
                       const char **unit, vs_value *value) {
  if (k < VS_MEASURES) {
    snprintf(name, VS_DECK_NAME + 4, "%s", vs_measures_known[k].name);
    *unit = vs_measures_known[k].unit;
    *value = r->values[k];
    return true;
  }
  k += VS_STANDARD_EXTREMES - VS_MEASURES;
  if (k >= r->measures->n_extremes) return false;
  const vs_extreme *e = &r->measures->extremes[k];
  vs_channel channel = vs_channel_at(&s->frame, e->channel);
  snprintf(name, VS_DECK_NAME + 4, "%s_%s", channel.name, e->sense < 0 ? "min" : "max");
  *unit = channel.unit;
  *value = e->best;
  return true;
}

/* Limits and stresses are shown in the unit of the rating line. */
static void print_verdict(const vs_result *r, FILE *out) {
  if (r->n_judgements)
    fprintf(out, "\n%-18s %12s %12s %12s %12s %-5s %8s\n", "rating", "min", "least", "largest",
            "max", "", "margin");
  for (size_t k = 0; k < r->n_judgements; k++) {
    const vs_judgement *j = &r->judgements[k];
    double unit = vs_unit_factor(j->rating->unit);
    fprintf(out, "%-18s %12.6g %12.6g %12.6g %12.6g %-5s %7.1f %%%s\n", j->probe->name,
            j->rating->min / unit, j->least.value / unit, j->largest.value / unit,
            j->rating->max / unit, j->rating->unit, 100 * j->margin,
            j->margin < 0 ? "  violated" : "");
  }
}

void vs_summary_table(const vs_scene *s, const vs_result *r, FILE *out) {
  char name[VS_DECK_NAME + 4];
  const char *unit;
  vs_value v;
  bool any = false;
  for (int k = 0; k < VS_MEASURES; k++) any = any || s->measured[k].known;
  fprintf(out, "scene  %s\ntier   %s (%s)\n", s->path, s->tier->name, s->why);
  if (r->ladder->rung)
    fprintf(out, "rung   %d: %s; before, %s\n", r->ladder->rung, vs_ladder_text(r->ladder->rung),
            r->ladder->failed);
  fputc('\n', out);
  fprintf(out, "%-18s %16s %-5s %14s%s\n", "measure", "computed", "", "at",
          any ? "         measured" : "");
  for (int k = 0; measure_at(s, r, k, name, &unit, &v); k++) {
    fprintf(out, "%-18s ", name);
    if (!v.known) {
      fprintf(out, "%16s\n", "-");
      continue;
    }
    fprintf(out, "%16.9g %-5s ", v.value, unit);
    if (isnan(v.at_s))
      fprintf(out, "%14s", "");
    else
      fprintf(out, "%12.7g s", v.at_s);
    if (k < VS_MEASURES && s->measured[k].known) {
      fprintf(out, " %16.6g", s->measured[k].value);
      if (s->measured[k].value != 0)
        fprintf(out, "   computed is %+.1f %%", 100 * (v.value / s->measured[k].value - 1));
    }
    fputc('\n', out);
  }
  if (s->frame.gap_at_rest && r->energy.joule[VS_E_WORK] != 0)
    fprintf(out, "\nthe one-way force of this tier did %.4f J of work that nothing supplied\n",
            r->energy.joule[VS_E_WORK]);
  print_verdict(r, out);
  fprintf(out, "\n%ld steps in %.3g s\n", r->steps, r->wall_s);
}

static void add_number(vs_text *json, double value) {
  if (isfinite(value))
    vs_text_add(json, "%.12g", value);
  else
    vs_text_add(json, "null");
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
  vs_text_add(json, "\n  },\n");
}

static void add_measures(vs_text *json, const vs_scene *s, const vs_result *r) {
  char name[VS_DECK_NAME + 4];
  const char *unit;
  vs_value v;
  bool first = true;
  vs_text_add(json, "  \"measures\": {");
  for (int k = 0; measure_at(s, r, k, name, &unit, &v); k++) {
    if (!v.known) continue;
    vs_text_add(json, "%s\n    \"%s\": {\"value\": ", first ? "" : ",", name);
    add_number(json, v.value);
    vs_text_add(json, ", \"unit\": \"%s\"", unit);
    if (!isnan(v.at_s)) vs_text_add(json, ", \"at_s\": %.12g", v.at_s);
    if (k < VS_MEASURES && s->measured[k].known)
      vs_text_add(json, ", \"measured\": %.12g", s->measured[k].value);
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

static void add_energy(vs_text *json, const vs_scene *s, const vs_energy *e,
                       const char *open_books) {
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
  vs_text_json(json, open_books ? open_books : "the books close");
  vs_text_add(json, "},\n");
}

static void add_extreme(vs_text *json, const char *name, vs_value v, double unit) {
  vs_text_add(json, ", \"%s\": ", name);
  add_number(json, v.value / unit);
  vs_text_add(json, ", \"%s_at_s\": ", name);
  add_number(json, v.at_s);
}

static void add_verdict(vs_text *json, const vs_result *r) {
  vs_text_add(json, "  \"verdict\": [");
  for (size_t k = 0; k < r->n_judgements; k++) {
    const vs_judgement *j = &r->judgements[k];
    double unit = vs_unit_factor(j->rating->unit);
    vs_text_add(json, "%s\n    {\"rating\": \"%s\", \"unit\": \"%s\", \"text\": ", k ? "," : "",
                j->probe->name, j->rating->unit);
    vs_text_json(json, j->rating->text);
    vs_text_add(json, ", \"min\": ");
    add_number(json, j->rating->min / unit);
    vs_text_add(json, ", \"max\": ");
    add_number(json, j->rating->max / unit);
    add_extreme(json, "least", j->least, unit);
    add_extreme(json, "largest", j->largest, unit);
    vs_text_add(json, ", \"margin\": ");
    add_number(json, j->margin);
    vs_text_add(json, ", \"violated\": %s}", j->margin < 0 ? "true" : "false");
  }
  vs_text_add(json, r->n_judgements ? "\n  ]\n}\n" : "]\n}\n");
}

void vs_summary_json(const vs_scene *s, const vs_result *r, bool with_cost, vs_text *json) {
  vs_text_add(json,
              "{\n  \"program\": {\"version\": \"%s\", \"ngspice\": \"%s\", \"gsl\": \"%s\"},\n",
              VS_VERSION, vs_ngspice_version(), gsl_version);
  add_scene(json, s);
  vs_text_add(json, "  \"tier\": \"%s\",\n  \"why\": ", s->tier->name);
  vs_text_json(json, s->why);
  vs_text_add(json, ",\n");
  vs_text_add(json, "  \"rung\": {\"number\": %d, \"text\": ", r->ladder->rung);
  vs_text_json(json, vs_ladder_text(r->ladder->rung));
  vs_text_add(json, ", \"failed\": ");
  vs_text_json(json, r->ladder->failed);
  vs_text_add(json, "},\n  \"warnings\": [");
  for (size_t k = 0; k < s->n_warnings; k++) {
    vs_text_add(json, "%s", k ? ", " : "");
    vs_text_json(json, s->warnings[k].text + s->warnings[k].place_size);
  }
  vs_text_add(json, "],\n");
  add_measures(json, s, r);
  add_energy(json, s, &r->energy, r->open_books);
  if (with_cost)
    vs_text_add(json, "  \"cost\": {\"wall_s\": %.6g, \"steps\": %ld},\n", r->wall_s, r->steps);
  add_verdict(json, r);
}
