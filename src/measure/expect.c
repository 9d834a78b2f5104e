/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/expect.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

const vs_criterion vs_expect_criteria[VS_CRITERIA] = {
    {"A", "nothing happens", " "},
    {"B", "it may fire or misfire", " unintended_firing misfire commutation_failure "},
    {"C", "a fuse may open, too", " fuse_opens "}};

int vs_expect_criterion(const char *name) {
  for (int k = 0; k < VS_CRITERIA; k++)
    if (!strcmp(vs_expect_criteria[k].name, name)) return k;
  return -1;
}

bool vs_expect_spares(int criterion, const char *what) {
  char word[VS_DECK_NAME];
  snprintf(word, sizeof word, " %.60s ", what);
  for (int k = 0; k <= criterion; k++)
    if (strstr(vs_expect_criteria[k].spares, word)) return true;
  return false;
}

bool vs_expect_has(const vs_expects *expects, const vs_device *device,
                   const vs_device_measure *measure) {
  for (size_t k = 0; expects && k < expects->count; k++)
    if (expects->item[k].measure == measure && !strcmp(expects->item[k].device, device->name))
      return true;
  return false;
}

bool vs_expect_allows(const vs_expects *expects, const vs_device *device,
                      const vs_device_measure *measure) {
  return expects && measure->held == VS_NEVER && !vs_expect_has(expects, device, measure) &&
         vs_expect_spares(expects->criterion, vs_kinds_happening(measure)->what);
}

/* True where something happened to the device that the scene expects or allows. */
static bool happens_as_expected(const vs_expects *expects, const vs_watched *w) {
  for (size_t n = 0; n < w->count; n++) {
    const vs_reduced *r = &w->reduced[n];
    const vs_happening *h = vs_reducer_happening(r);
    if (h && h->times &&
        (vs_expect_has(expects, w->device, r->measure) ||
         vs_expect_allows(expects, w->device, r->measure)))
      return true;
  }
  return false;
}

void vs_expect_excuse(const vs_expects *expects, vs_devices *devices) {
  for (size_t k = 0; devices && k < devices->count; k++) {
    vs_watched *w = &devices->item[k];
    if (!happens_as_expected(expects, w)) continue;
    for (size_t n = 0; n < w->count; n++) {
      vs_reduced *r = &w->reduced[n];
      if (!r->by->until_opens || !r->limit) continue;
      r->limit = NULL;
      r->unjudged = "not judged: it opens, as expected";
    }
  }
}

static const vs_device_measure *measure_named(const vs_device *d, const char *name) {
  for (size_t k = 0; d->kind && k < d->kind->n_measures; k++)
    if (!strcmp(d->kind->measures[k].name, name)) return &d->kind->measures[k];
  return NULL;
}

/* A name that is a measure's means that one; else it is a limit's. */
bool vs_expect_waives(const vs_expects *expects, const vs_device *device,
                      const vs_device_measure *measure) {
  const bool own = measure->limit && measure->held != VS_WARD_AT_MOST;
  for (size_t k = 0; expects && k < expects->n_waivers; k++) {
    const vs_waiver *w = &expects->waiver[k];
    if (strcmp(w->device, device->name) != 0) continue;
    if (!*w->name) return measure->held != VS_NEVER;
    const vs_device_measure *named = measure_named(device, w->name);
    if (named ? named == measure : own && !strcmp(measure->limit, w->name)) return true;
  }
  return false;
}

bool vs_expect_waives_limit(const vs_expects *expects, const vs_device *device, const char *limit) {
  for (size_t k = 0; expects && k < expects->n_waivers; k++)
    if (!strcmp(expects->waiver[k].device, device->name) &&
        (!*expects->waiver[k].name || !strcmp(expects->waiver[k].name, limit)))
      return true;
  return false;
}

const char *vs_expect_waiver_name(const vs_waiver *w, char name[2 * VS_DECK_NAME]) {
  snprintf(name, 2 * VS_DECK_NAME, "%s%s%s", w->device, *w->name ? "." : "", w->name);
  return name;
}

/* ---- reading ---- */

/* A key that is a list of such entries. */
typedef struct listed {
  const char *key, *entry, *example; /* "expect", "a device and what happens to it", ... */
  char between;                      /* what stands between the device and the rest */
  vs_status (*read)(const vs_node *node, const vs_device *d, const char *rest, vs_expects *expects,
                    vs_error *err);
} listed;

static vs_status refuse_unknown_device(const listed *of, const vs_node *node, const char *name,
                                       const vs_deck *deck, vs_error *err) {
  const char **names = vs_alloc(deck->n_devices + 1, sizeof *names);
  for (size_t k = 0; k < deck->n_devices; k++) names[k] = deck->devices[k].name;
  const char *nearest = vs_text_nearest(name, names, deck->n_devices);
  free(names);
  return vs_fail_at(err, node->where,
                    "%s: the deck has no device '%s'; %s%s%san entry is %s, as '%s'", of->key, name,
                    nearest ? "did you mean '" : "", nearest ? nearest : "", nearest ? "'? " : "",
                    of->entry, of->example);
}

/* Nothing of that name happens to the device: says what may. */
static vs_status no_happening(const vs_node *node, const char *what, const vs_device *d,
                              vs_error *err) {
  vs_text all = {0};
  for (size_t k = 0; d->kind && k < d->kind->n_measures; k++)
    if (d->kind->measures[k].held == VS_NEVER)
      vs_text_add(&all, "%s'%s %s'", all.length ? ", " : "", d->name,
                  vs_kinds_happening(&d->kind->measures[k])->verb);
  vs_status status =
      vs_fail_at(err, node->where, "expect: '%s %s' is nothing that is told of a %s; %s%s", d->name,
                 what, d->kind ? d->kind->name : "device without a kind",
                 all.length ? "there are: " : "no entry can name it", all.length ? all.text : "");
  vs_text_free(&all);
  return status;
}

static vs_status read_expected(const vs_node *node, const vs_device *d, const char *what,
                               vs_expects *expects, vs_error *err) {
  const vs_device_measure *m = NULL;
  for (size_t k = 0; d->kind && k < d->kind->n_measures; k++) {
    const vs_device_measure *each = &d->kind->measures[k];
    const vs_happening_words *words = each->held == VS_NEVER ? vs_kinds_happening(each) : NULL;
    if (words && (!strcmp(what, words->verb) || !strcmp(what, words->what))) m = each;
  }
  if (!m) return no_happening(node, what, d, err);
  if (vs_expect_has(expects, d, m))
    return vs_fail_at(err, node->where, "expect: '%s %s' stands here a second time; leave one out",
                      d->name, vs_kinds_happening(m)->verb);
  if (expects->count == VS_EXPECTS_MOST)
    return vs_fail_at(err, node->where, "expect: more than %d entries", VS_EXPECTS_MOST);
  vs_expected *entry = &expects->item[expects->count++];
  entry->measure = m;
  memcpy(entry->device, d->name, sizeof entry->device);
  return VS_OK;
}

/* Nothing of the device has that name: says what is near, or what has one. */
static vs_status no_limit(const vs_node *node, const char *name, const vs_device *d,
                          vs_error *err) {
  vs_text all = {0};
  for (size_t k = 0; d->kind && k < d->kind->n_measures; k++)
    if (d->kind->measures[k].limit)
      vs_text_add(&all, "%s%s.%s", all.length ? ", " : "", d->name, d->kind->measures[k].name);
  vs_status status =
      vs_fail_at(err, node->where, "waive: '%s.%s' is no limit of a %s; %s%s", d->name, name,
                 d->kind ? d->kind->name : "device without a kind",
                 all.length ? "there are: " : "no entry can name it", all.length ? all.text : "");
  vs_text_free(&all);
  return status;
}

static vs_status read_waiver(const vs_node *node, const vs_device *d, const char *name,
                             vs_expects *expects, vs_error *err) {
  const vs_device_measure *m = measure_named(d, name);
  const char *nearest;
  if (m && m->held == VS_NEVER)
    return vs_fail_at(err, node->where,
                      "waive: %s.%s counts what must not happen, and is no limit; the key expect "
                      "says what may: expect: [%s %s]",
                      d->name, name, d->name, vs_kinds_happening(m)->verb);
  const bool whole = !*name && d->kind;
  if (!whole && (m ? !m->limit : !d->kind || !vs_kinds_knows_limit(d->kind->name, name, &nearest)))
    return no_limit(node, name, d, err);
  if (vs_expect_waives_limit(expects, d, name))
    return vs_fail_at(err, node->where, "waive: '%s%s%s' stands here a second time; leave one out",
                      d->name, whole ? "" : ".", name);
  if (expects->n_waivers == VS_EXPECTS_MOST)
    return vs_fail_at(err, node->where, "waive: more than %d entries", VS_EXPECTS_MOST);
  vs_waiver *entry = &expects->waiver[expects->n_waivers++];
  memcpy(entry->device, d->name, sizeof entry->device);
  snprintf(entry->name, sizeof entry->name, "%s", name);
  return VS_OK;
}

static const listed LISTS[] = {
    {"expect", "a device and what happens to it", "fuse_2 opens", ' ', read_expected},
    {"waive", "a device and its measure or limit", "varistor_1.power", '.', read_waiver}};

static bool has_fuse(const vs_deck *deck) {
  for (size_t k = 0; k < deck->n_devices; k++)
    if (deck->devices[k].kind && deck->devices[k].kind->melts) return true;
  return false;
}

static vs_status read_criterion(const vs_node *node, int criterion, const vs_deck *deck,
                                vs_expects *expects, vs_error *err) {
  if (criterion >= VS_CRITERION_OPENS && !deck->lost && !has_fuse(deck))
    return vs_fail_at(err, node->where,
                      "expect: criterion %s lets a fuse open, and the deck has no device fuse; B "
                      "is wanted, or a deck with one",
                      node->text);
  expects->criterion = criterion;
  return VS_OK;
}

/* The measures whose limit tells whether a device that latches fires and turns off as it should. */
static bool tells_of_firing(const vs_device_measure *m) {
  return m->limit && (m->how == VS_R_RISE || m->how == VS_R_RETURN_RISE || m->how == VS_R_FALL ||
                      m->how == VS_R_OFFERED);
}

int vs_expect_left_out_by(const vs_reduced *r) {
  return r->by->until_opens            ? VS_CRITERION_OPENS
         : tells_of_firing(r->measure) ? VS_CRITERION_FIRES
                                       : 0;
}

/* Leaves out the limits that the criterion does not ask for. */
static void waive_firing(const vs_deck *deck, vs_expects *expects) {
  for (size_t k = 0; k < deck->n_devices; k++) {
    const vs_device *d = &deck->devices[k];
    for (size_t n = 0; d->kind && n < d->kind->n_measures; n++) {
      const vs_device_measure *m = &d->kind->measures[n];
      if (!tells_of_firing(m) || vs_expect_waives(expects, d, m)) continue;
      if (expects->n_waivers == VS_EXPECTS_MOST) return; /* the lines are judged then */
      vs_waiver *entry = &expects->waiver[expects->n_waivers++];
      memcpy(entry->device, d->name, sizeof entry->device);
      snprintf(entry->name, sizeof entry->name, "%s", m->name);
    }
  }
}

static vs_status read_expectation(const listed *of, const vs_node *node, const vs_deck *deck,
                                  vs_expects *expects, vs_error *err) {
  char name[VS_NAME_SIZE] = "";
  const char *text = node->kind == VS_NODE_TEXT ? node->text : "",
             *rest = strchr(text, of->between);
  const int criterion = of == LISTS ? vs_expect_criterion(text) : -1;
  if (criterion >= 0) return read_criterion(node, criterion, deck, expects, err);
  if (!rest && of->between == '.') rest = text + strlen(text); /* a device alone */
  if (!rest || rest - text >= (long)sizeof name || strlen(rest) >= VS_DECK_NAME)
    return vs_fail_at(err, node->where, "%s: %s are wanted, as '%s'%s", of->key, of->entry,
                      of->example, of == LISTS ? "; or a criterion: A, B or C" : "");
  memcpy(name, text, (size_t)(rest - text));
  rest += of->between == ' ' ? strspn(rest, " ") : *rest == '.';
  for (size_t k = 0; k < deck->n_devices; k++)
    if (!strcmp(deck->devices[k].name, name))
      return of->read(node, &deck->devices[k], rest, expects, err);
  return refuse_unknown_device(of, node, name, deck, err);
}

static vs_status read_expectations(const listed *of, const vs_node *node, const vs_deck *deck,
                                   vs_expects *expects, vs_error *err) {
  vs_status status = VS_OK;
  if (!node || (node->kind == VS_NODE_TEXT && !*node->text)) return VS_OK;
  if (node->kind == VS_NODE_MAP)
    return vs_error_keep(
        err, vs_fail_at(err, node->where, "%s: a list is wanted: [%s, ...]", of->key, of->example));
  if (node->kind == VS_NODE_TEXT)
    return vs_error_keep(err, read_expectation(of, node, deck, expects, err));
  for (const vs_node *item = node->child; item && !status; item = item->next)
    status = vs_error_keep(err, read_expectation(of, item, deck, expects, err));
  return status;
}

vs_status vs_expect_read(const vs_node *scene, const vs_deck *deck, vs_expects *expects,
                         vs_error *err) {
  vs_status status = VS_OK;
  expects->count = expects->n_waivers = 0;
  expects->criterion = 0;
  for (size_t k = 0; k < sizeof LISTS / sizeof *LISTS && !status; k++)
    status = read_expectations(&LISTS[k], vs_tree_child(scene, LISTS[k].key), deck, expects, err);
  if (!status && expects->criterion >= VS_CRITERION_FIRES) waive_firing(deck, expects);
  return status;
}
