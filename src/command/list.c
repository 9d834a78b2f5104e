/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "command/list.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "control/regulators.h"
#include "deck/devices.h"
#include "deck/netlist.h"
#include "drive/events.h"
#include "machine/blueprint.h"
#include "machine/build.h"
#include "scene/scene.h"
#include "scene/sections.h"
#include "syntax/units.h"

/* Whose probes, measures and parameters are listed. */
typedef struct listed {
  vs_deck *deck;
  vs_machine *machine;
} listed;

static void print_file(void *ctx, const char *path) {
  const vs_shelf *shelf = ctx;
  const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path;
  printf("%-20.*s %s\n", (int)(strlen(base) - strlen(shelf->ending)), base, path);
}

static void list_scenes(const listed *of) {
  (void)of;
  vs_path_list(&vs_scene_shelf, print_file, (void *)(size_t)&vs_scene_shelf);
}

static void list_studies(const listed *of) {
  (void)of;
  vs_path_list(&vs_scene_study_shelf, print_file, (void *)(size_t)&vs_scene_study_shelf);
}

static void list_fits(const listed *of) {
  (void)of;
  vs_path_list(&vs_scene_fit_shelf, print_file, (void *)(size_t)&vs_scene_fit_shelf);
}

/* With its title; a deck that cannot be read is listed all the same. */
static void print_deck(void *ctx, const char *path) {
  vs_deck *deck = vs_alloc(1, sizeof *deck);
  vs_error err = {0};
  print_file(ctx, path);
  if (!vs_netlist_read(path, deck, &err)) printf("%-20s %s\n", "", deck->title);
  vs_deck_free(deck);
  free(deck);
}

static void list_decks(const listed *of) {
  (void)of;
  vs_path_list(&vs_deck_shelf, print_deck, (void *)(size_t)&vs_deck_shelf);
}

/* With its title; a machine that cannot be read is listed all the same. */
static void print_machine(void *ctx, const char *path) {
  vs_machine *machine = vs_alloc(1, sizeof *machine);
  vs_error err = {0};
  print_file(ctx, path);
  vs_machine_begin(machine);
  vs_blueprint_read(path, machine, &err);
  if (*machine->title) printf("%-20s %s\n", "", machine->title);
  vs_machine_free(machine);
  free(machine);
}

static void list_machines(const listed *of) {
  (void)of;
  vs_path_list(&vs_machine_shelf, print_machine, (void *)(size_t)&vs_machine_shelf);
}

/* What it is, what its maker allows, and its parameters. */
static void print_part(void *ctx, const char *path) {
  vs_deck *part = vs_alloc(1, sizeof *part);
  vs_error err = {0};
  print_file(ctx, path);
  vs_status status = vs_netlist_read_part(path, part, &err);
  if (status) printf("    %s\n", err.text);
  if (!status && part->n_part_files)
    printf("    %s: %s\n", part->part_files[0].kind, part->part_files[0].text);
  for (size_t k = 0; k < part->n_limits && !status; k++)
    printf("    limit %-18s %-14s %s%s\n", part->limits[k].name, part->limits[k].written,
           part->limits[k].text, part->limits[k].assumed ? " (assumed)" : "");
  for (size_t k = 0; k < part->n_zth && !status; k++)
    printf("    zth   %g K/W, %g s%s\n", part->zth[k].k_per_w, part->zth[k].tau_s,
           part->zth[k].assumed ? " (assumed)" : "");
  for (size_t k = 1; k < part->section.count && !status; k++)
    printf("    param %-18s %-14s %s\n", part->section.fields[k].key,
           part->section.fields[k].default_text, part->section.fields[k].text);
  vs_deck_free(part);
  free(part);
}

static void list_parts(const listed *of) {
  (void)of;
  vs_path_list(&vs_deck_parts_shelf, print_part, (void *)(size_t)&vs_deck_parts_shelf);
}

/* With its title; a set that cannot be read is listed all the same. */
static void print_set(void *ctx, const char *path) {
  vs_tree tree = {0};
  vs_error err = {0};
  print_file(ctx, path);
  const vs_node *title = vs_tree_read(path, &tree, &err) ? NULL : vs_tree_child(tree.root, "title");
  if (title && title->text) printf("%-20s %s\n", "", title->text);
  vs_tree_free(&tree);
}

static void print_instrument(const vs_instrument *i) {
  const vs_instrument_values *v = &i->v;
  double unit = vs_units_factor(i->unit);
  printf("%-20s %-7s %s: %g..%g %s, ", i->column, i->unit, v->channel, v->range[0] / unit,
         v->range[1] / unit, i->unit);
  if (isfinite(v->bandwidth_hz)) printf("%g Hz of order %d, ", v->bandwidth_hz, v->order);
  printf("%g samples/s, ", v->rate_hz);
  if (v->bits) printf("%d bits, ", v->bits);
  printf("noise %g %s; %s\n", v->noise / unit, i->unit, v->text);
}

/* The sets, and what that of the machine has. */
static void list_instruments(const listed *of) {
  vs_instruments *all = vs_alloc(1, sizeof *all);
  vs_setup *setup = vs_alloc(1, sizeof *setup);
  vs_error err = {0};
  const vs_node section = vs_tree_word("instruments", "", (vs_where){0});
  vs_path_list(&vs_instrument_shelf, print_set, (void *)(size_t)&vs_instrument_shelf);
  setup->machine = of->machine;
  setup->deck = *of->deck;
  setup->model = (vs_model){.machine = of->machine, .dof = of->machine->dof};
  const vs_frame frame = {.model = &setup->model, .deck = &setup->deck};
  vs_instruments_read(&section, setup, &frame, all, &err); /* without a set there are none */
  if (all->count) printf("%-20s the machine's: column, unit, channel, range, ...\n", "own");
  for (int k = 0; k < all->count; k++) print_instrument(&all->item[k]);
  vs_instruments_free(all);
  free(setup); /* it only borrows */
  free(all);
}

static void list_tiers(const listed *of) {
  (void)of;
  for (int k = 0; k < VS_TIERS; k++)
    printf("%-20s %s\n", vs_tiers_all[k]->name, vs_tiers_all[k]->text);
}

static void list_probes(const listed *of) {
  const vs_model model = {.machine = of->machine, .dof = of->machine->dof};
  const vs_frame frame = {.model = &model, .deck = of->deck};
  int numbers[VS_CH_MOST], count = vs_channel_listed(&frame, numbers);
  for (int k = 0; k < count; k++) {
    vs_channel c = vs_channel_at(&frame, numbers[k]);
    printf("%-20s %-7s %s%s\n", c.name, c.unit, c.text,
           numbers[k] >= vs_channel_deck(&model) ? " (tier circuit)" : "");
  }
}

static void list_of_kind(const char *name, const vs_kind *kind, const char *where) {
  for (size_t n = 0; kind && n < kind->n_measures; n++) {
    const vs_device_measure *m = &kind->measures[n];
    char of[VS_DECK_NAME + 24];
    snprintf(of, sizeof of, "%s.%s", name, m->name);
    printf("%-20s %-7s %s%s%s%s%s\n", of, m->unit, m->text, where, m->limit ? "; limit " : "",
           m->limit ? m->limit : "", m->held == VS_WARD_AT_MOST ? " of what it protects" : "");
  }
}

static void list_kinds(const listed *of) {
  (void)of;
  for (const vs_kind *kind = vs_kinds_all; kind->name; kind++) list_of_kind(kind->name, kind, "");
}

static void list_measures(const listed *of) {
  const vs_deck *deck = of->deck;
  vs_model *model = vs_alloc(1, sizeof *model);
  vs_error err = {0};
  vs_measure m;
  vs_build_model(NULL, of->machine, model, &err); /* names follow, even where its numbers do not */
  for (int k = 0; vs_measure_at(model, k, &m); k++)
    printf("%-20s %-7s %s\n", m.name, m.unit, m.text);
  vs_actuator_end(&model->coil);
  free(model);
  for (size_t k = 0; k < deck->n_probes; k++)
    printf("%s_min, %s_max  %s  extremes of the probe (tier circuit)\n", deck->probes[k].name,
           deck->probes[k].name, deck->probes[k].unit);
  for (size_t k = 0; k < deck->n_devices; k++)
    list_of_kind(deck->devices[k].name, deck->devices[k].kind, " (tier circuit)");
}

static void print_field(const char *section, const vs_field *f) {
  char name[128], range[128];
  snprintf(name, sizeof name, "%s.%s", section, f->key);
  vs_field_range(f, range, sizeof range);
  printf("%-28s %-18s %-26s %s\n", name, f->default_text,
         f->kind == VS_NAME ? "a name or path" : range, f->text);
  for (size_t k = 0; f->options && k < f->options->keys.count; k++)
    print_field(name, &f->options->keys.fields[k]);
}

static void list_parameters(const listed *of) {
  for (int s = 0; s < VS_SECTIONS; s++) {
    const vs_section *section = vs_section_fields(of->machine, of->deck, s);
    for (size_t k = 0; k < section->count; k++) print_field(section->name, &section->fields[k]);
  }
  const vs_section *const instruments[] = {&vs_instruments_section, &vs_instrument_section};
  for (int s = 0; s < 2; s++)
    for (size_t k = 0; k < instruments[s]->count; k++)
      print_field(instruments[s]->name, &instruments[s]->fields[k]);
  for (size_t k = 0; k < vs_control_section.count; k++)
    print_field(vs_control_section.name, &vs_control_section.fields[k]);
  for (size_t k = 0; k < vs_observing_section.count; k++)
    print_field(vs_observing_section.name, &vs_observing_section.fields[k]);
}

static void list_events(const listed *of) {
  (void)of;
  const vs_event_kind *kind;
  for (size_t k = 0; (kind = vs_events_kind(k)); k++) {
    printf("%-20s %s\n", kind->name, kind->text);
    for (size_t f = 1; f < kind->n_fields; f++) {
      char range[128];
      vs_field_range(&kind->fields[f], range, sizeof range);
      printf("    %-16s %-12s %-26s %s\n", kind->fields[f].key, kind->fields[f].default_text,
             kind->fields[f].kind == VS_NAME ? "a name" : range, kind->fields[f].text);
    }
  }
}

static void list_laws(const listed *of) {
  (void)of;
  for (const vs_law *const *law = vs_actuator_laws; *law; law++)
    printf("%-20s %s\n", (*law)->name, (*law)->text);
}

static void list_regulators(const listed *of) {
  (void)of;
  for (const vs_regulator *const *r = vs_regulators; *r; r++) {
    printf("%-20s %s\n", (*r)->name, (*r)->text);
    for (size_t k = 0; k < (*r)->n_fields; k++) {
      const vs_field *f = &(*r)->fields[k];
      char range[128];
      vs_field_range(f, range, sizeof range);
      printf("    %-16s %-12s %-26s %s\n", f->key, f->default_text,
             f->kind == VS_NAME ? "a name" : range, f->text);
    }
  }
}

static const struct kind {
  const char *name, *heading;
  void (*print)(const listed *);
} KINDS[] = {
    {"scenes", "scenes that come with the program", list_scenes},
    {"studies", "studies that come with the program", list_studies},
    {"fits", "fits that come with the program", list_fits},
    {"machines", "machines that come with the program", list_machines},
    {"decks", "decks that come with the program", list_decks},
    {"parts", "parts that come with the program", list_parts},
    {"instruments",
     "sets of instruments that come with the program, and what the machine's own has",
     list_instruments},
    {"kinds", "kinds of devices: what is measured of each, unit, meaning, limit", list_kinds},
    {"tiers", "tiers, from the least modelled to the most", list_tiers},
    {"laws", "laws of the actuator, by actuator.law", list_laws},
    {"regulators", "laws of control, by control.law, with their keys; ~ is the unit of the sensor",
     list_regulators},
    {"probes", "probes: name, unit, meaning", list_probes},
    {"events", "events: kind, its keys with default, allowed, meaning", list_events},
    {"measures", "measures: name, unit, meaning", list_measures},
    {"parameters", "parameters: scene key, default, allowed, meaning", list_parameters},
};
enum { N_KINDS = sizeof KINDS / sizeof *KINDS };

static vs_status check_kind(const char *kind, vs_error *err) {
  const char *names[N_KINDS];
  bool found = !kind;
  for (size_t k = 0; k < N_KINDS; k++) {
    names[k] = KINDS[k].name;
    found = found || !strcmp(kind, names[k]);
  }
  if (found) return VS_OK;
  const char *nearest = vs_text_nearest(kind, names, N_KINDS);
  vs_text there_are = {0};
  for (size_t k = 0; k < N_KINDS; k++) vs_text_add(&there_are, "%s%s", k ? ", " : "", names[k]);
  vs_fail(err, VS_INPUT, "list: no kind '%s'; there are: %s%s%s%s", kind, there_are.text,
          nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
  vs_text_free(&there_are);
  return VS_INPUT;
}

static vs_status read_listed(const char *deck, const char *machine, const listed *of,
                             vs_error *err) {
  const vs_where nowhere = {0};
  char path[VS_PATH_SIZE];
  vs_status status =
      vs_path_find(&vs_deck_shelf, deck ? deck : vs_deck_key.default_text, nowhere, path, err);
  if (!status) status = vs_netlist_read(path, of->deck, err);
  if (!status) status = vs_netlist_read_parts(of->deck, NULL, err);
  if (!status)
    status = vs_path_find(&vs_machine_shelf, machine ? machine : vs_machine_key.default_text,
                          nowhere, path, err);
  return status ? status : vs_blueprint_read(path, of->machine, err);
}

vs_status vs_list_command(const char *kind, const char *deck, const char *machine, vs_error *err) {
  vs_status status = check_kind(kind, err);
  if (status) return status;
  const listed of = {vs_alloc(1, sizeof *of.deck), vs_alloc(1, sizeof *of.machine)};
  vs_machine_begin(of.machine);
  status = read_listed(deck, machine, &of, err);
  for (size_t k = 0; k < N_KINDS && !status; k++) {
    if (kind && strcmp(kind, KINDS[k].name)) continue;
    if (!kind) printf("%s%s\n", k ? "\n" : "", KINDS[k].heading);
    KINDS[k].print(&of);
  }
  vs_deck_free(of.deck);
  vs_machine_free(of.machine);
  free(of.deck);
  free(of.machine);
  return status;
}
