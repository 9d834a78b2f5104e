/* SPDX-License-Identifier: GPL-3.0-or-later
 * One scene drawn at random (random_scene.h), run in a process of its own. Does it come to its end,
 * and if not, has the scene the cause? If it is one to be judged: does each margin lie within its
 * told error of a finer run's, and does plain ngspice run the exported deck?
 *
 * A case appends one row to the table RANDOM_CASE_ROWS in the working folder. One that is judged
 * appends its verdict's lines to RANDOM_CASE_LINES, too. */
#pragma once

#include <sys/types.h>

#define RANDOM_CASE_ROWS "robustness.part.csv"
#define RANDOM_CASE_LINES "margins.part.csv"
/* The heads of both tables, which the files above do not have. */
extern const char random_case_head[], random_case_lines_head[];

/* Columns of a row. A cause that begins with '?' is one that the scene does not have. */
enum {
  RANDOM_CASE_STATUS = 8,
  RANDOM_CASE_RUNG,
  RANDOM_CASE_CPU = 11,
  RANDOM_CASE_BOOKS = 14,
  RANDOM_CASE_COMPARED,
  RANDOM_CASE_OUTSIDE,
  RANDOM_CASE_WRONG,
  RANDOM_CASE_PLAIN,
  RANDOM_CASE_CAUSE,
  RANDOM_CASE_COLUMNS
};

/* Starts the case. Returns its process, or what fork returns where there is none. */
pid_t random_case_begin(int number);
/* The process of that case has ended so (wait(2)). Writes the row of one that could not. */
void random_case_end(int number, int how);
