/* SPDX-License-Identifier: GPL-3.0-or-later
 * One run of one scene, from its setup to its result: watchers, ladder, second run, verdict. It is
 * the only caller of the sim, so that every door (a run, a study's case, an orbit, a check, a test)
 * is told the same. */
#ifndef VS_STUDY_SESSION_H
#define VS_STUDY_SESSION_H

#include <signal.h>

#include "study/summary.h"

/* Someone who takes part in a run besides its watchers: writes files, shows progress, looks on.
 * Members may be NULL. */
typedef struct vs_guest {
  void *ctx;
  /* Before the first step of each attempt. scene: the one that is run, with the keys of the
   * ladder's rung. */
  vs_status (*begin)(void *ctx, vs_scene *scene, vs_error *err);
  /* Each accepted step, once the watchers have seen it; result: what they have so far. Not VS_OK
   * ends the run. */
  vs_status (*accept)(void *ctx, const vs_step *step, const vs_result *result, vs_error *err);
  /* The attempt has ended because ngspice gave up; another begins on the ladder's rung `next`. */
  void (*again)(void *ctx, const char *failed, int next);
} vs_guest;

typedef struct vs_session {
  const vs_guest *guest; /* NULL: nobody */
  bool verify;           /* run.verify: auto means a second run here, where something is rated */
  bool bare;      /* without watchers and ladder: of the result only wall_s and steps are filled */
  bool unguarded; /* the run goes on beyond the pole cover without a stop: for those who look where
                     it is met */
  const volatile sig_atomic_t
      *stop; /* set by a signal: the run ends with VS_SIGNAL; NULL: not looked at */
} vs_session;

/* Runs the scene and fills the result, which is freed with vs_result_free also after an error.
 * Where ngspice gives up, the scene is run again with the settings of the ladder's next rung;
 * result->scene is the one that was run last. A signal in the second run leaves the first one's
 * result, unverified (result->second.stopped). Errors: those of vs_sim_run and of the guest; VS_RUN,
 * the energy books are further open than a result may be. */
vs_status vs_session_run(const vs_session *session, vs_scene *scene, vs_result *result,
                         vs_error *err);

/* What follows from the verdict: VS_SIGNAL, its second run was stopped; VS_OK, every line is held or
 * unverified within its limit;
 * VS_RATING, a line is violated or undecided. err names the worst line then. */
vs_status vs_session_judge(const vs_result *result, vs_error *err);

/* A run up to its first accepted step: finds what only the solver knows. */
vs_status vs_session_try(const vs_tier *tier, const vs_setup *setup, vs_error *err);

#endif
