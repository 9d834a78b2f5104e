/* SPDX-License-Identifier: GPL-3.0-or-later
 * Out of which folders input may be read. A stranger's scene or deck can name any file of the
 * machine, and messages quote lines of what was read. In the jail a file is read only if it lies
 * below one of these folders: that of a file that the user has named on the command line; the
 * working directory, if such a file lies below it; those that come with the program. Where a file
 * lies is asked of the system, so that links and ".." lead nowhere else. Below such a folder
 * nothing is read whose way from there has a name that begins with a dot. Of the root, and of a
 * home folder or one above it, only the files that lie directly in it are read.
 *
 * The jail is one for the whole process, as its working directory is: every door through which
 * input comes asks it, and none can be left out by a caller that forgets to pass it on. */
#ifndef VS_BASE_JAIL_H
#define VS_BASE_JAIL_H

#include <stdbool.h>

#include "base/error.h"

/* From now on the jail holds; nothing ends it. way_out: what to do to read more, for messages, as
 * "give --no-jail"; borrowed for ever. */
void vs_jail_begin(const char *way_out);
bool vs_jail_is_on(void);

/* Allows what lies below a folder. One that is not there allows nothing. */
void vs_jail_allow(const char *folder);
/* Allows a file that the user has named by that name, whatever it leads to, and what lies below its
 * folder, or directly in it if that is the root, a home folder or above one. Allows the working
 * directory, too, if the file lies below it and it is none of these. Of what lies in /dev nothing
 * else is allowed. */
void vs_jail_allow_named(const char *file);
/* A file that is named at the place with this label is one that the user has named. */
void vs_jail_allow_place(const char *label);

/* Asked before a file is opened, whether it is there or not. `where` is the place that names it.
 * Error: it lies outside of what is allowed. */
vs_status vs_jail_check(const char *path, vs_where where, vs_error *err);

#endif
