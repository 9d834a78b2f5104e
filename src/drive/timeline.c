/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "drive/timeline.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/units.h"

#define S_(member) offsetof(vs_supply_values, member)
#define F_(member) offsetof(vs_firing_values, member)

static const vs_field SUPPLY[] = {
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
};
static const vs_field FIRING[] = {
    {"angle", VS_REAL, "deg", "100 deg", 0, 180, true, F_(angle_rad),
     "alpha*, from the rising zero crossing of the mains (Eq. 92)", NULL, NULL},
    {"pulse_width", VS_REAL, "ms", "8 ms", 0, 1e6, true, F_(pulse_width_s),
     "t_pulse, length of the gate pulse train", NULL, NULL},
    {"every", VS_COUNT, "", "once", 1, 1e6, false, F_(every), "fires in every n-th cycle", "once",
     NULL},
    {"first_cycle", VS_COUNT, "", "1", 1, 1e9, false, F_(first_cycle),
     "cycle of the first firing, counted from 1", NULL, NULL},
    {"burst_frequency", VS_REAL, "kHz", "5 kHz", 0.01, 1000, false, F_(burst_hz),
     "of the sub-pulses that fill a gate pulse; decks with a port burst", NULL, NULL},
    {"burst_duty", VS_REAL, "%", "30 %", 0, 100, true, F_(burst_duty),
     "part of each sub-pulse's period in which it is there", NULL, NULL},
};
const vs_section vs_timeline_supply_section = {"supply", SUPPLY, sizeof SUPPLY / sizeof *SUPPLY};
const vs_section vs_timeline_firing_section = {"firing", FIRING, sizeof FIRING / sizeof *FIRING};

vs_status vs_timeline_build(const vs_node *scene, vs_timeline *t, vs_error *err) {
  *t = (vs_timeline){0};
  size_t found = vs_error_count(err);
  const vs_node *firing = vs_tree_child(scene, "firing");
  vs_status s = vs_field_section_read(&vs_timeline_supply_section, vs_tree_child(scene, "supply"),
                                      &t->supply, err);
  if (!s) s = vs_field_section_read(&vs_timeline_firing_section, firing, &t->firing, err);
  if (s) return s;
  t->peak_v = t->supply.voltage_v * M_SQRT2;
  t->omega_rad_s = 2 * M_PI * t->supply.frequency_hz;
  t->period_s = 1 / t->supply.frequency_hz;
  double turns = -t->supply.phase_rad / (2 * M_PI);
  t->first_zero_s = (turns - floor(turns)) * t->period_s;
  if (vs_error_count(err) > found) return VS_OK;
  if (t->firing.every && t->firing.pulse_width_s >= t->firing.every * t->period_s) {
    const vs_node *width = vs_tree_child(firing, "pulse_width");
    return vs_fail_at(
        err, width ? width->where : (vs_where){0},
        "firing.pulse_width: %g ms reaches into the next pulse; allowed here: below %g ms",
        1e3 * t->firing.pulse_width_s, 1e3 * t->firing.every * t->period_s);
  }
  return VS_OK;
}

/* The numbers of all events of a stage, together. */
static double staged(const vs_timeline *t, vs_mains_stage stage, double t_s, double angle_rad) {
  double number = stage == VS_MAINS_FACTOR ? 1 : 0;
  for (size_t k = 0; k < t->events.count; k++) {
    const vs_occurrence *e = &t->events.item[k];
    if (!e->kind->mains || e->kind->stage != stage) continue;
    double own = e->kind->mains(e, t, t_s, angle_rad);
    number = stage == VS_MAINS_FACTOR ? number * own : number + own;
  }
  return number;
}

double vs_mains_voltage(const vs_timeline *t, double t_s) {
  double angle = t->omega_rad_s * t_s + t->supply.phase_rad;
  if (!t->events.count) return t->peak_v * sin(angle);
  angle += staged(t, VS_MAINS_ANGLE, t_s, angle);
  return t->peak_v * (sin(angle) + staged(t, VS_MAINS_ADDED, t_s, angle)) *
         staged(t, VS_MAINS_FACTOR, t_s, angle);
}

double vs_mains_stage_at(const vs_timeline *t, vs_mains_stage stage, double t_s) {
  return staged(t, stage, t_s, 0); /* the angle matters to harmonics alone */
}

double vs_mains_phase(const vs_timeline *t, double t_s) {
  double turns = (t_s - t->first_zero_s) / t->period_s;
  return 2 * M_PI * (turns - floor(turns));
}

/* Leading edge of the n-th pulse (n = 0, 1, ...), from integers, so that a million cycles do not
 * drift. */
static double pulse_start(const vs_timeline *t, double shift_rad, double n) {
  double cycle = t->firing.first_cycle - 1 + n * t->firing.every;
  return t->first_zero_s + (cycle + (t->firing.angle_rad + shift_rad) / (2 * M_PI)) * t->period_s;
}

/* An edge reached by a step is met only this well: ngspice ends a step at a breakpoint or 1e-11 of
 * the largest step before it. More would put the jump behind the breakpoint, where ngspice does not
 * expect one. */
double vs_timeline_rounding(double t_s) {
  return 1e-15 + 8 * DBL_EPSILON * t_s;
}

/* The last pulse that started before t (strictly, up to rounding); -1: none yet. */
static double last_pulse(const vs_timeline *t, double shift_rad, double t_s) {
  double since = t_s - pulse_start(t, shift_rad, 0);
  double slack = vs_timeline_rounding(t_s);
  if (since <= slack) return -1;
  if (!t->firing.every) return 0;
  return ceil((since - slack) / (t->firing.every * t->period_s)) - 1;
}

/* Length and voltage of the n-th pulse. */
static void pulse(const vs_timeline *t, double shift_rad, double n, double *width_s,
                  double *voltage) {
  *width_s = t->firing.pulse_width_s;
  *voltage = 1;
  for (size_t k = 0; k < t->events.count; k++) {
    const vs_occurrence *e = &t->events.item[k];
    if (e->kind->pulse && e->v.cycle == t->firing.first_cycle + n * t->firing.every &&
        vs_occurrence_at_gate(e, shift_rad))
      e->kind->pulse(e, width_s, voltage);
  }
}

/* Of the train's pulses the first that ends after t, as events leave it. */
static bool train_stretch(const vs_timeline *t, double shift_rad, double t_s, double until_s,
                          double *from_s, double *to_s) {
  double width, voltage;
  for (double n = fmax(last_pulse(t, shift_rad, t_s), 0); !n || t->firing.every; n++) {
    double start = pulse_start(t, shift_rad, n);
    if (start >= until_s) return false;
    pulse(t, shift_rad, n, &width, &voltage);
    if (!(voltage > 0) || start + width <= t_s) continue;
    *from_s = fmax(start, t_s);
    *to_s = start + width;
    return true;
  }
  return false;
}

bool vs_gate_stretch(const vs_timeline *t, double shift_rad, double t_s, double until_s,
                     double *from_s, double *to_s) {
  bool found = train_stretch(t, shift_rad, t_s, until_s, from_s, to_s);
  for (size_t k = 0; k < t->events.count; k++) {
    const vs_occurrence *e = &t->events.item[k];
    double from = fmax(e->start_s, t_s);
    if (!e->kind->adds_pulse || e->end_s <= t_s || e->start_s >= until_s ||
        !vs_occurrence_at_gate(e, shift_rad) || (found && *from_s <= from))
      continue;
    found = true;
    *from_s = from;
    *to_s = e->end_s;
  }
  return found;
}

/* A pulse besides those of the train: its start; -INFINITY: none at t. */
static double added_pulse(const vs_timeline *t, double shift_rad, double t_s, double *end_s) {
  double slack = vs_timeline_rounding(t_s);
  for (size_t k = 0; k < t->events.count; k++) {
    const vs_occurrence *e = &t->events.item[k];
    *end_s = e->end_s;
    if (e->kind->adds_pulse && t_s > e->start_s + slack && t_s <= e->end_s + slack &&
        vs_occurrence_at_gate(e, shift_rad))
      return e->start_s;
  }
  return -INFINITY;
}

double vs_gate_voltage(const vs_timeline *t, double shift_rad, double t_s) {
  double n = last_pulse(t, shift_rad, t_s), width, voltage, end, slack = vs_timeline_rounding(t_s);
  if (t->events.count && added_pulse(t, shift_rad, t_s, &end) > -INFINITY) return 1;
  if (n < 0) return 0;
  pulse(t, shift_rad, n, &width, &voltage);
  return t_s <= pulse_start(t, shift_rad, n) + width + slack ? voltage : 0;
}

bool vs_gate_named(const char *name, double *shift_rad) {
  char why[200];
  if (strncmp(name, "gate", 4) || (name[4] && name[4] != '+')) return false;
  *shift_rad = 0;
  return !name[4] || vs_units_read(name + 5, "deg", shift_rad, why, sizeof why);
}

bool vs_gate_is_on(const vs_timeline *t, double shift_rad, double t_s) {
  return vs_gate_voltage(t, shift_rad, t_s) > 0;
}

double vs_gate_edge(const vs_timeline *t, double shift_rad, double t_s) {
  double n = last_pulse(t, shift_rad, t_s), slack = vs_timeline_rounding(t_s), width, voltage;
  double fall = -INFINITY;
  if (n >= 0) pulse(t, shift_rad, n, &width, &voltage), fall = pulse_start(t, shift_rad, n) + width;
  if (fall > t_s + slack) return fall;
  double rise = n < 0 || t->firing.every ? pulse_start(t, shift_rad, n + 1) : INFINITY;
  return rise > t_s + slack ? rise : vs_gate_edge(t, shift_rad, t_s + 2 * slack);
}

/* The sub-pulse that began before t (strictly, up to rounding), by its time and the end of its gate
 * pulse; false: t is in none's period. */
static bool last_sub_pulse(const vs_timeline *t, double shift_rad, double t_s, double *start_s,
                           double *end_s) {
  double n = last_pulse(t, shift_rad, t_s), slack = vs_timeline_rounding(t_s), width, voltage;
  double start = t->events.count ? added_pulse(t, shift_rad, t_s, end_s) : -INFINITY, k;
  if (start == -INFINITY && n < 0) return false;
  if (start == -INFINITY) {
    pulse(t, shift_rad, n, &width, &voltage);
    start = pulse_start(t, shift_rad, n);
    *end_s = start + width;
  }
  k = ceil((t_s - start - slack) * t->firing.burst_hz) - 1;
  *start_s = start + k / t->firing.burst_hz;
  return *start_s < *end_s - slack;
}

bool vs_gate_burst(const vs_timeline *t, double shift_rad, double t_s) {
  double start, end, slack = vs_timeline_rounding(t_s);
  return last_sub_pulse(t, shift_rad, t_s, &start, &end) &&
         t_s <= fmin(start + t->firing.burst_duty / t->firing.burst_hz, end) + slack;
}

double vs_gate_burst_edge(const vs_timeline *t, double shift_rad, double t_s) {
  double start, end, slack = vs_timeline_rounding(t_s);
  if (last_sub_pulse(t, shift_rad, t_s + 2 * slack, &start, &end)) { /* one that begins now, too */
    double fall = fmin(start + t->firing.burst_duty / t->firing.burst_hz, end);
    double rise = start + 1 / t->firing.burst_hz;
    if (fall > t_s + slack) return fall;
    if (rise > t_s + slack && rise < end - slack) return rise;
  }
  /* of the gate's edges only the leading ones are left */
  double edge = vs_gate_edge(t, shift_rad, t_s);
  return vs_gate_is_on(t, shift_rad, edge) ? vs_gate_edge(t, shift_rad, edge) : edge;
}

static double mains_voltage(const vs_timeline *t, const vs_signal *s, double t_s) {
  (void)s;
  return vs_mains_voltage(t, t_s);
}
static double no_edge(const vs_timeline *t, const vs_signal *s, double t_s) {
  (void)t, (void)s, (void)t_s;
  return INFINITY; /* those of events are asked for all together */
}
static double gate_voltage(const vs_timeline *t, const vs_signal *s, double t_s) {
  return vs_gate_voltage(t, s->shift_rad, t_s);
}
static double gate_edge(const vs_timeline *t, const vs_signal *s, double t_s) {
  return vs_gate_edge(t, s->shift_rad, t_s);
}
static double burst_voltage(const vs_timeline *t, const vs_signal *s, double t_s) {
  return vs_gate_burst(t, s->shift_rad, t_s) ? vs_gate_voltage(t, s->shift_rad, t_s) : 0;
}
static double burst_edge(const vs_timeline *t, const vs_signal *s, double t_s) {
  return vs_gate_burst_edge(t, s->shift_rad, t_s);
}
static double event_voltage(const vs_timeline *t, const vs_signal *s, double t_s) {
  const vs_occurrence *e = &t->events.item[s->event];
  return e->kind->source(e, t_s);
}
const vs_drive vs_drives[VS_DRIVES] = {
    [VS_DRIVE_MAINS] = {"mains", false, mains_voltage, no_edge},
    [VS_DRIVE_GATE] = {"gate", true, gate_voltage, gate_edge},
    [VS_DRIVE_BURST] = {"burst", true, burst_voltage, burst_edge},
    [VS_DRIVE_EVENT] = {NULL, false, event_voltage, no_edge}};

double vs_gate_next_conduction(const vs_timeline *t, double t_s) {
  double n = last_pulse(t, 0, t_s);
  if (n < 0) n = 0;
  for (;; n++) { /* a pulse that meets no forward voltage is followed by others */
    if (n > 0 && !t->firing.every) return INFINITY;
    double from = fmax(pulse_start(t, 0, n), t_s);
    double to = pulse_start(t, 0, n) + t->firing.pulse_width_s;
    if (from > to) continue;
    double phase = vs_mains_phase(t, from);
    if (phase < M_PI) return from;
    double zero = from + (2 * M_PI - phase) / t->omega_rad_s;
    if (zero < to) return zero;
  }
}
