/* SPDX-License-Identifier: GPL-3.0-or-later
 * LTspice's A devices as the program translates them: their truth, levels, delays and edges against
 * closed forms, and fuses of the shapes that makers' libraries have, whose melting has one. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"

/* The coil's circuit is there for the sake of the program; v(hi) is 3 V, v(lo) 0.2 V, v(up) the
 * time in ms. */
#define BENCH                                                                                      \
  "*$ port mains = Vmains\n*$ port gate = Vgate\n*$ probe i_thyristor = i(Vt) A\n"                 \
  "*$ probe y = v(yy) V\nVmains a 0 external\nVgate g 0 external\nRg g 0 1k\nVt a b1 0\n"          \
  "R1 b1 b 100k\nXeva b 0 eva\nVhi hi 0 3\nVlo lo 0 0.2\nVup up 0 PWL(0 0 10m 10)\n" /* 13 lines   \
                                                                                      */

/* Runs the bench with these lines; v(yy) each microsecond. free() it. */
static double *course(const char *lines, int until_us, const char *more, int line) {
  vs_text deck = {0};
  vs_text_add(&deck, BENCH "%s\n", lines);
  write_file("d.cir", deck.text);
  vs_text_free(&deck);
  ran r = run("run paper --set circuit.deck=d.cir --set run.until=%dus --set run.sample=1us --set "
              "run.verify=never --quiet -o o %s",
              until_us, more);
  expect(r.status == 0, line, "%s: %d: %s", lines, r.status, r.err);
  free_ran(&r);
  double *v = calloc((size_t)until_us + 1, sizeof *v);
  char *csv = read_file("o/run.csv"), *row = csv;
  size_t column = 0;
  for (const char *s = csv; *s && *s != '\n' && strncmp(s, ",y_v", 4); s++) column += *s == ',';
  for (int k = 0; k <= until_us && (row = strchr(row, '\n')); k++) {
    row++;
    const char *s = row;
    for (size_t n = 0; n <= column && s; n++) s = strchr(s, ',') ? strchr(s, ',') + 1 : NULL;
    v[k] = s ? strtod(s, NULL) : NAN;
  }
  free(csv);
  remove_tree("o");
  return v;
}

/* Without delays and edges the law holds at once and stays. Levels are 0 and 1 V behind 1 ohm, into
 * 1 kohm, unless the line says otherwise. */
static void truths(void) {
  const double one = 1000. / 1001;
  const struct {
    const char *lines;
    double value;
  } ROWS[] = {
      {"A1 hi 0 0 0 0 0 yy 0 BUF", one},
      {"A1 lo 0 0 0 0 0 yy 0 BUF", 0},
      {"A1 hi 0 0 0 0 yy 0 0 buf", 0},
      {"A1 lo 0 0 0 0 yy 0 0 INV", one},
      {"A1 hi 0 0 0 0 yy gnd 0 inv", 0},
      {"A1 hi 0 0 0 0 0 yy 0 BUF Ref=3.1", 0},
      {"A1 hi lo 0 0 0 0 yy 0 AND", 0},
      {"A1 hi hi 0 0 hi 0 yy 0 AND", one},
      {"A1 hi lo 0 0 0 yy 0 0 AND", one},
      {"A1 lo lo 0 0 lo 0 yy 0 OR", 0},
      {"A1 0 0 lo 0 hi 0 yy 0 OR", one},
      {"A1 lo hi 0 0 0 yy 0 0 OR", 0},
      {"A1 hi lo 0 0 0 0 yy 0 XOR", one},
      {"A1 hi hi 0 0 0 0 yy 0 XOR", 0},
      {"A1 hi hi hi 0 0 0 yy 0 XOR", 0}, /* one and no other */
      {"A1 hi 0 0 0 0 0 yy 0 BUF Vhigh=5 Vlow=-5 Rout=1k", 2.5},
      {"A1 lo 0 0 0 0 0 yy 0 BUF Vhigh={2+3} Vlow = -5 Rhigh=9 Rlow=3k Ref=1", -1.25},
      {"A1 hi 0 0 0 0 0 yy 0 SCHMITT Vt=2 Vh=0.5", one},
      {"A1 hi lo 0 0 0 0 yy 0 SCHMITT Vt=2.5 Vh=0.1", one}, /* 2.8 V between them */
      {"A1 lo hi 0 0 0 0 yy 0 SCHMITT Vt=2.5 Vh=0.1", 0},
      {"A1 hi 0 0 0 0 0 yy 0 SRFLOP", one},
      {"A1 lo lo 0 0 0 yy 0 0 SRFLOP", one},
      {"A1 lo lo 0 0 0 0 yy 0 SRFLOP ic=1", one},
      {"A1 hi hi 0 0 0 0 yy 0 SRFLOP ic=1", 0}, /* the reset wins */
      {"A1 hi 0 0 0 0 0 yy 0 BUF Td=1", one},   /* as at the operating point, long before Td */
      {"A1 lo 0 0 0 0 yy 0 0 BUF Td=1 tripdt=1u", one},
      /* the common node is not ground: an input at ground is one, and is low */
      {"Vc cc 0 1\nA1 hi 0 cc cc cc cc yy cc AND", 1000. / 1001},
      {"Vc cc 0 1\nA1 hi cc cc cc cc cc yy cc AND", 2000. / 1001},
      {"X1 hi yy s\n.subckt s p q high=4\nA_U1 p 0 0 0 0 0 q 0 BUF Vhigh={high} Ref={high/2}\n"
       ".ends",
       4 * one},
      {"*$ compat ps\nA1 hi lo 0 0 0 0 yy 0 XOR", one},
      /* a threshold has no width, however large the levels are */
      {"Vi ii 0 1\nA1 ii ii ii 0 0 0 yy 0 AND Vhigh=1k Ref=0.5", 1000 * one},
      {"Vi ii 0 0\nA1 ii ii ii ii 0 0 yy 0 OR Vhigh=1k Ref=0.5", 0},
      {"A1 lo 0 0 0 0 0 yy 0 SRFLOP Vhigh=12 Ref=0.25", 0},
      {"A1 0 lo 0 0 0 0 yy 0 SRFLOP Vhigh=12 Ref=0.201 ic=1", 12 * one},
      {"A1 hi 0 0 0 0 0 yy 0 BUF Td=0us Trise=0ns", one},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text lines = {0};
    vs_text_add(&lines, "%s\nRyy yy 0 1k", ROWS[k].lines);
    double *v = course(lines.text, 20, "", __LINE__);
    vs_close(v[1], ROWS[k].value, 1, 0.02, ROWS[k].lines, __LINE__); /* an edge has rung out */
    vs_close(v[20], ROWS[k].value, 1, 1e-5, ROWS[k].lines, __LINE__);
    free(v);
    vs_text_free(&lines);
  }
}

/* The n-th instant, from 1, at which the course goes through a level, us; NaN: it does not. */
static double crossing(const double *v, int until_us, double level, int n) {
  for (int k = 1; k <= until_us; k++)
    if ((v[k] > level) != (v[k - 1] > level) && --n == 0)
      return k - 1 + (level - v[k - 1]) / (v[k] - v[k - 1]);
  return NAN;
}

/* Each instant is wanted within the run's largest step, 2 us here, as LTspice's gates, too, leave
 * the steps to others. */
static void instants(void) {
  static const struct {
    const char *lines;
    double level;
    double at_us[3]; /* 0: there is none */
  } ROWS[] = {
      /* v(up) is 1 V at 1 ms, and 1.5 V at 1.5 ms */
      {"A1 up 0 0 0 0 0 yy 0 BUF Ref=1", 0.5, {1000}},
      {"A1 up 0 0 0 0 0 yy 0 BUF Ref=1 Td=300u", 0.5, {1300}},
      {"A1 up 0 0 0 0 yy 0 0 BUF Ref=1 Trise=100u Td={0.3m}", 0.5, {1350}},
      {"A1 up 0 0 0 0 0 yy 0 BUF Ref=1 Tau=100u", 0.5, {1069.3}},
      {"A1 up 0 0 0 0 0 yy 0 BUF Ref=1 Rout=1k Cout=100n", 0.5, {1069.3}},
      {"Vw w 0 PULSE(0 5 300u 1u 1u 700u 1)\nA1 w 0 0 0 0 0 yy 0 OR Trise=20u Tfall=200u",
       0.5,
       {310.5, 1101.5}},
      /* a pulse that is shorter than the delay comes through */
      {"Vw w 0 PULSE(0 5 300u 1u 1u 50u 1)\nA1 w 0 0 0 0 0 yy 0 AND Vhigh=5 Td=600u Rout=9",
       2.5,
       {900.5, 951.5}},
      /* 1 V + 0.4 V up, 1 V - 0.4 V down, of a triangle of 1 V in 500 us */
      {"Vw w 0 PWL(0 0 1m 2 2m 0)\nA1 w 0 0 0 0 0 yy 0 SCHMITT Vt=1 Vh=0.4", 0.5, {700, 1700}},
      {"Vs s 0 PULSE(0 5 300u 1u 1u 50u 1)\nVr r 0 PULSE(0 5 900u 1u 1u 50u 1)\n"
       "A1 s r 0 0 0 yy 0 0 SRFLOP Td=10u Ref=2.5",
       0.5,
       {310.5, 910.5}},
      /* two that hold each other, without a delay: set at 0.3 ms, reset at 0.9 ms */
      {"Vs s 0 PULSE(0 5 300u 1u 1u 50u 1)\nVr r 0 PULSE(0 5 900u 1u 1u 50u 1)\nVb b2 0 PULSE(0 5 "
       "100u 1u 1u 50u 1)\nA1 s yy 0 0 0 nq 0 0 OR\nA2 r nq b2 0 0 yy 0 0 OR",
       0.5,
       {NAN, 300.5, 900.5}}, /* NaN: as they are at first */
      /* C is charged from 1 V to 2 V by 3 V, and back by 0 V: half a period of R C ln 2 */
      {"A1 yy 0 0 0 0 q 0 0 SCHMITT Vt=1.5 Vh=0.5 Vhigh=3\nRq q yy 1k\nCy yy 0 100n",
       1.5,
       {69.3, 69.3 + 40.5 + 28.8, 69.3 + 40.5 + 28.8 + 69.3}},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    double *v = course(ROWS[k].lines, 2000, "--set run.max_step=2us", __LINE__);
    for (int n = 0; n < 3 && !(ROWS[k].at_us[n] <= 0); n++)
      if (!isnan(ROWS[k].at_us[n]))
        vs_close(crossing(v, 2000, ROWS[k].level, n + 1), ROWS[k].at_us[n], 1, 2.1, ROWS[k].lines,
                 __LINE__);
    free(v);
  }
}

/* A timer in the shape of LTspice's NE555: comparators of 1 mV, a flip-flop with a rise, gates of
 * other levels. Its capacitor goes between a third and two thirds of the supply: up through 2 kohm
 * in 1.386 ms, down through 1 kohm and the switch in 0.697 ms. */
static const char TIMER[] =
    "Vcc vcc 0 12\nRa vcc dis 1k\nRb dis tri 1k\nCt tri 0 1u\nX1 0 tri yy vcc ctl tri dis vcc "
    "TIMER\n"
    "Ryy yy 0 1k\nRctl ctl 0 1meg\n.subckt TIMER 1 2 3 4 5 6 7 8\n"
    "A1 low 2 1 1 1 1 up 1 SCHMITT Vt=0 Vh=1m\nR1 low 1 5K\nR2 5 low 5K\nR3 8 5 5K\n"
    "S1 1 7 dis 1 D\nA2 set up 1 1 1 1 q 1 SRFLOP Trise=100n tripdt=10n\n"
    "A3 6 5 1 1 1 1 high 1 SCHMITT Vt=0 Vh=1m\nS2 8 3 nq 1 O\nS3 3 1 q 1 O\n"
    "A6 1 off 1 q 1 1 dis 1 OR Ref=.5 Vlow=-1 Trise=100n\nA4 1 q 1 off 1 nq 1 1 OR ref=.5 "
    "Trise=100n\n"
    "A5 4 1 1 1 1 off 1 1 SCHMITT Vt=.7 Vh=1m\nA7 1 off 1 high 1 1 set 1 OR\nR9 2 1 1G\nR10 6 1 "
    "1G\n"
    ".model O SW(Ron=6 Roff=1Meg Vt=.5 Vh=.1)\n.model D SW(Ron=6 Roff=1G Vt=.5 Vh=.4)\n.ends";

static void timer(void) {
  double *v = course(TIMER, 12000, "", __LINE__);
  double fall = crossing(v, 12000, 6, 1), rise = crossing(v, 12000, 6, 2),
         last = crossing(v, 12000, 6, 7);
  const double fallen = 1006 * log((8 - 0.072) / (4 - 0.072));
  CLOSE(rise - fall, fallen, 0.02); /* a step of 20 us at the tolerance of 1e-4, at each end */
  CLOSE((last - fall) / 3, 2000 * log(2) + fallen, 0.01);
  free(v);
}

/* Fuses as makers' libraries have them, written here: heat in a capacitor, a switch that it opens,
 * and an A device that remembers. 5 A flow from t = 0. */
#define FED "Is 0 yy PWL(0 0 1u 5)\nRyy yy 0 1k\n"

/* With a loss of heat and a resistance that rises: tau p' = i^2 (1 + p/E) - p reaches E at
 * tau/a ln(1 + a E/i^2), a = i^2/E - 1; behind this the flip-flop's delay. */
static const char WITH_LOSS[] =
    FED "XF yy 0 F2A\n.subckt F2A in out\nXF1 in out Link\n+PARAMS: I_FUSE=2 TAU_FUSE=20m\n.ends\n"
        ".SUBCKT Link in out ; a generic one\n+PARAMS: I_FUSE=1 TAU_FUSE=5\n"
        "E1 lim 0 Value={I_FUSE*I_FUSE*2}\nRX lim 0 1G\nR1 in 1 1m\nV2 1 2 0\n"
        "B1 0 pt I=I(V2)*I(V2)*(1+V(pt)/V(lim))\nR2 pt 0 1\nC1 pt 0 {TAU_FUSE} IC=0\n"
        "S1 2 out 5 0 SW1\nV3 4 0 PULSE(0 1 1u 1u 1u 10u 1e6)\nA1 3 4 0 0 0 5 0 0 SRFLOP td=1m\n"
        "B2 3 0 V=IF(V(pt)>V(lim), 1, 0)\n.MODEL SW1 SW(Ron=1u Roff=1G Vt=0.5 Vh=0)\n.ENDS";

/* The integral of i^2 alone, kept by a Schmitt trigger that never falls back: 0.1 A2s / 25 A2. */
static const char ADIABATIC[] =
    FED "XF yy 0 FI\n.subckt FI a b\nV1 a m 0\nB1 0 q I=I(V1)**2\nC1 q 0 1 ic=0\n"
        "A1 q 0 0 0 0 ok 0 0 SCHMITT Vt=0 Vh=0.1 Vhigh=5 Trise=1u\nS1 m b ok 0 sw\n"
        ".model sw SW(Ron=1m Roff=100Meg Vt=2.5 Vh=1)\n.ends";

/* The same by gates: an OR that holds itself, as the loop through A2 does. */
static const char BY_GATES[] =
    FED "XF yy 0 FG\n.subckt FG a b\nV1 a m 0\nB1 0 q I={1/0.1}*I(V1)*I(V1)\nC1 q 0 1 ic=0\n"
        "A1 q blown 0 0 0 ok blow 0 OR Ref=1 Vhigh=2 Trise=1u\nA2 blow 0 0 0 0 0 blown 0 BUF Ref=1 "
        "Vhigh=2 Td=10u\nS1 m b ok 0 sw\n.model sw SW(Ron=1m Roff=100Meg Vt=1 Vh=0.2)\n.ends";

static void fuses(void) {
  const double i2 = 25, most = 8, a = i2 / most - 1;
  const struct {
    const char *lines;
    double at_us;
  } ROWS[] = {{WITH_LOSS, 1e6 * (20e-3 / a * log(1 + a * most / i2) + 1e-3)},
              {ADIABATIC, 1e6 * 0.1 / i2},
              {BY_GATES, 1e6 * 0.1 / i2}};
  for (size_t k = 0; k < COUNT(ROWS); k++)
    for (int fine = 0; fine < 2; fine++) {
      const char *more = fine ? "--set run.max_step=2us" : "--set run.tolerance=1e-3";
      double *v = course(ROWS[k].lines, 7000, more, __LINE__);
      double at = crossing(v, 7000, 1000, 1);
      vs_close(at, ROWS[k].at_us, 1, fine ? 4 : 100, ROWS[k].lines, __LINE__);
      CLOSE(v[7000], 5000, 1e-2); /* it stays open, and nothing but 1 kohm is left */
      free(v);
    }
}

/* A delay that is shorter than a step is no more than an edge, behind which the output stays. */
static void short_delays(void) {
  static const char *const KINDS[] = {"BUF", "SRFLOP", "BUF Trise=1u"}, *const TD[] = {"10n", "1u"};
  for (size_t k = 0; k < COUNT(KINDS) * COUNT(TD); k++) {
    char lines[96];
    snprintf(lines, sizeof lines, "A1 up 0 0 0 0 0 yy 0 %s Ref=1 Td=%s", KINDS[k / 2], TD[k % 2]);
    double *v = course(lines, 2000, "", __LINE__);
    vs_close(crossing(v, 2000, 0.5, 1), 1001, 1, 1.6, lines, __LINE__);
    EXPECT(isnan(crossing(v, 2000, 0.5, 2)), "%s", lines);
    free(v);
  }
}

static void refused(const char *lines, const char *at, const char *says, int line) {
  vs_text deck = {0};
  vs_text_add(&deck, BENCH "%s\nRyy yy 0 1k\n", lines);
  write_file("d.cir", deck.text);
  vs_text_free(&deck);
  ran r = run("check d.cir");
  expect(r.status == 2 && strstr(r.err, at) && strstr(r.err, says), line, "%s: %d %s", lines,
         r.status, r.err);
  free_ran(&r);
}

static void refusals(void) {
  refused("A1 hi 0 lo 0 0 0 yy 0 DFLOP", "d.cir:14:23", "dflop is a device of LTspice's own",
          __LINE__);
  refused("A1 hi 0 lo 0 0 0 yy 0 SAMPLEHOLD", "d.cir:14:23", "BUF, INV, AND, OR, XOR", __LINE__);
  refused("A1 hi lo 0 0 0 0 yy 0 BUF", "d.cir:14:7", "none of its pins", __LINE__);
  refused("A1 hi 0 0 0 0 0 yy 0 INV", "d.cir:14:17", "/Q at 6 and", __LINE__);
  refused("A1 0 0 0 0 0 0 yy 0 AND", "d.cir:14:4", "are not there", __LINE__);
  refused("A1 hi 0 0 0 0 0 yy 0 BUF Vhigh=5 Iout=3", "d.cir:14:34", "Iout: no parameter of buf",
          __LINE__);
  refused("A1 hi 0 0 0 0 0 yy 0 BUF ic=1", "d.cir:14:26", "IC= of SRFLOP", __LINE__);
  refused("A1 hi 0 0 0 0 0 yy 0 BUF Td=-10u", "d.cir:14:26", "0 or more is wanted", __LINE__);
  refused("A1 hi 0 0 0 0 0 yy 0 BUF Rlow = 0", "d.cir:14:26", "more than 0 is wanted", __LINE__);
  refused("A1 hi 0 0 0 0 0 yy 0 BUF Vhigh={}", "d.cir:14:26", "it has no value", __LINE__);
  refused("A1 hi 0 0 0 0 0 yy 0 BUF Td=1u Td=1u", "d.cir:14:32", "given twice", __LINE__);
  refused("A1 N(1) 0 0 0 0 0 yy 0 BUF", "d.cir:14:4", "a node with brackets", __LINE__);
  write_file("d.cir", BENCH "A1 hi 0 0 0 0 0 yy 0 BUF\nRyy yy 0 1k\n");
  ran r = run("check d.cir");
  EXPECT(r.status == 0 && strstr(r.err, "d.cir:14:1: warning: an A device of LTspice's"), "%d %s",
         r.status, r.err);
  free_ran(&r);
}

int main(void) {
  static const vs_test TESTS[] = {
      {"truths", truths}, {"instants", instants}, {"short delays", short_delays},
      {"timer", timer},   {"fuses", fuses},       {"refusals", refusals}};
  return program_suite("gates", TESTS, COUNT(TESTS));
}
