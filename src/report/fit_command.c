/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/fit_command.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/csv.h"
#include "base/file.h"
#include "base/gnuplot.h"
#include "base/shutdown.h"
#include "base/units.h"
#include "fit/fit_result.h"
#include "fit_printout.h"
#include "ngspice/self_test.h"
#include "report/scale.h"
#include "run/version.h"

/* ---- the picture: data, fit, residuals ---- */

enum { WIDTH = 900, HIGH = 290, LOW = 190, TOP = 50, UNDER = 26, UNDER_LABEL = 52 };

/* A picture under way: panels one under the other. */
typedef struct portrait {
  const vs_fit_result *o;
  vs_script script;
  int height, at; /* pixels in all, and where the next panel begins, from above */
} portrait;

/* Places the next panel, of this height; `under` of it is for what stands below its frame. */
static void place_panel(portrait *p, int high, int under) {
  double top = 1 - (double)p->at / p->height, bottom = 1 - (double)(p->at + high) / p->height;
  vs_gnuplot_add(&p->script, "set tmargin at screen %.6f\nset bmargin at screen %.6f\n",
                 top - 8. / p->height, bottom + (double)under / p->height);
  p->at += high;
}

static void label(portrait *p, char axis, const char *name, const char *unit) {
  char pretty[64], text[VS_NAME_SIZE + 128];
  vs_scale_unit(unit, pretty, sizeof pretty);
  snprintf(text, sizeof text, "%s%s%s", name, *pretty ? " / " : "", pretty);
  vs_gnuplot_add(&p->script, "set %clabel ", axis);
  vs_gnuplot_quoted(&p->script, text);
  vs_gnuplot_add(&p->script, "\n");
}

/* ---- a column ---- */

/* Adds the column's samples as the data block $D: t in ms, measured, fitted, residual. */
static void add_samples(portrait *p, const vs_fit_result_column *c, double factor) {
  const vs_fit_problem_run *run = &p->o->inquiry->runs[c->run];
  vs_gnuplot_add(&p->script, "$D << EOD\n");
  for (size_t k = 0; k < run->recording.n_samples; k++) {
    const vs_sample *s = &run->recording.samples[k];
    size_t n = run->datum + run->aims.count + k;
    if ((size_t)s->column != c->column) continue;
    vs_gnuplot_add(&p->script, "%.9g %.9g %.9g %.6g\n", 1e3 * s->t_s, s->value * factor,
                   p->o->estimate.computed[n] * factor, p->o->estimate.residual[n]);
  }
  vs_gnuplot_add(&p->script, "EOD\n");
}

/* The prefix of the unit that gives the largest amount one to three digits before the decimal
 * point, and its factor. */
static double prefix_of(const portrait *p, const vs_fit_result_column *c, char *prefix) {
  const vs_recording *r = &p->o->inquiry->runs[c->run].recording;
  double most = 0;
  for (size_t k = 0; k < r->n_samples; k++)
    if ((size_t)r->samples[k].column == c->column) most = fmax(most, fabs(r->samples[k].value));
  *prefix = '\0';
  if (r->columns.item[c->column].si != 1) return 1 / r->columns.item[c->column].si;
  if (most == 0 || most >= 1 || !vs_units_known(r->columns.item[c->column].unit)) return 1;
  snprintf(prefix, 8, "%s", most >= 1e-3 ? "m" : "u");
  return most >= 1e-3 ? 1e3 : 1e6;
}

static void draw_column(portrait *p, const vs_fit_result_column *c) {
  const vs_recorded *column = &p->o->inquiry->runs[c->run].recording.columns.item[c->column];
  char prefix[8], unit[64], name[VS_NAME_SIZE + 32];
  double factor = prefix_of(p, c, prefix);
  snprintf(unit, sizeof unit, "%s%.40s", prefix, column->unit);
  if (!*column->unit || !vs_units_known(unit))
    snprintf(unit, sizeof unit, "%.40s", column->unit), factor = 1 / column->si;
  snprintf(name, sizeof name, "%s", column->name);
  if (p->o->inquiry->n_runs > 1)
    snprintf(name, sizeof name, "%s, run %zu", column->name, c->run + 1);
  add_samples(p, c, factor);
  place_panel(p, HIGH, UNDER);
  label(p, 'y', name, unit);
  vs_gnuplot_add(
      &p->script,
      "set xlabel ''\nset key top right\nplot $D using 1:2 with points pt 7 ps 0.35 lc rgb "
      "%s title 'measured', $D using 1:3 with lines lw 1.4 lc rgb %s title 'fitted'\n",
      vs_scale_colour_bad, vs_scale_colour_good);
  place_panel(p, LOW, UNDER_LABEL);
  vs_gnuplot_add(&p->script,
                 "set ylabel 'residual / std error'\nset xlabel 't / ms'\nplot 0 lt 1 lc rgb "
                 "'#404040' notitle, 2 lt 1 dt 2 lc rgb '#808080' notitle, -2 lt 1 dt 2 lc "
                 "rgb '#808080' notitle, $D using 1:4 with impulses lc rgb %s notitle\n",
                 vs_scale_colour_good);
}

/* ---- the measures ---- */

/* Adds the data block $M: place, residual, name; one row for each measure. */
static int add_measure_points(portrait *p) {
  const vs_fit_problem *q = p->o->inquiry;
  int count = 0;
  vs_gnuplot_add(&p->script, "$M << EOD\n");
  for (size_t n = 0; n < q->n_data; n++) {
    if (q->data[n].aim < 0) continue;
    vs_text name = {0};
    vs_text_add(&name, "%s", vs_fit_problem_name(q, &q->data[n]));
    if (q->n_runs > 1) vs_text_add(&name, ", run %d", q->data[n].run + 1);
    vs_gnuplot_add(&p->script, "%d %.6g ", ++count, p->o->estimate.residual[n]);
    vs_gnuplot_word(&p->script, name.text);
    vs_gnuplot_add(&p->script, "\n");
    vs_text_free(&name);
  }
  vs_gnuplot_add(&p->script, "EOD\n");
  return count;
}

static void draw_measures(portrait *p) {
  int count = add_measure_points(p);
  place_panel(p, HIGH, UNDER_LABEL);
  vs_gnuplot_add(
      &p->script,
      "set ylabel 'residual / std error'\nset xlabel ''\nset xrange [0.3:%d.7]\n"
      "set rmargin 10\nset xtics rotate by -20 font 'sans,9'\n"
      "plot 0 lt 1 lc rgb '#404040' notitle, 2 lt 1 dt 2 lc rgb '#808080' notitle, -2 lt 1 "
      "dt 2 lc rgb '#808080' notitle, $M using 1:2:(1):xtic(3) with yerrorbars pt 7 ps 1 "
      "lc rgb %s title 'fitted less measured, in standard errors'\n"
      "set xrange [*:*]\nset xtics norotate autofreq font 'sans,11'\n",
      count, vs_scale_colour_good);
}

/* ---- the picture ---- */

static void begin_fit_picture(portrait *p, const char *name, bool measures) {
  bool svg = strlen(name) > 4 && !strcmp(name + strlen(name) - 4, ".svg");
  const char *slash = strrchr(p->o->inquiry->path, '/');
  char title[VS_PATH_SIZE + 64];
  p->height = TOP + (int)p->o->n_columns * (HIGH + LOW) + measures * HIGH;
  p->at = TOP;
  snprintf(title, sizeof title, "%s: chi2 = %.4g with %ld degrees of freedom%s",
           slash ? slash + 1 : p->o->inquiry->path, p->o->estimate.minimum.chi2,
           p->o->estimate.freedom, vs_estimate_fits(&p->o->estimate) ? "" : ": does not fit");
  vs_gnuplot_code(&p->script,
                  svg ? "set terminal svg noenhanced dynamic" : "set terminal pngcairo noenhanced");
  vs_gnuplot_add(&p->script, " size %d,%d font 'sans,11' background rgb 'white'\n", WIDTH,
                 p->height);
  vs_gnuplot_add(&p->script, "set grid lt 1 lw 0.5 lc rgb '#d0d0d0'\nset border lc rgb '#404040'\n"
                             "set lmargin 12\nset rmargin 3\nset multiplot title ");
  vs_gnuplot_caption(&p->script, title, WIDTH, 13);
  vs_gnuplot_add(&p->script, " font 'sans,13'\n");
}

/* Draws, for each recorded column, the measured and the fitted curve, with the residuals over time
 * below; for the measures of a run, fitted over measured values with their standard errors. name:
 * of the picture, ending in .png or .svg. Errors: gnuplot is missing or fails; the file cannot be
 * written. */
static vs_status portrait_draw(const vs_fit_result *o, const char *folder, const char *name,
                               vs_error *err) {
  portrait p = {.o = o};
  bool measures = false;
  char *picture = NULL;
  size_t size = 0;
  vs_file file = {0};
  for (size_t n = 0; n < o->inquiry->n_data; n++)
    measures = measures || o->inquiry->data[n].aim >= 0;
  begin_fit_picture(&p, name, measures);
  for (size_t k = 0; k < o->n_columns; k++) draw_column(&p, &o->columns[k]);
  if (measures) draw_measures(&p);
  vs_gnuplot_add(&p.script, "unset multiplot\n");
  vs_status status = vs_gnuplot_picture(p.script.text.text, &picture, &size, err);
  vs_gnuplot_free(&p.script);
  if (!status) status = vs_file_open(&file, folder, name, err);
  if (!status) {
    fwrite(picture, 1, size, file.stream); /* an error stays in the stream */
    status = vs_file_commit(&file, err);
  }
  free(picture);
  return status;
}

/* ---- for programs: fit.json, residuals.csv and profile.csv ---- */

enum { DIGITS = 12 };

/* ---- JSON ---- */

static void add_range_json(vs_json *json, const char *key, double from, double to) {
  vs_json_array(json, key, VS_JSON_ROW);
  vs_json_number(json, NULL, from, DIGITS);
  vs_json_number(json, NULL, to, DIGITS);
  vs_json_end(json);
}

static void add_unknown(const vs_fit_result *o, size_t k, vs_json *json) {
  const vs_estimate *e = &o->estimate;
  const vs_unknown *u = &e->inquiry->unknowns[k];
  vs_json_object(json, u->name, VS_JSON_ROW);
  vs_json_number(json, "value", e->value[k], DIGITS);
  vs_json_text(json, "unit", u->axis.unit);
  vs_json_number(json, "standard_error", e->error[k] * (u->log ? e->value[k] : u->scale), DIGITS);
  if (u->log) vs_json_number(json, "standard_error_of_ln", e->error[k], DIGITS);
  add_range_json(json, "interval_95", e->least[k], e->most[k]);
  vs_json_number(json, "start", u->start, DIGITS);
  add_range_json(json, "bounds", u->from, u->to);
  vs_json_bool(json, "on_bound", e->minimum.bound[k]);
  for (size_t p = 0; p < o->n_profiles; p++)
    if (o->profiles[p].unknown == k)
      add_range_json(json, "profile_95", o->profiles[p].least, o->profiles[p].most);
  vs_json_end(json);
}

static void add_correlation(const vs_estimate *e, vs_json *json) {
  vs_json_array(json, "correlation", VS_JSON_LINES);
  for (size_t i = 0; i < e->n; i++) {
    vs_json_array(json, NULL, VS_JSON_ROW);
    for (size_t k = 0; k < e->n; k++)
      vs_json_number(json, NULL, vs_estimate_correlation(e, i, k), DIGITS);
    vs_json_end(json);
  }
  vs_json_end(json);
}

/* Adds {UNKNOWN: EXPONENT, ...}, without those whose exponent is 0. */
static void add_exponents(const vs_estimate *e, const char *key, const double *exponent,
                          vs_json *json) {
  vs_json_object(json, key, VS_JSON_ROW);
  for (size_t k = 0; k < e->n; k++)
    if (exponent[k] != 0) vs_json_number(json, e->inquiry->unknowns[k].name, exponent[k], DIGITS);
  vs_json_end(json);
}

/* One combination of unknowns that the data determine well or badly: its text, its standard error,
 * and the exponents of the unknowns in it. */
static void add_combination(const vs_estimate *e, const vs_combination *c, vs_json *json) {
  vs_json_object(json, NULL, VS_JSON_LINES);
  vs_json_text(json, "combination", c->text);
  vs_json_number(json, "standard_error", c->error, DIGITS);
  vs_json_bool(json, "of_logarithm", c->product);
  add_exponents(e, "exponents", c->exponent, json);
  if (c->singular > 0) {
    vs_json_number(json, "singular_value", c->singular, DIGITS);
    add_exponents(e, "direction", c->exact, json);
  }
  vs_json_end(json);
}

static void add_combinations(const vs_estimate *e, vs_json *json) {
  vs_json_array(json, "singular_values", VS_JSON_ROW);
  for (size_t k = 0; k < e->n_directions; k++)
    vs_json_number(json, NULL, e->directions[k].singular, DIGITS);
  vs_json_end(json);
  vs_json_array(json, "directions", VS_JSON_LINES);
  for (size_t k = 0; k < e->n_directions; k++) add_combination(e, &e->directions[k], json);
  vs_json_end(json);
  vs_json_array(json, "pairs", VS_JSON_LINES);
  for (size_t k = 0; k < e->n_pairs; k++) add_combination(e, &e->pairs[k], json);
  vs_json_end(json);
}

static void add_measures(const vs_fit_result *o, vs_json *json) {
  const vs_fit_problem *q = o->inquiry;
  vs_json_array(json, "measures", VS_JSON_LINES);
  for (size_t n = 0; n < q->n_data; n++) {
    const vs_datum *d = &q->data[n];
    const char *unit = vs_fit_problem_unit(q, d);
    if (d->aim < 0) continue;
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_json_whole(json, "run", d->run + 1);
    vs_json_text(json, "name", vs_fit_problem_name(q, d));
    vs_json_text(json, "unit", unit);
    vs_json_number(json, "measured", d->value / vs_units_factor(unit), DIGITS);
    vs_json_number(json, "fitted", o->estimate.computed[n] / vs_units_factor(unit), DIGITS);
    vs_json_number(json, "residual", o->estimate.residual[n], DIGITS);
    vs_json_end(json);
  }
  vs_json_end(json);
}

static void add_columns(const vs_fit_result *o, vs_json *json) {
  vs_json_array(json, "columns", VS_JSON_LINES);
  for (size_t k = 0; k < o->n_columns; k++) {
    const vs_fit_result_column *c = &o->columns[k];
    const vs_residual_tests *p = &c->pattern;
    vs_json_object(json, NULL, VS_JSON_LINES);
    vs_json_whole(json, "run", (int64_t)c->run + 1);
    vs_json_text(json, "name", o->inquiry->runs[c->run].recording.columns.item[c->column].name);
    vs_json_whole(json, "samples", (int64_t)p->count);
    vs_json_number(json, "rms", p->rms, DIGITS);
    vs_json_whole(json, "runs", p->runs);
    vs_json_number(json, "runs_expected", p->runs_expected, DIGITS);
    vs_json_number(json, "runs_probability", p->runs_probability, DIGITS);
    vs_json_whole(json, "lags", p->lags);
    vs_json_number(json, "ljung_box", p->ljung_box, DIGITS);
    vs_json_number(json, "ljung_box_probability", p->ljung_box_probability, DIGITS);
    vs_json_number(json, "durbin_watson", p->durbin_watson, DIGITS);
    vs_json_bool(json, "pattern", p->found);
    vs_json_end(json);
  }
  vs_json_end(json);
}

static void add_warning(void *ctx, const char *text) {
  vs_json_text(ctx, NULL, text);
}

static void add_warnings(const vs_fit_result *o, vs_json *json) {
  bool circuit = false;
  for (size_t r = 0; r < o->inquiry->n_runs; r++)
    circuit = circuit || o->inquiry->runs[r].scene->tier->has_circuit;
  vs_json_array(json, "warnings", VS_JSON_LINES);
  if (circuit && *vs_self_test_text()) add_warning(json, vs_self_test_text());
  vs_fit_printout_warnings(o, add_warning, json);
  vs_json_end(json);
}

static void add_search(const vs_fit_result *o, vs_json *json) {
  vs_json_object(json, "search", VS_JSON_ROW);
  vs_json_whole(json, "starts", (int64_t)o->descents.count);
  vs_json_whole(json, "converged", (int64_t)o->converged);
  vs_json_whole(json, "reached_least", (int64_t)o->reached);
  vs_json_number(json, "next_chi2", o->next_chi2, DIGITS);
  vs_json_whole(json, "runs", o->prediction.runs);
  vs_json_whole(json, "failed_runs", o->prediction.failures);
  vs_json_text(json, "slopes", o->slopes);
  vs_json_whole(json, "slopes_not_exact", o->prediction.inexact);
  vs_json_end(json);
}

/* Adds the JSON of a fit, ended by a line break. */
static void found_json(const vs_fit_result *o, vs_text *text) {
  const vs_estimate *e = &o->estimate;
  vs_json json = vs_json_new(text);
  vs_json_object(&json, NULL, VS_JSON_LINES);
  vs_version_json(&json);
  const char *slash = strrchr(o->inquiry->path, '/');
  vs_json_text(&json, "fit", slash ? slash + 1 : o->inquiry->path);
  add_search(o, &json);
  vs_json_whole(&json, "data", (int64_t)o->inquiry->n_data);
  vs_json_whole(&json, "priors", (int64_t)o->inquiry->n_priors);
  vs_json_text(&json, "residual", o->inquiry->difference ? "difference" : "logarithm");
  vs_json_number(&json, "chi2_at_start", o->descents.first_chi2, DIGITS);
  vs_json_number(&json, "chi2", e->minimum.chi2, DIGITS);
  vs_json_whole(&json, "degrees_of_freedom", e->freedom);
  vs_json_number(&json, "probability", e->probability, DIGITS);
  vs_json_bool(&json, "fits", vs_estimate_fits(e));
  vs_json_object(&json, "unknowns", VS_JSON_LINES);
  for (size_t k = 0; k < e->n; k++) add_unknown(o, k, &json);
  vs_json_end(&json);
  add_correlation(e, &json);
  add_combinations(e, &json);
  add_measures(o, &json);
  add_columns(o, &json);
  add_warnings(o, &json);
  vs_json_end(&json);
  vs_text_add(text, "\n");
}

/* ---- CSV ---- */

static void add_number(vs_text *row, double value, int digits) {
  char text[VS_NUMBER_SIZE];
  vs_text_number(text, value, digits);
  vs_text_add(row, ",%s", text);
}

/* Writes residuals.csv: run, name, unit, t_s, measured, computed, error, residual; SI. Measures
 * belong to no instant and have an empty t_s. */
static void found_residuals(const vs_fit_result *o, int digits, FILE *out) {
  const vs_fit_problem *q = o->inquiry;
  fputs("run,name,unit,t_s,measured,computed,error,residual\n", out);
  for (size_t n = 0; n < q->n_data; n++) {
    const vs_datum *d = &q->data[n];
    const double si = vs_units_factor(vs_fit_problem_unit(q, d));
    vs_text row = {0};
    vs_text_add(&row, "%d,", d->run + 1);
    vs_csv_cell(&row, vs_fit_problem_name(q, d));
    vs_text_add(&row, ",%s", vs_fit_problem_unit(q, d));
    if (d->aim < 0)
      add_number(&row, q->runs[d->run].recording.samples[d->sample].t_s, digits);
    else
      vs_text_add(&row, ",");
    add_number(&row, d->value / si, digits);
    add_number(&row, o->estimate.computed[n] / si, digits);
    add_number(&row, (d->relative ? fabs(d->error * d->value) : d->error) / si, digits);
    add_number(&row, o->estimate.residual[n], digits);
    fprintf(out, "%s\n", row.text);
    vs_text_free(&row);
  }
}

/* Writes profile.csv: unknown, unit, value, chi2. */
static void found_profiles(const vs_fit_result *o, int digits, FILE *out) {
  fputs("unknown,unit,value,chi2\n", out);
  for (size_t p = 0; p < o->n_profiles; p++) {
    const vs_likelihood *profile = &o->profiles[p];
    const vs_unknown *u = &o->inquiry->unknowns[profile->unknown];
    for (size_t k = 0; k < profile->count; k++) {
      vs_text row = {0};
      vs_csv_cell(&row, u->name);
      vs_text_add(&row, ",%s", u->axis.unit);
      add_number(&row, vs_unknown_value(u, profile->point[k].s), digits);
      add_number(&row, profile->point[k].chi2, digits);
      fprintf(out, "%s\n", row.text);
      vs_text_free(&row);
    }
  }
}

/* ---- files ---- */

typedef void (*csv_writer)(const vs_fit_result *outcome, int digits, FILE *out);

static void write_fit_json(const vs_fit_result *o, int digits, FILE *out) {
  vs_text json = {0};
  (void)digits;
  found_json(o, &json);
  fputs(json.text, out);
  vs_text_free(&json);
}

static vs_status write_fit_file(const vs_fit_command_options *options, const vs_fit_result *o,
                                const char *name, csv_writer write, vs_error *err) {
  vs_file file;
  vs_status status = vs_file_open(&file, options->folder, name, err);
  if (status) return status;
  write(o, options->digits, file.stream);
  return vs_file_commit(&file, err);
}

/* Removes the file of an older fit where this fit does not write it. */
static void remove_stale(const char *folder, const char *name) {
  char path[VS_PATH_SIZE];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  unlink(path);
}

/* Draws the picture. Without gnuplot there is none, which a warning says; everything else is
 * written. */
static vs_status write_pictures(const vs_fit_command_options *options, const vs_fit_result *o) {
  static const char *const NAMES[] = {"fit.png", "fit.svg"};
  vs_error err = {0};
  vs_status status = VS_OK;
  for (size_t k = 0; k < 2 && !status; k++) {
    remove_stale(options->folder, NAMES[k]);
    status = portrait_draw(o, options->folder, NAMES[k], &err);
  }
  if (status && !options->quiet) fprintf(stderr, "vibrospice: warning: no picture: %s\n", err.text);
  return status;
}

static vs_status write_fit_files(const vs_fit_command_options *options, const vs_fit_result *o,
                                 vs_error *err) {
  vs_status status = write_fit_file(options, o, "fit.json", write_fit_json, err);
  if (!status) status = write_fit_file(options, o, "residuals.csv", found_residuals, err);
  if (!status && o->n_profiles)
    status = write_fit_file(options, o, "profile.csv", found_profiles, err);
  else if (!status)
    remove_stale(options->folder, "profile.csv");
  if (status) return status;
  bool drawn = !write_pictures(options, o);
  if (!options->quiet && !options->json)
    printf("written: fit.json, residuals.csv%s%s in %s\n", o->n_profiles ? ", profile.csv" : "",
           drawn ? ", fit.png, fit.svg" : "", options->folder);
  return VS_OK;
}

/* ---- the command ---- */

static void print_warning(void *ctx, const char *text) {
  (void)ctx;
  fprintf(stderr, "vibrospice: warning: %s\n", text);
}

static void print_fit(const vs_fit_command_options *options, const vs_fit_result *o) {
  vs_text json = {0};
  if (options->json) {
    found_json(o, &json);
    fputs(json.text, stdout);
    vs_text_free(&json);
  } else if (!options->quiet)
    vs_fit_printout_show(o, stdout);
  if (!options->quiet) vs_fit_printout_warnings(o, print_warning, NULL);
}

static vs_status fit_and_report(const vs_fit_command_options *options, const vs_fit_problem *q,
                                vs_error *err) {
  int made = 0;
  vs_fit_result *o = vs_alloc(1, sizeof *o);
  vs_status status = options->folder ? vs_file_folder_make(options->folder, &made, err) : VS_OK;
  bool folder = options->folder && !status;
  if (made) vs_shutdown_remove(options->folder); /* so that a signal leaves no empty folder */
  if (!status) status = vs_fit_result_of(q, o, err);
  if (made) vs_shutdown_forget(options->folder);
  if (o->told) print_fit(options, o);
  if (o->told && folder) {
    vs_error other = {0};
    vs_status written = write_fit_files(options, o, &other);
    if (written) *err = other, status = written;
    folder = written;
  }
  if (status && folder) vs_file_folder_unmake(options->folder, made);
  if (!status) status = vs_fit_printout_judge(o, err);
  vs_fit_result_free(o);
  free(o);
  return status;
}

vs_status vs_fit_command_run(const vs_fit_command_options *options, vs_error *err) {
  vs_fit_problem *q = vs_alloc(1, sizeof *q);
  vs_status status =
      vs_fit_problem_read(options->name, options->sets, options->n_sets, options->profile, q, err);
  for (size_t r = 0; r < q->n_runs && !status && !options->quiet; r++)
    vs_scene_warn(q->runs[r].scene);
  for (size_t r = 0; r < q->n_runs && !status; r++) {
    q->runs[r].scene->order.shows = !options->quiet && isatty(STDERR_FILENO);
    q->runs[r].scene->allow_code = options->allow_code;
    status = vs_control_allow(&q->runs[r].scene->control, options->allow_code, err);
  }
  if (!status) status = fit_and_report(options, q, err);
  vs_fit_problem_free(q);
  free(q);
  return status;
}

/* ---- for check ---- */

/* The reading ends at the first mistake. */
vs_status vs_fit_command_check(const vs_check_options *options, vs_text *good, vs_error *err) {
  vs_fit_problem *q = vs_alloc(1, sizeof *q);
  vs_error first = {
      0}; /* without findings: what follows a mistake would be read from an incomplete scene */
  vs_status status =
      vs_fit_problem_read(options->name, options->sets, options->n_sets, NULL, q, &first);
  if (status) {
    first.findings = err->findings;
    *err = first;
  } else
    vs_text_add(good, "a good fit: %zu unknowns from %zu numbers and %zu priors, of %zu run%s",
                q->n_unknowns, q->n_data, q->n_priors, q->n_runs, q->n_runs > 1 ? "s" : "");
  vs_fit_problem_free(q);
  free(q);
  return status;
}
