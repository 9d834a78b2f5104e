/* SPDX-License-Identifier: GPL-3.0-or-later
 * The machine's motion in the circuit: nodes of the EVA that a deck may name. Their values are the
 * machine's state, to the order of the step that engine/coupled/trajectory.h states, on every machine that
 * ships, with every file and law of the EVA, and in the exported deck. The netlist has a source for
 * a node only where the deck names it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"

/* ---- node against state ---- */

/* A half-wave thyristor; `more` are lines of the test's own. */
static void write_deck(const char *path, const char *more) {
  vs_text deck = {0};
  vs_text_add(&deck,
              "*$ port mains = Vmains\n*$ port gate = Vgate\n*$ param thyristor = latch part\n"
              "*$ probe i_thyristor = i(Vthy) A\n*$ store c1 = 47n*v(c,b)^2/2\n"
              "*$ store ls = {l_source}*i(Vmains)^2/2\n%s"
              "Vmains src 0 external\nRsource src s {r_source}\nLsource s a {l_source} ic=0\n"
              "Vgate g b external\nVthy a t 0\nXthy t b g thyristor\nR1 a c 330\nC1 c b 47n ic=0\n"
              "Xeva b 0 eva\n",
              more);
  write_file(path, deck.text);
  vs_text_free(&deck);
}

/* A deck with a probe of every node that the machine has. */
static void write_probes(const vs_machine *m) {
  vs_text all = {0};
  vs_text_add(&all, "*$ probe n_z = v(xeva.z) m\n*$ probe n_vz = v(xeva.vz) m/s\n");
  for (int k = 0; k < m->dof; k++) {
    const vs_coordinate *c = &m->coordinates[k];
    vs_text_add(&all, "*$ probe n_q%d = v(XEVA.q_%s) %s\n*$ probe n_v%d = v(xeva.v_%s) %s\n", k,
                c->name, c->unit, k, c->name, c->rate_unit);
  }
  write_deck("probes.cir", all.text);
  vs_text_free(&all);
}

enum { GAP, GAP_RATE, COORDINATES, RATES, KINDS };

typedef struct seen {
  double worst[KINDS], peak[KINDS][VS_MOST_STATES];
  double error[KINDS][VS_MOST_STATES];
  long steps;
  bool without; /* the solver was left */
} seen;

static void look(seen *s, int kind, int k, double node, double state) {
  s->peak[kind][k] = fmax(s->peak[kind][k], fabs(state));
  s->error[kind][k] = fmax(s->error[kind][k], fabs(node - state));
}

/* Holds the probes of a solver's step against the state at its end. At a step of no length, which
 * shows the far side of an instant, the probes are those of the near side. */
static vs_status watch(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  seen *s = ctx;
  const vs_knot *k = step->to;
  const vs_model *m = step->frame->model;
  if (k->t_s <= step->from->t_s) return VS_OK;
  for (size_t p = 0; p < step->frame->deck->n_probes; p++) {
    const vs_probe *probe = &step->frame->deck->probes[p];
    double node = probe->sign * k->terms[probe->term];
    int n = 0;
    if (!strcmp(probe->name, "n_z"))
      look(s, GAP, 0, node, vs_mechanics_gap(m, k->x));
    else if (!strcmp(probe->name, "n_vz"))
      look(s, GAP_RATE, 0, node, vs_mechanics_travel(m, k->x + m->dof));
    else if (sscanf(probe->name, "n_q%d", &n) == 1)
      look(s, COORDINATES, n, node, k->x[n]);
    else if (sscanf(probe->name, "n_v%d", &n) == 1)
      look(s, RATES, n, node, k->x[m->dof + n]);
  }
  s->without = s->without || step->periodic;
  s->steps++;
  return VS_OK;
}

static seen run_probes(const char *scene, const char *const *sets) {
  seen s = {.steps = 0};
  const vs_observer also = {&s, watch};
  vs_trial *t = vs_trial_run(scene, "circuit", sets, &also);
  EXPECT(t->status == VS_OK, "%s: %s", scene, t->err.text);
  for (int kind = 0; kind < KINDS; kind++)
    for (int k = 0; k < VS_MOST_STATES; k++)
      if (s.peak[kind][k] > 0)
        s.worst[kind] = fmax(s.worst[kind], s.error[kind][k] / s.peak[kind][k]);
  vs_trial_free(t);
  return s;
}

static void for_scene(const char *scene) {
  vs_trial *t = vs_trial_read(scene, NULL, NULL);
  EXPECT(t->status == VS_OK, "%s: %s", scene, t->err.text);
  if (t->status == VS_OK) write_probes(t->scene.setup.machine);
  vs_trial_free(t);
}

/* Over a step h a rate is foretold up to h^3, what it is the rate of up to h^4: half the step makes
 * an eighth and a sixteenth of the error. A half of that is left for steps that are shorter anyway
 * behind a firing. */
static void of_the_order_that_is_stated(void) {
  static const char *const STEPS[] = {"run.max_step=80us", "run.max_step=40us",
                                      "run.max_step=20us"};
  static const double LEAST[KINDS] = {8, 4, 8, 4};
  double before[KINDS] = {0};
  for_scene("paper");
  for (size_t n = 0; n < COUNT(STEPS); n++) {
    const char *const sets[] = {"circuit.deck=probes.cir", STEPS[n],         "run.tolerance=1e-3",
                                "run.until=30ms",          "firing.every=1", NULL};
    seen s = run_probes("paper", sets);
    for (int k = 0; k < KINDS; k++) {
      EXPECT(s.worst[k] > 0 && (!n || before[k] / s.worst[k] > LEAST[k]),
             "kind %d: %.2e behind %.2e", k, s.worst[k], before[k]);
      before[k] = s.worst[k];
    }
  }
  printf(" at 20 us z %.1e vz %.1e q %.1e v %.1e of the peak", before[0], before[1], before[2],
         before[3]);
}

/* By the tolerance alone the nodes are far within it. */
static void within_the_tolerance(void) {
  static const struct {
    const char *set;
    double tolerance;
  } ROWS[] = {{"run.tolerance=1e-3", 1e-3},
              {"run.tolerance=5e-4", 5e-4},
              {"run.tolerance=1e-4", 1e-4},
              {"run.tolerance=1e-5", 1e-5}};
  for_scene("paper");
  for (size_t n = 0; n < COUNT(ROWS); n++) {
    const char *const sets[] = {"circuit.deck=probes.cir", ROWS[n].set, "run.until=60ms",
                                "firing.every=1", NULL};
    seen s = run_probes("paper", sets);
    printf(" %s: z %.1e, vz %.1e;", ROWS[n].set, s.worst[GAP], s.worst[GAP_RATE]);
    for (int k = 0; k < KINDS; k++)
      EXPECT(s.worst[k] < ROWS[n].tolerance / 10, "%s: kind %d: %.2e", ROWS[n].set, k, s.worst[k]);
  }
}

/* Every machine that ships, and every file and law of the EVA's: a tenth of run.tolerance, as
 * above, and run.tolerance itself where the armature meets a stop within a step. */
static void on_every_machine_and_eva(void) {
  static const char STOP[] = "actuator.stop={stiffness: 1e6 N/m, damping: 100 N.s/m}";
  static const struct {
    const char *scene, *sets[4];
    double most;
  } ROWS[] = {
      {"fixed_base", {"run.until=60ms"}, 1e-5},
      {"two_mass", {"run.until=60ms"}, 1e-5},
      {"paper", {"run.until=60ms", "machine.model=conveyor_bodies"}, 1e-5},
      {"lds_v203",
       {"run.until=40ms", "firing.valve=thyristor", "firing.angle=100deg", "supply.kind=sine"},
       1e-5},
      {"paper", {"run.until=60ms", "firing.every=1", "firing.angle=85deg", STOP}, 1e-4},
      {"paper",
       {"run.until=60ms", "events={s: {kind: coil_short, at: 25 ms, fraction: 30 %}}"},
       1e-5},
      {"paper", {"run.until=60ms", "events={s: {kind: jam, at: 25 ms}}"}, 1e-5},
      {"paper",
       {"run.until=60ms", "actuator.saturation={law: series, flux: 1.2 Wb, exponent: 7, "
                          "current: 0.2 A}"},
       1e-5},
      {"paper", {"run.until=0.5s", "firing.every=8"}, 1e-5}, /* of eva_led.inc */
  };
  for (size_t n = 0; n < COUNT(ROWS); n++) {
    const char *sets[COUNT(ROWS[n].sets) + 2] = {"circuit.deck=probes.cir"};
    memcpy(sets + 1, ROWS[n].sets, sizeof ROWS[n].sets);
    for_scene(ROWS[n].scene);
    seen s = run_probes(ROWS[n].scene, sets);
    printf(" %s %.1e %.1e", ROWS[n].scene, s.worst[GAP_RATE], s.worst[RATES]);
    EXPECT(s.steps > 100 && s.peak[GAP_RATE][0] > 0, "%s %s: nothing moves", ROWS[n].scene,
           sets[2]);
    for (int k = 0; k < KINDS; k++)
      EXPECT(s.worst[k] < ROWS[n].most, "%s %s: kind %d: %.2e", ROWS[n].scene, sets[2], k,
             s.worst[k]);
  }
}

/* ---- what a deck may name ---- */

/* A deck that names no motion has no source for it, and one that names a node twice has one. */
static void a_source_where_it_is_named(void) {
  write_deck("one.cir", "Ea m1 0 xeva.vz 0 1\nBa m2 0 V=2*v(XEVA.VZ)*v(xeva.z)\n");
  const struct {
    const char *deck;
    size_t motions;
    bool reads;
  } ROWS[] = {{"circuit.deck=halfwave_snubbed", 0, false}, {"circuit.deck=one.cir", 1, true}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_trial *t = vs_trial_read("paper", "circuit", (const char *const[]){ROWS[k].deck, NULL});
    EXPECT(t->status == VS_OK, "%s", t->err.text);
    CU_ASSERT_EQUAL(t->scene.setup.deck.n_motions, ROWS[k].motions);
    CU_ASSERT_EQUAL(t->scene.setup.deck.reads_eva.file != NULL, ROWS[k].reads);
    vs_trial_free(t);
  }
}

static void other_names_are_refused(void) {
  static const struct {
    const char *lines, *at, *says;
  } ROWS[] = {
      {"Ea m1 0 xeva.foo 0 1\n", "bad.cir:7:9: ", "xeva.z, xeva.lam, xeva.vz, xeva.q_p"},
      {"Ba m1 0 V=v(xeva.z)+v(xeva.v_pp)\n", "bad.cir:7:23: ", "did you mean 'xeva.v_p'?"},
      {"*$ probe b = v(xeva.q_phy) rad\n", "bad.cir:7:14: ", "did you mean 'xeva.q_phi'?"},
      {"Rb xeva.lam m1 1k\n", "bad.cir:7:4: ", "E1 a 0 xeva.lam 0 1"},
      {"Xm xeva.lam meter\n.subckt meter a\nRa a 0 1\n.ends\n",
       "bad.cir:7:4: ", "a source read it"},
      {"*$ loss b = v(xeva.y)^2\n", "bad.cir:7:", "xeva.y"},
      {"Xm m1 meter\n.subckt meter a\nBa a 0 V=v(xeva.z)\nRa a 0 1\n.ends\n",
       "bad.cir:9:12: ", ".global xeva.z"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    write_deck("bad.cir", ROWS[k].lines);
    ran r = run("check bad.cir");
    EXPECT(r.status == 2 && strstr(r.err, ROWS[k].at) == r.err && strstr(r.err, ROWS[k].says),
           "case %zu: %d: %s", k, r.status, r.err);
    free_ran(&r);
  }
  remove("bad.cir");
  write_deck("good.cir", "Xm m1 meter\n.global xeva.z\n.subckt meter a\nBa a 0 V=v(xeva.z)\n"
                         "Ra a 0 1\n.ends\n*$ probe g = v(m1) m\n");
  RUN_GOOD("run paper --set circuit.deck=good.cir --set run.until=5ms -o out --quiet");
  write_deck("good.cir", "Ba m1 0 V=v(xeva.lam)\nEb m2 0 xeva.lam 0 1\nRb xeva.z m2 1k\n");
  RUN_GOOD("run paper --set circuit.deck=good.cir --set run.until=5ms -o out --quiet");
}

/* A feedback is nothing that an ideal thyristor has; a probe alone is. */
static void ideal_tiers_refuse_it(void) {
  write_deck("reads.cir", "Ea m1 0 xeva.vz 0 1\n");
  write_deck("shows.cir", "*$ probe g = v(xeva.z) m\n");
  static const char *const TIERS[] = {"analytic", "switched"};
  for (size_t k = 0; k < COUNT(TIERS); k++) {
    ran r = run("run paper --set circuit.deck=reads.cir --tier %s", TIERS[k]);
    EXPECT(r.status == 2 && strstr(r.err, "reads.cir:7:9: ") && strstr(r.err, TIERS[k]) &&
               strstr(r.err, "take tier circuit or auto"),
           "%d: %s", r.status, r.err);
    free_ran(&r);
    r = run("run paper --set circuit.deck=shows.cir --tier %s --set run.until=5ms", TIERS[k]);
    EXPECT(r.status == 0, "%s", r.err);
    free_ran(&r);
  }
  ran r = run("run paper --set circuit.deck=reads.cir --set run.until=5ms");
  EXPECT(r.status == 0 && strstr(r.out, "tier   circuit (auto"), "%s%s", r.out, r.err);
  free_ran(&r);
}

/* With an element that reads the motion the run is the same whether the circuit may be left or not,
 * and says so; without it this circuit is left. */
static void the_circuit_is_not_left(void) {
  static const char *const LINES[] = {"", "Ea m1 0 xeva.q_u 0 1\n"};
  static const char RUN[] = "run paper --set circuit.deck=quiet.cir --set run.until=0.3s --quiet ";
  for (int reads = 0; reads < 2; reads++) {
    write_deck("quiet.cir", LINES[reads]);
    ran a = run("%s -o a", RUN), b = run("%s -o b --set run.leave_circuit=never", RUN);
    EXPECT(a.status == 0 && b.status == 0, "%s%s", a.err, b.err);
    char *one = read_file("a/run.csv"), *other = read_file("b/run.csv");
    char *summary = read_file("a/summary.json");
    CU_ASSERT_EQUAL(!strcmp(one, other), reads);
    CU_ASSERT_EQUAL(strstr(summary, "reads the machine's motion") != NULL, reads);
    free(one);
    free(other);
    free(summary);
    free_ran(&a);
    free_ran(&b);
  }
}

/* ---- the example of docs/circuits.md ---- */

/* Writes the netlist of the page that begins with "* NAME:". */
static void write_example(const char *name) {
  char begin[64];
  char *page = read_file(VS_TEST_FOLDER "/../docs/circuits.md");
  snprintf(begin, sizeof begin, "```spice\n* %s:", name);
  char *at = strstr(page, begin), *end = at ? strstr(at + 8, "```") : NULL;
  EXPECT(end, "%s: no such example", name);
  if (end) *end = '\0';
  write_file(name, at ? at + strlen("```spice\n") : "");
  free(page);
}

enum { MOST_ROWS = 8000, MOST_COLUMNS = 40 };
typedef struct table {
  char names[MOST_COLUMNS][64];
  double (*row)[MOST_COLUMNS];
  int columns, rows;
} table;

static table read_table(const char *path, const char *between) {
  table t = {.row = vs_alloc(MOST_ROWS, sizeof *t.row)};
  char *text = read_file(path), *rest = text, *line = strsep(&rest, "\n");
  for (char *name; line && (name = strsep(&line, between));)
    if (*name && t.columns < MOST_COLUMNS) snprintf(t.names[t.columns++], 64, "%s", name);
  while (rest && (line = strsep(&rest, "\n")) && t.rows < MOST_ROWS) {
    int n = 0;
    for (char *word; (word = strsep(&line, between)) && n < t.columns;)
      if (*word) t.row[t.rows][n++] = strtod(word, NULL);
    t.rows += n == t.columns;
  }
  free(text);
  return t;
}

static int column(const table *t, const char *name) {
  for (int k = 0; k < t->columns; k++)
    if (!strcmp(t->names[k], name)) return k;
  EXPECT(false, "no column %s", name);
  return 0;
}

#define EXAMPLE                                                                                    \
  "paper --set firing.every=1 --set firing.angle=80deg --set run.until=0.4s "                      \
  "--set circuit.deck=interlock.cir "

/* The sensor's voltage follows from the column z_m: tau y' = z - y, in closed form for a z that
 * runs straight from row to row. With rows every 0.1 ms the straight line is off by
 * (w h)^2/8 = 1.3e-4 of the amplitude at 50 Hz; of it 4e-5 of the peak were measured. */
static double sensor_error(const table *t) {
  const double tau = 1e-3;
  int at = column(t, "t_s"), z = column(t, "z_m"), s = column(t, "gap_sensor_m");
  double y = t->row[0][s], worst = 0, peak = 0;
  for (int k = 1; k < t->rows; k++) {
    const double *a = t->row[k - 1], *b = t->row[k];
    double h = b[at] - a[at], slope = (b[z] - a[z]) / h, fades = exp(-h / tau);
    y = fades * y + (b[z] - slope * tau) - fades * (a[z] - slope * tau);
    worst = fmax(worst, fabs(y - b[s]));
    peak = fmax(peak, b[s]);
  }
  return worst / peak;
}

/* The comparator closes as the gap falls through 3.7 mm, and the capacitor is charged from then
 * on. */
static void expect_trip(const table *t) {
  int z = column(t, "z_m"), held = column(t, "held_v");
  for (int k = 1; k < t->rows; k++) {
    if (!(t->row[k - 1][held] < 1e-3 && t->row[k][held] >= 1e-3)) continue;
    EXPECT(t->row[k - 1][z] > 3.6e-3 && t->row[k][z] < 3.7e-3, "tripped from %.6g m to %.6g m",
           t->row[k - 1][z], t->row[k][z]);
    return;
  }
  EXPECT(false, "the interlock never trips");
}

static void the_interlock(void) {
  write_example("interlock.cir");
  RUN_GOOD("run " EXAMPLE "-o out --quiet");
  table t = read_table("out/run.csv", ",");
  int v = column(&t, "gap_speed_m_s"), vp = column(&t, "vp_m_s");
  double worst = 0, peak = 0;
  for (int k = 0; k < t.rows; k++) {
    worst = fmax(worst, fabs(t.row[k][v] - t.row[k][vp]));
    peak = fmax(peak, fabs(t.row[k][vp]));
  }
  double sensor = sensor_error(&t);
  printf(" speed %.1e, sensor %.1e of the peak", worst / peak, sensor);
  /* a probe runs straight from step to step, which is the larger part of it */
  EXPECT(worst < 1e-4 * peak, "gap_speed: %.2e of the peak", worst / peak);
  EXPECT(sensor < 1.3e-4, "gap_sensor: %.2e of the peak", sensor);
  expect_trip(&t);
  free(t.row);
  char *events = read_file("out/events.csv");
  int fires = 0;
  for (char *at = events; (at = strstr(at, "fires")); at++) fires++;
  CU_ASSERT_EQUAL(fires, 2);
  free(events);
}

static double peak_of(const table *t, int k) {
  double peak = 0;
  for (int r = 1; r < t->rows; r++) peak = fmax(peak, fabs(t->row[r][k]));
  return peak;
}

/* Peaks of plain ngspice's table against the run's. */
static void exported(void) {
  write_example("interlock.cir");
  RUN_GOOD("run " EXAMPLE "-o out --quiet");
  ran r = run("export " EXAMPLE "-o x.cir");
  EXPECT(r.status == 0, "%s", r.err);
  free_ran(&r);
  CU_ASSERT_EQUAL(system("ngspice -b x.cir >x.log 2>&1"), 0);
  table mine = read_table("out/run.csv", ","), theirs = read_table("x.txt", " \t");
  double worst = 0;
  int compared = 0;
  for (int i = 1; i < mine.columns; i++)
    for (int j = 1; j < theirs.columns; j++) {
      if (strcmp(mine.names[i], theirs.names[j])) continue;
      double error = fabs(peak_of(&theirs, j) / peak_of(&mine, i) - 1);
      worst = fmax(worst, error);
      EXPECT(error < 1e-3, "%s: %.2e", mine.names[i], error);
      compared++;
    }
  printf(" %d columns, worst %.1e", compared, worst);
  CU_ASSERT(compared >= 12);
  free(mine.row);
  free(theirs.row);
}

static const vs_test TESTS[] = {
    {"of the order that is stated", of_the_order_that_is_stated},
    {"within the tolerance", within_the_tolerance},
    {"on every machine and EVA", on_every_machine_and_eva},
    {"a source where it is named", a_source_where_it_is_named},
    {"other names are refused", other_names_are_refused},
    {"ideal tiers refuse it", ideal_tiers_refuse_it},
    {"the circuit is not left", the_circuit_is_not_left},
    {"the interlock", the_interlock},
    {"exported", exported},
};

int main(void) {
  bool there = on_path("ngspice");
  if (!there) puts("ngspice is not on the PATH: exported decks are not compared");
  return program_suite("nodes", TESTS, there ? COUNT(TESTS) : COUNT(TESTS) - 1);
}
