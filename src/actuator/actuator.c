/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "actuator/actuator.h"

#include <stddef.h>

#include "actuator/reluctance.h"

#define A_(member) offsetof(vs_actuator_values, member)

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
const vs_section vs_actuator_section = {"actuator", ACTUATOR, sizeof ACTUATOR / sizeof *ACTUATOR};

void vs_actuator_end(vs_coil *coil) {
  if (coil->law && coil->law->end) coil->law->end(coil);
}

vs_status vs_actuator_build(const vs_actuator_values *v, const vs_node *map,
                            const vs_law_formulas *formulas, vs_coil *coil, vs_stops *stops,
                            vs_error *err) {
  *coil = (vs_coil){.law = &vs_reluctance_law,
                    .resistance_ohm = v->resistance_ohm,
                    .gap_rest_m = v->gap_m + v->pole_cover_m};
  vs_status status = coil->law->build(v, map, formulas, coil, err);
  if (status) return status;
  *stops = (vs_stops){0};
  if (v->stop.present)
    stops->item[stops->count++] = (vs_stop){.kind = &vs_stop_linear,
                                            .side = 1,
                                            .at_m = -v->gap_m,
                                            .stiffness = v->stop.stiffness_n_m,
                                            .damping_ns_m = v->stop.damping_ns_m};
  return VS_OK;
}
