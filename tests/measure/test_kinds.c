/* SPDX-License-Identifier: GPL-3.0-or-later
 * What is measured of triacs, diodes, mosfets, igbts, electrolytic capacitors and fuses, against
 * closed forms: courses that are given, sources that force a voltage and a current, and a triac
 * that is imported and run. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "measure/devices/losses.h"
#include "program.h"

/* ---- what the loss is made of: given courses ---- */

typedef struct knot {
  double t_us, v, i;
} knot;

static void complete(double y[VS_COURSES]) {
  y[VS_OF_POWER] = y[VS_OF_V] * y[VS_OF_I];
}

/* Follows straight lines through the knots, each cut into so many steps. Returns int v i dt. */
static double follow(vs_losses *l, const knot *knots, size_t count, int steps) {
  double joule = 0;
  vs_losses_resume(l, knots[0].v, knots[0].i);
  for (size_t k = 0; k + 1 < count; k++)
    for (int n = 0; n < steps; n++) {
      const knot *a = &knots[k], *b = a + 1;
      double at[3] = {(double)n / steps, (n + 0.5) / steps, (n + 1.0) / steps};
      vs_course_step c = {.h_s = 1e-6 * (b->t_us - a->t_us) / steps};
      double *to[3] = {c.from, c.mid, c.to};
      for (int e = 0; e < 3; e++) {
        to[e][VS_OF_V] = a->v + at[e] * (b->v - a->v);
        to[e][VS_OF_I] = a->i + at[e] * (b->i - a->i);
        complete(to[e]);
      }
      c.t0_s = 1e-6 * (a->t_us + at[0] * (b->t_us - a->t_us));
      c.t1_s = c.t0_s + c.h_s;
      vs_losses_follow(l, &c);
      joule += c.h_s * (c.from[VS_OF_POWER] + 4 * c.mid[VS_OF_POWER] + c.to[VS_OF_POWER]) / 6;
    }
  return joule;
}

static void adds_up(const vs_losses *l, double joule) {
  double sum = 0;
  for (int k = 0; k < VS_LOSSES; k++) sum += l->joule[k];
  CLOSE(sum, joule, 1e-12);
}

/* Hard switching of V = 300 V and I = 10 A: E = V I t/2. The ends miss (V1/V)^2 = 1.1e-3 of the
 * voltage's half and (I1/I)^2 = 4e-4 of the current's; 2e-3 of all. A second switching begins at
 * 2 % of the current, the first at 1 mA. */
static void hard_switching(void) {
  static const knot COURSE[] = {{0, 300, 0},     {10, 300, 0},     {10.1, 300, 10}, {10.2, 0, 10},
                                {30.2, 0, 10},   {30.3, 300, 10},  {30.6, 300, 0},  {50, 300, 0},
                                {50.3, 300, 10}, {50.4, 0, 10},    {70, 0, 10},     {70.1, 300, 10},
                                {70.3, 300, 0},  {80, 300, 0.001}, {90, 300, 0.001}};
  for (int steps = 1; steps <= 300; steps += 299) {
    vs_losses l;
    vs_losses_begin(&l, false);
    adds_up(&l, follow(&l, COURSE, COUNT(COURSE), steps));
    CLOSE(l.largest[VS_LOSS_ON].value, 300 * 10 * 0.4e-6 / 2, 2e-3);
    CLOSE(l.largest[VS_LOSS_ON].at_s, 50.4e-6, 1e-3);
    CLOSE(l.largest[VS_LOSS_OFF].value, 300 * 10 * 0.4e-6 / 2, 2e-3);
    CLOSE(l.largest[VS_LOSS_OFF].at_s, 30.6e-6, 1e-3);
    CLOSE(l.joule[VS_LOSS_ON], 300 * 10 * (0.2e-6 + 0.4e-6) / 2, 2e-3);
    CLOSE(l.joule[VS_LOSS_OFF], 300 * 10 * (0.4e-6 + 0.3e-6) / 2, 2e-3);
    CLOSE(l.turned_off.value, 10, 1e-9);
    CU_ASSERT_EQUAL(l.joule[VS_LOSS_RECOVERY], 0);
    /* up to I1 of each ramp is blocking: 2 % of 10 A; and the leakage behind */
    double ramps = 300 * 0.2 * 0.2 / 10 / 2 * (0.3e-6 + 0.3e-6 + 0.2e-6);
    double leaks = 300 * 1e-3 * (9.7e-6 / 2 + 10e-6);
    CLOSE(l.joule[VS_LOSS_BLOCKING], ramps + leaks, 1e-3);
  }
}

/* 2 V at 10 A for 20 us, and no more than 30 V are switched: V1 is a tenth of these. */
static void low_voltage(void) {
  static const knot COURSE[] = {{0, 30, 0},    {1, 30, 0},     {1.1, 30, 10}, {1.2, 2, 10},
                                {21.2, 2, 10}, {21.3, 30, 10}, {21.4, 30, 0}, {30, 30, 0}};
  vs_losses l;
  vs_losses_begin(&l, false);
  adds_up(&l, follow(&l, COURSE, COUNT(COURSE), 7));
  CLOSE(l.joule[VS_LOSS_CONDUCTION], 2 * 10 * 20e-6, 2e-3);
  /* the ramps of voltage from 30 V to V1 = 3 V alone: (27/28) of 100 ns at 16.5 V on the mean */
  double ramp = 27.0 / 28 * 0.1e-6 * 16.5 * 10, current = 30 * 10 * 0.1e-6 / 2;
  CLOSE(l.largest[VS_LOSS_ON].value, current + ramp, 1e-6);
  CLOSE(l.largest[VS_LOSS_OFF].value, current + ramp, 1e-3);
}

/* A diode: 1 V forward at 10 A, its current falls through zero to -4 A in 1.4 us while it still has
 * 1 V forward, then 300 V of reverse voltage stand while the current decays straight in 60 ns:
 * E = -1 V 4 A 0.4 us/2 + 300 V 4 A 60 ns/2, the second less 4e-4 of it at its end. */
static void recovery(void) {
  static const knot COURSE[] = {{0, 1, 10},         {10, 1, 10},       {11.4, 1, -4},
                                {11.401, -300, -4}, {11.461, -300, 0}, {20, -300, 0},
                                {20.1, 0, 0},       {20.2, 1, 10},     {30, 1, 10}};
  for (int steps = 1; steps <= 50; steps += 49) {
    vs_losses l;
    vs_losses_begin(&l, true);
    adds_up(&l, follow(&l, COURSE, COUNT(COURSE), steps));
    double step = 1e-9 * 4 * 299.0 / 2; /* from 1 V to -300 V */
    double expected = -1.0 * 4 * 0.4e-6 / 2 + 300.0 * 4 * 60e-9 / 2 + step;
    CLOSE(l.joule[VS_LOSS_RECOVERY], expected, 1e-3);
    CLOSE(l.largest[VS_LOSS_RECOVERY].value, expected, 1e-3);
    CU_ASSERT_EQUAL(l.joule[VS_LOSS_ON] + l.joule[VS_LOSS_OFF], 0);
    CLOSE(l.joule[VS_LOSS_CONDUCTION], 10 * 10e-6 + 10 * 1e-6 / 2 + 10 * 0.1e-6 / 3 + 10 * 9.8e-6,
          1e-6);
  }
}

/* ---- forced by sources ---- */

#define ASIDE "Re e 0 1\nXeva e 0 eva\n"
#define PART(kind, lines) "*$ part " kind " \"P\"\n" lines ".subckt p a b\nR1 a b 1meg\n.ends\n"
/* a voltage and a current, each from PWL */
#define FORCED(v, i) "Vx x 0 PWL(" v ")\nIt 0 y PWL(" i ")\nVt y z 0\nRz z 0 1\n" ASIDE

static vs_trial *run_deck(const char *deck, const char *part, const char *until, const char *step) {
  char sets[2][64];
  write_file("p.inc", part);
  write_file("d.cir", deck);
  snprintf(sets[0], sizeof sets[0], "run.until=%s", until);
  snprintf(sets[1], sizeof sets[1], "run.max_step=%s", step);
  vs_trial *t = vs_trial_run(
      "paper", "circuit",
      (const char *[]){"circuit.deck=d.cir", "firing.every=1", sets[0], sets[1], NULL}, NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  return t;
}

static const vs_reduced *measure(const vs_trial *t, const char *what) {
  static const vs_reduced NONE = {.value = {false, NAN, NAN}, .failed_s = NAN};
  const vs_watched *w = &t->result.watchers.devices->item[0];
  for (size_t n = 0; n < w->count; n++)
    if (!strcmp(w->reduced[n].measure->name, what)) return &w->reduced[n];
  EXPECT(false, "no measure %s", what);
  return &NONE;
}

static double value(const vs_trial *t, const char *what) {
  const vs_reduced *r = measure(t, what);
  return r->value.known ? r->value.value : NAN;
}

static double sum_of(const vs_trial *t, const char *const *what) {
  double sum = 0;
  for (; *what; what++) sum += value(t, *what);
  return sum;
}

static const char MOSFET_DECK[] = "*$ param t = p part\n*$ device t = v(x), i(Vt)\n" FORCED(
    "0 400 10u 400 10.1u 2 20u 2 20.1u 500 20.2u 400", "0 0 9.9u 0 10u 8 20.1u 8 20.2u 0");

/* 400 V and 8 A; what ngspice makes of the corners of its sources is 1e-6 of it. The turn-off goes
 * up to 500 V. 398 V in 0.1 us fall, 498 V rise. */
static void a_mosfet(void) {
  vs_trial *t = run_deck(MOSFET_DECK,
                         PART("mosfet", "*$ limit v_dss = 450 V\n*$ limit i_dm = 20 A\n"
                                        "*$ limit dv_dt = 6 kV/us\n*$ limit e_as = 0.15 mJ\n"
                                        "*$ zth 0.5 K/W 1 ms\n"),
                         "30us", "10ns");
  static const char *const PARTS[] = {"loss_conduction", "loss_switching", "loss_blocking", NULL};
  CLOSE(sum_of(t, PARTS), value(t, "loss"), 1e-9);
  CLOSE(value(t, "v_peak"), 500, 1e-5);
  CU_ASSERT(measure(t, "v_peak")->failed_s > 20e-6);
  CLOSE(value(t, "i_peak"), 8, 1e-5);
  CLOSE(value(t, "dv_dt"), 498 / 0.1e-6, 1e-3);
  CU_ASSERT(measure(t, "dv_dt")->limit && isnan(measure(t, "dv_dt")->failed_s));
  CLOSE(value(t, "i_off"), 8, 1e-3);
  CLOSE(value(t, "e_on"), 8 * 400 * 0.1e-6 / 2 + 8 * 0.1e-6 * (400 + 2) / 2, 2e-3);
  /* the current's fall from 8 A to 0 meets 500 to 400 V: 8 A t (500/2 - 100/6) */
  CLOSE(value(t, "e_off"), 8 * 0.1e-6 * (500 + 2) / 2 + 8 * 0.1e-6 * (500.0 / 2 - 100.0 / 6), 2e-3);
  /* above 450 V: 50 V of the rise at 8 A, and half of the fall, of (500 - 100 x) 8 (1 - x) */
  CLOSE(value(t, "e_avalanche"), 8 * 475 * 0.1e-6 * 50 / 498 + 0.1e-6 * 8 * (250 - 75 + 12.5 / 3),
        2e-3);
  CU_ASSERT(measure(t, "e_avalanche")->failed_s > 20.1e-6);
  CLOSE(value(t, "loss_conduction"), 2 * 8 * 9.9e-6, 5e-3); /* and up to 10 V of two ramps */
  /* 0.8 mJ within 10 us, of which a network of 1 ms forgets 1 % at most */
  CLOSE(value(t, "t_j_rise"), 0.5 * value(t, "loss") / 1e-3, 2e-2);
  vs_trial_free(t);
}

/* The same courses with each sign in the device's line. A wrong one was not told, and its limits
 * were held. */
static void signs(void) {
  static const char COURSES[] = FORCED("0 -400 9.8u -400 9.9u 1 20.1u 1 20.2u -400",
                                       "0 -5u 9.9u -5u 10u 8 20u 8 20.1u -1 20.2u -1 20.3u -5u");
  static const struct {
    const char *kind, *v, *i, *says;
  } ROWS[] = {{"diode", "v(x)", "i(Vt)", NULL},
              {"diode", "-v(x)", "i(Vt)", "device t gives 0.00"},
              {"diode", "v(x)", "-i(Vt)", "device t gives 0.00"},
              {"diode", "-v(x)", "-i(Vt)", "device t conducts backwards, which no diode does"},
              {"mosfet", "-v(x)", "-i(Vt)", NULL}, /* it may conduct either way */
              {"igbt", "v(x)", "-i(Vt)", "which no igbt does"},
              {"electrolytic", "v(x)", "-i(Vt)", NULL}}; /* it may give what it has */
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char deck[1024], part[128], text[512] = "";
    snprintf(deck, sizeof deck, "*$ param t = p part\n*$ device t = %s, %s\n%s", ROWS[k].v,
             ROWS[k].i, COURSES);
    snprintf(part, sizeof part, PART("%s", ""), ROWS[k].kind);
    vs_trial *t = run_deck(deck, part, "30us", "10ns");
    const vs_watched *w = t->result.watchers.devices->item;
    bool wrong = vs_devices_sign_is_wrong(w, 1e-3, text, sizeof text);
    EXPECT(wrong == (ROWS[k].says != NULL), "%zu: %s", k, text);
    if (ROWS[k].says) EXPECT(strstr(text, ROWS[k].says), "%s", text);
    vs_trial_free(t);
  }
}

static void an_igbt_and_its_limits(void) {
  char deck[800];
  snprintf(deck, sizeof deck, "%s", MOSFET_DECK);
  vs_trial *t = run_deck(deck,
                         PART("igbt", "*$ limit v_ces = 600 V\n*$ limit i_cm = 5 A\n"
                                      "*$ limit i_rbsoa = 7 A\n*$ limit i_c = 5 A\n"),
                         "30us", "10ns");
  CU_ASSERT(isnan(measure(t, "v_peak")->failed_s) && measure(t, "v_peak")->limit);
  CU_ASSERT(measure(t, "i_peak")->failed_s < 11e-6);
  CLOSE(measure(t, "i_off")->failed_s, 20.2e-6, 1e-2);
  CU_ASSERT(measure(t, "i_rms")->unjudged != NULL);
  CLOSE(value(t, "i_mean"), 8 * (0.05e-6 + 10.1e-6 + 0.05e-6) / 30e-6, 1e-4);
  CLOSE_OF(value(t, "v_reverse"), -2, 500, 1e-5);
  vs_trial_free(t);
}

/* Triangles of 5 ms, 10 A, and reverse voltage between them; 2 V forward. */
static void a_diode(void) {
  vs_trial *t = run_deck(
      "*$ param t = p part\n*$ device t = v(x), i(Vt)\n" FORCED(
          "0 2 5m 2 5.01m -600 10m -600 10.01m 2", "0 0 2.5m 10 5m 0 10.01m 0 12.51m 10 15.01m 0"),
      PART("diode", "*$ limit v_rrm = 500 V\n*$ limit i_f_av = 1 A\n*$ limit i2t = 0.1 A2.s\n"),
      "16ms", "20us");
  static const char *const PARTS[] = {"loss_conduction", "loss_recovery", "loss_blocking", NULL};
  CLOSE(sum_of(t, PARTS), value(t, "loss"), 1e-9);
  CLOSE(value(t, "v_reverse"), 600, 1e-5);
  CLOSE(value(t, "i_peak"), 10, 1e-5);
  CLOSE(value(t, "i2t"), 100 * 5e-3 / 3, 1e-3);
  CU_ASSERT(measure(t, "i2t")->failed_s < 5e-3);
  CLOSE(value(t, "i_mean"), 10 * 5e-3 / 16e-3, 1e-4);
  CLOSE(value(t, "loss_conduction"), 2 * 10 * 5e-3, 1e-4);
  CLOSE_OF(value(t, "loss_recovery"), 0, value(t, "loss"), 1e-4);
  vs_trial_free(t);
}

/* 2 A either way through an ESR of 0.1 ohm are 0.4 W, whatever is stored; 5 K/W with 1 s. */
static void an_electrolytic(void) {
  static const char DECK[] = "*$ param t = p part\n*$ device t = v(x), i(Vt)\n" FORCED(
      "0 -3 1m -3 1.1m 400", "0 2 10m 2 10.01m -2 20m -2 20.01m 2");
  vs_trial *t = run_deck(DECK,
                         PART("electrolytic", "*$ limit v_rated = 350 V\n*$ limit v_reverse = 1 V\n"
                                              "*$ limit i_ripple = 3 A\n*$ limit esr = 0.1 ohm\n"
                                              "*$ zth 5 K/W 1 s\n"),
                         "40ms", "100us");
  CLOSE(value(t, "v_peak"), 400, 1e-5);
  CLOSE(value(t, "v_reverse"), 3, 1e-5);
  CU_ASSERT(!isnan(measure(t, "v_reverse")->failed_s) && !isnan(measure(t, "v_peak")->failed_s));
  CLOSE(value(t, "i_rms"), 2, 1e-3);
  CLOSE(value(t, "t_core_rise"), 5 * 0.4 * -expm1(-0.04), 2e-3); /* less at the two turns */
  vs_trial_free(t);
  t = run_deck(DECK, PART("electrolytic", "*$ zth 5 K/W 1 s\n"), "10ms", "100us");
  CU_ASSERT_FALSE(measure(t, "t_core_rise")->value.known); /* no ESR, no heat */
  vs_trial_free(t);
}

/* ---- triacs ---- */

/* Fired at 100 degrees, 5.556 ms, and 10 ms later. The current falls straight from 10 A to 0 in
 * 2.5 ms: 4 A/ms; then the voltage of the other half cycle comes within 10 us: 30 V/us. */
static void a_triac_both_ways(void) {
  vs_trial *t = run_deck(
      "*$ param t = p part\n*$ port gate = Vg\n*$ port gate+180deg = Vh\n"
      "*$ device t gate gate+180deg = v(x), i(Vt)\nVg g 0 external\nVh h 0 external\n" FORCED(
          "0 300 5.6m 300 5.601m 1 13.5m 1 13.5001m -1 13.51m -300 15.6m -300 15.601m -1 "
          "23.5m -1 23.5001m 1 23.51m 300",
          "0 0 5.6m 0 5.61m 10 11m 10 13.5m 0 15.6m 0 15.61m -10 21m -10 23.5m 0"),
      PART("triac", "*$ limit v_drm = 250 V\n*$ limit dv_dt_c = 20 V/us\n"
                    "*$ limit di_dt_c = 5 A/ms\n*$ limit dv_dt = 500 V/us\n"),
      "25ms", "20us");
  CLOSE(value(t, "v_forward"), 300, 1e-5);
  CLOSE(value(t, "v_reverse"), 300, 1e-5);
  CLOSE(value(t, "di_dt_c"), 4000, 5e-3);
  CLOSE(value(t, "dv_dt_c"), 299 / 9.9e-6, 2e-2);
  CLOSE(measure(t, "dv_dt_c")->failed_s, 13.5e-3, 1e-3);
  CU_ASSERT(isnan(measure(t, "di_dt_c")->failed_s));
  CLOSE(value(t, "dv_dt"), value(t, "dv_dt_c"), 1e-12); /* there is no other rise */
  CLOSE(value(t, "dv_dt_max"), 299 / 9.9e-6, 1e-6);     /* straight, so that every window has it */
  CLOSE(value(t, "i2t"), 100 * (5.39e-3 + 0.01e-3 / 3 + 2.5e-3 / 3), 2e-3); /* one half cycle */
  CLOSE_OF(value(t, "i_mean"), 0, 10, 2e-2);
  CLOSE_OF(value(t, "misfires"), 0, 1, 0);
  CLOSE_OF(value(t, "unintended_firings"), 0, 1, 0);
  static const char *const PARTS[] = {"loss_conduction", "loss_switching", "loss_blocking", NULL};
  CLOSE(sum_of(t, PARTS), value(t, "loss"), 1e-9);
  vs_trial_free(t);
}

/* Behind its fall, of 4 A/ms but where another is said, the current is 0.5 A the other way as the
 * voltage turns, and decays; then the voltage comes at 30 V/us. That is no firing. A rise of 14 V
 * does not stand for one of 295 V that follows; a surge 1.7 ms later meets no charge; a run that
 * ends before the voltage has come down; a fall at 12 A/ms behind a peak of 200 A; one of 0.85 A in
 * 5 us behind milliseconds at that, whose mean over 50 us is 17 A/ms; a run that ends 0.1 ms later,
 * before a failure could show; a fall behind which no voltage comes, as where a fuse has opened;
 * under its gate pulse a current that its snubber rings through zero, and one that ends at
 * 200 A/ms. And it does fire where the current stays, or comes back with an on-state voltage. */
static void a_triac_commutates(void) {
  static const struct {
    const char *v, *i, *until;
    double dv_dt_c_v_us, di_dt_c_a_ms;
    int unintended;
    unsigned unsure; /* of di_dt_c */
    bool too_early;  /* to see a commutation failure */
  } ROWS[] = {
      {"13.625m 1 13.6251m -1 13.6351m -300 16m -300",
       "11m 10 13.5m 0 13.625m -0.5 13.655m -0.15 13.745m 0", "run.until=15ms", 29.9, 4, 0, 0,
       false},
      {"13.5m 1 13.5001m -1 13.51m -15 13.512m -5 13.53m -5 13.532m -300 16m -300",
       "11m 10 13.5m 0", "run.until=15ms", 147.5, 4, 0, 0, false},
      {"13.5m 1 13.5001m -1 13.7m -200 15.2m -220 15.201m -700 15.3m -250 16m -250",
       "11m 10 13.5m 0", "run.until=15.5ms", 1, 4, 0, 0, false},
      {"13.5m 1 13.5001m -1 13.51m -300 16m -300", "11m 10 13.5m 0", "run.until=14ms", 30.2, 4, 0,
       0, false},
      {"13.5m 1 13.5001m -1 13.51m -300 16m -300", "6m 200 6.05m 10 11m 10 13m 6 13.5m 0",
       "run.until=15ms", 30.2, 12, 0, VS_ASSUMED, false},
      {"13.5m 1 13.5001m -1 13.51m -300 16m -300", "10m 0.95 13.495m 0.85 13.5m 0",
       "run.until=15ms", 30.2, 17, 0, VS_ASSUMED, false},
      {"13.5m 1 13.5001m -1 13.51m -300 16m -300", "11m 10 13.5m 0", "run.until=13.6ms", 30.2, 4, 0,
       0, true},
      {"13.5m 1 13.5001m 0 16m 0", "11m 10 13.5m 0", "run.until=15.5ms", NAN, NAN, 0, 0, false},
      {"13.5m 1 13.5001m -1 13.51m -300 16m -300",
       "5.612m -0.02 5.63m -0.02 5.65m 0.1 11m 10 13.5m 0", "run.until=15ms", 30.2, 4, 0, 0, false},
      {"5.7m 1 5.7001m -1 5.71m -300 16m -300", "5.65m 10 5.7m 0 16m 0", "run.until=15ms", 30.2,
       200, 0, 0, false},
      {"13.55m 1 13.5501m -1 19m -1", "11m 10 13.5m 0 13.55m -3 14m -2 15m -1", "run.until=15ms",
       NAN, 4, 1, 0, false},
      {"13.55m 1 13.5501m -1 13.56m -100 13.57m -100 13.571m -1 19m -1",
       "11m 10 13.5m 0 13.55m -1 13.565m -0.1 13.57m -0.1 13.58m -8 19m -8", "run.until=15ms",
       10.06, 4, 1, 0, false}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char deck[800];
    snprintf(deck, sizeof deck,
             "*$ param t = p part\n*$ port gate = Vg\n*$ port gate+180deg = Vh\n"
             "*$ device t gate gate+180deg = v(x), i(Vt)\nVg g 0 external\nVh h 0 external\n" //
             FORCED("0 300 5.6m 300 5.601m 1 %s", "0 0 5.6m 0 5.61m 10 %s"),
             ROWS[k].v, ROWS[k].i);
    write_file("p.inc", PART("triac", "*$ limit v_drm = 800 V\n*$ limit dv_dt_c = 20 V/us\n"
                                      "*$ limit di_dt_c = 5 A/ms\n"));
    write_file("d.cir", deck);
    vs_trial *t = vs_trial_run("paper", "circuit",
                               (const char *[]){"circuit.deck=d.cir", "firing.every=1",
                                                "firing.pulse_width=1ms", ROWS[k].until, NULL},
                               NULL);
    CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
    CU_ASSERT_EQUAL(measure(t, "dv_dt_c")->value.known, !isnan(ROWS[k].dv_dt_c_v_us));
    if (!isnan(ROWS[k].dv_dt_c_v_us))
      CLOSE(value(t, "dv_dt_c"), 1e6 * ROWS[k].dv_dt_c_v_us, 1e-2); /* knots beside the corners */
    CU_ASSERT_EQUAL(measure(t, "di_dt_c")->value.known, !isnan(ROWS[k].di_dt_c_a_ms));
    if (!isnan(ROWS[k].di_dt_c_a_ms)) CLOSE(value(t, "di_dt_c"), 1e3 * ROWS[k].di_dt_c_a_ms, 5e-3);
    CU_ASSERT_EQUAL(measure(t, "di_dt_c")->unsure, ROWS[k].unsure);
    CU_ASSERT_EQUAL(measure(t, "commutation_failures")->unjudged != NULL, ROWS[k].too_early);
    CLOSE_OF(value(t, "unintended_firings"), ROWS[k].unintended, 1, 0);
    vs_trial_free(t);
  }
}

static char *events_of(const char *deck, const char *part, const char *sets) {
  write_file("d.cir", deck);
  write_file("p.inc", part);
  ran r = run("run paper --set circuit.deck=d.cir --set run.verify=never --quiet -o out %s", sets);
  EXPECT(r.status == 0 || r.status == 3, "%s", r.err);
  free_ran(&r);
  return read_file("out/events.csv");
}

#define TWO_GATES                                                                                  \
  "*$ param t = p part\n*$ port gate = Vg\n*$ port gate+180deg = Vh\n"                             \
  "*$ device t = v(x), i(Vt)\nVg g 0 external\nVh h 0 external\n"
#define SHORT_PULSES "--set firing.every=1 --set firing.pulse_width=1ms --set run.until=22ms"

/* The current goes on in the other direction without a gate pulse; or 0.5 ms behind its zero. */
static void fails_to_commutate(void) {
  char *e = events_of(TWO_GATES FORCED("0 300 5.6m 300 5.601m 1 9.99m 1 10.01m -1 20m -1",
                                       "0 0 5.6m 0 5.61m 10 8m 10 12m -10 19m -10"),
                      PART("triac", ""), SHORT_PULSES);
  CLOSE(event_s(e, "t fires (positive half cycle)"), 5.6e-3, 1e-3);
  CLOSE(event_s(e, "t extinct (positive half cycle)"), 10e-3, 2e-3);
  CLOSE(event_s(e, "t fires without a gate pulse (commutation failure)"), 10e-3, 2e-3);
  CLOSE(event_s(e, "t fires (negative half cycle)"), 10e-3, 2e-3);
  CU_ASSERT_PTR_NULL(strstr(e, "thyristor"));
  free(e);
  e = events_of(TWO_GATES FORCED("0 300 5.6m 300 5.601m 1 9.999m 1 10.001m -1 10.01m -300 "
                                 "10.5m -300 10.501m -1 20m -1",
                                 "0 0 5.6m 0 5.61m 10 8m 10 10m 0 10.5m 0 10.51m -10 19m -10"),
                PART("triac", ""), SHORT_PULSES);
  CLOSE(event_s(e, "t fires without a gate pulse (commutation failure)"), 10.5e-3, 1e-3);
  free(e);
}

/* A current of the other direction flows already as the voltage changes its sign. It rises by 0.1
 * A/us; that its sign is counted anew there is no rise: from -1 A to 1 A within 0.1 us were 20
 * A/us.
 */
static void a_current_before_its_half_cycle(void) {
  vs_trial *t =
      run_deck(TWO_GATES FORCED("0 300 5.6m 300 5.601m 1 10.01m 1 10.0101m -1 20m -1",
                                "0 0 5.6m 0 5.61m 0.1 10m 0 10.01m -1 10.02m -2 12m -2 19m -2"),
               PART("triac", "*$ limit di_dt = 50 A/us\n"), "15ms", "20us");
  CLOSE(value(t, "di_dt"), 0.1e6, 2e-2); /* within 0.1 us the corners are round by less */
  vs_trial_free(t);
}

/* The current ends at 8 ms, and the other half cycle's voltage comes 2 ms later and fires the
 * triac: its charge has long gone, and that is no failure to commutate. No t_q is stated. */
static void fires_long_behind_a_conduction(void) {
  char *e = events_of(TWO_GATES FORCED("0 300 5.6m 300 5.601m 1 9.999m 1 10.001m -1 20m -1",
                                       "0 0 5.6m 0 5.61m 10 6m 10 8m 0 10m 0 10.01m -10 14m -10"),
                      PART("triac", ""), SHORT_PULSES);
  CLOSE(event_s(e, "t fires without a gate pulse (unintended firing)"), 10e-3, 1e-3);
  CU_ASSERT_PTR_NULL(strstr(e, "commutation"));
  free(e);
}

/* It has blocked for a half cycle, and fires without a pulse in the next: that is no commutation.
 */
static void fires_a_half_cycle_later(void) {
  char *e = events_of(TWO_GATES FORCED("0 300 5.6m 300 5.601m 1 9.999m 1 10.001m -1 10.01m -300 "
                                       "19.99m -300 20.01m 300 21m 300 21.001m 1",
                                       "0 0 5.6m 0 5.61m 10 8m 10 10m 0 21m 0 21.01m 10"),
                      PART("triac", ""), SHORT_PULSES);
  CLOSE(event_s(e, "t fires without a gate pulse (unintended firing)"), 21e-3, 1e-3);
  CU_ASSERT_PTR_NULL(strstr(e, "commutation"));
  free(e);
}

/* It blocks in the second half cycle, whose pulse begins at 15.556 ms and ends 1 ms later; in the
 * first one it is fired at 3 ms, before any pulse. */
static void disobeys(void) {
  char *e = events_of(TWO_GATES FORCED("0 300 3m 300 3.001m 1 9.999m 1 10.001m -1 10.01m -300",
                                       "0 0 3m 0 3.01m 10 8m 10 10m 0"),
                      PART("triac", ""), SHORT_PULSES);
  CLOSE(event_s(e, "t fires without a gate pulse (unintended firing)"), 3e-3, 1e-3);
  CLOSE(event_s(e, "t misfires"), 16.556e-3, 1e-4);
  CU_ASSERT_PTR_NULL(strstr(e, "commutation"));
  CU_ASSERT_PTR_NULL(strstr(e, "fires (negative"));
  free(e);
}

/* What import makes of KiCad's triac: its gate has two ports, and both of its half cycles show. */
static void an_imported_triac(void) {
  ran r = run("import triac_kicad.cir --mains V1 --gate V3 --coil L1+R4 -o t.cir --scene t.yaml "
              "--quiet");
  EXPECT(r.status == 0, "%s", r.err);
  free_ran(&r);
  char *deck = read_file("t.cir");
  CU_ASSERT_PTR_NOT_NULL(strstr(deck, "*$ device triac triac gate gate+180deg = "));
  RUN_GOOD("run t.yaml --set run.until=30ms --set run.verify=never --quiet -o out");
  char *e = read_file("out/events.csv");
  /* its gate's edge is 1 us long */
  CLOSE(event_s(e, "triac fires (positive half cycle)"), 5.5e-3, 1e-3);
  CLOSE(event_s(e, "triac fires (negative half cycle)"), 15.5e-3, 1e-3);
  CU_ASSERT(event_s(e, "triac extinct (positive half cycle)") < 15e-3);
  CU_ASSERT(event_s(e, "triac extinct (negative half cycle)") < 25e-3);
  CU_ASSERT_PTR_NULL(strstr(e, "without a gate pulse"));
  CU_ASSERT_PTR_NULL(strstr(e, "misfires"));
  free(e);
  /* a tenth of the second pulse is not enough */
  char *weak = strstr(deck, "Vgate2_v3 v3_on2 0 external");
  vs_text text = {0};
  CU_ASSERT_PTR_NOT_NULL_FATAL(weak);
  vs_text_add(&text, "%.*sE2 v3_on2 0 v3_whole 0 0.1\nVgate2_v3 v3_whole 0 external%s",
              (int)(weak - deck), deck, weak + strlen("Vgate2_v3 v3_on2 0 external"));
  write_file("t.cir", text.text);
  RUN_GOOD("run t.yaml --set run.until=30ms --set run.verify=never --quiet -o weak --set "
           "'expect=[triac misfires]'");
  e = read_file("weak/events.csv");
  CLOSE(event_s(e, "triac misfires"), 16.501e-3, 1e-4);
  CU_ASSERT_PTR_NULL(strstr(e, "negative half cycle"));
  free(e);
  vs_text_free(&text);
  free(deck);
}

/* ---- fuses ---- */

#define FUSE(ohm)                                                                                  \
  "*$ param f = fuse part\n*$ device f = v(a,b), i(Vf)\nVs s 0 PWL(0 0 1u 600 20m 600)\n"          \
  "Rs s a " ohm "\nVf a x 0\nXf x b f\nRb b 0 1m\n" ASIDE

/* 600 V through some 6 ohm melt the fuse of 5 A2.s and 13 A at t = -tau ln(1 - (13 A/I)^2), tau =
 * 5 A2.s/(13 A)^2; I is 100 A. The arc's 1100 V then take the current away. 1e-2 is what the part's
 * head says of its instant. */
static void a_fuse(void) {
  char *e = events_of(FUSE("5.959"), "", "--set run.until=5ms");
  double tau = 5.0 / 169, melts = -tau * log1p(-169.0 / 1e4);
  CLOSE(event_s(e, "f melts"), melts, 1e-2);
  CU_ASSERT(event_s(e, "f has cleared") > event_s(e, "f melts"));
  CU_ASSERT(event_s(e, "f has cleared") < event_s(e, "f melts") + 0.5e-3);
  free(e);
  /* 1 kA, of which the source's rise within 1 us is to bring a third as much as a whole one */
  e = events_of(FUSE("0.559"), "", "--set run.until=5ms");
  CLOSE(event_s(e, "f melts"), 5e-6 + 2e-6 / 3, 2e-2);
  free(e);
  e = events_of(FUSE("60"), "", "--set run.until=5ms");
  EXPECT(!strstr(e, "f "), "%s", e); /* 10 A it bears */
  free(e);
}

/* ---- ports that a device names ---- */

static void ports(void) {
  static const struct {
    const char *device, *kind, *says;
  } ROWS[] = {
      {"*$ device t gate = v(a), v(a)\n", "diode", "d.cir:4:13: device t: a diode has no gate"},
      {"*$ device t gate+90deg = v(a), v(a)\n", "igbt", "device t: the deck has no such port"},
      {"*$ device t gate gate+90deg = v(a), v(a)\n", "triac", "d.cir:4:18: device t: the deck has"},
      {"*$ device t gate gate gate gate gate = v(a), v(a)\n", "triac", "d.cir:4:33: 'device NAME"},
      {"*$ device t gate = v(a), v(a)\n", "mosfet", NULL},
      {"*$ device t burst = v(a), v(a)\n", "triac", NULL},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char deck[400], part[200];
    snprintf(deck, sizeof deck,
             "*$ param t = p part\n*$ port mains = Vm\n*$ port gate = Vg\n%s"
             "Vm a 0 external\nVg g 0 external\n" ASIDE,
             ROWS[k].device);
    snprintf(part, sizeof part, "*$ part %s \"P\"\n.subckt p a b\nR1 a b 1meg\n.ends\n",
             ROWS[k].kind);
    write_file("d.cir", deck);
    write_file("p.inc", part);
    ran r = run("check d.cir");
    EXPECT(ROWS[k].says ? r.status == 2 && strstr(r.err, ROWS[k].says) : r.status == 0,
           "row %zu, %d: %s%s", k, r.status, r.out, r.err);
    free_ran(&r);
  }
}

/* ---- docs/devices.md ---- */

static bool has_row(const char *section, const char *name, const char *limit) {
  char measure[80], held[80];
  snprintf(measure, sizeof measure, "`%s`", name);
  snprintf(held, sizeof held, "`%s`", limit ? limit : "");
  for (const char *line = section; line && strncmp(line, "\n## ", 4);
       line = strchr(line + 1, '\n')) {
    size_t n = strcspn(line + 1, "\n") + 1;
    vs_text row = {0};
    vs_text_add(&row, "%.*s", (int)n, line);
    const char *last = strrchr(row.text, '`');
    bool good = row.text[1] == '|' && strstr(row.text, measure) &&
                (limit ? strstr(strstr(row.text, measure) + 1, held) != NULL : last != NULL);
    vs_text_free(&row);
    if (good) return true;
  }
  return false;
}

/* Each measure of these kinds stands in the page, with its limit. */
static void the_page(void) {
  static const struct {
    const char *kind, *head;
  } ROWS[] = {{"thyristor", "\n## Semiconductors"},
              {"triac", "\n## Semiconductors"},
              {"diode", "\n## Semiconductors"},
              {"mosfet", "\n## Semiconductors"},
              {"diac", "\n## Semiconductors"},
              {"igbt", "\n## Semiconductors"},
              {"varistor", "\n## Passive parts"},
              {"zener", "\n## Passive parts"},
              {"tvs", "\n## Passive parts"},
              {"resistor", "\n## Passive parts"},
              {"capacitor", "\n## Passive parts"},
              {"electrolytic", "\n## Passive parts"},
              {"fuse", "\n## Fuses"}};
  char *text = read_file(VS_TEST_FOLDER "/../docs/devices.md");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    const char *section = strstr(text, ROWS[k].head);
    const vs_kind *kind = vs_kinds_find(ROWS[k].kind);
    CU_ASSERT_FATAL(section && kind);
    for (size_t n = 0; n < kind->n_measures; n++)
      EXPECT(has_row(strchr(section + 1, '\n'), kind->measures[n].name, kind->measures[n].limit),
             "%s.%s, limit %s", kind->name, kind->measures[n].name, kind->measures[n].limit);
  }
  free(text);
}

/* ---- rows ---- */

static const vs_kind_limit *limit_named(const vs_kind *kind, const char *name) {
  for (size_t k = 0; k < kind->n_limits; k++)
    if (!strcmp(kind->limits[k].name, name)) return &kind->limits[k];
  return NULL;
}

static bool is_in_a_ratio(const vs_kind *kind, const char *limit) {
  for (int k = 0; k < VS_KIND_RATIOS && kind->ratios[k].more; k++)
    if (!strcmp(kind->ratios[k].more, limit)) return true;
  return false;
}

/* What decides is looked at by `check` of the part: it has a range, or stands beside another limit.
 * No range is known of a varistor's mean power; i2t has to fit the peak of a half sine. */
static void limits_are_whole(const vs_kind *kind) {
  for (size_t k = 0; k < kind->n_limits; k++) {
    const vs_kind_limit *l = &kind->limits[k];
    const bool ranged = l->most > 0;
    EXPECT(!*l->unit || vs_units_known(l->unit), "%s: %s in %s", kind->name, l->name, l->unit);
    EXPECT(limit_named(kind, l->name) == l, "%s: %s stands twice", kind->name, l->name);
    EXPECT(!ranged || (l->least > 0 && l->least < l->most), "%s: %s", kind->name, l->name);
    EXPECT(ranged || !(l->is & (VS_LIMIT_PARAM | VS_LIMIT_TWIN)), "%s: %s", kind->name, l->name);
    EXPECT(l->param || !(l->is & VS_LIMIT_TWIN), "%s: %s", kind->name, l->name);
    EXPECT(!(l->is & VS_LIMIT_DECIDES) || ranged || is_in_a_ratio(kind, l->name) ||
               !strcmp(l->name, "i2t") || !strcmp(l->name, "p_max"),
           "%s: nothing says what is usual of %s", kind->name, l->name);
    char *words = vs_copy(l->hang), *rest = words;
    for (char *word; (word = strsep(&rest, " "));) {
      bool there = !*word;
      for (size_t n = 0; n < kind->n_measures; n++)
        there = there || !strcmp(kind->measures[n].name, word);
      EXPECT(there, "%s: %s hangs on %s and is no measure", kind->name, word, l->name);
    }
    free(words);
  }
  for (int k = 0; k < VS_KIND_RATIOS && kind->ratios[k].more; k++) {
    const vs_kind_ratio *r = &kind->ratios[k];
    EXPECT(limit_named(kind, r->more) && limit_named(kind, r->less), "%s: %s", kind->name, r->more);
    EXPECT(r->refused || (r->least > 0 && r->least < r->most), "%s: %s", kind->name, r->more);
  }
}

static void measures_are_whole(const vs_kind *kind) {
  bool heats = false;
  for (size_t k = 0; k < kind->n_measures; k++) {
    const vs_device_measure *m = &kind->measures[k];
    const vs_kind_limit *l = m->limit ? limit_named(kind, m->limit) : NULL;
    heats = heats || m->how == VS_R_JUNCTION;
    if (!m->limit || m->held == VS_WARD_AT_MOST) continue;
    EXPECT(l && vs_units_same_kind(l->unit, m->unit), "%s.%s: limit %s", kind->name, m->name,
           m->limit);
  }
  EXPECT(heats == (kind->heat.current != NULL), "%s: a junction", kind->name);
  EXPECT(!heats || limit_named(kind, kind->heat.current), "%s: %s", kind->name, kind->heat.current);
}

/* The pins are those of the part that its template makes, which the test stand can try. */
static void pins_are_whole(const vs_kind *kind) {
  vs_text head = {0};
  const int pins = vs_kinds_count_pins(kind);
  CU_ASSERT_EQUAL(pins, (kind->switches && kind->gated) || kind->driven ? 3 : 2);
  for (int role = 0; role < pins; role++)
    EXPECT(vs_kinds_pin(kind, role) >= 0, "%s has no pin of role %d", kind->name, role);
  vs_text_add(&head, "\n.subckt own");
  for (int k = 0; k < pins; k++) {
    const char *node = kind->pins[k].node;
    vs_text_add(&head, " %s", node);
    EXPECT(!kind->letters || kind->letters[k] == node[strlen(node) - 1], "%s: %s", kind->name,
           node);
    EXPECT(!kind->letters == !kind->pins[k].words, "%s: %s", kind->name, node);
  }
  vs_text_add(&head, "\n");
  ran r = run("part %s -o own.inc --overwrite --quiet", kind->name);
  expect_good(&r, kind->name, __LINE__);
  char *text = read_file("own.inc");
  EXPECT(strstr(text, head.text), "%s: %s", kind->name, head.text);
  free(text);
  free_ran(&r);
  r = run("check own.inc");
  EXPECT(strstr(r.out, "figure ") && !strstr(r.out, "no bench"), "%s: %s", kind->name, r.out);
  free_ran(&r);
  vs_text_free(&head);
}

/* A gate drive is another's circuit: it has no template, and pins of its own. */
static void each_row_is_whole(void) {
  for (const vs_kind *kind = vs_kinds_all; kind->name; kind++) {
    limits_are_whole(kind);
    measures_are_whole(kind);
    if (!kind->gated || kind->switches) pins_are_whole(kind);
  }
}

static const vs_test TESTS[] = {
    {"hard switching", hard_switching},
    {"low voltage", low_voltage},
    {"recovery", recovery},
    {"a mosfet", a_mosfet},
    {"signs", signs},
    {"an igbt and its limits", an_igbt_and_its_limits},
    {"a diode", a_diode},
    {"an electrolytic", an_electrolytic},
    {"a triac both ways", a_triac_both_ways},
    {"a triac commutates", a_triac_commutates},
    {"fails to commutate", fails_to_commutate},
    {"a current before its half cycle", a_current_before_its_half_cycle},
    {"fires long behind a conduction", fires_long_behind_a_conduction},
    {"fires a half cycle later", fires_a_half_cycle_later},
    {"disobeys", disobeys},
    {"an imported triac", an_imported_triac},
    {"a fuse", a_fuse},
    {"ports", ports},
    {"the page", the_page},
    {"each row is whole", each_row_is_whole},
};
int main(void) {
  return program_suite("kinds", TESTS, COUNT(TESTS));
}
