/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the scene says of its verdict on the deck's devices. Its key `expect` has what may happen to
 * them, and has to. Each entry is a device and what happens to it, as "fuse_2 opens" or "fuse_2
 * fuse_opens" (netlist/kinds.h has the words). Without an entry it breaks the verdict; with one the
 * verdict breaks where it never comes. Its key `waive` has limits that the verdict leaves out, each
 * by its device and the measure or the limit, as "varistor_1.power" or "varistor_1.p_max". */
#ifndef VS_MEASURE_EXPECT_H
#define VS_MEASURE_EXPECT_H

#include "measure/devices.h"
#include "base/tree.h"

/* One entry. */
typedef struct vs_expected {
  char device[VS_DECK_NAME];        /* by its name, as a copy of the deck has it elsewhere */
  const vs_device_measure *measure; /* that counts it */
} vs_expected;

/* One limit that is left out. */
typedef struct vs_waiver {
  char device[VS_DECK_NAME], name[VS_DECK_NAME]; /* of the device, and of its measure or limit */
} vs_waiver;

enum { VS_EXPECTS_MOST = 64 };
typedef struct vs_expects {
  vs_expected item[VS_EXPECTS_MOST];
  size_t count;
  vs_waiver waiver[VS_EXPECTS_MOST];
  size_t n_waivers;
} vs_expects;

/* Reads both keys of the scene against the deck, whose devices must be resolved. Errors with their
 * place, each of which a check carries on from: no such device, nothing of that name happens to it,
 * no such measure or limit of it, an entry that stands there twice, too many of them. */
vs_status vs_expect_read(const vs_node *scene, const vs_deck *deck, vs_expects *expects,
                         vs_error *err);

/* True where the scene expects what this measure of the device counts. expects: NULL: nothing. */
bool vs_expect_has(const vs_expects *expects, const vs_device *device,
                   const vs_device_measure *measure);

/* Called once the run is over: what a fuse has to pass to open is not judged where it opened and
 * the scene expects it. devices: may be NULL. */
void vs_expect_excuse(const vs_expects *expects, vs_devices *devices);
/* True where the scene leaves the limit of this measure of the device out. expects: NULL: none. */
bool vs_expect_waives(const vs_expects *expects, const vs_device *device,
                      const vs_device_measure *measure);
/* The same of a limit of the device's part that no measure is held to. */
bool vs_expect_waives_limit(const vs_expects *expects, const vs_device *device, const char *limit);

#endif
