/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "steady/fraction.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "machine/build.h"
#include "orbit/shooting.h"
#include "period/throw.h"
#include "scene/session.h"
#include "steady/picard.h"
#include "tier/tiers.h"

enum { MOST_TRIALS = 40 };
/* The share is found where the orbit's own differs by less: far below what an empirical number
 * means, and far above the rounding of an orbit. */
static const double SAME = 1e-11;
/* On a tier with a circuit the share is to be known as well as the run, whose orbits, and K with
 * them, are known to run.tolerance. */
static double sameness(const vs_scene *scene) {
  return scene->tier->has_circuit ? fmax(SAME, scene->setup.run.tolerance) : SAME;
}

typedef struct search {
  vs_scene *scene; /* without events, on a tier that knows orbits; it borrows what the caller's owns
                    */
  int periods;
  vs_orbit orbit; /* of the last trial, on an ideal tier */
  bool has_orbit;
  double coefficient; /* K on it */
} search;

/* ---- a trial ---- */

static vs_status accept(void *ctx, const vs_step *step, const vs_result *result, vs_error *err) {
  (void)result;
  (void)err;
  vs_throw_accept(ctx, step);
  return VS_OK;
}

/* Runs a period of the orbit, for K. With a circuit, `pilot` finds the orbit before; else it is
 * NULL. */
static vs_status measure(search *s, const vs_orbit *orbit, vs_pilot *pilot, vs_error *err) {
  vs_throw thrown = {0};
  const vs_guest guest = {.ctx = &thrown, .accept = accept};
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
  return status ? status : measure(s, &s->orbit, NULL, err);
}

/* With a circuit the run finds the orbit itself, in its prelude. */
static vs_status follow_circuit(search *s, vs_error *err) {
  vs_picard *picard;
  vs_status status = vs_picard_new(s->scene, s->periods, false, &picard, err);
  if (status) return status;
  status = measure(s, &picard->orbit, &picard->pilot, err);
  vs_picard_free(picard);
  return status;
}

/* Finds the orbit with this share, and by how much the share that follows from it is more. */
static vs_status try(search *s, double share, double *more, vs_error *err) {
  vs_setup *setup = &s->scene->setup;
  const vs_load_values load = setup->model.load;
  vs_error why = {0};
  vs_status status =
      vs_build_loaded(setup->machine, &setup->model, &load, share, &setup->model, &why);
  if (!status)
    status = s->scene->tier->has_circuit ? follow_circuit(s, &why) : follow_ideal(s, &why);
  s->has_orbit = !status;
  *more = vs_model_fraction(s->coefficient) - share;
  if (!status) return VS_OK;
  vs_fail(err, status, "load.fraction: auto: with %.9g of the material riding: %s", share,
          why.text);
  err->gave_up = why.gave_up;
  return status;
}

/* ---- the search ---- */

/* Looks for a share from `at` on. The first step goes to the share that this one's orbit asks for,
 * the others by the secant through the last two trials; where that leads out of what is known to
 * hold a share, it is again the share asked for, or the middle. */
static vs_status find(search *s, double at, double *share, vs_error *err) {
  const double same = sameness(s->scene);
  double lower = vs_model_load_range.least, upper = vs_model_load_range.most;
  double more, before = NAN, more_before = NAN;
  s->has_orbit = false;
  for (int k = 0; k < MOST_TRIALS; k++) {
    vs_status status = try(s, at, &more, err);
    *share = at;
    if (status || fabs(more) < same) return status;
    if (more > 0)
      lower = at;
    else
      upper = at;
    double slope = isnan(before) ? -1 : (more - more_before) / (at - before);
    double next = at - more / slope;
    if (!(next >= lower && next <= upper && next != at)) next = at + more;
    before = at;
    more_before = more;
    at = next >= lower && next <= upper ? next : (lower + upper) / 2;
  }
  return vs_fail(err, VS_RUN,
                 "load.fraction: auto: no share is found that its own orbit asks for; it lies "
                 "between %.9g and %.9g, where %.9g asks for %.9g",
                 lower, upper, before, before + more_before);
}

/* Shares that differ by more than this are two, and by more than so many times what each is known
 * to. */
static const double APART = 1e-6, APART_BY = 30;

/* Finds the share from the lower end of the range on, and looks for another one from the upper end
 * on; NaN: there is none. */
static vs_status find_both(search *s, double *share, double *coefficient, double *other,
                           vs_error *err) {
  vs_error none = {0};
  vs_status status = find(s, vs_model_load_range.least, share, err);
  *coefficient = s->coefficient;
  if (status) return status;
  double apart = fmax(APART, APART_BY * sameness(s->scene));
  bool is_one = find(s, vs_model_load_range.most, other, &none) || fabs(*other - *share) < apart;
  if (is_one) *other = NAN;
  return VS_OK;
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
  calm->order.junction = NULL;
  calm->frame = vs_sim_frame(calm->tier, setup);
  return calm;
}

vs_status vs_fraction_settle(vs_scene *scene, int periods, vs_error *err) {
  vs_setup *setup = &scene->setup;
  double share = NAN, coefficient = NAN, other = NAN;
  if (!setup->wants_fraction) return VS_OK;
  search *s = vs_alloc(1, sizeof *s);
  s->scene = undisturbed(scene);
  s->periods = periods;
  vs_status status = find_both(s, &share, &coefficient, &other, err);
  if (!status) {
    const vs_load_values load = setup->model.load;
    status = vs_build_loaded(setup->machine, &setup->model, &load, share, &setup->model, err);
  }
  if (!status)
    status =
        vs_loads_make(&setup->timeline.events, setup->machine, &setup->model, &setup->loads, err);
  setup->throw_coefficient = coefficient;
  setup->other_fraction = other;
  setup->wants_fraction = status != VS_OK;
  free(s->scene);
  free(s);
  return status;
}
