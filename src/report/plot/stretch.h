/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a close-up shows: probes of one run or several over a stretch of time. */
#ifndef VS_REPORT_STRETCH_H
#define VS_REPORT_STRETCH_H

#include "base/text.h"
#include "plot/moments.h"
#include "plot/probes.h"
#include "base/gnuplot.h"

enum {
  VS_STRETCH_RUNS = 8,    /* over one another, at most */
  VS_STRETCH_HEIGHT = 210 /* of a strip, pixels */
};

typedef struct vs_stretch_run {
  const char *folder; /* borrowed */
  vs_traces traces;
  vs_moments moments;
  double cycle_s; /* of its mains */
} vs_stretch_run;

/* Start from {0}. */
typedef struct vs_stretch {
  vs_stretch_run run[VS_STRETCH_RUNS];
  size_t runs;
  vs_probes_shown probes;
  double from_s, to_s; /* what is shown */
} vs_stretch;

/* Adds the style that all pictures of a close-up share, and returns the colour of a run's curves.
 */
void vs_stretch_begin(vs_script *script);
/* Sets where the names of the runs stand; one alone has none. */
void vs_stretch_legend(const vs_stretch *stretch, vs_script *script);
const char *vs_stretch_colour(size_t run);

#endif
