/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "actuator/reluctance.h"

#include "actuator/coil.h"
#include "actuator/leakage.h"
#include "actuator/saturation.h"
#include "actuator/values.h"

static vs_status build(const vs_actuator_values *v, const vs_node *map,
                       const vs_law_formulas *formulas, vs_coil *c, vs_error *err) {
  (void)map, (void)formulas, (void)err;
  c->square = true;
  c->rest_h = v->inductance_h;
  c->a_hm = v->inductance_h * c->gap_rest_m / 2;
  if (v->saturation.present) vs_saturation_add(c, &v->saturation);
  if (v->leakage_h > 0) vs_leakage_add(c, v->leakage_h);
  return VS_OK;
}

static double current(const vs_coil *c, double flux_wb, double z_m) {
  return flux_wb * z_m / (2 * c->a_hm);
}

static double force(const vs_coil *c, double flux_wb, double z_m) {
  (void)z_m;
  return flux_wb * flux_wb / (4 * c->a_hm);
}

static double energy(const vs_coil *c, double flux_wb, double z_m) {
  return flux_wb * flux_wb * z_m / (4 * c->a_hm);
}

static void along(const vs_coil *c, const double flux[3], const double z[3], double current[3],
                  double force[3]) {
  double per_2a = 1 / (2 * c->a_hm);
  current[0] = flux[0] * z[0] * per_2a;
  current[1] = (flux[1] * z[0] + flux[0] * z[1]) * per_2a;
  current[2] = (flux[2] * z[0] + 2 * flux[1] * z[1] + flux[0] * z[2]) * per_2a;
  force[0] = flux[0] * flux[0] * per_2a / 2;
  force[1] = flux[0] * flux[1] * per_2a;
  force[2] = (flux[1] * flux[1] + flux[0] * flux[2]) * per_2a;
}

static void netlist(const vs_coil *c, const char *flux, const char *gap, vs_text *lines,
                    vs_text *current, vs_text *force) {
  (void)lines;
  vs_text_add(current, "%s*%s/(%.17g)", flux, gap, 2 * c->a_hm);
  vs_text_add(force, "%s*%s/(%.17g)", flux, flux, 4 * c->a_hm);
}

const vs_law vs_reluctance_law = {.name = "reluctance",
                                  .text = "i = lambda z/(2a), F = lambda^2/(4a), with saturation "
                                          "and leakage where the scene has them",
                                  .keys = "inductance|leakage|saturation",
                                  .build = build,
                                  .poles = true,
                                  .current = current,
                                  .force = force,
                                  .energy = energy,
                                  .along = along,
                                  .netlist = netlist};
