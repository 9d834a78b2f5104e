/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fraction.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/tiers.h"
#include "measure/throw.h"
#include "orbit/picard.h"
#include "orbit/shooting.h"
#include "plant/build.h"
#include "run/session.h"

enum { MOST_TRIALS = 40 };
/* The share is found where the orbit's own differs by less: far below what an empirical number
 * means, and far above the rounding of an orbit. */
static const double SAME = 1e-11;
/* On a tier with a circuit the share is to be known as well as the run, whose orbits, and K with
 * them, are known to run.tolerance. */
static double tolerance_of_share(const vs_scene *scene) {
  return scene->tier->has_circuit ? fmax(SAME, scene->setup.run.tolerance) : SAME;
}

/* The budget, in cycles of the mains. On the decks that come with the program a search that goes
 * well takes 5 to 270 of them in the circuit, half of the searches less than 30; at 10 to 70 ms a
 * cycle all of it is 3 to 20 s of one core. An orbit on an ideal tier takes 105 firing periods
 * where nothing is in the way, and up to 5000 where a stop is in reach; 1000 cycles take some 40
 * ms. Where the orbit's period is long there is at least so much for each cycle in it. */
enum { MOST_IDEAL = 60000, MOST_CIRCUIT = 300, FOR_EACH_IDEAL = 12000, FOR_EACH_CIRCUIT = 60 };

typedef struct search {
  vs_scene *scene; /* without events, on a tier that knows orbits; it borrows what the caller's owns
                    */
  int periods;
  vs_orbit orbit; /* of the last trial, on an ideal tier */
  bool has_orbit;
  vs_picard_past past; /* of the last trial, with a circuit */
  bool has_past;
  double coefficient; /* K on it */
  double slope;    /* by how much more is asked for where the share is one more; NaN: not known */
  int trials;      /* so far, */
  double at, more; /* the last one that came to its end; NaN: none did */
  double lower, upper; /* the share lies between them */
  vs_budget *budget;   /* of the whole search */
} search;

/* ---- a trial ---- */

static vs_status accept_step_of_fraction(void *ctx, const vs_step *step, const vs_result *result,
                                         vs_error *err) {
  (void)result;
  (void)err;
  vs_throw_accept(ctx, step);
  return VS_OK;
}

/* Runs a period of the orbit, for K. With a circuit, `pilot` finds the orbit before; else it is
 * NULL. */
static vs_status measure_throw(search *s, const vs_orbit *orbit, vs_orbit_search *pilot,
                               vs_error *err) {
  vs_throw thrown = {0};
  const vs_session_listener guest = {.ctx = &thrown, .accept = accept_step_of_fraction};
  const vs_session session = {
      .guest = &guest, .bare = true, .unguarded = !pilot, .stop = s->scene->order.stop};
  vs_scene *along = vs_alloc(1, sizeof *along);
  vs_result *none = vs_alloc(1, sizeof *none);
  vs_run_values run = s->scene->setup.run;
  run.until_s = orbit->period_s;
  if (!pilot) run.tolerance = s->scene->tier->finest;
  *along = *s->scene;
  along->order.pilot = pilot;
  along->setup = vs_shooting_setup(s->scene, &run, orbit);
  along->frame = vs_sim_frame(along->tier, &along->setup);
  vs_status status = vs_session_run(&session, along, none, err);
  s->coefficient = vs_throw_coefficient(&thrown).value;
  free(none);
  free(along);
  return status;
}

/* Finds the orbit, from the last one on where there is one, and from the scene's start where that
 * leads to none; then K. */
static vs_status follow_ideal(search *s, vs_error *err) {
  const vs_orbit last = s->orbit;
  const vs_shooting near = {.periods = s->periods, .from = last.x}, anew = {.periods = s->periods};
  vs_error none = {0};
  vs_status status = s->has_orbit ? vs_shooting_seek(s->scene, &near, &s->orbit, &none) : VS_RUN;
  if (status) status = vs_shooting_seek(s->scene, &anew, &s->orbit, err);
  return status ? status : measure_throw(s, &s->orbit, NULL, err);
}

/* With a circuit the run finds the orbit itself, while it settles. */
static vs_status follow_circuit(search *s, vs_error *err) {
  vs_picard *picard;
  vs_status status = vs_picard_new(s->scene, s->periods, false, &picard, err);
  if (status) return status;
  if (s->has_past) vs_picard_begin_near(picard, &s->past);
  status = measure_throw(s, &picard->orbit, &picard->pilot, err);
  s->has_past = !status;
  if (s->has_past) s->past = vs_picard_over(picard);
  vs_picard_free(picard);
  return status;
}

/* Finds the orbit with this share, and by how much the share that follows from it is more. */
static vs_status try_share(search *s, double share, double *more, vs_error *err) {
  vs_setup *setup = &s->scene->setup;
  const vs_load_values load = setup->model.load;
  vs_error why = {0};
  vs_status status =
      vs_build_loaded(setup->machine, &setup->model, &load, share, &setup->model, &why);
  if (!status)
    status = s->scene->tier->has_circuit ? follow_circuit(s, &why) : follow_ideal(s, &why);
  s->has_orbit = !status;
  *more = vs_model_fraction(s->coefficient) - share;
  if (!status) {
    s->at = share;
    s->more = *more;
    return VS_OK;
  }
  vs_fail(err, status, "load.fraction: auto: with %.9g of the material riding: %s", share,
          why.text);
  err->gave_up = why.gave_up;
  return status;
}

/* ---- the search ---- */

/* A slope is known from trials that are at least so far apart, and so many times as far as the
 * share is known to. */
static const double TELLS = 1e-7, TELLS_BY = 10;

/* With a circuit the first trials have this run.tolerance, where the scene's is less. */
static const double LOOSE = 1e-4;

/* The share is known well enough for a loose tolerance: the trials that follow have the scene's.
 * What was known to hold the share is known to that only. */
static void tighten_tolerance(search *s, double tolerance) {
  double same = TELLS_BY * tolerance_of_share(s->scene);
  s->scene->setup.run.tolerance = tolerance;
  s->lower = fmax(vs_model_load_range.least, s->lower - same);
  s->upper = fmin(vs_model_load_range.most, s->upper + same);
}

static double least_change_that_tells(const search *s) {
  return s->scene->tier->has_circuit ? fmax(TELLS, TELLS_BY * tolerance_of_share(s->scene)) : TELLS;
}

/* Looks for a share from `at` on. Where no slope is known the first step goes to the share that
 * this one's orbit asks for, the others by the secant through the last two trials; where that leads
 * out of what is known to hold a share, it is again the share asked for, or the middle. */
static vs_status find_riding_share(search *s, double at, double *share, vs_error *err) {
  vs_run_values *run = &s->scene->setup.run;
  const double tolerance = run->tolerance;
  double more, before = NAN, more_before = NAN;
  if (s->scene->tier->has_circuit) run->tolerance = fmax(tolerance, LOOSE);
  s->has_orbit = false;
  s->at = NAN;
  s->lower = vs_model_load_range.least;
  s->upper = vs_model_load_range.most;
  for (int k = 0; k < MOST_TRIALS; k++) {
    snprintf(s->budget->stage, sizeof s->budget->stage, "trial %d, with %.6g", ++s->trials, at);
    vs_status status = try_share(s, at, &more, err);
    const bool is_loose = run->tolerance > tolerance;
    const bool is_near = !status && fabs(more) < tolerance_of_share(s->scene);
    *share = at;
    if (status || (is_near && !is_loose)) {
      run->tolerance = tolerance;
      return status;
    }
    if (more > 0)
      s->lower = at;
    else
      s->upper = at;
    if (fabs(at - before) > least_change_that_tells(s))
      s->slope = (more - more_before) / (at - before);
    if (is_near) tighten_tolerance(s, tolerance);
    double next = at - more / (isnan(s->slope) ? -1 : s->slope);
    if (is_near && !(next >= s->lower && next <= s->upper)) next = at;
    if (is_near && next == at) { /* the same share, looked at more closely */
      before = NAN;
      continue;
    }
    if (!(next >= s->lower && next <= s->upper && next != at)) next = at + more;
    before = at;
    more_before = more;
    at = next >= s->lower && next <= s->upper ? next : (s->lower + s->upper) / 2;
  }
  run->tolerance = tolerance;
  return vs_fail(err, VS_RUN,
                 "load.fraction: auto: no share is found that its own orbit asks for; it lies "
                 "between %.9g and %.9g, where %.9g asks for %.9g",
                 s->lower, s->upper, before, before + more_before);
}

/* Shares that differ by more than this are two, and by more than so many times what each is known
 * to. */
static const double APART = 1e-6, APART_BY = 30;

static bool is_out(const search *s) {
  return s->budget->out[s->scene->tier->has_circuit ? VS_BUDGET_CIRCUIT : VS_BUDGET_IDEAL];
}

/* A share that was found. */
typedef struct found {
  double share, coefficient;
  double other;  /* NaN: there is none */
  bool is_alone; /* the search for another one came to its end */
  bool on_ideal; /* another one was looked for on an ideal tier, and not with the circuit */
} found;

/* From `from` on, and for another one from `from_other` on. */
static vs_status find_both(search *s, double from, double from_other, found *f, vs_error *err) {
  vs_error none = {0};
  const double slope = s->slope;
  vs_status status = find_riding_share(s, from, &f->share, err);
  f->coefficient = s->coefficient;
  f->other = NAN;
  f->is_alone = true;
  if (status || isnan(from_other)) return status;
  double apart = fmax(APART, APART_BY * tolerance_of_share(s->scene)), other;
  s->slope = slope;
  status = find_riding_share(s, from_other, &other, &none);
  if (!status && fabs(other - f->share) >= apart) f->other = other;
  f->is_alone = !is_out(s);
  return status == VS_SIGNAL ? vs_fail(err, status, "%s", none.text) : VS_OK;
}

/* ---- where the search begins ---- */

static void free_ideal(search *ideal) {
  free(ideal->scene);
  free(ideal);
}

/* Makes the search on an ideal tier that guides one with a circuit. */
static search *on_ideal_tier(const search *s) {
  search *ideal = vs_alloc(1, sizeof *ideal);
  *ideal = *s;
  ideal->scene = vs_alloc(1, sizeof *ideal->scene);
  *ideal->scene = *s->scene;
  ideal->scene->tier = vs_tiers_automatic(false);
  ideal->scene->frame = vs_sim_frame(ideal->scene->tier, &ideal->scene->setup);
  return ideal;
}

/* With a circuit a trial takes a second and more, on an ideal tier some milliseconds. So the search
 * begins at the shares that the ideal tier's orbits ask for. Where these are one, one is looked
 * for. Where there are no such orbits, it begins at the ends of the range. */
static vs_status find_guided(search *s, found *f, vs_error *err) {
  vs_error none = {0};
  found guess = {0};
  double from = vs_model_load_range.least, from_other = vs_model_load_range.most;
  if (!s->scene->tier->has_circuit) return find_both(s, from, from_other, f, err);
  search *ideal = on_ideal_tier(s);
  vs_status status = find_both(ideal, from, from_other, &guess, &none);
  if (!status) {
    from = guess.share;
    from_other = guess.other;
    if (isnan(guess.other)) s->slope = ideal->slope;
    f->on_ideal = isnan(guess.other);
  }
  free_ideal(ideal);
  return status == VS_SIGNAL ? vs_fail(err, status, "%s", none.text)
                             : find_both(s, from, from_other, f, err);
}

static vs_scene *undisturbed(const vs_scene *scene) {
  vs_scene *calm = vs_alloc(1, sizeof *calm);
  vs_setup *setup = &calm->setup;
  *calm = *scene;
  setup->timeline.events.count = 0;
  setup->loads = (vs_loads){0};
  setup->model.reloaded = setup->steady = setup->wants_fraction = false;
  calm->tier = vs_tiers_of_orbit(scene->tier);
  calm->order.raw = NULL;
  calm->order.fork = NULL;
  calm->frame = vs_sim_frame(calm->tier, setup);
  return calm;
}

/* The budget is spent before a share is found: says how far the search came. */
static vs_status refuse_spent_search_of_share(const search *s, vs_error *err) {
  const vs_budget *b = s->budget;
  char last[128] = "none has come to its end";
  if (!isnan(s->at))
    snprintf(last, sizeof last, "the last that came to its end was %.6g, which asks for %.6g",
             s->at, s->at + s->more);
  return vs_fail(err, VS_BUDGET,
                 "load.fraction: auto: no share is found within the search's budget of %ld cycles "
                 "of the mains in the circuit and %ld on the ideal tiers; %d %s tried, and "
                 "the one looked for lies between %.6g and %.6g: %s; write load.fraction as a "
                 "number between these, or keep the armature off its stop by %s",
                 b->most[VS_BUDGET_CIRCUIT], b->most[VS_BUDGET_IDEAL], s->trials,
                 s->trials == 1 ? "share was" : "shares were", s->lower, s->upper, last,
                 vs_shooting_weakens(s->scene));
}

static void warn_of_another(vs_scene *scene, const search *s) {
  vs_fail(vs_warnings_add(&scene->warnings), VS_OK,
          "load.fraction: auto: whether another share asks for itself, too, is not known: the "
          "search's budget of %ld cycles of the mains in the circuit and %ld on the ideal tiers "
          "was spent before",
          s->budget->most[VS_BUDGET_CIRCUIT], s->budget->most[VS_BUDGET_IDEAL]);
}

static long larger(long a, long b) {
  return a > b ? a : b;
}

static vs_budget budget_of(const vs_scene *scene, int periods) {
  const vs_firing_values *firing = &scene->setup.timeline.firing;
  long cycles = (long)periods * (firing->every > 1 ? firing->every : 1);
  return (vs_budget){.what = "load.fraction: auto",
                     .of = scene->order.budget,
                     .most = {larger(MOST_IDEAL, FOR_EACH_IDEAL * cycles),
                              larger(MOST_CIRCUIT, FOR_EACH_CIRCUIT * cycles)},
                     .shows = scene->order.shows && !scene->order.budget};
}

vs_status vs_fraction_settle(vs_scene *scene, int periods, vs_error *err) {
  vs_setup *setup = &scene->setup;
  if (!setup->wants_fraction) return VS_OK;
  vs_budget budget = budget_of(scene, periods);
  search *s = vs_alloc(1, sizeof *s);
  found f = {NAN, NAN, NAN, true, false};
  s->scene = undisturbed(scene);
  s->scene->order.budget = s->budget = &budget;
  s->periods = periods;
  s->slope = NAN;
  vs_status status = find_guided(s, &f, err);
  vs_budget_end(&budget);
  if ((status == VS_RUN || status == VS_BUDGET) && is_out(s))
    status = refuse_spent_search_of_share(s, err);
  if (!status) {
    const vs_load_values load = setup->model.load;
    status = vs_build_loaded(setup->machine, &setup->model, &load, f.share, &setup->model, err);
  }
  if (!status)
    status = vs_setup_make_loads(&setup->timeline.events, setup->machine, &setup->model,
                                 &setup->loads, err);
  if (!status && !f.is_alone) warn_of_another(scene, s);
  setup->throw_coefficient = f.coefficient;
  setup->other_fraction = f.other;
  setup->other_on_ideal = f.on_ideal;
  setup->wants_fraction = status != VS_OK;
  free(s->scene);
  free(s);
  return status;
}
