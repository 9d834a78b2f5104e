/* SPDX-License-Identifier: GPL-3.0-or-later
 * Out of which folders input may be read. A stranger's scene or deck can name any file of the
 * machine, and messages quote lines of what was read. In the jail a file is read only if it lies
 * below the folder of a file that the user has named on the command line, or below those that come
 * with the program. Where a file lies is asked of the system, so that links and ".." lead nowhere
 * else.
 *
 * The jail is one for the whole process, as its working directory is: every door through which
 * input comes asks it, and none can be left out by a caller that forgets to pass it on. */
#ifndef VS_BASE_JAIL_H
#define VS_BASE_JAIL_H

#include <stdbool.h>

#include "base/error.h"

/* From now on the jail holds; nothing ends it. */
void vs_jail_begin(void);
bool vs_jail_is_on(void);

/* Allows what lies below a folder. One that is not there allows nothing. */
void vs_jail_allow(const char *folder);
/* Allows what lies below the folder of a file. A name that is no file's allows nothing. What a link
 * in /dev leads to is allowed, too. */
void vs_jail_allow_beside(const char *file);

/* Asked before a file is opened, whether it is there or not. `where` is the place that names it.
 * Error: it lies outside of what is allowed. */
vs_status vs_jail_check(const char *path, vs_where where, vs_error *err);

#endif
