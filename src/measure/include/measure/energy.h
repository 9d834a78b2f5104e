/* SPDX-License-Identifier: GPL-3.0-or-later
 * Watcher that keeps the books of energy. Every term is integrated on its own, so that a balance
 * that does not close shows an error. */
#pragma once

#include <stdbool.h>

#include "engine/batch.h"

/* The terms, all in J. id, name, text */
#define VS_ENERGY_LIST(X)                                                                          \
  X(VS_E_SOURCE, "source", "drawn from the mains, int u i dt")                                     \
  X(VS_E_PORT, "eva", "taken in by the EVA, int v i dt")                                           \
  X(VS_E_COPPER, "copper", "lost in the coil, int R_c i^2 dt")                                     \
  X(VS_E_WORK, "work_force", "done by the force on the machine, int -F g' dt")                     \
  X(VS_E_DAMPING, "damping", "lost in springs and mounts, int q'.B q' dt")                         \
  X(VS_E_STOP, "stop", "lost in stops, while they are touched")                                    \
  X(VS_E_MAGNETIC, "magnetic", "gained in the coil's field, W(lambda, z)")                         \
  X(VS_E_MECHANICAL, "mechanical", "gained in the machine, (q'.M q' + q.K q)/2, and in the stop")  \
  X(VS_E_TRANSDUCER, "transducer",                                                                 \
    "lost between a coil whose two constants differ and the machine")                              \
  X(VS_E_LOAD, "load", "brought by what is added to the load, at the trough's velocity")           \
  X(VS_E_EDDY, "eddy", "lost by eddy currents and in the core, sum of int R i^2 dt")

enum {
#define VS_ENERGY_ID(id, name, text) id,
  VS_ENERGY_LIST(VS_ENERGY_ID)
#undef VS_ENERGY_ID
      VS_ENERGIES
};
extern const char *const vs_energy_names[VS_ENERGIES];
/* True if the machine has that term: the last three are of coils that have a transducer, of
 * scenes in which events change the load, and of coils with eddy currents alone. */
bool vs_energy_has(const vs_model *model, int term);

/* The balances. Each is what comes in, less what is lost and stored. id, name, text */
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
extern const char *const vs_energy_balance_names[VS_BALANCES];

/* Start from {0} with the frame set. The frame is borrowed. */
typedef struct vs_energy {
  const vs_frame *frame;
  const vs_model *model; /* of the last step: the load may have changed */
  double joule[VS_ENERGIES];
  struct {
    int i, j;
    double b;
  } damping[VS_MOST_DOF * VS_MOST_DOF]; /* the coefficients of B that are not 0, by rows */
  int n_damping;
  double loss_w[VS_DECK_MOST];  /* the deck's loss lines at the end of the last step taken */
  double loss_j[VS_DECK_MOST];  /* their integrals */
  double store_j[VS_DECK_MOST]; /* what the deck's store lines have gained since the beginning */
  vs_knot first, last;          /* of the steps accepted so far; of the last its time, state, flux
                                   linkages and terms alone */
  double began_j;               /* the machine's energy at the first */
  long steps;
  double left_j[VS_BALANCES];     /* what each balance leaves over when it was last taken */
  double furthest_j[VS_BALANCES]; /* the most that it left over so far, with its sign */
  double furthest_s[VS_BALANCES]; /* and when */
  bool balanced[VS_BALANCES];   /* false: there is nothing to balance, as the deck declares neither
                                   losses nor stores */
  double residual[VS_BALANCES]; /* left_j as a part of the work of the force, of 1 % of what was
                                   drawn from the mains, of what the machine had at the first knot
                                   or, with constant forces, of what damping took, whichever is
                                   most; in J where the first two are 0 */
  double worst;                 /* the largest |residual| */
} vs_energy;

/* Takes one accepted step, but for what the deck's losses are in it. The balances are taken every
 * 32 steps. */
void vs_energy_accept(vs_energy *energy, const vs_step *step);
/* Takes the losses of some steps that were accepted; `all`: up to the last one. They must be known
 * to the last step when the balances are taken: where the deck has any, once vs_energy_is_due
 * returns true. */
void vs_energy_take_losses(vs_energy *energy, const vs_batch *batch, bool all);
/* True if vs_energy_take_losses is to take balances now. */
bool vs_energy_is_due(const vs_energy *energy);
/* Takes the balances at the end of the run and fills balanced, residual and worst. With a one-way
 * force (analytic tier) the EVA's balance leaves the work out, as nothing supplies it. */
void vs_energy_finish(vs_energy *energy);
/* Sets to 0 what is no more than the rounding of the largest term, once all is finished. */
void vs_energy_round_off(vs_energy *energy);

/* What a balance may leave over without a warning, times run.tolerance and vs_energy_whole. */
enum { VS_ENERGY_ALLOWED = 10 };
/* The work of the force, what was drawn from the mains, what damping took or what the machine had
 * at the first knot, whichever is most, J; where nothing is drawn from mains, what the EVA took,
 * too. */
double vs_energy_whole(const vs_energy *energy);

/* Returns NULL where the books close, at the end and on the way. Otherwise writes into the buffer
 * which balance does not, and returns it. A balance may leave VS_ENERGY_ALLOWED times the tolerance
 * of vs_energy_whole. */
const char *vs_energy_open(const vs_energy *energy, double tolerance, char *buffer, size_t size);
