/* SPDX-License-Identifier: GPL-3.0-or-later
 * What is told of a branch: its points and marks as CSV, as JSON and as a table. */
#pragma once

#include <stdio.h>

#include "continuation.h"

/* Writes branch.csv: a row for each point and mark, in the order along the branch. */
void vs_branch_output_csv(const vs_continuation *walk, int digits, FILE *out);

/* Adds branch.json: the scene, with the key at its first value, the branch, its points and its
 * marks.
 */
void vs_branch_output_json(const vs_continuation *walk, vs_text *text);

/* Prints the table: some of the points, and all marks. */
void vs_branch_output_print(const vs_continuation *walk, FILE *out);

/* What the gap cannot do: "pole_cover", the armature goes beyond it, and there is no stop; "iron",
 * it goes where no gap is left. "": the orbit is one of the machine. */
const char *vs_branch_output_beyond(const vs_branch_point *at);
