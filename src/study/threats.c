/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "threats.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/path.h"
#include "base/units.h"
#include "engine/events.h"
#include "engine/tiers.h"
#include "measure/expect.h"

/* ---- kinds that are events under another name ---- */

typedef struct alias {
  const char *name, *kind, *text;
  const char *set[2][2]; /* keys with other defaults than the event's */
} alias;

/* Where the neutral conductor is lost, a load may get up to the voltage between two phases, the
 * root of 3 times its own, until that is switched off: 5 s (IEC 61643-11 tests for as long). */
static const alias ALIASES[] = {{"overvoltage",
                                 "swell",
                                 "a temporary overvoltage, as where the neutral is lost",
                                 {{"level", "173.2 %"}, {"duration", "5 s"}}}};

static const char NONE[] = "none", N_KEY[] = "n", SEED[] = "seed", ANY[] = "any", REST[] = "rest";
enum { CASES = 16 }; /* of a threat with a continuous range, unless n says otherwise */

static const alias *alias_named(const char *name) {
  for (size_t k = 0; k < sizeof ALIASES / sizeof *ALIASES; k++)
    if (!strcmp(ALIASES[k].name, name)) return &ALIASES[k];
  return NULL;
}

static vs_status unknown_kind(const vs_threat *t, const vs_node *node, const char *word,
                              vs_error *err) {
  enum { MOST = 64 };
  const char *names[MOST];
  size_t count = 0;
  vs_text all = {0};
  for (const vs_event_kind *kind; count < MOST && (kind = vs_events_kind(count)); count++)
    names[count] = kind->name;
  for (size_t k = 0; k < sizeof ALIASES / sizeof *ALIASES && count < MOST; k++)
    names[count++] = ALIASES[k].name;
  for (size_t k = 0; k < count; k++) vs_text_add(&all, "%s%s", k ? ", " : "", names[k]);
  vs_status status = vs_fail_at(err, node ? node->where : t->where,
                                "threats.%s.kind: there is no kind '%s'; there are: %s%s", t->name,
                                word, all.text, vs_text_hint(word, names, count, "").text);
  vs_text_free(&all);
  return status;
}

/* ---- reading one threat ---- */

static vs_threat_setting *add_setting(vs_threat *t, const char *key, vs_where where) {
  t->setting = vs_alloc_grow(t->setting, t->n_settings, sizeof *t->setting);
  vs_threat_setting *s = &t->setting[t->n_settings++];
  *s = (vs_threat_setting){.where = where};
  snprintf(s->key, sizeof s->key, "events.%s.%s", t->name, key);
  return s;
}

static void set_text(vs_threat *t, const char *key, const char *text, vs_where where) {
  vs_threat_setting *s = add_setting(t, key, where);
  snprintf(s->text, sizeof s->text, "%s", text);
}

static const vs_field *field_named(const vs_event_kind *kind, const char *key) {
  for (size_t k = 0; k < kind->n_fields; k++)
    if (!strcmp(kind->fields[k].key, key)) return &kind->fields[k];
  return NULL;
}

static bool is_any(const vs_node *node) {
  return node->kind == VS_NODE_TEXT && !strcmp(node->text, ANY);
}

static bool is_range(const vs_field *field, const vs_node *node) {
  const bool word = field->kind & (VS_CHOICE | VS_NAME);
  return node->kind != VS_NODE_TEXT || is_any(node) || (!word && strstr(node->text, ".."));
}

/* Of two words that mean the same (+ and positive) the first is taken. */
static vs_status any_word(vs_axis *axis, const vs_node *node, vs_error *err) {
  static const char POLARITY[] = "+|-|positive|negative";
  char words[256], *rest = words;
  vs_status status = VS_OK;
  snprintf(words, sizeof words, "%s",
           strcmp(axis->field->choices, POLARITY) ? axis->field->choices : "+|-");
  for (char *word; !status && (word = strsep(&rest, "|"));) {
    const vs_node one = vs_tree_word(NULL, word, node->where);
    status = vs_axis_values(axis, &one, err);
  }
  return status;
}

/* The gates of the deck, each by itself. */
static vs_status any_gate(vs_axis *axis, const vs_scene *scene, const vs_node *node,
                          vs_error *err) {
  const vs_deck *deck = &scene->setup.deck;
  vs_status status = VS_OK;
  for (size_t p = 0; p < deck->n_ports && !status; p++) {
    const vs_signal *s = &deck->ports[p].signal;
    char name[VS_NAME_SIZE];
    if (!vs_port_is_gated(s)) continue;
    const double deg = s->shift_rad / vs_units_factor("deg");
    snprintf(name, sizeof name, s->shift_rad == 0 ? "gate" : "gate+%.12gdeg", deg);
    const vs_node one = vs_tree_word(NULL, name, node->where);
    status = vs_axis_values(axis, &one, err);
  }
  if (!status && !axis->n_values)
    status = vs_fail_at(err, node->where, "%s: the deck has no gate port", axis->key);
  return status;
}

/* The parts of the deck, each by itself. */
static vs_status any_part(const vs_threat *t, vs_axis *axis, const vs_scene *scene,
                          const vs_node *node, vs_error *err) {
  char name[VS_DECK_NAME];
  vs_status status = VS_OK;
  for (size_t k = 0; !status && t->kind->part(&scene->setup.deck, k, name); k++) {
    const vs_node one = vs_tree_word(NULL, name, node->where);
    status = vs_axis_values(axis, &one, err);
  }
  if (!status && !axis->n_values)
    status = vs_fail_at(err, node->where, "%s: the deck has no part", axis->key);
  return status;
}

/* All that the key allows, where that has two ends that are meant. */
static vs_status any_number(vs_axis *axis, const vs_node *node, vs_error *err) {
  const vs_field *f = axis->field;
  const double large = 1e3; /* an end beyond it only keeps out what cannot be meant */
  if (f->kind == VS_COUNT || f->open || !(f->min < f->max) || f->max > large)
    return vs_fail_at(
        err, node->where,
        "%s: 'any' needs a key with two ends, and this one has none; 'A .. B' or a list "
        "is wanted",
        axis->key);
  axis->ranged = true;
  axis->from = f->min;
  axis->to = f->max;
  return VS_OK;
}

static vs_status read_any(const vs_threat *t, vs_axis *axis, const vs_scene *scene,
                          const vs_node *node, vs_error *err) {
  if (axis->field->kind == VS_CHOICE) return any_word(axis, node, err);
  if (axis->field->kind == VS_NAME && !strcmp(axis->field->key, "gate"))
    return any_gate(axis, scene, node, err);
  if (t->kind->part && axis->is_word) return any_part(t, axis, scene, node, err);
  if (axis->is_word)
    return vs_fail_at(err, node->where, "%s: a list of names is wanted: [A, B]", axis->key);
  return any_number(axis, node, err);
}

/* Error: the range falls. Of an angle it may be meant to lead on through 0 deg, which it does not.
 */
static vs_status check_rise(const vs_axis *axis, const vs_node *node, vs_error *err) {
  if (!axis->ranged || axis->n_values || axis->from < axis->to) return VS_OK;
  return vs_fail_at(
      err, node->where,
      "%s: the range goes down, from %.6g to %.6g %s; the lesser end first is wanted%s", axis->key,
      axis->from, axis->to, axis->unit,
      strcmp(axis->unit, "deg") ? "" : ", and past 360 deg another threat");
}

static vs_status add_range(vs_threat *t, const vs_scene *scene, const vs_field *field,
                           const vs_node *node, vs_error *err) {
  if (t->n_ranges == VS_THREAT_RANGES)
    return vs_fail_at(err, node->key_where, "threats.%s: more than %d ranges", t->name,
                      VS_THREAT_RANGES);
  vs_axis *axis = &t->range[t->n_ranges++];
  char name[sizeof t->name];
  snprintf(name, sizeof name, "%s", t->name); /* gcc 12 takes t->name for a part of the axis */
  *axis = (vs_axis){.by = "threats", .where = node->key_where, .field = field, .nominal = NAN};
  snprintf(axis->section, sizeof axis->section, "events.%s", name);
  snprintf(axis->key, sizeof axis->key, "events.%s.%s", name, field->key);
  axis->unit = field->unit;
  axis->is_word = field->kind & (VS_CHOICE | VS_NAME);
  vs_status status =
      is_any(node) ? read_any(t, axis, scene, node, err) : vs_axis_values(axis, node, err);
  if (!status) status = check_rise(axis, node, err);
  if (status) t->n_ranges--;
  if (status) vs_axis_free(axis);
  return status;
}

/* `from` of a kind that has no generator says when it begins. */
static bool is_beginning(const vs_threat *t, const char *key) {
  return !strcmp(key, "from") && !field_named(t->kind, key) && field_named(t->kind, "at");
}

/* The threat begins at one instant: `at: any` is any angle of a cycle. */
static vs_status read_key(vs_threat *t, const vs_scene *scene, const vs_node *node, vs_error *err) {
  const char *key = node->key;
  if (!strcmp(key, "at") && is_any(node)) key = "angle";
  const vs_field *field = field_named(t->kind, key);
  if (is_beginning(t, key)) {
    if (node->kind != VS_NODE_TEXT || !strcmp(node->text, "strike"))
      return vs_fail_at(
          err, node->where,
          "threats.%s.from: the kind %s has no generator; start or a time is wanted, as "
          "15 ms",
          t->name, t->kind->name);
    set_text(t, "at", strcmp(node->text, "start") ? node->text : "0 ms", node->where);
    return VS_OK;
  }
  if (is_range(field, node)) return add_range(t, scene, field, node, err);
  add_setting(t, key, node->key_where)->node = node;
  return VS_OK;
}

static const char *const OWN[] = {"kind", "criterion", "with", "live", "start", "until", N_KEY};
enum { N_OWN = sizeof OWN / sizeof *OWN };

static bool is_own(const char *key) {
  for (size_t k = 0; k < N_OWN; k++)
    if (!strcmp(OWN[k], key)) return true;
  return false;
}

/* Error: a key that neither threats nor the kind have. */
static vs_status check_keys(const vs_threat *t, const vs_node *map, vs_error *err) {
  enum { MOST = 64 };
  const char *names[MOST];
  char what[VS_EVENT_NAME + 64];
  size_t n = 0;
  for (; n < N_OWN; n++) names[n] = OWN[n];
  for (size_t k = 0; k < t->kind->n_fields && n < MOST - 1; k++)
    if (strcmp(t->kind->fields[k].key, "kind") != 0 && strcmp(t->kind->fields[k].key, "off") != 0)
      names[n++] = t->kind->fields[k].key;
  if (is_beginning(t, "from")) names[n++] = "from";
  snprintf(what, sizeof what, "threats.%s, of kind %s,", t->name, t->kind->name);
  return vs_field_known_keys(map, what, names, n, err);
}

static vs_status read_kind(vs_threat *t, const vs_node *map, vs_error *err) {
  const vs_node *node = vs_tree_child(map, "kind");
  const char *word = node && node->kind == VS_NODE_TEXT ? node->text : "";
  const alias *a = alias_named(word);
  t->kind = vs_events_find(a ? a->kind : word);
  if (!t->kind) return unknown_kind(t, node, word, err);
  t->text = a ? a->text : t->kind->text;
  set_text(t, "kind", t->kind->name, t->where);
  for (size_t k = 0; a && k < sizeof a->set / sizeof *a->set; k++)
    if (!vs_tree_child(map, a->set[k][0])) set_text(t, a->set[k][0], a->set[k][1], node->where);
  return VS_OK;
}

static vs_status read_criterion(vs_threat *t, const vs_node *map, vs_error *err) {
  const vs_node *node = vs_tree_child(map, "criterion");
  if (!node) return VS_OK;
  t->criterion = node->kind == VS_NODE_TEXT ? vs_expect_criterion(node->text) : -1;
  if (t->criterion < 0) {
    vs_text all = {0};
    for (int k = 0; k < VS_CRITERIA; k++)
      vs_text_add(&all, "%s%s (%s)", k ? ", " : "", vs_expect_criteria[k].name,
                  vs_expect_criteria[k].text);
    vs_status status =
        vs_fail_at(err, node->where, "threats.%s.criterion: '%s' is no criterion; there are: %s",
                   t->name, node->text ? node->text : "", all.text);
    vs_text_free(&all);
    t->criterion = 0;
    return status;
  }
  t->criterion_where = node->where;
  return VS_OK;
}

static vs_status read_live(vs_threat *t, const vs_node *map, const vs_scene *scene, vs_error *err) {
  const vs_node *list = vs_tree_child(map, "live");
  const vs_deck *deck = &scene->setup.deck;
  const char *names[VS_DECK_MOST];
  size_t n = 0;
  if (!list) return VS_OK;
  if (list->kind != VS_NODE_LIST || !list->child)
    return vs_fail_at(err, list->where, "threats.%s.live: a list of devices is wanted: [thyristor]",
                      t->name);
  for (; n < deck->n_devices && n < VS_DECK_MOST; n++) names[n] = deck->devices[n].name;
  for (const vs_node *node = list->child; node; node = node->next) {
    const char *name = node->kind == VS_NODE_TEXT ? node->text : "";
    size_t k = 0;
    while (k < n && strcmp(names[k], name) != 0) k++;
    if (k == n && !deck->lost)
      return vs_fail_at(err, node->where, "threats.%s.live: the deck has no device '%s'%s", t->name,
                        name, vs_text_hint(name, names, n, "").text);
  }
  t->live = list;
  return VS_OK;
}

static vs_status read_beginning(vs_threat *t, const vs_node *map, vs_error *err) {
  const vs_node *start = vs_tree_child(map, "start"), *until = vs_tree_child(map, "until");
  char why[200];
  t->start = start;
  t->until_s = NAN;
  if (start && (start->kind != VS_NODE_TEXT ||
                (strcmp(start->text, REST) != 0 && strcmp(start->text, vs_setup_steady) != 0)))
    return vs_fail_at(err, start->where,
                      "threats.%s.start: rest, or steady (the machine is at work), is wanted",
                      t->name);
  if (until &&
      (until->kind != VS_NODE_TEXT ||
       !vs_units_read(until->text, "s", &t->until_s, why, sizeof why) || !(t->until_s > 0)))
    return vs_fail_at(err, until->where, "threats.%s.until: a time is wanted, as 0.2 s", t->name);
  return VS_OK;
}

static bool is_set(const vs_threat *t, const char *key) {
  char name[VS_KEY_SIZE];
  snprintf(name, sizeof name, "events.%s.%s", t->name, key);
  for (size_t k = 0; k < t->n_settings; k++)
    if (!strcmp(t->setting[k].key, name)) return true;
  for (size_t k = 0; k < t->n_ranges; k++)
    if (!strcmp(t->range[k].key, name)) return true;
  return false;
}

/* A threat without `at` or `cycle` comes in the cycle of the scene's first firing. */
static void place(vs_threat *t, const vs_scene *scene) {
  char cycle[32];
  if (is_set(t, "at") || is_set(t, "cycle")) return;
  t->first_cycle = scene->setup.timeline.firing.first_cycle;
  snprintf(cycle, sizeof cycle, "%d", t->first_cycle);
  set_text(t, "cycle", cycle, t->where);
}

static const vs_threat *threat_named(const vs_threats *all, const char *name) {
  for (size_t k = 0; k < all->count; k++)
    if (!strcmp(all->item[k].name, name)) return &all->item[k];
  return NULL;
}

static bool scene_has(const vs_scene *scene, const char *name) {
  return vs_tree_child(vs_tree_child(scene->tree.root, "events"), name) != NULL;
}

static vs_status check_name(const vs_threats *all, const vs_threat *t, const vs_node *map,
                            vs_error *err) {
  if (!strcmp(map->key, NONE))
    return vs_fail_at(err, map->key_where,
                      "threats.none: that is the scene itself, which is always a case; another "
                      "name is wanted");
  if (strlen(map->key) >= VS_EVENT_NAME || strchr(map->key, '.'))
    return vs_fail_at(err, map->key_where,
                      "threats: '%.80s': a name of up to %d letters without a dot is wanted",
                      map->key, VS_EVENT_NAME - 1);
  if (threat_named(all, t->name))
    return vs_fail_at(err, map->key_where, "threats.%s stands here a second time; leave one out",
                      t->name);
  if (scene_has(all->scene, t->name))
    return vs_fail_at(err, map->key_where,
                      "threats.%s: the scene has an event of that name; another one is wanted",
                      t->name);
  return VS_OK;
}

static vs_status read_threat(vs_threats *all, const vs_node *map, vs_threat *t, vs_error *err) {
  *t = (vs_threat){.where = map->key_where, .n = all->n, .until_s = NAN};
  snprintf(t->name, sizeof t->name, "%s", map->key);
  vs_status status = check_name(all, t, map, err);
  if (!status && map->kind != VS_NODE_MAP)
    status = vs_fail_at(err, map->where,
                        "threats.%s: a map is wanted: {kind: surge, angle: any, level: [1 kV, 2 "
                        "kV]}",
                        t->name);
  if (!status) status = read_kind(t, map, err);
  if (!status) status = check_keys(t, map, err);
  if (!status) status = vs_error_keep(err, read_criterion(t, map, err));
  if (!status) status = vs_error_keep(err, read_live(t, map, all->scene, err));
  if (!status) status = vs_error_keep(err, read_beginning(t, map, err));
  if (!status) status = vs_axis_whole(map, N_KEY, 1, 10000000, &t->n, err);
  for (const vs_node *node = map->child; node && !status; node = node->next)
    if (!is_own(node->key) && (field_named(t->kind, node->key) || is_beginning(t, node->key)))
      status = vs_error_keep(err, read_key(t, all->scene, node, err));
  if (!status) place(t, all->scene);
  return status;
}

static void free_threat(vs_threat *t) {
  for (size_t k = 0; k < t->n_ranges; k++) vs_axis_free(&t->range[k]);
  free(t->setting);
}

/* ---- the list ---- */

static vs_status read_partner(const vs_threats *all, const vs_node *map, vs_threat *t,
                              vs_error *err) {
  const vs_node *node = vs_tree_child(map, "with");
  if (!node) return VS_OK;
  const char *name = node->kind == VS_NODE_TEXT ? node->text : "";
  const char *names[VS_THREATS_MOST];
  size_t n = 0;
  for (size_t k = 0; k < all->count; k++)
    if (&all->item[k] != t && all->item[k].kind) names[n++] = all->item[k].name;
  const vs_threat *with = threat_named(all, name);
  if (!with || with == t || !with->kind)
    return vs_fail_at(err, node->where, "threats.%s.with: '%s' is no other threat%s", t->name, name,
                      vs_text_hint(name, names, n, "").text);
  t->with = with;
  return VS_OK;
}

/* Error: a pair of which one is a pair itself. */
static vs_status check_pair(const vs_node *map, const vs_threat *t, vs_error *err) {
  const vs_node *node = vs_tree_child(map, "with");
  if (!t->with || !t->with->with) return VS_OK;
  return vs_fail_at(err, node->where,
                    "threats.%s.with: %s comes with %s itself, and at most two come together",
                    t->name, t->with->name, t->with->with->name);
}

static vs_status open_file(const vs_node *name, vs_threats *all, const vs_node **map,
                           vs_error *err) {
  static const vs_shelf FILES = {"file", "studies", ""};
  vs_status status = vs_path_find(&FILES, name->text, name->where, all->path, err);
  if (!status) status = vs_tree_read(all->path, &all->file, err);
  if (!status) *map = all->file.root;
  return status;
}

/* Reads all threats of the map; what is wrong with one does not keep the others from being read. */
static vs_status read_all(vs_threats *all, const vs_node *map, vs_error *err) {
  all->n = CASES;
  const size_t found = vs_error_count(err);
  vs_status status = vs_axis_whole(map, N_KEY, 1, 10000000, &all->n, err);
  if (!status) status = vs_axis_whole(map, SEED, 0, UINT64_MAX >> 12, &all->seed, err);
  for (const vs_node *node = map->child; node && !status; node = node->next) {
    if (!strcmp(node->key, N_KEY) || !strcmp(node->key, SEED)) continue;
    if (all->count == VS_THREATS_MOST - 1)
      return vs_fail_at(err, node->key_where, "threats: more than %d", VS_THREATS_MOST - 1);
    vs_threat t;
    const size_t before = vs_error_count(err);
    status = read_threat(all, node, &t, err);
    if (status || vs_error_count(err) > before)
      free_threat(&t);
    else
      all->item[all->count++] = t;
    status = vs_error_keep(err, status);
  }
  for (size_t k = 0; k < all->count && !status && vs_error_count(err) == found; k++)
    status = vs_error_keep(
        err, read_partner(all, vs_tree_child(map, all->item[k].name), &all->item[k], err));
  for (size_t k = 0; k < all->count && !status; k++)
    status =
        vs_error_keep(err, check_pair(vs_tree_child(map, all->item[k].name), &all->item[k], err));
  return status;
}

void vs_threats_free(vs_threats *all) {
  for (size_t k = 0; k < all->count; k++) free_threat(&all->item[k]);
  free(all->item);
  vs_tree_free(&all->file);
  *all = (vs_threats){0};
}

/* ---- laying a case over a scene ---- */

/* Puts a list of what the scene itself says under the key, and of these words. */
static void put_list(const vs_scene *scene, const char *key, const char *const *words, size_t n,
                     vs_where where, vs_tree *tree) {
  enum { MOST = 2 * VS_EXPECTS_MOST };
  vs_node item[MOST], *last = NULL, list = {.kind = VS_NODE_LIST, .where = where};
  vs_error never = {0};
  const vs_node *node = vs_tree_child(scene->tree.root, key);
  size_t count = 0;
  if (!n) {
    vs_tree_put_back(tree, &scene->tree, key);
    return;
  }
  if (node && node->kind == VS_NODE_TEXT && *node->text) item[count++] = *node;
  for (const vs_node *each = node && node->kind == VS_NODE_LIST ? node->child : NULL;
       each && count < VS_EXPECTS_MOST; each = each->next)
    item[count++] = *each;
  for (size_t k = 0; k < n && count < MOST; k++)
    item[count++] = vs_tree_word(NULL, words[k], where);
  for (size_t k = count; k-- > 0; last = &item[k]) {
    item[k].key = NULL;
    item[k].next = last;
  }
  list.child = item;
  list.key_where = where;
  vs_tree_graft(tree, key, &list, &never);
}

static bool is_live(const vs_threat *t, const char *device) {
  for (const vs_node *n = t->live ? t->live->child : NULL; n; n = n->next)
    if (!strcmp(n->text, device)) return true;
  return !t->live;
}

/* The devices that the threat does not ask to live, but for those that the scene leaves out
 * already. Writes words[VS_DECK_MOST] and returns how many they are. */
static size_t waivers_of(const vs_threats *all, const vs_threat *t, const char **words) {
  const vs_deck *deck = &all->scene->setup.deck;
  const vs_expects *own = &all->scene->expects;
  size_t n = 0;
  for (size_t k = 0; k < deck->n_devices && n < VS_DECK_MOST; k++) {
    bool waived = is_live(t, deck->devices[k].name);
    for (size_t w = 0; w < own->n_waivers; w++)
      waived = waived ||
               (!*own->waiver[w].name && !strcmp(own->waiver[w].device, deck->devices[k].name));
    if (!waived) words[n++] = deck->devices[k].name;
  }
  return n;
}

static void put_waivers(const vs_threats *all, const vs_threat *t, vs_tree *tree) {
  const char *words[VS_DECK_MOST];
  const size_t n = waivers_of(all, t, words);
  put_list(all->scene, "waive", words, n, t->live ? t->live->where : t->where, tree);
}

/* Of a pair the later end. NaN: the scene's. */
static double until_of(const vs_threat *t) {
  return t->with ? fmax(t->until_s, t->with->until_s) : t->until_s;
}

static void put_until(const vs_threats *all, const vs_threat *t, vs_tree *tree) {
  const double until_s = until_of(t);
  bool any = false;
  char text[64];
  for (size_t k = 0; k < all->count; k++) any = any || !isnan(all->item[k].until_s);
  if (!any) return;
  snprintf(text, sizeof text, "%.17g s", isnan(until_s) ? all->scene->setup.run.until_s : until_s);
  vs_tree_put(tree, "run.until", text, t->where);
}

static void put_event(const vs_threat *t, const double *value, vs_tree *tree) {
  vs_error never = {0};
  for (size_t k = 0; k < t->n_settings; k++) {
    const vs_threat_setting *s = &t->setting[k];
    if (s->node)
      vs_tree_graft(tree, s->key, s->node, &never);
    else
      vs_tree_put(tree, s->key, s->text, s->where);
  }
  for (size_t k = 0; k < t->n_ranges; k++) vs_axis_put(&t->range[k], value[k], 12, tree);
}

void vs_threats_put(const vs_threats *all, const vs_threat *t, const double *value, vs_tree *tree) {
  const char *criterion = vs_expect_criteria[t->criterion].name;
  vs_tree_put_back(tree, &all->scene->tree, "events");
  if (t->kind) put_event(t, value, tree);
  if (t->with) put_event(t->with, value + t->n_ranges, tree);
  put_list(all->scene, "expect", &criterion, t->criterion > 0, t->criterion_where, tree);
  put_waivers(all, t, tree);
  if (t->start && !strcmp(t->start->text, REST))
    vs_tree_drop(tree, "start");
  else if (t->start)
    vs_tree_put(tree, "start", vs_setup_steady, t->start->where);
  else
    vs_tree_put_back(tree, &all->scene->tree, "start");
  put_until(all, t, tree);
}

/* ---- is it there, and does the run go on behind it ---- */

static const vs_scene_event *event_of(const vs_threat *t, const vs_scene *scene) {
  const vs_events *events = &scene->setup.timeline.events;
  for (size_t k = 0; k < events->count; k++)
    if (!strcmp(events->item[k].name, t->name)) return &events->item[k];
  return NULL;
}

/* When the event begins, whether it is built or not; NaN: the scene has none. */
static double begins_s(const vs_threat *t, const vs_scene *scene) {
  const vs_events *events = &scene->setup.timeline.events;
  const vs_scene_event *e = event_of(t, scene);
  for (size_t k = 0; k < events->n_unbuilt && !e; k++)
    if (!strcmp(events->unbuilt[k].name, t->name)) e = &events->unbuilt[k];
  return e ? e->start_s : NAN;
}

/* The run has to go on for a cycle of the mains behind the event's beginning and behind its end, as
 * what an event does may come when it is over: a triac that fires again, a fuse that melts. One
 * that lasts this long is there for good. */
static const double FOR_GOOD_S = 1e4;

static vs_status check_one(const vs_threat *t, const vs_scene *scene, vs_error *err) {
  const vs_scene_event *e = event_of(t, scene);
  const double until_s = scene->setup.run.until_s, period_s = scene->setup.timeline.period_s;
  const double from_s = e ? e->start_s : begins_s(t, scene);
  const double end_s = e && e->end_s - e->start_s < FOR_GOOD_S ? e->end_s : from_s;
  const double needed_s = end_s + (scene->setup.timeline.supply.direct ? 0 : period_s);
  const int first_cycle = scene->setup.timeline.firing.first_cycle;
  if (t->first_cycle && t->first_cycle != first_cycle)
    return vs_fail_at(
        err, t->where,
        "threats.%s: it comes in cycle %d, that of the scene's first firing, which is "
        "in cycle %d here: cycle, or at, is wanted",
        t->name, t->first_cycle, first_cycle);
  if (e && needed_s <= until_s * (1 + 1e-12)) return VS_OK;
  if (!e && from_s < until_s)
    return vs_fail_at(err, t->where, "threats.%s: it is not built", t->name);
  return vs_fail_at(
      err, t->where,
      "threats.%s: it begins at %.6g s, and the run ends at %.6g s, before what it does "
      "is over: until: %.6g s or more (or run.until) is wanted, or an earlier cycle",
      t->name, from_s, until_s, needed_s);
}

/* Error: nothing would be judged, so that whatever comes would count as held. */
static vs_status check_tier(const vs_threat *t, const vs_scene *scene, vs_error *err) {
  if (scene->tier->has_circuit || scene->ratings.count) return VS_OK;
  return vs_fail_at(err, t->where,
                    "threats.%s: tier %s (%s) judges no part; circuit.deck, run.tier: %s or the "
                    "scene's own ratings are wanted",
                    t->name, scene->tier->name, scene->why, vs_tiers_circuit());
}

vs_status vs_threats_check(const vs_threat *t, const vs_scene *scene, vs_error *err) {
  vs_status status = check_tier(t, scene, err);
  if (!status && t->kind) status = check_one(t, scene, err);
  return status || !t->with ? status : vs_threats_check(t->with, scene, err);
}

/* Error: a fault of the coil or the machine that comes when the only shot is over. Nothing flows
 * then, and nothing would happen whatever the parts are. */
static vs_status check_shot(const vs_threat *t, const vs_scene *scene, vs_error *err) {
  const vs_timeline *line = &scene->setup.timeline;
  const vs_firing_values *f = &line->firing;
  const vs_event_kind *kind = t->kind;
  const bool needs =
      kind && (kind->cuts || kind->jams || kind->load || (kind->element && !kind->wants_element));
  if (!needs || f->every > 0 || f->no_valve || line->supply.direct) return VS_OK;
  const double over_s = line->first_zero_s + f->first_cycle * line->period_s;
  const double from_s = begins_s(t, scene);
  if (!(from_s >= over_s * (1 - 1e-9))) return VS_OK;
  return vs_fail_at(err, t->where,
                    "threats.%s: it begins at %.6g s at the earliest, when the scene's only shot, "
                    "in cycle %d, is over and nothing flows: an earlier cycle is wanted, or "
                    "firing.every: 1",
                    t->name, from_s, f->first_cycle);
}

/* Settles the scene of a case on trial. */
static vs_status try_case(const vs_threats *all, const vs_threat *t, const double *value,
                          bool earliest, vs_error *err) {
  const vs_scene *s = all->scene;
  const size_t found = vs_error_count(err);
  vs_scene *other = vs_alloc(1, sizeof *other);
  memcpy(other->path, s->path, sizeof other->path);
  other->allow_code = s->allow_code;
  other->held = s->held;
  other->of_period = s->of_period;
  vs_tree_copy(&s->tree, &other->tree);
  vs_threats_put(all, t, value, &other->tree);
  vs_status status = vs_scene_read_sections(other, s->tier_named, err);
  if (!status && vs_error_count(err) == found) status = vs_threats_check(t, other, err);
  if (!status && vs_error_count(err) == found && earliest) status = check_shot(t, other, err);
  vs_scene_free(other);
  free(other);
  return status;
}

/* Tries both ends of all ranges, and each name that a list has once, as the deck may not have it.
 */
static vs_status try_threat(const vs_threats *all, const vs_threat *t, vs_error *err) {
  const size_t found = vs_error_count(err);
  size_t tries = 2;
  vs_status status = VS_OK;
  double value[VS_THREAT_NUMBERS];
  for (size_t k = 0; k < vs_threat_numbers(t); k++) {
    const vs_axis *axis = vs_threat_range(t, k);
    if (axis->is_word && axis->n_values > tries) tries = axis->n_values;
  }
  for (size_t n = 0; n < tries && !status && vs_error_count(err) == found; n++) {
    for (size_t k = 0; k < vs_threat_numbers(t); k++) {
      const vs_axis *axis = vs_threat_range(t, k);
      const size_t last = axis->n_values ? axis->n_values - 1 : 0;
      value[k] =
          axis->is_word ? axis->value[n < last ? n : last] : vs_threat_value(axis, n % 2 ? 1 : 0);
    }
    status = vs_error_keep(err, try_case(all, t, value, n == 0, err));
  }
  return status;
}

vs_status vs_threats_read(const vs_node *node, const vs_scene *scene, vs_threats *all,
                          vs_error *err) {
  const vs_node *map = node;
  vs_status status = VS_OK;
  *all = (vs_threats){.scene = scene};
  if (node->kind == VS_NODE_TEXT && *node->text) status = open_file(node, all, &map, err);
  if (status) return status;
  if (map->kind != VS_NODE_MAP || !map->child)
    return vs_fail_at(err, map->where,
                      "threats: a map of names is wanted: {surge: {kind: surge, angle: any}}, or "
                      "the name of a file that is one");
  all->item = vs_alloc(VS_THREATS_MOST, sizeof *all->item);
  status = read_all(all, map, err);
  if (status) return status;
  vs_threat *none = &all->item[all->count++];
  *none = (vs_threat){
      .where = node->key_where, .text = "the scene itself", .n = all->n, .until_s = NAN};
  snprintf(none->name, sizeof none->name, "%s", NONE);
  for (size_t k = 0; k < all->count && !status; k++)
    status = vs_error_keep(err, try_threat(all, &all->item[k], err));
  return status;
}

/* ---- words ---- */

/* The words of a list that the threat puts under the key, besides those of the scene. */
static void write_list(const vs_scene *scene, const char *key, const char *const *words, size_t n,
                       vs_text *text) {
  const vs_node *node = vs_tree_child(scene->tree.root, key);
  const char *comma = "";
  vs_text_add(text, "%s=[", key);
  if (node && node->kind == VS_NODE_TEXT && *node->text)
    vs_text_add(text, "%s", node->text), comma = ", ";
  for (const vs_node *each = node && node->kind == VS_NODE_LIST ? node->child : NULL; each;
       each = each->next, comma = ", ")
    vs_text_add(text, "%s%s", comma, each->text);
  for (size_t k = 0; k < n; k++, comma = ", ") vs_text_add(text, "%s%s", comma, words[k]);
  vs_text_add(text, "]");
}

static bool write_event(const vs_threat *t, size_t *k, vs_text *text) {
  if (!t || *k >= t->n_settings) {
    *k -= t ? t->n_settings : 0;
    return false;
  }
  const vs_threat_setting *s = &t->setting[*k];
  vs_text_add(text, "%s=%s", s->key, s->node ? s->node->text : s->text);
  return true;
}

bool vs_threats_setting(const vs_threats *all, const vs_threat *t, size_t k, vs_text *text) {
  const char *criterion = vs_expect_criteria[t->criterion].name, *words[VS_DECK_MOST];
  if (write_event(t, &k, text) || write_event(t->with, &k, text)) return true;
  const size_t waived = waivers_of(all, t, words);
  if (t->criterion && k-- == 0)
    write_list(all->scene, "expect", &criterion, 1, text);
  else if (waived && k-- == 0)
    write_list(all->scene, "waive", words, waived, text);
  else if (t->start && k-- == 0)
    vs_text_add(text, "start=%s", strcmp(t->start->text, REST) ? vs_setup_steady : "");
  else if (!isnan(until_of(t)) && k-- == 0)
    vs_text_add(text, "run.until=%.17g s", until_of(t));
  return text->length > 0;
}
