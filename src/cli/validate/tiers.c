/* SPDX-License-Identifier: GPL-3.0-or-later
 * Tier against tier, where both are valid. */
#include "validate/experiment.h"
#define SCENE(name, tier_name, seconds, ...)                                                       \
  static const vs_experiment name = {.perform = vs_experiment_perform,                             \
                                     .wall_s = seconds,                                            \
                                     .tier = tier_name,                                            \
                                     .sets = {__VA_ARGS__, NULL}}

/* ---- analytic and switched: where p is so small that L is constant ---- */

#define FAINT "supply.voltage=0.44 V", "run.until=0.2s", "run.tolerance=1e-10"
SCENE(faint_analytic, "analytic", 0.01, FAINT);
SCENE(faint_switched, "switched", 0.01, FAINT);

#define AS_ANALYTIC(text, unit, what)                                                              \
  {                                                                                                \
    "switched as analytic, 0.44 V: " text, unit, &faint_switched, what, 0, &faint_analytic, 1e-6,  \
        0, "tier analytic", "p is 2e-7 of the gap, so L is constant to that"                       \
  }

/* ---- circuit, with parts that are all but ideal ---- */

#define IDEAL                                                                                      \
  "circuit.deck=halfwave_bare", "circuit.on_voltage=0 V", "circuit.on_resistance=1e-4 ohm",        \
      "circuit.off_resistance=1000 Mohm", "supply.resistance=0", "supply.inductance=0"
#define WEAK "supply.voltage=4.4 V", "run.until=0.1s"
SCENE(weak_analytic, "analytic", 0.01, WEAK, "run.tolerance=1e-10");
SCENE(weak_circuit, "circuit", 0.1, WEAK, "run.tolerance=1e-5", IDEAL);

#define THREE "three times run.tolerance, 1e-5"
#define CIRCUIT_AS_ANALYTIC(text, unit, what)                                                      \
  {                                                                                                \
    "circuit as analytic, 4.4 V: " text, unit, &weak_circuit, what, 0, &weak_analytic, 3e-5, 0,    \
        "tier analytic, p is 2e-5 of the gap", THREE                                               \
  }

/* ---- switched and circuit: a bare thyristor, all but ideal ---- */

#define SHORT "run.until=0.1s"
SCENE(bare, "circuit", 0.1, SHORT, IDEAL, "run.tolerance=1e-5");
#define EVERY_SECOND "run.until=0.2s", "firing.angle=120deg", "firing.every=2"
SCENE(switched, "switched", 0.01, SHORT, "run.tolerance=1e-10");
SCENE(bare_second, "circuit", 0.2, EVERY_SECOND, IDEAL, "run.tolerance=1e-5");
SCENE(switched_second, "switched", 0.01, EVERY_SECOND, "run.tolerance=1e-10");

#define AS_SWITCHED(text, unit, what, tolerance, why)                                              \
  {                                                                                                \
    "circuit as switched, bare: " text, unit, &bare, what, 0, &switched, tolerance, 0,             \
        "tier switched", why                                                                       \
  }
#define SECOND_CYCLE(text, unit, what)                                                             \
  {                                                                                                \
    "circuit as switched, every second cycle at 120 deg: " text, unit, &bare_second, what, 0,      \
        &switched_second, 3e-5, 0, "tier switched", THREE                                          \
  }

/* ---- halfwave_paper with ideal parts and halfwave_snubbed ---- */

SCENE(paper, "circuit", 0.15, SHORT, "circuit.deck=halfwave_paper", "circuit.thyristor=latch",
      "circuit.fuse_1=fuse_ideal", "circuit.fuse_2=fuse_ideal", "circuit.gate_drive=gate_ideal",
      "circuit.transformer=autotransformer_ideal", "circuit.varistor_1=varistor_power",
      "circuit.varistor_2=varistor_power", "circuit.varistor_3=varistor_power",
      "circuit.varistor_capacitance=1 pF", "circuit.r1=100 ohm", "circuit.c1=100 nF",
      "circuit.r2=220 ohm", "circuit.c2=47 nF");
SCENE(snubbed, "circuit", 0.1, SHORT, "circuit.deck=halfwave_snubbed");

#define AS_SNUBBED(text, unit, what, tolerance, why)                                               \
  {                                                                                                \
    "halfwave_paper as halfwave_snubbed: " text, unit, &paper, what, 0, &snubbed, tolerance, 0,    \
        "the other deck", why                                                                      \
  }
#define BOTH "run.tolerance, 1e-4, of both"

static const vs_comparison COMPARISONS[] = {
    AS_ANALYTIC("peak current", "A", "i_peak"),
    AS_ANALYTIC("extinction", "s", "t_extinction"),
    AS_ANALYTIC("peak force", "N", "force_peak"),
    AS_ANALYTIC("first peak of p", "m", "p_first_peak"),
    AS_ANALYTIC("second peak of p", "m", "p_second_peak"),
    AS_ANALYTIC("peak acceleration of p", "m/s2", "ap_peak"),
    AS_ANALYTIC("resonance", "Hz", "f_resonance"),

    CIRCUIT_AS_ANALYTIC("peak current", "A", "i_peak"),
    CIRCUIT_AS_ANALYTIC("peak force", "N", "force_peak"),
    CIRCUIT_AS_ANALYTIC("p_min", "m", "p_min"),
    CIRCUIT_AS_ANALYTIC("p_max", "m", "p_max"),

    AS_SWITCHED("peak current", "A", "i_peak", 3e-5, THREE),
    AS_SWITCHED("extinction", "s", "t_extinction", 3e-5, THREE),
    AS_SWITCHED("peak force", "N", "force_peak", 3e-5, THREE),
    AS_SWITCHED("first peak of p", "m", "p_first_peak", 3e-5, THREE),
    AS_SWITCHED("second peak of p", "m", "p_second_peak", 3e-5, THREE),
    AS_SWITCHED("peak acceleration of p", "m/s2", "ap_peak", 3e-5, THREE),
    AS_SWITCHED("energy drawn", "J", "energy.source", 3e-4, "currents are straight between steps"),
    AS_SWITCHED("work of the force", "J", "energy.work_force", 1e-4, "ten times run.tolerance"),
    SECOND_CYCLE("p_min", "m", "p_min"),
    SECOND_CYCLE("p_max", "m", "p_max"),
    SECOND_CYCLE("peak current", "A", "i_peak"),
    SECOND_CYCLE("peak force", "N", "force_peak"),
    {"circuit, bare: largest reverse voltage", "V", &bare, "v_ak_min", -622.2539674, NULL, 1e-5, 0,
     "closed form, the mains' peak", "run.tolerance"},
    {"circuit, bare: energy left over", "", &bare, "books", 0, NULL, 1e-4, 1,
     "energy is conserved; in parts of what was drawn",
     "ten times run.tolerance: what a run warns of"},

    AS_SNUBBED("peak current", "A", "i_peak", 2e-4, BOTH),
    AS_SNUBBED("extinction", "s", "t_extinction", 2e-4, BOTH),
    AS_SNUBBED("peak force", "N", "force_peak", 2e-4, BOTH),
    AS_SNUBBED("first peak of p", "m", "p_first_peak", 2e-4, BOTH),
    AS_SNUBBED("second peak of p", "m", "p_second_peak", 2e-4, BOTH),
    AS_SNUBBED("largest reverse voltage", "V", "v_ak_min", 1e-3, "1 pF, and 2 milliohms of fuses"),
    AS_SNUBBED("largest forward voltage", "V", "v_ak_max", 1e-3, "1 pF, and 2 milliohms of fuses"),
    {"halfwave_paper, ideal parts: energy left over", "", &paper, "books", 0, NULL, 1e-3, 1,
     "energy is conserved; in parts of what was drawn",
     "ten times run.tolerance: what a run warns of"},
};
const vs_comparisons vs_tiers_comparisons = {COMPARISONS, sizeof COMPARISONS / sizeof *COMPARISONS};
