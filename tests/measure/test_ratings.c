/* SPDX-License-Identifier: GPL-3.0-or-later
 * The user's own limits: what a scene allows of measures and of probes, in runs, on orbits, in
 * studies and in searches. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/units.h"
#include "program.h"
#include "run/listed_measure.h"

/* ---- a run in this process ---- */

#define SHORT "run={until: 40 ms}"

static const vs_judgement *line_of(const vs_trial *t, const char *name) {
  const vs_judgement *line = judged_line(&t->result.verdict, name);
  EXPECT(line, "no line %s", name);
  return line;
}

static double value_of(const vs_trial *t, const char *name) {
  vs_listed_measure m;
  for (int k = 0; vs_listed_measure_at(&t->scene.frame, &t->result, k, &m); k++)
    if (!strcmp(m.name, name)) return m.value.known ? m.value.value * vs_units_factor(m.unit) : NAN;
  EXPECT(false, "no measure %s", name);
  return NAN;
}

/* Each kind of measure is judged by the value that the run shows of it. */
static void every_kind_of_measure(void) {
  static const struct {
    const char *name, *range;
    double limit; /* SI, of the end that is nearer */
    bool least;
  } ROWS[] = {{"stroke", "0.5 mm .. 1.5 mm", 1.5e-3, false},
              {"p_min", "-5 mm ..", -5e-3, true},
              {"gap_max", ".. 1 mm", 1e-3, false},
              {"t_extinction", ".. 14 ms", 14e-3, false},
              {"v_ak_max", ".. 900 V", 900, false},
              {"r1.power", ".. 2 W", 2, false},
              {"thyristor.di_dt", ".. 50 A/us", 50e6, false},
              {"thyristor.t_off", "50 us ..", 50e-6, true},
              {"energy_in", ".. 5", 5, false},
              {"mains.thd", ".. 50 %", 0.5, false},
              {"i.harmonic_3", ".. 0.1 A", 0.1, false}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char rating[96];
    bool plain = !strcmp(ROWS[k].name, "energy_in");
    snprintf(rating, sizeof rating, "ratings={%s: '%s%s'}", ROWS[k].name, ROWS[k].range,
             plain ? " J" : "");
    const char *const sets[] = {SHORT, "quality=[mains, i]", rating, NULL};
    vs_trial *t = vs_trial_run("paper", "circuit", sets, NULL);
    EXPECT(!t->status, "%s: %s", ROWS[k].name, t->err.text);
    const vs_judgement *j = t->status ? NULL : line_of(t, ROWS[k].name);
    if (j) {
      double value = strchr(ROWS[k].name, '.') && strstr(ROWS[k].name, "harmonic")
                         ? vs_spectrum_harmonic(&t->result.quality[1].current, 3)
                         : value_of(t, ROWS[k].name);
      double room = ROWS[k].least ? value - ROWS[k].limit : ROWS[k].limit - value;
      CLOSE(j->stress.value, value, 1e-12); /* the same number */
      CLOSE_OF(j->margin, room / fabs(ROWS[k].limit), 1, 1e-12);
      EXPECT(!j->unknown && (j->margin >= 0 || j->failed_s <= 0.04), "%s fails at %g s",
             ROWS[k].name, j->failed_s);
    }
    vs_trial_free(t);
  }
}

static void stroke_is_the_way_between(void) {
  static const char *const SETS[] = {SHORT, NULL};
  vs_trial *t = vs_trial_run("paper", "switched", SETS, NULL);
  CLOSE(value_of(t, "stroke"), value_of(t, "p_max") - value_of(t, "p_min"), 1e-14);
  CLOSE(value_of(t, "stroke"), value_of(t, "gap_max") - value_of(t, "gap_min"), 1e-14);
  vs_trial_free(t);
  static const char *const ANY[] = {SHORT, "ratings={stroke: .. 1 m}", NULL};
  t = vs_trial_run("two_mass", NULL, ANY, NULL);
  CLOSE(value_of(t, "stroke"), value_of(t, "gap_max") - value_of(t, "gap_min"), 1e-14);
  EXPECT(!t->status && line_of(t, "stroke")->margin > 0.9, "%s", t->err.text);
  vs_trial_free(t);
}

/* A probe is judged by its least and its largest value, as the deck's own ratings are: the lines
 * are the same but for who says them. */
static void as_the_decks_own(void) {
  write_file("own.cir",
             "*$ port mains = Vm\n*$ probe v_r = v(a) V\n*$ probe i_r = i(Vr) A\n"
             "*$ rating v_r -120..150 V\nVm a 0 external\nVr a r 0\nR1 r 0 100\nRe a e 1meg\n"
             "Xeva e 0 eva\n");
  static const char *const SETS[] = {"circuit.deck=own.cir", "supply.voltage=100V",
                                     "run={until: 30 ms}",
                                     "ratings={v_r: -120 .. 150 V, "
                                     "i_r: 0 A .., v_mains: -1 kV .. 1 kV}",
                                     NULL};
  vs_trial *t = vs_trial_run("paper", NULL, SETS, NULL);
  const vs_verdict *v = &t->result.verdict;
  EXPECT(!t->status && v->count == 4, "%zu lines: %s", v->count, t->err.text);
  if (v->count == 4) {
    const vs_judgement *deck = &v->item[0], *own = &v->item[1], *current = &v->item[2];
    EXPECT(!deck->name && !strcmp(own->name, "v_r"), "lines in another order");
    CLOSE(own->margin, deck->margin, 1e-14);
    CLOSE(own->failed_s, deck->failed_s, 1e-12);
    CLOSE(own->least.value, deck->least.value, 1e-14);
    CLOSE(own->largest.at_s, deck->largest.at_s, 1e-14);
    /* 0 says which sign it may have; beyond it the margin is a part of the largest magnitude */
    CLOSE(current->margin, -1, 1e-3);
    CLOSE(current->failed_s, 10e-3, 1e-2);
    CLOSE(v->item[3].margin, 1 - 0.1 * sqrt(2), 1e-4);
  }
  vs_trial_free(t);
}

/* Channels of the machine are followed besides: what i_peak and p_max say of them is known. */
static void channels_of_the_machine(void) {
  static const char *const TIERS[] = {"switched", "circuit", "analytic"};
  for (size_t k = 0; k < COUNT(TIERS); k++) {
    static const char *const SETS[] = {
        SHORT, "ratings={i: -1 A .. 0.5 A, p: -1 mm .. 5 mm, vp: -10 .. 10 m/s, force: .. 1 kN}",
        NULL};
    vs_trial *t = vs_trial_run("paper", TIERS[k], SETS, NULL);
    EXPECT(!t->status, "%s", t->err.text);
    const vs_judgement *i = line_of(t, "i"), *p = line_of(t, "p"), *vp = line_of(t, "vp"),
                       *force = line_of(t, "force");
    CLOSE(i->largest.value, value_of(t, "i_peak"), 1e-9); /* of two searches on one curve */
    CLOSE(force->largest.value, value_of(t, "force_peak"), 1e-9);
    CLOSE(p->largest.value, value_of(t, "p_max"), 1e-9);
    CLOSE(p->least.value, value_of(t, "p_min"), 1e-9);
    CLOSE(i->margin, 1 - value_of(t, "i_peak") / 0.5, 1e-9);
    EXPECT(i->failed_s > value_of(t, "t_fire") && i->failed_s < i->largest.at_s, "i fails at %g s",
           i->failed_s);
    EXPECT(vp->largest.value > 0.05 && vp->least.value < -0.05 && vp->margin > 0.9,
           "vp from %g to %g m/s", vp->least.value, vp->largest.value);
    vs_trial_free(t);
  }
}

/* ---- what is not known ---- */

/* Each probe that a rating names, the deck's first as well, wants the tier that has it. */
static void probes_want_the_circuit(void) {
  static const char *const RATINGS[] = {"v_ak: .. 1 kV", "i_thyristor: .. 1 kA",
                                        "v_c1_min: -1 kV .."};
  for (size_t k = 0; k < COUNT(RATINGS); k++) {
    char scene[100];
    snprintf(scene, sizeof scene, "run: {until: 50 ms}\nratings: {%s}\n", RATINGS[k]);
    write_file("s.yaml", scene);
    ran r = run("check s.yaml");
    EXPECT(r.status == 0 && strstr(r.out, "tier circuit (auto: the scene names ratings."), "%d %s",
           r.status, r.out);
    free_ran(&r);
  }
}

static void without_a_value(void) {
  static const struct {
    const char *tier, *set, *name, *why;
  } ROWS[] = {
      {"switched", "ratings={r1.power: .. 2 W}", "r1.power", "this tier has no circuit"},
      {"switched", "ratings={v_ak: -900 .. 900 V}", "v_ak", "this tier has no circuit"},
      {"switched", "ratings={v_ak_max: .. 900 V}", "v_ak_max", "this tier has no circuit"},
      {"circuit", "ratings={thyristor.t_off: 50 us ..}", "thyristor.t_off", "it did not occur"},
      {"switched", "ratings={t_fire: 1 ms ..}", "t_fire",
       "it did not occur, or the run ends too early"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char at[64];
    ran r = run("run paper --set run.until=4ms --tier %s --set '%s' -o none --quiet", ROWS[k].tier,
                ROWS[k].set);
    snprintf(at, sizeof at, "a rating is undecided: %s has no value, as ", ROWS[k].name);
    EXPECT(r.status == 3 && strstr(r.err, at) && strstr(r.err, ROWS[k].why), "%d: %s", r.status,
           r.err);
    free_ran(&r);
    char *json = read_file("none/summary.json");
    EXPECT(strstr(json, "\"margin\": null, \"margin_error\": null, \"word\": \"undecided\"") &&
               strstr(json, ROWS[k].why) && strstr(json, "its line is undecided"),
           "%s", strstr(json, "\"verdict\""));
    free(json);
  }
  ran r = run("run paper --set run.until=4ms --tier switched --set 'ratings={t_fire: 1 ms .., "
              "stroke: .. 1 m}'");
  EXPECT(r.status == 3 && strstr(r.out, "verdict: undecided") &&
             strstr(r.out, "undecided: t_fire (it did not occur, or the run ends too early)") &&
             strstr(r.out, "weakest: stroke"),
         "%s", r.out);
  free_ran(&r);
}

/* ---- how sure ---- */

/* The second run is made where nothing else is rated, and its error holds against a finer run. */
static void margins_have_errors(void) {
  static const char *const SETS =
      "--set run.until=0.1s --set quality=mains --set 'ratings={stroke: "
      ".. 3 mm, mains.i_rms: .. 0.3 A, i: .. 1 A, p_max: .. 2 mm}' ";
  static const char *const TIERS[] = {"switched", "circuit"};
  for (size_t k = 0; k < COUNT(TIERS); k++) {
    ran coarse = run("run paper %s --tier %s --json --quiet", SETS, TIERS[k]),
        fine = run("run paper %s --tier %s --set run.tolerance=%s --set run.verify=never --json "
                   "--quiet",
                   SETS, TIERS[k], k ? "3e-6" : "1e-8");
    EXPECT(coarse.status == 0 && fine.status == 0, "%s%s", coarse.err, fine.err);
    const char *a = strstr(coarse.out, "\"verdict\""), *b = strstr(fine.out, "\"verdict\"");
    int lines = 0;
    while (a && b && (a = strstr(a, "\"margin\": ")) && (b = strstr(b, "\"margin\": "))) {
      double margin, error, truth;
      EXPECT(sscanf(a, "\"margin\": %lf, \"margin_error\": %lf", &margin, &error) == 2 &&
                 sscanf(b, "\"margin\": %lf", &truth) == 1,
             "%.100s", a);
      EXPECT(fabs(margin - truth) <= error && error < 0.05, "%s: margin %g +- %g, it is %g",
             TIERS[k], margin, error, truth);
      a++, b++, lines++;
    }
    EXPECT(lines == 4, "%d lines", lines);
    EXPECT(strstr(fine.out, "\"word\": \"unverified\"") != NULL, "no second run, and yet verified");
    free_ran(&coarse), free_ran(&fine);
  }
}

/* ---- keys ---- */

static void keys_may_be_set(void) {
  write_file("flat.yaml", "ratings: {r1.power: .. 2 W, stroke: .. 1 m}\nrun: {until: 20 ms}\n");
  write_file("nested.yaml", "ratings: {r1: {power: .. 2 W}, stroke: .. 1 m}\n"
                            "run: {until: 20 ms}\n");
  static const char *const FILES[] = {"flat", "nested"};
  for (size_t k = 0; k < COUNT(FILES); k++) {
    ran r = run("run %s.yaml --set 'ratings.r1.power=.. 1 mW' --json --quiet", FILES[k]);
    EXPECT(r.status == 3 &&
               strstr(r.out, "\"r1.power\": {\"min\": null, \"max\": 1, \"unit\": "
                             "\"mW\"}") &&
               strstr(r.err, "r1.power = ") && strstr(r.err, " mW, allowed at most 1 mW"),
           "%s: %s", FILES[k], r.err);
    free_ran(&r);
    r = run("run %s.yaml --set ratings.r1.power=none --set 'ratings.stroke=2 m ..' --json --quiet",
            FILES[k]);
    EXPECT(r.status == 3 && !strstr(r.out, "\"rating\": \"r1.power\"") &&
               strstr(r.err, "allowed at least 2 m"),
           "%s: %s", FILES[k], r.err);
    free_ran(&r);
  }
  ran r = run("check flat.yaml");
  EXPECT(strstr(r.out, "tier circuit (auto: the scene names ratings.r1.power") != NULL, "%s",
         r.out);
  free_ran(&r);
  r = run("run paper --set run.until=10ms --set ratings=none --quiet");
  EXPECT(r.status == 0, "%s", r.err);
  free_ran(&r);
}

static void bad_input(void) {
  static const struct {
    const char *line, *at, *says[2];
  } BAD[] = {
      {"ratings: [stroke]", "bad.yaml:1:11: ", {"a map is wanted", NULL}},
      {"ratings: {strok: .. 1 mm}", "bad.yaml:1:11: ", {"no measure or probe 'strok'", "'stroke'"}},
      {"ratings: {stroke: .. 1 kg}", "bad.yaml:1:19: ", {"ratings.stroke: ", "wrong unit"}},
      {"ratings: {stroke: 1 .. 2}", "bad.yaml:1:19: ", {"ratings.stroke: ", "has no unit"}},
      {"ratings: {stroke: 1 mm}", "bad.yaml:1:19: ", {"a range is wanted", ".. B m"}},
      {"ratings: {stroke: ..}", "bad.yaml:1:19: ", {"a range is wanted", NULL}},
      {"ratings: {stroke: }", "bad.yaml:1:11: ", {"a range is wanted", NULL}},
      {"ratings: {stroke: [1 mm]}", "bad.yaml:1:20: ", {"a range is wanted", NULL}},
      {"ratings: {stroke: 2 .. 1 mm}",
       "bad.yaml:1:19: ",
       {"from 2 to 1 mm there is nothing", "lesser end first"}},
      {"ratings: {stroke: .. 1 mm .. 2 mm}", "bad.yaml:1:19: ", {"ratings.stroke: ", NULL}},
      {"ratings: {r1.power: .. 1 W, r1: {power: .. 2 W}}",
       "bad.yaml:1:34: ",
       {"r1.power stands here a second time", NULL}},
      {"ratings: {mains.thd: .. 1}", "bad.yaml:1:11: ", {"write quality: [mains]", NULL}},
  };
  for (size_t k = 0; k < COUNT(BAD); k++) {
    write_file("bad.yaml", BAD[k].line);
    refuse("run bad.yaml -o out", BAD[k].line, BAD[k].at, BAD[k].says, __LINE__);
  }
}

/* ---- orbits, studies, searches ---- */

static void on_an_orbit(void) {
  ran r = run("steady paper --tier switched --set firing.every=1 --set quality=mains "
              "--set 'ratings={stroke: .. 5 mm, mains.harmonic_part: .. 1 %%}' --json --quiet");
  EXPECT(r.status == 3 && strstr(r.err, "a rating is violated: mains.harmonic_part = ") &&
             strstr(r.out, "\"rating\": \"stroke\", \"of\": \"scene\"") &&
             strstr(r.out, "\"word\": \"held\"") && strstr(r.out, "\"word\": \"violated\""),
         "%d: %s", r.status, r.err);
  free_ran(&r);
}

#define GRID                                                                                       \
  "scene: own.yaml\nvary: {firing.angle: [100 deg, 90 deg], supply.voltage: [440 V, 400 V]}\n"     \
  "report: [stroke]\n"
static const char OWN[] = "ratings: {stroke: .. 2.9 mm}\nrun: {until: 40 ms, tier: switched}\n";

/* Each row is judged, and a study that was stopped goes on to the same bytes. */
static void in_a_study(void) {
  write_file("own.yaml", OWN);
  write_file("grid.yaml", GRID);
  ran r = run("study grid.yaml -o whole --jobs 1 --quiet");
  EXPECT(r.status == 3, "%d: %s", r.status, r.err);
  free_ran(&r);
  char *whole = read_file("whole/study.csv"), *row = strchr(whole, '\n');
  int rows = 0;
  for (; row && row[1]; row = strchr(row + 1, '\n'), rows++) {
    double stroke, margin;
    int status;
    char *last = strchr(row + 1, '\n');
    EXPECT(last && sscanf(row + 1, "%*[^,],%*[^,],%*[^,],%*[^,],%lf,%lf,,stroke,", &stroke,
                          &margin) == 2,
           "%.120s", row + 1);
    if (!last) break;
    status = last[-1] - '0';
    CLOSE_OF(margin, 1 - stroke / 2.9e-3, 1, 1e-10);
    EXPECT(status == (margin < 0 ? 3 : 0), "margin %g, status %d", margin, status);
  }
  EXPECT(rows == 4 && strstr(whole, ",3\n") && strstr(whole, ",0\n"), "%s", whole);
  /* as if it had been stopped before its last case */
  char *journal = read_file("whole/journal"), *end = strrchr(journal, '\n');
  EXPECT(end != NULL, "%s", journal);
  if (end) *end = '\0';
  end = strrchr(journal, '\n');
  if (end) end[1] = '\0';
  write_file("whole/journal", journal);
  free(journal);
  r = run("study grid.yaml -o whole --jobs 1 --resume --quiet");
  char *again = read_file("whole/study.csv");
  EXPECT(r.status == 3 && !strcmp(whole, again), "%d: %s", r.status, again);
  free_ran(&r);
  free(again);
  /* another limit is another run: its rows have other ids */
  write_file("own.yaml", "ratings: {stroke: .. 2.8 mm}\nrun: {until: 40 ms, tier: switched}\n");
  r = run("study grid.yaml -o whole --jobs 1 --resume --quiet");
  EXPECT(r.status == 2, "%d: %s", r.status, r.err);
  free_ran(&r);
  r = run("study grid.yaml -o other --jobs 1 --quiet");
  free_ran(&r);
  char *other = read_file("other/study.csv"), one[64] = "", two[64] = "";
  sscanf(strchr(whole, '\n') + 1, "0,%63[^,]", one);
  sscanf(strchr(other, '\n') + 1, "0,%63[^,]", two);
  EXPECT(*one && *two && strcmp(one, two) != 0, "ids %s and %s", one, two);
  free(whole), free(other);
}

/* What no column tells is judged to the run's end, too: such a run is not left early. */
static void beside_the_columns(void) {
  write_file("besides.yaml", "set: {ratings: {u_max: .. 1 m, ap_peak: .. 1e6 m/s2, p: .. 1 m}, "
                             "run: {until: 5 s, tier: switched}}\n"
                             "vary: {supply.voltage: [440 V, 400 V]}\nreport: [i_peak]\n");
  RUN_GOOD("study besides.yaml -o besides --jobs 1 --quiet");
  char *csv = read_file("besides/study.csv");
  EXPECT(strstr(csv, ",0\n") && !strstr(csv, "has no value"), "%s", csv);
  free(csv);
}

/* A case whose rating has no value is undecided, and counts as judged. */
static void unknown_in_a_study(void) {
  write_file("un.yaml", "set: {ratings: {t_extinction: .. 1 s}, run.tier: switched}\n"
                        "vary: {run.until: [4 ms, 30 ms]}\nreport: [stroke]\n");
  ran r = run("study un.yaml -o un --jobs 1 --quiet");
  EXPECT(r.status == 3 && strstr(r.err, "in 1 of 2 cases"), "%d: %s", r.status, r.err);
  free_ran(&r);
  char *csv = read_file("un/study.csv");
  EXPECT(strstr(csv, "ratings: t_extinction has no value") && strstr(csv, ",3\n"), "%s", csv);
  free(csv);
  if (!on_path("gnuplot")) return;
  RUN_GOOD("plot un --quiet");
  char *page = read_file("un/report.html");
  EXPECT(strstr(page, "1 of 2 cases keep every rating") != NULL, "%.2000s", page);
  free(page);
}

static void in_a_search(void) {
  write_file("worst.yaml",
             "set: {ratings: {stroke: .. 3 mm}, run: {until: 30 ms, tier: switched}}\n"
             "vary: {firing.angle: {from: 95 deg, to: 120 deg}}\n"
             "find: {worst: min margin_least, n: 30}\nreport: [stroke]\n");
  ran r = run("study worst.yaml -o worst --jobs 1 --quiet");
  EXPECT(r.status == 3, "%d: %s", r.status, r.err);
  free_ran(&r);
  /* the stroke falls with the angle, so the worst case is the least angle */
  char *json = read_file("worst/manifest.json");
  char *csv = read_file("worst/study.csv");
  double least = INFINITY, at = NAN;
  for (char *row = strchr(csv, '\n'); row && row[1]; row = strchr(row + 1, '\n')) {
    double angle, stroke, margin;
    EXPECT(sscanf(row + 1, "%*[^,],%*[^,],%lf,%lf,%lf", &angle, &stroke, &margin) == 3, "%.100s",
           row + 1);
    CLOSE_OF(margin, 1 - stroke / 3e-3, 1, 1e-10);
    if (margin < least) least = margin, at = angle;
  }
  CLOSE(at, 95, 1e-3);
  EXPECT(least < 0, "margin %g; %.200s", least, json);
  free(json), free(csv);
}

/* A candidate of which a rating has no value holds not. */
static void in_a_search_for_a_snubber(void) {
  static const char *const RATINGS[] = {"thyristor.t_off: 1 us ..", "i_peak: .. 1 kA"};
  for (int known = 0; known < 2; known++) {
    char text[512];
    snprintf(text, sizeof text,
             "set: {ratings: {%s}, run: {until: 12 ms}}\n"
             "vary: {circuit.r1: {log: [100 ohm, 1 kohm]}, circuit.c1: {log: [10 nF, 100 nF]}}\n"
             "snubber: {ratings: {thyristor.di_dt: 10000 A/us}, n: 4}\n",
             RATINGS[known]);
    write_file("snubber.yaml", text);
    ran r = run("study snubber.yaml -o snubber%d --jobs 1 --quiet", known);
    EXPECT(r.status == (known ? 0 : 3), "%d: %s", r.status, r.err);
    free_ran(&r);
    char *json = read_file(known ? "snubber1/manifest.json" : "snubber0/manifest.json");
    EXPECT((strstr(json, "\"found\": null") == NULL) == known, "%d: %s", known,
           strstr(json, "\"candidates\""));
    free(json);
  }
}

/* ---- told ---- */

/* All that is violated stands in the table, however many lines that takes. */
static void all_that_is_violated(void) {
  static const char *const NAMES[] = {
      "i_peak: .. 1 uA",          "force_peak: .. 1 uN",    "p_max: .. 1 pm",
      "u_max: .. 1 pm",           "w_max: .. 1 pm",         "stroke: .. 1 pm",
      "ap_peak: .. 1e-6 m/s2",    "au_peak: .. 1e-6 m/s2",  "aw_peak: .. 1e-6 m/s2",
      "energy_in: .. 1 uJ",       "energy_copper: .. 1 uJ", "t_fire: .. 1 us",
      "conduction_time: .. 1 us", "work_force: .. 1 uJ"};
  vs_text scene = {0};
  vs_text_add(&scene, "run: {until: 50 ms, verify: never}\nratings:\n");
  for (size_t k = 0; k < COUNT(NAMES); k++) vs_text_add(&scene, "  %s\n", NAMES[k]);
  write_file("many.yaml", scene.text);
  ran r = run("run many.yaml");
  for (size_t k = 0; k < COUNT(NAMES); k++) {
    char line[40];
    snprintf(line, sizeof line, "\n  %.*s ", (int)strcspn(NAMES[k], ":"), NAMES[k]);
    EXPECT(r.status == 3 && strstr(r.out, line), "%d, no%s in %s", r.status, line, r.out);
  }
  free_ran(&r);
  vs_text_free(&scene);
}

static void told(void) {
  ran r = run("run paper --set run.until=40ms --set 'ratings={stroke: .. 2 mm, v_ak: -2 .. 2 kV, "
              "thyristor.v_forward: .. 3 kV}' -o told --quiet");
  EXPECT(r.status == 3, "%d: %s", r.status, r.err);
  free_ran(&r);
  char *json = read_file("told/summary.json");
  EXPECT(strstr(json, "{\"rating\": \"stroke\", \"of\": \"scene\", \"unit\": \"mm\"") &&
             strstr(json, "\"first_to_fail\": \"stroke\"") &&
             strstr(json, "\"v_ak\": {\"min\": -2, \"max\": 2, \"unit\": \"kV\"}"),
         "%s", strstr(json, "\"verdict\""));
  free(json);
  r = run("run paper --tier switched --set run.until=40ms --set 'ratings={stroke: .. 2 mm, v_ak: "
          "-2 .. 2 kV}' -o ideal --quiet");
  free_ran(&r);
  r = run("compare told ideal");
  EXPECT(strstr(r.out, "\n  v_ak ") && strstr(r.out, " - undecided"), "%s", r.out);
  free_ran(&r);
  if (!on_path("gnuplot")) return;
  RUN_GOOD("plot told --quiet");
  char *page = read_file("told/report.html");
  EXPECT(strstr(page, "<td>stroke</td><td class=\"n\">") && strstr(page, "<td>violated</td>"),
         "no line on the page");
  free(page);
}

static const vs_test TESTS[] = {
    {"probes want the circuit", probes_want_the_circuit},
    {"every kind of measure", every_kind_of_measure},
    {"stroke is the way between", stroke_is_the_way_between},
    {"as the deck's own", as_the_decks_own},
    {"channels of the machine", channels_of_the_machine},
    {"without a value", without_a_value},
    {"margins have errors", margins_have_errors},
    {"keys may be set", keys_may_be_set},
    {"bad input", bad_input},
    {"on an orbit", on_an_orbit},
    {"in a study", in_a_study},
    {"beside the columns", beside_the_columns},
    {"unknown in a study", unknown_in_a_study},
    {"in a search", in_a_search},
    {"in a search for a snubber", in_a_search_for_a_snubber},
    {"told", told},
    {"all that is violated", all_that_is_violated},
};

int main(void) {
  return program_suite("ratings", TESTS, COUNT(TESTS));
}
