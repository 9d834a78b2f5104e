/* SPDX-License-Identifier: GPL-3.0-or-later
 * Netlists in the manner of PSpice and OrCAD Capture, brought in, run, and held against plain
 * ngspice (imported.h); and what of them is refused, with its cure. */
#include <stdio.h>
#include <string.h>

#include "imported.h"
#include "program.h"
#include "suite.h"

static void held(void) {
  imported_held("pspice");
}

static void exported(void) {
  imported_exported("pspice");
}

static const char GOOD[] = "* source X\nV_V1 A 0 SIN(0 325 50)\nL_L1 A B 1\nR_R4 B 0 90\n";

/* What the lines behind a good netlist's add to it, and how the program answers. */
static const struct row {
  const char *lines;
  int status;
  const char *says;
} ROWS[] = {
    {"U_U1 INV A B C D0_GATE IO_STD\n", 2, "x.cir:5:1: U_U1: with U begin PSpice's digital parts"},
    {"V_2 C 0 STIMULUS=up\nR_1 C 0 1\n", 2, "x.cir:5:1: V_2: the stimulus was drawn"},
    {"E_1 C 0 LAPLACE {V(A)} {1/(1+s)}\nR_1 C 0 1\n", 2,
     "write the transfer function with R, L and C"},
    {"E_1 C 0 FREQ {V(A)} = (0,0,0)(1k,0,0)\nR_1 C 0 1\n", 2, "write the transfer function with"},
    {"X_1 A 0 PART\n.LIB x.lib\n", 2, "x.cir:5:1: X_1: subcircuit 'part' is defined nowhere"},
    {".STEP PARAM X 1 2 1\n", 0, "of many circuits a study asks"},
    {"S_1 A C D 0 SM\nR_1 C 0 1\nR_2 D 0 1\n.MODEL SM VSWITCH(RON=1 ROFF=1MEG VON=1 VOFF=0)\n", 0,
     "read in PSpice's dialect"},
    {"R_1 A B RM 1k\n.MODEL RM RES(R=2)\n", 2, "x.cir:6:1: this parameter multiplies what"},
    {".FUNC T(X) {X/F}\n.PARAM F=50\nV_3 C 0 PULSE(0 5 {T(0.25)} 1u 1u 1m {T(1)})\nR_3 C 0 1k\n", 0,
     "V_3 fires, the only pulse"},
    {".ALIASES\nR_R4 R4(1=B 2=0 )\n.ENDALIASES\n.EXTERNAL OUTPUT B\n.PROBE64 V(alias(*))\n.END\n",
     0, "lines of analysis and commands left out"},
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
  return program_suite("import_pspice", TESTS, COUNT(TESTS));
}
