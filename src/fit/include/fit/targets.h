/* SPDX-License-Identifier: GPL-3.0-or-later
 * An aim of a fit: one number that was measured of a run, with its error. It is a measure of every
 * run (i_peak, f_resonance, ...); of a period of an orbit one that `steady` tells (power_in, ...);
 * or one of the machine at rest, which needs no run:
 *
 *   working_frequency   Hz, at which the mode that the force drives hardest swings freely:
 *                       Im s/(2 pi)
 *   working_decay       s, in which that mode decays to 1/e: -1/Re s
 *
 * Or it is the coil's impedance at a frequency, with the armature at rest, or what the maker's
 * sheet says of the iron's losses, from a CSV file.
 */
#pragma once

#include "orbit/measured.h"

typedef struct vs_target {
  char name[VS_JUDGED_NAME];
  char unit[24];  /* in which it is shown */
  vs_where where; /* of its key in the fit file */
  double value;   /* as it was measured, SI */
  double error;   /* its standard error: a share of the value, or SI */
  bool relative;  /* error is a share */
  int place;      /* among those of vs_measured_at; -1: it is one of the machine at rest */
  double at_hz;   /* of an impedance or a core loss: its frequency; else 0 */
  int part;       /* of an impedance: which of its columns */
  double flux_wb; /* of a core loss: the flux linkage's peak; else 0 */
  double from_hz; /* of a core loss per cycle: above that at this frequency; else 0 */
} vs_target;

typedef struct vs_targets {
  vs_target *item; /* [count]; owned */
  size_t count;
} vs_targets;

/* Reads the map `measures` of a fit file, NAME: {value: 1.5 mm, error: 3 %}. periods: 0, they are
 * those of the scene's run; else of a period of its orbit, of so many firing periods. Free
 * aims->item even after an error. Errors: no such measure; no value, no error; an error that is not
 * above 0. */
vs_status vs_targets_read(vs_targets *aims, const vs_node *map, const vs_scene *scene, int periods,
                          vs_error *err);

/* Adds the numbers of a map `impedance` of a fit file, {file: z.csv, error: 2 %}, whose file has a
 * frequency in its first column, f_hz, and any of r_ohm and x_ohm, the impedance's real and
 * imaginary part, z_ohm, its magnitude, and l_H, the imaginary part over the angular frequency.
 * beside: the fit file's path. Errors: there is no such column; an error that is no share; what
 * vs_recording_file and the file itself are wrong in. */
vs_status vs_targets_read_impedance(vs_targets *aims, const vs_node *map, const char *beside,
                                    vs_error *err);
/* Adds the numbers of a map `core_loss`, {file: sheet.csv, mass: 1 kg, area: 10 cm2, turns: 500,
 * error: 5 %}, whose file has the columns f_hz, b_t and loss_w_kg, of sinusoidal flux densities of
 * that peak: the maker's sheet. Such a loss has a part by hysteresis, which the secondaries have
 * not. Its energy in a cycle does not depend on the frequency, so that of each flux density the
 * differences of the losses in a cycle count; or with `hysteresis: 70 %` of the losses what that
 * share leaves. Errors: those of the other; a flux density at one frequency, without such a share.
 */
vs_status vs_targets_read_core_loss(vs_targets *aims, const vs_node *map, const char *beside,
                                    vs_error *err);
/* True if none of them needs a run. */
bool vs_targets_rest(const vs_targets *aims);

/* Finds what a run of the scene gave, SI. Error: VS_RUN, it has no such number, as nothing fired.
 */
vs_status vs_target_computed(const vs_target *aim, const vs_scene *scene,
                             const vs_measured *measured, double *value, vs_error *err);

/* Adds a line for each measure of the machine at rest, for --help. */
void vs_target_explain(vs_text *help);
