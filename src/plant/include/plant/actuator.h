/* SPDX-License-Identifier: GPL-3.0-or-later
 * The scene's section actuator: coil, gap and stops, and the laws that a coil may have. */
#pragma once

#include "plant/coil.h"
#include "plant/values.h"

extern const vs_section vs_actuator_section;

/* The laws, in the order of lists; NULL behind the last. */
extern const vs_law *const vs_actuator_laws[];

/* Makes the coil and the stops of these values. map: the section they were read from, for the
 * places of errors; NULL where the scene has none. Errors: an unknown law, a key that the law does
 * not use, and the law's own; the coil then has no law. The caller frees the coil with
 * vs_actuator_end. */
vs_status vs_actuator_build(const vs_actuator_values *values, const vs_node *map,
                            const vs_law_formulas *formulas, vs_coil *coil, vs_stops *stops,
                            vs_error *err);
void vs_actuator_end(vs_coil *coil);
