/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/picard.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "ideal/propagator.h"
#include "orbit/copies.h"
#include "orbit/creep.h"

enum { MOST = VS_MOST_STATES, LONGEST = 6 };

/* What a pass is for: */
enum {
  STEERED, /* Newton's step behind it, with the Phi there is */
  FREE,    /* none: the machine is left to itself */
  FIRST,   /* the first of a pair, from which the circuit's own Phi comes, */
  SECOND   /* and the second of it */
};

/* A search: the prelude of one run. LONGEST: the longest period that the machine is asked for where
 * it is left to itself. */
typedef struct vs_picard_search {
  const vs_setup *setup;
  int count;        /* of the states */
  int passed;       /* firing periods of the present pass, which has orbit.n of them */
  int cycles;       /* in all */
  double tolerance; /* Newton's correction is to come below */
  double x[MOST];   /* where the present pass began */
  double inverse[MOST][MOST];
  double least;      /* the least correction so far */
  int stalled;       /* passes since it last fell */
  double noise;      /* the largest correction of these */
  double correction; /* the last one's size: the largest over the states, relative to scale */
  double before;     /* that of the one before; 0: there is none */
  double ratio;      /* of the two */
  int steady;        /* for how many passes that ratio has been about the same, and slow */
  double creeps;     /* that ratio; 0: corrections fall fast */
  double remains; /* the sum of the last correction and of all that are still to come; 0: they fall
                     fast */
  double peak[MOST + 1],
      scale[MOST +
            1]; /* largest sizes of the states, and of lambda: in this pass; in the last one */
  double (*between)[MOST]; /* the states at the ends of the pass's firing periods; owned */
  vs_copies copies;
  vs_creep creep;
  int pass;                   /* what the present pass is for */
  int steered;                /* passes that were steered */
  int left;                   /* so many passes more the machine is left to itself */
  bool marched;               /* it was for long */
  int pairs;                  /* since it was last */
  double pair[2][MOST];       /* where the last pair's passes ended */
  double past_m[2 * LONGEST]; /* the travel where the last firing periods ended */
  double travel_m;            /* the largest size of the travel so far */
} search;

/* ---- Newton's step ---- */

/* Sets (I - Phi)^-1, which is found in parts of each state's scale. Returns false where there is
 * none. */
static bool invert(const vs_orbit *o, double inverse[MOST][MOST]) {
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
    for (size_t j = 0; j < n; j++) inverse[i][j] = found[i * n + j] * o->scale[i] / o->scale[j];
  return true;
}

/* A state that hardly moves is told from one that does not move at all to this part of the largest
 * of its kind: of the coordinates, or of their rates. */
static const double UNMOVED = 1e-6;

static void find_scales(search *s) {
  double largest[3] = {0};
  int dof = s->count / 2;
  for (int j = 0; j <= s->count; j++) largest[j / dof] = fmax(largest[j / dof], s->peak[j]);
  for (int j = 0; j <= s->count; j++) {
    double least = largest[j / dof] > 0 ? UNMOVED * largest[j / dof] : 1;
    s->scale[j] = fmax(s->peak[j], least);
    s->peak[j] = 0;
  }
}

/* Corrects the pass that ended at `end`: s->x becomes where the next one begins. */
static void correct(search *s, const double *end) {
  double step[MOST] = {0};
  find_scales(s);
  for (int i = 0; i < s->count; i++)
    for (int j = 0; j < s->count; j++) step[i] += s->inverse[i][j] * (end[j] - s->x[j]);
  s->correction = 0;
  for (int j = 0; j < s->count; j++) {
    s->x[j] += step[j];
    s->correction = fmax(s->correction, fabs(step[j]) / s->scale[j]);
  }
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
  const search *s = p->search;
  for (int k = 1; k < p->orbit.n; k++) {
    double off = 0;
    if (p->orbit.n % k) continue;
    for (int j = 0; j < s->count; j++)
      off = fmax(off, fabs(s->between[k - 1][j] - s->x[j]) / s->scale[j]);
    if (off <= REPEATS * s->tolerance) return k;
  }
  return p->orbit.n;
}

/* A copy's state is pushed by `part` of its scale. In Phi that makes an error of noise/part by what
 * the orbit is not known to, and by what the solver rounds, NOISE of run.tolerance; and one of
 * CURVED part by what is not linear. Both are as large at the part that is taken. Measured on
 * halfwave_snubbed at 90, 100 and 120 degrees. */
static const double NOISE = 1e-3, CURVED = 0.015;

static double part_pushed(const search *s, double *error) {
  double noise = fmax(s->correction, NOISE * s->setup->run.tolerance);
  *error = 2 * sqrt(CURVED * noise);
  return sqrt(noise / CURVED);
}

/* Returns true in a copy of the process. */
static bool find_multipliers(vs_picard *p, const vs_knot *end) {
  search *s = p->search;
  vs_error why = {0};
  if (s->creeps > 0) { /* the copies show one slow state of the circuit and not two */
    snprintf(p->missing, sizeof p->missing,
             "something in the circuit is forgotten by a factor of %.3g a period alone", s->creeps);
    p->multipliers = 0;
    return false;
  }
  double part = part_pushed(s, &p->known_to);
  vs_status status = vs_copies_fork(&s->copies, &s->setup->model, s->scale, part, p->pilot.x, &why);
  if (!status && s->copies.inside) return true;
  double orbit[MOST + 1];
  memcpy(orbit, s->x, (size_t)s->count * sizeof *orbit);
  orbit[s->count] = end->flux_wb;
  if (!status)
    status = vs_copies_hear(&s->copies, orbit, s->scale, p->known_to, p->orbit.multiplier,
                            &p->multipliers, &why);
  if (status) snprintf(p->missing, sizeof p->missing, "%.255s", why.text);
  if (status) p->multipliers = 0;
  p->orbit.stable = !status && hypot(p->orbit.multiplier[0].re, p->orbit.multiplier[0].im) < 1;
  return false;
}

/* An unstable orbit is refused where tier switched knows that the machine runs on a subharmonic. */
static vs_status refuse_subharmonic(const vs_picard *p, vs_error *err) {
  vs_error why = {0};
  vs_orbit other;
  if (!p->multipliers || p->orbit.stable) return VS_OK;
  vs_status status = vs_shooting_find(p->ideal, p->orbit.n, &other, &why);
  return status == VS_INPUT ? vs_fail(err, status, "on tier %s: %s", p->ideal->tier->name, why.text)
                            : VS_OK;
}

/* Notes what was found. *begins becomes false in a copy. */
static vs_status take_orbit(vs_picard *p, const vs_knot *end, bool *begins, vs_error *err) {
  search *s = p->search;
  int least = least_period(p);
  if (least < p->orbit.n)
    return vs_fail(err, VS_INPUT,
                   "an orbit of period %d was asked for; the one found repeats after %d already: "
                   "write --period %d",
                   p->orbit.n, least, least);
  if (p->found) return VS_OK;
  p->found = true;
  p->cycles = s->cycles;
  p->orbit.residual = s->correction;
  memcpy(p->orbit.x, s->x, sizeof s->x);
  memcpy(p->orbit.scale, s->scale, (size_t)s->count * sizeof *s->scale);
  if (!p->wants_multipliers) return VS_OK;
  *begins = !find_multipliers(p, end);
  return *begins ? refuse_subharmonic(p, err) : VS_OK;
}

/* ---- the circuit's own Phi ---- */

/* Where tier switched's Phi does not do, as with a stop that this tier does not reach or reaches
 * later, the circuit's own is taken, by differences. The parent and a copy for each state run for
 * two periods, in the first of which the circuit forgets; R of the second is Phi, all that the
 * circuit remembers included. From the pair's residual and R comes Newton's step. Copies try it,
 * and parts of it; the best one is taken. A run that fails, as the stop gives way, is then that of
 * a copy. */

/* A copy's state is pushed by this part of its scale. */
static const double PUSHED = 3e-4;
/* The parts of Newton's step that are tried: 1, 1/3, 1/9, ... */
enum { TRIALS = 4 };
static const double SHORTER = 1.0 / 3;
/* With a residual below this the Phi found is kept, and passes are steered again. */
static const double NEAR = 1e-3;
/* So many pairs follow on one march. */
enum { PAIRS = 8 };
/* For so many firing periods the machine is left to itself: before the first pair where no orbit of
 * tier switched is known, times the orbit's period; and where pairs have come to nothing. */
enum { MARCH = 30, LONG_MARCH = 200 };
/* How near, in parts of the largest travel, the armature is to come to where it was, behind the
 * long one. Slow modes are still on their way then. */
static const double COMES_BACK = 0.03;
/* Passes that are not steered, but for the long march: two rounds of pairs, and the short march. */
enum { MOST_UNSTEERED = 4 * PAIRS + MARCH + 1 };

/* Sends the copies that Phi is found from, at s->x. Sets the pilot's state, also in a copy. */
static vs_status begin_pair(vs_picard *p, vs_error *err) {
  search *s = p->search;
  double start[MOST][MOST];
  for (int j = 0; j < s->count; j++) {
    memcpy(start[j], s->x, sizeof s->x);
    start[j][j] += PUSHED * s->scale[j];
  }
  s->pass = FIRST;
  memcpy(p->pilot.x, s->x, sizeof s->x);
  return vs_copies_send(&s->copies, s->count, start, p->pilot.x, err);
}

static double residual(const search *s, const double *from, const double *to) {
  double most = 0;
  for (int j = 0; j < s->count; j++) most = fmax(most, fabs(to[j] - from[j]) / s->scale[j]);
  return most;
}

/* Tries parts of Newton's step from where the first pass ended, and sets s->x to the best. Returns
 * the residual there; INFINITY: all have failed. *inside: this is a copy. */
static double try_steps(vs_picard *p, const double *step, bool *inside, vs_error *err) {
  search *s = p->search;
  double start[TRIALS][MOST], part = 1, best = INFINITY;
  vs_copies_told told[VS_COPIES_MOST];
  bool came[VS_COPIES_MOST];
  for (int k = 0; k < TRIALS; k++, part *= SHORTER)
    for (int j = 0; j < s->count; j++) start[k][j] = s->pair[0][j] + part * step[j];
  *inside = false;
  if (vs_copies_send(&s->copies, TRIALS, start, p->pilot.x, err)) return INFINITY;
  *inside = s->copies.inside;
  if (*inside) return 0;
  vs_copies_await(&s->copies, told, came);
  for (int k = 0; k < TRIALS; k++) {
    double off = came[k] ? residual(s, told[k].z[0], told[k].z[1]) : INFINITY;
    if (!(off < best)) continue;
    best = off;
    memcpy(s->x, start[k], sizeof s->x);
  }
  return best;
}

/* What was moved in the circuit may have been what crept. */
static void forget_corrections(search *s) {
  s->before = s->creeps = s->remains = 0;
  s->ratio = NAN;
  s->steady = 0;
}

/* The least residual of passes that are steered again: those before count no more. */
static void steer_again(search *s) {
  s->pass = STEERED;
  s->least = INFINITY;
  s->stalled = 0;
  s->noise = 0;
  forget_corrections(s);
  vs_creep_begin(&s->creep, s->creep.deck, s->creep.tolerance, s->creep.period_s);
}

/* Pairs have come to nothing: is the machine on another orbit? */
static vs_status leave_alone(vs_picard *p, vs_error *err) {
  search *s = p->search;
  if (s->marched)
    return vs_fail(
        err, VS_RUN,
        "with the circuit's own derivatives, too, the residual is still %.2g of the motion",
        s->correction);
  s->marched = true;
  s->pass = FREE;
  s->left = LONG_MARCH / p->orbit.n + 1;
  if (p->guessed) memcpy(s->x, p->orbit.x, sizeof s->x);
  memcpy(p->pilot.x, s->x, sizeof s->x);
  return VS_OK;
}

/* The least number of firing periods after which the machine comes back to about where it was; 0:
 * there is none up to LONGEST. */
static int comes_back_after(const search *s) {
  for (int k = 1; k <= LONGEST; k++) {
    double off = 0;
    for (int back = 0; back < LONGEST; back++)
      off = fmax(off, fabs(s->past_m[(s->cycles - back) % (2 * LONGEST)] -
                           s->past_m[(s->cycles - back - k) % (2 * LONGEST)]));
    off /= s->travel_m;
    if (off < COMES_BACK) return k;
  }
  return 0;
}

/* The long march has ended. */
static vs_status look_around(vs_picard *p, vs_error *err) {
  int k = comes_back_after(p->search), n = p->orbit.n;
  if (k == n) return begin_pair(p, err);
  if (k)
    return vs_fail(err, VS_INPUT,
                   "an orbit of period %d was asked for; none is found, and the machine, left to "
                   "itself, comes back to about where it was after %d periods: try --period %d",
                   n, k, k);
  return vs_fail(err, VS_RUN,
                 "no orbit of period %d is found; nor does the machine, left to itself, come back "
                 "to where it was after up to %d periods",
                 n, LONGEST);
}

/* The pair has ended. */
static vs_status end_pair(vs_picard *p, vs_error *err) {
  search *s = p->search;
  bool inside;
  vs_error why = {0};
  double before = residual(s, s->pair[0], s->pair[1]), step[MOST] = {0};
  vs_status status = vs_copies_map(&s->copies, s->pair, s->scale, p->orbit.monodromy, &why);
  memcpy(p->orbit.scale, s->scale, sizeof s->scale);
  memcpy(s->x, s->pair[1], sizeof s->x);
  s->correction = before;
  if (status || !invert(&p->orbit, s->inverse)) return leave_alone(p, err);
  for (int i = 0; i < s->count; i++)
    for (int j = 0; j < s->count; j++)
      step[i] += s->inverse[i][j] * (s->pair[1][j] - s->pair[0][j]);
  double after = try_steps(p, step, &inside, err);
  if (inside) return VS_OK;
  s->correction = after;
  if (after < NEAR) {
    steer_again(s);
    return VS_OK;
  }
  if (!isfinite(after) || ++s->pairs == PAIRS) return leave_alone(p, err);
  return begin_pair(p, err);
}

/* Behind a pass that is not steered. Sets where the next one begins. */
static vs_status pass_unsteered(vs_picard *p, const vs_knot *end, vs_error *err) {
  search *s = p->search;
  vs_status status = VS_OK;
  find_scales(s);
  if (s->pass == FREE) {
    memcpy(s->x, end->x, sizeof s->x);
    memcpy(p->pilot.x, s->x, sizeof s->x);
    if (--s->left > 0) return VS_OK;
    s->pairs = 0;
    return s->marched ? look_around(p, err) : begin_pair(p, err);
  }
  memcpy(s->pair[s->pass == SECOND], end->x, sizeof s->x);
  if (s->pass == FIRST) {
    s->pass = SECOND;
    memcpy(p->pilot.x, end->x, sizeof p->pilot.x);
    return VS_OK;
  }
  status = end_pair(p, err);
  if (!s->copies.inside) memcpy(p->pilot.x, s->x, sizeof s->x);
  return status;
}

/* ---- the pilot ---- */

/* The most passes of a search that are steered by Newton's step. */
enum { MOST_PASSES = 200 };

/* Relative to run.tolerance: how well the orbit is to be known. */
static const double CLOSED = 0.01;
/* The same of what still creeps in the circuit. */
static const double CREPT = 0.1;
/* Corrections that have not come below this part of the least one in so many passes have stalled.
 */
static const double FALLS = 0.7;
enum { STALLED = 10 };

static void begin(void *self, const vs_setup *setup) {
  vs_picard *p = self;
  search *s = p->search;
  double(*between)[MOST] = s->between;
  *s = (search){.setup = setup,
                .between = between,
                .count = 2 * setup->model.dof,
                .least = INFINITY,
                .ratio = NAN,
                .tolerance = CLOSED * setup->run.tolerance};
  memcpy(s->x, p->orbit.x, sizeof s->x);
  memcpy(p->pilot.x, s->x, sizeof s->x);
  invert(&p->orbit, s->inverse);
  /* Where a stop is in reach, and there is no other Phi than the swing's own. */
  if (!p->guessed && setup->model.stops.count) {
    s->pass = FREE;
    s->left = MARCH;
  }
  vs_creep_begin(&s->creep, &setup->deck, CREPT * setup->run.tolerance, p->pilot.period_s);
}

static void accept(void *self, const vs_step *step) {
  search *s = ((vs_picard *)self)->search;
  for (int j = 0; j < s->count; j++) s->peak[j] = fmax(s->peak[j], fabs(step->to->x[j]));
  s->peak[s->count] = fmax(s->peak[s->count], fabs(step->to->flux_wb));
  s->travel_m = fmax(s->travel_m, fabs(vs_mechanics_travel(&s->setup->model, step->to->x)));
  vs_creep_accept(&s->creep, step);
}

/* Why the search goes on; an error where it has gone on for too long. */
static vs_status go_on(const vs_picard *p, vs_error *err) {
  const search *s = p->search;
  const char *name = "";
  const vs_creep_probe *creeps = vs_creep_worst(&s->creep, &name);
  if (isfinite(s->correction) && s->steered < MOST_PASSES) return VS_OK;
  if (creeps && s->correction <= s->tolerance)
    return vs_fail(err, VS_RUN, "%s still creeps by %.2g of its largest size a period", name,
                   fabs(creeps->change) / creeps->scale);
  if (s->remains > 0)
    return vs_fail(
        err, VS_RUN,
        "corrections fall slowly: the last one is %.2g of the motion, and %.2g are still "
        "to come; something in the circuit creeps",
        s->correction, s->remains);
  return vs_fail(err, VS_RUN,
                 "the last correction is %.2g of the motion, the least was %.2g; %.1g "
                 "is wanted",
                 s->correction, s->least, s->tolerance);
}

/* Something in the circuit that no probe shows may creep. Then corrections fall by about the same
 * factor over ENOUGH passes: a factor of SLOW and more, and each within SAME of the one before.
 * What is still to come is the sum of their series, of at most LASTS passes. The factor is kept
 * when the solver's rounding hides it later on. */
static const double SLOW = 0.6, SAME = 0.1, LASTS = 200;
enum { ENOUGH = 5 };

static void follow_corrections(search *s) {
  double ratio = s->before > 0 ? s->correction / s->before : NAN;
  bool same = fabs(ratio - s->ratio) <= SAME && ratio >= SLOW; /* false with NaN */
  s->steady = same ? s->steady + 1 : 0;
  s->ratio = ratio;
  s->before = s->correction;
  if (s->steady == ENOUGH) s->creeps = ratio;
  if (s->steady > ENOUGH) s->creeps += (ratio - s->creeps) / ENOUGH;
  double series = s->creeps < 1 ? fmin(1 / (1 - s->creeps), LASTS) : LASTS;
  s->remains = s->creeps > 0 ? s->correction * series : 0;
}

/* Notes whether corrections still fall. */
static void watch(search *s) {
  follow_corrections(s);
  bool falls = s->correction < FALLS * s->least;
  s->least = fmin(s->least, s->correction);
  s->stalled = falls ? 0 : s->stalled + 1;
  s->noise = falls ? 0 : fmax(s->noise, s->correction);
}

/* Corrections that do not fall any more are what the solver's rounding makes of them. The orbit is
 * then known as well as they are small, and that is enough where it is as well as the run is to be.
 */
static bool is_close(search *s) {
  bool small = s->correction <= s->tolerance;
  bool stalled = s->stalled >= STALLED && s->noise <= s->setup->run.tolerance;
  if (!(small || stalled) || s->remains > CREPT * s->setup->run.tolerance) return false;
  s->correction = fmax(small ? s->correction : s->noise, s->remains);
  return true;
}

/* Corrections are so far from falling that another Phi is wanted: so many passes have brought no
 * less, or one behind the first few is a large part of the motion. A stop makes that. */
static const double WILD = 0.4;
enum { LOST = 5, SETTLES = 3 };

static bool is_lost(const search *s) {
  if (!s->setup->model.stops.count) return false;
  return (s->stalled >= LOST || (s->correction > WILD && s->steered > SETTLES)) &&
         s->least > s->setup->run.tolerance && s->creep.area_v_s == 0;
}

static vs_status turn(void *self, const vs_knot *end, bool *begins, vs_error *err) {
  vs_picard *p = self;
  search *s = p->search;
  const char *name;
  s->cycles++;
  s->past_m[s->cycles % (2 * LONGEST)] = vs_mechanics_travel(&s->setup->model, end->x);
  memcpy(s->between[s->passed], end->x, sizeof *s->between);
  memcpy(p->pilot.x, end->x, sizeof p->pilot.x);
  if (++s->passed < p->orbit.n) return VS_OK;
  s->passed = 0;
  if (s->copies.inside) {
    vs_copies_pass(&s->copies, end);
    return VS_OK;
  }
  if (s->pass != STEERED) return pass_unsteered(p, end, err);
  s->steered++;
  bool clean = vs_creep_turn(&s->creep, end);
  if (clean) correct(s, end->x); /* else the machine goes back to where it was */
  if (clean)
    watch(s);
  else
    forget_corrections(s);
  if (is_lost(s)) {
    memcpy(s->x, end->x, sizeof s->x);
    return begin_pair(p, err);
  }
  memcpy(p->pilot.x, s->x, sizeof s->x);
  bool next_clean =
      vs_creep_is_told(&s->creep) && s->creep.area_v_s == 0 && !vs_creep_worst(&s->creep, &name);
  *begins = clean && next_clean && is_close(s);
  return *begins ? take_orbit(p, end, begins, err) : go_on(p, err);
}

static double push(void *self, double t_s) {
  const search *s = ((vs_picard *)self)->search;
  return s->passed == 0 ? vs_creep_push(&s->creep, t_s) : 0;
}

static void end(void *self) {
  const search *s = ((vs_picard *)self)->search;
  if (s->copies.inside) vs_copies_fail(&s->copies);
}

static void release(void *self) {
  vs_picard_free(self);
}

/* ---- where the search begins ---- */

static vs_scene *on_ideal_tier(const vs_scene *scene) {
  vs_scene *ideal = vs_alloc(1, sizeof *ideal);
  *ideal = *scene;
  ideal->tier = vs_tiers_automatic(false);
  ideal->frame = vs_sim_frame(ideal->tier, &ideal->setup);
  return ideal;
}

/* One period of the orbit more: Phi becomes the product of Phi and that of one period. */
static void follow_on(vs_orbit *o, const vs_orbit *one) {
  double product[VS_ORBIT_STATES][VS_ORBIT_STATES] = {0};
  for (int i = 0; i < o->count; i++)
    for (int j = 0; j < o->count; j++)
      for (int k = 0; k < o->count; k++) product[i][j] += o->monodromy[i][k] * one->monodromy[k][j];
  memcpy(o->monodromy, product, sizeof product);
}

/* Where the search begins. The orbit of tier switched may repeat after fewer periods. */
static vs_status guess(const vs_scene *ideal, int periods, vs_orbit *o, bool *guessed,
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
  *picard = NULL;
  vs_status status = guess(p->ideal, periods, &p->orbit, &p->guessed, err);
  if (status) {
    vs_picard_free(p);
    return status;
  }
  p->search->between = vs_alloc((size_t)periods, sizeof *p->search->between);
  p->pilot =
      (vs_pilot){.self = p,
                 .period_s = p->orbit.period_s / p->orbit.n,
                 .most = (MOST_PASSES + MOST_UNSTEERED + VS_COPIES_PERIODS) * periods + LONG_MARCH,
                 .begin = begin,
                 .accept = accept,
                 .turn = turn,
                 .push = push,
                 .end = end,
                 .free = release};
  *picard = p;
  return VS_OK;
}

void vs_picard_free(vs_picard *p) {
  if (!p) return;
  free(p->search->between);
  free(p->search);
  free(p->ideal);
  free(p);
}

void vs_picard_again(vs_picard *p) {
  p->found = false;
}
