/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "method/search.h"

#include <assert.h>
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
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
static const double START_PART = 0.25, GLOBAL_PART = 0.7, CROSSOVER[] = {0.9, 0.3},
                    TO_BEST[] = {0.7, 0, 0},
                    FIRST_STEP = 0.1, /* the pattern's step; it grows where it found something */
    GROW = 2;

typedef enum phase { START, EVOLUTION, PATTERN, OVER } phase;

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

static size_t start_count(const vs_search *s) {
  size_t n = (size_t)(START_PART * (double)s->setup.most), most = START_PER_AXIS * s->setup.axes;
  if (n > most) n = most;
  if (n < 2 * s->population) n = 2 * s->population;
  return n < s->setup.most ? n : s->setup.most;
}

static void ask_start(vs_search *s) {
  const size_t n = start_count(s);
  vs_sobol *sobol = vs_alloc(1, sizeof *sobol);
  vs_random_sobol_begin(sobol, s->setup.axes, n, s->setup.seed);
  for (size_t i = 0; i < n; i++) {
    double *x = add_point_of_search(s);
    for (size_t d = 0; d < s->setup.axes; d++) x[d] = vs_random_sobol_at(sobol, i, d);
    snap_to_levels(&s->setup, x);
  }
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

/* Adds the point unless it was asked for before, as no such point is better than the centre. */
static void add_new(vs_search *s, double *x) {
  const size_t bytes = s->setup.axes * sizeof *x;
  snap_to_levels(&s->setup, x);
  for (size_t k = 0; k < s->asked + s->count; k++)
    if (!memcmp(x, &s->points[k * s->setup.axes], bytes)) return;
  memcpy(add_point_of_search(s), x, bytes);
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

const double *vs_search_ask(vs_search *s, size_t *count) {
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

const char *vs_search_phase(const vs_search *s) {
  static const char *const NAMES[] = {"start", "evolution", "pattern", "over"};
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
  s->points = vs_alloc(room * setup->axes, sizeof *s->points);
  return s;
}

void vs_search_free(vs_search *s) {
  if (!s) return;
  free(s->member);
  free(s->fitness);
  free(s->points);
  free(s);
}
