/* SPDX-License-Identifier: GPL-3.0-or-later
 * The Python module of tools/python, tried by python_module.py here: with nothing but Python's
 * standard library, and with numpy and pandas where they are installed. Skipped (status 77) where
 * there is no python3. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"

/* Python as it comes loads no library that is built with sanitizers; test_vibrospice tries that. */
#ifdef __SANITIZE_ADDRESS__
enum { LOADS = false };
#else
enum { LOADS = true };
#endif

/* Runs one class of the checks; "without-numpy" hides numpy and pandas from it. */
static void check(const char *class, const char *how) {
  const char *const argv[] = {"env", "python3", VS_TEST_FOLDER "/install/python_module.py",
                              class, how,       NULL};
  ran r = collect(spawn_other("/usr/bin/env", argv, environ));
  EXPECT(r.status == 0, "%s: status %d: %s%s", class, r.status, r.out, r.err);
  EXPECT(strstr(r.err, "\nRan "), "%s: no check ran: %s", class, r.err);
  free_ran(&r);
}

static void runs(void) {
  check("Runs", "without-numpy");
}

static void stepped(void) {
  if (!LOADS) return;
  check("Stepped", "without-numpy");
  check("Stepped", NULL);
}

static void inputs(void) {
  check("Inputs", "without-numpy");
}

static void studies(void) {
  check("Studies", "without-numpy");
}

static void designs(void) {
  check("Designs", "without-numpy");
}

static void pictures(void) {
  check("Pictures", "without-numpy");
}

static void tables(void) {
  check("Tables", "without-numpy");
  check("Tables", NULL);
}

static void page(void) {
  if (LOADS) check("Page", NULL);
}

static const vs_test TESTS[] = {
    {"runs", runs},
    {"stepped", stepped},
    {"inputs", inputs},
    {"studies", studies},
    {"designs", designs},
    {"pictures", pictures},
    {"lists or numpy, pandas", tables},
    {"docs/python.md", page},
};

int main(void) {
  if (!on_path("python3")) {
    puts("skipped: there is no python3");
    return 77;
  }
  setenv("VIBROSPICE", VS_PROGRAM, 1);
  setenv("PYTHONPATH", VS_TEST_FOLDER "/../tools/python", 1);
  setenv("PYTHONDONTWRITEBYTECODE", "1", 1); /* the source tree stays as it is */
  return program_suite("python", TESTS, COUNT(TESTS));
}
