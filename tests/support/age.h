/* SPDX-License-Identifier: GPL-3.0-or-later
 * What tests of long-lived studies share: time, processes, and what stands in a folder. */
#pragma once

#include "engine/budget.h"
#include "program.h"

void wait_seconds(double s);

/* Waits until the condition holds. Where it never does that ends, after a time that no busy machine
 * needs. */
enum { WAIT_MOST_S = 60 };
#define WAIT_UNTIL(condition)                                                                      \
  for (double end_ = vs_budget_clock_s() + WAIT_MOST_S;                                            \
       !(condition) && vs_budget_clock_s() < end_;)                                                \
  wait_seconds(0.01)

/* True if the file is there and has that text in it. */
bool file_says(const char *path, const char *text);

/* Begins the program with a command line, as run() does, and does not wait for its end. */
pid_t begin(const char *words);

/* Fills `found` with the children of a process, and returns how many of at most `most` there are.
 */
size_t children_of(pid_t parent, pid_t *found, size_t most);

/* All files below the folder but journals: a line for each with its path in it, its length in bytes
 * and its CRC-32. free() it. */
char *tree_of(const char *folder);

/* The whole lines of all journals in the folder and in the folders that it holds, one after the
 * other. free() it. */
char *rows_of(const char *folder);

/* How many whole lines of `before` are not in `after`, in whatever order. A line that stands there
 * twice before and once after is lost once. */
int lines_lost(const char *before, const char *after);
