/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a one-port's law (oneport.h) says of the cycles of the mains to come, and what its errors
 * may add up to in them. */
#ifndef VS_ENGINE_OUTLOOK_H
#define VS_ENGINE_OUTLOOK_H

#include "macromodel/record.h"

/* Ten cycles of 50 Hz hold the slowest beats of the mains with a machine that is driven near its
 * resonance. In each of them 100 instants, 3.6 degrees apart, meet a peak to 5e-4 of it. */
enum { VS_OUTLOOK_CYCLES = 10, VS_OUTLOOK_STEPS = 100 };

typedef struct vs_outlook {
  /* The largest flux linkage in each cycle, relative to the largest in view: an error of the flux
   * linkage makes one of the force in proportion to it. 0 for a cycle behind the end. */
  double ratio[VS_OUTLOOK_CYCLES];
  double reach; /* how far these cycles lie beyond what the law was fitted to (vs_oneport_reach);
                   at least 1 */
} vs_outlook;

/* Follows the law from the record's last knot on, but not beyond until_s. Returns false where GSL
 * cannot integrate, or where a signal or the EVA's voltage leaves the range that it had over the
 * cycle in view: a law found there says nothing of what lies outside, as a diode may conduct there
 * that did not, or block. */
bool vs_outlook_find(const vs_record *record, vs_oneport *port, double until_s, vs_outlook *out);

/* How often the error that a mode took in one cycle may be added up over so many cycles. *walked is
 * the same for an error that grows by its own size in every cycle. */
double vs_outlook_times(const vs_outlook *outlook, const vs_mode *mode, double cycles,
                        double period_s, double *walked);

#endif
