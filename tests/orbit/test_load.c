/* SPDX-License-Identifier: GPL-3.0-or-later
 * The load: changed by events (engine/test_disturbed.c has them against an integration of its own),
 * found by the throw coefficient on the orbit, and what steady tells of the material that it is. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "program.h"

/* ---- numbers out of JSON and CSV ---- */

/* The numbers of the line that begins with `t,`; of the last one where t is NULL. */
static void row_of(const char *csv, const char *t, double *cells, int count) {
  char wanted[40];
  snprintf(wanted, sizeof wanted, "\n%s,", t ? t : "");
  const char *line = t ? strstr(csv, wanted) : NULL;
  for (const char *at = csv; !t && (at = strchr(at, '\n')) && at[1]; at++) line = at;
  CU_ASSERT_FATAL(line != NULL);
  char *at = NULL;
  for (int k = 0; k < count; k++) cells[k] = strtod(k ? at + 1 : line + 1, &at);
}

/* ---- the event ---- */

/* Two runs glued by hand: one with the first load up to an instant at which no current flows and
 * the mains rise through zero, and one with the second load from the state there. The numbers pass
 * through CSV with 17 digits; what remains is what either run may be off by at run.tolerance 1e-10.
 */
static void an_event_is_two_runs(void) {
  static const char FIRED[] = "--set firing.every=1 --set run.tolerance=1e-10 --tier switched "
                              "--digits 17 --quiet --set load.density=0.6g/cm3 --set "
                              "run.sample=10ms --set record=[p,u,w,phi,vp,vu,vw,vphi]";
  double at[9], two[9], one[9];
  ran r = run("run paper %s --set load.fraction=0.2 --set run.until=40ms -o first", FIRED);
  CU_ASSERT(r.status == 0);
  free_ran(&r);
  char *csv = read_file("first/run.csv");
  row_of(csv, NULL, at, 9);
  free(csv);
  r = run("run paper %s --set load.fraction=0.5 --set load.volume=300cm3 --set run.until=50ms "
          "--set 'start={p: %.17g m, u: %.17g m, w: %.17g m, phi: %.17g rad, vp: %.17g m/s, "
          "vu: %.17g m/s, vw: %.17g m/s, vphi: %.17g rad/s}' -o second",
          FIRED, at[1], at[2], at[3], at[4], at[5], at[6], at[7], at[8]);
  EXPECT(r.status == 0, "%s", r.err);
  free_ran(&r);
  r = run("run paper %s --set load.fraction=0.2 --set run.until=90ms --set 'events.more={kind: "
          "load, at: 40ms, fraction: 0.5, volume: 300cm3}' -o whole",
          FIRED);
  EXPECT(r.status == 0, "%s", r.err);
  free_ran(&r);
  csv = read_file("second/run.csv");
  row_of(csv, NULL, two, 9);
  free(csv);
  csv = read_file("whole/run.csv");
  row_of(csv, NULL, one, 9);
  free(csv);
  char *events = read_file("whole/events.csv");
  CU_ASSERT(strstr(events, "\n0.040000000000000001,load changes\n") != NULL);
  free(events);
  CLOSE_OF(one[1], two[1], 1.5e-3, 1e-9);
  CLOSE_OF(one[4], two[4], 1e-3, 1e-9);
  CLOSE_OF(one[5], two[5], 0.5, 1e-9);
  CLOSE_OF(one[8], two[8], 0.3, 1e-9);
}

typedef struct jump {
  int times;
  double at_s, before_m_s, after_m_s, before_m_s2, after_m_s2, p_m;
} jump;

static vs_status look(void *ctx, const vs_step *step, vs_error *err) {
  jump *j = ctx;
  (void)err;
  for (int k = 0; k < 2; k++)
    if (step->event[k] == VS_EV_LOADS) {
      j->times++;
      j->at_s = step->to->t_s;
      j->p_m = step->to->x[0];
      j->before_m_s = step->from->x[1];
      j->after_m_s = step->to->x[1];
      j->before_m_s2 = step->from->a[0];
      j->after_m_s2 = step->to->a[0];
    }
  return VS_OK;
}

/* A trough alone on its springs, 0.83 kg, which 0.19 kg are added to. The velocity stays to the
 * bit; the acceleration falls by the ratio of the masses, as force and springs are what they were;
 * what was added brings m v^2/2, by which the books close. At 67 ms current flows. */
static void what_arrives_has_the_velocity(const char *tier, double tolerance) {
  const char *sets[] = {"firing.every=1",
                        "run.until=80ms",
                        "load.density=0.5g/cm3",
                        "load.volume=380cm3",
                        "events.more={kind: load, at: 67 ms, fraction: 1}",
                        NULL};
  jump j = {0};
  const vs_observer also = {&j, look};
  vs_trial *t = vs_trial_run("fixed_base", tier, sets, &also);
  EXPECT(!t->status, "%s: %s", tier, t->err.text);
  const double *joule = t->result.watchers.energy.joule;
  EXPECT(j.times == 1 && fabs(j.at_s - 67e-3) < 1e-12, "%s: %d at %g", tier, j.times, j.at_s);
  EXPECT(j.after_m_s == j.before_m_s && j.after_m_s != 0, "%s: %g, %g", tier, j.before_m_s,
         j.after_m_s);
  CLOSE(j.after_m_s2 / j.before_m_s2, 0.83 / 1.02, 1e-12);
  CLOSE(joule[VS_E_LOAD], 0.19 * j.after_m_s * j.after_m_s / 2, 1e-9);
  EXPECT(t->result.watchers.energy.worst < tolerance, "%s: the books leave %g", tier,
         t->result.watchers.energy.worst);
  vs_trial_free(t);
}
static void momentum_and_energy(void) {
  what_arrives_has_the_velocity("analytic", 1e-9);
  what_arrives_has_the_velocity("switched", 1e-9);
  what_arrives_has_the_velocity("circuit", 1e-3); /* its circuit's books, at run.tolerance 1e-4 */
}

/* What is put on and taken off again at once brings as much as it takes: the books' line is then
 * what two changes of the velocity make, and with no time between them nothing. */
static void on_and_off(void) {
  static const char SAME[] = "--set firing.every=1 --set load.density=0.6g/cm3 --tier switched "
                             "--set run.until=0.1s --json --reproducible";
  ran r = run("run paper %s --set 'events.a={kind: load, at: 50ms, fraction: 0.4}' --set "
              "'events.b={kind: load, at: 50.000001ms, fraction: 0}'",
              SAME),
      plain = run("run paper %s", SAME);
  EXPECT(r.status == 0 && plain.status == 0, "%s%s", r.err, plain.err);
  CLOSE_OF(number_in(r.out, "load_J"), 0, number_in(plain.out, "work_force_J"), 1e-6);
  CLOSE(number_in(r.out, "p_min"), number_in(plain.out, "p_min"), 1e-6);
  CU_ASSERT(!strstr(plain.out, "load_J")); /* the line is for scenes that have such events */
  free_ran(&r), free_ran(&plain);
}

static void an_event_at_work(void) {
  static const char AT_WORK[] = "--set firing.every=1 --set load.density=0.6g/cm3 --set "
                                "load.fraction=0.3 --tier switched --set start=steady --set "
                                "run.sample=20ms --digits 17 --quiet --set record=[p]";
  double first[2], at[2], after[2];
  ran r = run("run paper %s --set run.until=0.2s --set 'events.a={kind: load, at: 101ms, fraction: "
              "0.4}' -o work",
              AT_WORK);
  EXPECT(r.status == 0, "%s", r.err);
  free_ran(&r);
  char *csv = read_file("work/run.csv");
  row_of(csv, "0", first, 2);
  row_of(csv, "0.10000000000000001", at, 2);
  row_of(csv, NULL, after, 2);
  CLOSE(at[1], first[1], 1e-8);                    /* on the orbit until then */
  CU_ASSERT(fabs(after[1] / first[1] - 1) > 1e-3); /* and on no orbit afterwards */
  free(csv);
}

/* ---- the throw ---- */

/* The trough's centre of mass goes up by w + p cos(alpha) + (x_C - x_B) phi (Eq. 55's moments);
 * rows 2 us apart miss an extreme by (w h)^2/8, which is 1e-7 for what swings at 100 Hz. */
static void numbers_of_the_throw(void) {
  RUN_GOOD("steady paper --set firing.every=1 --set supply.voltage=230V --quiet --digits 17 --set "
           "run.sample=2us -o throw");
  char *csv = read_file("throw/run.csv"), *json = read_file("throw/summary.json"), *rest = csv;
  double least[3] = {0}, most[3] = {0}, c = cos(70 * M_PI / 180), s = sin(70 * M_PI / 180);
  strsep(&rest, "\n");
  for (char *line; (line = strsep(&rest, "\n")) && *line;) {
    double cell[13];
    char *at = line - 1;
    for (int k = 0; k < 13; k++) cell[k] = strtod(at + 1, &at);
    const double of[3] = {cell[11] + c * cell[9] - 0.102 * cell[12],
                          s * cell[9] - cell[10] + 0.04 * cell[12],
                          cell[7] + c * cell[5] - 0.102 * cell[8]};
    for (int k = 0; k < 3; k++) {
      least[k] = fmin(least[k], of[k]);
      most[k] = fmax(most[k], of[k]);
    }
  }
  CLOSE(number_in(json, "throw_coefficient"), number_in(json, "ap_peak") / 9.81, 1e-9);
  CLOSE(number_in(json, "throw_number"), fmax(-least[0], most[0]) / 9.81, 1e-6);
  CLOSE(number_in(json, "throw_down"), -least[0] / 9.81, 1e-6);
  CU_ASSERT(strstr(json, "\"thrown\": true, \"speed_in_range\": true") != NULL);
  /* a point of material on a sine of these amplitudes, thrown by hand: it leaves where the sine of
   * the phase is 1/G, flies, and has landed where it is below the trough again */
  double big = -least[0] / 9.81, w = (most[0] - least[0]) / (most[2] - least[2]);
  double amplitude = big * 9.81 / (w * w), from = asin(1 / big), x = 0, step = 1e-3;
  for (; step > 1e-14; step /= 2)
    for (;;) {
      double next = x + step, t = next / w;
      double flown = amplitude * (sin(from) + cos(from) * next) - 9.81 * t * t / 2;
      if (next > 0.5 && flown < amplitude * sin(from + next)) break;
      x = next;
    }
  double cotangent = (most[1] - least[1]) / (most[0] - least[0]), t = x / w;
  double went = cotangent * (amplitude * cos(from) * x - amplitude * (sin(from + x) - sin(from)));
  CLOSE(went, cotangent * 9.81 * t * t / 2, 1e-9);
  CLOSE(number_in(json, "conveying_speed"), went * w / (2 * M_PI), 1e-5);
  free(csv), free(json);
}

static void range_of_the_speed(void) {
  ran r = run("steady paper --set firing.every=1 --all"); /* throw_down 6.1 */
  CU_ASSERT(r.status == 0 && strstr(r.out, "outside of its formula's range") != NULL);
  CLOSE(strtod(strstr(r.out, "\nthrow_down") + 11, NULL), 6.14709722, 1e-8);
  free_ran(&r);
  r = run("steady paper --set firing.every=1 --set firing.angle=150deg --json");
  CU_ASSERT(strstr(r.out, "\"thrown\": false") && !strstr(r.out, "conveying_speed\":"));
  free_ran(&r);
  r = run("steady fixed_base --set firing.every=1 --set supply.voltage=110V --json");
  CU_ASSERT(!isnan(number_in(r.out, "throw_coefficient")) &&
            isnan(number_in(r.out, "throw_number")));
  CLOSE(number_in(r.out, "throw_coefficient"), number_in(r.out, "ap_peak") / 9.81, 1e-9);
  free_ran(&r);
  r = run("steady lds_v203 --set supply.kind=sine --set supply.frequency=20Hz --json");
  CU_ASSERT(r.status == 0 && !strstr(r.out, "throw"));
  free_ran(&r);
}

/* With material on the trough it is a warning, in a study's case too. */
static void a_warning_where_it_matters(void) {
  write_file("study.yaml", "set: {firing.every: 1, load.density: 0.1 g/cm3, load.fraction: 0.5}\n"
                           "steady: {period: 1}\nvary: {firing.angle: [100 deg, 130 deg]}\n"
                           "report: [throw_down, conveying_speed]\n");
  ran r = run("study study.yaml --jobs 1 --quiet");
  EXPECT(r.status == 0, "%s", r.err);
  const char *first = strstr(r.out, "\n0,"), *second = first ? strstr(first, "\n1,") : NULL;
  const char *said = first ? strstr(first, "conveying_speed is outside of its formula's") : NULL;
  CU_ASSERT(first && second && said && said < second);
  CU_ASSERT(second && !strstr(second, "outside of its formula"));
  free_ran(&r);
}

/* ---- auto ---- */

#define LOADED "paper --set firing.every=1 --set supply.voltage=230V --set load.density=0.5g/cm3 "

static double share_of(double k) {
  return 0.1 + fmin(fmax((k - 1) / 2.3, 0), 1) * 0.5;
}

/* The share by hand: steady with a number, its K, the number that follows, and again. Each changes
 * the next a few times less than the one before. */
static double by_hand(const char *angle) {
  double share = 0.3, before = NAN;
  for (int n = 0; n < 60 && !(fabs(share - before) < 1e-11); n++) {
    ran r = run("steady " LOADED "--set firing.angle=%s --json --quiet --set load.fraction=%.17g",
                angle, share);
    EXPECT(r.status == 0, "%s", r.err);
    before = share;
    share = share_of(number_in(r.out, "ap_peak") / 9.81);
    free_ran(&r);
  }
  CU_ASSERT(fabs(share - before) < 1e-11);
  return share;
}

static void the_share_of_its_own_orbit(void) {
  static const char *const ANGLES[] = {"120deg", "125deg"};
  for (size_t k = 0; k < COUNT(ANGLES); k++) {
    ran r =
        run("steady " LOADED "--set firing.angle=%s --json --set load.fraction=auto", ANGLES[k]);
    EXPECT(r.status == 0 && !*r.err, "%s: %s", ANGLES[k], r.err);
    double share = number_in(r.out, "load_fraction"),
           coefficient = number_in(r.out, "throw_coefficient");
    CLOSE(share, by_hand(ANGLES[k]), 1e-9);
    CLOSE(share, share_of(coefficient), 1e-9);
    CU_ASSERT(strstr(r.out, "\"fraction\": \"auto\"") && strstr(r.out, "\"from\": \"empirical"));
    CU_ASSERT(strstr(r.out, "\"held\": false") != NULL);
    free_ran(&r);
  }
  /* a run, a case and the orbit have the same */
  ran r = run("run " LOADED "--set firing.angle=120deg --set load.fraction=auto --set "
              "run.until=0.1s --quiet --digits 17 -o auto");
  EXPECT(r.status == 0, "%s", r.err);
  free_ran(&r);
  char *json = read_file("auto/summary.json"), *one = read_file("auto/run.csv");
  r = run("run " LOADED "--set firing.angle=120deg --set load.fraction=%.17g --set run.until=0.1s "
          "--quiet --digits 9 -o by_number",
          number_in(json, "load_fraction"));
  free_ran(&r);
  char *other = read_file("by_number/run.csv");
  double cells[2], others[2];
  row_of(one, NULL, cells, 2);
  row_of(other, NULL, others, 2);
  CLOSE(cells[1], others[1], 1e-8);
  free(one), free(other), free(json);
}

static void held_at_the_ends(void) {
  ran r = run("steady " LOADED "--set load.fraction=auto --json");
  CU_ASSERT(r.status == 0 && number_in(r.out, "load_fraction") == 0.6);
  CU_ASSERT(strstr(r.err, "warning: load.fraction: auto is held at 0.6: the throw coefficient"
                          " on the orbit, K = 9.5") != NULL);
  CU_ASSERT(strstr(r.out, "\"held\": true") && strstr(r.out, "auto is held at 0.6"));
  free_ran(&r);
  r = run("steady " LOADED "--set load.fraction=auto --set firing.angle=140deg");
  CU_ASSERT(r.status == 0 && strstr(r.err, "is held at 0.1: the throw coefficient"));
  CU_ASSERT(strstr(r.out, "load   fraction 0.1 of the material rides (auto: empirical") != NULL);
  free_ran(&r);
}

/* Near resonance a heavier trough swings further, and throws more: a share of 0.14 and one of 0.6
 * both ask for themselves. The lesser one is taken, and the other is told; it does hold. */
static void two_shares(void) {
  static const char HEAVY[] = LOADED "--set load.density=1.5g/cm3 --set firing.angle=130deg --json";
  ran r = run("steady %s --set load.fraction=auto", HEAVY), other = run("steady %s --set "
                                                                        "load.fraction=0.6",
                                                                        HEAVY);
  CU_ASSERT(r.status == 0 && strstr(r.err, "load.fraction: auto is 0.137964, and 0.6 would"));
  CLOSE(number_in(r.out, "load_fraction"), share_of(number_in(r.out, "throw_coefficient")), 1e-9);
  CU_ASSERT(number_in(r.out, "other") == 0.6 && number_in(other.out, "throw_coefficient") > 3.3);
  free_ran(&r), free_ran(&other);
}

/* On tier circuit the share is the one that the circuit's own orbit asks for, which is another one
 * than tier switched's: there the snubber's currents weaken the pulse. It is known to
 * run.tolerance, and is the same wherever a run begins. Runs of the search are not verified: with
 * run.verify: always the program crashed. */
static void the_share_of_the_circuit(void) {
  static const char SCENE[] = LOADED "--set firing.angle=125deg --tier circuit --json --quiet "
                                     "--set load.fraction=auto --set run.tolerance=3e-4";
  ran r = run("steady %s", SCENE), ideal = run("steady " LOADED "--set firing.angle=125deg --json "
                                               "--set load.fraction=auto");
  EXPECT(r.status == 0, "%s", r.err);
  double share = number_in(r.out, "load_fraction");
  CLOSE_OF(share, share_of(number_in(r.out, "ap_peak") / 9.81), 1, 6e-4);
  CU_ASSERT(fabs(share - number_in(ideal.out, "load_fraction")) > 5e-3);
  CU_ASSERT(strstr(r.out, "\"orbit_tier\": \"circuit\"") != NULL);
  CU_ASSERT(strstr(r.out, "\"other_on_ideal_tier_alone\": true") != NULL);
  ran rest = run("run %s --set run.until=20ms --set run.verify=always", SCENE);
  CU_ASSERT(rest.status == 0 && number_in(rest.out, "load_fraction") == share);
  free_ran(&r), free_ran(&ideal), free_ran(&rest);
}

/* With this soft stop the motion does not repeat. The search for its orbit alone would go on to
 * another end, and so would the further ones that a share wants: all have one budget, and the end
 * says how far the search came. */
static void a_budget_is_spent(void) {
  ran r = run("run paper --set load.density=2.16g/cm3 --set load.volume=341cm3 --set "
              "load.fraction=auto --tier circuit --set firing.every=1 --set firing.angle=103.3deg "
              "--set 'actuator.stop={stiffness: 2.78e5 N/m, damping: 6.07 N.s/m}' --set "
              "machine.spring_stiffness=1.28e4N/m --set run.until=60ms --quiet");
  EXPECT(r.status == 4 && count_lines(r.err) == 1, "%d %s", r.status, r.err);
  EXPECT(strstr(r.err, "no share is found within the search's budget of 300 cycles") &&
             strstr(r.err, "lies between 0.1 and 0.6") && strstr(r.err, "write load.fraction"),
         "%s", r.err);
  free_ran(&r);
}

/* What events name is changed; what they do not stays as it was found. */
static void events_behind_auto(void) {
  static const char SCENE[] = LOADED "--set firing.angle=120deg --tier switched --set "
                                     "run.until=0.1s --json --reproducible --quiet";
  ran a = run("run %s --set load.fraction=auto --set 'events.a={kind: load, at: 50ms, volume: "
              "500cm3}'",
              SCENE);
  EXPECT(a.status == 0, "%s", a.err);
  ran b = run("run %s --set load.fraction=%.15g --set 'events.a={kind: load, at: 50ms, volume: "
              "500cm3}'",
              SCENE, number_in(a.out, "load_fraction"));
  CLOSE(number_in(a.out, "load_J"), number_in(b.out, "load_J"), 1e-6);
  CLOSE(number_in(a.out, "p_min"), number_in(b.out, "p_min"), 1e-9);
  free_ran(&a), free_ran(&b);
}

/* ---- bad input ---- */

static void what_is_refused(void) {
  refuse("run paper --set load.fraction=auto", "no orbit", "",
         (const char *[]){"load.fraction: auto", "firing.every: 1"}, __LINE__);
  refuse("steady lds_v203 --set load.fraction=auto", "no load", "",
         (const char *[]){"load.fraction", "no load"}, __LINE__);
  refuse("modes paper --set firing.every=1 --set load.fraction=auto", "modes", "",
         (const char *[]){"modes wants a number", NULL}, __LINE__);
  refuse("export paper --set firing.every=1 --set load.fraction=auto -o x.cir", "export", "",
         (const char *[]){"export wants a number", NULL}, __LINE__);
  refuse("run paper --set 'events.a={kind: load, at: 1ms}'", "nothing named", "",
         (const char *[]){"events.a", "'fraction' or 'volume'"}, __LINE__);
  refuse("run paper --set 'events.a={kind: load, at: 1ms, fraction: 2}'", "too much", "",
         (const char *[]){"events.a.fraction", "out of range"}, __LINE__);
  refuse("run paper --set 'events.a={kind: load, at: 1ms, fraction: 0}' --set 'events.b={kind: "
         "load, at: 1ms, volume: 1cm3}'",
         "two at once", "", (const char *[]){"events.b", "clashes"}, __LINE__);
  refuse("run solenoid --set 'events.a={kind: load, at: 1ms, fraction: 1}'", "no load", "",
         (const char *[]){"events.a", "no load"}, __LINE__);
}

static const char BOWL[] =
    "title: bowl\n"
    "coordinates: {x: {unit: m}}\n"
    "parameters: {bowl: {default: 3 kg}, spring: {default: 300 kN/m}}\n"
    "mass: bowl\ndamping: 20 N.s/m\nstiffness: spring\ngap: {along: {x: 1}}\n"
    "load: {adds: bowl, to: [mass]%s}\n"
    "actuator: {gap: 2 mm, pole_cover: 0.2 mm, inductance: 0.8 H, resistance: 20 ohm}\n";

static void keys_of_a_machine(void) {
  char text[800];
  write_file("s.yaml", "machine: {model: bowl.yaml}\nload: {fraction: auto}\n"
                       "firing: {every: 1, angle: 140 deg}\nrun: {tier: switched}\n"
                       "supply: {voltage: 440 V}\n");
  snprintf(text, sizeof text, BOWL, "");
  write_file("bowl.yaml", text);
  refuse("steady s.yaml", "no load.along",
         "s.yaml:2:18:", (const char *[]){"load.fraction", "no load.along"}, __LINE__);
  snprintf(text, sizeof text, BOWL, ", along: x, up: x*sqrt(2)/2, forward: x*sqrt(2)/2");
  write_file("bowl.yaml", text);
  ran r = run("steady s.yaml --json");
  EXPECT(r.status == 0, "%s", r.err);
  CLOSE(number_in(r.out, "throw_number"), number_in(r.out, "throw_coefficient") / sqrt(2), 1e-9);
  free_ran(&r);
  snprintf(text, sizeof text, BOWL, ", along: abs(x)");
  write_file("bowl.yaml", text);
  refuse("run s.yaml", "not linear", "bowl.yaml:8:", (const char *[]){"abs(x)", "linear"},
         __LINE__);
  snprintf(text, sizeof text, BOWL, ", up: 2 kg");
  write_file("bowl.yaml", text);
  refuse("run s.yaml", "no length", "bowl.yaml:8:", (const char *[]){"load.up", "m"}, __LINE__);
}

static void a_change_of_nothing(void) {
  ran r = run("run paper --set 'events.a={kind: load, at: 1ms, fraction: 0.5}' --set "
              "run.until=20ms --quiet --json");
  CU_ASSERT(r.status == 0 && strstr(r.out, "events.a: the load is 0 kg before and after it"));
  free_ran(&r);
}

/* The share of auto is not known yet where events are read: an event that names a fraction may
 * change it, whichever it is. */
static void a_change_of_auto(void) {
  static const char SCENE[] = "run " LOADED "--set firing.angle=120deg --set run.until=20ms --tier "
                              "switched --json --quiet --set load.fraction=auto --set "
                              "'events.a={kind: load, at: 5ms, %s}'";
  ran r = run(SCENE, "fraction: 0.1"), same = run(SCENE, "volume: 380cm3");
  EXPECT(r.status == 0, "%d: %s", r.status, r.err);
  CU_ASSERT(number_in(r.out, "load_fraction") > 0.11);
  CU_ASSERT(!strstr(r.out, "nothing changes"));
  CU_ASSERT(strstr(same.out, "the load is the same before and after it") != NULL);
  free_ran(&r), free_ran(&same);
}

/* ---- the page's example ---- */

/* Copy of the first fenced block of that kind behind `at`. */
static char *block(const char *at, const char *kind) {
  char fence[32];
  snprintf(fence, sizeof fence, "\n```%s\n", kind);
  const char *begin = at ? strstr(at, fence) : NULL;
  CU_ASSERT_PTR_NOT_NULL_FATAL(begin);
  char *text = vs_copy(begin + strlen(fence));
  *strstr(text, "\n```") = '\0';
  return text;
}

static void the_page(void) {
  char *page = read_file(VS_TEST_FOLDER "/../docs/power.md");
  const char *load = strstr(page, "\n## The load");
  char *yaml = block(load, "yaml"), *lines = block(load, "sh"), *rest = lines, *line;
  char *text = block(load, "text"), *expected = text;
  vs_text said = {0};
  write_file("charge.yaml", yaml);
  while ((line = strsep(&rest, "\n"))) {
    ran r = run("%s", line + strlen("vibrospice "));
    EXPECT(r.status == 0, "%s: %s", line, r.err);
    vs_text_add(&said, "%s", r.out);
    free_ran(&r);
  }
  while ((line = strsep(&expected, "\n"))) EXPECT(strstr(said.text, line), "not said: %s", line);
  vs_text_free(&said);
  free(text), free(lines), free(yaml), free(page);
}

static const vs_test TESTS[] = {
    {"an event is two runs", an_event_is_two_runs},
    {"what arrives has the trough's velocity", momentum_and_energy},
    {"on and off", on_and_off},
    {"an event at work", an_event_at_work},
    {"numbers of the throw", numbers_of_the_throw},
    {"range of the conveying speed", range_of_the_speed},
    {"a warning where it matters", a_warning_where_it_matters},
    {"auto is the share of its own orbit", the_share_of_its_own_orbit},
    {"auto is held at the ends", held_at_the_ends},
    {"two shares", two_shares},
    {"the circuit's own orbit", the_share_of_the_circuit},
    {"a budget is spent", a_budget_is_spent},
    {"events behind auto", events_behind_auto},
    {"what is refused", what_is_refused},
    {"keys of a machine", keys_of_a_machine},
    {"a change of nothing", a_change_of_nothing},
    {"a change of auto", a_change_of_auto},
    {"the page's example", the_page},
};

int main(void) {
  return program_suite("the load", TESTS, COUNT(TESTS));
}
