/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `steady --along`: a branch of periodic orbits over a key of the scene. */
#pragma once

#include <signal.h>

#include "orbit/branch_parameter.h"

typedef struct vs_branch_options {
  vs_branch_parameter_words words;
  int periods, digits; /* significant digits in branch.csv */
  const char *folder;  /* for the files; NULL: none are written */
  bool json, quiet;
  const volatile sig_atomic_t *stop; /* set by a signal: what was found is told */
} vs_branch_options;

/* Follows the scene's branch, and prints it; with a folder it writes branch.csv, branch.json and
 * branch.png. Errors: VS_INPUT, and nothing is written; VS_RUN, no orbit is found at the
 * beginning, or the branch cannot be followed to an end of the range, and what was found is
 * written and printed all the same; VS_SIGNAL, likewise. Without gnuplot there is no picture, which
 * a warning says. */
vs_status vs_branch_command(const vs_branch_options *options, vs_scene *scene, vs_error *err);
