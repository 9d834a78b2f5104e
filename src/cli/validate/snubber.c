/* SPDX-License-Identifier: GPL-3.0-or-later
 * The RC snubber: a voltage E switched onto R-L with R_S-C across the open switch, by ngspice,
 * against closed forms. omega0 = 1/sqrt(LC), zeta = R/2 sqrt(C/L), chi = I_RR/E sqrt(L/C). Here E
 * is 100 V, L 1 mH and C 100 nF, so that R is 200 ohm zeta, I_RR 1 A chi and E omega0 10 V/us. */
#include "validate/experiment.h"
#define WIDTH "circuit.deck=validate/snubber", "run.tolerance=1e-6"
#define NORMAL WIDTH, "run.until=50us", "run.max_step=10ns", "supply.voltage=1 V"
#define BENCH(name, ...)                                                                           \
  static const vs_experiment name = {.perform = vs_experiment_perform,                             \
                                     .wall_s = 0.03,                                               \
                                     .tier = "circuit",                                            \
                                     .sets = {__VA_ARGS__, NULL}}

/* ---- by damping ratio ---- */

BENCH(zeta_005, NORMAL, "circuit.snubber_r=10 ohm");
BENCH(zeta_01, NORMAL, "circuit.snubber_r=20 ohm");
BENCH(zeta_02, NORMAL, "circuit.snubber_r=40 ohm");
BENCH(zeta_0265, NORMAL, "circuit.snubber_r=53 ohm");
BENCH(zeta_03, NORMAL, "circuit.snubber_r=60 ohm");
BENCH(zeta_05, NORMAL, "circuit.snubber_r=100 ohm");
BENCH(zeta_1, NORMAL, "circuit.snubber_r=200 ohm");

#define DAMPED(text, experiment, peak, rate)                                                       \
  {"snubber, zeta " text ": peak voltage",                                                         \
   "V",                                                                                            \
   &experiment,                                                                                    \
   "v_switch_max",                                                                                 \
   100 * (peak),                                                                                   \
   NULL,                                                                                           \
   6e-5,                                                                                           \
   100,                                                                                            \
   "closed form; optimum as published (Mohan)",                                                    \
   "half a unit of the last digit given"},                                                         \
  {                                                                                                \
    "snubber, zeta " text ": largest dv/dt", "V/us", &experiment, "rate_max", 10 * (rate), NULL,   \
        6e-5, 10, "closed form; optimum as published (Mohan)",                                     \
        "half a unit of the last digit given"                                                      \
  }

/* ---- the least peak that any damping gives, at a recovered current ---- */

BENCH(chi_05, NORMAL, "circuit.i_0=0.5 A", "circuit.snubber_r=219.2 ohm");
BENCH(chi_07, NORMAL, "circuit.i_0=0.7 A", "circuit.snubber_r=166.8 ohm");
BENCH(chi_1, NORMAL, "circuit.i_0=1 A", "circuit.snubber_r=129 ohm");
BENCH(chi_15, NORMAL, "circuit.i_0=1.5 A", "circuit.snubber_r=101.2 ohm");
BENCH(chi_2, NORMAL, "circuit.i_0=2 A", "circuit.snubber_r=88 ohm");
BENCH(chi_3, NORMAL, "circuit.i_0=3 A", "circuit.snubber_r=75.6 ohm");

#define LEAST(text, experiment, peak)                                                              \
  {                                                                                                \
    "snubber, best at chi " text ": peak voltage", "V", &experiment, "v_switch_max", 100 * (peak), \
        NULL, 6e-5, 100, "McMurray, IEEE Trans. IA-8, 1972", "half a unit of the last digit given" \
  }

/* ---- all the resistance in the load: 1 + exp(-pi zeta/sqrt(1 - zeta^2)) ---- */

BENCH(load_01, NORMAL, "circuit.snubber_r=0.001 ohm", "circuit.load_r=20 ohm");
BENCH(load_03, NORMAL, "circuit.snubber_r=0.001 ohm", "circuit.load_r=60 ohm");
BENCH(load_06, NORMAL, "circuit.snubber_r=0.001 ohm", "circuit.load_r=120 ohm");

#define IN_LOAD(text, experiment, peak)                                                            \
  {                                                                                                \
    "snubber, resistance in the load, zeta " text ": peak voltage", "V", &experiment,              \
        "v_switch_max", 100 * (peak), NULL, 6e-5, 100,                                             \
        "closed form, 1 + exp(-pi zeta/sqrt(1 - zeta^2))",                                         \
        "a milliohm is left in the snubber; steps of 1/1000 radian"                                \
  }

/* ---- the conveyor's coil, at the mains of its extinction ---- */

#define COIL                                                                                       \
  WIDTH, "run.until=2ms", "run.max_step=0.4us", "circuit.load_l=1.6 H", "circuit.load_r=92 ohm"
#define KEPT COIL, "circuit.voltage=-573.0 V"
#define GOING_ON COIL, "circuit.voltage=0 V", "circuit.mains_part=1", "supply.phase=247.0587deg"
BENCH(kept_100, KEPT, "circuit.snubber_r=100 ohm");
BENCH(kept_2k, KEPT, "circuit.snubber_r=2 kohm");
BENCH(kept_4k, KEPT, "circuit.snubber_r=4 kohm");
BENCH(sine_100, GOING_ON, "circuit.snubber_r=100 ohm");
BENCH(sine_2k, GOING_ON, "circuit.snubber_r=2 kohm");
BENCH(sine_4k, GOING_ON, "circuit.snubber_r=4 kohm");

#define ON_COIL(text, experiment, peak, rate)                                                      \
  {"snubber on the coil, " text ": peak voltage",                                                  \
   "V",                                                                                            \
   &experiment,                                                                                    \
   "v_switch_min",                                                                                 \
   peak,                                                                                           \
   NULL,                                                                                           \
   1e-4,                                                                                           \
   0,                                                                                              \
   "closed form",                                                                                  \
   "half a unit of the fourth digit"},                                                             \
  {                                                                                                \
    "snubber on the coil, " text ": largest dv/dt", "V/us", &experiment, "rate_min", -(rate),      \
        NULL, 5e-3, 1, "closed form", "half a unit of the last digit given"                        \
  }

static const vs_comparison COMPARISONS[] = {
    DAMPED("0.05", zeta_005, 1.8588, .9313),
    DAMPED("0.1", zeta_01, 1.7441, .8801),
    DAMPED("0.2", zeta_02, 1.5717, .8209),
    DAMPED("0.265", zeta_0265, 1.4887, .8101),
    DAMPED("0.3", zeta_03, 1.4510, .8134),
    DAMPED("0.5", zeta_05, 1.2984, 1.0),
    DAMPED("1", zeta_1, 1.1353, 2.0),
    LEAST("0.5", chi_05, 1.1773),
    LEAST("0.7", chi_07, 1.3005),
    LEAST("1", chi_1, 1.5062),
    LEAST("1.5", chi_15, 1.8760),
    LEAST("2", chi_2, 2.2610),
    LEAST("3", chi_3, 3.0494),
    IN_LOAD("0.1", load_01, 1.7292475),
    IN_LOAD("0.3", load_03, 1.3723261),
    IN_LOAD("0.6", load_06, 1.0947802),
    ON_COIL("100 ohm", kept_100, -1104.5, 1.38),
    ON_COIL("2 kohm", kept_2k, -852.0, 1.15),
    ON_COIL("4 kohm", kept_4k, -736.4, 1.43),
    ON_COIL("mains going on, 100 ohm", sine_100, -1171.7, 1.44),
    ON_COIL("mains going on, 2 kohm", sine_2k, -906.0, 1.19),
    ON_COIL("mains going on, 4 kohm", sine_4k, -784.1, 1.43),
};
const vs_comparisons vs_snubber_comparisons = {COMPARISONS,
                                               sizeof COMPARISONS / sizeof *COMPARISONS};
