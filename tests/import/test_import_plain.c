/* SPDX-License-Identifier: GPL-3.0-or-later
 * Twelve netlists in the manner of plain, brought in and held against plain ngspice. */
#include "imported.h"
#include "program.h"

static void with_the_gap_held(void) {
  imported_held("plain");
}

static void exported(void) {
  imported_exported("plain");
}

static const vs_test TESTS[] = {
    {"as plain ngspice with the gap held", with_the_gap_held},
    {"exported (long)", exported},
};

int main(void) {
  return program_suite("import_plain", TESTS, COUNT(TESTS));
}
