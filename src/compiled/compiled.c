/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "compiled/compiled.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "elements.h"
#include "monodromy.h"
#include "reduction.h"
#include "replay.h"
#include "rodas.h"

/* By what the error of an unknown is measured. */
typedef struct measured {
  bool counts, shown;
  double of_tolerance; /* so much of the tolerance */
  double of_peak;      /* of its size, and of so much of what it has been at most */
  double small;        /* and of this, in its unit */
  double peak;
} measured;

/* A run under way. */
typedef struct compiled {
  const vs_circuit_job *job;
  const vs_circuit_host *host;
  vs_equations e;
  vs_rodas r;
  measured *of;                /* of each unknown; owned */
  int *counting, n_counting;   /* the unknowns whose errors count; owned */
  int *signal;                 /* the unknown of each of the job's signals; owned */
  double *shown;               /* their values, as accept() is given them; owned */
  double *charge;              /* M y where a restart begins; owned */
  double *between;             /* a state within a step; owned */
  double before_s, off_before; /* the last step's length and error; 0: there is none */
  bool still;                  /* time stands at 0, for the operating point */
  bool looked;                 /* the junctions' currents behind the step are known */
  bool failed;                 /* a longer step from here was tried, and off */
  double course_s;             /* the longest step by the sources' own courses */
  double left_s;               /* to the next edge, from the last step's end */
  int landings;                /* steps that ended at a branch at once, one behind the other */
  double from_s;               /* where the stretch began whose tries are counted */
  long tries;
  vs_monodromy map; /* for the host's; without states where it has none */
  double *states;   /* of the host's map: owned */
  double *began;    /* the state before which the stretch under way began, with the next: */
  bool *on;         /* its switches; owned */
} compiled;

/* ---- sources ---- */

static void drive_sources(void *ctx, double t_s, double *value) {
  const compiled *c = ctx;
  if (c->still) t_s = 0;
  for (int k = 0; k < c->e.sources; k++) {
    const vs_compiled_source *s = &c->e.source[k];
    const bool same = k && s->port >= 0 && s[-1].port == s->port;
    if (s->course >= 0)
      value[k] = vs_course_at(&c->e.course[s->course], t_s);
    else
      value[k] = same ? value[k - 1] : c->host->source(c->host->ctx, (size_t)s->port, t_s);
  }
}

/* ---- shown ---- */

/* Shows what holds at a part of the step of h that was tried: 1 is its end. */
static vs_status show_instant(compiled *c, double h, double part, vs_error *err) {
  double *y = part < 1 ? c->between : c->r.next;
  for (int n = 0; n < c->n_counting && part < 1; n++)
    if (c->of[c->counting[n]].shown)
      y[c->counting[n]] = vs_rodas_dense_of(&c->r, c->counting[n], part);
  for (size_t k = 0; k < c->job->n_signals; k++) {
    const int u = c->signal[k];
    c->shown[k] = u >= 0 ? y[u] : u == -1 ? 0 : NAN;
  }
  const double t_s = c->r.t_s + part * h;
  if (part < 1 && c->host->passes && c->host->passes(c->host->ctx, t_s, c->shown)) return VS_OK;
  return c->host->accept(c->host->ctx, t_s, c->shown, err);
}

/* The host takes signals for straight lines between what it is shown, but the flux linkage for a
 * cubic. A step is shown in so many parts that these are off by no more than STRAIGHT of the
 * tolerance of each signal's peak, where the dense output bends most: at one of its ends. What the
 * method itself is off by comes on top of that. Of what counts as small SLIGHT is added to a peak,
 * 0.1 mV: a run that begins with a capacitor at 0 V, 1e-8 V behind its first step, was shown in 144
 * parts more. A node that stands for a flux linkage may have as little as 1 mV. */
static const double STRAIGHT = 0.7, SLIGHT = 1e-3;
enum { MOST_PARTS = 100 };
/* Where derivatives are taken of what is shown there are so many times as many parts: an extreme
 * lies beside the instant at which it is shown, and what a key makes of it there is off by that. */
enum { FINER = 4 };

static int parts_of(const compiled *c) {
  double most = 1;
  const double allowed = STRAIGHT * c->job->tolerance;
  for (int n = 0; n < c->n_counting; n++) {
    const int u = c->counting[n];
    const measured *of = &c->of[u];
    if (!of->shown || u == c->e.flux) continue;
    const double bend = c->r.bend[0][u], more = c->r.bend[1][u];
    const double begin = fabs(bend - more), end = fabs(bend + 2 * more);
    const double behind = fabs(c->r.next[u]), peak = behind > of->peak ? behind : of->peak;
    const double off = (begin > end ? begin : end) / 4,
                 may_be = allowed * (peak + SLIGHT * of->small);
    if (off > may_be * most) most = off / may_be;
  }
  return (int)fmin(ceil(sqrt(most)), MOST_PARTS);
}

static vs_status show_step(compiled *c, double h, vs_error *err) {
  const bool on = vs_replay_is_on(c->job->steps);
  const bool hides = !on && c->host->hides && c->host->hides(c->host->ctx); /* nobody looks */
  const int parts = vs_replay_parts(c->job->steps, hides ? 1 : (on ? FINER : 1) * parts_of(c));
  vs_status status = VS_OK;
  for (int k = 1; k <= parts && !status; k++)
    status = show_instant(c, h, k == parts ? 1 : (double)k / parts, err);
  return status;
}

/* ---- the error of a step ---- */

/* The method estimates the error of its rule of third order; that of the result is much less, so
 * that these may be large. An error that adds up from step to step is held to OF_TOLERANCE of the
 * tolerance, with which voltages of a snubber that rings are off by 1.1 tolerances at most (with
 * 0.2 by 1.45); that of an unknown without a memory to WITHOUT_MEMORY of it, if it
 * is shown. One that is not shown does not count: its effect on the others does. What is shown
 * is measured by its peak so far, the rest by its size and OF_PEAK of its peak; SMALL_V and its
 * like are added to either, for what is shown SHOWN of them. */
static const double OF_TOLERANCE = 0.14, WITHOUT_MEMORY = 3, OF_PEAK = 0.1, SMALL_V = 1,
                    SMALL_WB = 1e-3, SMALL_M = 1e-5, SHOWN = 0.1;

/* Behind a step the currents of a junction may be out of balance by OF_JUNCTION of the tolerance,
 * as a part of its peak current. With five times that, thyristors of transistors that let go were
 * off by up to 1.8 tolerances; with a tenth of it halfwave_paper takes half as many steps again. */
static const double OF_JUNCTION = 1;

static measured measure_of(const compiled *c, int unknown) {
  const vs_equations *e = &c->e;
  const bool current = e->name[unknown][0] == 'i';
  const bool moves = unknown >= e->machine && unknown < e->machine + e->states;
  const double current_a = c->job->current_tolerance_a / c->job->relative_tolerance;
  measured of = {.of_tolerance = WITHOUT_MEMORY,
                 .of_peak = OF_PEAK,
                 .small = moves                ? SMALL_M
                          : current            ? current_a
                          : unknown == e->flux ? SMALL_WB
                                               : SMALL_V};
  for (int k = 0; k < e->masses; k++)
    if (e->mass[k].column == unknown) {
      of.counts = true;
      of.of_tolerance = OF_TOLERANCE;
    }
  for (size_t k = 0; k < c->job->n_signals; k++)
    if (c->signal[k] == unknown && !of.shown) {
      of.counts = of.shown = true;
      of.of_peak = 1;
      of.small *= SHOWN;
    }
  return of;
}

/* A coil that rings forgets nothing for long: its errors add up, and are held to OF_TOLERANCE over
 * RINGS_S. Where steps are shorter than FAST_S, what rings is a line's inductance with a varistor's
 * capacitance, at 1 MHz, and what that leaves in the flux linkage averages out: without FAST_S
 * triac_feeder took 5 times the steps. */
static const double RINGS_S = 9e-4, FAST_S = 1e-5;

static double error_of(const compiled *c, double h) {
  double most = 0;
  const double rings = fmin(1, fmax(h, FAST_S) / RINGS_S);
  double sum = 0;
  for (int k = 0; k < c->e.n; k++) sum += c->r.error[k];
  if (!isfinite(sum)) return INFINITY;
  for (int n = 0; n < c->n_counting; n++) {
    const int k = c->counting[n];
    const measured *of = &c->of[k];
    const double before = fabs(c->r.y[k]), behind = fabs(c->r.next[k]);
    const double size = behind > before ? behind : before;
    const double allowed = of->of_tolerance * (size + of->of_peak * of->peak + of->small);
    const double off = fabs(c->r.error[k]) / (k == c->e.flux ? rings * allowed : allowed);
    if (!(off <= most)) most = off;
  }
  return most / c->job->tolerance;
}

/* The step of h is taken. */
static void accept_step(compiled *c, double h) {
  vs_rodas_take(&c->r, h);
  vs_equations_note_peaks(&c->e, c->looked ? NULL : c->r.y);
  c->looked = false;
  for (int n = 0; n < c->n_counting; n++) {
    const int k = c->counting[n];
    if (fabs(c->r.y[k]) > c->of[k].peak) c->of[k].peak = fabs(c->r.y[k]);
  }
}

/* ---- the state as a whole ---- */

/* A junction's charge, in C, of which SMALL_C count. */
static const double SMALL_C = 1e-12;

/* A charge is the only unknown that its row has as it is. */
static bool is_charge(const vs_equations *e, int unknown) {
  for (int l = 0; l < e->linears; l++)
    for (int k = 0; k < 2 * e->devices && e->linear[l].column == unknown; k++)
      if (e->device[k / 2].charge[k % 2] == e->linear[l].row) return true;
  return false;
}

/* About how large a charge or flux of M y is over a run. */
static double size_of_row(const compiled *c, int row) {
  double size = 0;
  for (int n = 0; n < c->e.masses; n++) {
    const vs_entry *m = &c->e.mass[n];
    const measured *of = &c->of[m->column];
    const double small = is_charge(&c->e, m->column) ? SMALL_C : of->small;
    if (m->row == row) size += fabs(m->value) * (of->peak + small);
  }
  return size;
}

/* Sets what the host's map says of where the step ends that is being shown. */
static void tell_state(void *circuit) {
  compiled *c = circuit;
  vs_circuit_map *map = c->host->map;
  vs_equations_mass(&c->e, c->r.next, c->charge);
  vs_monodromy_state(&c->map, c->charge, map->end);
  for (int k = 0; k < c->map.states; k++) map->size[k] = size_of_row(c, c->map.row[k]);
  map->knows_slope = c->map.follows && c->map.known;
  if (map->knows_slope) vs_monodromy_slope(&c->map, map->slope);
}

static void name_state(void *circuit, int state, char name[VS_STATE_NAME], const char **unit) {
  const compiled *c = circuit;
  const int row = c->map.row[state];
  const char *of = c->e.name[row];
  const bool charge = *of == 'v' && row != c->e.flux;
  *unit = charge ? "C" : "Wb";
  snprintf(name, VS_STATE_NAME, "%s%.*s", charge ? "charge" : "flux", VS_STATE_NAME - 8, of + 1);
}

static void begin_map(compiled *c) {
  vs_circuit_map *map = c->host->map;
  vs_monodromy_begin(&c->map, &c->e);
  const size_t n = (size_t)c->map.states;
  c->states = vs_alloc(4 * n + n * n + (size_t)c->e.n, sizeof *c->states);
  c->began = c->states + 4 * n + n * n;
  c->on = vs_alloc((size_t)c->e.devices + 1, sizeof *c->on);
  *map = (vs_circuit_map){.states = (int)n,
                          .start = c->states,
                          .end = c->states + n,
                          .size = c->states + 2 * n,
                          .next = c->states + 3 * n,
                          .slope = c->states + 4 * n,
                          .tell = tell_state,
                          .name = name_state,
                          .solver = c};
}

/* Switches may keep what a stretch has made of them. With `back` they, and the state from which a
 * restart looks for its own, are those with which the last stretch began; else they are kept. */
static void turn_back(compiled *c, bool back) {
  const size_t size = (size_t)c->e.n * sizeof *c->began;
  memcpy(back ? c->r.y : c->began, back ? c->began : c->r.y, size);
  for (int k = 0; k < c->e.devices; k++) {
    bool *now = &c->e.device[k].on, *then = &c->on[k];
    *(back ? now : then) = *(back ? then : now);
  }
  if (back) vs_equations_choose(&c->e, c->r.y, false);
}

/* A restart is to come from c->charge: where the host's stretch begins, from what it says. */
static void go_on_in_map(compiled *c) {
  vs_circuit_map *map = c->host->map;
  if (!c->map.states) return;
  vs_monodromy_stop(&c->map);
  if (!map->begins) return;
  map->begins = false;
  turn_back(c, map->returns);
  map->returns = false;
  vs_monodromy_charge(&c->map, map->next, c->charge);
  memcpy(c->states, map->next, (size_t)map->states * sizeof *c->states);
  vs_monodromy_start(&c->map, map->wants_slope);
}

/* ---- branches ---- */

/* How well the instant of a change is known, as a part of its step; and where derivatives are taken
 * by what differs between runs. */
static const double SHARP = 1e-9, SHARPEST = 1e-14;

/* The part of the step at which a branch or a switch first wants to be another; 2: none does. */
static double changes_at(compiled *c) {
  double low = 0, high = 0.5;
  vs_rodas_dense(&c->r, high, c->between);
  if (!vs_equations_choose(&c->e, c->between, true)) {
    low = high;
    high = 1;
    if (!vs_equations_choose(&c->e, c->r.next, true)) return 2;
  }
  const double sharp = vs_replay_is_on(c->job->steps) ? SHARPEST : SHARP;
  while (high - low > sharp) {
    const double middle = (low + high) / 2;
    vs_rodas_dense(&c->r, middle, c->between);
    *(vs_equations_still_asks(&c->e, c->between) ? &high : &low) = middle;
  }
  return high;
}

/* Takes the branches and switches that the last state asks for. Returns whether the equations jump
 * by that: by more than JUMPS, A or V. Most branches of expressions are two formulas for one curve.
 */
static const double JUMPS = 1e-7;

static bool choose_branches(compiled *c) {
  double *before = c->r.k[0], *behind = c->r.k[1], most = 0;
  if (!vs_equations_choose(&c->e, c->r.y, true)) return false;
  drive_sources(c, c->r.t_s, c->r.source[0]);
  vs_equations_value(&c->e, c->r.y, c->r.source[0], false, before, NULL);
  vs_monodromy_look(&c->map, &c->r, before);
  vs_equations_choose(&c->e, c->r.y, false);
  vs_equations_value(&c->e, c->r.y, c->r.source[0], false, behind, NULL);
  for (int k = 0; k < c->e.rows; k++) most = fmax(most, fabs(behind[k] - before[k]));
  if (most > JUMPS) vs_monodromy_jump(&c->map, &c->r);
  return most > JUMPS;
}

/* ---- a run ---- */

static vs_status give_up(const compiled *c, const char *what, vs_error *err) {
  const double t_s = c->host->clock ? c->host->clock(c->host->ctx, c->r.t_s) : c->r.t_s;
  vs_fail(err, VS_RUN, "t = %.9g s: tier compiled: %s", t_s, what);
  err->gave_up = true;
  return VS_RUN;
}

/* Behind a jump a step of the backward Euler rule has RESTART_S, or another length if it does not
 * converge, and the first one of RODASP's FIRST_S at most. What is shorter than LEAST_S makes no
 * progress. */
static const double RESTART_S = 1e-11, FIRST_S = 2e-8, LEAST_S = 1e-13;
enum { CHANGES = 100 };

/* The steps of another run do not serve: a device switches in another of them. */
static vs_status lose_steps(const compiled *c, vs_error *err) {
  return vs_fail(err, VS_RUN,
                 "t = %.9g s: a device switches in another step than in the scene's own run",
                 c->host->clock ? c->host->clock(c->host->ctx, c->r.t_s) : c->r.t_s);
}

static vs_status no_solution(const compiled *c, vs_error *err) {
  if (vs_replay_follows(c->job->steps)) return lose_steps(c, err);
  char why[160] = "the circuit's equations have no solution behind a jump";
  if (c->r.culprit >= 0)
    snprintf(why, sizeof why,
             "nothing decides %.80s: a node without a path to ground, or a loop of sources",
             c->e.name[c->r.culprit]);
  return give_up(c, why, err);
}

/* The branches are held while the iteration runs, as switches may turn over and over. Where it
 * finds no solution so, as far behind the branch that ends a formula with a power of 299, they are
 * chosen anew in each iteration. */
static double restart_again(compiled *c) {
  double h = 0;
  const vs_circuit_step *step = vs_replay_next(c->job->steps, NAN, &h);
  return step && vs_rodas_restart(&c->r, c->charge, h, step->cut) ? h : 0;
}

static double restart_length(compiled *c, double first_s) {
  static const double TIMES[] = {1, 10, 100, 0.1, 1000};
  if (vs_replay_follows(c->job->steps)) return restart_again(c);
  for (int chooses = 0; chooses < 2; chooses++)
    for (size_t n = 0; n < sizeof TIMES / sizeof *TIMES; n++) {
      const vs_circuit_step step = {.length_s = TIMES[n] * first_s, .left_s = NAN, .cut = chooses};
      if (!vs_rodas_restart(&c->r, c->charge, step.length_s, chooses)) continue;
      vs_replay_note(c->job->steps, &step);
      return step.length_s;
    }
  return 0;
}

/* Goes on behind a jump, from the charges: branches and switches are those that the state behind it
 * asks for. The machine is where the host has it, as what happened may have stopped it. */
static vs_status restart_behind_jump(compiled *c, double first_s, vs_error *err) {
  if (c->e.states) c->host->machine.state(c->host->ctx, c->charge + c->e.machine);
  for (int k = 0; k < CHANGES; k++) {
    const double h = restart_length(c, first_s);
    if (!(h > 0)) return no_solution(c, err);
    const bool chosen = vs_equations_choose(&c->e, c->r.next, false);
    if (vs_replay_restarts(c->job->steps, chosen)) continue;
    vs_monodromy_restart(&c->map, &c->r, h);
    vs_status status = show_instant(c, h, 1, err);
    accept_step(c, h);
    return status;
  }
  return give_up(c, "a switch or a branch of an expression opens and closes without end", err);
}

static vs_status restart_here(compiled *c, double first_s, vs_error *err) {
  c->before_s = 0;
  vs_equations_mass(&c->e, c->r.y, c->charge);
  go_on_in_map(c);
  return restart_behind_jump(c, first_s, err);
}

/* Where no step is short enough: what hangs on a current that a jump has left beside a capacitance
 * does not get better with shorter steps. Each further restart is ten times as long, so that this
 * dies out. */
enum { MOST_STUCK = 4 };

static vs_status get_past(compiled *c, int *stuck, vs_error *err) {
  if (*stuck == MOST_STUCK) return give_up(c, "no step is short enough", err);
  return restart_here(c, pow(10, (*stuck)++) * RESTART_S, err);
}

/* So many tries within PROGRESS_S are no progress, as of ngspice's (ngspice/ngspice.c). */
enum { PROGRESS_TRIES = 100000 };
static const double PROGRESS_S = 1e-5;

static bool progress_made(compiled *c) {
  if (c->job->tries) ++*c->job->tries;
  if (c->r.t_s - c->from_s >= PROGRESS_S) {
    c->from_s = c->r.t_s;
    c->tries = 0;
  }
  return ++c->tries < PROGRESS_TRIES;
}

/* Where a shorter step is worse, and so is one of a sixth of that, what is left of the error is
 * rounding: of two nodes at 600 V, say, with microfarads between them and picofarads to all others.
 * Such a step is taken if it is off by no more than this, and the next one is longer. (Of steps
 * beyond a ring's period a shorter one alone may be worse.) */
static const double ROUNDING = 10;

/* Where the state slides along a kink, as where an arc holds a current at its zero, each step would
 * end at a branch at once. After so many of these one is taken whole. */
enum { MOST_LANDINGS = 10 };

/* The next step's length as a part of h, whose error was off: that which would be off by FULL, and
 * longer or shorter again as the last one should have been (Gustafsson's rule: Hairer and Wanner,
 * section IV.8), by up to TREND. Errors above 1 tell nothing of a trend. */
static const double FULL = 0.65, TREND = 2, LEAST_OFF = 1e-3, SHORTER = 1.0 / 6, LONGER = 5;

static double next_factor(const compiled *c, double h, double off) {
  if (!isfinite(off)) return SHORTER;
  double factor = pow(FULL / off, 0.25);
  if (c->before_s > 0 && off <= 1) {
    const double trend = h / c->before_s * pow(c->off_before / fmax(off, LEAST_OFF), 0.25);
    factor *= fmin(fmax(trend, 1 / TREND), TREND);
  }
  return fmin(fmax(factor, SHORTER), LONGER);
}

/* A step of h was off by `off`, and that of before_s, longer, by `before`: would one of no length
 * be off by more than 1, too? So it is where the step before has left a junction a current out of
 * balance that no step corrects but Newton's iteration. */
static bool stays_off(double h, double off, double before_s, double before) {
  return off < before && isfinite(before) && off - h * (before - off) / (before_s - h) > 1;
}

/* Takes the step that the other run took here. */
static vs_status step_again(compiled *c, double *taken, bool *jumps, vs_error *err) {
  double h = 0;
  const vs_circuit_step *step = vs_replay_next(c->job->steps, c->left_s, &h);
  *taken = 0;
  if (!step) return lose_steps(c, err);
  if (!(h > 0)) return VS_OK;
  if (!vs_rodas_try(&c->r, h)) return lose_steps(c, err);
  const double part = changes_at(c);
  *jumps = part <= 1;
  *taken = step->cut ? fmax(part * h, RESTART_S) : h;
  if (*jumps != step->jumps || (step->cut && !vs_rodas_try(&c->r, *taken)))
    return lose_steps(c, err);
  return VS_OK;
}

/* Tries steps of at most *h until one is right, and makes *h what the next one may be. *taken: the
 * length; 0: none is short enough. *jumps: a switch or branch is another behind it. */
static vs_status try_steps(compiled *c, double *h, double *taken, bool *jumps, vs_error *err) {
  double best = INFINITY, best_s = 0, before = INFINITY, before_s = INFINITY;
  int worse = 0; /* so many steps, each shorter, were off by more than the best one */
  if (vs_replay_follows(c->job->steps)) return step_again(c, taken, jumps, err);
  *taken = 0;
  while (*h > LEAST_S) {
    if (!progress_made(c)) return give_up(c, "the run makes no progress", err);
    double off = vs_rodas_try(&c->r, *h) ? error_of(c, *h) : INFINITY;
    const bool fits = off <= 1; /* but for junctions */
    c->looked = off <= ROUNDING;
    if (c->looked)
      off = fmax(off, vs_equations_imbalance(&c->e, c->r.y, c->r.next, c->r.error) /
                          (OF_JUNCTION * c->job->tolerance));
    const bool rounds = *h == best_s; /* it is tried again */
    const double factor = next_factor(c, *h, off);
    if (!(off <= 1) && !rounds) {
      if (fits && stays_off(*h, off, before_s, before)) break;
      before = fits ? off : INFINITY;
      before_s = *h;
      if (off < best) {
        best = off;
        best_s = *h;
        worse = 0;
      } else {
        worse += best <= ROUNDING;
      }
      *h = worse == 2 ? best_s : *h * (worse ? SHORTER : fmin(factor, 0.9));
      c->failed = true;
      continue;
    }
    const double part = changes_at(c);
    vs_circuit_step note = {.length_s = *h, .left_s = c->left_s, .parts = 1, .jumps = part <= 1};
    *jumps = part <= 1;
    *taken = *h;
    if (part < 1 && *h > RESTART_S && c->landings < MOST_LANDINGS) {
      *taken = fmax(part * *h, RESTART_S); /* a step that ended a little before it has it at once */
      note.cut = true;
      c->landings = *taken < 10 * RESTART_S ? c->landings + 1 : 0;
      c->looked = false;
      if (!vs_rodas_try(&c->r, *taken)) { /* a restart may be longer */
        *taken = 0;
        break;
      }
      if (!isfinite(error_of(c, *taken))) { /* a junction's exponential within the step */
        *h = *taken / 6;
        *taken = best_s = 0;
        best = INFINITY;
        worse = 0;
        continue;
      }
    } else {
      c->landings = 0;
      c->before_s = rounds ? 0 : *h;
      c->off_before = off;
      *h *= rounds ? LONGER : c->failed ? fmin(factor, 1) : factor;
      c->failed = false;
    }
    vs_replay_note(c->job->steps, &note);
    return VS_OK;
  }
  vs_replay_note(c->job->steps, &(vs_circuit_step){.left_s = c->left_s});
  return VS_OK;
}

/* An unknown that is driven has no error at a step's end, however long it is; between its ends the
 * dense output is a cubic. With SWINGS radians of a source's own sine at a tolerance of 1 that is
 * off by no more than the tolerance; without, at 1e-3 a capacitive divider of 1 kHz by 15 %. */
static const double SWINGS = 3;

static double longest_by_courses(const compiled *c) {
  double most_s = INFINITY;
  for (int k = 0; k < c->e.courses; k++) most_s = fmin(most_s, vs_course_radian(&c->e.course[k]));
  return SWINGS * pow(c->job->tolerance, 0.25) * most_s;
}

/* The longest step from here, so that an edge is met and none is left that is short beside it. */
static double longest_step(const compiled *c, double h, double left_s) {
  const double host_s = c->host->longest(c->host->ctx, c->r.t_s);
  const double most = fmin(fmin(host_s, c->job->max_step_s), fmin(c->course_s, h));
  return most >= left_s * (1 - 1e-6) ? left_s : fmin(most, fmax(left_s / 2, left_s - most));
}

/* The host's next edge, or the next corner of a source's own course. */
static double next_edge(const compiled *c) {
  double next_s = c->host->edge(c->host->ctx, c->r.t_s);
  for (int k = 0; k < c->e.courses; k++)
    next_s = fmin(next_s, vs_course_edge(&c->e.course[k], c->r.t_s));
  return next_s;
}

/* The circuit comes to rest under the sources of t = 0 by a few steps of the backward Euler rule,
 * each far longer than the last one; LONGEST_S is long beside any time constant of a circuit. The
 * machine stays where it is. */
static const double LONGER_BY = 1e3, LONGEST_S = 1e4;

static vs_status find_operating_point(compiled *c, vs_error *err) {
  vs_status status = VS_OK;
  c->still = true;
  for (double h = RESTART_S; h <= LONGEST_S && !status; h *= LONGER_BY) {
    if (c->e.states) c->host->machine.state(c->host->ctx, c->charge + c->e.machine);
    if (!(restart_length(c, h) > 0)) status = no_solution(c, err);
    vs_rodas_take(&c->r, h);
    vs_equations_mass(&c->e, c->r.y, c->charge);
  }
  c->still = false;
  c->r.t_s = 0;
  return status;
}

static bool is_enough(const compiled *c) {
  return c->host->enough && c->host->enough(c->host->ctx);
}

static vs_status run_equations(void *circuit, vs_error *err) {
  compiled *c = circuit;
  const double until_s = c->job->until_s;
  double h = FIRST_S;
  int stuck = 0;
  c->course_s = longest_by_courses(c);
  vs_replay_begin(c->job->steps);
  vs_equations_choose(&c->e, c->r.y, false);
  memcpy(c->charge, c->e.charge, (size_t)c->e.rows * sizeof *c->charge);
  vs_status status = c->job->stands ? find_operating_point(c, err) : VS_OK;
  if (!status) status = restart_behind_jump(c, RESTART_S, err);
  if (c->map.states) vs_monodromy_state(&c->map, c->charge, c->states);
  while (!status && c->r.t_s < until_s - RESTART_S && !is_enough(c)) {
    const double edge_s = fmin(next_edge(c), until_s);
    double taken = 0;
    bool jumps = false;
    c->left_s = edge_s - c->r.t_s;
    if (c->left_s > RESTART_S) {
      h = longest_step(c, h, c->left_s);
      status = try_steps(c, &h, &taken, &jumps, err);
      if (!status && taken == 0) {
        status = get_past(c, &stuck, err);
        h = FIRST_S;
        continue;
      }
      stuck = 0;
      vs_monodromy_step(&c->map, &c->r, taken);
      if (!status) status = show_step(c, taken, err);
      accept_step(c, taken);
    }
    jumps = jumps && vs_replay_restarts(c->job->steps, choose_branches(c));
    if (status || (!jumps && (c->r.t_s < edge_s - RESTART_S || edge_s == until_s))) continue;
    if (vs_replay_is_on(c->job->steps) && is_enough(c)) continue; /* no restart was noted there */
    status = restart_here(c, RESTART_S, err);
    h = FIRST_S;
  }
  return status;
}

/* ---- loaded ---- */

static void free_circuit(void *circuit) {
  compiled *c = circuit;
  if (!c) return;
  if (c->map.states) c->host->map->states = 0;
  vs_monodromy_free(&c->map);
  free(c->states);
  free(c->on);
  vs_rodas_free(&c->r);
  vs_equations_free(&c->e);
  free(c->of);
  free(c->counting);
  free(c->signal);
  free(c->shown);
  free(c->charge);
  free(c->between);
  free(c);
}

static vs_status find_signals(compiled *c, vs_error *err) {
  const vs_circuit_job *job = c->job;
  if (!c->signal) c->signal = vs_alloc(job->n_signals + 1, sizeof *c->signal);
  for (size_t k = 0; k < job->n_signals; k++) {
    c->signal[k] = vs_equations_signal(&c->e, job->signals[k]);
    if (c->signal[k] == -2 && k + job->n_wanted < job->n_signals)
      return vs_fail(err, VS_INPUT, "the netlist has no %s", job->signals[k]);
  }
  return VS_OK;
}

static vs_status load_equations(const vs_circuit_job *job, const vs_circuit_host *host,
                                void **circuit, vs_error *err) {
  compiled *c = *circuit = vs_alloc(1, sizeof *c);
  c->job = job;
  c->host = host;
  vs_status status = vs_elements_make(job, host, &c->e, err);
  if (!status) status = find_signals(c, err);
  if (status) return status;
  vs_reduction_make(&c->e, c->signal, job->n_signals);
  find_signals(c, err); /* they may have other numbers */
  const vs_rodas_drive of_host = {c, drive_sources};
  const size_t n = (size_t)c->e.n;
  vs_rodas_begin(&c->r, &c->e, &of_host);
  c->of = vs_alloc(n, sizeof *c->of);
  c->counting = vs_alloc(n, sizeof *c->counting);
  for (int k = 0; k < c->e.n; k++) {
    c->of[k] = measure_of(c, k);
    if (c->of[k].counts) c->counting[c->n_counting++] = k;
  }
  c->shown = vs_alloc(job->n_signals + 1, sizeof *c->shown);
  c->charge = vs_alloc(n, sizeof *c->charge);
  c->between = vs_alloc(n, sizeof *c->between);
  if (host->map) begin_map(c);
  return VS_OK;
}

const vs_circuit_kind vs_compiled_kind = {.name = "compiled",
                                          .measures_errors = true,
                                          .load = load_equations,
                                          .run = run_equations,
                                          .free = free_circuit};
