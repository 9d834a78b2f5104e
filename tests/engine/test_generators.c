/* SPDX-License-Identifier: GPL-3.0-or-later
 * Generators on live mains: against plain ngspice, which charges a capacitor and switches it; their
 * networks on the line; events that are not built; pulses that come more than once. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "program.h"

/* ---- the circuit ----
 * Mains of 0.5 ohm and 0.5 mH, a varistor i = 1 mA (v/V1)^30 and 100 kohm across them. */

typedef struct strike {
  double mains_v, varistor_v, level_v, angle_deg;
  bool negative, earth;
  double decoupling_h;
} strike;

/* Peaks of the varistor's voltage and current, and its heat. */
typedef struct stress {
  double v, a, j;
} stress;

static const char LINE[] =
    "*$ param varistor_voltage = 750 V 1..1e5 \"at 1 mA\"\n*$ port mains = Vm\n*$ line a\n"
    "*$ earth 0\n*$ probe v_line = v(a) V\n*$ probe i_varistor = i(Vv) A\n"
    "*$ loss r_source = {r_source}*i(Vm)^2\n*$ loss varistor = v(a)*i(Vv)\n"
    "*$ loss r_line = v(a)^2/100000\n*$ store l_source = {l_source}*i(Vm)^2/2\n"
    "Vm src 0 external\nRs src s1 {r_source}\nLs s1 a {l_source} ic=0\nVv a av 0\n"
    "Bv av 0 I = 1m*sgn(v(av))*pow(abs(v(av))/{varistor_voltage},30)\nRl a 0 100k\n"
    "Rb b 0 1\nXeva b 0 eva\n";

/* Behind a whole cycle, in which the network comes to what it is on the mains. */
static double strikes_s(const strike *s) {
  return 20e-3 + s->angle_deg / 360 * 20e-3;
}

static double larger(double a, double b) {
  return fmax(fabs(a), fabs(b));
}

/* The program's own, with its default tolerance; `keys`: more of the event. What the books leave
 * over is told relative to 1 % of what is drawn, as the machine is idle: 2e-2 of that. */
static stress simulated(const strike *s, const char *keys) {
  char scene[600];
  write_file("d.cir", LINE);
  snprintf(scene, sizeof scene,
           "circuit: {deck: d.cir, varistor_voltage: %g V}\n"
           "supply: {voltage: %g V, decoupling: %g H}\n"
           "run: {until: %.12g s, verify: never}\n"
           "events: {s: {kind: surge, cycle: 2, angle: %g deg, level: %g V, polarity: '%s', "
           "coupling: %s%s}}\n",
           s->varistor_v, s->mains_v, s->decoupling_h, strikes_s(s) + 500e-6, s->angle_deg,
           s->level_v, s->negative ? "-" : "+", s->earth ? "earth" : "line", keys);
  write_file("s.yaml", scene);
  ran r = run("run s.yaml --json --quiet");
  EXPECT(r.status == 0, "%s: %s", scene, r.err);
  const char *loss = strstr(r.out, "\"varistor\": ");
  stress of = {larger(measure_in(r.out, "v_line_max"), measure_in(r.out, "v_line_min")),
               larger(measure_in(r.out, "i_varistor_max"), measure_in(r.out, "i_varistor_min")),
               loss ? strtod(loss + strlen("\"varistor\": "), NULL) : NAN};
  const char *books = strstr(r.out, "\"residual\": ");
  EXPECT(books && strtod(books + strlen("\"residual\": "), NULL) < 2e-2, "%s: %.40s", scene, books);
  free_ran(&r);
  return of;
}

static double measured_by_ngspice(const char *log, const char *name) {
  char start[32];
  snprintf(start, sizeof start, "\n%s ", name);
  const char *at = strstr(log, start), *is = at ? strchr(at, '=') : NULL;
  return is ? strtod(is + 1, NULL) : NAN;
}

/* What plain ngspice makes of it, with a capacitor that is charged before the run and switched onto
 * the network. at_once: the run begins with the strike, as if the network were not there before:
 * its coupling capacitor has the line's voltage. The largest step is 1 us: with 20 us its own error
 * is up to 1 %. */
static stress plain(const strike *s, bool at_once) {
  double from_s = at_once ? strikes_s(s) : 0, t0_s = strikes_s(s) - from_s, end_s = t0_s + 500e-6;
  double peak_v = s->mains_v * M_SQRT2, line_v = peak_v * sin(2 * M_PI * 50 * from_s);
  vs_text t = {0};
  vs_text_add(&t,
              "surge\nVm src 0 SIN(0 %.17g 50 0 0 %.17g)\nRs src s1 0.5\nLs s1 a %.17g ic=0\n"
              "Bv a 0 I=1m*sgn(v(a))*pow(abs(v(a))/%g,30)\nRl a 0 100k\n",
              peak_v, 360 * 50 * from_s, 0.5e-3 + s->decoupling_h, s->varistor_v);
  vs_text_add(&t,
              "Cg g 0 5.9302u ic=%.17g\nSg g h c 0 sw off\n.model sw sw(ron=1u roff=1e12 vt=0.5 "
              "vh=0.1)\nVc c 0 PWL(0 0 %.12g 0 %.12g 1)\nRg h 0 20.154\nLg h i 10.871u ic=0\n"
              "Ri i o 0.81412\nRo o 0 26.151\n",
              (s->negative ? -1 : 1) * 1.06044 * s->level_v, t0_s, t0_s + 1e-9);
  vs_text_add(&t, "Rq o q %s\nCo q a %s ic=%.17g\n", s->earth ? "10" : "1u",
              s->earth ? "9u" : "18u", at_once ? -line_v : 0);
  vs_text_add(&t,
              ".options reltol=1e-6 abstol=1e-9 vntol=1e-6 method=trap\n"
              ".tran 0.05u %.12g 0 1u uic\n.control\nrun\nlet iv=1m*(abs(v(a))/%g)^30\n"
              "let p=abs(v(a))*iv\nlet av=abs(v(a))\nmeas tran vmax MAX av from=0 to=%.12g\n"
              "meas tran imax MAX iv from=0 to=%.12g\nmeas tran heat INTEG p from=0 to=%.12g\n"
              "quit 0\n.endc\n.end\n",
              end_s, s->varistor_v, end_s, end_s, end_s);
  write_file("x.cir", t.text);
  vs_text_free(&t);
  EXPECT(system("timeout 100 ngspice -b x.cir >x.log 2>&1") == 0, "ngspice gives up; see x.log");
  char *log = read_file("x.log");
  stress of = {measured_by_ngspice(log, "vmax"), measured_by_ngspice(log, "imax"),
               measured_by_ngspice(log, "heat")};
  free(log);
  return of;
}

/* The larger of the three differences, as a part. */
static double off_by(const stress *a, const stress *b) {
  return fmax(fabs(a->v / b->v - 1), fmax(fabs(a->a / b->a - 1), fabs(a->j / b->j - 1)));
}

/* ---- against plain ngspice ---- */

enum { ANGLES = 10, LEVELS = 3, ALL = 2 * ANGLES * LEVELS };
static const double LEVEL_V[LEVELS] = {1000, 2000, 4000};

static strike numbered(int n) {
  return (strike){.mains_v = 440,
                  .varistor_v = 750,
                  .level_v = LEVEL_V[n / (2 * ANGLES)],
                  .angle_deg = n / 2 % ANGLES * 360.0 / ANGLES,
                  .negative = n % 2};
}

/* Half a per cent is what is asked. The worst of all 60 is 0.15 %, of a heat of 1 mJ. A few of them
 * without --long, the worst among them. */
static void against_plain_ngspice(void) {
  bool all = getenv("VS_LONG");
  double worst = 0;
  if (!on_path("ngspice")) return;
  FILE *table = all ? fopen(VS_BUILD_TREE "/tests/run/test_generators/generators.csv", "w") : NULL;
  if (table)
    fputs("level_v,angle_deg,polarity,v_plain,a_plain,j_plain,v,a,j,worst_percent\n", table);
  for (int n = all ? 0 : 3; n < ALL; n += all ? 1 : 11) {
    strike s = numbered(n);
    stress of = plain(&s, false), own = simulated(&s, "");
    double off = off_by(&own, &of);
    EXPECT(off < 5e-3, "%g V at %g deg: %g V %g A %g J, plain ngspice %g V %g A %g J", s.level_v,
           s.angle_deg, own.v, own.a, own.j, of.v, of.a, of.j);
    worst = fmax(worst, off);
    if (table)
      fprintf(table, "%g,%g,%s,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.3f\n", s.level_v, s.angle_deg,
              s.negative ? "-" : "+", of.v, of.a, of.j, own.v, own.a, own.j, 100 * off);
  }
  if (table) fclose(table);
  printf(" off by %.3f %% at most ", 100 * worst);
}

/* To earth, with a decoupling inductance, at 230 V, and with a network that comes with the wave. */
static void other_networks(void) {
  static const struct {
    strike s;
    const char *keys;
    bool at_once;
  } ROWS[] = {{{440, 750, 2000, 250, true, true, 0}, "", false},
              {{440, 750, 1000, 20, false, false, 1.5e-3}, "", false},
              {{440, 750, 1000, 20, false, true, 1.5e-3}, "", false},
              {{230, 430, 1000, 100, true, false, 0}, "", false},
              {{440, 750, 1000, 20, false, false, 0}, ", from: strike", true},
              {{440, 750, 2000, 250, true, true, 0}, ", from: strike", true}};
  if (!on_path("ngspice")) return;
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    stress of = plain(&ROWS[k].s, ROWS[k].at_once), own = simulated(&ROWS[k].s, ROWS[k].keys);
    EXPECT(off_by(&own, &of) < 5e-3, "row %zu: %g V %g A %g J, plain ngspice %g V %g A %g J", k,
           own.v, own.a, own.j, of.v, of.a, of.j);
  }
}

/* Two of them as somebody else computed them, where plain ngspice is not installed; 0.5 %. */
static void computed_elsewhere(void) {
  static const strike HIGH = {440, 750, 1000, 20, false, false, 0},
                      LOW = {230, 430, 500, 30, false, false, 0};
  stress high = simulated(&HIGH, ""), low = simulated(&LOW, "");
  CLOSE(high.v, 1058.65, 5e-3);
  CLOSE(high.a, 30.955, 5e-3);
  CLOSE(high.j, 0.25417, 5e-3);
  CLOSE(low.a, 13.756, 5e-3);
  CLOSE(low.j, 0.06156, 5e-3);
}

/* ---- on the line ---- */

/* The largest difference between two rows of run.csv, 1 us apart, from from_s on, of the column. */
static double largest_jump(const char *csv, double from_s, int column) {
  double largest = 0, before = NAN;
  for (const char *row = strchr(csv, '\n'); row && row[1]; row = strchr(row + 1, '\n')) {
    double t_s = strtod(row + 1, NULL);
    const char *cell = row + 1;
    for (int k = 0; k < column && cell; k++) cell = strchr(cell, ',') + 1;
    double value = strtod(cell, NULL);
    if (t_s > from_s && !isnan(before)) largest = fmax(largest, fabs(value - before));
    before = value;
  }
  return largest;
}

/* A network that comes onto the line in the midst of a run makes no jump: the line's voltage goes
 * on with 0.195 V to the microsecond, as 440 V of 50 Hz do, and with what the 18 uF draw from then
 * on. One without charge would take hundreds of volts off the line. Before that, nothing lies on
 * it. */
static void comes_onto_the_line(void) {
  static const char SCENE[] =
      "circuit: {deck: d.cir}\nrun: {until: 12 ms, sample: 1 us, verify: never}\n"
      "record: [v_line]\nevents: {s: {kind: %s, at: 11.999 ms, from: %s}}\n";
  static const char *const KINDS[] = {"surge", "ring_wave", "eft"};
  char scene[300];
  write_file("d.cir", LINE);
  for (size_t k = 0; k < COUNT(KINDS); k++) {
    snprintf(scene, sizeof scene, SCENE, KINDS[k], "6 ms");
    write_file("s.yaml", scene);
    RUN_GOOD("run s.yaml --quiet -o o --set events.s.at=11.9999ms --set run.until=11.9999001ms");
    char *csv = read_file("o/run.csv");
    double jump = largest_jump(csv, 5e-3, 1);
    EXPECT(jump > 0.1 && jump < 0.4, "%s: %g V within a microsecond", KINDS[k], jump);
    free(csv);
    RUN_GOOD("run s.yaml --quiet -o p --set events.s.from=strike --set run.until=11.998ms "
             "--set events.s.at=11.9979ms");
    RUN_GOOD("run s.yaml --quiet -o q --set events.s.off=true --set run.until=11.998ms");
    char *with = read_file("p/run.csv"), *without = read_file("q/run.csv");
    size_t same = 0; /* up to the strike, but for the last digits of steps taken otherwise */
    for (const char *a = strchr(with, '\n'), *b = strchr(without, '\n'); a && a[1] && b && b[1];
         a = strchr(a + 1, '\n'), b = strchr(b + 1, '\n')) {
      double t_s = strtod(a + 1, NULL), own = strtod(strchr(a, ',') + 1, NULL);
      if (t_s > 11.9978e-3) break;
      CU_ASSERT_FATAL(t_s == strtod(b + 1, NULL));
      if (fabs(own - strtod(strchr(b, ',') + 1, NULL)) < 622 * 1e-4) same++;
    }
    EXPECT(same == 11998, "%s: %zu rows are the same", KINDS[k], same);
    free(with), free(without);
  }
}

/* The table's head and the summary name what lies on the line. */
static void named_in_the_results(void) {
  write_file("d.cir", LINE);
  write_file("s.yaml", "circuit: {deck: d.cir}\nrun: {until: 3 ms, verify: never}\nevents:\n"
                       "  s1: {kind: surge, at: 2 ms}\n");
  static const struct {
    const char *set, *head, *json;
  } ROWS[] = {
      {"level=1kV", "\nline   on the line from the start: surge s1 (18 uF + 2 ohm, line to line)\n",
       "{\"event\": \"s1\", \"kind\": \"surge\", \"from_s\": 0, \"network\": \"18 uF + 2 ohm, line "
       "to line\"}"},
      {"from=strike", "\nline   on the line from 2 ms: surge s1 (18 uF + 2 ohm, line to line)\n",
       "\"from_s\": 0.002"},
      {"from=1ms", "\nline   on the line from 1 ms: surge s1 (", "\"from_s\": 0.001"},
      {"coupling=earth", "surge s1 (9 uF + 10 ohm + 2 ohm, line to earth)\n",
       "9 uF + 10 ohm + 2 ohm, line to earth"},
      {"times=10", "\npulses 10, 60 s apart: one is simulated", "\"times\": 10, \"every_s\": 60}"},
      {"kind=ring_wave", "ring_wave s1 (18 uF + 12 ohm, line to line)\n",
       "18 uF + 12 ohm, line to line"},
      {"kind=eft", "eft s1 (33 nF + 50 ohm, line to line)\n", "33 nF + 50 ohm, line to line"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("run s.yaml --set events.s1.%s", ROWS[k].set);
    EXPECT(r.status == 0 && strstr(r.out, ROWS[k].head), "%s: %s", ROWS[k].set, r.out);
    free_ran(&r);
    r = run("run s.yaml --json --quiet --set events.s1.%s", ROWS[k].set);
    EXPECT(r.status == 0 && strstr(r.out, ROWS[k].json), "%s: %s", ROWS[k].set, r.out);
    free_ran(&r);
  }
  ran r = run("run s.yaml --set events.s1.off=true");
  EXPECT(r.status == 0 && !strstr(r.out, "on the line"), "%s", r.out);
  free_ran(&r);
}

/* Two at once: warned of at the later one, in all places where warnings are. */
static void two_at_once(void) {
  write_file("d.cir", LINE);
  write_file("s.yaml", "circuit: {deck: d.cir}\nrun: {until: 3 ms, verify: never}\nevents:\n"
                       "  a: {kind: surge, at: 2 ms}\n  b: {kind: eft, at: 1 ms, from: 0.5 ms}\n");
  static const char SAYS[] = "events.b: its network lies on the line together with that of "
                             "events.a, from 0.0005 s on: each loads the other's wave";
  ran r = run("run s.yaml --json");
  EXPECT(r.status == 0 && strstr(r.err, SAYS) && strstr(r.out, SAYS), "%s%s", r.err, r.out);
  free_ran(&r);
  r = run("check s.yaml");
  EXPECT(strstr(r.err, "s.yaml:5:3: warning: events.b: its network"), "%s", r.err);
  free_ran(&r);
  r = run("run s.yaml --json --set events.a.off=true");
  EXPECT(r.status == 0 && !strstr(r.out, "together"), "%s", r.out);
  free_ran(&r);
}

/* ---- events that are not built ---- */

/* From the summary on: the part behind its scene. */
static const char *behind_scene(const char *json) {
  const char *at = strstr(json, "\"measures\": ");
  CU_ASSERT_PTR_NOT_NULL_FATAL(at);
  return at;
}

static void expect_same_run(const char *a, const char *b) {
  char *csv[2], *events[2], *json[2];
  char path[64];
  for (int k = 0; k < 2; k++) {
    snprintf(path, sizeof path, "%s/run.csv", k ? b : a);
    csv[k] = read_file(path);
    snprintf(path, sizeof path, "%s/events.csv", k ? b : a);
    events[k] = read_file(path);
    snprintf(path, sizeof path, "%s/summary.json", k ? b : a);
    json[k] = read_file(path);
  }
  EXPECT(*csv[0] && !strcmp(csv[0], csv[1]), "%s/run.csv is another than %s/run.csv", a, b);
  EXPECT(!strcmp(events[0], events[1]), "%s%s", events[0], events[1]);
  EXPECT(!strcmp(behind_scene(json[0]), behind_scene(json[1])), "%s%s", json[0], json[1]);
  for (int k = 0; k < 2; k++) free(csv[k]), free(events[k]), free(json[k]);
}

/* Off, at the run's end, and behind it: each run is to the byte the one without the line. One
 * nanosecond earlier the event's network lies on the line. */
static void not_built(void) {
  static const char SCENE[] = "circuit: {deck: halfwave_snubbed}\nfiring: {every: 1}\n"
                              "run: {until: 25 ms}\nevents:\n%s"
                              "  e: {kind: ring_wave, at: 13 ms}\n";
  static const struct {
    const char *line, *says;
  } ROWS[] = {{"  s: {kind: surge, at: 20 ms, off: true}\n", NULL},
              {"  s: {kind: jam, at: 20 ms, off: true}\n", NULL},
              {"  s: {kind: missing_pulse, cycle: 1, off: true}\n", NULL},
              {"  s: {kind: open, at: 20 ms, off: true}\n", NULL}, /* of no element */
              {"  s: {kind: surge, at: 25 ms}\n",
               "events.s: it would begin at 0.025 s, and the run ends at run.until = 0.025 s: it "
               "is not built"},
              {"  s: {kind: surge, cycle: 3, angle: 90 deg}\n", "it would begin at 0.045 s"},
              {"  s: {kind: short, at: 1 s, element: R1}\n", "it would begin at 1 s"}};
  char scene[400];
  snprintf(scene, sizeof scene, SCENE, "");
  write_file("s.yaml", scene);
  RUN_GOOD("run s.yaml --quiet --reproducible -o without");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    snprintf(scene, sizeof scene, SCENE, ROWS[k].line);
    write_file("s.yaml", scene);
    remove_tree("with");
    ran r = run("run s.yaml --reproducible -o with");
    EXPECT(r.status == 0, "%s: %s", ROWS[k].line, r.err);
    EXPECT(ROWS[k].says ? strstr(r.err, ROWS[k].says) != NULL : !strstr(r.err, "events.s"),
           "%s: %s", ROWS[k].line, r.err);
    free_ran(&r);
    expect_same_run("with", "without");
    char *json = read_file("with/summary.json");
    EXPECT(strstr(json, "\"s\": {\"starts_s\": ") && strstr(json, "\"built\": false") &&
               (!ROWS[k].says || strstr(json, ROWS[k].says)),
           "%s", json);
    free(json);
    if (!ROWS[k].says) continue;
    r = run("check s.yaml");
    EXPECT(r.status == 0 && strstr(r.err, "s.yaml:5:") && strstr(r.err, ROWS[k].says), "%s", r.err);
    free_ran(&r);
  }
  remove_tree("with");
  RUN_GOOD("run s.yaml --reproducible --quiet -o with --set events.s.off=true");
  expect_same_run("with", "without");
  snprintf(scene, sizeof scene, SCENE, "  s: {kind: surge, at: 24.999999 ms}\n");
  write_file("s.yaml", scene);
  ran r = run("run s.yaml");
  EXPECT(strstr(r.err, "together") && strstr(r.out, "from the start: surge s"), "%s", r.err);
  free_ran(&r);
}

/* Which of the names in the first row it is; -1: none. */
static int column_of(const char *csv, const char *name) {
  int column = 0;
  for (const char *at = csv; at && *at && *at != '\n'; column++) {
    size_t n = strcspn(at, ",\n");
    if (n == strlen(name) && !strncmp(at, name, n)) return column;
    at += n + (at[n] == ',');
  }
  return -1;
}

static double cell_of(const char *row, int column) {
  for (; column > 0; column--) row = strchr(row, ',') + 1;
  return strtod(row, NULL);
}

/* In a study and an export. */
static void not_built_elsewhere(void) {
  write_file("s.yaml", "circuit: {deck: halfwave_snubbed}\nrun: {until: 25 ms, verify: never}\n"
                       "events: {s: {kind: surge, at: 30 ms, level: 1 kV}}\n");
  write_file("t.yaml", "scene: s.yaml\nvary:\n  events.s.at: [12 ms, 25 ms, 30 ms]\n"
                       "  events.s.off: [false, true]\n");
  RUN_GOOD("study t.yaml -o t --quiet --jobs 1 --overwrite");
  char *csv = read_file("t/study.csv");
  int column = column_of(csv, "i_peak_a"), rows = 0;
  double i[6] = {0};
  for (const char *row = strchr(csv, '\n'); column > 0 && row && row[1] && rows < 6;
       row = strchr(row + 1, '\n'))
    i[rows++] = cell_of(row + 1, column);
  EXPECT(rows == 6 && i[1] == i[2] && i[2] == i[3] && i[3] == i[4] && i[4] == i[5] && i[0] != i[1],
         "%s", csv);
  free(csv);
  ran r = run("export s.yaml -o x.cir");
  EXPECT(r.status == 0, "%s", r.err);
  free_ran(&r);
  r = run("export s.yaml -o x.cir --set events.s.at=12ms");
  EXPECT(r.status == 2 && strstr(r.err, "leave s out"), "%s", r.err);
  free_ran(&r);
}

/* ---- pulses that come more than once ---- */

/* 100 W from 1 to 11 ms, five times 40 ms apart. What a term R (1 - exp(-t/tau)) has at the end of
 * the n-th pulse is a geometric series: R P (1 - exp(-10 ms/tau)) (1 - q^n)/(1 - q), q = exp(-40
 * ms/tau). Its edges are 1 us long: 2e-4. The surge itself is elsewhere. */
static void heat_adds_up(void) {
  static const double R[] = {0.5, 1}, TAU_S[] = {1e-3, 20e-3};
  write_file("p.inc", "*$ part thyristor \"P\"\n*$ zth 0.5 K/W 1 ms\n*$ zth 1 K/W 20 ms\n"
                      "*$ limit t_j_rise = 92 K\n.subckt p a k g\nR1 a k 1meg\nR2 g k 1k\n.ends\n");
  write_file("d.cir",
             "*$ param t = p part\n*$ port gate = Vg\n*$ device t = v(x), i(Vs)\n*$ line z\n"
             "Vg g 0 external\nRg g 0 1k\n"
             "Is 0 y PWL(0 0 1m 0 1.001m 10 11m 10 11.001m 0)\nVs y x 0\nRx x 0 1\n"
             "Rz z 0 100\nRe e 0 1\nXeva e 0 eva\n");
  write_file("s.yaml",
             "circuit: {deck: d.cir}\nrun: {until: 30 ms, max_step: 20 us, verify: "
             "never}\nfiring: {every: 1}\nevents: {s: {kind: surge, at: 2 ms, every: 40 ms}}\n"
             "waive: [t.v_drm, t.v_rrm, t.i_t_rms, t.i_tsm, t.i2t, t.dv_dt, t.di_dt, t.t_q]\n"
             "expect: [t fires without a gate pulse]\n");
  double once = 0, five = 0;
  for (int k = 0; k < 2; k++) {
    double one = 100 * R[k] * -expm1(-10e-3 / TAU_S[k]);
    once += one;
    five += one * expm1(-5 * 40e-3 / TAU_S[k]) / expm1(-40e-3 / TAU_S[k]);
  }
  for (int times = 1; times <= 5; times += 4) {
    ran r = run("run s.yaml --json --quiet --set events.s.times=%d", times);
    CLOSE(measure_in(r.out, "t.t_j_rise"), times > 1 ? five : once, 2e-4);
    EXPECT(r.status == (times > 1 ? 3 : 0), "%s%s", r.err, r.out); /* 92 K lies between them */
    free_ran(&r);
  }
  /* so do cases of a study that have their beginning in common */
  write_file("t.yaml",
             "scene: s.yaml\nvary:\n  events.s.at: [15 ms, 20 ms]\n  events.s.times: [1, 5]\n"
             "report: [t.t_j_rise]\n");
  ran r = run("study t.yaml -o t --quiet --jobs 1 --overwrite");
  EXPECT(r.status == 3, "%d: %s", r.status, r.err);
  free_ran(&r);
  char *csv = read_file("t/study.csv");
  int column = column_of(csv, "t.t_j_rise_k"), row = 0;
  double rises[4] = {0};
  for (const char *at = strchr(csv, '\n'); column > 0 && at && at[1]; at = strchr(at + 1, '\n'))
    rises[row++ % 4] = cell_of(at + 1, column);
  for (int k = 0; k < 4; k++) CLOSE(rises[k], k % 2 ? five : once, 2e-4);
  CU_ASSERT_EQUAL(row, 4);
  free(csv);
  r = run("run s.yaml --set events.s.times=5 --set events.s.every=20ms");
  EXPECT(r.status == 2 && strstr(r.err, "0.02 s is less than the run, of run.until = 0.03 s"), "%s",
         r.err);
  free_ran(&r);
}

/* A current of 1000 A for 100 us is held against a table of 20 and 200 us, 1 and 100 times: a power
 * law between its rows. The pulse has an edge of 0.1 us at either end: 1e-3. */
static void a_table_of_pulses(void) {
  static const char PART[] = "*$ part varistor \"V\"\n*$ limit energy = 1000 J\n%s"
                             ".subckt v a b\nR1 a b 1meg\n.ends\n",
                    ROWS[] = "*$ pulse 20 us 1 4000 A\n*$ pulse 200 us 1 1500 A\n"
                             "*$ pulse 20 us 100 1000 A\n*$ pulse 200 us 100 400 A assumed\n";
  char part[500];
  write_file("d.cir", "*$ param w = v part\n*$ device w = v(x), i(Vs)\n*$ line z\n"
                      "Is 0 y PWL(0 0 1m 0 1.0001m 1000 1.1m 1000 1.1001m 0)\nVs y x 0\n"
                      "Rx x 0 1m\nRz z 0 100\nRe e 0 1\nXeva e 0 eva\n");
  write_file("s.yaml", "circuit: {deck: d.cir}\nrun: {until: 5 ms, max_step: 5 us, verify: never}\n"
                       "events: {s: {kind: surge, at: 4 ms, every: 30 s}}\n"
                       "waive: [w.i_surge, w.p_max]\n");
  snprintf(part, sizeof part, PART, ROWS);
  write_file("v.inc", part);
  double wide = log(100.0 / 20) / log(10);
  double once = 4000 * pow(1500.0 / 4000, wide), hundred = 1000 * pow(400.0 / 1000, wide);
  for (int times = 1; times <= 100; times = 10 * times) {
    double allowed = once * pow(hundred / once, log(times) / log(100));
    ran r = run("run s.yaml --json --quiet --set events.s.times=%d", times);
    CU_ASSERT_EQUAL(r.status, allowed < 1000 ? 3 : 0);
    const char *line = strstr(r.out, "\"measure\": \"i_pulse\"");
    const char *limit = line ? strstr(line, "\"limit\": ") : NULL;
    CLOSE(limit ? strtod(limit + strlen("\"limit\": "), NULL) : NAN, allowed, 1e-3);
    CLOSE(measure_in(r.out, "w.i_pulse"), 1000, 1e-6);
    EXPECT(strstr(line ? line : "", times > 1 ? "\"assumed\": true" : "\"assumed\": false"), "%s",
           r.out);
    EXPECT(!strstr(r.out, "no derating"), "%s", r.out);
    if (times > 1) /* 1 J of 1000 A, 1 V, 100 us and its edges */
      CLOSE(measure_in(r.out, "w.power_repeated"), 0.1 / 30, 2e-3);
    free_ran(&r);
  }
  ran r = run("run s.yaml --json --quiet --set events.s.times=1000");
  EXPECT(r.status == 0 && strstr(r.out, "not judged: the part's table of pulses ends"), "%s",
         r.out);
  free_ran(&r);
  snprintf(part, sizeof part, PART, "");
  write_file("v.inc", part);
  r = run("run s.yaml --json --set events.s.times=10");
  EXPECT(strstr(r.err,
                "events.s.times: 10 pulses; w states no derating over number (pulse), so its "
                "limits for one pulse were used") &&
             strstr(r.out, "so its limits for one pulse were used") &&
             strstr(r.out, "\"not_judged\": [\"w.i_pulse\""),
         "%s %s", r.err, r.out);
  free_ran(&r);
  r = run("run s.yaml --json");
  EXPECT(!strstr(r.err, "derating"), "%s", r.err);
  free_ran(&r);
}

/* ---- bad input ---- */

static void bad_input(void) {
  static const struct {
    const char *supply, *events, *deck, *at, *says;
  } ROWS[] = {
      {"{}", "{e: {kind: surge, at: 3 ms, from: later}}", LINE,
       "s.yaml:4:43: ", "'later' is none of: start, strike, a time as 15 ms"},
      {"{}", "{e: {kind: surge, from: later}}", LINE, /* one message, of what comes first */
       "s.yaml:4:10: ", "'at', or 'cycle' and 'angle', is wanted"},
      {"{}", "{e: {kind: eft, at: 3 ms, from: 4 ms}}", LINE,
       "s.yaml:4:41: ", "onto the line at 0.004 s, behind its wave, which begins at 0.003 s"},
      {"{}", "{e: {kind: surge, at: 3 ms, coupling: ground}}", LINE,
       "s.yaml:4:47: ", "is not one of: line|earth"},
      {"{}", "{e: {kind: surge, at: 3 ms, coupling: earth}}", "*$ line a\nRa a 0 1\nXeva a 0 eva\n",
       "s.yaml:4:10: ", "the deck has no line '*$ earth NODE', which says which node is the earth"},
      {"{}", "{e: {kind: surge, at: 3 ms, times: 0}}", LINE, "s.yaml:4:44: ", "allowed: 1..1e+06"},
      {"{}", "{e: {kind: surge, at: 3 ms, times: 2, every: 5 ms}}", LINE,
       "s.yaml:4:54: ", "less than the run"},
      {"{}", "{a: {kind: eft, at: 1 ms, times: 2}, e: {kind: eft, at: 3 ms, times: 3}}", LINE,
       "s.yaml:4:78: ", "events.a repeats the run already"},
      {"{}", "{e: {kind: sag, at: 3 ms, off: yes}}", LINE,
       "s.yaml:4:40: ", "is not one of: false|true"},
      {"{decoupling: 1.5 mH}", "{}", "*$ port mains = Vm\nVm a 0 external\nXeva a 0 eva\n",
       "s.yaml:2:22: ", "the deck has no element of {l_source}"},
      {"{decoupling: -1 mH}", "{}", LINE, "s.yaml:2:22: ", "allowed: 0.."}};
  char scene[400];
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    write_file("d.cir", ROWS[k].deck);
    snprintf(scene, sizeof scene,
             "circuit: {deck: d.cir}\nsupply: %s\nrun: {until: 25 ms}\nevents: %s\n",
             ROWS[k].supply, ROWS[k].events);
    write_file("s.yaml", scene);
    for (int check = 0; check < 2; check++) {
      ran r = run(check ? "check s.yaml" : "run s.yaml");
      CU_ASSERT_EQUAL(r.status, 2);
      const char *text = check ? r.err : r.err + strlen("vibrospice: ");
      const char *event = strstr(text, ": events.e: ");
      EXPECT(!strncmp(text, ROWS[k].at, strlen(ROWS[k].at)) && strstr(text, ROWS[k].says) &&
                 !(event && strstr(event + 1, ": events.e")),
             "%s", r.err);
      free_ran(&r);
    }
  }
  static const char *const DECKS[][2] = {{"*$ earth\n", "'earth NODE' is wanted here"},
                                         {"*$ earth a b\n", "nothing may follow the node"},
                                         {"*$ earth a\n*$ earth b\n", "a second '*$ earth'"}};
  for (size_t k = 0; k < COUNT(DECKS); k++) {
    char deck[200];
    snprintf(deck, sizeof deck, "%sRa a 0 1\nRb b 0 1\nXeva a b eva\n", DECKS[k][0]);
    write_file("d.cir", deck);
    ran r = run("check d.cir");
    EXPECT(r.status == 2 && strstr(r.err, DECKS[k][1]), "%s", r.err);
    free_ran(&r);
  }
}

static const vs_test TESTS[] = {
    {"against plain ngspice", against_plain_ngspice},
    {"other networks", other_networks},
    {"computed elsewhere", computed_elsewhere},
    {"comes onto the line", comes_onto_the_line},
    {"named in the results", named_in_the_results},
    {"two at once", two_at_once},
    {"not built", not_built},
    {"not built elsewhere", not_built_elsewhere},
    {"heat adds up", heat_adds_up},
    {"a table of pulses", a_table_of_pulses},
    {"bad input", bad_input},
};

int main(void) {
  return program_suite("generators", TESTS, COUNT(TESTS));
}
