/* SPDX-License-Identifier: GPL-3.0-or-later
 * The exported netlist: plain ngspice gives with it what the circuit tier gives. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/export.h"
#include "engine/gate.h"
#include "suite.h"

enum { MOST_ROWS = 2101 };

/* The columns that are compared. */
static const int CHANNELS[] = {VS_CH_P, VS_CH_U,      VS_CH_W, VS_CH_PHI,
                               VS_CH_Z, VS_CH_LAMBDA, VS_CH_I, VS_CH_FORCE};
static const char *const COLUMNS[] = {"p_m", "u_m",       "w_m", "phi_rad",
                                      "z_m", "lambda_wb", "i_a", "force_n"};
enum { N_COLUMNS = COUNT(COLUMNS) };

/* ---- plain ngspice ---- */

static size_t count_sets(const char *const *sets) {
  size_t n = 0;
  while (sets[n]) n++;
  return n;
}

static vs_status export(const char *const *sets, vs_error *err) {
  remove("x.cir");
  remove("x.txt");
  return vs_export_command("paper", (char *const *)(size_t)sets, count_sets(sets), "x.cir", err);
}

/* Exit status of `ngspice -b x.cir`, whose words go to x.log. */
static int run_ngspice(void) {
  int how = system("timeout 120 ngspice -b x.cir >x.log 2>&1");
  return WIFEXITED(how) ? WEXITSTATUS(how) : 1000;
}

/* The table as rows of numbers; index[k]: where COLUMNS[k] stands, -1: nowhere. */
typedef struct table {
  double y[MOST_ROWS][32];
  int rows, columns, index[N_COLUMNS];
  char names[2048];
} table;

static int find_column(const char *names, const char *wanted) {
  char copy[2048], *rest = copy;
  snprintf(copy, sizeof copy, "%s", names);
  int n = 0;
  for (char *name; (name = strsep(&rest, " \t\n"));) {
    if (!*name) continue;
    if (!strcmp(name, wanted)) return n;
    n++;
  }
  return -1;
}

static int count_words(const char *text) {
  int n = 0;
  for (text += strspn(text, " \n"); *text; n++) {
    text += strcspn(text, " \n");
    text += strspn(text, " \n");
  }
  return n;
}

static table *read_table(void) {
  table *t = vs_alloc(1, sizeof *t);
  FILE *f = fopen("x.txt", "r");
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  CU_ASSERT_PTR_NOT_NULL(fgets(t->names, sizeof t->names, f));
  t->columns = count_words(t->names);
  CU_ASSERT_FATAL(t->columns <= 32);
  for (int k = 0; k < N_COLUMNS; k++) t->index[k] = find_column(t->names, COLUMNS[k]);
  for (bool more = true; more && t->rows < MOST_ROWS; t->rows += more)
    for (int k = 0; k < t->columns && more; k++) more = fscanf(f, "%lf", &t->y[t->rows][k]) == 1;
  fclose(f);
  return t;
}

/* "name = VALUE" in x.log; NaN: it is not there. */
static double measured(const char *name) {
  FILE *f = fopen("x.log", "r");
  char line[512], word[64];
  double value, found = NAN;
  while (f && fgets(line, sizeof line, f))
    if (sscanf(line, "%63s = %lf", word, &value) == 2 && !strcmp(word, name)) found = value;
  if (f) fclose(f);
  return found;
}

static char *read_text(const char *path) {
  vs_text all = {0};
  FILE *f = fopen(path, "r");
  char part[4096];
  CU_ASSERT_PTR_NOT_NULL_FATAL(f);
  while (fgets(part, sizeof part, f)) vs_text_add(&all, "%s", part);
  fclose(f);
  return all.text;
}

/* ---- the same instants of the circuit tier ---- */

typedef struct samples {
  double y[MOST_ROWS][N_COLUMNS];
  int rows;
} samples;

static vs_status sample(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  samples *s = ctx;
  for (; s->rows < MOST_ROWS && s->rows * 1e-4 <= step->to->t_s; s->rows++)
    for (int k = 0; k < N_COLUMNS; k++)
      s->y[s->rows][k] = vs_step_channel(step, s->rows * 1e-4, CHANNELS[k]);
  return VS_OK;
}

/* Exports, runs both, compares. The circuit tier runs at a tolerance of 1e-5, so that its own error
 * (under continuous firing 9e-4 at the default) is small in the 1e-3 that are asked for. A refusal
 * of bursts that do not fit into the time between pulses is counted where `refusals` asks. */
static void agree(const char *const *sets, int *refusals, int line) {
  const char *finer[16];
  size_t n = count_sets(sets);
  memcpy(finer, sets, n * sizeof *sets);
  finer[n] = "run.tolerance=1e-5";
  finer[n + 1] = NULL;
  samples *s = vs_alloc(1, sizeof *s);
  vs_observer observer = {s, sample};
  vs_error err = {0};
  if (export(sets, &err) == VS_INPUT && refusals && strstr(err.text, "firing.burst_frequency")) {
    ++*refusals;
    return;
  }
  expect(!*err.text, line, "export: %s", err.text);
  expect(run_ngspice() == 0, line, "ngspice fails; see x.log");
  table *t = read_table();
  vs_trial *trial = vs_trial_run("paper", "circuit", finer, &observer);
  expect(trial->status == VS_OK, line, "circuit tier: %s", trial->err.text);
  expect(t->rows >= 600 && abs(t->rows - s->rows) <= 1, line, "%d rows of %d", t->rows, s->rows);
  int rows = t->rows < s->rows ? t->rows : s->rows;
  for (int k = 0; k < N_COLUMNS; k++) {
    double error = 0, peak = 0;
    for (int r = 1; r < rows; r++) { /* the row at 0 is ngspice's extrapolation */
      error = fmax(error, fabs(t->y[r][t->index[k]] - s->y[r][k]));
      peak = fmax(peak, fabs(s->y[r][k]));
    }
    printf(" %.1e", error / peak);
    expect(error <= 1e-3 * peak, line, "%s: off by %.2e of its peak", COLUMNS[k], error / peak);
  }
  const vs_value *v = trial->result.values;
  if (!refusals)
    vs_close(measured("p_first_peak_m"), v[VS_M_GAP_FIRST].value, v[VS_M_GAP_FIRST].value, 1e-3,
             "p_first_peak", line);
  vs_close(measured("i_peak_a"), v[VS_M_I_PEAK].value, v[VS_M_I_PEAK].value, 1e-3, "i_peak", line);
  vs_trial_free(trial);
  free(t);
  free(s);
}
#define AGREE(...) agree((const char *const[]){__VA_ARGS__, NULL}, NULL, __LINE__)

/* ---- plain ngspice against the circuit tier ---- */

static void single_shot(void) {
  AGREE("run.until=0.1s");
}

static void continuous_firing(void) {
  if (is_for_memory_alone()) return;
  AGREE("run.until=0.2s", "firing.every=1", "firing.angle=100deg");
}

static void loaded_on_another_deck(void) {
  AGREE("run.until=0.1s", "firing.every=2", "firing.angle=95deg", "circuit.deck=halfwave_bare",
        "load={density: 1.6 g/cm3, fraction: 0.3}", "machine.m14=derived");
}

static void by_gears_rule(void) {
  if (is_for_memory_alone()) return;
  AGREE("run.until=0.07s", "run.method=gear");
  char *text = read_text("x.cir");
  CU_ASSERT_PTR_NOT_NULL(strstr(text, ".options method=gear "));
  free(text);
}

/* The mains begin within a cycle, and the thyristor fires from the second cycle on. */
static void another_timeline(void) {
  AGREE("run.until=0.1s", "supply.phase=30deg", "supply.frequency=60Hz", "firing.first_cycle=2",
        "firing.every=2", "firing.pulse_width=2ms");
}

/* One strike at 51 ms. */
static void with_eddy_currents(void) {
  AGREE("run.until=0.06s", "circuit.deck=halfwave_bare",
        "actuator.saturation={flux: 1.2 Wb, current: 0.2 A}",
        "actuator.eddy=[{resistance: 15 kohm}, {resistance: 2 kohm, inductance: 0.4 H, coupling: "
        "0.8}]");
}

static void with_a_stop(void) {
  AGREE("run.until=0.07s", "firing.every=1", "firing.angle=80deg",
        "actuator.stop={stiffness: 2e7 N/m, damping: 500 N.s/m}");
}

static void started_in_motion(void) {
  AGREE("run.until=0.1s", "start={p: 1 mm, u: 0.1 mm, w: 0.5 mm, phi: 3e-3 rad, vp: 0.1 m/s, "
                          "vu: 0.02 m/s, vw: 0.05 m/s, vphi: 0.1 rad/s}");
}

/* Each deck that comes with the program, fired in every cycle where the armature does not meet the
 * pole by it. */
static void shipped_decks(void) {
  if (!is_for_memory_alone()) {
    AGREE("run.until=0.06s", "firing.every=1", "circuit.deck=halfwave_paper");
    AGREE("run.until=0.06s", "firing.every=1", "circuit.deck=fullwave_antiparallel");
  }
  AGREE("run.until=0.06s", "circuit.deck=bridge_halfcontrolled");
  if (is_for_memory_alone()) return;
  AGREE("run.until=0.06s", "circuit.deck=chopper", "supply={kind: step, voltage: 100 V}",
        "pwm={carrier: 5 kHz, duty: 0.4}", "circuit.electrolytic_start=100V");
  /* the first peak is the first one behind the switching on */
  AGREE("run.until=0.06s", "circuit.deck=coil_switch", "supply={kind: step, voltage: 100 V}",
        "pwm={on: 20 ms, off: 50 ms}");
  if (!getenv("VS_LONG")) return; /* ten seconds */
  AGREE("run.until=0.06s", "circuit.deck=bridge_link", "supply={voltage: 115 V}",
        "pwm={carrier: 2 kHz, duty: 0.5, depth: 0.5, frequency: 51 Hz}");
}

/* Twenty scenes drawn from a generator with a fixed seed, one of them without VS_LONG. The first
 * peak is not compared: mains that begin at a high voltage may fire a thyristor by its dv/dt, from
 * which the program counts, and the netlist from its first gate pulse. */
static void random_scenes(void) {
  static const char *const DECKS[] = {"halfwave_bare", "halfwave_snubbed", "halfwave_paper",
                                      "fullwave_antiparallel"};
  unsigned long seed = 20261127;
  int refusals = 0;
  for (int n = 0; n < 20; n++) {
    char set[7][64];
    double u[8];
    for (int k = 0; k < 8; k++)
      u[k] = (double)((seed = (seed * 1103515245UL + 12345) & 0x7fffffffUL) >> 8) / 0x800000;
    snprintf(set[0], sizeof *set, "circuit.deck=%s", DECKS[(int)(4 * u[0])]);
    snprintf(set[1], sizeof *set, "supply.voltage=%.4gV", 200 + 240 * u[1]);
    snprintf(set[2], sizeof *set, "supply.frequency=%dHz", u[2] < 0.5 ? 50 : 60);
    snprintf(set[3], sizeof *set, "supply.phase=%.3gdeg", 360 * u[3]);
    snprintf(set[4], sizeof *set, "firing={angle: %.4g deg, every: %d}", 90 + 60 * u[4],
             1 + (int)(3 * u[5]));
    snprintf(set[5], sizeof *set, "supply.resistance=%.3g ohm", 0.1 + u[6]);
    snprintf(set[6], sizeof *set, "load={density: 0.6 g/cm3, fraction: %.3g}", 0.6 * u[7]);
    printf("\n  %s %s %s %s %s:", set[0], set[1], set[2], set[3], set[4]);
    agree((const char *const[]){"run.until=0.08s", set[0], set[1], set[2], set[3], set[4], set[5],
                                set[6], NULL},
          &refusals, __LINE__);
    if (!getenv("VS_LONG")) return;
  }
  CU_ASSERT(refusals <= 5); /* halfwave_paper at 60 Hz, where a gate pulse has no whole bursts */
}

/* What the circuit tier refuses is no result here either: no table, exit status 1. */
static void the_pole_is_met(void) {
  vs_error err = {0};
  CU_ASSERT_EQUAL(
      export((const char *const[]){"run.until=0.1s", "firing.every=1", "firing.angle=90deg", NULL},
             &err),
      VS_OK);
  CU_ASSERT_EQUAL(run_ngspice(), 1);
  CU_ASSERT_NOT_EQUAL(access("x.txt", F_OK), 0);
}

/* The largest current is told by its size, at its own instant: here the mains begin with their
 * negative half, and the coil's first current is its largest. */
static void the_largest_current_is_negative(void) {
  write_file("coil.cir", "*$ port mains = Vmains\nVmains a 0 external\nR1 a b 200\nXeva b 0 eva\n");
  const char *sets[] = {"circuit.deck=coil.cir", "run.until=40ms",      "supply.phase=180deg",
                        "run.tolerance=1e-5",    "supply.voltage=100V", NULL};
  vs_error err = {0};
  CU_ASSERT_EQUAL_FATAL(export(sets, &err), VS_OK);
  CU_ASSERT_EQUAL_FATAL(run_ngspice(), 0);
  vs_trial *trial = vs_trial_run("paper", "circuit", sets, NULL);
  EXPECT(!trial->status, "%s", trial->err.text);
  vs_value peak = trial->result.values[VS_M_I_PEAK];
  CLOSE(measured("i_peak_a"), peak.value, 1e-3);
  vs_trial_free(trial);
  table *t = read_table();
  double most = -INFINITY;
  for (int r = 1; r < t->rows; r++) most = fmax(most, t->y[r][t->index[6]]);
  EXPECT(most < 0.99 * peak.value, "%g A is no smaller than %g A", most, peak.value);
  free(t);
}

/* What a source of gate pulses, or of their sub-pulses, is at. */
static bool is_on(const vs_timeline *line, int source, double t_s) {
  double shift_rad = source % 2 * M_PI;
  return source < 2 ? vs_gate_is_on(line, shift_rad, t_s) : vs_gate_burst(line, shift_rad, t_s);
}

/* Two gates and their sub-pulses, the second ones half a cycle later, seen at every instant that is
 * no edge; probes of every form, one node's name with an operator in it. least: at how many
 * instants sources have to be on. */
static void follow(const char *first_cycle, const char *every, int least, int line_no) {
  write_file("two.cir", "*$ port mains = Vmains\n*$ port gate = Vone\n*$ port gate+180deg = Vtwo\n"
                        "*$ port burst = Vthree\n*$ port burst+180deg = Vfour\n"
                        "*$ probe one = v(g+1) V\n*$ probe two = v(g2,0) V\n"
                        "*$ probe three = v(g3) V\n*$ probe four = v(g4) V\n"
                        "*$ probe minus = -v(g+1) V\n*$ probe between = v(g2,g+1) V\n"
                        "Vmains a 0 external\nVone g+1 0 external\nVtwo g2 0 external\n"
                        "Vthree g3 0 external\nVfour g4 0 external\nR4 g3 0 1k\nR5 g4 0 1k\n"
                        "R1 a b 1k\nR2 g+1 0 1k\nR3 g2 0 1k\nXeva b 0 eva\n");
  enum { SOURCES = 4 };
  const char *sets[] = {"circuit.deck=two.cir",
                        "run.until=0.2s",
                        "supply.phase=-77deg",
                        first_cycle,
                        every,
                        "firing.pulse_width=7.77ms",
                        "firing.burst_frequency=1kHz",
                        "run.max_step=10us",
                        "firing.angle=33deg",
                        NULL};
  vs_error err = {0};
  CU_ASSERT_EQUAL_FATAL(export(sets, &err), VS_OK);
  expect(run_ngspice() == 0, line_no, "ngspice fails; see x.log");
  if (access("x.txt", F_OK)) return;
  table *t = read_table();
  vs_trial *trial = vs_trial_run("paper", "switched", sets, NULL);
  const vs_timeline *line = &trial->scene.setup.timeline;
  expect(t->rows >= 2000, line_no, "%d rows", t->rows);
  int on = 0;
  for (int r = 1; r < t->rows; r++) {
    const double *y = t->y[r] + t->columns - SOURCES - 2;
    CU_ASSERT(y[4] == -y[0] && fabs(y[5] - (y[1] - y[0])) < 1e-9);
    for (int k = 0; k < SOURCES; k++) {
      double at = t->y[r][0], seen = y[k];
      bool wanted = is_on(line, k, at);
      on += wanted;
      /* between two of ngspice's points an edge is a straight line in the table */
      bool near = wanted != is_on(line, k, at - 1e-5) || wanted != is_on(line, k, at + 1e-5);
      expect(near || fabs(seen - wanted) < 1e-9, line_no, "t = %.4g: source %d is at %g V", at, k,
             seen);
    }
  }
  expect(on > least, line_no, "on at %d instants", on);
  vs_trial_free(trial);
  free(t);
}

static void gates_follow_the_timeline(void) {
  follow("firing.first_cycle=2", "firing.every=3", 600, __LINE__);
}

/* The first gate's first pulse is over before the run begins, the second's has begun. */
static void pulses_before_the_run(void) {
  if (is_for_memory_alone()) return;
  follow("firing.first_cycle=0", "firing.every=1", 1800, __LINE__);
  follow("firing.first_cycle=0", "firing.every=2", 900, __LINE__);
  follow("firing.first_cycle=0", "firing.every=once", 40, __LINE__);
  AGREE("run.until=0.1s", "supply.phase=-70deg", "firing.first_cycle=0", "firing.every=1",
        "firing.angle=100deg");
  /* one that ends at t = 0 to the bit */
  AGREE("run.until=0.1s", "supply.phase=136deg", "firing.first_cycle=0", "firing.every=1",
        "firing.angle=100deg", "firing.pulse_width=2ms");
}

/* ---- without ngspice ---- */

/* One file for any machine: no other file is named in it, no source waits for a program. */
static void stands_alone(void) {
  vs_error err = {0};
  CU_ASSERT_EQUAL_FATAL(export((const char *const[]){"run.max_step=7us", NULL}, &err), VS_OK);
  char *text = read_text("x.cir");
  CU_ASSERT_PTR_NULL(strstr(text, ".inc"));
  CU_ASSERT_PTR_NULL(strstr(text, "external"));
  CU_ASSERT_PTR_NULL(strstr(text, VS_TEST_FOLDER));
  CU_ASSERT_PTR_NOT_NULL(strstr(text, "vibrospice " VS_VERSION));
  CU_ASSERT_PTR_NOT_NULL(strstr(text, "ngspice -b x.cir"));
  CU_ASSERT_PTR_NOT_NULL(strstr(text, "M q\" + B q' + K q = (-F, 0, 0, 0), solved for q\"."));
  CU_ASSERT_PTR_NOT_NULL(strstr(text, ".param varistor_voltage=910\n"));
  CU_ASSERT_PTR_NOT_NULL(strstr(text, ".param vs_until=2 ;"));
  CU_ASSERT_PTR_NOT_NULL(strstr(text, ".options method=trap "));
  CU_ASSERT_PTR_NOT_NULL(strstr(text, ".param vs_step=6.9999999999999999e-06 ;"));
  free(text);
}

/* A file's name is a word of the deck's text and of a command: it cannot say more. */
static void names_of_files_are_tamed(void) {
  vs_error err = {0};
  char name[] = "a b\n.control\nshell touch made.cir", *const none[] = {NULL};
  CU_ASSERT_EQUAL_FATAL(vs_export_command("paper", none, 0, name, &err), VS_OK);
  char *text = read_text(name);
  CU_ASSERT_PTR_NOT_NULL(strstr(text, "wrdata a_b_.control_shell_touch_made.txt "));
  CU_ASSERT_PTR_NULL(strstr(text, "shell touch"));
  free(text);
  remove(name);
}

/* What the netlist would leave out without a word is refused. */
static void what_is_not_exported(void) {
  static const struct {
    const char *sets[3], *says;
  } ALL[] = {{{"firing.every=1", "control.law=none"}, "one angle for all firings"},
             {{"firing.every=1", "start=steady"}, "the orbit that start: steady begins on"},
             {{"firing.angle=[[0 s, 160 deg], [1 s, 100 deg]]", "firing.every=1"}, "a table over"}};
  for (size_t k = 0; k < COUNT(ALL); k++) {
    vs_error err = {0};
    EXPECT(export(ALL[k].sets, &err) == VS_INPUT, "%s is exported", ALL[k].sets[1]);
    EXPECT(strstr(err.text, ALL[k].says) != NULL, "%s", err.text);
  }
}

static void names_of_our_own_are_refused(void) {
  static const struct {
    const char *line, *says[2];
  } ROWS[] = {
      {"R1 a vs_p 1k", {"d.cir:4:1: ", "vs_"}},
      {"Rvs_x a 0 1k", {"d.cir:4:1: ", "vs_"}},
      {".param VS_X=1", {"d.cir:4:1: ", "vs_"}},
      {"*$ param vs_x = 1 ohm 0..2 \"x\"", {"d.cir", "vs_x"}},
      {"*$ probe z = v(c) m\nEc c 0 a 0 1", {"d.cir:4:10: ", "probe z"}},
      {"*$ probe i_peak = i(Vs_m) A", {"d.cir", "i_peak_a"}},
      {"*$ probe x = v(i_a) V\nR1 a i_a 1k", {"d.cir", "i_a"}},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text deck = {0};
    vs_error err = {0};
    vs_text_add(&deck, "*$ port mains = Vs_m\nVs_m a 0 external\nXeva a 0 eva\n%s\n", ROWS[k].line);
    write_file("d.cir", deck.text);
    vs_text_free(&deck);
    vs_status status = export((const char *const[]){"circuit.deck=d.cir", NULL}, &err);
    EXPECT(status == VS_INPUT, "'%s' is taken", ROWS[k].line);
    for (int w = 0; w < 2; w++)
      EXPECT(strstr(err.text, ROWS[k].says[w]), "'%s': %s", ROWS[k].line, err.text);
    CU_ASSERT_NOT_EQUAL(access("x.cir", F_OK), 0);
  }
}

static void a_source_may_be_called_vs(void) {
  vs_error err = {0};
  write_file("d.cir", "*$ port mains = Vs_m\nVs_m a 0 external\nXeva a 0 eva\n");
  CU_ASSERT_EQUAL(export((const char *const[]){"circuit.deck=d.cir", NULL}, &err), VS_OK);
}

/* A relay's armature first settles on its stop by 0.1 um: its first peak is the stroke's end, in
 * ngspice as in a run. */
static void a_ripple_is_no_peak(void) {
  const char *sets[] = {"run.until=12 ms", "run.verify=never", NULL};
  vs_error err = {0};
  remove("x.cir");
  CU_ASSERT_FALSE(
      vs_export_command("relay", (char *const *)(size_t)sets, count_sets(sets), "x.cir", &err));
  CU_ASSERT_FALSE(run_ngspice());
  vs_trial *t = vs_trial_run("relay", "circuit", sets, NULL);
  CLOSE(measured("s_first_peak_m"), t->result.values[VS_M_GAP_FIRST].value, 1e-3);
  CU_ASSERT_TRUE(measured("s_first_peak_m") < -1e-3);
  vs_trial_free(t);
}

static const vs_test TESTS[] = {
    {"stands alone", stands_alone},
    {"names of files", names_of_files_are_tamed},
    {"names of our own", names_of_our_own_are_refused},
    {"what is not exported", what_is_not_exported},
    {"a source may be called Vs...", a_source_may_be_called_vs},
    {"single shot", single_shot},
    {"continuous firing", continuous_firing},
    {"another deck, loaded", loaded_on_another_deck},
    {"by Gear's rule", by_gears_rule},
    {"another timeline", another_timeline},
    {"eddy currents", with_eddy_currents},
    {"with a stop", with_a_stop},
    {"started in motion", started_in_motion},
    {"shipped decks", shipped_decks},
    {"random scenes", random_scenes},
    {"the pole is met", the_pole_is_met},
    {"a negative current", the_largest_current_is_negative},
    {"two gates", gates_follow_the_timeline},
    {"pulses before the run", pulses_before_the_run},
    {"a ripple is no peak", a_ripple_is_no_peak},
};
enum { WITHOUT_NGSPICE = 4 };

int main(void) {
  bool there = on_path("ngspice");
  if (!there) puts("ngspice is not on the PATH: what it gives is not compared");
  return vs_suite("export", TESTS, there ? COUNT(TESTS) : WITHOUT_NGSPICE);
}
