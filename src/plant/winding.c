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

/* True where winding and core are one body. */
static bool is_one_body(const vs_winding_values *w) {
  return w->r_th[0] == 0 || w->c_th[1] == 0;
}

double vs_winding_fastest(const vs_winding_values *w) {
  const double r = w->r_th[0] + w->r_th[1];
  if (is_one_body(w)) return (w->c_th[0] + w->c_th[1]) * r;
  const double beside = w->r_th[1] > 0 ? w->r_th[0] * w->r_th[1] / r : w->r_th[0];
  return fmin(w->c_th[0] * w->r_th[0], w->c_th[1] * beside);
}

/* In steps of a fiftieth of the shorter time constant, by the rule of the mid-point. A core that
 * stores nothing, or nothing between winding and core, makes one body of the two. */
void vs_winding_go(const vs_winding_values *w, double copper_w, double core_w, double by_s,
                   vs_winding_state *s) {
  enum { MOST = 100000 };
  const double fastest = vs_winding_fastest(w), r = w->r_th[0] + w->r_th[1];
  if (!w->present || !(w->c_th[0] > 0) || !(fastest > 0)) return;
  const int parts = (int)fmin(ceil(50 * by_s / fastest), MOST);
  const double h = by_s / parts;
  for (int n = 0; n < parts; n++) {
    double d[2] = {0, 0};
    for (int half = 0; half < 2; half++) {
      const double t_w = s->winding_degc + h / 2 * d[0], t_c = s->core_degc + h / 2 * d[1];
      if (is_one_body(w)) {
        d[0] = d[1] = (copper_w + core_w - (t_w - w->ambient_degc) / r) / (w->c_th[0] + w->c_th[1]);
        continue;
      }
      const double flow_w = (t_w - t_c) / w->r_th[0];
      const double off_w = w->r_th[1] > 0 ? (t_c - w->ambient_degc) / w->r_th[1] : 0;
      d[0] = (copper_w - flow_w) / w->c_th[0];
      d[1] = (core_w + flow_w - off_w) / w->c_th[1];
    }
    s->winding_degc += h * d[0];
    s->core_degc += h * d[1];
  }
}
