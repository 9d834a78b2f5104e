/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "netlist/netlist.h"
#include "netlist/parts.h"
#include "ngspice/ngspice.h"
#include "suite.h"

static double gap(void *ctx, size_t port, double t_s) {
  (void)ctx, (void)port, (void)t_s;
  return 6.5e-3; /* m; the EVA's, the only external source */
}

static double no_edge(void *ctx, double t_s) {
  (void)ctx, (void)t_s;
  return INFINITY;
}

static vs_status accept(void *ctx, double t_s, const double *signals, vs_error *err) {
  (void)err;
  bench *b = ctx;
  b->steps++;
  for (int k = 0; k < BENCH_SIGNALS && b->signals[k]; k++) b->last[k] = signals[k];
  if (b->see) b->see(b->ctx, t_s, signals);
  return VS_OK;
}

static vs_status solve(bench *b, const vs_deck *deck, char **netlist, size_t lines, vs_error *err) {
  static const char *const PORTS[] = {"v.xeva.vgap"};
  vs_circuit_job job = {.netlist = netlist,
                        .lines = lines,
                        .ports = PORTS,
                        .n_ports = 1,
                        .signals = b->signals,
                        .until_s = b->until_s,
                        .max_step_s = b->max_step_s,
                        .gear = b->gear,
                        .dialect = deck->compat,
                        .relative_tolerance = b->relative_tolerance,
                        .current_tolerance_a =
                            b->current_tolerance_a > 0 ? b->current_tolerance_a : 1e-12};
  while (job.n_signals < BENCH_SIGNALS && b->signals[job.n_signals]) job.n_signals++;
  vs_circuit_host host = {
      .ctx = b, .source = gap, .edge = no_edge, .longest = no_edge, .accept = accept};
  void *circuit = NULL;
  b->steps = 0;
  vs_status s = vs_ngspice_kind.load(&job, &host, &circuit, err);
  if (!s) s = vs_ngspice_kind.run(circuit, err);
  vs_ngspice_kind.free(circuit);
  return s;
}

static double *find(const vs_deck *deck, vs_circuit_values *values, const char *key) {
  for (size_t k = 0; k < deck->section.count; k++)
    if (!strcmp(deck->section.fields[k].key, key))
      return (double *)(void *)((char *)values + deck->section.fields[k].offset);
  EXPECT(false, "the bench's deck has no parameter %s", key);
  return NULL;
}

static vs_status read_deck(const bench *b, vs_deck *deck, vs_circuit_values *values,
                           vs_error *err) {
  vs_text text = {0};
  vs_text_add(&text, "%s\nReva eva_ 0 1\nXeva eva_ 0 eva\n", b->deck);
  write_file("bench.cir", text.text);
  vs_text_free(&text);
  vs_status s = vs_netlist_read("bench.cir", deck, err);
  if (!s) s = vs_netlist_read_parts(deck, NULL, err);
  if (!s) s = vs_field_section_read(&deck->section, NULL, values, err);
  for (const bench_value *v = b->set; !s && v && v->key; v++) {
    double *value = find(deck, values, v->key);
    if (value) *value = v->value;
  }
  return s;
}

vs_status bench_run(bench *b, vs_error *err) {
  const vs_deck_value standard[] = {{"u_rms", 440},    {"f_mains", 50},    {"phase", 0},
                                    {"r_source", 0.5}, {"l_source", 5e-4}, {"eva_resistance", 92},
                                    {"eva_a", 5.2e-3}};
  vs_deck *deck = vs_alloc(1, sizeof *deck);
  vs_circuit_values *values = vs_alloc(1, sizeof *values);
  char **netlist = NULL;
  size_t lines = 0;
  vs_status s = read_deck(b, deck, values, err);
  if (!s) s = vs_deck_bind(deck, values, standard, COUNT(standard), err);
  if (!s) s = vs_parts_require_hold(deck, values, NULL, err);
  if (!s) s = vs_netlist_make(deck, values, standard, COUNT(standard), &netlist, &lines, err);
  if (!s) s = solve(b, deck, netlist, lines, err);
  vs_netlist_free(netlist, lines);
  vs_deck_free(deck);
  free(values);
  free(deck);
  return s;
}

void bench_good(bench *b, const char *what, int line) {
  vs_error err = {0};
  const vs_status s = bench_run(b, &err);
  expect(s == VS_OK, line, "%s: %s", what, err.text);
}

double bench_value_of(const bench *b, const char *key) {
  vs_error err = {0};
  vs_deck *deck = vs_alloc(1, sizeof *deck);
  vs_circuit_values *values = vs_alloc(1, sizeof *values);
  vs_status s = read_deck(b, deck, values, &err);
  EXPECT(!s, "%s", err.text);
  const double *value = s ? NULL : find(deck, values, key);
  double got = value ? *value : NAN;
  vs_deck_free(deck);
  free(values);
  free(deck);
  return got;
}
