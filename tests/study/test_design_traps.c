/* SPDX-License-Identifier: GPL-3.0-or-later
 * Parts that only look good, in the lists of prices of `design`. Each of them costs less than the
 * good one and differs from it in one line of its file, for which the run breaks a limit, or
 * something happens that must not. The design takes the good part, and names of each of the others
 * what it fails by. Limits lie 2 % or more to either side of what the part bears. */
#include <string.h>

#include "base/text.h"
#include "program.h"

enum { LINES = 10, GOOD = 99 };

/* A line of the part's file as the good part has it, as a bad one has it, and what that one fails
 * by, as design.csv says it; NULL: no bad part differs in it. Lines of the contract begin with a
 * star, the others are elements of the subcircuit. */
typedef struct trap {
  const char *good, *bad, *killer;
} trap;

typedef struct world {
  const char *kind;
  trap line[LINES];
  const char *load;  /* elements from x, behind the part, to ground; other lines of the deck */
  const char *scene; /* what it has besides */
} world;

#define LONG                                                                                       \
  "run: {tier: circuit, until: 1.2 s, tolerance: 1e-3}\n" /* means are judged over 1 s and more */
#define SHORT "run: {tier: circuit, until: 60 ms}\n"
#define NO_LOAD "Rx x 0 1u\n"
#define MELTS(i2t, arc)                                                                            \
  "X1 a b i2t melt fuse_law resistance=1 melting_i2t=" i2t " fusing_current=1 v_arc=" arc
#define SCR                                                                                        \
  "*$ param on_voltage = 0.9 V 0.5..5\n*$ param on_resistance = 20 mohm 0.1..1e4\n"                \
  "*$ param off_resistance = 10 Mohm 1e-2..1e3\n"                                                  \
  "*$ param turn_off_time = 50 us 2..1000\n"                                                       \
  "*$ param recovered_charge = 10 A*us 0.01..1e4\n*$ param test_current = 10 A 0.1..5000\n"        \
  "*$ param test_slope = 30 A/us 0.1..1000\n.include thyristor.inc"
#define WARD "*$ device w ward = 0*v(x), 0*i(Vd)\n*$ param ward = w.inc part\nXw x 0 ward\n"

static const world WORLDS[] = {
    /* 100 V over 1 kohm: 10 W, 0.1 A; peaks of 141.4 V and 0.1414 A; 12 J in 1.2 s */
    {"varistor",
     {{"*$ limit p_max = 10.2 W", "*$ limit p_max = 9.8 W", "d.power,"},
      {"*$ limit v_rms = 102 V", "*$ limit v_rms = 98 V", "d.v_rms,"},
      {"*$ limit i_surge = 0.1443 A", "*$ limit i_surge = 0.1386 A", "d.i_peak,"},
      {"*$ limit energy = 12.3 J", "*$ limit energy = 11.7 J", "d.energy,"},
      {"R1 a b 1k", NULL, NULL}},
     NO_LOAD,
     LONG},
    /* 0.6 J in 60 ms, and as much by each of nine more surges */
    {"varistor",
     {{"*$ limit p_max = 0.612 W", "*$ limit p_max = 0.588 W", "d.power_repeated,"},
      {"*$ limit i_surge = 9 A", NULL, NULL},
      {"*$ limit energy = 9 J", NULL, NULL},
      {"R1 a b 1k", NULL, NULL}},
     NO_LOAD,
     SHORT
     "events: {b: {kind: surge, at: 59 ms, level: 500 V, from: strike, times: 10, every: 1 s}}\n"},
    /* pulses of sin^5, of a charge over their peak of 3.395 ms; the power law between the lines */
    {"varistor",
     {{"*$ pulse 2 ms 1 0.2 A\n*$ pulse 10 ms 1 0.0258 A\n*$ pulse 2 ms 6 0.2 A\n"
       "*$ pulse 10 ms 6 0.0258 A",
       "*$ pulse 2 ms 1 0.2 A\n*$ pulse 10 ms 1 0.0228 A\n*$ pulse 2 ms 6 0.2 A\n"
       "*$ pulse 10 ms 6 0.0228 A",
       "d.i_pulse,"},
      {"*$ limit i_surge = 9 A", NULL, NULL},
      {"*$ limit energy = 9 J", NULL, NULL},
      {"B1 a b I=0.1*pow(abs(v(a,b))/141.421,5)*sgn(v(a,b))", NULL, NULL}},
     NO_LOAD,
     SHORT},
    /* 10 A, 1 A2.s in a half cycle, and 15 % from one fuse to the next */
    {"fuse",
     {{"*$ limit i_rated = 10.2 A", "*$ limit i_rated = 9.8 A", "d.i_rms,"},
      {"*$ limit i2t_melt = 1250 A2.s", "*$ limit i2t_melt = 0.8 A2.s", "d.i2t_surge,"},
      {"R1 a b 1", MELTS("0.4", "300"), "\"fuse_opens of d at "}},
     "Rx x 0 9\n",
     LONG},
    {"fuse",
     {{"*$ time_current 10 ms 30 A\n*$ time_current 40 ms 10.2 A",
       "*$ time_current 10 ms 30 A\n*$ time_current 40 ms 9.8 A", "d.i_overload,"},
      {"*$ limit i_rated = 5 A", NULL, NULL},
      {"*$ limit i2t_melt = 9 A2.s", NULL, NULL},
      {"R1 a b 1", NULL, NULL}},
     "Rx x 0 9\n",
     SHORT},
    /* It opens, as it has to, beside a diode that bears 0.5 A2.s and 330 V. */
    {"fuse",
     {{"*$ limit v_rated = 102 V", "*$ limit v_rated = 98 V", "d.v_open,"},
      {".param i2t = 0.4", ".param i2t = 0.6", "d.let_through,"},
      {".param arc = 300", ".param arc = 360", "d.v_arc,"},
      {MELTS("{i2t}", "{arc}"), "R1 a b 1k", "\"fuse_opens of d did not happen"}},
     "Rx x y 9\nLx y 0 10m ic=0\n" WARD,
     SHORT "expect: [d opens]\n"},
    {"resistor",
     {{"*$ limit p_rated = 10.2 W", "*$ limit p_rated = 9.8 W", "d.power,"},
      {"*$ limit v_class = 144.3 V", "*$ limit v_class = 138.6 V", "d.v_peak,"},
      {"*$ limit e_pulse = 0.102 J", "*$ limit e_pulse = 0.098 J", "d.e_pulse,"},
      {"R1 a b 1k", NULL, NULL}},
     NO_LOAD,
     LONG},
    /* 0.314 A, and 44.4 V/ms, of which a rate is known to some 10 % */
    {"capacitor",
     {{"*$ limit v_class = 144.3 V", "*$ limit v_class = 138.6 V", "d.v_peak,"},
      {"*$ limit v_rms = 102 V", "*$ limit v_rms = 98 V", "d.v_rms,"},
      {"*$ limit i_rms_max = 0.321 A", "*$ limit i_rms_max = 0.308 A", "d.i_rms,"},
      {"*$ limit dv_dt_max = 0.053 V/us", "*$ limit dv_dt_max = 0.037 V/us", "d.dv_dt_max,"},
      {"R1 a m 1\nC1 m b 10u ic=0", NULL, NULL}},
     NO_LOAD,
     LONG},
    /* The sheets of the first three tell what their models do not do: the surge rises by 1.1 kV/us,
     * to 525 V, and 4.3 A are to latch. */
    {"thyristor",
     {{"*$ param critical_dvdt = 5000 V/us 5..5000", "*$ param critical_dvdt = 100 V/us 5..5000",
       "\"unintended_firing of d at "},
      {"*$ param blocking_voltage = 1200 V 50..10000",
       "*$ param blocking_voltage = 300 V 50..10000", "\"unintended_firing of d at "},
      {"*$ param gate_current = 15 mA 0.02..5000\n*$ param latching_current = 60 mA 0.2..5000\n"
       "*$ param holding_current = 30 mA 0.1..5000",
       "*$ param gate_current = 900 mA 0.02..5000\n*$ param latching_current = 2000 mA 0.2..5000\n"
       "*$ param holding_current = 500 mA 0.1..5000",
       "misfire of d at "},
      {"*$ limit v_drm = 1200 V", "*$ limit v_drm = 500 V", "d.v_forward,"},
      {"*$ limit dv_dt = 2000 V/us", "*$ limit dv_dt = 100 V/us", "d.dv_dt,"},
      {"*$ limit t_q = 50 us", NULL, NULL},
      {SCR, NULL, NULL},
      {"X1 a b g thyristor_two_transistor", NULL, NULL}},
     "Vm s 0 external\nRs s s1 {r_source}\nLs s1 a {l_source} ic=0\nRx x 0 23\n",
     SHORT "events: {b: {kind: surge, at: 41 ms, level: 500 V}}\n"},
    /* It conducts under its gate pulse alone, 1.79 A rms, and burns 3.3 W into 14 K/W. */
    {"thyristor",
     {{"*$ limit v_rrm = 144.3 V", "*$ limit v_rrm = 138.6 V", "d.v_reverse,"},
      {"*$ limit i_t_rms = 1.84 A", "*$ limit i_t_rms = 1.75 A", "d.i_rms,"},
      {"*$ limit t_j_max = 90 degC", "*$ limit t_j_max = 82 degC", "d.t_j,"},
      {"*$ limit v_drm = 200 V", NULL, NULL},
      {"*$ zth 2 K/W 1 s", NULL, NULL},
      {"Rg g b 1k\nBk a b I=v(a,b)*v(g,b)", NULL, NULL}},
     "Rx x 0 23\n",
     LONG "ambient: 40 degC\nheatsink: {d: 12 K/W}\n"},
    /* The run of the first ends as the stop gives way: it is named as one that was not judged. */
    {"resistor",
     {{"R1 a b 1k", "R1 a b 1", "t = 0.0"}, {"*$ limit v_class = 2000 V", NULL, NULL}},
     "Vm a 0 external\nXeva x 0 eva\n",
     SHORT "actuator: {stop: {stiffness: 1e4 N/m}}\n"},
};

static bool is_gated(const world *w) {
  return !strcmp(w->kind, "thyristor");
}

static bool gives_way(const world *w) {
  return strstr(w->scene, "stop");
}

static void write_part(const world *w, size_t bad) {
  vs_text head = {0}, body = {0};
  char path[32];
  snprintf(path, sizeof path, "p%zu.inc", bad);
  vs_text_add(&head, "*$ part %s \"a trap\"\n", w->kind);
  for (size_t k = 0; k < LINES && w->line[k].good; k++) {
    const char *line = k == bad ? w->line[k].bad : w->line[k].good;
    vs_text_add(*line == '*' ? &head : &body, "%s\n", line);
  }
  vs_text_add(&head, "%s.subckt p%zu a b%s\n%s.ends\n",
              strstr(body.text, "fuse_law") ? ".include fuse_law.inc\n" : "", bad,
              is_gated(w) ? " g" : "", body.text);
  write_file(path, head.text);
  vs_text_free(&head);
  vs_text_free(&body);
}

static void write_world(const world *w) {
  vs_text text = {0}, list = {0};
  vs_text_add(&text,
              "*$ port mains = Vm\n*$ line a\n*$ param part = p99.inc part\n"
              "*$ device d part%s = v(d,x), i(Vd)\n*$ loss d = v(d,x)*i(Vd)\nVd a d 0\n%s%s%s"
              "%s",
              strstr(w->load, "ward") ? " protects w" : "",
              strstr(w->load, "Vm") ? "" : "Vm a 0 external\n",
              is_gated(w) ? "*$ port gate = Vg\nVg q x external\nRg q g 10\nXd d x g part\n"
                          : "Xd d x part\n",
              w->load, strstr(w->load, "eva") ? "" : "Re a e 1meg\nXeva e 0 eva\n");
  write_file("d.cir", text.text);
  text.length = 0;
  vs_text_add(
      &text,
      "circuit: {deck: d.cir}\nsupply: {voltage: %d V}\nfiring: {every: 1, pulse_width: 3 ms}\n%s",
      gives_way(w) ? 440 : 100, w->scene);
  write_file("s.yaml", text.text);
  vs_text_add(&list, "part,kind,price\n");
  for (size_t k = 0; k < LINES && w->line[k].good; k++)
    if (w->line[k].bad) {
      write_part(w, k);
      vs_text_add(&list, "p%zu.inc,%s,%zu\n", k, w->kind, k + 1);
    }
  write_part(w, GOOD);
  vs_text_add(&list, "p99.inc,%s,99\n", w->kind);
  write_file("p.csv", list.text);
  write_file("w.inc", "*$ part diode \"\"\n*$ limit i2t = 0.5 A2.s\n*$ limit v_rrm = 330 V\n"
                      ".subckt w a b\nR1 a b 1g\n.ends\n");
  vs_text_free(&text);
  vs_text_free(&list);
}

static void none_is_taken(void) {
  for (size_t n = 0; n < COUNT(WORLDS); n++) {
    const world *w = &WORLDS[n];
    vs_text waived = {0}, text = {0};
    write_world(w);
    char *part = read_file("p99.inc");
    waive_the_rest("d", w->kind, part, &waived);
    if (strstr(w->load, "ward")) waive_the_rest("w", "diode", "i2t v_rrm", &waived);
    vs_text_add(&text,
                "scene: s.yaml\nreport: [i_peak]\nset: {waive: [%s]}\ncatalogue:\n  prices: p.csv\n"
                "  choose: {circuit.part: {kind: %s}}\nproof: {verify: false, neighbours: false}\n",
                waived.length ? waived.text : "", w->kind);
    write_file("d.yaml", text.text);
    ran r = run("design d.yaml -o out --overwrite --jobs 1");
    EXPECT(r.status == (gives_way(w) ? 1 : 0) && strstr(r.out, "circuit.part          p99.inc "),
           "%s %zu: %d %s%s", w->kind, n, r.status, r.out, r.err);
    free_ran(&r);
    char *csv = read_file("out/design.csv");
    for (size_t k = 0; k < LINES && w->line[k].good; k++) {
      char row[128];
      snprintf(row, sizeof row, ",p%zu.inc,%s,the scene as it is,%s", k,
               gives_way(w) ? "unjudged" : "violated", w->line[k].bad ? w->line[k].killer : "");
      EXPECT(!w->line[k].bad || strstr(csv, row), "%s: no '%s' in %s", w->kind, row, csv);
    }
    free(csv);
    free(part);
    vs_text_free(&text);
    vs_text_free(&waived);
  }
}

int main(void) {
  static const vs_test TESTS[] = {{"none is taken", none_is_taken}};
  return program_suite("design traps", TESTS, COUNT(TESTS));
}
