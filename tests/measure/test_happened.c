/* SPDX-License-Identifier: GPL-3.0-or-later
 * What happened comes first: a device that fires without a gate pulse, misfires or fails to turn
 * off, and a fuse that opens, break the verdict unless the scene expects them; what a verdict could
 * not judge stands below it; and a run, a study, the report and JSON say the same.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"
#include "measure/verdict.h"
#include "program.h"

/* The paper's converter with its gate off, and a surge that rises faster than the thyristor bears.
 */
static const char SURGE[] =
    "circuit: {deck: halfwave_paper}\n"
    "firing: {every: 1}\n"
    "run: {until: 45 ms}\n"
    "events: {s: {kind: surge, cycle: 3, angle: 15 deg, level: 2 kV, polarity: +}}\n";

/* The coil is shorted behind a stiff source, so that the fast fuse melts and the slow one does not.
 */
static const char SHORT[] =
    "circuit: {deck: halfwave_paper, thyristor: TYN1212, transformer: autotransformer_ideal}\n"
    "firing: {every: 1}\n"
    "run: {until: 28 ms, verify: never}\n"
    "events: {c: {kind: coil_short, at: 22 ms}}\n";

static void write_scene(const char *path, const char *text) {
  FILE *f = fopen(path, "w");
  if (!f) abort();
  fputs(text, f);
  if (fclose(f)) abort();
}

#define SAYS(text, what) EXPECT(strstr(text, what), "no '%s' in: %s", what, text)
#define SAYS_NOT(text, what) EXPECT(!strstr(text, what), "'%s' in: %s", what, text)

static void fires_by_itself(void) {
  write_scene("surge.yaml", SURGE);
  ran r = run("run surge.yaml -o out");
  EXPECT(r.status == 3, "%d %s", r.status, r.err);
  SAYS(r.out, "verdict: violated\nhappened: thyristor fires without a gate pulse at 40.83 ms (");
  free_ran(&r);
  char *json = read_file("out/summary.json");
  SAYS(json,
       "\"happened\": [{\"what\": \"unintended_firing\", \"device\": \"thyristor\", \"at_s\": "
       "0.0408");
  SAYS(json, "\"measure\": \"unintended_firings\"");
  free(json);
}

/* A triac whose gate pulse at 225 degrees ends before the current of the half cycle before does is
 * lost, so that it conducts one way alone; and one that bears 600 V breaks over at 720 V. */
static void of_a_triac(void) {
  static const struct {
    const char *firing, *happened;
  } ROWS[] = {{"angle: 45 deg, pulse_width: 1 ms, every: 1}\nsupply: {voltage: 180 V}\n"
               "run: {until: 19 ms, method: gear, verify: never}",
               "happened: triac misfires at 12.5 ms (the last half cycle's current outlasted its "
               "gate pulse"},
              {"angle: 140 deg, every: 1}\nsupply: {voltage: 520 V}\n"
               "run: {until: 6 ms, method: gear, verify: never}",
               "without a gate pulse at 4.684 ms (breakover at 721.8 V, beyond V_DRM of 600 V"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text scene = {0};
    vs_text_add(&scene,
                "machine: {model: two_mass, spring: 1.9e6 N/m, spring_damping: 100 N.s/m}\n"
                "circuit: {deck: triac_feeder, triac: BT137-600}\nfiring: {%s\n",
                ROWS[k].firing);
    write_scene("triac.yaml", scene.text);
    ran r = run("run triac.yaml");
    SAYS(r.out, ROWS[k].happened);
    free_ran(&r);
    vs_text_free(&scene);
  }
  unlink("triac.yaml");
}

/* An arc of 300 V does not end a current that mains of 622 V at their crest drive. One of 1100 V
 * does, and nothing is said. */
static void an_arc_too_low(void) {
  static const char LOW[] =
      "fuse_2 has melted and does not clear: the voltage of its arc, 301 V, is "
      "below the crest of the mains, 622.3 V";
  RUN_GOOD("part fuse -o own.inc");
  char *part = read_file("own.inc"), *at = strstr(part, "arc_voltage = 1100 V");
  CU_ASSERT_PTR_NOT_NULL_FATAL(at);
  for (int low = 0; low < 2; low++) {
    if (low) memcpy(at, "arc_voltage =  300 V", strlen("arc_voltage =  300 V"));
    write_scene("own.inc", part);
    write_scene("arc.yaml", SHORT);
    ran r =
        run("run arc.yaml --set circuit.fuse_2=own.inc --set circuit.transformer=autotransformer "
            "--set events.c.at=8ms");
    EXPECT(low == (strstr(r.err, LOW) != NULL), "%d: %s", low, r.err);
    EXPECT(low == (strstr(r.err, "does not clear") != NULL), "%d: %s", low, r.err);
    free_ran(&r);
  }
  free(part);
}

/* Each sentence about the fuse, by what the scene expects. */
static void fuse_opens(void) {
  if (is_for_memory_alone()) return;
  static const struct {
    const char *expect, *says;
    int status;
  } CASES[] = {
      {"", "happened: fuse_2 opens at ", 3},
      {"[fuse_2 opens]", "as expected", 0},
      {"[fuse_2 fuse_opens]", "as expected", 0},
      {"fuse_2 opens", "as expected", 0},
      {"[fuse_2 opens, fuse_1 opens]", "did not happen, though expected: fuse_1 opens", 3}};
  write_scene("short.yaml", SHORT);
  for (size_t k = 0; k < COUNT(CASES); k++) {
    ran r = run("run short.yaml --set 'expect=%s'", CASES[k].expect);
    EXPECT(r.status == CASES[k].status, "%s: %d %s%s", CASES[k].expect, r.status, r.out, r.err);
    SAYS(r.out, CASES[k].says);
    SAYS(r.out, "(melted after int i^2 dt of ");
    free_ran(&r);
  }
  /* what an event opens did not melt, at its element or at the source that shows its current */
  static const char *const ELEMENT[] = {"Xf2", "Vf1"}, *const FUSE[] = {"fuse_2", "fuse_1"};
  for (size_t k = 0; k < COUNT(ELEMENT); k++) {
    ran r = run("run short.yaml --all --set 'events={o: {kind: open, element: %s, at: 5 ms}}'",
                ELEMENT[k]);
    SAYS_NOT(r.out, " opens at ");
    EXPECT(strstr(r.out, FUSE[k]) && strstr(r.out, ".v_open (an event opens it)"), "%s", r.out);
    free_ran(&r);
  }
}

/* Ideal elements rate nothing, so that there is no verdict; a misfire makes one. */
static void an_ideal_thyristor_misfires(void) {
  static const char SCENE[] = "circuit: {deck: halfwave_snubbed}\n"
                              "run: {until: 20 ms}\n"
                              "events: {w: {kind: weak_pulse, cycle: 1, level: 5 %}}\n";
  write_scene("weak.yaml", SCENE);
  ran r = run("run weak.yaml");
  EXPECT(r.status == 3, "%d %s", r.status, r.err);
  SAYS(r.out, "happened: thyristor misfires at ");
  SAYS(r.err, "thyristor misfires at ");
  free_ran(&r);
  r = run("run weak.yaml --set 'expect=[thyristor misfires]'");
  EXPECT(r.status == 0, "%d %s", r.status, r.err);
  SAYS(r.out, "verdict: held\n");
  free_ran(&r);
  r = run("run weak.yaml --set events.w.level=100%%");
  EXPECT(r.status == 0, "%d %s", r.status, r.err);
  SAYS(r.out, "verdict: none");
  free_ran(&r);
}

/* The coarser second run of this scene fires falsely at 40 ms: its steps are too long there. The
 * line hangs on figures of the second run's deck, which is freed before the table is printed. */
static void in_the_second_run_alone(void) {
  ran r =
      run("run paper --set circuit.deck=halfwave_paper --set circuit.thyristor=BT151-800R --set "
          "firing.every=1 --set run.until=48ms");
  EXPECT(r.status == 3 && (!strstr(r.out, "happened: ") || strstr(r.out, ", in one of two runs\n")),
         "%d %s", r.status, r.out);
  free_ran(&r);
}

/* What happens in one of the two runs is undecided, unless the criterion allows it: then it may. */
static void allowed_in_one_run_alone(void) {
  vs_device thyristor = {.name = "thyristor", .kind = vs_kinds_find("thyristor"), .part = -1};
  vs_deck *deck = vs_alloc(1, sizeof *deck);
  const vs_device_measure *fires = thyristor.kind->measures;
  while (fires->held != VS_NEVER) fires++;
  for (int allowed = 0; allowed < 2; allowed++)
    for (int run = 0; run < 2; run++) {
      vs_verdict v[2] = {{0}};
      v[run].item = vs_alloc(1, sizeof *v[run].item);
      v[run].item[v[run].count++] = (vs_judgement){.device = &thyristor,
                                                   .measure = fires,
                                                   .margin = allowed ? INFINITY : -1,
                                                   .margin_error = NAN,
                                                   .stress = {true, 1, 1e-3},
                                                   .expected = allowed,
                                                   .allowed = allowed};
      vs_verdict_compare(&v[0], &v[1], deck, 1e-4, 1e-3);
      CU_ASSERT_EQUAL(v[0].count, run == 0 || !allowed);
      if (v[0].count) CU_ASSERT_EQUAL(vs_verdict_word(v[0].item), allowed ? VS_HELD : VS_UNDECIDED);
      for (int k = 0; k < 2; k++) vs_verdict_free(&v[k]);
    }
  free(deck);
}

static void not_judged(void) {
  ran r = run("run paper --set circuit.deck=halfwave_paper --set circuit.thyristor=TYN1212 --set "
              "run.until=10ms --set run.verify=never --all");
  SAYS(r.out, "\nnot judged: ");
  SAYS(r.out, "r1, c1, "); /* of which nothing at all is judged */
  SAYS(r.out, "(no limit stated)");
  SAYS(r.out, "fuse_1.v_open, fuse_2.v_open (it did not open)");
  free_ran(&r);
  r = run("run paper --set circuit.deck=halfwave_paper --set circuit.thyristor=TYN1212 --set "
          "run.until=10ms --set run.verify=never --json --quiet");
  SAYS(r.out, "\"not_judged\": [\"thyristor.i_rms\", ");
  SAYS(r.out, "\"r1.power\", \"r1.e_pulse\", \"r1.v_peak\", \"c1.v_peak\", ");
  SAYS_NOT(r.out, "\"thyristor.v_forward\"]");
  free_ran(&r);
  /* a verdict of none stands for nothing, and leaves nothing out */
  r = run("run paper --tier circuit --set run.until=10ms");
  SAYS(r.out, "verdict: none");
  SAYS_NOT(r.out, "not judged: ");
  free_ran(&r);
  write_scene("own.inc", "*$ part resistor \"R\"\n*$ limit v_rms = 250 V\n.subckt own a b\n"
                         "R1 a b 1k\n.ends own\n");
  r = run("check own.inc");
  SAYS(r.out, "nothing is held to v_rms");
  free_ran(&r);
}

static void the_same_in_a_study(void) {
  write_scene("short.yaml", SHORT);
  write_scene("study.yaml", "scene: short.yaml\n"
                            "vary: {events.c.at: [22 ms, 39 ms]}\n"
                            "report: [fuse_2.opens]\n");
  ran r = run("study study.yaml -o rows --jobs 1");
  EXPECT(r.status == 3, "%d %s", r.status, r.err);
  free_ran(&r);
  r = run("study study.yaml -o rows --jobs 1 --resume"); /* takes the rows of the journal */
  EXPECT(r.status == 3, "%d %s", r.status, r.err);
  free_ran(&r);
  char *csv = read_file("rows/study.csv");
  SAYS(csv, ",happened,not_judged,warnings,status\n");
  SAYS(csv, "fuse_opens of fuse_2 at 0.0");
  SAYS(csv, "-1,"); /* the margin of what must not happen */
  SAYS(csv, ",fuse_2.opens,");
  SAYS(csv, "r1, c1");
  free(csv);
  RUN_GOOD("plot rows");
  char *html = read_file("rows/report.html");
  SAYS(html, "Happened in 1 case: fuse_opens of fuse_2.");
  SAYS(html, "Not judged: ");
  free(html);
  r = run("run short.yaml -o one");
  SAYS(r.out, "; expect: [C] allows it");
  free_ran(&r);
  char *events = read_file("one/events.csv");
  double last_s = 0;
  for (char *row = strchr(events, '\n'); row && row[1]; row = strchr(row + 1, '\n')) {
    const double at_s = strtod(row + 1, NULL);
    EXPECT(at_s >= last_s, "%s", events);
    last_s = at_s;
  }
  free(events);
  RUN_GOOD("plot one");
  html = read_file("one/report.html");
  SAYS(html, "Happened: fuse_opens of fuse_2 at ");
  SAYS(html, "Shares are of all that was given");
  SAYS(html, "Not judged: ");
  free(html);
}

/* A case's id follows from what is expected, as its status does. */
static void an_id_of_its_own(void) {
  static const char STUDY[] = "scene: paper\n"
                              "set: {run.until: 1 ms, circuit.deck: halfwave_paper%s}\n"
                              "report: [i_peak]\n"
                              "vary: {firing.angle: [90 deg]}\n";
  char *rows[2], text[512];
  for (int k = 0; k < 2; k++) {
    snprintf(text, sizeof text, STUDY, k ? ", expect: [fuse_2 opens]" : "");
    write_scene(k ? "two.yaml" : "one.yaml", text);
  }
  for (int k = 0; k < 2; k++) {
    ran r = run("study %s.yaml -o %s --jobs 1", k ? "two" : "one", k ? "b" : "a");
    EXPECT(r.status == (k ? 3 : 0), "%d %s", r.status, r.err);
    free_ran(&r);
    rows[k] = read_file(k ? "b/study.csv" : "a/study.csv");
  }
  const char *a = strstr(rows[0], "\n0,"), *b = strstr(rows[1], "\n0,");
  EXPECT(a && b && strncmp(a, b, 19) != 0, "%s%s", rows[0], rows[1]);
  SAYS(rows[1], "fuse_opens of fuse_2 did not happen, though expected");
  for (int k = 0; k < 2; k++) free(rows[k]);
}

static void refused(void) {
  static const struct {
    const char *entry, *says[2];
  } CASES[] = {{"[fuse_3 opens]", {"the deck has no device 'fuse_3'", "did you mean 'fuse_"}},
               {"[fuse_2 burns]", {"'fuse_2 burns' is nothing that is told", "'fuse_2 opens'"}},
               {"[r1 opens]", {"nothing that is told of a resistor", NULL}},
               {"fuse_2", {"a device and what happens to it are wanted", NULL}},
               {"[fuse_2 opens, fuse_2 fuse_opens]", {"a second time", NULL}},
               {"{a: b}", {"a list is wanted", NULL}}};
  for (size_t k = 0; k < COUNT(CASES); k++) {
    write_scene("bad.yaml", "circuit: {deck: halfwave_paper}\nexpect: ");
    FILE *f = fopen("bad.yaml", "a");
    if (!f) abort();
    fprintf(f, "%s\n", CASES[k].entry);
    fclose(f);
    ran r = run("check bad.yaml");
    EXPECT(r.status == 2, "%s: %d %s", CASES[k].entry, r.status, r.err);
    SAYS(r.err, "bad.yaml:2:");
    for (int n = 0; n < 2 && CASES[k].says[n]; n++) SAYS(r.err, CASES[k].says[n]);
    free_ran(&r);
  }
  ran r = run("run paper --tier switched --set 'expect=[fuse_2 opens]'");
  EXPECT(r.status == 2, "%d %s", r.status, r.err);
  SAYS(r.err, "has no devices");
  free_ran(&r);
}

int main(void) {
  static const vs_test TESTS[] = {{"fires by itself", fires_by_itself},
                                  {"of a triac", of_a_triac},
                                  {"a fuse opens", fuse_opens},
                                  {"an arc too low", an_arc_too_low},
                                  {"an ideal thyristor misfires", an_ideal_thyristor_misfires},
                                  {"in the second run alone", in_the_second_run_alone},
                                  {"allowed in one run alone", allowed_in_one_run_alone},
                                  {"not judged", not_judged},
                                  {"the same in a study", the_same_in_a_study},
                                  {"an id of its own", an_id_of_its_own},
                                  {"refused", refused}};
  return program_suite("happened", TESTS, COUNT(TESTS));
}
