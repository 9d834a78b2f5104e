/* SPDX-License-Identifier: GPL-3.0-or-later
 * ngspice is left where that saves more steps than the looks cost that it takes, and is not looked
 * at otherwise. */
#include <math.h>

#include "macromodel/circuit_states.h"
#include "suite.h"

typedef struct leaving {
  int times;
  double first_s, total_s, since_s;
} leaving;

static vs_status note_leaving(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  leaving *l = ctx;
  if (step->event[1] == VS_EV_QUIET) {
    l->since_s = step->event_s[1];
    if (!l->times++) l->first_s = l->since_s;
  } else if (step->event[1] == VS_EV_BACK) {
    l->total_s += step->event_s[1] - l->since_s;
    l->since_s = NAN;
  }
  return VS_OK;
}

/* Leaving takes two looks, each of which costs as much as 200 steps. Of 0.1 s two cycles are left
 * then, of 750 steps at 1e-4. A loose truncation leaves a cycle with 200 steps. */
static void left_where_it_pays(void) {
  static const struct {
    const char *trtol, *tolerance, *until;
    bool leaves;
  } CASES[] = {{"run.trtol=1000", "run.tolerance=1e-1", "run.until=95ms", false},
               {"run.trtol=1000", "run.tolerance=1e-1", "run.until=300ms", true},
               {"run.trtol=7", "run.tolerance=1e-4", "run.until=100ms", true}};
  for (size_t k = 0; k < COUNT(CASES); k++) {
    const char *const sets[] = {CASES[k].trtol, CASES[k].tolerance, CASES[k].until, NULL};
    leaving seen = {.since_s = NAN};
    const vs_observer observer = {&seen, note_leaving};
    vs_trial *t = vs_trial_run("paper", "circuit", sets, &observer);
    EXPECT(t->status == VS_OK, "%s", t->err.text);
    EXPECT((seen.times > 0) == CASES[k].leaves, "%s, %s: left %d times", CASES[k].tolerance,
           CASES[k].until, seen.times);
    /* what summary.json tells of it */
    const vs_absence *told = &t->result.watchers.absence;
    const double until_s = t->scene.setup.run.until_s;
    if (!isnan(seen.since_s)) seen.total_s += until_s - seen.since_s;
    CU_ASSERT_EQUAL(told->times, seen.times);
    if (seen.times) CLOSE(told->first_s, seen.first_s, 0);
    CLOSE_OF(told->total_s, seen.total_s, until_s, 1e-15);
    vs_trial_free(t);
  }
}

/* Each capacitor once: those of a subcircuit, and those of the lines behind it. */
static void states_of_a_deck(void) {
  write_file("d.cir", "*$ port mains = Vm\nVm s 0 external\n.subckt pair a b\nC1 a m 1n\n"
                      "C2 m b 1n\n.ends\nC9 s 0 1n\nX1 s 0 pair\nXeva s 0 eva\n");
  vs_trial *t =
      vs_trial_read("paper", "circuit", (const char *const[]){"circuit.deck=d.cir", NULL});
  vs_circuit_states all = {0};
  EXPECT(!t->status && vs_circuit_states_list(&t->scene.setup.deck, &all), "%s", t->err.text);
  CU_ASSERT_EQUAL(all.count, 3);
  vs_trial_free(t);
}

/* What a formula reads besides the capacitor: nothing where it is linear in its signals. */
static void reads_of_a_formula(void) {
  static const struct {
    const char *line;
    size_t reads;
  } CASES[] = {{"B1 b 0 V=-(v(s)+2*v(c))/k+sqrt(2)*v(c) m=2", 0},
               {"E1 b 0 value={v(s)*{k}}", 0},
               {"B1 b 0 V=v(s)*v(c)", 2},
               {"B1 b 0 V=k/v(s)", 1},
               {"E1 b 0 vol = v(s) * v(c)", 2},
               {"E1 b 0 TABLE {v(s)} = (0,0) (1,1)", 1},
               {"B1 b 0 V=f(v(s))", 1},
               {"B1 b 0 V=v(s) v(c)", 2},
               {"R1 b 0 r={1+v(c)}", 1}};
  for (size_t k = 0; k < sizeof CASES / sizeof *CASES; k++) {
    vs_text deck = {0};
    vs_text_add(&deck,
                "*$ port mains = Vm\nVm s 0 external\n.param k=2\n.func f(x) {k*x}\n%s\n"
                "Rb b 0 1\nVc c 0 1\nC9 s 0 1n\nXeva s 0 eva\n",
                CASES[k].line);
    write_file("d.cir", deck.text);
    vs_text_free(&deck);
    vs_trial *t =
        vs_trial_read("paper", "circuit", (const char *const[]){"circuit.deck=d.cir", NULL});
    vs_circuit_states all = {0};
    EXPECT(!t->status && vs_circuit_states_list(&t->scene.setup.deck, &all) &&
               all.count == 1 + CASES[k].reads,
           "%s: %zu %s", CASES[k].line, all.count, t->err.text);
    vs_trial_free(t);
  }
}

static const vs_test TESTS[] = {{"left where it pays", left_where_it_pays},
                                {"states of a deck", states_of_a_deck},
                                {"reads of a formula", reads_of_a_formula}};

VS_SUITE_MAIN("looks", TESTS)
