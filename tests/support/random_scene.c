/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "random_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "study/random.h"
#include "suite.h"

/* ---- drawing ---- */

enum { SEED = 21 };

/* The numbers of one scene, one after the other. */
typedef struct draw {
  uint64_t number, axis;
} draw;

/* C does not say in which order the arguments of a call are evaluated, so at most one of them may
 * draw. */

static double even(draw *d) {
  return vs_random_uniform(SEED, d->number, d->axis++);
}
static bool chance(draw *d, double share) {
  return even(d) < share;
}
static double between(draw *d, double low, double high) {
  return low + (high - low) * even(d);
}
static double decades(draw *d, double low, double high) {
  return low * pow(high / low, even(d));
}
static size_t one_of(draw *d, size_t count) {
  return (size_t)(even(d) * (double)count);
}
#define WORD(d, words) ((words)[one_of(d, COUNT(words))])

/* ---- machines ---- */

typedef struct parameter {
  const char *name;
  double value;
  const char *unit;
} parameter;

typedef struct machine {
  const char *name;
  double share;
  double voltage_v; /* rms that drives it well */
  double gap_mm;    /* 0: its coil has no gap to set */
  double henry, ohm;
  const char *kicked;      /* its key of a start in motion */
  bool loaded;             /* it has a key load */
  bool sensed;             /* it has the paper's instruments, one of which shows p */
  const parameter *varied; /* of its own, up to one without a name */
} machine;

static const parameter CONVEYOR[] = {{"trough_mass", 0.83, "kg"},
                                     {"base_mass", 4, "kg"},
                                     {"spring_stiffness", 43e3, "N/m"},
                                     {"mount_stiffness_x", 8e3, "N/m"},
                                     {"mount_stiffness_y", 40e3, "N/m"},
                                     {"spring_damping", 1.2, "N.s/m"},
                                     {0}};
static const parameter FIXED_BASE[] = {{"trough_mass", 0.83, "kg"},
                                       {"spring_stiffness", 43e3, "N/m"},
                                       {"spring_damping", 1.2, "N.s/m"},
                                       {0}};
static const parameter TWO_MASS[] = {{"trough_mass", 6, "kg"}, {"counter_mass", 10, "kg"},
                                     {"spring", 4.2e5, "N/m"}, {"spring_damping", 20, "N.s/m"},
                                     {"isolator", 2e4, "N/m"}, {0}};
static const parameter SOLENOID[] = {
    {"armature_mass", 0.016, "kg"}, {"load_mass", 0.01, "kg"}, {0}};
static const parameter SHAKER[] = {
    {"mass", 0.03118, "kg"}, {"stiffness", 2896.6, "N/m"}, {"damping", 6.846, "N.s/m"}, {0}};
static const parameter PIECE[] = {{"mass", 0.03118, "kg"},
                                  {"piece_mass", 0.7, "kg"},
                                  {"coupling", 5000, "N/m"},
                                  {"damping", 6.846, "N.s/m"},
                                  {0}};
static const machine MACHINES[] = {
    {"conveyor", 0.50, 440, 6, 1.6, 92, "vp", true, true, CONVEYOR},
    {"conveyor_bodies", 0.10, 440, 6, 1.6, 92, "vp", true, true, CONVEYOR},
    {"fixed_base", 0.14, 440, 6, 1.6, 92, "vp", true, false, FIXED_BASE},
    {"two_mass", 0.12, 230, 2, 0.46, 12, "vx", true, false, TWO_MASS},
    {"solenoid", 0.06, 12, 0, 0, 0, "vs", false, false, SOLENOID},
    {"lds_v203", 0.04, 6, 0, 764e-6, 1.6, "vx", false, false, SHAKER},
    {"lds_v203_piece", 0.04, 6, 0, 764e-6, 1.6, "vx", false, false, PIECE},
};

static const machine *draw_machine(draw *d) {
  double u = even(d);
  size_t n = 0;
  while (n + 1 < COUNT(MACHINES) && u >= MACHINES[n].share) u -= MACHINES[n++].share;
  return &MACHINES[n];
}

/* Masses, springs and dampers from a half to twice their own. A third of the machines is as it
 * ships. */
static void add_machine(draw *d, random_scene *s, const machine *m) {
  s->machine = m->name;
  vs_text_add(&s->text, "machine: {model: %s", m->name);
  bool own = chance(d, 0.33);
  for (size_t k = 0; m->varied[k].name && !own; k++)
    if (chance(d, 0.6))
      vs_text_add(&s->text, ", %s: %.4g %s", m->varied[k].name,
                  m->varied[k].value * decades(d, 0.5, 2), m->varied[k].unit);
  vs_text_add(&s->text, "}\n");
}

static void add_iron(draw *d, random_scene *s) {
  if (chance(d, 0.12)) {
    double exponent = between(d, 3, 9), flux_wb = between(d, 0.5, 2);
    vs_text_add(&s->text, ", saturation: {flux: %.3g Wb, exponent: %.3g", flux_wb, exponent);
    if (chance(d, 0.5))
      vs_text_add(&s->text, ", law: multiplicative}");
    else
      vs_text_add(&s->text, ", law: series, current: %.3g A}", between(d, 0.05, 0.4));
  }
  if (chance(d, 0.12)) vs_text_add(&s->text, ", leakage: %.3g H", decades(d, 0.01, 0.3));
}

static void add_stop(draw *d, random_scene *s, bool quadratic) {
  s->has_stop = true;
  bool clipped = quadratic || chance(d, 0.2);
  double damping = decades(d, 10, 1000);
  if (clipped)
    vs_text_add(&s->text,
                ", stop: {kind: quadratic_clipped, stiffness: %.3g N/m2, damping: %.3g N.s/m}",
                decades(d, 1e10, 1e12), damping);
  else
    vs_text_add(&s->text, ", stop: {stiffness: %.3g N/m, damping: %.3g N.s/m}",
                decades(d, 1e6, 2e7), damping);
}

static void add_actuator(draw *d, random_scene *s, const machine *m) {
  vs_text_add(&s->text, "actuator: {");
  size_t before = s->text.length;
  if (m->ohm > 0 && chance(d, 0.6))
    vs_text_add(&s->text, ", resistance: %.4g ohm", m->ohm * decades(d, 0.6, 1.7));
  if (m->henry > 0 && chance(d, 0.6))
    vs_text_add(&s->text, ", inductance: %.4g H", m->henry * decades(d, 0.6, 1.7));
  if (m->gap_mm > 0 && chance(d, 0.6))
    vs_text_add(&s->text, ", gap: %.4g mm", m->gap_mm * decades(d, 0.7, 1.5));
  if (m->gap_mm > 0 && strcmp(s->tier, "analytic")) add_iron(d, s);
  bool solenoid = !strcmp(m->name, "solenoid");
  if ((m->gap_mm > 0 || solenoid) && chance(d, 0.3)) add_stop(d, s, solenoid);
  s->has_stop = s->has_stop || solenoid; /* as it ships it has one */
  if (solenoid && s->ideal && chance(d, 0.3)) {
    vs_text_add(&s->text, ", law: %s/../spice/machines/solenoid_table.csv", VS_TEST_FOLDER);
    s->has_table = true;
  }
  if (s->text.length > before) { /* without the first comma */
    char *at = s->text.text + before;
    memmove(at, at + 2, s->text.length - before - 1);
    s->text.length -= 2;
  }
  vs_text_add(&s->text, "}\n");
}

static void add_load(draw *d, random_scene *s) {
  if (!chance(d, 0.3)) return;
  double fraction = even(d), density = between(d, 0.3, 3);
  vs_text_add(&s->text, "load: {density: %.3g g/cm3, fraction: %.3g}\n", density, fraction);
}

/* ---- mains and firing ---- */

static void add_supply(draw *d, random_scene *s, const machine *m, bool direct) {
  double volt = m->voltage_v * between(d, 0.4, 1.15);
  if (direct && !strcmp(s->deck, "chopper")) volt = fmin(volt, 150);
  if (!strcmp(s->deck, "bridge_link")) volt = fmin(volt, 230);
  vs_text_add(&s->text, "supply: {voltage: %.4g V", volt);
  if (direct)
    vs_text_add(&s->text, ", kind: step");
  else
    vs_text_add(&s->text, ", kind: sine, frequency: %.4g Hz", s->frequency_hz);
  s->shifted = !direct && chance(d, 0.15);
  if (s->shifted) vs_text_add(&s->text, ", phase: %.3g deg", between(d, -180, 180));
  if (!strcmp(s->tier, "circuit") && chance(d, 0.8)) {
    double mh = decades(d, 0.01, 5), ohm = decades(d, 0.05, 5);
    vs_text_add(&s->text, ", resistance: %.3g ohm, inductance: %.3g mH", ohm, mh);
  }
  vs_text_add(&s->text, "}\n");
}

/* True: the coil has a voltage of its own, which an ideal thyristor does not take. */
static bool has_no_valve(const random_scene *s) {
  return s->ideal && !strncmp(s->machine, "lds", 3);
}

static void add_firing(draw *d, random_scene *s, bool controlled) {
  if (has_no_valve(s)) {
    vs_text_add(&s->text, "firing: {valve: none}\n");
    return;
  }
  static const char *const EVERY[] = {"once", "once", "once", "1", "1", "1", "2", "3"};
  double angle = chance(d, 0.75) ? between(d, 80, 160) : between(d, 5, 176);
  const char *every = controlled ? "1" : WORD(d, EVERY);
  s->every = atoi(every);
  s->pulse_ms = 8;
  s->first_cycle = 1;
  vs_text_add(&s->text, "firing: {valve: thyristor, angle: %.4g deg, every: %s", angle, every);
  if (chance(d, 0.5)) {
    s->pulse_ms = decades(d, 0.02, 9);
    vs_text_add(&s->text, ", pulse_width: %.3g ms", s->pulse_ms);
  }
  if (chance(d, 0.1)) {
    s->first_cycle = chance(d, 0.5) ? 0 : 2;
    vs_text_add(&s->text, ", first_cycle: %d", s->first_cycle);
  }
  if (!strcmp(s->deck, "halfwave_paper") && chance(d, 0.4)) {
    double duty = between(d, 15, 60), khz = decades(d, 2, 20);
    vs_text_add(&s->text, ", burst_frequency: %.3g kHz, burst_duty: %.3g %%", khz, duty);
  }
  vs_text_add(&s->text, "}\n");
}

static void add_pwm(draw *d, random_scene *s) {
  double duty = between(d, 0.1, 0.9), most = 2 * fmin(duty, 1 - duty); /* of the depth */
  double hz = between(d, 20, 200), depth = chance(d, 0.5) ? 0 : most * between(d, 0, 0.99);
  vs_text_add(&s->text, "pwm: {carrier: %.3g kHz, duty: %.4f, depth: %.3f, frequency: %.3g Hz",
              decades(d, 2, 15), duty, depth, hz);
  vs_text_add(&s->text, ", dead_time: %.3g us}\n", chance(d, 0.3) ? 0 : between(d, 0.5, 5));
}

/* ---- circuits ---- */

static const char *const THYRISTORS[] = {"TYN1212", "thyristor_2t", "BT151-800R",
                                         "TYN1012", "12TTS08S",     "latch"};
static const char *const VARISTORS[] = {"v511da40", "v481da40", "s20k510",        "s20k460",
                                        "s14k510",  "s14k460",  "varistor_power", "varistor_siov"};
static const char *const FUSES_1[] = {"S505H-3-15-R", "S505H-3-15-R", "fuse", "fuse_ideal"};
static const char *const FUSES_2[] = {"FWP-10A14F",   "FWP-10A14F", "FWP-50A14F",
                                      "A070gRB10T13", "fuse",       "fuse_ideal"};
static const char *const DRIVES[] = {"gate_pulse_transformer", "gate_pulse_transformer",
                                     "gate_pt20_104", "gate_pt20_105", "gate_ideal"};

/* What a deck has to be drawn. */
enum {
  SNUBBER_1 = 1 << 0,
  SNUBBER_2 = 1 << 1,
  DISCS = 1 << 2,
  VARISTOR = 1 << 3,
  PARTS = 1 << 4,
  LATCH = 1 << 5,
  PWM = 1 << 6,
  LINE = 1 << 7
};
typedef struct deck {
  const char *name;
  double share;
  unsigned has;
  const char *elements[4]; /* that an event may open or short */
} deck;

static const deck DECKS[] = {
    {"halfwave_bare", 0.12, LATCH, {"Xeva", "Rsource"}},
    {"halfwave_snubbed", 0.24, LATCH | SNUBBER_1 | SNUBBER_2 | DISCS, {"R1", "C2", "R2", "Xeva"}},
    {"halfwave_paper", 0.26, SNUBBER_1 | SNUBBER_2 | PARTS, {"R1", "R2", "Xv1", "Xeva"}},
    {"fullwave_antiparallel", 0.14, SNUBBER_1 | SNUBBER_2 | VARISTOR, {"R1", "Xv1", "Xv2", "Xeva"}},
    {"bridge_halfcontrolled", 0.14, LATCH | SNUBBER_1 | VARISTOR, {"D1", "Xv", "R1one", "Xeva"}},
    {"chopper", 0.07, PWM, {"Rsnub", "Xdiode", "Rsource"}},
    {"bridge_link", 0.03, PWM | LINE, {"Rsnub", "Rbleed", "Rline"}},
};

static const deck *draw_deck(draw *d) {
  double u = even(d);
  size_t n = 0;
  while (n + 1 < COUNT(DECKS) && u >= DECKS[n].share) u -= DECKS[n++].share;
  return &DECKS[n];
}

static void add_parts(draw *d, random_scene *s) {
  for (int k = 1; k <= 3; k++)
    if (chance(d, 0.5)) vs_text_add(&s->text, ", varistor_%d: %s", k, WORD(d, VARISTORS));
  if (chance(d, 0.3)) vs_text_add(&s->text, ", fuse_1: %s", WORD(d, FUSES_1));
  if (chance(d, 0.3)) vs_text_add(&s->text, ", fuse_2: %s", WORD(d, FUSES_2));
  if (chance(d, 0.3)) vs_text_add(&s->text, ", transformer: autotransformer_ideal");
  if (chance(d, 0.4)) vs_text_add(&s->text, ", gate_drive: %s", WORD(d, DRIVES));
}

static void add_circuit(draw *d, random_scene *s, const deck *k) {
  vs_text_add(&s->text, "circuit: {deck: %s", k->name);
  if (!(k->has & PWM)) {
    s->part = THYRISTORS[one_of(d, COUNT(THYRISTORS) - s->judged)]; /* a latch has no limits */
    vs_text_add(&s->text, ", thyristor: %s", s->part);
  }
  if (k->has & SNUBBER_1 && chance(d, 0.7)) {
    double nf = decades(d, 2, 1000), ohm = decades(d, 10, 10e3);
    vs_text_add(&s->text, ", r1: %.4g ohm, c1: %.4g nF", ohm, nf);
  }
  if (k->has & SNUBBER_2 && chance(d, 0.5)) {
    double nf = decades(d, 2, 500), ohm = decades(d, 20, 10e3);
    vs_text_add(&s->text, ", r2: %.4g ohm, c2: %.4g nF", ohm, nf);
  }
  if (k->has & DISCS && chance(d, 0.4)) {
    double exponent = between(d, 15, 45), volt = between(d, 650, 1400);
    vs_text_add(&s->text, ", varistor_voltage: %.4g V, varistor_exponent: %.3g", volt, exponent);
  }
  if (k->has & VARISTOR && chance(d, 0.5))
    vs_text_add(&s->text, ", varistor: %s", WORD(d, VARISTORS));
  if (k->has & PARTS) add_parts(d, s);
  if (!strcmp(s->part, "latch") && chance(d, 0.5)) {
    double off = decades(d, 0.1, 10), on = decades(d, 2e-3, 0.5), volt = between(d, 0, 2);
    vs_text_add(&s->text,
                ", on_voltage: %.3g V, on_resistance: %.3g ohm, off_resistance: %.3g Mohm", volt,
                on, off);
  }
  if (!strcmp(k->name, "chopper") && chance(d, 0.7))
    vs_text_add(&s->text, ", electrolytic_start: %.3g V", between(d, 0, 150));
  vs_text_add(&s->text, "}\n");
}

/* ---- what happens ---- */

/* Two events of one group might clash. */
typedef enum group { MAINS, SURGE, GATE, CIRCUIT, MACHINE } group;
typedef struct happening {
  const char *kind;
  group group;
  bool ideal;         /* an ideal tier takes it */
  const char *key;    /* one number more; NULL: none */
  double low, high;   /* between these, by decades where low > 0 */
  const char *unit;   /* of it */
  const char *second; /* written as it is, or NULL */
} happening;

static const happening HAPPENINGS[] = {
    {"surge", SURGE, false, "level", 0.5, 4, " kV", NULL},
    {"surge", SURGE, false, "level", 0.5, 4, " kV", "polarity: negative"},
    {"ring_wave", SURGE, false, "level", 0.25, 6, " kV", NULL},
    {"eft", SURGE, false, "level", 0.25, 4, " kV", "duration: 1 ms"},
    {"sag", MAINS, true, "level", 0, 95, " %", "duration: 12 ms"},
    {"swell", MAINS, true, "level", 101, 180, " %", "duration: 12 ms"},
    {"interruption", MAINS, true, "duration", 0.2, 30, " ms", NULL},
    {"notch", MAINS, true, "duration", 0.05, 2, " ms", NULL},
    {"phase_jump", MAINS, true, "jump", -120, 120, " deg", NULL},
    {"harmonic", MAINS, true, "level", 1, 30, " %", "order: 5"},
    {"harmonic", MAINS, true, "level", 1, 10, " %", "order: 23"},
    {"missing_pulse", GATE, true, NULL, 0, 0, NULL, NULL},
    {"short_pulse", GATE, true, "duration", 0.0005, 0.5, " ms", NULL},
    {"weak_pulse", GATE, false, "level", 1, 95, " %", NULL},
    {"spurious_pulse", GATE, true, "duration", 0.0005, 0.5, " ms", NULL},
    {"coil_short", CIRCUIT, false, "fraction", 1, 100, " %", NULL},
    {"open", CIRCUIT, false, "level", 0.5, 5, " kV", NULL},
    {"short", CIRCUIT, false, NULL, 0, 0, NULL, NULL},
    {"jam", MACHINE, true, NULL, 0, 0, NULL, NULL},
    {"load", MACHINE, true, "fraction", 0, 1, "", NULL},
};

/* Pulses are told by their cycle, all other events by an instant, or a cycle and an angle. */
static bool has_cycle(const happening *h) {
  return h->group == GATE && strcmp(h->kind, "spurious_pulse");
}

static double end_cycle(const random_scene *s) { /* at which the run ends */
  return s->until_s * s->frequency_hz;
}

/* The cycle of a gate pulse of the run: the wanted one, or the other of cycles 1 and 2; 0: neither
 * has one. */
static int pulse_cycle(const random_scene *s, int wanted) {
  for (int n = 0; n < 2; n++) {
    const int cycle = n ? 3 - wanted : wanted, behind = cycle - s->first_cycle;
    const bool fires = s->every ? behind >= 0 && behind % s->every == 0 : behind == 0;
    if (fires && (cycle == 1 || end_cycle(s) > 1.1)) return cycle;
  }
  return 0;
}

/* One that the scene's tier, deck and machine take, of another group than the one before it. */
static const happening *draw_happening(draw *d, const random_scene *s, const deck *k,
                                       const machine *m, const happening *before) {
  for (;;) {
    const happening *h = &HAPPENINGS[one_of(d, COUNT(HAPPENINGS))];
    if (!k && !h->ideal) continue;
    if (h->group == GATE && has_no_valve(s)) continue;
    if (k && k->has & PWM && (h->group == GATE || h->group == MAINS)) continue;
    if (k && k->has & PWM && h->group == SURGE && !(k->has & LINE)) continue;
    if (!strcmp(h->kind, "load") && !m->loaded) continue;
    if (before && before->group == h->group) continue;
    if (has_cycle(h) && !pulse_cycle(s, 1)) continue;
    return h;
  }
}

static void add_instant(draw *d, random_scene *s, const happening *h) {
  if (has_cycle(h))
    vs_text_add(&s->text, "cycle: %d",
                pulse_cycle(s, chance(d, 0.7) || end_cycle(s) < 1.1 ? 1 : 2));
  else if (chance(d, 0.5))
    vs_text_add(&s->text, "at: %.5g ms", 1e3 * s->until_s * between(d, 0, 0.99));
  else
    vs_text_add(&s->text, "cycle: 1, angle: %.4g deg", 359 * fmin(end_cycle(s), 1) * even(d));
}

static const happening *add_event(draw *d, random_scene *s, int n, const deck *k, const machine *m,
                                  const happening *before) {
  const happening *h = draw_happening(d, s, k, m, before);
  s->extra = h->kind;
  vs_text_add(&s->text, "%se%d: {kind: %s, ", n ? ", " : "", n, h->kind);
  add_instant(d, s, h);
  if (h->key) {
    double value = h->low > 0 ? decades(d, h->low, h->high) : between(d, h->low, h->high);
    if (!strcmp(h->kind, "short_pulse")) value = fmin(value, 0.9 * s->pulse_ms);
    vs_text_add(&s->text, ", %s: %.4g%s", h->key, value, h->unit);
  }
  if (h->second) vs_text_add(&s->text, ", %s", h->second);
  if (!strcmp(h->kind, "open") || !strcmp(h->kind, "short")) {
    size_t count = 0;
    while (count < COUNT(k->elements) && k->elements[count]) count++;
    vs_text_add(&s->text, ", element: %s", k->elements[one_of(d, count)]);
  }
  vs_text_add(&s->text, "}");
  return h;
}

static void add_events(draw *d, random_scene *s, const deck *k, const machine *m) {
  const happening *before = NULL;
  if (s->shifted || !chance(d, 0.4)) return; /* cycles are then others */
  int count = chance(d, 0.25) ? 2 : 1;
  vs_text_add(&s->text, "events: {");
  for (int n = 0; n < count; n++) before = add_event(d, s, n, k, m, before);
  vs_text_add(&s->text, "}\n");
}

static void add_control(draw *d, random_scene *s) {
  if (chance(d, 0.5)) {
    s->extra = "amplitude";
    double integral = between(d, 0, 100), gain = between(d, -20, 5),
           setpoint = between(d, 0.1, 1.5);
    vs_text_add(&s->text,
                "instruments: {}\ncontrol: {law: amplitude, sensor: p, setpoint: %.3g mm, gain: "
                "%.3g deg/mm, "
                "integral: %.3g deg/mm.s, angle: [90 deg, 175 deg]}\n",
                setpoint, gain, integral);
  } else {
    s->extra = "phase";
    vs_text_add(&s->text,
                "instruments: {}\ncontrol: {law: phase, sensor: p, phase: %.3g deg, angle: [90 "
                "deg, 175 deg]}\n",
                between(d, 0, 360));
  }
}

/* ---- the run ---- */

/* Finer runs are shorter, as their steps are; and so are those whose circuit has fast parts: a
 * pulse width modulation, or a thyristor's capacitance that nothing damps. */
static void draw_run(draw *d, random_scene *s, double shorter) {
  static const struct {
    double share, judged, tolerance, most_ms;
  } ROWS[] = {
      {0.35, 0.3, 1e-3, 45}, {0.54, 0.67, 1e-4, 28}, {0.08, 0.03, 1e-5, 17}, {1, 1, 1e-6, 11}};
  double u = even(d);
  size_t n = 0;
  for (; n + 1 < COUNT(ROWS); n++) {
    double share = s->judged ? ROWS[n].judged : ROWS[n].share;
    if (u < share) break;
    u -= share;
  }
  double most_ms = s->judged ? fmin(ROWS[n].most_ms, 16) : ROWS[n].most_ms;
  s->tolerance = ROWS[n].tolerance;
  s->until_s = 1e-3 * between(d, 10, most_ms) / shorter;
}

static void add_run(draw *d, random_scene *s) {
  vs_text_add(&s->text, "run: {until: %.5g ms, tolerance: %.0e, verify: %s", 1e3 * s->until_s,
              s->tolerance, s->judged ? "always" : "never");
  if (strcmp(s->tier, "auto")) vs_text_add(&s->text, ", tier: %s", s->tier);
  if (!strcmp(s->tier, "circuit") && chance(d, 0.05)) vs_text_add(&s->text, ", method: gear");
  vs_text_add(&s->text, "}\n");
}

random_scene random_scene_at(int number) {
  static const char *const IDEAL[] = {"switched", "switched", "analytic", "auto"};
  draw d = {(uint64_t)number, 0};
  random_scene s = {.number = number, .part = "", .deck = "", .extra = "", .tier = "circuit"};
  s.judged = number % RANDOM_JUDGED == 0;
  bool ideal = chance(&d, 0.2) && !s.judged;
  const deck *k = ideal ? NULL : draw_deck(&d);
  const machine *m = draw_machine(&d);
  bool pwm = k && k->has & PWM, bare = k && !strcmp(k->name, "halfwave_bare");
  if (bare && !m->gap_mm) m = &MACHINES[0]; /* behind so small a coil it rings all of the time */
  bool controlled = !s.judged && !pwm && m->sensed && chance(&d, 0.08);
  if (k) s.deck = k->name;
  s.ideal = ideal;
  if (ideal) s.tier = m->gap_mm > 0 ? WORD(&d, IDEAL) : "switched";
  s.frequency_hz = chance(&d, 0.6) ? 50 : chance(&d, 0.7) ? 60 : between(&d, 40, 70);
  if (!strcmp(s.deck, "chopper")) s.frequency_hz = 50; /* of no mains, but of cycles */
  draw_run(&d, &s, pwm ? 6 : bare ? 1.5 : 1);
  vs_text_add(&s.text, "# random scene %d\n", number);
  add_machine(&d, &s, m);
  add_actuator(&d, &s, m);
  if (m->loaded) add_load(&d, &s);
  add_supply(&d, &s, m, pwm && !strcmp(s.deck, "chopper"));
  if (k) add_circuit(&d, &s, k);
  if (pwm) add_pwm(&d, &s);
  if (!pwm) add_firing(&d, &s, controlled);
  if (controlled)
    add_control(&d, &s);
  else
    add_events(&d, &s, k, m);
  if (chance(&d, 0.06)) {
    vs_text_add(&s.text, "start: {%s: %.3g m/s}\n", m->kicked, between(&d, -0.3, 0.3));
    if (!s.extra[0]) s.extra = "kick";
  }
  add_run(&d, &s);
  return s;
}

void random_scene_free(random_scene *s) {
  vs_text_free(&s->text);
}
