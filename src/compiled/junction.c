/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "junction.h"

#include <math.h>
#include <string.h>

/* ---- models ---- */

/* A parameter of a model, and where it goes. */
typedef struct parameter {
  const char *name;
  double *value;
} parameter;

static vs_status read_model(const vs_cards *c, vs_parameters *in, const vs_netlist_card *model,
                            const parameter *known, size_t count, vs_error *err) {
  for (size_t k = model->first; k < model->first + model->count; k++) {
    const vs_argument *a = &c->arguments[k];
    if (!a->name.n) { /* its type, or a flag */
      if (k == model->first || vs_words_is(a->value, "nchan")) continue;
      return vs_fail(err, VS_INPUT, ".model %.*s: '%.*s' is not known here", (int)model->name.n,
                     model->name.at, (int)a->value.n, a->value.at);
    }
    size_t n = 0;
    while (n < count && !vs_words_is(a->name, known[n].name)) n++;
    if (n == count)
      return vs_fail(err, VS_INPUT, ".model %.*s: the parameter '%.*s' is not known here",
                     (int)model->name.n, model->name.at, (int)a->name.n, a->name.at);
    vs_status status = vs_parameters_of(c, in, a->value, known[n].value, err);
    if (status) return status;
  }
  return VS_OK;
}

/* The solver's own breakdown voltage: that at which the reverse current is ibv, by both branches.
 */
static double corrected_breakdown(const vs_diode *d, double bv, double ibv) {
  const double vt = VS_JUNCTION_VT, is = d->saturation_a;
  double x = bv;
  if (ibv < is * bv / vt) return bv;
  x = bv - d->nbv * vt * log(1 + ibv / is);
  for (int k = 0; k < 25; k++) {
    x = bv - d->nbv * vt * log(ibv / is + 1 - x / vt);
    double found = is * (exp((bv - x) / (d->nbv * vt)) - 1 + x / vt);
    if (fabs(found - ibv) <= 1e-3 * ibv) break;
  }
  return x;
}

vs_status vs_junction_diode(const vs_cards *c, vs_parameters *in, const vs_netlist_card *model,
                            vs_diode *d, vs_error *err) {
  double bv = INFINITY, ibv = 1e-3, nbv = NAN;
  *d = (vs_diode){.saturation_a = 1e-14, .n = 1};
  const parameter known[] = {
      {"is", &d->saturation_a},   {"n", &d->n},         {"bv", &bv}, {"ibv", &ibv}, {"nbv", &nbv},
      {"rs", &d->resistance_ohm}, {"tt", &d->transit_s}};
  vs_status status = read_model(c, in, model, known, sizeof known / sizeof *known, err);
  d->nbv = isnan(nbv) ? d->n : nbv;
  d->breakdown_v = isfinite(bv) ? corrected_breakdown(d, bv, ibv) : INFINITY;
  return status;
}

vs_status vs_junction_bipolar(const vs_cards *c, vs_parameters *in, const vs_netlist_card *model,
                              vs_bipolar *q, vs_error *err) {
  double vaf = INFINITY;
  *q = (vs_bipolar){.junction = {.saturation_a = 1e-16, .n = 1, .breakdown_v = INFINITY},
                    .forward = 100,
                    .reverse = 1,
                    .way = vs_words_is(model->model, "pnp") ? -1 : 1};
  const parameter known[] = {
      {"is", &q->junction.saturation_a}, {"bf", &q->forward}, {"br", &q->reverse}, {"vaf", &vaf}};
  vs_status status = read_model(c, in, model, known, sizeof known / sizeof *known, err);
  q->early_v = vaf;
  return status;
}

/* ---- a junction ---- */

/* Above this the exponential goes on as a straight line. */
static const double STEEPEST = 200;

/* The current without gmin. */
static double pure_current(const vs_diode *d, double v, double *slope) {
  const double vte = d->n * VS_JUNCTION_VT, is = d->saturation_a;
  double i, g;
  if (v >= -3 * vte) {
    const double x = v / vte, e = exp(fmin(x, STEEPEST));
    i = is * (e * (1 + fmax(x - STEEPEST, 0)) - 1);
    g = is * e / vte;
  } else if (v >= -d->breakdown_v) {
    const double x = 3 * vte / (v * M_E), cube = x * x * x;
    i = -is * (1 + cube);
    g = is * 3 * cube / v;
  } else {
    const double vtb = d->nbv * VS_JUNCTION_VT, x = -(d->breakdown_v + v) / vtb,
                 e = exp(fmin(x, STEEPEST));
    i = -is * e * (1 + fmax(x - STEEPEST, 0));
    g = is * e / vtb;
  }
  *slope = g;
  return i;
}

double vs_junction_current(const vs_diode *d, double v, double *slope) {
  const double i = pure_current(d, v, slope);
  *slope += VS_JUNCTION_GMIN;
  return i + VS_JUNCTION_GMIN * v;
}

static double limit_forward(double v, double before, double vt, double is) {
  const double critical = vt * log(vt / (M_SQRT2 * is));
  if (!(v > critical && fabs(v - before) > 2 * vt)) return v;
  if (before <= 0) return vt * log(v / vt);
  const double x = 1 + (v - before) / vt;
  return x > 0 ? before + vt * log(x) : critical;
}

double vs_junction_limit(const vs_diode *d, double v, double before) {
  const double vt = d->n * VS_JUNCTION_VT;
  if (v >= -d->breakdown_v || !isfinite(d->breakdown_v))
    return limit_forward(v, before, vt, d->saturation_a);
  const double over = -(v + d->breakdown_v), was = -(before + d->breakdown_v);
  return -(limit_forward(over, was, d->nbv * VS_JUNCTION_VT, d->saturation_a) + d->breakdown_v);
}

/* ---- a transistor ---- */

void vs_junction_transistor(const vs_bipolar *q, double vbe, double vbc, double *ic, double *ib,
                            double dc[2], double db[2]) {
  double gbe, gbc;
  const double cbe = pure_current(&q->junction, vbe, &gbe);
  const double cbc = pure_current(&q->junction, vbc, &gbc);
  /* 1/q_b = 1 - vbc/VAF: the base's width changes with the collector's voltage */
  const double width = isfinite(q->early_v) ? 1 - vbc / q->early_v : 1;
  const double narrows = isfinite(q->early_v) ? -1 / q->early_v : 0;
  const double leak = VS_JUNCTION_GMIN; /* none of it is amplified */
  *ic = (cbe - cbc) * width - cbc / q->reverse - leak * vbc;
  *ib = cbe / q->forward + cbc / q->reverse + leak * (vbe + vbc);
  dc[0] = gbe * width;
  dc[1] = -gbc * width + (cbe - cbc) * narrows - gbc / q->reverse - leak;
  db[0] = gbe / q->forward + leak;
  db[1] = gbc / q->reverse + leak;
}

/* ---- a power MOSFET ---- */

vs_status vs_junction_vdmos(const vs_cards *c, vs_parameters *in, const vs_netlist_card *model,
                            vs_vdmos *q, vs_error *err) {
  double rd = 0, rs = 0, rg = 0;
  *q = (vs_vdmos){.kp = 1,
                  .subthreshold_v = 0.1,
                  .a = 1,
                  .vj_v = 0.8,
                  .m = 0.5,
                  .body = {.saturation_a = 1e-14, .n = 1, .breakdown_v = INFINITY}};
  const parameter known[] = {{"vto", &q->vto_v},
                             {"kp", &q->kp},
                             {"lambda", &q->lambda},
                             {"ksubthres", &q->subthreshold_v},
                             {"cgs", &q->cgs_f},
                             {"cgdmin", &q->cgd_min_f},
                             {"cgdmax", &q->cgd_max_f},
                             {"a", &q->a},
                             {"cjo", &q->cjo_f},
                             {"vj", &q->vj_v},
                             {"m", &q->m},
                             {"is", &q->body.saturation_a},
                             {"n", &q->body.n},
                             {"rd", &rd},
                             {"rs", &rs},
                             {"rg", &rg}};
  vs_status status = read_model(c, in, model, known, sizeof known / sizeof *known, err);
  if (!status && (rd != 0 || rs != 0 || rg != 0))
    return vs_fail(err, VS_INPUT, ".model %.*s: rd, rs and rg are only known as 0 here",
                   (int)model->name.n, model->name.at);
  return status;
}

double vs_junction_channel(const vs_vdmos *q, double vgs, double vds, double slope[2]) {
  if (vds < 0) { /* drain and source change their parts */
    double turned[2];
    const double i = vs_junction_channel(q, vgs - vds, -vds, turned);
    slope[0] = -turned[0];
    slope[1] = turned[0] + turned[1];
    return -i;
  }
  /* the voltage above the threshold, v = w ln(1 + exp((vgs - vto)/w)) */
  const double w = q->subthreshold_v, x = (vgs - q->vto_v) / w;
  const double v = x > 40 ? x * w : w * log1p(exp(x)), rate = x > 40 ? 1 : 1 / (1 + exp(-x));
  const double beta = q->kp * (1 + q->lambda * vds), wide = q->kp * q->lambda;
  if (v <= vds) {
    slope[0] = beta * v * rate;
    slope[1] = wide * v * v / 2;
    return beta * v * v / 2;
  }
  slope[0] = beta * vds * rate;
  slope[1] = beta * (v - vds) + wide * vds * (v - vds / 2);
  return beta * vds * (v - vds / 2);
}

/* The capacitance is y + s tanh(a v) above 0 V and y + s atan(a v) below. */
double vs_junction_gate_charge(const vs_vdmos *q, double v, double *capacitance) {
  const double s = (q->cgd_max_f - q->cgd_min_f) / (1 + M_PI_2), y = q->cgd_max_f - s, a = q->a;
  const double x = a * v;
  if (v > 0) {
    *capacitance = y + s * tanh(x);
    return y * v + s / a * (x + log1p(exp(-2 * x)) - M_LN2); /* ln cosh x */
  }
  *capacitance = y + s * atan(x);
  return y * v + s / a * (x * atan(x) - log1p(x * x) / 2);
}

/* cjo/(1 - v/vj)^m, from half of vj on as a straight line. */
double vs_junction_body_charge(const vs_vdmos *q, double v, double *capacitance) {
  const double half = 0.5, m = q->m, vj = q->vj_v, knee_v = half * vj;
  const double below_v = fmin(v, knee_v), rest = 1 - below_v / vj;
  const double c = q->cjo_f * pow(rest, -m),
               charge = q->cjo_f * vj * (1 - pow(rest, 1 - m)) / (1 - m);
  const double over_v = v - below_v, bend = c * m / (vj * rest);
  *capacitance = c + bend * over_v;
  return charge + over_v * (c + bend * over_v / 2);
}
