/* SPDX-License-Identifier: GPL-3.0-or-later
 * The closed loop of a control: the limit of its gain that the multipliers tell, against full runs
 * with a gain 1 % below it, which must come to rest, and 1 % above it, which must not. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"

enum { FIRINGS = 700 };

typedef struct loop {
  const char *scene;            /* what stands in the file besides firing, control and run */
  const char *control;          /* without gains */
  double gain, integral, angle; /* deg per mm, deg per mm and s, deg */
} loop;

static void write_scene(const loop *l, double proportional, double integral, double angle_deg) {
  char text[2048];
  snprintf(text, sizeof text,
           "%s\nfiring: {angle: %.12g deg, every: 1}\nstart: steady\n"
           "control: {law: amplitude, %s, gain: %.12g deg/mm, integral: %.12g deg/mm.s}\n"
           "run: {until: %.2f s, sample: 20 ms, tolerance: 1e-8, tier: switched}\n",
           l->scene, angle_deg, l->control, proportional, integral, 0.02 * FIRINGS);
  write_file("loop.yaml", text);
}

/* A column of a run, at each section; NaN where it has no number. */
static void read_column(const char *name, double value[FIRINGS]) {
  char *text = read_file("out/run.csv"), *rest = text, *line = strsep(&rest, "\n");
  int column = 0;
  const char *at = strstr(line, name);
  EXPECT(at != NULL, "%s", line);
  for (const char *c = line; at && c <= at; c++) column += *c == ',';
  for (int k = 0; k < FIRINGS; k++) {
    value[k] = NAN;
    line = strsep(&rest, "\n");
    for (int n = 0; line && *line && n < column; n++) line = strchr(line, ',') + 1;
    if (line && *line && *line != ',') value[k] = strtod(line, NULL);
  }
  free(text);
}

/* The root mean square of the angle about its mean over some firings. */
static double swing_of(const double *angle, int from, int to) {
  double mean = 0, square = 0;
  for (int k = from; k < to; k++) mean += angle[k] / (to - from);
  for (int k = from; k < to; k++) square += pow(angle[k] - mean, 2) / (to - from);
  return sqrt(square);
}

/* By what factor the control's swing grows from the middle of the run to its end. */
static double growth(const loop *l, double proportional, double integral, double angle_deg) {
  double angle[FIRINGS];
  write_scene(l, proportional, integral, angle_deg);
  RUN_GOOD("run loop.yaml --quiet --digits 15 -o out");
  read_column(",firing_angle_rad", angle);
  return swing_of(angle, FIRINGS - 200, FIRINGS) / swing_of(angle, FIRINGS - 400, FIRINGS - 200);
}

/* The run begins a hundredth of a degree off the angle at which the control comes to rest. Its
 * swing over 200 firings is that of the largest multiplier alone by then, or of it and of the
 * machine's slow modes, which decay too. At 1 % above the limit it is some 5e-4 above 1, so that
 * the swing grows by a tenth. */
static void limits(void) {
  static const loop LOOPS[] = {
      {"machine: {model: conveyor}\ninstruments: {set: none, p: {range: [-3 mm, 3 mm], "
       "bandwidth: 100 Hz, bits: none}}",
       "sensor: p, setpoint: 1.45 mm", 2, 20, 106.28},
      {"machine: {model: conveyor}\ninstruments: {set: none, p: {range: [-3 mm, 3 mm], "
       "bits: none}}",
       "sensor: p, setpoint: 1.2 mm", 0, 50, 109.5},
      {"machine: {model: two_mass}\nsupply: {voltage: 440 V}\ninstruments: {set: none, gap: "
       "{channel: z, range: [0 mm, 30 "
       "mm], bandwidth: 60 Hz, order: 2, bits: none}}",
       "sensor: gap, setpoint: 0.3 mm", 50, 200, 130},
  };
  for (size_t k = 0; k < COUNT(LOOPS); k++) {
    const loop *l = &LOOPS[k];
    write_scene(l, l->gain, l->integral, l->angle);
    ran r = run("steady loop.yaml --json --quiet");
    double times = number_in(r.out, "limit_both_times"), angle = number_in(r.out, "angle_deg");
    EXPECT(times > 0.01 && times < 100, "%zu: %s", k, r.err);
    free_ran(&r);
    double below = growth(l, 0.99 * times * l->gain, 0.99 * times * l->integral, angle + 0.01);
    double above = growth(l, 1.01 * times * l->gain, 1.01 * times * l->integral, angle + 0.01);
    printf("%zu: %.4g times: %.4g and %.4g\n", k, times, below, above);
    EXPECT(below < 0.98 && above > 1.04, "%zu: %g, %g", k, below, above);
  }
}

/* A step of the set point by 1 um: when the amplitude is within 1 % of it for good, and by how much
 * it passes it. The control knows the amplitude one firing later. What the 10 kHz of the samples
 * take from an amplitude of 1 mm, up to 1.2e-4 of it, would be an eighth of the step, but is nearly
 * the same throughout; hence 100 kHz, and two firings on either side. */
static void a_step_of_the_set_point(void) {
  enum { STEP = 50 };
  const loop l = {"machine: {model: conveyor}\ninstruments: {set: none, p: {range: [-3 mm, 3 mm], "
                  "bandwidth: 100 Hz, bits: none, rate: 100 kHz}}",
                  "sensor: p, rate: 100 kHz, sensor_gain: 1, setpoint: [[0 s, 0.9029 mm], [0.99 s, "
                  "0.9029 mm], [0.99 s, 0.9039 mm]]",
                  -5, 60, 112.347};
  double amplitude[FIRINGS], largest = 0, from, to = 0;
  int settled = 0;
  write_scene(&l, l.gain, l.integral, l.angle);
  ran r = run("steady loop.yaml --json --quiet");
  double angle = number_in(r.out, "angle_deg"), settles_s = number_in(r.out, "settles_s");
  double overshoot = number_in(r.out, "overshoot");
  free_ran(&r);
  write_scene(&l, l.gain, l.integral, angle);
  RUN_GOOD("run loop.yaml --quiet --digits 15 -o out");
  read_column(",amplitude_meas_m", amplitude);
  from = amplitude[STEP - 2];
  for (int k = FIRINGS - 100; k < FIRINGS; k++) to += amplitude[k] / 100;
  for (int k = STEP + 1; k < FIRINGS; k++) {
    double part = (amplitude[k] - from) / (to - from);
    largest = fmax(largest, part - 1);
    if (fabs(part - 1) > 0.01) settled = k - STEP;
  }
  printf("settles in %.3g s and %.3g s, overshoots by %.3g and %.3g\n", settles_s, 0.02 * settled,
         overshoot, largest);
  CLOSE_OF(0.02 * settled, settles_s, 0.02, 2.01);
  CLOSE_OF(largest, overshoot, 1, 0.005);
}

/* Without gains the loop is open: its multipliers are those of the orbit. */
static void without_gains(void) {
  const loop l = {"machine: {model: two_mass}\nsupply: {voltage: 440 V}\ninstruments: {set: none, "
                  "gap: {channel: z, range: "
                  "[0 mm, 30 mm], bits: none}}",
                  "sensor: gap, setpoint: 0.3 mm", 0, 0, 130};
  write_scene(&l, 0, 0, 130);
  ran r = run("steady loop.yaml --json --quiet");
  const char *closed = r.out ? strstr(r.out, "\"closed_loop\"") : NULL;
  EXPECT(closed && strstr(closed, "\"stable\": true"), "%s", r.err);
  CLOSE(number_in(closed, "angle_deg"), 130, 1e-12);
  CLOSE(number_in(closed ? strstr(closed, "multipliers") : NULL, "re"),
        number_in(strstr(r.out, "multipliers"), "re"), 1e-9);
  EXPECT(isnan(number_in(closed, "limit_both_times")), "%s", closed);
  free_ran(&r);
}

/* A sensor so fast that its low-pass forgets within a cycle is one without a low-pass: what it is
 * late by, 8 us of 20 ms, changes the limit by less than 1e-3. */
static void a_fast_sensor(void) {
  double times[2];
  for (int k = 0; k < 2; k++) {
    const loop l = {k ? "machine: {model: two_mass}\nsupply: {voltage: 440 V}\ninstruments: {set: "
                        "none, gap: {channel: z, "
                        "range: [0 mm, 30 mm], bandwidth: 20 kHz, rate: 100 kHz, bits: none}}"
                      : "machine: {model: two_mass}\nsupply: {voltage: 440 V}\ninstruments: {set: "
                        "none, gap: {channel: z, "
                        "range: [0 mm, 30 mm], rate: 100 kHz, bits: none}}",
                    "sensor: gap, setpoint: 0.3 mm", -5, 80, 140};
    write_scene(&l, l.gain, l.integral, l.angle);
    ran r = run("steady loop.yaml --json --quiet");
    times[k] = number_in(r.out, "limit_both_times");
    EXPECT(!isnan(times[k]), "%d: %s %s", k, r.err, r.out ? strstr(r.out, "closed_loop") : "");
    free_ran(&r);
  }
  CLOSE(times[1], times[0], 1e-3);
}

/* What cannot be told is said, and the orbit is reported all the same. */
static void what_is_missing(void) {
  const loop far = {"machine: {model: two_mass}\nsupply: {voltage: 440 V}\ninstruments: {set: "
                    "none, gap: {channel: z, range: "
                    "[0 mm, 30 mm], bits: none}}",
                    "sensor: gap, setpoint: 0.3 mm, angle: [129 deg, 131 deg]", 0, 10, 130};
  write_scene(&far, 0, 10, 130);
  ran r = run("steady loop.yaml");
  EXPECT(r.status == 0 && strstr(r.out, "no angle from 129 to 131 deg keeps the set point") &&
             strstr(r.err, "control: it is off here"),
         "%d %s", r.status, r.err);
  free_ran(&r);
  write_file(
      "bent.yaml",
      "machine: {model: two_mass}\nsupply: {voltage: 440 V}\nfiring: {every: 1, angle: 130 deg}\n"
      "instruments: {set: none, i: {range: [-3 A, 3 A]}}\n"
      "control: {law: amplitude, sensor: i, setpoint: 0.3 A, gain: 1 deg/A}\n");
  r = run("steady bent.yaml --quiet --json");
  EXPECT(r.status == 0 && strstr(r.out, "\"closed_loop_missing\": \"i is not linear"), "%d %s",
         r.status, r.err);
  free_ran(&r);
}

static const vs_test TESTS[] = {{"limits of the gain", limits},
                                {"a step of the set point", a_step_of_the_set_point},
                                {"without gains", without_gains},
                                {"a fast sensor", a_fast_sensor},
                                {"what is missing", what_is_missing}};

int main(void) {
  return program_suite("closed", TESTS, COUNT(TESTS));
}
