/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/keys.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "scene/sections.h"
#include "syntax/units.h"

enum { MOST_KEYS = 1024 };

typedef struct key_list {
  vs_key item[MOST_KEYS];
  size_t count;
} key_list;

static void add_maps(key_list *list, const vs_field *f, const char *member);

static void add_keys(key_list *list, const char *section, const vs_section *fields,
                     const void *values) {
  for (size_t k = 0; k < fields->count && list->count < MOST_KEYS; k++) {
    const vs_field *f = &fields->fields[k];
    const char *member = values ? (const char *)values + f->offset : NULL;
    vs_key *key = &list->item[list->count++];
    snprintf(key->name, sizeof key->name, "%.*s.%s", VS_KEY_SIZE - 2, section, f->key);
    snprintf(key->section, sizeof key->section, "%s", section);
    key->field = f;
    key->value = member;
    if (f->kind == VS_OPTION) add_maps(list, f, member);
  }
}

/* The keys of an option's maps: NAME.KEY where it has none or one, NAME.1.KEY, ... where it has a
 * list of them. */
static void add_maps(key_list *list, const vs_field *f, const char *member) {
  char name[VS_KEY_SIZE], part[VS_KEY_SIZE + 16];
  const vs_options *o = f->options;
  int count = member ? vs_field_maps(f, member) : 0;
  snprintf(name, sizeof name, "%s", list->item[list->count - 1].name);
  if (!count) add_keys(list, name, &o->keys, NULL);
  for (int k = 0; k < count; k++) {
    const char *values = member + (size_t)k * o->size;
    snprintf(part, sizeof part, count > 1 ? "%s.%d" : "%s", name, k + 1);
    add_keys(list, part, vs_field_form(o, values), values);
  }
}

static void add_event(key_list *list, const vs_occurrence *e) {
  char name[VS_KEY_SIZE];
  snprintf(name, sizeof name, "events.%s", e->name);
  const vs_section section = {name, e->kind->fields, e->kind->n_fields};
  add_keys(list, name, &section, &e->v);
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
    add_keys(list, part.section->name, part.section, part.values);
  }
  if (instruments->count)
    add_keys(list, vs_instruments_section.name, &vs_instruments_section, &instruments->v);
  for (int k = 0; k < instruments->count; k++)
    add_keys(list, instruments->item[k].path, &instruments->item[k].section,
             &instruments->item[k].v);
  if (scene->control.regulator)
    add_keys(list, scene->control.section.name, &scene->control.section, &scene->control.v);
  if (scene->control.observing.system)
    add_keys(list, vs_observing_section.name, &vs_observing_section, &scene->control.observing.v);
  const vs_events *events = &setup->timeline.events;
  for (size_t e = 0; e < events->count; e++) add_event(list, &events->item[e]);
  for (size_t e = 0; e < events->n_unbuilt; e++) add_event(list, &events->unbuilt[e]);
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
static vs_status refuse_instrument(const char *name, vs_where where, vs_error *err) {
  return vs_fail_at(err, where,
                    "%s: the scene has no section instruments; give it one, as instruments.set=own "
                    "(in a study set: {instruments.set: own})",
                    name);
}

static vs_status refuse_name(const vs_scene *scene, const key_list *list, const char *name,
                             vs_where where, vs_error *err) {
  const char *names[MOST_KEYS], *section = vs_instruments_section.name;
  size_t length = strlen(section);
  if (!scene->instruments.count && !strncmp(name, section, length) && name[length] == '.')
    return refuse_instrument(name, where, err);
  for (size_t k = 0; k < list->count; k++) {
    names[k] = list->item[k].name;
    if (!strcmp(list->item[k].section, name)) return refuse_section(&list->item[k], where, err);
  }
  const char *nearest = vs_text_nearest(name, names, list->count);
  return vs_fail_at(err, where, "a scene has no key '%s'%s%s%s", name,
                    nearest ? "; did you mean '" : "", nearest ? nearest : "",
                    nearest ? "'?" : "; see 'vibrospice list parameters'");
}

vs_status vs_key_find(const vs_scene *scene, const char *name, vs_where where, vs_key *key,
                      vs_error *err) {
  key_list *list = all_keys(scene);
  size_t k = 0;
  while (k < list->count && strcmp(list->item[k].name, name) != 0) k++;
  vs_status status = VS_OK;
  if (k < list->count)
    *key = list->item[k];
  else
    status = refuse_name(scene, list, name, where, err);
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

static vs_status add_spread(const vs_scene *scene, const char *name, const char *way,
                            vs_where where, vs_spreads *spreads, vs_error *err) {
  vs_key key;
  char why[256];
  double si;
  if (spreads->count == VS_SPREADS_MOST)
    return vs_fail_at(err, where,
                      "spread: more than %d keys, which are 64 corners; a study with sample: "
                      "{method: corners} takes more",
                      VS_SPREADS_MOST);
  vs_status status = vs_key_find(scene, name, where, &key, err);
  if (status) return status;
  const double nominal = vs_field_is_real(key.field) ? vs_key_number(&key) : NAN;
  const bool relative = strchr(way, '%');
  if (isnan(nominal))
    return vs_fail_at(err, where, "spread: %s has no number that could be off by a tolerance",
                      name);
  if (!vs_units_read(way, relative ? "%" : key.field->unit, &si, why, sizeof why))
    return vs_fail_at(err, where, "spread: %s: %s; a tolerance is '10 %%' or in %s", name, why,
                      *key.field->unit ? key.field->unit : "the key's own size");
  const double off = relative ? si * fabs(nominal) : si;
  if (!(off > 0) || isinf(off))
    return vs_fail_at(err, where, "spread: %s: a tolerance above 0 is wanted%s", name,
                      relative && si > 0 ? ", and no part of a value of 0" : "");
  const double factor = vs_units_factor(key.field->unit);
  const size_t k = spreads->count++;
  snprintf(spreads->item[k].key, sizeof spreads->item[k].key, "%s", name);
  snprintf(spreads->item[k].way, sizeof spreads->item[k].way, "%s", way);
  snprintf(spreads->item[k].unit, sizeof spreads->item[k].unit, "%s", key.field->unit);
  spreads->item[k].value[0] = (nominal - off) / factor;
  spreads->item[k].value[1] = (nominal + off) / factor;
  return VS_OK;
}

vs_status vs_key_spreads(const vs_scene *scene, vs_spreads *spreads, vs_error *err) {
  static const char *const USUAL[] = {"supply.voltage", "circuit.varistor_scale"};
  const vs_node *map = vs_tree_child(scene->tree.root, "spread");
  vs_status status = VS_OK;
  spreads->count = 0;
  if (map && (map->kind != VS_NODE_MAP || !map->child))
    return vs_error_carry_on(
        err, vs_fail_at(err, map->where,
                        "spread: a map is wanted: {supply.voltage: 10 %%, circuit.r1: 5 %%}"));
  for (const vs_node *n = map ? map->child : NULL; n && !status; n = n->next) {
    const char *way = n->kind == VS_NODE_TEXT ? n->text : "";
    status = vs_error_carry_on(err, add_spread(scene, n->key, way, n->where, spreads, err));
  }
  for (size_t k = 0; !map && !status && k < sizeof USUAL / sizeof *USUAL; k++) {
    vs_key key;
    vs_error none = {0};
    if (k && !scene->tier->has_circuit) break;
    if (!vs_key_find(scene, USUAL[k], (vs_where){0}, &key, &none))
      status = add_spread(scene, USUAL[k], "10 %", (vs_where){0}, spreads, err);
  }
  return status;
}
