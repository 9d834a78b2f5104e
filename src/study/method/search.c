/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "method/search.h"

#include <assert.h>
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "study/random.h"

/* The start takes a quarter of all points, but at least 2 populations and at most 50 points for
 * each axis. The population has 6 members for each axis, within these bounds, and is bred until at
 * most 0.7 of all points are used. Each difference has a new weight, 0.4 to 0.9, and every third
 * child goes towards the best member as well. Every other child takes nine coordinates of ten from
 * the mutant, which suits valleys that lie askew; the others take three of ten, which suits valleys
 * along the axes. */
enum { FEWEST = 12, MOST = 60, PER_AXIS = 6, START_PER_AXIS = 50 };
/* Rounds of the pattern before its step is halved; the first one goes along the axes. */
enum { TURNS = 3 };
/* These keep the uses of one seed apart. */
enum { SALT_PICK = 1 << 20, SALT_CROSS = 1 << 21, SALT_TURN = 1 << 22 };
/* A search with restarts draws half of the points it has left. Its climbs share the others in equal
 * parts: the first is for all climbs, the next for the better half of them, and so on until one is
 * left (successive halving: Jamieson and Talwalkar, AISTATS 2016). A climb along several axes looks
 * at three changed places at a time, each change between three spacings of the points and the
 * finest. If all climbs have ended, the search draws again. */
enum { CHANGES = 3, LEVELS_EVERY = 4, FEW_LEVELS = 6, ROUNDS = 6, SALT_CHANGE = 1 << 23 };
static const double STRATA_PART = 0.5, LARGEST_CHANGE = 3, PATIENCE = 8;
static const double START_PART = 0.25, GLOBAL_PART = 0.7, CROSSOVER[] = {0.9, 0.3},
                    TO_BEST[] = {0.7, 0, 0},
                    FIRST_STEP = 0.1, /* the pattern's step; it grows where it found something */
    GROW = 2;

typedef enum phase { START, EVOLUTION, PATTERN, RESTARTS, OVER } phase;

/* One of several local searches, each of which begins at a place of its own. */
typedef struct climb {
  double at[VS_SEARCH_AXES], value, came[VS_SEARCH_AXES];
  bool coming;
  /* Of a single axis: down and up it. Each side has its own, as a worst value often lies at a jump,
   * where one side falls at once and the other does not. */
  double step[2];
  size_t stride; /* in its periods; 0: it looks at no other period */
  size_t polled[CHANGES + 4 + (FEW_LEVELS + 1) * VS_SEARCH_AXES],
      polls;                                                 /* points it looks at now */
  int side[CHANGES + 4 + (FEW_LEVELS + 1) * VS_SEARCH_AXES]; /* of each: 0, 1; -1: it is no step */
  double may;                 /* points that may be run for it until the next part */
  size_t used, tries, failed; /* points that were run for it; how often it asked; in vain */
  bool looking, moved, over;  /* it asked in this generation; it came here by the last steps; it has
                                 ended */
  size_t joined;              /* 1 + the better climb that it came to; 0: it came to none */
} climb;

struct vs_search {
  vs_search_setup setup;
  phase phase;
  size_t asked; /* points of all generations that were told */
  uint64_t generation;
  size_t population, members; /* members of the population, while that is being settled */
  double *member, *fitness;   /* [population][axes]; [population] */
  double *points;             /* all points so far; those of this generation come last */
  size_t count;               /* of this generation */
  double best[VS_SEARCH_AXES], best_value;
  double center[VS_SEARCH_AXES],
      came[VS_SEARCH_AXES]; /* local search: where it is, and how it got there */
  double center_value, step;
  int turned;
  double *value; /* of all points so far; only of a search with restarts */
  double spacing;
  climb *climbs;   /* [climbing]; those from `fresh` on began in this round */
  size_t continua; /* axes without levels */
  size_t line;     /* the axis that is the only continuum; SIZE_MAX: there is none, or more */
  size_t climbing, drawn; /* drawn: points of Sobol's sequence */
  size_t racing;          /* climbs that share the present part */
  double part;            /* points of it */
  int round;
};

static bool is_better(double value, double than) {
  return !isnan(value) && (isnan(than) || value < than);
}

static void snap_to_levels(const vs_search_setup *setup, double *x) {
  for (size_t d = 0; d < setup->axes; d++) {
    int n = setup->levels[d];
    x[d] = fmin(fmax(x[d], 0), 1);
    if (n) x[d] = (fmin(floor(x[d] * n), n - 1) + 0.5) / n;
  }
}

static double *point_of_search(const vs_search *s, size_t k) { /* of this generation */
  return &s->points[(s->asked + k) * s->setup.axes];
}

static double *add_point_of_search(vs_search *s) {
  return point_of_search(s, s->count++);
}

/* Returns which point this is; the number of all, if it is a new one. */
static size_t find_point(const vs_search *s, const double *x) {
  const size_t all = s->asked + s->count;
  size_t k = 0;
  while (k < all && memcmp(x, &s->points[k * s->setup.axes], s->setup.axes * sizeof *x)) k++;
  return k;
}

/* Adds the point unless it was asked for before. */
static void add_new(vs_search *s, double *x) {
  snap_to_levels(&s->setup, x);
  if (find_point(s, x) == s->asked + s->count)
    memcpy(add_point_of_search(s), x, s->setup.axes * sizeof *x);
}

static size_t start_count(const vs_search *s) {
  if (s->setup.restarts) {
    const size_t left = s->setup.most - s->asked, part = (size_t)(STRATA_PART * (double)left);
    return part > s->setup.restarts ? part : left;
  }
  size_t n = (size_t)(START_PART * (double)s->setup.most), most = START_PER_AXIS * s->setup.axes;
  if (n > most) n = most;
  if (n < 2 * s->population) n = 2 * s->population;
  return n < s->setup.most ? n : s->setup.most;
}

/* How many coordinates of a Sobol point it takes: two for each axis with a period, one for each of
 * the others that has no levels, and a last one for all that have. */
static size_t strata_axes(const vs_search_setup *setup) {
  size_t n = 1;
  for (size_t d = 0; d < setup->axes; d++) n += setup->levels[d] ? 0 : setup->period[d] > 0 ? 2 : 1;
  return n;
}

/* Returns a point of the start as strata: a coordinate of u says in which period of an axis it lies
 * and another one where in it, so that all of a period is seen as well as all periods. One
 * coordinate says which of all combinations of levels it has. */
static void place_in_strata(const vs_search_setup *setup, const double *u, double *x) {
  double word = u[strata_axes(setup) - 1];
  for (size_t d = 0; d < setup->axes; d++) {
    const double period = setup->period[d];
    const int levels = setup->levels[d];
    if (levels) {
      word *= levels;
      x[d] = (floor(word) + 0.5) / levels;
      word -= floor(word);
    } else if (period > 0) {
      x[d] = (floor(u[0] * ceil(1 / period)) + u[1]) * period;
      if (x[d] > 1) x[d] -= period;
      u += 2;
    } else
      x[d] = *u++;
  }
}

/* Puts one of the first points at an end of a range: each range has both of its ends once, as they
 * are often the worst. In a start of few points that would be most of them, and none is put there.
 */
static void put_at_end(const vs_search *s, size_t point, size_t of, double *x) {
  if (4 * s->continua > of || point >= 2 * s->continua) return;
  for (size_t d = 0, k = 0; d < s->setup.axes; d++)
    if (!s->setup.levels[d] && k++ == point / 2) x[d] = (double)(point % 2);
}

static void ask_start(vs_search *s) {
  const size_t n = start_count(s);
  const size_t axes = s->setup.restarts ? strata_axes(&s->setup) : s->setup.axes;
  vs_sobol *sobol = vs_alloc(1, sizeof *sobol);
  vs_random_sobol_begin(sobol, axes, s->drawn + n, s->setup.seed);
  for (size_t i = s->drawn; i < s->drawn + n; i++) {
    double u[VS_SOBOL_AXES], x[VS_SEARCH_AXES];
    for (size_t d = 0; d < axes; d++) u[d] = vs_random_sobol_at(sobol, i, d);
    if (s->setup.restarts) {
      place_in_strata(&s->setup, u, x);
      put_at_end(s, i, n, x);
      add_new(s, x);
    } else {
      memcpy(x, u, axes * sizeof *x);
      snap_to_levels(&s->setup, x);
      memcpy(add_point_of_search(s), x, axes * sizeof *x);
    }
  }
  s->drawn += s->setup.restarts ? n : 0;
  free(sobol);
}

/* Returns a member of the population that is none of those chosen so far. */
static size_t pick_member(const vs_search *s, uint64_t child, const size_t *taken, size_t n_taken) {
  uint64_t draw = 0;
  for (;; draw++) {
    uint64_t bits =
        vs_random_bits(s->setup.seed, child, SALT_PICK + 64 * (uint64_t)n_taken + draw % 64);
    size_t at = (size_t)((bits >> 8) % s->population + draw / 64) % s->population;
    bool free_place = true;
    for (size_t k = 0; k < n_taken; k++) free_place &= taken[k] != at;
    if (free_place) return at;
  }
}

/* Makes the mutant: a member and the weighted difference of two others. A coordinate beyond a bound
 * is put halfway to it. */
static void breed_mutant(const vs_search *s, size_t parent, double *x) {
  const size_t n = s->setup.axes;
  const uint64_t child = s->generation * MOST + parent;
  size_t taken[3] = {parent};
  for (size_t k = 1; k < 3; k++) taken[k] = pick_member(s, child, taken, k);
  const double *own = &s->member[parent * n], *a = &s->member[taken[1] * n],
               *b = &s->member[taken[2] * n];
  const double weight = 0.4 + 0.5 * vs_random_uniform(s->setup.seed, child, SALT_CROSS);
  const size_t always = (size_t)(vs_random_bits(s->setup.seed, child, SALT_CROSS + 1) >> 8) % n;
  for (size_t d = 0; d < n; d++) {
    bool crossed =
        vs_random_uniform(s->setup.seed, child, SALT_CROSS + 2 + d) < CROSSOVER[child % 2];
    double mutant = own[d] + TO_BEST[parent % 3] * (s->best[d] - own[d]) + weight * (a[d] - b[d]);
    if (mutant < 0) mutant = own[d] / 2;
    if (mutant > 1) mutant = (own[d] + 1) / 2;
    x[d] = crossed || d == always ? mutant : own[d];
  }
  snap_to_levels(&s->setup, x);
}

/* Makes a random direction of length 1. */
static void random_direction(const vs_search *s, double *v) {
  const size_t n = s->setup.axes;
  double sum = 0;
  for (size_t d = 0; d < n; d++) {
    double u = vs_random_uniform(s->setup.seed, s->generation, SALT_TURN + d);
    v[d] = gsl_cdf_ugaussian_Pinv(u);
    sum += v[d] * v[d];
  }
  for (size_t d = 0; d < n; d++) v[d] /= sqrt(sum);
}

/* Asks for the points one step away, both ways along each axis. When it is turned, the axes are
 * mirrored at a random plane, so that the pattern does not come to rest in a valley or at an edge
 * that lies askew. */
static void poll_neighbours(vs_search *s) {
  double x[VS_SEARCH_AXES], v[VS_SEARCH_AXES] = {0};
  const size_t n = s->setup.axes;
  if (s->turned) random_direction(s, v);
  for (size_t k = 0; k < 2 * n; k++) {
    for (size_t d = 0; d < n; d++) {
      int levels = s->setup.levels[d];
      double step = levels ? fmax(s->step, 1.0 / levels) : s->step;
      double along = (d == k / 2) - 2 * v[d] * v[k / 2];
      x[d] = s->center[d] + (k % 2 ? -step : step) * along;
    }
    add_new(s, x);
  }
}

static void ask_pattern(vs_search *s) {
  double x[VS_SEARCH_AXES];
  const size_t n = s->setup.axes;
  double far = 0;
  for (size_t d = 0; d < n; d++) far = fmax(far, fabs(s->came[d]));
  for (double reach = 1; far > 0 && reach <= 4;
       reach *= 2) { /* on in the direction in which it went */
    for (size_t d = 0; d < n; d++) x[d] = s->center[d] + reach * s->came[d];
    add_new(s, x);
  }
  poll_neighbours(s);
}

/* Returns how many of the start's points near to point k are better than it. */
static size_t count_better(const vs_search *s, const double *values, size_t k) {
  size_t n = 0;
  const double reach = 1.5 / pow((double)s->count, 1 / (double)s->setup.axes);
  for (size_t i = 0; i < s->count; i++) {
    double far = 0;
    for (size_t d = 0; d < s->setup.axes; d++)
      far = fmax(far, fabs(point_of_search(s, i)[d] - point_of_search(s, k)[d]));
    n += far <= reach && is_better(values[i], values[k]);
  }
  return n;
}

static void take_results(vs_search *s, const double *values, size_t from) {
  memcpy(&s->member[s->members * s->setup.axes], point_of_search(s, from),
         s->setup.axes * sizeof *s->member);
  s->fitness[s->members++] = values[from];
}

/* Chooses the population among the start's points. Up to half of it are points than which none near
 * them is better, so that a narrow valley is not passed over for the slopes of a wide one. The
 * others are the best there are. */
static void settle_population(vs_search *s, const double *values) {
  bool *gone = vs_alloc(s->count, sizeof *gone);
  if (s->population > s->count) s->population = s->count;
  for (int pass = 0; pass < 2; pass++)
    while (s->members < (pass ? s->population : s->population / 2)) {
      size_t found = SIZE_MAX;
      for (size_t i = 0; i < s->count; i++) {
        if (gone[i] || (!pass && count_better(s, values, i))) continue;
        if (found == SIZE_MAX || is_better(values[i], values[found])) found = i;
      }
      if (found == SIZE_MAX) break;
      gone[found] = true;
      take_results(s, values, found);
    }
  free(gone);
}

/* Returns the member of the population that is nearest to a point. */
static size_t nearest_member(const vs_search *s, const double *x) {
  size_t found = 0;
  double least = INFINITY;
  for (size_t k = 0; k < s->population; k++) {
    double sum = 0;
    for (size_t d = 0; d < s->setup.axes; d++)
      sum += (s->member[k * s->setup.axes + d] - x[d]) * (s->member[k * s->setup.axes + d] - x[d]);
    if (sum < least) least = sum, found = k;
  }
  return found;
}

/* A child takes the place of the member nearest to it, if it is better. Through this crowding
 * (Thomsen, CEC 2004) a member far from all others is not lost before its own surroundings were
 * seen. */
static void select_children(vs_search *s, const double *values) {
  for (size_t k = 0; k < s->count; k++) {
    size_t at = nearest_member(s, point_of_search(s, k));
    if (!is_better(values[k], s->fitness[at])) continue;
    memcpy(&s->member[at * s->setup.axes], point_of_search(s, k),
           s->setup.axes * sizeof *s->member);
    s->fitness[at] = values[k];
  }
}

/* Returns the longest side of the box that the population lies in. */
static double extent_of_population(const vs_search *s) {
  double longest = 0;
  for (size_t d = 0; d < s->setup.axes; d++) {
    double low = 1, high = 0;
    for (size_t k = 0; k < s->population; k++) {
      low = fmin(low, s->member[k * s->setup.axes + d]);
      high = fmax(high, s->member[k * s->setup.axes + d]);
    }
    longest = fmax(longest, high - low);
  }
  return longest;
}

static void begin_pattern(vs_search *s) {
  s->phase = PATTERN;
  memcpy(s->center, s->best, sizeof s->center);
  memset(s->came, 0, sizeof s->came);
  s->center_value = s->best_value;
  s->step = fmin(FIRST_STEP, fmax(extent_of_population(s) / 4, 4 * s->setup.finest));
}

static void move_search(vs_search *s) {
  if (is_better(s->best_value, s->center_value)) {
    for (size_t d = 0; d < s->setup.axes; d++) s->came[d] = s->best[d] - s->center[d];
    memcpy(s->center, s->best, sizeof s->center);
    s->center_value = s->best_value;
    s->step = fmin(FIRST_STEP, s->step * GROW);
    return;
  }
  memset(s->came, 0, sizeof s->came);
  s->turned = (s->turned + 1) % TURNS;
  if (s->turned) return; /* looks once more, in other directions */
  s->step /= 2;
  if (s->step < s->setup.finest) s->phase = OVER;
}

/* ---- restarts ---- */

/* How far two points are from each other: the longest of their distances along the axes; 2 if they
 * differ in a level. */
static double distance_of(const vs_search *s, const double *a, const double *b) {
  double far = 0;
  for (size_t d = 0; d < s->setup.axes; d++) {
    if (s->setup.levels[d] && a[d] != b[d]) return 2;
    far = fmax(far, fabs(a[d] - b[d]));
  }
  return far;
}

static double finest_of_axis(const vs_search *s, size_t d) {
  return s->setup.finest * (s->setup.period[d] > 0 ? fmin(1, 4 * s->setup.period[d]) : 1);
}

static void begin_climb(vs_search *s, size_t point) {
  climb *c = &s->climbs[s->climbing++];
  const double period = s->line < SIZE_MAX ? s->setup.period[s->line] : 0;
  memcpy(c->at, &s->points[point * s->setup.axes], s->setup.axes * sizeof *c->at);
  c->value = s->value[point];
  c->step[0] = c->step[1] = (period > 0 ? fmin(s->spacing, period / 2) : s->spacing) / 2;
  c->stride = period > 0 ? (size_t)fmax(1, round(1 / period / 8)) : 0;
}

typedef struct ranked {
  double value;
  size_t point;
} ranked;

static int compare_ranked(const void *a, const void *b) {
  const ranked *x = a, *y = b;
  if (x->value != y->value) return x->value < y->value ? -1 : 1;
  return x->point < y->point ? -1 : 1;
}

/* True if point k of the order is near to no climb and, for a valley, near to none of the better
 * points before it. */
static bool is_apart(const vs_search *s, const ranked *order, size_t k, bool valley) {
  const double reach = 1.5 * s->spacing, *x = &s->points[order[k].point * s->setup.axes];
  for (size_t c = 0; c < s->climbing; c++)
    if (distance_of(s, x, s->climbs[c].at) <= reach) return false;
  for (size_t i = 0; i < k && valley; i++)
    if (distance_of(s, x, &s->points[order[i].point * s->setup.axes]) <= reach) return false;
  return true;
}

/* Begins a climb at the best point that has no better one near it and is near to no climb, and so
 * on. If there are too few of them, points on the slopes follow (multi level single linkage:
 * Rinnooy Kan and Timmer, Mathematical Programming, 1987). */
static void begin_climbs(vs_search *s) {
  const size_t n = s->asked, axes = s->setup.axes;
  size_t combinations = 1, known = 0;
  for (size_t d = 0; d < axes; d++)
    if (s->setup.levels[d] && combinations < n) combinations *= (size_t)s->setup.levels[d];
  s->spacing = pow(fmin(0.5, (double)combinations / (double)n), 1 / fmax(1, (double)s->continua));
  ranked *order = vs_alloc(n, sizeof *order);
  for (size_t k = 0; k < n; k++)
    if (!isnan(s->value[k])) order[known++] = (ranked){s->value[k], k};
  qsort(order, known, sizeof *order, compare_ranked);
  const size_t before = s->climbing;
  for (int pass = 0; pass < 2; pass++)
    for (size_t k = 0; k < known && s->climbing < before + s->setup.restarts; k++)
      if (is_apart(s, order, k, !pass)) begin_climb(s, order[k].point);
  free(order);
  s->phase = s->climbing ? RESTARTS : OVER;
  s->racing = 2 * (s->climbing - before);
  s->part = (double)(s->setup.most - n) / ceil(1 + log2(fmax(1, (double)s->racing / 2)));
}

/* Gives the next part to the better half of those that shared the last one. */
static void begin_part(vs_search *s) {
  size_t left = 0;
  s->racing = s->racing > 2 ? (s->racing + 1) / 2 : 1;
  for (size_t k = 0; k < s->climbing; k++) {
    size_t better = 0;
    climb *c = &s->climbs[k];
    for (size_t j = 0; j < s->climbing; j++)
      better += !s->climbs[j].over && (is_better(s->climbs[j].value, c->value) ||
                                       (s->climbs[j].value == c->value && j < k));
    if (c->over || better >= s->racing) continue;
    c->may = (double)c->used + fmax(1, s->part / (double)s->racing);
    left++;
  }
  if (left) return;
  s->phase = ++s->round < ROUNDS && s->asked < s->setup.most ? START : OVER;
}

/* Adds a point that a climb looks at. One that is known is not run again. */
static void look_at(vs_search *s, climb *c, double *x, int side) {
  const size_t before = s->count;
  add_new(s, x);
  c->used += s->count - before;
  c->side[c->polls] = side;
  c->polled[c->polls++] = find_point(s, x);
}

static void look_along(vs_search *s, climb *c, size_t d, double by, int side) {
  double x[VS_SEARCH_AXES];
  memcpy(x, c->at, sizeof x);
  x[d] += by;
  if (side < 0 && !(x[d] >= 0 && x[d] <= 1)) return;
  look_at(s, c, x, side);
}

/* Looks one step away on both sides, and at the same place in other periods. */
static void look_at_sides(vs_search *s, climb *c) {
  const size_t d = s->line;
  for (int side = 0; side < 2; side++) {
    if (c->step[side] >= finest_of_axis(s, d))
      look_along(s, c, d, side ? c->step[1] : -c->step[0], side);
    if (c->stride)
      look_along(s, c, d, (side ? 1 : -1) * (double)c->stride * s->setup.period[d], -1);
  }
}

/* Returns the largest change of an axis; it shrinks as long as none is found that is better. */
static double largest_change(const vs_search *s, const climb *c) {
  return LARGEST_CHANGE * s->spacing * exp(-(double)c->failed / PATIENCE);
}

/* Returns a change of an axis: as likely between 1e-3 and 1e-2 of it as between 1e-2 and 1e-1
 * (Muehlenbein and Schlierkamp-Voosen, Evolutionary Computation, 1993), and for half of
 * the changes by some of its periods besides, if it has any. */
static double change_of_axis(const vs_search *s, const climb *c, size_t d, uint64_t id) {
  double u[4];
  const double period = s->setup.period[d];
  for (size_t k = 0; k < 4; k++)
    u[k] = vs_random_uniform(s->setup.seed, id, SALT_CHANGE + 8 * (uint64_t)d + k);
  const double largest = fmin(largest_change(s, c), period > 0 ? period / 2 : 1);
  const double least = fmin(finest_of_axis(s, d), largest);
  double by = least * pow(largest / least, u[0]);
  if (u[1] < 0.5) by = -by;
  if (period > 0 && u[2] < 0.5)
    by += (u[2] < 0.25 ? period : -period) * round(pow(0.25 / period, u[3]));
  return by;
}

/* Looks at places in which about half of the axes that are continua have changed. */
static void look_at_changes(vs_search *s, climb *c) {
  for (int k = 0; k < CHANGES; k++) {
    double x[VS_SEARCH_AXES];
    const uint64_t id = ((uint64_t)(c - s->climbs) << 32) + c->tries * CHANGES + (uint64_t)k;
    const size_t always =
        (size_t)(vs_random_bits(s->setup.seed, id, SALT_CHANGE - 1) >> 8) % s->setup.axes;
    memcpy(x, c->at, sizeof x);
    if (!k && c->coming) {
      for (size_t d = 0; d < s->setup.axes; d++) x[d] += c->came[d];
      look_at(s, c, x, -1);
      continue;
    }
    for (size_t d = 0; d < s->setup.axes; d++)
      if (!s->setup.levels[d] &&
          (d == always ||
           vs_random_uniform(s->setup.seed, id, SALT_CHANGE + 8 * (uint64_t)d + 4) < 0.5))
        x[d] += change_of_axis(s, c, d, id);
    look_at(s, c, x, -1);
  }
}

/* Asks for the points about a climb. Of levels it looks at all if they are few, which may be words,
 * else at the next ones. */
static void ask_climb(vs_search *s, climb *c) {
  c->polls = 0;
  c->looking = true;
  if (s->line < SIZE_MAX)
    look_at_sides(s, c);
  else if (s->continua)
    look_at_changes(s, c);
  if (c->tries++ % LEVELS_EVERY && s->continua) return;
  for (size_t d = 0; d < s->setup.axes; d++) {
    const int levels = s->setup.levels[d];
    for (int k = 0; k < levels; k++) {
      const double by = (k + 0.5) / levels - c->at[d];
      if (levels <= FEW_LEVELS || fabs(by) < 1.5 / levels) look_along(s, c, d, by, -1);
    }
  }
}

static void ask_climbs(vs_search *s) {
  bool asked = false;
  for (size_t k = 0; k < s->climbing; k++) {
    climb *c = &s->climbs[k];
    if (c->over || (double)c->used >= c->may) continue;
    ask_climb(s, c);
    asked = true;
  }
  if (!asked) begin_part(s);
}

/* Halves the steps of a climb that found nothing better. Once they are the finest, it looks at the
 * same place of the next periods, which may be better now that the place is exact. */
static void shorten_steps(const vs_search *s, climb *c) {
  c->failed++;
  c->over = true;
  if (s->line == SIZE_MAX) {
    c->over = !s->continua || largest_change(s, c) < s->setup.finest;
    return;
  }
  for (int side = 0; side < 2; side++) {
    if (c->step[side] >= finest_of_axis(s, s->line)) c->step[side] /= 2;
    c->over &= c->step[side] < finest_of_axis(s, s->line);
  }
  c->stride /= 2;
  c->over &= !c->stride;
  if (!c->over || !c->moved || !(s->setup.period[s->line] > 0)) return;
  c->moved = false;
  c->stride = 2;
  c->over = false;
}

static void move_climb(vs_search *s, climb *c) {
  size_t best = SIZE_MAX;
  double value = c->value;
  if (!c->looking) return;
  c->looking = false;
  for (size_t k = 0; k < c->polls; k++)
    if (c->polled[k] < s->asked + s->count && is_better(s->value[c->polled[k]], value)) {
      best = k;
      value = s->value[c->polled[k]];
    }
  c->coming = best != SIZE_MAX;
  if (best == SIZE_MAX) {
    shorten_steps(s, c);
    return;
  }
  for (size_t d = 0; d < s->setup.axes; d++) {
    const double to = s->points[c->polled[best] * s->setup.axes + d];
    c->came[d] = to - c->at[d];
    c->at[d] = to;
  }
  c->value = value;
  c->moved = true;
  c->failed = 0;
  const int side = c->side[best];
  if (s->line == SIZE_MAX) return;
  if (side >= 0)
    c->step[1 - side] = c->step[side]; /* back there it is known */
  else /* in another period, or at another level, its place is not known so well */
    for (int k = 0; k < 2; k++)
      c->step[k] = fmax(
          c->step[k], (s->setup.period[s->line] > 0 ? s->setup.period[s->line] : s->spacing) / 32);
}

/* Ends a climb that has come to where a better one is: from there both would do the same. */
static void end_joined(vs_search *s) {
  for (size_t k = 0; k < s->climbing; k++)
    for (size_t j = 0; j < s->climbing && !s->climbs[k].over; j++) {
      climb *c = &s->climbs[k];
      const climb *other = &s->climbs[j];
      if (k == j || c->value < other->value || (c->value == other->value && k < j) ||
          distance_of(s, c->at, other->at) > s->spacing / 4)
        continue;
      c->over = true;
      c->joined = j + 1;
    }
}

const double *vs_search_ask(vs_search *s, size_t *count) {
  while (!s->count && s->phase == RESTARTS) {
    ask_climbs(s);
    for (size_t k = 0; k < s->climbing && !s->count; k++) move_climb(s, &s->climbs[k]);
  }
  if (!s->count && s->phase == START) ask_start(s);
  if (!s->count && s->phase == EVOLUTION)
    for (size_t k = 0; k < s->population; k++) breed_mutant(s, k, add_point_of_search(s));
  while (!s->count && s->phase == PATTERN) {
    ask_pattern(s);
    if (!s->count) move_search(s); /* all points about it are known, so the step is halved */
  }
  size_t left = s->setup.most - s->asked;
  if (s->count > left) s->count = left;
  if (!s->count) s->phase = OVER;
  *count = s->count;
  return point_of_search(s, 0);
}

void vs_search_tell(vs_search *s, const double *values) {
  assert(s->count);
  for (size_t k = 0; k < s->count; k++)
    if (is_better(values[k], s->best_value)) {
      memcpy(s->best, point_of_search(s, k), s->setup.axes * sizeof *s->best);
      s->best_value = values[k];
    }
  s->generation++;
  if (s->value) memcpy(&s->value[s->asked], values, s->count * sizeof *values);
  if (s->phase == RESTARTS) {
    for (size_t k = 0; k < s->climbing; k++) move_climb(s, &s->climbs[k]);
    end_joined(s);
    s->asked += s->count;
    s->count = 0;
    return;
  }
  if (s->phase == START && s->setup.restarts) {
    s->asked += s->count;
    s->count = 0;
    begin_climbs(s);
    return;
  }
  if (s->phase == START) {
    settle_population(s, values);
    s->phase = EVOLUTION;
  } else if (s->phase == EVOLUTION)
    select_children(s, values);
  else
    move_search(s);
  s->asked += s->count;
  s->count = 0;
  if (s->phase == EVOLUTION &&
      ((double)(s->asked + s->population) > GLOBAL_PART * (double)s->setup.most ||
       s->population < 4 || extent_of_population(s) < 4 * s->setup.finest))
    begin_pattern(s);
  if (isnan(s->best_value) && s->phase == PATTERN)
    s->phase = OVER; /* no point has a value, so there is nowhere to begin */
}

const double *vs_search_best(const vs_search *s, double *value) {
  *value = s->best_value;
  return s->best;
}

size_t vs_search_restarts(const vs_search *s) {
  return s->climbing;
}

size_t vs_search_agree(const vs_search *s, size_t *near) {
  size_t place = 0;
  *near = 0;
  for (size_t k = 0; k < s->climbing; k++) {
    const climb *c = &s->climbs[k];
    while (c->joined) c = &s->climbs[c->joined - 1];
    *near += c->value - s->best_value <= VS_SEARCH_AGREE * fabs(s->best_value);
    place += distance_of(s, c->at, s->best) <= VS_SEARCH_AGREE;
  }
  return place;
}

const char *vs_search_phase(const vs_search *s) {
  static const char *const NAMES[] = {"start", "evolution", "pattern", "restarts", "over"};
  return NAMES[s->phase];
}

vs_search *vs_search_new(const vs_search_setup *setup) {
  assert(setup->axes && setup->axes <= VS_SEARCH_AXES && setup->most);
  vs_search *s = vs_alloc(1, sizeof *s);
  s->setup = *setup;
  s->best_value = s->center_value = NAN;
  s->population = PER_AXIS * setup->axes;
  if (s->population < FEWEST) s->population = FEWEST;
  if (s->population > MOST) s->population = MOST;
  s->member = vs_alloc(s->population * setup->axes, sizeof *s->member);
  s->fitness = vs_alloc(s->population, sizeof *s->fitness);
  size_t room = setup->most + s->population + 2 * setup->axes +
                3; /* the last generation is cut to what may still be asked for */
  if (setup->restarts) {
    s->line = SIZE_MAX;
    for (size_t d = 0; d < setup->axes; d++)
      if (!setup->levels[d] && ++s->continua == 1) s->line = d;
    if (s->continua > 1) s->line = SIZE_MAX;
    for (size_t d = setup->axes; d-- && strata_axes(&s->setup) > VS_SOBOL_AXES;)
      s->setup.period[d] = 0;
    room += ROUNDS * setup->restarts * (CHANGES + 4 + (FEW_LEVELS + 1) * setup->axes);
    s->value = vs_alloc(room, sizeof *s->value);
    s->climbs = vs_alloc(ROUNDS * setup->restarts, sizeof *s->climbs);
  }
  s->points = vs_alloc(room * setup->axes, sizeof *s->points);
  return s;
}

void vs_search_free(vs_search *s) {
  if (!s) return;
  free(s->member);
  free(s->fitness);
  free(s->points);
  free(s->value);
  free(s->climbs);
  free(s);
}
