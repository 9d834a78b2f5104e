/* SPDX-License-Identifier: GPL-3.0-or-later
 * Leaving ngspice where the circuit remembers more than the snubbers do: an L-C hardly damped at or
 * near the mains' frequency, in the deck or in a subcircuit of an included file, and timers that
 * throw a switch. Either ngspice is not left, or what is told, extremes of the devices too, is that
 * of the run that stays, within the bound. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "suite.h"

static const int CHANNELS[] = {VS_CH_P, VS_CH_U, VS_CH_W, VS_CH_PHI, VS_CH_FORCE, VS_CH_I};
enum { N_CHANNELS = COUNT(CHANNELS), MOST_SAMPLES = 10001, N_SETS = 8 };
static const double SAMPLE_S = 4e-4;

typedef struct course {
  int count, times;
  double first_s, bound;
  double y[MOST_SAMPLES][N_CHANNELS];
} course;

static vs_status record(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  course *c = ctx;
  if (step->event[1] == VS_EV_QUIET) {
    if (!c->times++) c->first_s = step->event_s[1];
    c->bound = fmax(c->bound, step->bound);
  }
  if (step->event[1] == VS_EV_BACK) c->bound = fmax(c->bound, step->bound);
  for (; c->count < MOST_SAMPLES && c->count * SAMPLE_S <= step->to->t_s; c->count++) {
    double all[VS_CH_MOST];
    vs_step_at(step, c->count * SAMPLE_S, all);
    for (int k = 0; k < N_CHANNELS; k++) c->y[c->count][k] = all[CHANNELS[k]];
  }
  return VS_OK;
}

static course left, stayed; /* too large for the stack */

static vs_trial *run(const char *const *sets, const char *leave, course *c) {
  const char *all[N_SETS + 2] = {NULL};
  char key[64];
  size_t n = 0;
  for (; sets[n]; n++) all[n] = sets[n];
  snprintf(key, sizeof key, "run.leave_circuit=%s", leave);
  all[n] = key;
  memset(c, 0, sizeof *c);
  const vs_observer observer = {c, record};
  return vs_trial_run("paper", "circuit", all, &observer);
}

/* What is told, in parts of its peak. */
static double difference(const course *a, const course *b) {
  double worst = 0;
  int count = a->count < b->count ? a->count : b->count;
  for (int k = 0; k < N_CHANNELS; k++) {
    double peak = 0, off = 0;
    for (int n = 0; n < count; n++) {
      peak = fmax(peak, fabs(b->y[n][k]));
      off = fmax(off, fabs(a->y[n][k] - b->y[n][k]));
    }
    worst = fmax(worst, off / peak);
  }
  return worst;
}

/* An extreme is of a signal whose peak is the larger of its two; below 1 V and 0.1 A the solver
 * tells nothing apart (engine/macromodel/oneport_macromodel.c), a third of which counts as a peak.
 */
static double extremes_off(const vs_trial *a, const vs_trial *b) {
  double worst = 0;
  for (int k = 0; k < a->result.watchers.measures->n_extremes; k++) {
    const vs_extreme *x = &a->result.watchers.measures->extremes[k],
                     *y = &b->result.watchers.measures->extremes[k];
    const char *unit = vs_channel_at(&a->scene.frame, x->channel).unit;
    double peak = 0, least = !strcmp(unit, "V") ? 1.0 / 3 : !strcmp(unit, "A") ? 0.1 / 3 : 0;
    for (int n = 0; n < a->result.watchers.measures->n_extremes; n++)
      if (b->result.watchers.measures->extremes[n].channel == y->channel)
        peak = fmax(peak, fabs(b->result.watchers.measures->extremes[n].best.value));
    if (!(peak > 0)) continue;
    worst = fmax(worst, fabs(x->best.value - y->best.value) / fmax(peak, least));
  }
  return worst;
}

/* halfwave_snubbed, or another, with lines put before the EVA's. */
static void make_deck(const char *deck, const char *lines) {
  char path[512], text[16384];
  snprintf(path, sizeof path, "%s/../spice/%s.cir", VS_TEST_FOLDER, deck);
  FILE *in = fopen(path, "r");
  CU_ASSERT_PTR_NOT_NULL_FATAL(in);
  size_t n = fread(text, 1, sizeof text - 1, in);
  fclose(in);
  text[n] = '\0';
  char *eva = strstr(text, "Xeva ");
  FILE *out = fopen("d.cir", "w");
  fprintf(out, "%.*s%s\n%s", (int)(eva - text), text, lines, eva);
  fclose(out);
}

typedef struct scene {
  const char *where; /* "across the EVA", ... */
  const char *deck, *node, *other;
  double f_hz, tau_s;
  bool series, included;
} scene;

/* An L-C of 2 H, parallel to the two nodes behind 20 kohm, or in series, with tau = 2 L/R. */
static void write_scene(const scene *s) {
  char lines[1024], part[1024];
  double l = 2, w = 2 * M_PI * s->f_hz, c = 1 / (w * w * l);
  if (s->series)
    snprintf(part, sizeof part, "Rs %%s m1 %.6g\nLs m1 m2 %.6g ic=0\nCs m2 %%s %.9g ic=0\n",
             2 * l / s->tau_s, l, c);
  else
    snprintf(part, sizeof part,
             "Rp %%s m1 20k\nLp m1 m2 %.6g ic=0\nRl m2 %%2$s %.6g\nCp m1 %%2$s %.9g ic=0\n", l,
             2 * l / s->tau_s, c);
  if (s->included) {
    FILE *f = fopen("lc.inc", "w");
    fprintf(f, ".subckt lc a b\n");
    fprintf(f, part, "a", "b");
    fprintf(f, ".ends lc\n");
    fclose(f);
    snprintf(lines, sizeof lines, ".include lc.inc\nXlc %s %s lc", s->node, s->other);
  } else {
    int n = snprintf(lines, sizeof lines,
                     "*$ probe  v_lc = v(%s%s%s)  V  \"of the L-C\"\n*$ store c_lc = "
                     "%.9g*v(%s%s%s)^2/2\n",
                     s->series ? "m2" : "m1", strcmp(s->other, "0") ? "," : "",
                     strcmp(s->other, "0") ? s->other : "", c, s->series ? "m2" : "m1",
                     strcmp(s->other, "0") ? "," : "", strcmp(s->other, "0") ? s->other : "");
    snprintf(lines + n, sizeof lines - (size_t)n, part, s->node, s->other);
  }
  make_deck(s->deck, lines);
}

typedef struct seen {
  bool left;
  double bound, off, extremes; /* relative to the peaks */
  double first_s;
} seen;

static seen compare_runs(const char *const *sets) {
  seen s = {0};
  vs_trial *a = run(sets, "when_quiet", &left);
  EXPECT(a->status == VS_OK || strstr(a->err.text, "pole cover"), "%s", a->err.text);
  s.left = left.times > 0;
  if (s.left) {
    vs_trial *b = run(sets, "never", &stayed);
    EXPECT(b->status == a->status, "%s", b->err.text);
    s.bound = left.bound;
    s.first_s = left.first_s;
    s.off = difference(&left, &stayed);
    s.extremes = extremes_off(a, b);
    vs_trial_free(b);
  }
  vs_trial_free(a);
  return s;
}

static bool table_wanted(void) {
  return getenv("VS_LONG");
}

static void run_scene(const scene *s, const char *until) {
  char key[64];
  snprintf(key, sizeof key, "run.until=%s", until);
  const char *sets[] = {"circuit.deck=d.cir", key, NULL};
  write_scene(s);
  seen r = compare_runs(sets);
  double part = r.left ? fmax(r.off, r.extremes) / r.bound : 0;
  if (table_wanted())
    printf(
        "\n%-16s %-18s %-8s %-8s %4g Hz %4g s: %s at %.3f s, bound %.2e, off %.2e, extremes %.2e, "
        "ratio %.2g",
        s->deck, s->where, s->series ? "series" : "parallel", s->included ? "included" : "deck",
        s->f_hz, s->tau_s, r.left ? "left" : "stays", r.first_s, r.bound, r.off, r.extremes, part);
  EXPECT(part <= 1, "L-C %s, %s, %g Hz, %g s: off by %.2g, extremes by %.2g, bound %.2g", s->where,
         s->series ? "series" : "parallel", s->f_hz, s->tau_s, r.off, r.extremes, r.bound);
}

static void resonances(void) {
  static const scene PLACES[] = {
      {"across the EVA", "halfwave_snubbed", "b", "0", 50, 10, false, false},
      {"across the EVA", "halfwave_snubbed", "b", "0", 50, 10, true, false},
      {"across the line", "halfwave_snubbed", "a", "0", 50, 10, false, false},
      {"the thyristor", "halfwave_snubbed", "a", "b", 50, 10, false, false},
      {"across the line", "halfwave_bare", "a", "0", 50, 10, false, false},
      {"across the EVA", "halfwave_bare", "b", "0", 50, 10, false, false},
      {"across the EVA", "fullwave_antiparallel", "k", "0", 50, 10, false, false},
  };
  static const double HZ[] = {45, 48, 49.5, 50, 50.3, 53, 55}, TAU_S[] = {0.5, 2, 10, 30};
  if (!table_wanted()) return;
  size_t number = 0;
  for (size_t p = 0; p < COUNT(PLACES); p++)
    for (size_t f = 0; f < COUNT(HZ); f++)
      for (size_t t = 0; t < COUNT(TAU_S); t++) {
        scene s = PLACES[p];
        s.f_hz = HZ[f];
        s.tau_s = TAU_S[t];
        s.included = number++ % 2;
        if (getenv("VS_FEW") && number % (size_t)atoi(getenv("VS_FEW")) != 1) continue;
        run_scene(&s, "2s");
      }
}

static void a_few_resonances(void) {
  static const scene ROWS[] = {
      {"across the EVA", "halfwave_snubbed", "b", "0", 50, 10, false, false},
      {"across the line", "halfwave_snubbed", "a", "0", 50, 10, false, true},
      {"across the EVA", "halfwave_snubbed", "b", "0", 49.5, 30, false, true},
      {"the thyristor", "halfwave_snubbed", "a", "b", 50, 0.5, false, false},
  };
  if (table_wanted()) return;
  for (size_t k = 0; k < COUNT(ROWS); k++) run_scene(&ROWS[k], "0.5s");
}

/* ---- what nobody names ---- */

/* A timer of 40 s towards 100 V: it passes 1 V after 0.4 s and then makes the thyristor's gate its
 * own, or, drawn from the mains by a diode, does so. */
static const char TIMER[] = ".subckt timer a b\n"
                            "Vown s 0 100\nRt s t 40meg\nCt t 0 1u ic=0\n"
                            "Sx a b t 0 late off\n.model late sw(ron=100 roff=1g vt=1 vh=0)\n"
                            ".ends timer\n",
                  PUMPED[] = ".subckt timer a b\n"
                             "Dp a s pump\n.model pump d(is=1n)\nRt s t 3g\nCt t 0 1u ic=0\n"
                             "Sx a b t 0 late off\n.model late sw(ron=100 roff=1g vt=0.02 vh=0)\n"
                             ".ends timer\n",
                  NESTED[] = ".subckt timer a b\n.subckt clock t\n"
                             "Vown s 0 100\nRt s t 40meg\nCt t 0 1u ic=0\n.ends clock\n"
                             "Xc t clock\n"
                             "Sx a b t 0 late off\n.model late sw(ron=100 roff=1g vt=1 vh=0)\n"
                             ".ends timer\n",
                  JUNCTION[] = ".subckt timer a b\n"
                               "Vown s 0 100\nRt s t 40meg\nDt 0 t big\n"
                               ".model big d(is=1e-16 cjo=1u m=0.01)\n"
                               "Sx a b t 0 late off\n.model late sw(ron=100 roff=1g vt=1 vh=0)\n"
                               ".ends timer\n",
                  INDUCTOR[] = ".subckt timer a b\n"
                               "Vown s 0 1u\nLt s s2 1 ic=0\nVs s2 0 0\n"
                               "Wx a b Vs late off\n.model late csw(ron=100 roff=1g it=0.4u ih=0)\n"
                               ".ends timer\n";

static void timers(void) {
  static const char *const TIMERS[] = {TIMER, PUMPED, NESTED, JUNCTION, INDUCTOR};
  static const char *const DECKS[] = {"halfwave_snubbed", "halfwave_bare"};
  for (size_t d = 0; d < COUNT(DECKS); d++)
    for (size_t k = 0; k < COUNT(TIMERS); k++) {
      if (!table_wanted() && (d + k) % COUNT(DECKS)) continue; /* each of them in one deck */
      static const char *const SETS[] = {"circuit.deck=d.cir", "run.until=0.6s", NULL};
      write_file("timer.inc", TIMERS[k]);
      make_deck(DECKS[d], ".include timer.inc\nXtimer a b timer");
      seen s = compare_runs(SETS);
      EXPECT(!s.left || fmax(s.off, s.extremes) <= s.bound, "%s, timer %zu: off by %g, bound %g",
             DECKS[d], k, fmax(s.off, s.extremes), s.bound);
    }
}

/* A hold-up capacitor of 94 uF that a relay watches: where it drifts to the relay's level within
 * the run, ngspice is not left; where the level is far from it, ngspice is. The relay is a switch
 * by voltage or by current, a source whose formula has a branch or is steep, or a transistor. A
 * formula's level is not read, so that it keeps ngspice wherever it is. A formula is steep by a
 * power, an exponential, the kink of an absolute value, a product of two signals, or in a
 * resistance; it may make a switch's control. Left in the solver's absence, each was off by up to
 * 70 times the bound that was told. What is linear in the capacitor's voltage need not keep
 * ngspice. */
static void relays(void) {
  static const char HOLD[] = "*$ probe v_hold = v(rc) V\n*$ store hold = 94e-6*v(rc)^2/2\n"
                             "*$ loss bleed = v(rc)^2/10e6\n"
                             "Rbleed rc rs 10meg\nVbleed rs 0 0\nCh rc 0 94u ic=325\n";
  static const struct {
    const char *relay;
    bool leaves;
  } ROWS[] = {
      {"Sx b bx 0 rc low off\nRx bx 0 3k\n.model low sw(ron=1 roff=1e12 vt=-324.9 vh=0.01)", false},
      {"Sx b bx 0 rc low off\nRx bx 0 3k\n.model low sw(ron=1 roff=1e12 vt=-300 vh=1)", true},
      {"Sx b bx 0 rc low off\nRx bx 0 3k\n.model low sw(ron=1 roff=1e12 vt=-300 vh=24.9)", false},
      {"Sx b bx 0 rc low off\nRx bx 0 3k\n.model low sw(ron=1 roff=1e12 vt={-324.9} vh=0.01)",
       false},
      {"Wx b bx Vbleed low on\nRx bx 0 3k\n.model low csw(ron=1e12 roff=1 it=32.49u ih=0)", false},
      {"Bx b 0 I = v(rc) < 324.9 ? v(b)/3k : 0", false},
      {"Gx b 0 value={u(324.9-v(rc))*v(b)/3k}", false},
      {".func low(x) {x < 324.9 ? 1 : 0}\nBx b 0 I = low(v(rc))*v(b)/3k", false},
      {".func low(x) {x < 324.9 ? 1 : 0}\n.func of(y) {low(y)/3k}\nBx b 0 I = of(v(rc))*v(b)",
       false},
      {"Bx b 0 I = (1+tanh(1e4*(324.9-v(rc))))*v(b)/6k", false},
      {"Mx bx rc 0 0 mm\nRx b bx 3k\n.model mm nmos(vto=324.85 kp=100 lambda=0)", false},
      {".func low() {u(324.9-v(rc))}\nBx b 0 I = low()*v(b)/3k", false},
      {".func low(x) {x/3k}\nBx b 0 I = low(v(b))", true},
      {"Bx b 0 I = exp(100*(324.9-v(rc)))*v(b)/3e6", false},
      {"Bx b 0 I = pow(325-v(rc),4)*100*v(b)/3k", false},
      {"Bx b 0 I = (abs(324.9-v(rc))+324.9-v(rc))*v(b)/300", false},
      {"Bx b 0 I = (325-v(rc))*(325-v(rc))*v(b)/300", false},
      {"Rx b 0 R='3k/(1e-6+exp(100*(324.9-v(rc))))'", false},
      {"Bc ctl 0 V = exp(100*(324.9-v(rc)))\nSx b bx ctl 0 low off\nRx bx 0 3k\n"
       ".model low sw(ron=1 roff=1e12 vt=1 vh=0.01)",
       false},
      {"E1 e 0 vol='pow(325-v(rc),4)'\nRe e 0 1k\nGx 0 b e 0 1m", false},
      {"Ex e 0 POLY(1) rc 0 0 0 1u\nRe e 0 1k", false},
      {"Bx x 0 V = {2}*(v(b)-v(rc))/3k+1m\nRx x 0 1k", true},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    const bool is_read = strchr("SWM", *ROWS[k].relay); /* its level is met within 0.48 s, or not */
    const char *sets[] = {"circuit.deck=d.cir", is_read ? "run.until=0.48s" : "run.until=0.2s",
                          "run.tolerance=1e-3", NULL};
    char lines[1024];
    snprintf(lines, sizeof lines, "%s%s", HOLD, ROWS[k].relay);
    make_deck("halfwave_snubbed", lines);
    vs_trial *t = run(sets, "when_quiet", &left);
    EXPECT(t->status == VS_OK && (left.times > 0) == ROWS[k].leaves, "relay %zu: left %d times, %s",
           k, left.times, t->err.text);
    vs_trial_free(t);
  }
}

/* What no signal shows, and what cannot be told from one that does not. */
static void not_to_be_seen(void) {
  static const char *const LINES[] = {
      "Tline y 0 z 0 z0=50 td=3m\nRy y 0 50\nRz z 0 50",
      ".model keeps int(in_offset=0 gain=1 out_lower_limit=-1e9 out_upper_limit=1e9 limit_range=1n "
      "out_ic=0)\nAint y z keeps\nRy y 0 1k\nRz z 0 1k",
      ".model halves hyst(in_low=0 in_high=1)\nAh y z halves\nRy y 0 1k\nRz z 0 1k",
      ".model bends pwl(x_array=[0 1 2] y_array=[0 0 1] input_domain=1u fraction=false)\nAp y z "
      "bends\nRy y 0 1k\nRz z 0 1k",
      ".model cuts limit(gain=1e4 out_lower_limit=0 out_upper_limit=1 limit_range=1m)\nAl y z "
      "cuts\nRy y 0 1k\nRz z 0 1k",
  };
  for (size_t k = 0; k < COUNT(LINES); k++) {
    static const char *const SETS[] = {"circuit.deck=d.cir", "run.until=0.2s", NULL};
    make_deck("halfwave_snubbed", LINES[k]);
    vs_trial *t = run(SETS, "when_quiet", &left);
    EXPECT(t->status == VS_OK && left.times == 0, "line %zu: %s", k, t->err.text);
    vs_trial_free(t);
  }
}

/* The shipped decks leave, a part's inner charges and all, and about as early as they did. */
static void still_left(void) {
  static const struct {
    const char *deck, *set;
    double latest_s;
  } ROWS[] = {{"halfwave_snubbed", "run.tolerance=1e-4", 0.12},
              {"halfwave_bare", "run.tolerance=1e-4", 0.075},
              {"fullwave_antiparallel", "run.tolerance=1e-4", 0.12}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char deck[64];
    snprintf(deck, sizeof deck, "circuit.deck=%s", ROWS[k].deck);
    const char *sets[] = {deck, ROWS[k].set, "run.until=0.6s", NULL};
    seen s = compare_runs(sets);
    EXPECT(s.left && s.first_s < ROWS[k].latest_s, "%s: at %g s", ROWS[k].deck, s.first_s);
    EXPECT(fmax(s.off, s.extremes) <= s.bound, "%s: off by %g, extremes %g, bound %g", ROWS[k].deck,
           s.off, s.extremes, s.bound);
  }
}

static const vs_test TESTS[] = {
    {"timers", timers},
    {"relays", relays},
    {"not to be seen", not_to_be_seen},
    {"still left", still_left},
    {"a few resonances", a_few_resonances},
    {"resonances (long)", resonances},
};
VS_SUITE_MAIN("leaving", TESTS)
