/* SPDX-License-Identifier: GPL-3.0-or-later
 * The formats in which a study's rows are written (`--format`), and where its file of rows is
 * whichever it was. */
#pragma once

#include <stdbool.h>

#include "base/error.h"
#include "base/path.h"

/* One format: a plug of vs_format_all. */
typedef struct vs_format {
  const char *name, *text;
  const char
      *rows;    /* the file of rows; a name that ends with ".zst" is packed (base/compressed.h) */
  bool columns; /* the folder of columns (study/npy.h) is written, too */
  const char *written; /* the files, for the line that names them */
} vs_format;

/* Their names, for an option's value: the table's, in its order. */
#define VS_FORMAT_WORDS "csv|csv.zst|npy"
extern const vs_format
    vs_format_all[]; /* the first one is the default; a row without a name ends it */

/* Finds the format of that name; NULL is the default's. Error: there is no such format. */
vs_status vs_format_find(const char *name, const vs_format **format, vs_error *err);

/* Writes to path where the folder's file of rows is, whatever its format. Returns false, and writes
 * where that of the default format would be, if it has none. */
bool vs_format_find_rows(const char *folder, char path[VS_PATH_SIZE]);
