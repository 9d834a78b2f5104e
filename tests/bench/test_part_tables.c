/* SPDX-License-Identifier: GPL-3.0-or-later
 * Parts that stand in tables (src/catalogue): what ships is listed, tried and runs; a row is the
 * same as a file of its own; what is wrong in a table is named by its place; a study's cases depend
 * on the row that they use alone; a resistor of a deck takes the limits of a series; the numbers of
 * what ships do not contradict each other. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/text.h"
#include "bench/stand.h"
#include "netlist/catalogue.h"
#include "netlist/deck.h"
#include "part_rows.h"

#define PARTS VS_TEST_FOLDER "/../spice/parts"

/* ---- what ships ---- */

/* The rows of one table. */
typedef struct rows {
  const char *table;
  char *name[128];
  size_t count;
} rows;

static void take(void *ctx, const char *path) {
  rows *all = ctx;
  size_t n;
  const char *name = vs_catalogue_name(path, &n);
  if (vs_catalogue_is_row(path) && strstr(path, all->table) && all->count < COUNT(all->name))
    all->name[all->count++] = vs_alloc_part(name, n);
}

static rows rows_of(const char *table) {
  rows all = {.table = table};
  vs_catalogue_list(&vs_deck_parts_shelf, take, &all);
  return all;
}

static void free_rows(rows *all) {
  for (size_t k = 0; k < all->count; k++) free(all->name[k]);
}

/* So many as are wanted at least ship of each kind, and `list parts` shows each with its kind. */
static void listed(void) {
  static const struct {
    const char *table, *kind;
    size_t least;
  } TABLES[] = {{"/thyristors.tab", "thyristor", 12}, {"/triacs.tab", "triac", 8},
                {"/varistors.tab", "varistor", 50},   {"/fuses.tab", "fuse", 12},
                {"/resistors.tab", "resistor", 6},    {"/capacitors.tab", "capacitor", 12},
                {"/zeners.tab", "zener", 11},         {"/tvs.tab", "tvs", 3},
                {"/zeners_diode.tab", "zener", 3},    {"/diodes.tab", "diode", 4},
                {"/mosfets.tab", "mosfet", 2}};
  ran r = run("list parts");
  expect_good(&r, "list parts", __LINE__);
  for (size_t t = 0; t < COUNT(TABLES); t++) {
    rows all = rows_of(TABLES[t].table);
    EXPECT(all.count >= TABLES[t].least, "%s has %zu rows", TABLES[t].table, all.count);
    for (size_t k = 0; k < all.count; k++) {
      vs_text entry = {0};
      vs_text_add(&entry, "\n%-20s", all.name[k]);
      const char *at = strstr(r.out, entry.text), *next = at ? strchr(at + 1, '\n') : NULL;
      vs_text_add(&entry, "%s", ""); /* the line below says what it is */
      EXPECT(next && !strncmp(next + 5, TABLES[t].kind, strlen(TABLES[t].kind)), "%s is no %s",
             all.name[k], TABLES[t].kind);
      vs_text_free(&entry);
    }
    free_rows(&all);
  }
  EXPECT(!strstr(r.out, "    limit "), "%s", r.out);
  free_ran(&r);
  r = run("list parts LF213-1A"); /* three of them, with their limits and models */
  EXPECT(strstr(r.out, "\n    model i_fusing, -1 % of sheet\n"), "%s", r.out);
  free_ran(&r);
  r = run("list parts fuse"); /* of that kind alone: no Littelfuse's thyristor */
  EXPECT(!strstr(r.out, "    thyristor: ") && strstr(r.out, "    fuse: "), "%s", r.out);
  free_ran(&r);
}

/* The discs go from S05 to S20, and from 130 to 510 V. */
static void discs(void) {
  static const char *const NAMES[] = {"S05K130", "S07K230", "S10K510", "S14K275", "S20K275"};
  char path[VS_PATH_SIZE];
  for (size_t k = 0; k < COUNT(NAMES); k++)
    EXPECT(vs_catalogue_shipped(&vs_deck_parts_shelf, NAMES[k], path) && vs_catalogue_is_row(path),
           "%s", NAMES[k]);
  EXPECT(vs_catalogue_shipped(&vs_deck_parts_shelf, "s20k275", path) &&
             strstr(path, "varistors.tab#S20K275"),
         "%s", path); /* capitals aside */
  EXPECT(vs_catalogue_shipped(&vs_deck_parts_shelf, "s20k510", path) &&
             strstr(path, "parts/s20k510.inc"),
         "%s", path); /* a file's own name goes first */
}

/* The deviation in `check --json` of a figure that is furthest. */
static double furthest(const char *json, const char *figure) {
  double all = 0;
  vs_text key = {0};
  vs_text_add(&key, "\"of\": \"%s\", \"model_deviation\": ", figure);
  for (const char *at = json; (at = strstr(at, key.text));) {
    double own = strtod(at += key.length, NULL);
    if (fabs(own) > fabs(all)) all = own;
  }
  vs_text_free(&key);
  return all;
}

/* Figures that are sought, to 2 %: another ngspice may end the search a step of 1.2 % aside. */
static bool is_sought(const char *figure) {
  static const char *const SOUGHT[] = {"i_l", "dv_dt", "dv_dt_c", "t_q", "i_fusing"};
  for (size_t k = 0; k < COUNT(SOUGHT); k++)
    if (!strcmp(figure, SOUGHT[k])) return true;
  return false;
}

/* What the model does is what its file asks, and what the part says of its model beside its sheet
 * is what the test stand finds: to the half per cent that it is rounded by, and the step of a
 * search. */
static void beside_the_sheet(const char *name) {
  char path[VS_PATH_SIZE];
  vs_stand *s = vs_alloc(1, sizeof *s);
  vs_error err = {0};
  ran r = run("check %s --json", name);
  EXPECT(vs_catalogue_shipped(&vs_deck_parts_shelf, name, path) && !vs_stand_open(path, s, &err),
         "%s: %s", name, err.text);
  EXPECT(r.status == 0 && strstr(r.out, "\"figure\": ") && !strstr(r.out, "\"word\": \"off\"") &&
             !strstr(r.out, "\"word\": \"failed\""),
         "%s: %d: %s%s", name, r.status, r.out, r.err);
  for (size_t k = 0; k < s->deck.n_models; k++) {
    const vs_model_line *m = &s->deck.models[k];
    const double got = furthest(r.out, m->figure),
                 step = is_sought(m->figure) ? 0.012 * (1 + got) : 0;
    EXPECT(fabs(got - m->deviation) <= 0.00501 + step, "%s: model %s = %g %%, and it is %g %%",
           name, m->figure, 100 * m->deviation, 100 * got);
  }
  vs_stand_close(s);
  free(s);
  free_ran(&r);
}

/* The same of parts in files of their own; all with VS_LONG. */
static void files_beside_their_sheets(void) {
  static const char *const FILES[] = {"s20k460",      "v511da40",     "FWP-10A14F", "rectifier",
                                      "mosfet",       "igbt",         "s14k460",    "s14k510",
                                      "s20k510",      "v481da40",     "FWP-50A14F", "A070gRB10T13",
                                      "S505H-3-15-R", "12TTS08S",     "BT151-800R", "TYN1012",
                                      "TYN1212",      "thyristor_2t", "triac_2t"};
  const size_t SOME = 6;
  for (size_t k = 0; k < (getenv("VS_LONG") ? COUNT(FILES) : SOME); k++) {
    ran r = run("check %s", FILES[k]);
    EXPECT(r.status == 0 && !strstr(r.out, "*$ model"), "%s: %s", FILES[k], r.out);
    free_ran(&r);
    beside_the_sheet(FILES[k]);
  }
}

/* What the model of each does is what its row asks. All rows with VS_LONG: a thyristor takes 1 s,
 * a triac 1.5 s. */
static void tried(void) {
  static const char *const TABLES[] = {"/thyristors.tab", "/triacs.tab",    "/varistors.tab",
                                       "/fuses.tab",      "/resistors.tab", "/capacitors.tab"};
  static const char *const SOME[] = {"BT152-800R", "S20K275", "S05K420", "S505-3-15-R",
                                     "LF213-2A",   "PR02",    "X2-100N", "Z0103MA"};
  bool whole = getenv("VS_LONG") != NULL;
  for (size_t t = 0; t < COUNT(TABLES); t++) {
    rows all = rows_of(TABLES[t]);
    for (size_t k = 0; k < all.count; k++) {
      bool wanted = whole;
      for (size_t n = 0; n < COUNT(SOME); n++) wanted = wanted || !strcmp(SOME[n], all.name[k]);
      if (wanted) beside_the_sheet(all.name[k]);
    }
    free_rows(&all);
  }
}

/* A run with each of them begins. */
static void each_runs(void) {
  static const char *const TABLES[][2] = {
      {"/thyristors.tab", "thyristor"}, {"/varistors.tab", "varistor_1"}, {"/fuses.tab", "fuse_2"}};
  for (size_t t = 0; t < COUNT(TABLES); t++) {
    rows all = rows_of(TABLES[t][0]);
    for (size_t k = 0; k < all.count; k++) {
      ran r = run("run paper --tier circuit --set circuit.deck=halfwave_paper --set "
                  "circuit.%s=%s --set run.until=0.05ms --set run.verify=never --quiet",
                  TABLES[t][1], all.name[k]);
      EXPECT(r.status == 0 || r.status == 3, "%s: %d: %s", all.name[k], r.status, r.err);
      free_ran(&r);
    }
    free_rows(&all);
  }
}

/* ---- are the numbers sound? ---- */

/* The lines that a row makes. */
typedef struct sheet {
  const char *name;
  vs_catalogue_part part;
} sheet;

/* The number behind "NAME = " in the row's line of the contract; NaN: it has none. */
static double given(const sheet *s, const char *line, const char *name) {
  for (size_t k = 0; k < s->part.source.count; k++) {
    char word[32], called[64];
    double value;
    if (sscanf(s->part.source.line[k], "*$ %31s %63s = %lf", word, called, &value) == 3 &&
        !strcmp(word, line) && !strcmp(called, name))
      return value;
  }
  return NAN;
}

static double limit(const sheet *s, const char *name) {
  return given(s, "limit", name);
}

/* a <= b. Fails also where the row states one of them not. */
#define AT_MOST(s, a, b)                                                                           \
  EXPECT((a) <= (b), "%s: %s = %g, and %s = %g", (s)->name, #a, (double)(a), #b, (double)(b))

static void each_row(const char *table, void (*look)(const sheet *)) {
  rows all = rows_of(table);
  EXPECT(all.count > 0, "%s", table);
  for (size_t k = 0; k < all.count; k++) {
    char path[VS_PATH_SIZE];
    vs_error err = {0};
    sheet s = {.name = all.name[k]};
    snprintf(path, sizeof path, PARTS "%s#%s", table, all.name[k]);
    EXPECT(!vs_catalogue_read(path, &s.part, &err), "%s: %s", path, err.text);
    look(&s);
    vs_catalogue_free(&s.part);
  }
  free_rows(&all);
}

/* The terms of zth rise with their time constants. The rated current, in half sines, does not melt
 * the chip: a current of I rms has a mean of 2/pi I. Returns R_th. */
static void heat(const sheet *s, double most_k, double on_v, double on_ohm) {
  const double i_rms = limit(s, "i_t_rms");
  double r = 0, last_r = 0, last_ms = 0;
  size_t terms = 0;
  for (size_t k = 0; k < s->part.source.count; k++) {
    double term, ms;
    if (sscanf(s->part.source.line[k], "*$ zth %lf K/W %lf ms", &term, &ms) != 2) continue;
    EXPECT(term > last_r && ms > last_ms, "%s: %s", s->name, s->part.source.line[k]);
    r += term;
    last_r = term;
    last_ms = ms;
    terms++;
  }
  EXPECT(terms == 3, "%s: %zu terms", s->name, terms);
  AT_MOST(s, r * (on_v * i_rms * 2 / M_PI + on_ohm * i_rms * i_rms), most_k);
}

/* A half sine of I_TSM and 10 ms has I_TSM^2 5 ms. Sheets round it, which is within 2 %. */
static void thyristor(const sheet *s) {
  const double i_tsm = limit(s, "i_tsm");
  AT_MOST(s, limit(s, "i2t"), 1.02 * i_tsm * i_tsm * 5e-3);
  AT_MOST(s, 0.75 * i_tsm * i_tsm * 5e-3, limit(s, "i2t"));
  AT_MOST(s, 5 * limit(s, "i_t_rms"), i_tsm);
  AT_MOST(s, given(s, "param", "holding_current"), given(s, "param", "latching_current"));
  AT_MOST(s, limit(s, "dv_dt"), given(s, "param", "critical_dvdt"));
  AT_MOST(s, limit(s, "t_q"), given(s, "param", "turn_off_time"));
  heat(s, limit(s, "t_j_max") - 25, given(s, "param", "on_voltage"),
       1e-3 * given(s, "param", "on_resistance"));
}

/* A triac's sheet takes I2t from the surge at 60 Hz, which is up to 6 % larger: 13 % of I2t. */
static void triac(const sheet *s) {
  const double i_tsm = limit(s, "i_tsm");
  AT_MOST(s, limit(s, "i2t"), 1.13 * i_tsm * i_tsm * 5e-3);
  AT_MOST(s, 0.75 * i_tsm * i_tsm * 5e-3, limit(s, "i2t"));
  AT_MOST(s, 5 * limit(s, "i_t_rms"), i_tsm);
  AT_MOST(s, given(s, "param", "triac_holding_current"),
          given(s, "param", "triac_latching_current"));
  AT_MOST(s, limit(s, "dv_dt"), given(s, "param", "triac_critical_dvdt"));
  heat(s, limit(s, "t_j_max") - 25, given(s, "param", "triac_on_voltage"),
       1e-3 * given(s, "param", "triac_on_resistance"));
}

/* The disc and the class that the name of a varistor says, S20K275. A disc bears as much as the
 * maker says of its size, and a larger one more. The least voltage at 1 mA, 10 % less than the
 * nominal one, is not below the peak of the alternating voltage by more than 2 %: sheets round it.
 */
static void varistor(const sheet *s) {
  static const struct {
    int disc;
    double p_max, i_surge;
  } DISCS[] = {{5, 0.1, 400}, {7, 0.25, 1200}, {10, 0.4, 2500}, {14, 0.6, 4500}, {20, 1, 8000}};
  int disc = 0, volts = 0;
  size_t d = 0;
  EXPECT(sscanf(s->name, "S%dK%d", &disc, &volts) == 2, "%s", s->name);
  while (d + 1 < COUNT(DISCS) && DISCS[d].disc != disc) d++;
  EXPECT(DISCS[d].disc == disc && limit(s, "p_max") == DISCS[d].p_max &&
             limit(s, "i_surge") == DISCS[d].i_surge && limit(s, "v_rms") == volts,
         "%s", s->name);
  AT_MOST(s, 1.2 * limit(s, "v_rms"), limit(s, "v_dc"));
  AT_MOST(s, limit(s, "v_dc"), 0.9 * limit(s, "v_varistor"));
  AT_MOST(s, 0.98 * M_SQRT2 * limit(s, "v_rms"), 0.9 * limit(s, "v_varistor"));
  AT_MOST(s, 1.1 * limit(s, "v_varistor"), limit(s, "v_clamp"));
  /* 2 ms at the clamping voltage take less current than the surge of 20 us */
  AT_MOST(s, limit(s, "energy") / (2e-3 * limit(s, "v_clamp")), limit(s, "i_surge"));
}

/* The time-current curve falls from 10 ms to half an hour at least. At none of its points, but for
 * what is assumed, has the fuse had less than its melting I2t less 15 %: nothing melts on less.
 * 1 %: the figures are rounded. */
static void fuse(const sheet *s) {
  double last_s = 0, last_a = INFINITY;
  const double melting = limit(s, "i2t_melt");
  for (size_t k = 0; k < s->part.source.count; k++) {
    double t, i;
    if (sscanf(s->part.source.line[k], "*$ time_current %lf s %lf A", &t, &i) != 2) continue;
    EXPECT(t > last_s && i < last_a, "%s: %s", s->name, s->part.source.line[k]);
    AT_MOST(s, 0.99 * 0.85 * melting, i * i * t);
    EXPECT(last_s > 0 || t == 0.01, "%s: begins at %g s", s->name, t);
    last_s = t;
    last_a = i;
  }
  AT_MOST(s, 1800, last_s);
  AT_MOST(s, 1.2 * limit(s, "i_rated"), last_a);
  AT_MOST(s, last_a, limit(s, "i_fusing"));
  if (!isnan(limit(s, "i2t_clear"))) AT_MOST(s, melting, limit(s, "i2t_clear"));
  AT_MOST(s, M_SQRT2 * limit(s, "v_rated"), limit(s, "v_arc"));
}

/* Fuses of one series: the larger one bears more. */
static void fuses_grow(void) {
  rows all = rows_of("/fuses.tab");
  double last_a = 0, last_melting = 0;
  for (size_t k = 0; k < all.count; k++) {
    char path[VS_PATH_SIZE];
    vs_error err = {0};
    sheet s = {.name = all.name[k]};
    snprintf(path, sizeof path, PARTS "/fuses.tab#%s", all.name[k]);
    EXPECT(!vs_catalogue_read(path, &s.part, &err), "%s", err.text);
    bool same = k > 0 && !strncmp(all.name[k], all.name[k - 1], strcspn(all.name[k], "-123456789"));
    EXPECT(!same || (limit(&s, "i_rated") > last_a && limit(&s, "i2t_melt") > last_melting),
           "%s: %g A, %g A2s", all.name[k], limit(&s, "i_rated"), limit(&s, "i2t_melt"));
    last_a = limit(&s, "i_rated");
    last_melting = limit(&s, "i2t_melt");
    vs_catalogue_free(&s.part);
  }
  free_rows(&all);
}

/* What is left of the power falls with the ambient temperature, is all at 70 degC, nothing in the
 * end; the voltage class is no more than the rated power allows at the largest resistance. */
static void resistor(const sheet *s) {
  double last_degc = 0, last = INFINITY, at_70 = NAN;
  for (size_t k = 0; k < s->part.source.count; k++) {
    double degc, left;
    if (sscanf(s->part.source.line[k], "*$ derate p_rated %lf degC %lf %%", &degc, &left) != 2)
      continue;
    EXPECT(degc > last_degc && left < last, "%s: %s", s->name, s->part.source.line[k]);
    if (degc == 70) at_70 = left;
    last_degc = degc;
    last = left;
  }
  EXPECT(at_70 == 100 && last == 0, "%s: %g, %g", s->name, at_70, last);
  const double r_most = 1e3 * limit(s, "r_most"), v = limit(s, "v_class");
  AT_MOST(s, limit(s, "r_least"), 1);
  AT_MOST(s, 1e3, r_most);
  if (!isnan(v)) AT_MOST(s, v * v, limit(s, "p_rated") * r_most);
  /* a pulse of 10 ms is more than the rated power for as long */
  AT_MOST(s, 0.01 * limit(s, "p_rated"), limit(s, "e_pulse"));
}

/* The rms voltage that the class allows; the rms current makes less heat than 2 W in the ESR, and
 * no more current than the steepest rise, for ever. */
static void capacitor(const sheet *s) {
  AT_MOST(s, M_SQRT2 * limit(s, "v_rms"), limit(s, "v_class"));
  AT_MOST(s, limit(s, "i_rms_max"), limit(s, "c_rated") * 1e-3 * limit(s, "dv_dt_max"));
}

static void sound(void) {
  each_row("/thyristors.tab", thyristor);
  each_row("/triacs.tab", triac);
  each_row("/varistors.tab", varistor);
  each_row("/fuses.tab", fuse);
  each_row("/resistors.tab", resistor);
  each_row("/capacitors.tab", capacitor);
  fuses_grow();
}

/* ---- a table of one's own ---- */

static const char TABLE[] = "* discs of a user's\n"
                            "*$ part   varistor \"own @NAME@\"\n"
                            "*$ limit  v_rms = @v@ V @v?@ \"continuous\"\n"
                            "*$ limit  energy = @e@ J @e?@\n"
                            ".include varistor_law.inc\n"
                            ".subckt @SUBCKT@ a b\n"
                            "X1 a b varistor_law v_1ma=@v_1ma@ alpha=30 c_par=500p\n"
                            ".ends @SUBCKT@\n"
                            "*$ rows NAME   v     e   v_1ma\n"
                            "        One    510?  10  820\n"
                            "        Two    460   -   750\n";

#define RUN                                                                                        \
  "run paper --tier circuit --set circuit.deck=halfwave_paper --set run.until=12ms --quiet --set " \
  "circuit.varistor_1="

/* A row and the file that it would be: the same curves, the same limits. */
static void as_a_file(void) {
  write_file("own.tab", TABLE);
  write_file("one.inc", "*$ part   varistor \"own One\"\n"
                        "*$ limit  v_rms = 510 V assumed \"continuous\"\n*$ limit  energy = 10 J\n"
                        ".include varistor_law.inc\n.subckt one a b\n"
                        "X1 a b varistor_law v_1ma=820 alpha=30 c_par=500p\n.ends one\n");
  ran r = run(RUN "own.tab#One -o row"), f = run(RUN "one.inc -o file");
  EXPECT(r.status == f.status && r.status != 2, "%d %d: %s", r.status, f.status, r.err);
  char *a = read_file("row/run.csv"), *b = read_file("file/run.csv");
  EXPECT(*a && !strcmp(a, b), "run.csv of the row is another");
  free(a);
  free(b);
  free_ran(&r);
  free_ran(&f);
  r = run("check own.tab#One --json");
  f = run("check one.inc --json");
  expect_good(&r, "row", __LINE__);
  CLOSE(number_of(r.out, "V", 0, "got"), number_of(f.out, "V", 0, "got"), 1e-12);
  free_ran(&r);
  free_ran(&f);
  RUN_GOOD("export paper --set circuit.deck=halfwave_paper --set circuit.varistor_1=own.tab#One -o "
           "x.cir");
  a = read_file("x.cir");
  EXPECT(strstr(a, ".subckt one a b"), "the row's subcircuit is not exported");
  free(a);
}

/* A cell '-' leaves the line out: no limit of that name. */
static void nothing_said(void) {
  write_file("own.tab", TABLE);
  ran r = run("check own.tab#Two");
  expect_good(&r, "Two", __LINE__);
  EXPECT(strstr(r.out, "own Two; 1 limits"), "%s", r.out);
  free_ran(&r);
}

static void replace(const char *old, const char *new) {
  write_file("own.tab", TABLE);
  alter("own.tab", "own.tab", old, new);
}

/* Each mistake is named with its place in the table: of the cell, where a cell is wrong. */
static void mistakes(void) {
  static const struct {
    const char *old, *new, *part, *says[2];
  } ROWS[] = {
      {"510?  10", "5x0?  10", "One", {"own.tab:10:16: v: a number is wanted", "'5x0?'"}},
      {"510?  10",
       "-510? 10",
       "One",
       {"own.tab:10:16: limit v_rms: a positive number", "'-510 V'"}},
      {"10  820", "10     ", "One", {"own.tab:10:9: One has 3 cells", "has 4 columns"}},
      {"10  820", "10  820 7", "One", {"own.tab:10:30: One has 5 cells", "has 4 columns"}},
      {"-   750", "-   -  ", "Two", {"own.tab:11:26: v_1ma: a number is wanted", "model"}},
      {"Two    460", "One    460", "One", {"own.tab:11:9: One stands here a second", "line 10"}},
      {"e   v_1ma", "f   v_1ma", "One", {"own.tab:4:21: the line 'rows' has no column 'e'", ""}},
      {"e   v_1ma", "v   v_1ma", "One", {"own.tab:9:22: column v stands here a second", ""}},
      {"rows NAME", "rows PART", "One", {"own.tab:9:", "'rows NAME COLUMN...' is wanted here"}},
      {"*$ rows", "* rows", "One", {"own.tab: has no line '*$ rows NAME COLUMN...'", ""}},
      {"Two    460", "T.o    460", "T.o", {"own.tab:11:9: 'T.o' is no name of a part", ""}},
      {"Two", "Two", "Tow", {"own.tab: has no row 'Tow'; did you mean 'Two'?", ""}},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    replace(ROWS[k].old, ROWS[k].new);
    ran r = run("check own.tab#%s", ROWS[k].part);
    EXPECT(r.status == 2 && strstr(r.err, ROWS[k].says[0]) && strstr(r.err, ROWS[k].says[1]),
           "%s: %d: %s%s", ROWS[k].new, r.status, r.err, r.out);
    free_ran(&r);
  }
}

/* A name that is none is answered with what may have been meant, of files and of rows. */
static void near_names(void) {
  ran r = run("run paper --tier circuit --set circuit.deck=halfwave_paper --set "
              "circuit.varistor_1=S14K27");
  EXPECT(r.status == 2 && strstr(r.err, "no part 'S14K27': not a file, and not a part that comes "
                                        "with the program; did you mean 'S14K275'?"),
         "%d: %s", r.status, r.err);
  free_ran(&r);
  r = run("run paper --tier circuit --set circuit.deck=halfwave_paper --set "
          "circuit.varistor_1=FWX-10A14F");
  EXPECT(r.status == 2 && strstr(r.err, "of kind fuse, and varistor is wanted"), "%d: %s", r.status,
         r.err);
  free_ran(&r);
}

/* One that begins otherwise is of another family: a resistor AC03 is no transistor. */
static void other_families(void) {
  ran r = run("run relay --set circuit.switch=BC337");
  EXPECT(r.status == 2 && strstr(r.err, "no part 'BC337'") && !strstr(r.err, "did you mean"),
         "%d: %s", r.status, r.err);
  free_ran(&r);
}

/* A file of one's own is named with its ending, and in a --set also with its folder, unless that is
 * where the program runs. The message says what to write, and that works. */
static void own_file(void) {
  static const struct {
    const char *scene, *name, *write;
  } ROWS[] = {{"own.yaml", "ZZ9", "ZZ9.inc"},
              {"there/own.yaml", "ZZ9", "ZZ9.inc"},
              {"there/own.yaml", "ZZ8", "there/ZZ8.inc"},
              {"there/own.yaml", "ZZ8.inc", "there/ZZ8.inc"}};
  static const char SCENE[] = "circuit: {deck: halfwave_paper}\nrun: {until: 0.1 ms}\n";
  char says[160];
  CU_ASSERT(!mkdir("there", 0777));
  write_file("own.yaml", SCENE);
  write_file("there/own.yaml", SCENE);
  RUN_GOOD("part varistor -o ZZ9.inc");
  RUN_GOOD("part varistor -o there/ZZ8.inc");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("check %s --set circuit.varistor_1=%s", ROWS[k].scene, ROWS[k].name);
    snprintf(says, sizeof says,
             "no part '%s' comes with the program; the file %s is there: write "
             "%s\n",
             ROWS[k].name, ROWS[k].write, ROWS[k].write);
    EXPECT(r.status == 2 && strstr(r.err, says), "%d: %s", r.status, r.err);
    free_ran(&r);
    r = run("check %s --set circuit.varistor_1=%s", ROWS[k].scene, ROWS[k].write);
    EXPECT(r.status == 0, "%d: %s", r.status, r.err);
    free_ran(&r);
  }
}

/* The sum of a row is the same whatever the other rows say, and another when it changes itself, or
 * the law does. */
static void sum_of(const char *part, char sum[VS_HASH_TEXT]) {
  vs_error err = {0};
  EXPECT(!vs_catalogue_hash(part, sum, &err), "%s", err.text);
}

static void identities(void) {
  char before[VS_HASH_TEXT] = "", after[VS_HASH_TEXT] = "";
  write_file("own.tab", TABLE);
  sum_of("own.tab#One", before);
  replace("460   -", "461   8");
  sum_of("own.tab#One", after);
  EXPECT(!strcmp(before, after), "another row has changed it");
  replace("10  820", "11  820");
  sum_of("own.tab#One", after);
  EXPECT(strcmp(before, after), "its own cell has not changed it");
  replace("alpha=30", "alpha=31");
  sum_of("own.tab#One", after);
  EXPECT(strcmp(before, after), "the law has not changed it");
}

/* A scene does not read a table outside of its folder, not by a link either. */
static void jailed(void) {
  write_file("../outside.tab", TABLE);
  write_file("far.yaml", "circuit: {deck: halfwave_paper, varistor_1: ../outside.tab#One}\n");
  ran r = run("check far.yaml");
  EXPECT(r.status == 2 && strstr(r.err, "is not read"), "%d: %s", r.status, r.err);
  free_ran(&r);
  EXPECT(!symlink("../outside.tab", "link.tab"), "no link");
  write_file("far.yaml", "circuit: {deck: halfwave_paper, varistor_1: link.tab#One}\n");
  r = run("check far.yaml");
  EXPECT(r.status == 2 && strstr(r.err, "is not read"), "%d: %s", r.status, r.err);
  free_ran(&r);
}

/* ---- import ---- */

/* A subcircuit that the netlist does not define is the row of that name. */
static void imported(void) {
  write_file("net.net", "* from elsewhere\nV1 n1 0 SINE(0 325 50)\nX1 n1 0 S20K275\nX2 n1 n2 g "
                        "BT152-800R\nVg g n2 PULSE(0 2 5m 1u 1u 8m 20m)\nL1 n2 n3 1.6\nR1 n3 0 "
                        "92\n.tran 0.1\n.end\n");
  ran r = run("import net.net -o net.cir");
  char *deck = read_file("net.cir");
  EXPECT(r.status == 0 && strstr(deck, "S20K275 part varistor") &&
             strstr(deck, "BT152-800R part thyristor"),
         "%d: %s%s", r.status, r.err, deck);
  free(deck);
  free_ran(&r);
}

#define SHORTED(fuse) "events: {short: {kind: coil_short, at: 42 ms}}\nexpect: [" fuse " opens]\n"

/* ---- series of resistors and capacitors ---- */

/* circuit.r1_part gives R1 of the deck the limits of a series; without that key there is none. */
static void series(void) {
  write_file("s.yaml", "circuit: {deck: halfwave_paper, c1_part: MKP-1000V-100N, r1_part: PR02}\n"
                       "run: {until: 2 ms}\n");
  ran r = run("run s.yaml --json --quiet");
  EXPECT(r.status == 0 && strstr(r.out, "\"c1.v_peak\"") && strstr(r.out, "\"r1_part\""),
         "%d: %s%s", r.status, r.err, r.out);
  free_ran(&r);
  r = run("check s.yaml --set circuit.r1_part=none");
  EXPECT(r.status == 0, "%s", r.err);
  free_ran(&r);
  r = run("check s.yaml --set circuit.r1_part=");
  EXPECT(r.status == 2 && strstr(r.err, "circuit.r1_part: a part is wanted, or none"), "%s", r.err);
  free_ran(&r);
  write_file("s.yaml", "circuit: {deck: halfwave_paper, r1_part: MKP-1000V-100N}\n");
  r = run("check s.yaml");
  EXPECT(r.status == 2 && strstr(r.err, "s.yaml:1:42: circuit.r1_part: mkp-1000v-100n is a part of "
                                        "kind capacitor, and resistor is wanted"),
         "%d: %s", r.status, r.err);
  free_ran(&r);
  write_file("s.yaml", "circuit: {deck: halfwave_paper, r9_part: PR02}\n");
  r = run("check s.yaml");
  EXPECT(r.status == 2 && strstr(r.err, "s.yaml:1:33: "), "%d: %s", r.status, r.err);
  free_ran(&r);
}

/* A value that the series has not is told with what it has, wherever the value stands: as the
 * scene's key, as the deck's default, of a device that shares a parameter, as a number in the
 * netlist. */
static void series_range(void) {
  static const struct {
    const char *circuit, *says;
  } ROWS[] = {
      {"deck: halfwave_paper, r1: 900 kohm, r1_part: AC03",
       "circuit.r1_part: ac03 is made from 0.1 ohm to 5.1 kohm, and r1 is 900 kohm"},
      {"deck: own.cir, r8_part: PR02",
       "circuit.r8_part: pr02 is made from 0.33 ohm to 1000 kohm, and r8 is 0.05 ohm"},
      {"deck: halfwave_paper, c1_part: X2-470N",
       "circuit.c1_part: x2-470n has 470 nF, and c1 is 100 nF; a part of that value is wanted"},
      {"deck: chopper, c_snubber_part: X2-470N",
       "circuit.c_snubber_part: x2-470n has 470 nF, and c_snubber is 1 nF"},
      {"deck: bridge_halfcontrolled, r1: 8 kohm, r1_t1_part: AC03",
       "circuit.r1_t1_part: ac03 is made from 0.1 ohm to 5.1 kohm, and r1_t1 is 8 kohm"},
      {"deck: own.cir, r7_part: AC03",
       "circuit.r7_part: ac03 is made from 0.1 ohm to 5.1 kohm, and r7 is 6.2 kohm"},
      {"deck: halfwave_paper, r1: 5.1 kohm, r1_part: AC03", NULL},
      {"deck: halfwave_paper, c1: 119 nF, c1_part: MKP-1000V-100N", NULL},
      {"deck: halfwave_paper, c1: 121 nF, c1_part: MKP-1000V-100N", "has 100 nF, and c1 is 121 nF"},
  };
  write_file("own.cir", "* own\n*$ port mains = Vm\n*$ probe v_ak = v(a) V\n"
                        "*$ device r7 resistor = v(b), v(b)/6200\n"
                        "*$ device r8 resistor = v(a,b), v(a,b)/50m\n"
                        "Vm m 0 external\nRs m a 1\nR8 a b 50m\nR7 b 0 6.2k\nXeva a 0 eva\n");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text scene = {0};
    vs_text_add(&scene, "circuit: {%s}\n", ROWS[k].circuit);
    write_file("s.yaml", scene.text);
    vs_text_free(&scene);
    ran r = run("check s.yaml");
    EXPECT(r.status == 0, "%s: %d: %s", ROWS[k].circuit, r.status, r.err);
    if (ROWS[k].says)
      EXPECT(strstr(r.err, "s.yaml:1:") && strstr(r.err, ROWS[k].says), "%s: %s", ROWS[k].circuit,
             r.err);
    else
      EXPECT(!strstr(r.err, "_part"), "%s: %s", ROWS[k].circuit, r.err);
    free_ran(&r);
  }
}

/* The rated power of a series goes by the scene's ambient temperature. 1e-3: it is told with four
 * digits. The resistor stands alone at the mains, as a mean is judged from a second on. */
static void series_warm(void) {
  static const struct {
    const char *part;
    int ambient;
    double p_rated;
  } ROWS[] = {{"PR02", 25, 2}, {"PR02", 70, 2},    {"PR02", 120, 2.0 * 35 / 85},
              {"AC03", 25, 3}, {"AC03", 55, 2.75}, {"AC03", 100, 2.5 * 100 / 130}};
  write_file("alone.cir", "*$ port mains = Vm\n*$ probe v_ak = v(a) V\n"
                          "*$ device r1 resistor = v(b), v(b)/5000\n"
                          "Vm m 0 external\nRs m a 1\nRa a b 1k\nR1 b 0 5k\nXeva b 0 eva\n");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("run paper --set circuit.deck=alone.cir --set circuit.r1_part=%s --set "
                "ambient=%ddegC --set run.until=1.02s --set run.tolerance=1e-2 --set "
                "run.verify=never --json --quiet",
                ROWS[k].part, ROWS[k].ambient);
    const char *line = strstr(r.out, "\"device\": \"r1\", \"measure\": \"power\""),
               *at = line ? strstr(line, "\"limit\": ") : NULL;
    EXPECT(at, "%d: %s%s", r.status, r.err, r.out);
    if (at) CLOSE(strtod(at + strlen("\"limit\": "), NULL), ROWS[k].p_rated, 1e-3);
    free_ran(&r);
  }
}

/* A fuse of the table is held to its own time-current curve: the verdict has the line, and what the
 * part does not say elsewhere is not needed. */
static void fuse_curve(void) {
  static const struct {
    const char *fuse;
    bool assumed;
  } ROWS[] = {{"LF213-3A15", false}, {"S505-8-R", false}, {"FWX-10A14F", true}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("run paper --set circuit.deck=halfwave_paper --set circuit.fuse_1=%s --set "
                "run.until=60ms --set run.verify=never --json --quiet",
                ROWS[k].fuse);
    const char *line = strstr(r.out, "\"device\": \"fuse_1\", \"measure\": \"i_overload\""),
               *end = line ? strchr(line, '}') : NULL,
               *assumed = line ? strstr(line, "\"assumed\": ") : NULL;
    EXPECT(end && assumed && assumed < end &&
               !strncmp(assumed + strlen("\"assumed\": "), "true", 4) == ROWS[k].assumed,
           "%s: %s%s", ROWS[k].fuse, r.err, r.out);
    free_ran(&r);
  }
}

/* A short of the coil melts S505-1-R. On the 440 V side that is more than its 250 V, which the
 * verdict names; on the 230 V side it is not. A fuse for 250 V on mains of 252 V has those to keep
 * off, although the line's resistance leaves 246 V across it. A fuse of 3.15 A that carries 5.5 A
 * for a second, into a resistor, is told, too. */
static void fuses_tell(void) {
  static const struct {
    const char *circuit, *rest, *line;
    bool held;
    int supply_v;
  } ROWS[] = {
      {"triac_feeder", SHORTED("fuse_1") "run: {until: 60 ms, method: gear}\n", "fuse_1.v_open",
       false, 252},
      {"halfwave_paper, transformer: autotransformer_ideal, fuse_2: S505-1-R",
       SHORTED("fuse_2") "run: {until: 60 ms}\n", "fuse_2.v_open", false, 440},
      {"halfwave_paper, transformer: autotransformer_ideal, fuse_1: S505-1-R, fuse_2: A070gRB10T13",
       SHORTED("fuse_1") "run: {until: 60 ms}\n", "fuse_1.v_open", true, 440},
      {"fed.cir", "run: {until: 1.02 s, tolerance: 1e-2}\n", "fuse_1.i_rms", false, 440}};
  write_file("fed.cir",
             "*$ param fuse_1 = LF213-3A15 part fuse\n*$ port mains = Vm\n"
             "*$ probe v_ak = v(a) V\n*$ device fuse_1 = v(a,f), i(Vf)\n"
             "Vm m 0 external\nRs m a 1\nVf a f0 0\nXf f0 f fuse_1\nRf f 0 80\nRl f b 10k\n"
             "Xeva b 0 eva\n");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text scene = {0}, key = {0};
    vs_text_add(&scene,
                "machine: {model: two_mass, spring: 5e6 N/m}\nactuator: {inductance: 0.2 H}\n"
                "supply: {voltage: %d V}\n"
                "firing: {angle: 95 deg, every: 1}\ncircuit: {deck: %s}\n%s",
                ROWS[k].supply_v, ROWS[k].circuit, ROWS[k].rest);
    write_file("f.yaml", scene.text);
    ran r = run("run f.yaml");
    vs_text_add(&key, "\n  %s ", ROWS[k].line);
    const char *at = strstr(r.out, key.text), *end = at ? strchr(at + 1, '\n') : NULL,
               *word = at ? strstr(at, ROWS[k].held ? "  held" : "  violated") : NULL;
    EXPECT(end && word && word < end && (ROWS[k].held || r.status == 3), "%s: %d: %s%s",
           ROWS[k].line, r.status, r.err, r.out);
    free_ran(&r);
    vs_text_free(&scene);
    vs_text_free(&key);
  }
}

static const vs_test TESTS[] = {{"sound", sound},
                                {"series range", series_range},
                                {"series warm", series_warm},
                                {"fuse curve", fuse_curve},
                                {"fuses tell", fuses_tell},
                                {"listed", listed},
                                {"discs", discs},
                                {"tried", tried},
                                {"files beside their sheets", files_beside_their_sheets},
                                {"each runs", each_runs},
                                {"as a file", as_a_file},
                                {"nothing said", nothing_said},
                                {"mistakes", mistakes},
                                {"near names", near_names},
                                {"other families", other_families},
                                {"own file", own_file},
                                {"identities", identities},
                                {"jailed", jailed},
                                {"imported", imported},
                                {"series", series}};

int main(void) {
  return program_suite("part tables", TESTS, COUNT(TESTS));
}
