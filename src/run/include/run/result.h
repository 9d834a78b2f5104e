/* SPDX-License-Identifier: GPL-3.0-or-later
 * What one run of a scene came to, and what is to be warned of in it. */
#pragma once

#include "control/loop.h"
#include "measure/verdict.h"
#include "measure/watchers.h"
#include "run/keys.h"
#include "run/ladder.h"

/* The second run of the scene, which tells the errors of the margins. */
typedef struct vs_second_run {
  bool done;
  bool stopped;       /* by a signal */
  double tolerance;   /* its run.tolerance */
  char sequence[512]; /* what it has in another sequence than the first run; empty: nothing */
  double decides;   /* a run.tolerance at which the undecided lines of the verdict are likely to be
                       decided; 0: none is known, or none is needed */
  char unsure[256]; /* extremes that the two runs have very differently; empty: there are none */
  double wall_s;
  char failed[256]; /* why there was none though it was wanted; empty: there was one, or it was not
                       wanted */
} vs_second_run;

/* What the runs at the corners came to: at all ends of the spreads. The number of a
 * corner says which (vs_key_spread_at). */
enum { VS_CORNERS_MOST = 1 << VS_SPREADS_MOST };
typedef struct vs_corner {
  char line[VS_JUDGED_NAME]; /* the corner's worst line; empty: nothing is rated there */
  double margin, error;      /* of that line, as vs_judgement has them */
  vs_finding word;
  bool breaks;      /* the line is violated or undecided */
  char note[128];   /* that the armature did not pull in there; empty: nothing is to be said */
  char failed[256]; /* why the run failed, which then has no line; empty: it did not */
} vs_corner;
typedef struct vs_corners {
  vs_spreads spread;
  size_t count, held, failed; /* held: something is rated there, and nothing breaks */
  size_t worst; /* the number of the corner with the worst line; count: none has one */
  vs_corner item[VS_CORNERS_MOST];
} vs_corners;
/* Writes where a corner is: "supply.voltage = 484 V, circuit.r1 = 31.35 ohm". */
const char *vs_result_corner(const vs_corners *corners, size_t k, char *text, size_t size);

/* Start from {0} and free with vs_result_free. Not to be copied: its verdict points into itself. */
typedef struct vs_result {
  const vs_scene *scene; /* that was run: the caller's, or `climbed` */
  vs_scene *climbed;     /* the scene with the keys of the ladder's rung, owned; NULL: the caller's
                            scene was run as it is */
  vs_value values[VS_MEASURES]; /* of the measures, SI (measure/measures.h) */
  vs_watchers watchers;         /* what they have seen of the run */
  vs_meter *meters;    /* of the scene's instruments, in their order, owned; NULL: it has none */
  vs_loop *loop;       /* the scene's control, owned; NULL: it has none */
  vs_quality *quality; /* of the scene's currents, in their order, owned; NULL: it names none */
  int n_quality;
  char no_pull_in[128]; /* why the armature did not pull in; empty: it did, or nobody asks */
  char lets_go[128];    /* when it let go while the coil was driven; empty: it did not */
  char books[512];      /* what the energy audit finds; empty: nothing */
  vs_verdict verdict;
  const vs_corners *corners;      /* borrowed; NULL: only nominal values were run */
  const struct vs_causes *causes; /* run/causes.h; borrowed; NULL: nobody asked why */
  vs_ladder ladder; /* the rung whose settings gave this result; 0 is the scene as it is */
  vs_second_run second;
  double wall_s;
  long steps;
} vs_result;

/* Fills values and verdict from what the watchers have seen, once the run has reached its end. */
void vs_result_finish(vs_result *result);
void vs_result_free(vs_result *result);
/* Begins the quality of the scene's currents anew. */
void vs_result_begin_quality(vs_result *result, const vs_scene *scene);
/* Ends the control of an attempt that another one follows. */
void vs_result_end_loop(vs_result *result);

/* Why the circuit's solver was not to be left in this run, for its machine's or its control's sake;
 * NULL: it might be, or there is no solver, or the scene has run.leave_circuit: never. */
const char *vs_result_declined(const vs_result *result);

/* Calls each(ctx, text) with every warning, one after the other: those of the scene, then those
 * that are known only once it was run. */
void vs_result_warnings(const vs_result *result, void (*each)(void *ctx, const char *text),
                        void *ctx);

/* True for a run by the trapezoidal rule whose steps are that much shorter than the mains and
 * run.tolerance ask for that the other rule may be worth a trial; writes what is to be said of it.
 */
bool vs_result_steps_are_short(const vs_result *result, char *text, size_t size);

/* Prints a line on standard error for each warning that is known only once the scene was run. That
 * nothing fires is not said of a run shorter than a cycle of the mains: whoever asks for one does
 * not wait for a firing. */
void vs_result_warn(const vs_result *result);
