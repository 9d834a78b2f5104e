/* SPDX-License-Identifier: GPL-3.0-or-later
 * What every test program here shares: a main in one line, numbers compared with a stated
 * tolerance. */
#pragma once

#include <CUnit/Basic.h>
#include <stdbool.h>
#include <stddef.h>

#include "conveyor.h"
#include "run/trial.h"

typedef struct vs_test {
  const char *name;
  void (*run)(void);
} vs_test;

/* Runs the tests as one CUnit suite; what a main returns: 0 when all passed. */
int vs_suite(const char *name, const vs_test *tests, size_t count);
#define VS_SUITE_MAIN(name, tests)                                                                 \
  int main(void) {                                                                                 \
    return vs_suite(name, tests, COUNT(tests));                                                    \
  }

/* True in a build with sanitizers, unless VS_LONG is set: tests that compare numbers of many runs
 * are left out there (tests/CMakeLists.txt). */
bool is_for_memory_alone(void);

/* |got - expected| <= tolerance * scale; says both and the error when not. */
void vs_close(double got, double expected, double scale, double tolerance, const char *what,
              int line);
#define CLOSE(got, expected, tolerance) vs_close(got, expected, expected, tolerance, #got, __LINE__)
#define CLOSE_OF(got, expected, scale, tolerance)                                                  \
  vs_close(got, expected, scale, tolerance, #got, __LINE__)

/* The verdict's line of that name; NULL: there is none. */
const vs_judgement *judged_line(const vs_verdict *verdict, const char *name);

/* The extreme of a run's channel, the largest where sense is 1, the least where it is -1; NaN: none
 * was asked for. */
double run_extreme(const vs_trial *run, const char *channel, int sense);

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* A check that says what it saw when it fails. */
void expect(bool good, int line, const char *format, ...) __attribute__((format(printf, 3, 4)));
#define EXPECT(good, ...) expect(good, __LINE__, __VA_ARGS__)

/* Files and folders of a test's own. listing: the names in a folder, hidden ones too, sorted, each
 * followed by a blank; free() it. */
void write_file(const char *path, const char *text);
char *listing(const char *folder);
void expect_files(const char *folder, const char *names, int line);
#define EXPECT_FILES(folder, names) expect_files(folder, names, __LINE__)
void remove_tree(const char *path);
bool on_path(const char *program); /* is it in a folder of $PATH? */

/* True where libngspice is 44 or newer: some netlists that kill 39 are then refused, or run. */
bool is_newer_ngspice(void);
/* True where libfyaml is 0.8 or newer: it has other places for values that are empty. */
bool is_newer_yaml(void);
