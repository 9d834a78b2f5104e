/* SPDX-License-Identifier: GPL-3.0-or-later
 * Where shipped files are found, and files that appear whole or not at all. */
#ifndef VS_BASE_PATH_H
#define VS_BASE_PATH_H

#include <stdbool.h>
#include <stdio.h>

#include "base/error.h"

enum { VS_PATH_SIZE = 4096 };

typedef struct vs_shelf {
  const char *what;   /* "scene", for messages */
  const char *folder; /* below the library folder; "" for the folder itself */
  const char *ending; /* ".yaml" */
} vs_shelf;

/* Looks name up as the path given, then NAME+ending on the shelf in each library folder:
 * $VIBROSPICE_PATH (colon-separated), share/vibrospice beside the executable, the source tree it
 * was built from. where: who asked, for the message. Error: not found (nearest shipped name given).
 */
vs_status vs_path_find(const vs_shelf *shelf, const char *name, vs_where where,
                       char path[VS_PATH_SIZE], vs_error *err);

/* Calls each(ctx, path) for every file on the shelf, sorted by name within each library folder. */
void vs_path_list(const vs_shelf *shelf, void (*each)(void *ctx, const char *path), void *ctx);

/* A file being written beside its final place, under a name of ours (".vibrospice-tmp.XXXXXX"),
 * which this process keeps locked: one that nobody has locked was left by a process that was
 * killed, and goes when the next file is opened in that folder. Not to be moved while it is open.
 * The final name is replaced, whatever it was: a link is never followed. */
typedef struct vs_file {
  FILE *stream; /* NULL when closed */
  char path[VS_PATH_SIZE], temporary[VS_PATH_SIZE + 32];
} vs_file;

/* Makes the folder and its parents and checks that it can be written; *made: how many of them it
 * made. vs_file_folder_unmake takes that many away again, as far as they are empty. */
vs_status vs_file_folder_make(const char *folder, int *made, vs_error *err);
void vs_file_folder_unmake(const char *folder, int made);
vs_status vs_file_open(vs_file *file, const char *folder, const char *name, vs_error *err);
vs_status vs_file_commit(vs_file *file,
                         vs_error *err); /* flush, fsync, rename; then it is there, whole */
void vs_file_discard(vs_file *file);     /* as if it had never been; safe on a closed file */
/* Commits under another name in the same folder ("run.partial.csv"). */
vs_status vs_file_commit_as(vs_file *file, const char *folder, const char *name, vs_error *err);

#endif
