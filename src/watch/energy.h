/* SPDX-License-Identifier: GPL-3.0-or-later
 * Watcher that keeps the books of energy, each term integrated on its own. */
#ifndef VS_WATCH_ENERGY_H
#define VS_WATCH_ENERGY_H

#include <stdbool.h>

#include "sim/step.h"

/* name, text; all J */
#define VS_ENERGY_LIST(X)                                                                          \
  X(VS_E_SOURCE, "source", "drawn from the mains, int u i dt")                                     \
  X(VS_E_PORT, "eva", "taken in by the EVA, int v i dt")                                           \
  X(VS_E_COPPER, "copper", "lost in the coil, int R_c i^2 dt")                                     \
  X(VS_E_WORK, "work_force", "done by the force on the machine, int -F p' dt")                     \
  X(VS_E_DAMPING, "damping", "lost in springs and mounts, int q'.B q' dt")                         \
  X(VS_E_STOP, "stop", "lost in the stop, int c p'^2 dt while it is touched")                      \
  X(VS_E_MAGNETIC, "magnetic", "stored in the air gap at the end, lambda^2 z/4a")                  \
  X(VS_E_MECHANICAL, "mechanical",                                                                 \
    "stored in the machine at the end, (q'.M q' + q.K q)/2, and in the stop")

enum {
#define VS_ENERGY_ID(id, name, text) id,
  VS_ENERGY_LIST(VS_ENERGY_ID)
#undef VS_ENERGY_ID
      VS_ENERGIES
};
extern const char *const vs_energy_names[VS_ENERGIES];

typedef struct vs_energy {
  bool one_way; /* the force draws nothing from the circuit (analytic tier) */
  double joule[VS_ENERGIES];
  double residual;            /* EVA: (eva - copper - magnetic - work)/work; see vs_energy_finish */
  double mechanical_residual; /* (work - damping - stop - mechanical)/work */
} vs_energy;

void vs_energy_accept(vs_energy *energy, const vs_step *step);
/* Residuals, relative to the work of the force, in J where that is 0. With a one-way force the
 * EVA's balance leaves the work out: nothing supplies it. */
void vs_energy_finish(vs_energy *energy);

#endif
