/* SPDX-License-Identifier: GPL-3.0-or-later
 * All memory is requested here. A request that cannot be met ends the process, so no caller checks
 * a result, and none can forget to. The files that the process has begun are removed first
 * (base/shutdown.h), and one line on standard error says how many bytes were wanted; the exit
 * status is 1. Nothing that was kept is lost: a file appears whole or not at all, and a study's
 * journal has its rows. A forked child says nothing and ends with VS_ALLOC_STATUS, so that its
 * parent can tell the user what became of it. To hand the failure up instead would need a way back
 * through every function and through the callbacks of the libraries, of which most would never be
 * tried. Programs that use the library end in the same way; where they do not call
 * vs_shutdown_begin, files that were begun stay behind under their temporary names, until the next
 * one is begun there.
 *
 * src/heap.c does the same for what the program's libraries ask for.
 *
 * What these functions return is freed with free(). */
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* The exit status of a child process that has run out of memory. It is none of vs_status. */
enum { VS_ALLOC_STATUS = 12 };

/* Returns count*size zeroed bytes, also where that is 0. */
void *vs_alloc(size_t count, size_t size);
/* Returns the memory with a new size of count*size bytes, which may be at another place; NULL for
 * memory is none yet. What is added is not zeroed. A count that has no place in a size_t, as on a
 * machine of 32 bits, is more than there is. */
void *vs_resize(void *memory, uint64_t count, size_t size);
/* Returns the list of `count` items of that size with room for one more. The room doubles, so a
 * list may only ever have grown by this function; NULL with a count of 0. */
void *vs_alloc_grow(void *list, size_t count, size_t size);
/* Returns a copy of the string. */
char *vs_copy(const char *string);
/* Returns memory that a library has allocated; ends the process where it is NULL. */
void *vs_checked(void *memory);

/* Returns a stream into memory. vs_alloc_stream_close closes it; then *text is what was written,
 * *size bytes and a '\0' behind them, which the caller frees. */
FILE *vs_alloc_stream(char **text, size_t *size);
void vs_alloc_stream_close(FILE *stream);

/* Returns a copy of the string's first `length` bytes, or of all if it is shorter. */
char *vs_alloc_part(const char *string, size_t length);
/* As getline: reads a line with its newline into *line, which has *size bytes and grows. Returns
 * the length; -1 at the file's end, where it cannot be read, and, with errno EFBIG, where the line
 * has more than `most` bytes: a stranger's file may be one line of terabytes. */
ssize_t vs_alloc_row(char **line, size_t *size, size_t most, FILE *file);
/* The same with at most 2^26 bytes. */
ssize_t vs_alloc_line(char **line, size_t *size, FILE *file);

/* Ends the process, as so many bytes were wanted and are not there; 0: it is not known how many.
 * It asks for no memory. */
_Noreturn void vs_alloc_failed(size_t bytes);
