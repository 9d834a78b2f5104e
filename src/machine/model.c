/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "machine/model.h"

#include <stddef.h>

#define M_(member) offsetof(vs_machine_values, member)
#define A_(member) offsetof(vs_actuator_values, member)
#define L_(member) offsetof(vs_load_values, member)

static const vs_field MACHINE[] = {
    {"trough_mass", VS_REAL, "kg", "0.83 kg", 1e-6, 1e4, false, M_(trough_mass_kg),
     "m_k0, empty trough with armature (Table 1)", NULL, NULL},
    {"base_mass", VS_REAL, "kg", "4 kg", 1e-6, 1e5, false, M_(base_mass_kg), "m_B, base (Table 1)",
     NULL, NULL},
    {"trough_inertia", VS_REAL, "kg.m2", "3.86e-3 kg.m2", 1e-12, 1e4, false,
     M_(trough_inertia_kgm2), "J_k0, trough about its centre of mass (Table 1)", NULL, NULL},
    {"base_inertia", VS_REAL, "kg.m2", "0.017 kg.m2", 1e-12, 1e5, false, M_(base_inertia_kgm2),
     "J_B, base about its centre of mass (Table 1)", NULL, NULL},
    {"spring_angle", VS_REAL, "deg", "70 deg", 0, 180, false, M_(spring_angle_rad),
     "alpha, inclination of the leaf springs (Table 1)", NULL, NULL},
    {"base_com", VS_PAIR, "mm", "194 mm, 89 mm", -1e5, 1e5, false, M_(base_com_m),
     "B, centre of mass of the base (Table 1)", NULL, NULL},
    {"trough_com", VS_PAIR, "mm", "92 mm, 129 mm", -1e5, 1e5, false, M_(trough_com_m),
     "C, centre of mass of the trough (Table 1)", NULL, NULL},
    {"mount_3", VS_PAIR, "mm", "33 mm, 15 mm", -1e5, 1e5, false, M_(mount_3_m),
     "K3, rubber mount (Table 1)", NULL, NULL},
    {"mount_4", VS_PAIR, "mm", "211.83 mm, 15 mm", -1e5, 1e5, false, M_(mount_4_m),
     "K4, rubber mount (Table 1)", NULL, NULL},
    {"spring_stiffness", VS_REAL, "N/m", "0.43e5 N/m", 0, 1e12, true, M_(spring_stiffness_n_m),
     "k, each of the two leaf springs (Table 1)", NULL, NULL},
    {"mount_stiffness_x", VS_REAL, "N/m", "0.08e5 N/m", 0, 1e12, true, M_(mount_stiffness_x_n_m),
     "k_x, each mount, horizontal (Table 1)", NULL, NULL},
    {"mount_stiffness_y", VS_REAL, "N/m", "0.4e5 N/m", 0, 1e12, true, M_(mount_stiffness_y_n_m),
     "k_y, each mount, vertical (Table 1)", NULL, NULL},
    {"spring_damping", VS_REAL, "N.s/m", "1.2 N.s/m", 0, 1e9, false, M_(spring_damping_ns_m),
     "beta, each leaf spring (Table 1)", NULL, NULL},
    {"mount_damping_x", VS_REAL, "N.s/m", "0.1 N.s/m", 0, 1e9, false, M_(mount_damping_x_ns_m),
     "beta_x, each mount, horizontal (Table 1)", NULL, NULL},
    {"mount_damping_y", VS_REAL, "N.s/m", "0.5 N.s/m", 0, 1e9, false, M_(mount_damping_y_ns_m),
     "beta_y, each mount, vertical (Table 1)", NULL, NULL},
    {"m14", VS_CHOICE, "", "paper", 0, 0, false, M_(m14),
     "inertia coupling p-phi: the paper's zero, or as Eq. 55 gives it", "paper|derived", NULL},
};
/* Elastic stop: F = k delta + c delta' while the indentation delta = -D - p is positive, so it may
 * pull. */
static const vs_field STOP[] = {
    {"stiffness", VS_REAL, "N/m", "1e7 N/m", 0, 1e12, true, offsetof(vs_stop_values, stiffness_n_m),
     "k of the elastic stop", NULL, NULL},
    {"damping", VS_REAL, "N.s/m", "300 N.s/m", 0, 1e9, false,
     offsetof(vs_stop_values, damping_ns_m), "c of the elastic stop", NULL, NULL},
};
static const vs_section STOP_SECTION = {"actuator.stop", STOP, sizeof STOP / sizeof *STOP};
static const vs_field ACTUATOR[] = {
    {"gap", VS_REAL, "mm", "6 mm", 0, 1e3, true, A_(gap_m),
     "D, armature to pole cover at rest (Table 1)", NULL, NULL},
    {"pole_cover", VS_REAL, "mm", "0.5 mm", 0, 1e3, false, A_(pole_cover_m),
     "d, bronze pole cover (Table 1)", NULL, NULL},
    {"inductance", VS_REAL, "H", "1.6 H", 0, 1e4, true, A_(inductance_h),
     "L(0), coil at rest (Table 1)", NULL, NULL},
    {"resistance", VS_REAL, "ohm", "92 ohm", 0, 1e6, true, A_(resistance_ohm),
     "R_c, coil (Table 1)", NULL, NULL},
    {"stop", VS_OPTION, "", "none", 0, 0, false, A_(stop),
     "what the armature meets at p = -D; with none a run that gets there ends with an error",
     "none", &STOP_SECTION},
};
static const vs_field LOAD[] = {
    {"density", VS_REAL, "g/cm3", "0 g/cm3", 0, 30, false, L_(density_kg_m3),
     "rho, conveyed material (Eq. 88)", NULL, NULL},
    {"volume", VS_REAL, "cm3", "380 cm3", 0, 1e9, false, L_(volume_m3),
     "V_k, trough (Eq. 88; Table 1 gives 380 and 269)", NULL, NULL},
    {"fraction", VS_REAL, "", "0", 0, 1, false, L_(fraction),
     "lambda_t, share of the material that rides (Eq. 88); adds to m_k only", NULL, NULL},
};
const vs_section vs_model_machine_section = {"machine", MACHINE, sizeof MACHINE / sizeof *MACHINE};
const vs_section vs_model_actuator_section = {"actuator", ACTUATOR,
                                              sizeof ACTUATOR / sizeof *ACTUATOR};
const vs_section vs_model_load_section = {"load", LOAD, sizeof LOAD / sizeof *LOAD};
