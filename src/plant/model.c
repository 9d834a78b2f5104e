/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plant/model.h"

#include <math.h>
#include <stddef.h>

#define L_(member) offsetof(vs_load_values, member)

static const vs_field LOAD[] = {
    {"density", VS_REAL, "g/cm3", "0 g/cm3", 0, 30, false, L_(density_kg_m3),
     "rho, conveyed material (Eq. 88)", NULL, NULL},
    {"volume", VS_REAL, "cm3", "380 cm3", 0, 1e9, false, L_(volume_m3),
     "V_k, trough (Eq. 88; Table 1 gives 380 and 269)", NULL, NULL},
    {"fraction", VS_REAL, "", "0", 0, 1, false, L_(fraction),
     "lambda_t, share of the material that rides (Eq. 88); adds to m_k only; auto: empirical, from "
     "the throw coefficient on the orbit",
     "auto", NULL},
};
const vs_section vs_model_load_section = {"load", LOAD, sizeof LOAD / sizeof *LOAD};

const double vs_model_gravity_m_s2 = 9.81;

/* The paper, below Eq. 88: 3.3 > K > 1 belongs to 0.6 > lambda_t > 0.1. */
const vs_load_range vs_model_load_range = {1, 3.3, 0.1, 0.6};

double vs_model_fraction(double k) {
  const vs_load_range *r = &vs_model_load_range;
  double part = fmin(fmax((k - r->least_k) / (r->most_k - r->least_k), 0), 1);
  return r->least + part * (r->most - r->least);
}
