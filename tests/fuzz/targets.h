/* SPDX-License-Identifier: GPL-3.0-or-later
 * The targets by name. VS_FUZZ_TARGETS(X) has X(NAME) for each; NAME.c defines fuzz_NAME. */
#pragma once

#include "target.h"

#define VS_FUZZ_TARGETS(X)                                                                         \
  X(units)                                                                                         \
  X(formula)                                                                                       \
  X(sets)                                                                                          \
  X(scene)                                                                                         \
  X(study)                                                                                         \
  X(fit)                                                                                           \
  X(machine)                                                                                       \
  X(deck)                                                                                          \
  X(part)                                                                                          \
  X(netlist)                                                                                       \
  X(cards)                                                                                         \
  X(journal)                                                                                       \
  X(study_csv)                                                                                     \
  X(manifest)                                                                                      \
  X(fmu)                                                                                           \
  X(overlay)                                                                                       \
  X(run_csv)                                                                                       \
  X(summary)

#define VS_FUZZ_DECLARED(name) extern const fuzz_target fuzz_##name;
VS_FUZZ_TARGETS(VS_FUZZ_DECLARED)
#undef VS_FUZZ_DECLARED
