/* SPDX-License-Identifier: GPL-3.0-or-later
 * An aim of a fit: one number that was measured of a run, with its error. It is a measure of every
 * run (i_peak, f_resonance, ...), or one of the machine at rest, which needs no run:
 *
 *   working_frequency   Hz, at which the mode that the force drives hardest swings freely: Im s/2
 * pi working_decay       s, in which that mode decays to 1/e: -1/Re s
 */
#ifndef VS_FIT_AIMS_H
#define VS_FIT_AIMS_H

#include "scene/shown.h"

typedef struct vs_aim {
  char name[VS_JUDGED_NAME];
  const char *unit; /* in which it is shown; borrowed from the scene or from a table */
  vs_where where;   /* of its key in the fit file */
  double value;     /* as it was measured, SI */
  double error;     /* its standard error: a share of the value, or SI */
  bool relative;    /* error is a share */
  int place;        /* the how many-th measure of a run it is; -1: one of the machine at rest */
} vs_aim;

/* Reads the map `measures` of a fit file, NAME: {value: 1.5 mm, error: 3 %}. The aims are the
 * caller's to free(). Errors: no such measure; no value, no error; an error that is not above 0. */
vs_status vs_aims_read(const vs_node *map, const vs_scene *scene, vs_aim **aims, size_t *count,
                       vs_error *err);

/* Finds what a run gave, SI. Error: VS_RUN, it has no such number, as nothing fired. */
vs_status vs_aim_computed(const vs_aim *aim, const vs_scene *scene, const vs_result *result,
                          double *value, vs_error *err);

/* Adds a line for each measure of the machine at rest, for --help. */
void vs_aim_explain(vs_text *help);

#endif
