/* SPDX-License-Identifier: GPL-3.0-or-later
 * Generators against the standards they are made for, the surge into a varistor, varistor laws, and
 * the I2t of a half sine. */
#include "engine/events.h"
#include "validate/experiment.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* ---- the surge generator, its coupling capacitor shorted, and with its coupling ---- */

#define SURGE(name, probe, level, ...)                                                             \
  static const vs_experiment name = {.perform = vs_experiment_perform,                             \
                                     .wall_s = 0.1,                                                \
                                     .tier = "circuit",                                            \
                                     .sets = {"circuit.deck=validate/surge", "run.until=320us",    \
                                              "run.max_step=20ns",                                 \
                                              "events={s: {kind: surge, at: 1 us, level: " level   \
                                              "}, c: {kind: short, at: 0, element: Cvs_o0}}",      \
                                              __VA_ARGS__, NULL},                                  \
                                     .curve = probe}
SURGE(open_circuit, "v_load", "2 kV", "circuit.load=1 Mohm");
SURGE(short_circuit, "i_load", "2 kV", "circuit.load=1 mohm");
SURGE(into_750_1, "v_load", "1 kV", "circuit.varistor_voltage=750 V");
SURGE(into_750_2, "v_load", "2 kV", "circuit.varistor_voltage=750 V");
SURGE(into_750_4, "v_load", "4 kV", "circuit.varistor_voltage=750 V");
SURGE(into_1000_2, "v_load", "2 kV", "circuit.varistor_voltage=1 kV");

#define COUPLED(name, probe, coupling, ...)                                                        \
  static const vs_experiment name = {                                                              \
      .perform = vs_experiment_perform,                                                            \
      .wall_s = 0.1,                                                                               \
      .tier = "circuit",                                                                           \
      .sets = {"circuit.deck=validate/surge", "run.until=320us", "run.max_step=20ns",              \
               "events={s: {kind: surge, at: 1 us, level: 2 kV, coupling: " coupling "}}",         \
               __VA_ARGS__, NULL},                                                                 \
      .curve = probe}
COUPLED(line_open, "v_load", "line", "circuit.load=1 Mohm");
COUPLED(line_short, "i_load", "line", "circuit.load=1 mohm");
COUPLED(earth_open, "v_load", "earth", "circuit.load=1 Mohm");
COUPLED(earth_short, "i_load", "earth", "circuit.load=1 mohm");

#define AT_LINE(text, unit, experiment, what, value, tolerance)                                    \
  {                                                                                                \
    "surge through its coupling, " text, unit, &experiment, what, value, NULL, tolerance, 0,       \
        "IEC 61000-4-5, at the output of a coupling network", "the standard's tolerance"           \
  }

#define GENERATOR(text, unit, experiment, what, value)                                             \
  {                                                                                                \
    "surge generator, " text, unit, &experiment, what, value, NULL, 5e-3, 0,                       \
        "IEC 61000-4-5, 1.2/50 and 8/20 us, 2 ohm", "the network was solved for these"             \
  }
#define INTO(text, unit, experiment, what, value)                                                  \
  {                                                                                                \
    "surge into a varistor, " text, unit, &experiment, what, value, NULL, 1e-3, 0,                 \
        "independent solution", "the milliohm in the place of 18 uF, of 2 ohm"                     \
  }

/* ---- waves that come as a formula ---- */

static void sample_wave(double (*wave)(const vs_scene_event *, double), double until_s,
                        const vs_scene_event *e, vs_numbers *out) {
  enum { POINTS = 20000 };
  vs_experiment_curve curve = {0};
  for (int k = 0; k <= POINTS; k++) {
    double t = until_s * k / POINTS;
    vs_experiment_curve_add(&curve, t, wave(e, t));
  }
  vs_experiment_curve_numbers(&curve, out);
  vs_experiment_curve_free(&curve);
}

static const vs_scene_event OF_1V = {
    .v = {.level_v = 1, .frequency_hz = 5000, .duration_s = 15e-3}};

static vs_status perform_ring(const vs_experiment *e, const vs_observer *also, vs_numbers *out,
                              vs_error *err) {
  (void)e, (void)also, (void)err;
  sample_wave(vs_events_find("ring_wave")->source, 20e-6, &OF_1V, out);
  return VS_OK;
}
static vs_status perform_eft(const vs_experiment *e, const vs_observer *also, vs_numbers *out,
                             vs_error *err) {
  (void)e, (void)also, (void)err;
  sample_wave(vs_events_find("eft")->source, 200e-9, &OF_1V, out);
  return VS_OK;
}
static const vs_experiment ring = {.perform = perform_ring}, eft = {.perform = perform_eft};

/* ---- varistor laws ---- */

#define DRIVEN(name, ...)                                                                          \
  static const vs_experiment name = {                                                              \
      .perform = vs_experiment_perform,                                                            \
      .wall_s = 0.01,                                                                              \
      .tier = "circuit",                                                                           \
      .sets = {"circuit.deck=validate/current", "run.tolerance=1e-6", __VA_ARGS__, NULL}}
#define SLOWLY "run.until=2ms", "run.max_step=2us"
#define FAST "run.until=20us", "run.max_step=20ns"
DRIVEN(power_1ma, SLOWLY, "circuit.current=1 mA");
DRIVEN(power_1a, FAST, "circuit.current=1 A");
DRIVEN(power_100a, FAST, "circuit.current=100 A");
DRIVEN(siov_1ma, SLOWLY, "circuit.current=1 mA", "circuit.varistor=s20k460");
DRIVEN(siov_1a, FAST, "circuit.current=1 A", "circuit.varistor=s20k460");
DRIVEN(siov_100a, FAST, "circuit.current=100 A", "circuit.varistor=s20k460");

#define LAW(text, experiment, value, law)                                                          \
  {                                                                                                \
    "varistor, " text, "V", &experiment, "v_varistor_max", value, NULL, 1e-5, 0, law,              \
        "the inverted law's own 8e-6, run.tolerance 1e-6"                                          \
  }
#define POWER_LAW "closed form, 910 V (I/1 mA)^(1/30)"
#define SIOV_LAW "closed form, the maker's polynomial"

/* ---- the fuse's integral ---- */

static const vs_experiment half_sine = {
    .perform = vs_experiment_perform,
    .wall_s = 0.01,
    .tier = "circuit",
    .sets = {"circuit.deck=validate/half_sine", "run.until=10ms", "run.max_step=10us", NULL}};

static const vs_comparison COMPARISONS[] = {
    GENERATOR("open: peak", "V", open_circuit, "peak", 2000),
    GENERATOR("open: front time", "s", open_circuit, "front_v", 1.2e-6),
    GENERATOR("open: time to half value", "s", open_circuit, "half_v", 50e-6),
    GENERATOR("shorted: peak", "A", short_circuit, "peak", 1000),
    GENERATOR("shorted: front time", "s", short_circuit, "front_i", 8e-6),
    GENERATOR("shorted: time to half value", "s", short_circuit, "half_i", 20e-6),
    GENERATOR("shorted: undershoot", "A", short_circuit, "least", -336),

    AT_LINE("18 uF, open: peak", "V", line_open, "peak", 2000, 0.1),
    AT_LINE("18 uF, open: front time", "s", line_open, "front_v", 1.2e-6, 0.3),
    AT_LINE("18 uF, open: time to half value", "s", line_open, "half_v", 50e-6, 0.2),
    AT_LINE("18 uF, shorted: peak", "A", line_short, "peak", 1000, 0.1),
    AT_LINE("18 uF, shorted: front time", "s", line_short, "front_i", 8e-6, 0.2),
    AT_LINE("18 uF, shorted: time to half value", "s", line_short, "half_i", 20e-6, 0.2),
    AT_LINE("9 uF and 10 ohm, open: peak", "V", earth_open, "peak", 2000, 0.1),
    AT_LINE("9 uF and 10 ohm, open: front time", "s", earth_open, "front_v", 1.2e-6, 0.3),
    AT_LINE("9 uF and 10 ohm, open: time to half value", "s", earth_open, "half_v", 50e-6, 0.2),
    AT_LINE("9 uF and 10 ohm, shorted: peak", "A", earth_short, "peak", 2000.0 / 12, 0.1),
    AT_LINE("9 uF and 10 ohm, shorted: front time", "s", earth_short, "front_i", 2.5e-6, 0.3),
    AT_LINE("9 uF and 10 ohm, shorted: time to half value", "s", earth_short, "half_i", 25e-6, 0.3),

    INTO("750 V, 1 kV: current", "A", into_750_1, "i_load_max", 3.459),
    INTO("750 V, 1 kV: voltage", "V", into_750_1, "v_load_max", 984.07),
    INTO("750 V, 1 kV: energy", "J", into_750_1, "loss.load", 0.01519),
    INTO("750 V, 2 kV: current", "A", into_750_2, "i_load_max", 389.770),
    INTO("750 V, 2 kV: voltage", "V", into_750_2, "v_load_max", 1151.918),
    INTO("750 V, 2 kV: energy", "J", into_750_2, "loss.load", 6.3448),
    INTO("750 V, 2 kV: I2t", "A2.s", into_750_2, "load.i2t", 1.6929),
    INTO("750 V, 4 kV: current", "A", into_750_4, "i_load_max", 1361.075),
    INTO("750 V, 4 kV: voltage", "V", into_750_4, "v_load_max", 1200.947),
    INTO("750 V, 4 kV: energy", "J", into_750_4, "loss.load", 25.0901),
    INTO("1 kV, 2 kV: current", "A", into_1000_2, "i_load_max", 208.556),
    INTO("1 kV, 2 kV: voltage", "V", into_1000_2, "v_load_max", 1504.206),
    INTO("1 kV, 2 kV: energy", "J", into_1000_2, "loss.load", 3.8831),

    {"ring wave: peak", "", &ring, "peak", 1.0001, NULL, 6e-5, 1, "IEEE C62.41, its formula",
     "half a unit of the last digit given"},
    {"ring wave: rise", "s", &ring, "rise", 0.4999e-6, NULL, 2e-4, 0, "IEEE C62.41, 0.5 us",
     "a unit of the last digit given"},
    {"EFT pulse: rise", "s", &eft, "rise", 5.12e-9, NULL, 1e-3, 0, "IEC 61000-4-4, 5 ns +- 30 %",
     "half a unit of the last digit given"},
    {"EFT pulse: width", "s", &eft, "width", 49.4e-9, NULL, 1.1e-3, 0,
     "IEC 61000-4-4, 50 ns +- 30 %", "half a unit of the last digit given"},

    LAW("power law at 1 mA", power_1ma, 910, POWER_LAW),
    LAW("power law at 1 A", power_1a, 1145.6221247, POWER_LAW),
    LAW("power law at 100 A", power_100a, 1335.6973335, POWER_LAW),
    LAW("s20k460 at 1 mA", siov_1ma, 750.0916721, SIOV_LAW),
    LAW("s20k460 at 1 A", siov_1a, 930.3603641, SIOV_LAW),
    LAW("s20k460 at 100 A", siov_100a, 1124.5261840, SIOV_LAW),

    {"half sine of 100 A, 10 ms: I2t", "A2.s", &half_sine, "pulse.i2t", 50, NULL, 1e-4, 0,
     "closed form, I^2 t/2", "run.tolerance"},
};
const vs_comparisons vs_surge_comparisons = {COMPARISONS, COUNT(COMPARISONS)};
