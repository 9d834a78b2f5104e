/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "conveyor.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define ROW(key, member)                                                                           \
  { key, offsetof(conveyor_values, member), sizeof(((conveyor_values *)0)->member) }
static const struct {
  const char *key;
  size_t offset, size;
} ROWS[] = {
    ROW("trough_mass", trough_mass_kg),
    ROW("base_mass", base_mass_kg),
    ROW("trough_inertia", trough_inertia_kgm2),
    ROW("base_inertia", base_inertia_kgm2),
    ROW("spring_angle", spring_angle_rad),
    ROW("base_com", base_com_m),
    ROW("trough_com", trough_com_m),
    ROW("mount_3", mount_3_m),
    ROW("mount_4", mount_4_m),
    ROW("spring_stiffness", spring_stiffness_n_m),
    ROW("mount_stiffness_x", mount_stiffness_x_n_m),
    ROW("mount_stiffness_y", mount_stiffness_y_n_m),
    ROW("spring_damping", spring_damping_ns_m),
    ROW("mount_damping_x", mount_damping_x_ns_m),
    ROW("mount_damping_y", mount_damping_y_ns_m),
    ROW("m14", m14),
};
#undef ROW

/* By the keys of the machine's section: where a value lies in the machine's own struct is no
 * business of a test. */
conveyor_values conveyor_values_of(const vs_model *model) {
  conveyor_values v;
  const vs_section *section = &model->machine->section;
  for (size_t r = 0; r < sizeof ROWS / sizeof *ROWS; r++) {
    const vs_field *field = NULL;
    for (size_t k = 0; k < section->count; k++)
      if (!strcmp(section->fields[k].key, ROWS[r].key)) field = &section->fields[k];
    if (!field) abort();
    memcpy((char *)&v + ROWS[r].offset, (const char *)&model->parameters + field->offset,
           ROWS[r].size);
  }
  return v;
}
