/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the loss of a device is made of: conduction, switching, recovery, blocking. It is told from
 * the voltage and current at the device's terminals alone. Each instant belongs to one of them, so
 * that they add up to the integral of v i.
 *
 * IEC 60747-8 and -9 let a turn-on begin at 10 % of the voltage at the gate and end at 2 % of the
 * off-state voltage, and a turn-off begin at 90 % at the gate and end at 2 % of the current. The
 * gate's voltage is not known here. These are the program's own definitions:
 *
 *   conduction   |v| is at most V1. V1 is 10 V, or a tenth of the largest |v| that the device has
 *                borne so far where that is 10 to 100 V
 *   blocking     |v| is above V1, and |i| is at most I1. I1 is 2 % of the |i| at which the last
 *                conduction ended, and 1 mA at least
 *   turn-off     |v| is above V1 and |i| above I1, and conduction was before
 *   turn-on      the same, and blocking was before
 *
 * Switching is turn-on and turn-off. Of a straight rise of the current to I at the voltage V, and
 * a straight fall of the voltage behind it, a turn-on so counted misses (I1/I)^2 of the first and
 * (V1/V)^2 of the second half. A turn-on that ends in blocking, or a turn-off that ends in
 * conduction, counts in the sums and not among the single energies.
 *
 * A diode has no gate, and its current tells the phases:
 *
 *   conduction   v and i are forward, so that the forward recovery is part of it
 *   recovery     from the current's zero behind a conduction until |i| is at most 2 % of the
 *                largest reverse current since then, or at most 1 mA, and v is not forward
 *   blocking     everything else
 *
 * What a capacitance of the device stores and gives back counts where it flows. On an orbit a
 * switching that goes on across the period's end counts as two. */
#pragma once

#include "measure/switching.h"

enum {
  VS_LOSS_CONDUCTION,
  VS_LOSS_ON,  /* turn-on */
  VS_LOSS_OFF, /* turn-off */
  VS_LOSS_RECOVERY,
  VS_LOSS_BLOCKING,
  VS_LOSSES
};

typedef struct vs_losses {
  bool rectifies;              /* it is a diode */
  int phase;                   /* VS_LOSS_... of the present instant */
  double joule[VS_LOSSES];     /* over the run so far */
  double stretch_j;            /* since the present phase began */
  vs_value largest[VS_LOSSES]; /* of a single turn-on, turn-off or recovery, J, with its end */
  double most_v;               /* the largest |v| so far */
  double on_a;                 /* |i| at the end of the last conduction */
  double reverse_a;    /* of a diode: the largest reverse current since its current's zero */
  vs_value turned_off; /* the largest on_a that was followed by blocking, A */
} vs_losses;

void vs_losses_begin(vs_losses *losses, bool rectifies);
/* Tells voltage and current at the first knot. */
void vs_losses_resume(vs_losses *losses, double v_v, double i_a);
/* Takes the next step. */
void vs_losses_follow(vs_losses *losses, const vs_course_step *c);
/* The energy of a step up to a part of it, 0 to 1, J. The power runs on a parabola. */
double vs_losses_at(const vs_course_step *c, double at);
