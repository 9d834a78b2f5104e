/* SPDX-License-Identifier: GPL-3.0-or-later
 * The hints of check: nodes that nothing holds, open ends and loops of sources; comparators that go
 * to and fro, and those that look alike and do not; what the solver's other rule would do; the hint
 * after a run that crawled. Each deck is a small converter with some lines more. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "program.h"

/* ---- decks ---- */

/* Its last line is line 19, so that what is added begins at line 20. */
static const char CONVERTER[] = "* half wave\n"
                                "*$ port   mains = Vmains\n"
                                "*$ port   gate = Vgate\n"
                                "*$ probe  v_ak = v(a,b) V\n"
                                "*$ probe  i_thyristor = i(Va) A\n"
                                "Vmains  src 0 external\n"
                                "Rsource src s1 {r_source}\n"
                                "Lsource s1 a {l_source} ic=0\n"
                                "Vgate   g b external\n"
                                "Rg g b 100\n"
                                "Va a t 0\n"
                                "S1 t k1 g b gated\n"
                                "D1 k1 b dd\n"
                                "R1 a c 100\n"
                                "C1 c b 100n\n"
                                "Vcc cc 0 15\n"
                                ".model dd d\n"
                                ".model gated sw(vt=0.5 vh=0.1 ron=0.01 roff=1meg)\n"
                                "Xeva    b 0 eva\n";

static void write_deck(const char *more) {
  vs_text text = {0};
  vs_text_add(&text, "%s%s", CONVERTER, more);
  write_file("deck.cir", text.text);
  vs_text_free(&text);
}

/* What check says of the deck with these lines more. */
static ran check(const char *more, const char *options) {
  write_deck(more);
  return run("check deck.cir %s", options);
}

/* The number behind a key in the row of that kind; NaN: there is none. */
static double number_of(const char *json, const char *kind, const char *key) {
  char mark[64];
  snprintf(mark, sizeof mark, "\"kind\": \"%s\"", kind);
  const char *row = strstr(json, mark), *end = row ? strchr(row, '\n') : NULL;
  snprintf(mark, sizeof mark, "\"%s\": ", key);
  const char *at = row ? strstr(row, mark) : NULL;
  return at && (!end || at < end) ? strtod(at + strlen(mark), NULL) : NAN;
}

/* ---- what nothing holds ---- */

#define MODEL ".model plain sw(vt=50 ron=10 roff=10meg)\n"

/* Of each kind decks that have it, with what is said and at which line, and decks that look like
 * them and have not. ngspice ends with 'singular matrix' at the first ten of them but for the
 * isolated rectifier, where it crawls (3e-4 s in 60 s), the source alone and the open control. */
static void nodes_that_nothing_holds(void) {
  static const struct {
    const char *more, *place, *says;
  } WITH[] = {
      {"Lp a 0 10\nLs x1 x2 10\nK1 Lp Ls 0.99\nRs x1 x2 1k\n", "deck.cir:21:1", "node x1, x2"},
      {"Lp a 0 10\nLs x1 x2 10\nK1 Lp Ls 0.99\nD8 x1 x3 dd\nC8 x3 x2 1u\nR8 x3 x2 1k\n",
       "deck.cir:21:1", "node x1, x2, x3"},
      {"E1 x1 x2 a 0 1\nRx x1 x2 1k\n", "deck.cir:20:1", "node x1, x2"},
      {".subckt iso p n\nE1 q r p n 1\nRq q r 1k\n.ends\nXi a 0 iso\n", "deck.cir:21:1",
       "node xi.q, xi.r"},
      {"I1 0 x1 1m\nB1 y 0 V=v(x1)\nRy y 0 1k\n", "deck.cir:20:1", "node x1"},
      {"I1 0 x1 1m\n", "deck.cir:20:1", "node x1"},
      {"B1 y 0 V=v(xx)*2\nRy y 0 1k\n", "deck.cir:20:1", "b1 looks at node xx"},
      {"V1 x 0 5\nV2 x 0 5\nR2 x 0 1k\n", "deck.cir:21:1", "loop of voltage sources"},
      {"V1 x 0 5\nE2 x 0 a 0 1\nR2 x 0 1k\n", "deck.cir:21:1", "loop of voltage sources"},
      {"V1 a x 0\nV2 a x 0\nRx x 0 1meg\n", "deck.cir:21:1", "loop of voltage sources"},
      {"S7 a 0 q 0 gated\n", "deck.cir:20:1", "looks at node q"},
      {"R9 a bbb 1k\n", "deck.cir:20:1", "nothing else is connected to node bbb"},
  };
  static const char *const WITHOUT[] = {
      "",
      "Lp a 0 10\nLs x1 x2 10\nK1 Lp Ls 0.99\nRs x1 x2 1k\nRgnd x2 0 1G\n",
      "Lp a 0 10\nLs x1 x2 10\nK1 Lp Ls 0.99\nRs x1 x2 1k\nCgnd x2 0 10p\n",
      "Ca a x1 1n\nCb x1 0 1n\n",
      "B1 x 0 I=v(x)/1k\nI1 0 x 1m\n",
      "G1 x 0 a 0 1m\nG2 x 0 x 0 1m\n",
      "G1 x 0 a 0 1m\nC3 x 0 1u\n",
      "L1 a x 1\nL2 x 0 1\n",
      "V1 x 0 5\nL1 x 0 1\n",
      "V3 x 0 3\n",
      "B1 y 0 V=v(xeva.z)*1000\nRy y 0 1k\n",
      ".subckt two p n\n.subckt one p n\nR1 p m 1k\nR2 m n 1k\n.ends\nX1 p n one\n.ends\nXt a 0 "
      "two\n",
  };
  for (size_t k = 0; k < COUNT(WITH); k++) {
    ran r = check(WITH[k].more, "");
    const char *at = strstr(r.err, "warning: "), *place = strstr(r.err, WITH[k].place);
    EXPECT(at && place && strstr(at, WITH[k].says), "%s: %s", WITH[k].more, r.err);
    free_ran(&r);
  }
  for (size_t k = 0; k < COUNT(WITHOUT); k++) {
    ran r = check(WITHOUT[k], "");
    EXPECT(r.status == 0 && !*r.err, "%s: %s", WITHOUT[k], r.err);
    free_ran(&r);
  }
  ran r = check(WITH[0].more, "--json --quiet");
  EXPECT(vs_json_is_whole(r.out) && strstr(r.out, "\"kind\": \"floating\", \"level\": \"warning\""),
         "%s", r.out);
  free_ran(&r);
}

/* The shipped decks have nothing of the kind. */
static void no_false_alarm(void) {
  static const char *const DECKS[] = {"bridge_halfcontrolled", "fullwave_antiparallel",
                                      "halfwave_bare", "halfwave_paper", "halfwave_snubbed"};
  for (size_t k = 0; k < COUNT(DECKS); k++) {
    ran r = run("check %s --json --quiet", DECKS[k]);
    EXPECT(r.status == 0 && !strcmp(r.out, "[]\n"), "%s: %s", DECKS[k], r.out);
    free_ran(&r);
  }
}

/* ---- comparators ---- */

/* The level that a trial gives the deck's comparator; "" where it is not spoken of. */
static void expect_level(const char *more, const char *level) {
  write_deck(more);
  write_file("scene.yaml", "circuit: {deck: deck.cir}\n"
                           "run: {tier: circuit, until: 1 ms}\n");
  ran r = run("check scene.yaml --deep --json --quiet");
  const char *row = strstr(r.out, "\"kind\": \"comparator\"");
  char wanted[64];
  snprintf(wanted, sizeof wanted, "\"kind\": \"comparator\", \"level\": \"%s\"", level);
  EXPECT(r.status == 0 && vs_json_is_whole(r.out), "%s: %d %s%s", more, r.status, r.out, r.err);
  EXPECT(*level ? row && strstr(r.out, wanted) : !row, "%s: not '%s': %s", more, level, r.out);
  free_ran(&r);
}

/* Each fails within the first millisecond, or takes steps of nanoseconds and less. */
static void comparators_that_go_to_and_fro(void) {
  static const char *const DECKS[] = {
      "R9 a x 10k\nC9 x 0 10n\nS9 x 0 x 0 plain\n" MODEL,
      "R9 a x 10k\nS9 x 0 x 0 plain\n" MODEL,
      "R9 a x 10k\nB9 x 0 I=v(x)>50 ? 0.1 : 0\n",
      "R9 a x 10k\nB9 x 0 I=1>(v(x)>50) ? 0 : 0.1\n", /* the one within is about to turn over */
      "R9 cc x 1k\nC9 x 0 1u\nB9 o 0 V=v(x)>5 ? 15 : 0\nS9 x 0 o 0 sr\n"
      ".model sr sw(vt=7 vh=1 ron=100 roff=10meg)\n",
      "R9 cc x 1k\nC9 x 0 10n\nB9 z 0 V=(v(x)>5)*15\nR8 z q 100\nC8 q 0 1p\nG9 x 0 q 0 2m\n",
      ".subckt reg i o\nRr i o 1k\nSr o 0 o 0 sz\n.model sz sw(vt=5 ron=1 roff=10meg)\n.ends\n"
      "X9 cc q reg\nC9 q 0 100n\n",
  };
  for (size_t k = 0; k < COUNT(DECKS); k++) expect_level(DECKS[k], "hint");
}

/* The same, but with hysteresis or a slope, with a control that nothing leads back to, or with
 * nothing that is driven back. */
static void comparators_that_do_not(void) {
  static const struct {
    const char *more, *level;
  } DECKS[] = {
      {"R9 a x 10k\nC9 x 0 10n\nS9 x 0 x 0 sz\n.model sz sw(vt=50 vh=5 ron=10 roff=10meg)\n", ""},
      {"Vt tr 0 PULSE(0 1 0 0.1m 0.1m 1u 0.202m)\nB9 p 0 V=v(tr)>0.4 ? 15 : 0\nR9 p q 100\n"
       "C9 q 0 1n\n",
       ""},
      {"S9 cc x g 0 s9\nR9 x 0 1k\n.model s9 sw(vt=9 ron=1 roff=10meg)\n", ""},
      {"B9 p 0 V=v(a)>0 ? 5 : 0\nR9 p 0 1k\n", ""},
      {"R9 cc x 1k\nC9 x 0 100n\nB9 x 0 I=10m*(1+tanh((v(x)-5)/0.01))\n", ""},
      {"B9 a 0 I=1m*pwr(v(a)/910,30)\n", ""},
      {"R9 a x 1k\nB9 x 0 I=v(x)>0 ? v(x)/100 : 0\n", "note"},
      {"R9 a x 10k\nS9 x y y 0 sl\nR8 y 0 1k\nR7 x y 1meg\n"
       ".model sl sw(vt=1 ron=10 roff=10meg)\n",
       "note"},
      {"R9 cc x 10k\nC9 x 0 10n\nS9 y 0 x 0 s9\nR8 cc y 1k\n"
       ".model s9 sw(vt=5 ron=1 roff=10meg)\n",
       ""},
      {"Rr a r 10k\nDr r q dd\nCr q 0 10n\nS9 cc y q 0 s9\nR9 y 0 1k\n"
       ".model s9 sw(vt=20 ron=1 roff=10meg)\n",
       ""},
  };
  for (size_t k = 0; k < COUNT(DECKS); k++) {
    ran r = check(DECKS[k].more, "");
    EXPECT(r.status == 0 && !*r.err, "%s: %s", DECKS[k].more, r.err);
    free_ran(&r);
    expect_level(DECKS[k].more, DECKS[k].level);
  }
}

/* Before a run only a switch across itself is spoken of, with its line and with its cure. */
static void a_switch_across_itself(void) {
  ran r = check("R9 a x 10k\nC9 x 0 10n\nS9 x 0 x 0 plain\n" MODEL, "");
  EXPECT(r.status == 0 && strstr(r.err, "deck.cir:22:1: warning: s9 conducts by its own voltage") &&
             strstr(r.err, "as vh=0.1"),
         "%s", r.err);
  free_ran(&r);
}

/* ---- the solver's rule ---- */

/* A thyristor of two transistors and a free-wheeling diode, whose junctions have a capacitance and
 * no stored charge. */
static void write_crawling(void) {
  write_file("crawling.cir", "* two transistors\n"
                             "*$ port   mains = Vmains\n"
                             "*$ port   gate = Vgate\n"
                             "*$ probe  v_ak = v(a,b) V\n"
                             "*$ probe  i_thyristor = i(Va) A\n"
                             "Vmains  src 0 external\n"
                             "Rsource src s1 {r_source}\n"
                             "Lsource s1 a {l_source} ic=0\n"
                             "Vgate   gg b external\n"
                             "Bgate   g1 b V=5*v(gg,b)\n"
                             "Rg      g1 g 33\n"
                             "Va      a t 0\n"
                             "Xthy    t b g scr\n"
                             "Xeva    b 0 eva\n"
                             "Dfw     0 b dfw\n"
                             ".model  dfw d(is=1e-14 rs=1m bv=1000 cjo=200p)\n"
                             ".subckt scr a k g\n"
                             "Qp   b1 b2 a pmod\n"
                             "Qn   b2 b1 k nmod\n"
                             "Rgk  b1 k 1k\n"
                             "Rgg  g b1 10\n"
                             ".model pmod pnp(is=1e-14 bf=2  br=0.1 cje=100p cjc=200p)\n"
                             ".model nmod npn(is=1e-14 bf=20 br=0.5 cje=100p cjc=200p)\n"
                             ".ends\n");
  write_file("crawling.yaml", "circuit: {deck: crawling.cir}\n"
                              "firing: {every: 1}\n"
                              "run: {tier: circuit, until: 15 ms, verify: never}\n");
}

/* Trap takes many times the steps of gear (208,695 against 30,818 with ngspice 39.3), and the
 * motion is the same. The run with gear has the numbers that the trial foretells.
 */
static void gear_where_it_pays(void) {
  write_crawling();
  ran r = run("check crawling.yaml --deep --json --quiet");
  EXPECT(r.status == 0 && vs_json_is_whole(r.out), "%d: %s%s", r.status, r.out, r.err);
  double steps = number_of(r.out, "method", "steps"),
         gear = number_of(r.out, "method", "other_steps");
  double off = number_of(r.out, "method", "difference");
  printf(" %.0f %.0f %.1e", steps, gear, off);
  EXPECT(strstr(r.out, "\"kind\": \"method\", \"level\": \"hint\""), "%s", r.out);
  EXPECT(steps > 3 * gear && gear > 1000 && off < 6e-4, "%g %g %g", steps, gear, off);
  free_ran(&r);
  r = run("run crawling.yaml --set run.method=gear --set run.leave_circuit=never --json");
  char wanted[64];
  snprintf(wanted, sizeof wanted, "\"steps\": %.0f}", gear);
  EXPECT(r.status == 0 && strstr(r.out, wanted) && !strstr(r.err, "hint"), "%s, not in %s%s",
         wanted, r.out, r.err);
  free_ran(&r);
}

/* The current of a capacitor straight across a rectified voltage jumps at each zero of that. The
 * trapezoidal rule leaves it going up and down by as much from step to step, as each step's current
 * is twice the mean one less the last (65 to 450 times in turn with ngspice 39.3 at tolerances of
 * 3e-5 to 1e-3, gear not once). A resistor of 1 kohm in series ends that. */
static void ringing(void) {
  static const char MORE[] = "*$ probe i_x = i(Vx) A\nBx x 0 V = abs(v(src))\nCx x y 1u\n";
  vs_text rings = {0}, damped = {0};
  vs_text_add(&rings, "%sVx y 0 0\n", MORE);
  vs_text_add(&damped, "%sRx y z 1k\nVx z 0 0\n", MORE);
  write_deck(rings.text);
  write_file("scene.yaml", "circuit: {deck: deck.cir}\nrun: {tier: circuit, until: 12 ms}\n");
  ran r = run("check scene.yaml --deep --json --quiet");
  printf(" %.0f", number_of(r.out, "ringing", "turns"));
  EXPECT(r.status == 0 && strstr(r.out, "run.method: trap rings: i_x goes up and down"), "%s",
         r.out);
  free_ran(&r);
  write_deck(damped.text);
  r = run("check scene.yaml --deep --json --quiet");
  EXPECT(r.status == 0 && !strstr(r.out, "rings"), "%s", r.out);
  free_ran(&r);
  vs_text_free(&rings);
  vs_text_free(&damped);
}

/* An ordinary converter: gear's steps are half as long and nothing else. */
static void gear_where_it_does_not(void) {
  ran r = check("", "--deep");
  EXPECT(r.status == 0 && strstr(r.out, "\nnote: run.method: gear would not help: "), "%d: %s%s",
         r.status, r.out, r.err);
  free_ran(&r);
}

/* A deck of modulated switches has no gate to fire. In the trial both legs do the same, so that the
 * coil has no voltage, and no rule is the better one for the rounding that is left of it. */
static void modulated_legs(void) {
  write_file("legs.cir", "*$ title two legs that do the same\n"
                         "*$ port pwm = Vu\n*$ port pwm_low = Vl\n*$ probe v_x = v(x) V\n"
                         "Vu u 0 external\nVl l 0 external\nVdc d 0 100\nRdc d p 10\n"
                         "Cdc p 0 10u ic=100\nS1 p x u 0 sw off\nS2 x 0 l 0 sw off\n"
                         "S3 p y u 0 sw off\nS4 y 0 l 0 sw off\n"
                         "D1 x p dw\nD2 0 x dw\nD3 y p dw\nD4 0 y dw\n"
                         "Rsn x sn 330\nCsn sn y 1n ic=0\n"
                         ".model sw sw(ron=0.3 roff=10meg vt=0.5 vh=0.1)\n"
                         ".model dw d(is=1e-9 rs=20m cjo=100p bv=2000)\nXeva x y eva\n");
  ran r = run("check legs.cir --deep");
  EXPECT(r.status == 0 && strstr(r.out, "tried: ") && !strstr(r.out, "hint: "), "%d: %s%s",
         r.status, r.out, r.err);
  free_ran(&r);
}

/* The hint after a run stands where the run crawled, on standard error and in summary.json, and not
 * with --quiet. */
static void after_a_run(void) {
  write_crawling();
  ran r = run("run crawling.yaml --json");
  EXPECT(r.status == 0 && strstr(r.err, "vibrospice: hint: ") &&
             strstr(r.err, "'vibrospice check --deep crawling.yaml'") &&
             strstr(r.out, ", \"hint\": \""),
         "%s%s", r.out, r.err);
  free_ran(&r);
  r = run("run crawling.yaml --quiet");
  EXPECT(r.status == 0 && !*r.err, "%s", r.err);
  free_ran(&r);
  write_deck("");
  r = run("run crawling.yaml --set circuit.deck=deck.cir --json");
  EXPECT(r.status == 0 && !strstr(r.err, "hint") && !strstr(r.out, "\"hint\""), "%s", r.err);
  free_ran(&r);
}

/* What cannot be tried is said, and a finding comes before any trial. */
static void what_is_not_tried(void) {
  ran r = run("check paper --deep");
  EXPECT(r.status == 0 && strstr(r.out, "nothing is tried: tier"), "%s", r.out);
  free_ran(&r);
  write_file("grid.yaml", "scene: paper\nvary: {firing.angle: [90 deg, 100 deg]}\n");
  r = run("check grid.yaml --deep");
  EXPECT(r.status == 0 && strstr(r.out, "nothing is tried: --deep tries a scene or a deck"), "%s",
         r.out);
  free_ran(&r);
  write_deck("R9 a\n");
  r = run("check deck.cir --deep");
  EXPECT(r.status == 2 && !strstr(r.out, "tried"), "%d: %s", r.status, r.out);
  free_ran(&r);
}

static const vs_test TESTS[] = {
    {"nodes that nothing holds, open ends, loops", nodes_that_nothing_holds},
    {"no false alarm on shipped decks", no_false_alarm},
    {"comparators that go to and fro", comparators_that_go_to_and_fro},
    {"comparators that do not", comparators_that_do_not},
    {"a switch across itself", a_switch_across_itself},
    {"gear where it pays", gear_where_it_pays},
    {"ringing", ringing},
    {"gear where it does not", gear_where_it_does_not},
    {"modulated legs", modulated_legs},
    {"after a run", after_a_run},
    {"what is not tried", what_is_not_tried},
};

int main(void) {
  return program_suite("hints", TESTS, COUNT(TESTS));
}
