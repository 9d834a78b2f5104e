/* SPDX-License-Identifier: GPL-3.0-or-later
 * What `check` says of a study. */
#pragma once

#include "run/findings.h"
#include "study/method.h"

/* True if name is a file that is a study rather than a scene, or is the name of a study that comes
 * with the program and of no scene. */
bool vs_study_check_is_study(const char *name, const vs_method *const *methods);

/* Reads the study as the command would, without running it, and takes its first case's first step.
 * On success it adds one line that describes the study to good. */
vs_status vs_study_check_read(const vs_check_options *options, const vs_method *const *methods,
                              vs_text *good, vs_error *err);
