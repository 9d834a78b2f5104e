/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parameter_rates.h"

#include "plant/coil.h"

enum { ALL = 1 + VS_PARAMETER_NEAR };

static double along_slope(const vs_parameter *p, const double *q) {
  double g = 0;
  for (int i = 0; i < p->setup->model.dof; i++) g += p->slopes.along[i] * q[i];
  return g;
}

double vs_parameter_rates_surface(const vs_parameter *p, int stop, const double *q) {
  return along_slope(p, q) - p->slopes.at_m[stop];
}

/* The stops' part of the force F that closes the gap, and its derivative at a given state. All
 * kinds' forces are in proportion to stiffness and damping together, and the damping stands
 * beside the depth's rate alone (plant/stops.h):
 *   k dF/dk + c dF/dc = F,   c dF/dc = rate dF/drate. */
static double add_stops(const vs_parameter *p, const vs_parameter_rates_place *at, double *slope) {
  const vs_model *m = &p->setup->model;
  double g = vs_mechanics_travel(m, at->q), g1 = vs_mechanics_travel(m, at->rate), force = 0;
  double dg = along_slope(p, at->q), dg1 = along_slope(p, at->rate);
  for (int n = 0; n < m->stops.count; n++) {
    vs_stop stop = m->stops.item[n];
    if (!(at->touched >> n & 1)) continue;
    double depth = vs_stop_depth(&stop, g), rate = -stop.side * g1, own[2], damped[2];
    double push = stop.kind->force(&stop, depth, rate);
    stop.kind->slopes(&stop, depth, rate, own);
    double elastic = push - rate * own[1];
    if (stop.damping_ns_m == 0) stop.damping_ns_m = 1e-30; /* none, but it has a slope */
    stop.kind->slopes(&stop, depth, rate, damped);
    double by_numbers = rate * damped[1] / stop.damping_ns_m * p->slopes.stop_damping[n];
    if (stop.stiffness != 0) by_numbers += elastic / stop.stiffness * p->slopes.stop_stiffness[n];
    force -= stop.side * push;
    *slope += own[0] * (dg - p->slopes.at_m[n]) + own[1] * dg1 - stop.side * by_numbers;
  }
  return force;
}

/* The coil's part of the same, its current, and their derivatives at a given state. */
typedef struct pull {
  double force_n, i_a, force, i;
} pull;

static pull pull_of(const vs_parameter *p, const vs_parameter_rates_place *at) {
  const vs_coil *c = &p->setup->model.coil;
  bool at_rest = at->frame->gap_at_rest;
  double z = vs_mechanics_gap(&p->setup->model, at->q), force[ALL], i[ALL];
  double dz = p->slopes.gap_rest_m + along_slope(p, at->q);
  for (int k = 0; k < ALL; k++) { /* other numbers of the law, at the same lambda and z */
    const vs_coil *other = &p->setup[k].model.coil;
    force[k] = vs_coil_force(other, at->flux_wb, z);
    i[k] = vs_coil_current(other, at->flux_wb, at_rest ? c->gap_rest_m : z);
  }
  const vs_law_rates by_gap =
      vs_coil_rates(c, at->flux_wb, 0, at_rest ? c->gap_rest_m : z, 1); /* another z */
  return (pull){force[0], i[0], vs_parameter_slope(p, force) + by_gap.force_rate_n_s * dz,
                vs_parameter_slope(p, i) +
                    by_gap.i_rate_a_s * (at_rest ? p->slopes.gap_rest_m : dz)};
}

/* The mains' voltage, and its derivative at the same instant, counted in periods. */
static double mains_at(const vs_parameter *p, double t_s, double *slope) {
  double v[ALL], u[3];
  for (int k = 0; k < ALL; k++) {
    vs_wave_at(&p->mains[k], vs_parameter_time(p, k, t_s) - p->origin_s[k], u);
    v[k] = u[0];
  }
  *slope = vs_parameter_slope(p, v);
  return v[0];
}

/* q" = m0 + mf F - (M^-1 K) q - (M^-1 B) q',   lambda' = u - R_c i, each differentiated, and times
 * the period's own change. */
void vs_parameter_rates_find(const vs_parameter *p, const vs_parameter_rates_place *at,
                             double *rate) {
  const vs_model *m = &p->setup->model;
  const vs_parameter_slopes *s = &p->slopes;
  int dof = m->dof;
  double force_slope = 0, mains_slope, a[VS_MOST_DOF];
  double force = add_stops(p, at, &force_slope);
  rate[2 * dof] = 0;
  if (at->conducting) {
    const pull coil = pull_of(p, at);
    double r = m->coil.resistance_ohm, u = mains_at(p, at->t_s, &mains_slope);
    force += coil.force_n;
    force_slope += coil.force;
    rate[2 * dof] =
        mains_slope - s->resistance_ohm * coil.i_a - r * coil.i + s->clock * (u - r * coil.i_a);
  }
  vs_mechanics_accelerations(m, at->q, at->rate, force, a);
  for (int i = 0; i < dof; i++) {
    double sum = s->m0[i] + s->mf[i] * force + m->mf[i] * force_slope + s->clock * a[i];
    for (int j = 0; j < dof; j++)
      sum -= s->mk_column[j][i] * at->q[j] + s->mb_column[j][i] * at->rate[j];
    rate[i] = s->clock * at->rate[i];
    rate[dof + i] = sum;
  }
}
