/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plant/winding.h"

#include <math.h>

double vs_winding_ohm(const vs_winding_values *w, double cold_ohm, double t_degc) {
  return w->present ? cold_ohm * (1 + w->coefficient_1_k * (t_degc - 20)) : cold_ohm;
}

vs_winding_state vs_winding_begin(const vs_winding_values *w) {
  const double all = w->r_th[0] + w->r_th[1], share = all > 0 ? w->r_th[1] / all : 1;
  const double rise = w->temperature_degc - w->ambient_degc;
  return (vs_winding_state){w->temperature_degc, w->ambient_degc + share * rise, false};
}

/* What heats the winding where one body tells all. */
typedef struct body {
  double c_j_k, r_k_w, heat_w, around_degc;
} body;

/* True where that is so: nothing is between winding and core, or the core stores nothing, or it has
 * the ambient's temperature. */
static bool is_one_body(const vs_winding_values *w, double copper_w, double core_w, body *b) {
  const double *r = w->r_th, *c = w->c_th;
  *b = (body){c[0], r[0] + r[1], copper_w, w->ambient_degc + r[1] * core_w};
  if (r[0] == 0) *b = (body){c[0] + c[1], r[1], copper_w + core_w, w->ambient_degc};
  return r[0] == 0 || c[1] == 0 || r[1] == 0;
}

double vs_winding_fastest(const vs_winding_values *w) {
  const double *r = w->r_th, *c = w->c_th;
  body b;
  if (is_one_body(w, 0, 0, &b)) return b.c_j_k * b.r_k_w;
  return fmin(c[0] * r[0], c[1] * r[0] * r[1] / (r[0] + r[1]));
}

/* Two bodies: x = T - T(infinity) follows x' = A x, and with the mean m of A's eigenvalues, which
 * are real, and half of their distance q
 *   exp(A t) = (e+ + e-)/2 + (e+ - e-)/(2 q) (A - m),  e+- = exp((m +- q) t). */
static void go_as_two(const vs_winding_values *w, double copper_w, double core_w, double by_s,
                      vs_winding_state *s) {
  const double *r = w->r_th, *c = w->c_th, g = 1 / r[0];
  const double core_degc = w->ambient_degc + r[1] * (copper_w + core_w),
               winding_degc = core_degc + r[0] * copper_w;
  const double a[2][2] = {{-g / c[0], g / c[0]}, {g / c[1], -(g + 1 / r[1]) / c[1]}};
  const double m = (a[0][0] + a[1][1]) / 2, half = (a[0][0] - a[1][1]) / 2,
               q = sqrt(half * half + a[0][1] * a[1][0]);
  const double more = exp((m + q) * by_s), less = exp((m - q) * by_s), mean = (more + less) / 2,
               by = (more - less) / (2 * q);
  const double x = s->winding_degc - winding_degc, y = s->core_degc - core_degc;
  s->winding_degc = winding_degc + mean * x + by * (half * x + a[0][1] * y);
  s->core_degc = core_degc + mean * y + by * (a[1][0] * x - half * y);
}

/* In closed form, however long. */
void vs_winding_go(const vs_winding_values *w, double copper_w, double core_w, double by_s,
                   vs_winding_state *s) {
  body b;
  if (!w->present || !(w->c_th[0] > 0) || !(w->r_th[0] + w->r_th[1] > 0)) return;
  if (!is_one_body(w, copper_w, core_w, &b)) {
    go_as_two(w, copper_w, core_w, by_s, s);
    return;
  }
  const double end_degc = b.around_degc + b.r_k_w * b.heat_w;
  s->winding_degc = end_degc + (s->winding_degc - end_degc) * exp(-by_s / (b.c_j_k * b.r_k_w));
  s->core_degc = w->r_th[0] == 0
                     ? s->winding_degc
                     : b.around_degc + (s->winding_degc - b.around_degc) * w->r_th[1] / b.r_k_w;
}
