/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report_columns.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "run/listed_line.h"

int vs_report_columns_add(vs_plan *plan, const char *measure, vs_where where) {
  if (!strcmp(measure, "margin_least")) return VS_COLUMN_MARGIN;
  for (size_t k = 0; k < plan->n_columns; k++)
    if (!strcmp(plan->columns[k].name, measure)) return (int)k;
  if (plan->n_columns >= VS_PLAN_REPORT)
    return VS_COLUMN_MARGIN; /* vs_report_columns_read refuses a study with so many */
  vs_report_column *column = &plan->columns[plan->n_columns];
  *column = (vs_report_column){.rating = NAN, .where = where};
  snprintf(column->name, sizeof column->name, "%s", measure);
  return (int)plan->n_columns++;
}

vs_status vs_report_columns_derive(vs_plan *plan, const vs_sensitivity_order *order, vs_where where,
                                   vs_error *err) {
  size_t entries = order->n_of * order->n_to;
  if (2 * entries > VS_PLAN_REPORT - plan->n_columns)
    return vs_fail_at(err, where,
                      "sensitivity: %zu derivatives with their errors; there is room "
                      "for %zu",
                      entries, (VS_PLAN_REPORT - plan->n_columns) / 2);
  for (size_t k = 0; k < 2 * entries; k++) {
    vs_report_column *column = &plan->columns[plan->n_columns++];
    const char *of = order->of[k / 2 / order->n_to].name;
    const char *to = order->to[k / 2 % order->n_to].name;
    *column = (vs_report_column){.rating = NAN, .where = where};
    column->derivative = (k % 2 ? -1 : 1) * (int)(1 + k / 2);
    snprintf(column->name, sizeof column->name, "%s_to_%s%s", of, to, k % 2 ? "_error" : "");
    memcpy(column->column, column->name, sizeof column->name);
    snprintf(column->of, sizeof column->of, "%.63s", of);
    snprintf(column->text, sizeof column->text, "%sd ln|%s| / d ln %s", k % 2 ? "error of " : "",
             of, to);
  }
  plan->derivatives = order;
  return VS_OK;
}

/* Adds the columns of an orbit that nobody has to ask for. */
static void add_usual(vs_plan *plan) {
  const vs_steady blank = {.model = &plan->base->setup.model};
  vs_listed_measure m;
  for (int k = 0; vs_orbit_columns_default(&blank, k, &m); k++)
    vs_report_columns_add(plan, m.name, (vs_where){0});
}

vs_status vs_report_columns_read(vs_plan *plan, vs_error *err) {
  const vs_node *list = vs_tree_child(plan->tree.root, "report");
  size_t room = VS_PLAN_REPORT - plan->n_columns, n = 0;
  vs_status status = VS_OK;
  if (!list || (list->kind == VS_NODE_TEXT && !*list->text)) {
    vs_measure m;
    for (int k = 0; vs_measure_at(&plan->base->setup.model, k, &m); k++)
      vs_report_columns_add(plan, m.name, (vs_where){0});
    if (plan->periods) add_usual(plan);
    return VS_OK;
  }
  for (const vs_node *item = list->kind == VS_NODE_LIST ? list->child : list; item && !status;
       item = list->kind == VS_NODE_LIST ? item->next : NULL) {
    if (item->kind != VS_NODE_TEXT || !*item->text || strlen(item->text) >= VS_JUDGED_NAME)
      status = vs_fail_at(err, item->where, "report: names of measures are wanted: [p_min, ...]");
    else if (++n > room)
      status = vs_fail_at(err, item->where, "report: more than %d columns", VS_PLAN_REPORT);
    else
      vs_report_columns_add(plan, item->text, item->where);
    status = vs_error_keep(err, status);
  }
  return status;
}

static vs_status unknown_measure(const vs_report_column *column, const vs_orbit_columns *of,
                                 const vs_tier *tier, vs_error *err) {
  enum { MOST = 1024 };
  vs_listed_measure *all = vs_alloc(MOST, sizeof *all);
  const char **names = vs_alloc(MOST, sizeof *names);
  size_t n = 0;
  while (n < MOST && vs_orbit_columns_at(of, (int)n, &all[n])) {
    names[n] = all[n].name;
    n++;
  }
  vs_fail_at(err, column->where, "no measure '%s' on tier %s%s", column->name, tier->name,
             vs_text_hint(column->name, names, n, "; see 'vibrospice list measures'").text);
  free(all);
  free(names);
  return VS_INPUT;
}

/* What the columns of a scene are found in: a run of it that has not begun. */
typedef struct blank {
  vs_frame frame;
  vs_result result;
  vs_steady steady;
  vs_orbit_columns of;
} blank;

static void begin_blank(blank *b, const vs_plan *plan, const vs_scene *scene, const vs_tier *tier) {
  b->frame = vs_sim_frame(tier, &scene->setup);
  b->result.scene = scene;
  vs_watchers_begin(&b->result.watchers, &b->frame, NULL);
  vs_result_begin_quality(&b->result, scene);
  b->steady = (vs_steady){.model = &scene->setup.model, .devices = b->result.watchers.devices};
  b->of = (vs_orbit_columns){&b->frame, &b->result, plan->periods ? &b->steady : NULL};
}

static void fill_column(vs_report_column *column, const vs_listed_measure *m, bool line) {
  char suffix[64];
  snprintf(column->name, sizeof column->name, "%s", m->name);
  snprintf(column->unit, sizeof column->unit, "%s", m->unit);
  snprintf(column->of, sizeof column->of, "%s", m->of);
  snprintf(column->text, sizeof column->text, "%s", m->text);
  snprintf(column->limit_unit, sizeof column->limit_unit, "%s", m->limit_unit ? m->limit_unit : "");
  column->rating = m->limit;
  column->at_least = m->at_least;
  column->own = m->own;
  column->unsure = m->unsure;
  column->left_out_by = m->left_out_by;
  column->sense = m->sense;
  column->line = line;
  vs_units_suffix(m->unit, suffix, sizeof suffix);
  snprintf(column->column, sizeof column->column, "%s%s%.20s", m->name, *suffix ? "_" : "", suffix);
}

static bool find_measure(const vs_orbit_columns *of, const char *name, vs_listed_measure *m) {
  for (int k = 0; vs_orbit_columns_at(of, k, m); k++)
    if (!strcmp(m->name, name)) return true;
  return false;
}

static bool find_line(const blank *b, const char *name, vs_listed_measure *m) {
  for (int k = 0; vs_listed_line_at(&b->frame, &b->result, k, m); k++)
    if (!strcmp(m->name, name)) return true;
  return false;
}

vs_status vs_report_columns_resolve(vs_plan *plan, const vs_scene *scene, const vs_tier *tier,
                                    vs_error *err) {
  blank *b = vs_alloc(1, sizeof *b);
  vs_status status = VS_OK;
  begin_blank(b, plan, scene, tier);
  for (size_t c = 0; c < plan->n_columns && !status; c++) {
    vs_report_column *column = &plan->columns[c];
    vs_listed_measure m;
    if (column->derivative) continue;
    const bool line = find_line(b, column->name, &m);
    if (line || find_measure(&b->of, column->name, &m))
      fill_column(column, &m, line);
    else
      status = vs_error_keep(err, unknown_measure(column, &b->of, tier, err));
  }
  vs_result_free(&b->result);
  free(b);
  return status;
}

/* The plan's column of that name; NULL: it has none. */
static vs_report_column *find_column(vs_plan *plan, const char *name) {
  for (size_t c = 0; c < plan->n_columns; c++)
    if (!strcmp(plan->columns[c].name, name)) return &plan->columns[c];
  return NULL;
}

/* True if an axis is that rating of the scene's own. */
static bool is_varied(const vs_plan *plan, const char *number) {
  for (size_t k = 0; k < plan->n_axes; k++)
    if (!strncmp(plan->axes[k].key, "ratings.", 8) &&
        !strcmp(plan->axes[k].key + 8, strchr(number, '.') + 1))
      return true;
  return false;
}

/* Adds the column of a line's number or, if there is one, sees whether it has the same limit. */
static vs_status add_line(vs_plan *plan, const vs_listed_measure *m, vs_error *err) {
  vs_report_column *column = find_column(plan, m->name);
  if (!column && plan->n_columns == VS_PLAN_COLUMNS)
    return vs_fail_at(err, plan->scene_where,
                      "the verdict has more lines than the %d columns of a study have room for",
                      VS_PLAN_COLUMNS);
  if (!column) fill_column(column = &plan->columns[plan->n_columns++], m, true);
  const bool varied = is_varied(plan, m->name);
  const bool other = strcmp(column->limit_unit, m->limit_unit ? m->limit_unit : "") != 0;
  if (column->rating != m->limit || other || varied) column->rating = NAN;
  if (column->sense != m->sense || varied) column->sense = 0;
  if (column->left_out_by != m->left_out_by) column->left_out_by = 0;
  column->unsure |= m->unsure;
  return VS_OK;
}

/* Error: a device whose measures would pass for lines. */
static vs_status check_device_names(const vs_plan *plan, const vs_scene *scene, vs_error *err) {
  char number[VS_DECK_NAME + 8];
  for (size_t k = 0; k < scene->setup.deck.n_devices; k++) {
    const char *name = scene->setup.deck.devices[k].name;
    snprintf(number, sizeof number, "%s.", name);
    if (vs_listed_line_is(number))
      return vs_fail_at(
          err, plan->scene_where,
          "the deck has a device '%s'; margin, error and at are what the columns of a "
          "study begin with: give the device another name",
          name);
  }
  return VS_OK;
}

vs_status vs_report_columns_add_lines(vs_plan *plan, const vs_scene *scene, vs_error *err) {
  blank *b = vs_alloc(1, sizeof *b);
  vs_listed_measure m;
  vs_status status = check_device_names(plan, scene, err);
  begin_blank(b, plan, scene, scene->tier);
  for (int k = 0; !status && vs_listed_line_at(&b->frame, &b->result, k, &m); k++)
    status = add_line(plan, &m, err);
  vs_result_free(&b->result);
  free(b);
  return status;
}
