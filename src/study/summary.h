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

/* The second run, which tells the errors of the margins. */
typedef struct vs_second_run {
  bool done, stopped; /* stopped: by a signal */
  double tolerance;   /* its run.tolerance */
  double decides; /* a run.tolerance at which the undecided lines would be decided; 0: none does, or
                     none need be */
  double wall_s;
  char failed[256]; /* why there is none though it was wanted; empty: there is one, or it was not
                       wanted */
} vs_second_run;

/* What a run came to. Start from {0}; vs_result_free it. */
typedef struct vs_result {
  const vs_scene *scene; /* that was run: the caller's, or `climbed` */
  vs_scene *climbed; /* the scene with the keys of the ladder's rung; NULL: the caller's as it is */
  vs_value values[VS_MEASURES];
  vs_measures *measures; /* its extremes of the deck's probes */
  vs_devices *devices;   /* NULL: the deck has none */
  vs_energy energy;
  char books[512]; /* what the energy audit finds; empty: nothing */
  vs_verdict verdict;
  vs_ladder ladder; /* on which rung of it this was got */
  vs_absence absence;
  vs_second_run second;
  double wall_s;
  long steps;
} vs_result;

/* Once the run is over: values and verdict, by what its measures, energy and devices have seen. */
void vs_result_finish(vs_result *r);
void vs_result_free(vs_result *r);

/* All that is to be warned of, before and after the run: calls each(ctx, text) for one after the
 * other. */
void vs_result_warnings(const vs_result *r, void (*each)(void *ctx, const char *text), void *ctx);

/* A line on standard error for each of those that are known only once the run is over. That nothing
 * fires is not said of a run shorter than a cycle of the mains: who asks for one does not wait for
 * a firing. */
void vs_result_warn(const vs_result *r);

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

void vs_summary_table(const vs_result *result, FILE *out);
void vs_summary_json(const vs_result *result, bool with_cost, vs_text *json);

#endif
