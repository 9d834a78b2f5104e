/* SPDX-License-Identifier: GPL-3.0-or-later
 * Netlists in the manner of KiCad 6, 7 and 8, brought in, run, and held against plain ngspice
 * (imported.h); and what of them is refused, with its cure. */
#include <stdio.h>
#include <string.h>

#include "imported.h"
#include "program.h"
#include "suite.h"

static void held(void) {
  imported_held("kicad");
}

static void exported(void) {
  imported_exported("kicad");
}

static const vs_test TESTS[] = {
    {"twelve netlists, the gap held, as plain ngspice", held},
    {"twelve netlists exported, as plain ngspice", exported},
};

int main(void) {
  return program_suite("import_kicad", TESTS, COUNT(TESTS));
}
