/* SPDX-License-Identifier: GPL-3.0-or-later
 * Netlists in the manner of plain ngspice, LTspice, KiCad 6, 7 and 8, and PSpice and OrCAD Capture,
 * twelve of each and more, brought in, run, and held against plain ngspice (imported.h); and what
 * of them is refused, with its cure. */
#include <stdio.h>
#include <string.h>

#include "imported.h"
#include "program.h"

#define HELD_AND_EXPORTED(origin, first)                                                           \
  static void origin##_held(void) {                                                                \
    imported_held(#origin, first);                                                                 \
  }                                                                                                \
  static void origin##_exported(void) {                                                            \
    imported_exported(#origin);                                                                    \
  }
HELD_AND_EXPORTED(plain, 0)
HELD_AND_EXPORTED(ltspice, 1)
HELD_AND_EXPORTED(kicad, 0)
HELD_AND_EXPORTED(pspice, 1)

/* What the lines behind a good netlist's add to it, and how the program answers. */
typedef struct row {
  const char *lines;
  int status;
  const char *says;
} row;

static void answers(const char *good, const row *rows, size_t count, int line) {
  char text[2048];
  for (size_t k = 0; k < count; k++) {
    snprintf(text, sizeof text, "%s%s", good, rows[k].lines);
    write_file("x.cir", text);
    ran r = run("import x.cir -o y.cir");
    expect(r.status == rows[k].status && strstr(r.err, rows[k].says), line, "row %zu: %d: %s", k,
           r.status, r.err);
    free_ran(&r);
  }
}

static void kicad_refused(void) {
  static const char GOOD[] = ".title KiCad schematic\n"
                             "V1 /a GND SIN( 0 325 50 )\nL1 /a /b 1\nR4 /b GND 90Ω\n";
  static const row ROWS[] = {
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
  answers(GOOD, ROWS, COUNT(ROWS), __LINE__);
}

static void pspice_refused(void) {
  static const char GOOD[] = "* source X\nV_V1 A 0 SIN(0 325 50)\nL_L1 A B 1\nR_R4 B 0 90\n";
  static const row ROWS[] = {
      {"U_U1 INV A B C D0_GATE IO_STD\n", 2,
       "x.cir:5:1: U_U1: with U begin PSpice's digital parts"},
      {"V_2 C 0 STIMULUS=up\nR_1 C 0 1\n", 2, "x.cir:5:1: V_2: the stimulus was drawn"},
      {"E_1 C 0 LAPLACE {V(A)} {1/(1+s)}\nR_1 C 0 1\n", 2,
       "write the transfer function with R, L and C"},
      {"E_1 C 0 FREQ {V(A)} = (0,0,0)(1k,0,0)\nR_1 C 0 1\n", 2, "write the transfer function with"},
      {"X_1 A 0 PART\n.LIB x.lib\n", 2, "x.cir:5:1: X_1: subcircuit 'part' is defined nowhere"},
      {".STEP PARAM X 1 2 1\n", 0, "of many circuits a study asks"},
      {"S_1 A C D 0 SM\nR_1 C 0 1\nR_2 D 0 1\n.MODEL SM VSWITCH(RON=1 ROFF=1MEG VON=1 VOFF=0)\n", 0,
       "read in PSpice's dialect"},
      {"R_1 A B RM 1k\n.MODEL RM RES(R=2)\n", 2, "x.cir:6:1: this parameter multiplies what"},
      {".FUNC T(X) {X/F}\n.PARAM F=50\nV_3 C 0 PULSE(0 5 {T(0.25)} 1u 1u 1m {T(1)})\nR_3 C 0 1k\n",
       0, "V_3 fires, the only pulse"},
      {".ALIASES\nR_R4 R4(1=B 2=0 )\n.ENDALIASES\n.EXTERNAL OUTPUT B\n.PROBE64 V(alias(*))\n.END\n",
       0, "lines of analysis and commands left out"},
  };
  answers(GOOD, ROWS, COUNT(ROWS), __LINE__);
}

static const vs_test TESTS[] = {
    {"plain: as plain ngspice with the gap held", plain_held},
    {"plain: exported (long)", plain_exported},
    {"LTspice: as plain ngspice with the gap held", ltspice_held},
    {"LTspice: exported (long)", ltspice_exported},
    {"KiCad: refused with its cure", kicad_refused},
    {"KiCad: twelve netlists, the gap held, as plain ngspice", kicad_held},
    {"KiCad: twelve netlists exported, as plain ngspice", kicad_exported},
    {"PSpice: refused with its cure", pspice_refused},
    {"PSpice: twelve netlists, the gap held, as plain ngspice", pspice_held},
    {"PSpice: twelve netlists exported, as plain ngspice", pspice_exported},
};

int main(void) {
  return program_suite("import_origins", TESTS, COUNT(TESTS));
}
