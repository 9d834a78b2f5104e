/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/picard.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "engine/budget.h"
#include "engine/propagator.h"
#include "full_newton.h"
#include "orbit/shooting.h"
#include "process_copies.h"
#include "slow_modes.h"

/* ---- convergence ---- */

/* How corrections go on from pass to pass, as parts of the motion's sizes: whether they still fall,
 * have stalled at what the solver rounds, or creep because something in the circuit does. */
typedef struct convergence {
  double tolerance; /* run.tolerance */
  double wanted;    /* what a correction is to come below */
  double last;      /* the last one */
  double least;     /* the least so far */
  int stalled;      /* passes since it last fell */
  double noise;     /* the largest of these */
  double before;    /* the one before the last; 0: there is none */
  double ratio;     /* of the two */
  int steady;       /* for how many passes that ratio has been about the same, and slow */
  double creeps;    /* that ratio; 0: corrections fall fast */
  double remains; /* the sum of the last one and of all that are still to come; 0: they fall fast */
} convergence;

/* Parts of run.tolerance: to which the orbit is to be known, and which may remain of what creeps.
 */
static const double CLOSED = 0.01, CREPT = 0.1;
/* Corrections that have not come below this part of the least one in so many passes have stalled.
 */
static const double FALLS = 0.7;
enum { STALLED = 10 };

/* Forgets how fast they fall, as what crept has been moved. */
static void convergence_forget(convergence *c) {
  c->before = c->creeps = c->remains = 0;
  c->ratio = NAN;
  c->steady = 0;
}

static void convergence_begin(convergence *c, double tolerance) {
  *c = (convergence){
      .tolerance = tolerance, .wanted = CLOSED * tolerance, .least = INFINITY, .ratio = NAN};
}

/* Something in the circuit that no probe shows may creep. Then corrections fall by about the same
 * factor over ENOUGH passes: a factor of SLOW and more, and each within SAME of the one before.
 * What is still to come is the sum of their series, of at most LASTS passes. The factor is kept
 * when the solver's rounding hides it later on. */
static const double SLOW = 0.6, SAME = 0.1, LASTS = 200;
enum { ENOUGH = 5 };

static void follow_ratio(convergence *c) {
  double ratio = c->before > 0 ? c->last / c->before : NAN;
  bool same = fabs(ratio - c->ratio) <= SAME && ratio >= SLOW; /* false with NaN */
  c->steady = same ? c->steady + 1 : 0;
  c->ratio = ratio;
  c->before = c->last;
  if (c->steady == ENOUGH) c->creeps = ratio;
  if (c->steady > ENOUGH) c->creeps += (ratio - c->creeps) / ENOUGH;
  double series = c->creeps < 1 ? fmin(1 / (1 - c->creeps), LASTS) : LASTS;
  c->remains = c->creeps > 0 ? c->last * series : 0;
}

static void convergence_take(convergence *c, double size) {
  c->last = size;
  follow_ratio(c);
  bool falls = c->last < FALLS * c->least;
  c->least = fmin(c->least, c->last);
  c->stalled = falls ? 0 : c->stalled + 1;
  c->noise = falls ? 0 : fmax(c->noise, c->last);
}

/* Corrections that do not fall any more are what the solver's rounding makes of them. The orbit is
 * then known as well as they are small, and that is enough where it is as well as the run is to be.
 */
static bool convergence_close(convergence *c) {
  bool small = c->last <= c->wanted;
  bool stalled = c->stalled >= STALLED && c->noise <= c->tolerance;
  if (!(small || stalled) || c->remains > CREPT * c->tolerance) return false;
  c->last = fmax(small ? c->last : c->noise, c->remains);
  return true;
}

/* ---- a search: how one run settles ---- */

/* The longest period that the machine is asked for where it is left to itself. */
enum { LONGEST_PERIOD = 6 };

/* What a pass is for: */
typedef enum search_pass {
  PASS_STEERED, /* Newton's step behind it, with the Phi there is */
  PASS_FREE,    /* none: the machine is left to itself */
  PASS_FIRST,   /* the first of a pair, from which the circuit's own Phi comes, */
  PASS_SECOND   /* and the second of it */
} search_pass;

typedef struct vs_picard_search {
  const vs_setup *setup;
  vs_orbit *orbit;   /* where the search begins, and the Phi in use; the pilot's */
  bool guessed;      /* it is one of tier switched, or of a scene that is nearly the same */
  bool own_phi;      /* the Phi in use is the circuit's own */
  vs_budget *budget; /* what the search may take; borrowed */
  int of_mains;      /* cycles of the mains in a firing period */
  double *next;      /* the machine's state where the next firing period begins; the pilot's */
  int count;         /* of the states */
  int passed;        /* firing periods of the present pass, which has orbit->n of them */
  int cycles;        /* in all */
  double x[VS_MOST_STATES];                       /* where the present pass began */
  double inverse[VS_MOST_STATES][VS_MOST_STATES]; /* (I - Phi)^-1 */
  double peak[VS_MOST_STATES + 1],
      scale[VS_MOST_STATES + 1]; /* largest sizes of the states, and of lambda: in this pass; in the
                                    last one */
  double (
      *between)[VS_MOST_STATES]; /* the states at the ends of the pass's firing periods; owned */
  convergence corrections;
  vs_process_copies copies;
  vs_slow_modes creep;
  vs_full_newton full; /* where the solver can set the circuit's state, and meets no stop */
  search_pass pass;
  int steered;                       /* passes that were steered */
  int left;                          /* so many passes more the machine is left to itself */
  bool swung;                        /* it was for long */
  int pairs;                         /* since it was last */
  double pair[2][VS_MOST_STATES];    /* where the last pair's passes ended */
  double past_m[2 * LONGEST_PERIOD]; /* the travel where the last firing periods ended */
  double travel_m;                   /* the largest size of the travel so far */
} vs_picard_search;

enum { MOST = VS_MOST_STATES };

/* Finds (I - Phi)^-1, in parts of each state's scale. False: there is none, as Phi has the
 * multiplier 1. */
static bool search_invert(vs_picard_search *s) {
  const vs_orbit *o = s->orbit;
  size_t n = (size_t)o->count, order[MOST];
  double matrix[MOST * MOST], found[MOST * MOST];
  int sign;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++)
      matrix[i * n + j] = (i == j) - o->monodromy[i][j] * o->scale[j] / o->scale[i];
  gsl_matrix_view a = gsl_matrix_view_array(matrix, n, n);
  gsl_matrix_view b = gsl_matrix_view_array(found, n, n);
  gsl_permutation p = {n, order};
  if (gsl_linalg_LU_decomp(&a.matrix, &p, &sign) || gsl_linalg_LU_invert(&a.matrix, &p, &b.matrix))
    return false;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) s->inverse[i][j] = found[i * n + j] * o->scale[i] / o->scale[j];
  return true;
}

/* A state that hardly moves is told from one that does not move at all to this part of the largest
 * of its kind: of the coordinates, or of their rates. */
static const double UNMOVED = 1e-6;

/* Sets the scales from the peaks of the pass that has ended. */
static void search_scale(vs_picard_search *s) {
  double largest[3] = {0};
  int dof = s->count / 2;
  for (int j = 0; j <= s->count; j++) largest[j / dof] = fmax(largest[j / dof], s->peak[j]);
  for (int j = 0; j <= s->count; j++) {
    double least = largest[j / dof] > 0 ? UNMOVED * largest[j / dof] : 1;
    s->scale[j] = fmax(s->peak[j], least);
    s->peak[j] = 0;
  }
}

/* Where the machine is to go on from. */
static void search_go_on(vs_picard_search *s, const double *x) {
  memcpy(s->next, x, sizeof s->x);
}

/* Counts so many passes on the budget: those of this process, or of copies. Error: VS_RUN, it has
 * none left. */
static vs_status search_take(vs_picard_search *s, int passes, vs_error *err) {
  return vs_budget_take(s->budget, true, (long)passes * s->orbit->n * s->of_mains, err);
}

/* Begins, where orbit, guessed, own_phi, budget, of_mains, next and between are set, with orbit->x
 * and orbit's Phi. */
static void search_begin(vs_picard_search *s, const vs_setup *setup) {
  vs_orbit *orbit = s->orbit;
  vs_full_newton_free(&s->full);
  *s = (vs_picard_search){.setup = setup,
                          .orbit = orbit,
                          .guessed = s->guessed,
                          .own_phi = s->own_phi,
                          .budget = s->budget,
                          .of_mains = s->of_mains,
                          .next = s->next,
                          .between = s->between,
                          .count = 2 * setup->model.dof};
  convergence_begin(&s->corrections, setup->run.tolerance);
  memcpy(s->x, orbit->x, sizeof s->x);
  search_go_on(s, s->x);
  search_invert(s);
}

/* ---- pairs of passes: the circuit's own Phi ---- */

/* Where tier switched's Phi does not do, as with a stop that this tier does not reach or reaches
 * later, the circuit's own is taken, by differences. The parent and a copy for each state run for
 * two periods, in the first of which the circuit forgets; R of the second is Phi, all that the
 * circuit remembers included. From the pair's residual and R comes Newton's step. Copies try it,
 * and parts of it; the best one is taken. A run that fails, as the stop gives way, is then that of
 * a copy. */

/* So many pairs follow one free swing. */
enum { MOST_PAIRS = 8 };
/* For so many firing periods the machine is left to itself: before the first pair where no orbit of
 * tier switched is known, times the orbit's period; and where pairs have come to nothing. */
enum { FREE_SWING = 30, LONG_FREE_SWING = 200 };
/* Passes that are not steered, but for the long free swing: two rounds of pairs, and the short one.
 */
enum { PAIR_PASSES = 4 * MOST_PAIRS + FREE_SWING + 1 };

/* A copy's state is pushed by this part of its scale. */
static const double PUSHED = 3e-4;
/* The parts of Newton's step that are tried: 1, 1/3, 1/9, ... */
enum { TRIALS = 4 };
static const double SHORTER = 1.0 / 3;
/* With a residual below this the Phi found is kept, and passes are steered again. */
static const double NEAR = 1e-3;
/* How near, in parts of the largest travel, the armature is to come to where it was, behind the
 * long one. Slow modes are still on their way then. */
static const double COMES_BACK = 0.03;

/* Begins a pair at search->x: sends the copies that Phi is found from. search->next is set, also in
 * a copy. Errors: VS_RUN, there are no processes to be had; the budget is spent. */
static vs_status pairs_begin(vs_picard_search *s, vs_error *err) {
  double start[MOST][MOST];
  vs_status status = search_take(s, 2 * s->count, err);
  if (status) return status;
  for (int j = 0; j < s->count; j++) {
    memcpy(start[j], s->x, sizeof s->x);
    start[j][j] += PUSHED * s->scale[j];
  }
  s->pass = PASS_FIRST;
  search_go_on(s, s->x);
  return vs_process_copies_send(&s->copies, s->count, start, s->next, err);
}

static double pairs_residual(const vs_picard_search *s, const double *from, const double *to) {
  double most = 0;
  for (int j = 0; j < s->count; j++) most = fmax(most, fabs(to[j] - from[j]) / s->scale[j]);
  return most;
}

/* Tries parts of Newton's step from where the first pass ended, and sets s->x to the best. Returns
 * the residual there; INFINITY: all have failed. *inside: this is a copy. */
static double try_steps(vs_picard_search *s, const double *step, bool *inside, vs_error *err) {
  double start[TRIALS][MOST], part = 1, best = INFINITY;
  vs_process_copies_told told[VS_COPIES_MOST];
  bool came[VS_COPIES_MOST];
  for (int k = 0; k < TRIALS; k++, part *= SHORTER)
    for (int j = 0; j < s->count; j++) start[k][j] = s->pair[0][j] + part * step[j];
  *inside = false;
  if (search_take(s, 2 * TRIALS, err)) return INFINITY;
  if (vs_process_copies_send(&s->copies, TRIALS, start, s->next, err)) return INFINITY;
  *inside = s->copies.inside;
  if (*inside) return 0;
  vs_process_copies_await(&s->copies, told, came);
  for (int k = 0; k < TRIALS; k++) {
    double off = came[k] ? pairs_residual(s, told[k].z[0], told[k].z[1]) : INFINITY;
    if (!(off < best)) continue;
    best = off;
    memcpy(s->x, start[k], sizeof s->x);
  }
  return best;
}

/* Passes are steered again: corrections before count no more. */
static void steer_again(vs_picard_search *s) {
  s->pass = PASS_STEERED;
  convergence_begin(&s->corrections, s->setup->run.tolerance);
  vs_slow_modes_begin(&s->creep, s->creep.deck, s->creep.tolerance, s->creep.period_s);
}

/* Pairs have come to nothing: is the machine on another orbit? */
static vs_status leave_alone(vs_picard_search *s, vs_error *err) {
  if (s->swung)
    return vs_fail(
        err, VS_RUN,
        "with the circuit's own derivatives, too, the residual is still %.2g of the motion",
        s->corrections.last);
  s->swung = true;
  s->pass = PASS_FREE;
  s->left = LONG_FREE_SWING / s->orbit->n + 1;
  if (s->guessed) memcpy(s->x, s->orbit->x, sizeof s->x);
  search_go_on(s, s->x);
  return VS_OK;
}

/* The least number of firing periods after which the machine comes back to about where it was; 0:
 * there is none up to LONGEST_PERIOD. */
static int comes_back_after(const vs_picard_search *s) {
  for (int k = 1; k <= LONGEST_PERIOD; k++) {
    double off = 0;
    for (int back = 0; back < LONGEST_PERIOD; back++)
      off = fmax(off, fabs(s->past_m[(s->cycles - back) % (2 * LONGEST_PERIOD)] -
                           s->past_m[(s->cycles - back - k) % (2 * LONGEST_PERIOD)]));
    off /= s->travel_m;
    if (off < COMES_BACK) return k;
  }
  return 0;
}

/* The long free swing has ended. */
static vs_status look_around(vs_picard_search *s, vs_error *err) {
  int k = comes_back_after(s), n = s->orbit->n;
  if (k == n) return pairs_begin(s, err);
  if (k)
    return vs_fail(err, VS_INPUT,
                   "--period %d: no such orbit is found, and the machine, left to itself, comes "
                   "back to about where it was after %d periods; try --period %d",
                   n, k, k);
  return vs_fail(err, VS_RUN,
                 "no orbit of period %d is found; nor does the machine, left to itself, come back "
                 "to where it was after up to %d periods",
                 n, LONGEST_PERIOD);
}

static vs_status end_pair(vs_picard_search *s, vs_error *err) {
  bool inside;
  vs_error why = {0};
  double before = pairs_residual(s, s->pair[0], s->pair[1]), step[MOST] = {0};
  vs_status status =
      vs_process_copies_map(&s->copies, s->pair, s->scale, s->orbit->monodromy, &why);
  memcpy(s->orbit->scale, s->scale, sizeof s->scale);
  memcpy(s->x, s->pair[1], sizeof s->x);
  s->corrections.last = before;
  if (status || !search_invert(s)) return leave_alone(s, err);
  s->own_phi = true;
  for (int i = 0; i < s->count; i++)
    for (int j = 0; j < s->count; j++)
      step[i] += s->inverse[i][j] * (s->pair[1][j] - s->pair[0][j]);
  double after = try_steps(s, step, &inside, err);
  if (inside) return VS_OK;
  s->corrections.last = after;
  if (after < NEAR) {
    steer_again(s);
    return VS_OK;
  }
  if (!isfinite(after) || ++s->pairs == MOST_PAIRS) return leave_alone(s, err);
  return pairs_begin(s, err);
}

/* A pass that was not steered has ended. Sets where the next one begins, and what it is for.
 * Errors: VS_INPUT, the machine, left to itself, comes back after another number of periods;
 * VS_RUN, it does not come back, or pairs lead nowhere. */
static vs_status pairs_turn(vs_picard_search *s, const vs_knot *end, vs_error *err) {
  vs_status status = VS_OK;
  search_scale(s);
  if (s->pass == PASS_FREE) {
    memcpy(s->x, end->x, sizeof s->x);
    search_go_on(s, s->x);
    if (--s->left > 0) return VS_OK;
    s->pairs = 0;
    return s->swung ? look_around(s, err) : pairs_begin(s, err);
  }
  memcpy(s->pair[s->pass == PASS_SECOND], end->x, sizeof s->x);
  if (s->pass == PASS_FIRST) {
    s->pass = PASS_SECOND;
    search_go_on(s, end->x);
    return VS_OK;
  }
  status = end_pair(s, err);
  if (!s->copies.inside) search_go_on(s, s->x);
  return status;
}

/* ---- Newton's step ---- */

/* Corrects the pass that ended at `end`: s->x becomes where the next one begins. */
static void correct_by_newton(vs_picard_search *s, const double *end) {
  double step[MOST] = {0};
  search_scale(s);
  for (int i = 0; i < s->count; i++)
    for (int j = 0; j < s->count; j++) step[i] += s->inverse[i][j] * (end[j] - s->x[j]);
  double size = 0;
  for (int j = 0; j < s->count; j++) {
    s->x[j] += step[j];
    size = fmax(size, fabs(step[j]) / s->scale[j]);
  }
  convergence_take(&s->corrections, size);
}

/* ---- Phi of the machine's swing alone ---- */

/* For want of an orbit of tier switched: the scene's start, and the swing's own Phi. */
static void begin_at_start(const vs_scene *scene, double period_s, vs_orbit *o) {
  vs_propagator swing;
  vs_propagator_make(&swing, &scene->setup.model, false, period_s);
  o->count = 2 * scene->setup.model.dof;
  for (int i = 0; i < o->count; i++) {
    o->scale[i] = 1;
    for (int j = 0; j < o->count; j++) o->monodromy[i][j] = swing.column[j][i];
  }
  memcpy(o->x, scene->setup.start.x, sizeof scene->setup.start.x);
}

/* ---- what was found ---- */

/* The state repeats after fewer firing periods where it is off by less than this many times what
 * the orbit is known to. */
static const double REPEATS = 10;

static int least_period(const vs_picard *p) {
  const vs_picard_search *s = p->search;
  for (int k = 1; k < p->orbit.n; k++) {
    double off = 0;
    if (p->orbit.n % k) continue;
    for (int j = 0; j < s->count; j++)
      off = fmax(off, fabs(s->between[k - 1][j] - s->x[j]) / s->scale[j]);
    if (off <= REPEATS * s->corrections.wanted) return k;
  }
  return p->orbit.n;
}

/* A copy's state is pushed by `part` of its scale. In Phi that makes an error of noise/part by what
 * the orbit is not known to, and by what the solver rounds, NOISE of run.tolerance; and one of
 * CURVED part by what is not linear. Both are as large at the part that is taken. Measured on
 * halfwave_snubbed at 90, 100 and 120 degrees. */
static const double NOISE = 1e-3, CURVED = 0.015;

static double part_pushed(const vs_picard_search *s, double *error) {
  double noise = fmax(s->corrections.last, NOISE * s->setup->run.tolerance);
  *error = 2 * sqrt(CURVED * noise);
  return sqrt(noise / CURVED);
}

/* What one set of copies shows: each state pushed to one side. */
typedef struct side {
  vs_multiplier multiplier[VS_VARIATION_MOST]; /* the largest first */
  int found;
} side;

/* Sends such copies and hears of them. In a copy search->copies.inside is true behind it. */
static vs_status look_aside(const vs_picard *p, const vs_knot *end, double part, double *x,
                            side *to, vs_error *err) {
  vs_picard_search *s = p->search;
  double orbit[MOST + 1];
  vs_status status = vs_process_copies_fork(&s->copies, &s->setup->model, s->scale, part, x, err);
  if (status || s->copies.inside) return status;
  memcpy(orbit, s->x, (size_t)s->count * sizeof *orbit);
  orbit[s->count] = end->flux_wb;
  return vs_process_copies_hear(&s->copies, orbit, s->scale, p->known_to, to->multiplier,
                                &to->found, err);
}

/* How far the largest multipliers of the two sides lie apart. */
static double distance_of_sides(const side *a, const side *b) {
  return fabs(hypot(a->multiplier[0].re, a->multiplier[0].im) -
              hypot(b->multiplier[0].re, b->multiplier[0].im));
}

/* Pushes the states to one side, and then to the other. What part_pushed tells of the error is
 * measured where copies differ smoothly. Where one meets a stop or a firing that another just
 * misses, the two sides differ by more, and that is the error. Returns true in a copy of the
 * process. */
static bool find_multipliers(vs_picard *p, const vs_knot *end) {
  vs_picard_search *s = p->search;
  vs_error why = {0};
  side up, down;
  p->multipliers = 0;
  if (s->corrections.creeps > 0) { /* the copies show one slow state of the circuit and not two */
    snprintf(p->missing, sizeof p->missing,
             "something in the circuit is forgotten by a factor of %.3g a period alone",
             s->corrections.creeps);
    return false;
  }
  double part = part_pushed(s, &p->known_to);
  vs_status status = look_aside(p, end, part, p->pilot.x, &up, &why);
  if (!status && !s->copies.inside) status = look_aside(p, end, -part, p->pilot.x, &down, &why);
  if (status) {
    snprintf(p->missing, sizeof p->missing, "%.255s", why.text);
    return false;
  }
  if (s->copies.inside) return true;
  p->known_to = fmax(p->known_to, distance_of_sides(&up, &down));
  p->multipliers = up.found;
  memcpy(p->orbit.multiplier, up.multiplier, sizeof up.multiplier);
  p->orbit.stable = hypot(up.multiplier[0].re, up.multiplier[0].im) < 1;
  return false;
}

/* The pass is one of Newton's iteration for machine and circuit as one. */
static bool is_full(const vs_picard *p) {
  return p->map.states && !p->search->full.failed;
}

/* Those of machine and circuit. On halfwave_snubbed they were off by 0.03 of run.tolerance, on
 * halfwave_paper by 0.45, and by 0.1 of how far from the orbit Phi was taken. */
static void take_multipliers(vs_picard *p) {
  const vs_full_newton *f = &p->search->full;
  p->known_to = fmax(0.3 * f->phi_off, 0.5 * p->search->setup->run.tolerance);
  p->multipliers = vs_full_newton_multipliers(f, VS_VARIATION_MOST, p->orbit.multiplier);
  if (!p->multipliers) snprintf(p->missing, sizeof p->missing, "they cannot be found");
  p->orbit.stable = hypot(p->orbit.multiplier[0].re, p->orbit.multiplier[0].im) < 1;
}

/* An unstable orbit is refused where tier switched knows that the machine runs on a subharmonic. */
static vs_status refuse_subharmonic(const vs_picard *p, vs_error *err) {
  vs_error why = {0};
  vs_orbit other = {0};
  if (!p->multipliers || p->orbit.stable) return VS_OK;
  vs_status status = vs_shooting_find(p->ideal, p->orbit.n, &other, &why);
  return status && other.runs_on
             ? vs_fail(err, VS_INPUT, "on tier %s: %s", p->ideal->tier->name, why.text)
             : VS_OK;
}

/* *begins becomes false in a copy. */
static vs_status take_orbit(vs_picard *p, const vs_knot *end, bool *begins, vs_error *err) {
  vs_picard_search *s = p->search;
  int least = least_period(p);
  if (least < p->orbit.n)
    return vs_fail(
        err, VS_INPUT,
        "--period %d: the orbit that is found repeats after %d already; write --period %d",
        p->orbit.n, least, least);
  if (p->found) return VS_OK;
  p->found = true;
  p->cycles = s->cycles;
  p->orbit.residual = s->corrections.last;
  memcpy(p->orbit.x, s->x, sizeof s->x);
  memcpy(p->orbit.scale, s->scale, (size_t)s->count * sizeof *s->scale);
  if (!p->wants_multipliers) return VS_OK;
  if (is_full(p)) take_multipliers(p);
  *begins = is_full(p) || !find_multipliers(p, end);
  return *begins ? refuse_subharmonic(p, err) : VS_OK;
}

/* ---- its budget ---- */

/* Cycles of the mains that a search may take. The search for an
 * orbit of one cycle ends before, for a reason of its own. Where the orbit's period is long there
 * are at least so many for each cycle in it. */
enum { MOST_IDEAL = 400000, MOST_CIRCUIT = 1500, FOR_EACH = 100 };

static int cycles_of(const vs_scene *scene) {
  return scene->setup.timeline.firing.every > 1 ? scene->setup.timeline.firing.every : 1;
}

static vs_budget whole_search(const vs_scene *scene, int periods) {
  long cycles = (long)periods * cycles_of(scene);
  return (vs_budget){
      .what = "periodic orbit",
      .of = scene->order.budget,
      .most = {MOST_IDEAL, cycles > MOST_CIRCUIT / FOR_EACH ? FOR_EACH * cycles : MOST_CIRCUIT},
      .shows = scene->order.shows && !scene->order.budget};
}

/* ---- the pilot ---- */

/* The most passes of a search that are steered by Newton's step. */
enum { MOST_PASSES = 200 };

static void begin_search(void *self, const vs_setup *setup) {
  vs_picard *p = self;
  vs_picard_search *s = p->search;
  p->budget = whole_search(p->ideal, p->orbit.n); /* a run anew */
  search_begin(s, setup);
  /* Where a stop is in reach, and there is no other Phi than the swing's own. */
  if (!s->guessed && setup->model.stops.count) {
    s->pass = PASS_FREE;
    s->left = FREE_SWING;
  }
  vs_slow_modes_begin(&s->creep, &setup->deck, CREPT * setup->run.tolerance, p->pilot.period_s);
}

static void accept_step_of_search(void *self, const vs_step *step) {
  vs_picard_search *s = ((vs_picard *)self)->search;
  for (int j = 0; j < s->count; j++) s->peak[j] = fmax(s->peak[j], fabs(step->to->x[j]));
  s->peak[s->count] = fmax(s->peak[s->count], fabs(step->to->flux_wb));
  const double travel_m = vs_mechanics_travel(&s->setup->model, step->to->x);
  s->travel_m = fmax(s->travel_m, fabs(travel_m));
  if (vs_stops_touched(&s->setup->model.stops, travel_m)) s->full.failed = true;
  vs_slow_modes_accept(&s->creep, step);
}

/* Error: the search has gone on for too long, and why it did. */
static vs_status check_search_goes_on(const vs_picard *p, vs_error *err) {
  const vs_picard_search *s = p->search;
  const char *name = "";
  const vs_slow_modes_probe *creeps = vs_slow_modes_worst(&s->creep, &name);
  if (isfinite(s->corrections.last) && s->steered < MOST_PASSES) return VS_OK;
  if (creeps && s->corrections.last <= s->corrections.wanted)
    return vs_fail(err, VS_RUN, "%s still creeps by %.2g of its largest size a period", name,
                   fabs(creeps->change) / creeps->scale);
  if (s->corrections.remains > 0)
    return vs_fail(
        err, VS_RUN,
        "corrections fall slowly: the last one is %.2g of the motion, and %.2g are still "
        "to come; something in the circuit creeps",
        s->corrections.last, s->corrections.remains);
  return vs_fail(err, VS_RUN,
                 "the last correction is %.2g of the motion, the least was %.2g; %.1g "
                 "is wanted",
                 s->corrections.last, s->corrections.least, s->corrections.wanted);
}

/* Corrections are so far from falling that another Phi is wanted: so many passes have brought no
 * less, or one behind the first few is a large part of the motion. A stop makes that. */
static const double WILD = 0.4;
enum { LOST = 5, SETTLES = 3 };

static bool is_lost(const vs_picard_search *s) {
  if (!s->setup->model.stops.count) return false;
  return (s->corrections.stalled >= LOST || (s->corrections.last > WILD && s->steered > SETTLES)) &&
         s->corrections.least > s->setup->run.tolerance && s->creep.area_v_s == 0;
}

static vs_status turn_full(vs_picard *p, const vs_knot *end, bool *begins, vs_error *err) {
  vs_picard_search *s = p->search;
  double size;
  search_scale(s);
  s->steered++;
  if (!vs_full_newton_turn(&s->full, &p->map, s->count, end->x, s->scale, &size)) {
    memcpy(s->x, end->x, sizeof s->x);
    steer_again(s);
    return VS_OK;
  }
  memcpy(s->x, p->map.next, (size_t)s->count * sizeof *s->x);
  search_go_on(s, s->x);
  convergence_take(&s->corrections, size);
  const bool closed = convergence_close(&s->corrections);
  *begins = vs_full_newton_ends(&s->full, &p->map, closed, p->wants_multipliers);
  if (!*begins) return VS_OK;
  vs_budget_end(s->budget);
  return take_orbit(p, end, begins, err);
}

/* A firing period of the settling has ended at `end`. *begins: the orbit is found, and the run
 * begins on it. Errors: the search's own (vs_picard_new). */
static vs_status end_period_of_search(void *self, const vs_knot *end, bool *begins, vs_error *err) {
  vs_picard *p = self;
  vs_picard_search *s = p->search;
  const char *name;
  /* The end of every firing period: where the machine is goes on record. */
  vs_status status = s->copies.inside ? VS_OK : vs_budget_take(s->budget, true, s->of_mains, err);
  if (status) return status;
  s->cycles++;
  s->past_m[s->cycles % (2 * LONGEST_PERIOD)] = vs_mechanics_travel(&s->setup->model, end->x);
  memcpy(s->between[s->passed], end->x, sizeof *s->between);
  memcpy(p->pilot.x, end->x, sizeof p->pilot.x);
  if (++s->passed < p->orbit.n) return VS_OK;
  /* The end of a pass, which is as many firing periods as the orbit has. A copy tells its state; a
   * pass of a pair, or of a free swing, is for pairs_turn. */
  s->passed = 0;
  if (s->copies.inside) {
    vs_process_copies_pass(&s->copies, end);
    return VS_OK;
  }
  if (s->pass != PASS_STEERED) return pairs_turn(s, end, err);
  if (is_full(p)) return turn_full(p, end, begins, err);
  /* Newton's step, but not behind a pass in which a flux was moved. */
  s->steered++;
  bool clean = vs_slow_modes_turn(&s->creep, end);
  if (clean)
    correct_by_newton(s, end->x);
  else /* the machine goes back to where it was; what was moved may have been what crept */
    convergence_forget(&s->corrections);
  if (is_lost(s)) {
    memcpy(s->x, end->x, sizeof s->x);
    return pairs_begin(s, err);
  }
  /* The run begins where the corrections are small enough, and nothing creeps any more. */
  memcpy(p->pilot.x, s->x, sizeof s->x);
  bool next_clean = vs_slow_modes_is_told(&s->creep) && s->creep.area_v_s == 0 &&
                    !vs_slow_modes_worst(&s->creep, &name);
  *begins = clean && next_clean && convergence_close(&s->corrections);
  status = *begins ? take_orbit(p, end, begins, err) : check_search_goes_on(p, err);
  if (*begins) vs_budget_end(s->budget);
  return status;
}

static double push_of_search(void *self, double t_s) {
  const vs_picard_search *s = ((vs_picard *)self)->search;
  return s->passed == 0 ? vs_slow_modes_push(&s->creep, t_s) : 0;
}

static void end_search(void *self) {
  const vs_picard_search *s = ((vs_picard *)self)->search;
  if (s->copies.inside) vs_process_copies_fail(&s->copies);
  vs_budget_end(s->budget);
}

static vs_scene *on_ideal_tier(const vs_scene *scene) {
  vs_scene *ideal = vs_alloc(1, sizeof *ideal);
  *ideal = *scene;
  ideal->tier = vs_tiers_automatic(false);
  ideal->frame = vs_sim_frame(ideal->tier, &ideal->setup);
  return ideal;
}

/* One period more: Phi becomes the product of Phi and that of one period. */
static void follow_on(vs_orbit *o, const vs_orbit *one) {
  double product[VS_ORBIT_STATES][VS_ORBIT_STATES] = {0};
  for (int i = 0; i < o->count; i++)
    for (int j = 0; j < o->count; j++)
      for (int k = 0; k < o->count; k++) product[i][j] += o->monodromy[i][k] * one->monodromy[k][j];
  memcpy(o->monodromy, product, sizeof product);
}

/* Where the search begins. The orbit of tier switched may repeat after fewer periods. */
static vs_status guess_orbit(const vs_scene *ideal, int periods, vs_orbit *o, bool *guessed,
                             vs_error *err) {
  const vs_shooting how = {.periods = periods, .quietly = true};
  const vs_timeline *line = &ideal->setup.timeline;
  vs_error why = {0};
  vs_status status = vs_shooting_seek(ideal, &how, o, &why);
  if (status == VS_INPUT) return vs_fail(err, status, "%s", why.text);
  const vs_orbit one = *o;
  for (int k = one.n; !status && k < periods; k += one.n) follow_on(o, &one);
  o->n = periods;
  o->period_s = periods * line->firing.every * line->period_s;
  *guessed = !status;
  if (status) begin_at_start(ideal, o->period_s, o);
  return VS_OK;
}

vs_status vs_picard_new(const vs_scene *scene, int periods, bool wants_multipliers,
                        vs_picard **picard, vs_error *err) {
  vs_picard *p = vs_alloc(1, sizeof *p);
  *p = (vs_picard){.wants_multipliers = wants_multipliers, .ideal = on_ideal_tier(scene)};
  p->search = vs_alloc(1, sizeof *p->search);
  p->budget = whole_search(scene, periods);
  p->search->budget = &p->budget;
  p->search->of_mains = cycles_of(scene);
  p->search->orbit = &p->orbit;
  p->search->next = p->pilot.x;
  *picard = NULL;
  vs_status status = guess_orbit(p->ideal, periods, &p->orbit, &p->search->guessed, err);
  if (status) {
    vs_picard_free(p);
    return status;
  }
  memcpy(p->guess, p->orbit.x, sizeof p->guess);
  p->search->between = vs_alloc((size_t)periods, sizeof *p->search->between);
  p->pilot = (vs_orbit_search){.self = p,
                               .period_s = p->orbit.period_s / p->orbit.n,
                               .of_orbit = p->orbit.n,
                               .most = (MOST_PASSES + PAIR_PASSES + VS_COPIES_PERIODS) * periods +
                                       LONG_FREE_SWING,
                               .begin = begin_search,
                               .accept = accept_step_of_search,
                               .turn = end_period_of_search,
                               .push = push_of_search,
                               .end = end_search,
                               .map = &p->map};
  *picard = p;
  return VS_OK;
}

void vs_picard_free(vs_picard *p) {
  if (!p) return;
  free(p->search->between);
  vs_full_newton_free(&p->search->full);
  free(p->search);
  free(p->ideal);
  free(p);
}

vs_full_newton *vs_picard_newton(const vs_picard *p) {
  return is_full(p) ? &p->search->full : NULL;
}

void vs_picard_again(vs_picard *p) {
  p->found = false;
}

vs_picard_past vs_picard_over(const vs_picard *p) {
  vs_picard_past past = {p->orbit, {0}, p->search->guessed, p->search->own_phi};
  memcpy(past.guess, p->guess, sizeof past.guess);
  return past;
}

void vs_picard_begin_near(vs_picard *p, const vs_picard_past *past) {
  vs_picard_search *s = p->search;
  bool follows = s->guessed && past->guessed && !past->own_phi;
  for (int j = 0; j < p->orbit.count; j++)
    p->orbit.x[j] = past->orbit.x[j] + (follows ? p->orbit.x[j] - past->guess[j] : 0);
  memcpy(p->pilot.x, p->orbit.x, sizeof p->pilot.x);
  if (follows) return;
  memcpy(p->orbit.monodromy, past->orbit.monodromy, sizeof p->orbit.monodromy);
  memcpy(p->orbit.scale, past->orbit.scale, sizeof p->orbit.scale);
  s->guessed = true;
  s->own_phi = past->own_phi;
}
