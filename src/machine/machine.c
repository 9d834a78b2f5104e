/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "machine/machine.h"

#include <stddef.h>
#include <string.h>

/* Transitional: the conveyor's declarations in C, until its file is read. */
#define M_(member) offsetof(vs_machine_values, member)
static vs_field CONVEYOR[] = {
    {"trough_mass", VS_REAL, "kg", "0.83 kg", 1e-6, 1e4, false, M_(real[0]),
     "m_k0, empty trough with armature (Table 1)", NULL, NULL},
    {"base_mass", VS_REAL, "kg", "4 kg", 1e-6, 1e5, false, M_(real[1]), "m_B, base (Table 1)", NULL,
     NULL},
    {"trough_inertia", VS_REAL, "kg.m2", "3.86e-3 kg.m2", 1e-12, 1e4, false, M_(real[2]),
     "J_k0, trough about its centre of mass (Table 1)", NULL, NULL},
    {"base_inertia", VS_REAL, "kg.m2", "0.017 kg.m2", 1e-12, 1e5, false, M_(real[3]),
     "J_B, base about its centre of mass (Table 1)", NULL, NULL},
    {"spring_angle", VS_REAL, "deg", "70 deg", 0, 180, false, M_(real[4]),
     "alpha, inclination of the leaf springs (Table 1)", NULL, NULL},
    {"base_com", VS_PAIR, "mm", "194 mm, 89 mm", -1e5, 1e5, false, M_(real[5]),
     "B, centre of mass of the base (Table 1)", NULL, NULL},
    {"trough_com", VS_PAIR, "mm", "92 mm, 129 mm", -1e5, 1e5, false, M_(real[7]),
     "C, centre of mass of the trough (Table 1)", NULL, NULL},
    {"mount_3", VS_PAIR, "mm", "33 mm, 15 mm", -1e5, 1e5, false, M_(real[9]),
     "K3, rubber mount (Table 1)", NULL, NULL},
    {"mount_4", VS_PAIR, "mm", "211.83 mm, 15 mm", -1e5, 1e5, false, M_(real[11]),
     "K4, rubber mount (Table 1)", NULL, NULL},
    {"spring_stiffness", VS_REAL, "N/m", "0.43e5 N/m", 0, 1e12, true, M_(real[13]),
     "k, each of the two leaf springs (Table 1)", NULL, NULL},
    {"mount_stiffness_x", VS_REAL, "N/m", "0.08e5 N/m", 0, 1e12, true, M_(real[14]),
     "k_x, each mount, horizontal (Table 1)", NULL, NULL},
    {"mount_stiffness_y", VS_REAL, "N/m", "0.4e5 N/m", 0, 1e12, true, M_(real[15]),
     "k_y, each mount, vertical (Table 1)", NULL, NULL},
    {"spring_damping", VS_REAL, "N.s/m", "1.2 N.s/m", 0, 1e9, false, M_(real[16]),
     "beta, each leaf spring (Table 1)", NULL, NULL},
    {"mount_damping_x", VS_REAL, "N.s/m", "0.1 N.s/m", 0, 1e9, false, M_(real[17]),
     "beta_x, each mount, horizontal (Table 1)", NULL, NULL},
    {"mount_damping_y", VS_REAL, "N.s/m", "0.5 N.s/m", 0, 1e9, false, M_(real[18]),
     "beta_y, each mount, vertical (Table 1)", NULL, NULL},
    {"m14", VS_CHOICE, "", "paper", 0, 0, false, M_(choice[0]),
     "inertia coupling p-phi: the paper's zero, or as Eq. 55 gives it", "paper|derived", NULL},
};

#define START_(key, unit, limit, index, text)                                                      \
  {                                                                                                \
    key, VS_REAL, unit, "0 " unit, -limit, limit, false, (index) * sizeof(double), text, NULL,     \
        NULL                                                                                       \
  }
static const vs_field START[] = {
    START_("p", "mm", 1000, 0, "p at t = 0"),
    START_("u", "mm", 1000, 1, "u at t = 0"),
    START_("w", "mm", 1000, 2, "w at t = 0"),
    START_("phi", "rad", 1, 3, "phi at t = 0"),
    START_("vp", "m/s", 100, 4, "velocity of p at t = 0: a kick"),
    START_("vu", "m/s", 100, 5, "velocity of u at t = 0"),
    START_("vw", "m/s", 100, 6, "velocity of w at t = 0"),
    START_("vphi", "rad/s", 1000, 7, "velocity of phi at t = 0"),
};

bool vs_machine_has_output(const vs_machine *machine, const char *name) {
  for (int k = 0; k < machine->dof; k++) {
    const vs_coordinate *c = &machine->coordinates[k];
    if (!strcmp(name, c->name) || !strcmp(name, c->rate) || !strcmp(name, c->rate2)) return true;
  }
  for (int k = 0; k < machine->n_probes; k++)
    if (!strcmp(name, machine->probes[k].name)) return true;
  return false;
}

const vs_machine vs_machine_conveyor = {
    .title = "conveyor",
    .section = {"machine", CONVEYOR, sizeof CONVEYOR / sizeof *CONVEYOR},
    .start = {"start", START, sizeof START / sizeof *START},
    .dof = 4,
    .coordinates = {
        {"p",
         "m",
         "trough relative to base, along the springs' motion",
         "vp",
         "m/s",
         "velocity of p",
         "ap",
         "m/s2",
         "acceleration of p",
         {0}},
        {"u",
         "m",
         "base, horizontal",
         "vu",
         "m/s",
         "velocity of u",
         "au",
         "m/s2",
         "acceleration of u",
         {0}},
        {"w",
         "m",
         "base, vertical",
         "vw",
         "m/s",
         "velocity of w",
         "aw",
         "m/s2",
         "acceleration of w",
         {0}},
        {"phi",
         "rad",
         "base, rotation, counter-clockwise",
         "vphi",
         "rad/s",
         "velocity of phi",
         "aphi",
         "rad/s2",
         "acceleration of phi",
         {0}},
    }};
