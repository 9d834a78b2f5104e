/* SPDX-License-Identifier: GPL-3.0-or-later
 * How the sections of a scene become the numbers of a machine. */
#pragma once

#include "plant/model.h"

/* Builds the model from the machine and the scene's sections machine, actuator and load, of which
 * each may be missing. The machine's formulas are bound to these values; the model borrows it. The
 * caller ends model->coil with vs_actuator_end, also after an error. Errors: what
 * vs_field_section_read refuses; a value that is not finite, an M or a K that is not symmetric or
 * not positive definite, a gap that no coordinate opens (the model is then not whole, even if a
 * check carries on); a load where the machine has none. */
vs_status vs_build_model(const vs_node *scene, vs_machine *machine, vs_model *model, vs_error *err);

/* The same over a model that was built before, or is {0}, which is kept where the three sections
 * have not changed since. written: their text then, {0} at first; the caller frees it. A model
 * whose load is auto is always built, as its load is put in its place later. Ends the model's coil
 * where it builds another. */
vs_status vs_build_again(const vs_node *scene, vs_machine *machine, vs_model *model,
                         vs_text *written, vs_error *err);

/* Builds in `out` the model `from` with another load: these values of the section, of which the
 * share `riding` rides. `out` may be `from`; it borrows what that one's coil owns, and is not to be
 * ended. Errors: as of vs_build_model. */
vs_status vs_build_loaded(vs_machine *machine, const vs_model *from, const vs_load_values *load,
                          double riding, vs_model *out, vs_error *err);
