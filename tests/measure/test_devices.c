/* SPDX-License-Identifier: GPL-3.0-or-later
 * What devices are measured for, against closed forms of currents and voltages that sources force
 * on them; the verdict on their limits; and what a thyristor does against its gate. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "measure/verdict.h"
#include "program.h"

/* The EVA stands aside; device t is a part p unless a deck says otherwise. */
#define ASIDE "Re e 0 1\nXeva e 0 eva\n"
#define PARTED "*$ param t = p part\n"
#define PART(lines)                                                                                \
  "*$ part thyristor \"P\"\n" lines ".subckt p a k g\nR1 a k 1meg\nR2 g k 1k\n.ends\n"
static const char ANY_PART[] = PART("");

static vs_trial *run_deck(const char *deck, const char *part, const char *until, const char *step) {
  char sets[3][64];
  write_file("p.inc", part);
  write_file("d.cir", deck);
  snprintf(sets[0], sizeof sets[0], "circuit.deck=d.cir");
  snprintf(sets[1], sizeof sets[1], "run.until=%s", until);
  snprintf(sets[2], sizeof sets[2], "run.max_step=%s", step);
  vs_trial *t =
      vs_trial_run("paper", "circuit", (const char *[]){sets[0], sets[1], sets[2], NULL}, NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  return t;
}

static const vs_reduced *measure(const vs_trial *t, const char *device, const char *what) {
  static const vs_reduced NONE = {.value = {false, NAN, NAN}, .failed_s = NAN};
  for (size_t k = 0; t->result.watchers.devices && k < t->result.watchers.devices->count; k++)
    for (size_t n = 0; n < t->result.watchers.devices->item[k].count; n++) {
      const vs_watched *w = &t->result.watchers.devices->item[k];
      if (!strcmp(w->device->name, device) && !strcmp(w->reduced[n].measure->name, what))
        return &w->reduced[n];
    }
  EXPECT(false, "no measure %s.%s", device, what);
  return &NONE;
}

static void close_to(const vs_trial *t, const char *device, const char *what, double expected,
                     double tolerance, int line) {
  const vs_reduced *r = measure(t, device, what);
  expect(r->value.known && fabs(r->value.value - expected) <= tolerance * fabs(expected), line,
         "%s.%s = %.9g, expected %.9g", device, what, r->value.known ? r->value.value : NAN,
         expected);
}
#define MEASURES(t, device, what, expected, tolerance)                                             \
  close_to(t, device, what, expected, tolerance, __LINE__)

/* ---- closed forms ---- */

/* Half sines of 100 A, 10 ms and of 50 A, 4 ms in 1 ohm: int i^2 dt = I^2 t_p/2 = 50 and 5 A2.s.
 * Chords of 10 us over them are off by (w h)^2/6 = 1e-5 in i^2; 1e-4. */
#define SINES                                                                                      \
  "Bs 0 y I = 100*sin(314.159265359*time)*(time<10m) + "                                           \
  "50*sin(785.398163397*(time-20m))*(time>20m)*(time<24m)\nVs y x 0\nRx x 0 1\n" ASIDE
static const char SINE_DEVICES[] =
    PARTED "*$ probe v_x = v(x) V\n*$ rating v_x -200..60 V\n"
           "*$ device f fuse = v(x), i(Vs)\n*$ device t = v(x), i(Vs)\n" SINES;

static void half_sines(void) {
  vs_trial *t = run_deck(SINE_DEVICES, ANY_PART, "40ms", "10us");
  MEASURES(t, "f", "i2t", 55, 1e-4);
  MEASURES(t, "t", "i2t", 50, 1e-4);
  CLOSE(measure(t, "t", "i2t")->value.at_s, 10e-3, 2e-3); /* its last step but one */
  MEASURES(t, "f", "i_peak", 100, 1e-5);
  MEASURES(t, "f", "v_peak", 100, 1e-5);
  MEASURES(t, "f", "i_rms", sqrt(55 / 40e-3), 1e-4);
  MEASURES(t, "t", "i_peak", 100, 1e-5);
  CLOSE(measure(t, "t", "i_peak")->value.at_s, 5e-3, 2e-3); /* within a step */
  MEASURES(t, "t", "i_surge", 100, 1e-4);
  MEASURES(t, "t", "i_mean", 2 / M_PI * (100 * 10e-3 + 50 * 4e-3) / 40e-3, 1e-4);
  MEASURES(t, "t", "i_rms", sqrt(55 / 40e-3), 1e-4);
  MEASURES(t, "t", "loss", 55, 1e-4);
  MEASURES(t, "t", "di_dt", 50 * 785.398, 1e-3); /* I w of the second, over its first steps */
  CU_ASSERT_FALSE(measure(t, "t", "t_j_rise")->value.known);
  CU_ASSERT_FALSE(measure(t, "t", "misfires")->value.known); /* no port, no gate */
  vs_trial_free(t);
}

/* I_TSM is the peak of a half sine of 10 ms; what is shorter is told as the one with its int i^2
 * dt. Here 5 A2.s of 50 A for 4 ms, twice 10 ms apart: alone; then two of 50 A for 2 ms, 3 ms
 * apart, are one; then 20 A all the time; then of 30 A for 14 ms its middle, 5 ms + 7 ms/pi
 * sin(2 pi/7) of I^2. Chords are off by 1e-5, and the rest of a quarter of a millisecond's part by
 * 1e-4 where the current flows on. */
static void surge_currents(void) {
  static const char DECK[] = PARTED "*$ device t = v(x), i(Vs)\n*$ device f fuse = v(x), i(Vs)\n"
                                    "Bs 0 y I = %s\nVs y x 0\nRx x 0 1\n" ASIDE;
  static const struct {
    const char *current;
    double a2s;
  } ROWS[] = {{"50*sin(785.398163397*time)*(time<4m)+50*sin(785.398163397*(time-15m))*(time>15m)"
               "*(time<19m)",
               5},
              {"50*sin(1570.79632679*time)*(time<2m)+50*sin(1570.79632679*(time-5m))*(time>5m)"
               "*(time<7m)",
               5},
              {"20", 4},
              {"30*sin(224.399475256*time)*(time<14m)", 6.067848}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char deck[800];
    snprintf(deck, sizeof deck, DECK, ROWS[k].current);
    vs_trial *t = run_deck(deck, PART("*$ limit i_tsm = 30 A\n"), "30ms", "10us");
    double peak = sqrt(2 * ROWS[k].a2s / 10e-3), got = measure(t, "t", "i_surge")->value.value;
    CLOSE(got, peak, 2e-4);
    MEASURES(t, "f", "let_through", ROWS[k].a2s, 4e-4);
    CU_ASSERT_PTR_NULL(measure(t, "t", "i_peak")->limit);
    CU_ASSERT_PTR_NOT_NULL(measure(t, "t", "i_surge")->limit);
    vs_trial_free(t);
  }
}

/* 20 A all the time, where 12 A are allowed for ever: judged once the run is a second long, and
 * then passed at its end. */
static void continuous_current(void) {
  static const char *const UNTIL[] = {"0.99 s", "1 s"};
  for (int k = 0; k < 2; k++) {
    vs_trial *t =
        run_deck(PARTED "*$ device t = v(x), i(Vs)\nIs 0 y 20\nVs y x 0\nRx x 0 1\n" ASIDE,
                 PART("*$ limit i_t_rms = 12 A\n"), UNTIL[k], "1ms");
    MEASURES(t, "t", "i_rms", 20, 1e-6);
    const vs_reduced *r = measure(t, "t", "i_rms");
    CU_ASSERT_EQUAL(r->limit != NULL, k == 1);
    if (k) CLOSE(r->failed_s, 1, 1e-9);
    vs_verdict v;
    vs_verdict_make(t->result.watchers.measures, t->result.watchers.devices, NULL, &v);
    CU_ASSERT_EQUAL(v.first_to_fail != NULL, k == 1);
    if (k && v.first_to_fail) CLOSE(v.first_to_fail->margin, -8.0 / 12, 1e-6);
    vs_verdict_free(&v);
    vs_trial_free(t);
  }
}

/* Forward voltage: a ramp of 180 V in 1 us with a tail of 20 V in 100 us, down in 1 us, up to 200 V
 * by 1 kohm and 10 nF. A ramp's mean rate is its rate; an exponential's is the largest over its
 * first volts, over/(-tau ln(1 - over/V)), and over 0.1 us V/0.1us (1 - exp(-0.1us/tau)). Chords of
 * 50 ns make 2e-4 of it. The stretch is 10 V where nothing is known of the part. */
static void voltage_rises(void) {
  vs_trial *t = run_deck(
      PARTED
      "*$ device t = v(r), i(Vt)\n*$ device c1 capacitor = v(r), i(Vt)\n"
      "Vr r 0 PWL(0 0 20u 0 21u 180 121u 200 130u 200 132u 0)\nVt r d 0\nRt d 0 1meg\n" ASIDE,
      ANY_PART, "150us", "50ns");
  MEASURES(t, "t", "dv_dt", 180e6, 1e-6);
  CLOSE(measure(t, "t", "dv_dt")->value.at_s, 20e-6, 1e-2);
  CLOSE(measure(t, "t", "dv_dt")->over_v, 10, 1e-12);
  MEASURES(t, "t", "dv_dt_max", 180e6, 1e-6);
  MEASURES(t, "t", "v_forward", 200, 1e-9);
  MEASURES(t, "t", "v_reverse", 0, 1e-9);
  MEASURES(t, "c1", "dv_dt_max", 180e6, 1e-6);
  vs_trial_free(t);
  static const struct {
    const char *part;
    double over_v;
  } ROWS[] = {{PART(""), 10},
              {PART("*$ limit v_drm = none\n"), 10},
              {PART("*$ limit v_drm = 750 V\n"), 75},
              {PART("*$ limit v_drm = 60 V\n"), 10},
              {PART("*$ limit dv_dt_over = 0.3 kV\n"), 300},
              {PART("*$ limit dv_dt_over = 10 V\n*$ limit v_drm = 750 V\n"), 10},
              {PART("*$ limit v_drm = 800 V\n*$ limit dv_dt_over = 480 V\n"), 480}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    t = run_deck(PARTED "*$ device t = v(c), i(Vt)\n"
                        "Vp p 0 PULSE(0 500 20u 1n 1n 200u)\nRp p c 1k\nCp c 0 10n ic=0\n"
                        "Vt c d 0\nRt d 0 1g\n" ASIDE,
                 ROWS[k].part, "300us", "50ns");
    MEASURES(t, "t", "dv_dt", ROWS[k].over_v / (-10e-6 * log1p(-ROWS[k].over_v / 500)), 4e-4);
    CLOSE(measure(t, "t", "dv_dt")->over_v, ROWS[k].over_v, 1e-12);
    MEASURES(t, "t", "dv_dt_max", 500 / 0.1e-6 * -expm1(-0.1 / 10), 1e-3);
    vs_trial_free(t);
  }
}

/* 1 kA of 8/20 us, by its closed form a t^3 exp(-t/3.911 us): charge 6 a tau^4 = 17.449 uC per A,
 * int i^2 dt 720 a^2 (tau/2)^7 = 12.164 us I^2. A per cent is asked; this is good to 1e-3. */
static void impulse_8_20(void) {
  vs_trial *t = run_deck(PARTED "*$ device t = v(x), i(Vs)\n*$ device f fuse = v(x), i(Vs)\n"
                                "*$ device v1 varistor = 100, i(Vs)\n"
                                "Bs 0 y I = 1000*0.01243*(1meg*time)^3*exp(-time/3.911u)\n"
                                "Vs y x 0\nRx x 0 1\n" ASIDE,
                         ANY_PART, "100us", "100ns");
  MEASURES(t, "t", "i_peak", 1000, 1e-3);
  MEASURES(t, "t", "i_mean", 17.449e-3 / 100e-6, 1e-3);
  MEASURES(t, "v1", "energy", 100 * 17.449e-3, 1e-3);
  MEASURES(t, "f", "i2t", 12.164, 1e-3);
  MEASURES(t, "t", "i2t", 12.164, 1e-3);
  MEASURES(t, "t", "i_surge", sqrt(2 * 12.164 / 10e-3), 1e-3); /* of 1000 A, 49 A */
  vs_trial_free(t);
}

/* Straight across 100 V at 50 Hz: R = 100 ohm, P = V^2/2R; C = 10 uF, I = w C V. */
static void resistor_and_capacitor(void) {
  const double w = 100 * M_PI, c = 10e-6;
  vs_trial *t = run_deck("*$ device r1 resistor = v(s), v(s)/100\n"
                         "*$ device c1 capacitor = v(s), i(Vc)\n"
                         "V1 s 0 SIN(0 100 50)\nR1 s 0 100\nVc s d 0\nC1 d 0 10u ic=0\n" ASIDE,
                         ANY_PART, "40ms", "10us");
  MEASURES(t, "r1", "power", 50, 1e-4);
  MEASURES(t, "r1", "power_peak", 100, 1e-5);
  MEASURES(t, "r1", "energy", 2, 1e-4);
  MEASURES(t, "c1", "v_peak", 100, 1e-5);
  MEASURES(t, "c1", "i_rms", w * c * 100 / M_SQRT2, 1e-3);
  MEASURES(t, "c1", "i_peak", w * c * 100, 1e-3);
  MEASURES(t, "c1", "dv_dt_max", w * 100, 1e-3);
  vs_trial_free(t);
}

/* int sin^n over one half sine of that length */
static double half_sine(double n, double length_s) {
  return length_s / sqrt(M_PI) * tgamma((n + 1) / 2) / tgamma(n / 2 + 1);
}

/* v = 910 V (i/1 mA)^(1/30) under half sines of 100 A and -50 A, 20 us long: the energy of each is
 * int v i. They are 20 us apart, and so one pulse. */
static void varistor_pulses(void) {
  vs_trial *t = run_deck("*$ device v1 varistor = 910*pwr(i(Vs)/1m,1/30), i(Vs)\n"
                         "Bs 0 y I = 100*sin(157079.632679*time)*(time<20u) - "
                         "50*sin(157079.632679*(time-40u))*(time>40u)*(time<60u)\n"
                         "Vs y x 0\nRx x 0 1\n" ASIDE,
                         ANY_PART, "100us", "50ns");
  double clamp = 910 * pow(100 / 1e-3, 1.0 / 30), one = clamp * 100 * half_sine(31.0 / 30, 20e-6);
  MEASURES(t, "v1", "v_clamp", clamp, 1e-5);
  MEASURES(t, "v1", "i_peak", 100, 1e-4);
  double both = one * (1 + pow(0.5, 31.0 / 30));
  MEASURES(t, "v1", "energy", both, 1e-3); /* which begins within a step, at 1 mA */
  MEASURES(t, "v1", "energy_total", both, 1e-3);
  vs_trial_free(t);
}

/* A pulse goes on above 1 mA, and for 5 ms: 10 A for 10 us, then again behind 6 ms with 2 mA (12 %
 * more) and behind 4 ms with 0.5 mA, then once more behind 6 ms with 0.5 mA; at 100 V, with edges
 * of 0.1 us. */
static void pulses_end_at_1_ma(void) {
  vs_trial *t = run_deck("*$ device v1 varistor = 100, i(Vs)\n"
                         "Is 0 y PWL(0 0 10u 0 10.1u 10 20u 10 20.1u 2m 6m 2m 6.0001m 10 6.01m 10 "
                         "6.0101m 0.5m 10m 0.5m 10.0001m 10 10.01m 10 10.0101m 0.5m 16m 0.5m "
                         "16.0001m 10 16.01m 10 16.0101m 0)\nVs y x 0\nRx x 0 1\n" ASIDE,
                         ANY_PART, "17ms", "10us");
  double one = 100 * 10 * 10e-6, low = 100 * (2e-3 * 5.98e-3 + 0.5e-3 * 3.99e-3);
  MEASURES(t, "v1", "energy", 3 * one + low + 100 * 0.5e-3 * 5e-3, 1e-3);
  MEASURES(t, "v1", "energy_total", 4 * one + low + 100 * 0.5e-3 * 5.99e-3, 1e-3);
  vs_trial_free(t);
}

/* 100 W for 10 ms into 0.5 K/W with 1 ms and 1 K/W with 20 ms; 1e-4: the edges of 1 us. */
static void junction_temperature(void) {
  vs_trial *t = run_deck(PARTED "*$ device t = v(x), i(Vs)\n"
                                "Is 0 y PWL(0 0 1m 0 1.001m 10 11m 10 11.001m 0)\nVs y x 0\n"
                                "Rx x 0 1\n" ASIDE,
                         PART("*$ zth 0.5 K/W 1 ms\n*$ zth 1 K/W 20 ms assumed \"x\"\n"
                              "*$ limit t_j_rise = 50 K\n"),
                         "30ms", "20us");
  double rise = 100 * (0.5 * -expm1(-10) + 1 * -expm1(-0.5));
  MEASURES(t, "t", "t_j_rise", rise, 2e-4);
  CLOSE(measure(t, "t", "t_j_rise")->value.at_s, 11e-3, 2e-4);
  /* 50 (1 - exp(-s/1 ms)) + 100 (1 - exp(-s/20 ms)) = 50 */
  double at = measure(t, "t", "t_j_rise")->failed_s - 1e-3;
  CLOSE(50 * -expm1(-at / 1e-3) + 100 * -expm1(-at / 20e-3), 50, 1e-3);
  vs_trial_free(t);
}

/* A part of a maker's: its terms add up to what the sheet says, and give the rise behind 10 ms of
 * 100 W. */
static void junctions_of_parts(void) {
  static const struct {
    const char *part;
    double k_per_w;
  } ROWS[] = {{"TYN1212", 3.8}, {"TYN1012", 1.3}, {"BT151-800R", 1.3}, {"12TTS08S", 1.8}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char deck[600];
    snprintf(deck, sizeof deck,
             "*$ param t = %s part\n*$ device t = v(x), i(Vs)\n"
             "Is 0 y PWL(0 0 1m 0 1.001m 10 11m 10 11.001m 0)\nVs y x 0\nRx x 0 1\n" ASIDE,
             ROWS[k].part);
    vs_trial *t = run_deck(deck, ANY_PART, "12ms", "20us");
    const vs_deck *d = &t->scene.setup.deck;
    double sum = 0, rise = 0;
    for (size_t n = 0; n < d->n_zth; n++) {
      sum += d->zth[n].k_per_w;
      rise += 100 * d->zth[n].k_per_w * -expm1(-10e-3 / d->zth[n].tau_s);
      CU_ASSERT(d->zth[n].unsure == VS_ASSUMED);
    }
    CLOSE(sum, ROWS[k].k_per_w, 1e-9);
    MEASURES(t, "t", "t_j_rise", rise, 2e-4);
    vs_trial_free(t);
  }
}

/* The current ends at 110 us, forward voltage is back at 160 us: 50 us of rest. Then once more with
 * 30 us, which is less than t_q. */
#define REST                                                                                       \
  "*$ device t = v(x), i(Vs)\n"                                                                    \
  "Is 0 y PWL(0 0 1u 10 100u 10 110u 0 200u 0 201u 10 300u 10 310u 0)\nVs y z 0\nRz z 0 1\n"       \
  "Vx x 0 PWL(0 0 1u 1 108u 1 110u -100 150u -100 170u 100 180u 100 200u 0 201u 1 308u 1 310u "    \
  "-100 330u -100 350u 100)\n" ASIDE
static void time_to_rest(void) {
  vs_trial *t = run_deck(PARTED REST, PART("*$ limit t_q = 40 us assumed \"x\"\n"), "400us", "1us");
  MEASURES(t, "t", "t_off", 30e-6, 1e-3);
  CLOSE(measure(t, "t", "t_off")->value.at_s, 340e-6, 1e-4);
  CLOSE(measure(t, "t", "t_off")->failed_s, 340e-6, 1e-4);
  vs_verdict *v = vs_alloc(1, sizeof *v);
  vs_verdict_make(t->result.watchers.measures, t->result.watchers.devices, NULL, v);
  size_t k = 0;
  while (k < v->count && !v->item[k].limit) k++; /* the part states no other limit */
  CU_ASSERT_FATAL(k < v->count);
  CLOSE(v->item[k].margin, -0.25, 1e-3);
  CU_ASSERT_PTR_EQUAL(v->first_to_fail, &v->item[k]);
  vs_verdict_free(v);
  free(v);
  vs_trial_free(t);
}

/* The least of the gate pulses' peaks; the last pulse has not ended and does not count. */
static void gate_currents(void) {
  write_file("p.inc", ANY_PART);
  write_file("d.cir", "*$ port gate = Vg\n*$ device g1 gate_drive = v(y), i(Vs), -1m*v(y)\n"
                      "Vg g 0 external\n"
                      "Bs 0 y I = v(g)*(time<20m ? 0.5 : time<40m ? 0.3 : 0.1)\n"
                      "Vs y x 0\nRx x 0 1\n" ASIDE);
  vs_trial *t = vs_trial_run("paper", "circuit",
                             (const char *[]){"circuit.deck=d.cir", "run.until=47ms",
                                              "firing.every=1", "firing.pulse_width=2ms", NULL},
                             NULL);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  MEASURES(t, "g1", "i_peak", 0.5, 1e-6);
  MEASURES(t, "g1", "i_min", 0.3, 1e-6);
  MEASURES(t, "g1", "volt_seconds", 0.5e-3, 1e-6);
  vs_trial_free(t);
}

/* One sub-pulse of 60 us: the core's flux linkage is the integral of the voltage at its winding,
 * which is told by the energy of 1 A there. Twice as long uses up what the part has. */
static void volt_seconds(void) {
  write_file("d.cir", "*$ param gate_drive = gate_pulse_transformer part\n*$ port gate = Vg\n"
                      "*$ port burst = Vb\n*$ device gate_drive = v(g), v(g)/20, v(xd.flux)\n"
                      "*$ device r1 resistor = v(xd.x1.p), 1\nVg w 0 external\nVb b 0 external\n"
                      "Xd w b g 0 gate_drive\nRg g 0 20\n" ASIDE);
  static const struct {
    const char *until, *duty;
    bool used_up;
  } ROWS[] = {{"run.until=5.6155 ms", "firing.burst_duty=30 %", false},
              {"run.until=5.6755 ms", "firing.burst_duty=60 %", true}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_trial *t = vs_trial_run("paper", "circuit",
                               (const char *[]){"circuit.deck=d.cir", "run.tolerance=1e-6",
                                                ROWS[k].until, ROWS[k].duty, NULL},
                               NULL);
    EXPECT(t->status == VS_OK, "%s", t->err.text);
    MEASURES(t, "gate_drive", "volt_seconds", measure(t, "r1", "energy")->value.value, 2e-3);
    const vs_reduced *r = measure(t, "gate_drive", "volt_seconds");
    CU_ASSERT(r->value.value > 1e-3 && r->limit && !isnan(r->failed_s) == ROWS[k].used_up);
    vs_trial_free(t);
  }
}

/* ---- verdict ---- */

static ran run_sines(const char *limits) {
  vs_text part = {0};
  vs_text_add(&part, "*$ part thyristor \"P\"\n%s.subckt p a k g\nR1 a k 1meg\n.ends\n", limits);
  write_file("p.inc", part.text);
  vs_text_free(&part);
  write_file("d.cir", SINE_DEVICES);
  return run("run paper --set circuit.deck=d.cir --set run.until=40ms --set run.max_step=10us "
             "--json --quiet --reproducible");
}

/* The number behind a word, from where `begin` first stands on. */
static double number_behind(const char *text, const char *begin, const char *word) {
  const char *at = strstr(text, begin);
  at = at ? strstr(at, word) : NULL;
  return at ? strtod(at + strlen(word), NULL) : NAN;
}

/* The rating is passed first, at asin(60/100)/w = 2.048 ms; the i2t of 25 A2.s at 5 ms, where the
 * half sine has its half: that one is exceeded most; the i_tsm of 80 A at the 32 A2.s of its own
 * half sine. */
static void verdicts(void) {
  ran r = run_sines("*$ limit i_tsm = 0.08 kA\n*$ limit i2t = 25 A2.s assumed \"guessed\"\n"
                    "*$ limit v_drm = none\n*$ limit t_q = 1 us\n");
  CU_ASSERT_EQUAL(r.status, 3);
  EXPECT(count_lines(r.err) == 1 &&
             strstr(r.err, "vibrospice: a rating is violated: t.i2t = 49.99") &&
             strstr(r.err, " A2.s at 0.0100") && strstr(r.err, ", allowed at most 25 A2.s\n"),
         "%s", r.err);
  EXPECT(strstr(r.out, "\"weakest\": \"t.i2t\"") && strstr(r.out, "\"first_to_fail\": \"v_x\""),
         "%s", r.out);
  EXPECT(!strstr(r.out, "\"measure\": \"v_forward\"") && !strstr(r.out, "\"measure\": \"t_off\""),
         "without a limit, or not measured: %s", r.out);
  static const char PEAK[] = "\"measure\": \"i_surge\"", I2T[] = "\"measure\": \"i2t\"";
  CLOSE(number_behind(r.out, PEAK, "\"stress\": "), 0.1, 1e-4); /* in the limit's unit */
  CLOSE(number_behind(r.out, PEAK, "\"limit\": "), 0.08, 1e-12);
  CLOSE(number_behind(r.out, PEAK, "\"margin\": "), -0.25, 1e-3);
  double at = number_behind(r.out, PEAK, "\"failed_at_s\": "), w = 100 * M_PI;
  CLOSE(1e4 * (at / 2 - sin(2 * w * at) / (4 * w)), 32, 1e-3);
  CLOSE(number_behind(r.out, I2T, "\"failed_at_s\": "), 5e-3, 1e-4);
  CLOSE(number_behind(r.out, "\"rating\"", "\"failed_at_s\": "), asin(0.6) / (100 * M_PI), 1e-4);
  CLOSE(number_behind(r.out, "\"t.i2t\"", "\"value\": "), 50, 1e-4);
  const char *peak = strstr(r.out, PEAK), *i2t = strstr(r.out, I2T);
  EXPECT(peak && strstr(peak, "\"assumed\": false") < strstr(peak, "\"margin\""), "%s", r.out);
  EXPECT(i2t && strstr(i2t, "\"guessed\"") && strstr(i2t, "\"assumed\": true"), "%s", r.out);
  free_ran(&r);
  r = run("run paper --set circuit.deck=d.cir --set run.until=40ms");
  EXPECT(strstr(r.out, "\n  t.i2t ") && strstr(r.out, "  violated  assumed\n") &&
             !strncmp(r.out, "verdict: violated\nweakest: t.i2t, ", 34) &&
             strstr(r.out, ", margin -100.0 % +- ") &&
             strstr(r.out, " %  violated\nfirst to fail: v_x, at 2.04"),
         "%s", r.out);
  free_ran(&r);
}

/* Nothing is exceeded: the weakest is named all the same. */
static void all_is_well(void) {
  ran r = run_sines("*$ limit i_tsm = 200 A\n*$ limit i2t = 400 A2.s\n");
  EXPECT(r.status == 3 && strstr(r.out, "\"first_to_fail\": \"v_x\""), "%s", r.out); /* as ever */
  free_ran(&r);
  vs_text deck = {0};
  vs_text_add(&deck, "%s", PARTED "*$ device t = v(x), i(Vs)\n" SINES);
  write_file("d.cir", deck.text);
  vs_text_free(&deck);
  r = run("run paper --set circuit.deck=d.cir --set run.until=40ms --json --quiet --set "
          "'waive=[t.v_drm, t.v_rrm, t.i_t_rms, t.dv_dt, t.di_dt]'");
  EXPECT(r.status == 0 && strstr(r.out, "\"weakest\": \"t.i_surge\"") &&
             strstr(r.out, "\"first_to_fail\": null"),
         "%s", r.out);
  free_ran(&r);
  r = run("run paper --tier switched --set run.until=10ms --json --quiet");
  EXPECT(r.status == 0 && strstr(r.out, "\"weakest\": null"), "%s", r.out);
  free_ran(&r);
}

/* ---- against its gate ---- */

static char *events_of(const char *deck, const char *part, const char *sets) {
  write_file("d.cir", deck);
  write_file("p.inc", part);
  ran r = run("run paper --set circuit.deck=d.cir --quiet -o out %s", sets);
  EXPECT(r.status == 0 || r.status == 3, "%s", r.err); /* done; a rating may well be violated */
  free_ran(&r);
  return read_file("out/events.csv");
}

static int how_often(const char *events, const char *what) {
  int n = 0;
  for (; (events = strstr(events, what)); events++) n++;
  return n;
}

/* An ideal thyristor in front of 100 ohm, fired by `gate` and told to the program with `device`. */
#define LATCH(gate, device)                                                                        \
  "*$ param p = latch part\n*$ port mains = Vm\n*$ port gate = Vg\n*$ port gate+20deg = Vh\n"      \
  "*$ device p " device " = v(a,b), i(Vt)\nVm a 0 external\nVg g b external\nVh h b external\n"    \
  "Rg g b 1k\nRh h b 1k\nVt a c 0\nXt c b " gate " p\nRl b 0 100\n" ASIDE

static void fires_out_of_turn(void) {
  char *e = events_of(LATCH("g", "gate"), ANY_PART, "--set run.until=20ms");
  EXPECT(!strstr(e, "p "), "fired by its own gate: %s", e);
  free(e);
  /* 100 degrees are 5.556 ms, 120 are 6.667 ms */
  e = events_of(LATCH("g", "gate+20deg"), ANY_PART, "--set run.until=20ms");
  CLOSE(event_s(e, "p fires without a gate pulse (unintended firing)"), 100.0 / 18000, 1e-4);
  EXPECT(count_lines(e) == 2, "%s", e);
  free(e);
}

/* Never connected: the pulse ends under forward voltage at 5.556 + 2 ms. With 8 ms it ends under
 * reverse voltage, but had forward voltage. No pulse has ended by 7 ms; at 179.5
 * degrees 5 V are left, and that is no forward voltage. */
static void misfires(void) {
  static const struct {
    const char *sets;
    double at_s;
  } ROWS[] = {
      {"--set run.until=20ms --set firing.pulse_width=2ms", 7.5556e-3},
      {"--set run.until=20ms --set firing.pulse_width=8ms", 13.5556e-3},
      {"--set run.until=7ms --set firing.pulse_width=2ms", NAN},
      {"--set run.until=20ms --set firing.angle=179.5deg --set firing.pulse_width=2ms", NAN}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char *e = events_of(LATCH("b", ""), ANY_PART, ROWS[k].sets);
    if (isnan(ROWS[k].at_s))
      EXPECT(count_lines(e) == 1, "%s: %s", ROWS[k].sets, e);
    else
      CLOSE(event_s(e, "p misfires"), ROWS[k].at_s, 1e-4);
    free(e);
  }
}

/* A gate pulse of sub-pulses, from 5.556 to 7.556 ms: what goes out and is fired again within it
 * has not misfired; what stays out has, and is told so at its end. */
static void sub_pulses(void) {
#define FORCED(v, i)                                                                               \
  "*$ param t = p part\n*$ port gate = Vg\n*$ device t = v(x), i(Vt)\nVg g 0 external\n"           \
  "Vx x 0 PWL(0 600 5.6m 600 5.601m 1 5.7m 1 5.701m 600 " v ")\n"                                  \
  "It 0 y PWL(0 0 5.6m 0 5.601m 1 5.7m 1 5.701m 0 " i ")\nVt y z 0\nRz z 0 1\n" ASIDE
  static const char SETS[] = "--set run.until=12ms --set firing.pulse_width=2ms";
  char *e = events_of(FORCED("5.8m 600 5.801m 1 9m 1 9.001m -100", "5.8m 0 5.801m 1 9m 1 9.001m 0"),
                      ANY_PART, SETS);
  EXPECT(count_lines(e) == 1, "%s", e);
  free(e);
  e = events_of(FORCED("9m 600", "9m 0"), ANY_PART, SETS);
  EXPECT(count_lines(e) == 2, "%s", e);
  CLOSE(event_s(e, "t misfires"), 7.5556e-3, 1e-4);
  free(e);
}

/* Of 400 A 30 mA are less than a ten-thousandth, and yet a current that conducts: it neither ends
 * nor begins anew. */
static void large_currents(void) {
  char *e = events_of("*$ param t = p part\n*$ port gate = Vg\n*$ device t = v(x), i(Vt)\n"
                      "Vg g 0 external\nVx x 0 PWL(0 600 1m 600 1.01m 1 7m 1 7.1m -100)\n"
                      "It 0 y PWL(0 0 1m 0 1.1m 400 2m 400 2.1m 30m 5m 30m 6m 400 7m 0)\nVt y z 0\n"
                      "Rz z 0 1\n" ASIDE,
                      ANY_PART,
                      "--set run.until=8ms --set firing.angle=18deg --set firing.pulse_width=1ms");
  EXPECT(count_lines(e) == 1, "%s", e);
  free(e);
}

/* Always on: it fires at each zero of the mains, half a cycle after its current ended. That is a
 * commutation failure if the part asks for more rest than 10 ms; of a part that does not say, ten
 * times the 150 us of a slow thyristor are rest enough. */
static void commutation_failures(void) {
#define DIODE                                                                                      \
  "*$ param t = p part\n*$ port mains = Vm\n*$ port gate = Vg\n"                                   \
  "*$ device t = v(a,b), i(Vt)\nVm a 0 external\nVg g b external\nRg g b 1k\n"                     \
  "Vt a c 0\nXt c b t\nRl b 0 100\n" ASIDE
#define ALWAYS_ON(lines)                                                                           \
  "*$ part thyristor \"P\"\n" lines ".subckt p a k\nD1 a k d\n.model d d\n.ends\n"
  static const struct {
    const char *part;
    int failures;
  } ROWS[] = {{ALWAYS_ON(""), 0},
              {ALWAYS_ON("*$ limit t_q = 20 ms\n"), 2},
              {ALWAYS_ON("*$ limit t_q = 5 ms\n"), 0}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    write_file("d.cir", DIODE);
    write_file("p.inc", ROWS[k].part);
    ran r = run("run paper --set circuit.deck=d.cir --quiet --json -o out --set run.until=45ms");
    CU_ASSERT_EQUAL(r.status, 3);
    char *e = read_file("out/events.csv");
    CU_ASSERT_EQUAL(how_often(e, "t fires without a gate pulse"), 3);
    CU_ASSERT_EQUAL(how_often(e, "(commutation failure)"), ROWS[k].failures);
    if (ROWS[k].failures) CLOSE(event_s(e, "(commutation failure)"), 20e-3, 1e-3);
    CU_ASSERT_EQUAL(number_behind(r.out, "\"t.unintended_firings\"", "\"value\": "), 3);
    CU_ASSERT_EQUAL(number_behind(r.out, "\"t.commutation_failures\"", "\"value\": "),
                    ROWS[k].failures);
    CLOSE(number_behind(r.out, "\"t.t_off\"", "\"value\": "), 10e-3, 1e-2); /* of threshold */
    free(e);
    free_ran(&r);
  }
}

/* A thyristor of 200 V/us: a ramp of 1.5 times that fires it, one of half of it does not, though
 * its junction draws more than 7 mA all the while. And one that is not fired long enough: its
 * current, through the coil, is below its latching current when the pulse ends. */
static void rises_and_short_pulses(void) {
#define RAMP(end)                                                                                  \
  "*$ param t = thyristor_2t part\n*$ port gate = Vg\n*$ device t = v(a), i(Vt)\n"                 \
  "Vg g 0 external\nVr r 0 PWL(0 0 100u 0 " end ")\nRl r a 50\nVt a c 0\nXt c 0 g t\n" ASIDE
  char *e = events_of(RAMP("102.667u 800"), ANY_PART, "--set run.until=200us");
  CLOSE(event_s(e, "t fires without a gate pulse (unintended firing)"), 101.5e-6, 0.02);
  free(e);
  e = events_of(RAMP("108u 800"), ANY_PART, "--set run.until=200us");
  EXPECT(count_lines(e) == 1, "%s", e);
  free(e);
  /* one that takes 100 mA at its gate draws 50 mA from half of its critical ramp */
  e = events_of(RAMP("108u 800"), ANY_PART,
                "--set run.until=200us --set circuit.gate_current=100mA "
                "--set circuit.latching_current=400mA --set circuit.holding_current=200mA");
  EXPECT(count_lines(e) == 1, "%s", e);
  free(e);
  ran r = run("run paper --quiet -o out --set run.until=20ms --set circuit.thyristor=thyristor_2t "
              "--set firing.pulse_width=20us --tier circuit");
  CU_ASSERT_EQUAL(r.status, 3); /* it misfires */
  free_ran(&r);
  e = read_file("out/events.csv");
  EXPECT(how_often(e, "thyristor misfires") == 1 && how_often(e, "thyristor fires") == 1, "%s", e);
  free(e);
  /* an ideal one stays on, and its current, 4 mA then, counts as begun in the pulse */
  r = run("run paper --quiet -o out --set run.until=20ms --set circuit.deck=halfwave_bare "
          "--set firing.pulse_width=20us");
  CU_ASSERT_EQUAL(r.status, 0);
  free_ran(&r);
  e = read_file("out/events.csv");
  EXPECT(count_lines(e) == 3 && how_often(e, "thyristor fires") == 1, "%s", e);
  free(e);
}

/* The shipped decks with two thyristors: each goes by its own gate port, so that nothing fires out
 * of turn or not at all; and a surge couples in at their line, which shows in what V takes. */
static void two_thyristors(void) {
  static const struct {
    const char *deck, *varistor;
  } ROWS[] = {{"circuit.deck=fullwave_antiparallel", "varistor_2"},
              {"circuit.deck=bridge_halfcontrolled", "varistor"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    double joule[2];
    for (int surge = 0; surge < 2; surge++) {
      vs_trial *t = vs_trial_run(
          "paper", "circuit",
          (const char *[]){ROWS[k].deck, "firing.every=1", "firing.angle=130deg", "run.until=45ms",
                           surge ? "events.s={kind: surge, at: 43 ms, level: 4 kV}"
                                 : "circuit.thyristor=TYN1212",
                           NULL},
          NULL);
      EXPECT(t->status == VS_OK, "%s", t->err.text);
      joule[surge] = measure(t, ROWS[k].varistor, "energy")->value.value;
      for (int n = 1; n <= 2 && !surge; n++) {
        const char *name = n == 1 ? "t1" : "t2";
        CU_ASSERT_EQUAL(measure(t, name, "misfires")->value.value, 0);
        CU_ASSERT_EQUAL(measure(t, name, "unintended_firings")->value.value, 0);
        CU_ASSERT(measure(t, name, "i_peak")->value.value > 0.3);
        CLOSE(measure(t, name, "t_off")->value.value, 10e-3, 0.02); /* the other's half wave */
        CU_ASSERT_PTR_NOT_NULL(measure(t, name, "i2t")->limit);
      }
      vs_trial_free(t);
    }
    EXPECT(joule[0] < 1e-3 && joule[1] > 1, "%s: %g J, %g J", ROWS[k].deck, joule[0], joule[1]);
  }
}

/* ---- lines ---- */

static void bad_lines(void) {
#define HEAD "*$ param t = p part\n*$ port mains = Vm\n*$ port gate = Vg\n"
#define REST_OF "Vm a 0 external\nVg g 0 external\nXt a b g t\nRb b 0 1\n" ASIDE
  static const struct {
    const char *lines, *part, *place, *says;
  } ROWS[] = {
      {"*$ device\n", "", "d.cir:4:10: ", "'device NAME [PART or KIND] [PORT]... [protects"},
      {"*$ device t v(a), v(b)\n", "", "d.cir:4:14: ", "'device NAME [PART or KIND]"},
      {"*$ device t a b = v(a), v(b)\n", "", "d.cir:4:15: ", "'device NAME [PART or KIND]"},
      {"*$ device t = v(a)\n", "", "d.cir:4:19: ", "',' and the formula of its current"},
      {"*$ device t = v(a) v(b)\n", "", "d.cir:4:20: ", "an operator"},
      {"*$ device t = v(a), i(\n", "", "d.cir:4:22: ", "i(Vx)"},
      {"*$ device t = v(a), v(b) V\n", "", "d.cir:4:26: ", "an operator"},
      {"*$ device t = v(a), v(b)/rx\n", "", "d.cir:4:26: ", "no parameter 'rx'"},
      {"*$ device t = v(a), v(b)\n*$ device t = v(a), v(b)\n", "", "d.cir:5:11: ", "second time"},
      {"*$ device r1 = v(a), v(b)\n", "",
       "d.cir:4:11: ", "'r1' is no part of this deck and no kind"},
      {"*$ device r1 resister = v(a), v(b)\n", "", "d.cir:4:14: ", "did you mean 'resistor'?"},
      {"*$ device t fuse = v(a), v(b)\n", "", "d.cir:4:13: ", "is of kind thyristor, not fuse"},
      {"*$ device t gate+90 = v(a), v(b)\n", "", "d.cir:4:13: ", "'gate+90' is no part"},
      {"*$ device t gate+90deg = v(a), v(b)\n", "", "d.cir:4:13: ", "no such port"},
      {"*$ device r1 resistor gate = v(a), v(b)\n", "", "d.cir:4:23: ", "a resistor has no gate"},
      {"*$ device t = v(a), v(b), v(a)\n", "", "d.cir:4:25: ", "of a thyristor two formulas"},
      {"*$ device t protects = v(a), v(b)\n", "", "d.cir:4:13: ", "'device NAME [PART or KIND]"},
      {"*$ device f fuse protects q = v(a), v(b)\n*$ device t = v(a), v(b)\n", "",
       "d.cir:4:27: ", "no device 'q' stands in the deck"},
      {"*$ device t protects t = v(a), v(b)\n", "", "d.cir:4:22: ", "a thyristor protects nothing"},
      {"*$ device f fuse protects t = v(a), v(b)\n*$ device t = v(a), v(b)\n",
       "*$ limit i2t = 3 A\n", "p.inc:2:16: ", "a unit as A2.s"},
      {"*$ device t = v(a), v(b)\n", "*$ limit i2t = 3 A\n", "p.inc:2:16: ", "a unit as A2.s"},
      {"", "*$ limit v_drm = 800 V\n*$ limit dv_dt_over = 0.9 kV\n", "p.inc:3:1: ",
       "a voltage from 10 V on and up to v_drm, which is 800 V, is wanted, not '0.9"},
      {"", "*$ limit dv_dt_over = 9 V\n",
       "p.inc:2:1: ", "a voltage from 10 V on is wanted, not '9"},
      {"", "*$ limit dv_dt_over = none\n",
       "p.inc:2:1: ", "without this line it is a tenth of v_drm"},
      {"", "*$ limit dv_dt_over = 0 V\n", "p.inc:2:23: ", "a positive number"},
      {"", "*$ limit dv_dt_over = 80 V/us\n", "p.inc:2:23: ", "a unit as V is wanted"},
      {"", "*$ zth 0.5 1 ms\n", "p.inc:2:8: ", "a thermal resistance and its time constant"},
      {"", "*$ zth 0.5 K/W 0 ms\n", "p.inc:2:8: ", "both positive, as 0.5 K/W 1 ms"},
      {"", "*$ zth 0.5 K/W 1 ms guessed\n", "p.inc:2:21: ", "quotes"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_text text = {0};
    vs_text_add(&text, "%s%s%s", HEAD, ROWS[k].lines, REST_OF);
    write_file("d.cir", text.text);
    vs_text_free(&text);
    vs_text_add(&text, "*$ part thyristor \"P\"\n%s.subckt p a k g\nR1 a k 1\nR2 g k 1\n.ends\n",
                ROWS[k].part);
    write_file("p.inc", text.text);
    vs_text_free(&text);
    ran r = run("check d.cir");
    EXPECT(r.status == 2 && !strncmp(r.err, ROWS[k].place, strlen(ROWS[k].place)) &&
               strstr(r.err, ROWS[k].says),
           "row %zu, status %d: %s", k, r.status, r.err);
    const char *caret = strstr(r.err, "^\n"); /* the one error's, and nothing behind it */
    EXPECT(caret && !caret[2], "row %zu: %s", k, r.err);
    free_ran(&r);
  }
  write_file("d.cir", "*$ param t = p part\n*$ port mains = Vm\n*$ device t = v(a), v(b)\n"
                      "Vm a 0 external\nXt a b g t\nRb b 0 1\n" ASIDE);
  write_file("p.inc", ".subckt p a k g\nR1 a k 1\nR2 g k 1\n.ends\n");
  ran r = run("check d.cir");
  EXPECT(r.status == 2 && strstr(r.err, "p.inc:1:1: has no line '*$ part KIND \"TEXT\"', which the "
                                        "device t at d.cir:3 asks for"),
         "%s", r.err);
  free_ran(&r);
  write_file("p.inc", "*$ part snubber \"S\"\n.subckt p a k g\nR1 a k 1\nR2 g k 1\n.ends\n");
  r = run("check d.cir");
  EXPECT(r.status == 2 && strstr(r.err, "d.cir:3:11: device t: its part p is of kind snubber, of "
                                        "which nothing is measured"),
         "%s", r.err);
  free_ran(&r);
}

/* Two devices may be of one part; a device's kind may be said; lists say what is measured. */
static void devices_are_listed(void) {
  write_file("d.cir", "*$ param t = p part\n*$ port mains = Vm\n*$ port gate+180deg = Vg\n"
                      "*$ device t1 t = v(a,b), i(Vm) \"one\"\n*$ device t2 t gate+180deg = "
                      "v(b,a), -i(Vm)\n*$ device f1 fuse = v(a), i(Vm)\n"
                      "Vm a 0 external\nVg g 0 external\nXt a b g t\nRb b 0 1\n" ASIDE);
  write_file("p.inc", PART("*$ limit i2t = 3 A2.s\n"));
  ran r = run("list measures --deck d.cir");
  EXPECT(r.status == 0 && strstr(r.out, "t2.i2t               A2.s ") &&
             strstr(r.out, "; limit i2t\n") && strstr(r.out, "f1.i2t "),
         "%s", r.out);
  free_ran(&r);
  r = run("check d.cir");
  EXPECT(r.status == 0 && strstr(r.out, ", 3 devices\n"), "%s%s", r.out, r.err);
  free_ran(&r);
  vs_trial *t = vs_trial_run("paper", "circuit",
                             (const char *[]){"circuit.deck=d.cir", "run.until=1ms", NULL}, NULL);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  CU_ASSERT(measure(t, "t1", "i2t")->limit && measure(t, "t2", "i2t")->limit);
  CU_ASSERT_PTR_NULL(measure(t, "f1", "i2t")->limit);
  CLOSE(t->result.watchers.devices->item[0].device->gates.rad[0], M_PI,
        1e-12); /* the deck's only gate */
  vs_trial_free(t);
  r = run("list parts");
  CU_ASSERT_EQUAL(r.status, 0);
  free_ran(&r);
}

static const vs_test TESTS[] = {
    {"half sines", half_sines},
    {"surge currents", surge_currents},
    {"continuous current", continuous_current},
    {"voltage rises", voltage_rises},
    {"impulse 8/20", impulse_8_20},
    {"resistor and capacitor", resistor_and_capacitor},
    {"varistor pulses", varistor_pulses},
    {"pulses end at 1 mA", pulses_end_at_1_ma},
    {"junction temperature", junction_temperature},
    {"junctions of parts", junctions_of_parts},
    {"time to rest", time_to_rest},
    {"gate currents", gate_currents},
    {"volt-seconds", volt_seconds},
    {"verdicts", verdicts},
    {"all is well", all_is_well},
    {"fires out of turn", fires_out_of_turn},
    {"misfires", misfires},
    {"sub-pulses", sub_pulses},
    {"large currents", large_currents},
    {"commutation failures", commutation_failures},
    {"rises and short pulses", rises_and_short_pulses},
    {"two thyristors", two_thyristors},
    {"bad lines", bad_lines},
    {"devices are listed", devices_are_listed},
};
int main(void) {
  return program_suite("devices", TESTS, COUNT(TESTS));
}
