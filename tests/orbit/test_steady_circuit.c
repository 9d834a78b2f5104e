/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command steady, and `start: steady`, on tier circuit: the numbers of orbits against a
 * reference that was found by another program, the cycles that the search takes, what begins on the
 * orbit, and what is refused. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "orbit/measured.h"
#include "program.h"

/* ---- numbers out of JSON ---- */

/* The number behind "key": , or behind "key": {"value": ; NaN: there is none. */
static double number(const char *json, const char *key) {
  char name[64];
  snprintf(name, sizeof name, "\"%s\": ", key);
  const char *at = strstr(json, name);
  if (!at) return NAN;
  at += strlen(name);
  if (!strncmp(at, "{\"value\": ", 10)) at += 10;
  return strtod(at, NULL);
}

/* The size of the k-th multiplier. */
static double size_of(const char *json, int k) {
  const char *at = strstr(json, "\"multipliers\": [");
  while (at && k-- >= 0) at = strstr(at + 1, "{\"re\": ");
  const char *im = at ? strstr(at, "\"im\": ") : NULL;
  return im ? hypot(strtod(at + 7, NULL), strtod(im + 6, NULL)) : NAN;
}

static ran steady(const char *words) {
  ran r = run("steady paper --tier circuit --set firing.every=1 %s --json --reproducible --quiet",
              words);
  EXPECT(r.status == 0 && !*r.err, "steady %s: %d %s", words, r.status, r.err);
  return r;
}

/* ---- a run's files ---- */

/* A column of run.csv, in the order of its rows; to be freed. *count: how many there are. */
static double *column(const char *path, const char *name, size_t *count) {
  char *text = read_file(path), *rest = text, *line = strsep(&rest, "\n");
  double *values = vs_alloc((size_t)count_lines(rest) + 1, sizeof *values);
  size_t at = 0, n = 0;
  for (char *word; (word = strsep(&line, ",")) && strcmp(word, name); at++) {
  }
  while ((line = strsep(&rest, "\n")) && *line) {
    for (size_t k = 0; k < at; k++) strsep(&line, ",");
    values[n++] = strtod(line, NULL);
  }
  free(text);
  *count = n;
  return values;
}

static bool contains(const char *path, const char *what) {
  char *text = read_file(path);
  bool found = strstr(text, what) != NULL;
  free(text);
  return found;
}

/* ---- numbers ---- */

/* T3A at 100 degrees, found by shooting on the circuit's equations in another program. A run is
 * right to its run.tolerance, and the orbit to a hundredth of that; the finest, which takes three
 * times as long, with VS_LONG. The losses have more: what the varistors and snubbers take is a
 * small part of power_in. */
static void at_100_degrees(void) {
  const double TOLERANCE[] = {1e-4, getenv("VS_LONG") ? 1e-6 : 1e-5};
  static const double SIZE[] = {0.99948987, 0.99860011, 0.99439091, 0.97083055};
  for (size_t k = 0; k < COUNT(TOLERANCE); k++) {
    double tolerance = TOLERANCE[k];
    char words[64];
    snprintf(words, sizeof words, "--set run.tolerance=%g", tolerance);
    ran r = steady(words);
    CLOSE(number(r.out, "p_min"), -0.0020778927946, tolerance);
    CLOSE(number(r.out, "p_max"), 0.001856145811, tolerance);
    CLOSE(number(r.out, "i_peak"), 0.61837671812, tolerance);
    CLOSE(number(r.out, "force_peak"), 101.40731321, tolerance);
    CLOSE(number(r.out, "power_in"), 13.677377413, tolerance);
    CLOSE(number(r.out, "t_extinction"), 0.013868338866, tolerance);
    CLOSE(number(r.out, "energy_copper"), 8.3001785 * 0.02, tolerance);
    CLOSE(number(r.out, "damping_J"), 0.48301747 * 0.02, 2 * tolerance); /* as p squared */
    EXPECT(number(r.out, "cycles") <= (k ? 20 : 15), "%g cycles", number(r.out, "cycles"));
    EXPECT(number(r.out, "correction") <= 0.01 * tolerance, "%g", number(r.out, "correction"));
    EXPECT(strstr(r.out, "\"stable\": true") != NULL, "stable");
    for (int i = 0; i < 4; i++) /* the differences' error */
      CLOSE(size_of(r.out, 2 * i), SIZE[i], k ? 3e-5 : 2e-4);
    free_ran(&r);
  }
}

/* At 90 degrees the thyristor fires once in a cycle; at 110 it goes out 49 us after it has fired,
 * and fires again 261 us later. The finer run tells the error of the coarser one, which is to hold
 * its tolerance; both searches are to end within the cycles that were seen at first. */
static void at_other_angles(void) {
  static const struct {
    const char *angle;
    int cycles[2]; /* at most, at 1e-3 and at 1e-4 */
  } ROWS[] = {{"90deg", {13, 15}}, {"110deg", {10, 12}}, {"120deg", {16, 20}}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char words[128];
    snprintf(words, sizeof words, "--set firing.angle=%s --set run.tolerance=1e-3", ROWS[k].angle);
    ran coarse = steady(words);
    snprintf(words, sizeof words, "--set firing.angle=%s", ROWS[k].angle);
    ran fine = steady(words);
    static const char *const NAMES[] = {"p_min", "p_max", "i_peak", "power_in", "i_rms"};
    for (size_t n = 0; n < COUNT(NAMES); n++)
      CLOSE(number(coarse.out, NAMES[n]), number(fine.out, NAMES[n]), 1.1e-3);
    EXPECT(number(coarse.out, "cycles") <= ROWS[k].cycles[0], "%s: %g", ROWS[k].angle,
           number(coarse.out, "cycles"));
    EXPECT(number(fine.out, "cycles") <= ROWS[k].cycles[1], "%s: %g", ROWS[k].angle,
           number(fine.out, "cycles"));
    free_ran(&coarse), free_ran(&fine);
  }
}

/* The transformer's flux linkage creeps by 6 mWb a cycle to -1.268 Wb, for 60 cycles if it is left
 * alone. On the orbit it is where it was a period before. */
static void a_flux_that_creeps(void) {
  ran r = run("steady paper --tier circuit --set circuit.deck=halfwave_paper --set firing.every=1 "
              "--set run.tolerance=1e-3 --set run.verify=never --json --quiet -o flux");
  EXPECT(r.status == 0, "%d %s", r.status, r.err);
  EXPECT(number(r.out, "cycles") <= 30, "%g cycles", number(r.out, "cycles"));
  size_t n;
  double *flux = column("flux/run.csv", "flux_wb", &n), first = flux[0], last = flux[n - 1];
  EXPECT(fabs(first + 1.268) < 2e-3 && fabs(last - first) < 1e-4, "%g, %g", first, last);
  free(flux);
  free_ran(&r);
}

/* The line warms up with a time constant of 0.2 s, which no probe shows. What the search says that
 * it is off by is no less than what the run goes on to move; multipliers, which the copies would
 * have wrong, are not told, and a warning says so. */
static void what_no_probe_shows(void) {
  write_file("slow.cir",
             "*$ title  a line that warms up\n*$ param  thyristor = latch part thyristor\n"
             "*$ port   mains = Vmains\n*$ port   gate = Vgate\n*$ line   a\n"
             "Vmains src 0 external\nRsource src s1 {r_source}\nLsource s1 a2 {l_source} ic=0\n"
             "Bwarm a2 a V = 5*i(Vmains)*v(warm)\nBheat 0 warm I = i(Vmains)^2\n"
             "Rwarm warm 0 10\nCwarm warm 0 20m ic=0\nVgate g b external\nVthy a t 0\n"
             "Xthy t b g thyristor\nRsnub a c1p 100\nCsnub c1p b 100n ic=0\n"
             "Reva b c2p 220\nCeva c2p 0 47n ic=0\nXeva b 0 eva\n");
#define SLOW                                                                                       \
  "--tier circuit --set circuit.deck=slow.cir --set firing.every=1 --set run.tolerance=1e-3 "      \
  "--set run.verify=never --quiet "
  ran r = run("steady paper " SLOW "--json");
  EXPECT(r.status == 0 && strstr(r.out, "\"stable\": null") &&
             strstr(r.out, "whether the orbit is stable is not known"),
         "%d %s", r.status, r.err);
  RUN_GOOD("run paper " SLOW "--digits 17 --set start=steady --set run.until=0.6s "
           "--set run.sample=20ms -o slow");
  size_t n;
  double *p = column("slow/run.csv", "p_m", &n), off = 0;
  for (size_t k = 0; k < n; k++) off = fmax(off, fabs(p[k] - p[0]) / 2.08e-3);
  EXPECT(off < number(r.out, "correction") && off < 1e-4, "%g, told %g", off,
         number(r.out, "correction"));
  free(p);
  free_ran(&r);
  write_file("judged.yaml",
             "set: {circuit.deck: slow.cir, firing.every: 1, run: {tier: circuit, tolerance: 1e-3, "
             "verify: never}}\nsteady: true\nvary: {firing.angle: [100 deg]}\nreport: [stable]\n");
  RUN_GOOD("study judged.yaml --quiet -o judged");
  EXPECT(contains("judged/study.csv", ",100,,"), "the column stable is empty");
  EXPECT(contains("judged/study.csv", "stable is not known"), "its warning");
}

/* ---- what begins on the orbit ---- */

/* A run from the orbit goes on as it: after five cycles the motion is the first one's. An event
 * that comes then changes nothing before it, and counts its time from the run's beginning. */
static void a_run_begins_there(void) {
  RUN_GOOD("run paper --tier circuit --set firing.every=1 --set start=steady --set "
           "run.until=0.1s --quiet -o calm");
  write_file("dip.yaml", "start: steady\nfiring: {every: 1}\nrun: {until: 0.1 s, tier: circuit}\n"
                         "events: {dip: {kind: sag, at: 70 ms}}\n");
  RUN_GOOD("run dip.yaml --quiet -o dip");
  double off = 0, apart[2] = {0}, scale = 2.078e-3;
  size_t n, m;
  double *calm = column("calm/run.csv", "p_m", &n), *dip = column("dip/run.csv", "p_m", &m);
  EXPECT(n == 1001 && m == 1001, "%zu and %zu rows", n, m);
  for (size_t k = 0; k < n && k < m; k++) {
    off = fmax(off, fabs(calm[k] - calm[k % 200]) / scale);
    apart[k > 700] = fmax(apart[k > 700], fabs(dip[k] - calm[k]) / scale);
  }
  free(calm), free(dip);
  EXPECT(off < 5e-6, "off by %g", off); /* 5 times what the orbit is known to at 1e-4 */
  EXPECT(apart[0] < 2e-5 && apart[1] > 1e-3, "%g, then %g", apart[0], apart[1]);
  EXPECT(contains("dip/events.csv", "0.07,dip begins"), "the event's time");
  EXPECT(contains("dip/summary.json", "\"steady\": true"), "summary.json");
}

/* Who looks for an orbit while a run settles ends with that run: the scene, as that of the next
 * case of a study, has nothing of it left. */
static void no_search_is_left(void) {
  char *sets[] = {"firing.every=1"};
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_measured *measured = vs_alloc(1, sizeof *measured);
  vs_error err = {0};
  const vs_session session = {0};
  vs_status status = vs_scene_read("paper", sets, 1, "circuit", scene, &err);
  if (!status) status = vs_measured_run(measured, scene, 1, &session, &err);
  EXPECT(!status && measured->steady.picard && !scene->order.pilot, "%s", err.text);
  vs_measured_free(measured);
  vs_scene_free(scene);
  free(measured);
  free(scene);
}

/* With a stop, and the orbits of period 1 and 3 that are stable there. At 80 degrees tier switched
 * keeps off the stop; the circuit does not, and the machine, marched on for 200 cycles, comes back
 * after 5. At 60 degrees the swing's own Phi would drive the armature through its stop. At 1e-3
 * four of nine such orbits have multipliers that are not known well enough to tell. */
static void with_a_stop(void) {
  static const struct {
    const char *words;
    int status;
    const char *says;
  } ROWS[] = {
      {"1e-4 --set firing.angle=82deg", 0, "\"stable\": true"},
      {"1e-4 --set firing.angle=66deg --period 3", 0, "\"stable\": true"},
      {"1e-3 --set firing.angle=80deg", 1, "after 5 periods; try --period 5"},
      {"1e-3 --set firing.angle=60deg", 1, "`steady --period 2` reports"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("steady paper --tier circuit --set firing.every=1 --set actuator.stop={} --set "
                "run.verify=never --json --quiet --set run.tolerance=%s",
                ROWS[k].words);
    EXPECT(r.status == ROWS[k].status && strstr(r.status ? r.err : r.out, ROWS[k].says),
           "%s: %d %s", ROWS[k].words, r.status, r.err);
    EXPECT(r.status || number(r.out, "correction") <= 1e-5, "%s", ROWS[k].words);
    free_ran(&r);
  }
}

/* A copy that is pushed aside may meet the stop otherwise than the orbit does. At a coarse
 * tolerance pushes to one side alone gave largest multipliers of 1.0026 to 1.82 in these scenes,
 * known to 0.001. At 1e-4 they are below 1. */
static void not_unstable(void) {
  static const char *const ANGLES[] = {"82", "95", "95.5"};
  for (size_t k = 0; k < COUNT(ANGLES); k++) {
    ran r = run("steady paper --tier circuit --set firing.every=1 --set actuator.stop={} --set "
                "run.tolerance=1e-2 --set run.verify=never --set firing.angle=%sdeg --json --quiet",
                ANGLES[k]);
    EXPECT(!r.status && !strstr(r.out, "\"stable\": false"), "%s: %d %s", ANGLES[k], r.status,
           r.err);
    free_ran(&r);
  }
}

/* The same bytes again, and for an orbit of a machine that is another. */
static void the_same_again(void) {
  static const char WORDS[] = "steady two_mass --tier circuit --set firing.every=1 --set "
                              "firing.angle=130deg --reproducible --quiet --json";
  ran one = run("%s", WORDS), other = run("%s", WORDS);
  EXPECT(one.status == 0 && !strcmp(one.out, other.out), "%d %s", one.status, one.err);
  free_ran(&one), free_ran(&other);
}

/* ---- what is refused ---- */

static void refused(void) {
  static const struct {
    const char *words;
    int status;
    const char *says[2];
  } ROWS[] = {
      {"--set firing.every=1 --period 2", 1, {"period 2", "--period 1"}},
      {"--set firing.every=1 --period 0", 2, {"--period", "allowed"}},
      {"", 2, {"firing.every", "once"}},
      {"--set firing.every=1 --set firing.angle=75deg", 1, {"in cycle", "pole cover"}},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("steady paper --tier circuit %s --quiet -o out", ROWS[k].words);
    EXPECT(r.status == ROWS[k].status && !*r.out && count_lines(r.err) == 1 &&
               strstr(r.err, ROWS[k].says[0]) && strstr(r.err, ROWS[k].says[1]),
           "%s: %d %s%s", ROWS[k].words, r.status, r.out, r.err);
    free_ran(&r);
  }
}

static const vs_test TESTS[] = {
    {"at 100 degrees", at_100_degrees},
    {"at other angles", at_other_angles},
    {"a flux that creeps", a_flux_that_creeps},
    {"a run begins there", a_run_begins_there},
    {"no search is left", no_search_is_left},
    {"with a stop", with_a_stop},
    {"not unstable", not_unstable},
    {"what no probe shows", what_no_probe_shows},
    {"the same again", the_same_again},
    {"refused", refused},
};

int main(void) {
  return program_suite("steady_circuit", TESTS, COUNT(TESTS));
}
