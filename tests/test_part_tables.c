/* SPDX-License-Identifier: GPL-3.0-or-later
 * Parts that stand in tables (src/catalogue): what ships is listed, tried and runs; a row is the
 * same as a file of its own; what is wrong in a table is named by its place; a study's cases depend
 * on the row that they use alone; a resistor of a deck takes the limits of a series. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"
#include "catalogue/catalogue.h"
#include "deck/deck.h"
#include "part_rows.h"
#include "stand/stand.h"

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
                {"/resistors.tab", "resistor", 6},    {"/capacitors.tab", "capacitor", 12}};
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

/* What the part says of its model beside its sheet is what the test stand finds: to the half per
 * cent that it is rounded by, and the step of a search. */
static void beside_the_sheet(const char *name) {
  char path[VS_PATH_SIZE];
  vs_stand *s = vs_alloc(1, sizeof *s);
  vs_error err = {0};
  ran r = run("check %s --json", name);
  EXPECT(vs_catalogue_shipped(&vs_deck_parts_shelf, name, path) && !vs_stand_open(path, s, &err),
         "%s: %s", name, err.text);
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

/* What the model of each does is what its row asks. All rows with VS_LONG: a thyristor takes 2 s, a
 * triac 3 s. */
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
      if (!wanted) continue;
      ran r = run("check %s", all.name[k]);
      EXPECT(r.status == 0 && !strstr(r.out, " off ") && !strstr(r.out, " failed ") &&
                 strstr(r.out, "\nfigure "),
             "%s: %d: %s%s", all.name[k], r.status, r.out, r.err);
      free_ran(&r);
      beside_the_sheet(all.name[k]);
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

/* A file of one's own is named with its ending. */
static void own_file(void) {
  RUN_GOOD("part varistor -o ZZ9.inc");
  ran r = run("run paper --tier circuit --set circuit.deck=halfwave_paper --set "
              "circuit.varistor_1=ZZ9");
  EXPECT(r.status == 2 && strstr(r.err, "did you mean 'ZZ9.inc'?"), "%d: %s", r.status, r.err);
  free_ran(&r);
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

/* ---- series of resistors and capacitors ---- */

/* circuit.r1_part gives R1 of the deck the limits of a series; without that key there is none. */
static void series(void) {
  write_file("s.yaml", "circuit: {deck: halfwave_paper, c1_part: MKP-1000V-100N, r1_part: PR02}\n"
                       "run: {until: 2 ms}\n");
  ran r = run("run s.yaml --json --quiet");
  EXPECT(r.status == 0 && strstr(r.out, "\"c1.v_peak\"") && strstr(r.out, "\"r1_part\""),
         "%d: %s%s", r.status, r.err, r.out);
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

static const vs_test TESTS[] = {{"listed", listed},
                                {"discs", discs},
                                {"tried", tried},
                                {"files beside their sheets", files_beside_their_sheets},
                                {"each runs", each_runs},
                                {"as a file", as_a_file},
                                {"nothing said", nothing_said},
                                {"mistakes", mistakes},
                                {"near names", near_names},
                                {"own file", own_file},
                                {"identities", identities},
                                {"jailed", jailed},
                                {"imported", imported},
                                {"series", series}};

int main(void) {
  return program_suite("part tables", TESTS, COUNT(TESTS));
}
