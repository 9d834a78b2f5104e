/* SPDX-License-Identifier: GPL-3.0-or-later
 * `run --why`: what a current or voltage is made of, against phasors by hand, and that the shares
 * of each line sum to its total. */
#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"

/* A resistor of 1 kohm and a capacitor side by side feed a device of 100 ohm from the mains. With
 * omega R C = 0.5 the resistor's current is 1 / (1 + 0.5 j) of the whole. */
static const char DECK[] = "* shares known by hand\n"
                           "*$ title  two branches into one device\n"
                           "*$ port   mains = Vmains\n"
                           "*$ probe  i_d = i(Vd)  A\n"
                           "*$ probe  v_d = v(a)   V\n"
                           "*$ probe  i_m = -i(Vmains)  A\n"
                           "*$ device d resistor = v(a), i(Vd)\n"
                           "Vmains src 0 external\n"
                           "Rs     src a 1k\n"
                           "Cs     src a 1.5915494309u ic=0\n"
                           "Vd     a b 0\n"
                           "Rd     b 0 100\n"
                           "Xeva   src 0 eva\n",
                  SCENE[] = "circuit: {deck: own.cir}\n"
                            "ratings: {i_d: .. 10 mA, v_d: .. 1 V, i_m: .. 1 mA}\n"
                            "run: {until: 8 ms, tier: circuit, verify: never}\n";
static const double OMEGA = 2 * M_PI * 50, PEAK_V = 440 * M_SQRT2;

/* The object "cause" of a line of the verdict, up to its end; NULL: it has none. */
static const char *cause_of(const char *json, const char *key, const char *name) {
  char begin[96];
  snprintf(begin, sizeof begin, "{\"%s\": \"%s\"", key, name);
  const char *line = strstr(json, begin), *end = line ? strchr(line, '\n') : NULL;
  const char *cause = line ? strstr(line, "\"cause\": {") : NULL;
  return cause && cause < end ? cause : NULL;
}

/* The share of that name; NaN: it has none. */
static double share_of(const char *cause, const char *name) {
  char begin[96];
  snprintf(begin, sizeof begin, "{\"from\": \"%s\"", name);
  const char *share = cause ? strstr(cause, begin) : NULL,
             *end = cause ? strchr(cause, '\n') : NULL;
  return share && share < end ? number_in(share, "value") : NAN;
}

static double at(double complex phasor, double t_s) {
  return PEAK_V * cimag(phasor * cexp(I * OMEGA * t_s));
}

/* Tolerance: run.tolerance is 1e-4 of a peak, and the largest value is seen at the end of a step,
 * where the capacitor's share of it, which is its slope, is known a few times worse. */
static void by_phasors(void) {
  const double complex y_c = I * 0.5e-3, y_r = 1e-3, v_a = 1 / (1 + 0.01 / (y_r + y_c));
  write_file("own.cir", DECK);
  write_file("s.yaml", SCENE);
  ran r = run("run s.yaml --why --json --quiet");
  CU_ASSERT_EQUAL(r.status, 3);
  const char *i = cause_of(r.out, "rating", "i_d"), *v = cause_of(r.out, "rating", "v_d");
  CU_ASSERT_FATAL(i && v);
  const double t_s = number_in(i, "at_s"), peak_a = number_in(i, "total");
  CLOSE(peak_a, PEAK_V * cabs(v_a) / 100, 3e-4);
  CLOSE_OF(share_of(i, "rs"), at((1 - v_a) * y_r, t_s), peak_a, 1e-3);
  CLOSE_OF(share_of(i, "cs"), at((1 - v_a) * y_c, t_s), peak_a, 1e-3);
  CLOSE_OF(share_of(i, "rs") / peak_a, 0.8, 1, 3e-3); /* 1 / (1 + 0.5^2), at the very peak */
  const double v_s = number_in(v, "at_s"), peak_v = number_in(v, "total");
  CLOSE_OF(share_of(v, "the mains"), at(1, v_s), peak_v, 1e-3);
  CLOSE_OF(share_of(v, "rs"), at(v_a - 1, v_s), peak_v, 1e-3);
  const char *m = cause_of(r.out, "rating", "i_m"); /* of a source that is no device */
  CU_ASSERT_FATAL(m != NULL);
  CLOSE_OF(share_of(m, "the coil") + share_of(m, "rs") + share_of(m, "cs"), number_in(m, "total"),
           1, 1e-6 * number_in(m, "total"));
  free_ran(&r);
  r = run("run s.yaml --why");
  EXPECT(strstr(r.out, "\nwhy i_d: 632 mA at ") &&
             strstr(r.out, " ms, made of 505 mA from rs, 126 mA from cs\n"),
         "%s", r.out);
  free_ran(&r);
}

/* The converter under a surge that fires its thyristor: the discharge of the varistors beside it.
 * Kirchhoff's law holds to the solver's tolerance of a current, and a loop's voltages to rounding.
 */
static void under_a_surge(void) {
  write_file("f.yaml", "circuit: {deck: halfwave_paper}\nfiring: {every: 1}\n"
                       "run: {until: 50 ms, verify: never}\n"
                       "events:\n"
                       "  hit: {kind: surge, cycle: 3, angle: 90 deg, level: 2 kV}\n"
                       "  late: {kind: sag, cycle: 3, angle: 170 deg}\n");
  ran plain = run("run f.yaml --json --quiet --reproducible"),
      r = run("run f.yaml --why --json --quiet --reproducible");
  CU_ASSERT_EQUAL(r.status, 3);
  CU_ASSERT_EQUAL(plain.status, 3);
  EXPECT(!strstr(plain.out, "\"cause\": {"), "%s", plain.out);
  int causes = 0;
  for (const char *c = r.out; (c = strstr(c, "\"cause\": {\"of\"")); c++, causes++)
    EXPECT(fabs(number_in(c, "sum_error")) <= 1e-6 * number_in(c, "total"), "%.300s", c);
  EXPECT(causes >= 3, "%d causes", causes);
  const char *di_dt = cause_of(r.out, "device", "thyristor\", \"measure\": \"di_dt");
  CU_ASSERT_FATAL(di_dt != NULL);
  EXPECT(share_of(di_dt, "varistor_1's capacitance") > 0.5 * number_in(di_dt, "total"), "%.500s",
         di_dt);
  EXPECT(share_of(di_dt, "varistor_2's capacitance") > 0, "%.500s", di_dt);
  const char *event = strstr(di_dt, "{\"what\": ");
  CU_ASSERT_FATAL(event != NULL);
  EXPECT(!strncmp(event, "{\"what\": \"hit\"", 14), "%.200s", event);
  CLOSE(number_in(event, "at_s"), 0.045, 1e-9);
  CLOSE_OF(number_in(event, "before_s"), number_in(di_dt, "at_s") - 0.045, 1,
           1.1e-7); /* a stretch */
  free_ran(&plain);
  free_ran(&r);
}

/* A voltage below 0 is told by its size. The deck's rating of it, which is violated together with
 * the limit of its device, is not told again. */
static void a_reverse_voltage(void) {
  write_file("r.yaml", "circuit: {deck: halfwave_snubbed, thyristor: TYN1012}\n"
                       "run: {until: 24 ms, verify: never}\n");
  ran r = run("run r.yaml --why");
  CU_ASSERT_EQUAL(r.status, 3);
  EXPECT(strstr(r.out,
                "\nwhy thyristor.v_reverse: 1.05 kV at 15.2 ms, made of 621 V from the mains, "
                "430 V from the coil; the thyristor goes out at 13.72 ms, "),
         "%s", r.out);
  EXPECT(!strstr(r.out, "v_ak"), "%s", r.out);
  free_ran(&r);
}

/* Of transistors whose currents ngspice does not tell whole, as they switch, and of a current that
 * leaves its device's first node. */
static void all_sums(const char *words, int want) {
  ran r = run("run %s --why --json --quiet --set run.verify=never", words);
  int causes = 0;
  for (const char *c = r.out; (c = strstr(c, "\"cause\": {\"of\"")); c++, causes++)
    EXPECT(fabs(number_in(c, "sum_error")) <= 1e-6 * number_in(c, "total"), "%.300s", c);
  EXPECT(causes == want, "%s: %d causes, %s", words, causes, r.err);
  free_ran(&r);
}

static void transistors_and_gates(void) {
  all_sums("bridge_link --until 30ms --set 'ratings.i_2=.. 1 uA' --set 'ratings.i=.. 1 uA' --set "
           "'ratings.v_eva=.. 1 V'",
           3);
  all_sums("paper --until 8ms --tier compiled --set 'ratings.i=.. 1 uA'",
           1); /* looked at on ngspice */
  all_sums("paper --until 8ms --set circuit.deck=halfwave_paper --set 'ratings.i_gate=.. 1 uA'", 1);
}

/* What has no current or voltage says so, and the status is the run's. */
static void without_a_circuit(void) {
  write_file("m.yaml", "ratings: {stroke: .. 0.1 mm, i: .. 0.1 A}\nrun: {until: 30 ms}\n");
  ran r = run("run m.yaml --tier switched --why");
  CU_ASSERT_EQUAL(r.status, 3);
  EXPECT(strstr(r.out, "why stroke, i: tier switched has no circuit"), "%s", r.out);
  free_ran(&r);
  r = run("run m.yaml --tier circuit --why");
  CU_ASSERT_EQUAL(r.status, 3);
  EXPECT(strstr(r.out, "why stroke: it is no device's current or voltage"), "%s", r.out);
  EXPECT(strstr(r.out, "why i: 833 mA at ") && strstr(r.out, ", made of 824 mA from thyristor"),
         "%s", r.out);
  free_ran(&r);
}

/* A figure without a source is named, and the other switch of the leg by its device's name. */
static void assumed_figures(void) {
  ran r = run("run bridge_link --set run.until=4ms --set pwm.dead_time=0us "
              "--set circuit.gate_resistance=1kohm --why");
  EXPECT(
      strstr(r.out,
             "why switch.i_peak: 54.6 A at 3.875 ms, made of 54.6 A from s1; assumed: switch.i_cm"),
      "%s", r.out);
  free_ran(&r);
}

/* What the coil induces is the coil's, not the resistor's beside it. */
static void coil_before_resistor(void) {
  ran r = run("run relay --set circuit.across_coil=open --until 52ms --set run.verify=never --why");
  EXPECT(strstr(r.out, "why switch.v_peak: ") && strstr(r.out, " V from the coil, ") &&
             !strstr(r.out, "riron"),
         "%s", r.out);
  free_ran(&r);
}

/* A parameter without a source is named for the elements that are made of it, also by way of
 * another one, and marks the lines of the device whose formula has it. What the scene says is no
 * guess. */
static void assumed_parameters(void) {
  static const char GUESSED[] =
      "* what no source says\n"
      "*$ param r_s = 1 kohm 1..1e6 assumed \"a guess\"\n"
      "*$ param c_s = 1.6 uF 1e-3..1e3 typical\n"
      "*$ param r_d = 100 ohm 1..1e6 assumed \"a guess\"\n"
      "*$ param t = p.inc part\n*$ port mains = Vmains\n*$ probe i_d = i(Vd) A\n"
      "*$ device t = v(a), v(a)/{r_d}\n.param twice={2*r_s}\n"
      "Vmains src 0 external\nRs src a {twice/2}\nCs src a {c_s} ic=0\nVd a b 0\nRd b 0 {r_d}\n"
      "Xeva src 0 eva\n";
  write_file("own.cir", GUESSED);
  write_file("p.inc",
             "*$ part thyristor \"P\"\n*$ limit i_tsm = 1 A typical\n*$ limit v_drm = 9 kV\n"
             ".subckt p a k g\nRg g k 1k\n.ends p\n");
  write_file("s.yaml", "circuit: {deck: own.cir}\nratings: {i_d: .. 10 mA}\n"
                       "run: {until: 8 ms, tier: circuit, verify: never}\n");
  ran r = run("run s.yaml --why --all");
  EXPECT(strstr(r.out, "; assumed: circuit.r_s; typical: circuit.c_s\n"), "%s", r.out);
  EXPECT(strstr(r.out, "unverified  assumed, typical\n") &&
             strstr(r.out, "99.3 %              unverified\n"),
         "%s", r.out);
  free_ran(&r);
  r = run("run s.yaml --why --all --json --set circuit.r_s=1kohm --set circuit.c_s=1.6uF "
          "--set circuit.r_d=100ohm");
  EXPECT(!strstr(r.out, "circuit.r_s") && strstr(r.out, "\"assumed\": false, \"typical\": true"),
         "%s", r.out);
  free_ran(&r);
}

/* A rating that is stricter than the limit of the device whose voltage it is stands beside it in
 * the table, though both have one stress. */
static void a_stricter_rating(void) {
  write_file("own.cir",
             "* one stress, two limits\n*$ param t = p.inc part\n*$ port mains = Vmains\n"
             "*$ probe i_d = i(Vd) A\n*$ probe v_x = v(a) V\n*$ rating v_x -10..10 V \"own\"\n"
             "*$ device t = v(a), v(a)/100\nVmains src 0 external\nRs src a 1k\nVd a b 0\n"
             "Rd b 0 100\nXeva src 0 eva\n");
  write_file("p.inc", "*$ part thyristor \"P\"\n*$ limit v_drm = 9 kV\n"
                      ".subckt p a k g\nRg g k 1k\n.ends p\n");
  write_file("s.yaml", "circuit: {deck: own.cir}\nratings: {i_d: .. 10 mA}\n"
                       "run: {until: 8 ms, tier: circuit, verify: never}\n");
  ran r = run("run s.yaml");
  EXPECT(strstr(r.out, "\nweakest: i_d,") && strstr(r.out, "\n  v_x ") &&
             strstr(r.out, "\n  t.v_forward "),
         "%s", r.out);
  free_ran(&r);
}

/* Of more lines than there is room for, it is said how many are left out. */
static void many_lines(void) {
  enum { MORE = 11 }; /* beside three */
  char deck[4096] = "", scene[1024] = "circuit: {deck: own.cir}\nratings: {";
  size_t n = 0, m = strlen(scene);
  const char *rest = strstr(DECK, "*$ device");
  n += (size_t)snprintf(deck, sizeof deck, "%.*s", (int)(rest - DECK), DECK);
  for (int k = 0; k < MORE; k++) {
    n += (size_t)snprintf(deck + n, sizeof deck - n, "*$ probe p%d = v(a) V\n", k);
    m += (size_t)snprintf(scene + m, sizeof scene - m, "p%d: .. 1 V, ", k);
  }
  snprintf(deck + n, sizeof deck - n, "%s", rest);
  snprintf(scene + m, sizeof scene - m, "%s", strstr(SCENE, "i_d: "));
  write_file("own.cir", deck);
  write_file("s.yaml", scene);
  ran r = run("run s.yaml --why");
  EXPECT(strstr(r.out, "why: 2 more violated lines are left out\n"), "%s%s", r.out, r.err);
  free_ran(&r);
}

/* What melts a fuse is a sum of i^2, whose part is that of the line i2t_surge beside it. */
static void a_fuse_that_opens(void) {
  ran r = run("run paper --set circuit.deck=halfwave_paper --set firing.every=1 --until 27ms "
              "--set run.verify=never --why --json --quiet "
              "--set 'events.sh={kind: coil_short, cycle: 2, angle: 90 deg}'");
  const char *opens = cause_of(r.out, "device", "fuse_2\", \"measure\": \"opens"),
             *sum = cause_of(r.out, "device", "fuse_2\", \"measure\": \"i2t_surge");
  CU_ASSERT_FATAL(opens && sum);
  CLOSE_OF(number_in(opens, "most"), number_in(sum, "most"), 1, 1e-6);
  free_ran(&r);
}

/* The fall of the triac's current to zero, over which (di/dt)c is the mean. */
static void a_fall_to_zero(void) {
  ran r = run("run paper --set circuit.deck=triac_feeder --set firing.every=1 --until 30ms "
              "--set firing.pulse_width=4ms --set supply.voltage=230V --set run.verify=never "
              "--why --json --quiet --set 'ratings={triac.di_dt_c: .. 0.1 A/ms}'");
  const char *fall = cause_of(r.out, "rating", "triac.di_dt_c");
  CU_ASSERT_FATAL(fall != NULL);
  EXPECT(!strncmp(strstr(fall, "\"of\": "), "\"of\": \"fall\"", 12), "%.300s", fall);
  CLOSE_OF(number_in(fall, "over_s"), 50e-6, 50e-6, 1e-9);
  CU_ASSERT(number_in(fall, "total") > 0);
  free_ran(&r);
}

static const vs_test tests[] = {{"a fall to zero", a_fall_to_zero},
                                {"a fuse that opens", a_fuse_that_opens},
                                {"more lines than are told", many_lines},
                                {"shares by phasors", by_phasors},
                                {"shares under a surge", under_a_surge},
                                {"a reverse voltage", a_reverse_voltage},
                                {"a stricter rating", a_stricter_rating},
                                {"assumed figures", assumed_figures},
                                {"the coil before a resistor", coil_before_resistor},
                                {"assumed parameters", assumed_parameters},
                                {"transistors and gates", transistors_and_gates},
                                {"lines without a circuit", without_a_circuit}};

int main(void) {
  return program_suite("why", tests, COUNT(tests));
}
