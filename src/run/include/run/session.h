/* SPDX-License-Identifier: GPL-3.0-or-later
 * One run of one scene, from its setup to its result: the watchers, the ladder, the second run and
 * the verdict. The session is the only caller of the sim, so that whoever wants a run (the command
 * `run`, a case of a study, an orbit, a test) is told the same. */
#pragma once

#include <signal.h>

#include "run/result.h"

/* Someone who takes part in a run besides its watchers: who writes files, shows progress or looks
 * on. Members may be NULL. */
typedef struct vs_session_listener {
  void *ctx;
  /* Called before the first step of each attempt. scene: the one that is run, with the keys of the
   * ladder's rung. An error ends the run. */
  vs_status (*begin)(void *ctx, vs_scene *scene, vs_error *err);
  /* Called with each accepted step, once the watchers have seen it. result: its watchers hold what
   * they have seen so far, and its meters have come to where the step begins. Anything but VS_OK
   * ends the run. */
  vs_status (*accept)(void *ctx, const vs_step *step, const vs_result *result, vs_error *err);
  /* Called when an attempt has ended because the solver gave up, and another one is to begin on the
   * ladder's rung `next`. failed: how it ended. */
  void (*again)(void *ctx, const char *failed, int next);
  bool
      late; /* `accept` does not ask the watchers, so that these may look at some steps at a time */
} vs_session_listener;

typedef struct vs_session {
  const vs_session_listener *guest; /* NULL: nobody */
  bool verify;       /* what `run.verify: auto` means: a second run where something is rated */
  bool verify_edges; /* what it means besides: a second run where the first one shows that its
                        sequence of firings is on edge */
  bool bare; /* no watchers, no ladder and no control, so that the angle is firing.angle: of the
                result only wall_s and steps are filled */
  const vs_measure_set
      *wants;     /* the values that are read of the result; others may be left unknown,
                 and what the run needs for these alone may be left out; NULL: all */
  bool unguarded; /* the run goes on beyond the pole cover without a stop, for callers who look
                     where the armature meets it */
  const volatile sig_atomic_t
      *stop; /* set by a signal: the run ends with VS_SIGNAL; NULL: no signal ends it */
} vs_session;

/* Runs the scene and fills the result, which vs_result_free frees also after an error. Where
 * the solver gives up, the scene is run again with the settings of the ladder's next rung;
 * result->scene is the one that was run last. Code of the user's own wants scene->allow_code. A
 * signal in the second run leaves the first one's result, unverified (result->second.stopped).
 * Errors: those of vs_sim_run and of the guest; VS_RUN, the energy books are open so far that the
 * numbers mean nothing; VS_INPUT, `start: steady` or `load.fraction: auto`, which vs_steady_run
 * runs (orbit/steady.h). */
vs_status vs_session_run(const vs_session *session, vs_scene *scene, vs_result *result,
                         vs_error *err);

/* ---- vs_session_run in its parts, for who prepares the scene of each attempt ---- */

/* Begins the result. Error: the scene runs code of the user's own, which is not allowed. */
vs_status vs_session_begin(const vs_session *session, const vs_scene *scene, vs_result *result,
                           vs_error *err);
/* Runs the scene once. */
vs_status vs_session_attempt(const vs_session *session, vs_scene *scene, vs_result *result,
                             vs_error *err);
/* Where the solver gave up, returns `scene` with the settings of the ladder's next rung, which the
 * result owns. NULL: `status`, with err, is how the last attempt ended. */
vs_scene *vs_session_climb(const vs_session *session, const vs_scene *scene, vs_status status,
                           vs_result *result, vs_error *err);
/* Makes the second run that `session` wants behind an attempt without an error. Returns `status`,
 * how the last attempt ended. */
vs_status vs_session_finish(const vs_session *session, vs_status status, vs_scene *scene,
                            vs_result *result);

/* Cycles of the mains that a run of the scene takes, of its search for an orbit apart; at least 1.
 */
long vs_session_cycles(const vs_scene *scene);

/* Counts them on the budget of the scene's order, for who searches by runs. Error: VS_BUDGET. */
vs_status vs_session_charge_budget(const vs_scene *scene, vs_error *err);

/* What follows from the verdict. VS_SIGNAL: its second run was stopped. VS_OK: every line is held,
 * or is unverified and within its limit. VS_RATING: a line is violated or undecided; err then names
 * the worst one. */
vs_status vs_session_judge(const vs_result *result, vs_error *err);

/* Runs up to the first accepted step, to find what only the solver knows. Errors: those of the
 * tier's run. */
vs_status vs_session_try(const vs_tier *tier, const vs_setup *setup, vs_error *err);

/* Another run.tolerance, at which a run shows the errors of the first by how far it differs; and
 * what any number of a run at that tolerance may be wrong by besides, relative to it. of_rate: it
 * is a rate over microseconds. */
double vs_session_other_tolerance(double tolerance);
double vs_session_resolution(double tolerance, bool of_rate);
