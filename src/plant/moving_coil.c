/* SPDX-License-Identifier: GPL-3.0-or-later
 * Law "moving_coil": a coil that moves in the field of a magnet, as in a shaker or a loudspeaker.
 *
 * With g = z - z_rest, so that lambda = 0 without current at rest:
 *
 *   lambda = L i + k_e g      i = (lambda - k_e g)/L      W = L i^2/2 = (lambda - k_e g)^2/(2 L)
 *   v = R i + L i' + k_e g'   F = -k_f i, as force_n is positive where it closes the gap
 *
 * Where k_f = k_e, F = dW/dz. Otherwise the magnet's motion takes k_e i g' from the circuit and
 * gives k_f i g' to the armature. */
#include "plant/law.h"

#include <math.h>
#include <stdlib.h>

#include "plant/coil.h"
#include "plant/values.h"

typedef struct constants {
  double emf_vs_m, force_n_a;
} constants;

static vs_status moving_coil_build(const vs_actuator_values *v, const vs_node *map,
                                   const vs_law_formulas *formulas, vs_coil *c, vs_error *err) {
  (void)map, (void)formulas, (void)err;
  constants *own = vs_alloc(1, sizeof *own);
  own->emf_vs_m = v->emf_constant_vs_m;
  own->force_n_a = isnan(v->force_constant_n_a) ? v->emf_constant_vs_m : v->force_constant_n_a;
  c->own = own;
  c->rest_h = v->inductance_h;
  return VS_OK;
}

static void moving_coil_end(vs_coil *c) {
  free(c->own);
  c->own = NULL;
}

static double moving_coil_current(const vs_coil *c, double flux_wb, double z_m) {
  const constants *k = c->own;
  return (flux_wb - k->emf_vs_m * (z_m - c->gap_rest_m)) / c->rest_h;
}

static double moving_coil_force(const vs_coil *c, double flux_wb, double z_m) {
  const constants *k = c->own;
  return -k->force_n_a * moving_coil_current(c, flux_wb, z_m);
}

static double moving_coil_energy(const vs_coil *c, double flux_wb, double z_m) {
  double i = moving_coil_current(c, flux_wb, z_m);
  return c->rest_h * i * i / 2;
}

static void moving_coil_along(const vs_coil *c, const double flux[3], const double z[3],
                              double i[3], double f[3]) {
  const constants *k = c->own;
  i[0] = moving_coil_current(c, flux[0], z[0]);
  for (int n = 1; n < 3; n++) i[n] = (flux[n] - k->emf_vs_m * z[n]) / c->rest_h;
  for (int n = 0; n < 3; n++) f[n] = -k->force_n_a * i[n];
}

static double transducer_w(const vs_coil *c, double flux_wb, double z_m, double z_rate_m_s) {
  const constants *k = c->own;
  return (k->emf_vs_m - k->force_n_a) * moving_coil_current(c, flux_wb, z_m) * z_rate_m_s;
}

static void moving_coil_netlist(const vs_coil *c, const char *flux, const char *gap, vs_text *lines,
                                vs_text *current, vs_text *force) {
  const constants *k = c->own;
  (void)lines;
  vs_text_add(current, "(%s-(%.17g)*(%s-(%.17g)))/(%.17g)", flux, k->emf_vs_m, gap, c->gap_rest_m,
              c->rest_h);
  vs_text_add(force, "-(%.17g)*(%s-(%.17g)*(%s-(%.17g)))/(%.17g)", k->force_n_a, flux, k->emf_vs_m,
              gap, c->gap_rest_m, c->rest_h);
}

const vs_law vs_moving_coil_law = {
    .name = "moving_coil",
    .text = "lambda = L i + k_e g, force k_f i that opens the gap: a coil in a magnet's field",
    .keys = "inductance|emf_constant|force_constant",
    .build = moving_coil_build,
    .end = moving_coil_end,
    .current = moving_coil_current,
    .force = moving_coil_force,
    .energy = moving_coil_energy,
    .along = moving_coil_along,
    .transducer_w = transducer_w,
    .netlist = moving_coil_netlist};
