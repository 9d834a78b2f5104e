/* SPDX-License-Identifier: GPL-3.0-or-later
 * `vibrospice import`: the netlists that ship, one in the manner of each origin, become decks that
 * pass a check, run, and give with the gap held what plain ngspice gives for the netlist itself;
 * exported they give the same in plain ngspice. What cannot be decided is asked for by its place
 * and the option that would tell it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/json.h"
#include "program.h"
#include "suite.h"

/* ---- against plain ngspice ---- */

/* A signal's least and largest value. */
typedef struct extreme {
  const char *probe;
  double min, max;
} extreme;

enum { MOST_EXTREMES = 6 };

/* The coil's inductance is constant, as the netlist's: a coil in a field of no force. */
#define HELD "--set actuator.law=moving_coil --set 'actuator.emf_constant=0 V.s/m'"

/* Each netlist as plain ngspice 39.3 reads it: `ngspice -b X`, with its lines .options, .tran,
 * .save, .probe and .control replaced by
 *   .options method=gear reltol=1e-5
 *   .tran 10u END 0 0.5u uic
 *   .control / run / let q = SIGNAL / meas tran m max q / meas tran n min q / .endc
 * The file of LTspice's manner without mfg= and type=, with a resistor of 0.5 ohm for Rser and u
 * for the sign of a millionth; that of PSpice's by `ngspice -D ngbehavior=psa -b`. ngspice's own
 * error at these settings, seen by halving the step, is below 6e-4 of the peak of i_source of the
 * bridge, which is the discharge of a snubber in microseconds, and below 6e-5 of all others. */
static const struct shipped {
  const char *name, *options, *origin, *tolerance;
  extreme extremes[MOST_EXTREMES]; /* the first is the coil's current, of which the peak is told */
} SHIPPED[] = {
    {"halfwave_ltspice.net",
     "",
     "LTspice",
     "1e-5",
     {{"i_peak", 0, 0.9186262}, {"v_ak", -324.0479, 321.0054}, {"v_k", -1.004554, 324.0717}}},
    {"triac_kicad.cir",
     "--coil L1+R4",
     "KiCad",
     "1e-4",
     {{"i_peak", 0, 0.8932452},
      {"v_ak", -565.8549, 575.1771},
      {"v_load", -320.0547, 320.0534},
      {"i_source", -0.8778037, 0.8932452}}},
    {"bridge_plain.cir",
     "--gate Vg1,Vg2",
     "plain SPICE",
     "1e-5",
     {{"i_peak", 0, 0.7567689},
      {"v_ak", -154.6875, 156.5393},
      {"v_ak_xt2", -155.2235, 156.5393},
      {"v_p", -0.9744109, 133.8465},
      {"v_s1", -155.5945, 269.908},
      {"i_source", -0.987869, 0.9884534}}},
    {"dimmer_pspice.cir",
     "",
     "PSpice",
     "1e-5",
     {{"i_peak", 0, 0.8377316},
      {"v_ak", -324.3261, 326.1922},
      {"v_out", -0.9885976, 319.3943},
      {"i_source", -0.003389726, 0.8948061}}}};

static void import(const struct shipped *s) {
  ran r = run("import %s %s -o w.cir --scene w.yaml --json --quiet", s->name, s->options);
  EXPECT(r.status == 0 && !*r.err, "%s: %s", s->name, r.err);
  EXPECT(vs_json_is_whole(r.out) && strstr(r.out, s->origin), "%s: %s", s->name, r.out);
  free_ran(&r);
}

static void as_plain_ngspice_with_the_gap_held(void) {
  for (size_t k = 0; k < COUNT(SHIPPED); k++) {
    const struct shipped *s = &SHIPPED[k];
    import(s);
    ran r = run("check w.cir");
    EXPECT(r.status == 0, "%s: %s", s->name, r.err);
    free_ran(&r);
    if (k && is_for_memory_alone()) continue; /* such circuits run elsewhere, too */
    r = run("run w.yaml --json --quiet --set run.tolerance=%s " HELD, s->tolerance);
    EXPECT(r.status == 0, "%s: %s", s->name, r.err);
    double worst = fabs(json_measure(r.out, "i_peak", "") / s->extremes[0].max - 1);
    for (int n = 1; n < MOST_EXTREMES && s->extremes[n].probe; n++) {
      const extreme *e = &s->extremes[n];
      double peak = fmax(fabs(e->min), fabs(e->max));
      worst = fmax(worst, fabs(json_measure(r.out, e->probe, "_min") - e->min) / peak);
      worst = fmax(worst, fabs(json_measure(r.out, e->probe, "_max") - e->max) / peak);
    }
    printf(" %s %.1e", s->name, worst);
    EXPECT(worst <= 1e-3, "%s: off by %.2e of a peak", s->name, worst);
    EXPECT(strstr(r.out, "\"energy\"") && json_measure(r.out, "energy_residual", "") < 1e-3,
           "%s: the energy books do not close", s->name);
    free_ran(&r);
  }
}

/* What asks for the coil's own node or current keeps it. v_p is that of plain ngspice 39.3 for the
 * same netlist with a fixed inductance, to its four digits. */
static void the_coils_own_names(void) {
  static const char HEAD[] = "* C:\\work\\own.asc\nV1 mains 0 SINE(0 325 50)\n"
                             "Vg g k PULSE(0 5 2.5m 1u 1u 1m 20m)\nRg g gg 100\n"
                             "XU1 mains gg k SCR2T\nL1 k b 0.5 Rser=20\nR1 b 0 100\n";
  static const char TAIL[] = ".subckt SCR2T A G K\nQp G n1 A pm\nQn n1 G K nm\nRgk G K 220\n"
                             ".model pm pnp(is=1e-14 bf=2 cjc=50p cje=50p)\n"
                             ".model nm npn(is=1e-14 bf=50 cjc=50p cje=100p)\n.ends\n"
                             ".tran 0 60m 0 10u\n.backanno\n.end\n";
  static const struct {
    const char *lines, *coil;
    double v_p;
  } ROWS[] = {{"B1 p 0 V=if(time>10m,V(b),0)\nR2 p 0 1k\n", "0.5 H, 20 ohm", 169.90},
              {"B1 p 0 V=V(k)*I(L1)\nR2 p 0 50K\n", "0.5 H, 120 ohm", 451.7},
              {"B1 p 0 V=100*I(R1)\nR2 p 0 50K\n", "0.5 H, 20 ohm", 169.90}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text text = {0};
    vs_text_add(&text, "%s%s%s", HEAD, ROWS[k].lines, TAIL);
    write_file("own.net", text.text);
    vs_text_free(&text);
    ran r = run("import own.net -o own.cir --scene own.yaml");
    EXPECT(r.status == 0 && strstr(r.err, ROWS[k].coil), "%s", r.err);
    free_ran(&r);
    if (is_for_memory_alone()) continue; /* the others run such circuits, too */
    r = run("run own.yaml --json --quiet --set run.until=30ms " HELD);
    EXPECT(r.status == 0, "%s", r.err);
    CLOSE_OF(json_measure(r.out, "v_p", "_max"), ROWS[k].v_p, ROWS[k].v_p, 1e-3);
    free_ran(&r);
  }
}

/* ---- exported ---- */

enum { MOST_COLUMNS = 40 };

/* The largest magnitude of each column of a table, but for its first row, which is ngspice's
 * extrapolation in the export's. Returns how many columns there are. */
static int peaks(const char *path, const char *between, char names[MOST_COLUMNS][64],
                 double peak[MOST_COLUMNS]) {
  char *text = read_file(path), *rest = text, *line = strsep(&rest, "\n");
  int count = 0, row = 0;
  for (char *name; (name = strsep(&line, between));)
    if (*name && count < MOST_COLUMNS) {
      snprintf(names[count], 64, "%s", name);
      peak[count++] = 0;
    }
  while ((line = strsep(&rest, "\n"))) {
    int n = 0;
    for (char *word; (word = strsep(&line, between)) && n < count;)
      if (*word) {
        if (row > 0) peak[n] = fmax(peak[n], fabs(strtod(word, NULL)));
        n++;
      }
    row += n > 0;
  }
  free(text);
  return count;
}

/* The machine in it moves here. Both tables have rows at the same instants. */
static void exported(void) {
  for (size_t k = 0; k < (is_for_memory_alone() ? 1 : COUNT(SHIPPED)); k++) {
    const struct shipped *s = &SHIPPED[k];
    bool pspice = !strcmp(s->origin, "PSpice");
    char a[MOST_COLUMNS][64], b[MOST_COLUMNS][64];
    double mine[MOST_COLUMNS], theirs[MOST_COLUMNS];
    import(s);
    RUN_GOOD("run w.yaml -o out --quiet --set run.until=0.04s --set run.tolerance=2e-5");
    ran r = run("export w.yaml --set run.until=0.04s --set run.tolerance=2e-5 -o x.cir");
    EXPECT(r.status == 0, "%s: %s", s->name, r.err);
    free_ran(&r);
    int how = system(pspice ? "ngspice -D ngbehavior=psa -b x.cir >x.log 2>&1"
                            : "ngspice -b x.cir >x.log 2>&1");
    EXPECT(how == 0, "%s: ngspice fails", s->name);
    int n = peaks("out/run.csv", ",", a, mine), m = peaks("x.txt", " \t", b, theirs), seen = 0;
    double worst = 0;
    for (int i = 1; i < n; i++)
      for (int j = 1; j < m; j++)
        if (!strcmp(a[i], b[j]) && mine[i] > 0) {
          double error = fabs(mine[i] - theirs[j]) / mine[i];
          worst = fmax(worst, error);
          EXPECT(error <= 1e-3, "%s: peak of %s is off by %.2e", s->name, a[i], error);
          seen++;
        }
    EXPECT(seen >= 10, "%s: %d columns", s->name, seen);
    printf(" %s %.1e", s->name, worst);
    remove("x.txt");
  }
}

/* ---- what it does and says ---- */

/* The example of the issue: the gate's level and its resistor are kept as parameters. */
static const char NETLIST[] = "thyristor, 440 V\n"
                              "V1 line 0 SIN(0 622.25 50)\n"
                              "X1 line k g scr\n"
                              "R2 line s 1k\n"
                              "C2 s k 47n ic=0\n"
                              "V3 gs k PULSE(0 5 5.5556m 1u 1u 2m 20m)\n"
                              "R3 gs g 100\n"
                              "L1 k m 1.6\n"
                              "R4 m 0 92\n"
                              ".subckt scr a k g\n"
                              "Q1 b c a up\nQ2 c b k down\nRg g b 10\nRk b k 220\n"
                              ".model up pnp(is=1e-15 bf=2 rc=20m)\n"
                              ".model down npn(is=1e-15 bf=10 rc=20m)\n"
                              ".ends\n"
                              ".tran 10u 60m uic\n"
                              ".end\n";

static void says_what_it_did(void) {
  static const char *const LINES[] = {"*$ param  v3_level = 5 V ",
                                      "*$ param  r3 = 100 ohm ",
                                      "*$ port   mains = V1\n",
                                      "*$ port   gate = Vgate_v3\n",
                                      "*$ line   line\n",
                                      "*$ probe  i_thyristor = i(Vi_x1) A",
                                      "*$ probe  v_k = v(k) V",
                                      "*$ device thyristor thyristor = v(line,k), i(Vi_x1)\n",
                                      "*$ device c2 capacitor = v(s,k), i(Vi_c2)\n",
                                      "*$ loss   r3 = v(gs,g)^2/{r3}\n",
                                      "*$ store  c2 = {c2}*v(s,k)^2/2\n",
                                      "\nV1 line 0 external\n",
                                      " {v3_level}\n",
                                      "\nC2 c2_in k {c2} ic=0\n",
                                      "\nXeva k 0 eva\n",
                                      "* left out: .tran 10u 60m uic\n",
                                      "*   L1+R4 is the EVA's coil, as said: 1.6 H, 92 ohm\n"};
  write_file("x.net", NETLIST);
  ran r = run("import x.net --mains V1 --gate V3 --coil L1+R4 -o my.cir --scene my.yaml");
  EXPECT(r.status == 0 && !*r.out, "%s", r.err);
  EXPECT(strstr(r.err, "V3 fires, as said: its 5 V become v3_level") &&
             strstr(r.err, "left to decide:\n"),
         "%s", r.err);
  free_ran(&r);
  char *deck = read_file("my.cir"), *scene = read_file("my.yaml");
  for (size_t k = 0; k < COUNT(LINES); k++)
    EXPECT(strstr(deck, LINES[k]), "no line '%s' in %s", LINES[k], deck);
  EXPECT(!strstr(deck, "\nL1 ") && !strstr(deck, "\nR4 "), "%s", deck);
  EXPECT(strstr(scene, "firing: {angle: 100.0008 deg, pulse_width: 2.001 ms, every: 1}") &&
             strstr(scene, "actuator: {inductance: 1.6 H, resistance: 92 ohm}") &&
             strstr(scene, "run: {tier: circuit, until: 0.06 s}"),
         "%s", scene);
  RUN_GOOD("check my.yaml");
  free(deck);
  free(scene);
  r = run("import x.net -o same.cir --quiet"); /* all of it is certain */
  EXPECT(r.status == 0 && !*r.out && !*r.err, "%s", r.err);
  free_ran(&r);
}

/* What a netlist looks like must not change what comes of it: encoding, ends of lines, names. */
static void reads_what_programs_write(void) {
  vs_text wide = {0};
  write_file("x.net", NETLIST);
  RUN_GOOD("import x.net -o a.cir --quiet");
  FILE *f = fopen("y.net", "wb");
  fputs("\xff\xfe", f);
  for (const char *c = NETLIST; *c; c++) {
    if (*c == '\n') fwrite("\r\0", 1, 2, f);
    fwrite((char[]){*c, '\0'}, 1, 2, f);
  }
  fclose(f);
  vs_text_free(&wide);
  RUN_GOOD("import y.net -o b.cir --quiet");
  char *a = read_file("a.cir"), *b = read_file("b.cir");
  const char *from = "*$ title";
  EXPECT(strstr(a, from) && strstr(b, from) && !strcmp(strstr(a, from), strstr(b, from)), "%s", b);
  free(a);
  free(b);
  write_file("odd.net", "* C:\\x.asc\n"
                        "V§1 /V+ GND SINE(0 325 50)\n"
                        "R§1 /V+ Net-(D1-A) 4k7\n"
                        "D1 Net-(D1-A) /out+ DX\n"
                        "C1 /out+ GND 10µ\n"
                        "L1 /out+ N001 1 Rser=5\n"
                        "R4 N001 GND 90\n"
                        ".model DX D(Is=1n)\n"
                        ".tran 20m\n.backanno\n.end\n");
  ran r = run("import odd.net -o odd.cir");
  EXPECT(r.status == 0 && strstr(r.err, "1 H, 95 ohm"), "%s", r.err);
  free_ran(&r);
  char *odd = read_file("odd.cir");
  EXPECT(strstr(odd, "*$ param  r_1 = 4.7 kohm") || strstr(odd, "*$ param  1 = 4.7 kohm"), "%s",
         odd);
  EXPECT(strstr(odd, "*$ param  c1 = 10 uF") && strstr(odd, "Xeva outp 0 eva"), "%s", odd);
  free(odd);
}

/* A folder of a test's own, within the work folder. */
static void enter(const char *folder) {
  CU_ASSERT_EQUAL_FATAL(mkdir(folder, 0700), 0);
  CU_ASSERT_EQUAL_FATAL(chdir(folder), 0);
}

static void leave(void) {
  CU_ASSERT_EQUAL_FATAL(chdir(".."), 0);
}

/* ---- what cannot be decided ---- */

static const struct refusal {
  const char *netlist, *options, *at, *says[2];
} REFUSALS[] = {
    {"t\nV1 a 0 SIN(0 1 50)\nV2 b 0 SIN(0 1 50)\nR1 a b 1\nL1 b 0 1\n",
     "",
     "x.net:3:1: ",
     {"V1, V2", "--mains NAME"}},
    {"t\nV1 a 0 SIN(0 1 50)\nV3 g 0 PULSE(0 5 1m 1u 1u 1m 20m)\n"
     "V4 h 0 PULSE(0 5 9m 1u 1u 1m 20m)\nR1 a g 1\nL1 h 0 1\n",
     "",
     "x.net:4:1: ",
     {"--gate V3,V4", "--gate none"}},
    {"t\nV1 a 0 SIN(0 1 50)\nL1 a b 1\nL2 b c 2\nR2 c 0 9\n",
     "",
     "x.net:4:1: ",
     {"--coil says which", "L2+R2"}},
    {"t\nV1 a 0 SIN(0 1 50)\nR1 a 0 1\n", "", "x.net:1:1: ", {"no inductor", "--coil L1+R4"}},
    {"t\nA1 1 2 summer\n", "", "x.net:1:1: ", {"no inductor", NULL}}, /* no node at all is known */
    {"t\nV1 a 0 SIN(0 1 50)\nL1 a b 1\nR4 c 0 9\nR5 b c 1\nR6 b 0 1\n",
     "--coil L1+R4",
     "x.net:4:1: ",
     {"not in series", NULL}},
    {"t\nV1 a 0 SIN(0 1 50)\nL1 a 0 1\n", "--coil L7", "x.net:1:1: ", {"--coil L7", "L1?"}},
    {"t\nV1 a 0 SIN(0 1 50)\nV3 g 0 PULSE(0 5 1m 1u 1u 1m 13m)\nR1 a g 1\nL1 g 0 1\n",
     "",
     "x.net:3:1: ",
     {"0.013 s", "--gate none"}},
    {"t\nV1 a 0 SIN(5 1 50)\nL1 a 0 1\n", "", "x.net:2:1: ", {"offset", "--mains none"}},
    {"t\nV1 a 0 SIN(0 1 50)\nD1 a b 1N4007\nL1 b 0 1\n.lib C:\\lib\\standard.dio\n",
     "",
     "x.net:3:1: ",
     {"'1n4007' is defined nowhere", "--library"}},
    {"t\nV1 a 0 SIN(0 1 50)\nX1 a b g my_scr\nR3 g a 9\nL1 b 0 1\n.subckt my_scr 1 2 3\n"
     "R1 1 2 1\nR2 3 2 1\n.ends\n",
     "",
     "x.net:3:1: ",
     {"looks like a thyristor", "--pins X1=akg"}},
    {"t\nV1 a 0 SIN(0 1 50)\nR1 a b 1\nR2 b 0 {nope}\nL1 b 0 1\n",
     "",
     "x.net:4:",
     {"[nope]", NULL}},
    {"t\nV1 a 0 SIN(0 {big} 50)\nL1 a 0 1\n", "", "x.net:2:1: ", {"{big}", ".param"}},
    {"t\nV1 a 0 SIN(0 0x10 50)\nL1 a 0 1\n", "", "x.net:2:1: ", {"0x10", ".param"}},
    {"t\nV1 a 0 SIN(0 1 50 0 0 0 3)\nL1 a 0 1\n", "", "x.net:2:1: ", {"3 cycles", "leave it out"}},
    {"t\nV1 a 0 SIN(0 1 50)\nL1 a 0 1\n.ic V(a)=0 I(L1)=0.1\n",
     "",
     "x.net:4:1: ",
     {"IC=... in the line of L1", NULL}},
    {"t\nV1 a 0 SIN(0 1 50)\nL1 a 0 1 m=2\n", "", "x.net:3:1: ", {"m=2", "value that it makes"}},
    {"t\nV1 a 0 SIN(0 1 50)\nL1 a b 1\nR4 b 0 9 m=2\n", "", "x.net:4:1: ", {"m=2", NULL}},
    {"t\nV1 a 0 SIN(0 1 50)\nR1 a b 5k 1%\nL1 b 0 1\nC1 b 0 100n 50V\n",
     "",
     "x.net:3:1: ",
     {"'{r1} 1%'", "x.net:5:1: "}}, /* ngspice would take 1 ohm and 50 F */
    {"t\nV1 a 0 SIN(0 1 50)\nV3 g 0 PWL(0 0 1m 0 2m 5 3m 0 8m 0 9m 5 10m 0)\nR1 a g 1\nL1 g 0 1\n"
     "V4 h 0 1\nR2 h g 1\n",
     "--gate V3,V3",
     "x.net:3:1: ",
     {"--gate none", NULL}},
    {"t\nV1 a 0 SIN(0 1 50)\nV3 g 0 PWL(0 0 1m 0 2m 5 3m 0 21m 0 22m 5 26m 0)\nR1 a g 1\nL1 g 0 "
     "1\n",
     "",
     "x.net:3:1: ",
     {"more than one pulse", "--gate none"}},
    {"t\nV1 a 0 SIN(0 1 50)\nV3 g 0 PULSE(0 5 1m 1u 1u 1m 20m)\nR1 a g 1\nL1 g 0 1\n",
     "--gate V3,V3",
     "x.net:3:1: ",
     {"V3 twice", NULL}},
    {"Version 4\nSHEET 1 880 680\n", "", "x.net:1:1: ", {"drawing", "-netlist"}},
    {"EESchema Schematic File Version 4\n", "", "x.net:1:1: ", {"KiCad's drawing", "Netlist"}},
    {"*version 9.1 123\nu 30\n", "", "x.net:1:1: ", {"PSpice's Schematics", "Create Netlist"}},
    {"<Qucs Schematic 0.0.19>\n", "", "x.net:1:1: ", {"Qucs' drawing", "--ngspice"}},
    {"$ 1 0.000005 10.2 50 5 43\n", "", "x.net:1:1: ", {"circuitjs' drawing", "draw it in"}},
    {"t\nV1 a 0 SIN(0 1 50)\nV3 g 0 PWL file=none.txt\nR1 a g 1\nL1 g 0 1\n",
     "",
     "x.net:3:1: ",
     {"none.txt of PWL points is not here", "copy it"}},
    {"*$ title t\nV1 a 0 external\nXeva a 0 eva\n", "", "x.net:1:1: ", {"a deck already", "check"}},
    {"t\nV1 a 0 SIN(0 1 50)\nL1 a 0 1\n", "--pins L1=xyz", "--pins", {"akg", "triac"}},
    {"t\nV1 a 0 SIN(0 1 50)\nX1 a b g my_triac\nR3 g a 9\nL1 b 0 1\n.subckt my_triac 1 2 3\n"
     "S1 1 2 3 0 sw\n.ends\n.model sw sw(vt=1)\n",
     "",
     "x.net:3:1: ",
     {"looks like a triac", "--pins X1=21g"}},
    {"t\nV1 a 0 SIN(0 1 50)\nV3 g 0 PULSE(0 5 1m 1u 1u 1m 10m)\nR3 g h 9\nX1 a h b triac_2t\nL1 "
     "b 0 1\n",
     "",
     "x.net:5:1: ",
     {"has the pins mt2 mt1 g", "--pins X1=21g"}},
};

static void asks_for_what_it_cannot_decide(void) {
  enter("asked");
  for (size_t k = 0; k < COUNT(REFUSALS); k++) {
    const struct refusal *f = &REFUSALS[k];
    write_file("x.net", f->netlist);
    ran r = run("import x.net %s -o y.cir --scene y.yaml", f->options);
    EXPECT(r.status == 2 && !*r.out, "case %zu: status %d: %s", k, r.status, r.err);
    EXPECT(strstr(r.err, f->at) == r.err, "case %zu: %s", k, r.err);
    for (int n = 0; n < 2; n++)
      EXPECT(!f->says[n] || strstr(r.err, f->says[n]), "case %zu: no '%s': %s", k, f->says[n],
             r.err);
    EXPECT_FILES(".", "x.net ");
    free_ran(&r);
    r = run("import x.net %s -o y.cir --json", f->options);
    EXPECT(r.status == 2 && vs_json_is_whole(r.out) && strstr(r.out, "\"written\": null"),
           "case %zu: %s", k, r.out);
    free_ran(&r);
  }
  leave();
}

/* A dimmer: RC and a diac fire a triac, a shipped part by its name or one of the netlist's with the
 * pins of a thyristor. The diac, of which the pins are called as a diode's, is none. */
static void dimmers(void) {
  static const char DIMMER[] =
      "t\nV1 a 0 SIN(0 170 60)\nRp a d 68k\nCd d out 68n\nXD d g DB3\nXT %s\nL1 out n2 0.3\n"
      "R1 n2 0 20\nRl out 0 220\n.subckt DB3 A K\nB1 c0 0 V=abs(V(A,K))\nR1 c0 c 1k\nC1 c 0 1n\n"
      "S1 A 3 c 0 SD\nR3 3 K 47\n.model SD SW(Ron=10 Roff=50Meg Vt=21 Vh=11)\n.ends\n"
      ".subckt BTA12 A K G\nX1 A K ga HALF\nX2 K A gb HALF\nR1 G ga 6\nR2 G gb 330\n.ends\n"
      ".subckt HALF a k g\nQ1 b c a pp\nQ2 c b k nn\nRk b k 200\nRg g b 2\n"
      ".model pp pnp(is=1f bf=2 cjc=100p rc=20m)\n.model nn npn(is=1f bf=10 cjc=20p rc=20m)\n"
      ".ends\n.subckt BT136 A K G\nS1 A p on 0 ST\nV1 p K 0\nRg G K 200\nRa A K 5meg\n"
      "B1 s 0 V=abs(V(G,K))>1|abs(I(V1))>10m ? 1 : 0\nR1 s on 1k\nC1 on 0 1n\n"
      ".model ST SW(Ron=20m Roff=5Meg Vt=0.5 Vh=0.1)\n.ends\n"
      ".subckt MAC97A6 A K G\nX1 A K G BT136\n.ends\n.tran 50m\n";
  static const struct {
    const char *triac, *says, *device;
  } ROWS[] = {{"a out g triac_2t", "XT is a triac, a shipped part: triac_2t",
               "*$ device triac = v(a,out), i(Vi_xt)"},
              {"a out g BTA12", "XT is a triac, by the junctions",
               "*$ device triac triac = v(a,out), i(Vi_xt)"},
              {"a out g BT136", "XT is a triac, by the junctions",
               "*$ device triac triac = v(a,out), i(Vi_xt)"},
              {"a out g MAC97A6", "XT is a triac, by the junctions",
               "*$ device triac triac = v(a,out), i(Vi_xt)"}};
  enter("dimmers");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char text[2048];
    snprintf(text, sizeof text, DIMMER, ROWS[k].triac);
    write_file("x.net", text);
    ran r = run("import x.net -o y%zu.cir --scene y%zu.yaml", k, k);
    EXPECT(r.status == 0 && strstr(r.err, ROWS[k].says) &&
               strstr(r.err, "XD is a diac, by its name"),
           "%d %s%s", r.status, r.out, r.err);
    free_ran(&r);
    snprintf(text, sizeof text, "y%zu.cir", k);
    char *deck = read_file(text);
    EXPECT(strstr(deck, ROWS[k].device) && !strstr(deck, "diode"), "%s", deck);
    free(deck);
    r = run("run y%zu.yaml --json --quiet " HELD " --set run.verify=never", k);
    double most = number_in(r.out, "i_thyristor_max"), least = number_in(r.out, "i_thyristor_min");
    EXPECT((r.status == 0 || r.status == 3) && most > 0.3 && least < -0.3, "%d %g %g %s", r.status,
           least, most, r.err);
    free_ran(&r);
  }
  leave();
}

/* What a gate's course says besides one pulse: times that count from the one before, a PWL that
 * repeats, no width. */
static void courses_of_gates(void) {
  static const struct {
    const char *course, *scene;
  } ROWS[] = {
      {"PULSE(0 5 1m 1u 1u 1m 20m)", "every: 1"},
      {"PULSE(0 5 1m)", "every: once"},
      {"PWL(0 0 1m 0 +1u 5 +2m 5 +1u 0)", "pulse_width: 2.001 ms"},
      {"PWL(0 0 1m 0 2m 5 3m 0 20m 0) r=0", "every: 1"},
  };
  enter("courses");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text text = {0};
    vs_text_add(
        &text, "t\nV1 a 0 SIN(0 1 50)\nV3 g 0 %s\nR1 a g 1\nL1 g 0 1 IC=0.1 Rser=9 Rpar=0 Cpar=0\n",
        ROWS[k].course);
    write_file("x.net", text.text);
    ran r = run("import x.net -o y.cir --scene y.yaml");
    char *scene = read_file("y.yaml");
    EXPECT(r.status == 0 && strstr(scene, ROWS[k].scene), "%s: %s%s", ROWS[k].course, r.err, scene);
    EXPECT(strstr(r.err, "L1 begins with a current"), "%s", r.err);
    free(scene);
    free_ran(&r);
    vs_text_free(&text);
  }
  leave();
}

/* A .tran without uic begins at an operating point, the deck at 0: said where a source is not 0 as
 * it begins and an element stores what it gives. */
static void tells_of_the_operating_point(void) {
  static const struct {
    const char *lines, *tran, *source; /* NULL: nothing is said */
  } ROWS[] = {
      {"V2 x 0 DC 12\nC2 x 0 1u\n", "10u 60m 0 10u", "V2 is not 0 there; the deck begins with C2"},
      {"V2 x 0 5\nR5 x y 1k\nL2 y 0 1m\n", "60m", "L2"},
      {"I2 x 0 AC 1 DC {2*3}\nC2 x 0 1u\nC3 x 0 1u\n", "60m", "C2, C3"},
      {"V2 x 0 PULSE(-1 0 1u 1n 1n 1u 2u)\nC2 x 0 1u\n", "60m", "V2"},
      {"V2 x 0 PWL(0 1 1 1)\nC2 x 0 1u\n", "60m", "V2"},
      {"V2 x 0 SIN(1 1 50)\nC2 x 0 1u\n", "60m", "V2"},
      {"V2 x 0 SIN(0 1 50 0 0 90)\nC2 x 0 1u\n", "60m", "V2"},
      {"V2 x 0 EXP(1 2 0 1m 2m 1m)\nC2 x 0 1u\n", "60m", "V2"},
      {"X2 x dc\n.subckt dc p\nV2 p 0 12\n.ends\nC2 x 0 1u\n", "60m",
       "V2 of subcircuit dc is not 0 there; the deck begins with C2"},
      {"X2 x dc\n.subckt dc p u=5\nI2 p 0 PULSE({u} 0)\n.ends\nC2 x 0 1u\n", "60m",
       "I2 of subcircuit dc"},
      {"X2 x dc\n.subckt dc p\nV2 p 0 0\nV3 q p PWL(0 0 1m 1)\n.ends\nC2 x 0 1u\n", "60m", NULL},
      {"R2 x 0 1\n.subckt dc p\nV2 p 0 12\n.ends\nC2 x 0 1u\n", "60m", NULL},
      {"V2 x 0 DC 12\nC2 x 0 1u\n", "10u 60m 0 10u UIC", NULL},
      {"V2 x 0 DC 12\nC2 x 0 1u\n", "60m startup", NULL},
      {"V2 x 0 DC 12\nC2 x 0 1u\n", "60m skipbp", NULL},
      {"V2 x 0 DC 12\nC2 x 0 1u ic=12\n", "60m", NULL},
      {"V2 x 0 DC 12\nR2 x 0 1k\n", "60m", NULL}, /* what stores is the coil alone */
      {"V2 x 0 DC 0\nC2 x 0 1u\n", "60m", NULL},
      {"V2 x 0 AC 1\nC2 x 0 1u\n", "60m", NULL},
      {"V2 x 0 DC 3 PULSE(0 5 0 1n 1n 1u 2u)\nC2 x 0 1u\n", "60m", NULL},
      {"V2 x 0 PWL(0 0 1m 1)\nC2 x 0 1u\n", "60m", NULL},
      {"V2 x 0 SIN(0 1 50 0 0 180)\nC2 x 0 1u\n", "60m", NULL},
      {"C2 a 0 1u\n", "60m", NULL},
  };
  enter("begins");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text text = {0};
    char at[64];
    int line = 6;
    for (const char *c = ROWS[k].lines; *c; c++) line += *c == '\n';
    snprintf(at, sizeof at, "line %d: '.tran %s' has no uic", line, ROWS[k].tran);
    vs_text_add(&text,
                "t\nV1 a 0 SIN(0 325 50)\nV3 g 0 PULSE(0 5 1m 1u 1u 1m 20m)\nR1 a g 1k\n"
                "L1 a 0 1 Rser=9\n%s.tran %s\n",
                ROWS[k].lines, ROWS[k].tran);
    write_file("x.net", text.text);
    ran r = run("import x.net --mains V1 --gate V3 --coil L1 -o y.cir");
    EXPECT(r.status == 0, "case %zu: %s", k, r.err);
    char *deck = read_file("y.cir");
    const char *said = strstr(r.err, "has no uic"), *source = ROWS[k].source;
    EXPECT(!said == !source && !strstr(deck, "has no uic") == !source, "case %zu: %s", k, r.err);
    EXPECT(!source || (strstr(r.err, at) && strstr(said, source)), "case %zu: %s", k, r.err);
    free(deck);
    free_ran(&r);
    vs_text_free(&text);
  }
  leave();
}

/* A capacitor whose current is sensed has a node of its own, which .ic sets, too: 6 V of a divider
 * of 12 V stay. */
static void begins_at_what_ic_says(void) {
  static const char *const LINES[] = {".ic v(st)=6", ".IC  V ( ST ) = {2*3} v(a)=0"};
  enter("ic");
  for (size_t k = 0; k < COUNT(LINES); k++) {
    vs_text text = {0};
    vs_text_add(&text,
                "t\nV1 a 0 SIN(0 325 50)\nV2 aux 0 12\nR1 aux st 10k\nR2 st 0 10k\nC2 st 0 10u\n"
                "L1 a 0 1 Rser=900\n%s\n.tran 10u 10m uic\n",
                LINES[k]);
    write_file("x.net", text.text);
    ran r = run("import x.net --mains V1 --gate none --coil L1 -o y.cir --scene y.yaml");
    EXPECT(r.status == 0, "%s", r.err);
    free_ran(&r);
    r = run("run y.yaml -o o --quiet --json");
    EXPECT(r.status == 0, "%s", r.err);
    const char *at = strstr(r.out, "\"v_st_min\"");
    double least = at && (at = strstr(at, "\"value\": ")) ? strtod(at + 9, NULL) : 0;
    EXPECT(fabs(least - 6) < 6e-3, "'%s': %g V in %.2000s", LINES[k], least, r.out);
    free_ran(&r);
    vs_text_free(&text);
  }
  leave();
}

/* What the coil is when it is warm is not taken, and told; 0 is nothing. */
static void tells_of_a_warm_coil(void) {
  static const struct {
    const char *coil, *says;
  } ROWS[] = {
      {"L1 a b 0.8 tc1=0.01\nR4 b 0 40\n", "L1 has a coefficient of temperature"},
      {"L1 a b 0.8\nR4 b 0 40 tc=3.9m,0\n", "give actuator.resistance"},
      {"L1 a b 0.8 tc1=0\nR4 b 0 40 tc2=0\n", NULL},
  };
  enter("warm");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text text = {0};
    vs_text_add(&text, "t\nV1 a 0 SIN(0 325 50)\n%s.tran 60m\n", ROWS[k].coil);
    write_file("x.net", text.text);
    ran r = run("import x.net -o y.cir");
    const char *said = strstr(r.err, ROWS[k].says ? ROWS[k].says : "coefficient");
    EXPECT(r.status == 0 && !said == !ROWS[k].says, "case %zu: %s", k, r.err);
    free_ran(&r);
    vs_text_free(&text);
  }
  leave();
}

/* A model behind the coil's value would make another one of it; that is told. */
static void tells_of_a_modelled_coil(void) {
  static const struct {
    const char *coil, *says;
  } ROWS[] = {
      {"L1 a b 0.8\nR4 b 0 40 rmod\n", "R4 has a .model"},
      {"L1 a b 0.8\nR4 b 0 rmod R=40\n", "give actuator.resistance"},
      {"L1 a b 0.8 lmod\nR4 b 0 40\n", "L1 has a .model"},
      {"L1 a b 0.8\nR4 b 0 40\n", NULL},
  };
  enter("modelled");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text text = {0};
    vs_text_add(&text,
                "t\nV1 a 0 SIN(0 325 50)\n%s.model rmod r(tc1=0.01)\n.model lmod l(tc1=0.01)\n"
                ".tran 60m\n",
                ROWS[k].coil);
    write_file("x.net", text.text);
    ran r = run("import x.net -o y.cir");
    const char *said = strstr(r.err, ROWS[k].says ? ROWS[k].says : "has a .model");
    EXPECT(r.status == 0 && !said == !ROWS[k].says, "case %zu: %s", k, r.err);
    free_ran(&r);
    vs_text_free(&text);
  }
  leave();
}

/* Whatever bytes it is given, it ends, and says where it gave up. */
static void survives_any_text(void) {
  unsigned seed = 20;
  for (int k = 0; k < 60; k++) {
    size_t n = strlen(NETLIST), cuts = 1 + (size_t)k % 6;
    char *text = vs_copy(NETLIST);
    for (size_t c = 0; c < cuts; c++) {
      static const char SIGNS[] = "(){}=,'\"+*. \n;$xK9";
      seed = seed * 1664525u + 1013904223u;
      text[(seed >> 8) % n] = SIGNS[(seed >> 3) % (sizeof SIGNS - 1)];
    }
    write_file("x.net", text);
    ran r = run("import x.net -o y.cir --quiet");
    EXPECT(r.status == 0 || (r.status == 2 && *r.err), "status %d: %s: %s", r.status, r.err, text);
    free_ran(&r);
    free(text);
  }
}

static void bad_command_lines(void) {
  enter("lines");
  write_file("x.net", NETLIST);
  static const char *const ROWS[][2] = {{"import x.net", "-o FILE.cir"},
                                        {"import x.net -o x.net", ".cir"},
                                        {"import none.net -o y.cir", "none.net"},
                                        {"import x.net -o no/y.cir", "no/y.cir"},
                                        {"import x.net -o y.cir --scene y.cir", "that is the deck"},
                                        {"import -o y.cir", "NETLIST"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("%s", ROWS[k][0]);
    EXPECT(r.status == 2 && strstr(r.err, ROWS[k][1]), "%s: %d %s", ROWS[k][0], r.status, r.err);
    free_ran(&r);
  }
  EXPECT_FILES(".", "x.net ");
  leave();
}

/* A deck that was edited is not replaced without a word. */
static void what_is_replaced_is_said(void) {
  for (int again = 0; again < 2; again++) {
    ran r = run("import halfwave_ltspice.net -o twice.cir --scene twice.yaml");
    bool said = strstr(r.err, "note: replaced twice.cir, twice.yaml\n") != NULL;
    EXPECT(r.status == 0 && said == (again > 0), "%s", r.err);
    free_ran(&r);
  }
}

/* A part that its user made of a data sheet, beside the netlist, is taken by its name; a netlist
 * of other pins is told so; a definition of the netlist's own goes first. A part of another kind
 * has that kind's pins, a MOSFET d g s. */
static void a_part_of_ones_own(void) {
  static const char HEAD[] = "t\nV1 l 0 SIN(0 325 50)\nR1 l a 0.4\nR2 a b 47\nC1 b k 100n\n"
                             "V2 g k PULSE(0 5 5.5m 1u 1u 2m 20m)\nL1 k 0 0.9 Rser=38\n";
  static const char OWN[] = ".subckt MyScr a k g\nR1 a k 1meg\nR2 g k 100\n.ends\n";
  static const struct {
    const char *line, *rest;
    int status;
    const char *says, *deck;
  } ROWS[] = {
      {"XU1 a k g MyScr\n", "", 0, "XU1 is a thyristor, a part beside the netlist: myscr",
       "param  thyristor = myscr part thyristor"},
      {"XU1 a g k MyScr\n", "", 2, "the part myscr has the pins a k g", ""},
      {"XU1 a k g MyScr\n", OWN, 0, "what its maker allows is not known here", "XU1"},
      {"XU1 a g k mosfet\n", "", 0, "XU1 is a mosfet, a shipped part: mosfet",
       "device mosfet = v(a,k), i(Vi_xu1)"},
  };
  enter("ownpart");
  ran part = run("part thyristor -o myscr.inc");
  EXPECT(part.status == 0, "%s", part.err);
  free_ran(&part);
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text text = {0};
    vs_text_add(&text, "%s%s%s", HEAD, ROWS[k].line, ROWS[k].rest);
    write_file("x.net", text.text);
    ran r = run("import x.net -o y.cir --scene y.yaml");
    EXPECT(r.status == ROWS[k].status && strstr(r.err, ROWS[k].says), "%s", r.err);
    char *deck = r.status ? vs_copy("") : read_file("y.cir");
    EXPECT(strstr(deck, ROWS[k].deck), "%s", deck);
    free(deck);
    free_ran(&r);
    vs_text_free(&text);
    if (k) continue;
    ran judged = run("run y.yaml --until 10ms");
    EXPECT(judged.status == 0 && strstr(judged.out, "verdict: held"), "%s%s", judged.out,
           judged.err);
    free_ran(&judged);
  }
  leave();
}

static const vs_test TESTS[] = {
    {"a part of one's own", a_part_of_ones_own},
    {"the coil's own names", the_coils_own_names},
    {"what is replaced is said", what_is_replaced_is_said},
    {"says what it did", says_what_it_did},
    {"reads what programs write", reads_what_programs_write},
    {"asks for what it cannot decide", asks_for_what_it_cannot_decide},
    {"dimmers", dimmers},
    {"bad command lines", bad_command_lines},
    {"courses of gates", courses_of_gates},
    {"tells of the operating point", tells_of_the_operating_point},
    {"begins at what .ic says", begins_at_what_ic_says},
    {"tells of a warm coil", tells_of_a_warm_coil},
    {"a model of the coil's parts is told", tells_of_a_modelled_coil},
    {"survives any text", survives_any_text},
    {"as plain ngspice with the gap held", as_plain_ngspice_with_the_gap_held},
    {"exported", exported},
};

int main(void) {
  bool there = on_path("ngspice");
  if (!there) puts("ngspice is not on the PATH: exported decks are not compared");
  return program_suite("import", TESTS, there ? COUNT(TESTS) : COUNT(TESTS) - 1);
}
