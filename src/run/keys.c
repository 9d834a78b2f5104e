/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/keys.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/units.h"
#include "netlist/devices.h"
#include "run/sections.h"

enum { MOST_KEYS = 1024 };

typedef struct key_list {
  vs_key item[MOST_KEYS];
  size_t count;
} key_list;

static void add_keys_of_maps(key_list *list, const vs_field *f, const char *member);

static void add_keys_of_section(key_list *list, const char *section, const vs_section *fields,
                                const void *values) {
  for (size_t k = 0; k < fields->count && list->count < MOST_KEYS; k++) {
    const vs_field *f = &fields->fields[k];
    const char *member = values ? (const char *)values + f->offset : NULL;
    vs_key *key = &list->item[list->count++];
    snprintf(key->name, sizeof key->name, "%.*s.%s", VS_KEY_SIZE - 2, section, f->key);
    snprintf(key->section, sizeof key->section, "%s", section);
    key->field = f;
    key->value = member;
    if (f->kind == VS_OPTION) add_keys_of_maps(list, f, member);
  }
}

/* The keys of an option's maps: NAME.KEY where it has none or one, NAME.1.KEY, ... where it has a
 * list of them. */
static void add_keys_of_maps(key_list *list, const vs_field *f, const char *member) {
  char name[VS_KEY_SIZE], part[VS_KEY_SIZE + 16];
  const vs_inside *o = f->inside;
  int count = member ? vs_field_maps(f, member) : 0;
  snprintf(name, sizeof name, "%s", list->item[list->count - 1].name);
  if (!count) add_keys_of_section(list, name, &o->keys, NULL);
  for (int k = 0; k < count; k++) {
    const char *values = member + (size_t)k * o->size;
    snprintf(part, sizeof part, count > 1 ? "%s.%d" : "%s", name, k + 1);
    add_keys_of_section(list, part, vs_field_form(o, values), values);
  }
}

static void add_keys_of_event(key_list *list, const vs_scene_event *e) {
  char name[VS_KEY_SIZE];
  snprintf(name, sizeof name, "events.%s", e->name);
  const vs_section section = {name, e->kind->fields, e->kind->n_fields};
  add_keys_of_section(list, name, &section, &e->v);
}

/* `ambient`, and the heat sinks that the scene has. */
static void add_cooling(key_list *list, const vs_setup *setup) {
  const vs_cooling *cooling = &setup->cooling;
  if (!cooling->stated) return;
  if (list->count < MOST_KEYS)
    list->item[list->count++] =
        (vs_key){.name = "ambient", .field = &vs_cooling_ambient, .value = &cooling->ambient_degc};
  for (size_t k = 0; k < setup->deck.n_devices && list->count < MOST_KEYS; k++) {
    if (!(cooling->sink_k_per_w[k] > 0)) continue;
    vs_key *key = &list->item[list->count++];
    *key = (vs_key){
        .section = "heatsink", .field = &vs_cooling_heatsink, .value = &cooling->sink_k_per_w[k]};
    snprintf(key->name, sizeof key->name, "heatsink.%s", setup->deck.devices[k].name);
  }
}

static key_list *all_keys(const vs_scene *scene) {
  const vs_setup *setup = &scene->setup;
  const vs_instruments *instruments = &scene->instruments;
  key_list *list = vs_alloc(1, sizeof *list);
  for (int p = 0; p < VS_SECTIONS; p++) {
    vs_filled_section part = vs_section_at(setup, p);
    add_keys_of_section(list, part.section->name, part.section, part.values);
  }
  if (instruments->count)
    add_keys_of_section(list, vs_instruments_section.name, &vs_instruments_section,
                        &instruments->v);
  for (int k = 0; k < instruments->count; k++)
    add_keys_of_section(list, instruments->item[k].path, &instruments->item[k].section,
                        &instruments->item[k].v);
  if (scene->control.regulator)
    add_keys_of_section(list, scene->control.section.name, &scene->control.section,
                        &scene->control.v);
  if (scene->control.observing.system)
    add_keys_of_section(list, vs_state_observer_section.name, &vs_state_observer_section,
                        &scene->control.observing.v);
  const vs_events *events = &setup->timeline.events;
  for (size_t e = 0; e < events->count; e++) add_keys_of_event(list, &events->item[e]);
  for (size_t e = 0; e < events->n_unbuilt; e++) add_keys_of_event(list, &events->unbuilt[e]);
  add_cooling(list, setup);
  return list;
}

/* Refuses the name of a section, which has keys of its own. `start` may be a word instead of keys,
 * which is the same for all runs of a scene. */
static vs_status refuse_section(const vs_key *one, vs_where where, vs_error *err) {
  const bool start = !strcmp(one->section, "start");
  return vs_fail_at(err, where, "%s has keys of its own, such as %s: name one of those%s",
                    one->section, one->name,
                    start ? "; 'steady' is not for vary: set: {start: steady} begins every case on "
                            "its orbit"
                          : "");
}

/* Refuses a key of instruments in a scene without any. */
static vs_status refuse_instrument_key(const char *name, vs_where where, vs_error *err) {
  return vs_fail_at(err, where,
                    "%s: the scene has no section instruments; give it one, as instruments.set=own "
                    "(in a study set: {instruments.set: own})",
                    name);
}

static vs_status refuse_key_name(const vs_scene *scene, const key_list *list, const char *name,
                                 vs_where where, vs_error *err) {
  const char *names[MOST_KEYS], *section = vs_instruments_section.name;
  size_t length = strlen(section);
  if (!scene->instruments.count && !strncmp(name, section, length) && name[length] == '.')
    return refuse_instrument_key(name, where, err);
  for (size_t k = 0; k < list->count; k++) {
    names[k] = list->item[k].name;
    if (!strcmp(list->item[k].section, name)) return refuse_section(&list->item[k], where, err);
  }
  return vs_fail_at(
      err, where, "a scene has no key '%s'%s", name,
      vs_text_hint(name, names, list->count, "; see 'vibrospice list parameters'").text);
}

static const vs_key *key_named(const key_list *list, const char *name) {
  for (size_t k = 0; k < list->count; k++)
    if (!strcmp(list->item[k].name, name)) return &list->item[k];
  return NULL;
}

static bool has_key(const vs_scene *scene, const char *name) {
  key_list *list = all_keys(scene);
  const bool found = key_named(list, name);
  free(list);
  return found;
}

vs_status vs_key_find(const vs_scene *scene, const char *name, vs_where where, vs_key *key,
                      vs_error *err) {
  key_list *list = all_keys(scene);
  const vs_key *found = key_named(list, name);
  vs_status status = VS_OK;
  if (found)
    *key = *found;
  else
    status = refuse_key_name(scene, list, name, where, err);
  free(list);
  return status;
}

double vs_key_number(const vs_key *key) {
  double real = NAN;
  int whole = 0;
  if (!key->value) return NAN;
  if (vs_field_is_real(key->field)) memcpy(&real, key->value, sizeof real);
  if (key->field->kind != VS_COUNT) return real;
  memcpy(&whole, key->value, sizeof whole);
  return whole;
}

/* ---- spreads ---- */

static const char OF_CIRCUIT[] = "circuit.", OF_SCALE[] = "_scale";

/* The device whose value or factor the key is: circuit.NAME, circuit.NAME_scale. NULL: none. */
static const vs_device *device_of(const vs_deck *deck, const char *key) {
  if (strncmp(key, OF_CIRCUIT, strlen(OF_CIRCUIT))) return NULL;
  key += strlen(OF_CIRCUIT);
  for (size_t k = 0; k < deck->n_devices; k++) {
    const size_t n = strlen(deck->devices[k].name);
    if (!strncmp(key, deck->devices[k].name, n) && (!key[n] || !strcmp(key + n, OF_SCALE)))
      return &deck->devices[k];
  }
  return NULL;
}

/* Multiplies the ends, in parts of the nominal value, by what the part's file states under that
 * name. False: it states nothing. */
static bool take_figure(const vs_deck *deck, const vs_device *d, const char *name, double end[2]) {
  const vs_limit *figure = d ? vs_devices_own_limit(deck, d, name) : NULL;
  if (!figure || isinf(figure->value)) return false;
  end[0] *= 1 - figure->value;
  end[1] *= 1 + figure->value;
  return true;
}

static const char *const FIGURES[] = {"tolerance", "ageing"};

static bool is_figure(const char *way, const char *name) {
  return !strcmp(way, name) || !strcmp(way, "tolerance and ageing");
}

bool vs_key_is_figure(const char *way) {
  return is_figure(way, FIGURES[0]) || is_figure(way, FIGURES[1]);
}

vs_status vs_key_figures(const vs_scene *scene, const char *key, const char *way, vs_where where,
                         double end[2], vs_error *err) {
  const vs_deck *deck = &scene->setup.deck;
  const vs_device *d = device_of(deck, key);
  for (size_t k = 0; k < sizeof FIGURES / sizeof *FIGURES; k++) {
    if (!is_figure(way, FIGURES[k]) || take_figure(deck, d, FIGURES[k], end)) continue;
    if (!d)
      return vs_fail_at(err, where,
                        "spread: %s is no device of which a part states its %s; a number is "
                        "wanted, as 10 %%",
                        key, FIGURES[k]);
    return vs_fail_at(
        err, where,
        "spread: %s: %s%s; a number is wanted, as 10 %%, or in the part's file a line "
        "'*$ limit %s = 10 %%'",
        key,
        d->part < 0 ? "it has no part, which could state its " : deck->parts[d->part].subcircuit,
        d->part < 0 ? FIGURES[k]
        : k         ? " states no ageing"
                    : " states no tolerance",
        FIGURES[k]);
  }
  return VS_OK;
}

/* Reads a tolerance in numbers. */
static vs_status read_way(const vs_key *key, const char *way, vs_where where, double nominal,
                          double value[2], vs_error *err) {
  char why[256];
  double si;
  const bool relative = strchr(way, '%');
  const bool kelvin = !strcmp(key->field->unit, "degC") && strchr(way, 'K'); /* a difference */
  const char *unit = relative ? "%" : kelvin ? "K" : key->field->unit;
  if (!vs_units_read(way, unit, &si, why, sizeof why))
    return vs_fail_at(err, where, "spread: %s: %s; a tolerance is '10 %%' or in %s", key->name, why,
                      *key->field->unit ? key->field->unit : "the key's own size");
  const double off = relative ? si * fabs(nominal) : si;
  if (!(off > 0) || isinf(off))
    return vs_fail_at(err, where, "spread: %s: a tolerance above 0 is wanted%s", key->name,
                      relative && si > 0 ? ", and no part of a value of 0" : "");
  value[0] = nominal - off;
  value[1] = nominal + off;
  return VS_OK;
}

/* Gives the ends of a spread, in the key's unit. Error: one of them is out of the key's range. */
static vs_status add_ends(const vs_key *key, const double value[2], vs_where where,
                          vs_spreads *spreads, vs_error *err) {
  const vs_field *f = key->field;
  const double factor = vs_units_factor(f->unit);
  char range[160];
  for (int k = 0; k < 2; k++) {
    const double end = value[k] / factor, rounding = 1e-12 * fabs(end);
    if (f->open ? end > f->min && end < f->max
                : end >= f->min - rounding && end <= f->max + rounding)
      continue;
    vs_field_range(f, range, sizeof range);
    return vs_fail_at(err, where, "spread: %s: its end %.6g%s%s is out of range; allowed: %s",
                      key->name, end, *f->unit ? " " : "", f->unit, range);
  }
  const size_t n = spreads->count++;
  spreads->item[n].number = spreads->spreads;
  snprintf(spreads->item[n].key, sizeof spreads->item[n].key, "%s", key->name);
  snprintf(spreads->item[n].unit, sizeof spreads->item[n].unit, "%s", f->unit);
  for (int k = 0; k < 2; k++) spreads->item[n].value[k] = value[k] / factor;
  return VS_OK;
}

static bool has_key_course(const vs_key *key) {
  return key->field->kind == VS_PROFILE && key->value &&
         ((const vs_field_profile *)key->value)->count;
}

/* A tolerance as the scene has it, and where it and its key stand. */
typedef struct stated {
  const char *way;
  vs_where at_key, where;
} stated;

/* Adds one key of a spread. */
static vs_status add_spread_key(const vs_scene *scene, const char *name, const stated *t,
                                vs_spreads *spreads, vs_error *err) {
  vs_key key;
  double end[2] = {1, 1}, value[2] = {0, 0};
  const char *way = t->way;
  const vs_where where = t->where;
  vs_status status = vs_key_find(scene, name, t->at_key, &key, err);
  if (status) return status;
  for (size_t k = 0; k < spreads->count; k++)
    if (!strcmp(spreads->item[k].key, name))
      return vs_fail_at(err, t->at_key, "spread: %s stands here a second time; leave one out",
                        name);
  const double nominal = vs_field_is_real(key.field) ? vs_key_number(&key) : NAN;
  if (has_key_course(&key))
    return vs_fail_at(err, where,
                      "spread: %s changes over time; a key with one value is wanted there", name);
  if (isnan(nominal))
    return vs_fail_at(err, where, "spread: %s has no number that could be off by a tolerance",
                      name);
  if (is_figure(way, "tolerance") || is_figure(way, "ageing")) {
    status = vs_key_figures(scene, name, way, where, end, err);
    for (int k = 0; k < 2; k++) value[k] = end[k] * nominal;
  } else
    status = read_way(&key, way, where, nominal, value, err);
  return status ? status : add_ends(&key, value, where, spreads, err);
}

double vs_key_spread_at(const vs_spreads *spreads, size_t n, size_t corner) {
  return spreads->item[n].value[corner >> spreads->item[n].number & 1];
}

static const char WITH[] = " with ";

/* Adds a spread: of a key, or of two that go up and down together. */
static vs_status add_spread(const vs_scene *scene, const char *name, const stated *t,
                            vs_spreads *spreads, vs_error *err) {
  char first[VS_KEY_SIZE];
  const char *with = strstr(name, WITH);
  if (spreads->spreads == VS_SPREADS_MOST)
    return vs_fail_at(err, t->at_key,
                      "spread: more than %d keys, which are %d corners; a study with sample: "
                      "{method: corners} takes more",
                      VS_SPREADS_MOST, 1 << VS_SPREADS_MOST);
  snprintf(first, sizeof first, "%.*s", with ? (int)(with - name) : VS_KEY_SIZE - 1, name);
  vs_status status = add_spread_key(scene, first, t, spreads, err);
  if (!status && with) status = add_spread_key(scene, with + strlen(WITH), t, spreads, err);
  if (!status) spreads->spreads++;
  return status;
}

/* Adds the key by the tolerance, unless the scene has no such key. */
static vs_status add_usual_spread(const vs_scene *scene, const char *name, const char *way,
                                  vs_spreads *spreads, vs_error *err) {
  if (!has_key(scene, name)) return VS_OK;
  return add_spread(scene, name, &(stated){.way = way}, spreads, err);
}

/* How far the device is off by its part's file. */
static const char *way_of(const vs_deck *deck, const vs_device *d) {
  double end[2] = {1, 1};
  const bool tolerance = take_figure(deck, d, "tolerance", end),
             ageing = take_figure(deck, d, "ageing", end);
  return tolerance && ageing ? "tolerance and ageing"
         : tolerance         ? "tolerance"
         : ageing            ? "ageing"
                             : "10 %";
}

/* What is not known exactly where the scene does not say: the mains, and varistors. A device that
 * is called varistor has the factor of all for its own. */
static vs_status take_usual_spreads(const vs_scene *scene, vs_spreads *spreads, vs_error *err) {
  static const char ALL[] = "circuit.varistor_scale", LINE[] = "circuit.line_voltage",
                    BOTH[] = "supply.voltage with circuit.line_voltage";
  const vs_deck *deck = &scene->setup.deck;
  char names[VS_DECK_DEVICES][VS_KEY_SIZE];
  const char *ways[VS_DECK_DEVICES];
  size_t count = 0;
  const bool has_line = scene->tier->has_circuit && has_key(scene, LINE);
  vs_status status =
      add_spread(scene, has_line ? BOTH : "supply.voltage", &(stated){.way = "10 %"}, spreads, err);
  if (!scene->tier->has_circuit) return status;
  for (size_t k = 0; k < deck->n_devices; k++) {
    const vs_device *d = &deck->devices[k];
    snprintf(names[count], sizeof names[count], "%s%s%s", OF_CIRCUIT, d->name, OF_SCALE);
    if (!d->scale_at && strcmp(names[count], ALL)) continue;
    ways[count++] = way_of(deck, d);
  }
  if (!count || spreads->spreads + count > VS_SPREADS_MOST)
    return status ? status : add_usual_spread(scene, ALL, "10 %", spreads, err);
  for (size_t k = 0; k < count && !status; k++)
    status = add_usual_spread(scene, names[k], ways[k], spreads, err);
  return status;
}

vs_status vs_key_spreads(const vs_scene *scene, vs_spreads *spreads, vs_error *err) {
  const vs_node *map = vs_tree_child(scene->tree.root, "spread");
  vs_status status = VS_OK;
  spreads->count = spreads->spreads = 0;
  if (scene->setup.machine->lost) return VS_OK; /* a check carries on; nobody knows the keys */
  if (!map) return take_usual_spreads(scene, spreads, err);
  if (map->kind != VS_NODE_MAP || !map->child)
    return vs_error_keep(
        err, vs_fail_at(err, map->where,
                        "spread: a map is wanted: {supply.voltage: 10 %%, circuit.r1: 5 %%}"));
  for (const vs_node *n = map->child; n && !status; n = n->next) {
    const stated t = {n->kind == VS_NODE_TEXT ? n->text : "", n->key_where, n->where};
    status = vs_error_keep(err, add_spread(scene, n->key, &t, spreads, err));
  }
  return status;
}
