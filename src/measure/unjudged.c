/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/unjudged.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "netlist/parts.h"

static const char NO_LIMIT[] = "no limit stated", NOT_SEEN[] = "nothing to measure",
                  NOT_HELD[] = "stated, and nothing is held to it";

/* ---- one measure, one limit ---- */

/* True where the part says itself that it has no such limit. */
static bool says_none(const vs_deck *deck, const vs_device *d, const vs_device_measure *m) {
  if (m->held == VS_WARD_AT_MOST && d->protects < 0) return false;
  const vs_device *of = m->held == VS_WARD_AT_MOST ? &deck->devices[d->protects] : d;
  const char *file = of->part < 0 ? NULL : deck->parts[of->part].file;
  const vs_limit *limit = file ? vs_parts_find_limit(deck, file, m->limit) : NULL;
  return limit && isinf(limit->value);
}

/* True where another measure of the device, which the run knows, is held to the same limit. */
static bool has_other(const vs_watched *w, const vs_reduced *r) {
  for (size_t n = 0; n < w->count; n++) {
    const vs_reduced *other = &w->reduced[n];
    if (other != r && other->value.known && other->measure->limit &&
        !strcmp(other->measure->limit, r->measure->limit))
      return true;
  }
  return false;
}

/* True where a rating of the scene judges the measure. */
static bool is_rated(const vs_watched *w, const vs_reduced *r, const vs_verdict *v) {
  const size_t n = strlen(w->device->name);
  for (size_t k = 0; k < v->count; k++) {
    const char *name = v->item[k].name;
    if (name && !strncmp(name, w->device->name, n) && name[n] == '.' &&
        !strcmp(name + n + 1, r->measure->name))
      return true;
  }
  return false;
}

/* True for a line of the verdict that has no limit. */
static bool is_lacking(const vs_watched *w, const vs_reduced *r) {
  return r->value.known && !r->limit && vs_devices_lacks(w->deck, w->device, r->measure);
}

/* Why a measure that a data sheet would limit is not judged; NULL: it is, or need not be. */
static const char *why_not(const vs_watched *w, const vs_reduced *r, const vs_verdict *v) {
  const vs_device_measure *m = r->measure;
  if (r->idle || is_rated(w, r, v) || is_lacking(w, r)) return NULL;
  if (vs_expect_waives(v->expects, w->device, m)) return NULL;
  if (r->unjudged) return r->unjudged + strlen("not judged: ");
  if (!m->limit || (!r->value.known && has_other(w, r))) return NULL;
  if (r->limit) return r->value.known ? NULL : NOT_SEEN;
  return says_none(w->deck, w->device, m) ? NULL : NO_LIMIT;
}

/* The n-th limit of the device's part that nothing is held to, from 0; NULL: there are no more. */
static const vs_limit *limit_left_of(const vs_deck *deck, const vs_device *d,
                                     const vs_expects *expects, size_t n) {
  const char *file = d->part < 0 ? NULL : deck->parts[d->part].file;
  for (size_t k = 0; file && k < deck->n_limits; k++)
    if (!strcmp(deck->limits[k].where.file, file) &&
        vs_parts_limit_is_left(deck, &deck->limits[k]) &&
        !vs_expect_waives_limit(expects, d, deck->limits[k].name) && n-- == 0)
      return &deck->limits[k];
  return NULL;
}

/* ---- of one device ---- */

static void fill_unjudged(vs_unjudged *entry, const vs_device *d, const char *name,
                          const char *why) {
  snprintf(entry->name, sizeof entry->name, "%s.%s", d->name, name);
  entry->why = why;
}

static bool entry_of(const vs_watched *w, const vs_verdict *v, size_t k, vs_unjudged *entry) {
  for (size_t n = 0; n < w->count; n++) {
    const char *why = why_not(w, &w->reduced[n], v);
    if (!why || k-- > 0) continue;
    fill_unjudged(entry, w->device, w->reduced[n].measure->name, why);
    return true;
  }
  const vs_limit *left = limit_left_of(w->deck, w->device, v->expects, k);
  if (left) fill_unjudged(entry, w->device, left->name, NOT_HELD);
  return left;
}

static bool is_device_judged(const vs_watched *w, const vs_verdict *v) {
  for (size_t n = 0; n < w->count; n++)
    if (is_lacking(w, &w->reduced[n]) || is_rated(w, &w->reduced[n], v) ||
        (w->reduced[n].limit && w->reduced[n].value.known))
      return true;
  return false;
}

/* True where all of the device's entries have one reason and none of its measures is judged. */
static bool is_left_whole(const vs_watched *w, const vs_verdict *v) {
  vs_unjudged first, next;
  if (is_device_judged(w, v) || !entry_of(w, v, 0, &first)) return false;
  size_t k = 1;
  while (entry_of(w, v, k, &next))
    if (k++, next.why != first.why) return false;
  return k > 1;
}

/* ---- of all ---- */

bool vs_unjudged_at(const vs_devices *devices, const vs_verdict *v, size_t k, vs_unjudged *entry) {
  for (size_t d = 0; devices && d < devices->count; d++) {
    size_t n = 0;
    while (entry_of(&devices->item[d], v, n, entry))
      if (n++ == k) return true;
    k -= n;
  }
  return false;
}

bool vs_unjudged_is_told(const vs_devices *devices, const vs_verdict *v) {
  vs_unjudged entry;
  bool told = v->count;
  for (size_t d = 0; devices && d < devices->count; d++)
    for (size_t k = 0; !told && entry_of(&devices->item[d], v, k, &entry); k++)
      told = entry.why != NO_LIMIT;
  return told;
}

/* Writes the entries of one reason. A device that is left whole is named once. */
static void write_reason(const vs_devices *devices, const vs_verdict *v, const char *why,
                         vs_text *text) {
  vs_unjudged entry;
  size_t named = 0;
  for (size_t d = 0; d < devices->count; d++) {
    const vs_watched *w = &devices->item[d];
    const bool whole = is_left_whole(w, v);
    for (size_t n = 0; entry_of(w, v, n, &entry) && !(whole && n); n++)
      if (entry.why == why)
        vs_text_add(text, "%s%s",
                    named++        ? ", "
                    : text->length ? "; "
                                   : "",
                    whole ? w->device->name : entry.name);
  }
  vs_text_add(text, " (%s)", why);
}

void vs_unjudged_write(const vs_devices *devices, const vs_verdict *v, vs_text *text) {
  enum { MOST_REASONS = 16 };
  const char *written[MOST_REASONS];
  size_t count = 0, n;
  vs_unjudged entry;
  for (size_t k = 0; vs_unjudged_at(devices, v, k, &entry) && count < MOST_REASONS; k++) {
    for (n = 0; n < count && written[n] != entry.why;) n++;
    if (n < count) continue;
    written[count++] = entry.why;
    write_reason(devices, v, entry.why, text);
  }
}

void vs_unjudged_write_left(const vs_deck *deck, vs_text *text) {
  for (size_t d = 0; d < deck->n_devices; d++) {
    const vs_limit *left;
    for (size_t n = 0; (left = limit_left_of(deck, &deck->devices[d], NULL, n)); n++)
      vs_text_add(text, "%s%s.%s", text->length ? ", " : "", deck->devices[d].name, left->name);
  }
}
