/* SPDX-License-Identifier: GPL-3.0-or-later
 * What is told of a branch: its points and marks as CSV, as JSON and as a table. */
#ifndef VS_BRANCH_ROWS_H
#define VS_BRANCH_ROWS_H

#include <stdio.h>

#include "branch/walk.h"

/* Writes branch.csv: a row for each point and mark, in the order along the branch. */
void vs_rows_csv(const vs_walk *walk, int digits, FILE *out);

/* Adds branch.json: the scene at the last value of the key, the branch, its points and its marks.
 */
void vs_rows_json(const vs_walk *walk, vs_text *text);

/* Prints the table: some of the points, and all marks. */
void vs_rows_print(const vs_walk *walk, FILE *out);

/* What becomes of a machine that is put on the orbit: "stable", "unstable"; beyond what the machine
 * can do: "beyond". */
const char *vs_rows_state(const vs_walk *walk, const vs_path_point *at);

#endif
