/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dependence/subject.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "orbit/steady.h"

static const char *inexact(const vs_scene *s) {
  const vs_setup *setup = &s->setup;
  if (s->tier->has_circuit) return "the circuit's equations are its solver's own";
  if (isfinite(vs_setup_jams(setup))) return "the armature jams";
  if (setup->loads.count) return "the load changes";
  if (setup->wants_fraction) return "load.fraction: auto is found by trial";
  return NULL;
}

vs_status vs_subject_begin(vs_subject *s, const vs_scene *scene, int periods, vs_error *err) {
  *s = (vs_subject){.scene = scene, .periods = periods, .inexact = inexact(scene)};
  if (s->inexact || (!periods && !scene->setup.steady)) return VS_OK;
  vs_status status = vs_tiers_require_orbits(periods ? "--steady" : "start: steady", scene->tier,
                                             scene->why, (vs_where){0}, err);
  if (status) return status;
  if (periods) {
    s->calm = vs_alloc(1, sizeof *s->calm);
    *s->calm = *scene;
    s->calm->setup.steady = false;
    s->calm->frame = vs_sim_frame(s->calm->tier, &s->calm->setup);
  } else {
    s->calm = vs_steady_undisturbed(scene);
  }
  return vs_shooting_find(s->calm, periods ? periods : 1, &s->orbit, err);
}

void vs_subject_end(vs_subject *s) {
  free(s->calm);
  s->calm = NULL;
}

/* A firing period of this scene, s. */
static double firing_period(const vs_setup *setup) {
  const vs_timeline *line = &setup->timeline;
  return (line->firing.no_valve ? 1 : line->firing.every) * line->period_s;
}

vs_setup vs_subject_setup(const vs_subject *s, const vs_scene *scene, double tolerance) {
  vs_run_values run = scene->setup.run;
  run.tolerance = tolerance;
  if (!s->calm) return vs_setup_varied(&scene->setup, &run, NULL);
  if (s->periods) run.until_s = s->orbit.n * firing_period(&scene->setup);
  vs_setup along = vs_steady_setup(scene, &run, &s->orbit);
  along.steady = false;
  if (s->periods) return along;
  vs_setup setup = vs_setup_varied(&scene->setup, &run, NULL);
  setup.steady = false;
  setup.start = along.start;
  setup.timeline.firing.first_cycle = along.timeline.firing.first_cycle;
  return setup;
}
