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

static const char GOOD[] = ".title KiCad schematic\n"
                           "V1 /a GND SIN( 0 325 50 )\nL1 /a /b 1\nR4 /b GND 90Ω\n";

/* What the lines behind a good netlist's add to it, and how the program answers. */
static const struct row {
  const char *lines;
  int status;
  const char *says;
} ROWS[] = {
    {"U1 /a GND /c TIMER\n", 2, "x.cir:5:1: U1: with U begin PSpice's digital parts"},
    {"R5 /a GND 4,7k\n", 2, "x.cir:5:1: R5: '4,7k': the decimal sign is a point"},
    {"R5 /a GND R\n", 2, "x.cir:5:1: R5: 'R' is no value"},
    {"Q1 /a /b /c BC1\n", 2, "x.cir:5:1: Q1: model 'bc1' is defined nowhere"},
    {".include \"D:/lib/none.lib\"\n", 0, "is not here and left out"},
    {"V5 /ac GND PULSE( 0 5 5m 1u 1u 1m 20m )\nR5 /ac GND 4.7kΩ\n", 0, "V5 fires"},
    {"V5 /x /a PULSE( 0 5 5m 1u 1u 1m 20m )\nR5 /x GND 4.7kΩ\n", 0, "V5 fires"},
    {"R5 /gt GND 1k\nR6 /gt /a 1k\nR7 /n /a 1k\nR8 /n GND 2k\n", 0, "is the EVA's coil"},
    {".model __Q1 VDMOS NCHAN ( vto=3 kp=5 )\nMQ1 /a /a GND __Q1\n", 0, "MQ1 is a mosfet"},
};

static void refused_with_its_cure(void) {
  char text[2048];
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    snprintf(text, sizeof text, "%s%s", GOOD, ROWS[k].lines);
    write_file("x.cir", text);
    ran r = run("import x.cir -o y.cir");
    EXPECT(r.status == ROWS[k].status && strstr(r.err, ROWS[k].says), "row %zu: %d: %s", k,
           r.status, r.err);
    free_ran(&r);
  }
}

static const vs_test TESTS[] = {
    {"refused with its cure", refused_with_its_cure},
    {"twelve netlists, the gap held, as plain ngspice", held},
    {"twelve netlists exported, as plain ngspice", exported},
};

int main(void) {
  return program_suite("import_kicad", TESTS, COUNT(TESTS));
}
