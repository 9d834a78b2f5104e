/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnosis/attempt.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>

#include "ngspice/child.h"

/* The observer of a trial's steps. */
typedef struct onlooker {
  const vs_attempt_plan *plan;
  vs_attempt *trial;
  int channels;
  double last[VS_CH_MOST],
      change[VS_CH_MOST]; /* for each channel: its value, and its last change */
  long turns[VS_CH_MOST]; /* how many changes in a row were turns */
  double sign[VS_ATTEMPT_WATCHES];
  long crossed_at[VS_ATTEMPT_WATCHES]; /* the number of the step */
} onlooker;

/* getrusage() tells nothing here: src/clocks.c stops it. */
static double processor_time(void) {
  struct timespec used;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
  return (double)used.tv_sec + 1e-9 * (double)used.tv_nsec;
}

/* ---- what is seen ---- */

static const double LEAST_SWING = 1e-3;

/* A change of the channel counts as a turn if its sign is opposite to the last change, its size is
 * at least a thousandth of the channel's peak, and it is between half and double the last change.
 */
static void see_channel(onlooker *o, int c, double value, double t_s) {
  vs_attempt *trial = o->trial;
  double change = value - o->last[c], before = o->change[c];
  double peak = fmax(fabs(trial->least[c]), fabs(trial->largest[c]));
  bool turns = change * before < 0 && fabs(change) > LEAST_SWING * peak &&
               fabs(change) > 0.5 * fabs(before) && fabs(change) < 2 * fabs(before);
  o->turns[c] = turns ? o->turns[c] + 1 : 0;
  bool faint = trial->ring[c].swing < LEAST_SWING * peak; /* since the peak has grown */
  if (o->turns[c] > (faint ? 0 : trial->ring[c].steps))
    trial->ring[c] = (vs_attempt_ring){o->turns[c], t_s, fabs(change)};
  o->last[c] = value;
  o->change[c] = change;
  trial->least[c] = fmin(trial->least[c], value);
  trial->largest[c] = fmax(trial->largest[c], value);
}

/* A crossing is close to the last one if it comes at most this many steps later. */
enum { CLOSE = 4 };

static void see_watch(onlooker *o, size_t k, const vs_knot *at) {
  vs_attempt_watch *w = &o->trial->watch[k];
  double value = vs_formula_value(&o->plan->watched[k], at->terms), sign = value < 0 ? -1 : 1;
  bool first = o->trial->steps == 1;
  if (!first && sign != o->sign[k]) {
    w->crossings++;
    w->last_s = at->t_s;
    if (w->crossings > 1 && o->trial->steps - o->crossed_at[k] <= CLOSE) {
      if (w->close++ == 0) w->first_close_s = at->t_s;
      w->last_close_s = at->t_s;
    }
    o->crossed_at[k] = o->trial->steps;
  }
  o->sign[k] = sign;
  w->last = value;
  w->largest = fmax(w->largest, fabs(value));
}

static vs_status see(void *ctx, const vs_step *step, const vs_result *result, vs_error *err) {
  (void)result;
  onlooker *o = ctx;
  vs_attempt *trial = o->trial;
  double y[VS_CH_MOST], length_s = step->to->t_s - step->from->t_s;
  if (!(length_s > 0)) return VS_OK;
  vs_step_at(step, step->to->t_s, y);
  trial->steps++;
  trial->reached_s = step->to->t_s;
  trial->shortest_s = fmin(trial->shortest_s, length_s);
  for (int c = 0; c < o->channels; c++) see_channel(o, c, y[c], step->to->t_s);
  for (size_t k = 0; k < o->plan->n_watched; k++) see_watch(o, k, step->to);
  if (trial->steps % 64 || processor_time() < o->plan->limit_s) return VS_OK;
  trial->cut = true;
  return vs_fail(err, VS_SIGNAL, "the limit of processor time");
}

/* ---- in the child ---- */

/* Runs the trial in the child process, which ends soon after. */
static void attempt(const vs_attempt_plan *plan, vs_attempt *trial) {
  vs_scene *scene = plan->scene;
  onlooker *o = vs_alloc(1, sizeof *o);
  vs_result *result = vs_alloc(1, sizeof *result);
  vs_error err = {0};
  *o = (onlooker){.plan = plan, .trial = trial, .channels = vs_channel_count(&scene->frame)};
  const vs_session_listener guest = {.ctx = o, .accept = see};
  const vs_session session = {.guest = &guest, .bare = true};
  scene->setup.run.gear = plan->gear;
  scene->setup.run.until_s = plan->until_s;
  scene->setup.steady = false;
  scene->order.stand_in = NULL; /* so that the solver computes every step */
  scene->order.tries = &trial->tries;
  double began_s = processor_time();
  trial->status = vs_session_run(&session, scene, result, &err);
  if (trial->cut) trial->status = VS_OK;
  if (trial->status) snprintf(trial->why, sizeof trial->why, "%.255s", err.text);
  trial->processor_s = processor_time() - began_s;
}

/* ---- in the parent ---- */

vs_status vs_attempt_run(const vs_attempt_plan *plan, vs_attempt *trial, vs_error *err) {
  vs_child_copy copy;
  *trial = (vs_attempt){.shortest_s = INFINITY};
  for (int k = 0; k < VS_ATTEMPT_WATCHES; k++)
    trial->watch[k] = (vs_attempt_watch){.first_close_s = NAN, .last_close_s = NAN, .last_s = NAN};
  vs_status status = vs_child_fork(&copy, err);
  if (status) return status;
  if (copy.pid == 0) {
    rlim_t most = (rlim_t)(3 * plan->limit_s + 5); /* ends a solver that never returns */
    setrlimit(RLIMIT_CPU, &(struct rlimit){most, most});
    attempt(plan, trial);
    vs_child_tell(&copy, trial, sizeof *trial);
  }
  bool whole = vs_child_listen(&copy, trial, sizeof *trial);
  int how = vs_child_end_of(&copy);
  if (whole && !how) return VS_OK;
  trial->status = VS_RUN;
  snprintf(trial->why, sizeof trial->why, "ngspice does not come back from it, or dies of it");
  return VS_OK;
}
