/* SPDX-License-Identifier: GPL-3.0-or-later
 * Events on the tiers with an ideal thyristor: against an integration of their own that uses
 * nothing of the program but a scene's numbers and the machine's matrices, against the circuit tier
 * with all but ideal parts, and by the books of energy. */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "suite.h"

/* ---- the other integration: GSL's rk8pd in short steps of one length, edges and zeros met ---- */

enum { FLUX = 8, STATES, MOST_EDGES = 400, MOST_ROWS = 1000 };

typedef struct march {
  const vs_setup *setup;
  double edge_s[MOST_EDGES]; /* whatever changes, sorted */
  size_t edges;
  double t_s, mid_s, y[STATES];
  bool on, jammed, gap_rests;
  double mass[4][4], load_kg;
  double fired_s[32], ended_s[32];
  size_t fired, ended;
  gsl_odeiv2_system system;
  gsl_odeiv2_step *step;
} march;

static bool is(const vs_scene_event *e, const char *kind) {
  return !strcmp(e->kind->name, kind);
}

/* By `at` alone: the scenes here say no cycle and angle of what has a time. */
static bool within(const vs_scene_event *e, double t_s) {
  double since = t_s - e->v.at_s, period = 1 / 50.0;
  if (is(e, "phase_jump") || is(e, "jam") || is(e, "load")) return since > 0;
  if (is(e, "notch") && since > 0 && since < e->v.count * period) since = fmod(since, period);
  return since > 0 && since < e->v.duration_s;
}

/* With what is on at mid_s. */
static double mains(const march *m, double t_s) {
  const vs_events *all = &m->setup->timeline.events;
  double angle = 2 * M_PI * 50 * t_s, factor = 1, added = 0;
  for (size_t k = 0; k < all->count; k++)
    if (is(&all->item[k], "phase_jump") && within(&all->item[k], m->mid_s))
      angle += all->item[k].v.phase_rad;
  for (size_t k = 0; k < all->count; k++) {
    const vs_scene_event *e = &all->item[k];
    if (!within(e, m->mid_s)) continue;
    if (is(e, "harmonic")) added += e->v.fraction * sin(e->v.order * angle + e->v.phase_rad);
    if (is(e, "sag") || is(e, "swell")) factor *= e->v.fraction;
    if (is(e, "interruption")) factor = 0;
    if (is(e, "notch")) factor *= 1 - e->v.fraction;
  }
  return sqrt(2) * m->setup->timeline.supply.voltage_v * (sin(angle) + added) * factor;
}

/* The pulse of a cycle, from 1; false: it has none. */
static bool pulse(const march *m, int cycle, double *from_s, double *to_s) {
  const vs_firing_values *f = &m->setup->timeline.firing;
  const vs_events *all = &m->setup->timeline.events;
  *from_s = (cycle - 1 + f->angle.first / (2 * M_PI)) / 50;
  double width = f->pulse_width_s;
  for (size_t k = 0; k < all->count; k++) {
    const vs_scene_event *e = &all->item[k];
    if (is(e, "missing_pulse") && e->v.cycle == cycle) return false;
    if (is(e, "short_pulse") && e->v.cycle == cycle) width = fmin(width, e->v.duration_s);
  }
  *to_s = *from_s + width;
  return true;
}

static bool gate(const march *m, double t_s) {
  const vs_events *all = &m->setup->timeline.events;
  double from, to;
  for (int cycle = 1; cycle < 20; cycle++)
    if (pulse(m, cycle, &from, &to) && t_s > from && t_s < to) return true;
  for (size_t k = 0; k < all->count; k++)
    if (is(&all->item[k], "spurious_pulse") && within(&all->item[k], t_s)) return true;
  return false;
}

/* A x = b of three rows, without pivoting: parts of a positive definite matrix. */
static void solve_3(double a[3][3], double b[3]) {
  for (int c = 0; c < 3; c++)
    for (int r = 0; r < 3; r++) {
      if (r == c) continue;
      double f = a[r][c] / a[c][c];
      for (int j = c; j < 3; j++) a[r][j] -= f * a[c][j];
      b[r] -= f * b[c];
    }
  for (int c = 0; c < 3; c++) b[c] /= a[c][c];
}

/* The other three coordinates' part of M. */
static void rest_of_mass(const march *s, double a[3][3]) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) a[i][j] = s->mass[i + 1][j + 1];
}

static int rates(double t_s, const double y[], double rate[], void *ctx) {
  const march *s = ctx;
  const vs_model *m = &s->setup->model;
  double force[4] = {-y[FLUX] * y[FLUX] / (4 * m->coil.a_hm)}, a[3][3], b[3],
         z = m->coil.gap_rest_m;
  if (!s->gap_rests) z += y[0];
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++) force[i] -= m->stiffness[i][j] * y[j] + m->damping[i][j] * y[4 + j];
  memcpy(rate, y + 4, sizeof(double[4]));
  /* first the other three as if p" were 0, then what p" makes of it */
  rest_of_mass(s, a);
  memcpy(b, force + 1, sizeof b);
  solve_3(a, b);
  rate[4] = 0;
  memcpy(rate + 5, b, sizeof b);
  if (!s->jammed) { /* Schur's complement */
    double c[3] = {s->mass[1][0], s->mass[2][0], s->mass[3][0]}, whole = s->mass[0][0];
    rest_of_mass(s, a);
    solve_3(a, c);
    double push = force[0];
    for (int i = 0; i < 3; i++) {
      push -= s->mass[0][i + 1] * b[i];
      whole -= s->mass[0][i + 1] * c[i];
    }
    rate[4] = push / whole;
    for (int i = 0; i < 3; i++) rate[5 + i] -= c[i] * rate[4];
  }
  double drop = m->actuator.resistance_ohm * y[FLUX] * z / (2 * m->coil.a_hm);
  rate[FLUX] = s->on ? mains(s, t_s) - drop : 0;
  return GSL_SUCCESS;
}

static void try_step(march *s, double h_s, double y[STATES]) {
  double error[STATES];
  memcpy(y, s->y, sizeof s->y);
  gsl_odeiv2_step_apply(s->step, s->t_s, h_s, y, error, NULL, NULL, &s->system);
}

/* What the load is from mid_s on, by the events so far in order of time: Eq. 88. */
static double load_of(const march *s) {
  const vs_events *all = &s->setup->timeline.events;
  vs_load_values load = s->setup->model.load;
  for (double done_s = 0;;) {
    const vs_scene_event *next = NULL;
    for (size_t k = 0; k < all->count; k++) {
      const vs_scene_event *e = &all->item[k];
      if (is(e, "load") && within(e, s->mid_s) && e->v.at_s > done_s &&
          (!next || e->v.at_s < next->v.at_s))
        next = e;
    }
    if (!next) return load.density_kg_m3 * load.volume_m3 * load.fraction;
    if (!isnan(next->v.fraction)) load.fraction = next->v.fraction;
    if (!isnan(next->v.volume_m3)) load.volume_m3 = next->v.volume_m3;
    done_s = next->v.at_s;
  }
}

/* The load is part of m_k in Eq. 55, and nowhere else. q and q' stay. */
static void reload(march *s) {
  const conveyor_values v = conveyor_values_of(&s->setup->model);
  double more = load_of(s) - s->load_kg, c = cos(v.spring_angle_rad), d = sin(v.spring_angle_rad),
         dx = v.trough_com_m[0] - v.base_com_m[0], dy = v.trough_com_m[1] - v.base_com_m[1];
  const double per_kg[4][4] = {{1, -d, c, v.m14 * (dy * d + dx * c)},
                               {-d, 1, 0, -dy},
                               {c, 0, 1, dx},
                               {v.m14 * (dy * d + dx * c), -dy, dx, dx * dx + dy * dy}};
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++) s->mass[i][j] += more * per_kg[i][j];
  s->load_kg += more;
}

static void jam(march *s) {
  double a[3][3], b[3];
  rest_of_mass(s, a);
  for (int i = 0; i < 3; i++) b[i] = s->mass[i + 1][0] * s->y[4];
  solve_3(a, b);
  for (int i = 0; i < 3; i++) s->y[5 + i] += b[i];
  s->y[4] = 0;
  s->jammed = true;
}

static void fire(march *s) {
  s->on = true;
  if (s->fired < COUNT(s->fired_s)) s->fired_s[s->fired++] = s->t_s;
}

/* u or lambda where a step of h would end; which changes its sign within. */
static double zero_in(march *s, double h_s) {
  double low = 0, high = h_s, y[STATES];
  for (int n = 0; n < 80 && high - low > 1e-17; n++) {
    double middle = (low + high) / 2, value;
    if (s->on) {
      try_step(s, middle, y);
      value = y[FLUX];
    } else
      value = -mains(s, s->t_s + middle);
    if (value > 0)
      low = middle;
    else
      high = middle;
  }
  return high;
}

/* One step, up to the edge at most, or to a zero. */
static void advance(march *s, double h_s) {
  double y[STATES];
  bool gated = gate(s, s->mid_s), turns = false;
  if (!s->on && gated && mains(s, s->t_s) > 1e-7) fire(s);
  try_step(s, h_s, y);
  if (s->on)
    turns = y[FLUX] < 0;
  else if (gated)
    turns = mains(s, s->t_s + h_s) > 0;
  if (turns) {
    h_s = zero_in(s, h_s);
    try_step(s, h_s, y);
  }
  memcpy(s->y, y, sizeof s->y);
  s->t_s += h_s;
  if (!turns) return;
  if (!s->on) {
    fire(s);
    return;
  }
  s->on = false;
  s->y[FLUX] = 0;
  if (s->ended < COUNT(s->ended_s)) s->ended_s[s->ended++] = s->t_s;
}

static int by_time(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static void add_edge(march *s, double t_s) {
  if (s->edges < MOST_EDGES) s->edge_s[s->edges++] = t_s;
}

static void find_edges(march *s, double sample_s, size_t rows) {
  const vs_events *all = &s->setup->timeline.events;
  double from, to;
  for (size_t k = 1; k < rows; k++) add_edge(s, (double)k * sample_s);
  for (int cycle = 1; cycle < 20; cycle++)
    if (pulse(s, cycle, &from, &to)) add_edge(s, from), add_edge(s, to);
  for (size_t k = 0; k < all->count; k++) {
    const vs_scene_event *e = &all->item[k];
    if (e->kind->at_cycle) continue;
    for (int n = 0; n < (e->v.count > 1 ? e->v.count : 1); n++) {
      add_edge(s, e->v.at_s + n / 50.0);
      add_edge(s, e->v.at_s + n / 50.0 + e->v.duration_s);
    }
  }
  qsort(s->edge_s, s->edges, sizeof(double), by_time);
}

/* Fills rows of p, u, w, phi, lambda, i. */
static void integrate(march *s, double sample_s, double step_s, size_t rows, double (*row)[6]) {
  size_t k = 0;
  find_edges(s, sample_s, rows);
  s->system = (gsl_odeiv2_system){rates, NULL, STATES, s};
  s->step = gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, STATES);
  memcpy(s->y, s->setup->start.x, sizeof(double[VS_STATES]));
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++) s->mass[i][j] = s->setup->model.mass[i][j];
  s->load_kg = load_of(s);
  for (size_t e = 0; e < s->edges && k + 1 < rows; e++) {
    double end = s->edge_s[e];
    s->mid_s = (s->t_s + end) / 2;
    reload(s);
    while (end - s->t_s > 1e-15) advance(s, fmin(step_s, end - s->t_s));
    s->t_s = fmax(end, s->t_s);
    double next = e + 1 < s->edges ? (end + s->edge_s[e + 1]) / 2 : end;
    for (size_t n = 0; n < s->setup->timeline.events.count; n++) {
      const vs_scene_event *o = &s->setup->timeline.events.item[n];
      if (!s->jammed && is(o, "jam") && within(o, next)) jam(s);
    }
    if (fabs(s->t_s - (double)(k + 1) * sample_s) > 1e-12) continue;
    const vs_model *m = &s->setup->model;
    k++;
    memcpy(row[k], s->y, sizeof(double[4]));
    row[k][4] = s->y[FLUX];
    row[k][5] =
        s->y[FLUX] * (m->coil.gap_rest_m + (s->gap_rests ? 0 : s->y[0])) / (2 * m->coil.a_hm);
  }
  gsl_odeiv2_step_free(s->step);
}

/* ---- the program ---- */

static const int CHANNELS[6] = {VS_CH_P, VS_CH_U, VS_CH_W, VS_CH_PHI, VS_CH_LAMBDA, VS_CH_I};

typedef struct samples {
  double sample_s, row[MOST_ROWS][6];
  double fired_s[32], ended_s[32];
  size_t next, fired, ended;
  double blow_j;
} samples;

static vs_status take(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  samples *s = ctx;
  for (int k = 0; k < 2; k++) {
    if (step->event[k] == VS_EV_FIRES && s->fired < COUNT(s->fired_s))
      s->fired_s[s->fired++] = step->event_s[k];
    if (step->event[k] == VS_EV_EXTINCT && s->ended < COUNT(s->ended_s))
      s->ended_s[s->ended++] = step->event_s[k];
  }
  while (s->next < MOST_ROWS && (double)s->next * s->sample_s <= step->to->t_s) {
    double y[VS_CH_MOST];
    vs_step_at(step, (double)s->next * s->sample_s, y);
    for (int c = 0; c < 6; c++) s->row[s->next][c] = y[CHANNELS[c]];
    s->next++;
  }
  return VS_OK;
}

enum { MOST_KEYS = 24 };
typedef struct scene {
  const char *what, *keys[MOST_KEYS];
  double step_s; /* of the other integration; 0: 20 us */
} scene;

static const char *const EVERY[] = {"run.until=0.1s", "firing.every=1", "run.tolerance=1e-10",
                                    "run.sample=0.5ms"};

static vs_trial *run_it(const scene *sc, const char *tier, samples *s) {
  const char *sets[MOST_KEYS + COUNT(EVERY) + 1] = {NULL};
  size_t n = 0;
  for (size_t k = 0; k < COUNT(EVERY); k++) sets[n++] = EVERY[k];
  for (size_t k = 0; k < MOST_KEYS && sc->keys[k]; k++) sets[n++] = sc->keys[k];
  *s = (samples){.sample_s = 0.5e-3};
  vs_observer observer = {s, take};
  return vs_trial_run("paper", tier, sets, &observer);
}

/* Instants are compared where both have them; a firing or extinction more on one side is said. */
static void compare_instants(const char *what, const double *got, size_t n, const double *expected,
                             size_t m, double tolerance_s) {
  EXPECT(n == m, "%s: %zu firings or extinctions for %zu", what, n, m);
  for (size_t k = 0; k < n && k < m; k++)
    EXPECT(fabs(got[k] - expected[k]) <= tolerance_s, "%s: %.15g s for %.15g", what, got[k],
           expected[k]);
}

/* 1e-8 of each quantity's peak: the program holds 1e-10 there, the other integration about 1e-11.
 * 1e-10 s: what 1e-10 of the peak makes of an instant at which u is 10 V or more. */
static void check(const scene *sc, const char *tier) {
  samples *s = calloc(1, sizeof *s);
  double(*row)[6] = calloc(MOST_ROWS, sizeof *row), peak[6] = {0}, worst = 0;
  vs_trial *t = run_it(sc, tier, s);
  EXPECT(t->status == VS_OK, "%s: %s", sc->what, t->err.text);
  if (t->status && getenv("VS_SAY")) printf("%s: %s\n", sc->what, t->err.text);
  march m = {.setup = &t->scene.setup, .gap_rests = !strcmp(tier, "analytic")};
  size_t rows = t->status ? 0 : s->next;
  if (rows) integrate(&m, s->sample_s, sc->step_s > 0 ? sc->step_s : 20e-6, rows, row);
  for (size_t k = 0; k < rows; k++)
    for (int c = 0; c < 6; c++) peak[c] = fmax(peak[c], fabs(row[k][c]));
  for (size_t k = 0; k < rows; k++)
    for (int c = 0; c < 6; c++)
      worst = fmax(worst, fabs(s->row[k][c] - row[k][c]) / fmax(peak[c], 1e-300));
  if (getenv("VS_SAY"))
    printf("%-9s %-50s worst %.1e books %.1e fired %zu\n", tier, sc->what, worst,
           t->result.watchers.energy.worst, s->fired);
  EXPECT(rows > 100 && worst <= 1e-8, "%s, %s: off by %.2e of the peak", sc->what, tier, worst);
  compare_instants(sc->what, s->fired_s, s->fired, m.fired_s, m.fired, 1e-10);
  compare_instants(sc->what, s->ended_s, s->ended, m.ended_s, m.ended, 1e-10);
  EXPECT(t->result.watchers.energy.worst <= 1e-9, "%s, %s: books %.2e", sc->what, tier,
         t->result.watchers.energy.worst);
  vs_trial_free(t);
  free(row);
  free(s);
}

#define E(name, kind, keys) "events." name "={kind: " kind ", " keys "}"
static const scene SCENES[] = {
    {"nothing, for the other integration's sake", {E("n", "sag", "at: 90ms, level: 100 %")}, 0},
    {"sag in a conduction", {E("s", "sag", "at: 27ms, duration: 23ms, level: 50 %")}, 0},
    {"swell", {E("s", "swell", "at: 26ms, duration: 3ms, level: 130 %")}, 0},
    {"interruption in a conduction", {E("i", "interruption", "at: 27ms, duration: 2ms")}, 0},
    {"interruption through a conduction's end and a firing",
     {E("i", "interruption", "at: 31ms, duration: 18ms")},
     0},
    {"mains that come back forward into a conduction",
     {E("i", "interruption", "at: 28ms, duration: 14ms"), "firing.pulse_width=1ms",
      "supply.voltage=300V"},
     0},
    {"notches", {E("n", "notch", "at: 27ms, duration: 0.7ms, count: 3, depth: 80 %")}, 0},
    {"a notch at the firing", {E("n", "notch", "at: 25ms, duration: 1ms")}, 0},
    {"a notch that hides a pulse",
     {E("n", "notch", "at: 25ms, duration: 1ms"), "firing.pulse_width=0.5ms"},
     0},
    {"a jump in a conduction", {E("j", "phase_jump", "at: 27ms, jump: 60 deg")}, 0},
    {"a jump back, two maxima",
     {E("j", "phase_jump", "at: 33ms, jump: -170 deg"), "supply.voltage=150V"},
     0},
    {"a jump before a firing", {E("j", "phase_jump", "at: 22ms, jump: 100 deg")}, 0},
    {"fifth harmonic", {E("h", "harmonic", "at: 21ms, level: 20 %, phase: 40 deg")}, 0},
    {"third harmonic as large as the mains",
     {E("h", "harmonic", "at: 1ms, level: 100 %, order: 3"), "firing.angle=70deg",
      "actuator.gap=20mm", "firing.pulse_width=12ms"},
     0},
    {"hundredth harmonic",
     {E("h", "harmonic", "at: 1ms, level: 60 %, order: 100, duration: 60ms"),
      "firing.angle=150deg"},
     1e-6},
    {"missing pulse", {E("m", "missing_pulse", "cycle: 2")}, 0},
    {"short pulse, over before forward voltage",
     {E("m", "short_pulse", "cycle: 2, duration: 0.3ms"),
      E("j", "phase_jump", "at: 21ms, jump: -120 deg"), "supply.voltage=150V"},
     0},
    {"spurious pulse",
     {E("s", "spurious_pulse", "at: 44ms, duration: 0.2ms"), "supply.voltage=150V"},
     0},
    {"spurious pulse under reverse voltage", {E("s", "spurious_pulse", "at: 36ms")}, 0},
    {"spurious pulse that waits for forward voltage",
     {E("s", "spurious_pulse", "at: 38.5ms, duration: 2ms"), "supply.voltage=150V"},
     0},
    {"jam in a conduction", {E("j", "jam", "at: 29ms")}, 0},
    {"jam in free flight", {E("j", "jam", "at: 38.3ms"), "machine.m14=derived"}, 0},
    {"more load in a conduction",
     {"load.density=0.7 g/cm3", "load.fraction=0.1", E("l", "load", "at: 29ms, fraction: 0.6")},
     0},
    {"less load in free flight, the derived m14, which depends on it too",
     {"load.density=1 g/cm3", "load.fraction=0.4", "machine.m14=derived", "supply.voltage=300V",
      E("l", "load", "at: 38.3ms, volume: 0 cm3")},
     0},
    {"three changes, one right at a firing, and a jam before the last",
     {"load.density=0.5 g/cm3", E("a", "load", "at: 65.6ms, volume: 100 cm3"),
      E("b", "load", "at: 7ms, fraction: 0.5"), E("c", "load", "at: 90ms, fraction: 1"),
      "firing.angle=108deg", E("h", "jam", "at: 81ms"),
      E("d", "load", "at: 26ms, volume: 300 cm3")},
     0},
    {"all at once",
     {E("a", "sag", "at: 15ms, duration: 50ms, level: 70 %"),
      E("b", "harmonic", "at: 8ms, level: 15 %, order: 7"),
      E("c", "harmonic", "at: 12ms, level: 8 %, order: 11, phase: 33 deg, duration: 61ms"),
      E("d", "phase_jump", "at: 28ms, jump: 25 deg"),
      E("e", "notch", "at: 47ms, duration: 0.4ms, count: 2"), E("f", "missing_pulse", "cycle: 4"),
      E("g", "spurious_pulse", "at: 62ms"), E("h", "jam", "at: 81ms")},
     0},
};

static void each_kind_on_switched(void) {
  for (size_t k = 0; k < COUNT(SCENES); k++) check(&SCENES[k], "switched");
}

static void and_on_analytic(void) {
  for (size_t k = 1; k < COUNT(SCENES); k += 3) check(&SCENES[k], "analytic");
}

/* ---- tier against tier ---- */

#define IDEAL                                                                                      \
  "circuit.deck=halfwave_bare", "circuit.on_voltage=0 V", "circuit.on_resistance=1e-4 ohm",        \
      "circuit.off_resistance=1000 Mohm", "supply.resistance=0", "supply.inductance=0"

/* Three times the circuit tier's run.tolerance, as without events (src/cli/validate/tiers.c);
 * its currents are straight lines between steps, so energies are told ten times less well. */
static void circuit_with_ideal_parts(void) {
  static const char *const KEYS[][4] = {
      {E("s", "sag", "at: 27ms, duration: 23ms, level: 50 %")},
      {E("i", "interruption", "at: 31ms, duration: 18ms")},
      {E("n", "notch", "at: 27ms, duration: 0.7ms, count: 3, depth: 80 %")},
      {E("j", "phase_jump", "at: 27ms, jump: 40 deg")},
      {E("h", "harmonic", "at: 21ms, level: 20 %, phase: 40 deg")},
      {E("m", "missing_pulse", "cycle: 2"), E("s", "spurious_pulse", "at: 48ms")},
      {E("s", "short_pulse", "cycle: 2, duration: 0.2ms"), E("s2", "swell", "at: 41ms")},
      {E("j", "jam", "at: 29ms")},
      {"load.density=0.7 g/cm3", E("l", "load", "at: 29ms, fraction: 0.5")}};
  static const struct {
    int measure;
    double tolerance;
  } MEASURES[] = {{VS_M_I_PEAK, 3e-5},
                  {VS_M_FORCE_PEAK, 3e-5},
                  {VS_M_GAP_MIN, 3e-5},
                  {VS_M_GAP_MAX, 3e-5},
                  {VS_M_OF_COORDINATE(P, VS_PEAK), 3e-5},
                  {VS_M_OF_COORDINATE(U, VS_PEAK), 3e-5}};
  for (size_t k = 0; k < COUNT(KEYS); k++) {
    const char *ideal[] = {"run.until=76ms",
                           "firing.every=1",
                           "run.tolerance=1e-5",
                           IDEAL,
                           KEYS[k][0],
                           KEYS[k][1],
                           NULL};
    const char *alone[] = {"run.until=76ms", "firing.every=1", KEYS[k][0], KEYS[k][1], NULL};
    vs_trial *c = vs_trial_run("paper", "circuit", ideal, NULL);
    vs_trial *s = vs_trial_run("paper", "switched", alone, NULL);
    EXPECT(!c->status && !s->status, "%s: %s%s", KEYS[k][0], c->err.text, s->err.text);
    for (size_t n = 0; n < COUNT(MEASURES); n++) {
      double of_circuit = c->result.values[MEASURES[n].measure].value;
      double of_switched = s->result.values[MEASURES[n].measure].value;
      EXPECT(fabs(of_circuit - of_switched) <= MEASURES[n].tolerance * fabs(of_switched),
             "%s, measure %d: circuit %.9g, switched %.9g", KEYS[k][0], MEASURES[n].measure,
             of_circuit, of_switched);
    }
    double in = s->result.watchers.energy.joule[VS_E_SOURCE],
           got = c->result.watchers.energy.joule[VS_E_SOURCE];
    EXPECT(fabs(got - in) <= 3e-4 * in, "%s: circuit draws %.9g J, switched %.9g J", KEYS[k][0],
           got, in);
    vs_trial_free(c);
    vs_trial_free(s);
  }
}

/* A sag to half leaves half the current's peak and a quarter of the force, to what the back-EMF
 * takes; before, the peak was the undisturbed one to the bit. */
static void a_sag_is_no_footnote(void) {
  const char *plain[] = {"run.until=30ms", NULL};
  const char *sag[] = {"run.until=30ms", E("s", "sag", "at: 1ms, level: 50 %"), NULL};
  vs_trial *whole = vs_trial_run("paper", "switched", plain, NULL);
  vs_trial *half = vs_trial_run("paper", "switched", sag, NULL);
  CU_ASSERT_EQUAL_FATAL(whole->status, VS_OK);
  CU_ASSERT_EQUAL_FATAL(half->status, VS_OK);
  CLOSE(half->result.values[VS_M_I_PEAK].value, whole->result.values[VS_M_I_PEAK].value / 2, 0.06);
  CLOSE(half->result.values[VS_M_GAP_MIN].value, whole->result.values[VS_M_GAP_MIN].value / 4,
        0.02);
  CLOSE(half->result.watchers.energy.joule[VS_E_SOURCE],
        half->result.watchers.energy.joule[VS_E_PORT], 1e-9);
  vs_trial_free(whole);
  vs_trial_free(half);
}

/* A third harmonic as large as the mains, 4 sin x cos^2 x, touches zero from below at 270 degrees
 * with the gate on: that is no forward voltage. */
static void a_touch_is_no_firing(void) {
  static const char *const LEVEL[] = {"99 %", "100 %"};
  for (size_t k = 0; k < COUNT(LEVEL); k++) {
    char keys[128];
    snprintf(keys, sizeof keys, "events.h={kind: harmonic, at: 1ms, level: %s, order: 3}",
             LEVEL[k]);
    const char *sets[] = {"firing.first_cycle=2", keys, "run.until=20ms",
                          E("s", "spurious_pulse", "at: 14ms, duration: 2ms"), NULL};
    vs_trial *t = vs_trial_run("paper", "switched", sets, NULL);
    EXPECT(t->status == VS_OK, "%s", t->err.text);
    EXPECT(!t->result.values[VS_M_T_FIRE].known, "%s: it fires", LEVEL[k]);
    vs_trial_free(t);
  }
}

/* Mains that stay away: lambda dies away, and what is left of it conducts no more when they come
 * back. With the gate off nothing fires then. */
static void mains_that_stay_away(void) {
  const char *sets[] = {"run.until=1.5s", "firing.pulse_width=1ms",
                        E("i", "interruption", "at: 8ms, duration: 1s"), NULL};
  vs_trial *t = vs_trial_run("paper", "switched", sets, NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  CU_ASSERT(t->result.values[VS_M_T_EXTINCTION].known);
  CU_ASSERT(t->result.values[VS_M_T_EXTINCTION].value < 1.008);
  CU_ASSERT(isnan(t->result.watchers.measures->refired_s));
  vs_trial_free(t);
}

/* After the blow p rests: no velocity, no acceleration in any channel, on both tiers; the machine's
 * loss by the blow is in the books. */
static vs_status look_at_p(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  double *largest = ctx, y[VS_CH_MOST];
  if (step->from->t_s < 29e-3 || step->to->t_s == step->from->t_s) return VS_OK;
  vs_step_at(step, (step->from->t_s + step->to->t_s) / 2, y);
  *largest = fmax(*largest, fmax(fabs(y[VS_CH_VP]), fabs(y[VS_CH_AP])));
  return VS_OK;
}
static void a_jam_holds_p(void) {
  for (int tier = 0; tier < 2; tier++) {
    const char *sets[] = {"run.until=60ms", "firing.every=1", E("j", "jam", "at: 29ms"), NULL};
    double largest = 0;
    vs_observer observer = {&largest, look_at_p};
    vs_trial *t = vs_trial_run("paper", tier ? "circuit" : "switched", sets, &observer);
    EXPECT(t->status == VS_OK, "%s", t->err.text);
    /* p's rounding over a step's length, which is 5e-11 s where a thyristor goes out; half a m/s
     * and 180 m/s2 before */
    EXPECT(largest <= 1e-8, "tier %d: p moves by %g", tier, largest);
    CU_ASSERT(t->result.watchers.energy.joule[VS_E_STOP] > 1e-3);
    vs_trial_free(t);
  }
}

static const vs_test TESTS[] = {
    {"each kind on tier switched", each_kind_on_switched},
    {"and on tier analytic", and_on_analytic},
    {"the circuit tier with ideal parts", circuit_with_ideal_parts},
    {"a sag acts", a_sag_is_no_footnote},
    {"a touch of zero does not fire", a_touch_is_no_firing},
    {"mains that stay away", mains_that_stay_away},
    {"a jam holds p", a_jam_holds_p},
};
VS_SUITE_MAIN("events on the ideal tiers", TESTS)
