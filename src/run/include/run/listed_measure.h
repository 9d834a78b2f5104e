/* SPDX-License-Identifier: GPL-3.0-or-later
 * The measures of a run as they are shown, in tables, JSON and a study's columns: by name, in the
 * unit of their kind, with the limit they are held against. */
#pragma once

#include "run/result.h"

/* What a measure is about. */
typedef enum vs_listed_measure_group {
  VS_SHOWN_MOTION,
  VS_SHOWN_ELECTRICAL, /* currents, voltages, firing and extinction */
  VS_SHOWN_DEVICES,
  VS_SHOWN_ENERGY,
  VS_SHOWN_QUALITY, /* of currents, to the mains */
  VS_SHOWN_GROUPS
} vs_listed_measure_group;

typedef struct vs_listed_measure {
  char name[VS_JUDGED_NAME], text[2 * VS_DECK_TEXT];
  char of[VS_DECK_NAME]; /* the device, the coordinate or the deck's probe; "": none of these */
  const char *unit;      /* borrowed from the deck or from a table of the program */
  vs_value value;        /* in that unit */
  double limit; /* in that unit: of a rating of its probe or of its device's part; NaN: none. Of a
                   margin: the limit it is a part of, in limit_unit; NaN: it has two ends */
  const char *limit_unit; /* of a margin; NULL: it is none */
  bool at_least;          /* the limit is the least allowed, not the most */
  bool own;        /* of a margin: the scene itself rates it, which `waive` does not leave out */
  unsigned unsure; /* of a margin: of its limit, and of figures that the stress is made of */
  int left_out_by; /* of a margin: see vs_expect_left_out_by */
  int sense;     /* of a margin: 1, it is 1 - stress / limit; -1, stress / limit - 1; 0, neither, as
                    of a limit of 0 */
  double over_v; /* of a rate of rise: how far the stretch rises that it is the mean rate of, V; 0:
                    of any other measure */
  vs_listed_measure_group group;
  int channel;  /* of the frame, whose extreme this is; -1: it is none of a deck's probe */
  bool doubled; /* the same number stands under another name, or it is the error of another one */
  const char *absent;   /* why there is no value; NULL: nothing is to be said */
  const char *unjudged; /* why the value is not held against its part's limit; NULL: nothing is to
                           be said */
} vs_listed_measure;

/* Fills `shown` with the k-th measure, from 0, and returns true; false: there are no more. First
 * come the standard measures, the energies among them; then the extremes of the deck's probes; then
 * the measures of its devices; then those of the quality of currents (measure/quality.h). Of the
 * result only its values, its watchers' measures and devices, and its quality are read, which must
 * have begun with this frame. */
bool vs_listed_measure_at(const vs_frame *frame, const vs_result *result, int k,
                          vs_listed_measure *shown);
