/* SPDX-License-Identifier: GPL-3.0-or-later
 * The machines that come with the program besides the conveyor: modes, single shots, periodic
 * orbits, a shaker and a solenoid on a voltage that is switched on; and the paper's machine with
 * saturation and leakage. */
#include "validate/experiment.h"
#include "validate/orbit.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))
#define MACHINES "machines: "

/* One comparison of an experiment: what it is in words, its unit, number and value, the tolerance
 * in parts of the scale, and the scale (0: the value itself). */
#define IS(experiment, text, unit, what, value, tolerance, scale, source, why)                     \
  { MACHINES text, unit, &experiment, what, value, NULL, tolerance, scale, source, why }
#define INTEGRATORS "two or three unlike integrators, which agree to 1e-10"

/* ---- modes ---- */

static const vs_experiment modes_fixed = {.perform = vs_experiment_modes, .scene = "fixed_base"};
static const vs_experiment modes_two = {.perform = vs_experiment_modes, .scene = "two_mass"};

#define MODE(experiment, text, unit, what, value)                                                  \
  IS(experiment, text, unit, what, value, 1e-9, 0, "eigenvalues by other programs",                \
     "a tenth of the eight digits asked for")

/* ---- single shots ---- */

#define SHOT(name, ...)                                                                            \
  static const vs_experiment name = {.perform = vs_experiment_perform,                             \
                                     .wall_s = 0.01,                                               \
                                     .tier = "switched",                                           \
                                     __VA_ARGS__,                                                  \
                                     .look_s = {0.1}}
SHOT(shot_fixed, .scene = "fixed_base", .sets = {"run.until=0.1s", "run.tolerance=1e-10", NULL});
SHOT(shot_two, .scene = "two_mass", .sets = {"run.until=0.1s", "run.tolerance=1e-10", NULL});
#define SERIES "actuator.saturation={law: series, flux: 1.2 Wb, exponent: 7, current: 0.2 A}"
#define PRODUCT "actuator.saturation={law: multiplicative, flux: 1.5 Wb, exponent: 6}"
SHOT(shot_s, .sets = {SERIES, "run.until=0.1s", "run.tolerance=1e-10", NULL});
SHOT(shot_m, .sets = {PRODUCT, "run.until=0.1s", "run.tolerance=1e-10", NULL});
SHOT(shot_k,
     .sets = {SERIES, "actuator.leakage=0.15 H", "run.until=0.1s", "run.tolerance=1e-10", NULL});

#define EXACT(experiment, text, unit, what, value, scale)                                          \
  IS(experiment, text, unit, what, value, 1e-8, scale, INTEGRATORS,                                \
     "a hundred times run.tolerance, 1e-10")
#define SINGLE(experiment, text, i, i_at, f, t_ext, first, first_at, second, end, e_in, e_cu)      \
  EXACT(experiment, text ", single shot: peak current", "A", "i_peak", i, 0),                      \
      EXACT(experiment, text ", single shot: peak current, when", "s", "i_peak.at", i_at, 0),      \
      EXACT(experiment, text ", single shot: peak force", "N", "force_peak", f, 0),                \
      EXACT(experiment, text ", single shot: extinction", "s", "t_extinction", t_ext, 0),          \
      EXACT(experiment, text ", single shot: first peak", "m", "gap_first_peak", first, 0),        \
      EXACT(experiment, text ", single shot: first peak, when", "s", "gap_first_peak.at",          \
            first_at, 0),                                                                          \
      EXACT(experiment, text ", single shot: second peak", "m", "gap_second_peak", second, 0),     \
      EXACT(experiment, text ", single shot: travel at 0.1 s", "m", "travel@0.1", end, first),     \
      EXACT(experiment, text ", single shot: energy drawn", "J", "energy_in", e_in, 0),            \
      EXACT(experiment, text ", single shot: energy lost in copper", "J", "energy_copper", e_cu,   \
            0),                                                                                    \
      IS(experiment, text ", single shot: energy left over", "", "books", 0, 1e-9, 1,              \
         "energy is conserved; in parts of what was drawn", "ten times run.tolerance, 1e-10")

/* The same on the circuit tier, with parts that are all but ideal. */
#define IDEAL                                                                                      \
  "circuit.deck=halfwave_bare", "circuit.on_voltage=0 V", "circuit.on_resistance=1e-4 ohm",        \
      "circuit.off_resistance=1000 Mohm", "supply.resistance=0", "supply.inductance=0",            \
      "run.until=0.1s", "run.tolerance=1e-5"
#define CIRCUIT(name, ...)                                                                         \
  static const vs_experiment name = {.perform = vs_experiment_perform,                             \
                                     .wall_s = 0.3,                                                \
                                     .tier = "circuit",                                            \
                                     .sets = {__VA_ARGS__, IDEAL, NULL}}
CIRCUIT(circuit_s, SERIES);
CIRCUIT(circuit_m, PRODUCT);
CIRCUIT(circuit_k, SERIES, "actuator.leakage=0.15 H");

#define NEAR(experiment, text, unit, what, value)                                                  \
  IS(experiment, text, unit, what, value, 3e-5, 0, INTEGRATORS, "three times run.tolerance, 1e-5")
#define IN_CIRCUIT(experiment, text, i, f, first)                                                  \
  NEAR(experiment, text ", circuit: peak current", "A", "i_peak", i),                              \
      NEAR(experiment, text ", circuit: peak force", "N", "force_peak", f),                        \
      NEAR(experiment, text ", circuit: first peak", "m", "gap_first_peak", first)

/* ---- periodic orbits ---- */

#define ORBIT(name, scene_name, angle)                                                             \
  static const vs_experiment name = {.perform = vs_orbit_perform,                                  \
                                     .wall_s = 0.02,                                               \
                                     .scene = scene_name,                                          \
                                     .tier = "switched",                                           \
                                     .multipliers = true,                                          \
                                     .sets = {"firing.angle=" angle, "firing.every=1",             \
                                              "run.until=2s", "run.tolerance=1e-10", NULL}}
ORBIT(orbit_fixed, "fixed_base", "150deg");
ORBIT(orbit_two, "two_mass", "130deg");

#define STEADY(experiment, text, g_min, g_max, i, f, t_ext, p_in, p_cu, i_rms)                     \
  EXACT(experiment, text ": gap_min", "m", "gap_min", g_min, 0),                                   \
      EXACT(experiment, text ": gap_max", "m", "gap_max", g_max, 0),                               \
      EXACT(experiment, text ": peak current", "A", "i_peak", i, 0),                               \
      EXACT(experiment, text ": peak force", "N", "force_peak", f, 0),                             \
      EXACT(experiment, text ": extinction", "s", "t_extinction", t_ext, 0),                       \
      EXACT(experiment, text ": power", "W", "power", p_in, 0),                                    \
      EXACT(experiment, text ": power lost in copper", "W", "power_copper", p_cu, 0),              \
      EXACT(experiment, text ": current, rms", "A", "i_rms", i_rms, 0)
#define MULTIPLIER(experiment, text, what, value)                                                  \
  IS(experiment, text, "", what, value, 6e-10, 1, "the same map by other integrators",             \
     "half a unit of the last digit given, and run.tolerance, 1e-10")

/* ---- the shaker ---- */

#define SHAKER(name, looks, ...)                                                                   \
  static const vs_experiment name = {.perform = vs_experiment_perform,                             \
                                     .wall_s = 0.01,                                               \
                                     .scene = "lds_v203",                                          \
                                     .tier = "switched",                                           \
                                     .look_s = looks,                                              \
                                     .sets = {__VA_ARGS__, "run.tolerance=1e-10", NULL}}
#define AT(...)                                                                                    \
  { __VA_ARGS__ }
SHAKER(shaker_step, AT(0.001, 0.005, 0.02), "run.until=0.1s");
SHAKER(shaker_rise, AT(0), "run.until=0.003s"); /* to the first extremum of i */
/* A sine with a peak of 1 V, long after what it began with has died away. */
SHAKER(shaker_sine, AT(1, 1.0125), "run.until=1.02s", "supply.kind=sine", "supply.frequency=20 Hz",
       "supply.voltage=0.70710678118654752 V");

#define CLOSED(experiment, text, unit, what, value, scale)                                         \
  IS(experiment, "shaker, " text, unit, what, value, 1e-8, scale, "closed form",                   \
     "a hundred times run.tolerance; in parts of the peak")
#define STEP(at, x, v, i)                                                                          \
  CLOSED(shaker_step, "step: x at " at " s", "m", "x@" at, x, 6.77e-3),                            \
      CLOSED(shaker_step, "step: speed at " at " s", "m/s", "vx@" at, v, 0.82),                    \
      CLOSED(shaker_step, "step: current at " at " s", "A", "i@" at, i, 5.23)
/* amplitude times sine and cosine of the phase */
#define SINE(what, unit, channel, at_0, at_90, amplitude)                                          \
  CLOSED(shaker_sine, "20 Hz: " what " where the voltage rises through 0", unit, channel "@1",     \
         at_0, amplitude),                                                                         \
      CLOSED(shaker_sine, "20 Hz: " what " at the voltage's peak", unit, channel "@1.0125", at_90, \
             amplitude)

/* ---- the solenoid ---- */

#define SOLENOID(name, looks, ...)                                                                 \
  static const vs_experiment name = {.perform = vs_experiment_perform,                             \
                                     .wall_s = 0.02,                                               \
                                     .scene = "solenoid",                                          \
                                     .tier = "switched",                                           \
                                     .look_s = looks,                                              \
                                     .sets = {"run.tolerance=1e-7", __VA_ARGS__, NULL}}
SOLENOID(solenoid, AT(0.008, 0.012, 0.02), "run.until=0.021s");
SOLENOID(solenoid_peak, AT(0), "run.until=0.01s"); /* before the current rises again */
SOLENOID(solenoid_linear, AT(0.0124, 0.0128), "run.until=0.013s",
         "actuator.stop={kind: linear, stiffness: 1e6 N/m, damping: 200 N.s/m, at: 0.25 mm}");

#define SOLVED(experiment, text, unit, what, value, scale)                                         \
  IS(experiment, "solenoid, " text, unit, what, value, 1e-6, scale,                                \
     "other integrators of the equations of the Modelica Standard Library",                        \
     "ten times run.tolerance, 1e-7")
#define SAMPLE(at, z, flux, i, force)                                                              \
  SOLVED(solenoid, "gap at " at " s", "m", "z@" at, z, 0),                                         \
      SOLVED(solenoid, "flux linkage at " at " s", "Wb", "lambda@" at, flux, 0),                   \
      SOLVED(solenoid, "current at " at " s", "A", "i@" at, i, 0),                                 \
      SOLVED(solenoid, "force at " at " s", "N", "force@" at, force, 0)

/* Its actuator from a table of 20 gaps and 31 currents, up to the contact, where the table ends. */
static const vs_experiment solenoid_table = {.perform = vs_experiment_perform,
                                             .wall_s = 0.02,
                                             .scene = "solenoid_table",
                                             .tier = "switched",
                                             .look_s = AT(0.008, 0.012)};
#define TABLE(text, unit, what, value)                                                             \
  IS(solenoid_table, "solenoid from a table: " text, unit, what, value, 5e-3, 0,                   \
     "other integrators of the equations of the Modelica Standard Library",                        \
     "what gaps 0.25 mm apart leave of the force")

static const vs_comparison COMPARISONS[] = {
    MODE(modes_fixed, "fixed base, mode: frequency", "Hz", "f1", 51.2307024887),
    MODE(modes_fixed, "fixed base, mode: time constant", "s", "tau1", 0.6916666667),
    MODE(modes_two, "two masses, mode 1: frequency", "Hz", "f1", 5.60804323363),
    MODE(modes_two, "two masses, mode 2: frequency", "Hz", "f2", 53.4432582966),
    MODE(modes_two, "two masses, mode 1: time constant", "s", "tau1", 1.621323837),
    MODE(modes_two, "two masses, mode 2: time constant", "s", "tau2", 0.3278810283),

    SINGLE(shot_fixed, "fixed base", 0.84755834705, 0.00937555595, 95.678944449, 0.01376446144,
           -0.0013273743082, 0.0144932696, 0.0013087757128, 0.00085414580034, 0.3456225057,
           0.2691431102),
    SINGLE(shot_two, "two masses", 1.317153444, 0.00955441597, 222.73355935, 0.013640301681,
           -0.00060634592841, 0.0145155118, 0.00058891881562, 0.00042644571322, 0.1561023054,
           0.07687320797),
    SINGLE(shot_s, "law S", 1.2884797007, 0.00934100892, 88.635095317, 0.013617686556, -0.001296558,
           0.0139218354, 0.0012677986356, -0.00075217313145, 0.5157028251, 0.4421181214),
    SINGLE(shot_m, "law M", 1.264466234, 0.00931648797, 101.21092622, 0.013629717245,
           -0.0014123810503, 0.0139257756, 0.0013810970804, -0.00081816469135, 0.5154860345,
           0.4281561778),
    SINGLE(shot_k, "law S and leakage", 1.0125937925, 0.00946408396, 74.847781157, 0.013727115868,
           -0.0011285110331, 0.0140128642, 0.0011034412318, -0.00063148180291, 0.3722316814,
           0.3164929452),
    IN_CIRCUIT(circuit_s, "law S", 1.2884797007, 88.635095317, -0.001296558),
    IN_CIRCUIT(circuit_m, "law M", 1.264466234, 101.21092622, -0.0014123810503),
    IN_CIRCUIT(circuit_k, "law S and leakage", 1.0125937925, 74.847781157, -0.0011285110331),

    STEADY(orbit_fixed, "fixed base, orbit at 150 deg", -0.00012196812378, 0.00012009416534,
           0.15329683691, 3.0014203897, 0.011566612412, 0.1870901158, 0.1853348668, 0.04488328667),
    MULTIPLIER(orbit_fixed, "fixed base, orbit at 150 deg: multiplier", "multiplier1", 0.971444741),
    STEADY(orbit_two, "two masses, orbit at 130 deg", -0.00035404968735, 0.00033816010455,
           0.63842439604, 68.740115634, 0.012664816272, 0.8464749564, 0.7069804534, 0.2427242011),
    MULTIPLIER(orbit_two, "two masses, orbit at 130 deg: multiplier 1", "multiplier1", 0.987740250),
    MULTIPLIER(orbit_two, "two masses, orbit at 130 deg: multiplier 3", "multiplier3", 0.939078381),

    STEP("0.001", 0.000127862768692, 0.319395303456, 4.20408662937),
    STEP("0.005", 0.00314544357825, 0.823797149213, 3.23981706413),
    STEP("0.02", 0.00677011695283, 0.0025854053243, 5.2177005625),
    CLOSED(shaker_step, "step: first peak of x", "m", "gap_first_peak", 0.0067714270409, 0),
    CLOSED(shaker_step, "step: first peak of x, when", "s", "gap_first_peak.at", 0.021128094382, 0),
    CLOSED(shaker_step, "step: second peak of x", "m", "gap_second_peak", 0.00675692105916, 0),
    CLOSED(shaker_rise, "step: first peak of the current", "A", "i_peak", 4.26356695966, 0),
    CLOSED(shaker_rise, "step: first peak of the current, when", "s", "i_peak.at", 0.00122432379758,
           0),
    SINE("x", "m", "x", -0.000494220300015, 0.000552257360146, 0.000741108559377),
    SINE("speed", "m/s", "vx", 0.0693987066210, 0.0621055545513, 0.0931304482261),
    SINE("current", "A", "i", -0.190493474369, 0.468238884316, 0.505505110323),

    SOLVED(solenoid_peak, "peak current", "A", "i_peak", 1.0073962738, 0),
    SOLVED(solenoid_peak, "peak current, when", "s", "i_peak.at", 0.0069357041473, 0),
    SOLVED(solenoid, "contact", "s", "contact", 0.012281796804, 0),
    SOLVED(solenoid, "current at the contact", "A", "i@contact", 0.3852808708, 0),
    SOLVED(solenoid, "flux linkage at the contact", "Wb", "lambda@contact", 0.05141216523, 0),
    SOLVED(solenoid, "release", "s", "release", 0.01251481158, 0),
    SOLVED(solenoid, "current at the release", "A", "i@release", 0.3997278239, 0),
    SOLVED(solenoid, "flux linkage at the release", "Wb", "lambda@release", 0.05334013467, 0),
    SAMPLE("0.008", 0.003746295142, 0.0350100584, 0.9936220385, 3.090742444),
    SAMPLE("0.012", 0.0006067959254, 0.04930137236, 0.5092345686, 8.955993363),
    SAMPLE("0.02", 0.0002294630206, 0.09839182456, 0.7239651584, 42.58175755),
    SOLVED(solenoid_linear, "linear stop: gap at 0.0124 s", "m", "z@0.0124", 0.00015374624399, 0),
    SOLVED(solenoid_linear, "linear stop: gap at 0.0128 s", "m", "z@0.0128", 0.00021442815682, 0),
    TABLE("peak current", "A", "i_peak", 1.0073962738),
    TABLE("peak current, when", "s", "i_peak.at", 0.0069357041473),
    TABLE("gap at 0.008 s", "m", "z@0.008", 0.003746295142),
    TABLE("gap at 0.012 s", "m", "z@0.012", 0.0006067959254),
    TABLE("flux linkage at 0.012 s", "Wb", "lambda@0.012", 0.04930137236),
    TABLE("current at 0.012 s", "A", "i@0.012", 0.5092345686),
    TABLE("force at 0.012 s", "N", "force@0.012", 8.955993363),
    IS(solenoid, "solenoid: energy left over", "", "books", 0, 1e-6, 1,
       "energy is conserved; in parts of what was drawn", "ten times run.tolerance, 1e-7"),
};
const vs_comparisons vs_machines_comparisons = {COMPARISONS, COUNT(COMPARISONS)};
