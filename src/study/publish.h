/* SPDX-License-Identifier: GPL-3.0-or-later
 * A study's result as its folder has it, made of the journals' rows: the file of rows,
 * failures.csv, manifest.json, and in some formats the folder of columns. */
#pragma once

#include "study/format.h"
#include "workers/journal.h"
#include "workers/journal_head.h"

/* The files of the default format. */
enum { VS_PUBLISH_FILES = 3 };
extern const char *const vs_publish_files[VS_PUBLISH_FILES];

/* Returns the name of a file of a result, of any format, that the folder holds; NULL: none. */
const char *vs_publish_found(const char *folder);
/* Removes the result's files, of any format. What study/cleanup.h removes goes before. */
void vs_publish_remove(const char *folder);

/* Error: the format wants a folder of columns, and something else has its name. */
vs_status vs_publish_check(const char *folder, const vs_format *format, vs_error *err);

/* What has come of all the journals' cases. */
vs_journal_head_counts vs_publish_count(const vs_journals *journals);

/* Writes the result into the folder, in the order of the cases, and removes what the same study has
 * left there in other formats. Error: a journal has more rows than cases, or one that was changed
 * meanwhile; a file cannot be written. Nothing is left of the result then. */
vs_status vs_publish_write(const vs_journals *journals, const vs_format *format, const char *folder,
                           vs_error *err);

/* True if the folder has exactly these journals' rows, but no manifest, which is written last: the
 * writing of this result was interrupted. */
bool vs_publish_was_begun(const vs_journals *journals, const char *folder);

/* Warns if something of the scene was not built in some cases: how many, and of the first. */
void vs_publish_warn(const vs_journals *journals);

/* Prints one of the folder's files, with its header row or without. Errors: VS_INPUT or VS_RUN, it
 * cannot be read. */
vs_status vs_publish_show(const char *folder, const char *name, bool header, FILE *out,
                          vs_error *err);
