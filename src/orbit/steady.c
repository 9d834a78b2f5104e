/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/steady.h"

#include <stdlib.h>
#include <string.h>

#include "base/text.h"

vs_status vs_steady_begin(vs_steady *steady, vs_scene *scene, int periods, vs_error *err) {
  vs_run_values run = scene->setup.run;
  *steady = (vs_steady){0};
  vs_status status = vs_tiers_require_orbits("steady", scene->tier, scene->why, (vs_where){0}, err);
  scene->setup.steady = false; /* it begins there anyway */
  if (!status) status = vs_shooting_find(scene, periods, &steady->orbit, err);
  if (status) return status;
  run.until_s = steady->orbit.period_s;
  scene->setup = vs_shooting_setup(scene, &run, &steady->orbit);
  scene->frame = vs_sim_frame(scene->tier, &scene->setup);
  memset(scene->measured, 0, sizeof scene->measured); /* it was measured in the scene's own run */
  vs_spectrum_begin(&steady->spectrum, scene->setup.timeline.omega_rad_s);
  return VS_OK;
}

void vs_steady_end(vs_steady *steady) {
  vs_spectrum_end(&steady->spectrum);
}

void vs_steady_accept(vs_steady *steady, const vs_step *step) {
  vs_spectrum_accept(&steady->spectrum, step);
}

void vs_steady_finish(vs_steady *steady, const vs_result *r) {
  const double *joule = r->watchers.energy.joule;
  steady->power_in_w = joule[VS_E_SOURCE] / steady->orbit.period_s;
  steady->i_rms_a = vs_spectrum_rms(&steady->spectrum);
  steady->i_mean_a = vs_spectrum_mean(&steady->spectrum);
  steady->power_factor =
      steady->power_in_w / (r->scene->setup.timeline.supply.voltage_v * steady->i_rms_a);
  steady->energy_stored_j = joule[VS_E_MAGNETIC] + joule[VS_E_MECHANICAL];
}

bool vs_steady_at(const vs_steady *steady, int k, vs_steady_measure *measure) {
  const vs_steady_measure all[] = {
#define ROW(member, name, unit, text) {name, unit, text, steady->member},
      VS_STEADY_LIST(ROW)
#undef ROW
  };
  if (k >= (int)(sizeof all / sizeof *all)) return false;
  *measure = all[k];
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

vs_status vs_steady_start(vs_scene *scene, vs_error *err) {
  vs_orbit orbit;
  vs_scene *calm = undisturbed(scene);
  vs_status status = vs_shooting_find(calm, 1, &orbit, err);
  if (!status) {
    const vs_setup on = vs_shooting_setup(calm, &scene->setup.run, &orbit);
    scene->setup.start = on.start;
    /* the machine has been fired before: a long pulse of the cycle before still counts */
    scene->setup.timeline.firing.first_cycle = on.timeline.firing.first_cycle;
  }
  free(calm);
  return status;
}
