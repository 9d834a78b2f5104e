/* SPDX-License-Identifier: GPL-3.0-or-later
 * Events: generators against their standards and against closed forms, what is done to the mains,
 * at the gate and to elements, and bad input. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "engine/events.h"
#include "engine/gate.h"
#include "schedule.h"

/* ---- the surge generator ---- */

enum { MOST = 120000 };

/* A curve, point by point, and what is read off it. */
typedef struct curve {
  const char *name;
  int channel;
  size_t points;
  double t_s[MOST], y[MOST];
} curve;

static vs_status record(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  curve *c = ctx;
  if (!c->points) c->channel = vs_channel_find(step->frame, c->name);
  CU_ASSERT_FATAL(c->channel >= 0 && c->points < MOST);
  c->t_s[c->points] = step->to->t_s;
  c->y[c->points++] = vs_step_channel(step, step->to->t_s, c->channel);
  return VS_OK;
}

static size_t peak_of(const curve *c, double sign) {
  size_t peak = 0;
  for (size_t k = 0; k < c->points; k++)
    if (sign * c->y[k] > sign * c->y[peak]) peak = k;
  return peak;
}

/* When the curve passes part of its peak, before it or behind it. */
static double passes(const curve *c, double part, bool behind) {
  size_t peak = peak_of(c, 1), k = peak;
  while (k > 0 && k + 1 < c->points && c->y[k] > part * c->y[peak]) k += behind ? 1 : (size_t)-1;
  size_t other = behind ? k - 1 : k + 1;
  double share = (part * c->y[peak] - c->y[k]) / (c->y[other] - c->y[k]);
  return c->t_s[k] + share * (c->t_s[other] - c->t_s[k]);
}

/* The generator alone at the line, its coupling capacitor shorted; what: what lies across it. */
static vs_trial *surge_into(const char *what, const char *level, curve *c) {
  char deck[600], set[80];
  snprintf(deck, sizeof deck,
           "*$ line a\n*$ probe v_a = v(a) V\n*$ probe i_a = i(Vs) A\n*$ loss load = v(a)*i(Vs)\n"
           "Vs a s 0\n%s\nRb b 0 1\nXeva b 0 eva\n",
           what);
  write_file("d.cir", deck);
  write_file("s.yaml",
             "circuit: {deck: d.cir}\nrun: {until: 320 us, max_step: 20 ns, sample: 1 us}\n"
             "events:\n  s: {kind: surge, at: 1 us}\n"
             "  c: {kind: short, at: 0, element: Cvs_o0}\n");
  snprintf(set, sizeof set, "events.s.level=%s", level);
  const vs_observer also = {c, record};
  c->points = 0;
  vs_trial *t = vs_trial_run("s.yaml", "circuit", (const char *const[]){set, NULL}, &also);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  return t;
}

/* IEC 61000-4-5: 1.2/50 us open, 8/20 us shorted, 2 ohm. The network was solved for these, so that
 * it is held to 0.5 % and not to the standard's 20 and 30 %. The virtual origin is that of the line
 * through 30 and 90 % (10 and 90 % for the current). */
static void surge_meets_its_standard(void) {
  curve *c = vs_alloc(1, sizeof *c);
  c->name = "v_a";
  vs_trial_free(surge_into("R1 s 0 1meg", "2 kV", c));
  double t30 = passes(c, 0.3, false), t90 = passes(c, 0.9, false), open_v = c->y[peak_of(c, 1)];
  CLOSE(open_v, 2000, 5e-3);
  CLOSE(1.67 * (t90 - t30), 1.2e-6, 5e-3);
  CLOSE(passes(c, 0.5, true) - (t30 - (t90 - t30) / 2), 50e-6, 5e-3);
  c->name = "i_a";
  vs_trial_free(surge_into("R1 s 0 1m", "2 kV", c));
  double t10 = passes(c, 0.1, false), short_a = c->y[peak_of(c, 1)];
  t90 = passes(c, 0.9, false);
  CLOSE(open_v / short_a, 2, 5e-3);
  CLOSE(1.25 * (t90 - t10), 8e-6, 5e-3);
  CLOSE(passes(c, 0.5, true) - (t10 - (t90 - t10) / 8), 20e-6, 5e-3);
  CLOSE(-c->y[peak_of(c, -1)] / short_a, 0.336, 5e-3);
  free(c);
}

/* Into a varistor i = 1 mA (v/V1)^30: peak current, peak voltage, energy, I2t of an independent
 * solution; half a per cent is what is asked. */
static void surge_into_a_varistor(void) {
  if (is_for_memory_alone()) return;
  static const struct {
    double v1, a, v, j, i2t;
    const char *level;
  } ROWS[] = {{750, 3.459, 984.07, 0.01519, 0, "1 kV"},
              {750, 389.770, 1151.918, 6.3448, 1.6929, "2 kV"},
              {750, 1361.075, 1200.947, 25.0901, 0, "4 kV"},
              {1000, 208.556, 1504.206, 3.8831, 0, "2 kV"}};
  curve *c = vs_alloc(1, sizeof *c);
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char varistor[100];
    snprintf(varistor, sizeof varistor, "B1 s 0 I = 1m*pwr(v(s)/%g,30)", ROWS[k].v1);
    c->name = "v_a";
    vs_trial_free(surge_into(varistor, ROWS[k].level, c));
    CLOSE(c->y[peak_of(c, 1)], ROWS[k].v, 5e-3);
    c->name = "i_a";
    vs_trial *t = surge_into(varistor, ROWS[k].level, c);
    double i2t = 0;
    for (size_t n = 1; n < c->points; n++)
      i2t += (c->t_s[n] - c->t_s[n - 1]) * (pow(c->y[n], 2) + pow(c->y[n - 1], 2)) / 2;
    CLOSE(c->y[peak_of(c, 1)], ROWS[k].a, 5e-3);
    CLOSE(t->result.watchers.energy.loss_j[0], ROWS[k].j, 5e-3);
    if (ROWS[k].i2t > 0) CLOSE(i2t, ROWS[k].i2t, 5e-3);
    vs_trial_free(t);
  }
  free(c);
}

/* On the paper's converter: four angles of the mains, both polarities, three levels (a few of them
 * without --long, the one that leaves most among them). Each run comes to its end on the scene as
 * it is, and its energy books close to 1 % of the force's work, which is a hundredth of what the
 * surge and the mains bring. Measured: 0.28 %; 1.4 % without short steps while the line rings. */
static void surges_on_the_paper(void) {
  static const char *const LEVELS[] = {"1 kV", "2 kV", "4 kV"};
  double worst = 0;
  bool all = getenv("VS_LONG");
  for (int n = all ? 0 : 5; n < 24; n += all ? 1 : 7) {
    char scene[300];
    snprintf(
        scene, sizeof scene,
        "circuit: {deck: halfwave_paper}\nrun: {until: 25 ms}\nevents: {s: {kind: surge, cycle: "
        "1, angle: %d deg, polarity: '%s', level: %s}}\n",
        n % 4 * 90, n / 4 % 2 ? "-" : "+", LEVELS[n / 8]);
    write_file("s.yaml", scene);
    vs_trial *t = vs_trial_run("s.yaml", "circuit", NULL, NULL);
    EXPECT(t->status == VS_OK, "%s: %s", scene, t->err.text);
    worst = fmax(worst, t->result.watchers.energy.worst);
    vs_trial_free(t);
  }
  CU_ASSERT(worst > 0 && worst < 0.01);
}

/* The voltage across 100 ohm 30 us behind the first of two surges, 10 us apart; both levels in kV.
 */
static double of_two_surges(double first_kv, double second_kv) {
  char scene[300];
  curve *c = vs_alloc(1, sizeof *c);
  c->name = "v_a";
  write_file("d.cir", "*$ line a\n*$ probe v_a = v(a) V\nRa a 0 100\nRb b 0 1\nXeva b 0 eva\n");
  snprintf(
      scene, sizeof scene,
      "circuit: {deck: d.cir}\nrun: {until: 31 us, max_step: 0.2 us}\nevents:\n"
      "  a: {kind: surge, at: 1 us, level: %g kV}\n  b: {kind: surge, at: 11 us, level: %g kV}\n",
      first_kv, second_kv);
  write_file("s.yaml", scene);
  const vs_observer also = {c, record};
  vs_trial *t = vs_trial_run("s.yaml", "circuit", NULL, &also);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  double last = c->points ? c->y[c->points - 1] : NAN;
  vs_trial_free(t);
  free(c);
  return last;
}

/* Closer than they last: each is a generator of its own, and into what is linear their voltages add
 * up, and not to one of them. The later one counts for more. A solver's tolerance. */
static void surges_add_up(void) {
  double both = of_two_surges(1, 1), second = of_two_surges(1, 2) - both;
  double first = of_two_surges(2, 1) - both;
  CU_ASSERT(first > 50 && second > first);
  CLOSE(first + second, both, 1e-3);
}

/* Not fired, the machine takes in next to nothing of what a surge and the snubbers draw: what is
 * left over is told relative to 1 % of that, and so says, as where it is fired, that the books
 * close: 10 run.tolerance of all that is drawn. The work is some 1e-8 of it. */
static void books_of_an_idle_machine(void) {
  vs_trial *t = vs_trial_run(
      "paper", "circuit",
      (const char *[]){"firing.first_cycle=100", "run.until=25ms",
                       "events.s={kind: surge, cycle: 1, angle: 90 deg, level: 1 kV}", NULL},
      NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  const vs_energy *e = &t->result.watchers.energy;
  double drawn = fabs(e->joule[VS_E_SOURCE]), scale = 0.01 * drawn;
  CU_ASSERT(fabs(e->joule[VS_E_WORK]) < 1e-6 * drawn);
  CLOSE(e->residual[VS_B_CIRCUIT], e->left_j[VS_B_CIRCUIT] / scale, 1e-12);
  EXPECT(e->worst > 0 && e->worst < 0.1, "%g", e->worst);
  vs_trial_free(t);
}

/* ---- waves that come as a formula ---- */

static double first_at(const vs_scene_event *e, double (*wave)(const vs_scene_event *, double),
                       double level, double from_s, double step_s) {
  double t = from_s;
  for (; fabs(wave(e, t)) < level; t += step_s) {
  }
  return t;
}

static void peak_of_wave(const vs_scene_event *e, double (*wave)(const vs_scene_event *, double),
                         double step_s, double *at_s, double *peak) {
  *at_s = *peak = 0;
  for (double t = 0; t < 1000 * step_s; t += step_s)
    if (fabs(wave(e, t)) > *peak) *peak = fabs(wave(e, t)), *at_s = t;
}

/* Ring wave: peak 1.0001 of the level, rise time (10 to 90 %) 0.4999 us, 100 kHz. EFT: 5.12 ns and
 * 49.4 ns at half. Figures of the formulas' own; the steps of the search are 0.1 %. */
static void ring_wave_and_eft(void) {
  vs_scene_event e = {.v = {.level_v = 1000, .frequency_hz = 5000, .duration_s = 15e-3}};
  double at, peak;
  const vs_event_kind *ring = vs_events_find("ring_wave"), *eft = vs_events_find("eft");
  peak_of_wave(&e, ring->source, 1e-9, &at, &peak);
  CLOSE(peak, 1000.1, 1e-3);
  CLOSE(first_at(&e, ring->source, 0.9 * peak, 0, 1e-10) -
            first_at(&e, ring->source, 0.1 * peak, 0, 1e-10),
        0.4999e-6, 2e-3);
  CU_ASSERT(ring->source(&e, 5e-6) < 0 && ring->source(&e, 10e-6) > 0);
  peak_of_wave(&e, eft->source, 0.1e-9, &at, &peak);
  CLOSE(peak, 1000, 0.03); /* the standard's equation has its scale for other reasons */
  double up = first_at(&e, eft->source, 0.5 * peak, 0, 1e-12), down = at;
  while (eft->source(&e, down) > 0.5 * peak) down += 1e-12;
  CLOSE(first_at(&e, eft->source, 0.9 * peak, 0, 1e-12) -
            first_at(&e, eft->source, 0.1 * peak, 0, 1e-12),
        5.12e-9, 3e-3);
  CLOSE(down - up, 49.4e-9, 3e-3);
  CLOSE(eft->source(&e, 3 * 200e-6 + at), peak, 1e-6); /* 75 pulses, 200 us apart */
  CU_ASSERT_EQUAL(eft->source(&e, 15e-3 + at), 0);
  CLOSE(eft->edge(&e, 0.1e-3), 0.2e-3, 1e-12);
  CLOSE(eft->edge(&e, 0.2e-3), 0.4e-3, 1e-12);
  CU_ASSERT_EQUAL(eft->edge(&e, 14.85e-3), INFINITY);
}

/* ---- the mains and the gate ---- */

static void on_the_mains(void) {
  vs_timeline t = schedule("events:\n"
                           " sag: {kind: sag, at: 20 ms, duration: 20 ms, level: 40 %}\n"
                           " up: {kind: swell, at: 60 ms, duration: 20 ms, level: 130 %}\n"
                           " out: {kind: interruption, cycle: 6, angle: 90 deg}\n"
                           " cut: {kind: notch, cycle: 8, angle: 90 deg, duration: 1 ms, depth: "
                           "50 %, count: 3}\n"
                           " jump: {kind: phase_jump, at: 300 ms, jump: 30 deg}\n"
                           " five: {kind: harmonic, at: 240 ms, duration: 20 ms, order: 5, level: "
                           "10 %, phase: 90 deg}\n");
  static const struct {
    double t_ms, value; /* of the peak */
  } ROWS[] = {{5, 1},
              {25, 0.4},
              {45, 1},
              {65, 1.3},
              {85, 1},
              {104, 0.95105652},
              {106, 0},
              {124, 0},
              {126, 0.95105652},
              {145, 1},
              {145.5, 0.5 * 0.98768834},
              {147, 0.80901699},
              {165.5, 0.5 * 0.98768834},
              {185.5, 0.5 * 0.98768834},
              {205.5, 0.98768834},
              {245, 1 + 0.1 * 0},
              {250, -0.1},
              {265, 1},
              {305, 0.8660254}};
  for (size_t k = 0; k < COUNT(ROWS); k++)
    CLOSE_OF(vs_timeline_voltage(&t, 1e-3 * ROWS[k].t_ms), ROWS[k].value * t.peak_v, t.peak_v,
             1e-8);
  static const double EDGES_MS[] = {20,  40,  60,  80,  105, 125, 145, 146,
                                    165, 166, 185, 186, 240, 260, 300};
  double at = 0;
  for (size_t k = 0; k < COUNT(EDGES_MS); k++) {
    at = vs_events_edge(&t.events, at);
    CLOSE(at, 1e-3 * EDGES_MS[k], 1e-9);
  }
  CU_ASSERT_EQUAL(vs_events_edge(&t.events, at), INFINITY);
}

/* Several at once, at the same instant, in whatever order: first the angle, then the harmonics of
 * that angle, then the factors. At 3 ms the sine stands at 54 degrees; jumped, at 84. To rounding.
 */
static void several_on_the_mains(void) {
#define JUMP "kind: phase_jump, at: 1 ms, jump: 30 deg"
#define FIFTH "kind: harmonic, at: 1 ms, order: 5, level: 20 %"
#define SAG "kind: sag, at: 1 ms, level: 40 %"
#define OUT "kind: interruption, at: 1 ms"
#define NOTCH "kind: notch, at: 1 ms, duration: 5 ms, depth: 75 %"
  const double jumped = sin(84 * M_PI / 180), fifth = 0.2 * sin(5 * 84 * M_PI / 180);
  const struct {
    const char *kind[4];
    double value;
  } ROWS[] = {{{SAG, JUMP}, 0.4 * jumped},
              {{OUT, JUMP}, 0},
              {{OUT, FIFTH}, 0},
              {{JUMP, FIFTH}, jumped + fifth},
              {{SAG, FIFTH, JUMP}, 0.4 * (jumped + fifth)},
              {{NOTCH, JUMP}, 0.25 * jumped},
              {{JUMP, NOTCH, SAG, FIFTH}, 0.25 * 0.4 * (jumped + fifth)}};
#undef JUMP
#undef FIFTH
#undef SAG
#undef OUT
#undef NOTCH
  for (size_t k = 0; k < COUNT(ROWS); k++)
    for (int turn = 0; turn < 8; turn++) { /* each of them first once, either way round */
      vs_text scene = {0};
      vs_text_add(&scene, "events:\n");
      for (int n = 0; n < 4; n++) {
        int at = (turn < 4 ? n + turn : 7 - n - turn % 4) % 4;
        if (ROWS[k].kind[at]) vs_text_add(&scene, " e%d: {%s}\n", at, ROWS[k].kind[at]);
      }
      vs_timeline t = schedule(scene.text);
      CLOSE_OF(vs_timeline_voltage(&t, 3e-3), ROWS[k].value * t.peak_v, t.peak_v, 1e-14);
      vs_text_free(&scene);
    }
}

/* Firing at 90 degrees: pulses at 5, 25, 45 ms, ... of 8 ms. */
static void at_the_gate(void) {
  vs_timeline t = schedule(
      "firing: {angle: 90 deg, every: 1, burst_frequency: 10 kHz, burst_duty: 50 %}\nevents:\n"
      " a: {kind: missing_pulse, cycle: 2}\n"
      " b: {kind: short_pulse, cycle: 3, duration: 1 ms}\n"
      " c: {kind: weak_pulse, cycle: 4, level: 25 %}\n"
      " d: {kind: spurious_pulse, at: 97 ms, duration: 0.5 ms}\n");
  static const struct {
    double t_ms, volt;
  } ROWS[] = {{4, 0},    {6, 1},     {12.9, 1}, {13.1, 0}, {26, 0},   {45.5, 1},
              {46.5, 0}, {66, 0.25}, {73.1, 0}, {97.2, 1}, {97.6, 0}, {86, 1}};
  for (size_t k = 0; k < COUNT(ROWS); k++)
    CLOSE_OF(vs_gate_voltage(&t, 0, 1e-3 * ROWS[k].t_ms), ROWS[k].volt, 1, 0);
  static const double EDGES_MS[] = {5, 13, 45, 46, 65, 73, 85, 93, 105, 113};
  double at = 0;
  for (size_t k = 0; k < COUNT(EDGES_MS); k++) {
    do at = vs_gate_edge(&t, 0, at);
    while (fabs(at - 25e-3) < 1e-9); /* that of the missing pulse is a step's end, no more */
    CLOSE(at, 1e-3 * EDGES_MS[k], 1e-9);
  }
  /* its sub-pulses, of 10 kHz and a half: the spurious pulse has five */
  int on = 0;
  for (int k = 0; k < 1000; k++) on += vs_gate_burst(&t, 0, 96.5e-3 + 2e-6 * (k + 0.5));
  CU_ASSERT_EQUAL(on, 125);
}

/* Of two gates one: pulses at 5, 25 ms and, of the other, at 15, 35 ms. */
static void at_one_gate(void) {
  vs_timeline t = schedule(
      "firing: {angle: 90 deg, every: 1, burst_frequency: 10 kHz, burst_duty: 50 %}\nevents:\n"
      " a: {kind: missing_pulse, cycle: 1, gate: gate+180deg}\n"
      " b: {kind: weak_pulse, cycle: 1, level: 50 %, gate: gate}\n"
      " c: {kind: spurious_pulse, at: 24 ms, duration: 0.5 ms, gate: gate+180 deg}\n");
  static const struct {
    double t_ms, volt[2];
  } ROWS[] = {{6, {0.5, 0}}, {16, {0, 0}}, {24.01, {0, 1}}, {26, {1, 0}}, {36.01, {0, 1}}};
  for (size_t k = 0; k < COUNT(ROWS); k++)
    for (int n = 0; n < 2; n++)
      CLOSE_OF(vs_gate_voltage(&t, n * M_PI, 1e-3 * ROWS[k].t_ms), ROWS[k].volt[n], 1, 0);
  CU_ASSERT(vs_gate_burst(&t, M_PI, 24.01e-3) && !vs_gate_burst(&t, 0, 24.01e-3));
  /* in a circuit: without its second pulse T2 does not fire */
  write_file("s.yaml",
             "circuit: {deck: fullwave_antiparallel}\nfiring: {every: 1, angle: 120 deg}\n"
             "run: {until: 45 ms}\nevents: {e: {kind: missing_pulse, cycle: 2, gate: "
             "gate+180deg}}\n");
  RUN_GOOD("run s.yaml --quiet -o o");
  char *csv = read_file("o/events.csv");
  EXPECT(strstr(csv, "\n0.0066") && strstr(csv, "\n0.0166") && strstr(csv, "\n0.0266") &&
             !strstr(csv, "\n0.036"),
         "%s", csv);
  free(csv);
}

/* ---- elements ---- */

static double peak_of_probe(const char *events, const char *probe, vs_status wanted) {
  char scene[400];
  curve *c = vs_alloc(1, sizeof *c);
  c->name = probe;
  snprintf(scene, sizeof scene,
           "run: {until: 25 ms}\ncircuit: {deck: halfwave_snubbed}\nevents: {%s}\n", events);
  write_file("s.yaml", scene);
  const vs_observer also = {c, record};
  vs_trial *t = vs_trial_run("s.yaml", "circuit", NULL, &also);
  EXPECT(t->status == wanted, "%s: %s", events, t->err.text);
  double value = c->y[peak_of(c, 1)];
  vs_trial_free(t);
  free(c);
  return value;
}

/* The deck takes R1's current for v(a,c1p)/{r1}, which it is not once R1 is shorted or opened. The
 * run says so, and holds nothing of that against limits; another element's event says nothing. The
 * energy books close, whatever losses and stores reckon with. */
static void what_is_reckoned_otherwise(void) {
  static const struct {
    const char *event, *says;
  } ROWS[] = {{"short, element: R1", "those of fuse_2, r1, c1; "},
              {"open, element: R1", "those of fuse_2, r1, c1; "},
              {"short, element: C1", NULL},
              {"open, element: C1", NULL},
              {"open, element: Xv2", NULL},
              {"open, element: Rsource", NULL}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char scene[300];
    snprintf(scene, sizeof scene,
             "circuit: {deck: halfwave_paper}\nrun: {until: 7 ms, tier: circuit}\n"
             "events: {e: {kind: %s, at: 1 ms}}\n",
             ROWS[k].event);
    write_file("s.yaml", scene);
    ran r = run("run s.yaml --json");
    const char *line = strstr(r.out, "\"measure\": \"let_through\"");
    line = line ? strstr(line, "\"word\": ") : "";
    bool undecided = !strncmp(line, "\"word\": \"undecided\"", 19);
    EXPECT(ROWS[k].says
               ? strstr(r.err, "s.yaml:3:10: events.e: once ") && strstr(r.err, ROWS[k].says)
               : !strstr(r.err, "once "),
           "%s: %s", ROWS[k].event, r.err);
    EXPECT(undecided == (k < 2) && (!undecided || r.status == 3), "%s: %d %.30s", ROWS[k].event,
           r.status, line);
    EXPECT(!strstr(r.out, "\"weakest\": \"fuse_2.let_through\""), "%s", ROWS[k].event);
    EXPECT(strstr(r.out, "\"audit\": \"the books close\""), "%s", r.out);
    free_ran(&r);
  }
  write_file("d.cir", "*$ port mains = Vm\n*$ param r1 = 100 ohm 1..1e6 \"a resistor\"\n"
                      "*$ loss first = v(s,a)*(v(s,a)/{r1}+i(Vm))\nVm s 0 external\nR1 s a {r1}\n"
                      "Xeva a 0 eva\n");
  write_file("s.yaml", "circuit: {deck: d.cir}\nrun: {until: 7 ms, tier: circuit}\n"
                       "events: {e: {kind: short, element: R1, at: 1 ms}}\n");
  ran r = run("check s.yaml");
  EXPECT(strstr(r.err, "are not right any more: those of first;"), "%s", r.err);
  free_ran(&r);
  /* several varistors have one parameter; and a value may be more than it */
  write_file("s.yaml", "circuit: {deck: halfwave_snubbed}\nrun: {until: 7 ms, tier: circuit}\n"
                       "events: {e: {kind: open, element: Xv1, at: 1 ms}}\n");
  r = run("run s.yaml --quiet");
  EXPECT(!strstr(r.err, "varistor_2") && !strstr(r.err, "varistor_3"), "%s", r.err);
  free_ran(&r);
}

/* A shorted coil lets the mains through their own impedance alone: the current against the solution
 * of R-L (0.52 ohm, 0.5 mH, 1 V of the thyristor) from 9 ms on, to 1 %. One that is opened before
 * the thyristor fires has no current, and a snubber that is gone leaves none in C1. */
static void opened_and_shorted(void) {
  double r = 0.521, l = 0.5e-3, w = 100 * M_PI, z = hypot(r, w * l), i = 0.83, peak = 0;
  for (double t = 9e-3, h = 1e-7; t < 15e-3; t += h) {
    i += h * (440 * M_SQRT2 * sin(w * (t + h / 2)) - 1 - r * i) / l;
    peak = fmax(peak, i);
  }
  CU_ASSERT(peak < 440 * M_SQRT2 / z);
  CLOSE(peak_of_probe("e: {kind: coil_short, at: 9 ms}", "i_thyristor", VS_OK), peak, 0.01);
  CLOSE(peak_of_probe("e: {kind: short, at: 9 ms, element: Xeva}", "i_thyristor", VS_OK), peak,
        0.01);
  CU_ASSERT(peak_of_probe("e: {kind: open, at: 1 ms, element: xeva}", "i", VS_OK) <
            0.03); /* 28 mA before */
  /* a second node whose name is part of the first one's: still two nodes */
  write_file("n.cir", "*$ port mains = Vm\n.subckt load p q\nR1 p q 1k\n.ends\nVm a1 0 external\n"
                      "Xl a1 a load\nXeva a 0 eva\n");
  write_file("s.yaml",
             "run: {until: 2 ms}\ncircuit: {deck: n.cir}\nevents: {e: {kind: open, at: 1 ms, "
             "element: Xl}}\n");
  vs_trial *t = vs_trial_run("s.yaml", "circuit", NULL, NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  vs_trial_free(t);
  double whole = peak_of_probe("", "v_c1", VS_OK);
  double without =
      peak_of_probe("e: {kind: open, at: 0, element: R1, level: 100 kV}", "v_c1", VS_OK);
  CU_ASSERT(whole > 600 && without < 1);
}

/* A capacitor at 100 V is shorted by a conductance G that grows by the factor of e every tau = 1 us
 * over ln 1e12. It loses i = G v, so that v = 100 V exp(-tau G/C), and i has its peak of
 * 100 V C/(e tau) where G = C/tau. The conductance takes all that the capacitor had, C (100 V)^2/2.
 * Nodes have names with which no formula can be written. Within 1 %, as steps are a 50th of 1 us,
 * at each tolerance. */
static void a_shorted_capacitor(void) {
  static const char *const TOLERANCES[] = {"1e-3", "1e-4", "1e-5"};
  static const double FARAD[] = {1e-10, 1e-8, 1e-6};
  for (size_t k = 0; k < COUNT(FARAD) * COUNT(TOLERANCES); k++) {
    const char *tolerance = TOLERANCES[k % COUNT(TOLERANCES)];
    double farad = FARAD[k / COUNT(TOLERANCES)], tau_s = 1e-6 / log(1e12);
    char text[512];
    snprintf(text, sizeof text,
             "*$ port mains = Vm\n*$ probe i_c = i(Vc) A \"of the capacitor\"\n"
             "*$ loss r = v(n-1,p+)^2/1e9\n*$ store c = %g*v(p+)^2/2\n"
             "Vm n-1 0 external\nR1 n-1 p+ 1g\nR9 p+ 0 1g\nVc p+ q 0\nC1 q 0 %g ic=100\nXeva n-1 0 "
             "eva\n",
             farad, farad);
    write_file("c.cir", text);
    snprintf(text, sizeof text,
             "circuit: {deck: c.cir}\nsupply: {voltage: 1 V}\nrun: {until: 100 us, tolerance: %s}\n"
             "events: {e: {kind: short, at: 50 us, element: R9}}\n",
             tolerance);
    write_file("s.yaml", text);
    curve *c = vs_alloc(1, sizeof *c);
    c->name = "i_c";
    const vs_observer also = {c, record};
    vs_trial *t = vs_trial_run("s.yaml", "circuit", NULL, &also);
    EXPECT(t->status == VS_OK, "%s", t->err.text);
    CLOSE(c->y[peak_of(c, -1)], -100 * farad / (M_E * tau_s), 0.01);
    vs_trial_free(t);
    free(c);
  }
}

/* With part f of the turns shorted their loop carries -(dlambda/dt)/R_c, and the terminals what is
 * left of the ampere turns: i1 = (i + f (dlambda/dt)/R_c)/(1-f). Beside the coil only its snubber
 * draws current, 20 mA at most here. */
static vs_status watch_turns(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  double t = step->to->t_s, *worst = ctx, f = 0.3, r = 92;
  if (t < 9e-3 || t > 12e-3) return VS_OK;
  double i = vs_step_channel(step, t, VS_CH_I);
  double rate = vs_step_channel(step, t, VS_CH_V_EVA) - r * i;
  double anode = vs_step_channel(step, t, vs_channel_find(step->frame, "i_thyristor"));
  *worst = fmax(*worst, fabs(anode - (i + f * rate / r) / (1 - f)));
  return VS_OK;
}

static void some_turns_are_shorted(void) {
  double worst = 0;
  const vs_observer also = {&worst, watch_turns};
  write_file("s.yaml", "run: {until: 25 ms, tolerance: 1e-5}\nevents: {e: {kind: coil_short, at: 8 "
                       "ms, fraction: 30 %}}\n");
  vs_trial *t = vs_trial_run("s.yaml", "circuit", NULL, &also);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  CU_ASSERT(worst > 0 && worst < 0.03);
  CLOSE_OF(t->result.watchers.energy.worst, 0, 1, 1e-3); /* the books close */
  vs_trial_free(t);
}

/* The coil shorted behind a stiff source: the shipped F2 clears at a tenth of the thyristor's 72
 * A2s, a 50 A one of its family lets three times that through, and is warned of by its table alone.
 * The deck says that F2 protects the thyristor. */
static void a_fuse_protects_or_not(void) {
  static const char *const FUSES[] = {"FWP-10A14F", "FWP-50A14F"};
  double i2t[2], of_fuse;
  for (int k = 0; k < 2; k++) {
    write_file("s.yaml",
               "circuit: {deck: halfwave_paper, transformer: autotransformer_ideal, fuse_1: "
               "fuse_ideal}\nrun: {until: 20 ms}\nevents: {e: {kind: coil_short, at: 7 "
               "ms}}\nexpect: [fuse_2 opens]\n");
    ran r = run("run s.yaml --json --quiet --set circuit.fuse_2=%s", FUSES[k]);
    EXPECT(r.status == (k ? 3 : 0), "%s", r.err);
    i2t[k] = measure_in(r.out, "thyristor.i2t");
    of_fuse = measure_in(r.out, "fuse_2.let_through");
    CLOSE(of_fuse, i2t[k], 0.01); /* one current, but for the snubber's */
    const char *judged = strstr(r.out, "\"measure\": \"let_through\"");
    EXPECT(judged && strstr(judged, "\"limit\": 72, \"limit_of\": \"thyristor\""), "%s", r.out);
    CLOSE(judged ? strtod(strstr(judged, "\"margin\": ") + 10, NULL) : NAN, 1 - of_fuse / 72, 1e-9);
    EXPECT(strstr(r.out, k ? "\"first_to_fail\": \"thyristor.i2t\"" : "\"first_to_fail\": null") &&
               !strstr(r.out, "is above i2t of tyn1212, 72 A2.s, which it is to protect") == !k,
           "%s", r.out);
    free_ran(&r);
  }
  printf(" %.2f and %.1f A2s ", i2t[0], i2t[1]);
  CU_ASSERT(i2t[0] > 3.6 && i2t[0] < 7.2 && i2t[1] > 1.5 * 72);
}

/* The mains come back from a notch, through an inductance that sets how fast; C2 holds the cathode.
 * A rise of 1.2 times the thyristor's 200 V/us from 10 to 90 % fires it, one of 0.8 does not; nor
 * does the first one with more capacitance in the snubber. The steepest 120 V of both are told. */
static void a_notch_fires_by_its_slope(void) {
  static const struct {
    const char *source, *c1;
    double slope_v_s; /* 0: not looked at */
    bool fires;
  } ROWS[] = {{"130uH", "10nF", 290.9e6, true},
              {"410uH", "10nF", 183.9e6, false},
              {"130uH", "47nF", 0, false}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    write_file("s.yaml",
               "circuit: {deck: halfwave_snubbed, thyristor: thyristor_2t, r1: 10 ohm, r2: "
               "1 ohm, c2: 10 uF, varistor_voltage: 3 kV}\nfiring: {first_cycle: 9}\n"
               "run: {until: 2.4 ms, tolerance: 1e-5}\nevents: {n: {kind: notch, cycle: 1, "
               "angle: 30 deg, duration: 0.5 ms}}\n");
    ran r = run("run s.yaml --quiet -o o%zu --set supply.inductance=%s --set circuit.c1=%s", k,
                ROWS[k].source, ROWS[k].c1);
    EXPECT(r.status == 0 || r.status == 3, "%s", r.err);
    free_ran(&r);
    char path[40];
    snprintf(path, sizeof path, "o%zu/events.csv", k);
    char *events = read_file(path);
    EXPECT(!strstr(events, "thyristor fires without a gate pulse") == !ROWS[k].fires, "%s", events);
    free(events);
    snprintf(path, sizeof path, "o%zu/summary.json", k);
    char *json = read_file(path);
    const char *slope = strstr(json, "\"thyristor.dv_dt\": {\"value\": ");
    CU_ASSERT_PTR_NOT_NULL_FATAL(slope);
    if (ROWS[k].slope_v_s > 0)
      CLOSE(strtod(strstr(slope, "value") + 8, NULL), 1e-6 * ROWS[k].slope_v_s, 0.03);
    free(json);
  }
}

/* ---- the armature ---- */

typedef struct jam {
  double before_n_s, after_n_s; /* momentum of the whole along u, which no inner force changes */
  double p_m, vp_m_s;           /* p when it jammed; largest speed of it afterwards */
  double last_p_m;
  long steps;
} jam;

static double momentum(const vs_knot *k, const vs_model *m) {
  double sum = 0;
  for (int i = 0; i < VS_DOF; i++) sum += m->mass[U][i] * k->x[VS_DOF + i];
  return sum;
}

static vs_status watch_jam(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  jam *j = ctx;
  const vs_model *m = step->frame->model;
  if (step->event[1] == VS_EV_JAMS) {
    j->before_n_s = momentum(step->from, m);
    j->after_n_s = momentum(step->to, m);
    j->p_m = step->to->x[P];
    CU_ASSERT_EQUAL(step->from->t_s, step->to->t_s);
  } else if (j->p_m != 0)
    j->vp_m_s = fmax(j->vp_m_s, fabs(step->to->x[VS_DOF + P]));
  j->last_p_m = step->to->x[P];
  j->steps++;
  return VS_OK;
}

/* Stuck at 20 ms, on the way: from then on p stays to the last bit, momentum is kept through the
 * blow, what the blow takes is in the books, and base and trough go on as one. */
static void a_jammed_armature(void) {
  write_file("s.yaml", "run: {until: 100 ms}\nevents: {e: {kind: jam, at: 20 ms}}\n");
  jam j = {0};
  const vs_observer also = {&j, watch_jam};
  vs_trial *t = vs_trial_run("s.yaml", "circuit", NULL, &also);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  CU_ASSERT(fabs(j.p_m) > 1e-4 && fabs(j.before_n_s) > 1e-3);
  CU_ASSERT_EQUAL(j.last_p_m, j.p_m);
  CU_ASSERT_EQUAL(j.vp_m_s, 0);
  CLOSE(j.after_n_s, j.before_n_s, 1e-12);
  CU_ASSERT(t->result.watchers.energy.joule[VS_E_STOP] > 0.01);
  CLOSE_OF(t->result.watchers.energy.residual[VS_B_MECHANICAL], 0, 1, 1e-6);
  vs_trial_free(t);
}

/* ---- bad input ---- */

static void bad_input(void) {
  static const struct {
    const char *events, *at, *says;
  } ROWS[] = {
      {"{e: {kind: surgee, at: 1 ms}}", "s.yaml:2:20: ", "did you mean 'surge'?"},
      {"{e: {at: 1 ms}}",
       "s.yaml:2:14: ", "events.e.kind: there is no kind ''; there are: surge, "},
      {"{e: surge}", "s.yaml:2:13: ", "events.e: a map is wanted"},
      {"[surge]", "s.yaml:2:10: ", "events: a map of names is wanted"},
      {"{e: {kind: sag, at: 1 ms, levle: 3 %}}", "s.yaml:2:35: ", "did you mean 'level'?"},
      {"{e: {kind: surge, at: 1 ms, level: 5 kV}}", "s.yaml:2:44: ", "allowed: 0.5..4 kV"},
      {"{e: {kind: surge, at: 1 ms, polarity: up}}",
       "s.yaml:2:47: ", "is not one of: +|-|positive|negative"},
      {"{e: {kind: surge, at: 1 ms, polarity: -}}", "s.yaml:2:47: ", "is written in quotes: '-'"},
      {"{e: {kind: surge}}", "s.yaml:2:10: ", "'at', or 'cycle' and 'angle', is wanted"},
      {"{e: {kind: missing_pulse}}", "s.yaml:2:10: ", "'at', or 'cycle', is wanted"},
      {"{e: {kind: missing_pulse, at: 3 ms}}", "s.yaml:2:35: ", "has no key 'at'"},
      {"{e: {kind: missing_pulse, cycle: 2}}", "s.yaml:2:42: ", "no gate pulse in cycle 2; firing"},
      {"{e: {kind: weak_pulse, cycle: 2}}", "s.yaml:2:39: ", "= 1 and firing.every: once have one"},
      {"{e: {kind: short_pulse, cycle: 1, duration: 9 ms}}",
       "s.yaml:2:53: ", "9 ms is more than the pulse's own length, firing.pulse_width = 8 ms"},
      {"{e: {kind: surge, at: 1 ms, angle: 3 deg}}", "s.yaml:2:37: ", "'at' says when already"},
      {"{e: {kind: missing_pulse, cycle: 1, gate: 3}}",
       "s.yaml:2:51: ", "'all' or a gate port is wanted"},
      {"{e: {kind: missing_pulse, cycle: 1, gate: gate+180deg}}",
       "s.yaml:2:10: ", "events.e: the deck has no port gate+180deg"},
      {"{e: {kind: open, at: 1 ms, element: R7}}",
       "s.yaml:2:10: ", "no element 'R7'; did you mean"},
      {"{a: {kind: sag, at: 1 ms}, b: {kind: sag, at: 3 ms}}",
       "s.yaml:2:36: ", "it clashes with events.a: at the same time"},
      {"{a: {kind: weak_pulse, cycle: 1}, b: {kind: missing_pulse, cycle: 1}}",
       "s.yaml:2:43: ", "it clashes with events.a: the same pulse"},
      {"{a: {kind: open, at: 1 ms, element: R1}, b: {kind: short, at: 3 ms, element: r1}}",
       "s.yaml:2:50: ", "it clashes with events.a: the same element"},
      {"{a: {kind: coil_short, at: 1 ms}, b: {kind: coil_short, at: 3 ms, fraction: 30 %}}",
       "s.yaml:2:43: ", "it clashes with events.a: the same element"},
      {"{a: {kind: coil_short, at: 1 ms, fraction: 30 %}, b: {kind: open, at: 3 ms, element: "
       "xeva}}",
       "s.yaml:2:59: ", "it clashes with events.a: the same element"},
      {"{e: {kind: open, at: 1 ms}}",
       "s.yaml:2:10: ", "events.e: 'element' is wanted: the deck's to open, by its name, as R1"},
      {"{e: {kind: short, at: 1 ms}}", "s.yaml:2:10: ", "events.e: 'element' is wanted"},
      {"{e: {kind: notch, at: 1 ms, duration: 20 ms, count: 2}}",
       "s.yaml:2:61: ", "'duration' must be below a cycle, 20 ms"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char scene[300];
    snprintf(scene, sizeof scene, "run: {until: 25 ms}\nevents: %s\n", ROWS[k].events);
    write_file("s.yaml", scene);
    for (int check = 0; check < 2; check++) {
      ran r = run(check ? "check s.yaml" : "run s.yaml");
      CU_ASSERT_EQUAL(r.status, 2);
      const char *text = check ? r.err : r.err + strlen("vibrospice: ");
      EXPECT(!strncmp(text, ROWS[k].at, strlen(ROWS[k].at)) && strstr(text, ROWS[k].says), "%s",
             r.err);
      free_ran(&r);
    }
  }
  write_file("s.yaml", "circuit: {deck: halfwave_paper}\nevents: {e: {kind: open, at: 1 ms, "
                       "element: Xgate}}\n");
  ran r = run("run s.yaml");
  EXPECT(r.status == 2 && strstr(r.err, "Xgate is no element of two nodes, nor a part with"), "%s",
         r.err);
  free_ran(&r);
  write_file("d.cir", "*$ port mains = Vm\nVm s 0 external\nRs s a 1\nXeva a 0 eva\n");
  write_file("s.yaml", "circuit: {deck: d.cir}\nevents: {e: {kind: surge, at: 1 ms}}\n");
  r = run("run s.yaml");
  EXPECT(r.status == 2 && strstr(r.err, "s.yaml:2:10: events.e: the deck has no line '*$ line NODE "
                                        "NODE', which says where a surge couples in"),
         "%s", r.err);
  free_ran(&r);
}

/* The tier that has them, summary, events.csv; --set reaches each key; no export. */
static void said_in_the_results(void) {
  write_file("s.yaml", "run: {until: 8 ms}\nevents:\n  dip: {kind: sag, at: 3 ms, level: 50 %}\n");
  ran r =
      run("run s.yaml --quiet -o o --set events.dip.level=30%% --set 'events.n={kind: notch, at: 6 "
          "ms}'");
  CU_ASSERT_EQUAL(r.status, 0);
  free_ran(&r);
  char *json = read_file("o/summary.json"), *csv = read_file("o/events.csv");
  EXPECT(
      strstr(json, "\"tier\": \"circuit\"") && strstr(json, "the scene names events.dip") &&
          strstr(json, "\"events\": {\n      \"dip\": {\"starts_s\": 0.003, \"kind\": \"sag\"") &&
          strstr(json, "\"level\": {\"value\": 30, \"unit\": \"%\"}"),
      "%s", json);
  EXPECT(strstr(csv, "\n0.003,dip begins (sag)\n") && strstr(csv, "\n0.006,n begins (notch)\n"),
         "%s", csv);
  free(json), free(csv);
  r = run("export s.yaml -o x.cir");
  EXPECT(r.status == 2 && strstr(r.err, "s.yaml:3:3: export: a netlist for plain ngspice has no "
                                        "events; leave dip out"),
         "%s", r.err);
  free_ran(&r);
}

/* Every way to say which way the generator goes. */
static void polarities(void) {
  static const struct {
    const char *scene, *set;
    double sign;
  } ROWS[] = {{"+", "", 1},
              {"'-'", "", -1},
              {"positive", "", 1},
              {"negative", "", -1},
              {"+", " --set events.s.polarity=-", -1},
              {"+", " --set events.s.polarity=negative", -1},
              {"'-'", " --set events.s.polarity=+", 1}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char scene[300];
    write_file("d.cir", "*$ line a\n*$ probe v_a = v(a) V\nRa a 0 100\nRb b 0 1\nXeva b 0 eva\n");
    snprintf(scene, sizeof scene,
             "circuit: {deck: d.cir}\nrun: {until: 20 us, max_step: 1 us}\n"
             "events: {s: {kind: surge, at: 1 us, polarity: %s}}\n",
             ROWS[k].scene);
    write_file("s.yaml", scene);
    ran r = run("run s.yaml --json --quiet%s", ROWS[k].set);
    EXPECT(r.status == 0, "%s%s: %s", ROWS[k].scene, ROWS[k].set, r.err);
    double most = measure_in(r.out, "v_a_max"), least = measure_in(r.out, "v_a_min");
    EXPECT(ROWS[k].sign * (most + least) > 500, "%s%s: %g..%g V", ROWS[k].scene, ROWS[k].set, least,
           most);
    free_ran(&r);
  }
}

/* A sag leaves at most all of the voltage, and a swell makes at most three times of it. */
static void levels_have_bounds(void) {
  static const struct {
    const char *kind, *level;
    int status;
  } ROWS[] = {{"sag", "100 %", 0},   {"sag", "100.5 %", 2}, {"swell", "99.5 %", 2},
              {"swell", "100 %", 0}, {"swell", "300 %", 0}, {"swell", "300.5 %", 2}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char scene[200];
    snprintf(scene, sizeof scene,
             "run: {until: 50 ms}\nevents: {a: {kind: %s, at: 10 ms, level: %s}}\n", ROWS[k].kind,
             ROWS[k].level);
    write_file("s.yaml", scene);
    ran r = run("check s.yaml");
    EXPECT(r.status == ROWS[k].status, "%s of %s: %d %s", ROWS[k].kind, ROWS[k].level, r.status,
           r.err);
    free_ran(&r);
  }
}

static const vs_test TESTS[] = {
    {"levels have bounds", levels_have_bounds},
    {"surge meets its standard", surge_meets_its_standard},
    {"surge into a varistor", surge_into_a_varistor},
    {"surges on the paper's converter", surges_on_the_paper},
    {"surges add up", surges_add_up},
    {"books of an idle machine", books_of_an_idle_machine},
    {"ring wave and EFT", ring_wave_and_eft},
    {"on the mains", on_the_mains},
    {"several on the mains", several_on_the_mains},
    {"at the gate", at_the_gate},
    {"at one gate", at_one_gate},
    {"opened and shorted", opened_and_shorted},
    {"what is reckoned otherwise", what_is_reckoned_otherwise},
    {"a fuse protects, or not", a_fuse_protects_or_not},
    {"a notch fires by its slope", a_notch_fires_by_its_slope},
    {"a shorted capacitor", a_shorted_capacitor},
    {"some turns are shorted", some_turns_are_shorted},
    {"a jammed armature", a_jammed_armature},
    {"polarities", polarities},
    {"bad input", bad_input},
    {"said in the results", said_in_the_results},
};

int main(void) {
  return program_suite("events", TESTS, COUNT(TESTS));
}
