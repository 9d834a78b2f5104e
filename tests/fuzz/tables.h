/* SPDX-License-Identifier: GPL-3.0-or-later
 * A study's folder of three cases, of which targets change one file. */
#pragma once

#include <stddef.h>

/* Writes the folder's files but for the one called `name`, which gets this text, and reads all. */
void fuzz_tables_take(const char *name, const char *text, size_t size);
