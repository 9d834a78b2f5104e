/* SPDX-License-Identifier: GPL-3.0-or-later
 * Parts of the kinds diode, triac, MOSFET, IGBT and electrolytic capacitor: templates pass as they
 * are written; other numbers reach the model and are measured; a model that is off is found so; a
 * vendor's model is wrapped and tried, and the bench gets what its equations say. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "part_rows.h"

/* ---- templates ---- */

/* As written each is a good part whose model gives what the numbers ask; all of them are said to be
 * assumed. Only the triac's model is implausible: a rise behind a commutation fires it no sooner
 * than any other, and check says so. */
static void templates_pass(void) {
  static const struct {
    const char *kind;
    int figures, assumed, models; /* models: lines that would say how far the model is off */
  } ROWS[] = {{"diode", 6, 17, 1},
              {"triac", 20, 24, 6},
              {"mosfet", 11, 25, 1},
              {"igbt", 12, 29, 2},
              {"electrolytic", 4, 9, 0}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char assumed[64];
    ran r = run("part %s -o own.inc --overwrite", ROWS[k].kind);
    expect_good(&r, ROWS[k].kind, __LINE__);
    free_ran(&r);
    r = run("check own.inc");
    bool is_triac = !strcmp(ROWS[k].kind, "triac");
    if (is_triac)
      EXPECT(r.status == 0 && strstr(r.err, "implausible: (dv/dt)c is "), "%s", r.err);
    else
      expect_good(&r, ROWS[k].kind, __LINE__);
    snprintf(assumed, sizeof assumed, "\n%d numbers of the file are marked assumed",
             ROWS[k].assumed);
    int models = ROWS[k].models ? ROWS[k].models + 1 : 0;
    EXPECT(count_lines(r.out) == ROWS[k].figures + 3 + models, "%s: %s", ROWS[k].kind, r.out);
    EXPECT(strstr(r.out, assumed), "%s: %s", ROWS[k].kind, r.out);
    EXPECT(!strstr(r.out, " off ") && !strstr(r.out, " failed "), "%s: %s", ROWS[k].kind, r.out);
    free_ran(&r);
  }
}

/* A template that has the name of its kind is a file beside which nothing of the program's is taken
 * for itself. What is sought takes long, and is left out. */
static void named_as_its_kind(void) {
  static const char *const KINDS[] = {"thyristor", "triac", "diode"}, *const LONG[] = {
                                                                          "dv_dt", "dv_dt_c", "i_l",
                                                                          "t_q"};
  for (size_t k = 0; k < COUNT(KINDS); k++) {
    char name[32], limit[2][32];
    snprintf(name, sizeof name, "%s.inc", KINDS[k]);
    ran r = run("part %s -o %s --overwrite", KINDS[k], name);
    free_ran(&r);
    for (size_t n = 0; n < COUNT(LONG); n++) {
      snprintf(limit[0], sizeof limit[0], "*$ limit  %s =", LONG[n]);
      snprintf(limit[1], sizeof limit[1], "* limit  %s =", LONG[n]);
      char *text = read_file(name);
      if (strstr(text, limit[0])) alter(name, name, limit[0], limit[1]);
      free(text);
    }
    r = run("check %s", name);
    EXPECT(r.status == 0 && strstr(r.out, ": a good part: "), "%s: %s", name, r.err);
    free_ran(&r);
    unlink(name);
  }
}

/* A figure that the model is made of is tried as the model has it, whatever a limit's test is. */
static void conditions(void) {
  ran r = run("part diode -o my.inc --overwrite");
  free_ran(&r);
  alter("my.inc", "my.inc", "*$ limit  v_rrm", "*$ limit i_test = 20 A\n*$ limit  v_rrm");
  r = run("check my.inc --json");
  EXPECT(r.status == 0, "%s", r.err);
  CLOSE(number_of(r.out, "Q_rr", 0, "got"), 0.5, 0.1);
  free_ran(&r);
  r = run("part igbt -o my.inc --overwrite");
  free_ran(&r);
  alter("my.inc", "my.inc", "*$ limit  v_ces",
        "*$ limit i_test = 5 A\n*$ limit v_test = 200 V\n*$ limit  v_ces");
  r = run("check my.inc --json");
  EXPECT(r.status == 0, "%s", r.err);
  CLOSE(number_of(r.out, "E_off", 0, "got"), 0.4, 1.0 / 6);
  free_ran(&r);
}

/* ---- other numbers ---- */

enum { MOST_CHANGES = 8, MOST_ROWS = 8 };

/* A template with other numbers, and what the bench must get, each relative to a tolerance. */
static const struct other {
  const char *kind;
  const char *changes[MOST_CHANGES][2];
  struct {
    const char *figure;
    int nth;
    double got, tolerance;
  } row[MOST_ROWS];
} OTHERS[] = {
    {"diode",
     {{"my_on_voltage = 0.9 V", "my_on_voltage = 0.7 V"},
      {"my_on_resistance = 30", "my_on_resistance = 8"},
      {"my_recovered_charge = 0.5", "my_recovered_charge = 2"},
      {"my_softness = 0.5", "my_softness = 1"},
      {"my_test_current = 10 A", "my_test_current = 40 A"},
      {"my_blocking_voltage = 600 V", "my_blocking_voltage = 1200 V"},
      {"v_rrm = 600 V", "v_rrm = 1200 V"}},
     /* Q_rr = di/dt rise^2 (1/2 + softness), and I_RM = di/dt rise: 20 nC and 1 nF more. Breakdown
        is at 1.2 V_RRM, less 1 mA in 40 Mohm. */
     {{"V_F", 0, 0.7 + 0.32, 0.01},
      {"V_F", 1, 0.7 + 0.032, 0.05},
      {"V_R", 0, 1440, 0.01},
      {"Q_rr", 0, 2, 0.05},
      {"I_RM", 0, 11.55, 0.05}}},
    {"mosfet",
     {{"my_on_resistance = 400", "my_on_resistance = 60"},
      {"my_threshold = 3 V", "my_threshold = 2 V"},
      {"my_transconductance = 6", "my_transconductance = 20"},
      {"my_transconductance_current = 8", "my_transconductance_current = 20"},
      {"my_test_current = 8 A", "my_test_current = 20 A"},
      {"my_recovered_charge = 3", "my_recovered_charge = 0.4"},
      {"my_blocking_voltage = 500 V", "my_blocking_voltage = 100 V"},
      {"v_dss = 500 V", "v_dss = 100 V"}},
     {{"R_DS(on)", 0, 60, 0.03},
      {"V_GS(th)", 0, 2, 0.01},
      {"g_fs", 0, 20, 0.02},
      {"V_DS", 0, 120, 0.01},
      {"V_F", 0, 0.8 + 0.6, 0.01},
      {"Q_rr", 0, 0.4, 0.05}}},
    {"igbt",
     {{"my_on_voltage = 0.9 V", "my_on_voltage = 1.2 V"},
      {"my_on_resistance = 50", "my_on_resistance = 20"},
      {"my_threshold = 5 V", "my_threshold = 5.8 V"},
      {"my_test_current = 15 A", "my_test_current = 50 A"},
      {"my_transconductance = 10", "my_transconductance = 30"},
      {"my_transconductance_current = 15", "my_transconductance_current = 50"},
      {"my_turn_off_energy = 0.4", "my_turn_off_energy = 3"},
      {"my_input_capacitance = 1000", "my_input_capacitance = 3000"}},
     {{"V_CE(sat)", 0, 1.2 + 1, 0.02},
      {"V_GE(th)", 0, 5.8, 0.01},
      {"g_fs", 0, 30, 0.02},
      {"V_CE", 0, 720, 0.01},
      {"E_off", 0, 3, 1.0 / 6}}},
    {"electrolytic",
     {{"my_capacitance = 470", "my_capacitance = 2200"},
      {"my_esr = 250", "my_esr = 40"},
      {"esr = 0.25", "esr = 0.04"},
      {"my_esr_high = 170", "my_esr_high = 25"},
      {"my_leakage = 1 mA", "my_leakage = 3 mA"}},
     {{"C", 0, 2200, 0.01}, {"ESR", 0, 40, 0.03}, {"ESR", 1, 25, 0.05}, {"leakage", 0, 3, 0.01}}}};

static void write_other(const struct other *o) {
  ran r = run("part %s -o my.inc --overwrite", o->kind);
  expect_good(&r, o->kind, __LINE__);
  free_ran(&r);
  for (int n = 0; n < MOST_CHANGES && o->changes[n][0]; n++)
    alter("my.inc", "my.inc", o->changes[n][0], o->changes[n][1]);
}

static void other_numbers(void) {
  for (const struct other *o = OTHERS; o < OTHERS + COUNT(OTHERS); o++) {
    write_other(o);
    ran r = run("check my.inc --json");
    EXPECT(r.status == 0 && !strstr(r.out, "\"off\""), "%s: %d: %s%s", o->kind, r.status, r.err,
           r.out);
    for (int n = 0; n < MOST_ROWS && o->row[n].figure; n++)
      CLOSE(number_of(r.out, o->row[n].figure, o->row[n].nth, "got"), o->row[n].got,
            o->row[n].tolerance);
    free_ran(&r);
  }
}

/* A triac of other numbers, with 220 ohm beside its gate: they take 0.75 V / 220 ohm = 3.4 mA, so
 * that I_GT is off in each quadrant; the rest is as asked. */
static void a_sensitive_triac(void) {
  static const char *const CHANGES[][2] = {
      {"triac_gate_current = 35 mA", "triac_gate_current = 10 mA"},
      {"triac_gate_current_2 = 35 mA", "triac_gate_current_2 = 12 mA"},
      {"triac_gate_current_3 = 35 mA", "triac_gate_current_3 = 14 mA"},
      {"triac_gate_current_4 = 70 mA", "triac_gate_current_4 = 1 kA"},
      {"triac_latching_current = 60", "triac_latching_current = 25"},
      {"triac_holding_current = 35", "triac_holding_current = 15"},
      {"X1 mt2 mt1 g ", "Rbeside g mt1 220\nX1 mt2 mt1 g "}};
  RUN_GOOD("part triac -o my.inc --overwrite --quiet");
  for (size_t k = 0; k < COUNT(CHANGES); k++)
    alter("my.inc", "my.inc", CHANGES[k][0], CHANGES[k][1]);
  ran r = run("check my.inc --json");
  EXPECT(r.status == 1 && strstr(r.err, "3 of 15 figures are not what is asked"), "%d: %s",
         r.status, r.err);
  for (int n = 0; n < 3; n++) {
    double more = number_of(r.out, "I_GT", n, "got") - (10 + 2 * n);
    EXPECT(more > 2.8 && more < 4.2, "quadrant %d: %g mA more", n + 1, more);
  }
  EXPECT(isnan(number_of(r.out, "I_GT", 3, "got")), "quadrant 4: %s", r.out);
  for (int n = 0; n < 2; n++) { /* MT2 positive, negative */
    CLOSE(number_of(r.out, "I_H", n, "got"), 15, 0.03);
    CLOSE(number_of(r.out, "dv/dt", n, "got"), 500, 0.12);
    /* The model has no (dv/dt)c of its own: it fires at dv/dt. */
    EXPECT(number_of(r.out, "(dv/dt)c", n, "got") > 400, "%s", r.out);
  }
  free_ran(&r);
}

/* ---- what is off ---- */

/* One number of the model is not the file's: the row that tells of it, and no other, is off. */
static void what_is_off(void) {
  static const struct {
    const char *kind, *old, *new, *figure;
    int nth;
  } ROWS[] = {{"diode", "q_rr={my_recovered_charge}", "q_rr={1.3*my_recovered_charge}", "Q_rr", 0},
              {"mosfet", "r_on={my_on_resistance}", "r_on={1.1*my_on_resistance}", "R_DS(on)", 0},
              {"igbt", "e_off={my_turn_off_energy}", "e_off={2*my_turn_off_energy}", "E_off", 0},
              {"electrolytic", "esr_high={my_esr_high}", "esr_high={1.1*my_esr_high}", "ESR", 1}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("part %s -o my.inc --overwrite", ROWS[k].kind);
    free_ran(&r);
    alter("my.inc", "my.inc", ROWS[k].old, ROWS[k].new);
    r = run("check my.inc --json");
    double got = number_of(r.out, ROWS[k].figure, ROWS[k].nth, "got"),
           asked = number_of(r.out, ROWS[k].figure, ROWS[k].nth, "asked");
    EXPECT(r.status == 1 && strstr(r.err, ": 1 of "), "%s: %d: %s", ROWS[k].kind, r.status, r.err);
    EXPECT(got > 1.05 * asked, "%s: %g for %g", ROWS[k].figure, got, asked);
    free_ran(&r);
  }
}

/* ---- a vendor's ---- */

/* Written here, in the manner of a vendor's library: elements of plain SPICE. */
static const char VENDOR[] =
    ".subckt RD10 K A PARAMS: RS=20m\nD1 A K dmod\n"
    ".model dmod d(is=1n n=1.6 rs={RS} tt=80n cjo=100p bv=700 ibv=1m)\n.ends\n"
    ".subckt NM8 1 2 3\nLd 1 d 5n\nRdl 1 d 10\nM1 d gi 3 3 chan L=1u W=1u\nRg 2 gi 3\n"
    ".model chan nmos(level=1 vto=3.5 kp=4 rd=0.25 is=1e-20)\nCgs gi 3 1n\nCgd gi d 60p\nCds d 3 "
    "150p\n"
    "D1 3 d body\n.model body d(is=1p rs=20m tt=200n bv=550 ibv=1m)\n.ends\n"
    ".subckt GB15 Collector Gate Emitter\nM1 b gi e e chan L=1u W=1u\nRe e Emitter 1m\n"
    "Rg Gate gi 5\n.model chan nmos(level=1 vto=5 kp=6 rd=20m)\nQ1 Emitter b Collector pq\n"
    ".model pq pnp(is=1e-14 bf=1 tf=0.3u re=10m rc=1m)\nCge gi e 1n\nCgc gi b 50p\n"
    "Rl Collector Emitter 5meg\nDz Emitter Collector dd\n"
    ".model dd d(is=1p n=1.2 rs=20m tt=50n bv=700 ibv=1m)\n.ends\n"
    ".subckt TR12 T2 T1 G\nQp1 x1 y1 T2 pmod\nQn1 y1 x1 T1 nmod\nRg1 x1 T1 40\n"
    "Qp2 x2 y2 T1 pmod\nQn2 y2 x2 T2 nmod\nRg2 x2 T2 40\nRg G T1 40\nF1 T2 x2 Vn 1\n"
    "Vn T1 nn 0\nDn nn G dg\nF2 T1 x1 Vp 1\nDp G pp dg\nVp pp T1 0\n.model dg d(is=1n)\n"
    "Rl T2 T1 1meg\n.model pmod pnp(is=1e-14 bf=0.5 tf=2u cjc=20p cje=50p re=0.02)\n"
    ".model nmod npn(is=1e-14 bf=20 tf=0.3u cjc=20p cje=100p rc=0.02)\n.ends\n";

/* Wraps one, and expects its call and what is said of the pins in the part's file. */
static ran wrapped(const char *kind, const char *called, const char *call, const char *says) {
  ran r = run("part %s --wrap vendor.lib:%s -o my.inc --overwrite", kind, called);
  expect_good(&r, called, __LINE__);
  free_ran(&r);
  char *text = read_file("my.inc");
  EXPECT(strstr(text, call) && strstr(text, says), "%s", text);
  free(text);
  if (!strcmp(kind, "triac")) { /* what is sought takes long */
    alter("my.inc", "my.inc", "*$ limit  dv_dt =", "* limit  dv_dt =");
    alter("my.inc", "my.inc", "*$ limit  dv_dt_c =", "* limit  dv_dt_c =");
    alter("my.inc", "my.inc", "*$ limit  i_l =", "* limit  i_l =");
  }
  return run("check my.inc --json");
}

/* The junction: n vt ln(i/is) + rs i at 10 A, 1.6*0.025865 V*ln(1e10) + 0.2 V. */
static void a_vendors_diode(void) {
  ran r = wrapped("diode", "RD10", "\nX1 k a RD10\n", "by their names");
  EXPECT(r.status == 0, "%d: %s", r.status, r.err);
  CLOSE(number_of(r.out, "V_F", 0, "got"), 1.1529, 1e-3);
  CLOSE(number_of(r.out, "V_R", 0, "got"), 700, 1e-3);
  free_ran(&r);
}

/* Level 1: i = kp/2 (v - vto)^2 in saturation; at 8 A and 10 V the channel has v^2 - 13 v + 4 = 0,
 * and rd is in series. Its pins are numbers, so that their order is assumed. */
static void a_vendors_mosfet(void) {
  ran r = wrapped("mosfet", "NM8", "\nX1 d g s NM8\n", "assumed, as the names do not say");
  EXPECT(r.status == 0, "%d: %s", r.status, r.err);
  CLOSE(number_of(r.out, "V_GS(th)", 0, "got"), 3.5 + sqrt(2 * 0.25e-3 / 4), 1e-3);
  CLOSE(number_of(r.out, "g_fs", 0, "got"), 8, 2e-3);
  CLOSE(number_of(r.out, "R_DS(on)", 0, "got"), 250 + 1e3 * (13 - sqrt(169 - 16)) / 2 / 8, 2e-3);
  CLOSE(number_of(r.out, "V_DS", 0, "got"), 550, 1e-3);
  CLOSE(number_of(r.out, "V_F", 0, "got"), 0.025865 * log(8e12) + 0.16, 2e-3);
  free_ran(&r);
}

/* Half of the collector's current is the channel's, as the transistor amplifies by 1. */
static void a_vendors_igbt(void) {
  ran r = wrapped("igbt", "GB15", "\nX1 c g e GB15\n", "by their names");
  EXPECT(r.status == 1 && number_of(r.out, "E_off", 0, "got") > 0.6, "%d: %s", r.status, r.out);
  CLOSE(number_of(r.out, "V_GE(th)", 0, "got"), 5 + sqrt(2 * 0.25e-3 / 6), 2e-3);
  CLOSE(number_of(r.out, "V_CE", 0, "got"), 700, 2e-3);
  free_ran(&r);
}

/* It is the same both ways, so the bench must see the same in the mirror; its gate fires it in the
 * first and third quadrant. */
static void a_vendors_triac(void) {
  ran r = wrapped("triac", "TR12", "\nX1 mt2 mt1 g TR12\n", "by their names");
  double first = number_of(r.out, "I_GT", 0, "got"), third = number_of(r.out, "I_GT", 2, "got");
  EXPECT(r.status == 1 && first > 10 && first < 35, "%d: %g mA: %s", r.status, first, r.err);
  CLOSE(third, first, 1e-3);
  EXPECT(!(number_of(r.out, "I_GT", 1, "got") < 100), "%s", r.out);
  CLOSE(number_of(r.out, "V_T", 0, "got"), number_of(r.out, "V_T", 1, "got"), 1e-4);
  CLOSE(number_of(r.out, "I_H", 0, "got"), number_of(r.out, "I_H", 1, "got"), 1e-3);
  free_ran(&r);
}

/* Triacs in the shapes of makers' libraries, written here: A, K and G as of a thyristor, with
 * transistors and with switches; numbers; letters that are wrong; and what tells nothing. */
static const char TRIACS[] =
    ".subckt TKG A K G\nQp1 n2 n1 A pm\nQn1 n1 n2 K nm\nRg1 G n2 20\nRb1 n2 K 100\n"
    "Qp2 n4 n3 K pm\nQn2 n3 n4 A nm\nRg2 G n4 20\nRb2 n4 A 1k\n"
    ".model pm pnp(is=1e-14 bf=1 cjc=50p cje=50p tf=1u)\n"
    ".model nm npn(is=1e-14 bf=50 cjc=50p cje=100p tf=0.2u)\n.ends\n"
    ".subckt GENERAL A K G PARAMS: Igt=20m Rt=10m\nS1 A p on 0 sm\nV1 p K 0\nS2 n A on 0 sm\n"
    "V2 K n 0\nRgk G K 10G\nD1 g2 G dg\nD2 G g2 dg\nVg g2 g3 0\nRl g3 K 35\nRak A K 10meg\n"
    "Eon on 0 VALUE={IF(ABS(I(Vg))>Igt,1,0)}\n.model sm VSWITCH(Ron={Rt} Roff=1meg)\n"
    ".model dg D(Is=1e-14)\n.ends\n"
    ".subckt B12-600 A K G\nX1 A K G GENERAL PARAMS: Igt=35m\n.ends\n"
    ".SUBCKT Q12 1 2 3\nQ1 6 5 4 QN1\nQ2 5 6 1 QP1\nQ3 7 8 1 QN1\nQ4 8 7 2 QP1\nVs 4 2 0\n"
    "R1 5 3 10\nR2 5 4 60\nR3 3 7 470\nR4 7 1 2k\n.model QN1 NPN(BF=30)\n"
    ".model QP1 PNP(BF=0.5)\n.ends\n"
    ".SUBCKT TURNED K G A\nXp K A g1 HALF\nXn A K g2 HALF\nR1 G g1 22\nR2 G g2 330\n.ends\n"
    ".subckt HALF a k g\nQ1 b c a pp\nQ2 c b k nn\nRk b k 200\nRg g b 2\n.model pp pnp(bf=2)\n"
    ".model nn npn(bf=10)\n.ends\n"
    ".SUBCKT LEAKS 1 2 3\nQ1 4 3 2 QN1\nQ2 3 4 1 QP1\nQ3 5 6 1 QN1\nQ4 6 5 2 QP1\nR1 6 1 60\n"
    "R2 3 1 10k\nD1 3 2 DG\n.model QN1 NPN\n.model QP1 PNP\n.model DG D\n.ends\n"
    ".SUBCKT LEAKS_AKG A K G\nX1 A K G LEAKS\n.ends\n"
    ".SUBCKT DUMB 1 2 3\nS1 1 2 c 0 sw\nEc c 0 3 0 1\n.model sw sw(vt=1)\n.ends\n"
    ".SUBCKT AKG A K G\nS1 A K c 0 sw\nEc c 0 G 0 1\n.model sw sw(vt=1)\n.ends\n"
    ".SUBCKT NAMED MT1 G MT2\nS1 MT1 MT2 c 0 sw\nEc c 0 G MT1 1\n.model sw sw(vt=1)\n.ends\n";

static void triacs_pins(void) {
  static const struct {
    const char *name, *pins, *call, *says;
  } ROWS[] = {
      {"TKG", "", "\nX1 mt2 mt1 g TKG\n", "by the junctions"},
      {"B12-600", "", "\nX1 mt2 mt1 g B12-600\n", "by the junctions"},
      {"Q12", "", "\nX1 mt2 mt1 g Q12\n", "by the junctions"},
      {"TURNED", "", "\nX1 mt2 g mt1 TURNED\n", "A is mt1 (main terminal 1), by the junctions"},
      {"TURNED", "--pins 1g2", "\nX1 mt1 g mt2 TURNED\n", "as --pins says"},
      {"AKG", "", "\nX1 mt2 mt1 g AKG\n", "by their names"},
      /* a resistor that leaks to MT2 contradicts the junction on MT1 */
      {"LEAKS_AKG", "", "\nX1 mt2 mt1 g LEAKS_AKG\n", "by their names"},
      {"NAMED", "", "\nX1 mt1 g mt2 NAMED\n", "by their names"},
      {"DUMB", "--pins 21G", "\nX1 mt2 mt1 g DUMB\n", "as --pins says"}};
  write_file("vendor.lib", TRIACS);
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r =
        run("part triac --wrap vendor.lib:%s %s -o my.inc --overwrite", ROWS[k].name, ROWS[k].pins);
    expect_good(&r, ROWS[k].name, __LINE__);
    free_ran(&r);
    char *text = read_file("my.inc");
    EXPECT(strstr(text, ROWS[k].call) && strstr(text, ROWS[k].says), "%s: %s", ROWS[k].name, text);
    free(text);
  }
  ran r = run("part triac --wrap vendor.lib:LEAKS -o other.inc");
  EXPECT(r.status == 2 && strstr(r.err, "--pins 21g"), "%d %s", r.status, r.err);
  free_ran(&r);
  r = run("part triac --wrap vendor.lib:DUMB -o other.inc");
  EXPECT(r.status == 2 && strstr(r.err, "pins 1, 2 and 3 are main terminal 2") &&
             strstr(r.err, "--pins 21g"),
         "%d %s", r.status, r.err);
  free_ran(&r);
  r = run("part triac --wrap vendor.lib:DUMB --pins 221 -o other.inc");
  EXPECT(r.status == 2 && strstr(r.err, "the letters 21g are wanted"), "%d %s", r.status, r.err);
  free_ran(&r);
  r = run("part triac --pins 21g -o other.inc");
  EXPECT(r.status == 2 && strstr(r.err, "goes with --wrap"), "%d %s", r.status, r.err);
  free_ran(&r);
  /* 1.0589 V at 17 A by plain ngspice with its gate driven. The other way 11 V drive 20 mA through
   * the gate's resistors, which fires it; so it is with TKG both ways. */
  r = wrapped("triac", "Q12", "\nX1 mt2 mt1 g Q12\n", "by the junctions");
  CLOSE(number_of(r.out, "V_T", 0, "got"), 1.0589, 2e-3);
  EXPECT(isnan(number_of(r.out, "V_T", 1, "got")), "%s", r.out);
  free_ran(&r);
  r = wrapped("triac", "TKG", "\nX1 mt2 mt1 g TKG\n", "by the junctions");
  EXPECT(isnan(number_of(r.out, "V_T", 0, "got")) &&
             strstr(r.out, "could not judge: it conducts with its gate open"),
         "%s", r.out);
  free_ran(&r);
}

static void a_vendors_models(void) {
  write_file("vendor.lib", VENDOR);
  a_vendors_diode();
  a_vendors_mosfet();
  a_vendors_igbt();
  a_vendors_triac();
  triacs_pins();
}

/* ---- what is implausible, and what is not tried ---- */

static void implausible_numbers(void) {
  static const struct {
    const char *kind, *old, *new, *says;
    int line;
  } ROWS[] = {
      {"diode", "v_rrm = 600 V", "v_rrm = 600 kV", "a diode has 5 to 2e+04 V", 8},
      {"mosfet", "i_d = 8 A", "i_d = 32 A", "heats the junction by", 15},
      {"igbt", "v_ces = 600 V", "v_ces = 1200 V", "blocking_voltage, by which the model is made",
       0},
      {"electrolytic", "v_rated = 450 V", "v_rated = 45 kV", "an electrolytic has 2 to 1000 V", 8}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("part %s -o my.inc --overwrite", ROWS[k].kind);
    free_ran(&r);
    alter("my.inc", "my.inc", ROWS[k].old, ROWS[k].new);
    r = run("check my.inc");
    EXPECT(strstr(r.err, ROWS[k].says), "%s: %s", ROWS[k].kind, r.err);
    if (ROWS[k].line) expect_warning(&r, "my.inc", ROWS[k].line, ROWS[k].says);
    free_ran(&r);
  }
}

/* A part that is only read is not told as one that was tried. */
static void what_is_not_tried(void) {
  ran r = run("check " VS_TEST_FOLDER "/../spice/parts/gate_ideal.inc");
  EXPECT(r.status == 0 && strstr(r.out, "\nno bench: parts of the kind 'gate_drive'"), "%s", r.out);
  free_ran(&r);
  r = run("check " VS_TEST_FOLDER "/../spice/parts/gate_ideal.inc --json");
  EXPECT(r.status == 0 && strstr(r.out, "\"message\": \"no bench: "), "%s", r.out);
  free_ran(&r);
  r = run("check " VS_TEST_FOLDER "/../spice/parts/rc_snubber.inc --json");
  CLOSE(number_of(r.out, "C", 0, "got"), 0.1, 1e-3);
  CLOSE(number_of(r.out, "R", 0, "got"), 100, 1e-3);
  free_ran(&r);
}

static const vs_test TESTS[] = {
    {"named as its kind", named_as_its_kind}, {"conditions", conditions},
    {"templates pass", templates_pass},       {"other numbers", other_numbers},
    {"a sensitive triac", a_sensitive_triac}, {"what is off", what_is_off},
    {"a vendor's models", a_vendors_models},  {"implausible numbers", implausible_numbers},
    {"what is not tried", what_is_not_tried},
};

int main(void) {
  return program_suite("part_kinds", TESTS, COUNT(TESTS));
}
