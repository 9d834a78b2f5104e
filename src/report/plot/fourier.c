/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/fourier.h"

#include <gsl/gsl_fft_real.h>
#include <math.h>
#include <stdlib.h>

#include "base/csv.h"
#include "base/gnuplot.h"
#include "run/engineering.h"

enum {
  MOST_FACTOR = 101,  /* of the points */
  LAST_HARMONIC = 40, /* of the mains, the last one in the picture */
  DIGITS = 9          /* as run.csv has */
};
/* The vertical axis begins at this part of the probe's largest line. */
static const double FLOOR = 1e-6;

/* The smallest number from n on that has small prime factors alone: the transform of a large prime
 * number of points takes long. */
static size_t smooth_length(size_t n) {
  for (;; n++) {
    size_t rest = n;
    for (size_t factor = 2; factor <= MOST_FACTOR; factor++)
      while (rest % factor == 0) rest /= factor;
    if (rest == 1) return n;
  }
}

static size_t count_rows(const vs_traces *t, double from_s, double to_s, size_t *first) {
  size_t n = 0;
  for (size_t r = 0; r < t->rows; r++) {
    double at = vs_trace_time(t, r);
    if (at < from_s) *first = r;
    n += at >= from_s && at < to_s;
  }
  return n;
}

/* Reads the curve at n equidistant instants; false: it is not known at one of them. */
static bool resample(const vs_traces *t, int column, const vs_fourier *f, size_t row, double *y,
                     size_t n) {
  for (size_t k = 0; k < n; k++) {
    double at = f->from_s + f->span_s * (double)k / (double)n;
    while (row + 1 < t->rows && vs_trace_time(t, row + 1) <= at) row++;
    size_t next = row + 1 < t->rows ? row + 1 : row;
    double from = vs_trace_time(t, row), h = vs_trace_time(t, next) - from,
           share = h > 0 ? (at - from) / h : 0, a = vs_trace_value(t, row, column),
           b = vs_trace_value(t, next, column);
    y[k] = a + (share > 0 ? share * (b - a) : 0);
    if (isnan(y[k])) return false;
  }
  return true;
}

/* Finds the r.m.s. value of each line: |c_k| of the mean, sqrt(2) |c_k| of the others. */
static void transform(double *y, size_t n, vs_fourier *f) {
  gsl_fft_real_wavetable *table = vs_checked(gsl_fft_real_wavetable_alloc(n));
  gsl_fft_real_workspace *space = vs_checked(gsl_fft_real_workspace_alloc(n));
  gsl_fft_real_transform(y, 1, n, table, space);
  f->lines = (n + 1) / 2;
  f->rms = vs_alloc(f->lines, sizeof *f->rms);
  f->rms[0] = fabs(y[0]) / (double)n;
  for (size_t k = 1; k < f->lines; k++)
    f->rms[k] = M_SQRT2 * hypot(y[2 * k - 1], y[2 * k]) / (double)n;
  gsl_fft_real_wavetable_free(table);
  gsl_fft_real_workspace_free(space);
}

vs_status vs_fourier_take(const vs_traces *t, int column, const double window_s[2], double cycle_s,
                          vs_fourier *f, vs_error *err) {
  double until = fmin(window_s[1], vs_trace_time(t, t->rows - 1)),
         from = fmax(window_s[0], vs_trace_time(t, 0));
  double cycles = floor((until - from) / cycle_s * (1 + 1e-9) + 1e-9);
  size_t first = 0, n = 0;
  *f = (vs_fourier){.from_s = until - cycles * cycle_s, .span_s = cycles * cycle_s};
  if (cycles >= 1) n = count_rows(t, f->from_s - 1e-9 * cycle_s, until - 1e-9 * cycle_s, &first);
  if (n < 4)
    return vs_fail(err, VS_INPUT,
                   "--fft: no whole cycle of the mains, %.4g ms, lies between %.6g "
                   "ms and %.6g ms of %s",
                   1e3 * cycle_s, 1e3 * window_s[0], 1e3 * window_s[1], t->path);
  n = smooth_length(n);
  double *y = vs_alloc(n, sizeof *y);
  bool known = resample(t, column, f, first, y, n);
  if (known) transform(y, n, f);
  free(y);
  return known ? VS_OK
               : vs_fail(err, VS_INPUT, "--fft: %s: column %s has empty cells there", t->path,
                         t->name[column]);
}

/* Finds the spectrum of one probe of one run over the stretch that is shown. */
static vs_status take_spectrum(const vs_time_window *s, int probe, size_t run, vs_fourier *f,
                               vs_error *err) {
  const vs_traces *t = &s->run[run].traces;
  return vs_fourier_take(t, vs_traces_find(t, s->probes.item[probe].column),
                         (double[]){s->from_s, s->to_s}, s->run[run].cycle_s, f, err);
}

/* ---- the picture ---- */

/* The highest frequency in the picture, Hz: that of the run with the fastest mains. */
static double top_of(const vs_time_window *s) {
  double cycle_s = s->run[0].cycle_s;
  for (size_t r = 1; r < s->runs; r++) cycle_s = fmin(cycle_s, s->run[r].cycle_s);
  return (LAST_HARMONIC + 0.5) / cycle_s;
}

/* Adds the lines up to top_of() as a data block, one for each probe and run. */
static vs_status add_block(const vs_time_window *s, int probe, size_t run, vs_script *script,
                           double *largest, vs_error *err) {
  const vs_probe_shown *p = &s->probes.item[probe];
  vs_fourier f;
  vs_status status = take_spectrum(s, probe, run, &f, err);
  if (status) return status;
  vs_gnuplot_add(script, "$lines_%d_%zu << EOD\n", probe, run);
  for (size_t k = 0; k < f.lines; k++) {
    double frequency = (double)k / f.span_s;
    if (frequency > top_of(s)) break;
    vs_gnuplot_add(script, "%.9g,%.9g\n", frequency, p->scale * f.rms[k]);
    *largest = fmax(*largest, p->scale * f.rms[k]);
  }
  vs_gnuplot_add(script, "EOD\n");
  free(f.rms);
  return VS_OK;
}

static void add_panel(const vs_time_window *s, int probe, double largest, vs_script *script) {
  vs_text label = {0};
  vs_text_add(&label, "%s rms", s->probes.item[probe].label);
  if (probe + 1 == s->probes.count) vs_gnuplot_add(script, "set xlabel 'f / Hz'\n");
  double top = largest > 0 ? largest : 1;
  vs_gnuplot_add(script, "set yrange [%.3g:%.3g]\nset ylabel ", FLOOR * top, 2 * top);
  vs_gnuplot_quoted(script, label.text);
  vs_text_free(&label);
  vs_gnuplot_add(script, "\nplot ");
  for (size_t r = 0; r < s->runs; r++) {
    vs_gnuplot_add(script, r ? ", " : "");
    vs_gnuplot_add(script, "$lines_%d_%zu using 1:2 with impulses lc rgb %s lw %zu title ", probe,
                   r, vs_time_window_colour(r), 2 * (s->runs - r));
    vs_gnuplot_quoted(script, s->run[r].folder);
  }
  vs_gnuplot_add(script, "\n");
}

vs_status vs_fourier_add(const vs_time_window *s, vs_script *script, vs_error *err) {
  vs_status status = VS_OK;
  double largest[VS_PROBES_MOST] = {0};
  vs_time_window_begin(script);
  for (int k = 0; k < s->probes.count; k++)
    for (size_t r = 0; r < s->runs && !status; r++)
      status = add_block(s, k, r, script, &largest[k], err);
  vs_gnuplot_add(script, "set multiplot layout %d,1\nset logscale y\nset format y '%%g'\n",
                 s->probes.count);
  vs_time_window_legend(s, script);
  vs_gnuplot_add(script, "set xrange [%g:%g]\n", -top_of(s) / (2 * LAST_HARMONIC + 1), top_of(s));
  for (int k = 0; k < s->probes.count && !status; k++) add_panel(s, k, largest[k], script);
  vs_gnuplot_add(script, "unset multiplot\n");
  return status;
}

/* ---- the numbers ---- */

/* Adds the rows of a run. All its probes have the same lines, as they have the same times. */
static vs_status add_rows(const vs_time_window *s, size_t run, vs_text *csv, vs_error *err) {
  vs_fourier f[VS_PROBES_MOST] = {{.rms = NULL}};
  vs_status status = VS_OK;
  char number[VS_NUMBER_SIZE];
  for (int k = 0; k < s->probes.count && !status; k++)
    status = take_spectrum(s, k, run, &f[k], err);
  for (size_t line = 0; !status && line < f[0].lines; line++) {
    if (s->runs > 1) vs_csv_cell(csv, s->run[run].folder);
    vs_text_number(number, (double)line / f[0].span_s, DIGITS);
    vs_text_add(csv, "%s%s", s->runs > 1 ? "," : "", number);
    for (int k = 0; k < s->probes.count; k++) {
      vs_text_number(number, f[k].rms[line], DIGITS);
      vs_text_add(csv, ",%s", number);
    }
    vs_text_add(csv, "\n");
  }
  for (int k = 0; k < s->probes.count; k++) free(f[k].rms);
  return status;
}

vs_status vs_fourier_csv(const vs_time_window *s, vs_text *csv, vs_error *err) {
  vs_status status = VS_OK;
  vs_text_add(csv, "%sfrequency_hz", s->runs > 1 ? "run," : "");
  for (int k = 0; k < s->probes.count; k++) {
    char name[VS_PROBE_SIZE + 8];
    vs_time_window_probe_named(&s->probes.item[k], "rms", name, sizeof name);
    vs_text_add(csv, ",%s", name);
  }
  vs_text_add(csv, "\n");
  for (size_t r = 0; r < s->runs && !status; r++) status = add_rows(s, r, csv, err);
  return status;
}

vs_status vs_fourier_say(const vs_time_window *s, vs_text *words, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t r = 0; r < s->runs && !status; r++) {
    vs_fourier f = {.rms = NULL};
    char from[VS_ENGINEERING_SIZE], to[VS_ENGINEERING_SIZE], apart[VS_ENGINEERING_SIZE];
    status = take_spectrum(s, 0, r, &f, err);
    free(f.rms);
    if (status) break;
    vs_text_add(words, "spectrum of %s: from %s to %s, lines %s apart\n", s->run[r].folder,
                vs_engineering_text(f.from_s, "s", from),
                vs_engineering_text(f.from_s + f.span_s, "s", to),
                vs_engineering_text(1 / f.span_s, "Hz", apart));
  }
  return status;
}
