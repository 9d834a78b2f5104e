/* SPDX-License-Identifier: GPL-3.0-or-later
 * What happened in a run and when, as its events.csv tells; and the stretch of time that shows it.
 */
#ifndef VS_REPORT_MOMENTS_H
#define VS_REPORT_MOMENTS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"

typedef struct vs_moment {
  double at_s;
  char *what;
  bool is_event; /* an event of the scene begins */
} vs_moment;

/* Start from {0}; vs_moments_free even after an error. */
typedef struct vs_moments {
  vs_moment *item;
  size_t count;
} vs_moments;

/* Reads the folder's events.csv; where there is none, nothing has happened. Errors, VS_INPUT, with
 * the line: a row has not two cells, or its first is no number. */
vs_status vs_moments_read(const char *folder, vs_moments *moments, vs_error *err);
void vs_moments_free(vs_moments *moments);

/* True if an event of the scene begins in the run. */
bool vs_moments_eventful(const vs_moments *moments);

/* Gives the stretch of time to show, within 0 to until_s, and returns in words why that one. It
 * lies around the first of these that there are: events of the scene; what happens once where other
 * things happen often; all that happens, where this is little. Else it is the end of the run. A
 * cycle, cycle_s, is shown before and two behind. */
const char *vs_moments_window(const vs_moments *moments, double cycle_s, double until_s,
                              double *from_s, double *to_s);

#endif
