/* SPDX-License-Identifier: GPL-3.0-or-later
 * A study file as the program reads it. */
#pragma once

#include "program.h"
#include "study/methods.h"
#include "study/study_file.h"

/* A study that is there as long as a test needs it. */
typedef struct study {
  vs_plan plan;
  vs_error err;
  vs_status status;
} study;

/* Writes the text to study.yaml and reads that. */
study *read_study(const char *text);
/* The same of a text in which nothing is wrong, else the test ends. */
study *good_study(const char *text);
void drop_study(study *s);
