/* SPDX-License-Identifier: GPL-3.0-or-later
 * `vibrospice import`: the gates' pulses come when the netlist's do. For sources whose phases,
 * delays and periods are drawn at random, every edge of every gate of the imported scene is held
 * against the closed form of PULSE, delay + k period, over five cycles of the mains. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/gate.h"
#include "engine/timeline.h"
#include "program.h"
#include "run/scene.h"

static unsigned seed = 18;

/* A number from least to most, of six digits, so that the netlist has it exactly. */
static double drawn(double least, double most) {
  seed = seed * 1664525u + 1013904223u;
  return least + (most - least) * ((seed >> 8) % 1000000) / 1e6;
}

typedef struct gate {
  double at_s, width_s, period_s; /* period_s 0: it comes once */
  int cycles;                     /* 0: without end */
} gate;

static const double RISE_S = 1e-6;

/* The first edge of a PULSE behind t_s: where it begins to rise, or to fall. */
static double edge_of(const gate *g, double t_s) {
  double next_s = INFINITY;
  for (int k = 0; k < 1000; k++) {
    double rise_s = g->at_s + k * g->period_s, fall_s = rise_s + RISE_S + g->width_s;
    if ((!g->period_s && k) || (g->cycles && k >= g->cycles)) break;
    if (rise_s > t_s) next_s = fmin(next_s, rise_s);
    if (fall_s > t_s) next_s = fmin(next_s, fall_s);
  }
  return next_s;
}

/* The same pulses, of a source that rests at 5 V and is pulsed to 0 between them, if `turned`. */
static void add_gate(vs_text *net, int n, const gate *g, bool turned) {
  double off_s = g->at_s + RISE_S + g->width_s, low_s = g->period_s - 2 * RISE_S - g->width_s;
  vs_text_add(net, "V%d g%d k PULSE(%s %.15g 1u 1u %.15g", n, n, turned ? "5 0" : "0 5",
              turned ? off_s : g->at_s, turned ? low_s : g->width_s);
  if (g->period_s) vs_text_add(net, " %.15g", g->period_s);
  if (g->cycles) vs_text_add(net, " %d", g->cycles);
  vs_text_add(net, ")\nR%d g%d k%d 100\nX%d line k%d g%d scr\nRs%d k%d k 1m\n", n, n, n, n, n, n, n,
              n);
}

/* Edges closer than this are one, as are those of a pulse that another one follows at once. */
static const double SAME_S = 1e-9;

/* The imported gate's edges over five cycles. A gate that fires twice in a cycle is two ports of
 * half the rate, and so each of them is held against its own half of the pulses. Returns the worst
 * error, s. */
static double compare(const vs_scene *s, const gate *g, size_t first_port, double hz, int k) {
  const vs_timeline *t = &s->setup.timeline;
  const vs_deck *deck = &s->setup.deck;
  bool twice = g->period_s && fabs(g->period_s * hz - 0.5) < 1e-6;
  double worst = 0;
  for (int half = 0; half < (twice ? 2 : 1); half++) {
    gate own = *g;
    double shift = deck->ports[first_port + (size_t)half].signal.shift_rad, theirs = -1, mine = -1;
    if (twice) own.at_s += half * g->period_s, own.period_s *= 2;
    for (int n = 0; n < 40 && theirs < 5 / hz; n++) {
      theirs = edge_of(&own, theirs);
      mine = vs_gate_edge(t, shift, n ? mine : -1e-6);
      if (isinf(theirs) && isinf(mine)) break;
      double error = fabs(theirs - mine);
      worst = fmax(worst, error);
      EXPECT(error <= SAME_S, "case %d: edge %d at %.12g s, the netlist's at %.12g s", k, n, mine,
             theirs);
    }
  }
  return worst;
}

static double one_case(int k) {
  const double hz = k % 3 ? 50 : 60, cycle_s = 1 / hz, every[] = {1, 0.5, 2, 3, 0};
  vs_text net = {0};
  char title[64];
  bool turned = k >= 24; /* once there is a period */
  double phase_deg = k % 4 ? drawn(-180, 180) : 0, delay_s = k % 5 ? 0 : drawn(0, 2 * cycle_s);
  double period_s = every[k % 5] * cycle_s;
  gate g[2];
  int gates = k % 2 ? 2 : 1;
  for (int n = 0; n < gates; n++) g[n] = (gate){drawn(0, 3 * cycle_s), 0.2 * cycle_s, period_s, 0};
  if (k == 9) g[0].period_s = g[1].period_s = cycle_s, g[0].cycles = g[1].cycles = 1;
  snprintf(title, sizeof title, "case %d\nV9 line 0 SIN(0 325 %g ", k, hz);
  vs_text_add(&net, "%s%.15g 0 %.15g)\n", title, delay_s, phase_deg);
  for (int n = 0; n < gates; n++) add_gate(&net, n + 1, &g[n], turned);
  vs_text_add(&net, "L1 k m 1.6\nR8 m 0 92\n.subckt scr a k g\nD1 a b d\nR1 b k 1\nR2 g k 100\n"
                    ".model d d\n.ends\n.tran 10u 100m uic\n.end\n");
  write_file("x.net", net.text);
  ran r = run("import x.net --gate %s --pins X1=akg,X2=akg -o w.cir --scene w.yaml --quiet",
              gates == 2 ? "V1,V2" : "V1");
  if (gates == 1) {
    free_ran(&r);
    r = run("import x.net --gate V1 --pins X1=akg -o w.cir --scene w.yaml --quiet");
  }
  EXPECT(r.status == 0, "case %d: %s%s", k, r.err, net.text);
  free_ran(&r);
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_error err = {0};
  vs_status status = vs_scene_read("w.yaml", NULL, 0, NULL, scene, &err);
  EXPECT(!status, "case %d: %s", k, err.text);
  double worst = 0;
  size_t port = 1; /* behind the mains */
  for (int n = 0; n < gates && !status; n++) {
    if (g[n].cycles) g[n].period_s = 0;
    worst = fmax(worst, compare(scene, &g[n], port, hz, k));
    port += g[n].period_s && every[k % 5] == 0.5 ? 2 : 1;
  }
  double angle = 2 * M_PI * hz * (0.37 * cycle_s - delay_s) + phase_deg * M_PI / 180;
  double volts = 325 * sin(angle),
         got = vs_timeline_voltage(&scene->setup.timeline, 0.37 * cycle_s);
  EXPECT(fabs(got - volts) < 1e-6, "case %d: mains %.9g V, the netlist's %.9g V", k, got, volts);
  vs_scene_free(scene);
  free(scene);
  vs_text_free(&net);
  return worst;
}

static void edges_are_the_netlists(void) {
  double worst = 0;
  for (int k = 0; k < 24; k++) worst = fmax(worst, one_case(k));
  for (int k = 25; k < 34; k++)
    if (k % 5 != 4) worst = fmax(worst, one_case(k));
  printf(" worst %.1e s", worst);
}

static void what_a_scene_cannot_do(void) {
  static const struct {
    const char *sources, *options, *says[2];
  } ROWS[] = {
      {"V1 line 0 SIN(0 325 50 1m 0 0 3)\nV3 g k PULSE(0 5 1m 1u 1u 1m 20m)\n",
       "",
       {"x.net:2:1: ", "interruption, at: 0.061 s"}},
      {"V1 line 0 SIN(0 325 50)\nV3 g k PULSE(0 5 1m 1u 1u 1m 20m 4)\n",
       "",
       {"x.net:3:1: ", "not 4 times"}},
      {"V1 line 0 SIN(0 325 50)\nV3 g k PULSE(0 5 -1m 1u 1u 1m 20m)\n",
       "",
       {"x.net:3:1: ", "delay below 0"}},
      {"V1 line 0 SIN(0 325 50)\nV3 g k PULSE(0 5 1m 1u 1u 1m 20m)\n"
       "V4 h k PULSE(0 5 1m 1u 1u 1m 40m)\nR9 h k 1k\n",
       "--gate V3,V4",
       {"x.net:4:1: ", "0.04 s and 0.02 s"}},
      {"V1 line 0 SIN(0 325 50)\nV3 g k PULSE(0 5 1m 1u 1u 1m 20m)\n"
       "V4 h k PULSE(0 5 11m 1u 1u 2m 20m)\nR9 h k 1k\n",
       "--gate V3,V4",
       {"x.net:4:1: ", "0.002001 s and 0.001001 s"}},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text net = {0};
    vs_text_add(&net, "t\n%sR3 g k 1k\nR1 line k 9\nL1 k m 1\nR4 m 0 9\n.end\n", ROWS[k].sources);
    write_file("x.net", net.text);
    ran r = run("import x.net %s -o w.cir", ROWS[k].options);
    EXPECT(r.status == 2 && strstr(r.err, ROWS[k].says[0]) == r.err &&
               strstr(r.err, ROWS[k].says[1]),
           "case %zu: %d: %s", k, r.status, r.err);
    free_ran(&r);
    vs_text_free(&net);
  }
}

/* A source that rests at the level that fires: the gate's pulse is the rest of its period, begins
 * before t = 0 if need be, and what no pulse does is told. */
static void sources_that_rest_high(void) {
  static const struct {
    const char *course;
    int status;
    const char *scene, *says, *says_not;
  } ROWS[] = {
      {"PULSE(6 0 6m 1u 1u 19m 20m)", 0, "angle: 90.018 deg, pulse_width: 0.999 ms, every: 1}",
       "line 3: V3 also fires from t = 0 to 0.006 s", NULL},
      {"PULSE(6 0 0.5m 1u 1u 19m 20m)", 0, "pulse_width: 0.999 ms, every: 1, first_cycle: 0}",
       "its 6 V become v3_level", "also fires"},
      {"PULSE(6 0 0 1u 1u 19m 20m)", 0, "pulse_width: 0.999 ms, every: 1}", "its 6 V",
       "also fires"},
      {"PULSE(6 0 0 1u 1u 6m)", 0, "every: once", "its 6 V", "also fires"},
      {"PWL(0 6 5m 6 5.001m 0 19m 0 19.001m 6 20m 6) r=0", 0,
       "pulse_width: 6 ms, every: 1, first_cycle: 0", "its 6 V", "also fires"},
      {"PULSE(0 -6 6m 1u 1u 1m 20m)", 0, "pulse_width: 1.001 ms", "its -6 V", "rests at"},
      {"PWL(0 0 6m 0 6.001m -6 7m -6 7.001m 0)", 0, "every: once", "its -6 V", "rests at"},
      {"PULSE(-6 5 6m 1u 1u 1m 20m)", 0, "pulse_width: 1.001 ms", "its 11 V", "rests at"},
      {"PULSE(6 0 6m)", 2, NULL, "x.net:3:1: V3: it rests at 6 and does not come back", "inf"},
      {"PULSE(6 0 6m 1u 1u 20m 20m)", 2, NULL, "does not come back", "reaches into"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text net = {0};
    vs_text_add(&net,
                "t\nV1 line 0 SIN(0 325 50)\nV3 g k %s\nR3 g k 1k\nR1 line k 9\n"
                "L1 k m 1\nR4 m 0 9\n.tran 60m uic\n",
                ROWS[k].course);
    write_file("x.net", net.text);
    ran r = run("import x.net -o w.cir --scene w.yaml");
    char *scene = r.status ? vs_copy("") : read_file("w.yaml");
    const char *not = ROWS[k].says_not;
    EXPECT(r.status == ROWS[k].status && strstr(r.err, ROWS[k].says), "case %zu: %d: %s", k,
           r.status, r.err);
    EXPECT(!not || !strstr(r.err, not ), "case %zu: '%s' in %s", k, not, r.err);
    EXPECT(!ROWS[k].scene || strstr(scene, ROWS[k].scene), "case %zu: %s", k, scene);
    free(scene);
    free_ran(&r);
    vs_text_free(&net);
  }
}

/* A pulse that a thyristor does not see comes as often as it says: ngspice counts PULSE's eighth
 * number as LTspice does. */
static void pulses_of_a_deck_are_counted(void) {
  write_file("x.net", "t\nV1 line 0 SIN(0 325 50)\nV3 p 0 PULSE(0 5 1m 1u 1u 1m 4m 3)\nR3 p 0 1k\n"
                      "R1 line k 9\nL1 k m 1\nR4 m 0 9\n.tran 40m\n.end\n");
  RUN_GOOD("import x.net --gate none -o w.cir --scene w.yaml --quiet");
  RUN_GOOD("run w.yaml -o out --quiet --set run.until=0.02s");
  char *csv = read_file("out/run.csv"), *rest = csv, *line = strsep(&rest, "\n");
  int column = 0, rises = 0;
  char *at = strstr(line, "v_p_v");
  EXPECT(at, "no v_p_v in %s", line);
  for (char *c = line; at && c < at; c++) column += *c == ',';
  double before = 0;
  while (at && (line = strsep(&rest, "\n")) && *line) {
    for (int n = 0; n < column; n++) line = strchr(line, ',') + 1;
    double v = strtod(line, NULL);
    rises += before < 2.5 && v >= 2.5;
    before = v;
  }
  CU_ASSERT_EQUAL(rises, 3);
  free(csv);
}

static const vs_test TESTS[] = {
    {"the edges are the netlist's", edges_are_the_netlists},
    {"what a scene cannot do", what_a_scene_cannot_do},
    {"sources that rest high", sources_that_rest_high},
    {"pulses of a deck are counted", pulses_of_a_deck_are_counted},
};

int main(void) {
  return program_suite("import_firing", TESTS, COUNT(TESTS));
}
