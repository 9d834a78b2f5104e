/* SPDX-License-Identifier: GPL-3.0-or-later
 * What parts say of themselves and what decks ask of it: kinds, limits, ratings by a part's limit,
 * conditions between parameters, the mains against what a part allows, and the list of parts. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "measure/verdict.h"
#include "program.h"
#include "suite.h"

#define DECK                                                                                       \
  "*$ title t\n*$ param fuse = f part fuse \"F\"\n*$ param low = 2 mA 0..100 \"a\"\n"              \
  "*$ port mains = Vmains\n*$ probe v_f = v(a,b) V\n*$ probe i_f = i(Vs) A\n"
#define CIRCUIT "Vmains a 0 external\nXf a s fuse\nVs s b 0\nXeva b 0 eva\n"
#define PART(lines) "*$ part fuse \"a fuse\"\n" lines ".subckt f a b\nR1 a b 1\n.ends\n"

static vs_setup *setup_of(const char *deck, const char *part, const char *scene, vs_error *err) {
  static vs_setup setup;
  vs_tree tree = {0};
  write_file("d.cir", deck);
  write_file("f.inc", part);
  write_file("s.yaml", scene);
  *err = (vs_error){0};
  CU_ASSERT_EQUAL_FATAL(vs_tree_read("s.yaml", &tree, err), VS_OK);
  vs_status status = vs_setup_build(tree.root, &setup, err);
  vs_tree_free(&tree);
  if (status) vs_setup_free(&setup);
  return status ? NULL : &setup;
}

/* A rating takes a part's limit, in the limit's own unit, with the sign it stands with. */
static void ratings_take_limits(void) {
  vs_error err = {0};
  vs_setup *s = setup_of(
      DECK "*$ rating v_f -fuse.v_back..0.5 kV\n*$ rating i_f -2..fuse.i_rated A \"F\"\n" CIRCUIT,
      PART("*$ limit v_back = 0.7 kV assumed \"x\"\n*$ limit i_rated = 500 mA\n"),
      "circuit: {deck: d.cir}", &err);
  EXPECT(s, "%s", err.text);
  if (!s) return;
  CU_ASSERT_EQUAL_FATAL(s->deck.n_ratings, 2);
  CLOSE(s->deck.ratings[0].min, -700, 1e-15);
  CLOSE(s->deck.ratings[0].max, 500, 1e-15);
  CLOSE(s->deck.ratings[1].min, -2, 1e-15);
  CLOSE(s->deck.ratings[1].max, 0.5, 1e-15);
  CU_ASSERT_TRUE(s->deck.limits[0].unsure == VS_ASSUMED && !s->deck.limits[1].unsure);
  CU_ASSERT_TRUE(s->deck.ratings[0].bounds[0].unsure && !s->deck.ratings[1].bounds[1].unsure);
  vs_setup_free(s);
}

/* A part without a limit: that end is open; a rating open at both ends is none. */
static void no_limit_is_said(void) {
  vs_error err = {0};
  vs_setup *s =
      setup_of(DECK "*$ rating v_f -1..fuse.v V\n*$ rating i_f -fuse.v..fuse.v A\n" CIRCUIT,
               PART("*$ limit v = none \"ideal\"\n"), "circuit: {deck: d.cir}", &err);
  EXPECT(s, "%s", err.text);
  if (!s) return;
  CU_ASSERT_EQUAL_FATAL(s->deck.n_ratings, 1);
  CU_ASSERT_TRUE(isinf(s->deck.ratings[0].max));
  vs_setup_free(s);
}

/* The margin of a rating with one end is that to this end. */
static void one_end_is_judged(void) {
  write_file("d.cir", DECK "*$ rating v_f -fuse.v..fuse.v V\n*$ rating i_f 0..fuse.i A\n"
                           "*$ rating i_f -2000..fuse.i A\n" CIRCUIT);
  write_file("f.inc", PART("*$ limit v = 0.1 V\n*$ limit i = none\n"));
  write_file("s.yaml", "circuit: {deck: d.cir}\nrun: {until: 2 ms}\n");
  ran r = run("run s.yaml --json --quiet --reproducible");
  CU_ASSERT_EQUAL(r.status, 3); /* 0.24 A in 1 ohm */
  EXPECT(strstr(r.err, "a rating is violated: v_f") && strstr(r.err, "allowed -0.1..0.1 V"), "%s",
         r.err);
  EXPECT(strstr(r.out, "\"max\": null"), "%s", r.out);
  EXPECT(!strstr(r.out, "inf") && !strstr(r.out, "nan"), "%s", r.out);
  free_ran(&r);
}

/* One line for each thing that does not fit; where it stands and what would be right. */
static void bad_input(void) {
  static const struct {
    const char *deck, *part, *scene, *place, *says;
  } ROWS[] = {
      {DECK CIRCUIT, "*$ part varistor \"V\"\n.subckt f a b\nR1 a b 1\n.ends\n",
       "circuit: {deck: d.cir}",
       "d.cir:2:17: ", "f is a part of kind varistor, and fuse is wanted"},
      {DECK CIRCUIT, "*$ part varistor \"V\"\n.subckt f a b\nR1 a b 1\n.ends\n",
       "circuit: {deck: d.cir, fuse: f}", "s.yaml:1:30: ", "circuit.fuse: f is a part of kind"},
      {DECK CIRCUIT, ".subckt f a b\nR1 a b 1\n.ends\n", "circuit: {deck: d.cir}",
       "f.inc:1:1: ", "has no line '*$ part fuse \"TEXT\"', which circuit.fuse asks for"},
      {DECK CIRCUIT, "*$ part fuse \"V\"\n.subckt g a b\nR1 a b 1\n.ends\n",
       "circuit: {deck: d.cir}", "f.inc:2:1: ", "defines no subcircuit 'f'"},
      {DECK CIRCUIT, PART(""), "circuit: {deck: d.cir, fuse: fuze}", "s.yaml:1:30: ", "fuze"},
      {DECK "*$ rating i_f 0..fuse.i_rated A\n" CIRCUIT, PART(""), "circuit: {deck: d.cir}",
       "f.inc:1:1: ",
       "has no line '*$ limit i_rated = VALUE UNIT' (or none), which the rating of i_f at d.cir:7 "
       "asks for"},
      {DECK "*$ rating i_f 0..fuse.v A\n" CIRCUIT, PART("*$ limit v = 3 V\n"),
       "circuit: {deck: d.cir}", "f.inc:2:1: ", "a unit as A is wanted, for the rating of i_f"},
      {DECK "*$ rating i_f 0..fuze.i A\n" CIRCUIT, PART(""), "circuit: {deck: d.cir}",
       "d.cir:7:1: ", "'fuze' is no part of this deck; did you mean 'fuse'?"},
      {DECK "*$ rating i_f 0..fuse. A\n" CIRCUIT, PART(""), "circuit: {deck: d.cir}",
       "d.cir:7:15: ", "MIN..MAX"},
      {DECK CIRCUIT, PART("*$ limit v = -3 V\n"), "circuit: {deck: d.cir}", "f.inc:2:14: ",
       "a positive number with a unit known here, or 'none', is wanted, not '-3 V'"},
      {DECK CIRCUIT, PART("*$ limit v = 3\n"), "circuit: {deck: d.cir}",
       "f.inc:2:14: ", "a positive number with a unit"},
      {DECK CIRCUIT, PART("*$ limit v = 3 V\n*$ limit v = 4 V\n"), "circuit: {deck: d.cir}",
       "f.inc:3:1: ", "limit v stands here a second time"},
      {DECK CIRCUIT, PART("*$ limit v_rms = 3 A\n"), "circuit: {deck: d.cir}",
       "f.inc:2:18: ", "limit v_rms: a unit as V is wanted, not 'A'"},
      {DECK "*$ part fuse \"d\"\n" CIRCUIT, PART(""), "circuit: {deck: d.cir}",
       "d.cir:7:1: ", "belongs into a part's file"},
      {DECK "*$ rating v_f 100..-fuse.v V\n" CIRCUIT, PART("*$ limit v = 3 V\n"),
       "circuit: {deck: d.cir}", "d.cir:7:1: ", "from 100 to -3 V there is nothing"},
      {DECK CIRCUIT, PART("*$ limit v = 3 V guessed\n"), "circuit: {deck: d.cir}",
       "f.inc:2:18: ", "quotes"},
      {DECK CIRCUIT, PART("*$ part fuse \"again\"\n"), "circuit: {deck: d.cir}",
       "f.inc:2:1: ", "a file is one part"},
      {DECK CIRCUIT, PART("*$ param high = 1 mA 0..100 \"b\"\n*$ require low <= high \"a fuse\"\n"),
       "circuit: {deck: d.cir}",
       "f.inc:3:12: ", "circuit: low <= high is wanted (a fuse), and low = 2 mA, high = 1 mA"},
      {DECK CIRCUIT, PART("*$ param high = 3 mA 0..100 \"b\"\n*$ require 1.5*low < high\n"),
       "circuit:\n  deck: d.cir\n  high: 2 mA",
       "s.yaml:3:9: ", "circuit: 1.5*low < high is wanted, and low = 2 mA, high = 2 mA"},
      {DECK CIRCUIT, PART("*$ param high = 3 mA 0..100 \"b\"\n*$ require low < high\n"),
       "circuit:\n  deck: d.cir\n  high: 2 mA", "s.yaml:3:9: ", "low = 2 mA, high = 2 mA"},
      {DECK CIRCUIT, PART("*$ require low > 3\n"), "circuit: {deck: d.cir}",
       "f.inc:2:16: ", "an operator"},
      {DECK CIRCUIT, PART("*$ require low\n"), "circuit: {deck: d.cir}",
       "f.inc:2:15: ", "an operator, '<' or '<=' is wanted here"},
      {DECK CIRCUIT, PART("*$ require low < v(a)\n"), "circuit: {deck: d.cir}",
       "f.inc:2:12: ", "parameters are compared"},
      {DECK CIRCUIT, PART("*$ require low < hi\n"), "circuit: {deck: d.cir}",
       "f.inc:2:18: ", "no parameter 'hi'"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_error err = {0};
    vs_setup *s = setup_of(ROWS[k].deck, ROWS[k].part, ROWS[k].scene, &err);
    EXPECT(!s && !strncmp(err.text, ROWS[k].place, strlen(ROWS[k].place)) &&
               strstr(err.text, ROWS[k].says),
           "row %zu: %s", k, s ? "no error" : err.text);
    if (s) vs_setup_free(s);
  }
}

/* Equal is good enough for <=, also where a unit's conversion rounds. */
static void requirements_that_hold(void) {
  vs_error err = {0};
  vs_setup *s = setup_of(DECK CIRCUIT,
                         PART("*$ param high = 2000 uA 0..1e6 \"b\"\n*$ require low <= high\n"
                              "*$ require low < 3*high\n*$ require low/high <= 1 \"x\"\n"),
                         "circuit: {deck: d.cir}", &err);
  EXPECT(s, "%s", err.text);
  if (s) vs_setup_free(s);
}

/* Limits that the mains alone exceed; 440 V rms is a peak of 622 V. */
static void below_the_mains(void) {
  static const struct {
    const char *limit, *says;
  } ROWS[] = {{"v_drm = 600 V", "v_drm of f, 600 V, is below the mains: 622.254 V peak"},
              {"v_rrm = 600 V", "v_rrm of f, 600 V, is below the mains: 622.254 V peak"},
              {"v_rms = 420 V", "v_rms of f, 420 V, is below the mains: 440 V rms"},
              {"v_rwm = 600 V", "v_rwm of f, 600 V, is below the mains: 622.254 V peak"},
              {"v_rrm = 630 V", NULL},
              {"v_rms = 441 V", NULL},
              {"v_rms = none", NULL},
              {"v_other = 1 V", NULL}};
  write_file("d.cir", DECK CIRCUIT);
  write_file("s.yaml", "circuit:\n  deck: d.cir\n  fuse: f\nrun: {until: 1 ms}\n");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char part[200];
    snprintf(part, sizeof part, PART("*$ limit %s\n"), ROWS[k].limit);
    write_file("f.inc", part);
    const char *const COMMANDS[] = {"run s.yaml", "check s.yaml", "check d.cir",
                                    "run s.yaml --json --quiet"};
    static const char *const PLACE[] = {
        "vibrospice: warning: ", "s.yaml:3:9: warning: ", "d.cir: warning: ", "\"warnings\": [\""};
    for (size_t n = 0; n < COUNT(COMMANDS); n++) {
      char wanted[200];
      ran r = run("%s", COMMANDS[n]);
      const char *text = n < 3 ? r.err : r.out;
      snprintf(wanted, sizeof wanted, "%scircuit.fuse: %s", PLACE[n],
               ROWS[k].says ? ROWS[k].says : "");
      /* no device of the deck goes with the part, so that a run is undecided where it has limits */
      const bool real = !strstr(ROWS[k].limit, "none");
      CU_ASSERT_EQUAL(r.status, !strncmp(COMMANDS[n], "run", 3) && real ? VS_RATING : VS_OK);
      EXPECT(!strstr(text, wanted) == !ROWS[k].says, "%s: %s", ROWS[k].limit, text);
      free_ran(&r);
    }
  }
}

/* A limit that nothing is held to is warned of, where it stands: a name that is spelled wrong, or
 * of another kind of part. Not one that a rating asks for, that is none, or that is there to be
 * read. */
static void limits_that_nothing_is_held_to(void) {
  static const struct {
    const char *rating, *limit, *says;
  } ROWS[] = {
      {"", "i_ratet = 3 A",
       "limit i_ratet of f.inc: no measure of a fuse and no rating is held to it; did you mean "
       "'i_rated'?"},
      {"", "t_q = 30 us", "limit t_q of f.inc: no measure of a fuse"},
      {"", "i_ratet = none", NULL},
      {"", "i_fusing = 3 A", NULL},
      {"*$ rating i_f 0..fuse.i_ratet A\n", "i_ratet = 3 A", NULL},
  };
  write_file("s.yaml", "circuit: {deck: d.cir}\nrun: {until: 1 ms}\n");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char text[800];
    snprintf(text, sizeof text, "%s%s%s", DECK, ROWS[k].rating, CIRCUIT);
    write_file("d.cir", text);
    snprintf(text, sizeof text, PART("*$ limit %s\n"), ROWS[k].limit);
    write_file("f.inc", text);
    static const char *const COMMANDS[] = {"run s.yaml", "check s.yaml", "check d.cir",
                                           "check f.inc"};
    for (size_t n = 0; n < COUNT(COMMANDS); n++) {
      if (n == 3 && *ROWS[k].rating) continue; /* a part alone does not know its decks */
      snprintf(text, sizeof text, "%s: warning: %s", n ? "f.inc:2:1" : "vibrospice",
               ROWS[k].says ? ROWS[k].says : "limit");
      ran r = run("%s", COMMANDS[n]);
      const bool undecided = !n && !strstr(ROWS[k].limit, "none"); /* for want of a device */
      EXPECT(r.status == (undecided ? VS_RATING : VS_OK) && !strstr(r.err, text) == !ROWS[k].says,
             "%s: %s: %s", ROWS[k].limit, COMMANDS[n], r.err);
      free_ran(&r);
    }
  }
}

/* Every part that comes with the program says what it is, and those of a maker what they allow; a
 * part is added by adding its file. */
static void parts_are_listed(void) {
  ran r = run("list parts S20K510");
  CU_ASSERT_EQUAL(r.status, 0);
  EXPECT(strstr(r.out, "varistor: EPCOS (TDK) SIOV-S20K510, disc of 20 mm\n") &&
             strstr(r.out, "limit v_rms              510 V          continuous\n") &&
             strstr(r.out, "limit v_varistor         820 V          at 1 mA, nominal (assumed)\n"),
         "%s", r.out);
  free_ran(&r);
  r = run("list parts BT136-600");
  EXPECT(strstr(r.out, "limit dv_dt_c            50 V/us        after a commutation (typical)\n"),
         "%s", r.out);
  free_ran(&r);
  r = run("list parts");
  for (const char *line = r.out; *line; line = strchr(line, '\n') + 1)
    EXPECT(!strncmp(line, "    ", 4) || !strncmp(strchr(line, '\n') + 1, "    ", 4) ||
               strstr(line, " parts; up to 3 are shown"),
           "says nothing of itself: %.60s", line);
  free_ran(&r);
}

/* A part's file can be checked by itself. */
static void parts_are_checked(void) {
  write_file("f.inc", PART("*$ limit v = 3 V\n*$ param a = 1 A 0..2 \"a\"\n"));
  write_file("g.inc", ".subckt g a b\nR1 a b 1\n.ends\n");
  write_file("h.inc", PART("*$ limit v = 3\n"));
  ran r = run("check f.inc");
  EXPECT(r.status == 0 && strstr(r.out, "a good part: fuse, a fuse; 1 limits, 1 parameters"), "%s",
         r.out);
  free_ran(&r);
  r = run("check g.inc");
  EXPECT(r.status == 2 && !strncmp(r.err, "g.inc:1:1: has no line '*$ part", 31), "%s", r.err);
  free_ran(&r);
  r = run("check h.inc");
  EXPECT(r.status == 2 && !strncmp(r.err, "h.inc:2:14: limit v: ", 21), "%s", r.err);
  free_ran(&r);
}

static const vs_test TESTS[] = {
    {"ratings take limits", ratings_take_limits},
    {"no limit is said", no_limit_is_said},
    {"one end is judged", one_end_is_judged},
    {"bad input", bad_input},
    {"requirements that hold", requirements_that_hold},
    {"below the mains", below_the_mains},
    {"limits that nothing is held to", limits_that_nothing_is_held_to},
    {"parts are listed", parts_are_listed},
    {"parts are checked", parts_are_checked},
};
int main(void) {
  return program_suite("limits of parts", TESTS, COUNT(TESTS));
}
