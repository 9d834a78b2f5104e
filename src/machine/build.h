/* SPDX-License-Identifier: GPL-3.0-or-later
 * How the sections of a scene become the numbers of a machine. */
#ifndef VS_MACHINE_BUILD_H
#define VS_MACHINE_BUILD_H

#include "machine/model.h"

/* Builds the model from the scene's sections machine, actuator and load, of which each may be
 * missing. Errors: what vs_field_section_read refuses (the model is then not whole, even if a check
 * carries on); an M or K that is not positive definite. */
vs_status vs_build_model(const vs_node *scene, vs_model *model, vs_error *err);

#endif
