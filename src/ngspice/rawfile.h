/* SPDX-License-Identifier: GPL-3.0-or-later
 * A rawfile as ngspice's `load` reads it, written point by point: a head of text (ngspice manual,
 * "Rawfile format"), then each point as doubles in the machine's own order of bytes. It bears no
 * date, so that the same run gives the same bytes. */
#pragma once

#include <stddef.h>
#include <stdio.h>

#include "base/error.h"

typedef struct vs_rawfile {
  FILE *stream; /* borrowed; NULL: no file is written */
  size_t vectors;
  long points;
  double most_bytes; /* that its points may have; 0: any number */
  long count_at;     /* where the head says how many points there are, bytes from the beginning */
} vs_rawfile;

/* Writes the head. The names are ngspice's own, the time first: "time", "a", "vthy#branch"; they
 * become time, v(a), i(vthy). A stream that cannot be written to shows at the first point or at the
 * end. */
vs_rawfile vs_rawfile_begin(FILE *stream, const char *title, const char *const *names,
                            size_t count);
/* Checks the least number of points that there will be. Error, at `where`: they take more than
 * most_bytes. */
vs_status vs_rawfile_expect(const vs_rawfile *raw, double points, vs_where where, vs_error *err);
/* Checks that one more point has room. Error, with the time t_s: it has none. */
vs_status vs_rawfile_room(const vs_rawfile *raw, double t_s, vs_error *err);
/* Writes a point: as many values as names, SI. Error: the stream cannot be written to. */
vs_status vs_rawfile_point(vs_rawfile *raw, const double *values, vs_error *err);
/* Fills in the number of points; the stream is left open. Error: it cannot be written to. */
vs_status vs_rawfile_end(vs_rawfile *raw, vs_error *err);
