/* SPDX-License-Identifier: GPL-3.0-or-later
 * Power quality: currents whose harmonics are known in closed form, what is told of them, and what
 * is refused. */
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "measure/quality.h"
#include "program.h"

/* ---- closed forms ---- */

/* A current over a cycle of the mains: between two angles it is the real part of the sum of
 * size[k] exp(rate[k] a), a in rad; elsewhere it is 0. */
typedef struct form {
  double from, to;
  double complex size[2], rate[2];
} form;

static double form_at(const form *f, double a) {
  double sum = 0;
  for (int k = 0; k < 2; k++) sum += creal(f->size[k] * cexp(f->rate[k] * a));
  return a >= f->from && a <= f->to ? sum : 0;
}

/* Phasor of harmonic n: what it is the real part of is this times exp(j n a); amplitude, not rms.
 * Of 0 it is twice the mean. */
static double complex phasor(const form *f, int n) {
  double complex sum = 0;
  for (int k = 0; k < 2; k++) /* the real part is half the sum with its conjugate */
    for (int c = 0; c < 2; c++) {
      double complex size = c ? conj(f->size[k]) : f->size[k],
                     s = (c ? conj(f->rate[k]) : f->rate[k]) - (double)n * I;
      sum +=
          size / 2 * (cabs(s) > 1e-9 ? (cexp(s * f->to) - cexp(s * f->from)) / s : f->to - f->from);
    }
  return sum / M_PI;
}

/* The mean square, by Simpson's rule on many pieces. */
static double mean_square(const form *f) {
  enum { PIECES = 20000 };
  double sum = 0, h = (f->to - f->from) / PIECES;
  for (int k = 0; k <= PIECES; k++)
    sum += pow(form_at(f, fmin(f->from + k * h, f->to)), 2) * (k == 0 || k == PIECES ? 1
                                                               : k % 2               ? 4
                                                                                     : 2);
  return sum * h / 3 / (2 * M_PI);
}

/* Sizes are rms; tolerance: relative to harmonic 1. */
static void compare(const vs_quality *q, const form *f, double tolerance) {
  double first = cabs(phasor(f, 1)) / M_SQRT2, squares = 0, rms = sqrt(mean_square(f));
  for (int n = 0; n < VS_SPECTRUM_LINES; n++) {
    double complex p = n ? phasor(f, n) : phasor(f, 0) / 2;
    double size = n ? cabs(p) / M_SQRT2 : cabs(p);
    CLOSE_OF(vs_spectrum_harmonic(&q->current, n), size, first, tolerance);
    if (n > 1) squares += size * size;
    if (n && size > 1e-3 * first) /* cos(n a + phase) is sin(n a + phase + pi/2) */
      CLOSE_OF(remainder(vs_quality_phase(q, n) - carg(p) - M_PI_2, 2 * M_PI), 0, 1,
               tolerance * first / size);
  }
  vs_quality_measure m;
  for (int k = 0; vs_quality_at(q, k, false, &m); k++) {
    const char *name = strchr(m.name, '.') + 1;
    double v = m.value.value;
    EXPECT(m.value.known, "%s is not known", m.name);
    if (!strcmp(name, "i_rms")) CLOSE_OF(v, rms, first, tolerance);
    if (!strcmp(name, "i_dc")) CLOSE_OF(v, creal(phasor(f, 0)) / 2, first, tolerance);
    if (!strcmp(name, "thc")) CLOSE_OF(v, sqrt(squares), first, tolerance);
    if (!strcmp(name, "thd")) CLOSE_OF(v, sqrt(squares) / first, 1, 3 * tolerance);
    /* the voltage is a sine, cos(a - pi/2): harmonic 1 alone has power */
    double cosine = cos(carg(phasor(f, 1)) + M_PI_2);
    if (!strcmp(name, "displacement_factor")) CLOSE_OF(v, cosine, 1, 3 * tolerance);
    if (!strcmp(name, "power_factor")) CLOSE_OF(v, cosine * first / rms, 1, 3 * tolerance);
  }
}

/* Shows the current to a watcher in straight pieces, as tier circuit has them, over more than the
 * stretch. */
static void show(vs_quality *q, const vs_frame *frame, const form *f, double period_s) {
  enum { PIECES = 40000, CYCLES = 4 };
  vs_knot *a = vs_alloc(1, sizeof *a), *b = vs_alloc(1, sizeof *b);
  const double ends[] = {0, f->from, f->to, 2 * M_PI};
  for (int c = 0; c < CYCLES; c++)
    for (int part = 0; part < 3; part++)
      for (int k = 0; k < PIECES; k++) {
        double at[2], inside = part == 1;
        for (int e = 0; e < 2; e++)
          at[e] = ends[part] + (ends[part + 1] - ends[part]) * (k + e) / PIECES;
        a->t_s = period_s * (c + at[0] / (2 * M_PI));
        b->t_s = period_s * (c + at[1] / (2 * M_PI));
        a->i_mains_a = inside ? form_at(f, fmax(at[0], f->from)) : 0;
        b->i_mains_a = inside ? form_at(f, fmin(at[1], f->to)) : 0;
        const vs_step step = {.frame = frame, .from = a, .to = b};
        vs_quality_accept(q, &step);
      }
  free(a);
  free(b);
}

static void shown(const form *f) {
  static const char *const SETS[] = {"run.until=80ms", "measure={from: 20 ms, to: 60 ms}",
                                     "quality=mains", NULL};
  vs_trial *t = vs_trial_read("paper", "circuit", SETS);
  vs_quality q;
  EXPECT(!t->status && t->scene.quality.count == 1, "%s", t->err.text);
  vs_quality_begin(&q, &t->scene.quality.item[0], &t->scene.setup);
  show(&q, &t->scene.frame, f, 0.02);
  EXPECT(q.cycles == 2 && fabs(q.current.span_s - 0.04) < 1e-12, "%d cycles", q.cycles);
  /* straight pieces of a 40000th of half a cycle: (pi/4e4)^2/12 of a sine */
  compare(&q, f, 2e-9);
  vs_quality_end(&q);
  vs_trial_free(t);
}

/* sin a = Re(-j exp(j a)) */
static void half_wave(void) {
  const form f = {0, M_PI, {-3 * I, 0}, {I, 0}};
  shown(&f);
  CLOSE(cabs(phasor(&f, 0)) / 2, 3 / M_PI, 1e-14);
  CLOSE(cabs(phasor(&f, 2)), 2 * 3 / (3 * M_PI), 1e-14);
  CLOSE_OF(cabs(phasor(&f, 3)), 0, 1, 1e-14);
}

static void phase_controlled(void) {
  for (double degrees = 30; degrees < 180; degrees += 70) {
    const form f = {degrees * M_PI / 180, M_PI, {-3 * I, 0}, {I, 0}};
    shown(&f);
  }
}

/* Resistance and inductance behind an ideal thyristor that is fired at alpha: v/|Z| (sin(a - phi) -
 * sin(alpha - phi) exp(-(a - alpha)/tan(phi))), until it is 0. Tier analytic is that. */
static form inductive(double peak_v, double r, double x, double alpha) {
  double z = hypot(r, x), phi = atan2(x, r), low = M_PI, high = 2 * M_PI + alpha;
  form f = {
      alpha, high, {-I * peak_v / z * cexp(-I * phi), -peak_v / z * sin(alpha - phi)}, {I, -r / x}};
  f.size[1] *= exp(alpha * r / x);
  for (int k = 0; k < 80; k++) {
    double middle = (low + high) / 2;
    if (form_at(&f, middle) > 0)
      low = middle;
    else
      high = middle;
  }
  f.to = low;
  return f;
}

static void resistance_and_inductance(void) {
  static const char *const ANGLES[] = {"100deg", "120deg", "150deg"};
  for (size_t k = 0; k < COUNT(ANGLES); k++) {
    char angle[64];
    const char *const sets[] = {"firing.every=1",     angle,
                                "run.until=0.2s",     "measure.last=3 cycles",
                                "quality=[mains, i]", NULL};
    snprintf(angle, sizeof angle, "firing.angle=%s", ANGLES[k]);
    vs_trial *t = vs_trial_run("paper", "analytic", sets, NULL);
    EXPECT(!t->status && t->result.n_quality == 2, "%s", t->err.text);
    const vs_setup *s = &t->scene.setup;
    const form f = inductive(s->timeline.peak_v, s->model.actuator.resistance_ohm,
                             s->timeline.omega_rad_s * s->model.actuator.inductance_h,
                             atof(ANGLES[k]) * M_PI / 180);
    EXPECT(f.to < 2 * M_PI, "it conducts until %g", f.to);
    /* the tier's own error, which is below 1e-10 of the current */
    for (int n = 0; n < t->result.n_quality; n++) compare(&t->result.quality[n], &f, 1e-9);
    vs_trial_free(t);
  }
}

/* ---- runs ---- */

/* A resistor across the mains takes a sine from them, and its current is a probe. */
static void resistor(void) {
  write_file("r.cir", "*$ port mains = Vm\n*$ probe i_r = i(Vr) A\n*$ probe v_r = v(a) V\n"
                      "Vm a 0 external\nVr a r 0\nR1 r 0 100\nRe a e 1meg\nXeva e 0 eva\n");
  static const char *const SETS[] = {"circuit.deck=r.cir", "supply.voltage=100V",
                                     "run={until: 60 ms}", "measure.last=2 cycles",
                                     "quality=i_r",        NULL};
  vs_trial *t = vs_trial_run("paper", NULL, SETS, NULL);
  EXPECT(!t->status && t->result.n_quality == 1, "%s", t->err.text);
  vs_quality_measure m;
  for (int k = 0; !t->status && vs_quality_at(&t->result.quality[0], k, false, &m); k++) {
    double v = m.value.value;
    /* straight lines between ngspice's knots, some 1e-5 of a sine */
    if (strstr(m.name, ".power_factor") || strstr(m.name, ".displacement_factor"))
      CLOSE(v, 1, 1e-4);
    if (strstr(m.name, ".i_rms")) CLOSE(v, 1, 1e-4);
    if (!strcmp(m.name, "i_r.power")) CLOSE(v, 100, 1e-4);
    if (strstr(m.name, ".thd")) EXPECT(v < 1e-3, "thd %g", v);
  }
  vs_trial_free(t);
}

/* The number that follows a key in JSON. */
static double number_of(const char *json, const char *key) {
  const char *at = strstr(json, key);
  EXPECT(at != NULL, "no %s in %.300s", key, json);
  return at ? strtod(at + strlen(key), NULL) : NAN;
}

/* On the orbit `steady` and a run tell the same. */
static void on_the_orbit(void) {
#define WORK "--set firing.every=1 --set firing.angle=110deg --tier switched --quiet "
  RUN_GOOD("steady paper " WORK "-o period");
  RUN_GOOD("run paper " WORK
           "--set start=steady --set run.until=0.2s --set 'measure.last=5 cycles' "
           "--set quality=mains -o five");
  char *one = read_file("period/summary.json"), *five = read_file("five/summary.json");
  static const char *const NAMES[][2] = {
      {"\"thd\": {\"value\": ", "\"mains.thd\": {\"value\": "},
      {"\"displacement_factor\": {\"value\": ", "\"mains.displacement_factor\": {\"value\": "},
      {"\"power_factor\": {\"value\": ", "\"mains.power_factor\": {\"value\": "},
      {"\"i_mean\": {\"value\": ", "\"mains.i_dc\": {\"value\": "},
      {"\"power_in\": {\"value\": ", "\"mains.power\": {\"value\": "}};
  for (size_t k = 0; k < COUNT(NAMES); k++) /* as well as the run keeps to the orbit */
    CLOSE(number_of(five, NAMES[k][1]), number_of(one, NAMES[k][0]), 1e-7);
  EXPECT(strstr(five, "\"source\": \"state of 2014") &&
             strstr(five, "\"limits_A\": [null, null, 1.08"),
         "no limits in %.400s", strstr(five, "\"quality\""));
  free(one);
  free(five);
}

/* A step across the middle of two cycles belongs to both of its ends, each by its part: here the
 * second one along a straight line from 0 to 4 A, of which the first half goes up to 2 A. */
static void a_step_across_the_middle(void) {
  static const char *const SETS[] = {"run.until=80ms", "measure={from: 20 ms, to: 60 ms}",
                                     "quality=mains", "firing.every=1", NULL};
  vs_trial *t = vs_trial_read("paper", "circuit", SETS);
  vs_knot *a = vs_alloc(1, sizeof *a), *b = vs_alloc(1, sizeof *b);
  vs_quality q;
  EXPECT(!t->status && t->scene.quality.count == 1, "%s", t->err.text);
  vs_quality_begin(&q, &t->scene.quality.item[0], &t->scene.setup);
  for (int k = 0; k < 2; k++) {
    const double ends_s[] = {0.02, 0.0273, 0.06};
    a->t_s = ends_s[k], b->t_s = ends_s[k + 1];
    a->i_mains_a = 100 * (a->t_s - 0.02), b->i_mains_a = 100 * (b->t_s - 0.02);
    const vs_step step = {.frame = &t->scene.frame, .from = a, .to = b};
    vs_quality_accept(&q, &step);
  }
  EXPECT(q.half == 1, "ends of %d cycles", q.half);
  CLOSE(q.ends_squared[0], 0.02 * 4 / 3, 1e-12);
  CLOSE(q.ends_squared[1], 0.02 * 28 / 3, 1e-12);
  CLOSE(q.current.squared, 0.04 * 16 / 3, 1e-12);
  vs_quality_end(&q);
  free(a), free(b);
  vs_trial_free(t);
}

/* Wherever a stretch begins, the current of an orbit is settled. */
static void settled_on_the_orbit(void) {
  static const char *const UNTIL[] = {"0.2s", "0.207s", "0.213s"};
  for (size_t k = 0; k < COUNT(UNTIL); k++) {
    char line[512];
    snprintf(line, sizeof line,
             "run paper --set firing.every=1 --set quality=mains --set 'measure.last=2 cycles' "
             "--set start=steady --tier switched --set run.until=%s",
             UNTIL[k]);
    ran r = run(line);
    EXPECT(r.status == 0 && !strstr(r.err, "has not settled"), "%s: %s", UNTIL[k], r.err);
    free_ran(&r);
  }
}

/* A period of an orbit is whole cycles, whatever the scene's own run is. */
static void of_an_orbit(void) {
#define ORBIT "paper --set firing.every=1 --set quality=mains --tier switched "
  static const char *const SCENES[] = {"--set run.until=0.2s", "--set run.until=0.205s",
                                       "--set run.until=20ms --set 'measure.from=5 ms'"};
  double thd = NAN;
  for (size_t k = 0; k < COUNT(SCENES); k++) {
    char line[512];
    snprintf(line, sizeof line, "steady " ORBIT "%s --json", SCENES[k]);
    ran r = run(line);
    EXPECT(r.status == 0, "%s%s", SCENES[k], r.err);
    if (r.status == 0) {
      double own = number_of(r.out, "\"mains.thd\": {\"value\": ");
      if (k == 0) thd = own;
      CLOSE(own, thd, 1e-12);
    }
    free_ran(&r);
  }
  RUN_GOOD("steady " ORBIT "--set run.until=0.205s --along firing.angle=100deg..101deg --quiet");
  RUN_GOOD("sensitivity " ORBIT "--set run.until=0.205s --steady --of p_min --to supply.voltage");
  write_file("of.yaml",
             "scene: paper\nset: {firing.every: 1, quality: [mains], run.until: 0.205 s, "
             "run.tier: switched}\nvary: {firing.angle: [100 deg, 101 deg]}\n"
             "steady: true\nreport: [mains.thd]\n");
  RUN_GOOD("study of.yaml --quiet -o of");
  static const char *const SAYS[] = {"whole cycles", NULL};
  refuse("sensitivity " ORBIT "--set run.until=0.205s --of p_min --to supply.voltage", "a run", "",
         SAYS, __LINE__);
}

static void shown_and_drawn(void) {
  ran r = run("run paper "
              "--set firing.every=1 --tier switched --set run.until=0.1s --set "
              "'measure.last=5 cycles' --set 'quality=[mains, i]' -o q --all");
  EXPECT(r.status == 0 && strstr(r.out, "quality of mains, over 5 cycles") &&
             strstr(r.out, "mains.thd ") && strstr(r.out, "i.displacement_factor "),
         "%s%s", r.out, r.err);
  EXPECT(strstr(r.err, "quality: mains has not settled: over the first 2 of 5 cycles"), "%s",
         r.err);
  free_ran(&r);
  if (!on_path("gnuplot")) return;
  RUN_GOOD("plot q --quiet");
  char *svg = read_file("q/harmonics.svg");
  EXPECT(strstr(svg, "harmonics of mains") && strstr(svg, "class D"), "%.200s", svg);
  free(svg);
  r = run("run paper --tier switched --set run.until=20ms -o q --quiet");
  EXPECT(r.status == 0, "%s", r.err);
  EXPECT_FILES("q", "events.csv run.csv summary.json ");
  free_ran(&r);
}

/* The block of docs/power.md that begins with this text, up to its end; free() it. */
static char *block_of(const char *page, const char *begins) {
  const char *from = strstr(page, begins), *to = from ? strstr(from, "\n```") : NULL;
  EXPECT(to != NULL, "no block %s", begins);
  return to ? strndup(from, (size_t)(to - from) + 1) : vs_copy("");
}

/* True if only blanks stand before `at` in its line. */
static bool begins_line(const char *text, const char *at) {
  while (at > text && at[-1] == ' ') at--;
  return at == text || at[-1] == '\n';
}

/* Each word of a line of the page stands in the program's line that begins with the same one;
 * numbers to what ngspice gives on other machines. */
static void expect_line(const char *printed, char *line) {
  char *word = strtok(line, " ");
  const char *at = printed;
  while ((at = strstr(at, word))) {
    if (!begins_line(printed, at)) {
      at++;
      continue;
    }
    char *copy = strndup(at, strcspn(at, "\n")), *rest = NULL, *given = NULL;
    bool same = !strcmp(strtok_r(copy, " ", &rest), word);
    for (char *w = line + strlen(word) + 1; same && *w; w += *w == ' ') {
      char each[64];
      while (*w == ' ') w++;
      size_t n = strcspn(w, " ");
      snprintf(each, sizeof each, "%.*s", (int)n, w);
      w += n;
      if (!n) break;
      given = strtok_r(NULL, " ", &rest);
      char *end;
      double x = strtod(each, &end);
      same = given && (*end || end == each ? !strcmp(each, given)
                                           : fabs(strtod(given, NULL) - x) <= 1e-4 * fabs(x));
    }
    free(copy);
    if (same) return;
    at++;
  }
  EXPECT(false, "the page's line of %s is not printed", word);
}

static void the_page(void) {
  char *page = read_file(VS_TEST_FOLDER "/../docs/power.md");
  char *scene = block_of(page, "# quality.yaml"), *text = block_of(page, "mains.power  "),
       *rest = text;
  write_file("quality.yaml", scene);
  ran r = run("run quality.yaml -o quality --all");
  EXPECT(r.status == 0, "%s", r.err);
  for (char *line; (line = strsep(&rest, "\n"));)
    if (*line) expect_line(r.out, line);
  free_ran(&r);
  free(page), free(scene), free(text);
}

static void in_a_study(void) {
  write_file("s.yaml", "set: {quality: [mains], measure: {last: 1 cycles}, firing.every: 1, "
                       "start: steady, run: {until: 40 ms, tier: switched}}\n"
                       "vary: {firing.angle: [110 deg, 130 deg]}\n"
                       "report: [mains.thd, mains.harmonic_3, mains.i_dc]\n");
  RUN_GOOD("study s.yaml -o s --jobs 1 --quiet");
  char *csv = read_file("s/study.csv");
  EXPECT(strstr(csv, "mains.thd,mains.harmonic_3_a,mains.i_dc_a"), "%s", csv);
  const char *row = strchr(csv, '\n');
  double angle = 0, thd = 0, third = 0;
  EXPECT(row && sscanf(row + 1, "0,%*[^,],%lf,%lf,%lf", &angle, &thd, &third) == 3, "%s", csv);
  CLOSE(thd, 0.7058411, 1e-6); /* steady's, at 110 deg */
  CLOSE(third, 0.04536657, 1e-6);
  free(csv);
}

/* ---- currents that take several cycles to repeat ---- */

enum { AT = 64 /* points in a cycle */, GROUPS = 5 };

/* A current that repeats after `period` cycles, of lines up to 5.5 times the mains' frequency. */
static double lines_at(double cycles, int period) {
  double sum = 0.3;
  for (int m = 1; m <= 11 * period / 2; m++)
    sum += cos(2 * M_PI * m * cycles / period + m * m) / (1 + m % 5);
  return sum;
}

/* Squares of groups as an instrument finds them that samples windows of N cycles, one behind the
 * other, until they hold whole periods: the discrete transform as it is written. */
static void sampled_groups(const double *x, int count, int window, int n_cycles,
                           double squares[GROUPS + 1]) {
  int windows = 1;
  while (windows * window % count) windows++;
  memset(squares, 0, (GROUPS + 1) * sizeof *squares);
  for (int w = 0; w < windows; w++)
    for (int h = 1; h <= GROUPS; h++)
      for (int k = h * n_cycles - n_cycles / 2; k <= h * n_cycles + n_cycles / 2; k++) {
        double complex sum = 0;
        for (int j = 0; j < window; j++)
          sum += x[(w * window + j) % count] * cexp(-2 * M_PI * I * (k * j % window) / window);
        double part = 2 * abs(k - h * n_cycles) == n_cycles ? 0.5 : 1;
        squares[h] += part * 2 * pow(cabs(sum) / window, 2) / windows;
      }
}

static void groups_of_samples(void) {
  static const struct {
    double hz;
    int period, cycles, each, windows;
  } ROWS[] = {{50, 2, 2, 10, 1},  {50, 2, 20, 10, 2}, {50, 3, 3, 10, 3},   {50, 3, 96, 10, 9},
              {50, 4, 4, 10, 2},  {50, 7, 7, 10, 7},  {50, 10, 10, 10, 1}, {60, 3, 3, 12, 1},
              {60, 4, 28, 12, 2}, {60, 5, 5, 12, 5},  {60, 7, 14, 12, 7}};
  for (size_t r = 0; r < COUNT(ROWS); r++) {
    const int period = ROWS[r].period, count = period * AT;
    const double cycle_s = 1 / ROWS[r].hz, from_s = 0.0123;
    double x[10 * AT], squares[GROUPS + 1];
    vs_spectrum s;
    vs_spectrum_begin(&s, 2 * M_PI * ROWS[r].hz);
    vs_spectrum_begin_groups(&s, from_s, ROWS[r].cycles, period);
    for (int j = 0; j < count; j++) x[j] = lines_at((j + 0.5) / AT, period);
    for (int j = 0; j < ROWS[r].cycles * AT; j++)
      vs_spectrum_add(&s, from_s + (j + 0.5) * cycle_s / AT, cycle_s / AT, x[j % count]);
    sampled_groups(x, count, ROWS[r].each * AT, ROWS[r].each, squares);
    for (int h = 1; h <= GROUPS; h++) /* the same sums in another order: rounding */
      CLOSE(vs_spectrum_judged(&s, h), sqrt(squares[h]), 1e-11);
    EXPECT(s.grouping.each == ROWS[r].each && vs_spectrum_windows(&s) == ROWS[r].windows,
           "row %zu: %d windows of %d cycles", r, vs_spectrum_windows(&s), s.grouping.each);
    vs_spectrum_end(&s);
  }
}

/* A line half way between harmonics belongs to both by half of its square; one that is alone in its
 * group is the group. */
static void between_harmonics(void) {
  enum { CYCLES = 10, POINTS = 1000 };
  vs_spectrum s;
  vs_spectrum_begin(&s, 2 * M_PI * 50);
  vs_spectrum_begin_groups(&s, 0, CYCLES, 2);
  for (int j = 0; j < CYCLES * POINTS; j++) {
    double cycles = (j + 0.5) / POINTS;
    vs_spectrum_add(&s, cycles / 50, 0.02 / POINTS,
                    3 * sin(2 * M_PI * 1.5 * cycles) + 4 * sin(2 * M_PI * 2 * cycles));
  }
  s.span_s = CYCLES * 0.02;
  CLOSE(vs_spectrum_judged(&s, 1), 3 / 2.0, 1e-12);
  CLOSE(vs_spectrum_judged(&s, 2), sqrt(9 / 4.0 + 16 / 2.0), 1e-12);
  CLOSE(vs_spectrum_judged(&s, 3) + 1, 1, 1e-12);
  CLOSE(vs_spectrum_harmonic(&s, 2), 4 / M_SQRT2, 1e-12);
  vs_spectrum_end(&s);
}

/* The groups that a summary tells are those of the samples in the table beside it. */
static void groups_of_a_table(const char *folder, double hz, int each) {
  char path[64], line[4096];
  snprintf(path, sizeof path, "%s/run.csv", folder);
  FILE *f = fopen(path, "r");
  EXPECT(f && fgets(line, sizeof line, f), "no %s", path);
  if (!f) return;
  const int most = 40000, at = (int)lround(1 / hz / 5e-5);
  double *x = vs_alloc((size_t)most, sizeof *x), squares[GROUPS + 1];
  int count = 0;
  while (count < most && fgets(line, sizeof line, f)) {
    char *column = line;
    for (int k = 0; k < 15; k++) column = strchr(column, ',') + 1; /* i_a */
    x[count++] = atof(column);
  }
  fclose(f);
  sampled_groups(x, count - 1, each * at, each, squares); /* the last row is the first one again */
  snprintf(path, sizeof path, "%s/summary.json", folder);
  char *json = read_file(path);
  const char *own = strstr(json, "\"harmonic_groups\": [null");
  EXPECT(own != NULL, "no groups in %s", path);
  for (int h = 1; own && h <= GROUPS; h++) {
    own = strchr(own, ',') + 1;
    /* the samples' slope jumps at firing and extinction, which 400 of them in a cycle see to that
     */
    CLOSE(atof(own), sqrt(squares[h]), 3e-4);
  }
  free(x), free(json);
}

#define ORBIT_OF                                                                                   \
  "steady paper --tier switched --quiet --set run.sample=0.05ms --set firing.angle=97deg "
static void groups_on_the_orbit(void) {
  static const struct {
    const char *every, *folder;
  } ORBITS[] = {{"2", "e2"}, {"3", "e3"}, {"7", "e7"}};
  for (size_t k = 0; k < COUNT(ORBITS); k++) {
    char line[512];
    snprintf(line, sizeof line, ORBIT_OF "--set firing.every=%s -o %s", ORBITS[k].every,
             ORBITS[k].folder);
    RUN_GOOD(line);
    groups_of_a_table(ORBITS[k].folder, 50, 10);
  }
  RUN_GOOD(ORBIT_OF "--set firing.every=4 --set supply.frequency=62.5Hz -o e4");
  groups_of_a_table("e4", 62.5, 12);
  char *json = read_file("e2/summary.json");
  const char *limits = strstr(json, "\"harmonic_limits\""),
             *lines = strstr(json, "\"harmonics\": [");
  double second = NAN;
  EXPECT(limits && lines && sscanf(lines, "\"harmonics\": [%*[^,], %*[^,], %lf", &second) == 1,
         "%.300s", json);
  CLOSE(second / 1.08, 0.06411, 1e-4); /* the line alone, told as part of its limit before */
  CLOSE(limits ? number_of(limits, "\"worst_part\": ") : NAN, 0.09530, 1e-4);
  EXPECT(strstr(json, "\"windows\": {\"number\": 1, \"cycles\": 10}") != NULL, "no windows");
  free(json);
  ran r = run("steady paper --tier switched --set firing.angle=97deg --set firing.every=2 --all");
  EXPECT(strstr(r.out, "group A rms") && strstr(r.out, "harmonic 2 takes 9.53 % of its own") &&
             strstr(r.out, "root mean square of 1 window of 10 cycles"),
         "%s", r.out);
  char *page = read_file(VS_TEST_FOLDER "/../docs/power.md"),
       *text = block_of(page, "harmonic             A rms     group"), *rest = text;
  for (char *of_page; (of_page = strsep(&rest, "\n"));)
    if (*of_page) expect_line(r.out, of_page);
  free(page), free(text);
  free_ran(&r);
  r = run("steady paper --tier switched --set firing.every=1 --json");
  EXPECT(!strstr(r.out, "groups") && !strstr(r.out, "windows"), "groups in every cycle");
  free_ran(&r);
}

/* A run tells the same of the orbit, whether its stretch is whole windows or goes round. */
static void groups_of_a_run(void) {
#define EVERY "--set start=steady --tier switched --set firing.angle=97deg --set firing.every=2 "
  static const char *const LAST[] = {"2", "6", "20", "24"};
  for (size_t k = 0; k < COUNT(LAST); k++) {
    char line[512];
    snprintf(line, sizeof line,
             "run paper " EVERY "--set run.until=0.5s --set quality=mains --json "
             "--set 'measure.last=%s cycles'",
             LAST[k]);
    ran r = run(line);
    EXPECT(r.status == 0, "%s", r.err);
    CLOSE(number_of(r.out, "\"mains.harmonic_part\": {\"value\": "), 0.09530, 1e-4);
    CLOSE(number_of(r.out, "\"held\": true, \"worst\": 2, \"worst_part\": "), 0.09530, 1e-4);
    EXPECT(strstr(r.out, "\"groups_A\": [null, ") != NULL, "no groups");
    free_ran(&r);
  }
  ran r = run("run paper " EVERY "--set run.until=0.2s --set quality=mains -o odd --all "
              "--set 'measure.last=5 cycles'");
  EXPECT(r.status == 0 && strstr(r.err, "its harmonics are held against no limits") &&
             strstr(r.out, "groups by IEC 61000-4-7 want whole firing periods") &&
             strstr(r.out, "  mains.harmonic_part                    -\n"),
         "%s%s", r.out, r.err);
  free_ran(&r);
  char *json = read_file("odd/summary.json");
  EXPECT(strstr(json, "\"held\": null, \"worst\": null, \"worst_part\": null") &&
             !strstr(json, "mains.harmonic_part"),
         "%s", strstr(json, "\"quality\""));
  free(json);
  write_file("every.yaml", "set: {quality: [mains], firing: {every: 2, angle: 97 deg}, "
                           "run: {until: 0.2 s, tier: switched}}\n"
                           "vary: {supply.voltage: [440 V]}\nsteady: true\n"
                           "report: [harmonic_part, mains.harmonic_part]\n");
  RUN_GOOD("study every.yaml -o every --jobs 1 --quiet");
  char *csv = read_file("every/study.csv"), *row = strchr(csv, '\n');
  double part[2] = {NAN, NAN};
  EXPECT(row && sscanf(row + 1, "0,%*[^,],%*[^,],%lf,%lf", &part[0], &part[1]) == 2, "%s", csv);
  CLOSE(part[0], 0.09530, 1e-4);
  CLOSE(part[1], 0.09530, 1e-4);
  free(csv);
  if (!on_path("gnuplot")) return;
  RUN_GOOD("run paper " EVERY "--set run.until=0.2s --set quality=mains -o drawn --quiet "
           "--set 'measure.last=2 cycles'");
  RUN_GOOD("plot drawn --quiet");
  char *svg = read_file("drawn/harmonics.svg");
  EXPECT(strstr(svg, "group, held to limits") != NULL, "no groups are drawn");
  free(svg);
}

/* ---- bad input ---- */

static void bad_input(void) {
  static const struct {
    const char *line, *at, *says[2];
  } BAD[] = {
      {"quality: {a: b}", "bad.yaml:1:11: ", {"a list of currents is wanted", NULL}},
      {"quality: []", "bad.yaml:1:1: ", {"a list of currents is wanted", NULL}},
      {"quality: [main]", "bad.yaml:1:11: ", {"no current 'main'", "did you mean 'mains'"}},
      {"quality: [p]", "bad.yaml:1:11: ", {"p is in m; a current is wanted", NULL}},
      {"quality: [i, i]", "bad.yaml:1:14: ", {"i stands here a second time", NULL}},
      {"circuit: {deck: named.cir}\nquality: mains",
       "bad.yaml:2:10: ",
       {"a device of the deck", NULL}},
      {"quality: [[i]]", "bad.yaml:1:", {"no current", NULL}},
      {"run: {tier: switched}\nquality: i_source", "bad.yaml:2:10: ", {"take tier circuit", NULL}},
      {"run: {until: 50 ms}\nquality: i", "bad.yaml:2:10: ", {"whole cycles", "last: 5 cycles"}},
      {"measure: {last: 2.5 cycles}\nquality: i", "bad.yaml:2:10: ", {"which is 2.5", NULL}},
      {"supply: {kind: step}\nfiring: {valve: none}\nquality: i",
       "bad.yaml:3:10: ",
       {"direct voltage", NULL}},
  };
  write_file("named.cir", "*$ port mains = Vm\n*$ probe v_r = v(a) V\n*$ device mains resistor = "
                          "v(a), v(a)/100\nVm a 0 external\nR1 a 0 100\nXeva a 0 eva\n");
  for (size_t k = 0; k < COUNT(BAD); k++) {
    write_file("bad.yaml", BAD[k].line);
    refuse("run bad.yaml -o out", BAD[k].line, BAD[k].at, BAD[k].says, __LINE__);
  }
}

static const vs_test TESTS[] = {
    {"half a wave", half_wave},
    {"a phase-controlled resistor", phase_controlled},
    {"a phase-controlled coil", resistance_and_inductance},
    {"a resistor across the mains", resistor},
    {"on the orbit", on_the_orbit},
    {"a step across the middle", a_step_across_the_middle},
    {"settled on the orbit", settled_on_the_orbit},
    {"of an orbit", of_an_orbit},
    {"what is shown and drawn", shown_and_drawn},
    {"the page", the_page},
    {"in a study", in_a_study},
    {"groups of samples", groups_of_samples},
    {"between harmonics", between_harmonics},
    {"groups on the orbit", groups_on_the_orbit},
    {"groups of a run", groups_of_a_run},
    {"bad input", bad_input},
};

int main(void) {
  return program_suite("quality", TESTS, COUNT(TESTS));
}
