/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the scene says of its verdict on the deck's devices. Its key `expect` has what may happen to
 * them, and has to. Each entry is a device and what happens to it, as "fuse_2 opens" or "fuse_2
 * fuse_opens" (netlist/kinds.h has the words). Without an entry it breaks the verdict; with one the
 * verdict breaks where it never comes. Its key `waive` has limits that the verdict leaves out, each
 * by its device and the measure or the limit, as "varistor_1.power" or "varistor_1.p_max"; a device
 * alone stands for all of its limits.
 *
 * An entry of `expect` may be a criterion of acceptance: what may happen to all devices and does
 * not have to. Under B and C the limits that tell whether a device fires as it should (of its rates
 * of rise, of its time to turn off) are waived, as nothing is destroyed by passing them. */
#pragma once

#include "base/tree.h"
#include "measure/devices.h"

/* One entry. */
typedef struct vs_expected {
  char device[VS_DECK_NAME];        /* by its name, as a copy of the deck has it elsewhere */
  const vs_device_measure *measure; /* that counts it */
} vs_expected;

/* One limit that is left out. */
typedef struct vs_waiver {
  char device[VS_DECK_NAME], name[VS_DECK_NAME]; /* of the device, and of its measure or limit; the
                                                    latter is empty where all are left out */
} vs_waiver;

/* A criterion of acceptance. */
typedef struct vs_criterion {
  const char *name;   /* "B" */
  const char *text;   /* what it allows, for people */
  const char *spares; /* what may happen besides what the criteria before it allow, each as
                         summary.json calls it, between blanks */
} vs_criterion;
enum { VS_CRITERIA = 3, VS_CRITERION_FIRES = 1, VS_CRITERION_OPENS = 2 };
extern const vs_criterion vs_expect_criteria[VS_CRITERIA];

/* Returns the number of the criterion of that name, from 0; -1: there is none. */
int vs_expect_criterion(const char *name);
/* Returns the number of the first criterion that leaves the limit of this measure out: B where it
 * tells whether a device fires as it should, C where a fuse has to pass it to open and has opened;
 * 0: none does. */
int vs_expect_left_out_by(const vs_reduced *reduced);
/* True where the criterion of that number allows what summary.json calls by that name. */
bool vs_expect_spares(int criterion, const char *what);

enum { VS_EXPECTS_MOST = 64 };
typedef struct vs_expects {
  vs_expected item[VS_EXPECTS_MOST];
  size_t count;
  vs_waiver waiver[VS_EXPECTS_MOST];
  size_t n_waivers;
  int criterion; /* number of the scene's; 0, A, where it names none */
} vs_expects;

/* Reads both keys of the scene against the deck, whose devices must be resolved. Errors with their
 * place, each of which a check carries on from: no such device, nothing of that name happens to it,
 * no such measure or limit of it, an entry that stands there twice, too many of them, a criterion
 * that lets a fuse open in a deck without one. */
vs_status vs_expect_read(const vs_node *scene, const vs_deck *deck, vs_expects *expects,
                         vs_error *err);

/* True where the scene expects what this measure of the device counts. expects: NULL: nothing. */
bool vs_expect_has(const vs_expects *expects, const vs_device *device,
                   const vs_device_measure *measure);

/* True where the scene does not expect it and its criterion allows it. */
bool vs_expect_allows(const vs_expects *expects, const vs_device *device,
                      const vs_device_measure *measure);

/* Writes what the waiver leaves out, "varistor_1.power" or "varistor_1", and returns it. */
const char *vs_expect_waiver_name(const vs_waiver *waiver, char name[2 * VS_DECK_NAME]);

/* Called once the run is over: what a fuse has to pass to open is not judged where it opened and
 * the scene expects or allows it. devices: may be NULL. */
void vs_expect_excuse(const vs_expects *expects, vs_devices *devices);
/* True where the scene leaves the limit of this measure of the device out. expects: NULL: none. */
bool vs_expect_waives(const vs_expects *expects, const vs_device *device,
                      const vs_device_measure *measure);
/* The same of a limit of the device's part that no measure is held to. */
bool vs_expect_waives_limit(const vs_expects *expects, const vs_device *device, const char *limit);
