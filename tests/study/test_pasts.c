/* SPDX-License-Identifier: GPL-3.0-or-later
 * Cases that share their past (study/workers/shared_prefix.h): the bytes of a study are those of
 * cases run from their beginning, for every kind of event, any number of workers, in shards, and
 * whatever process is killed meanwhile. */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/text.h"
#include "engine/budget.h"
#include "engine/events.h"
#include "program.h"
#include "study/workers/divergence.h"

/* Surges on a machine that has been fired. */
static const char SURGES[] =
    "set: {firing.every: 1, run: {until: 46 ms, tolerance: 1e-2, tier: circuit}, events: {surge1: "
    "{kind: surge, cycle: 2}}}\n"
    "vary:\n"
    "  events.surge1.angle: [10 deg, 90 deg, 101 deg, 260 deg]\n"
    "  events.surge1.polarity: ['+', '-']\n"
    "report: [p_min, i_peak, v_ak_min]\n";

/* Runs the study and returns how many cases had their past from another; -1: it came to no end. */
static int shared(const char *words) {
  ran r = run("study %s --progress json%s", words, strstr(words, "--resume") ? "" : " --overwrite");
  int n = 0; /* the last line's */
  for (const char *s = r.out; (s = strstr(s, "\"shared\": ")); s += 10) n = atoi(s + 10);
  if (r.status != 0 && r.status != 1 && r.status != 3) n = -1;
  free_ran(&r);
  return n;
}

static void expect_shared(const char *words, int wanted, int line) {
  int n = shared(words);
  expect(n == wanted, line, "%s: %d cases shared their past, not %d", words, n, wanted);
}
#define EXPECT_SHARED(words, wanted) expect_shared(words, wanted, __LINE__)

/* Writes s.yaml and, once, what comes of it case by case. */
static void write_surges(void) {
  write_file("s.yaml", SURGES);
  if (access("whole/study.csv", F_OK)) EXPECT_SHARED("s.yaml -o whole --no-sharing", 0);
}

/* ---- the same bytes ---- */

static void any_number_of_workers(void) {
  write_surges();
  EXPECT_SHARED("s.yaml -o one --jobs 1", 8);
  EXPECT_SHARED("s.yaml -o three --jobs 3", 8);
  SAME_STUDY("whole", "one");
  SAME_STUDY("whole", "three");
}

static void in_shards(void) {
  write_surges();
  EXPECT_SHARED("s.yaml -o shards/1 --shard 1/3 --jobs 1", 3);
  EXPECT_SHARED("s.yaml -o shards/2 --shard 2/3 --jobs 2", 3);
  EXPECT_SHARED("s.yaml -o shards/3 --shard 3/3 --jobs 1", 2);
  RUN_GOOD("merge shards -o merged --quiet");
  SAME_STUDY("whole", "merged");
}

/* Each row: the scene's events, its other keys, what is varied, how many cases there are and how
 * many share. The instants lie before, between and on the edges of the gate's pulse, which is from
 * 5.56 to 13.56 ms of each cycle. */
static const struct mix {
  const char *name, *events, *keys, *vary;
  int n_shared;
} MIXES[] = {
    {"sag", "{e: {kind: sag, at: 50 ms}}", "", "{events.e.at: [25 ms, 45.5555555555556 ms, 52 ms]}",
     3},
    {"missing", "{e: {kind: missing_pulse, cycle: 3}}", "", "{events.e.cycle: [1, 2, 3]}", 3},
    {"weak", "{e: {kind: weak_pulse, cycle: 3}}", "", "{events.e.level: [0.1 %, 5 %, 100 %]}", 2},
    {"spurious", "{e: {kind: spurious_pulse, at: 30 ms}}", "", "{events.e.at: [22 ms, 41 ms]}", 2},
    {"jam", "{e: {kind: jam, at: 30 ms}}", "", "{events.e.at: [30 ms, 25.5555555555556 ms]}", 2},
    {"load", "{e: {kind: load, at: 30 ms, volume: 700 cm3}}", ", load.density: 1 g/cm3",
     "{events.e.at: [25 ms, 33.5555555555556 ms], events.e.fraction: [0.2, 0.6]}", 4},
    {"jump", "{e: {kind: phase_jump, at: 30 ms}}", "", "{events.e.at: [30 ms, 42 ms]}", 2},
    {"notch", "{e: {kind: notch, at: 30 ms, count: 2}}", "", "{events.e.at: [21 ms, 41 ms]}", 2},
    {"harmonic", "{e: {kind: harmonic, at: 30 ms}}", "", "{events.e.order: [3, 5]}", 2},
    {"short", "{e: {kind: short, element: R1, at: 30 ms}}", "", "{events.e.at: [25 ms, 41 ms]}", 2},
    {"open", "{e: {kind: open, element: R1, at: 30 ms}}", "", "{events.e.at: [25 ms, 41 ms]}", 2},
    {"coil", "{e: {kind: coil_short, at: 30 ms}}", "", "{events.e.fraction: [30 %, 100 %]}", 2},
    {"ring", "{e: {kind: ring_wave, at: 30 ms}}", "", "{events.e.at: [25 ms, 41 ms]}", 2},
    {"eft", "{e: {kind: eft, at: 30 ms, duration: 1 ms}}", "",
     "{events.e.frequency: [5 kHz, 10 kHz]}", 2},
    {"two", "{a: {kind: sag, at: 21 ms, duration: 5 ms}, b: {kind: missing_pulse, cycle: 3}}", "",
     "{events.a.level: [0 %, 40 %], events.b.cycle: [2, 3]}", 4},
    {"fixed", "{a: {kind: sag, at: 1 ms}, b: {kind: missing_pulse, cycle: 3}}", "",
     "{events.b.cycle: [2, 3]}", 2},
    {"verified", "{e: {kind: surge, cycle: 2}}",
     ", run.verify: always, circuit.deck: halfwave_paper",
     "{run.until: [40 ms], events.e.angle: [10 deg, 200 deg]}", 2},
    {"stop", "{e: {kind: swell, at: 40 ms}}", ", actuator.stop: {stiffness: 1e6 N/m}",
     "{events.e.level: [110 %, 300 %]}", 1}, /* one has blows, and takes other steps */
    {"left", "{e: {kind: surge, at: 50 ms}}", "",
     "{firing.every: [20], run.until: [450 ms], events.e.at: [50 ms, 270 ms, 431 ms]}", 3},
    {"decks", "{e: {kind: surge, cycle: 3}}", "",
     "{events.e.angle: [10 deg, 200 deg], circuit.r1: [100 ohm, 4.7 kohm]}", 4},
    {"orbit", "{e: {kind: surge, cycle: 1}}", ", start: steady",
     "{events.e.angle: [0 deg, 90 deg, 200 deg]}", 3},
    {"charged", "{e: {kind: load, at: 10 ms, volume: 300 cm3}}",
     ", start: steady, load: {density: 0.5 g/cm3, fraction: auto}",
     "{events.e.at: [2 ms, 10 ms], events.e.volume: [300 cm3, 380 cm3]}", 4},
    /* the first has no past, the last is refused, and the ideal tier has none to share */
    {"early", "{e: {kind: sag, at: 1 ms}}", "", "{events.e.at: [1 ms, 30 ms, 90 ms]}", 1},
    {"tiers", "{e: {kind: sag, at: 30 ms}}", "",
     "{run.tier: [circuit, switched], events.e.at: [30 ms, 41 ms]}", 2},
};

static void every_kind_of_event(void) {
  for (size_t k = 0; k < COUNT(MIXES); k++) {
    const struct mix *m = &MIXES[k];
    vs_text study = {0};
    char apart[64], together[64], words[128];
    snprintf(apart, sizeof apart, "%s_apart", m->name);
    snprintf(together, sizeof together, "%s_together", m->name);
    vs_text_add(&study,
                "set: {firing.every: 1, run: {until: 54 ms, tolerance: 1e-2, tier: circuit}, "
                "events: %s%s}\nvary: %s\nreport: [p_min, i_peak, v_ak_min]\n",
                m->events, m->keys, m->vary);
    write_file("m.yaml", study.text);
    vs_text_free(&study);
    snprintf(words, sizeof words, "m.yaml -o %s --no-sharing", apart);
    shared(words);
    snprintf(words, sizeof words, "m.yaml -o %s --jobs %zu", together, 1 + k % 2);
    int n = shared(words);
    EXPECT(n == m->n_shared, "%s: %d cases shared their past, not %d", m->name, n, m->n_shared);
    SAME_STUDY(apart, together);
  }
}

/* A search asks for its cases batch after batch; the shared prefix is there for all of them. */
static void a_search(void) {
  write_file("f.yaml", "set: {firing.every: 1, run: {until: 46 ms, tolerance: 1e-2}, events: "
                       "{surge1: {kind: surge, cycle: 3}}}\n"
                       "vary: {events.surge1.angle: {from: 0 deg, to: 40 deg}}\n"
                       "find: {worst: max v_ak_max, n: 16, seed: 3}\nreport: [v_ak_max]\n");
  shared("f.yaml -o apart --no-sharing");
  EXPECT(shared("f.yaml -o together --jobs 2") >= 12, "a search shares its cases' past");
  SAME_STUDY("apart", "together");
}

static void not_shared(void) {
  write_file("k.yaml", "set: {firing.every: 1, run: {until: 30 ms, tier: circuit}, events: {e: "
                       "{kind: sag, at: 25 ms}}}\nvary: {events.e.at: [25 ms, 28 ms]}\n");
  EXPECT_SHARED("k.yaml -o kept --keep runs", 0); /* each run has a file of its own */
  write_file("t.yaml", "set: {firing.every: 1, run: {until: 30 ms, tier: circuit}, events: {e: "
                       "{kind: sag, at: 25 ms}}}\nvary: {firing.angle: [100 deg, 110 deg]}\n");
  EXPECT_SHARED("t.yaml -o angles", 0);
}

/* ---- what is killed ---- */

static void wait_s(double s) {
  struct timespec t = {(time_t)s, (long)(1e9 * fmod(s, 1))};
  nanosleep(&t, NULL);
}

static pid_t child_of(pid_t parent) {
  char path[64], text[64] = "";
  snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)parent, (int)parent);
  FILE *f = fopen(path, "r");
  if (!f || !fgets(text, sizeof text, f)) *text = '\0';
  if (f) fclose(f);
  return (pid_t)atoi(text);
}

/* The process so many forks below the study's own: its worker, that one's runner, its branch; 0:
 * there is none now. */
static pid_t below(pid_t master, int forks) {
  pid_t pid = master;
  for (int k = 0; k < forks && pid; k++) pid = child_of(pid);
  return pid;
}

static pid_t start(const char *words) {
  char copy[256];
  const char *argv[MOST_WORDS];
  snprintf(copy, sizeof copy, "%s", words);
  split(copy, argv);
  return spawn(argv);
}

/* Signals the process so many forks below once there is one; false: there never was. */
static bool signal_below(pid_t master, int forks, int number) {
  for (double end = vs_budget_clock_s() + 20; vs_budget_clock_s() < end; wait_s(0.002)) {
    pid_t pid = below(master, forks);
    if (pid && pid != master) return kill(pid, number) == 0;
    if (!below(master, 1)) wait_s(0.01);
  }
  return false;
}

/* kill -9 of a branch, of a runner, of a worker: the study does not mind. */
static void a_copy_is_killed(void) {
  write_surges();
  for (int forks = 1; forks <= 3; forks++) {
    remove_tree("killed");
    pid_t master = start("study s.yaml -o killed --jobs 1 --quiet");
    EXPECT(signal_below(master, forks, SIGKILL), "nothing %d forks below", forks);
    ran r = collect(master);
    EXPECT(r.status == 0, "exit status %d: %s", r.status, r.err);
    free_ran(&r);
    SAME_STUDY("whole", "killed");
  }
}

/* A branch that does not come to its end costs its worker; the cases are then run one by one. */
static void a_copy_hangs(void) {
  write_surges();
  pid_t master = start("study s.yaml -o hung --jobs 1 --quiet --case-timeout 8s");
  EXPECT(signal_below(master, 3, SIGSTOP), "no branch");
  ran r = collect(master);
  EXPECT(r.status == 0, "exit status %d: %s", r.status, r.err);
  free_ran(&r);
  SAME_STUDY("whole", "hung");
}

/* kill -9 of the study itself; nobody outlives it, and --resume ends with the same bytes. */
static void broken_off(void) {
  write_surges();
  pid_t master = start("study s.yaml -o broken --jobs 1 --quiet"), branch = 0;
  for (double end = vs_budget_clock_s() + 20; !branch && vs_budget_clock_s() < end; wait_s(0.002))
    branch = below(master, 3);
  kill(master, SIGKILL);
  ran r = collect(master);
  CU_ASSERT_EQUAL(r.status, 1000 + SIGKILL);
  free_ran(&r);
  for (double end = vs_budget_clock_s() + 5; !kill(branch, 0) && vs_budget_clock_s() < end;)
    wait_s(0.01);
  EXPECT(branch && kill(branch, 0), "the branch %d outlives its study", (int)branch);
  EXPECT_SHARED("s.yaml -o broken --resume --jobs 2", 8);
  SAME_STUDY("whole", "broken");
}

/* ---- where runs part ---- */

static double parts(const char *one, const char *other) {
  const char *const a[] = {"run.until=60ms", "firing.every=1", one, NULL}, *const b[] = {
                                                                               "run.until=60ms",
                                                                               "firing.every=1",
                                                                               other, NULL};
  vs_trial *x = vs_trial_read("paper", "circuit", a), *y = vs_trial_read("paper", "circuit", b);
  double parts_s = vs_divergence_of(&x->scene.setup, &y->scene.setup);
  CU_ASSERT_EQUAL(x->status + y->status, 0);
  vs_trial_free(x), vs_trial_free(y);
  return parts_s;
}

/* At the last edge that both have, which is not later than what differs. */
static void partings(void) {
  const double rise_s = 0.1 / 18, fall_s = rise_s + 8e-3, cycle_s = 20e-3;
  CLOSE(parts("events={e: {kind: surge, at: 50 ms}}", "events={e: {kind: surge, at: 55 ms}}"),
        2 * cycle_s + rise_s, 1e-9);
  CLOSE(parts("events={e: {kind: surge, at: 50 ms}}", "events={e: {kind: surge, at: 44 ms}}"),
        cycle_s + fall_s, 1e-9);
  CLOSE(parts("events={e: {kind: surge, at: 50 ms, level: 1 kV}}",
              "events={e: {kind: surge, at: 50 ms, level: 2 kV}}"),
        50e-3, 1e-9);
  CLOSE(parts("events={e: {kind: weak_pulse, cycle: 2, level: 10 %}}",
              "events={e: {kind: weak_pulse, cycle: 2, level: 20 %}}"),
        cycle_s + rise_s, 1e-9);
  CLOSE(parts("events={e: {kind: sag, at: 30 ms, duration: 3 ms}}",
              "events={e: {kind: sag, at: 30 ms, duration: 4 ms}}"),
        30e-3, 1e-9);
  CU_ASSERT_EQUAL(
      parts("events={e: {kind: surge, at: 1 ms}}", "events={e: {kind: surge, at: 2 ms}}"), 0);
  CU_ASSERT_TRUE(
      isinf(parts("events={e: {kind: surge, at: 50 ms}}", "events={e: {kind: surge, at: 50 ms}}")));
}

static const vs_test TESTS[] = {
    {"partings", partings},
    {"any number of workers", any_number_of_workers},
    {"in shards", in_shards},
    {"every kind of event", every_kind_of_event},
    {"a search", a_search},
    {"not shared", not_shared},
    {"a copy is killed", a_copy_is_killed},
    {"a copy hangs", a_copy_hangs},
    {"broken off", broken_off},
};

int main(void) {
  return program_suite("pasts", TESTS, COUNT(TESTS));
}
