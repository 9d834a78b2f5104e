/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/steady.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fraction.h"
#include "heat.h"
#include "warmth.h"

/* ---- reactions ----
 * What springs and dampers do along each coordinate, the rows of K q + B q'. Along a coordinate
 * that moves the whole machine against the ground alone this is the force that the mounts carry
 * into the foundation. */

/* A step is at most half a radian of the fastest mode long, so that in one of its PARTS a reaction
 * turns once at most, or of LEAST where it is much shorter. Five points are exact to degree 9 in
 * each of them. */
enum { PARTS = 8, LEAST = 2, POINTS = 5 };
static const double AT[POINTS] = {0.04691007703066800, 0.23076534494715845, 0.5,
                                  0.76923465505284155, 0.95308992296933200};
static const double WEIGHT[POINTS] = {0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                                      0.23931433524968324, 0.11846344252809454};

/* The row i of K a + B b. */
static double reaction_row(const vs_model *m, int i, const double *a, const double *b) {
  double sum = 0;
  for (int j = 0; j < m->dof; j++) sum += m->stiffness[i][j] * a[j] + m->damping[i][j] * b[j];
  return sum;
}

static double reaction_value_at(const vs_step *step, double t_s, int i) {
  double y[VS_CH_MOST];
  vs_step_groups_at(step, t_s, VS_GROUP_VELOCITIES, y);
  return reaction_row(step->frame->model, i, y + VS_CH_Q, y + vs_channel_rates(step->frame->model));
}

static double reaction_rate_at(const vs_step *step, double t_s, int i) {
  const vs_model *m = step->frame->model;
  double y[VS_CH_MOST];
  vs_step_groups_at(step, t_s, VS_GROUP_VELOCITIES | VS_GROUP_ACCELERATIONS, y);
  return reaction_row(m, i, y + vs_channel_rates(m), y + vs_channel_rates2(m));
}

static void keep_largest_reaction(vs_value *peak, double value, double t_s) {
  if (!peak->known || fabs(value) > peak->value) *peak = (vs_value){true, fabs(value), t_s};
}

/* Looks for the largest size between lo and hi: at the end, and where the rate is 0. */
static void follow_reaction(vs_reaction *r, const vs_step *step, int i, double lo, double hi) {
  double before = reaction_rate_at(step, lo, i), end = hi;
  bool turns = before * reaction_rate_at(step, hi, i) < 0;
  for (int n = 0; turns && n < 60; n++) {
    double mid = (lo + hi) / 2;
    if (reaction_rate_at(step, mid, i) * before > 0)
      lo = mid;
    else
      hi = mid;
  }
  if (turns) keep_largest_reaction(&r->peak[i], reaction_value_at(step, hi, i), hi);
  keep_largest_reaction(&r->peak[i], reaction_value_at(step, end, i), end);
}

/* Takes one accepted step. */
static void accept_reactions(vs_reaction *r, const vs_step *step) {
  const int parts = vs_step_parts(step, LEAST, PARTS);
  double from = step->from->t_s, part = (step->to->t_s - from) / parts;
  if (!(part > 0)) return; /* the other side of an instant */
  r->span_s += parts * part;
  for (int i = 0; i < step->frame->model->dof; i++)
    for (int p = 0; p < parts; p++) {
      double lo = from + p * part, hi = p + 1 < parts ? lo + part : step->to->t_s;
      follow_reaction(r, step, i, lo, hi);
      for (int k = 0; k < POINTS; k++) {
        double value = reaction_value_at(step, lo + AT[k] * part, i);
        r->squared[i] += WEIGHT[k] * part * value * value;
      }
    }
}

/* The root mean square along the coordinate i. */
static double reaction_rms(const vs_reaction *r, int i) {
  return sqrt(r->squared[i] / r->span_s);
}

/* ---- the orbit and its period ---- */

vs_setup vs_steady_setup(const vs_scene *scene, const vs_run_values *run, const vs_orbit *orbit) {
  vs_setup setup = vs_shooting_setup(scene, run, orbit);
  vs_firing_values *firing = &setup.timeline.firing;
  double ends_s = firing->angle.first / setup.timeline.omega_rad_s + firing->pulse_width_s;
  if (ends_s < firing->every * setup.timeline.period_s) firing->first_cycle = 1;
  return setup;
}

static void begin_watching(vs_steady *steady, const vs_setup *setup) {
  steady->model = &setup->model;
  const int cycles = (int)round(setup->run.until_s / setup->timeline.period_s);
  vs_spectrum_begin(&steady->spectrum, setup->timeline.omega_rad_s);
  vs_spectrum_begin_groups(&steady->spectrum, 0, cycles, cycles);
}

vs_status vs_steady_check(const vs_scene *scene, int periods, vs_error *err) {
  vs_status status = vs_tiers_require_orbits("steady", scene->tier, scene->why,
                                             vs_tree_place(scene->tree.root, "run.tier"), err);
  return status ? status : vs_shooting_check(scene, periods, err);
}

/* ---- instruments ---- */

/* Meters that go along the orbit. */
typedef struct along {
  vs_meter *meter;
  int count;
} along;

static vs_status accept_along(void *ctx, const vs_step *step, vs_error *err) {
  const along *a = ctx;
  (void)err;
  for (int k = 0; k < a->count; k++) vs_meter_accept(&a->meter[k], step);
  return VS_OK;
}

/* Makes instruments begin as they are on the orbit, of which `setup` is one period. A circuit is
 * not run for that: there measure/meter.h does it, while the run settles. */
static vs_status settle_instruments(const vs_scene *scene, const vs_setup *setup,
                                    vs_instruments *all, vs_error *err) {
  if (scene->tier->has_circuit || !all->count) return VS_OK;
  const along a = {vs_alloc((size_t)all->count, sizeof(vs_meter)), all->count};
  const vs_observer observer = {(void *)(size_t)&a, accept_along};
  const double rest[2] = {0, 0};
  for (int k = 0; k < all->count; k++) {
    all->item[k].on_orbit = true;
    memcpy(all->item[k].x, rest, sizeof rest);
    vs_meter_begin(&a.meter[k], &all->item[k], all->v.seed);
  }
  vs_status status = vs_sim_run(scene->tier, setup, &scene->order, &observer, err);
  for (int k = 0; k < all->count && !status; k++) {
    vs_lowpass_close(&a.meter[k].lowpass, rest, setup->run.until_s);
    memcpy(all->item[k].x, a.meter[k].lowpass.x, sizeof all->item[k].x);
  }
  free(a.meter);
  return status;
}

/* ---- the orbit ---- */

/* Makes the scene the one whose run is a period of the orbit. */
static void put_on_orbit(vs_steady *steady, vs_scene *scene) {
  vs_run_values run = scene->setup.run;
  run.until_s = steady->orbit.period_s;
  scene->setup.steady = false; /* it begins there anyway */
  scene->setup = vs_steady_setup(scene, &run, &steady->orbit);
  scene->setup.means = (vs_span_s){0, run.until_s}; /* `measure` is of the scene's own run */
  scene->setup.at_work = true;
  scene->frame = vs_sim_frame(scene->tier, &scene->setup);
  if (steady->picard) scene->order.pilot = &steady->picard->pilot;
  memset(scene->measured, 0, sizeof scene->measured); /* it was measured in the scene's own run */
}

static vs_status warm_up(vs_scene *scene, int periods, vs_error *err) {
  if (!scene->setup.model.actuator.winding.present) return VS_OK;
  vs_scene *calm = vs_steady_undisturbed(scene);
  vs_status status = vs_warmth_settle(scene, calm, periods, err);
  free(calm);
  return status;
}

vs_status vs_steady_begin(vs_steady *steady, vs_scene *scene, int periods, vs_error *err) {
  *steady = (vs_steady){0};
  vs_status status = vs_tiers_require_orbits("steady", scene->tier, scene->why,
                                             vs_tree_place(scene->tree.root, "run.tier"), err);
  if (!status) status = vs_fraction_settle(scene, periods, err);
  if (!status) status = warm_up(scene, periods, err);
  if (status) return status;
  if (scene->tier->has_circuit)
    status = vs_picard_new(scene, periods, true, &steady->picard, err);
  else
    status = vs_shooting_find(scene, periods, &steady->orbit, err);
  if (status) return status;
  if (steady->picard) steady->orbit = steady->picard->orbit;
  put_on_orbit(steady, scene);
  begin_watching(steady, &scene->setup);
  steady->warnings = &scene->warnings;
  return settle_instruments(scene, &scene->setup, &scene->instruments, err);
}

void vs_steady_follow(vs_steady *steady, const vs_orbit *orbit, const vs_setup *setup) {
  *steady = (vs_steady){.orbit = *orbit};
  steady->orbit.period_s = setup->run.until_s;
  begin_watching(steady, setup);
}

void vs_steady_again(vs_steady *steady, vs_scene *scene) {
  put_on_orbit(steady, scene);
  vs_spectrum_end(&steady->spectrum);
  begin_watching(steady, &scene->setup);
  steady->reaction = (vs_reaction){0};
  steady->thrown = (vs_throw){0};
  if (steady->picard) vs_picard_again(steady->picard);
}

int vs_steady_multipliers(const vs_steady *s) {
  return s->picard ? s->picard->multipliers : s->orbit.count;
}

bool vs_steady_is_judged(const vs_steady *s) {
  if (!s->picard) return true;
  const vs_multiplier *largest = &s->orbit.multiplier[0];
  return s->picard->multipliers && fabs(hypot(largest->re, largest->im) - 1) > s->picard->known_to;
}

void vs_steady_end(vs_steady *steady) {
  vs_picard_free(steady->picard);
  vs_spectrum_end(&steady->spectrum);
}

void vs_steady_accept(vs_steady *steady, const vs_step *step) {
  vs_spectrum_accept(&steady->spectrum, step);
  accept_reactions(&steady->reaction, step);
  vs_throw_accept(&steady->thrown, step);
}

/* Warns where the conveying speed is outside of its formula's range. Without material on the trough
 * it is a number for comparison, and the table's line is enough. */
static void warn_of_speed(const vs_steady *s) {
  const vs_load_values *load = &s->model->load;
  vs_value down = vs_throw_down(&s->thrown);
  if (!s->warnings || load->density_kg_m3 * load->volume_m3 == 0) return;
  if (!vs_throw_speed(&s->thrown).known || down.value <= vs_throw_most) return;
  vs_fail(vs_warnings_add(s->warnings), VS_OK,
          "conveying_speed is outside of its formula's range, throw_down up to %.4g: this is %.4g, "
          "and the material flies for longer than a swing",
          vs_throw_most, down.value);
}

/* Warns where it is not known whether the machine stays on the orbit. */
static void warn_of_stability(const vs_steady *s) {
  const vs_multiplier *largest = &s->orbit.multiplier[0];
  if (!s->warnings || vs_steady_is_judged(s)) return;
  vs_error *warning = vs_warnings_add(s->warnings);
  if (s->picard->multipliers)
    vs_fail(warning, VS_OK,
            "whether the orbit is stable is not known: the size of its largest multiplier is %.6g, "
            "known to about %.1g",
            hypot(largest->re, largest->im), s->picard->known_to);
  else
    vs_fail(warning, VS_OK,
            "whether the orbit is stable is not known: it has no multipliers, as %.200s",
            s->picard->missing);
}

/* A difference of the same energies at both ends. It is known no better than the books of these
 * energies close: what they leave over at most is told as 0. */
static double stored(const vs_energy *e) {
  double gained = e->joule[VS_E_MAGNETIC] + e->joule[VS_E_MECHANICAL], left = 0;
  for (int b = 0; b < VS_BALANCES; b++)
    if (e->balanced[b]) left = fmax(left, fabs(e->furthest_j[b]));
  return fabs(gained) <= left ? 0 : gained;
}

void vs_steady_finish(vs_steady *steady, const vs_result *r) {
  const double *joule = r->watchers.energy.joule;
  if (steady->picard) steady->orbit = steady->picard->orbit;
  if (steady->thrown.model) steady->thrown.model = steady->model; /* a tier's own ends with it */
  steady->power_in_w = joule[VS_E_SOURCE] / steady->orbit.period_s;
  steady->i_rms_a = vs_spectrum_rms(&steady->spectrum);
  steady->i_mean_a = vs_spectrum_mean(&steady->spectrum);
  steady->power_factor =
      steady->power_in_w / (r->scene->setup.timeline.supply.voltage_v * steady->i_rms_a);
  const vs_spectrum *current = &steady->spectrum;
  const double first[] = {current->cosine[1], current->sine[1]};
  static const double MAINS[] = {0, 1}; /* they rise through zero at t = 0 */
  steady->displacement_factor = vs_quality_displacement(first, MAINS);
  steady->thd = vs_quality_thc(current) / vs_spectrum_harmonic(current, 1);
  steady->devices = r->watchers.devices;
  steady->energy_stored_j = stored(&r->watchers.energy);
  warn_of_speed(steady);
  warn_of_stability(steady);
}

/* The reaction along a coordinate: its largest size, or its root mean square. */
static void reaction_at(const vs_steady *s, int i, bool rms, vs_steady_measure *m) {
  const vs_coordinate *c = &s->model->machine->coordinates[i];
  const char *unit = !strcmp(c->unit, "m") ? "N" : !strcmp(c->unit, "rad") ? "N.m" : "";
  m->value = s->reaction.peak[i];
  if (rms) m->value = (vs_value){true, reaction_rms(&s->reaction, i), NAN};
  snprintf(m->name, sizeof m->name, "reaction_%s%s", c->name, rms ? "_rms" : "");
  m->unit = unit;
  snprintf(m->text, sizeof m->text, "%s of what springs and dampers do along %s",
           rms ? "root mean square" : "largest size", c->name);
}

static bool heat_at(const vs_steady *s, int k, vs_steady_measure *m) {
  vs_heat heat;
  if (!vs_heat_at(s->devices, s->orbit.period_s, k, &heat)) return false;
  snprintf(m->name, sizeof m->name, "%s", heat.name);
  snprintf(m->text, sizeof m->text, "%s", heat.text);
  m->unit = heat.unit;
  m->value = heat.value;
  return true;
}

/* What is told of the material, and behind that of the devices. */
static bool throw_at(const vs_steady *s, int k, vs_steady_measure *m) {
  const struct {
    vs_value (*of)(const vs_throw *);
    const char *name, *unit, *text;
  } all[] = {
#define ROW(of, name, unit, text) {of, name, unit, text},
      VS_STEADY_THROW_LIST(ROW)
#undef ROW
  };
  const int count = sizeof all / sizeof *all;
  if (k >= count) return heat_at(s, k - count, m);
  m->value = all[k].of(&s->thrown);
  snprintf(m->name, sizeof m->name, "%s", all[k].name);
  m->unit = all[k].unit;
  snprintf(m->text, sizeof m->text, "%s", all[k].text);
  return true;
}

bool vs_steady_at(const vs_steady *steady, int k, vs_steady_measure *m) {
  const struct {
    const char *name, *unit, *text;
    double value;
  } all[] = {
#define ROW(member, name, unit, text) {name, unit, text, steady->member},
      VS_STEADY_LIST(ROW)
#undef ROW
  };
  const int count = sizeof all / sizeof *all;
  const int reactions = steady->model ? 2 * steady->model->dof : 0;
  if (k >= count + reactions) return throw_at(steady, k - count - reactions, m);
  if (k >= count) {
    reaction_at(steady, (k - count) / 2, (k - count) % 2, m);
    return true;
  }
  m->value = (vs_value){isfinite(all[k].value), all[k].value, NAN};
  snprintf(m->name, sizeof m->name, "%s", all[k].name);
  m->unit = all[k].unit;
  snprintf(m->text, sizeof m->text, "%s", all[k].text);
  return true;
}

vs_scene *vs_steady_undisturbed(const vs_scene *scene) {
  vs_scene *calm = vs_alloc(1, sizeof *calm);
  *calm = *scene;
  calm->setup.timeline.events.count = 0;
  calm->setup.loads = (vs_loads){0};
  calm->setup.model.reloaded = false;
  calm->setup.steady = false;
  memset(&calm->setup.start, 0, sizeof calm->setup.start);
  calm->frame = vs_sim_frame(calm->tier, &calm->setup);
  return calm;
}

/* ---- runs that begin on an orbit ---- */

/* On tier circuit the run finds, as it settles, the orbit; it begins with that of tier switched. */
static vs_status find_start(vs_scene *scene, const vs_scene *calm, vs_picard **picard,
                            vs_orbit *orbit, vs_error *err) {
  if (!scene->tier->has_circuit) return vs_shooting_find(calm, 1, orbit, err);
  vs_status status = vs_picard_new(calm, 1, false, picard, err);
  if (status) return status;
  scene->order.pilot = &(*picard)->pilot;
  *orbit = (*picard)->orbit;
  return VS_OK;
}

/* Begins the scene on the orbit. A function of its own, so that runs that begin at rest do without
 * its stack, which has two setups. */
static __attribute__((noinline)) vs_status begin_on(vs_scene *scene, const vs_scene *calm,
                                                    const vs_orbit *orbit, vs_error *err) {
  const vs_setup on = vs_steady_setup(calm, &scene->setup.run, orbit);
  scene->setup.start = on.start;
  scene->setup.timeline.firing.first_cycle = on.timeline.firing.first_cycle;
  vs_run_values run = scene->setup.run;
  run.until_s = orbit->period_s;
  const vs_setup period = vs_steady_setup(calm, &run, orbit);
  return settle_instruments(calm, &period, &scene->instruments, err);
}

/* Finds the share of the load that rides where load.fraction is auto, and puts a scene with `start:
 * steady` at the beginning of its orbit of one firing period, that of the scene without its events.
 * On tier circuit the run itself comes to that orbit: *picard, which the caller frees behind it, is
 * the pilot of the scene's order. */
static vs_status put_at_work(vs_scene *scene, vs_picard **picard, vs_error *err) {
  vs_orbit orbit;
  vs_status found = vs_fraction_settle(scene, 1, err);
  if (found || !scene->setup.steady) return found;
  found = warm_up(scene, 1, err);
  if (found) return found;
  vs_scene *calm = vs_steady_undisturbed(scene);
  vs_status status = find_start(scene, calm, picard, &orbit, err);
  if (!status) status = begin_on(scene, calm, &orbit, err);
  free(calm);
  return status;
}

vs_status vs_steady_run(const vs_session *session, vs_scene *scene, vs_result *r, vs_error *err) {
  vs_picard *picard = NULL;
  vs_status status = vs_session_begin(session, scene, r, err);
  vs_scene *now = status ? NULL : scene;
  for (; now; now = vs_session_climb(session, scene, status, r, err)) {
    vs_picard_free(picard); /* of the attempt before */
    picard = NULL;
    now->order.stop = session->stop;
    status = put_at_work(now, &picard, err);
    if (!status) status = vs_session_attempt(session, now, r, err);
  }
  status = vs_session_finish(session, status, scene, r);
  vs_picard_free(picard);
  scene->order.pilot = NULL;
  if (r->climbed) r->climbed->order.pilot = NULL;
  return status;
}
