/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/steady.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

/* The setup of a run along the orbit. The pulse of the firing period before t = 0 is only kept
 * where it is so long that it counts. */
static vs_setup run_along(const vs_scene *scene, const vs_run_values *run, const vs_orbit *orbit) {
  vs_setup setup = vs_shooting_setup(scene, run, orbit);
  vs_firing_values *firing = &setup.timeline.firing;
  double ends_s = firing->angle_rad / setup.timeline.omega_rad_s + firing->pulse_width_s;
  if (ends_s < firing->every * setup.timeline.period_s) firing->first_cycle = 1;
  return setup;
}

/* Makes the scene the one whose run is a period of the orbit. */
static void put_on_orbit(vs_steady *steady, vs_scene *scene) {
  vs_run_values run = scene->setup.run;
  run.until_s = steady->orbit.period_s;
  scene->setup.steady = false; /* it begins there anyway */
  scene->setup = run_along(scene, &run, &steady->orbit);
  scene->frame = vs_sim_frame(scene->tier, &scene->setup);
  if (steady->picard) scene->order.pilot = &steady->picard->pilot;
  memset(scene->measured, 0, sizeof scene->measured); /* it was measured in the scene's own run */
}

vs_status vs_steady_begin(vs_steady *steady, vs_scene *scene, int periods, vs_error *err) {
  *steady = (vs_steady){0};
  vs_status status = vs_tiers_require_orbits("steady", scene->tier, scene->why, (vs_where){0}, err);
  if (status) return status;
  if (scene->tier->has_circuit)
    status = vs_picard_new(scene, periods, true, &steady->picard, err);
  else
    status = vs_shooting_find(scene, periods, &steady->orbit, err);
  if (status) return status;
  if (steady->picard) steady->orbit = steady->picard->orbit;
  put_on_orbit(steady, scene);
  steady->model = &scene->setup.model;
  vs_spectrum_begin(&steady->spectrum, scene->setup.timeline.omega_rad_s);
  return VS_OK;
}

void vs_steady_again(vs_steady *steady, vs_scene *scene) {
  put_on_orbit(steady, scene);
  vs_spectrum_end(&steady->spectrum);
  vs_spectrum_begin(&steady->spectrum, scene->setup.timeline.omega_rad_s);
  steady->reaction = (vs_reaction){0};
  if (steady->picard) vs_picard_again(steady->picard);
}

void vs_steady_end(vs_steady *steady) {
  vs_picard_free(steady->picard);
  vs_spectrum_end(&steady->spectrum);
}

void vs_steady_accept(vs_steady *steady, const vs_step *step) {
  vs_spectrum_accept(&steady->spectrum, step);
  vs_reaction_accept(&steady->reaction, step);
}

void vs_steady_finish(vs_steady *steady, const vs_result *r) {
  const double *joule = r->watchers.energy.joule;
  if (steady->picard) steady->orbit = steady->picard->orbit;
  steady->power_in_w = joule[VS_E_SOURCE] / steady->orbit.period_s;
  steady->i_rms_a = vs_spectrum_rms(&steady->spectrum);
  steady->i_mean_a = vs_spectrum_mean(&steady->spectrum);
  steady->power_factor =
      steady->power_in_w / (r->scene->setup.timeline.supply.voltage_v * steady->i_rms_a);
  steady->energy_stored_j = joule[VS_E_MAGNETIC] + joule[VS_E_MECHANICAL];
}

/* The reaction along a coordinate: its largest size, or its root mean square. */
static void reaction_at(const vs_steady *s, int i, bool rms, vs_steady_measure *m) {
  const vs_coordinate *c = &s->model->machine->coordinates[i];
  const char *unit = !strcmp(c->unit, "m") ? "N" : !strcmp(c->unit, "rad") ? "N.m" : "";
  m->value = s->reaction.peak[i];
  if (rms) m->value = (vs_value){true, vs_reaction_rms(&s->reaction, i), NAN};
  snprintf(m->name, sizeof m->name, "reaction_%s%s", c->name, rms ? "_rms" : "");
  snprintf(m->unit, sizeof m->unit, "%s", unit);
  snprintf(m->text, sizeof m->text, "%s of what springs and dampers do along %s",
           rms ? "root mean square" : "largest size", c->name);
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
  if (k >= count + (steady->model ? 2 * steady->model->dof : 0)) return false;
  if (k >= count) {
    reaction_at(steady, (k - count) / 2, (k - count) % 2, m);
    return true;
  }
  m->value = (vs_value){isfinite(all[k].value), all[k].value, NAN};
  snprintf(m->name, sizeof m->name, "%s", all[k].name);
  snprintf(m->unit, sizeof m->unit, "%s", all[k].unit);
  snprintf(m->text, sizeof m->text, "%s", all[k].text);
  return true;
}

/* The scene without events, and as if it began at rest: what its orbit is that of. It borrows what
 * the scene owns. */
static vs_scene *undisturbed(const vs_scene *scene) {
  vs_scene *calm = vs_alloc(1, sizeof *calm);
  *calm = *scene;
  calm->setup.timeline.events.count = 0;
  calm->setup.steady = false;
  memset(&calm->setup.start, 0, sizeof calm->setup.start);
  calm->frame = vs_sim_frame(calm->tier, &calm->setup);
  return calm;
}

/* On tier circuit the run's own prelude finds the orbit; it begins with that of tier switched. */
static vs_status find_start(vs_scene *scene, const vs_scene *calm, vs_orbit *orbit, vs_error *err) {
  vs_picard *picard;
  if (!scene->tier->has_circuit) return vs_shooting_find(calm, 1, orbit, err);
  vs_status status = vs_picard_new(calm, 1, false, &picard, err);
  if (status) return status;
  scene->order.pilot = &picard->pilot;
  *orbit = picard->orbit;
  return VS_OK;
}

vs_status vs_steady_start(vs_scene *scene, vs_error *err) {
  vs_orbit orbit;
  vs_scene *calm = undisturbed(scene);
  vs_status status = find_start(scene, calm, &orbit, err);
  if (!status) {
    const vs_setup on = run_along(calm, &scene->setup.run, &orbit);
    scene->setup.start = on.start;
    scene->setup.timeline.firing.first_cycle = on.timeline.firing.first_cycle;
  }
  free(calm);
  return status;
}
