/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"
#include "base/units.h"
#include "netlist/kinds.h"

/* ---- reading ---- */

/* part KIND "TEXT" */
vs_status vs_parts_kind(vs_deck *deck, vs_cursor *c, vs_error *err) {
  vs_part_file file = {.where = c->line};
  if (!vs_cursor_word(c, "", file.kind, sizeof file.kind))
    return vs_fail_at(err, vs_cursor_here(c), "'part KIND \"TEXT\"' is wanted here");
  vs_status status = vs_cursor_text(c, file.text, sizeof file.text, err);
  for (size_t k = 0; k < deck->n_part_files && !status; k++)
    if (!strcmp(deck->part_files[k].where.file, c->line.file))
      status = vs_fail_at(err, c->line, "a second line 'part'; a file is one part");
  if (!status && deck->n_part_files >= VS_DECK_PARTS)
    status = vs_fail_at(err, c->line, "more than %d parts", VS_DECK_PARTS);
  if (!status) deck->part_files[deck->n_part_files++] = file;
  return status;
}

/* Reads the rest of "VALUE UNIT [assumed | typical]" behind the value, whose place is `where`. */
static vs_status read_amount(vs_limit *limit, vs_cursor *c, const char *value, vs_where where,
                             vs_error *err) {
  char why[200];
  vs_cursor_token(c, limit->unit, sizeof limit->unit);
  snprintf(limit->written, sizeof limit->written, "%s %s", value, limit->unit);
  const char *usual = vs_kinds_limit_unit(limit->name);
  bool known = *limit->unit && vs_units_known(limit->unit);
  if (usual && vs_units_known(limit->unit) && !vs_units_same_kind(limit->unit, usual))
    return vs_fail_at(err, where, "limit %s: a unit as %s is wanted, not '%s'", limit->name, usual,
                      limit->unit);
  if (!known || !vs_units_read(limit->written, limit->unit, &limit->value, why, sizeof why) ||
      limit->value <= 0)
    return vs_fail_at(err, where,
                      "limit %s: a positive number with a unit known here, or 'none', is wanted, "
                      "not '%s'%s%s",
                      limit->name, limit->written, usual ? "; its unit is written as " : "",
                      usual ? usual : "");
  limit->unsure = vs_deck_unsure(c);
  return VS_OK;
}

/* limit NAME = VALUE UNIT [assumed] "TEXT", limit NAME = none "TEXT" */
vs_status vs_parts_limit(vs_deck *deck, vs_cursor *c, vs_error *err) {
  char value[VS_DECK_NAME];
  vs_limit limit = {.where = c->line, .value = INFINITY};
  vs_status status = vs_cursor_name(c, limit.name, sizeof limit.name, err);
  if (status) return status;
  vs_cursor_skip(c);
  vs_where where = vs_cursor_here(c);
  vs_cursor_token(c, value, sizeof value);
  snprintf(limit.written, sizeof limit.written, "%s", value);
  if (strcmp(value, "none")) status = read_amount(&limit, c, value, where, err);
  if (!status) status = vs_cursor_text(c, limit.text, sizeof limit.text, err);
  for (size_t k = 0; k < deck->n_limits && !status; k++)
    if (!strcmp(deck->limits[k].where.file, c->line.file) &&
        !strcmp(deck->limits[k].name, limit.name))
      status =
          vs_fail_at(err, c->line, "limit %s stands here a second time; leave one out", limit.name);
  if (!status && deck->n_limits >= VS_DECK_LIMITS)
    status = vs_fail_at(err, c->line, "more than %d limits", VS_DECK_LIMITS);
  if (!status) deck->limits[deck->n_limits++] = limit;
  return status;
}

/* Reads an end of a rating, as "-0.5", "thyristor.v_drm" or "-thyristor.v_rrm". */
static bool read_bound(const char *text, vs_bound *bound) {
  char *end, *dot;
  bound->value = vs_text_to_number(text, &end);
  if (end != text && !*end) return !isnan(bound->value);
  bound->sign = *text == '-' ? -1 : 1;
  snprintf(bound->part, sizeof bound->part, "%s", text + (*text == '-'));
  dot = strchr(bound->part, '.');
  if (!dot || dot == bound->part || !dot[1]) return false;
  *dot = '\0';
  snprintf(bound->limit, sizeof bound->limit, "%s", dot + 1);
  return true;
}

static bool read_bounds(char *range, vs_rating *rating) {
  char *dots = strstr(range, "..");
  if (!dots) return false;
  *dots = '\0';
  return read_bound(range, &rating->bounds[0]) && read_bound(dots + 2, &rating->bounds[1]) &&
         (*rating->bounds[0].part || *rating->bounds[1].part ||
          rating->bounds[0].value <= rating->bounds[1].value);
}

/* The probe's index; -1, with an error, where none of that name stands above. */
static int find_probe(const vs_deck *deck, const char *name, vs_where where, vs_status *status,
                      vs_error *err) {
  const char *names[VS_DECK_MOST];
  for (size_t k = 0; k < deck->n_probes; k++) {
    names[k] = deck->probes[k].name;
    if (!strcmp(name, names[k])) return (int)k;
  }
  if (deck->lost & VS_LOST_PROBE)
    return -1; /* the line of this probe may be the one that could not be read */
  *status = vs_fail_at(err, where, "rating: no probe '%s' stands above%s", name,
                       vs_text_hint(name, names, deck->n_probes, "").text);
  return -1;
}

/* rating PROBE MIN..MAX UNIT "TEXT" */
vs_status vs_parts_rating(vs_deck *deck, vs_cursor *c, vs_error *err) {
  char name[VS_DECK_NAME], range[4 * VS_DECK_NAME];
  vs_rating rating = {.where = c->line};
  vs_status status = VS_OK;
  vs_cursor_skip(c);
  vs_where where = vs_cursor_here(c);
  if (!vs_cursor_word(c, "", name, sizeof name))
    return vs_fail_at(err, where, "'rating PROBE MIN..MAX UNIT' is wanted here");
  rating.probe = find_probe(deck, name, where, &status, err);
  if (rating.probe < 0) return status;
  vs_cursor_skip(c);
  where = vs_cursor_here(c);
  vs_cursor_token(c, range, sizeof range);
  if (!read_bounds(range, &rating))
    return vs_fail_at(err, where,
                      "rating %s: a range MIN..MAX is wanted here, each a number or a part's limit "
                      "(thyristor.v_drm)",
                      name);
  vs_cursor_skip(c);
  where = vs_cursor_here(c);
  bool good = vs_cursor_word(c, "./^%", rating.unit, sizeof rating.unit);
  if (!good || !vs_units_same_kind(rating.unit, deck->probes[rating.probe].unit))
    return vs_fail_at(err, where, "rating %s: a unit of the probe's kind is wanted here, as %s",
                      name, deck->probes[rating.probe].unit);
  status = vs_cursor_text(c, rating.text, sizeof rating.text, err);
  if (!status && deck->n_ratings >= VS_DECK_MOST)
    status = vs_fail_at(err, c->line, "more than %d ratings", VS_DECK_MOST);
  if (!status) deck->ratings[deck->n_ratings++] = rating;
  return status;
}

static vs_status read_requirement(vs_deck *deck, vs_cursor *c, vs_requirement *r, vs_error *err) {
  vs_cursor_skip(c);
  const char *begin = c->at;
  r->where = vs_cursor_here(c);
  vs_status status = vs_deck_add_formula(deck, c, "<", &r->left, err);
  if (status) return status;
  if (!vs_cursor_take(c, '<'))
    return vs_fail_at(err, vs_cursor_here(c), "an operator, '<' or '<=' is wanted here");
  r->equal = *c->at == '=';
  c->at += r->equal;
  status = vs_deck_add_formula(deck, c, "\"", &r->right, err);
  if (status) return status;
  if (vs_formula_has_terms(&r->left) || vs_formula_has_terms(&r->right))
    return vs_fail_at(err, r->where, "require: parameters are compared, no voltages and currents");
  const char *end = c->at;
  while (end > begin && strchr(" \t", end[-1])) end--;
  snprintf(r->written, sizeof r->written, "%.*s", (int)(end - begin), begin);
  return vs_cursor_text(c, r->text, sizeof r->text, err);
}

/* require FORMULA <= FORMULA "TEXT", of parameters; or <. A line that cannot be read is no
 * requirement: its formulas may have terms, which nobody could evaluate here. */
vs_status vs_parts_require(vs_deck *deck, vs_cursor *c, vs_error *err) {
  if (deck->n_requirements >= VS_DECK_MOST)
    return vs_fail_at(err, c->line, "more than %d of these lines", VS_DECK_MOST);
  vs_requirement r = {0};
  vs_status status = read_requirement(deck, c, &r, err);
  if (status) {
    vs_formula_free(&r.left);
    vs_formula_free(&r.right);
  } else
    deck->requirements[deck->n_requirements++] = r;
  return status;
}

/* More than this is no deviation of a model's: the (dv/dt)c of a triac's model is 50 times the
 * sheet's. */
static const double MOST_DEVIATION = 1000;

/* model FIGURE = DEVIATION % "TEXT" */
vs_status vs_parts_model(vs_deck *deck, vs_cursor *c, vs_error *err) {
  char value[VS_DECK_NAME], unit[VS_DECK_NAME], text[VS_DECK_TEXT], *end;
  vs_model_line m = {.where = c->line};
  vs_status status = vs_cursor_name(c, m.figure, sizeof m.figure, err);
  if (status) return status;
  vs_cursor_skip(c);
  vs_where where = vs_cursor_here(c);
  vs_cursor_token(c, value, sizeof value);
  vs_cursor_token(c, unit, sizeof unit);
  m.deviation = vs_text_to_number(value, &end) / 100;
  bool good = end != value && !*end && !strcmp(unit, "%");
  if (!good || !(m.deviation >= -1 && m.deviation <= MOST_DEVIATION))
    return vs_fail_at(err, where,
                      "model %s: how far the model's figure is from the sheet's is wanted, from "
                      "-100 %% on, as -6 %%, not '%s%s%s'; `check` of the part tells",
                      m.figure, value, *unit ? " " : "", unit);
  status = vs_cursor_text(c, text, sizeof text, err);
  const vs_model_line *other = vs_parts_find_model(deck, c->line.file, m.figure);
  if (!status && other)
    status =
        vs_fail_at(err, c->line, "model %s stands here a second time, as in line %d; leave one out",
                   m.figure, other->where.line);
  if (!status && deck->n_models >= VS_DECK_LIMITS)
    status = vs_fail_at(err, c->line, "more than %d of these lines", VS_DECK_LIMITS);
  if (!status) deck->models[deck->n_models++] = m;
  return status;
}

/* ---- once the parts are chosen ---- */

const vs_part_file *vs_parts_file(const vs_deck *deck, const char *path) {
  for (size_t k = 0; k < deck->n_part_files; k++)
    if (!strcmp(deck->part_files[k].where.file, path)) return &deck->part_files[k];
  return NULL;
}

vs_status vs_parts_check_kind(const vs_deck *deck, const vs_part *part, vs_where where,
                              vs_error *err) {
  const vs_part_file *file = vs_parts_file(deck, part->file);
  if (!*part->kind || (file && !strcmp(file->kind, part->kind))) return VS_OK;
  if (!file)
    return vs_fail_at(err, (vs_where){part->file, 1, 1},
                      "has no line '*$ part %s \"TEXT\"', which circuit.%s asks for", part->kind,
                      part->name);
  return vs_fail_at(err, where,
                    "circuit.%s: %s is a part of kind %s, and %s is wanted; see 'vibrospice list "
                    "parts'",
                    part->name, part->subcircuit, file->kind, part->kind);
}

const vs_limit *vs_parts_find_limit(const vs_deck *deck, const char *file, const char *name) {
  for (size_t k = 0; k < deck->n_limits; k++)
    if (!strcmp(deck->limits[k].where.file, file) && !strcmp(deck->limits[k].name, name))
      return &deck->limits[k];
  return NULL;
}

bool vs_parts_is_real(const vs_deck *deck, const char *file) {
  for (size_t k = 0; k < deck->n_limits; k++)
    if (isfinite(deck->limits[k].value) && !strcmp(deck->limits[k].where.file, file)) return true;
  return false;
}

static vs_status resolve_bound(const vs_deck *deck, const vs_rating *r, vs_bound *bound,
                               double *value, vs_error *err) {
  if (!*bound->part) {
    *value = bound->value * vs_units_factor(r->unit);
    return VS_OK;
  }
  size_t p = 0;
  const char *names[VS_DECK_PARTS];
  for (size_t k = 0; k < deck->n_parts; k++) names[k] = deck->parts[k].name;
  while (p < deck->n_parts && strcmp(names[p], bound->part)) p++;
  if (p == deck->n_parts && deck->lost & VS_LOST_PARAM) return VS_OK;
  if (p == deck->n_parts)
    return vs_fail_at(err, r->where, "rating: '%s' is no part of this deck%s", bound->part,
                      vs_text_hint(bound->part, names, deck->n_parts, "").text);
  if (!deck->parts[p].file) return VS_OK; /* its file was not found, and a check carries on */
  const vs_limit *limit = vs_parts_find_limit(deck, deck->parts[p].file, bound->limit);
  const vs_part_file *said = vs_parts_file(deck, deck->parts[p].file);
  if (!limit && !vs_kinds_limit_unit(bound->limit)) /* more likely a slip in the rating's line */
    return vs_fail_at(
        err, r->where,
        "rating: the part %s has no limit '%s'; a line '*$ limit %s = VALUE UNIT' (or "
        "none) in %s gives it one",
        deck->parts[p].name, bound->limit, bound->limit, deck->parts[p].file);
  if (!limit)
    return vs_fail_at(err, said ? said->where : (vs_where){deck->parts[p].file, 1, 1},
                      "has no line '*$ limit %s = VALUE UNIT' (or none), which the rating of %s at "
                      "%s:%d asks for",
                      bound->limit, deck->probes[r->probe].name, r->where.file, r->where.line);
  if (isfinite(limit->value) && !vs_units_same_kind(limit->unit, r->unit))
    return vs_fail_at(err, limit->where, "limit %s: a unit as %s is wanted, for the rating of %s",
                      limit->name, r->unit, deck->probes[r->probe].name);
  *value = bound->sign * limit->value;
  bound->unsure = limit->unsure;
  return VS_OK;
}

/* Less than this may be the voltage of a device that conducts (measure/devices/switching.c). */
static const double LEAST_OVER_V = 10;

double vs_parts_dv_dt_over(const vs_deck *deck, const char *file) {
  const vs_limit *over = file ? vs_parts_find_limit(deck, file, "dv_dt_over") : NULL;
  const vs_limit *v_drm = file ? vs_parts_find_limit(deck, file, "v_drm") : NULL;
  if (over && isfinite(over->value)) return over->value;
  return v_drm && isfinite(v_drm->value) ? fmax(v_drm->value / 10, LEAST_OVER_V) : LEAST_OVER_V;
}

double vs_parts_turn_on_s(const vs_deck *deck, const char *file) {
  const vs_limit *takes = file ? vs_parts_find_limit(deck, file, "turn_on_time") : NULL;
  return takes && isfinite(takes->value) ? takes->value : 0;
}

/* The limit dv_dt_over says over how much of a rise dv_dt is told. It limits nothing by itself. */
static vs_status check_over(const vs_deck *deck, const vs_limit *over, vs_error *err) {
  const vs_limit *v_drm = vs_parts_find_limit(deck, over->where.file, "v_drm");
  bool above = v_drm && over->value > v_drm->value && isfinite(over->value);
  if (strcmp(over->name, "dv_dt_over")) return VS_OK;
  if (isfinite(over->value) && over->value >= LEAST_OVER_V && !above) return VS_OK;
  char most[VS_DECK_NAME * 2 + 16] = "";
  if (v_drm && isfinite(v_drm->value))
    snprintf(most, sizeof most, " and up to v_drm, which is %s,", v_drm->written);
  return vs_fail_at(err, over->where,
                    "limit dv_dt_over: a voltage from %g V on%s is wanted, not '%s'; without this "
                    "line it is a tenth of v_drm",
                    LEAST_OVER_V, most, over->written);
}

/* Error: limits of one part that contradict each other. */
static vs_status check_order(const vs_deck *deck, const vs_limit *more, vs_error *err) {
  const vs_part_file *file = vs_parts_file(deck, more->where.file);
  const vs_kind *kind = file ? vs_kinds_find(file->kind) : NULL;
  for (int k = 0; kind && k < VS_KIND_RATIOS && kind->ratios[k].more; k++) {
    const vs_kind_ratio *o = &kind->ratios[k];
    if (!o->refused || strcmp(o->more, more->name)) continue;
    const vs_limit *less = vs_parts_find_limit(deck, more->where.file, o->less);
    if (!less || isinf(less->value) || less->value <= more->value) continue;
    return vs_fail_at(err, more->where,
                      "limit %s: %s is below %s, which is %s at line %d; of a %s %s is at least %s",
                      more->name, more->written, less->name, less->written, less->where.line,
                      kind->name, o->more, o->less);
  }
  return VS_OK;
}

/* Error: nothing hangs on such a figure of that kind of part. */
static vs_status check_model(const vs_deck *deck, const vs_model_line *m, vs_error *err) {
  const vs_part_file *file = vs_parts_file(deck, m->where.file);
  char *names = NULL;
  if (!file || vs_kinds_is_hung_on(file->kind, m->figure, &names)) return VS_OK;
  vs_status status = vs_fail_at(
      err, m->where, "model %s: no margin of a %s hangs on that; %s%s", m->figure, file->kind,
      names ? "those that some hang on: " : "leave it out", names ? names : "");
  free(names);
  return status;
}

/* Two figures for the same that differ by more than these factors contradict each other. One pulse
 * of a table may be narrower than that of i_surge. An i2t that is nearer may be of another width
 * than 10 ms, which `check` of the part warns of (bench/acceptance.c). */
static const double CONTRADICTS = 2, I2T_CONTRADICTS = 20;

/* Error: an i2t that is not that of a half sine of 10 ms with the peak that one surge may have. */
static vs_status check_surge(const vs_deck *deck, const vs_limit *i2t, vs_error *err) {
  static const double HALF_SINE_S = 5e-3;
  const vs_part_file *file = vs_parts_file(deck, i2t->where.file);
  const char *surge = file ? vs_kinds_surge_limit(file->kind) : NULL;
  if (!surge || strcmp(i2t->name, "i2t") || isinf(i2t->value)) return VS_OK;
  const vs_limit *peak = vs_parts_find_limit(deck, i2t->where.file, surge);
  if (!peak || isinf(peak->value)) return VS_OK;
  const double other = peak->value * peak->value * HALF_SINE_S;
  if (i2t->value <= I2T_CONTRADICTS * other && other <= I2T_CONTRADICTS * i2t->value) return VS_OK;
  return vs_fail_at(err, i2t->where,
                    "limit i2t: %s does not fit %s, which is %s at line %d: a half sine of 10 ms "
                    "with that peak has %.3g A2.s",
                    i2t->written, peak->name, peak->written, peak->where.line, other);
}

/* Error: a row of a table of pulses beyond i_surge, or one of a width that fewer pulses lack. */
static vs_status check_pulse(const vs_deck *deck, const vs_derating *d, vs_error *err) {
  const vs_limit *surge = vs_parts_find_limit(deck, d->where.file, "i_surge");
  if (surge && d->current_a > CONTRADICTS * surge->value)
    return vs_fail_at(err, d->where,
                      "pulse: %.9g A do not fit i_surge, which is %s at line %d: no pulse of the "
                      "table is beyond it",
                      d->current_a, surge->written, surge->where.line);
  for (size_t k = 0; k < deck->n_deratings; k++) {
    const vs_derating *fewer = &deck->deratings[k];
    bool ends = !strcmp(fewer->where.file, d->where.file) && fewer->number < d->number;
    for (size_t n = 0; n < deck->n_deratings && ends; n++)
      ends = strcmp(deck->deratings[n].where.file, d->where.file) ||
             deck->deratings[n].number != fewer->number || deck->deratings[n].width_s < d->width_s;
    if (ends)
      return vs_fail_at(err, d->where,
                        "pulse: %.9g us stand here for %.9g pulses, and the table has no row of "
                        "%.9g pulse%s as long; a line 'pulse %.9g us %.9g CURRENT A' is wanted",
                        1e6 * d->width_s, d->number, fewer->number, fewer->number > 1 ? "s" : "",
                        1e6 * d->width_s, fewer->number);
  }
  return VS_OK;
}

vs_status vs_parts_resolve(vs_deck *deck, vs_error *err) {
  vs_status status = VS_OK;
  size_t kept = 0;
  for (size_t k = 0; k < deck->n_limits && !status; k++)
    status = vs_error_keep(err, check_surge(deck, &deck->limits[k], err));
  for (size_t k = 0; k < deck->n_deratings && !status; k++)
    status = vs_error_keep(err, check_pulse(deck, &deck->deratings[k], err));
  for (size_t k = 0; k < deck->n_limits && !status; k++)
    status = vs_error_keep(err, check_over(deck, &deck->limits[k], err));
  for (size_t k = 0; k < deck->n_limits && !status; k++)
    status = vs_error_keep(err, check_order(deck, &deck->limits[k], err));
  for (size_t k = 0; k < deck->n_models && !status; k++)
    status = vs_error_keep(err, check_model(deck, &deck->models[k], err));
  for (size_t k = 0; k < deck->n_ratings && !status; k++) {
    vs_rating r = deck->ratings[k];
    r.min = -INFINITY;
    r.max = INFINITY;
    status = vs_error_keep(err, resolve_bound(deck, &r, &r.bounds[0], &r.min, err));
    if (!status) status = vs_error_keep(err, resolve_bound(deck, &r, &r.bounds[1], &r.max, err));
    if (!status && r.min > r.max)
      status =
          vs_error_keep(err, vs_fail_at(err, r.where,
                                        "rating: from %g to %g %s there is nothing; MIN..MAX is "
                                        "wanted",
                                        r.min / vs_units_factor(r.unit),
                                        r.max / vs_units_factor(r.unit), r.unit));
    if (isfinite(r.min) || isfinite(r.max)) deck->ratings[kept++] = r;
  }
  deck->n_ratings = kept;
  return status;
}

/* Writes the parameters that a requirement names, with their values: "a = 3 mA, b = 2 mA". *node is
 * that of the first one which the scene gives. */
static void describe(const vs_deck *deck, const vs_requirement *r, const vs_circuit_values *values,
                     const vs_node *section, const vs_node **node, vs_text *text) {
  const vs_formula *sides[] = {&r->left, &r->right};
  bool told[VS_DECK_MOST] = {false};
  for (int side = 0; side < 2; side++)
    for (size_t n = 0; n < sides[side]->count; n++) {
      int name = vs_formula_name_of(&sides[side]->ops[n]);
      for (size_t k = 1; name >= 0 && !told[name] && k < deck->section.count; k++) {
        const vs_field *f = &deck->section.fields[k];
        if (f->kind != VS_REAL || strcasecmp(f->key, deck->names[name].name)) continue;
        double si = *(const double *)(const void *)((const char *)values + f->offset);
        vs_text_add(text, "%s%s = %.9g%s%s", text->length ? ", " : "", f->key,
                    si / vs_units_factor(f->unit), *f->unit ? " " : "", f->unit);
        if (!*node) *node = vs_tree_child(section, f->key);
        told[name] = true;
      }
    }
}

vs_status vs_parts_require_hold(const vs_deck *deck, const vs_circuit_values *values,
                                const vs_node *section, vs_error *err) {
  vs_status status = VS_OK;
  if (deck->lost & VS_LOST_PARAM) return VS_OK;
  for (size_t k = 0; k < deck->n_requirements && !status; k++) {
    const vs_requirement *r = &deck->requirements[k];
    double left = vs_formula_value(&r->left, NULL), right = vs_formula_value(&r->right, NULL);
    double slack = r->equal ? 1e-12 * fabs(right) : 0; /* rounding of the conversion of units */
    if (left < right + slack || (r->equal && left == right)) continue;
    vs_text text = {0};
    const vs_node *node = NULL;
    describe(deck, r, values, section, &node, &text);
    status = vs_fail_at(err, node ? node->where : r->where, "circuit: %s is wanted%s%s%s, and %s",
                        r->written, *r->text ? " (" : "", r->text, *r->text ? ")" : "",
                        text.text ? text.text : "it is not so");
    status = vs_error_keep(err, status);
    vs_text_free(&text);
  }
  return status;
}

bool vs_parts_below_mains(const vs_deck *deck, size_t part, double rms_v, char *text, size_t size) {
  const vs_part *p = &deck->parts[part];
  const vs_part_file *file = p->file ? vs_parts_file(deck, p->file) : NULL;
  const vs_kind *kind = file ? vs_kinds_find(file->kind) : NULL;
  for (const vs_mains_limit *held = vs_kinds_mains; held->name && p->file; held++) {
    const vs_limit *limit = vs_parts_find_limit(deck, p->file, held->name);
    if (!limit || (kind && kind->stores)) continue;
    if (limit->value >= held->factor * rms_v * (1 - 1e-12)) continue; /* but for rounding */
    snprintf(text, size, "circuit.%s: %s of %s, %s, is below the mains: %.6g V %s", p->name,
             limit->name, p->subcircuit, limit->written, held->factor * rms_v, held->what);
    return true;
  }
  return false;
}

/* True where a rating of the deck names this limit. */
static bool is_rated_by(const vs_deck *deck, const vs_limit *limit) {
  for (size_t k = 0; k < deck->n_ratings; k++)
    for (int b = 0; b < 2; b++)
      for (size_t p = 0; p < deck->n_parts; p++)
        if (deck->parts[p].file && !strcmp(deck->parts[p].file, limit->where.file) &&
            !strcmp(deck->parts[p].name, deck->ratings[k].bounds[b].part) &&
            !strcmp(limit->name, deck->ratings[k].bounds[b].limit))
          return true;
  return false;
}

bool vs_parts_limit_is_left(const vs_deck *deck, const vs_limit *limit) {
  const vs_part_file *file = vs_parts_file(deck, limit->where.file);
  return file && isfinite(limit->value) && !is_rated_by(deck, limit) &&
         vs_kinds_leaves_limit(file->kind, limit->name);
}

bool vs_parts_limit_is_idle(const vs_deck *deck, size_t number, char *text, size_t size) {
  const vs_limit *limit = &deck->limits[number];
  const vs_part_file *file = vs_parts_file(deck, limit->where.file);
  const char *nearest;
  if (!file || isinf(limit->value) || is_rated_by(deck, limit)) return false;
  if (vs_kinds_knows_limit(file->kind, limit->name, &nearest)) return false;
  const char *slash = strrchr(limit->where.file, '/');
  snprintf(text, size, "limit %s of %s: no measure of a %s and no rating is held to it%s%s%s",
           limit->name, slash ? slash + 1 : limit->where.file, file->kind,
           nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
  return true;
}

/* ---- the model beside the sheet ---- */

const vs_model_line *vs_parts_find_model(const vs_deck *deck, const char *file,
                                         const char *figure) {
  for (size_t k = 0; k < deck->n_models; k++)
    if (!strcmp(deck->models[k].where.file, file) && !strcmp(deck->models[k].figure, figure))
      return &deck->models[k];
  return NULL;
}

static const vs_model_line *model_of(const vs_deck *deck, const vs_device *d, const char *figure) {
  const char *file = d->part >= 0 ? deck->parts[d->part].file : NULL;
  return file ? vs_parts_find_model(deck, file, figure) : NULL;
}

/* The voltage between two nodes that a device's is, either way round; NULL: it is another. */
static const vs_term *voltage_of(const vs_deck *deck, const vs_device *d) {
  int term;
  double factor;
  bool is = vs_formula_is_term(&d->voltage, &term, &factor);
  return is && fabs(factor) == 1 ? &deck->terms[term] : NULL;
}

static bool is_across(const vs_term *a, const vs_term *b) {
  return a && b &&
         ((!strcmp(a->plus, b->plus) && !strcmp(a->minus, b->minus)) ||
          (!strcmp(a->plus, b->minus) && !strcmp(a->minus, b->plus)));
}

/* Adds what the parts that clamp the voltage of these nodes say of their clamping voltage. */
static size_t add_clamps(const vs_deck *deck, const vs_term *nodes, vs_model_beside *out) {
  size_t n = 0;
  for (size_t k = 0; k < deck->n_devices && n < VS_MODELS_BESIDE; k++) {
    const vs_device *d = &deck->devices[k];
    if (!d->kind || !d->kind->clamps || !is_across(voltage_of(deck, d), nodes)) continue;
    const vs_model_line *line = model_of(deck, d, "v_clamp");
    if (line) out[n++] = (vs_model_beside){line, d};
  }
  return n;
}

size_t vs_parts_models(const vs_deck *deck, const vs_device *d, const vs_device_measure *measure,
                       vs_model_beside out[VS_MODELS_BESIDE]) {
  const char *figure;
  if (!d->kind) return 0;
  bool clamped = measure->how == VS_R_PEAK && measure->of == VS_OF_V && !d->kind->clamps;
  size_t n = clamped ? add_clamps(deck, voltage_of(deck, d), out) : 0;
  for (size_t k = 0; n < VS_MODELS_BESIDE && (figure = vs_kinds_hanging(d->kind, measure->name, k));
       k++) {
    const vs_model_line *own = model_of(deck, d, figure);
    if (own) out[n++] = (vs_model_beside){own, NULL};
  }
  return n;
}

size_t vs_parts_models_across(const vs_deck *deck, const vs_probe *probe,
                              vs_model_beside out[VS_MODELS_BESIDE]) {
  return add_clamps(deck, &deck->terms[probe->term], out);
}
