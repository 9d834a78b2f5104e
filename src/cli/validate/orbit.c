/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "validate/orbit.h"

#include <math.h>
#include <stdlib.h>

#include "orbit/shooting.h"

static vs_status accept_step_of_orbit(void *ctx, const vs_step *step, const vs_result *result,
                                      vs_error *err) {
  const vs_observer *also = ctx;
  (void)result;
  return also->accept(also->ctx, step, err);
}

/* Over one period of the orbit. */
static vs_status measure_orbit(const vs_scene *s, const vs_orbit *orbit, const vs_observer *also,
                               vs_numbers *out, vs_error *err) {
  const vs_session_listener guest = {.ctx = (void *)(size_t)also, .accept = accept_step_of_orbit};
  const vs_session session = {.guest = also ? &guest : NULL, .unguarded = true};
  vs_scene *once = vs_alloc(1, sizeof *once); /* borrows what s owns */
  vs_result *r = vs_alloc(1, sizeof *r);
  vs_run_values run = s->setup.run;
  run.until_s = orbit->period_s;
  *once = *s;
  once->setup = vs_shooting_setup(s, &run, orbit);
  once->frame = vs_sim_frame(s->tier, &once->setup);
  vs_status status = vs_session_run(&session, once, r, err);
  if (!status) {
    const double *joule = r->watchers.energy.joule;
    vs_experiment_add_measures(&s->setup.model, r, out);
    vs_experiment_add(out, joule[VS_E_SOURCE] / run.until_s, "power");
    vs_experiment_add(out, joule[VS_E_COPPER] / run.until_s, "power_copper");
    vs_experiment_add(
        out, sqrt(joule[VS_E_COPPER] / s->setup.model.coil.resistance_ohm / run.until_s), "i_rms");
  }
  vs_result_free(r);
  free(r);
  free(once);
  return status;
}

static vs_status find_and_measure_orbit(const vs_scene *s, const vs_observer *also,
                                        bool multipliers, vs_numbers *out, vs_error *err) {
  const vs_shooting how = {.periods = 1, .unguarded = true};
  vs_orbit orbit;
  vs_status status = vs_shooting_seek(s, &how, &orbit, err);
  if (!status) status = measure_orbit(s, &orbit, also, out, err);
  for (int k = 0; k < orbit.count && multipliers && !status; k++)
    vs_experiment_add(out, hypot(orbit.multiplier[k].re, orbit.multiplier[k].im), "multiplier%d",
                      k + 1);
  return status;
}

vs_status vs_orbit_find(const vs_scene *s, const vs_observer *also, vs_numbers *out,
                        vs_error *err) {
  return find_and_measure_orbit(s, also, false, out, err);
}

vs_status vs_orbit_perform(const vs_experiment *e, const vs_observer *also, vs_numbers *out,
                           vs_error *err) {
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_status status = vs_experiment_scene(e, NULL, scene, err);
  if (!status) status = find_and_measure_orbit(scene, also, e->multipliers, out, err);
  vs_scene_free(scene);
  free(scene);
  return status;
}
