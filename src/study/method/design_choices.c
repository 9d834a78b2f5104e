/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "method/design_choices.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/formula.h"
#include "base/units.h"
#include "netlist/kinds.h"
#include "report_columns.h"

/* Candidates at most: the search keeps eight bytes for each. */
enum { MOST_CANDIDATES = 20000000, MOST_OPTIONS = 512 };

static const char NONE[] = "none", START[] = "0 ms"; /* as study/threats.h puts `from: start` */

/* ---- candidates ---- */

size_t vs_design_choices_option(const vs_design *d, uint64_t k, size_t choice) {
  for (size_t c = 0; c < d->choice[choice].leader; c++)
    if (d->choice[c].leader == c) k /= d->choice[c].n_options;
  return (size_t)(k % d->choice[d->choice[choice].leader].n_options);
}

uint64_t vs_design_choices_with(const vs_design *d, uint64_t k, size_t choice, size_t option) {
  uint64_t weight = 1;
  const size_t now = vs_design_choices_option(d, k, choice);
  for (size_t c = 0; c < d->choice[choice].leader; c++)
    if (d->choice[c].leader == c) weight *= d->choice[c].n_options;
  return k + weight * option - weight * now;
}

double vs_design_choices_price(const vs_design *d, uint64_t k, const size_t *class) {
  double price = 0;
  for (size_t c = 0; c < d->n_choices; c++) {
    const size_t leader = d->choice[c].leader;
    const vs_design_option *o = &d->choice[leader].option[vs_design_choices_option(d, k, leader)];
    price += d->choice[c].number * o->classes[class ? class[leader] : 0].price;
  }
  return vs_text_rounded(price, 12);
}

double vs_design_choices_dearest(const vs_design *d) {
  double price = 0;
  for (size_t c = 0; c < d->n_choices; c++) {
    const vs_design_choice *leader = &d->choice[d->choice[c].leader];
    double most = -INFINITY;
    for (size_t k = 0; k < leader->n_options; k++)
      for (size_t n = 0; n < leader->option[k].n_classes; n++)
        most = fmax(most, leader->option[k].classes[n].price);
    price += d->choice[c].number * most;
  }
  return vs_text_rounded(price, 12);
}

void vs_design_choices_write_option(const vs_design *d, const vs_plan *plan, uint64_t k,
                                    size_t choice, vs_text *text) {
  const vs_design_choice *leader = &d->choice[d->choice[choice].leader];
  const vs_axis *axis = &plan->axes[leader->axis];
  char word[VS_NAME_SIZE];
  vs_axis_print(axis, leader->option[vs_design_choices_option(d, k, choice)].number, word,
                sizeof word);
  vs_text_add(text, "%s%s%s", word, *axis->unit ? " " : "", axis->unit);
}

void vs_design_choices_write(const vs_design *d, const vs_plan *plan, uint64_t k, vs_text *text) {
  const char *between = "";
  for (size_t c = 0; c < d->n_choices; c++) {
    if (d->choice[c].leader != c) continue;
    vs_text_add(text, "%s", between);
    vs_design_choices_write_option(d, plan, k, c, text);
    between = ", ";
  }
}

/* True if the device is made of the choice: its name is what the key ends in, or its part's is. */
static bool makes_device(const vs_design_choice *c, const vs_deck *deck, const vs_device *device) {
  return !strcmp(device->name, c->device) ||
         (device->part >= 0 && !strcmp(deck->parts[device->part].name, c->device));
}

bool vs_design_choices_makes_line(const vs_design_choice *c, const vs_deck *deck,
                                  const char *line) {
  const size_t n = strcspn(line, ".");
  for (size_t k = 0; k < deck->n_devices; k++)
    if (strlen(deck->devices[k].name) == n && !strncmp(deck->devices[k].name, line, n))
      return makes_device(c, deck, &deck->devices[k]);
  return false;
}

const char *vs_design_choices_part(const vs_design *d, const vs_design_class *class) {
  if (class->row == VS_DESIGN_NONE) return NONE;
  return vs_price_list_cell(&d->list, class->row, d->list.part)->text;
}

static bool is_lacking(const vs_design_choice *c, const double *point) {
  return c->may_lack && point[c->axis] == c->lacking;
}

bool vs_design_choices_lacks(const vs_design *d, const double *point, const char *line) {
  const size_t n = strcspn(line, ".");
  for (size_t c = 0; c < d->n_choices; c++)
    for (size_t k = 0; k < d->choice[c].n_lacked && is_lacking(&d->choice[c], point); k++)
      if (strlen(d->choice[c].lacked[k]) == n && !strncmp(d->choice[c].lacked[k], line, n))
        return true;
  return false;
}

/* The scene's event that opens the source, whenever it does; NULL: there is none. */
static const vs_node *opening_of(const vs_tree *tree, const char *source) {
  const vs_node *events = vs_tree_child(tree->root, "events");
  for (const vs_node *e = events ? events->child : NULL; e; e = e->next) {
    const vs_node *kind = vs_tree_child(e, "kind"), *element = vs_tree_child(e, "element");
    if (kind && kind->text && !strcmp(kind->text, "open") && element && element->text &&
        !strcasecmp(element->text, source))
      return e;
  }
  return NULL;
}

/* Opens the source from the start, by the event that would open it later where there is one. */
static void open_source(const char *source, const char *device, vs_where where, vs_tree *tree) {
  const vs_node *later = opening_of(tree, source);
  vs_node at = vs_tree_word("at", START, where), element = vs_tree_word("element", source, where),
          kind = vs_tree_word("kind", "open", where);
  vs_error never = {0};
  char name[2 * VS_KEY_SIZE];
  kind.next = &element;
  element.next = &at;
  snprintf(name, sizeof name, later ? "events.%.90s" : "events.without_%.90s",
           later ? later->key : device);
  const vs_node map = vs_tree_map(NULL, &kind);
  vs_tree_graft(tree, name, &map, &never);
}

/* Adds the word to a list of the tree, unless it is there. */
static void add_to_list(vs_tree *tree, const char *key, const char *word, vs_where where) {
  vs_tree copy;
  vs_error never = {0};
  vs_node added = vs_tree_word(NULL, word, where), list = {.kind = VS_NODE_LIST, .where = where};
  list.key_where = where;
  vs_tree_copy(tree, &copy);
  vs_node *own = (vs_node *)(uintptr_t)vs_tree_child(copy.root, key), *last = NULL, lone;
  for (vs_node *n = own && own->kind == VS_NODE_LIST ? own->child : NULL; n; n = n->next) {
    if (n->text && !strcmp(n->text, word)) added.text = NULL;
    last = n;
  }
  list.child = last ? own->child : &added;
  if (own && own->kind == VS_NODE_TEXT && *own->text) { /* it stands for a list of it */
    lone = (vs_node){.kind = VS_NODE_TEXT, .text = own->text, .where = own->where};
    list.child = last = &lone;
  }
  if (last) last->next = added.text ? &added : NULL;
  vs_tree_graft(tree, key, &list, &never);
  if (last) last->next = NULL;
  vs_tree_free(&copy);
}

/* A part that is left out is its device's source opened from the start, and its device waived. */
void vs_design_choices_put(const vs_design *d, const vs_plan *plan, size_t choice,
                           const double *point, vs_tree *tree) {
  const vs_design_choice *c = &d->choice[choice];
  const size_t axis = c->tolerance ? c->tolerance - 1 : c->axis;
  if (!is_lacking(c, point)) {
    vs_axis_put(&plan->axes[axis], point[axis], 12, tree);
    return;
  }
  for (size_t k = 0; k < c->n_lacked; k++) {
    add_to_list(tree, "waive", c->lacked[k], c->node->where);
    open_source(c->source[k], c->lacked[k], c->node->where, tree);
  }
}

/* Without threats nothing else puts back what the scene has there. */
void vs_design_choices_put_back(const vs_design *d, const vs_plan *plan, vs_tree *tree) {
  static const char *const KEYS[] = {"events", "waive"};
  for (int k = 0; k < 2 && !d->cases.threats; k++)
    vs_tree_put_back(tree, &plan->base->tree, KEYS[k]);
}

/* ---- what is to be least ---- */

typedef struct columns {
  const vs_price_list *list;
  char unknown[VS_KEY_SIZE]; /* the first name that is no column; empty: all are */
} columns;

static int column_named(void *ctx, const char *at, const char *name) {
  columns *c = ctx;
  const size_t column = vs_price_list_column(c->list, name);
  (void)at;
  if (column != SIZE_MAX) return (int)column;
  if (!*c->unknown) snprintf(c->unknown, sizeof c->unknown, "%s", name);
  return -1;
}

static vs_status no_formula(const vs_design *d, const char *unknown, const char *why,
                            vs_error *err) {
  if (!*unknown) return vs_fail_at(err, d->aim->where, "aim.least: %s", why);
  return vs_fail_at(
      err, d->aim->where, "aim.least: %s has no column '%s'%s", d->list.path, unknown,
      vs_text_hint(unknown, (const char *const *)d->list.title, d->list.columns,
                   "; a column of numbers is wanted, or a sum as price + 0.02 * volume_cm3")
          .text);
}

/* Gives every row its price. Error: a column is missing, or has no number in that row. */
static vs_status price_of_row(const vs_design *d, size_t row, double *price, vs_error *err) {
  columns of = {.list = &d->list};
  const vs_formula_scope scope = {.ctx = &of, .name = column_named, .of_machine = true};
  vs_formula formula = {0};
  const char *bad = "";
  char why[256] = "";
  double *values = vs_alloc(d->list.columns, sizeof *values);
  const char *end = vs_formula_read(d->aim->text, &scope, &formula, &bad, why, sizeof why);
  vs_status status = VS_OK;
  if (!end || *end) status = no_formula(d, of.unknown, end ? "a formula is wanted" : why, err);
  for (size_t k = 0; !status && k < formula.count; k++) {
    const int column = vs_formula_name_of(&formula.ops[k]);
    if (column >= 0)
      status = vs_price_list_number(&d->list, row, (size_t)column, &values[column], err);
  }
  if (!status) {
    vs_formula_bind(&formula, values);
    *price = vs_formula_value(&formula, NULL);
    if (!isfinite(*price))
      status = vs_fail_at(err, d->aim->where, "aim.least: of %s it is no number",
                          vs_price_list_cell(&d->list, row, d->list.part)->text);
  }
  vs_formula_free(&formula);
  free(values);
  return status;
}

/* ---- options ---- */

static int by_price(const void *a, const void *b) {
  const vs_design_class *x = a, *y = b;
  return x->price != y->price ? (x->price < y->price ? -1 : 1) : x->row < y->row ? -1 : 1;
}

/* Reads what the row's columns say that it bears. */
static vs_status read_limits(const vs_design *d, const vs_design_choice *c, vs_design_class *class,
                             vs_error *err) {
  vs_status status = VS_OK;
  for (size_t l = 0; l < c->n_limits && !status; l++) {
    class->limit[l] = NAN;
    if (!*vs_price_list_cell(&d->list, class->row, c->limit_column[l])->text) continue;
    status = vs_price_list_number(&d->list, class->row, c->limit_column[l], &class->limit[l], err);
    if (!status && !(class->limit[l] > 0))
      status = vs_fail_at(err, vs_price_list_cell(&d->list, class->row, c->limit_column[l])->where,
                          "%s of %s: more than 0 is wanted, or an empty cell",
                          d->list.title[c->limit_column[l]],
                          vs_price_list_cell(&d->list, class->row, d->list.part)->text);
    class->limit[l] *= vs_units_factor(vs_kinds_limit_unit(c->measure[l]->limit));
  }
  return status;
}

/* Adds the option, or the row to the option of the same number. */
static vs_status add_row(const vs_design *d, vs_design_choice *c, double number, size_t row,
                         vs_error *err) {
  size_t k = 0;
  vs_design_class class = {.row = row};
  vs_status status = price_of_row(d, row, &class.price, err);
  if (!status) status = read_limits(d, c, &class, err);
  if (status) return status;
  while (k < c->n_options && c->option[k].number != number) k++;
  if (k == MOST_OPTIONS)
    return vs_fail_at(err, c->node->where, "%s: more than %d options", c->node->key, MOST_OPTIONS);
  if (k == c->n_options) {
    c->option = vs_alloc_grow(c->option, c->n_options, sizeof *c->option);
    c->option[c->n_options++] = (vs_design_option){.number = number};
  }
  vs_design_option *o = &c->option[k];
  o->classes = vs_alloc_grow(o->classes, o->n_classes, sizeof *o->classes);
  o->classes[o->n_classes++] = class;
  qsort(o->classes, o->n_classes, sizeof *o->classes, by_price);
  return VS_OK;
}

static vs_status add_part(vs_plan *plan, const vs_design *d, vs_design_choice *c, size_t row,
                          vs_error *err) {
  const vs_price_cell *cell = vs_price_list_cell(&d->list, row, d->list.part);
  const vs_node node = vs_tree_word(NULL, cell->text, cell->where);
  double number;
  vs_status status = vs_axis_number(&plan->axes[c->axis], &node, &number, err);
  return status ? status : add_row(d, c, number, row, err);
}

/* Adds "diode, zener". */
static void write_kinds(const vs_design_choice *c, vs_text *text) {
  for (size_t k = 0; k < c->n_kinds; k++)
    vs_text_add(text, "%s%s", k ? ", " : "", c->kind[k]->name);
}

static bool is_of_kind(const vs_design *d, const vs_design_choice *c, size_t row) {
  const char *kind = vs_price_list_cell(&d->list, row, d->list.kind)->text;
  for (size_t k = 0; k < c->n_kinds; k++)
    if (!strcmp(kind, c->kind[k]->name)) return true;
  return false;
}

static vs_status add_named(vs_plan *plan, const vs_design *d, vs_design_choice *c,
                           const vs_node *name, vs_error *err) {
  const size_t r = name->kind == VS_NODE_TEXT ? vs_price_list_find(&d->list, name->text) : SIZE_MAX;
  vs_text kinds = {0};
  if (r == SIZE_MAX)
    return vs_fail_at(err, name->where, "%s: %s has no part '%s'", c->node->key, d->list.path,
                      name->kind == VS_NODE_TEXT ? name->text : "");
  if (is_of_kind(d, c, r)) return add_part(plan, d, c, r, err);
  write_kinds(c, &kinds);
  vs_status status =
      vs_fail_at(err, name->where, "%s: %s is a %s in %s; a %s is wanted", c->node->key, name->text,
                 vs_price_list_cell(&d->list, r, d->list.kind)->text, d->list.path, kinds.text);
  vs_text_free(&kinds);
  return status;
}

/* The parts of these kinds, or those of them that `parts` names. */
static vs_status read_parts(vs_plan *plan, const vs_design *d, vs_design_choice *c, vs_error *err) {
  const vs_node *parts = vs_tree_child(c->node, "parts");
  vs_status status = VS_OK;
  for (size_t k = 0; k < c->n_kinds && !parts; k++)
    for (size_t r = 0;
         !status && (r = vs_price_list_next(&d->list, c->kind[k]->name, r)) != SIZE_MAX; r++)
      status = vs_error_keep(err, add_part(plan, d, c, r, err));
  for (const vs_node *n = parts && parts->kind == VS_NODE_LIST ? parts->child : parts; n && !status;
       n = parts->kind == VS_NODE_LIST ? n->next : NULL)
    status = vs_error_keep(err, add_named(plan, d, c, n, err));
  return status;
}

static vs_status number_of_text(vs_axis *axis, const char *text, vs_where where, double *number,
                                vs_error *err) {
  const vs_node node = vs_tree_word(NULL, text, where);
  return vs_axis_number(axis, &node, number, err);
}

/* The numbers that `series` or `values` lists; without them those of the list's rows are meant. */
static vs_status list_numbers(vs_axis *axis, const vs_design_choice *c, double *number,
                              size_t *count, vs_error *err) {
  const vs_node *series = vs_tree_child(c->node, "series"),
                *values = vs_tree_child(c->node, "values"), *from = vs_tree_child(c->node, "from"),
                *to = vs_tree_child(c->node, "to");
  vs_status status = VS_OK;
  double end[2];
  if (series) {
    if (!from || !to)
      return vs_fail_at(err, series->where, "%s: from and to are wanted besides series",
                        c->node->key);
    status = vs_axis_number(axis, from, &end[0], err);
    if (!status) status = vs_axis_number(axis, to, &end[1], err);
    if (status) return status;
    *count = vs_price_list_series(series->text ? series->text : "", end[0], end[1], number,
                                  MOST_OPTIONS);
    if (*count && *count <= MOST_OPTIONS) return VS_OK;
    return vs_fail_at(err, series->where,
                      *count ? "%s: series '%s' has more values there than can be chosen from"
                             : "%s: series '%s' has no value there; E3, E6, E12, E24, E48, E96 or "
                               "E192 is wanted, and from below to",
                      c->node->key, series->text ? series->text : "");
  }
  for (const vs_node *n = values && values->kind == VS_NODE_LIST ? values->child : values;
       n && !status && *count < MOST_OPTIONS; n = values->kind == VS_NODE_LIST ? n->next : NULL)
    status = vs_error_keep(err, vs_axis_number(axis, n, &number[(*count)++], err));
  return status;
}

/* Adds the row for each listed number that it may have; for its own where none are listed. */
static vs_status add_values(vs_axis *axis, const vs_design *d, vs_design_choice *c, size_t row,
                            const double *number, size_t count, vs_error *err) {
  const vs_price_cell *cell =
      d->list.value == SIZE_MAX ? NULL : vs_price_list_cell(&d->list, row, d->list.value);
  const bool any = !cell || !*cell->text;
  double own = NAN;
  vs_status status = VS_OK;
  if (!any) status = number_of_text(axis, cell->text, cell->where, &own, err);
  if (!any && !status && !count) return add_row(d, c, own, row, err);
  for (size_t k = 0; k < count && !status; k++)
    if (any || own == number[k]) status = add_row(d, c, number[k], row, err);
  return status;
}

static vs_status read_values(vs_plan *plan, const vs_design *d, vs_design_choice *c,
                             vs_error *err) {
  vs_axis *axis = &plan->axes[c->axis];
  double *number = vs_alloc(MOST_OPTIONS, sizeof *number);
  size_t count = 0;
  vs_status status = list_numbers(axis, c, number, &count, err);
  for (size_t r = 0; !status && (r = vs_price_list_next(&d->list, c->kind[0]->name, r)) != SIZE_MAX;
       r++)
    status = vs_error_keep(err, add_values(axis, d, c, r, number, count, err));
  free(number);
  return status;
}

/* Values rise. Parts by name get dearer, so that the one before is "one size smaller". */
static int by_number(const void *a, const void *b) {
  const vs_design_option *x = a, *y = b;
  return x->number < y->number ? -1 : x->number > y->number;
}
static int by_first_price(const void *a, const void *b) {
  const vs_design_option *x = a, *y = b;
  return by_price(x->classes, y->classes);
}

/* ---- a choice ---- */

/* Finds which limits of the kind the list has columns for: "p_rated_w". */
static void find_limits(const vs_design *d, vs_design_choice *c) {
  char title[VS_KEY_SIZE], suffix[64];
  for (size_t m = 0; m < c->kind[0]->n_measures; m++) {
    const vs_device_measure *measure = &c->kind[0]->measures[m];
    if (!measure->limit || measure->held != VS_AT_MOST || c->n_limits == VS_DESIGN_LIMITS) continue;
    vs_units_suffix(vs_kinds_limit_unit(measure->limit), suffix, sizeof suffix);
    snprintf(title, sizeof title, "%s_%s", measure->limit, suffix);
    const size_t column = vs_price_list_column(&d->list, title);
    if (column == SIZE_MAX) continue;
    c->measure[c->n_limits] = measure;
    c->limit_column[c->n_limits++] = column;
  }
}

/* Asks for the columns of what the choice's device bears. */
static vs_status want_measures(vs_plan *plan, const vs_design *d, vs_design_choice *c,
                               vs_error *err) {
  const vs_design_choice *leader = &d->choice[c->leader];
  const vs_deck *deck = &plan->base->setup.deck;
  char name[2 * VS_KEY_SIZE];
  bool found = false;
  for (size_t k = 0; k < deck->n_devices; k++)
    found = found || !strcmp(deck->devices[k].name, c->device);
  if (!found)
    return vs_fail_at(err, c->node->key_where,
                      "%s: the deck measures no device '%s', so that nothing tells what a %s there "
                      "has to bear; a line `*$ device %s %s = ...` is wanted",
                      c->node->key, c->device, leader->kind[0]->name, c->device,
                      leader->kind[0]->name);
  for (size_t l = 0; l < leader->n_limits; l++) {
    snprintf(name, sizeof name, "%s.%s", c->device, leader->measure[l]->name);
    c->column[l] = vs_report_columns_add(plan, name, c->node->key_where);
  }
  return VS_OK;
}

/* Error: of a value's rows one says nothing of what it bears, in none of the list's columns. */
static vs_status check_limits(const vs_design *d, const vs_design_choice *c, vs_error *err) {
  const bool resistor = !strcmp(c->kind[0]->name, "resistor");
  for (size_t k = 0; k < c->n_options; k++)
    for (size_t n = 0; n < c->option[k].n_classes; n++) {
      const vs_design_class *class = &c->option[k].classes[n];
      bool says = false;
      for (size_t l = 0; l < c->n_limits; l++) says = says || !isnan(class->limit[l]);
      if (says) continue;
      return vs_fail_at(err, vs_price_list_cell(&d->list, class->row, d->list.part)->where,
                        "%s: no column says what this %s bears; %s is wanted",
                        vs_price_list_cell(&d->list, class->row, d->list.part)->text,
                        c->kind[0]->name, resistor ? "p_rated_w" : "v_class_v");
    }
  return VS_OK;
}

static vs_status empty_choice(const vs_design *d, const vs_design_choice *c, vs_error *err) {
  const size_t any = vs_price_list_next(&d->list, c->kind[0]->name, 0);
  vs_text kinds = {0};
  write_kinds(c, &kinds);
  vs_status status =
      vs_fail_at(err, c->node->where, "%s: nothing to choose from: %s has no %s%s", c->node->key,
                 d->list.path, kinds.text, any == SIZE_MAX ? "" : " of these values");
  vs_text_free(&kinds);
  return status;
}

static vs_status add_kind(vs_design_choice *c, const vs_node *word, vs_error *err) {
  const char *names[64], *text = word->kind == VS_NODE_TEXT ? word->text : "";
  const vs_kind *kind = vs_kinds_find(text);
  size_t n = 0;
  if (kind && c->n_kinds == VS_DESIGN_KINDS)
    return vs_fail_at(err, word->where, "%s: more than %d kinds", c->node->key, VS_DESIGN_KINDS);
  if (kind) {
    c->kind[c->n_kinds++] = kind;
    return VS_OK;
  }
  for (const vs_kind *k = vs_kinds_all; k->name && n < 64; k++) names[n++] = k->name;
  return vs_fail_at(err, word->where, "%s: there is no kind of part '%s'%s", c->node->key, text,
                    vs_text_hint(text, names, n, "; `vibrospice list kinds` has them").text);
}

/* The kind, or for parts by name a list of kinds, whose parts compete. */
static vs_status read_kind(vs_design_choice *c, bool word, vs_error *err) {
  const vs_node *kind = vs_tree_child(c->node, "kind");
  vs_status status = VS_OK;
  if (!kind || kind->kind == VS_NODE_MAP || (kind->kind == VS_NODE_LIST && !kind->child))
    return vs_fail_at(err, kind ? kind->where : c->node->where,
                      "%s: kind is wanted, as {kind: thyristor}, {kind: [zener, tvs]} or {kind: "
                      "resistor, values: [1 kohm, 2.2 kohm]}, or same_as; what is no part with a "
                      "price is varied by a study",
                      c->node->key);
  if (kind->kind == VS_NODE_LIST && !word)
    return vs_fail_at(err, kind->where, "%s: a value has one kind, as {kind: resistor}",
                      c->node->key);
  for (const vs_node *n = kind->kind == VS_NODE_LIST ? kind->child : kind; n && !status;
       n = kind->kind == VS_NODE_LIST ? n->next : NULL)
    status = add_kind(c, n, err);
  return status;
}

static vs_status read_leader(const vs_design *d, vs_design_choice *c, const vs_node *same,
                             vs_error *err) {
  for (size_t k = 0; k < d->n_choices; k++)
    if (same->kind == VS_NODE_TEXT && !strcmp(d->choice[k].node->key, same->text)) {
      c->leader = d->choice[k].leader;
      return VS_OK;
    }
  return vs_fail_at(err, same->where, "%s: same_as: a key that stands before it is wanted",
                    c->node->key);
}

/* ---- nothing as an option ---- */

static double add_none(vs_axis *axis, vs_where where) {
  const size_t n = axis->n_words++;
  axis->word = vs_alloc_grow(axis->word, n, sizeof *axis->word);
  axis->word_where = vs_alloc_grow(axis->word_where, n, sizeof *axis->word_where);
  axis->word[n] = vs_copy(NONE);
  axis->word_where[n] = where;
  return (double)n;
}

/* Finds the devices that the choice's part makes, and the sources that open them. Error: a device's
 * current is not that of a source, so that its lines would not be right without it. */
static vs_status find_lacked(const vs_plan *plan, vs_design_choice *c, const vs_node *none,
                             vs_error *err) {
  const vs_deck *deck = &plan->base->setup.deck;
  for (size_t k = 0; k < deck->n_devices; k++) {
    const vs_device *device = &deck->devices[k];
    int term;
    double factor;
    if (!makes_device(c, deck, device)) continue;
    if (c->n_lacked == VS_DESIGN_DEVICES)
      return vs_fail_at(err, none->where, "%s: or: none: it makes more than %d devices",
                        c->node->key, VS_DESIGN_DEVICES);
    if (!vs_formula_is_term(&device->current, &term, &factor) ||
        strncmp(deck->terms[term].plus, "i(", 2) != 0)
      return vs_fail_at(err, none->where,
                        "%s: or: none: nothing of the deck opens %s alone; a 0 V source in series "
                        "is wanted, and i(SOURCE) as its current in `*$ device %s`",
                        c->node->key, device->name, device->name);
    snprintf(c->lacked[c->n_lacked], VS_DECK_NAME, "%s", device->name);
    snprintf(c->source[c->n_lacked++], VS_DECK_NAME, "%.*s",
             (int)strcspn(deck->terms[term].plus + 2, ")"), deck->terms[term].plus + 2);
  }
  if (c->n_lacked) return VS_OK;
  return vs_fail_at(err, none->where, "%s: or: none: the deck has no device of it", c->node->key);
}

static vs_status read_none(vs_plan *plan, vs_design_choice *c, vs_error *err) {
  const vs_node *none = vs_tree_child(c->node, "or");
  vs_axis *axis = &plan->axes[c->axis];
  vs_design_class class = {.row = VS_DESIGN_NONE};
  if (!none) return VS_OK;
  if (none->kind != VS_NODE_TEXT || strcmp(none->text, NONE) != 0)
    return vs_fail_at(err, none->where, "%s: or: none is wanted, or no `or`", c->node->key);
  if (!axis->is_word)
    return vs_fail_at(err, none->where,
                      "%s: or: none: a value cannot be left out, only a part by name",
                      c->node->key);
  vs_status status = find_lacked(plan, c, none, err);
  if (status) return status;
  for (size_t l = 0; l < VS_DESIGN_LIMITS; l++) class.limit[l] = NAN;
  c->may_lack = true;
  c->lacking = add_none(axis, none->where);
  c->option = vs_alloc_grow(c->option, c->n_options, sizeof *c->option);
  vs_design_option *o = &c->option[c->n_options++];
  *o = (vs_design_option){
      .number = c->lacking, .classes = vs_alloc(1, sizeof class), .n_classes = 1};
  o->classes[0] = class;
  return VS_OK;
}

/* The key's options, which become the values of its axis. */
static vs_status read_options(vs_plan *plan, const vs_design *d, vs_design_choice *c,
                              vs_error *err) {
  const bool word = plan->axes[c->axis].is_word;
  vs_status status = read_kind(c, word, err);
  if (status) return status;
  if (!word) find_limits(d, c);
  const size_t kept = vs_error_count(err);
  status = word ? read_parts(plan, d, c, err) : read_values(plan, d, c, err);
  if (status || vs_error_count(err) > kept) return status;
  if (!c->n_options) return empty_choice(d, c, err);
  status = read_none(plan, c, err);
  if (status) return status;
  qsort(c->option, c->n_options, sizeof *c->option, word ? by_first_price : by_number);
  return word ? VS_OK : check_limits(d, c, err);
}

static void give_values(vs_axis *axis, const vs_design_choice *leader) {
  axis->n_values = leader->n_options;
  axis->value = vs_alloc(axis->n_values, sizeof *axis->value);
  for (size_t k = 0; k < axis->n_values; k++) axis->value[k] = leader->option[k].number;
}

/* A follower's axis has the leader's words, under the same numbers. */
static vs_status copy_words(vs_axis *axis, const vs_design_choice *of, const vs_axis *leader,
                            const vs_node *same, vs_error *err) {
  vs_status status = VS_OK;
  double number;
  if (axis->is_word != leader->is_word || strcmp(axis->unit, leader->unit))
    return vs_fail_at(err, same->where, "%s: %s takes other values", axis->key, leader->key);
  for (size_t k = 0; k < leader->n_words && !status; k++)
    if (of->may_lack && (double)k == of->lacking)
      add_none(axis, leader->word_where[k]);
    else
      status = number_of_text(axis, leader->word[k], leader->word_where[k], &number, err);
  return status;
}

static const vs_inside PARTS = {.rows = VS_ROWS({.kind = VS_TEXT})},
                       VALUES = {.rows = VS_ROWS({.kind = VS_VALUE})};
static const vs_inside CHOICE = {
    .rows = VS_ROWS({"kind", VS_TEXT | VS_LIST, .inside = &PARTS},
                    {"parts", VS_TEXT | VS_LIST, .inside = &PARTS}, {"series", .kind = VS_TEXT},
                    {"from", .kind = VS_VALUE}, {"to", .kind = VS_VALUE},
                    {"values", VS_VALUE | VS_LIST, .inside = &VALUES}, {"same_as", .kind = VS_TEXT},
                    {"or", .kind = VS_TEXT}, {"number", .kind = VS_COUNT})};
const vs_inside vs_design_choices_keys = {.rows = VS_ROWS({.kind = VS_MAP, .inside = &CHOICE})};

/* Finds the key's spread, which is one of whatever is chosen. Error: it is no part of a value. */
static vs_status find_tolerance(const vs_plan *plan, vs_design_choice *c, vs_error *err) {
  for (size_t k = 0; k < plan->n_axes; k++)
    if (plan->axes[k].about == c->axis + 1) c->tolerance = k + 1;
  if (!c->tolerance || plan->axes[c->tolerance - 1].own) return VS_OK;
  return vs_fail_at(
      err, plan->axes[c->tolerance - 1].where,
      "spread.%s: it is chosen, so that a tolerance of what is chosen is wanted here, "
      "as '5 %% uniform'",
      c->node->key);
}

/* Error: two keys that do not go together, of which one would have no effect in silence. */
static vs_status check_keys(const vs_axis *axis, const vs_node *choice, vs_error *err) {
  static const char SAME[] = "same_as", SERIES[] = "series";
  static const char *const BESIDE_SAME[] = {"kind", "parts",  SERIES, "from",
                                            "to",   "values", "or",   NULL},
                           *const BESIDE_PARTS[] = {SERIES, "from", "to", "values", NULL},
                           *const BESIDE_SERIES[] = {"parts", "values", NULL},
                           *const BESIDE_VALUES[] = {"parts", "from", "to", NULL};
  const bool same = vs_tree_child(choice, SAME), word = axis->is_word;
  const vs_node *key = NULL;
  for (const char *const *no = same                            ? BESIDE_SAME
                               : word                          ? BESIDE_PARTS
                               : vs_tree_child(choice, SERIES) ? BESIDE_SERIES
                                                               : BESIDE_VALUES;
       !key && *no; no++)
    key = vs_tree_child(choice, *no);
  if (!key) return VS_OK;
  return vs_fail_at(err, key->key_where, "%s: %s has no effect here; %s", axis->key, key->key,
                    same   ? "only number goes with same_as"
                    : word ? "parts: [...] lists parts by name"
                           : "values: [...] is wanted, or series with from and to, or neither for "
                             "all values of the list");
}

static vs_status read_choice(vs_plan *plan, vs_design *d, const vs_node *node, vs_error *err) {
  uint64_t number = 1;
  vs_axis *axis;
  const vs_node *same;
  if (d->n_choices == VS_DESIGN_CHOICES)
    return vs_fail_at(err, node->key_where, "choose: more than %d keys", VS_DESIGN_CHOICES);
  const size_t kept = vs_error_count(err);
  vs_status status = vs_field_map_keys(node, node->key, &CHOICE, err);
  if (!status) status = vs_axis_whole(node, "number", 1, 1000, &number, err);
  if (!status) status = vs_plan_axis(plan, node, "catalogue", &axis, err);
  if (!status && vs_error_count(err) == kept) status = check_keys(axis, node, err);
  if (status || vs_error_count(err) > kept) return status;
  vs_design_choice *c = &d->choice[d->n_choices];
  const char *dot = strrchr(node->key, '.');
  *c = (vs_design_choice){.node = node,
                          .device = dot ? dot + 1 : node->key,
                          .axis = (size_t)(axis - plan->axes),
                          .leader = d->n_choices,
                          .number = (int)number};
  same = vs_tree_child(node, "same_as");
  status = find_tolerance(plan, c, err);
  if (status) return status;
  status = same ? read_leader(d, c, same, err) : read_options(plan, d, c, err);
  if (status || vs_error_count(err) > kept) return status;
  d->n_choices++;
  const vs_design_choice *leader = &d->choice[c->leader];
  if (same) status = copy_words(axis, leader, &plan->axes[leader->axis], same, err);
  if (same && !status && leader->may_lack) {
    vs_design_choice *own = &d->choice[d->n_choices - 1];
    own->may_lack = true;
    own->lacking = leader->lacking;
    status = find_lacked(plan, own, same, err);
  }
  if (status) return status;
  give_values(axis, leader);
  return leader->n_limits ? want_measures(plan, d, c, err) : VS_OK;
}

vs_status vs_design_choices_read(vs_plan *plan, vs_design *d, const vs_node *section,
                                 vs_error *err) {
  const vs_node *map = vs_tree_child(section, "choose");
  vs_status status = VS_OK;
  if (!map || map->kind != VS_NODE_MAP || !map->child)
    return vs_fail_at(err, map ? map->where : section->where,
                      "catalogue.choose: keys of the scene are wanted, as circuit.thyristor: "
                      "{kind: thyristor}");
  for (const vs_node *n = map->child; n && !status; n = n->next)
    status = vs_error_keep(err, read_choice(plan, d, n, err));
  return status;
}

/* ---- the cheapest first ---- */

typedef struct ranked {
  double price;
  uint64_t number;
} ranked;

static int by_rank(const void *a, const void *b) {
  const ranked *x = a, *y = b;
  if (x->price != y->price) return x->price < y->price ? -1 : 1;
  return x->number < y->number ? -1 : 1;
}

vs_status vs_design_choices_rank(const vs_node *section, vs_design *d, vs_error *err) {
  d->n_candidates = 1;
  for (size_t c = 0; c < d->n_choices; c++) {
    if (d->choice[c].leader == c) d->n_candidates *= d->choice[c].n_options;
    if (d->n_candidates > MOST_CANDIDATES)
      return vs_fail_at(err, vs_tree_child(section, "choose")->where,
                        "choose: more than %d candidates; fewer parts or values are wanted",
                        MOST_CANDIDATES);
  }
  ranked *all = vs_alloc(d->n_candidates, sizeof *all);
  for (uint64_t k = 0; k < d->n_candidates; k++)
    all[k] = (ranked){vs_design_choices_price(d, k, NULL), k};
  qsort(all, d->n_candidates, sizeof *all, by_rank);
  d->order = vs_alloc(d->n_candidates, sizeof *d->order);
  for (uint64_t k = 0; k < d->n_candidates; k++) d->order[k] = all[k].number;
  free(all);
  return VS_OK;
}
