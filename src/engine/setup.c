/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/setup.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/error.h"
#include "base/text.h"
#include "base/units.h"
#include "engine/channel.h"
#include "engine/events.h"
#include "engine/firing.h"
#include "engine/signals.h"
#include "netlist/deck.h"
#include "netlist/eva.h"
#include "netlist/netlist.h"
#include "netlist/parts.h"
#include "netlist/words.h"
#include "plant/build.h"
#include "plant/machine_file.h"
#include "plant/mechanics.h"
#include "plant/model.h"

/* ---- how a scene is run ---- */

const char vs_setup_tier_words[VS_TIERS][16] = {
#define TIER_WORD_(id, file, word) word,
    VS_TIER_LIST(TIER_WORD_)
#undef TIER_WORD_
};

#define R_(member) offsetof(vs_run_values, member)
#define OR_TIER_(id, file, word) "|" word

static const vs_field RUN[] = {
    {"tier", VS_CHOICE, "", "auto", 0, 0, false, R_(tier),
     "how much is modelled; auto: no more than the scene needs", "auto" VS_TIER_LIST(OR_TIER_),
     NULL},
    {"until", VS_REAL, "s", "2 s", 0, 1e6, true, R_(until_s), "end of the run, which starts at 0",
     NULL, NULL},
    {"sample", VS_REAL, "ms", "0.1 ms", 0, 1e9, true, R_(sample_s),
     "step of the rows in run.csv; does not change the run", NULL, NULL},
    {"tolerance", VS_REAL, "", "1e-4", 1e-10, 0.1, false, R_(tolerance),
     "largest error of motion, force and current, each relative to its peak", NULL, NULL},
    {"max_step", VS_REAL, "us", "0 us", 0, 1e6, false, R_(max_step_s),
     "largest step; 0: chosen from the tolerance", NULL, NULL},
    {"first_step", VS_REAL, "", "1e-7", 1e-12, 1, false, R_(first_step),
     "circuit tier: first step of a run whose mains are not at their zero, as a part of the "
     "largest",
     NULL, NULL},
    {"trtol", VS_REAL, "", "7", 1, 1e4, false, R_(trtol),
     "ngspice's: how much larger than tolerated its estimate of a step's truncation error may be",
     NULL, NULL},
    {"pivrel", VS_REAL, "", "0.05", 1e-6, 1, false, R_(pivrel),
     "ngspice's: how small a pivot may be in its column; decides the order of elimination", NULL,
     NULL},
    {"method", VS_CHOICE, "", "trap", 0, 0, false, R_(gear),
     "circuit tier's rule: trap, or gear, which damps the ringing of stiff circuits and needs half "
     "the step",
     "trap|gear", NULL},
    {"ladder", VS_CHOICE, "", "climb", 0, 0, false, R_(ladder),
     "when ngspice gives up: climb, to other methods and steps, and say so; ideal, to an ideal "
     "thyristor in the place of the scene's besides; or stay",
     VS_LADDER_WORDS, NULL},
    {"verify", VS_CHOICE, "", "auto", 0, 0, false, R_(verify),
     "a second, coarser run tells the numerical error of each margin: auto, in run where something "
     "is rated; always, in studies too; never",
     VS_VERIFY_WORDS, NULL},
    {"leave_circuit", VS_CHOICE, "", "when_quiet", 0, 0, false, R_(stays),
     "circuit tier: go on without ngspice once nothing fires any more and what that costs is "
     "bounded well below the tolerance",
     "when_quiet|never", NULL},
};
#undef OR_TIER_
#undef R_
const vs_section vs_setup_run_keys = {"run", RUN, sizeof RUN / sizeof *RUN};

static const vs_field MEASURE[] = {
    {"from", VS_REAL, "s", "0 s", 0, 1e6, false, offsetof(vs_measure_values, from_s),
     "means (power, i_mean, i_rms) are taken from here on", NULL, NULL},
    {"to", VS_REAL, "s", "0 s", 0, 1e6, false, offsetof(vs_measure_values, to_s),
     "up to here; 0: run.until", NULL, NULL},
    {"last", VS_REAL, "cycles", "0 cycles", 0, 1e9, false, offsetof(vs_measure_values, last_cycles),
     "instead of from and to: over the last cycles of the mains before run.until", NULL, NULL},
};
const vs_section vs_setup_measure_keys = {"measure", MEASURE, sizeof MEASURE / sizeof *MEASURE};

/* Returns the key at which the stretch of time that means are taken over is wrong, with what is
 * wrong in `text`; NULL: nothing is. */
static const char *wrong_means(const vs_measure_values *v, const vs_node *map, double period_s,
                               double until_s, char *text, size_t size) {
  bool from = vs_tree_child(map, "from"), to = vs_tree_child(map, "to");
  double end_s = to ? v->to_s : until_s;
  if (vs_tree_child(map, "last")) {
    if (from || to) {
      snprintf(text, size, "stands beside %s; write from and to, or last", from ? "from" : "to");
      return "last";
    }
    snprintf(text, size, "%g cycles of %g s are none, or more than run.until = %g s",
             v->last_cycles, period_s, until_s);
    return v->last_cycles > 0 && v->last_cycles * period_s <= until_s * (1 + 1e-12) ? NULL : "last";
  }
  snprintf(text, size, "%g s is beyond run.until = %g s", end_s, until_s);
  if (end_s > until_s * (1 + 1e-12)) return "to";
  snprintf(text, size, "%g s is not before the end of what means are over, %g s", v->from_s, end_s);
  return v->from_s < end_s ? NULL : from ? "from" : "to";
}

/* Gives the stretch of time that means are taken over. map: the section measure, as v was read from
 * it; period_s: of the mains. Errors: from is not before to, to is beyond run.until, there are more
 * cycles than the run has, both ways are taken at once. */
static vs_status find_averaging_window(const vs_measure_values *v, const vs_node *map,
                                       double until_s, double period_s, vs_span_s *means,
                                       vs_error *err) {
  char text[160];
  const char *key = wrong_means(v, map, period_s, until_s, text, sizeof text);
  const vs_node *node = key ? vs_tree_child(map, key) : NULL;
  if (key) return vs_fail_at(err, node ? node->where : map->where, "measure.%s: %s", key, text);
  bool to = vs_tree_child(map, "to");
  double first_s = v->last_cycles > 0 ? until_s - v->last_cycles * period_s : v->from_s;
  *means = (vs_span_s){fmax(first_s, 0), to ? fmin(v->to_s, until_s) : until_s};
  return VS_OK;
}

/* ---- the load over time: its events ---- */

/* The event that changes the load next behind `before`, NULL: behind the beginning; or NULL: there
 * is none. */
static const vs_scene_event *next_load_event(const vs_events *events,
                                             const vs_scene_event *before) {
  const vs_scene_event *next = NULL;
  for (size_t k = 0; k < events->count; k++) {
    const vs_scene_event *e = &events->item[k];
    bool later = !before || e->start_s > before->start_s;
    if (e->kind->load && later && (!next || e->start_s < next->start_s)) next = e;
  }
  return next;
}

static vs_status check_load_events(const vs_events *events, const vs_machine *machine,
                                   vs_error *err) {
  for (size_t k = 0; k < events->count; k++) {
    const vs_scene_event *e = &events->item[k];
    double fraction = NAN, volume_m3 = NAN;
    if (!e->kind->load) continue;
    if (machine->load.adds < 0)
      return vs_fail_at(err, e->where,
                        "events.%s: machine %s has no load (its file has no key load) that could "
                        "change; leave the event out",
                        e->name, machine->path);
    e->kind->load(e, &fraction, &volume_m3);
    if (isnan(fraction) && isnan(volume_m3))
      return vs_fail_at(err, e->where,
                        "events.%s: 'fraction' or 'volume' is wanted: what the load becomes",
                        e->name);
    for (size_t n = 0; n < k; n++)
      if (events->item[n].kind->load && events->item[n].start_s == e->start_s)
        return vs_fail_at(err, e->where, "events.%s: it clashes with events.%s: at the same time",
                          e->name, events->item[n].name);
  }
  return VS_OK;
}

/* ---- the load over time: its machines ---- */

static void free_loads(vs_loads *loads) {
  free(loads->item);
  *loads = (vs_loads){0};
}

vs_status vs_setup_make_loads(const vs_events *events, vs_machine *machine, vs_model *model,
                              vs_loads *loads, vs_error *err) {
  size_t count = 0;
  free_loads(loads);
  for (size_t k = 0; k < events->count; k++) count += events->item[k].kind->load != NULL;
  model->reloaded = count > 0;
  vs_status s = count ? check_load_events(events, machine, err) : VS_OK;
  if (s || !count) return s;
  loads->item = vs_alloc(count, sizeof *loads->item);
  const vs_model *from = model;
  for (const vs_scene_event *e = NULL; (e = next_load_event(events, e)) && !s; loads->count++) {
    vs_loaded *to = &loads->item[loads->count];
    vs_load_values load = from->load;
    double fraction = NAN;
    e->kind->load(e, &fraction, &load.volume_m3);
    if (!isnan(fraction)) load.fraction = fraction;
    to->at_s = e->start_s;
    s = vs_build_loaded(machine, from, &load, isnan(fraction) ? from->riding : fraction, &to->model,
                        err);
    from = &to->model;
  }
  return s;
}

const vs_scene_event *vs_setup_load_event(const vs_events *events, double at_s) {
  for (size_t k = 0; k < events->count; k++)
    if (events->item[k].kind->load && events->item[k].start_s == at_s) return &events->item[k];
  return NULL;
}

double vs_setup_load_at(const vs_loads *loads, size_t k) {
  return k < loads->count ? loads->item[k].at_s : INFINITY;
}

bool vs_setup_stands(const vs_setup *s) {
  return s->deck.stands && s->timeline.supply.direct;
}

/* ---- names that are taken ----
 *
 * A machine and a deck must not give what they show a name that is taken already. */

/* True for the name of a channel that every machine has, and for the one that the measures of the
 * travel begin with: gap_min. */
static bool is_the_programs(const char *name) {
  return vs_channel_is_standard(name) || !strcmp(name, "gap");
}

/* Error, where it stands: a coordinate, a rate or a probe of the machine has the name of a channel
 * that every machine has. A check carries on. */
static vs_status check_names_of_machine(const vs_machine *m, vs_error *err) {
  vs_status s = VS_OK;
  for (int k = 0; k < m->dof && !s; k++) {
    const vs_coordinate *c = &m->coordinates[k];
    const char *const names[] = {c->name, c->rate, c->rate2};
    for (int d = 0; d < 3 && !s; d++)
      if (is_the_programs(names[d]))
        s = vs_error_keep(err,
                          vs_fail_at(err, c->where, "coordinate %s: the name %s is the program's",
                                     c->name, names[d]));
  }
  for (int k = 0; k < m->n_probes && !s; k++)
    if (vs_channel_is_standard(m->probes[k].name))
      s = vs_error_keep(err, vs_fail_at(err, m->probes[k].where,
                                        "probe %s: that name is the program's", m->probes[k].name));
  return s;
}

/* A probe of the deck must not have the name of a channel that every tier has, nor that of the
 * time. */
static vs_status refuse_taken_names(const vs_model *model, const vs_deck *deck, vs_error *err) {
  vs_status s = VS_OK;
  for (size_t k = 0; k < deck->n_probes && !s; k++) {
    const vs_probe *probe = &deck->probes[k];
    bool machines = vs_machine_has_output(model->machine, probe->name);
    bool taken = machines || !strcmp(probe->name, "t") || !strcmp(probe->name, "gap") ||
                 vs_channel_is_standard(probe->name);
    if (taken)
      s = vs_error_keep(err,
                        vs_fail_at(err, probe->where, "probe %s: that name is %s%s", probe->name,
                                   machines ? "taken by the machine " : "the program's",
                                   machines ? model->machine->path : ""));
  }
  return s;
}

/* True if the shorter name, its unit behind it, makes the longer name's column. */
static bool is_one_column(vs_channel a, vs_channel b) {
  char of_a[32], of_b[32];
  size_t n = strlen(a.name), m = strlen(b.name);
  if (n > m) return is_one_column(b, a);
  if (n == m || strncmp(a.name, b.name, n) != 0) return false; /* names are compared elsewhere */
  vs_units_suffix(a.unit, of_a, sizeof of_a);
  vs_units_suffix(b.unit, of_b, sizeof of_b);
  const char *rest = b.name + n, *want = of_a;
  if (*rest++ != '_' || strncmp(rest, want, m - n - 1) != 0) return false;
  want += m - n - 1;
  return !*of_b ? !*want : *want++ == '_' && !strcmp(want, of_b);
}

static vs_where channel_place(const vs_frame *frame, int number) {
  const vs_model *m = frame->model;
  if (number >= vs_channel_deck(m)) return frame->deck->probes[number - vs_channel_deck(m)].where;
  if (number >= vs_channel_probes(m))
    return m->machine->probes[number - vs_channel_probes(m)].where;
  return m->machine->coordinates[(number - VS_CH_Q) % m->dof].where;
}

/* A column is a name with its unit: x in m, and x_m without a unit, would be one. The first column
 * is the time's. */
static vs_status refuse_one_column(const vs_model *model, const vs_deck *deck, vs_error *err) {
  static const vs_channel TIME = {.name = "t", .unit = "s"};
  const vs_frame frame = {.model = model, .deck = deck};
  vs_status s = VS_OK;
  for (int k = VS_CH_Q, n = vs_channel_count(&frame); k < n && !s; k++) {
    vs_channel c = vs_channel_at(&frame, k);
    int j = 0;
    while (j < k && !is_one_column(c, vs_channel_at(&frame, j))) j++;
    const bool is_time = is_one_column(c, TIME);
    if (j < k || is_time)
      s = vs_error_keep(
          err, vs_fail_at(err, channel_place(&frame, k),
                          "%s: its column in a run's table is that of %s; give it another name",
                          c.name, is_time ? TIME.name : vs_channel_at(&frame, j).name));
  }
  return s;
}

/* Error, where it stands: a probe of the deck has the name of a channel that every tier has, or of
 * the machine's, or of the time; or two channels would have one column in a run's table. A check
 * carries on. */
static vs_status check_names_of_deck(const vs_model *model, const vs_deck *deck, vs_error *err) {
  size_t found = vs_error_count(err);
  vs_status s = refuse_taken_names(model, deck, err);
  return s || vs_error_count(err) > found ? s : refuse_one_column(model, deck, err);
}

const char vs_setup_steady[] = "steady";

/* ---- the machine ---- */

/* The scene's node of the key machine.model, and the name that it gives. */
static const vs_node *machine_node(const vs_node *scene) {
  return vs_tree_child(vs_tree_child(scene, "machine"), vs_machine_key.key);
}

/* Reads the machine's file into an empty machine, of which a check has as much as can be read. */
static vs_status read_machine(const vs_node *scene, vs_machine *machine, vs_error *err) {
  const vs_node *named = machine_node(scene);
  const vs_section only_model = {"machine", &vs_machine_key, 1};
  const vs_node word = vs_tree_word(NULL, vs_machine_key.default_text, (vs_where){0});
  char path[VS_PATH_SIZE];
  vs_machine_values values;
  vs_machine_begin(machine);
  machine->lost = true;
  vs_status s = vs_field_read(&only_model, &vs_machine_key, named ? named : &word, &values, err);
  if (!s)
    s = vs_path_find(&vs_machine_shelf, values.model, named ? named->where : (vs_where){0}, path,
                     err);
  if (!s) s = vs_machine_file_read(path, machine, err);
  return s ? s : check_names_of_machine(machine, err);
}

/* True if the scene names the machine that the setup has. */
static bool keeps_machine(const vs_node *scene, const vs_setup *setup) {
  const vs_node *named = machine_node(scene);
  const char *had = setup->model.parameters.model;
  if (!setup->machine || setup->machine->lost || (named && named->kind != VS_NODE_TEXT))
    return false;
  return !strcmp(had, named ? named->text : vs_machine_key.default_text);
}

static void free_machine(vs_setup *setup) {
  if (!setup->machine) return;
  vs_machine_free(setup->machine);
  free(setup->machine);
  setup->machine = NULL;
}

static void forget_setup(vs_setup *setup) {
  vs_actuator_end(&setup->model.coil);
  setup->model.coil = (vs_coil){0};
  vs_text_free(&setup->written);
  vs_section_cache_free(&setup->memo);
}

/* ---- the circuit ---- */

/* Reads the values of the section circuit, whose keys are its deck's parameters. */
static vs_status read_values(const vs_node *map, vs_setup *setup, vs_error *err) {
  vs_circuit_values *values = &setup->circuit_values;
  if (setup->deck.lost & VS_LOST_PARAM) map = NULL; /* a key may be that one's */
  vs_status s =
      vs_section_cache_read(&setup->memo, &setup->deck.section, map, values, sizeof *values, err);
  size_t param = 0;
  for (size_t k = 1; k < setup->deck.section.count; k++) {
    const vs_field *field = &setup->deck.section.fields[k];
    if (field->kind != VS_REAL) continue;
    unsigned char *unsure = setup->deck.unsure[param++];
    unsure[1] = vs_tree_child(map, field->key) ? 0 : unsure[0];
  }
  vs_deck_value standard[VS_STANDARD];
  vs_setup_standard(setup, standard);
  size_t found = vs_error_count(err);
  if (!s) s = vs_deck_bind(&setup->deck, values, standard, VS_STANDARD, err);
  return s || vs_error_count(err) > found ? s
                                          : vs_parts_require_hold(&setup->deck, values, map, err);
}

/* Reads the section circuit: first its key `deck`, then all of it, as that deck's parameters are
 * its other keys. */
static vs_status read_circuit(const vs_node *scene, vs_setup *setup, vs_error *err) {
  const vs_node *map = vs_tree_child(scene, "circuit"),
                *named = vs_tree_child(map, vs_deck_key.key);
  const vs_section only_deck = {"circuit", &vs_deck_key, 1};
  const vs_node word = vs_tree_word(NULL, vs_deck_key.default_text, (vs_where){0});
  char path[VS_PATH_SIZE];
  vs_circuit_values *values = &setup->circuit_values;
  vs_status s = vs_field_read(&only_deck, &vs_deck_key, named ? named : &word, values, err);
  if (!s)
    s = vs_path_find(&vs_deck_shelf, values->deck, named ? named->where : (vs_where){0}, path, err);
  if (!s) s = vs_netlist_read(path, &setup->deck, err);
  if (s) {
    setup->deck.lost = VS_LOST_ALL;
    return s;
  }
  s = vs_netlist_read_parts(&setup->deck, map, err);
  if (!s) s = check_names_of_deck(&setup->model, &setup->deck, err);
  return s ? s : read_values(map, setup, err);
}

/* ngspice has no resistor of 0 ohm: it takes 1 mohm in its place. */
double vs_setup_source_ohm(const vs_setup *setup) {
  const double r_ohm = setup->timeline.supply.resistance_ohm;
  return r_ohm > 0 ? r_ohm : 1e-3;
}

void vs_setup_standard(const vs_setup *setup, vs_deck_value standard[VS_STANDARD]) {
  const vs_supply_values *supply = &setup->timeline.supply;
  const double values[] = {
      [VS_STANDARD_U_RMS] = supply->voltage_v,
      [VS_STANDARD_F_MAINS] = supply->frequency_hz,
      [VS_STANDARD_PHASE] = supply->phase_rad,
      [VS_STANDARD_R_SOURCE] = vs_setup_source_ohm(setup),
      [VS_STANDARD_L_SOURCE] = supply->inductance_h + supply->decoupling_h,
      [VS_STANDARD_EVA_RESISTANCE] = setup->model.coil.resistance_ohm,
      [VS_STANDARD_EVA_A] = setup->model.coil.a_hm,
  };
  _Static_assert(sizeof values / sizeof *values == VS_STANDARD, "a value for each name");
  for (int k = 0; k < VS_STANDARD; k++)
    standard[k] = (vs_deck_value){vs_deck_standard_names[k], values[k]};
}

/* Error: a decoupling inductance for a deck whose elements do not use l_source, of which it is a
 * part. */
static vs_status check_decoupling(const vs_node *scene, const vs_setup *setup, vs_error *err) {
  const char *name = vs_deck_standard_names[VS_STANDARD_L_SOURCE];
  const vs_deck *deck = &setup->deck;
  if (!(setup->timeline.supply.decoupling_h > 0) || deck->lost) return VS_OK;
  for (size_t k = 0; k < deck->n_lines; k++)
    if (vs_words_find(deck->lines[k].text, deck->lines[k].text, name, strlen(name))) return VS_OK;
  return vs_fail_at(err, vs_tree_place(scene, "supply.decoupling"),
                    "supply.decoupling: the deck has no element of {%s}, of which it would be a "
                    "part; give the mains' lead one, as 'Lsource s1 a {%s} ic=0'",
                    name, name);
}

/* Error: load.fraction is auto, and the scene has no orbit with which it could be found. */
static vs_status check_fraction(const vs_node *scene, const vs_setup *setup, vs_error *err) {
  const vs_timeline *line = &setup->timeline;
  const char *why = NULL;
  if (!setup->wants_fraction) return VS_OK;
  if (line->supply.direct) why = "and direct voltage (supply.kind: step) has none";
  if (!line->firing.no_valve && !line->firing.every)
    why = "and firing.every is 'once'; write firing.every: 1";
  if (line->firing.angle.count > 0)
    why = "and firing.angle is a table over time, which has none; write one angle";
  if (vs_deck_has_port(&setup->deck, vs_port_is_modulated))
    why = "and no orbit is sought where the deck has a port pwm";
  if (!why) return VS_OK;
  return vs_fail_at(err, vs_tree_place(scene, "load.fraction"),
                    "load.fraction: auto is found on the machine's orbit, %s, or a number here",
                    why);
}

/* Refuses, where the key stands or else at `map`, what leaves `start: steady` without a meaning. */
static vs_status check_steady(const vs_node *scene, const vs_setup *setup, const vs_node *map,
                              vs_error *err) {
  const vs_timeline *line = &setup->timeline;
  const vs_firing_values *firing = &line->firing;
  const char *section = "firing", *key = "every", *why = NULL;
  if (vs_deck_has_port(&setup->deck, vs_port_is_modulated))
    section = "circuit", key = "deck",
    why = "no orbit is sought where the deck has a port pwm; write start: {NAME: VALUE, ...}";
  else if (line->supply.direct)
    section = "supply", key = "kind", why = "direct voltage has no cycles, and so no orbit";
  else if (!firing->no_valve && !firing->every)
    why = "an orbit wants a firing in every cycle, and this is 'once'; write firing.every: 1";
  else if (firing->angle.count > 0)
    key = "angle", why = "an orbit has one angle, and this is a table over time";
  else if (!firing->no_valve && firing->first_cycle != 1)
    key = "first_cycle", why = "an orbit has a firing in the first cycle; leave the key out";
  else if (line->supply.phase_rad != 0)
    section = "supply", key = "phase",
    why = "an orbit begins at the mains' rise through zero; write 0 deg, or leave the key out";
  if (!why) return VS_OK;
  const vs_node *node = vs_tree_child(vs_tree_child(scene, section), key);
  return vs_fail_at(err, node ? node->where : map->where, "%s.%s: start is steady: %s", section,
                    key, why);
}

/* Reads `start: steady`. Error: another word stands there. */
static vs_status read_steady(const vs_node *scene, const vs_node *map, vs_setup *setup,
                             vs_error *err) {
  vs_status s = VS_OK;
  if (strcmp(map->text, vs_setup_steady))
    s = vs_fail_at(err, map->where,
                   "start: '%s' is neither 'steady' nor a map of coordinates: {%s: 0, ...}",
                   map->text, setup->machine->coordinates[0].name);
  setup->steady = !s;
  if (!s) s = check_steady(scene, setup, map, err);
  return vs_error_keep(err, s);
}

/* Reads the section start. Error: the armature would begin beyond the pole cover, or beyond the
 * iron where there is a stop. */
static vs_status read_start(const vs_node *scene, vs_setup *setup, vs_error *err) {
  const vs_model *m = &setup->model;
  const vs_section *section = &m->machine->start;
  const vs_node *map = vs_tree_child(scene, section->name), *key = NULL;
  const vs_actuator_values *a = &m->actuator;
  vs_status s = VS_OK;
  setup->steady = setup->at_work = false;
  if (m->machine->lost) return VS_OK;
  if (map && map->kind == VS_NODE_TEXT && *map->text) {
    s = read_steady(scene, map, setup, err);
    map = NULL;
  }
  if (!s)
    s = vs_section_cache_read(&setup->memo, section, map, &setup->start, sizeof setup->start, err);
  if (s || vs_error_count(err) || !m->coil.law->poles) return s; /* of the gap, perhaps */
  double least = -(a->gap_m + (m->stops.count ? a->pole_cover_m : 0));
  double g = vs_mechanics_travel(m, setup->start.x);
  if (g > least) return s;
  for (int i = 0; i < m->dof && !key; i++)
    if (m->along[i] != 0) key = vs_tree_child(map, m->machine->coordinates[i].name);
  return vs_fail_at(err, key ? key->where : vs_tree_place(scene, section->name),
                    "start.%s: %g mm is beyond the pole cover%s; allowed: more than %g mm",
                    key ? key->key : "", 1e3 * g, m->stops.count ? " and the iron" : "",
                    1e3 * least);
}

/* Reads the section measure. Errors: those of find_averaging_window. */
static vs_status read_means(const vs_node *scene, vs_setup *setup, vs_error *err) {
  const vs_node *map = vs_tree_child(scene, vs_setup_measure_keys.name);
  vs_measure_values *v = &setup->measure;
  double until_s = setup->run.until_s;
  setup->means = (vs_span_s){0, until_s};
  size_t found = vs_error_count(err);
  vs_status s = vs_section_cache_read(&setup->memo, &vs_setup_measure_keys, map, v, sizeof *v, err);
  if (s || vs_error_count(err) > found || !map || map->kind != VS_NODE_MAP) return s;
  return find_averaging_window(v, map, until_s, setup->timeline.period_s, &setup->means, err);
}

/* Reads the section limits, and holds a deck that was just read to it. */
static vs_status read_limits(const vs_node *scene, vs_setup *setup, bool has_deck, vs_error *err) {
  const vs_node *map = vs_tree_child(scene, vs_limits_section.name);
  vs_limits_values *v = &setup->limits;
  size_t found = vs_error_count(err);
  vs_status s = vs_section_cache_read(&setup->memo, &vs_limits_section, map, v, sizeof *v, err);
  if (s || has_deck || vs_error_count(err) > found) return s;
  return vs_error_keep(err, vs_limits_devices(&setup->deck, v->devices, err));
}

/* The EVA begins without a current. */
static void begin_eva(vs_setup *setup) {
  const vs_model *m = &setup->model;
  setup->deck.eva_flux_wb = vs_coil_idle_flux(&m->coil, vs_mechanics_gap(m, setup->start.x));
}

/* A run in which something happens after the circuit may have been left wants an EVA that can be
 * led back. Leaving takes a few cycles, so fewer than four between two firings are not worth it. An
 * EVA that an event has put in its place stays. has_motions: the deck's motions are known already.
 */
static vs_status choose_eva(vs_setup *setup, bool has_motions, vs_error *err) {
  bool again = setup->timeline.firing.every >= 4 || setup->timeline.events.count;
  setup->deck.eva_led =
      again && !setup->deck.eva_file && setup->model.coil.square && !setup->model.coil.eddies;
  if (vs_error_count(err)) return VS_OK; /* there may be no coil */
  vs_eva_take_law(&setup->deck, &setup->model.coil);
  begin_eva(setup);
  vs_status s = vs_error_keep(err, vs_eva_check_names(&setup->deck, &setup->model.coil, err));
  if (!s && !has_motions)
    s = vs_error_keep(err, vs_eva_take_motions(&setup->deck, setup->machine, err));
  return s;
}

/* All that the scene's events are to a run: they are read against the mains, put into the deck as
 * lines and sources, and give the machine other loads. In between the deck is looked at as the user
 * wrote it. */
static vs_status build_events(const vs_node *scene, vs_setup *setup, vs_error *err) {
  vs_timeline *line = &setup->timeline;
  vs_events *events = &line->events;
  vs_status s =
      vs_events_read(vs_tree_child(scene, "events"), line, setup->run.until_s, events, err);
  if (!s) s = vs_error_keep(err, check_decoupling(scene, setup, err));
  if (!s) s = vs_cooling_read(scene, &setup->deck, &setup->cooling, err);
  if (!s) s = vs_events_wire(events, &setup->deck, err);
  if (!s && !setup->machine->lost && !vs_error_count(err))
    s = vs_error_keep(
        err, vs_setup_make_loads(events, setup->machine, &setup->model, &setup->loads, err));
  return s;
}

/* Builds all of it; with has_deck the deck's text is there already, and so is a machine that the
 * setup has. */
static vs_status build_setup(const vs_node *scene, vs_setup *setup, bool has_deck, vs_error *err) {
  vs_status s = VS_OK;
  const bool has_machine = setup->machine;
  if (!has_machine) {
    setup->machine = vs_alloc(1, sizeof *setup->machine);
    s = vs_error_keep(err, read_machine(scene, setup->machine, err));
  }
  if (!s)
    s = vs_error_keep(err,
                      vs_build_again(scene, setup->machine, &setup->model, &setup->written, err));
  if (!s)
    s = vs_error_keep(
        err, vs_timeline_build(scene, setup->machine, &setup->timeline, &setup->memo, err));
  if (!s && has_deck)
    s = read_values(vs_tree_child(scene, "circuit"), setup, err);
  else if (!s)
    s = vs_error_keep(err, read_circuit(scene, setup, err));
  if (!s)
    s = vs_section_cache_read(&setup->memo, &vs_setup_run_keys, vs_tree_child(scene, "run"),
                              &setup->run, sizeof setup->run, err);
  if (!s) s = read_limits(scene, setup, has_deck, err);
  if (!s)
    s = vs_error_keep(
        err, vs_timeline_settle(scene, setup->machine, &setup->timeline, &setup->deck, err));
  setup->model.pulls_in =
      setup->timeline.supply.direct && vs_stops_closing(&setup->model.stops) >= 0;
  if (!s) s = build_events(scene, setup, err);
  setup->wants_fraction = isnan(setup->model.load.fraction);
  if (!s) s = vs_error_keep(err, check_fraction(scene, setup, err));
  if (!s) s = vs_error_keep(err, read_start(scene, setup, err));
  if (!s) s = vs_error_keep(err, read_means(scene, setup, err));
  if (!s) s = choose_eva(setup, has_deck && has_machine, err);
  return s;
}

vs_status vs_setup_build(const vs_node *scene, vs_setup *setup, vs_error *err) {
  if (setup->begun) memset(setup, 0, sizeof *setup); /* as in vs_deck_begin() */
  setup->begun = true;
  vs_status s = build_setup(scene, setup, false, err);
  if (s) setup->deck.lost = VS_LOST_ALL; /* so that vs_setup_again reads it anew */
  return s;
}

bool vs_setup_keeps_deck(const vs_node *scene, const vs_setup *setup) {
  const vs_node *map = vs_tree_child(scene, "circuit"), *events = vs_tree_child(scene, "events");
  const vs_deck *deck = &setup->deck;
  if (!deck->n_files || deck->lost || setup->timeline.events.count || (events && events->child))
    return false;
  for (size_t k = 0; k < deck->section.count; k++) {
    const vs_field *field = &deck->section.fields[k];
    const vs_node *node = vs_tree_child(map, field->key);
    const char *had = (const char *)&setup->circuit_values + field->offset;
    if (field->kind != VS_NAME) continue;
    if (node && node->kind != VS_NODE_TEXT) return false;
    if (strcmp(had, node ? node->text : field->default_text) != 0) return false;
  }
  return true;
}

vs_status vs_setup_again(const vs_node *scene, vs_setup *setup, vs_error *err) {
  bool keeps = vs_setup_keeps_deck(scene, setup);
  if (!keeps || !keeps_machine(scene, setup)) forget_setup(setup);
  if (!keeps_machine(scene, setup)) free_machine(setup);
  free_loads(&setup->loads);
  if (!keeps) {
    vs_deck_free(&setup->deck);
    *setup = (vs_setup){.begun = true, .machine = setup->machine};
  }
  vs_status s = build_setup(scene, setup, keeps, err);
  if (s) setup->deck.lost = VS_LOST_ALL; /* so that it is read anew the next time */
  return s;
}

void vs_setup_free(vs_setup *setup) {
  forget_setup(setup);
  free_machine(setup);
  free_loads(&setup->loads);
  vs_deck_free(&setup->deck);
}

vs_setup vs_setup_varied(const vs_setup *from, const vs_run_values *run,
                         const double x[VS_MOST_STATES]) {
  vs_setup setup = *from;
  setup.run = *run;
  if (run->until_s != from->run.until_s) setup.means = (vs_span_s){0, run->until_s};
  if (x) memcpy(setup.start.x, x, sizeof setup.start.x);
  if (x) setup.steady = false;
  begin_eva(&setup);
  return setup;
}

double vs_setup_edge(const vs_setup *setup, double t_s) {
  double next_s = vs_events_edge(&setup->timeline.events, t_s);
  for (size_t k = 0; k < setup->deck.n_ports; k++) {
    const vs_signal *s = &setup->deck.ports[k].signal;
    next_s = fmin(next_s, vs_signals_edge(&setup->timeline, s, t_s));
  }
  double known_s = vs_firing_known_s(&setup->timeline);
  return known_s > t_s + vs_scene_event_rounding(t_s) ? fmin(next_s, known_s) : next_s;
}

bool vs_setup_found_fraction(const vs_setup *setup) {
  return isnan(setup->model.load.fraction) && !setup->wants_fraction;
}

vs_status vs_setup_require_fraction(const vs_setup *setup, vs_where where, const char *who,
                                    vs_error *err) {
  if (!setup->wants_fraction) return VS_OK;
  return vs_fail_at(err, where,
                    "load.fraction: auto: %s wants a number; run, studies and steady find one, and "
                    "print it",
                    who);
}

double vs_setup_jams(const vs_setup *setup) {
  const vs_events *events = &setup->timeline.events;
  double first_s = INFINITY;
  for (size_t k = 0; k < events->count; k++)
    if (events->item[k].kind->jams) first_s = fmin(first_s, events->item[k].start_s);
  return first_s;
}

double vs_setup_coil_cut(const vs_setup *setup) {
  const vs_events *events = &setup->timeline.events;
  double first_s = INFINITY;
  for (size_t k = 0; k < events->count; k++) {
    const vs_scene_event *e = &events->item[k];
    if (e->kind->cuts && !strcasecmp(e->kind->element(e, &setup->deck), setup->deck.eva))
      first_s = fmin(first_s, e->start_s);
  }
  return first_s;
}
