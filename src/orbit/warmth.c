/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "warmth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "measure/energy.h"
#include "orbit/shooting.h"

/* The winding counts as burnt from here on, degC: copper's enamel of the highest class, C, bears
 * 240 degC for hours. */
static const double BURNT_DEGC = VS_WINDING_BURNT_DEGC;
static const double SETTLED_K = 1e-3;

typedef struct search {
  vs_scene *calm; /* that of the orbits */
  const vs_winding_values *winding;
  int periods;
} search;

typedef struct loss {
  double copper_w, eddy_w;
} loss;

static vs_status take_energy(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  vs_energy_accept(ctx, step);
  return VS_OK;
}

/* The mean losses on the orbit with a winding of this temperature. */
static vs_status lose(search *s, double t_degc, loss *of, vs_error *err) {
  vs_orbit orbit;
  vs_setup *setup = &s->calm->setup;
  setup->model.coil.resistance_ohm = vs_winding_ohm(s->winding, setup->model.coil.cold_ohm, t_degc);
  vs_status status = vs_shooting_find(s->calm, s->periods, &orbit, err);
  if (status) return status;
  vs_run_values run = setup->run;
  run.until_s = orbit.period_s;
  const vs_setup period = vs_shooting_setup(s->calm, &run, &orbit);
  const vs_frame frame = vs_sim_frame(s->calm->tier, &period);
  vs_energy *energy = vs_alloc(1, sizeof *energy);
  energy->frame = &frame;
  const vs_observer observer = {energy, take_energy};
  status = vs_sim_run(s->calm->tier, &period, &s->calm->order, &observer, err);
  *of = (loss){energy->joule[VS_E_COPPER] / run.until_s, energy->joule[VS_E_EDDY] / run.until_s};
  free(energy);
  return status;
}

/* The core's temperature where it takes in these losses. */
static double core_of(const vs_winding_values *w, loss of) {
  return w->ambient_degc + w->r_th[1] * (of.copper_w + of.eddy_w);
}

/* By how much warmer the losses at a temperature would keep the winding. */
static vs_status excess(search *s, double t_degc, double *more, loss *of, vs_error *err) {
  vs_status status = lose(s, t_degc, of, err);
  *more = core_of(s->winding, *of) + s->winding->r_th[0] * of->copper_w - t_degc;
  return status;
}

/* ---- how long it takes ---- */

enum { PLACES = 6 };
typedef struct table {
  double from, to;
  loss at[PLACES];
} table;

static loss look_up(const table *t, double t_degc) {
  double x = (t_degc - t->from) / (t->to - t->from) * (PLACES - 1);
  const int k = x < 0 ? 0 : x < PLACES - 2 ? (int)x : PLACES - 2;
  x -= k;
  const loss *a = &t->at[k], *b = a + 1;
  return (loss){a->copper_w + x * (b->copper_w - a->copper_w),
                a->eddy_w + x * (b->eddy_w - a->eddy_w)};
}

/* The time from the scene's own temperature to another; INFINITY: it is not reached; NaN: the
 * scene does not say what the winding stores. */
static vs_status time_to(search *s, double t_degc, double *lasts_s, vs_error *err) {
  enum { MOST_STEPS = 2000000 };
  const vs_winding_values *w = s->winding;
  table t = {w->temperature_degc, t_degc, {{0, 0}}};
  *lasts_s = NAN;
  if (!(w->c_th[0] > 0) || !(t_degc > w->temperature_degc)) return VS_OK;
  vs_status status = VS_OK;
  for (int k = 0; k < PLACES && !status; k++)
    status = lose(s, t.from + k * (t.to - t.from) / (PLACES - 1), &t.at[k], err);
  vs_winding_state state = vs_winding_begin(w);
  const double step_s = vs_winding_fastest(w) / 50;
  *lasts_s = INFINITY;
  for (long n = 0; n < MOST_STEPS && !status; n++) {
    const loss of = look_up(&t, state.winding_degc);
    vs_winding_go(w, of.copper_w, of.eddy_w, step_s, &state);
    if (state.winding_degc < t_degc) continue;
    *lasts_s = (double)(n + 1) * step_s;
    break;
  }
  return status;
}

/* ---- all of it ---- */

static vs_status refuse_runaway(search *s, double t_degc, loss of, vs_error *err) {
  double lasts_s;
  char when[96] = "";
  vs_status status = time_to(s, t_degc, &lasts_s, err);
  if (status) return status;
  if (isfinite(lasts_s)) snprintf(when, sizeof when, ", where it is after %.3g s", lasts_s);
  return vs_fail(err, VS_RUN,
                 "the winding runs away: at %.4g degC%s, the orbit heats it by %.4g W, and no "
                 "temperature below that keeps itself; look at actuator.winding, or drive less",
                 t_degc, when, of.copper_w);
}

/* Steps of the excess itself lead above the least such temperature, or beyond all; between two
 * temperatures the secant's rule goes on, halved where it would leave them. */
static vs_status find_temperature(search *s, double *t_degc, loss *of, vs_error *err) {
  double lo = s->winding->ambient_degc, hi = lo, more_lo, more_hi;
  vs_status status = excess(s, lo, &more_lo, of, err);
  for (more_hi = more_lo; !status && more_hi > 0;) {
    lo = hi;
    more_lo = more_hi;
    hi += more_hi + SETTLED_K;
    if (hi > BURNT_DEGC) hi = BURNT_DEGC;
    status = excess(s, hi, &more_hi, of, err);
    if (!status && hi >= BURNT_DEGC && more_hi > 0) return refuse_runaway(s, hi, *of, err);
  }
  for (int n = 0; n < 50 && !status && hi - lo > SETTLED_K; n++) {
    double at = lo + (hi - lo) * more_lo / (more_lo - more_hi), more;
    const double edge = 0.3 * SETTLED_K;
    at = fmin(fmax(at, lo + edge), hi - edge);
    if (n % 4 == 3) at = (lo + hi) / 2;
    status = excess(s, at, &more, of, err);
    if (more > 0)
      lo = at, more_lo = more;
    else
      hi = at, more_hi = more;
  }
  *t_degc = lo;
  return status;
}

/* The upper end of the scene's rating of coil.t_max. */
static double most_degc(const vs_scene *scene) {
  for (int k = 0; k < scene->ratings.count; k++)
    if (!strcmp(scene->ratings.item[k].name, "coil.t_max"))
      return scene->ratings.item[k].rating.max;
  return INFINITY;
}

static vs_status warn_of_limit(search *s, vs_scene *scene, double t_degc, vs_error *err) {
  const double most = most_degc(scene);
  double lasts_s;
  if (t_degc <= most) return VS_OK;
  vs_status status = time_to(s, most, &lasts_s, err);
  if (!status && isfinite(lasts_s))
    vs_fail(vs_warnings_add(&scene->warnings), VS_OK,
            "the winding, %.4g degC warm at first, is at %.4g degC after %.3g s, and at %.4g degC "
            "in the end",
            scene->setup.model.actuator.winding.temperature_degc, most, lasts_s, t_degc);
  return status;
}

vs_status vs_warmth_settle(vs_scene *scene, vs_scene *calm, int periods, vs_error *err) {
  const vs_winding_values *w = &scene->setup.model.actuator.winding;
  if (!w->present || w->r_th[0] + w->r_th[1] == 0) return VS_OK;
  search s = {calm, w, periods};
  double t_degc = NAN;
  loss of = {0, 0};
  s.calm->tier = vs_tiers_of_orbit(scene->tier);
  s.calm->order.raw = NULL;
  s.calm->order.fork = NULL;
  s.calm->frame = vs_sim_frame(s.calm->tier, &s.calm->setup);
  vs_status status = vs_shooting_check(s.calm, periods, err);
  if (!status) status = find_temperature(&s, &t_degc, &of, err);
  if (!status) status = warn_of_limit(&s, scene, t_degc, err);
  if (!status) {
    vs_coil *coil = &scene->setup.model.coil;
    coil->resistance_ohm = vs_winding_ohm(w, coil->cold_ohm, t_degc);
    coil->heat = (vs_winding_state){t_degc, core_of(w, of), true};
  }
  return status;
}
