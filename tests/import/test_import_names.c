/* SPDX-License-Identifier: GPL-3.0-or-later
 * `vibrospice import`: names that the netlist has are kept from those that its deck makes up, and
 * from those that are the program's own. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"
#include "suite.h"

/* A thyristor with a snubber, whose gate has edges of 1 us, so that the deck makes them. NAME is
 * what a row calls a parameter or a net. */
static void write_netlist(const char *lines, const char *name) {
  vs_text text = {0};
  vs_text_add(&text, "t\nV1 line 0 SIN(0 325 50) Rser=0.5 \nXU1 line k g scr\n"
                     "V3 gs k PULSE(0 5 4.44m 1u 1u 2m 20m)\nR3 gs g 100\nD1 0 k free\n"
                     "L1 k m 1.6\nR4 m 0 92\nC1 s k 22n\n");
  for (const char *s = lines; *s; s++)
    if (strncmp(s, "NAME", 4))
      vs_text_add(&text, "%c", *s);
    else {
      vs_text_add(&text, "%s", name);
      s += 3;
    }
  vs_text_add(&text, ".subckt scr a k g\nQ1 b c a up\nQ2 c b k down\nRg g b 10\nRk b k 220\n"
                     ".model up pnp(is=1e-15 bf=2 rc=20m)\n.model down npn(is=1e-15 bf=10 rc=20m)\n"
                     ".ends\n.model free d(is=1n n=1.8 rs=50m)\n.tran 10u 20m uic\n.end\n");
  write_file("x.net", text.text);
  vs_text_free(&text);
}

static double i_peak(void) {
  ran r = run("run x.yaml -o out --quiet --json --until 12ms");
  const char *at = strstr(r.out, "\"i_peak\": {\"value\": ");
  EXPECT(r.status == 0 && at, "%s%s", r.err, r.out);
  double value = at ? strtod(strchr(at, '{') + strlen("{\"value\": "), NULL) : (double)NAN;
  free_ran(&r);
  return value;
}

/* A parameter, net, element or function of any name changes nothing. */
static void made_up_names_are_free(void) {
  static const struct {
    const char *lines, *name, *harmless, *has; /* a line of the deck */
  } ROWS[] = {
      {"R1 line s {NAME}\n.param NAME=1k\n", "v3_level", "other", " {v3_level_2}\n"},
      {"R1 line s {NAME(1k)}\n.func NAME(x) {x}\n", "v3_level", "other", " {v3_level_2}\n"},
      {"R1 line NAME 500\nR2 NAME s 500\n", "v3_on", "other", "\nVgate_v3_2 v3_2_on 0 external\n"},
      {"R1 line NAME 500\nR2 NAME s 500\n", "v3_edge", "other", "*$ port   gate = Vgate_v3_2\n"},
      {"R1 line NAME 500\nR2 NAME s 500\n", "V3_low", "other", "\nV3 v3_2_low k 0\n"},
      {"R1 line NAME 500\nR2 NAME s 500\n", "v1_ser", "other", "\nV1 v1_2_ser 0 external\n"},
      {"R1 line NAME 500\nR2 NAME s 500\n", "xu1_in", "other", "\nXU1 xu1_in_2 k "},
      {"R1 line s 1k\nENAME NAME 0 s k 1\nR2 NAME 0 1k\n", "gate_v3", "other", "\nEgate_v3_2 "},
      {"R1 line s 1k\nXNAME line 0 load\n.subckt load a b\nR1 a b 1k\n.ends\n", "eva", "other",
       "\nXeva_2 k 0 eva\n"},
      {"B1 q 0 V=NAME\nR1 q s {20*NAME}\n.param NAME=50\n", "E", "other", "*$ param  e = 50 "},
      {"X2 q s load NAME=3\nR1 q line 1k\n.subckt load a b params: NAME=1\nB1 a c V=NAME\n"
       "R1 c b 500\n.ends\n",
       "pi", "other", "X2 q s load pi=3\n"},
      {"R_R2 line s 2k\nNAME line s 2k\n", "R2", "R5", "*$ loss   r2_2 = "},
      {"X2 line NAME far\nX5 NAME s far\n.global NAME\n.subckt far a b\nR1 a b 500\nR2 a NAME "
       "1Meg\n"
       ".ends\n",
       "v3_on", "other", "v3_2_on"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    double peak[2];
    for (int n = 0; n < 2; n++) {
      write_netlist(ROWS[k].lines, n ? ROWS[k].name : ROWS[k].harmless);
      ran r = run("import x.net -o x.cir --scene x.yaml --quiet");
      EXPECT(r.status == 0, "case %zu: %s", k, r.err);
      free_ran(&r);
      peak[n] = i_peak();
    }
    EXPECT(fabs(peak[1] / peak[0] - 1) < 1e-9, "case %zu: i_peak %g, not %g", k, peak[1], peak[0]);
    char *deck = read_file("x.cir");
    EXPECT(strstr(deck, ROWS[k].has), "case %zu: no '%s' in %s", k, ROWS[k].has, deck);
    free(deck);
  }
}

/* A parameter that every deck has by the program is not the netlist's: it is refused, unless its
 * value is the scene's anyway, or the deck does not use it. */
static void the_programs_parameters(void) {
  static const struct {
    const char *lines, *says; /* an error, if it begins with the file; else a note; NULL: nothing */
  } ROWS[] = {
      {"R1 line s {u_rms}\n.param u_rms=2k\n", "x.net:11:8: parameter u_rms is the program's"},
      {"R1 line s {x}\n.param a=2 Phase=3\n.param x={phase*1k}\n",
       "x.net:11:12: parameter phase is the program's"},
      {".subckt load a b\nR1 a b {eva_a}\n.ends\nX2 line s load\n.param eva_a=2k\n",
       "x.net:14:8: parameter eva_a is"},
      {"V2 s2 0 0 Rser={f_mains}\nR1 line s 1k\nR2 s2 0 1\n.param f_mains=60\n",
       "x.net:13:8: parameter f_mains is"},
      {"R1 line s {r_source}\n.param r_source={2*3}\n",
       "line 11: r_source is the program's own by that name: the scene's supply.resistance has its "
       "6,"},
      {"R1 line s 1k\n.param f_mains=50 u_rms=230\n", NULL},
      {"R1 line phase 1k\nR2 phase s 1k\n.param phase=80\n", NULL},
      {"R1 line s {x}\n.param u_rms=2k y={u_rms} x={y/2}\n", "x.net:11:8: parameter u_rms is"},
      {"R1 line s {f3(1)}\n.param u_rms=2k\n.func f3(x) {x*u_rms}\n",
       "x.net:11:8: parameter u_rms is"},
      {"R1 line s {f_mains}\n.param f_mains=50\n",
       "line 11: f_mains is the program's own by that name, and has the same value"},
      {"R1 line s 1k\nC9 line s 1n\n.ic v(s)={u_rms}\n.param u_rms=2k\n",
       "x.net:13:8: parameter u_rms is"},
      {"X2 line s load\n.subckt load a b params: r={u_rms}\nR1 a b {r}\n.ends\n.param u_rms=2k\n",
       "x.net:14:8: parameter u_rms is"},
      {"X2 line s load\n.subckt load a b\n.param r={u_rms}\nR1 a b {r}\n.ends\n.param u_rms=2k\n",
       "x.net:15:8: parameter u_rms is"},
      {"R1 line s 1k\n.param u_rms=2k y={u_rms}\n.step param u_rms 1 2 1\n", NULL},
      {"R1 line s {f3(1)}\n.param u_rms=2k\n.func f3(u_rms) {u_rms*1k}\n", NULL},
      {"X2 line s load phase=500\n.subckt load a b phase=1\nR1 a b {2*phase}\n.ends\n", NULL},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    const char *says = ROWS[k].says;
    write_netlist(ROWS[k].lines, "other");
    ran r = run("import x.net -o x.cir --scene x.yaml");
    bool refused = says && says == strstr(says, "x.net");
    EXPECT(r.status == (refused ? 2 : 0), "case %zu: %d: %s", k, r.status, r.err);
    EXPECT(says ? strstr(r.err, says) != NULL : !strstr(r.err, "program's own by"), "case %zu: %s",
           k, r.err);
    free_ran(&r);
  }
}

/* What a parameter of the netlist is stands in the deck also where only Rser= of the mains has it.
 */
static void a_parameter_of_the_mains(void) {
  write_netlist("R1 line s 1k\n.param rs=0.25\nV2 s2 0 0\nR2 s2 0 1\n", "other");
  char *netlist = read_file("x.net"), *at = strstr(netlist, "Rser=0.5");
  memcpy(at, "Rser={rs}", strlen("Rser={rs}"));
  write_file("x.net", netlist);
  ran r = run("import x.net -o x.cir --scene x.yaml");
  char *deck = read_file("x.cir");
  EXPECT(r.status == 0 && strstr(deck, "*$ param  rs = 0.25"), "%s%s", r.err, deck);
  free(deck);
  free(netlist);
  free_ran(&r);
}

static const vs_test TESTS[] = {
    {"made up names are free", made_up_names_are_free},
    {"the program's parameters", the_programs_parameters},
    {"a parameter of the mains", a_parameter_of_the_mains},
};

int main(void) {
  return program_suite("import_names", TESTS, COUNT(TESTS));
}
