/* SPDX-License-Identifier: GPL-3.0-or-later
 * The result of one run as JSON for programs: the file summary.json. */
#pragma once

#include "base/json.h"
#include "run/result.h"

/* What a command adds to the summary of its run. Members may be NULL. */
typedef struct vs_summary_more {
  const void *ctx;
  void (*measures)(const void *ctx, vs_json *json); /* adds members to the object "measures" */
  void (*members)(const void *ctx, vs_json *json);  /* adds members to the whole, behind it */
} vs_summary_more;

/* Adds {"value": ..., "unit": ...} under the measure's name, and its instant where it has one. */
void vs_summary_measure(vs_json *json, const char *name, vs_value value, const char *unit);

/* Adds how a limit of harmonics is held: "held", the harmonic "worst", and the "worst_part" that it
 * takes of its limit; all null where part is NaN. */
void vs_summary_limit(vs_json *json, int worst, double part);
/* Of a current whose groups are told (measure/spectrum.h), adds these as an array with that key, A
 * rms, from the direct part on, which has none; and "windows", over which they are. */
void vs_summary_groups(vs_json *json, const char *key, const vs_spectrum *current);

/* Adds the member "scene": every effective parameter with its unit, and the events. */
void vs_summary_scene(vs_json *json, const vs_scene *scene);

/* Appends the result to `json`. with_cost: wall times and steps, too, which no two runs share.
 * more: what is added; NULL: nothing. */
void vs_summary_json(const vs_result *result, bool with_cost, const vs_summary_more *more,
                     vs_text *json);
