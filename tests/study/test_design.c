/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `design`, against all candidates run with all cases by `study`; its files; its ends.
 * The deck is a resistor that a gate switches, in series with the one that is chosen, so that a run
 * takes some 30 ms. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/csv.h"
#include "base/text.h"
#include "program.h"
#include "study/price_list.h"
#include "suite.h"

static const char PART[] =
    "*$ part thyristor \"a resistor that its gate switches\"\n"
    "*$ limit v_drm = %d V\n*$ limit v_rrm = %d V\n*$ limit i_t_rms = 12 A typical\n"
    ".subckt g%d a k g\nRg g k 1k\nBk a k I=v(a,k)*v(g,k)*20m\n.ends g%d\n";
static const char DECK[] =
    "*$ param thyristor = g600.inc part thyristor\n*$ param r1 = 100 ohm 1..1e5\n"
    "*$ port mains = Vm\n*$ port gate = Vg\n*$ probe v_ak = v(a,b) V\n"
    "*$ device thyristor = v(a,b), i(Vt)\n*$ device r1 resistor = v(m,a), v(m,a)/{r1}\n"
    "Vm m 0 external\nR1 m a {r1}\nVg g b external\nVt a t 0\nXt t b g thyristor\n"
    "Rb b 0 1k\nXeva b 0 eva\n";
static const char SCENE[] =
    "circuit: {deck: d.cir, r1: 100 ohm}\nfiring: {every: 1, angle: 90 deg}\nsupply: {voltage: 440 "
    "V}\n"
    "run: {until: 50 ms}\n"
    "waive: [thyristor.t_off, thyristor.dv_dt, thyristor.di_dt, thyristor.i_surge, "
    "thyristor.i2t]\n";

static const int VOLTS[] = {600, 800, 1000, 1200};
static const double PART_PRICE[] = {0.5, 0.8, 1.3, 1.6};
static const double POWER[] = {1, 10, 50, 900}, POWER_PRICE[] = {0.1, 0.6, 2, 9};
static const char SIZES[] = "part,kind,price,size_cm3,p_rated_w\ng600.inc,thyristor,0.5,4,\n"
                            "g800.inc,thyristor,0.8,3,\ng1000.inc,thyristor,1.3,2,\n"
                            "g1200.inc,thyristor,1.6,1,\nR1,resistor,0.1,1,1\nR10,resistor,0.6,2,10"
                            "\nR50,resistor,2,9,50\nR900,resistor,9,90,900\n";

/* 4 parts, 5 values of E3; six cases with the threats below. */
static const char CHOOSE[] =
    "scene: s.yaml\nreport: [i_peak]\ncatalogue:\n  prices: p.csv\n  choose:"
    "\n    circuit.thyristor: {kind: thyristor%s}\n    circuit.r1: {kind: "
    "resistor, series: E3, from: 10 ohm, to: 220 ohm}\n%s";

static void write_world(void) {
  char text[1024], name[32];
  for (size_t k = 0; k < COUNT(VOLTS); k++) {
    snprintf(text, sizeof text, PART, VOLTS[k], VOLTS[k], VOLTS[k], VOLTS[k]);
    snprintf(name, sizeof name, "g%d.inc", VOLTS[k]);
    write_file(name, text);
  }
  write_file("d.cir", DECK);
  write_file("s.yaml", SCENE);
  write_file("p.csv", SIZES);
}

/* The design, with the parts that may be chosen and what stands behind the choices. */
static void write_design(const char *parts, const char *more) {
  char text[2048];
  snprintf(text, sizeof text, CHOOSE, parts, more);
  write_file("d.yaml", text);
}

static const char *threats(int most) {
  static char text[512];
  snprintf(text, sizeof text,
           "threats:\n  swell: {kind: swell, level: [110 %%, 120 %%, 130 %%, %d "
           "%%], duration: 20 ms}\n  dip: {kind: sag, level: 40 %%, duration: "
           "20 ms}\n",
           most);
  return text;
}

static void expect_end(ran *r, int status, const char *says) {
  EXPECT(r->status == status &&
             strstr(says && *says == '!' ? r->err : r->out, says ? says + (*says == '!') : ""),
         "%d, want %d with '%s': %s%s", r->status, status, says ? says : "", r->out, r->err);
  free_ran(r);
}

/* ---- brute force ---- */

enum { COLUMNS = 512 };

/* Reads study.csv of all candidates with all cases: fails[part][value], the largest power there. */
typedef struct brute {
  bool fails[4][16];
  double power[4][16];
  double value[16];
  size_t values, runs;
} brute;

static size_t column_of(char **names, size_t n, const char *name) {
  for (size_t k = 0; k < n; k++)
    if (!strcmp(names[k], name)) return k;
  EXPECT(false, "no column %s", name);
  return 0;
}

static brute run_all(int most) {
  brute b = {.values = 0};
  char *text, *names[COLUMNS], *cells[COLUMNS], study[1024];
  snprintf(study, sizeof study,
           "scene: s.yaml\nreport: [r1.power]\n%svary:\n  circuit.thyristor: [g600.inc, g800.inc, "
           "g1000.inc, g1200.inc]\n  circuit.r1: [10 ohm, 22 ohm, 47 ohm, 100 ohm, 220 ohm]\n",
           threats(most));
  write_file("all.yaml", study);
  ran r = run("study all.yaml -o all --quiet --overwrite");
  EXPECT(r.status == 3, "%d %s", r.status, r.err);
  free_ran(&r);
  text = read_file("all/study.csv");
  char *line = text, *end = strchr(line, '\n');
  *end = '\0';
  const size_t n = vs_csv_split(line, names, COLUMNS, NULL);
  const size_t part = column_of(names, n, "circuit.thyristor"),
               ohm = column_of(names, n, "circuit.r1_ohm"),
               watt = column_of(names, n, "r1.power_w"), status = column_of(names, n, "status");
  while (*(line = end + 1)) {
    end = strchr(line, '\n');
    *end = '\0';
    CU_ASSERT_EQUAL_FATAL(vs_csv_split(line, cells, COLUMNS, NULL), n);
    const int volts = atoi(cells[part] + 1);
    size_t p = 0, v = 0;
    while (VOLTS[p] != volts) p++;
    while (v < b.values && b.value[v] != atof(cells[ohm])) v++;
    if (v == b.values) b.value[b.values++] = atof(cells[ohm]);
    b.fails[p][v] |= atoi(cells[status]) != 0;
    b.power[p][v] = fmax(b.power[p][v], atof(cells[watt]));
    b.runs++;
  }
  free(text);
  return b;
}

/* The least price by the rows, with the cheapest class that has the house's margin. INFINITY:
 * nothing holds. */
static double cheapest(const brute *b, size_t parts, double house) {
  double least = INFINITY;
  for (size_t p = 0; p < parts; p++)
    for (size_t v = 0; v < b->values; v++)
      for (size_t c = 0; c < COUNT(POWER) && !b->fails[p][v]; c++)
        if (1 - b->power[p][v] / POWER[c] > house)
          least = fmin(least, PART_PRICE[p] + POWER_PRICE[c]);
  return least;
}

/* The same answer as all candidates with all cases have, and in fewer runs; once with an answer,
 * once without, once with dearer parts. */
static void equals_brute_force(void) {
  write_world();
  const brute b = run_all(140);
  EXPECT(b.runs == 4 * 5 * 6, "%zu", b.runs);
  write_design("", threats(140));
  ran r = run("design d.yaml -o a --jobs 2");
  expect_end(&r, 0, "cheapest that holds: price = ");
  char *json = read_file("a/design.json");
  const double want = cheapest(&b, 4, 0);
  EXPECT(fabs(number_in(json, "price") - want) < 1e-9, "%g, want %g", number_in(json, "price"),
         want);
  /* a fifth where a list is longer than six cases; here each candidate that is looked at costs a
   * sixth at least, and the neighbours of the answer are looked at, too */
  EXPECT(number_in(json, "runs") < 0.4 * (double)b.runs, "%g", number_in(json, "runs"));
  free(json);
  if (on_path("gnuplot")) {
    RUN_GOOD("plot a --quiet");
    char *page = read_file("a/report.html");
    EXPECT(strstr(page, "weakest case: threat = ") && strstr(page, "circuit.thyristor = g"),
           "%.3000s", page);
    free(page);
  }
  CU_ASSERT(isinf(cheapest(&b, 2, 0)));
  write_design(", parts: [g600.inc, g800.inc]", threats(140));
  r = run("design d.yaml -o none");
  expect_end(&r, 3,
             "!nothing in the catalogue holds: all 10 candidates, up to 9.8, violate a case");
  json = read_file("none/design.json");
  EXPECT(number_in(json, "lower_bound") == 9.8, "%s", json);
  free(json);
  char *page = read_file("none/design.txt");
  EXPECT(strstr(page, "nothing in the catalogue holds: all 10 candidates, up to 9.8, "), "%s",
         page);
  free(page);
  write_design("", "");
}

/* ---- what it writes ---- */

/* Each case that decides is a scene that ends as the design's own run did. */
static void cases_are_scenes(void) {
  const char *names[] = {"a/cases"};
  char *list = NULL;
  size_t seen = 0;
  for (int k = 0; k < 400; k++) {
    char path[64];
    snprintf(path, sizeof path, "%s/%d.yaml", names[0], k);
    if (access(path, F_OK)) continue;
    list = read_file(path);
    const char *says = strstr(list, "ends with status ");
    CU_ASSERT_FATAL(says != NULL);
    ran r = run("run %s --quiet", path);
    EXPECT(r.status == atoi(says + strlen("ends with status ")), "%s: %d", path, r.status);
    free_ran(&r);
    free(list);
    seen++;
  }
  EXPECT(seen >= 3, "%zu", seen);
}

static void files(void) {
  char *json = read_file("a/design.json"), *csv = read_file("a/design.csv"),
       *bom = read_file("a/bom.csv"), *page = read_file("a/design.txt");
  static const char *const MEMBERS[] = {"\"word\": \"proved\"",
                                        "\"one_size_smaller\": [",
                                        "\"part\": \"R1\", \"price\": ",
                                        "\"runner_up\": {",
                                        "\"proof\": [",
                                        "\"circuit.thyristor\": {\"chosen\": \"g1000.inc\"",
                                        "\"found_by\": \"list\""};
  for (size_t k = 0; k < COUNT(MEMBERS); k++)
    EXPECT(strstr(json, MEMBERS[k]), "%s in %s", MEMBERS[k], json);
  EXPECT(count_lines(csv) == 1 + (int)number_in(json, "looked_at"), "%d", count_lines(csv));
  EXPECT(!strncmp(csv, "candidate,price,circuit.thyristor,circuit.r1_ohm,verdict,killer,", 64),
         "%.80s", csv);
  EXPECT(!strncmp(bom,
                  "key,number,price_each,chosen,part,kind,price,size_cm3,p_rated_w\n"
                  "circuit.thyristor,1,1.3,g1000.inc,g1000.inc,thyristor,1.3,2,\n",
                  100),
         "%s", bom);
  EXPECT(count_lines(bom) == 3, "%s", bom);
  EXPECT(strstr(page, "g800.inc does not hold: thyristor.v_forward, margin -"), "%s", page);
  EXPECT(strstr(page, "1. List: the answer holds all 6 cases, each a run in ngspice. "), "%s",
         page);
  EXPECT(strstr(page, "3. Random: nothing was drawn."), "%s", page);
  EXPECT(strstr(page, " Typical limits, not guaranteed: thyristor.i_rms."), "%s", page);
  EXPECT(strstr(page, "+- "), "an error of a margin: %s", page);
  free(json);
  free(csv);
  free(bom);
  free(page);
}

static const char *const FILES[] = {"design.json", "design.csv", "bom.csv",
                                    "design.txt",  "study.csv",  "manifest.json"};

/* The same bytes with other workers, and of a design that goes on. */
static void same_bytes(void) {
  write_design("", threats(140));
  ran r = run("design d.yaml -o b --jobs 1 --quiet");
  expect_end(&r, 0, "");
  char *journal = read_file("b/journal");
  char *cut = journal;
  for (int k = 0; k < 30; k++) cut = strchr(cut, '\n') + 1;
  *cut = '\0';
  write_file("b/journal", journal);
  free(journal);
  unlink("b/manifest.json");
  unlink("b/study.csv");
  unlink("b/failures.csv");
  unlink("b/design.json");
  r = run("design d.yaml -o b --jobs 2 --quiet --resume");
  expect_end(&r, 0, "");
  for (size_t k = 0; k < COUNT(FILES); k++) {
    char path[2][64];
    snprintf(path[0], 64, "a/%s", FILES[k]);
    snprintf(path[1], 64, "b/%s", FILES[k]);
    char *one = read_file(path[0]), *other = read_file(path[1]);
    EXPECT(*one && !strcmp(one, other), "%s", FILES[k]);
    free(one);
    free(other);
  }
}

/* True if the journal has a case behind a later one, as where the later one was this process' own
 * and the other one came from another journal. */
static bool is_shared(const char *path) {
  char *text = read_file(path);
  int before = -1;
  bool shared = false;
  for (const char *at = text; (at = strstr(at, " = ")); at += 3) {
    shared = shared || atoi(at + 3) < before;
    before = atoi(at + 3);
  }
  free(text);
  return shared;
}

/* Each of three processes that share the runs has the whole answer, and none has run all. */
static void shards(void) {
  pid_t child[3];
  write_design("", threats(140));
  for (int k = 0; k < 3; k++) {
    char words[64];
    snprintf(words, sizeof words, "design d.yaml -o parts/%d --shard %d/3 --jobs 1", k, k + 1);
    child[k] = spawn_prepared(words, NULL, NULL);
  }
  for (int k = 0; k < 3; k++) {
    ran r = collect(child[k]);
    expect_end(&r, 0, "cheapest that holds: price = ");
    for (size_t n = 0; n < COUNT(FILES); n++) {
      char path[2][64];
      snprintf(path[0], 64, "a/%s", FILES[n]);
      snprintf(path[1], 64, "parts/%d/%s", k, FILES[n]);
      char *one = read_file(path[0]), *other = read_file(path[1]);
      EXPECT(*one && !strcmp(one, other), "%s", path[1]);
      free(one);
      free(other);
    }
  }
  CU_ASSERT(is_shared("parts/1/journal"));
  ran r = run("design d.yaml -o parts/4 --shard 4/3");
  expect_end(&r, 2, "!--shard 4/3: I/N is wanted");
}

/* ---- what it goes by ---- */

/* The house's margin is asked of the verdict's lines and of the list's; what is waived is printed;
 * any column is an aim. */
static void house(void) {
  char more[1024];
  snprintf(more, sizeof more, "%shold: {margin: 15 %%, thyristor.v_forward: 0.95}\n", threats(140));
  write_design("", more);
  ran r = run("design d.yaml -o house --overwrite");
  EXPECT(strstr(r.out, "is what is left beyond hold.margin, 15 % of the limit\n"), "%s", r.out);
  EXPECT(strstr(r.out, " Limits that hold changes: thyristor.v_forward times 0.95."), "%s", r.out);
  /* 440 V * sqrt(2) * 1.4 = 871 V is above 0.85 * 0.95 * 1000 V and below as much of 1200 V */
  expect_end(&r, 0, "circuit.thyristor     g1200.inc ");
  snprintf(more, sizeof more,
           "%shold: {waive: [thyristor.v_forward, thyristor.v_reverse, r1.power]}\n", threats(140));
  write_design("", more);
  r = run("design d.yaml -o waived --overwrite");
  EXPECT(strstr(r.out, "price = 0.6 of"), "%s", r.out);
  expect_end(&r, 0, "Waived by hold: thyristor.v_forward, thyristor.v_reverse, r1.power.");
  snprintf(more, sizeof more, "%saim: {least: size_cm3 + 0 * price}\n", threats(140));
  write_design("", more);
  r = run("design d.yaml -o small --overwrite");
  expect_end(&r, 0, "circuit.thyristor     g1200.inc ");
}

/* Of the range the list has one value, below 128.5 %, which 800 V hold. A draw behind the first 16,
 * which are asked for at a time, is above, and becomes a case. The next answer holds it and 60
 * fresh ones: those before do not count. */
static void draws_become_cases(void) {
  write_design("", "threats:\n  swell: {kind: swell, level: {from: 110 %, to: 129.2 %}, n: 1, "
                   "duration: 20 ms}\nproof: {random: 60, neighbours: false}\n");
  ran r = run("design d.yaml -o drawn --overwrite");
  EXPECT(strstr(r.out, "3. Random: 0 of 60 draws after the last change violate"), "%s", r.out);
  EXPECT(strstr(r.out, "no bound is claimed"), "%s", r.out);
  expect_end(&r, 0, "circuit.thyristor     g1000.inc ");
  char *json = read_file("drawn/design.json"), *csv = read_file("drawn/design.csv");
  EXPECT(number_in(json, "draws") > 16 + 60 && number_in(json, "list") > 2, "%s", json);
  EXPECT(strstr(csv, ",g800.inc,10,violated,swell: level 1"), "%s", csv);
  free(json);
  free(csv);
}

/* The list's sample of the level heats r1 to 3.009 W, which R3 bears; draws ask for R10. */
static void draws_ask_for_classes(void) {
  char text[1024];
  snprintf(text, sizeof text, "%sR3,resistor,0.2,1,3.02\n", SIZES);
  write_file("p.csv", text);
  write_design(
      ", parts: [g1200.inc]",
      "threats:\n  swell: {kind: swell, level: {from: 110 %, to: 131 %}, n: 1, duration: 20 "
      "ms}\nproof: {random: 20, verify: false}\n");
  ran r = run("design d.yaml -o classes --overwrite");
  EXPECT(strstr(r.out, "circuit.r1            as R3 does not hold: r1.power, margin -"), "%s",
         r.out);
  EXPECT(strstr(r.out, "3. Random: 0 of 20 draws after the last change violate"), "%s", r.out);
  expect_end(&r, 0, " (R10) ");
  write_file("p.csv", SIZES);
}

/* A draw makes 9.9 ohm dearer than 10 ohm, which then meets that case first: it takes two runs, for
 * budget.jobs, and not nine. */
static void what_made_dearer_is_first(void) {
  char text[1024], design[2048];
  snprintf(text, sizeof text, "%sR3,resistor,0.2,1,3.02\n", SIZES);
  write_file("p.csv", text);
  snprintf(text, sizeof text, "%s", CHOOSE);
  char *series = strstr(text, "series: ");
  strcpy(series, "values: [9.9 ohm, 10 ohm]}\n%s");
  snprintf(design, sizeof design, text, ", parts: [g1200.inc]",
           "threats:\n  swell: {kind: swell, level: {from: 110 %, to: 131 %}, n: 1, duration: 20 "
           "ms}\n  dip: {kind: sag, level: [40 %, 50 %, 60 %, 70 %, 80 %, 90 %], duration: 20 ms}\n"
           "proof: {random: 20, verify: false, neighbours: false}\n");
  write_file("d.yaml", design);
  ran r = run("design d.yaml -o dearer --overwrite");
  expect_end(&r, 0, "9.9 ohm (R10) ");
  char *csv = read_file("dearer/design.csv");
  EXPECT(strstr(csv, ",g1200.inc,10,open,,,,,,2\n"), "%s", csv);
  free(csv);
  write_file("p.csv", SIZES);
}

/* The list's only samples of the level lie below what 800 V hold; the search goes to the range's
 * end, where 1000 V hold: 440 V * sqrt(2) * 1.31 = 815 V. The worst found is told with how sure it
 * is. */
static void search_finds(void) {
  write_design("", "threats:\n  swell: {kind: swell, level: {from: 110 %, to: 131 %}, n: 1, "
                   "duration: 20 ms}\nproof: {search: {n: 24, restarts: 2}, random: 4, neighbours: "
                   "false}\n");
  ran r = run("design d.yaml -o searched --overwrite");
  EXPECT(strstr(r.out, "2. Ranges: the worst found, for each threat: +18.5 % +- "), "%s", r.out);
  EXPECT(strstr(r.out, " under swell: level 131 % (case "), "%s", r.out);
  EXPECT(strstr(r.out, "of 24 runs; of 2 restarts 1 came to this place and 1 to this value)"), "%s",
         r.out);
  expect_end(&r, 0, "circuit.thyristor     g1000.inc ");
  char *json = read_file("searched/design.json"), *csv = read_file("searched/design.csv");
  EXPECT(strstr(json, "\"found_by\": \"search\""), "%s", json);
  EXPECT(strstr(csv, ",g800.inc,10,violated,swell: level 1"), "%s", csv);
  free(json);
  free(csv);
}

/* A clamp that every candidate breaks is left out, whatever its own lines say then; so it is where
 * a threat opens it. The scene of such a case opens it, too. A waiver is printed with its reason.
 */
static void left_out(void) {
  char text[4096];
  snprintf(
      text, sizeof text, "%s%s", DECK,
      "*$ param clamp = k1.inc part varistor\n*$ device clamp = v(a,b), i(Vc)\nVc a c 0\nXc c b "
      "clamp\n");
  write_file("d.cir", text);
  write_file("k1.inc",
             "*$ part varistor \"a resistor\"\n*$ limit energy = 1 J\n*$ limit i_surge = 10 "
             "mA\n*$ limit p_max = 1 W\n.subckt k1 a b\nR a b 10k\n.ends k1\n");
  snprintf(text, sizeof text, "%sk1.inc,varistor,0.2,1,\n", SIZES);
  write_file("p.csv", text);
  write_design(
      "}\n    circuit.clamp: {kind: varistor, or: none",
      "threats:\n  swell: {kind: swell, level: 130 %, duration: 20 ms}\n  lost: {kind: "
      "open, element: Vc, from: start, criterion: B}\n  late: {kind: open, element: Vc, at: 12 ms, "
      "criterion: B}\nhold: {waive: [{line: "
      "thyristor.v_reverse, because: house rule 17}]}\nproof: {neighbours: false}\n");
  ran r = run("design d.yaml -o out --overwrite");
  EXPECT(strstr(r.out, "circuit.clamp         none                    1    0        -  "), "%s",
         r.out);
  EXPECT(strstr(r.out, "Waived by hold: thyristor.v_reverse (because: house rule 17)."), "%s",
         r.out);
  expect_end(&r, 0, "circuit.thyristor     g1000.inc ");
  char *csv = read_file("out/design.csv"), *bom = read_file("out/bom.csv");
  EXPECT(strstr(csv, ",g800.inc,k1.inc,10,violated,swell,clamp.i_peak,"), "%s", csv);
  EXPECT(!strstr(bom, "clamp"), "%s", bom);
  /* 1 % below its limit it is rejected with the error that this margin has */
  const char *near = strstr(csv, ",g800.inc,none,10,violated,swell,thyristor.v_forward,-0.010");
  near = near ? strstr(near, ",-0.010") + 1 : NULL;
  EXPECT(near && near[strcspn(near, ",")] == ',' && atof(strchr(near, ',') + 1) > 0, "%s", csv);
  free(csv);
  free(bom);
  char *json = read_file("out/design.json");
  r = run("run out/cases/%d.yaml --all", (int)number_in(json, "case"));
  expect_end(&r, 0, "verdict: held");
  free(json);
  write_world();
}

/* The least margin of all lines is told where it is a rating's, and a scene that is written names a
 * table's row by the whole path. */
static void margin_of_a_rating(void) {
  char text[2048];
  write_file("t.tab",
             "*$ part thyristor \"a resistor, @NAME@\"\n*$ limit v_drm = @v@ V\n"
             "*$ limit v_rrm = @v@ V\n*$ limit i_t_rms = 12 A\n.subckt @SUBCKT@ a k g\n"
             "Rg g k 1k\nBk a k I=v(a,k)*v(g,k)*20m\n.ends @SUBCKT@\n*$ rows NAME v\nt12 1200\n");
  snprintf(text, sizeof text, "%st.tab#t12,thyristor,0.2,1,\n", SIZES);
  write_file("p.csv", text);
  snprintf(text, sizeof text, "%sratings: {v_ak: -1 kV .. 650 V}\n", SCENE);
  write_file("s.yaml", text);
  write_design(", parts: [t.tab#t12]", "proof: {neighbours: false}\n");
  ran r = run("design d.yaml -o rated --overwrite");
  EXPECT(strstr(r.out, "\nof all lines, also of other parts and of ratings ") &&
             strstr(r.out, " v_ak  "),
         "%s%s", r.out, r.err);
  free_ran(&r);
  char *json = read_file("rated/design.json"), path[64];
  snprintf(path, sizeof path, "rated/cases/%d.yaml", (int)number_in(json, "case"));
  char *yaml = read_file(path);
  EXPECT(strstr(yaml, "\"thyristor\": \"/") && strstr(yaml, "/t.tab#t12\""), "%s", yaml);
  free(json);
  free(yaml);
  write_world();
}

/* A spread of what is chosen is a tolerance of the value at hand, whatever the scene's own one. */
static void tolerances(void) {
  write_design(", parts: [g1200.inc]", "spread: {circuit.r1: 10 % uniform}\n"
                                       "threats:\n  n: 4\n  dip: {kind: sag, level: 40 %, "
                                       "duration: 20 ms}\nproof: {random: 8, verify: false}\n");
  ran r = run("design d.yaml -o spread --overwrite --quiet");
  expect_end(&r, 0, "");
  char *text = read_file("spread/study.csv"), *names[COLUMNS], *cells[COLUMNS];
  char *line = text, *end = strchr(line, '\n');
  double least = 1, most = 1;
  *end = '\0';
  const size_t n = vs_csv_split(line, names, COLUMNS, NULL),
               chosen = column_of(names, n, "circuit.r1_ohm"),
               run_as = column_of(names, n, "circuit.r1_spread_ohm");
  while (*(line = end + 1)) {
    end = strchr(line, '\n');
    *end = '\0';
    vs_csv_split(line, cells, COLUMNS, NULL);
    least = fmin(least, atof(cells[run_as]) / atof(cells[chosen]));
    most = fmax(most, atof(cells[run_as]) / atof(cells[chosen]));
  }
  EXPECT(least > 0.9 - 1e-9 && least < 0.95 && most < 1.1 + 1e-9 && most > 1.05, "%g, %g", least,
         most);
  free(text);
}

/* A threat's own keys are run also where a point of operation has others: it comes at 60 ms, which
 * a run of the scene's 50 ms would not meet. */
static void threats_beside_operation(void) {
  write_design(", parts: [g1200.inc]",
               "operation: {long: {run.until: 70 ms}}\nthreats:\n  late: {kind: sag, at: 60 ms, "
               "duration: 5 ms, until: 90 ms}\nproof: {verify: false, neighbours: false}\n");
  ran r = run("design d.yaml -o beside --overwrite");
  EXPECT(strstr(r.out, "holds all 3 cases"), "%s", r.out);
  expect_end(&r, 0, "circuit.thyristor     g1200.inc ");
}

/* What an event makes untrue is no stress: r1, opened, would have kilowatts by the deck's line. No
 * candidate is rejected by it, and none holds. */
static void not_judged(void) {
  write_design(", parts: [g1200.inc]",
               "threats:\n  lost: {kind: open, element: R1, from: start, criterion: B}\n");
  ran r = run("design d.yaml -o open --overwrite");
  EXPECT(strstr(r.out, "g1200.inc, 10 ohm, for 2.2, could not be judged: r1.power is not known, "
                       "under lost (case 0)\n"),
         "%s", r.out);
  expect_end(&r, 1,
             "!5 candidates could not be judged; no other one holds, and nothing holds below 2.2");
  char *json = read_file("open/design.json");
  EXPECT(number_in(json, "lower_bound") == 2.2, "%s", json);
  free(json);
}

/* A candidate that a misfire rejects has no margin beside it: none of its lines is broken. */
static void happened(void) {
  write_design(
      ", parts: [g1200.inc]",
      "threats:\n  lost: {kind: open, element: Vt, from: start}\nproof: {verify: false}\n");
  ran r = run("design d.yaml -o misfires --overwrite");
  expect_end(&r, 3,
             "!nothing in the catalogue holds: all 5 candidates, up to 10.6, violate a case");
  char *csv = read_file("misfires/design.csv");
  EXPECT(strstr(csv, ",violated,lost,misfire of thyristor at 0.013 s (no current followed its gate "
                     "pulse),,,0,"),
         "%s", csv);
  free(csv);
}

/* A relay's suppressors of two kinds. Those below the supply's 12 V conduct at rest: they are
 * rejected, each for this. The scene has no winding: beside `cold` it has none. */
static void kinds_compete(void) {
  static const char DESIGN[] =
      "scene: relay\nset: {circuit.across_coil: open, run.until: 60 ms%s}\nreport: [v_ds_max]\n"
      "catalogue:\n  prices: k.csv\n  choose:\n    circuit.across_switch: {kind: [zener, tvs]}\n"
      "operation: {cold: {actuator.winding.temperature: -20 degC}}\nproof: {verify: false}\n";
  char text[1024];
  write_file("k.csv", "part,kind,price\nSMBJ24CA,tvs,3\n1N4740,zener,1\n1N4749,zener,2\n");
  snprintf(text, sizeof text, DESIGN, "");
  write_file("k.yaml", text);
  ran r = run("check k.yaml");
  EXPECT(!r.status && strstr(r.out, "its first case (across_switch 1N4740) cannot begin: t = 0 s"),
         "%d %s%s", r.status, r.out, r.err);
  free_ran(&r);
  r = run("design k.yaml -o kinds --overwrite");
  EXPECT(strstr(r.out, "of 3 candidates") && strstr(r.out, "holds all 2 cases"), "%s", r.out);
  expect_end(&r, 0, "1N4740 does not hold: t = 0 s: the coil carries a current");
  snprintf(text, sizeof text, DESIGN, ", ratings: {v_ds_max: .. 13 V}");
  write_file("k.yaml", text);
  r = run("design k.yaml -o kinds --overwrite");
  EXPECT(strstr(r.out, "what rejects them\n1 candidate; 1N4740 does not hold: t = 0 s: "), "%s",
         r.out);
  expect_end(&r, 3, "2 candidates; the nearest: ");
}

static void budget(void) {
  char more[1024];
  snprintf(more, sizeof more, "%sbudget: {runs: 12}\n", threats(140));
  write_design("", more);
  ran r = run("design d.yaml -o spent --overwrite");
  EXPECT(strstr(r.out, "none is known to hold; the nearest so far: price = ") &&
             strstr(r.out, ", where nothing below 1.4 holds (") &&
             strstr(r.out, "\ncircuit.thyristor ") && strstr(r.out, "\nagainst it: it "),
         "%s", r.out);
  expect_end(&r, 4, "!budget.runs = 12 is spent: nothing below 1.4 holds");
  /* spent on the draws, there is an answer that holds the list */
  write_design(", parts: [g800.inc, g1200.inc]",
               "threats:\n  swell: {kind: swell, level: {from: 110 %, to: 120 %}, n: 1, duration: "
               "20 ms}\nproof: {verify: false}\nbudget: {runs: 30}\n");
  r = run("design d.yaml -o spent --overwrite");
  EXPECT(strstr(r.out, "best so far: price = 1.4 of 10 candidates, after ") &&
             strstr(r.out, "; nothing below 1.4 holds, and it is not proved that this one does"),
         "%s", r.out);
  expect_end(&r, 4, "!nothing below 1.4 holds, and the best so far is not proved");
}

/* A point at work that begins in its orbit is judged by what a run this short is not: the junction,
 * 40 W into 7 K/W, of which g1200 bears 125 degC. */
static void heat(void) {
  static const char COOLED[] = "ambient: 25 degC\nheatsink: {thyristor: 5 K/W}\nstart: {}\n";
  char text[2048], name[32];
  write_world();
  for (size_t k = 0; k < COUNT(VOLTS); k++) {
    snprintf(name, sizeof name, "g%d.inc", VOLTS[k]);
    char *part = read_file(name);
    const size_t first = strcspn(part, "\n");
    snprintf(text, sizeof text, "%.*s\n*$ limit t_j_max = %d degC\n*$ zth 2 K/W 1 s%s", (int)first,
             part, k == 3 ? 125 : 60, part + first);
    write_file(name, text);
    free(part);
  }
  snprintf(text, sizeof text, "%s*$ loss thyristor = v(a,b)*i(Vt)\n", DECK);
  write_file("d.cir", text);
  snprintf(text, sizeof text, "%s%s", SCENE, COOLED);
  write_file("s.yaml", text);
  write_design("",
               "operation: {hot: {ambient: 40 degC, start: steady}}\nthreats: {dip: {kind: sag, "
               "level: 40 %, duration: 20 ms}}\n");
  ran r = run("design d.yaml -o hot --overwrite");
  EXPECT(strstr(r.out, "g1000.inc does not hold: thyristor.t_j, margin -"), "%s", r.out);
  expect_end(&r, 0, "circuit.thyristor     g1200.inc ");
  write_world();
}

static void refusals(void) {
  static const struct {
    const char *parts, *more, *at, *says[2];
  } BAD[] = {
      {"", "aim: {least: prize}\n", "d.yaml:8:14: ", {"p.csv has no column 'prize'", "price"}},
      {", parts: []", "", "d.yaml:6:25: ", {"nothing to choose from", "no thyristor"}},
      {", parts: [g700.inc]", "", "d.yaml:6:50: ", {"p.csv has no part 'g700.inc'", NULL}},
      {"", "hold: {thyristor.v_backward: 0.8}\n", "d.yaml:8:8: ", {"no line", "v_forward"}},
      {"", "hold: {waive: [r1.energy]}\n", "d.yaml:8:16: ", {"no line 'r1.energy'", NULL}},
      {", values: [g600.inc]", "", "d.yaml:6:42: ", {"values has no effect here", "parts: [...]"}},
      {", or: nothing", "", "d.yaml:6:46: ", {"circuit.thyristor: or: none is wanted", NULL}},
      {"", "hold: {waive: [{lin: r1.power}]}\n", "d.yaml:8:17: ", {"'lin'", "line"}},
      {"", "proof: {search: 400}\n", "d.yaml:8:17: ", {"proof", NULL}},
      {"", "hold: {margin: 2}\n", "d.yaml:8:16: ", {"hold.margin", "0 to 1"}},
      {"",
       "operation: {high: {supply.frequncy: 60 Hz}}\n",
       "d.yaml:8:20: ",
       {"frequncy", "frequency"}},
      {"",
       "operation: {high: {supply: {voltage: 484 V}}}\n",
       "d.yaml:8:20: ",
       {"all of supply", "{supply.voltage: ...}"}},
      {"",
       "operation: {odd: {circuit.r1: 5 ohm}}\n",
       "d.yaml:8:19: ",
       {"circuit.r1 stands under catalogue already", NULL}},
      {"",
       "operation: {high: {supply.voltage: 484 V}}\nspread: {supply.voltage: 5 % uniform}\n"
       "threats: {dip: {kind: sag}}\n",
       "d.yaml:8:20: ",
       {"supply.voltage stands under spread already", NULL}},
      {"", "vary: {circuit.r1: [1 ohm]}\n", "d.yaml:3:1: ", {"vary stands beside it", NULL}},
      {"", "set: {run.tier: compiled}\n", "d.yaml:1:8: ", {"ngspice", "circuit"}},
  };
  for (size_t k = 0; k < COUNT(BAD); k++) {
    char what[32];
    snprintf(what, sizeof what, "refusal %zu", k);
    write_design(BAD[k].parts, BAD[k].more);
    char words[] = "design d.yaml -o refused";
    refuse(words, what, BAD[k].at, BAD[k].says, __LINE__);
  }
  ran r = run("design s.yaml -o refused");
  EXPECT(r.status == 2, "%d", r.status);
  free_ran(&r);
  /* check reads on behind a threat that is wrong */
  write_design("", "threats:\n  late: {kind: surge, at: 200 ms, polarity: any}\n");
  r = run("check d.yaml");
  EXPECT(r.status == 2 && strstr(r.err, "d.yaml:9:3: threats.late: "), "%d %s", r.status, r.err);
  free_ran(&r);
}

static void bad_prices(void) {
  static const struct {
    const char *csv, *at, *says[2];
  } BAD[] = {
      {"item,kind,price\n", "p.csv:1:1: ", {"no column 'part'", NULL}},
      {"part,kind,price,price\n", "p.csv:1:17: ", {"twice", NULL}},
      {"part,kind,price\ng600.inc,thyristr,1\n", "p.csv:2:10: ", {"thyristr", "thyristor"}},
      {"part,kind,price\ng600.inc,thyristor\n", "p.csv:2:10: ", {"2 cells", "3 titles"}},
      {"part,kind,price\ng600.inc,thyristor,dear\n", "p.csv:2:20: ", {"'dear' is no number", NULL}},
      {"part,kind,price\nx.inc,thyristor,1\nR,resistor,1\n", "p.csv:3:1: ", {"p_rated_w", NULL}},
      {"part,kind,price,p_rated_w\ng600.inc,thyristor,1,\nR,resistor,1,-2\n",
       "p.csv:3:14: ",
       {"p_rated_w of R: more than 0", NULL}},
      {"part,kind,price,p_rated_w\nx.inc,thyristor,1,\nR,resistor,1,2\n",
       "p.csv:2:1: ",
       {"no part 'x.inc'", NULL}},
  };
  write_design("", "");
  for (size_t k = 0; k < COUNT(BAD); k++) {
    char what[32];
    snprintf(what, sizeof what, "prices %zu", k);
    write_file("p.csv", BAD[k].csv);
    char words[] = "design d.yaml -o refused";
    refuse(words, what, BAD[k].at, BAD[k].says, __LINE__);
  }
}

/* ---- E series ---- */

/* IEC 60063: the values of E3 to E24 as they are printed; of the others some that the rule rounds
 * either way, and the one that it does not give. */
static void series(void) {
  static const double E12[] = {10, 12, 15, 18, 22, 27, 33, 39, 47, 56, 68, 82, 100};
  static const struct {
    const char *series;
    double value, below, above;
  } NEXT[] = {{"E3", 47, 22, 100},     {"E6", 1000, 680, 1500}, {"E24", 0.033, 0.03, 0.036},
              {"E12", 40, 39, 47},     {"E96", 100, 97.6, 102}, {"E96", 243, 237, 249},
              {"E192", 920, 909, 931}, {"E192", 915, 909, 920}, {"E48", 2.87, 2.74, 3.01}};
  double values[64];
  CU_ASSERT_EQUAL(vs_price_list_series("E12", 10, 100, values, 64), COUNT(E12));
  for (size_t k = 0; k < COUNT(E12); k++) EXPECT(values[k] == E12[k], "%g", values[k]);
  CU_ASSERT_EQUAL(vs_price_list_series("E192", 1, 9.99, values, 64), 192);
  CU_ASSERT_EQUAL(vs_price_list_series("E13", 1, 10, values, 64), 0);
  CU_ASSERT_EQUAL(vs_price_list_series("E12", 13, 14, values, 64), 0);
  for (size_t k = 0; k < COUNT(NEXT); k++) {
    const double below = vs_price_list_neighbour(NEXT[k].series, NEXT[k].value, -1),
                 above = vs_price_list_neighbour(NEXT[k].series, NEXT[k].value, 1);
    EXPECT(below == NEXT[k].below && above == NEXT[k].above, "%s %g: %g, %g", NEXT[k].series,
           NEXT[k].value, below, above);
  }
  CU_ASSERT(isnan(vs_price_list_neighbour("E", 1, 1)));
}

int main(void) {
  static const vs_test TESTS[] = {{"equals brute force", equals_brute_force},
                                  {"files", files},
                                  {"cases are scenes", cases_are_scenes},
                                  {"same bytes", same_bytes},
                                  {"shards", shards},
                                  {"house", house},
                                  {"draws become cases", draws_become_cases},
                                  {"draws ask for classes", draws_ask_for_classes},
                                  {"what made dearer is first", what_made_dearer_is_first},
                                  {"search finds", search_finds},
                                  {"left out", left_out},
                                  {"tolerances", tolerances},
                                  {"margin of a rating", margin_of_a_rating},
                                  {"threats beside operation", threats_beside_operation},
                                  {"not judged", not_judged},
                                  {"happened", happened},
                                  {"kinds compete", kinds_compete},
                                  {"budget", budget},
                                  {"heat", heat},
                                  {"refusals", refusals},
                                  {"bad prices", bad_prices},
                                  {"series", series}};
  return program_suite("design", TESTS, COUNT(TESTS));
}
