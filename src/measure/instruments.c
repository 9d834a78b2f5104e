/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/instruments.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "engine/channel.h"

const vs_shelf vs_instrument_shelf = {"set of instruments", "instruments", ".yaml"};

#define AT(member) offsetof(vs_instrument_values, member)
static const vs_field KEYS[] = {
    {"channel", VS_NAME, "", "NAME", .offset = AT(channel),
     .text = "what it measures: a name of 'vibrospice list probes'"},
    {"range", VS_PAIR, "", "wanted", -1e12, 1e12, .offset = AT(range),
     .text = "what its sensor can show, from and to, in the channel's unit"},
    {"bandwidth", VS_REAL, "Hz", "none", 0, 1e9, true, AT(bandwidth_hz),
     .text = "frequency at which it shows 3 dB less", .choices = "none"},
    {"order", VS_COUNT, "", "1", 1, 2, .offset = AT(order), .text = "of its low-pass"},
    {"damping", VS_REAL, "", "0.7071", 0.01, 1, .offset = AT(damping),
     .text = "zeta of a low-pass of order 2"},
    {"noise", VS_REAL, "", "0", 0, 1e12, .offset = AT(noise),
     .text = "root mean square of the noise in each sample, in the channel's unit"},
    {"rate", VS_REAL, "Hz", "10 kHz", 0, 1e9, true, AT(rate_hz), .text = "samples in a second"},
    {"bits", VS_COUNT, "", "12", 1, 32, .offset = AT(bits),
     .text = "of the A/D, whose steps divide the range", .choices = "none"},
    {"text", VS_NAME, "", "-", .offset = AT(text), .text = "what it is"}};
#undef AT
enum { RANGE = 1, NOISE = 5 };
_Static_assert(sizeof KEYS / sizeof *KEYS == VS_INSTRUMENT_FIELDS, "a field for each key");
const vs_section vs_instrument_section = {"instruments.NAME", KEYS, VS_INSTRUMENT_FIELDS};

#define AT(member) offsetof(vs_instruments_values, member)
static const vs_field COMMON[] = {
    {"set", VS_NAME, "", "own", .offset = AT(set),
     .text = "a file of instruments, or the name of one that comes with the program; own: the "
             "machine's; none"},
    {"seed", VS_COUNT, "", "1", 0, 1e9, .offset = AT(seed), .text = "of all noise"}};
#undef AT
enum { N_COMMON = sizeof COMMON / sizeof *COMMON };
const vs_section vs_instruments_section = {"instruments", COMMON, N_COMMON};

bool vs_instruments_follows(const vs_field *key) {
  return key == &KEYS[RANGE] || key == &KEYS[NOISE];
}

const char vs_instruments_left_out[] = "none";

static bool is_common(const char *key) {
  for (int k = 0; k < N_COMMON; k++)
    if (!strcmp(key, COMMON[k].key)) return true;
  return false;
}

static bool is_instrument_word(const vs_node *node, const char *word) {
  return node && node->kind == VS_NODE_TEXT && !strcmp(node->text, word);
}

/* ---- one instrument ---- */

/* A name and what is said of it, by the scene, by the set, or by both; NULL where one is silent. */
typedef struct entry {
  const vs_node *own, *base;
} entry;

static const vs_node *key_of_entry(const entry *e, const char *key) {
  const vs_node *own = vs_tree_child(e->own, key);
  return own ? own : vs_tree_child(e->base, key);
}

/* Where a key stands; where it has none, the instrument's name. */
static vs_where place_of_entry(const entry *e, const vs_instrument *i, const char *key) {
  const vs_node *node = key_of_entry(e, key);
  return node ? node->where : i->where;
}

/* The frame with all channels that any tier has. */
static vs_frame full_frame(const vs_setup *setup, const vs_frame *frame) {
  vs_frame full = *frame;
  full.deck = &setup->deck;
  return full;
}

static vs_status unknown_channel(const vs_instrument *i, const char *name, vs_where where,
                                 const vs_frame *full, vs_error *err) {
  const char *names[VS_CH_MOST];
  int numbers[VS_CH_MOST], n = vs_channel_listed(full, numbers);
  if (vs_channel_find(full, name) >= 0)
    return vs_fail_at(err, where, "%s: channel %s exists only where a deck is run; take tier %s",
                      i->path, name, vs_setup_tier_words[VS_TIER_CIRCUIT]);
  if (full->deck->lost & VS_LOST_PROBE) return VS_OK; /* a check carries on: it may be that one */
  for (int k = 0; k < n; k++) names[k] = vs_channel_at(full, numbers[k]).name;
  return vs_fail_at(err, where, "%s: no channel '%s'%s", i->path, name,
                    vs_text_hint(name, names, (size_t)n, "; see 'vibrospice list probes'").text);
}

/* Error: the name is none that a column can have. */
static vs_status check_instrument_name(const vs_instrument *i, const char *name,
                                       const vs_frame *full, vs_error *err) {
  bool good = isalpha((unsigned char)*name) && strlen(name) < VS_INSTRUMENT_NAME;
  for (const char *c = name; *c; c++) good = good && (isalnum((unsigned char)*c) || *c == '_');
  if (!good)
    return vs_fail_at(err, i->where,
                      "instruments: '%s' is no name: at most %d letters, digits and _, the first "
                      "of them a letter",
                      name, VS_INSTRUMENT_NAME - 1);
  if (is_common(name))
    return vs_fail_at(err, i->where,
                      "instruments: '%s' is a key of the section, not a name for an instrument; "
                      "give it another name",
                      name);
  int numbers[VS_CH_MOST], n = vs_channel_listed(full, numbers);
  for (int k = 0; k < n; k++) {
    vs_channel c = vs_channel_at(full, numbers[k]);
    size_t length = strlen(i->column);
    if (!strncmp(c.name, i->column, length) && (!c.name[length] || c.name[length] == '_'))
      return vs_fail_at(err, i->where,
                        "%s: its column %s would be taken for that of %s; give it another name",
                        i->path, i->column, c.name);
  }
  return VS_OK;
}

/* Makes its keys, as the channel's unit is now known. */
static void make_instrument_section(vs_instrument *i) {
  memcpy(i->fields, KEYS, sizeof KEYS);
  i->fields[0].default_text = i->name;
  i->fields[RANGE].default_text = "0, 0";
  i->fields[RANGE].unit = i->fields[NOISE].unit = i->unit;
  i->section = (vs_section){i->path, i->fields, VS_INSTRUMENT_FIELDS};
}

/* Error: a low-pass that is not there, or one of order 1, is said to have what it has not. What the
 * scene changes makes no error of what its set says. */
static vs_status check_lowpass(const vs_instrument *i, const entry *e, vs_error *err) {
  const bool own_order = vs_tree_child(e->own, "order") != NULL;
  if (i->v.order == 1 &&
      (vs_tree_child(e->own, "damping") || (!own_order && key_of_entry(e, "damping"))))
    return vs_fail_at(err, place_of_entry(e, i, "damping"),
                      "%s.damping: a low-pass of order 1 has none; write order: 2, or leave it out",
                      i->path);
  const char *key = key_of_entry(e, "order") ? "order" : "damping";
  if (key_of_entry(e, key) && !key_of_entry(e, "bandwidth"))
    return vs_fail_at(err, place_of_entry(e, i, key),
                      "%s.%s: without a bandwidth there is no low-pass; write one, as bandwidth: "
                      "100 Hz, or leave this out",
                      i->path, key);
  return VS_OK;
}

/* Error: the keys, each good by itself, do not go together. */
static vs_status check_values(const vs_instrument *i, const entry *e, double until_s,
                              vs_error *err) {
  enum { MOST_SAMPLES = 1000000000 };
  const vs_instrument_values *v = &i->v;
  double unit = vs_units_factor(i->unit);
  if (!key_of_entry(e, "range"))
    return vs_fail_at(err, i->where,
                      "%s: 'range' is wanted: what its sensor can show, as range: [-1 %s, 1 %s]",
                      i->path, i->unit, i->unit);
  if (!(v->range[0] < v->range[1]))
    return vs_fail_at(err, place_of_entry(e, i, "range"),
                      "%s.range: from %g to %g %s is empty; the first must be the lower end",
                      i->path, v->range[0] / unit, v->range[1] / unit, i->unit);
  if (v->rate_hz * until_s > MOST_SAMPLES)
    return vs_fail_at(err, place_of_entry(e, i, "rate"),
                      "%s.rate: %g Hz makes %.3g samples up to run.until = %g s; allowed there: at "
                      "most %g Hz",
                      i->path, v->rate_hz, v->rate_hz * until_s, until_s, MOST_SAMPLES / until_s);
  return check_lowpass(i, e, err);
}

/* Puts the values of the map's keys over those that are there. */
static vs_status read_over(vs_instrument *i, const vs_node *map, vs_error *err) {
  vs_status s = vs_field_section_keys(&i->section, map, err);
  for (int k = 0; k < VS_INSTRUMENT_FIELDS && !s; k++) {
    const vs_node *node = vs_tree_child(map, KEYS[k].key);
    if (node) s = vs_error_keep(err, vs_field_read(&i->section, &i->fields[k], node, &i->v, err));
  }
  return s;
}

static bool is_silent(const vs_node *node) {
  return !node || (node->kind == VS_NODE_TEXT && !*node->text);
}

/* Reads the channel, on which the units of other keys depend. */
static vs_status read_channel(vs_instrument *i, const entry *e, const vs_setup *setup,
                              const vs_frame *frame, vs_error *err) {
  const vs_frame full = full_frame(setup, frame);
  const vs_node *node = key_of_entry(e, "channel");
  const char *name = node && node->kind == VS_NODE_TEXT ? node->text : i->name;
  i->channel = vs_channel_find(frame, name);
  if (i->channel < 0) return unknown_channel(i, name, node ? node->where : i->where, &full, err);
  i->unit = vs_channel_at(frame, i->channel).unit;
  return VS_OK;
}

static vs_status read_instrument(vs_instruments *all, const entry *e, const vs_setup *setup,
                                 const vs_frame *frame, vs_error *err) {
  const vs_node *node = e->own ? e->own : e->base;
  const vs_frame full = full_frame(setup, frame);
  size_t found = vs_error_count(err);
  if (all->count >= VS_INSTRUMENT_MOST)
    return vs_fail_at(err, node->key_where, "instruments: more than %d", VS_INSTRUMENT_MOST);
  vs_instrument *i = &all->item[all->count];
  *i = (vs_instrument){.where = node->key_where};
  snprintf(i->name, sizeof i->name, "%s", node->key);
  snprintf(i->column, sizeof i->column, "%.31s_meas", node->key);
  snprintf(i->path, sizeof i->path, "instruments.%.31s", node->key);
  if (node->kind != VS_NODE_MAP && !is_silent(node))
    return vs_fail_at(err, node->where, "%s: a map of keys is wanted: {range: [-1, 1], ...}%s",
                      i->path, e->own && e->base ? ", or none" : "");
  vs_status s = check_instrument_name(i, node->key, &full, err);
  if (!s) s = read_channel(i, e, setup, frame, err);
  if (s || i->channel < 0) return s;
  make_instrument_section(i);
  s = vs_field_section_read(&i->section, e->base, &i->v, err);
  if (!s) s = read_over(i, e->own, err);
  if (!s && vs_error_count(err) == found) s = check_values(i, e, setup->run.until_s, err);
  if (!s && vs_error_count(err) == found) all->count++;
  return s;
}

/* ---- sets ---- */

/* Reads the file of that name; *map is what it has under `instruments`. */
static vs_status read_set(const char *name, vs_where where, vs_instruments *all,
                          const vs_node **map, vs_error *err) {
  static const char *const TOP[] = {"title", "instruments"};
  char path[VS_PATH_SIZE];
  vs_status s = vs_path_find(&vs_instrument_shelf, name, where, path, err);
  if (!s) s = vs_tree_read(path, &all->tree, err);
  if (!s) s = vs_field_known_keys(all->tree.root, "a set of instruments", TOP, 2, err);
  if (s) return s;
  *map = vs_tree_child(all->tree.root, "instruments");
  if (*map && (*map)->kind == VS_NODE_MAP) return VS_OK;
  *map = NULL;
  return vs_fail_at(err, (vs_where){all->tree.name, 1, 1},
                    "a map instruments: {NAME: {range: [-1, 1], ...}, ...} is wanted");
}

/* Finds the map of the set that the section names. *map stays NULL where there is none. */
static vs_status find_set(const vs_node *section, const vs_setup *setup, vs_instruments *all,
                          const vs_node **map, vs_error *err) {
  const vs_node *named = vs_tree_child(section, "set");
  const char *set = all->v.set;
  vs_where where = named ? named->where : section->where;
  if (!strcmp(set, "none")) return VS_OK;
  if (strcmp(set, COMMON[0].default_text)) return read_set(set, where, all, map, err);
  const vs_node *own = vs_tree_child(setup->machine->tree.root, "instruments");
  if (is_silent(own)) return VS_OK;
  if (own->kind == VS_NODE_TEXT) return read_set(own->text, own->where, all, map, err);
  if (own->kind != VS_NODE_MAP)
    return vs_fail_at(err, own->where,
                      "instruments: the name of a set is wanted, or a map: {NAME: {...}, ...}");
  *map = own;
  return VS_OK;
}

/* ---- all ---- */

/* Reads the instruments of the set, then those that only the scene has. */
static vs_status read_all_instruments(const vs_node *section, const vs_node *set,
                                      const vs_setup *setup, const vs_frame *frame,
                                      vs_instruments *all, vs_error *err) {
  vs_status s = VS_OK;
  for (const vs_node *n = set ? set->child : NULL; n && !s; n = n->next) {
    const entry e = {vs_tree_child(section, n->key), n};
    if (!is_instrument_word(e.own, vs_instruments_left_out))
      s = vs_error_keep(err, read_instrument(all, &e, setup, frame, err));
  }
  for (const vs_node *n = section->child; n && !s; n = n->next) {
    const entry e = {n, NULL};
    if (!is_common(n->key) && !vs_tree_child(set, n->key))
      s = vs_error_keep(err, read_instrument(all, &e, setup, frame, err));
  }
  return s;
}

static vs_status read_common(const vs_node *section, vs_instruments_values *v, vs_error *err) {
  vs_status s = VS_OK;
  for (int k = 0; k < N_COMMON && !s; k++)
    s = vs_field_read_key(&vs_instruments_section, &COMMON[k],
                          vs_tree_child(section, COMMON[k].key), v, err);
  return s;
}

vs_status vs_instruments_read(const vs_node *section, const vs_setup *setup, const vs_frame *frame,
                              vs_instruments *all, vs_error *err) {
  const vs_node *set = NULL;
  all->count = 0;
  vs_tree_free(&all->tree);
  all->tree = (vs_tree){0};
  if (!section || setup->machine->lost) return VS_OK;
  if (section->kind != VS_NODE_MAP && !is_silent(section))
    return vs_error_keep(
        err, vs_fail_at(err, section->where,
                        "instruments: a map is wanted: {set: own, seed: 1, NAME: {...}}"));
  size_t found = vs_error_count(err);
  vs_status s = read_common(section, &all->v, err);
  if (!s) s = vs_error_keep(err, find_set(section, setup, all, &set, err));
  if (s || vs_error_count(err) > found) return s;
  s = read_all_instruments(section, set, setup, frame, all, err);
  if (s || all->count || vs_error_count(err) > found) return s;
  return vs_error_keep(
      err, vs_fail_at(err, section->where,
                      "instruments: there are none: %s has no set of its own; name one, as set: "
                      "NAME, or write {NAME: {range: [-1, 1]}}",
                      setup->machine->path));
}

void vs_instruments_free(vs_instruments *all) {
  vs_tree_free(&all->tree);
  all->tree = (vs_tree){0};
  all->count = 0;
}

const char *vs_instruments_names(const vs_node *section, const vs_node **at) {
  const bool is_map = section && section->kind == VS_NODE_MAP; /* else reading it refuses it */
  for (const vs_node *i = *at ? (*at)->next : is_map ? section->child : NULL; i; i = i->next) {
    if (is_common(i->key) || is_instrument_word(i, vs_instruments_left_out)) continue;
    const vs_node *channel = vs_tree_child(i, "channel");
    *at = i;
    return channel && channel->kind == VS_NODE_TEXT ? channel->text : i->key;
  }
  return NULL;
}

double vs_instruments_working_hz(const vs_setup *setup) {
  const vs_timeline *t = &setup->timeline;
  return t->supply.frequency_hz / (t->firing.every ? t->firing.every : 1);
}

const vs_instrument *vs_instruments_alias(const vs_instruments *all, char *text, size_t size) {
  const vs_instrument *first = NULL;
  size_t n = 0;
  for (int k = 0; k < all->count; k++) {
    const vs_instrument *i = &all->item[k];
    const vs_instrument_values *v = &i->v;
    if (!(v->bandwidth_hz > v->rate_hz / 2) || n >= size) continue;
    n += (size_t)snprintf(text + n, size - n, "%s%s (%g Hz, %g Hz)", first ? ", " : "", i->name,
                          v->bandwidth_hz, v->rate_hz / 2);
    if (!first) first = i;
  }
  return first;
}
