/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command part and the bench of check: templates pass as they are written; a model gives what
 * its file asks, also with other numbers; a vendor's model is wrapped and tried; what is
 * implausible is named with its line; how far a model is from its sheet stands beside the margins.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"
#include "netlist/kinds.h"
#include "part_rows.h"

#define TEMPLATES VS_TEST_FOLDER "/../spice/templates"

/* ---- templates ---- */

/* As written each is a good part whose model gives what the numbers ask; all of them are said to be
 * assumed. */
static void templates_pass(void) {
  if (is_for_memory_alone()) return;
  static const struct {
    const char *kind;
    int figures, assumed, models; /* models: lines that would say how far the model is off */
  } ROWS[] = {{"thyristor", 10, 24, 6}, {"varistor", 3, 9, 2}, {"diac", 7, 10, 0},
              {"zener", 1, 14, 1},      {"tvs", 2, 13, 2},     {"fuse", 5, 9, 4},
              {"resistor", 1, 7, 0},    {"capacitor", 2, 6, 0}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char assumed[64];
    ran r = run("part %s -o own.inc --overwrite", ROWS[k].kind);
    expect_good(&r, ROWS[k].kind, __LINE__);
    free_ran(&r);
    r = run("check own.inc");
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

/* A part made from a template lacks no limit without which a verdict is undecided; a fuse's has the
 * limits of all its measures. */
static void templates_decide(void) {
  for (const vs_kind *kind = vs_kinds_all; kind->name; kind++) {
    vs_text path[2] = {0};
    vs_text_add(&path[0], "%s/%s.inc", TEMPLATES, kind->name);
    vs_text_add(&path[1], "%s/%s_wrapped.inc", TEMPLATES, kind->name);
    for (size_t p = 0; p < COUNT(path); p++) {
      char *text = access(path[p].text, R_OK) ? NULL : read_file(path[p].text);
      for (size_t k = 0; text && k < kind->n_measures; k++) {
        const vs_device_measure *m = &kind->measures[k];
        vs_text line = {0};
        if (!m->limit || m->held == VS_WARD_AT_MOST) continue;
        vs_text_add(&line, "\n*$ limit  %s = ", m->limit);
        if (vs_kinds_decides(kind->name, m->limit) || kind->melts)
          EXPECT(strstr(text, line.text), "%s has no %s", path[p].text, m->limit);
        vs_text_free(&line);
      }
      free(text);
      vs_text_free(&path[p]);
    }
  }
}

/* A rating that the model contradicts is told: one of the two was left as it was. */
static void twins(void) {
  RUN_GOOD("part fuse -o two.inc");
  alter("two.inc", "two.inc", "two_melting_i2t = 3.6", "two_melting_i2t = 8");
  ran r = run("check two.inc");
  EXPECT(
      strstr(r.err, "melting_i2t, by which the model is made, is 2.222 times the limit i2t_melt"),
      "%s", r.err);
  free_ran(&r);
}

/* A number that is replaced reaches the model, the bench asks for it, and it is assumed no more. */
static void filled_in(void) {
  RUN_GOOD("part varistor -o disc.inc");
  alter("disc.inc", "disc.inc", "disc_v_1ma = 750 V      1..1e5  assumed",
        "disc_v_1ma = 390 V 1..1e5");
  alter("disc.inc", "disc.inc", "disc_v_clamp = 1240 V", "disc_v_clamp = 650 V");
  alter("disc.inc", "disc.inc", "v_rms = 460 V", "v_rms = 250 V");
  ran r = run("check disc.inc --json");
  expect_good(&r, "disc", __LINE__);
  /* Parallel to the line from 1.1*390 V at 1 mA to 650 V at 100 A. */
  double exponent = log(1e5) / log(650 / (1.1 * 390));
  CLOSE(number_of(r.out, "V", 0, "got"), 390, 1e-4);
  CLOSE(number_of(r.out, "V", 1, "got"), 650 / 1.1, 1e-4);
  CLOSE(number_of(r.out, "V", 2, "got"), 390 * pow(8e6, 1 / exponent), 1e-4);
  free_ran(&r);
  RUN_GOOD("part fuse -o link.inc");
  alter("link.inc", "link.inc", "melting_i2t = 3.6", "melting_i2t = 8");
  alter("link.inc", "link.inc", "i2t_melt = 3.6", "i2t_melt = 8");
  alter("link.inc", "link.inc", "i2t_clear = 25", "i2t_clear = 60");
  r = run("check link.inc --json");
  expect_good(&r, "link", __LINE__);
  CLOSE(number_of(r.out, "I2t melting", 0, "got"), 8, 0.01);
  CLOSE(number_of(r.out, "I melting", 0, "got"), 13, 0.02);
  free_ran(&r);
}

/* A model that is not what is asked: status 1, the row says so. */
static void what_is_off(void) {
  RUN_GOOD("part resistor -o load.inc");
  alter("load.inc", "load.inc", "R1 a m {load_resistance}", "R1 a m {1.05*load_resistance}");
  ran r = run("check load.inc");
  EXPECT(r.status == 1 && strstr(r.out, "100 +- 1 ohm") && strstr(r.out, "105 ohm") &&
             strstr(r.out, " off ") && strstr(r.err, "1 of 1 figures are not what is asked"),
         "%d: %s%s", r.status, r.out, r.err);
  free_ran(&r);
  r = run("check load.inc --json --quiet");
  EXPECT(r.status == 1 && strstr(r.out, "{\"file\": \"load.inc\", \"line\": 13, \"column\": 1, ") &&
             strstr(r.out, "\"word\": \"off\""),
         "%d: %s", r.status, r.out);
  free_ran(&r);
}

/* ---- parts that come with the program ---- */

/* Each does what its file asks, within the bench's tolerances, and nothing of it is implausible.
 * The first ones reach all code that the others do. */
static void shipped_parts(void) {
  static const char *const PARTS[] = {
      "latch",          "s14k460", "FWP-10A14F", "s20k510",      "v481da40",     "varistor_siov",
      "varistor_power", "fuse",    "FWP-50A14F", "A070gRB10T13", "S505H-3-15-R", "fuse_ideal"};
  for (size_t k = 0; k < (is_for_memory_alone() ? 3 : COUNT(PARTS)); k++) {
    ran r = run("check " VS_TEST_FOLDER "/../spice/parts/%s.inc", PARTS[k]);
    expect_good(&r, PARTS[k], __LINE__);
    EXPECT(!strstr(r.out, " off ") && !strstr(r.out, " failed ") && strstr(r.out, "\nfigure "),
           "%s: %s", PARTS[k], r.out);
    free_ran(&r);
  }
}

/* The bench's numbers of a thyristor with values of its own, against these: what
 * test_parts_thyristor holds the model to. */
static void a_small_thyristor(void) {
  if (is_for_memory_alone()) return;
  static const char *const CHANGES[][2] = {{"gate_current = 15 mA", "gate_current = 5 mA"},
                                           {"latching_current = 60 mA", "latching_current = 30 mA"},
                                           {"holding_current = 30 mA", "holding_current = 12 mA"},
                                           {"critical_dvdt = 200", "critical_dvdt = 500"},
                                           {"turn_off_time = 50", "turn_off_time = 100"},
                                           {"recovered_charge = 10", "recovered_charge = 4"}};
  RUN_GOOD("part thyristor -o small.inc");
  for (size_t k = 0; k < COUNT(CHANGES); k++)
    alter("small.inc", "small.inc", CHANGES[k][0], CHANGES[k][1]);
  ran r = run("check small.inc --json");
  EXPECT(r.status == 0, "%d: %s", r.status, r.err);
  expect_warning(&r, "small.inc", 32, "critical_dvdt, by which the model is made, is 2.5 times");
  expect_warning(&r, "small.inc", 33, "turn_off_time, by which the model is made, is 2 times");
  CLOSE_OF(number_of(r.out, "V_T", 0, "got"), 0.9 + 0.2, 1, 0.03);
  CLOSE(number_of(r.out, "I_GT", 0, "got"), 5, 0.03);
  CLOSE(number_of(r.out, "I_L", 0, "got"), 30, 0.04);
  CLOSE(number_of(r.out, "I_H", 0, "got"), 12, 0.03);
  CLOSE(number_of(r.out, "dv/dt", 0, "got"), 500, 0.12);
  CLOSE(number_of(r.out, "t_q", 0, "got"), 100, 0.08);
  CLOSE(number_of(r.out, "Q_rr", 0, "got"), 4, 0.03);
  EXPECT(number_of(r.out, "V_GT", 0, "got") > 0.55 && isnan(number_of(r.out, "V_GT", 0, "asked")),
         "%s", r.out);
  free_ran(&r);
}

/* The numbers of a sensitive gate of 0.8 A, whose dv/dt is that of the test of t_q, and of a disc
 * of 1200 A: ends of what thyristors are. */
static void ends_of_the_range(void) {
  if (is_for_memory_alone()) return;
  static const char *const CHANGES[][3] = {
      {"gate_current = 15 mA", "gate_current = 0.2 mA", "gate_current = 300 mA"},
      {"latching_current = 60 mA", "latching_current = 5 mA", "latching_current = 1500 mA"},
      {"holding_current = 30 mA", "holding_current = 3 mA", "holding_current = 300 mA"},
      {"critical_dvdt = 200", "critical_dvdt = 20", "critical_dvdt = 1000"},
      {"dv_dt = 200", "dv_dt = 20", "dv_dt = 1000"},
      {"turn_off_time = 50", "turn_off_time = 35", "turn_off_time = 400"},
      {"t_q = 50", "t_q = 35", "t_q = 400"},
      {"recovered_charge = 10", "recovered_charge = 0.5", "recovered_charge = 2600"},
      {"blocking_voltage = 800", "blocking_voltage = 600", "blocking_voltage = 2800"},
      {"test_current = 10", "test_current = 1", "test_current = 1200"},
      {"test_slope = 30", "test_slope = 5", "test_slope = 10"},
      {"on_resistance = 20", "on_resistance = 600", "on_resistance = 0.26"}};
  static const char *const NAMES[] = {"sensitive", "press_pack"};
  for (int n = 0; n < 2; n++) {
    char file[24], words[48];
    snprintf(file, sizeof file, "%s.inc", NAMES[n]);
    snprintf(words, sizeof words, "part thyristor -o %s", file);
    RUN_GOOD(words);
    for (size_t k = 0; k < COUNT(CHANGES); k++) alter(file, file, CHANGES[k][0], CHANGES[k][n + 1]);
    ran r = run("check %s", file);
    EXPECT(r.status == 0 && !strstr(r.out, " off ") && !strstr(r.out, " failed "), "%s: %s%s", file,
           r.out, r.err);
    free_ran(&r);
  }
}

/* ---- a vendor's ---- */

/* Two transistors, in the manner of a vendor's library; written here. R behind the gate, and from
 * there to the cathode 0.65 V at 10 mA. */
static const char VENDOR[] = "* SCRs\n"
                             ".subckt SCR12 %s %s %s PARAMS: IGT=10m\n"
                             "Qp 5 4 %s pmod\nQn 4 5 %s nmod\nRg %s 5 10\nRgk 5 %s {0.65/IGT}\n"
                             "Rak %s 4 2k\nCj 4 5 100p\n"
                             ".model pmod pnp(is=1e-14 bf=0.5 tf=2u cjc=50p cje=50p re=0.02)\n"
                             ".model nmod npn(is=1e-14 bf=20 tf=0.3u cjc=50p cje=100p rc=0.02)\n"
                             ".ends\n.subckt D1 a k\nD1 a k d1\n.model d1 d\n.ends\n";

/* pins: of anode, gate and cathode, and the order in which they stand. */
static void write_vendor(const char *const pin[3], const int order[3]) {
  vs_text text = {0};
  vs_text_add(&text, VENDOR, pin[order[0]], pin[order[1]], pin[order[2]], pin[0], pin[2], pin[1],
              pin[2], pin[0]);
  write_file("vendor.lib", text.text);
  vs_text_free(&text);
}

static void a_vendors_model(void) {
  static const char *const NAMED[] = {"Anode", "GATE", "K"}, *const NUMBERS[] = {"1", "2", "3"};
  static const struct {
    const char *const *pins;
    int order[3];
    const char *call, *says;
  } ROWS[] = {{NAMED, {2, 0, 1}, "\nX1 k a g SCR12\n", "by their names"},
              {NUMBERS, {0, 1, 2}, "\nX1 a g k SCR12\n", "assumed"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    write_vendor(ROWS[k].pins, ROWS[k].order);
    RUN_GOOD("part thyristor --wrap vendor.lib -o scr.inc --overwrite");
    char *text = read_file("scr.inc");
    EXPECT(strstr(text, ROWS[k].call) && strstr(text, ROWS[k].says) &&
               strstr(text, "\n.include \"vendor.lib\"\n") && strstr(text, "\n*$ compat ps\n"),
           "%s", text);
    free(text);
  }
  /* of two of one name ngspice takes the first; no other subcircuit has the part's name */
  write_file("two.lib", ".subckt R2 1 2\nR1 1 2 5k\n.ends\n.subckt other 1 2\nR1 1 2 1\n.ends\n"
                        ".subckt R2 1 2\nR1 1 2 9k\n.ends\n");
  ran two = run("part varistor --wrap two.lib:R2 -o d.inc");
  EXPECT(two.status == 0 && strstr(two.err, "two.lib:7:1: warning: a second .subckt R2: ngspice "
                                            "takes the first, of line 1"),
         "%d: %s", two.status, two.err);
  free_ran(&two);
  two = run("check d.inc --json");
  CLOSE(number_of(two.out, "V", 0, "got"), 5, 1e-6);
  EXPECT(strstr(two.err, "two.lib:7:1: warning: a second .subckt R2"), "%s", two.err);
  free_ran(&two);
  two = run("part varistor --wrap two.lib:R2 -o other.inc");
  EXPECT(two.status == 2 && strstr(two.err, "two.lib:4:1: a subcircuit other, and the part"), "%s",
         two.err);
  free_ran(&two);
  /* the same file in UTF-16, beside a model with a slip, wraps and reads as before */
  char *vendor = read_file("vendor.lib");
  FILE *wide = fopen("wide.lib", "w");
  fwrite("\xff\xfe", 1, 2, wide);
  for (const char *part = ".subckt BAD 1 2 3 {T=1}\nR1 1 2 4k7\n.ends\n"; *part; part++)
    fwrite((char[]){*part, 0}, 1, 2, wide);
  for (const char *c = vendor; *c; c++) fwrite((char[]){*c, 0}, 1, 2, wide);
  fclose(wide);
  free(vendor);
  RUN_GOOD("part thyristor --wrap wide.lib:SCR12 -o wide.inc");
  ran w = run("check wide.inc --json");
  EXPECT(w.status == 1 && strstr(w.err, "wide.lib:2:8: warning: passed by"), "%d: %s", w.status,
         w.err);
  ran r = run("check scr.inc --json");
  CLOSE(number_of(w.out, "I_GT", 0, "got"), number_of(r.out, "I_GT", 0, "got"), 1e-12);
  free_ran(&w);
  EXPECT(r.status == 1, "%d: %s", r.status, r.err); /* its dv/dt is low */
  double gate_ma = number_of(r.out, "I_GT", 0, "got");
  EXPECT(gate_ma > 9 && gate_ma < 11, "%g mA", gate_ma);
  EXPECT(number_of(r.out, "dv/dt", 0, "got") < 150, "%s", r.out);
  expect_warning(&r, "scr.inc", 17, "t_q is");
  free_ran(&r);
  r = run("run paper --tier circuit --set circuit.thyristor=scr.inc --set run.until=20ms --quiet");
  EXPECT(r.status == 0 || r.status == 3, "%d: %s", r.status, r.err);
  free_ran(&r);
}

/* What cannot be wrapped, and what ngspice cannot take, with its place in the vendor's file. */
static void a_vendors_mistakes(void) {
  static const struct {
    const char *words, *says;
  } ROWS[] = {
      {"part thyristor --wrap vendor.lib:nope -o p.inc", "has no subcircuit 'nope'"},
      {"part thyristor --wrap vendor.lib:D1 -o p.inc", "has 2 pins, and 3 are wanted"},
      {"part varistor --wrap none.lib -o p.inc", "none.lib: cannot be opened"},
      {"part resistor --wrap vendor.lib -o p.inc", "there are: diac, diode, fuse, igbt, mosfet"},
      {"part thyristor --wrap vendor.lib -o scr12.inc",
       "vendor.lib:2:1: a subcircuit scr12, and the part is to have that name"}};
  write_vendor((const char *const[]){"A", "G", "K"}, (const int[]){0, 1, 2});
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("%s", ROWS[k].words);
    EXPECT(r.status == 2 && strstr(r.err, ROWS[k].says) && access("p.inc", F_OK), "%s: %d: %s",
           ROWS[k].words, r.status, r.err);
    free_ran(&r);
  }
  alter("vendor.lib", "vendor.lib", "{0.65/IGT}", "{0.65/IGX}");
  RUN_GOOD("part thyristor --wrap vendor.lib -o scr.inc --overwrite");
  ran r = run("check scr.inc");
  EXPECT(r.status == 2 && strstr(r.err, "vendor.lib:6:"), "%d: %s", r.status, r.err);
  free_ran(&r);
}

/* What never conducts, as by pins in a wrong order, holds nothing: its figures could not be
 * measured. */
static void what_never_conducts(void) {
  static const char *const FAILED[] = {"I_GT", "V_GT", "I_H", "Q_rr", "di/dt"};
  write_file("dead.inc", "*$ part thyristor \"two resistors\"\n*$ limit i_h = 30 mA\n"
                         "*$ limit i_gt = 15 mA\n*$ limit v_gt = 1.5 V\n*$ limit q_rr = 20 A*us\n"
                         ".subckt dead a k g\nR1 a k 1meg\nR2 g k 100\n.ends\n");
  ran r = run("check dead.inc --json");
  EXPECT(r.status == 1 && strstr(r.err, "4 of 4 figures are not what is asked"), "%d: %s", r.status,
         r.err);
  for (size_t k = 0; k < COUNT(FAILED); k++)
    EXPECT(isnan(number_of(r.out, FAILED[k], 0, "got")), "%s: %s", FAILED[k], r.out);
  free_ran(&r);
}

/* ---- implausible numbers ---- */

/* A thyristor that latches as soon as its gate, on 10 ohm, is at 0.26 V: a comparator, no junction.
 */
#define COLD                                                                                       \
  ".subckt cold a k g\n"                                                                           \
  "Bset set 0 V = v(a,k) < 1 ? -0.1 : 0.35*v(g,k)\n"                                               \
  "S1 a t set 0 state off\n"                                                                       \
  ".model state sw(ron=10m roff=1e18 vt=0 vh=0.09)\n"                                              \
  "V1 t k 1\nRg g k 10\nRl a k 1e6\n.ends\n"

static void implausible_numbers(void) {
  write_file("cold.inc", "*$ part thyristor \"fires at 0.26 V\"\n*$ limit v_drm = 800 V\n"
                         "*$ limit i_t_rms = 12 A\n*$ limit i_tsm = 120 A\n"
                         "*$ limit i2t = 720 A2.s\n*$ limit di_dt = 50 A/s\n"
                         "*$ limit v_gt = 1.5 V\n*$ limit i_gt = 15 A\n" COLD);
  ran r = run("check cold.inc");
  EXPECT(r.status == 0, "%d: %s", r.status, r.err);
  expect_warning(&r, "cold.inc", 1, "no line 'zth'");
  expect_warning(&r, "cold.inc", 5, "i_tsm^2 * 5 ms; here it is 10");
  expect_warning(&r, "cold.inc", 6, "di_dt = 5e-05 A/us is implausible");
  expect_warning(&r, "cold.inc", 6, "a run's margin of di_dt would be -");
  expect_warning(&r, "cold.inc", 7, "the model's gate fires at 0.2");
  expect_warning(&r, "cold.inc", 8, "i_gt = 1.5e+04 mA is implausible");
  free_ran(&r);
  write_file("cold.inc", "*$ part thyristor \"hot\"\n*$ limit v_drm = 800 V\n"
                         "*$ limit i_t_rms = 12 A\n*$ zth 50 K/W 1 s\n" COLD);
  r = run("check cold.inc");
  expect_warning(&r, "cold.inc", 4, "heats the junction by");
  free_ran(&r);
  RUN_GOOD("part varistor -o kilo.inc");
  alter("kilo.inc", "kilo.inc", "v_rms = 460 V", "v_rms = 46 kV");
  alter("kilo.inc", "kilo.inc", "v_dc = 615 V", "v_dc = 61 kV");
  r = run("check kilo.inc");
  expect_warning(&r, "kilo.inc", 7, "v_rms = 4.6e+04 V is implausible");
  free_ran(&r);
}

/* ---- files and bad usage ---- */

static void files_of_a_bench(void) {
  bool gnuplot = system("command -v gnuplot >/dev/null 2>&1") == 0;
  RUN_GOOD("part varistor -o metal.inc");
  ran r = run("check metal.inc -o seen --quiet");
  EXPECT(r.status == 0 && !*r.out, "%d: %s", r.status, r.out);
  free_ran(&r);
  EXPECT_FILES("seen", gnuplot ? "bench.csv bench.json bench.png " : "bench.csv bench.json ");
  char *csv = read_file("seen/bench.csv"), *json = read_file("seen/bench.json");
  EXPECT(count_lines(csv) == 4 &&
             strstr(csv, "figure,unit,held,asked,tolerance,got,word,test,warning\nV,V,near,750,"),
         "%s", csv);
  CLOSE(number_of(json, "V", 0, "got"), 750, 1e-4);
  CLOSE(number_of(json, "V", 1, "asked"), 1240, 1e-12);
  free(csv);
  free(json);
}

/* ---- the model beside the sheet ---- */

#define S20K460 VS_TEST_FOLDER "/../spice/parts/s20k460.inc"

/* A file that says how far its model is off is what the stand finds. One of which the model is then
 * made 20 % lower is told: by the figure that is off, and by each line that is another now. One
 * without such a line is told which would do. */
static void a_model_that_is_off(void) {
  alter(S20K460, "s20k460.inc", "S20K460", "S20K460");
  ran r = run("check ./s20k460.inc");
  expect_good(&r, "as it ships", __LINE__);
  EXPECT(!strstr(r.out, "*$ model") && !*r.err, "%s%s", r.out, r.err);
  free_ran(&r);
  alter(S20K460, "s20k460.inc", "b1={2.9645747", "b1={2.8676647"); /* log10 of 0.8 */
  r = run("check ./s20k460.inc");
  EXPECT(r.status == 1 && strstr(r.out, "off     at 0.001 A"), "%d: %s", r.status, r.out);
  expect_warning(&r, "./s20k460.inc", 12, "model v_varistor = +0 %: on the test stand it is -20 %");
  expect_warning(&r, "./s20k460.inc", 13, "model v_clamp = -9 %: on the test stand it is -27 %");
  free_ran(&r);
  alter(S20K460, "s20k460.inc", "*$ model  v_clamp = -9 %\n", "");
  r = run("check ./s20k460.inc");
  expect_good(&r, "a line less", __LINE__);
  EXPECT(strstr(r.out, "With these lines in it, verdicts show that:\n*$ model  v_clamp = -9 %\n"),
         "%s", r.out);
  free_ran(&r);
  remove("s20k460.inc");
}

/* What is wrong with such a line is named with its place. */
static void lines_of_a_model(void) {
  static const struct {
    const char *new, *says;
  } ROWS[] = {
      {"v_clamp = -9", "13:21: model v_clamp: how far the model's figure is from the sheet's"},
      {"v_clamp = -9 V", "13:21: model v_clamp: how far"},
      {"v_clamp = low %", "13:21: model v_clamp: how far"},
      {"v_clamp = -120 %", "13:21: model v_clamp: how far"},
      {"v_clamp -9 %", "13:11: 'NAME = ...' is wanted here"},
      {"v_clamp = -9 % about", "13:26: "},
      {"v_clmp = -9 %",
       "13:1: model v_clmp: no margin of a varistor hangs on that; those that some "
       "hang on: v_clamp, v_varistor"},
      {"v_varistor = 1 %", "13:1: model v_varistor stands here a second time, as in line 12"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text says = {0};
    alter(S20K460, "s20k460.inc", "v_clamp = -9 %", ROWS[k].new);
    ran r = run("check ./s20k460.inc");
    vs_text_add(&says, "s20k460.inc:%s", ROWS[k].says);
    EXPECT(r.status == 2 && strstr(r.err, says.text), "%s: %d: %s", ROWS[k].new, r.status, r.err);
    vs_text_free(&says);
    free_ran(&r);
  }
  remove("s20k460.inc");
}

/* The line of the text that begins with these words; to be freed. */
static char *line_of(const char *text, const char *words) {
  vs_text begin = {0};
  vs_text_add(&begin, "\n%s", words);
  const char *at = strstr(text, begin.text);
  vs_text_free(&begin);
  return at ? vs_alloc_part(at + 1, strcspn(at + 1, "\n")) : vs_copy("");
}

/* A verdict has it beside the margins that hang on it: those of the varistor, and of the thyristor
 * that the varistor stands across, and no others. */
static void beside_the_margin(void) {
  static const char RUN[] = "run paper --tier circuit --set circuit.deck=halfwave_paper --set "
                            "circuit.varistor_1=./disc.inc --set run.until=40ms";
  static const struct {
    const char *line, *says; /* NULL: nothing */
  } ROWS[] = {
      {"weakest: varistor_1.energy", "% (model v_clamp -6 % of sheet)  held"},
      {"weakest: varistor_1.energy", " where 2.2 mJ (assumed) is allowed, margin "},
      {"  varistor_1.energy ", "  held  (model v_clamp -6 % of sheet)"},
      {"  thyristor.v_reverse ", "  held  (model varistor_1.v_clamp -6 % of sheet)"},
      {"  v_ak ", "  held  (model varistor_1.v_clamp -6 % of sheet)"},
      {"  thyristor.t_off ", "  held  (model t_q +1 %, i_h +1 % of sheet)"},
      {"  thyristor.i2t ", NULL},
  };
  write_file("disc.inc", "*$ part   varistor \"own\"\n*$ limit  energy = 2.2 mJ assumed\n"
                         "*$ limit i_surge = 8 kA\n*$ limit p_max = 1 W\n"
                         "*$ limit v_clamp = 1340 V\n*$ limit i_clamp = 100 A\n"
                         "*$ model  v_clamp = -6 %\n.include varistor_law.inc\n"
                         ".subckt disc a b\nX1 a b varistor_law v_1ma=860 alpha=30 c_par=500p\n"
                         ".ends disc\n");
  ran r = run("%s --all", RUN);
  EXPECT(r.status == 0, "%d: %s%s", r.status, r.out, r.err);
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char *line = line_of(r.out, ROWS[k].line);
    EXPECT(*line && (ROWS[k].says ? strstr(line, ROWS[k].says) != NULL : !strstr(line, "model")),
           "%s: %s", ROWS[k].line, line);
    free(line);
  }
  free_ran(&r);
  r = run("%s --json", RUN);
  EXPECT(strstr(r.out, "\"model_deviation\": {\"v_clamp\": -0.06}, \"word\"") &&
             strstr(r.out, "\"model_deviation\": {\"varistor_1.v_clamp\": -0.06}, \"word\""),
         "%s", r.out);
  free_ran(&r);
  alter("disc.inc", "disc.inc", "*$ model  v_clamp = -6 %\n", "");
  r = run("%s", RUN);
  EXPECT(r.status == 0 && !strstr(r.out, "varistor_1.v_clamp -"), "%d: %s", r.status, r.out);
  free_ran(&r);
}

static void bad_usage(void) {
  static const char *const ROWS[][2] = {
      {"part thyrister -o p.inc", "'thyrister' is no kind"},
      {"part thyristor", "wants -o NAME.inc"},
      {"part thyristor -o p.cir", "a file NAME.inc is wanted"},
      {"part thyristor -o 1p.inc", "a file NAME.inc is wanted"},
      {"part thyristor -o no/such/p.inc", "no/such"},
      {"part thyristor_wrapped -o p.inc", "is no kind"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("%s", ROWS[k][0]);
    EXPECT(r.status == 2 && strstr(r.err, ROWS[k][1]) && count_lines(r.err) == 1, "%s: %d: %s",
           ROWS[k][0], r.status, r.err);
    free_ran(&r);
  }
  RUN_GOOD("part resistor -o p.inc");
  ran r = run("part fuse -o p.inc");
  EXPECT(r.status == 2 && strstr(r.err, "is there already"), "%d: %s", r.status, r.err);
  free_ran(&r);
  r = run("part");
  EXPECT(r.status == 0 &&
             !strcmp(r.out,
                     "  capacitor\n  diac\n  diode\n  electrolytic\n  fuse\n  igbt\n  "
                     "mosfet\n  resistor\n  thyristor\n  triac\n  tvs\n  varistor\n  zener\n"),
         "%s", r.out);
  free_ran(&r);
}

static const vs_test TESTS[] = {
    {"templates pass", templates_pass},
    {"templates decide", templates_decide},
    {"filled in", filled_in},
    {"twins", twins},
    {"what is off", what_is_off},
    {"shipped parts", shipped_parts},
    {"a small thyristor", a_small_thyristor},
    {"ends of the range", ends_of_the_range},
    {"a vendor's model", a_vendors_model},
    {"a vendor's mistakes", a_vendors_mistakes},
    {"what never conducts", what_never_conducts},
    {"implausible numbers", implausible_numbers},
    {"files of a bench", files_of_a_bench},
    {"a model that is off", a_model_that_is_off},
    {"lines of a model", lines_of_a_model},
    {"beside the margin", beside_the_margin},
    {"bad usage", bad_usage},
};

int main(void) {
  return program_suite("part", TESTS, COUNT(TESTS));
}
