/* SPDX-License-Identifier: GPL-3.0-or-later
 * Tier "compiled": as tier "circuit" (coupled.c), with the netlist and the machine as one system of
 * equations of the program's own (compiled/compiled.h) in the place of ngspice. */
#include "compiled/compiled.h"

#include "coupled/coupled.h"
#include "engine/sim.h"

static vs_status run_compiled(const vs_setup *setup, const vs_run_order *order,
                              const vs_observer *observer, vs_error *err) {
  vs_run_order own = *order;
  own.solver = &vs_compiled_kind;
  own.stand_in = NULL;
  return vs_coupled_tier.run(setup, &own, observer, err);
}

const vs_tier vs_compiled_tier = {.name = vs_setup_tier_words[VS_TIER_COMPILED],
                                  .text = "the same netlist as equations of the program's own: "
                                          "searches and studies, judged by ngspice",
                                  .finest = 1e-7,
                                  .has_circuit = true,
                                  .keys = vs_coupled_keys,
                                  .run = run_compiled};
