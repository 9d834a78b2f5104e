/* SPDX-License-Identifier: GPL-3.0-or-later
 * The classes of apparatus by which IEC 61000-3-2 limits the harmonics of the mains current. Which
 * class holds is a matter of what the apparatus is: so each is told. */
#pragma once

#include "measure/spectrum.h"

/* What limits may depend on. */
typedef struct vs_drawn_current {
  const vs_spectrum *spectrum;
  double power_w, power_factor;
} vs_drawn_current;

typedef struct vs_harmonic_class {
  const char *name;   /* "A" */
  const char *text;   /* what it is for */
  const char *source; /* where its limits were read, and which are assumed */
  double (*limit)(const vs_drawn_current *drawn,
                  int n); /* of harmonic n, A rms; NaN: it states none */
} vs_harmonic_class;

/* All classes; the last row has no name. */
extern const vs_harmonic_class vs_harmonic_classes_all[];

/* Returns the harmonic that takes most of its limit; *part: how much of it, 1 for all. NaN: it is
 * not known what is to be held against limits (vs_spectrum_judged). */
int vs_harmonic_classes_worst(const vs_harmonic_class *of, const vs_drawn_current *drawn,
                              double *part);
