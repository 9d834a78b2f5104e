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
  X(VS_E_MAGNETIC, "magnetic", "gained in the air gap, lambda^2 z/4a")                             \
  X(VS_E_MECHANICAL, "mechanical", "gained in the machine, (q'.M q' + q.K q)/2, and in the stop")

enum {
#define VS_ENERGY_ID(id, name, text) id,
  VS_ENERGY_LIST(VS_ENERGY_ID)
#undef VS_ENERGY_ID
      VS_ENERGIES
};
extern const char *const vs_energy_names[VS_ENERGIES];

/* The balances; each is what comes in less what is lost and stored. id, name, text */
#define VS_BALANCE_LIST(X)                                                                         \
  X(VS_B_EVA, "eva", "eva - copper - magnetic - work_force")                                       \
  X(VS_B_MECHANICAL, "mechanical", "work_force - damping - stop - mechanical")                     \
  X(VS_B_CIRCUIT, "circuit", "source - losses - stores - eva")

enum {
#define VS_BALANCE_ID(id, name, text) id,
  VS_BALANCE_LIST(VS_BALANCE_ID)
#undef VS_BALANCE_ID
      VS_BALANCES
};
extern const char *const vs_energy_balance_names[VS_BALANCES],
    *const vs_energy_balance_texts[VS_BALANCES];

/* Start from {0} with the frame set. */
typedef struct vs_energy {
  const vs_frame *frame;
  double joule[VS_ENERGIES];
  double loss_w[VS_DECK_MOST];  /* of the deck's loss lines, at the last step's end */
  double loss_j[VS_DECK_MOST];  /* their integrals */
  double store_j[VS_DECK_MOST]; /* of the deck's store lines: gained since the beginning */
  vs_knot first, last;          /* of the steps shown */
  long steps;
  double left_j[VS_BALANCES];                              /* what each balance leaves over */
  double furthest_j[VS_BALANCES], furthest_s[VS_BALANCES]; /* the most on the way, and when */
  bool balanced[VS_BALANCES];   /* false: nothing to balance (a deck without losses and stores) */
  double residual[VS_BALANCES]; /* relative to the work of the force or to 1 % of what was drawn
                                   from the mains, whichever is more; in J where both are 0 */
  double worst;                 /* the largest of them */
} vs_energy;

void vs_energy_accept(vs_energy *energy, const vs_step *step);
/* Fills balanced, residual and worst. With a one-way force (analytic tier) the EVA's balance leaves
 * the work out: nothing supplies it. */
void vs_energy_finish(vs_energy *energy);

/* What may be left over before it is warned of, times run.tolerance and the whole below. */
enum { VS_ENERGY_ALLOWED = 10 };
/* The work of the force or what was drawn from the mains, whichever is more, J. */
double vs_energy_whole(const vs_energy *energy);

/* Do the books close, on the way and at the end? A balance may leave ten times run.tolerance of the
 * work of the force or of what was drawn from the mains, whichever is more. NULL: they do; else the
 * buffer says which does not. */
const char *vs_energy_open(const vs_energy *energy, double tolerance, char *buffer, size_t size);

#endif
