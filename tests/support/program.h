/* SPDX-License-Identifier: GPL-3.0-or-later
 * The built program seen from outside: its exit status and both its streams. */
#pragma once

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

/* Exit status 0 and nothing on standard error, but that files of an older run were replaced; what:
 * the run, for the message. */
void expect_good(const ran *r, const char *what, int line);
/* A run that must go well and of which only the files matter. */
void run_good(const char *words, int line);
#define RUN_GOOD(words) run_good(words, __LINE__)
/* A run that must end with that exit status. */
void expect_exit(const char *words, int status, int line);
#define EXPECT_EXIT(words, status) expect_exit(words, status, __LINE__)

/* Runs what must be refused without a trace in the work folder: exit status 2 and one line that
 * begins with at ("" for nowhere) and says both words, or those before a NULL. */
void refuse(const char *words, const char *what, const char *at, const char *const *says, int line);

/* The same in its parts. argv has room for MOST_WORDS; words is cut up. */
enum { MOST_WORDS = 32 };
size_t split(char *words, const char **argv);
pid_t spawn(const char *const *argv);
/* As spawn, and waits until the program handles SIGTERM, which a busy machine may delay: 20 s at
 * most. */
pid_t spawn_ready(const char *const *argv);
pid_t spawn_other(const char *program, const char *const *argv, char *const *environment);
/* Starts the program with a command line as run() has it. Before the child becomes the program it
 * calls `prepare`, unless that is NULL. */
pid_t spawn_prepared(const char *words, void (*prepare)(void *ctx), void *ctx);
ran collect(pid_t child);

/* Writes gated.cir and its part gated.inc: a resistor of 50 ohm that the gate switches, rated
 * 12 A, between the mains and the EVA. Nothing in it wants short steps. */
void write_gated_deck(void);

/* The value of a measure in summary.json's text; NaN: it has none of that name. */
double measure_in(const char *json, const char *name);

/* The same of NAME and what the name ends in, which must be there. */
double json_measure(const char *json, const char *name, const char *end);

/* The number behind "key": , or behind "key": {"value": ; NaN: there is none, or no text. */
double number_in(const char *json, const char *key);

/* Adds to the text, behind commas, what the scene's key waive leaves out of a device so that a part
 * of that kind with these lines decides the verdict alone: "d.v_forward,d.v_reverse". */
void waive_the_rest(const char *device, const char *kind, const char *lines, vs_text *text);

/* Makes of JSON its shape, in place: each number is written #, and a row of numbers as one. So a
 * test can say which keys there are, and in which order, without the numbers of a run. */
void make_shape(char *json);

/* Whole file, with a zero byte behind it; empty when it is not there. */
char *read_file(const char *path);
int count_lines(const char *text);
int count_words(const char *text, const char *word);
/* Both files are there, and the same to the byte; so are the files of two studies. */
void same_content(const char *a, const char *b, int line);
void same_study(const char *a, const char *b, int line);
#define SAME_STUDY(a, b) same_study(a, b, __LINE__)

/* When an event of that text was first, s, by the text of events.csv; NaN: there was none. */
double event_s(const char *events, const char *what);
