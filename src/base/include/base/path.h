/* SPDX-License-Identifier: GPL-3.0-or-later
 * Where the files that come with the program are found. */
#pragma once

#include <stdbool.h>

#include "base/error.h"

enum { VS_PATH_SIZE = 4096 }; /* bytes of the longest path, its end included */

/* One kind of shipped file: they lie in one folder of the library and end alike. */
typedef struct vs_shelf {
  const char *what;   /* "scene", for messages */
  const char *folder; /* below the library folder; "" for the folder itself */
  const char *ending; /* ".yaml" */
} vs_shelf;

/* Writes to path where the file called name lies. It is looked for beside the file that names it;
 * then at the path given, from the working folder (vs_path_is_fallback); then as NAME+ending on the
 * shelf in the first library folder that has it. The library folders are, in this order: those of
 * $VIBROSPICE_PATH (separated by colons), share/vibrospice beside the executable, and the build's
 * VS_LIBRARY: spice/ of the source tree, or where the Debian package installs it. where is the
 * place that names the file, for the message. Errors: there is no such file; the message names the
 * nearest shipped one; the jail does not let it be read; a file names it and it is no plain file
 * (the command line may name a pipe). */
vs_status vs_path_find(const vs_shelf *shelf, const char *name, vs_where where,
                       char path[VS_PATH_SIZE], vs_error *err);

/* Writes the path that the name has from the folder of the file that names it at `where`. False:
 * there is no such file, the name is a path from the root, or no file names it, but a --set. */
bool vs_path_beside(const char *name, vs_where where, char path[VS_PATH_SIZE]);

/* True if the name has a file from the working folder and none beside the file that names it, which
 * lies in another folder: to be warned of. */
bool vs_path_is_fallback(const char *name, vs_where where);

/* The same as vs_path_find, but on the shelf alone: a file of that name in the working directory is
 * none. `looked` says in the message where else the file is not, as "not a file". */
vs_status vs_path_find_shipped(const vs_shelf *shelf, const char *name, vs_where where,
                               const char *looked, char path[VS_PATH_SIZE], vs_error *err);

/* Error: `path`, which stands at `where`, is a folder, a pipe, a device or a socket. Who reads it
 * might wait for ever. */
vs_status vs_path_check_plain(const char *path, vs_where where, vs_error *err);

/* For a file of a folder of results, which may be a stranger's: the jail lets it be read. One that
 * is not there is no error. */
vs_status vs_path_check_result(const char *path, vs_error *err);

/* The same as vs_path_find, for a file that comes with the program: false where there is none of
 * that name. */
bool vs_path_shipped(const vs_shelf *shelf, const char *name, char path[VS_PATH_SIZE]);

/* The same, but never of $VIBROSPICE_PATH, whose files may be a stranger's; and it can be read. */
bool vs_path_own(const vs_shelf *shelf, const char *name, char path[VS_PATH_SIZE]);

/* Lets the jail (base/jail.h) allow all that comes with the program. */
void vs_path_allow_shipped(void);

/* Calls each(ctx, path) for every file on the shelf, sorted by name within each library folder. */
void vs_path_list(const vs_shelf *shelf, void (*each)(void *ctx, const char *path), void *ctx);
