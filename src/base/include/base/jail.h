/* SPDX-License-Identifier: GPL-3.0-or-later
 * The folders from which input may be read. A stranger's scene or deck can name any file of the
 * machine, and messages quote lines of what was read. In the jail a file is read only if it lies
 * below one of these folders: that of a file that the user has named on the command line; the
 * working directory, if such a file lies below it; those that come with the program. The system is
 * asked where a file really lies, so that links and ".." give no way out. Below such a folder,
 * files and folders whose names begin with a dot are not read. Of the root, and of a home folder or
 * one above it, only the files that lie directly in it are read. A file that has a second name, a
 * hard link, is not read: nothing tells where the other one lies. Whoever keeps copies as hard
 * links makes a real copy, or does without the jail.
 *
 * There is one jail for the whole process, as there is one working directory: every function that
 * opens input asks it, and no caller can forget to pass it on. */
#pragma once

#include <stdbool.h>

#include "base/error.h"

/* From now on the jail holds; nothing ends it. way_out: how the user can have more files read, for
 * messages, as "give --no-jail"; borrowed for ever. */
void vs_jail_begin(const char *way_out);
bool vs_jail_is_on(void);

/* Allows what lies below a folder. One that is not there allows nothing. */
void vs_jail_allow(const char *folder);
/* Allows a file that the user has named (of a row TABLE.tab#NAME the table), even if it is a link
 * that leads elsewhere, and what lies below its folder; if that folder is the root, a home folder
 * or above one, only what lies directly in it. Allows the working directory, too, if the file lies
 * below it and it is none of these. For a file in /dev only the file itself is allowed, for a
 * folder, as of results, only what lies below it. */
void vs_jail_allow_named(const char *name);
/* From now on a file counts as named by the user if its name stands at a place with this label,
 * such as that of a --set. */
void vs_jail_allow_place(const char *label);

/* Asked before a file is opened, whether it is there or not. `where` is the place that names it.
 * Error: it lies outside of what is allowed. */
vs_status vs_jail_check(const char *path, vs_where where, vs_error *err);
