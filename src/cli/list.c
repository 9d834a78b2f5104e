/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "list.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/path.h"
#include "base/units.h"
#include "commands.h"
#include "control/regulators.h"
#include "default_models.h"
#include "engine/events.h"
#include "list_entry.h"
#include "netlist/catalogue.h"
#include "netlist/deck.h"
#include "netlist/kinds.h"
#include "netlist/netlist.h"
#include "options.h"
#include "orbit/steady.h"
#include "plant/build.h"
#include "plant/machine_file.h"
#include "report/schematic.h"
#include "run/scene.h"
#include "run/sections.h"

/* What is listed: whose probes, measures and parameters, and where the entries go. */
typedef struct listed {
  vs_deck *deck;
  vs_machine *machine;
  vs_entries *to;
} listed;

/* ---- a file that comes with the program, as an entry ---- */

/* Adds to the entry what the file at `path` says of itself; nothing, or why, where it cannot be
 * read. */
typedef void put_details(vs_entries *to, const char *path);

/* The files of one shelf, and what is told of each besides its name and path. */
typedef struct shelf_walk {
  const vs_shelf *shelf;
  put_details *more; /* NULL: nothing */
  vs_entries *to;
} shelf_walk;

static void put_file(void *ctx, const char *path) {
  const shelf_walk *walk = ctx;
  size_t n;
  const char *base = vs_catalogue_name(path, &n);
  char name[VS_PATH_SIZE];
  if (!vs_catalogue_is_row(path)) n = strlen(base) - strlen(walk->shelf->ending);
  snprintf(name, sizeof name, "%.*s", (int)n, base);
  vs_list_entry_begin(walk->to);
  vs_list_entry_put(walk->to, "name", 20, name);
  vs_list_entry_path(walk->to, "path", path);
  vs_list_entry_line(walk->to);
  if (walk->more) walk->more(walk->to, path);
  vs_list_entry_end(walk->to);
}

/* Adds an entry for each file of the shelf: its name, its path, and what `more` tells of it. more
 * may be NULL. */
static void list_shelf(vs_entries *to, const vs_shelf *shelf, put_details *more) {
  const shelf_walk walk = {shelf, more, to};
  if (shelf == &vs_deck_parts_shelf)
    vs_catalogue_list(shelf, put_file, (void *)(size_t)&walk);
  else
    vs_path_list(shelf, put_file, (void *)(size_t)&walk);
}

static void put_title(vs_entries *to, const char *title) {
  vs_list_entry_say(to, "%-20s", "");
  vs_list_entry_put(to, "title", 0, title);
  vs_list_entry_line(to);
}

static void put_deck_title(vs_entries *to, const char *path) {
  vs_deck *deck = vs_alloc(1, sizeof *deck);
  vs_error err = {0};
  if (!vs_netlist_read(path, deck, &err)) put_title(to, deck->title);
  vs_deck_free(deck);
  free(deck);
  vs_html svg = {0};
  if (to->as_json && !vs_schematic_of_deck(path, &svg, &err))
    vs_list_entry_text(to, "schematic", svg.text.text);
  vs_html_free(&svg);
}

static void put_machine_title(vs_entries *to, const char *path) {
  vs_machine *machine = vs_alloc(1, sizeof *machine);
  vs_error err = {0};
  vs_machine_begin(machine);
  vs_machine_file_read(path, machine, &err);
  if (*machine->title) put_title(to, machine->title);
  vs_machine_free(machine);
  free(machine);
}

static void put_unsure(vs_entries *to, unsigned unsure) {
  if (unsure & VS_ASSUMED) vs_list_entry_true(to, "assumed");
  if (unsure & VS_TYPICAL) vs_list_entry_true(to, "typical");
}

static void put_limit(vs_entries *to, const vs_limit *limit) {
  vs_list_entry_object(to);
  vs_list_entry_say(to, "    limit");
  vs_list_entry_put(to, "name", 18, limit->name);
  vs_list_entry_put(to, "value", 14, limit->written);
  vs_list_entry_put(to, "text", 0, limit->text);
  put_unsure(to, limit->unsure);
  vs_list_entry_say(to, "%s", vs_deck_unsure_notes[limit->unsure]);
  vs_list_entry_line(to);
  vs_list_entry_object_end(to);
}

static void put_derating(vs_entries *to, const vs_derating *d) {
  vs_list_entry_object(to);
  vs_list_entry_number(to, "width_s", d->width_s);
  vs_list_entry_number(to, "number", d->number);
  vs_list_entry_number(to, "current_a", d->current_a);
  put_unsure(to, d->unsure);
  vs_list_entry_say(to, "    pulse %g s, %g times, %g A%s", d->width_s, d->number, d->current_a,
                    vs_deck_unsure_notes[d->unsure]);
  vs_list_entry_line(to);
  vs_list_entry_object_end(to);
}

static void put_surges(vs_entries *to, const vs_deck *part) {
  if (part->n_surges) vs_list_entry_array(to, "surges");
  for (size_t k = 0; k < part->n_surges; k++) {
    const vs_surge_row *row = &part->surges[k];
    vs_list_entry_object(to);
    vs_list_entry_number(to, "number", row->number);
    vs_list_entry_number(to, "current_a", row->current_a);
    put_unsure(to, row->unsure);
    vs_list_entry_say(to, "    surge %g cycles, %g A%s", row->number, row->current_a,
                      vs_deck_unsure_notes[row->unsure]);
    vs_list_entry_line(to);
    vs_list_entry_object_end(to);
  }
  if (part->n_surges) vs_list_entry_array_end(to);
}

static void put_limits_at(vs_entries *to, const vs_deck *part) {
  if (part->n_limits_at) vs_list_entry_array(to, "limits_at");
  for (size_t k = 0; k < part->n_limits_at; k++) {
    const vs_limit_at *at = &part->limits_at[k];
    vs_list_entry_object(to);
    vs_list_entry_text(to, "name", at->name);
    vs_list_entry_number(to, "at_degc", at->at_degc);
    vs_list_entry_number(to, "value", at->value);
    put_unsure(to, at->unsure);
    vs_list_entry_say(to, "    at %g degC %s = %g%s", at->at_degc, at->name,
                      at->value / vs_units_factor(vs_kinds_limit_unit(at->name)),
                      vs_deck_unsure_notes[at->unsure]);
    vs_list_entry_line(to);
    vs_list_entry_object_end(to);
  }
  if (part->n_limits_at) vs_list_entry_array_end(to);
}

static void put_models(vs_entries *to, const vs_deck *part) {
  if (part->n_models) vs_list_entry_array(to, "models");
  for (size_t k = 0; k < part->n_models; k++) {
    const vs_model_line *m = &part->models[k];
    vs_list_entry_object(to);
    vs_list_entry_text(to, "figure", m->figure);
    vs_list_entry_number(to, "deviation", m->deviation);
    vs_list_entry_say(to, "    model %s, %+.3g %% of sheet", m->figure, 100 * m->deviation);
    vs_list_entry_line(to);
    vs_list_entry_object_end(to);
  }
  if (part->n_models) vs_list_entry_array_end(to);
}

static void put_melting(vs_entries *to, const vs_melting_row *row) {
  vs_list_entry_object(to);
  vs_list_entry_number(to, "time_s", row->time_s);
  vs_list_entry_number(to, "current_a", row->current_a);
  put_unsure(to, row->unsure);
  vs_list_entry_say(to, "    time_current %g s, %g A%s", row->time_s, row->current_a,
                    vs_deck_unsure_notes[row->unsure]);
  vs_list_entry_line(to);
  vs_list_entry_object_end(to);
}

static void put_ambient(vs_entries *to, const vs_ambient_row *row) {
  vs_list_entry_object(to);
  vs_list_entry_text(to, "limit", row->limit);
  vs_list_entry_number(to, "ambient_degc", row->ambient_degc);
  vs_list_entry_number(to, "factor", row->factor);
  put_unsure(to, row->unsure);
  vs_list_entry_say(to, "    derate %s, %g degC, %g %%%s", row->limit, row->ambient_degc,
                    100 * row->factor, vs_deck_unsure_notes[row->unsure]);
  vs_list_entry_line(to);
  vs_list_entry_object_end(to);
}

/* What limits are over another quantity. */
static void put_tables(vs_entries *to, const vs_deck *part) {
  if (part->n_melting) vs_list_entry_array(to, "time_current");
  for (size_t k = 0; k < part->n_melting; k++) put_melting(to, &part->melting[k]);
  if (part->n_melting) vs_list_entry_array_end(to);
  if (part->n_ambients) vs_list_entry_array(to, "derate");
  for (size_t k = 0; k < part->n_ambients; k++) put_ambient(to, &part->ambients[k]);
  if (part->n_ambients) vs_list_entry_array_end(to);
}

static void put_limits(vs_entries *to, const vs_deck *part) {
  if (part->n_limits) vs_list_entry_array(to, "limits");
  for (size_t k = 0; k < part->n_limits; k++) put_limit(to, &part->limits[k]);
  if (part->n_limits) vs_list_entry_array_end(to);
  if (part->n_zth) vs_list_entry_array(to, "zth");
  for (size_t k = 0; k < part->n_zth; k++) {
    vs_list_entry_object(to);
    vs_list_entry_number(to, "k_per_w", part->zth[k].k_per_w);
    vs_list_entry_number(to, "tau_s", part->zth[k].tau_s);
    put_unsure(to, part->zth[k].unsure);
    vs_list_entry_say(to, "    zth   %g K/W, %g s%s", part->zth[k].k_per_w, part->zth[k].tau_s,
                      vs_deck_unsure_notes[part->zth[k].unsure]);
    vs_list_entry_line(to);
    vs_list_entry_object_end(to);
  }
  if (part->n_zth) vs_list_entry_array_end(to);
  if (part->n_deratings) vs_list_entry_array(to, "pulses");
  for (size_t k = 0; k < part->n_deratings; k++) put_derating(to, &part->deratings[k]);
  if (part->n_deratings) vs_list_entry_array_end(to);
  put_surges(to, part);
  put_limits_at(to, part);
  put_models(to, part);
}

static void put_part(vs_entries *to, const vs_deck *part) {
  if (part->n_part_files) {
    vs_list_entry_say(to, "    %s: %s", part->part_files[0].kind, part->part_files[0].text);
    vs_list_entry_line(to);
    vs_list_entry_text(to, "kind", part->part_files[0].kind);
    vs_list_entry_text(to, "text", part->part_files[0].text);
  }
  const char *kind = part->n_part_files ? part->part_files[0].kind : "";
  vs_list_entry_details(to, vs_kinds_find(to->filter) ? kind : NULL); /* fuse: no Littelfuse */
  put_limits(to, part);
  put_tables(to, part);
  vs_list_entry_array(to, "parameters");
  for (size_t k = 1; k < part->section.count; k++) {
    const vs_field *f = &part->section.fields[k];
    vs_list_entry_object(to);
    vs_list_entry_say(to, "    param");
    vs_list_entry_put(to, "name", 18, f->key);
    vs_list_entry_put(to, "default", 14, f->default_text);
    vs_list_entry_put(to, "text", 0, f->text);
    vs_list_entry_line(to);
    vs_list_entry_object_end(to);
  }
  vs_list_entry_array_end(to);
}

/* What it is, what its maker allows, and its parameters. */
static void put_part_details(vs_entries *to, const char *path) {
  vs_deck *part = vs_alloc(1, sizeof *part);
  vs_error err = {0};
  if (!vs_netlist_read_part(path, part, &err)) {
    put_part(to, part);
  } else {
    vs_list_entry_say(to, "    %s", err.text);
    vs_list_entry_text(to, "error", err.text);
    vs_list_entry_line(to);
  }
  vs_deck_free(part);
  free(part);
}

static void put_set_title(vs_entries *to, const char *path) {
  vs_tree tree = {0};
  vs_error err = {0};
  const vs_node *title = vs_tree_read(path, &tree, &err) ? NULL : vs_tree_child(tree.root, "title");
  if (title && title->text) put_title(to, title->text);
  vs_tree_free(&tree);
}

/* ---- all files that come with the program ---- */

static void list_scenes(const listed *of) {
  list_shelf(of->to, &vs_scene_shelf, NULL);
}

static void list_studies(const listed *of) {
  list_shelf(of->to, &vs_scene_study_shelf, NULL);
}

static void list_fits(const listed *of) {
  list_shelf(of->to, &vs_scene_fit_shelf, NULL);
}

static void list_decks(const listed *of) {
  list_shelf(of->to, &vs_deck_shelf, put_deck_title);
}

static void list_machines(const listed *of) {
  list_shelf(of->to, &vs_machine_shelf, put_machine_title);
}

static void list_parts(const listed *of) {
  list_shelf(of->to, &vs_deck_parts_shelf, put_part_details);
}

static void put_instrument(vs_entries *to, const vs_instrument *i) {
  const vs_instrument_values *v = &i->v;
  double unit = vs_units_factor(i->unit);
  vs_list_entry_begin(to);
  vs_list_entry_put(to, "name", 20, i->column);
  vs_list_entry_put(to, "unit", 7, i->unit);
  vs_list_entry_say(to, " %s: %g..%g %s, ", v->channel, v->range[0] / unit, v->range[1] / unit,
                    i->unit);
  if (isfinite(v->bandwidth_hz))
    vs_list_entry_say(to, "%g Hz of order %d, ", v->bandwidth_hz, v->order);
  vs_list_entry_say(to, "%g samples/s, ", v->rate_hz);
  if (v->bits) vs_list_entry_say(to, "%d bits, ", v->bits);
  vs_list_entry_say(to, "noise %g %s; %s", v->noise / unit, i->unit, v->text);
  vs_list_entry_line(to);
  vs_list_entry_text(to, "channel", v->channel);
  vs_list_entry_number(to, "from", v->range[0] / unit);
  vs_list_entry_number(to, "to", v->range[1] / unit);
  if (isfinite(v->bandwidth_hz)) vs_list_entry_number(to, "bandwidth_hz", v->bandwidth_hz);
  if (isfinite(v->bandwidth_hz)) vs_list_entry_number(to, "order", v->order);
  vs_list_entry_number(to, "rate_hz", v->rate_hz);
  if (v->bits) vs_list_entry_number(to, "bits", v->bits);
  vs_list_entry_number(to, "noise", v->noise / unit);
  vs_list_entry_text(to, "text", v->text);
  vs_list_entry_end(to);
}

/* The sets, and what that of the machine has. */
static void list_instruments(const listed *of) {
  vs_instruments *all = vs_alloc(1, sizeof *all);
  vs_setup *setup = vs_alloc(1, sizeof *setup);
  vs_error err = {0};
  const vs_node section = vs_tree_word("instruments", "", (vs_where){0});
  list_shelf(of->to, &vs_instrument_shelf, put_set_title);
  setup->machine = of->machine;
  setup->deck = *of->deck;
  setup->model = (vs_model){.machine = of->machine, .dof = of->machine->dof};
  const vs_frame frame = {.model = &setup->model, .deck = &setup->deck};
  vs_instruments_read(&section, setup, &frame, all, &err); /* without a set there are none */
  if (all->count) {
    vs_list_entry_begin(of->to);
    vs_list_entry_put(of->to, "name", 20, "own");
    vs_list_entry_put(of->to, "title", 0, "the machine's: column, unit, channel, range, ...");
    vs_list_entry_line(of->to);
    vs_list_entry_end(of->to);
  }
  for (int k = 0; k < all->count; k++) put_instrument(of->to, &all->item[k]);
  vs_instruments_free(all);
  free(setup); /* it only borrows */
  free(all);
}

/* ---- tables of the program ---- */

/* A name and what it means. */
static void put_named(vs_entries *to, const char *name, const char *text) {
  vs_list_entry_put(to, "name", 20, name);
  vs_list_entry_put(to, "text", 0, text);
  vs_list_entry_line(to);
}

static void list_tiers(const listed *of) {
  for (int k = 0; k < VS_TIERS; k++) {
    vs_list_entry_begin(of->to);
    put_named(of->to, vs_tiers_all[k]->name, vs_tiers_all[k]->text);
    vs_list_entry_end(of->to);
  }
}

static void list_laws(const listed *of) {
  for (const vs_law *const *law = vs_actuator_laws; *law; law++) {
    vs_list_entry_begin(of->to);
    put_named(of->to, (*law)->name, (*law)->text);
    vs_list_entry_end(of->to);
  }
}

/* Begins an entry of a quantity: its name, unit and meaning. */
static void begin_quantity(vs_entries *to, const char *name, const char *unit, const char *text) {
  vs_list_entry_begin(to);
  vs_list_entry_put(to, "name", 20, name);
  vs_list_entry_put(to, "unit", 7, unit);
  vs_list_entry_put(to, "text", 0, text);
}

/* Ends its line; on_circuit: only a run with the circuit has it. */
static void end_quantity(vs_entries *to, bool on_circuit) {
  if (on_circuit) vs_list_entry_text(to, "tier", "circuit");
  vs_list_entry_line(to);
  vs_list_entry_end(to);
}

static void list_probes(const listed *of) {
  const vs_model model = {.machine = of->machine, .dof = of->machine->dof};
  const vs_frame frame = {.model = &model, .deck = of->deck};
  int numbers[VS_CH_MOST], count = vs_channel_listed(&frame, numbers);
  for (int k = 0; k < count; k++) {
    vs_channel c = vs_channel_at(&frame, numbers[k]);
    bool on_circuit = numbers[k] >= vs_channel_deck(&model);
    begin_quantity(of->to, c.name, c.unit, c.text);
    if (on_circuit) vs_list_entry_say(of->to, " (tier circuit)");
    end_quantity(of->to, on_circuit);
  }
}

/* The measures of a device of that kind; on_circuit: of a device that a deck has. */
static void list_of_kind(vs_entries *to, const char *name, const vs_kind *kind, bool on_circuit) {
  for (size_t n = 0; kind && n < kind->n_measures; n++) {
    const vs_device_measure *m = &kind->measures[n];
    const bool protects = m->held == VS_WARD_AT_MOST;
    char of[VS_DECK_NAME + 24];
    snprintf(of, sizeof of, "%s.%s", name, m->name);
    begin_quantity(to, of, m->unit, m->text);
    if (on_circuit) vs_list_entry_say(to, " (tier circuit)");
    if (m->limit) vs_list_entry_say(to, "; limit %s", m->limit);
    if (protects) vs_list_entry_say(to, " of what it protects");
    if (m->held == VS_NEVER) vs_list_entry_say(to, "; must not happen unless 'expect' names it");
    if (m->limit) vs_list_entry_text(to, "limit", m->limit);
    if (protects) vs_list_entry_text(to, "limit_of", "what it protects");
    end_quantity(to, on_circuit);
  }
}

static void list_kinds(const listed *of) {
  for (const vs_kind *kind = vs_kinds_all; kind->name; kind++)
    list_of_kind(of->to, kind->name, kind, false);
}

/* The two extremes of a deck's probe: one line for people, two entries for programs. */
static void put_extremes(vs_entries *to, const vs_probe *probe) {
  static const char *const ENDS[] = {"min", "max"};
  for (int k = 0; k < 2; k++) {
    char name[VS_DECK_NAME + 8];
    snprintf(name, sizeof name, "%s_%s", probe->name, ENDS[k]);
    vs_list_entry_begin(to);
    if (k == 0)
      vs_list_entry_say(to, "%s_min, %s_max  %s  extremes of the probe (tier circuit)\n",
                        probe->name, probe->name, probe->unit);
    vs_list_entry_text(to, "name", name);
    vs_list_entry_text(to, "unit", probe->unit);
    vs_list_entry_text(to, "text", k ? "largest value of the probe" : "least value of the probe");
    vs_list_entry_text(to, "tier", "circuit");
    vs_list_entry_end(to);
  }
}

/* What `steady` tells besides; of the material only where the machine says how its trough moves. */
static void list_of_steady(const listed *of) {
  static const struct {
    const char *name, *unit, *text;
    bool of_throw;
  } ALL[] = {
#define ROW(member, name, unit, text) {name, unit, text, false},
      VS_STEADY_LIST(ROW)
#undef ROW
#define ROW(member, name, unit, text) {name, unit, text, true},
          VS_STEADY_THROW_LIST(ROW)
#undef ROW
  };
  for (size_t k = 0; k < sizeof ALL / sizeof *ALL; k++) {
    if (ALL[k].of_throw && !of->machine->load.way[VS_MACHINE_UP].text) continue;
    begin_quantity(of->to, ALL[k].name, ALL[k].unit, ALL[k].text);
    vs_list_entry_say(of->to, " (command steady)");
    vs_list_entry_text(of->to, "command", "steady");
    end_quantity(of->to, false);
  }
}

static void list_measures(const listed *of) {
  const vs_deck *deck = of->deck;
  vs_model *model = vs_alloc(1, sizeof *model);
  vs_error err = {0};
  vs_measure m;
  vs_build_model(NULL, of->machine, model, &err); /* names follow, even where its numbers do not */
  for (int k = 0; vs_measure_at(model, k, &m); k++) {
    begin_quantity(of->to, m.name, m.unit, m.text);
    end_quantity(of->to, false);
  }
  vs_actuator_end(&model->coil);
  free(model);
  for (size_t k = 0; k < deck->n_probes; k++) put_extremes(of->to, &deck->probes[k]);
  for (size_t k = 0; k < deck->n_devices; k++)
    list_of_kind(of->to, deck->devices[k].name, deck->devices[k].kind, true);
  list_of_steady(of);
}

/* ---- keys ---- */

/* The columns behind a key's name: default, allowed, meaning. is_name: what is said of a name. */
static void put_key(vs_entries *to, const vs_field *f, int width, const char *is_name) {
  char range[128];
  vs_field_range(f, range, sizeof range);
  vs_list_entry_put(to, "default", width, f->default_text);
  vs_list_entry_put(to, "allowed", 26, f->kind == VS_NAME ? is_name : range);
  vs_list_entry_put(to, "text", 0, f->text);
  vs_list_entry_line(to);
  if (*f->unit) vs_list_entry_text(to, "unit", f->unit);
}

static void put_field(vs_entries *to, const char *section, const vs_field *f) {
  char name[128];
  snprintf(name, sizeof name, "%s%s%s", section, *section ? "." : "", f->key);
  vs_list_entry_begin(to);
  vs_list_entry_put(to, "name", 28, name);
  put_key(to, f, 18, "a name or path");
  vs_list_entry_end(to);
  for (size_t k = 0; f->inside && k < f->inside->keys.count; k++)
    put_field(to, name, &f->inside->keys.fields[k]);
}

/* The sections that a scene may leave out, and whose keys stand in no setup. */
static const vs_section *const BESIDES[] = {&vs_instruments_section, &vs_instrument_section,
                                            &vs_control_section, &vs_state_observer_section};
enum { N_BESIDES = sizeof BESIDES / sizeof *BESIDES };

/* The keys NAME_part of the deck's resistors and capacitors. */
static void put_series(const listed *of) {
  for (size_t d = 0; d < of->deck->n_devices; d++) {
    char key[VS_SERIES_KEY];
    vs_field field;
    if (vs_netlist_series_key(of->deck, d, key, &field)) put_field(of->to, "circuit", &field);
  }
}

/* Adds the keys of the scene's section of that name and of those below it; NULL: of all. Returns
 * false where there is none. */
static bool put_sections(const listed *of, const char *name) {
  const size_t length = name ? strlen(name) : 0;
  bool found = false;
  for (int k = 0; k < VS_SECTIONS + N_BESIDES; k++) {
    const vs_section *s =
        k < VS_SECTIONS ? vs_section_fields(of->machine, of->deck, k) : BESIDES[k - VS_SECTIONS];
    if (name &&
        (strncmp(s->name, name, length) != 0 || (s->name[length] && s->name[length] != '.')))
      continue;
    for (size_t n = 0; n < s->count; n++) put_field(of->to, s->name, &s->fields[n]);
    if (!strcmp(s->name, "circuit")) put_series(of);
    found = true;
  }
  return found;
}

static void list_parameters(const listed *of) {
  put_sections(of, NULL);
  vs_field sink = vs_cooling_heatsink;
  sink.key = "heatsink.DEVICE";
  put_field(of->to, "", &vs_cooling_ambient);
  put_field(of->to, "", &sink);
}

/* An entry whose keys stand below it. */
static void put_keys(vs_entries *to, const vs_field *fields, size_t count) {
  vs_list_entry_array(to, "keys");
  for (size_t k = 0; k < count; k++) {
    vs_list_entry_object(to);
    vs_list_entry_say(to, "   ");
    vs_list_entry_put(to, "key", 16, fields[k].key);
    put_key(to, &fields[k], 12, "a name");
    vs_list_entry_object_end(to);
  }
  vs_list_entry_array_end(to);
}

static void list_events(const listed *of) {
  const vs_event_kind *kind;
  for (size_t k = 0; (kind = vs_events_kind(k)); k++) {
    vs_list_entry_begin(of->to);
    put_named(of->to, kind->name, kind->text);
    put_keys(of->to, kind->fields + 1, kind->n_fields - 1);
    vs_list_entry_end(of->to);
  }
}

static void list_regulators(const listed *of) {
  for (const vs_regulator *const *r = vs_regulators; *r; r++) {
    vs_list_entry_begin(of->to);
    put_named(of->to, (*r)->name, (*r)->text);
    put_keys(of->to, (*r)->fields, (*r)->n_fields);
    vs_list_entry_end(of->to);
  }
}

/* ---- the command ---- */

static const struct kind {
  const char *name, *heading;
  void (*put)(const listed *);
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
static const char ALL[] = "all";
enum { N_KINDS = sizeof KINDS / sizeof *KINDS };

/* True if one kind is asked for, by its name. */
static bool is_named(const vs_list_options *o) {
  return o->kind && strcmp(o->kind, ALL) != 0;
}

static vs_status check_kind(const vs_list_options *o, vs_error *err) {
  const char *names[N_KINDS], *kind = o->kind;
  bool found = !is_named(o);
  for (size_t k = 0; k < N_KINDS; k++) {
    names[k] = KINDS[k].name;
    found = found || !strcmp(kind, names[k]);
  }
  if (found) return VS_OK;
  vs_text there_are = {0};
  for (size_t k = 0; k < N_KINDS; k++) vs_text_add(&there_are, "%s%s", k ? ", " : "", names[k]);
  vs_fail(err, VS_INPUT, "list: no kind '%s'; there are: %s%s", kind, there_are.text,
          vs_text_hint(kind, names, N_KINDS, "").text);
  vs_text_free(&there_are);
  return VS_INPUT;
}

/* Prints the kinds as one JSON object that has an array for each. */
static void print_kind_json(const vs_entries *entries, const char *name, bool is_first) {
  printf("%s  \"%s\": [%s%s]", is_first ? "{\n" : ",\n", name,
         entries->count ? entries->out.text : "", entries->count ? "\n  " : "");
}

/* Lists one kind and returns how many entries it had. */
static int list_kind(const struct kind *kind, const vs_list_options *o, listed *of, bool is_first) {
  vs_entries entries = {.filter = o->filter, .as_json = o->json};
  of->to = &entries;
  kind->put(of);
  if (o->json)
    print_kind_json(&entries, kind->name, is_first);
  else {
    if (!is_named(o) && (entries.count || !o->filter))
      printf("%s%s\n", is_first ? "" : "\n", kind->heading);
    if (entries.count) fputs(vs_list_entry_lines(&entries), stdout);
  }
  vs_list_entry_free(&entries);
  return entries.count;
}

static void list_asked_kinds(const vs_list_options *o, listed *of) {
  int found = 0;
  bool is_first = true;
  for (size_t k = 0; k < N_KINDS; k++) {
    if (is_named(o) && strcmp(o->kind, KINDS[k].name) != 0) continue;
    int here = list_kind(&KINDS[k], o, of, is_first);
    found += here;
    if (o->json || here || !o->filter) is_first = false;
  }
  if (o->json) puts("\n}");
  if (!found && o->filter)
    fprintf(stderr, "vibrospice: list: nothing of %s has '%s'%s\n", is_named(o) ? o->kind : "all",
            o->filter,
            o->machine ? ""
                       : "; measures, probes and parameters are those of the machine conveyor: "
                         "--machine NAME takes another, --deck NAME another deck");
}

vs_status vs_list_command(const vs_list_options *o, vs_error *err) {
  vs_status status = check_kind(o, err);
  if (status) return status;
  vs_default_models ground;
  status = vs_default_models_read(o->deck, o->machine, &ground, err);
  listed of = {.deck = ground.deck, .machine = ground.machine};
  if (!status) list_asked_kinds(o, &of);
  vs_default_models_free(&ground);
  return status;
}

bool vs_list_has(const char *kind) {
  for (size_t k = 0; k < N_KINDS; k++)
    if (!strcmp(kind, KINDS[k].name)) return true;
  return false;
}

const char *vs_list_heading(int k) {
  return k < N_KINDS ? KINDS[k].heading : NULL;
}

const char *vs_list_kind(int k) {
  return k < N_KINDS ? KINDS[k].name : NULL;
}

bool vs_list_section(const char *name, const vs_default_models *ground) {
  vs_entries entries = {0};
  const listed of = {.deck = ground->deck, .machine = ground->machine, .to = &entries};
  const bool found = put_sections(&of, name);
  if (entries.count) fputs(entries.out.text, stdout);
  vs_list_entry_free(&entries);
  return found;
}

/* ---- the command line ---- */

typedef struct list_line {
  vs_arguments common;
  vs_list_options o;
} list_line;

static vs_status list_command(const void *given, vs_error *err) {
  const list_line *line = given;
  const vs_arguments *a = &line->common;
  if (a->n_names > 2)
    return vs_fail(err, VS_INPUT, "list: one argument too many: '%s'; see vibrospice list --help",
                   a->names[2]);
  vs_list_options o = line->o;
  o.kind = vs_command_name(a);
  o.filter = a->n_names > 1 ? a->names[1] : NULL;
  o.json = a->json;
  return vs_list_command(&o, err);
}

static const vs_option LIST_OPTIONS[] = {
    VS_OPTIONS_FILE(list_line, o.deck, "deck", "DECK",
                    "whose probes and parameters (default halfwave_snubbed)"),
    VS_OPTIONS_FILE(list_line, o.machine, "machine", "MACHINE", "likewise (default conveyor)"),
    VS_OPTIONS_FLAG(vs_arguments, json, "json",
                    "an object with an array of entries for each kind, on standard output"),
    VS_OPTIONS_END};

const vs_command vs_list_cli = {
    .name = "list",
    .argument = "[KIND [FILTER]]",
    .text = "lists scenes, studies, fits, machines, decks, parts, instruments, kinds, tiers, laws, "
            "regulators, probes, measures, "
            "parameters (with "
            "unit, default, range); FILTER: only what has that text in its name, kind or "
            "meaning",
    .examples = "  vibrospice list parameters\n  vibrospice list probes --deck my.cir\n"
                "  vibrospice list parameters angle --json\n"
                "  vibrospice list parameters --machine two_mass\n",
    .may_be_alone = true,
    .takes_many = true,
    .options = LIST_OPTIONS,
    .size = sizeof(list_line),
    .run = list_command};
