/* SPDX-License-Identifier: GPL-3.0-or-later
 * What means are over: the scene's section measure, and that a mean over one shot is not held
 * against a limit for ever. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"
#include "measure/verdict.h"

/* A resistor across the mains of 100 V rms. */
static const char DECK[] = "*$ port mains = Vm\n*$ probe v_r = v(a) V\n"
                           "*$ device r1 resistor = v(a), v(a)/100\n*$ device c1 capacitor = v(a), "
                           "v(a)/100\nVm a 0 external\nR1 a 0 100\nRe a e 1meg\nXeva e 0 eva\n";

/* The mean of v^2 over a stretch: exact for straight lines between knots, which is what all
 * watchers of devices take it for. */
typedef struct mean_square {
  double from_s, to_s, sum;
} mean_square;

static vs_status look(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  mean_square *m = ctx;
  double t0 = step->from->t_s, t1 = step->to->t_s, h = t1 - t0;
  double from = fmax(t0, m->from_s), to = fmin(t1, m->to_s);
  if (!(to > from)) return VS_OK;
  double v0 = step->from->terms[0], slope = (step->to->terms[0] - v0) / h;
  double a = v0 + slope * (from - t0), b = v0 + slope * (to - t0);
  m->sum += (to - from) * (a * a + a * b + b * b) / 3;
  return VS_OK;
}

static double measure_of(const vs_trial *t, const char *name) {
  for (size_t n = 0; n < t->result.watchers.devices->item[0].count; n++) {
    const vs_reduced *r = &t->result.watchers.devices->item[0].reduced[n];
    if (!strcmp(r->measure->name, name)) return r->value.value;
  }
  return NAN;
}

/* 1e-12: rounding of some hundred terms. The sine's own integral is met to 1e-3 by straight lines
 * over steps of up to a fortieth of a cycle. */
static void means_are_over_it_exactly(void) {
  static const struct {
    const char *measure;
    double from_s, to_s;
  } ROWS[] = {{"run.until=0.1s", 0, 0.1},
              {"measure={from: 31.234 ms}", 0.031234, 0.1},
              {"measure={to: 31.234 ms}", 0, 0.031234},
              {"measure={from: 12.345 ms, to: 67.891 ms}", 0.012345, 0.067891},
              {"measure={from: 50.00001 ms, to: 50.00002 ms}", 0.05000001, 0.05000002},
              {"measure={last: 1 cycle}", 0.08, 0.1},
              {"measure={last: 2.5 cycles}", 0.05, 0.1},
              {"measure={last: 5 cycles}", 0, 0.1}};
  write_file("mains.cir", DECK);
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    mean_square m = {ROWS[k].from_s, ROWS[k].to_s, 0};
    vs_observer observer = {&m, look};
    const char *sets[] = {"circuit.deck=mains.cir", "run.until=0.1s", "supply.voltage=100V",
                          ROWS[k].measure, NULL};
    vs_trial *t = vs_trial_run("paper", "circuit", sets, &observer);
    CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
    double span = m.to_s - m.from_s, w = 4 * M_PI * 50;
    double sine = 100 * (1 - (sin(w * m.to_s) - sin(w * m.from_s)) / (w * span));
    CLOSE(measure_of(t, "power"), m.sum / span / 100, span < 1e-6 ? 1e-8 : 1e-12);
    CLOSE_OF(measure_of(t, "power"), sine, 100, 1e-3);
    CLOSE(measure_of(t, "energy"), 10, 1e-3); /* over the run: 100 W for 0.1 s */
    vs_trial_free(t);
  }
}

static void what_is_wrong_is_refused(void) {
  static const struct {
    const char *measure, *at, *says;
  } ROWS[] = {{"{from: 0.2 s, to: 0.1 s}", "bad.yaml:2:17: ", "measure.from: 0.2 s"},
              {"{from: 0.1 s, to: 0.1 s}", "bad.yaml:2:17: ", "measure.from: 0.1 s"},
              {"{to: 3 s}", "bad.yaml:2:15: ", "beyond run.until = 2 s"},
              {"{from: 2 s}", "bad.yaml:2:17: ", "not before the end"},
              {"{from: 1 s, last: 5 cycles}", "bad.yaml:2:", "beside from"},
              {"{last: 101 cycles}", "bad.yaml:2:17: ", "more than run.until"},
              {"{last: 0 cycles}", "bad.yaml:2:17: ", "none"},
              {"{last: 5}", "bad.yaml:2:17: ", "5 cycles"},
              {"{last: 5 s}", "bad.yaml:2:17: ", "cycles"},
              {"{from: 5 cycles}", "bad.yaml:2:17: ", "wrong unit"},
              {"{form: 0.1 s}", "bad.yaml:2:11: ", "did you mean 'from'"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char text[256];
    snprintf(text, sizeof text, "run: {tier: circuit}\nmeasure: %s\n", ROWS[k].measure);
    write_file("bad.yaml", text);
    ran r = run("check bad.yaml");
    EXPECT(r.status == 2 && !strncmp(r.err, ROWS[k].at, strlen(ROWS[k].at)) &&
               strstr(r.err, ROWS[k].says),
           "%s: status %d, %s", ROWS[k].measure, r.status, r.err);
    free_ran(&r);
  }
}

static void table_and_json_say_it(void) {
  write_file("mains.cir", DECK);
  ran r = run("run paper --quiet --json --set circuit.deck=mains.cir --set run.until=0.1s "
              "--set supply.voltage=100V --set 'measure={from: 20 ms, to: 60 ms}'");
  EXPECT(strstr(r.out, "\"measure\": {\"from_s\": 0.02, \"to_s\": 0.06}"), "%s", r.out);
  free_ran(&r);
  r = run("run paper --set circuit.deck=mains.cir --set run.until=0.1s "
          "--set supply.voltage=100V --set 'measure={last: 2 cycles}' --all");
  EXPECT(strstr(r.out, "means  over 0.06..0.1 s"), "%s", r.out);
  free_ran(&r);
  r = run("run paper --json --tier switched");
  EXPECT(strstr(r.out, "\"measure\": {\"from_s\": 0, \"to_s\": 2}"), "%s", r.out);
  free_ran(&r);
}

/* ---- one shot ---- */

/* Is i_rms of the thyristor judged, and if not, why? */
static void judged(const char *const *more, const char *why) {
  const char *sets[8] = {"circuit.deck=gated.cir", "run.tolerance=1e-2"};
  for (size_t k = 0; more[k]; k++) sets[2 + k] = more[k];
  vs_trial *t = vs_trial_run("paper", "circuit", sets, NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  if (!t->status) {
    const vs_watched *w = &t->result.watchers.devices->item[0];
    for (size_t k = 0; k < w->count; k++) {
      const vs_reduced *r = &w->reduced[k];
      if (strcmp(r->measure->name, "i_rms")) continue;
      EXPECT(!r->limit == (why != NULL), "%s: judged or not", more[0]);
      EXPECT(why ? r->unjudged && !strcmp(r->unjudged, why) : !r->unjudged, "%s: %s", more[0],
             r->unjudged ? r->unjudged : "judged");
    }
  }
  vs_trial_free(t);
}

static void one_shot_is_no_current_to_rate(void) {
  write_gated_deck();
  static const char ONCE[] = "not judged: one shot",
                    SHORT[] = "not judged: over less than 1 s; vibrospice "
                              "steady SCENE judges it";
  judged((const char *[]){"firing.every=once", "run.until=1.1s", NULL}, ONCE);
  judged((const char *[]){"firing.every=25", "run.until=1.3s", NULL}, NULL);
  judged((const char *[]){"firing.every=25", "run.until=1.3s", "measure={from: 0.6 s}", NULL},
         SHORT);
  judged((const char *[]){"firing.every=60", "run.until=1.3s", "measure={from: 0.2 s}", NULL},
         ONCE);
  judged((const char *[]){"firing.every=100", "run.until=1.3s", "measure={from: 0.2 s}", NULL},
         ONCE);
}

static void table_and_json_say_why(void) {
  write_gated_deck();
  for (int json = 0; json < 2; json++) {
    ran r = run("run paper --set circuit.deck=gated.cir --set run.tolerance=1e-2 --set "
                "run.until=1.1s --set 'waive=[thyristor.v_drm, thyristor.v_rrm, thyristor.dv_dt, "
                "thyristor.di_dt, thyristor.i_tsm, thyristor.i2t, thyristor.t_q]'%s",
                json ? " --json" : " --all");
    const char *line = strstr(r.out, json ? "\"thyristor.i_rms\": {" : "  thyristor.i_rms ");
    const char *said = line ? strstr(line, "not judged: one shot") : NULL;
    EXPECT(r.status == 0 && said && said < strchr(line, '\n'), "%s%s", r.out, r.err);
    free_ran(&r);
  }
}

/* ---- windows ---- */

/* A resistor of a real part, 100 ohm across the mains of 100 V: 100 W of 90 W or of 110 W. */
static void write_rated_deck(double p_max_w) {
  vs_text part = {0};
  vs_text_add(&part,
              "*$ part resistor \"R\"\n*$ limit p_rated = %g W\n.subckt rr a b\nR1 a b "
              "100\n.ends\n",
              p_max_w);
  write_file("rr.inc", part.text);
  vs_text_free(&part);
  write_file("rated.cir", "*$ param r = rr part\n*$ port mains = Vm\n*$ probe v_r = v(a) V\n"
                          "*$ device r = v(a), v(a)/100\n*$ line a\nVm a 0 external\nXr a 0 r\n"
                          "Re a e 1meg\nXeva e 0 eva\n");
}

/* The mains are 1.2 times as high for 100 ms: a value over the whole would be off, and over less
 * than 1 s nothing is said. What is judged is behind the event. */
static void behind_an_event(void) {
  static const struct {
    const char *until, *says;
    double p_max_w;
    int status;
  } ROWS[] = {{"1.3s", "r.power", 99, 3},
              {"1.3s", "r.power", 101, 0},
              {"0.9s", "over less than 1 s", 99, 0},
              {"1.1s", "less than 1 s behind an event", 99, 0}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    write_rated_deck(ROWS[k].p_max_w);
    ran r = run("run paper --set circuit.deck=rated.cir --set supply.voltage=100V --set "
                "run.until=%s --set firing.every=1 --set 'events={s: {kind: swell, at: 150 ms, "
                "duration: 60 ms, level: 130 %%}}'",
                ROWS[k].until);
    const char *line = strstr(r.out, "\n  r.power ");
    EXPECT(r.status == ROWS[k].status, "%s, %g W: %d %s%s", ROWS[k].until, ROWS[k].p_max_w,
           r.status, r.out, r.err);
    EXPECT(strstr(r.out, ROWS[k].says), "%s", r.out);
    EXPECT(k > 1 || (line && strstr(line, "from 0.22 s on") < strchr(line + 1, '\n')), "%s", r.out);
    if (line) CLOSE(strtod(line + strlen("\n  r.power "), NULL), 100, 1e-3);
    free_ran(&r);
  }
}

static const vs_test TESTS[] = {
    {"behind an event", behind_an_event},
    {"means are over it exactly", means_are_over_it_exactly},
    {"what is wrong is refused", what_is_wrong_is_refused},
    {"table and JSON say it", table_and_json_say_it},
    {"one shot is no current to rate", one_shot_is_no_current_to_rate},
    {"table and JSON say why", table_and_json_say_why},
};
int main(void) {
  return program_suite("window", TESTS, COUNT(TESTS));
}
