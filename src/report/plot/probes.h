/* SPDX-License-Identifier: GPL-3.0-or-later
 * Probes as people name them: "v_ak" for the column v_ak_v. */
#ifndef VS_REPORT_PROBES_H
#define VS_REPORT_PROBES_H

#include "traces.h"

enum { VS_PROBES_MOST = 12, VS_PROBE_SIZE = 96 };

typedef struct vs_probe_shown {
  char column[VS_PROBE_SIZE]; /* its column in run.csv */
  char label[VS_PROBE_SIZE];  /* for an axis: "p / mm" */
  double scale;               /* from the column's unit to the label's */
} vs_probe_shown;

typedef struct vs_probes_shown {
  vs_probe_shown item[VS_PROBES_MOST];
  int count;
} vs_probes_shown;

/* Finds the probes that the words, parted by commas, name: columns, or columns without their unit.
 * words NULL: some that every run has. Errors, VS_INPUT: the run has no such column, the nearest is
 * named; there are too many. */
vs_status vs_probes_find(const char *words, const vs_traces *traces, vs_probes_shown *probes,
                         vs_error *err);

/* Fills the column of the rate of a probe, v_m_s of a coordinate's m, with its label; false: the
 * run has none. */
bool vs_probes_rate(const vs_probe_shown *probe, const vs_traces *traces, vs_probe_shown *rate);

/* Writes the probe's column with a word before its unit: "i_rms_a" of i_a and "rms". */
void vs_probes_named(const vs_probe_shown *probe, const char *word, char *name, size_t size);

#endif
