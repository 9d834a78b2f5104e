/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "drive/timeline.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define S_(member) offsetof(vs_supply_values, member)
#define F_(member) offsetof(vs_firing_values, member)

static const vs_field SUPPLY[] = {
    {"kind", VS_CHOICE, "", "sine", 0, 0, false, S_(direct),
     "sine: the mains; step: direct voltage from t = 0 on, on ideal tiers and for decks with a "
     "port "
     "pwm",
     "sine|step", NULL},
    {"voltage", VS_REAL, "V", "440 V", 0, 1e6, true, S_(voltage_v),
     "U, rms at the converter (Table 1)", NULL, NULL},
    {"frequency", VS_REAL, "Hz", "50 Hz", 0.1, 1e4, false, S_(frequency_hz), "f, mains (Table 1)",
     NULL, NULL},
    {"phase", VS_REAL, "deg", "0 deg", -360, 360, false, S_(phase_rad), "of the mains at t = 0",
     NULL, NULL},
    {"resistance", VS_REAL, "ohm", "0.5 ohm", 0, 1e5, false, S_(resistance_ohm),
     "R_s, source; circuit tier only", NULL, NULL},
    {"inductance", VS_REAL, "mH", "0.5 mH", 0, 1e5, false, S_(inductance_h),
     "L_s, source; circuit tier only", NULL, NULL},
    {"decoupling", VS_REAL, "mH", "0 mH", 0, 1e5, false, S_(decoupling_h),
     "of a coupling/decoupling network, in series with L_s; 1.5 mH: IEC 61000-4-5; circuit tier "
     "only",
     NULL, NULL},
};
static const vs_field FIRING[] = {
    {"valve", VS_CHOICE, "", "thyristor", 0, 0, false, F_(no_valve),
     "what stands between mains and coil; none: the coil is on the mains from t = 0, current both "
     "ways, ideal tiers only",
     "thyristor|none", NULL},
    {"angle", VS_PROFILE, "deg", "100 deg", 0, 180, true, F_(angle),
     "alpha*, from the rising zero crossing of the mains (Eq. 92)", NULL, NULL},
    {"pulse_width", VS_REAL, "ms", "8 ms", 0, 1e6, true, F_(pulse_width_s),
     "t_pulse, length of the gate pulse train", NULL, NULL},
    {"every", VS_COUNT, "", "once", 1, 1e6, false, F_(every), "fires in every n-th cycle", "once",
     NULL},
    {"first_cycle", VS_COUNT, "", "1", 0, 1e9, false, F_(first_cycle),
     "cycle of the first firing, from 1 on; 0: the cycle that is under way at t = 0", NULL, NULL},
    {"burst_frequency", VS_REAL, "kHz", "5 kHz", 0.01, 1000, false, F_(burst_hz),
     "of the sub-pulses that fill a gate pulse; decks with a port burst", NULL, NULL},
    {"burst_duty", VS_REAL, "%", "30 %", 0, 100, true, F_(burst_duty),
     "part of each sub-pulse's period in which it is there", NULL, NULL},
};
const vs_section vs_timeline_supply_section = {"supply", SUPPLY, sizeof SUPPLY / sizeof *SUPPLY};
const vs_section vs_timeline_firing_section = {"firing", FIRING, sizeof FIRING / sizeof *FIRING};

static const char NO_VALVE[] = "with firing.valve: none";

/* Error: a key of the firing where there is nothing to fire, or of a sine where the voltage is
 * direct. `why` tells why nothing fires. */
static vs_status refuse_unused(const vs_node *scene, const vs_timeline *t, const char *why,
                               vs_error *err) {
  const vs_node *firing = vs_tree_child(scene, "firing"), *supply = vs_tree_child(scene, "supply");
  const vs_node *phase = t->supply.direct ? vs_tree_child(supply, "phase") : NULL;
  for (const vs_node *n = firing ? firing->child : NULL; n; n = n->next)
    if (strcmp(n->key, "valve") != 0 || why != NO_VALVE)
      return vs_fail_at(err, n->key_where, "firing.%s: %s nothing fires; leave it out", n->key,
                        why);
  return phase ? vs_fail_at(err, phase->key_where,
                            "supply.phase: with supply.kind: step the voltage is direct; leave it "
                            "out")
               : VS_OK;
}

vs_status vs_timeline_build(const vs_node *scene, vs_timeline *t, vs_memo *memo, vs_error *err) {
  t->events.count = t->events.n_unbuilt = 0; /* its items are many, and count no more */
  t->program = NULL;
  size_t found = vs_error_count(err);
  const vs_node *firing = vs_tree_child(scene, "firing");
  vs_status s = vs_memo_read(memo, &vs_timeline_supply_section, vs_tree_child(scene, "supply"),
                             &t->supply, sizeof t->supply, err);
  if (!s)
    s = vs_memo_read(memo, &vs_timeline_firing_section, firing, &t->firing, sizeof t->firing, err);
  const vs_node *pwm = vs_tree_child(scene, vs_pwm_section.name);
  if (!s) s = vs_memo_read(memo, &vs_pwm_section, pwm, &t->pwm, sizeof t->pwm, err);
  if (s) return s;
  t->peak_v = t->supply.voltage_v * (t->supply.direct ? 1 : M_SQRT2);
  t->omega_rad_s = 2 * M_PI * t->supply.frequency_hz;
  t->period_s = 1 / t->supply.frequency_hz;
  double turns = -t->supply.phase_rad / (2 * M_PI);
  t->first_zero_s = (turns - floor(turns)) * t->period_s;
  if (vs_error_count(err) > found) return VS_OK;
  s = vs_error_carry_on(err, vs_pwm_check(pwm, &t->pwm, err));
  if (s || t->supply.direct) return s;
  if (t->firing.no_valve) return refuse_unused(scene, t, NO_VALVE, err);
  if (t->firing.every && t->firing.pulse_width_s >= t->firing.every * t->period_s) {
    return vs_fail_at(
        err, vs_tree_place(scene, "firing.pulse_width"),
        "firing.pulse_width: %g ms reaches into the next pulse; allowed here: below %g ms",
        1e3 * t->firing.pulse_width_s, 1e3 * t->firing.every * t->period_s);
  }
  return VS_OK;
}

/* True if the scene's firing drives something: a gate of the deck, or the thyristor of an ideal
 * tier, which no deck with pulse-width modulation is run on. */
static bool is_fired(const vs_deck *deck) {
  return vs_deck_has_port(deck, vs_port_is_gated) || !vs_deck_has_port(deck, vs_port_is_modulated);
}

vs_status vs_timeline_settle(const vs_node *scene, vs_timeline *t, const vs_deck *deck,
                             vs_error *err) {
  bool no_valve = t->firing.no_valve;
  if (!is_fired(deck)) t->firing.no_valve = 1;
  if (t->supply.direct && !t->firing.no_valve)
    return vs_fail_at(err, vs_tree_place(scene, "supply.kind"),
                      "supply.kind: step has no cycles for a thyristor to fire in; it wants "
                      "firing.valve: none");
  if (no_valve && !t->supply.direct) return VS_OK; /* vs_timeline_build has looked */
  return t->firing.no_valve
             ? refuse_unused(scene, t, no_valve ? NO_VALVE : "the deck has no port gate, and", err)
             : VS_OK;
}

/* The numbers of all events of a stage, multiplied where they are factors, else added. */
static double staged(const vs_timeline *t, vs_mains_stage stage, double t_s, double angle_rad) {
  double number = stage == VS_MAINS_FACTOR ? 1 : 0;
  for (size_t k = 0; k < t->events.count; k++) {
    const vs_occurrence *e = &t->events.item[k];
    if (!e->kind->mains || e->kind->stage != stage) continue;
    double own = e->kind->mains(e, t_s, angle_rad);
    number = stage == VS_MAINS_FACTOR ? number * own : number + own;
  }
  return number;
}

double vs_timeline_voltage(const vs_timeline *t, double t_s) {
  double angle = t->omega_rad_s * t_s + t->supply.phase_rad;
  if (t->supply.direct) return t->peak_v * staged(t, VS_MAINS_FACTOR, t_s, angle);
  if (!t->events.count) return t->peak_v * sin(angle);
  angle += staged(t, VS_MAINS_ANGLE, t_s, angle);
  return t->peak_v * (sin(angle) + staged(t, VS_MAINS_ADDED, t_s, angle)) *
         staged(t, VS_MAINS_FACTOR, t_s, angle);
}

double vs_timeline_stage(const vs_timeline *t, vs_mains_stage stage, double t_s) {
  return staged(t, stage, t_s, 0); /* only harmonics ask for the angle */
}

double vs_timeline_phase(const vs_timeline *t, double t_s) {
  double turns = (t_s - t->first_zero_s) / t->period_s;
  return 2 * M_PI * (turns - floor(turns));
}
