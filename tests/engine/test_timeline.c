/* SPDX-License-Identifier: GPL-3.0-or-later
 * Wing engine: when the mains and the gates do what; the netlist a deck becomes. */
#include <math.h>
#include <string.h>

#include "engine/gate.h"
#include "netlist/netlist.h"
#include "suite.h"

static vs_timeline timeline_of(const char *const *sets) {
  const char *all[8] = {"run.until=1us"};
  for (int k = 0; sets[k] && k < 6; k++) all[k + 1] = sets[k];
  vs_trial *t = vs_trial_read("paper", "circuit", all);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  vs_timeline line = t->scene.setup.timeline;
  vs_trial_free(t);
  return line;
}
#define TIMELINE(...) timeline_of((const char *const[]){__VA_ARGS__, NULL})

static void mains_is_a_sine_of_its_rms(void) {
  vs_timeline l = TIMELINE("supply.phase=30deg");
  CLOSE(vs_timeline_voltage(&l, 0), 440 * M_SQRT2 * 0.5, 1e-14);
  CLOSE_OF(vs_timeline_voltage(&l, l.first_zero_s), 0, 622, 1e-12);
  CLOSE(l.first_zero_s, 0.02 * 330 / 360, 1e-12); /* the first rising zero at or after t = 0 */
}

static void one_pulse(void) {
  vs_timeline l = TIMELINE("firing.every=once");
  double on = 0.02 * 100 / 360, off = on + 8e-3;
  CLOSE(vs_gate_edge(&l, 0, 0), on, 1e-14);
  CLOSE(vs_gate_edge(&l, 0, on), off, 1e-14);
  CU_ASSERT_EQUAL(vs_gate_edge(&l, 0, off), INFINITY);
  CU_ASSERT_FALSE(
      vs_gate_is_on(&l, 0, on)); /* a step that ends on the edge still sees what was before it */
  CU_ASSERT_TRUE(vs_gate_is_on(&l, 0, on + 1e-9));
  CU_ASSERT_TRUE(vs_gate_is_on(&l, 0, off));
  CU_ASSERT_FALSE(vs_gate_is_on(&l, 0, off + 1e-9));
  CU_ASSERT_FALSE(vs_gate_is_on(&l, 0, off + 1e-13)); /* a jump behind its breakpoint costs steps */
  CU_ASSERT_FALSE(vs_gate_is_on(&l, 0, on + 0.02 + 1e-3));
  CLOSE(vs_gate_next_conduction(&l, 0), on, 1e-14);
  CU_ASSERT_EQUAL(vs_gate_next_conduction(&l, 0.0137), INFINITY);
}

static void every_nth_cycle_from_a_first(void) {
  vs_timeline l = TIMELINE("firing.every=3", "firing.first_cycle=2");
  double on = 0.02 + 0.02 * 100 / 360;
  CLOSE(vs_gate_edge(&l, 0, 0), on, 1e-14);
  CLOSE(vs_gate_edge(&l, 0, on + 8e-3), on + 0.06, 1e-14);
  CLOSE(vs_gate_edge(&l, M_PI, 0), on + 0.01, 1e-14); /* a second thyristor, half a cycle later */
  CLOSE(vs_gate_next_conduction(&l, on + 8.2e-3), on + 0.06, 1e-14);
}

/* Instants come from integers: after a million cycles the edge is where it belongs to the last bit
 * or two. */
static void a_million_cycles_do_not_drift(void) {
  vs_timeline l = TIMELINE("firing.every=1");
  double on = 0.02 * 100 / 360, t = 1e6 * 0.02;
  CLOSE(vs_gate_edge(&l, 0, t), t + on, 1e-15);
  CU_ASSERT_FALSE(vs_gate_is_on(&l, 0, t + on - 1e-9));
  CU_ASSERT_TRUE(vs_gate_is_on(&l, 0, t + on + 1e-9));
  CLOSE_OF(vs_gate_next_conduction(&l, t + 0.0137), t + 0.02 + on, 1, 4e-12); /* an ulp of 2e4 s */
}

/* A pulse that begins before the mains turns forward waits for it, as an ideal thyristor does. */
static void conduction_waits_for_forward_voltage(void) {
  vs_timeline l = TIMELINE("firing.angle=179deg", "firing.pulse_width=15ms");
  CLOSE(vs_gate_next_conduction(&l, 0), 0.02 * 179 / 360, 1e-14);
  CLOSE_OF(vs_gate_next_conduction(&l, 0.0101), 0.02, 1, 1e-12);
}

/* Sub-pulses of a gate pulse: 2 kHz, a quarter of the time, in 1.2 ms: at 0, 0.5 and 1 ms; the last
 * is whole (0.125 of 0.2 ms left). */
static void a_burst_fills_the_gate_pulse(void) {
  vs_timeline l = TIMELINE("firing.every=2", "firing.pulse_width=1.2ms",
                           "firing.burst_frequency=2kHz", "firing.burst_duty=25%");
  double on = 0.02 * 100 / 360, at[] = {0, 0.125e-3, 0.5e-3, 0.625e-3, 1e-3, 1.125e-3};
  for (int pulse = 0; pulse < 3; pulse++, on += 0.04) {
    double t = on - 1e-3;
    for (size_t k = 0; k < COUNT(at); k++, t = on + at[k - 1]) {
      CLOSE(vs_gate_burst_edge(&l, 0, t), on + at[k], 1e-13);
      CU_ASSERT_EQUAL(vs_gate_burst(&l, 0, on + at[k] - 1e-6), k % 2 == 1);
      CU_ASSERT_EQUAL(vs_gate_burst(&l, 0, on + at[k] + 1e-6), k % 2 == 0);
    }
    CLOSE(vs_gate_burst_edge(&l, 0, on + 1.125e-3), on + 0.04, 1e-13);
    CLOSE(vs_gate_burst_edge(&l, 0, on + 1.15e-3), on + 0.04, 1e-13);
    CU_ASSERT_FALSE(vs_gate_burst(&l, 0, on + 1.5e-3)); /* a sub-pulse that would begin after it */
  }
  l = TIMELINE("firing.every=once", "firing.pulse_width=1.1ms", "firing.burst_frequency=2kHz",
               "firing.burst_duty=50%");
  on = 0.02 * 100 / 360; /* the gate pulse ends in its third sub-pulse */
  CLOSE(vs_gate_burst_edge(&l, 0, on + 1e-3), on + 1.1e-3, 1e-13);
  CU_ASSERT_EQUAL(vs_gate_burst_edge(&l, 0, on + 1.1e-3), INFINITY);
  CU_ASSERT_EQUAL(vs_gate_burst_edge(&l, M_PI, 0), vs_gate_edge(&l, M_PI, 0));
  bool spares = true; /* of those that are spared there are neither pulses nor edges */
  l.spares = &spares;
  CU_ASSERT_FALSE(vs_gate_burst(&l, 0, on + 1e-4));
  CU_ASSERT_EQUAL(vs_gate_burst_edge(&l, 0, on + 1e-4), INFINITY);
}

/* Every step of an edge-by-edge walk goes forward, whatever the numbers. */
static void edges_go_forward(void) {
  vs_timeline l = TIMELINE("firing.every=1", "firing.angle=33.3deg", "supply.frequency=59.9Hz",
                           "firing.pulse_width=1.234ms", "supply.phase=-77deg");
  double t = 0;
  for (int k = 0; k < 10000; k++) {
    double next = vs_gate_edge(&l, 0, t);
    CU_ASSERT_FATAL(next > t && next < t + 1.1 * 2 / 59.9);
    CU_ASSERT_EQUAL(vs_gate_is_on(&l, 0, next + 1e-6), k % 2 == 0);
    t = next;
  }
}

static void deck_becomes_a_netlist(void) {
  const char *sets[] = {"run.until=1us", "circuit.r1=220 ohm", "circuit.c1=0.33 uF", NULL};
  vs_trial *t = vs_trial_run("paper", "circuit", sets, NULL);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  const vs_deck_value standard[] = {{"u_rms", 440}};
  char **lines;
  size_t n;
  vs_error err = {0};
  CU_ASSERT_EQUAL_FATAL(vs_netlist_make(&t->scene.setup.deck, &t->scene.setup.circuit_values,
                                        standard, 1, &lines, &n, &err),
                        VS_OK);
  int found = 0;
  for (size_t k = 0; k < n; k++) {
    double value;
    if (sscanf(lines[k], ".param r1=%lf", &value) == 1) found += value == 220;
    if (sscanf(lines[k], ".param c1=%lf", &value) == 1) found += fabs(value - 0.33e-6) < 1e-21;
    if (!strcmp(lines[k], ".param u_rms=440")) found++;
    if (!strncmp(lines[k], ".subckt eva", 11)) found++;
    CU_ASSERT_NOT_EQUAL(lines[k][0], '*');
  }
  CU_ASSERT_EQUAL(found, 4);
  vs_netlist_free(lines, n);
  vs_trial_free(t);
}

static const vs_test TESTS[] = {
    {"mains", mains_is_a_sine_of_its_rms},
    {"one pulse", one_pulse},
    {"every n-th cycle", every_nth_cycle_from_a_first},
    {"a million cycles", a_million_cycles_do_not_drift},
    {"forward voltage", conduction_waits_for_forward_voltage},
    {"a burst fills the gate pulse", a_burst_fills_the_gate_pulse},
    {"edges go forward", edges_go_forward},
    {"netlist", deck_becomes_a_netlist},
};
VS_SUITE_MAIN("timeline and deck", TESTS)
