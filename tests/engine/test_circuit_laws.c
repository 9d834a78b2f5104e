/* SPDX-License-Identifier: GPL-3.0-or-later
 * Tier circuit, and the export, with machines that are not the conveyor and coils whose law is not
 * i = lambda z/(2a): the law's own text stands in the netlist, and runs agree with references that
 * were computed otherwise. The references of single shots are two or three unlike integrators of
 * the same equations with an ideal thyristor. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/export.h"
#include "netlist/netlist.h"
#include "suite.h"

/* ---- what a run gives ---- */

/* A measure of the run by its name; NaN where there is none. */
static double value(const vs_trial *t, const char *name) {
  vs_measure m;
  for (int k = 0; vs_measure_at(&t->scene.setup.model, k, &m); k++)
    if (!strcmp(m.name, name)) return m.factor * t->result.values[m.slot].value;
  EXPECT(false, "no measure %s", name);
  return NAN;
}

#define IDEAL                                                                                      \
  "circuit.deck=halfwave_bare", "circuit.on_voltage=0 V", "circuit.on_resistance=1e-4 ohm",        \
      "circuit.off_resistance=1000 Mohm", "supply.resistance=0", "supply.inductance=0",            \
      "run.tolerance=1e-5", "run.until=0.1 s"

/* Three times run.tolerance, as between the tiers in cli/validate/tiers.c. */
static const double THREE = 3e-5;

typedef struct reference {
  const char *name;
  double value;
} reference;

static vs_trial *compare(const char *scene, const char *const *sets, const reference *rows,
                         int line) {
  vs_trial *t = vs_trial_run(scene, "circuit", sets, NULL);
  expect(t->status == VS_OK, line, "%s", t->err.text);
  for (; t->status == VS_OK && rows->name; rows++)
    vs_close(value(t, rows->name), rows->value, rows->value, THREE, rows->name, line);
  return t;
}
#define COMPARE(scene, rows, ...)                                                                  \
  compare(scene, (const char *const[]){IDEAL, __VA_ARGS__, NULL}, rows, __LINE__)

/* ---- single shots ---- */

#define SERIES "saturation: {law: series, flux: 1.2 Wb, exponent: 7, current: 0.2 A}"

static const reference SERIES_ROWS[] = {{"i_peak", 1.2884797007},
                                        {"force_peak", 88.635095317},
                                        {"t_extinction", 0.013617686556},
                                        {"gap_first_peak", -0.001296558},
                                        {"gap_second_peak", 0.0012677986356},
                                        {NULL, 0}};

/* ngspice is not left, and the run says why. */
static void saturation_in_series(void) {
  vs_trial *t = COMPARE("paper", SERIES_ROWS, "actuator={" SERIES "}");
  CU_ASSERT_PTR_NOT_NULL(vs_result_declined(&t->result));
  CU_ASSERT_EQUAL(t->result.watchers.absence.times, 0);
  vs_trial_free(t);
}

/* The same coil as an event's EVA has it, of which turns are shorted only when all is over. */
static void saturation_in_a_coil_with_shorted_turns(void) {
  vs_trial_free(COMPARE("paper", SERIES_ROWS, "actuator={" SERIES "}",
                        "events={e: {kind: coil_short, at: 99 ms, fraction: 10 %}}"));
}

static void multiplicative_saturation(void) {
  static const reference ROWS[] = {{"i_peak", 1.264466234},
                                   {"force_peak", 101.21092622},
                                   {"t_extinction", 0.013629717245},
                                   {"gap_first_peak", -0.0014123810503},
                                   {"gap_second_peak", 0.0013810970804},
                                   {NULL, 0}};
  vs_trial_free(COMPARE("paper", ROWS,
                        "actuator={saturation: {law: multiplicative, flux: 1.5 Wb, exponent: 6}}"));
}

/* The flux linkage of the gap is the root of an equation, which ngspice solves in a node. */
static void saturation_and_leakage(void) {
  static const reference ROWS[] = {{"i_peak", 1.0125937925},
                                   {"force_peak", 74.847781157},
                                   {"t_extinction", 0.013727115868},
                                   {"gap_first_peak", -0.0011285110331},
                                   {"gap_second_peak", 0.0011034412318},
                                   {NULL, 0}};
  vs_trial_free(COMPARE("paper", ROWS, "actuator={leakage: 0.15 H, " SERIES "}"));
}

static void one_degree_of_freedom(void) {
  static const reference ROWS[] = {{"i_peak", 0.84755834705},
                                   {"force_peak", 95.678944449},
                                   {"t_extinction", 0.01376446144},
                                   {"gap_first_peak", -0.0013273743082},
                                   {"gap_second_peak", 0.0013087757128},
                                   {NULL, 0}};
  vs_trial *t = COMPARE("fixed_base", ROWS, "firing.angle=100 deg");
  CU_ASSERT_PTR_NULL(vs_result_declined(&t->result));
  vs_trial_free(t);
}

/* Two coordinates open the gap. */
static void two_masses(void) {
  static const reference ROWS[] = {{"i_peak", 1.317153444},
                                   {"force_peak", 222.73355935},
                                   {"t_extinction", 0.013640301681},
                                   {"gap_first_peak", -0.00060634592841},
                                   {"gap_second_peak", 0.00058891881562},
                                   {NULL, 0}};
  vs_trial_free(COMPARE("two_mass", ROWS, "firing.angle=110 deg"));
}

/* ---- on a source of the deck's own ---- */

enum { MOST_SAMPLES = 4 };
typedef struct samples {
  double t_s[MOST_SAMPLES], x[MOST_SAMPLES], v[MOST_SAMPLES], i[MOST_SAMPLES], z[MOST_SAMPLES],
      flux[MOST_SAMPLES], force[MOST_SAMPLES];
  int count, meets, leaves;
  double contact_s, release_s;
} samples;

static vs_status sample(void *ctx, const vs_step *step, vs_error *err) {
  samples *s = ctx;
  (void)err;
  for (int k = 0; k < s->count; k++) {
    double t = s->t_s[k];
    if (!(t > step->from->t_s && t <= step->to->t_s)) continue;
    s->x[k] = vs_step_channel(step, t, VS_CH_Q);
    s->v[k] = vs_step_channel(step, t, vs_channel_rates(step->frame->model));
    s->i[k] = vs_step_channel(step, t, VS_CH_I);
    s->z[k] = vs_step_channel(step, t, VS_CH_Z);
    s->flux[k] = vs_step_channel(step, t, VS_CH_LAMBDA);
    s->force[k] = vs_step_channel(step, t, VS_CH_FORCE);
  }
  if (step->event[1] == VS_EV_MEETS_STOP && s->meets++ == 0) s->contact_s = step->event_s[1];
  if (step->event[1] == VS_EV_LEAVES_STOP && s->leaves++ == 0) s->release_s = step->event_s[1];
  return VS_OK;
}

static void sample_run(const char *deck, const char *machine, const char *const *sets, samples *s) {
  const vs_observer also = {s, sample};
  char scene[240];
  snprintf(scene, sizeof scene,
           "{machine: {model: %s}, circuit: {deck: own.cir}, supply: {kind: sine, voltage: 440 V}, "
           "firing: {valve: thyristor, angle: 100 deg}}\n",
           machine);
  write_file("own.yaml", scene);
  write_file("own.cir", deck);
  vs_trial *t = vs_trial_run("own.yaml", "circuit", sets, &also);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  vs_trial_free(t);
}

#define BRIEFLY "run.until=0.03 s", "run.tolerance=1e-5"

/* Reference: the closed form of the linear equations. Errors are relative to the run's peaks. */
static void moving_coil_on_a_step(void) {
  const char *const sets[] = {BRIEFLY, NULL};
  samples s = {.t_s = {0.001, 0.005, 0.02}, .count = 3};
  static const double X[] = {0.000127862768692, 0.00314544357825, 0.00677011695283},
                      V[] = {0.319395303456, 0.823797149213, 0.0025854053243},
                      I[] = {4.20408662937, 3.23981706413, 5.2177005625};
  sample_run("Vd a 0 8.36501901140684\nXeva a 0 eva\n", "lds_v203", sets, &s);
  for (int k = 0; k < s.count; k++) {
    CLOSE_OF(s.x[k], X[k], 6.77e-3, THREE);
    CLOSE_OF(s.v[k], V[k], 0.98, THREE);
    CLOSE_OF(s.i[k], I[k], 5.22, THREE);
  }
}

/* Let go from 1 mm on an open circuit: the flux linkage that the coil begins with is that of no
 * current, else some 5 A would begin to flow. 1e-7 of these is far above the load's 4 nA. */
static void moving_coil_begins_without_a_current(void) {
  const char *const sets[] = {BRIEFLY, "start={x: 1 mm}", NULL};
  samples s = {.t_s = {1e-5, 0.005}, .count = 2};
  sample_run("Rload a 0 1g\nXeva a 0 eva\n", "lds_v203", sets, &s);
  for (int k = 0; k < s.count; k++) CLOSE_OF(s.i[k], 0, 4.9, 1e-7);
}

/* ---- exported: plain ngspice does the same ---- */

/* "name = VALUE" in x.log; NaN: it is not there. */
static double exported(const char *name) {
  FILE *f = fopen("x.log", "r");
  char line[512], word[64];
  double v, found = NAN;
  while (f && fgets(line, sizeof line, f))
    if (sscanf(line, "%63s = %lf", word, &v) == 2 && !strcmp(word, name)) found = v;
  if (f) fclose(f);
  return found;
}

/* Within 1e-3, as in test_export: its steps follow from another rule. first: how the export calls
 * the first peak. */
static void export_agrees(const char *scene, const char *first, const char *const *sets, int line) {
  size_t n = 0;
  vs_error err = {0};
  if (!on_path("ngspice")) return;
  while (sets[n]) n++;
  remove("x.log");
  vs_status status = vs_export_command(scene, (char *const *)(size_t)sets, n, "x.cir", &err);
  expect(status == VS_OK, line, "%s", err.text);
  expect(system("timeout 120 ngspice -b x.cir >x.log 2>&1") == 0, line, "ngspice fails; see x.log");
  vs_trial *t = vs_trial_run(scene, "circuit", sets, NULL);
  double i = value(t, "i_peak"), f = value(t, "force_peak"), g = value(t, "gap_first_peak");
  vs_close(exported(first), g, g, 1e-3, first, line);
  vs_close(exported("i_peak_a"), i, i, 1e-3, "i_peak", line);
  vs_close(exported("force_peak_n"), f, f, 1e-3, "force_peak", line);
  vs_trial_free(t);
}
#define EXPORT(scene, first, ...)                                                                  \
  export_agrees(scene, first, (const char *const[]){__VA_ARGS__, NULL}, __LINE__)

static void exports(void) {
  EXPORT("paper", "p_first_peak_m", "run.until=0.1 s", "actuator={leakage: 0.15 H, " SERIES "}");
  EXPORT("two_mass", "gap_first_peak_m", "run.until=0.1 s", "firing.every=1",
         "firing.angle=130 deg");
  EXPORT("fixed_base", "p_first_peak_m", "run.until=0.1 s",
         "actuator={saturation: {law: multiplicative, flux: 1.5 Wb, exponent: 6}}");
  /* its force opens the gap, so that the first peak is a maximum */
  EXPORT("two_mass", "gap_first_peak_m", "run.until=0.03 s",
         "actuator={law: moving_coil, inductance: 1 H, resistance: 90 ohm}");
}

/* ---- refusals ---- */

static void refused(const char *scene, const char *const *sets, const char *says, int line) {
  vs_trial *t = vs_trial_read(scene, "circuit", sets);
  expect(t->status == VS_INPUT && strstr(t->err.text, says), line, "%s", t->err.text);
  vs_trial_free(t);
}
#define REFUSED(scene, says, ...)                                                                  \
  refused(scene, (const char *const[]){__VA_ARGS__, NULL}, says, __LINE__)

static void what_a_circuit_cannot_do_is_refused(void) {
  REFUSED("lds_v203", "supply.kind: tier circuit", "run.until=0.1 s");
  REFUSED("paper", "firing.valve: tier circuit", "firing.valve=none");
  vs_text table = {0};
  vs_text_add(&table, "z_mm,i_a,lambda_wb\n");
  for (int z = 1; z <= 8; z++)
    for (int i = 0; i <= 8; i++) vs_text_add(&table, "%d,%g,%g\n", z, i / 4.0, i * 2.6e-3 / z);
  write_file("table.csv", table.text);
  vs_text_free(&table);
  REFUSED("paper", "no netlist of the law", "actuator.law=table.csv");
}

/* a is the plain reluctance's: a deck may ask for it only where the coil has one. */
static void a_is_not_every_law_s(void) {
  write_file("a.cir", "Xeva a 0 eva\nR1 a b 1k\nR2 b 0 {1e5*eva_a}\n");
  REFUSED("paper", "a.cir:3:1: eva_a: the actuator's law moving_coil has no a",
          "machine.model=lds_v203", "circuit.deck=a.cir");
  vs_trial *t =
      vs_trial_read("paper", "circuit",
                    (const char *const[]){"circuit.deck=a.cir", "actuator.leakage=1 H", NULL});
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  vs_trial_free(t);
}

/* ngspice has no resistor of 0 ohm. What it takes in its place is said, and is in the books: else
 * 1 mohm times int i^2 dt would be missing there, 6.5 uJ, which is more than 10 times the tolerance
 * allows of the 0.16 J. */
static void a_supply_without_resistance(void) {
  vs_trial *t = vs_trial_run(
      "two_mass", "circuit",
      (const char *const[]){IDEAL, "run.tolerance=1e-6", "run.until=20 ms", NULL}, NULL);
  EXPECT(t->status == VS_OK && !*t->result.books, "%s%s", t->err.text, t->result.books);
  const vs_warnings *w = &t->scene.warnings;
  bool said = false;
  for (size_t k = 0; k < w->count; k++) said |= strstr(w->item[k].text, "takes 1 mohm") != NULL;
  CU_ASSERT_TRUE(said);
  const vs_energy *e = &t->result.watchers.energy;
  CLOSE_OF(e->left_j[VS_B_CIRCUIT], 0, e->joule[VS_E_SOURCE], 1e-6);
  vs_trial_free(t);
}

static const vs_test TESTS[] = {
    {"a supply without resistance", a_supply_without_resistance},
    {"saturation in series", saturation_in_series},
    {"saturation in a coil with shorted turns", saturation_in_a_coil_with_shorted_turns},
    {"multiplicative saturation", multiplicative_saturation},
    {"saturation and leakage", saturation_and_leakage},
    {"one degree of freedom", one_degree_of_freedom},
    {"two masses", two_masses},
    {"moving coil on a step", moving_coil_on_a_step},
    {"moving coil begins without a current", moving_coil_begins_without_a_current},
    {"exports", exports},
    {"refusals", what_a_circuit_cannot_do_is_refused},
    {"a is not every law's", a_is_not_every_law_s},
};
VS_SUITE_MAIN("circuit_laws", TESTS)
