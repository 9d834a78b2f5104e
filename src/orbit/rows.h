/* SPDX-License-Identifier: GPL-3.0-or-later
 * What is told of a branch: its points and marks as CSV, as JSON and as a table. */
#ifndef VS_ORBIT_ROWS_H
#define VS_ORBIT_ROWS_H

#include <stdio.h>

#include "walk.h"

/* Writes branch.csv: a row for each point and mark, in the order along the branch. */
void vs_rows_csv(const vs_walk *walk, int digits, FILE *out);

/* Adds branch.json: the scene, with the key at its first value, the branch, its points and its
 * marks.
 */
void vs_rows_json(const vs_walk *walk, vs_text *text);

/* Prints the table: some of the points, and all marks. */
void vs_rows_print(const vs_walk *walk, FILE *out);

/* What the gap cannot do: "pole_cover", the armature goes beyond it, and there is no stop; "iron",
 * it goes where no gap is left. "": the orbit is one of the machine. */
const char *vs_rows_beyond(const vs_path_point *at);

#endif
