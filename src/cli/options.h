/* SPDX-License-Identifier: GPL-3.0-or-later
 * Options that several commands have, as rows of their tables. */
#ifndef VS_CLI_OPTIONS_H
#define VS_CLI_OPTIONS_H

#include "command.h"
#include "engine/tiers.h"

#define VS_OPTIONS_TIER                                                                            \
  VS_COMMAND_VALUE("tier", VS_KEY_TIER, "NAME", VS_TIER_WORDS "; over the scene's run.tier")
#define VS_OPTIONS_REPRODUCIBLE                                                                    \
  VS_COMMAND_FLAG("reproducible", VS_KEY_REPRODUCIBLE,                                             \
                  "leaves the cost (wall time) out of summary.json")
#define VS_OPTIONS_ALL                                                                             \
  VS_COMMAND_FLAG("all", VS_KEY_ALL,                                                               \
                  "the table leaves nothing out: every line of the verdict, every measure")
#define VS_OPTIONS_DIGITS                                                                          \
  VS_COMMAND_VALUE("digits", VS_KEY_DIGITS, "N",                                                   \
                   "significant digits in CSV, 1 to 17 (default 9; 17 is exact)")

#endif
