/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/stencil.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "alike.h"
#include "base/text.h"
#include "orbit/sensitivity_problem.h"
#include "run/session.h"

enum { RUNS = VS_STENCIL_RUNS };

typedef struct making {
  const vs_sensitivity_problem *subject;
  double tolerance;
} making;

static vs_setup make_setup_of_fan(const vs_scene *scene, void *ctx) {
  const making *m = ctx;
  return vs_sensitivity_problem_setup(m->subject, scene, m->tolerance);
}

vs_status vs_stencil_begin(vs_stencil *f, const vs_sensitivity_problem *subject, const char *key,
                           vs_where where, double step, double tolerance, const vs_parameter *known,
                           vs_error *err) {
  making as = {subject, tolerance};
  *f = (vs_stencil){0};
  vs_status status =
      vs_parameter_begin(&f->parameter, subject->scene, key, where, step, known, err);
  if (status) return status;
  vs_parameter_take(&f->parameter, make_setup_of_fan, &as);
  for (int k = 0; k < RUNS; k++) {
    const vs_scene *from = f->parameter.scene[f->parameter.idle ? 0 : k];
    vs_scene *s = f->scene[k] = vs_alloc(1, sizeof *s);
    *s = *from;
    s->setup = f->parameter.setup[k];
    s->frame = vs_sim_frame(s->tier, &s->setup);
    f->measured[k] = vs_alloc(1, sizeof *f->measured[k]);
    vs_measured_begin(f->measured[k], s, subject->periods ? &subject->orbit : NULL);
  }
  return VS_OK;
}

void vs_stencil_end(vs_stencil *f) {
  for (int k = 0; k < RUNS; k++) {
    if (f->measured[k]) vs_measured_free(f->measured[k]);
    free(f->measured[k]);
    free(f->scene[k]);
    f->measured[k] = NULL;
    f->scene[k] = NULL;
  }
  vs_parameter_end(&f->parameter);
}

/* ---- runs of their own ---- */

/* Each run finds its own orbit, where it begins on one or is a period of one. */
static vs_status run_one(vs_stencil *f, const vs_sensitivity_problem *subject, int k,
                         double tolerance, vs_alike *alike, vs_error *err) {
  vs_scene *scene = f->scene[k];
  const vs_session session = {.stop = subject->stop};
  vs_measured_free(f->measured[k]);
  *f->measured[k] = (vs_measured){.alike = subject->periods ? alike : NULL};
  *scene = *f->parameter.scene[f->parameter.idle ? 0 : k];
  scene->setup.run.tolerance = tolerance;
  if (alike) {
    scene->order.steps = &alike->steps;
    alike->steps.are = k ? VS_STEPS_TAKEN : VS_STEPS_NOTED;
    scene->setup.run.verify = VS_VERIFY_NEVER; /* a second run has other steps */
  }
  scene->frame = vs_sim_frame(scene->tier, &scene->setup);
  return vs_measured_run(f->measured[k], scene, subject->periods, &session, err);
}

vs_status vs_stencil_run(vs_stencil *f, const vs_sensitivity_problem *subject, double tolerance,
                         bool alike, vs_error *err) {
  vs_alike own = {0};
  vs_status status = VS_OK;
  for (int k = 0; k < RUNS && !status; k++) {
    vs_error why = {0};
    status = run_one(f, subject, k, tolerance, alike ? &own : NULL, &why);
    if (status && k)
      vs_fail(err, status, "with %s at %.9g of its value: %s", f->parameter.key.name,
              1 + f->parameter.at[k], why.text);
    else if (status)
      vs_fail(err, status, "%s", why.text);
  }
  vs_alike_free(&own);
  return status;
}

/* ---- the derivatives ---- */

/* By how much the slopes on either side of the scene's value differ. Of a smooth measure the second
 * difference grows with the square of the step, of a kink with the step itself. Only where the
 * scenes lie on both sides can it be told. */
static double bend_of(const vs_parameter *p, const double v[RUNS]) {
  if (p->at[1] * p->at[2] >= 0) return 0;
  double near = v[1] + v[2] - 2 * v[0], far = v[3] + v[4] - 2 * v[0];
  return fabs(4 * near - far) / (2 * p->step);
}

/* What a measure may be wrong by in itself, in parts of it: its rounding. */
static const double ROUNDING = 16 * DBL_EPSILON;

vs_slope_of vs_stencil_slope(const vs_stencil *f, const char *measure) {
  const vs_parameter *p = &f->parameter;
  double v[RUNS], coarse = 0;
  vs_slope_of s = {.known = true};
  for (int k = 0; k < RUNS; k++) {
    vs_measured_value m;
    int n = vs_measured_find(f->measured[k], measure);
    if (n < 0 || !vs_measured_at(f->measured[k], n, &m) || !m.value.known) {
      s.known = false;
      if (!k) return s;
      m.value.value = NAN;
    }
    v[k] = m.value.value;
  }
  s.value = v[0];
  s.slope = p->idle ? 0 : vs_parameter_slope(p, v);
  for (int k = 1; k < RUNS && !p->idle; k++) coarse += p->coarse[k] * (v[k] - v[0]);
  double rounding = 0;
  for (int k = 1; k < RUNS; k++) rounding += fabs(p->weight[k] * (v[k] != v[0]) * v[0]) * ROUNDING;
  if (s.slope != 0) rounding += f->unresolved * fabs(v[0]);
  s.error = fabs(s.slope - coarse) + rounding;
  s.bend = bend_of(p, v);
  return s;
}
