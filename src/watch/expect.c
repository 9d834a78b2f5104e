/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "watch/expect.h"

#include <stdlib.h>
#include <string.h>

#include "base/text.h"

bool vs_expect_has(const vs_expects *expects, const vs_device *device,
                   const vs_device_measure *measure) {
  for (size_t k = 0; expects && k < expects->count; k++)
    if (expects->item[k].measure == measure && !strcmp(expects->item[k].device, device->name))
      return true;
  return false;
}

/* True where something happened to the device that the scene expects. */
static bool happens_as_expected(const vs_expects *expects, const vs_watched *w) {
  for (size_t n = 0; n < w->count; n++) {
    const vs_reduced *r = &w->reduced[n];
    const vs_happening *h = vs_reducer_happening(r);
    if (h && h->times && vs_expect_has(expects, w->device, r->measure)) return true;
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

static vs_status no_device(const vs_node *node, const char *name, const vs_deck *deck,
                           vs_error *err) {
  const char **names = vs_alloc(deck->n_devices + 1, sizeof *names);
  for (size_t k = 0; k < deck->n_devices; k++) names[k] = deck->devices[k].name;
  const char *nearest = vs_text_nearest(name, names, deck->n_devices);
  free(names);
  return vs_fail_at(err, node->where,
                    "expect: the deck has no device '%s'; %s%s%san entry is a device and what "
                    "happens to it, as 'fuse_2 opens'",
                    name, nearest ? "did you mean '" : "", nearest ? nearest : "",
                    nearest ? "'? " : "");
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

static vs_status read_entry(const vs_node *node, const vs_deck *deck, vs_expects *expects,
                            vs_error *err) {
  char name[VS_NAME_SIZE] = "";
  const char *text = node->kind == VS_NODE_TEXT ? node->text : "", *what = strchr(text, ' ');
  if (!what || what - text >= (long)sizeof name)
    return vs_fail_at(err, node->where,
                      "expect: a device and what happens to it are wanted, as 'fuse_2 opens'");
  memcpy(name, text, (size_t)(what - text));
  what += strspn(what, " ");
  const vs_device *d = NULL;
  const vs_device_measure *m = NULL;
  for (size_t k = 0; k < deck->n_devices; k++)
    if (!strcmp(deck->devices[k].name, name)) d = &deck->devices[k];
  if (!d) return no_device(node, name, deck, err);
  for (size_t k = 0; d->kind && k < d->kind->n_measures; k++) {
    const vs_device_measure *each = &d->kind->measures[k];
    const vs_happening_words *words = each->held == VS_NEVER ? vs_kinds_happening(each) : NULL;
    if (words && (!strcmp(what, words->verb) || !strcmp(what, words->what))) m = each;
  }
  if (!m) return no_happening(node, what, d, err);
  if (vs_expect_has(expects, d, m))
    return vs_fail_at(err, node->where, "expect: '%s %s' stands here a second time; leave one out",
                      name, vs_kinds_happening(m)->verb);
  if (expects->count == VS_EXPECTS_MOST)
    return vs_fail_at(err, node->where, "expect: more than %d entries", VS_EXPECTS_MOST);
  vs_expected *entry = &expects->item[expects->count++];
  entry->measure = m;
  memcpy(entry->device, d->name, sizeof entry->device);
  return VS_OK;
}

vs_status vs_expect_read(const vs_node *node, const vs_deck *deck, vs_expects *expects,
                         vs_error *err) {
  vs_status status = VS_OK;
  expects->count = 0;
  if (!node || (node->kind == VS_NODE_TEXT && !*node->text)) return VS_OK;
  if (node->kind == VS_NODE_MAP)
    return vs_error_carry_on(
        err, vs_fail_at(err, node->where, "expect: a list is wanted: [fuse_2 opens, ...]"));
  if (node->kind == VS_NODE_TEXT)
    return vs_error_carry_on(err, read_entry(node, deck, expects, err));
  for (const vs_node *item = node->child; item && !status; item = item->next)
    status = vs_error_carry_on(err, read_entry(item, deck, expects, err));
  return status;
}
