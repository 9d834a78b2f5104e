/* SPDX-License-Identifier: GPL-3.0-or-later
 * The result of one run as a table for people and as JSON for programs. */
#ifndef VS_STUDY_SUMMARY_H
#define VS_STUDY_SUMMARY_H

#include <stdio.h>

#include "study/ladder.h"
#include "study/scene.h"
#include "watch/energy.h"
#include "watch/verdict.h"

typedef struct vs_result {
  vs_value values[VS_MEASURES];
  const vs_measures *measures; /* its extremes of the deck's probes */
  const vs_devices *devices;   /* NULL: the deck has none */
  vs_energy energy;
  const char *open_books; /* NULL: the energy audit finds nothing */
  vs_verdict verdict;
  const vs_ladder *ladder; /* and on which rung of it this was got */
  double left_s; /* when the circuit was left, as it was quiet; NaN: it was not */
  double bound;  /* on the error by that, relative to each probe's peak */
  double wall_s;
  long steps;
} vs_result;

void vs_summary_table(const vs_scene *scene, const vs_result *result, FILE *out);
void vs_summary_json(const vs_scene *scene, const vs_result *result, bool with_cost, vs_text *json);

#endif
