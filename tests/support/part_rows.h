/* SPDX-License-Identifier: GPL-3.0-or-later
 * Parts as `check` sees them: rows of the bench, files with one text changed, warnings by line. */
#pragma once

#include "program.h"

/* The number behind a key in the row of a figure; `nth` of those of that name, from 0. NaN: null,
 * or there is no such row. */
double number_of(const char *json, const char *figure, int nth, const char *key);

/* Writes a copy of a file in which one text is another. */
void alter(const char *from, const char *to, const char *old, const char *new);

/* Standard error holds a warning at that line which says `says`. */
void expect_warning(const ran *r, const char *file, int line, const char *says);
