/* SPDX-License-Identifier: GPL-3.0-or-later
 * The figures of models of many shapes (shapes.lib), wrapped as they come and tried with the limits
 * of the template, which are others than the models': against plain ngspice, and where a figure
 * cannot be told, that this is said. Without VS_LONG a few of known values. With it, all, and a
 * table is written; the one of the last release is tests/long/shapes.csv. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"
#include "bench.h"
#include "netlist/location.h"
#include "netlist/netlist.h"
#include "part_rows.h"

/* ---- check ---- */

/* Wraps a model and tries it. `quick` leaves out the lines of what is sought for long. */
static ran tried(const char *kind, const char *model, bool quick) {
  static const char *const LONG[] = {"dv_dt", "dv_dt_c", "t_q"};
  char *lib = read_file(VS_TEST_FOLDER "/bench/shapes.lib"), limit[2][32];
  write_file("shapes.lib", lib);
  free(lib);
  ran r = run("part %s --wrap shapes.lib:%s -o s.inc --overwrite --quiet", kind, model);
  EXPECT(r.status == 0, "%s: %s", model, r.err);
  free_ran(&r);
  for (size_t n = 0; n < COUNT(LONG) && quick; n++) {
    snprintf(limit[0], sizeof limit[0], "*$ limit  %s =", LONG[n]);
    snprintf(limit[1], sizeof limit[1], "* limit  %s =", LONG[n]);
    char *text = read_file("s.inc");
    if (strstr(text, limit[0])) alter("s.inc", "s.inc", limit[0], limit[1]);
    free(text);
  }
  return run("check s.inc --json");
}

/* ---- known values ---- */

/* What the models' own lines say, and for the varistors their laws: 2 % where it is sought (docs/
 * parts.md), 1 % else, 0.1 % of a varistor's voltage. The template's I_L of 60 mA is ten times and
 * more these models'. */
static void known_values(void) {
  static const struct {
    const char *kind, *model, *figure;
    int nth;
    double got, tolerance;
  } ROWS[] = {
      {"thyristor", "HOLD6", "I_H", 0, 6, 0.01},  {"thyristor", "HOLD6", "I_GT", 0, 5, 0.01},
      {"thyristor", "HOLD6", "I_L", 0, 6, 0.02},  {"thyristor", "PILOT", "I_GT", 0, 5, 0.01},
      {"thyristor", "PILOT", "I_L", 0, 10, 0.02}, {"thyristor", "PILOT", "I_H", 0, 6.67, 0.01},
      {"varistor", "MOVB", "V", 0, 402.17, 1e-3}, {"varistor", "MOVB", "V", 1, 1064.46, 1e-3},
      {"varistor", "MOVT", "V", 0, 430, 1e-3}};
  ran r = {0};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    if (!k || strcmp(ROWS[k].model, ROWS[k - 1].model)) {
      free_ran(&r);
      r = tried(ROWS[k].kind, ROWS[k].model, true);
    }
    double got = number_of(r.out, ROWS[k].figure, ROWS[k].nth, "got");
    vs_close(got, ROWS[k].got, ROWS[k].got, ROWS[k].tolerance, ROWS[k].model, __LINE__);
  }
  free_ran(&r);
}

/* ---- what cannot be judged ---- */

/* No such figure is `held`: what leaks is more than what is held; a diode has no on-state; what
 * conducts only while it is driven has no I_GT; what fires late does fire; what does not switch has
 * no energies of it. */
static void could_not_judge(void) {
  static const struct {
    const char *kind, *model, *figure;
    bool quick;
  } ROWS[] = {{"mosfet", "ALWAYS", "E_on", true},  {"mosfet", "STAYS", "E_off", true},
              {"thyristor", "LEAKY", "I_H", true}, {"thyristor", "LEAKY", "I_L", true},
              {"thyristor", "DIO", "V_T", true},   {"thyristor", "DIO", "I_GT", true},
              {"thyristor", "AMP", "I_GT", false}, {"thyristor", "LATEDV", "dv/dt", false}};
  ran r = {0};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    if (!ROWS[k].quick && !getenv("VS_LONG")) break; /* these are the last ones */
    if (!k || strcmp(ROWS[k].model, ROWS[k - 1].model)) {
      free_ran(&r);
      r = tried(ROWS[k].kind, ROWS[k].model, ROWS[k].quick);
    }
    char at[64];
    snprintf(at, sizeof at, "\"figure\": \"%s\"", ROWS[k].figure);
    const char *row = strstr(r.out, at), *why = row ? strstr(row, "could not judge: ") : NULL,
               *end = row ? strchr(row, '\n') : NULL;
    EXPECT(r.status == 1 && why && end && why < end, "%s %s: %.300s", ROWS[k].model, ROWS[k].figure,
           row ? row : r.err);
  }
  free_ran(&r);
  /* it holds at more than is asked, and less than a hundredth of I_L */
  r = tried("thyristor", "LEAKS20K", true);
  free_ran(&r);
  alter("s.inc", "s.inc", "i_h = 30 mA", "i_h = 0.1 mA");
  r = run("check s.inc --json");
  const char *row = strstr(r.out, "\"figure\": \"I_H\"");
  EXPECT(row && strstr(row, "\"why\": \"could not judge: below"), "%s", r.out);
  free_ran(&r);
}

/* ---- against plain ngspice ---- */

typedef struct record {
  size_t points;
  double *t, *v, *i, *g; /* one block, which t owns */
} record;

static void free_record(record *r) {
  free(r->t);
  *r = (record){0};
}

/* Reads "t v t i t g" of each step. */
static record read_record(void) {
  enum { COLUMNS = 6 };
  char *text = read_file("x.data"), *rest = text;
  size_t room = (size_t)count_lines(text) + 1;
  record r = {.t = vs_alloc(4 * room, sizeof *r.t)};
  r.v = r.t + room, r.i = r.v + room, r.g = r.i + room;
  for (double c[COLUMNS];; r.points++) {
    int n = 0;
    for (char *end; n < COLUMNS; n++, rest = end) {
      c[n] = strtod(rest, &end);
      if (end == rest) break;
    }
    if (n < COLUMNS || r.points == room) break;
    r.t[r.points] = c[0], r.v[r.points] = c[1], r.i[r.points] = c[3], r.g[r.points] = c[5];
  }
  free(text);
  return r;
}

/* A model's pins in a circuit of its own. */
typedef struct shape {
  const char *model, *nodes;
  bool triac;
  const char *plain; /* the model that plain ngspice gets */
} shape;

/* Runs a circuit around the model in plain ngspice, with its own tolerances first; where it gives
 * up, with others. False: it gives up with all. */
static bool plain(const shape *s, double until_s, double step_s, record *r, const char *lines) {
  static const char *const WAYS[] = {"reltol=1e-4", "method=gear reltol=1e-4",
                                     "method=gear reltol=1e-4 chgtol=1e-11", "reltol=1e-3"};
  for (size_t k = 0; k < COUNT(WAYS); k++) {
    vs_text deck = {0};
    vs_text_add(
        &deck,
        "shape\n.include shapes.lib\nVm a t 0\nXdut %s %s\nRa a 0 1e9\nRg g 0 1e6\n"
        "%s.options %s\n.control\ntran %g %g 0 %g uic\nwrdata x.data v(a) i(vm) v(g)\nquit\n"
        ".endc\n.end\n",
        s->nodes, s->plain ? s->plain : s->model, lines, WAYS[k], step_s, until_s, step_s);
    write_file("x.cir", deck.text);
    vs_text_free(&deck);
    unlink("x.data");
    if (system("timeout 100 ngspice -b x.cir >x.log 2>&1") || access("x.data", R_OK)) continue;
    *r = read_record();
    if (r->points && r->t[r->points - 1] > 0.999 * until_s) return true;
    free_record(r);
  }
  return false;
}

static double at(const record *r, const double *column, double t_s) {
  size_t k = 1;
  while (k + 1 < r->points && r->t[k] < t_s) k++;
  return column[k - 1] +
         (column[k] - column[k - 1]) * (t_s - r->t[k - 1]) / (r->t[k] - r->t[k - 1]);
}

static double crosses(const record *r, double from_s, double level_v) {
  for (size_t k = 1; k < r->points; k++)
    if (r->t[k] > from_s && (r->v[k] > level_v) != (r->v[k - 1] > level_v)) return r->t[k];
  return NAN;
}

/* What is compared: what check got, SI, and what plain ngspice says of it. */
typedef struct figures {
  double v_t, i_gt, v_gt, i_l, i_h, dv_dt, t_q;
} figures;

static double plain_on_state(const shape *s, const figures *f, double i) {
  record r = {0};
  char lines[256];
  snprintf(lines, sizeof lines, "I1 0 a pwl(0 0 100u 0 1m %g)\nIg 0 g pwl(0 0 50u %g)\n", i,
           3 * f->i_gt);
  double v = plain(s, 3e-3, 5e-6, &r, lines) ? r.v[r.points - 1] : NAN;
  free_record(&r);
  return v;
}

/* At 12 V and 0.5 A the gate's current rises slowly to three times what check got. */
static void plain_fire(const shape *s, const figures *f, figures *of) {
  record r = {0};
  char lines[256];
  snprintf(lines, sizeof lines, "V1 s 0 pwl(0 0 1m 12)\nR1 s a 24\nIg 0 g pwl(0 0 5m 0 65m %g)\n",
           3 * f->i_gt);
  if (plain(s, 65e-3, 10e-6, &r, lines)) {
    double fires_s = crosses(&r, 5e-3, 6);
    of->i_gt = 3 * f->i_gt * (fires_s - 5e-3) / 60e-3;
    of->v_gt = at(&r, r.g, fires_s - 30e-6);
  }
  free_record(&r);
}

/* The supply falls within 0.1 s from 100 V, at which four times the current flows that check got.
 */
static double plain_holding(const shape *s, const figures *f) {
  record r = {0};
  char lines[256];
  snprintf(lines, sizeof lines,
           "V1 s 0 pwl(0 0 1m 100 2m 100 102m 0)\nR1 s a %g\n"
           "Ig 0 g pwl(0 0 1m 0 1.01m %g 1.3m %g 1.31m 0)\n",
           25 / f->i_h, 3 * f->i_gt, 3 * f->i_gt);
  double i = NAN;
  if (plain(s, 102e-3, 10e-6, &r, lines) && at(&r, r.v, 1.9e-3) < 5)
    i = at(&r, r.i, crosses(&r, 2e-3, 5) - 50e-6);
  free_record(&r);
  return i;
}

/* Each is true where the device conducts in the end; -1: plain ngspice gives up. */
static int plain_latches(const shape *s, const figures *f, double i) {
  record r = {0};
  char lines[256];
  snprintf(lines, sizeof lines,
           "V1 s 0 pwl(0 0 1m 100)\nR1 s a %g\nIg 0 g pwl(0 0 1.2m 0 1.201m %g 1.4m %g 1.401m 0)\n",
           99 / i, 1.5 * f->i_gt, 1.5 * f->i_gt);
  int on = plain(s, 2e-3, 5e-6, &r, lines) ? r.v[r.points - 1] < 5 : -1;
  free_record(&r);
  return on;
}

static int plain_fires(const shape *s, double v_s) {
  const double v = 536, rise_s = v / v_s;
  record r = {0};
  char lines[256];
  snprintf(lines, sizeof lines, "V1 s 0 pwl(0 0 10u 0 %.9g %g)\nR1 s a 10\n", 10e-6 + rise_s, v);
  int on =
      plain(s, 80e-6 + rise_s, fmin(50e-9, rise_s / 100), &r, lines) ? r.v[r.points - 1] < 20 : -1;
  free_record(&r);
  return on;
}

/* 10 A fall at 30 A/us; then -25 V, and so long after the zero 0 V on the way to 536 V at 20 V/us.
 */
static int plain_stays(const shape *s, const figures *f, double t_q) {
  const double zero = 500e-6 + 10 / 30e6, back = zero + t_q, up = back + 536 / 20e6;
  record r = {0};
  vs_text lines = {0};
  vs_text_add(
      &lines,
      "I1 0 a pwl(0 0 50u 0 100u 10 500u 10 %.9g 0)\nIg 0 g pwl(0 0 20u %g 200u %g 201u 0)\n"
      "S1 a w ct 0 joined\n.model joined sw(ron=1 roff=1g vt=0.5 vh=0.1)\n"
      "Vct ct 0 pwl(0 0 %.9g 0 %.9g 1)\nVw w 0 pwl(0 -25 %.9g -25 %.9g 536)\n",
      zero, 3 * f->i_gt, 3 * f->i_gt, zero, zero + 1e-7, back - 25 / 20e6, up);
  int off = plain(s, up + 60e-6, 0.2e-6, &r, lines.text) ? r.v[r.points - 1] > 268 : -1;
  vs_text_free(&lines);
  free_record(&r);
  return off;
}

/* One row of the table: `off` is how far check is from plain ngspice, a part; or 0 where plain
 * ngspice is on one side a part `within` below and on the other above, 1 where it is not. */
static bool put_row(FILE *table, const char *model, const char *figure, double got, double plain_is,
                    double off, double most) {
  if (isnan(off))
    fprintf(table, "%s,%s,%.4g,,,plain ngspice gives up\n", model, figure, got);
  else if (isnan(plain_is))
    fprintf(table, "%s,%s,%.4g,,,%s %g %% around it\n", model, figure, got,
            off ? "not told by" : "told by", 100 * most);
  else
    fprintf(table, "%s,%s,%.4g,%.4g,%.2f,\n", model, figure, got, plain_is, 100 * off);
  EXPECT(isnan(off) || fabs(off) <= most, "%s %s: %g, plain ngspice: %g", model, figure, got,
         plain_is);
  return !isnan(off);
}

static double bracket(int below, int above, int conducts_above) {
  return below < 0 || above < 0 ? NAN : below != conducts_above && above == conducts_above ? 0 : 1;
}

/* Tolerances: 1 % of V_T, a settled value. 3 % where a ramp passes a threshold. 4 % of I_H, whose
 * ramps are of different speed. 6 % around what is sought to 2 %, 12 % around dv/dt and t_q. */
static size_t compare(FILE *table, const shape *s) {
  ran r = tried(s->triac ? "triac" : "thyristor", s->model, false);
  figures f = {.v_t = number_of(r.out, "V_T", 0, "got"),
               .i_gt = 1e-3 * number_of(r.out, "I_GT", 0, "got"),
               .v_gt = number_of(r.out, "V_GT", 0, "got"),
               .i_l = 1e-3 * number_of(r.out, "I_L", 0, "got"),
               .i_h = 1e-3 * number_of(r.out, "I_H", 0, "got"),
               .dv_dt = 1e6 * number_of(r.out, "dv/dt", 0, "got"),
               .t_q = 1e-6 * number_of(r.out, "t_q", 0, "got")},
          of = {.i_gt = NAN, .v_gt = NAN};
  free_ran(&r);
  size_t told = 0;
  of.v_t = plain_on_state(s, &f, s->triac ? 17 : 24);
  plain_fire(s, &f, &of);
  of.i_h = plain_holding(s, &f);
  told += put_row(table, s->model, "V_T", f.v_t, of.v_t, f.v_t / of.v_t - 1, 0.01);
  told += put_row(table, s->model, "I_GT", f.i_gt, of.i_gt, f.i_gt / of.i_gt - 1, 0.03);
  told += put_row(table, s->model, "V_GT", f.v_gt, of.v_gt, f.v_gt / of.v_gt - 1, 0.03);
  told += put_row(table, s->model, "I_H", f.i_h, of.i_h, f.i_h / of.i_h - 1, 0.04);
  told += put_row(
      table, s->model, "I_L", f.i_l, NAN,
      bracket(plain_latches(s, &f, 0.94 * f.i_l), plain_latches(s, &f, 1.06 * f.i_l), 1), 0.06);
  if (isfinite(f.dv_dt))
    told +=
        put_row(table, s->model, "dv/dt", f.dv_dt, NAN,
                bracket(plain_fires(s, 0.88 * f.dv_dt), plain_fires(s, 1.12 * f.dv_dt), 1), 0.12);
  if (f.t_q > 2e-6) /* the stand's circuit takes 1.4 us to turn round */
    told += put_row(table, s->model, "t_q", f.t_q, NAN,
                    bracket(plain_stays(s, &f, 0.88 * f.t_q), plain_stays(s, &f, 1.12 * f.t_q), 1),
                    0.12);
  return told;
}

static void against_plain_ngspice(void) {
  static const shape SHAPES[] = {
      {"TWO_T", "t 0 g", false, NULL},  {"IS_SCR", "t g 0", false, NULL},
      {"SENS", "t g 0", false, NULL},   {"HOLD6", "t 0 g", false, NULL},
      {"PILOT", "t 0 g", false, NULL},  {"PROD", "t g 0", false, "PLAINPROD"},
      {"LT_SCR", "t 0 g", false, NULL}, {"TAB", "t 0 g", false, NULL},
      {"HARD", "t 0 g", false, NULL},   {"PTRI", "t 0 g", true, NULL},
      {"TTRI", "t 0 g", true, NULL}};
  size_t told = 0;
  if (!getenv("VS_LONG") || !on_path("ngspice")) return;
  write_file(".spiceinit", "set ngbehavior=psa\n");
  FILE *table = fopen(VS_BUILD_TREE "/tests/run/test_shapes/shapes.csv", "w");
  EXPECT(table, "%s", "no table");
  if (!table) return;
  fputs("model,figure,got,plain,off_percent,remark\n", table);
  for (size_t k = 0; k < COUNT(SHAPES); k++) told += compare(table, &SHAPES[k]);
  fclose(table);
  EXPECT(told >= 60, "plain ngspice tells %zu figures alone", told);
}

/* ---- who is blamed ---- */

/* A source that jumps by 400 V charges 1 uF behind 2.2 ohm, whose charge is none before: no step is
 * short enough for its truncation error. ngspice names the node e, where no charge is; the element
 * is Cf. */
static void who_sets_the_step(void) {
  bench b = {.deck = "Vg g 0 pwl(0 0 1m 1)\nRg g 0 100\nE1 e 0 VALUE={u(v(g)-0.5)*400}\n"
                     "Rf e f 2.2\nCf 0 f 1u\nRh f h 1\nCh h 0 1p",
             .signals = {"v(f)", NULL},
             .until_s = 1e-3,
             .max_step_s = 1e-5,
             .relative_tolerance = 1e-6,
             .current_tolerance_a = 1e-12,
             .gear = true};
  vs_error err = {0};
  vs_status status = bench_run(&b, &err);
  EXPECT(status == VS_RUN && strstr(err.text, "the truncation error of instance cf sets the step"),
         "%d: %s", status, err.text);
}

/* The lines that complaints are about: the element that is an instance; of a node of the circuit
 * itself the user's subcircuit behind an ammeter, and not a subcircuit's node of that name; of a
 * power the one that has not another number for its exponent. */
static void which_line(void) {
  static const struct {
    const char *complaint;
    int line;
  } ROWS[] = {{"the truncation error of instance cf sets the step", 7},
              {"trouble with node \"a\"", 2},
              {"trouble with node \"xs.a\"", 3},
              {"-8.3e+50, 6.2e+118 out of range for ^", 9}};
  write_file("b.cir", "* a deck\n.subckt mine t b\nRm t a 1\nCm a b 1u\n.ends\nRs s a 1\n"
                      "Cf 0 a 1u\nB1 p 0 V=v(a)^2\nB2 q 0 V=v(a)^v(p)\nVa a m 0\nXs m 0 mine\n"
                      "Reva eva_ 0 1\nXeva eva_ 0 eva\n");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_deck *deck = vs_alloc(1, sizeof *deck);
    vs_error err = {0};
    EXPECT(vs_netlist_read("b.cir", deck, &err) == VS_OK, "%s", err.text);
    vs_fail(&err, VS_INPUT, "ngspice: Timestep too small: %s", ROWS[k].complaint);
    vs_location_locate(deck, 0, &err);
    EXPECT(err.line == ROWS[k].line, "%s: %s", ROWS[k].complaint, err.text);
    vs_deck_free(deck);
    free(deck);
  }
}

static const vs_test TESTS[] = {
    {"known values", known_values},
    {"could not judge", could_not_judge},
    {"against plain ngspice", against_plain_ngspice},
    {"who sets the step", who_sets_the_step},
    {"which line", which_line},
};

int main(void) {
  return program_suite("shapes", TESTS, COUNT(TESTS));
}
