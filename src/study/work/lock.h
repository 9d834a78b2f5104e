/* SPDX-License-Identifier: GPL-3.0-or-later
 * Locks by which a study belongs to one process at a time. They end with the process. Each waits a
 * moment, as a worker that was just forked holds the lock, too, and may outlive its killed parent
 * by so long. On a file system without locks there are none, and both succeed. */
#ifndef VS_STUDY_LOCK_H
#define VS_STUDY_LOCK_H

#include "base/error.h"

/* Locks the file that is open as fd, for this descriptor alone: closing another one of the same
 * file keeps the lock. path is for the message. Error: another process has it. */
vs_status vs_lock_file(int fd, const char *path, vs_error *err);

/* Opens the folder as *fd and locks it, so that of two processes that begin a study in it only one
 * goes on. *fd is -1 where it cannot be opened. Error: another process has it. */
vs_status vs_lock_folder(const char *folder, const char *path, int *fd, vs_error *err);

/* Error: the path does not name the open file any more, but another one or none. What is written to
 * it would be found by nobody, and what is written beside it would stand elsewhere. */
vs_status vs_lock_keeps(int fd, const char *path, vs_error *err);

#endif
