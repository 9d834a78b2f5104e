/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/limits.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include "lint/slips.h"
#include "netlist/cards.h"

/* A limit: its key, default, least and largest value, member, and what it limits. */
#define LIMIT_(key, default_text, least, most, member, text)                                       \
  {                                                                                                \
    key, VS_REAL, "", default_text, least, most, false, offsetof(vs_limits_values, member), text,  \
        NULL, NULL                                                                                 \
  }

static const vs_field LIMITS[] = {
    LIMIT_("csv", "1e9", 1e3, 1e15, csv_bytes,
           "bytes that run.csv may have; a run that would write more is refused before it begins; "
           "peaks.csv is left out where it would have more"),
    LIMIT_("raw", "1e9", 1e3, 1e15, raw_bytes,
           "bytes that run.raw may have; a run whose longest steps alone would write more is "
           "refused before it begins, another one ends there"),
    LIMIT_("kept", "1e10", 1e3, 1e18, kept_bytes,
           "bytes that all run.csv may have which study --keep runs writes; a study that would "
           "write more is refused before it begins; a case's peaks.csv is left out where it would "
           "have more than the case's part of the rest"),
    LIMIT_("devices", "1e5", 1, 1e9, devices,
           "elements that the circuit may have, those of each instance of a subcircuit counted"),
};
const vs_section vs_limits_section = {"limits", LIMITS, sizeof LIMITS / sizeof *LIMITS};

void vs_limits_write(double bytes, char text[VS_LIMITS_SIZE]) {
  static const char *const UNITS[] = {"bytes", "kB", "MB", "GB", "TB", "PB", "EB"};
  size_t unit = 0;
  /* 999.6 to three digits is 1000, which the next unit has */
  for (; bytes >= 999.5 && unit + 1 < sizeof UNITS / sizeof *UNITS; unit++) bytes /= 1000;
  snprintf(text, VS_LIMITS_SIZE, "%.*g %s", unit && bytes < 99.5 ? 2 : 3, bytes, UNITS[unit]);
}

/* ---- devices ---- */

/* What a scope comes to, once that is counted. */
typedef struct scope_size {
  double devices;
  enum { UNCOUNTED, COUNTING, COUNTED } state;
} scope_size;

static double count_scope(const vs_cards *c, scope_size *sizes, size_t scope, int depth);

/* Counts what a card comes to. A chain of more than DEEPEST calls is counted as if it ended there,
 * as ngspice itself does not take it. */
static double count_card(const vs_cards *c, scope_size *sizes, size_t number, int depth) {
  enum { DEEPEST = 200 };
  const vs_netlist_card *card = &c->card[number];
  if (card->kind == VS_CARDS_MODEL) return 1;
  if (card->kind != VS_CARDS_ELEMENT) return 0;
  const size_t called = vs_cards_called(c, card);
  if (!called || depth >= DEEPEST) return 1 + 2 * vs_slips_segments(c->lines[number].text);
  return count_scope(c, sizes, called, depth + 1);
}

static double count_scope(const vs_cards *c, scope_size *sizes, size_t scope, int depth) {
  const vs_netlist_scope *of = &c->scope[scope];
  scope_size *size = &sizes[scope];
  if (size->state == COUNTING) return 1;
  if (size->state == COUNTED) return size->devices;
  size->state = COUNTING;
  for (size_t k = of->first; k < of->last; k = vs_cards_next(c, k))
    size->devices += count_card(c, sizes, k, depth);
  size->state = COUNTED;
  return size->devices;
}

vs_status vs_limits_devices(const vs_deck *deck, double most, vs_error *err) {
  const vs_cards *c = vs_deck_cards(deck);
  scope_size *sizes = vs_alloc(c->n_scopes, sizeof *sizes);
  const double devices = count_scope(c, sizes, 0, 0);
  double of_line = 0;
  size_t line = 0;
  for (size_t k = 0; k < c->count && devices > most; k = vs_cards_next(c, k)) {
    const double its = count_card(c, sizes, k, 0);
    if (its > of_line) of_line = its, line = k;
  }
  free(sizes);
  return devices <= most
             ? VS_OK
             : vs_fail_at(
                   err, deck->lines[line].where,
                   "the circuit comes to %.4g devices with its subcircuits taken apart, %.4g "
                   "of them by this line; limits.devices = %.9g allows no more: take fewer, "
                   "or raise it",
                   devices, of_line, most);
}
