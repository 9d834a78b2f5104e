/* SPDX-License-Identifier: GPL-3.0-or-later
 * The tornado picture of `sensitivity`: for each measure a bar for each key, the longest on top. */
#pragma once

#include <stdbool.h>

#include "base/error.h"

/* True if the folder holds a sensitivity.csv. */
bool vs_tornado_here(const char *folder);

/* Draws tornado.png and tornado.svg from the folder's sensitivity.csv. Errors: it cannot be read;
 * gnuplot is missing or fails. */
vs_status vs_tornado_draw(const char *folder, bool quiet, vs_error *err);
