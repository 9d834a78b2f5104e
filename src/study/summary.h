/* SPDX-License-Identifier: GPL-3.0-or-later
 * The result of one run as a table for people and as JSON for programs. */
#ifndef VS_STUDY_SUMMARY_H
#define VS_STUDY_SUMMARY_H

#include <stdio.h>

#include "study/ladder.h"
#include "study/scene.h"
#include "watch/energy.h"
#include "watch/verdict.h"

/* Stretches of a run that went without ngspice, as the circuit was quiet. */
typedef struct vs_absence {
  int times;
  double first_s, total_s; /* when it was first left; how long in all */
  double since_s;          /* the present one */
  bool now;
  double bound; /* on the error by it, relative to each probe's peak */
} vs_absence;
void vs_absence_accept(vs_absence *absence, const vs_step *step);
void vs_absence_finish(vs_absence *absence, double until_s);

typedef struct vs_result {
  vs_value values[VS_MEASURES];
  const vs_measures *measures; /* its extremes of the deck's probes */
  const vs_devices *devices;   /* NULL: the deck has none */
  vs_energy energy;
  const char *open_books; /* NULL: the energy audit finds nothing */
  vs_verdict verdict;
  const vs_ladder *ladder; /* and on which rung of it this was got */
  vs_absence absence;
  double wall_s;
  long steps;
} vs_result;

/* Once the run is over: values and verdict, by what its measures, energy and devices (the same as
 * r->devices; may be NULL) have seen. */
void vs_result_finish(vs_result *r, vs_devices *devices);

/* A measure as it is shown. */
typedef struct vs_shown {
  char name[VS_JUDGED_NAME], text[VS_DECK_TEXT + 16];
  const char *unit;
  vs_value value; /* in that unit */
  double limit;   /* that a rating of its probe or a limit of its device's part sets; NaN: none */
  bool at_least;  /* that is the least allowed, not the most */
  const char *unjudged; /* why it is not held against its part's limit; NULL: nothing is to say */
} vs_shown;

/* Each measure there is, k from 0: the energies', the probes' extremes and the devices' included;
 * false: there are no more. Of the result its values, measures and devices are asked for. */
bool vs_shown_at(const vs_frame *frame, const vs_result *result, int k, vs_shown *shown);

/* What is to be told of a run that went well but may not be what was meant: nothing fires in it.
 * Gives how many of them it wrote, at most `most`. */
enum { VS_RESULT_WARNINGS = 2 };
size_t vs_result_warnings(const vs_scene *scene, const vs_result *result, vs_error out[],
                          size_t most);

/* A line for each of them on standard error, of a run of a cycle of the mains or longer. */
void vs_result_warn(const vs_scene *scene, const vs_result *result);

void vs_summary_table(const vs_scene *scene, const vs_result *result, FILE *out);
void vs_summary_json(const vs_scene *scene, const vs_result *result, bool with_cost, vs_text *json);

#endif
