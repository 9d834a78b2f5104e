/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stock.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "netlist/catalogue.h"
#include "netlist/deck.h"
#include "netlist/kinds.h"
#include "netlist/netlist.h"
#include "plant/blueprint.h"
#include "base/units.h"

/* The files of one shelf, and what is told of each besides its name and path. */
typedef struct shelf_walk {
  const vs_shelf *shelf;
  vs_stock_more *more; /* NULL: nothing */
  vs_entries *to;
} shelf_walk;

static void put_file(void *ctx, const char *path) {
  const shelf_walk *walk = ctx;
  size_t n;
  const char *base = vs_catalogue_name(path, &n);
  char name[VS_PATH_SIZE];
  if (!vs_catalogue_is_row(path)) n = strlen(base) - strlen(walk->shelf->ending);
  snprintf(name, sizeof name, "%.*s", (int)n, base);
  vs_entry_begin(walk->to);
  vs_entry_put(walk->to, "name", 20, name);
  vs_entry_path(walk->to, "path", path);
  vs_entry_line(walk->to);
  if (walk->more) walk->more(walk->to, path);
  vs_entry_end(walk->to);
}

void vs_stock_list(vs_entries *to, const vs_shelf *shelf, vs_stock_more *more) {
  const shelf_walk walk = {shelf, more, to};
  if (shelf == &vs_deck_parts_shelf)
    vs_catalogue_list(shelf, put_file, (void *)(size_t)&walk);
  else
    vs_path_list(shelf, put_file, (void *)(size_t)&walk);
}

static void put_title(vs_entries *to, const char *title) {
  vs_entry_say(to, "%-20s", "");
  vs_entry_put(to, "title", 0, title);
  vs_entry_line(to);
}

void vs_stock_deck(vs_entries *to, const char *path) {
  vs_deck *deck = vs_alloc(1, sizeof *deck);
  vs_error err = {0};
  if (!vs_netlist_read(path, deck, &err)) put_title(to, deck->title);
  vs_deck_free(deck);
  free(deck);
}

void vs_stock_machine(vs_entries *to, const char *path) {
  vs_machine *machine = vs_alloc(1, sizeof *machine);
  vs_error err = {0};
  vs_machine_begin(machine);
  vs_blueprint_read(path, machine, &err);
  if (*machine->title) put_title(to, machine->title);
  vs_machine_free(machine);
  free(machine);
}

static void put_limit(vs_entries *to, const vs_limit *limit) {
  vs_entry_object(to);
  vs_entry_say(to, "    limit");
  vs_entry_put(to, "name", 18, limit->name);
  vs_entry_put(to, "value", 14, limit->written);
  vs_entry_put(to, "text", 0, limit->text);
  if (limit->assumed) vs_entry_true(to, "assumed");
  if (limit->assumed) vs_entry_say(to, " (assumed)");
  vs_entry_line(to);
  vs_entry_object_end(to);
}

static void put_derating(vs_entries *to, const vs_derating *d) {
  vs_entry_object(to);
  vs_entry_number(to, "width_s", d->width_s);
  vs_entry_number(to, "number", d->number);
  vs_entry_number(to, "current_a", d->current_a);
  if (d->assumed) vs_entry_true(to, "assumed");
  vs_entry_say(to, "    pulse %g s, %g times, %g A%s", d->width_s, d->number, d->current_a,
               d->assumed ? " (assumed)" : "");
  vs_entry_line(to);
  vs_entry_object_end(to);
}

static void put_surges(vs_entries *to, const vs_deck *part) {
  if (part->n_surges) vs_entry_array(to, "surges");
  for (size_t k = 0; k < part->n_surges; k++) {
    const vs_surge_row *row = &part->surges[k];
    vs_entry_object(to);
    vs_entry_number(to, "number", row->number);
    vs_entry_number(to, "current_a", row->current_a);
    if (row->assumed) vs_entry_true(to, "assumed");
    vs_entry_say(to, "    surge %g cycles, %g A%s", row->number, row->current_a,
                 row->assumed ? " (assumed)" : "");
    vs_entry_line(to);
    vs_entry_object_end(to);
  }
  if (part->n_surges) vs_entry_array_end(to);
}

static void put_limits_at(vs_entries *to, const vs_deck *part) {
  if (part->n_limits_at) vs_entry_array(to, "limits_at");
  for (size_t k = 0; k < part->n_limits_at; k++) {
    const vs_limit_at *at = &part->limits_at[k];
    vs_entry_object(to);
    vs_entry_text(to, "name", at->name);
    vs_entry_number(to, "at_degc", at->at_degc);
    vs_entry_number(to, "value", at->value);
    if (at->assumed) vs_entry_true(to, "assumed");
    vs_entry_say(to, "    at %g degC %s = %g%s", at->at_degc, at->name,
                 at->value / vs_units_factor(vs_kinds_limit_unit(at->name)),
                 at->assumed ? " (assumed)" : "");
    vs_entry_line(to);
    vs_entry_object_end(to);
  }
  if (part->n_limits_at) vs_entry_array_end(to);
}

static void put_models(vs_entries *to, const vs_deck *part) {
  if (part->n_models) vs_entry_array(to, "models");
  for (size_t k = 0; k < part->n_models; k++) {
    const vs_model_line *m = &part->models[k];
    vs_entry_object(to);
    vs_entry_text(to, "figure", m->figure);
    vs_entry_number(to, "deviation", m->deviation);
    vs_entry_say(to, "    model %s, %+.3g %% of sheet", m->figure, 100 * m->deviation);
    vs_entry_line(to);
    vs_entry_object_end(to);
  }
  if (part->n_models) vs_entry_array_end(to);
}

static void put_melting(vs_entries *to, const vs_melting_row *row) {
  vs_entry_object(to);
  vs_entry_number(to, "time_s", row->time_s);
  vs_entry_number(to, "current_a", row->current_a);
  if (row->assumed) vs_entry_true(to, "assumed");
  vs_entry_say(to, "    time_current %g s, %g A%s", row->time_s, row->current_a,
               row->assumed ? " (assumed)" : "");
  vs_entry_line(to);
  vs_entry_object_end(to);
}

static void put_ambient(vs_entries *to, const vs_ambient_row *row) {
  vs_entry_object(to);
  vs_entry_text(to, "limit", row->limit);
  vs_entry_number(to, "ambient_degc", row->ambient_degc);
  vs_entry_number(to, "factor", row->factor);
  if (row->assumed) vs_entry_true(to, "assumed");
  vs_entry_say(to, "    derate %s, %g degC, %g %%%s", row->limit, row->ambient_degc,
               100 * row->factor, row->assumed ? " (assumed)" : "");
  vs_entry_line(to);
  vs_entry_object_end(to);
}

/* What limits are over another quantity. */
static void put_tables(vs_entries *to, const vs_deck *part) {
  if (part->n_melting) vs_entry_array(to, "time_current");
  for (size_t k = 0; k < part->n_melting; k++) put_melting(to, &part->melting[k]);
  if (part->n_melting) vs_entry_array_end(to);
  if (part->n_ambients) vs_entry_array(to, "derate");
  for (size_t k = 0; k < part->n_ambients; k++) put_ambient(to, &part->ambients[k]);
  if (part->n_ambients) vs_entry_array_end(to);
}

static void put_limits(vs_entries *to, const vs_deck *part) {
  if (part->n_limits) vs_entry_array(to, "limits");
  for (size_t k = 0; k < part->n_limits; k++) put_limit(to, &part->limits[k]);
  if (part->n_limits) vs_entry_array_end(to);
  if (part->n_zth) vs_entry_array(to, "zth");
  for (size_t k = 0; k < part->n_zth; k++) {
    vs_entry_object(to);
    vs_entry_number(to, "k_per_w", part->zth[k].k_per_w);
    vs_entry_number(to, "tau_s", part->zth[k].tau_s);
    if (part->zth[k].assumed) vs_entry_true(to, "assumed");
    vs_entry_say(to, "    zth   %g K/W, %g s%s", part->zth[k].k_per_w, part->zth[k].tau_s,
                 part->zth[k].assumed ? " (assumed)" : "");
    vs_entry_line(to);
    vs_entry_object_end(to);
  }
  if (part->n_zth) vs_entry_array_end(to);
  if (part->n_deratings) vs_entry_array(to, "pulses");
  for (size_t k = 0; k < part->n_deratings; k++) put_derating(to, &part->deratings[k]);
  if (part->n_deratings) vs_entry_array_end(to);
  put_surges(to, part);
  put_limits_at(to, part);
  put_models(to, part);
}

static void put_part(vs_entries *to, const vs_deck *part) {
  if (part->n_part_files) {
    vs_entry_say(to, "    %s: %s", part->part_files[0].kind, part->part_files[0].text);
    vs_entry_line(to);
    vs_entry_text(to, "kind", part->part_files[0].kind);
    vs_entry_text(to, "text", part->part_files[0].text);
  }
  put_limits(to, part);
  put_tables(to, part);
  vs_entry_array(to, "parameters");
  for (size_t k = 1; k < part->section.count; k++) {
    const vs_field *f = &part->section.fields[k];
    vs_entry_object(to);
    vs_entry_say(to, "    param");
    vs_entry_put(to, "name", 18, f->key);
    vs_entry_put(to, "default", 14, f->default_text);
    vs_entry_put(to, "text", 0, f->text);
    vs_entry_line(to);
    vs_entry_object_end(to);
  }
  vs_entry_array_end(to);
}

void vs_stock_part(vs_entries *to, const char *path) {
  vs_deck *part = vs_alloc(1, sizeof *part);
  vs_error err = {0};
  if (!vs_netlist_read_part(path, part, &err)) {
    put_part(to, part);
  } else {
    vs_entry_say(to, "    %s", err.text);
    vs_entry_text(to, "error", err.text);
    vs_entry_line(to);
  }
  vs_deck_free(part);
  free(part);
}

void vs_stock_set(vs_entries *to, const char *path) {
  vs_tree tree = {0};
  vs_error err = {0};
  const vs_node *title = vs_tree_read(path, &tree, &err) ? NULL : vs_tree_child(tree.root, "title");
  if (title && title->text) put_title(to, title->text);
  vs_tree_free(&tree);
}
