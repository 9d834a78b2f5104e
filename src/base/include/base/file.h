/* SPDX-License-Identifier: GPL-3.0-or-later
 * Files that appear whole or not at all, and the folders they go to. */
#pragma once

#include <stdio.h>

#include "base/error.h"
#include "base/path.h"

/* A file that is being written. Until it is committed it lies beside its final place under a name
 * of the program's own (".vibrospice-tmp.XXXXXX"), and this process keeps it locked. One that
 * nobody has locked was left by a process that was killed; it is removed when the next file is
 * opened in that folder. While it is open the struct must not be moved in memory. */
typedef struct vs_file {
  FILE *stream; /* NULL when closed */
  char path[VS_PATH_SIZE], temporary[VS_PATH_SIZE + 32];
} vs_file;

/* Makes the folder and its parents and checks that it can be written to. *made is how many folders
 * had to be made; vs_file_folder_unmake removes that many again, as far as they are empty. */
vs_status vs_file_folder_make(const char *folder, int *made, vs_error *err);
void vs_file_folder_unmake(const char *folder, int made);

/* Begins the file folder/name; an empty folder is the working directory. Error: VS_INPUT, it cannot
 * be written, also where a folder, a device, a pipe or a socket has its name. */
vs_status vs_file_open(vs_file *file, const char *folder, const char *name, vs_error *err);

/* Flushes the file to the disk and gives it its final name. A file that had that name is replaced;
 * a link is not followed. Error: VS_RUN, it cannot be written; nothing is left of it. */
vs_status vs_file_commit(vs_file *file, vs_error *err);
/* Writes a whole file folder/name; NULL: an empty one. Errors as of both. */
vs_status vs_file_write(const char *folder, const char *name, const char *text, vs_error *err);
/* Commits under another name in the same folder ("run.partial.csv"). */
vs_status vs_file_commit_as(vs_file *file, const char *folder, const char *name, vs_error *err);

/* In a forked copy of the process: goes on with a file of its own, which begins with what this one
 * has. The stream must have been flushed before the copy was made. Error: VS_RUN, there is none;
 * the file is closed then. */
vs_status vs_file_part(vs_file *file, vs_error *err);

/* Removes the file as if it had never been. Does nothing to one that is closed. */
void vs_file_discard(vs_file *file);

/* Removes what processes that were killed have left of files in the folder. */
void vs_file_sweep(const char *folder);

/* For who has read a file to its end: what seemed its end may be that it cannot be read on. To be
 * called before errno has changed. Error: VS_INPUT, it cannot be read, or vs_alloc_line found a
 * line too long. */
vs_status vs_file_was_read(FILE *stream, const char *path, vs_error *err);

/* Removes a plain file from the folder that is open as `folder`; a link, or what else has that
 * name, stays. */
void vs_file_remove(int folder, const char *name);
