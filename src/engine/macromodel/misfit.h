/* SPDX-License-Identifier: GPL-3.0-or-later
 * How wrong a one-port's law (oneport.h) is over the cycle of the mains that is in view (record.h),
 * where it is run beside the solver from the same state. */
#ifndef VS_ENGINE_MISFIT_H
#define VS_ENGINE_MISFIT_H

#include "macromodel/modal.h"
#include "macromodel/record.h"

/* The largest errors at any knot in view. */
typedef struct vs_misfit {
  double force_n, current_a; /* of the coil */
  double
      mode[VS_MOST_STATES];  /* share of each mode in the error of (q, q'), in units of its shape */
  double signal[VS_SIGNALS]; /* V or A */
  vs_coil_state coil[VS_MOST_SEEN]; /* what the law says of the coil at each knot in view */
} vs_misfit;

/* Runs the law beside the solver, and fills all but `signal`. Returns false, and ends there, where
 * vs_misfit_electric exceeds `most` or GSL cannot integrate. */
bool vs_misfit_find(const vs_record *record, vs_oneport *port, const vs_modal *modal, double most,
                    vs_misfit *out);

/* Then fills `signal`; needs vs_oneport_fit_signals. */
void vs_misfit_find_signals(const vs_record *record, const vs_oneport *port, vs_misfit *misfit);

/* The error of the coil's force or current, whichever is worse, relative to its peak, that the law
 * may make later: a multiple of the one found. */
double vs_misfit_electric(const vs_record *record, const vs_misfit *misfit);

/* That multiple: how much worse than in the cycle in view the law may be later. With five, the
 * bound on leaving the solver held over the scenes of tests/long/quiet.csv. */
extern const double vs_misfit_safety;

#endif
