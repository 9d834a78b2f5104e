/* SPDX-License-Identifier: GPL-3.0-or-later
 * The built program seen from outside: its exit status and both its streams. */
#ifndef VS_TESTS_PROGRAM_H
#define VS_TESTS_PROGRAM_H

#include <sys/types.h>

#include "suite.h"

/* As vs_suite. Each test works in a new folder's "work"; what the program prints lies beside it. */
int program_suite(const char *name, const vs_test *tests, size_t count);

typedef struct ran {
  int status; /* exit status; 1000 + number of the signal that ended it */
  char *out, *err;
} ran;
void free_ran(ran *r);

/* Runs the program to its end with a command line cut at its blanks, but for what stands 'in
 * quotes'. */
ran run(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* The same in its parts. argv has room for MOST_WORDS; words is cut up. */
enum { MOST_WORDS = 32 };
size_t split(char *words, const char **argv);
pid_t spawn(const char *const *argv);
ran collect(pid_t child);

/* Whole file, with a zero byte behind it; empty when it is not there. */
char *read_file(const char *path);
int count_lines(const char *text);

#endif
