/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "bench/acceptance.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/file.h"
#include "base/gnuplot.h"
#include "base/json.h"
#include "base/units.h"
#include "figures.h"
#include "netlist/catalogue.h"
#include "netlist/kinds.h"
#include "netlist/parts.h"
#include "ngspice/child.h"
#include "ngspice/self_test.h"
#include "report/scale.h"
#include "run/warnings.h"

/* ---- numbers that no device of the kind has, each named with its line ---- */

/* A figure stands in the file as the limit, as the parameter that the model is made with, or as
 * both. */
static void warn_of_range(const vs_stand *s, const char *kind, const vs_kind_limit *range,
                          vs_warnings *w) {
  const char *const names[] = {range->name, range->param};
  for (int n = 0; n < 2 && names[n] && range->most > 0; n++) {
    vs_figures_asked limit = vs_figures_limit(s, names[n]),
                     a = isfinite(limit.value) ? limit : vs_figures_any(s, names[n]);
    double shown = a.value / vs_units_factor(range->unit);
    if (isnan(shown) || (shown >= range->least && shown <= range->most)) continue;
    vs_fail_at(vs_warnings_add(w), a.where.file ? a.where : (vs_where){.file = s->name},
               "%s = %.4g %s is implausible: a%s %s has %.4g to %.4g %s; is the unit right?",
               names[n], shown, range->unit, strchr("aeio", *kind) ? "n" : "", kind, range->least,
               range->most, range->unit);
  }
}

/* ---- numbers side by side ---- */

/* Adds a warning where a over b is not within these ends. `text` says what is usual. */
static void warn_of_ratio(vs_figures_asked a, vs_figures_asked b, double least, double most,
                          const char *text, vs_warnings *w) {
  double ratio = a.value / b.value;
  if (isnan(ratio) || (ratio >= least && ratio <= most)) return;
  vs_fail_at(vs_warnings_add(w), a.where, "implausible: %s; here it is %.4g", text, ratio);
}

static void warn_of_pair(const vs_stand *s, const vs_kind_ratio *pair, vs_warnings *w) {
  char text[160];
  if (!(pair->most > 0)) return;
  snprintf(text, sizeof text, "%s is %.4g to %.4g times %s", pair->more, pair->least, pair->most,
           pair->less);
  warn_of_ratio(vs_figures_limit(s, pair->more), vs_figures_limit(s, pair->less), pair->least,
                pair->most, text, w);
}

/* A half sine of 10 ms and the peak I has I^2 * 5 ms. */
static void warn_of_surge(const vs_stand *s, const char *name, vs_warnings *w) {
  char text[160];
  if (!name) return;
  vs_figures_asked i2t = vs_figures_limit(s, "i2t"), surge = vs_figures_limit(s, name);
  surge.value *= surge.value * 5e-3;
  snprintf(text, sizeof text,
           "i2t is 0.5 to 1.5 times what a half sine of 10 ms and %s has, %s^2 * 5 ms", name, name);
  warn_of_ratio(i2t, surge, 0.5, 1.5, text, w);
}

/* A figure that stands in the file twice: as the limit that runs are held to, and as a parameter
 * that the model is made with. */
static void warn_of_twin(const vs_stand *s, const vs_kind_limit *twin, vs_warnings *w) {
  if (!(twin->is & VS_LIMIT_TWIN)) return;
  vs_figures_asked param = vs_figures_any(s, twin->param), limit = vs_figures_limit(s, twin->name);
  double ratio = param.value / limit.value;
  if (isnan(ratio) || fabs(ratio - 1) < 0.01) return;
  vs_fail_at(vs_warnings_add(w), param.where.file ? param.where : limit.where,
             "%s, by which the model is made, is %.4g times the limit %s: a run is held to the "
             "one, and the model does the other",
             twin->param, ratio, twin->name);
}

/* ---- heat ---- */

/* The place of the line `*$ part`. */
static vs_where part_line(const vs_stand *s) {
  const vs_part_file *file = vs_parts_file(&s->deck, s->file);
  return (vs_where){s->name, file ? file->where.line : 0, 1};
}

/* Without zth nothing is computed of the junction. With it, the rated current must not heat it from
 * a case at 25 degC beyond t_j_max. */
static void warn_of_heat(const vs_stand *s, const vs_kind *kind, vs_warnings *w) {
  static const double WARM_K = 150; /* from 25 degC to 175 degC; few chips go beyond */
  if (!kind->heat.current) return;
  double k_per_w = 0, i = vs_figures_limit(s, kind->heat.current).value,
         v0 = vs_figures_any(s, "on_voltage").value, r = vs_figures_any(s, "on_resistance").value;
  vs_where first = {0};
  for (size_t k = 0; k < s->deck.n_zth; k++) {
    const vs_zth *z = &s->deck.zth[k];
    if (strcmp(z->where.file, s->file)) continue;
    const vs_where where = {s->name, z->where.line, z->where.column};
    if (!first.file) first = where;
    k_per_w += z->k_per_w;
    if (z->tau_s < 1e-6 || z->tau_s > 1e4)
      vs_fail_at(vs_warnings_add(w), where,
                 "implausible: a time constant of %.4g s; chips and cases have 1 us to 10,000 s",
                 z->tau_s);
  }
  if (!first.file)
    vs_fail_at(vs_warnings_add(w), part_line(s),
               "no line 'zth': the junction's temperature is not computed, so that nothing tells "
               "when it is too hot; give the terms of Z_th(j-c)");
  const double mean_a = kind->heat.mean * i, rms_a = kind->heat.rms * i;
  double loss_w = mean_a; /* at 1 V */
  if (isfinite(r)) loss_w = (isfinite(v0) ? v0 : 0) * mean_a + r * rms_a * rms_a;
  if (first.file && k_per_w * loss_w > WARM_K)
    vs_fail_at(vs_warnings_add(w), first,
               "implausible: the lines zth make %.4g K/W, by which %s = %.4g A heats the "
               "junction by %.4g K",
               k_per_w, kind->heat.current, i, k_per_w * loss_w);
}

/* ---- what was measured ---- */

/* True where a warning speaks of that line. */
static bool is_named(const vs_warnings *w, int line) {
  for (size_t k = 0; k < w->count; k++)
    if (w->item[k].line == line && line) return true;
  return false;
}

/* A model may meet what is asked because it is ideal, as no device is. */
static void warn_of_figure(const vs_stand *s, const vs_figure *row, vs_warnings *w) {
  static const double FAR = 20; /* times better than what is asked */
  vs_where where = row->where.file ? row->where : part_line(s);
  double factor = vs_units_factor(row->unit), limit = vs_figures_limit(s, "di_dt").value;
  if (isnan(row->got)) return;
  if (!strcmp(row->name, "V_GT") && (row->got < 0.55 || row->got > 5))
    vs_fail_at(
        vs_warnings_add(w), where,
        "implausible: the model's gate fires at %.3g V; a gate's junction wants 0.55 to 5 V, "
        "and noise below that would fire it in a run",
        row->got);
  if (!strcmp(row->name, "di/dt") && row->got > 100 * limit)
    vs_fail_at(
        vs_warnings_add(w), vs_figures_limit(s, "di_dt").where,
        "implausible: di_dt = %.4g A/us, and the model turns on at %.3g A/us: a run's margin "
        "of di_dt would be %.2g %%, and tell nothing of the device; look at the unit, or "
        "give the circuit its inductance",
        limit * 1e-6, row->got * 1e-6, 100 * (1 - row->got / limit));
  if (is_named(w, row->where.line)) return; /* what is asked is wrong already */
  bool better = (row->held == VS_HELD_AT_MOST && row->got < row->asked / FAR) ||
                (row->held == VS_HELD_AT_LEAST && row->got > row->asked * FAR);
  if (better && isinf(row->got))
    vs_fail_at(vs_warnings_add(w), where,
               "implausible: the model never shows %s, and %.4g %s is asked: runs will not tell "
               "when the device would",
               row->name, row->asked / factor, row->unit);
  else if (better)
    vs_fail_at(vs_warnings_add(w), where,
               "implausible: %s is %.3g %s, and %.4g %s is asked: a model that is better than its "
               "device by so much hides what the device would do",
               row->name, row->got / factor, row->unit, row->asked / factor, row->unit);
}

static void warn_of_kind(const vs_stand *s, const vs_kind *kind, vs_warnings *w) {
  for (size_t k = 0; k < kind->n_limits; k++) warn_of_range(s, kind->name, &kind->limits[k], w);
  for (int k = 0; k < VS_KIND_RATIOS && kind->ratios[k].more; k++)
    warn_of_pair(s, &kind->ratios[k], w);
  warn_of_surge(s, vs_kinds_surge_limit(kind->name), w);
  for (size_t k = 0; k < kind->n_limits; k++) warn_of_twin(s, &kind->limits[k], w);
  warn_of_heat(s, kind, w);
}

/* By line, in the order of the file. */
static void sort(vs_warnings *w, size_t first) {
  for (size_t k = first + 1; k < w->count; k++)
    for (size_t n = k; n > first && w->item[n - 1].line > w->item[n].line; n--) {
      vs_error other = w->item[n];
      w->item[n] = w->item[n - 1];
      w->item[n - 1] = other;
    }
}

/* Adds a warning for each implausible number: of the file's limits, parameters and thermal
 * impedance, and of what was measured. Says nothing of a part without any limit, which is ideal. */
static void plausibility_warn(const vs_stand *s, const vs_figures *figures, vs_warnings *w) {
  const vs_part_file *file = vs_parts_file(&s->deck, s->file);
  const vs_kind *kind = file ? vs_kinds_find(file->kind) : NULL;
  size_t first = w->count;
  if (*figures->shows) vs_fail_at(vs_warnings_add(w), part_line(s), "%s", figures->shows);
  if (!file || !vs_parts_is_real(&s->deck, s->file)) return;
  if (kind) warn_of_kind(s, kind, w);
  for (size_t k = 0; k < figures->count; k++) warn_of_figure(s, &figures->row[k], w);
  sort(w, first);
}

static const vs_figures_kind *const KINDS[] = {
    &vs_thyristor_kind,    &vs_triac_kind,          &vs_diode_kind,       &vs_diac_kind,
    &vs_transistor_mosfet, &vs_transistor_igbt,     &vs_varistor_kind,    &vs_varistor_zener,
    &vs_varistor_tvs,      &vs_fuse_kind,           &vs_passive_resistor, &vs_passive_capacitor,
    &vs_passive_snubber,   &vs_passive_electrolytic};

/* ---- rows, shown ---- */

static const char *const SIGN[] = {[VS_HELD_NEAR] = "", "<= ", ">= ", ""},
                         *const HELD[] = {[VS_HELD_NEAR] = "near", "at most", "at least", NULL};

static double in_shown_unit(const vs_figure *row, double si) {
  return si / vs_units_factor(row->unit);
}

static void write_asked(const vs_figure *row, char *text, size_t size) {
  if (row->held == VS_HELD_NOT)
    snprintf(text, size, "-");
  else if (row->held == VS_HELD_NEAR)
    snprintf(text, size, "%.4g +- %.3g %s", in_shown_unit(row, row->asked),
             in_shown_unit(row, row->tolerance), row->unit);
  else
    snprintf(text, size, "%s%.4g %s", SIGN[row->held], in_shown_unit(row, row->asked), row->unit);
}

static void write_got(const vs_figure *row, char *text, size_t size) {
  if (isnan(row->got))
    snprintf(text, size, "-");
  else if (isinf(row->got))
    snprintf(text, size, "none");
  else
    snprintf(text, size, "%.4g %s", in_shown_unit(row, row->got), row->unit);
}

static void add_figures_table(const vs_figures *f, vs_text *table) {
  vs_text_add(table, "\n%-12s %-22s %-14s %-7s %s", "figure", "asked", "got", "word", "test");
  for (size_t k = 0; k < f->count; k++) {
    const vs_figure *row = &f->row[k];
    char asked[64], got[64];
    write_asked(row, asked, sizeof asked);
    write_got(row, got, sizeof got);
    vs_text_add(table, "\n%-12s %-22s %-14s %-7s %s%s%s", row->name, asked, got,
                vs_figures_word(row), row->text, *row->why && isnan(row->got) ? ": " : "",
                isnan(row->got) ? row->why : "");
  }
}

/* Adds one object on a line. file: for a row of check's array, which has a place and a message
 * besides, and where the warning about the library has a row of its own; NULL: for bench.json. */
static void add_figure_json(const vs_figure *row, const char *file, vs_text *text) {
  char asked[64], got[64];
  vs_json json = vs_json_new(text);
  vs_json_object(&json, NULL, VS_JSON_ROW);
  if (file) {
    write_asked(row, asked, sizeof asked);
    write_got(row, got, sizeof got);
    vs_text message = {0};
    vs_text_add(&message, "%s: asked %s, got %s: %s", row->name, asked, got, vs_figures_word(row));
    vs_json_text(&json, "file", file);
    vs_json_number(&json, "line", row->where.line ? (double)row->where.line : (double)NAN, 12);
    vs_json_number(&json, "column", row->where.line ? (double)row->where.column : (double)NAN, 12);
    vs_json_text(&json, "message", message.text);
    vs_text_free(&message);
  }
  vs_json_text(&json, "figure", row->name);
  vs_json_text(&json, "unit", row->unit);
  vs_json_text(&json, "held", HELD[row->held]);
  vs_json_number(&json, "asked", in_shown_unit(row, row->asked), 9);
  vs_json_number(&json, "tolerance", in_shown_unit(row, row->tolerance), 9);
  vs_json_number(&json, "got", in_shown_unit(row, row->got), 9);
  vs_json_text(&json, "word", vs_figures_word(row));
  vs_json_text(&json, "test", row->text);
  vs_json_text(&json, "why", isnan(row->got) ? row->why : NULL);
  if (row->of && isfinite(row->got / row->sheet)) {
    vs_json_text(&json, "of", row->of);
    vs_json_number(&json, "model_deviation", row->got / row->sheet - 1, 9);
  }
  if (!file) vs_json_text(&json, "warning", *vs_self_test_text() ? vs_self_test_text() : NULL);
  vs_json_end(&json);
}

/* ---- the picture ---- */

/* A gnuplot data block of at most MOST points: steps are dense where nothing shows. */
static void add_curve_points(const vs_figures_curve *c, size_t number, vs_script *script) {
  enum { MOST = 4000 };
  size_t every = 1 + c->points / MOST;
  vs_gnuplot_add(script, "$curve%zu << EOD\n", number);
  for (size_t k = 0; k < c->points; k += every)
    vs_gnuplot_add(script, "%.6g %.6g\n", c->x[k], c->y[k]);
  vs_gnuplot_add(script, "EOD\n");
}

static void add_curve_panel(const vs_figures_curve *c, size_t number, vs_script *script) {
  vs_gnuplot_add(script, c->log_x ? "set logscale x\nset title " : "unset logscale x\nset title ");
  vs_gnuplot_caption(script, c->title, 380, 10);
  vs_gnuplot_add(script, "\nset xlabel ");
  vs_gnuplot_quoted(script, c->x_label);
  vs_gnuplot_add(script, "\nset ylabel ");
  vs_gnuplot_quoted(script, c->y_label);
  vs_gnuplot_add(script, "\nplot $curve%zu using 1:2 with lines lw 1.5 lc rgb %s notitle\n", number,
                 vs_scale_colours[number % VS_COLOURS]);
}

/* Draws all curves side by side into a PNG of `size` bytes, to be freed by the caller. Errors:
 * VS_RUN, gnuplot is not installed or failed. */
static vs_status draw_curves(const vs_figures *f, const char *title, char **picture, size_t *size,
                             vs_error *err) {
  vs_script script = {0};
  for (size_t k = 0; k < f->n_curves; k++) add_curve_points(&f->curve[k], k, &script);
  vs_gnuplot_add(&script,
                 "set terminal pngcairo noenhanced size %zu,360 font 'sans,10' background rgb "
                 "'white'\nset multiplot layout 1,%zu title ",
                 420 * f->n_curves, f->n_curves);
  vs_gnuplot_caption(&script, title, (int)(420 * f->n_curves), 10);
  vs_gnuplot_add(&script,
                 "\nset grid lt 1 lw 0.5 lc rgb '#d0d0d0'\nset border 3\nset tics nomirror\n");
  for (size_t k = 0; k < f->n_curves; k++) add_curve_panel(&f->curve[k], k, &script);
  vs_gnuplot_add(&script, "unset multiplot\n");
  vs_status status = vs_gnuplot_picture(script.text.text, picture, size, err);
  vs_gnuplot_free(&script);
  return status;
}

/* ---- files ---- */

static void add_csv(const vs_figures *f, vs_text *text) {
  vs_text_add(text, "figure,unit,held,asked,tolerance,got,word,test,warning\n");
  for (size_t k = 0; k < f->count; k++) {
    const vs_figure *row = &f->row[k];
    const double number[] = {in_shown_unit(row, row->asked), in_shown_unit(row, row->tolerance),
                             in_shown_unit(row, row->got)};
    vs_csv_cell(text, row->name);
    vs_text_add(text, ",");
    vs_csv_cell(text, row->unit);
    vs_text_add(text, ",%s", HELD[row->held] ? HELD[row->held] : "");
    for (size_t n = 0; n < 3; n++)
      if (isfinite(number[n]))
        vs_text_add(text, ",%.9g", number[n]);
      else
        vs_text_add(text, ",");
    vs_text_add(text, ",%s,", vs_figures_word(row));
    vs_csv_cell(text, row->text);
    vs_text_add(text, ",");
    vs_csv_cell(text, vs_self_test_text());
    vs_text_add(text, "\n");
  }
}

static vs_status write_bench_file(const char *folder, const char *name, const char *bytes,
                                  size_t size, vs_error *err) {
  vs_file file;
  vs_status status = vs_file_open(&file, folder, name, err);
  if (status) return status;
  fwrite(bytes, 1, size, file.stream);
  return vs_file_commit(&file, err);
}

/* Writes bench.csv and bench.json, and bench.png where a test has curves. A picture that cannot be
 * drawn is only a warning. */
static vs_status write_folder(const vs_check_options *o, const vs_figures *f, const char *title,
                              vs_error *err) {
  vs_text csv = {0}, json = {0};
  char *picture = NULL;
  size_t size = 0;
  int made = 0;
  vs_error why = {0};
  add_csv(f, &csv);
  vs_text_add(&json, "[");
  for (size_t k = 0; k < f->count; k++) {
    vs_text_add(&json, "%s\n  ", k ? "," : "");
    add_figure_json(&f->row[k], NULL, &json);
  }
  vs_text_add(&json, "\n]\n");
  vs_status status = vs_file_folder_make(o->folder, &made, err);
  if (!status) status = write_bench_file(o->folder, "bench.csv", csv.text, csv.length, err);
  if (!status) status = write_bench_file(o->folder, "bench.json", json.text, json.length, err);
  vs_status drawn = status || !f->n_curves ? VS_OK : draw_curves(f, title, &picture, &size, &why);
  if (!status && picture) status = write_bench_file(o->folder, "bench.png", picture, size, err);
  if (drawn && !o->quiet)
    fprintf(stderr, "vibrospice: warning: there is no picture: %s\n", why.text);
  free(picture);
  vs_text_free(&csv);
  vs_text_free(&json);
  return status;
}

/* ---- all ---- */

/* How many numbers of the part's file are marked `assumed`. */
static size_t count_assumed(const char *path) {
  vs_catalogue_part row = {0};
  vs_source source = {0};
  vs_error unread = {0};
  size_t count = 0;
  const bool is_row = vs_catalogue_is_row(path);
  if (is_row ? vs_catalogue_read(path, &row, &unread) : vs_source_read(path, &source, &unread))
    return 0;
  const vs_source *lines = is_row ? &row.source : &source;
  for (size_t k = 0; k < lines->count; k++) {
    char *quote = strchr(lines->line[k], '"');
    if (quote) *quote = '\0';
    count += !strncmp(lines->line[k], "*$", 2) && strstr(lines->line[k], " assumed") != NULL;
  }
  vs_catalogue_free(&row);
  vs_source_free(&source);
  return count;
}

static void tell_figures(const vs_stand *s, const vs_figures *f, vs_check_bench *bench) {
  size_t assumed = count_assumed(s->file);
  add_figures_table(f, &bench->table);
  for (size_t k = 0; k < f->count; k++) {
    const char *word = vs_figures_word(&f->row[k]);
    bool asked = f->row[k].held != VS_HELD_NOT;
    bench->off += asked && (!strcmp(word, "off") || !strcmp(word, "failed"));
    bench->figures += asked;
    add_figure_json(&f->row[k], s->name, &bench->rows);
    vs_text_add(&bench->rows, "\n");
  }
  if (assumed)
    vs_text_add(&bench->table, "\n%zu number%s of the file %s marked assumed", assumed,
                assumed == 1 ? "" : "s", assumed == 1 ? "is" : "are");
}

/* ---- the model beside the sheet ---- */

/* A search for a figure ends within 2 %, and with another version of ngspice it may end a step
 * away. A line `model` that is further off than that belongs to another model. */
static const double AGREES = 0.02;

static double in_percent(double deviation) {
  return round(100 * deviation) + 0.0; /* no -0 */
}

/* Warns of a line `model` that differs from what was measured on the stand. */
static void warn_of_model(const vs_stand *s, const vs_model_line *line, double got,
                          vs_warnings *w) {
  const vs_where where = {s->name, line->where.line, line->where.column};
  if (isnan(got))
    vs_fail_at(
        vs_warnings_add(w), where,
        "model %s: the test stand has nothing to compare, as the file asks no such figure or "
        "the model shows none; leave the line out",
        line->figure);
  else if (fabs(got - line->deviation) > AGREES)
    vs_fail_at(vs_warnings_add(w), where,
               "model %s = %+.3g %%: on the test stand it is %+.0f %%, and a verdict shows what "
               "stands here",
               line->figure, 100 * line->deviation, in_percent(got));
}

/* Prints the lines `model` that the file lacks, so that they can be put into it; warns of those
 * that are wrong. An ideal part has no finite limit, and nothing is said of it. */
static void tell_of_models(const vs_stand *s, const vs_figures *f, vs_check_bench *bench) {
  const vs_part_file *file = vs_parts_file(&s->deck, s->file);
  const bool real = vs_parts_is_real(&s->deck, s->file);
  vs_text missing = {0};
  for (size_t k = 0; k < s->deck.n_models; k++)
    if (!strcmp(s->deck.models[k].where.file, s->file))
      warn_of_model(s, &s->deck.models[k], vs_figures_deviation(f, s->deck.models[k].figure),
                    bench->warnings);
  for (size_t k = 0; k < f->count && real; k++) {
    const char *of = f->row[k].of;
    size_t first = 0; /* of several rows of one figure */
    if (!of || !vs_kinds_is_hung_on(file->kind, of, NULL)) continue;
    while (!f->row[first].of || strcmp(f->row[first].of, of)) first++;
    const double got = vs_figures_deviation(f, of);
    if (first == k && isfinite(got) && !vs_parts_find_model(&s->deck, s->file, of))
      vs_text_add(&missing, "\n*$ model  %s = %+.0f %%", of, in_percent(got));
  }
  if (missing.length)
    vs_text_add(
        &bench->table,
        "\nthe file does not say how far its model is from the sheet. With these lines in it, "
        "verdicts show that:%s",
        missing.text);
  vs_text_free(&missing);
}

/* Error: ngspice cannot take the part at all, whatever stands around it. What it says of one
 * iteration, or of its steps, is of this circuit alone: each figure's own tells. A part without
 * pins in the table of kinds is a snubber, which has two. */
static vs_status try_part(const vs_stand *s, const vs_figures_kind *tried, vs_error *err) {
  const vs_kind *kind = vs_kinds_find(tried->name);
  vs_text text = {0};
  vs_stand_record r = {0};
  vs_text_add(&text, "Vm a t 0\nXdut");
  for (int k = 0; k < (kind ? vs_kinds_count_pins(kind) : 2); k++)
    vs_text_add(&text, " %c", "t0g"[kind ? kind->pins[k].role : k]);
  vs_text_add(&text, " %s\nRa a 0 1e6\nRg g 0 1e6\n", s->subcircuit);
  const vs_stand_circuit c = {text.text, 1e-6, 1e-7, 0};
  vs_status status = vs_stand_run(s, &c, &r, err);
  vs_stand_free(&r);
  vs_text_free(&text);
  if (status && strstr(err->text, vs_stand_late))
    vs_fail_at(err, (vs_where){.file = s->name},
               "the model alone takes ngspice more than %d s of processor time for the first "
               "microsecond, so that nothing can be tried or run with it; take a simpler model of "
               "the device, such as its maker's of a lower level, or `vibrospice part %s`",
               VS_CHILD_SECONDS, tried->name);
  return status && !err->gave_up ? VS_INPUT : VS_OK;
}

/* Says that nothing was tried, so that the absence of figures is not taken for a good result. */
static void tell_of_no_bench(const vs_stand *s, vs_check_bench *bench) {
  const vs_part_file *file = vs_parts_file(&s->deck, s->file);
  vs_text message = {0};
  vs_text_add(
      &message,
      "no bench: parts of the kind '%s' are read and not tried, so that nothing is known of "
      "what the model does",
      file ? file->kind : "");
  vs_text_add(&bench->table, "\n%s", message.text);
  vs_json json = vs_json_new(&bench->rows);
  vs_json_object(&json, NULL, VS_JSON_ROW);
  vs_json_text(&json, "file", s->name);
  vs_json_number(&json, "line", file ? (double)file->where.line : (double)NAN, 12);
  vs_json_number(&json, "column", file ? (double)file->where.column : (double)NAN, 12);
  vs_json_text(&json, "message", message.text);
  vs_json_end(&json);
  vs_text_add(&bench->rows, "\n");
  vs_text_free(&message);
}

/* The kind of the part on the stand; NULL: it is not tried. */
static const vs_figures_kind *kind_of(const vs_stand *s) {
  const vs_part_file *file = vs_parts_file(&s->deck, s->file);
  for (size_t k = 0; k < sizeof KINDS / sizeof *KINDS && file; k++)
    if (!strcmp(KINDS[k]->name, file->kind)) return KINDS[k];
  return NULL;
}

vs_status vs_acceptance_try(const vs_check_options *o, vs_check_bench *bench, vs_error *err) {
  vs_stand *s = vs_alloc(1, sizeof *s);
  vs_figures f = {0};
  vs_error own = {0};
  vs_status status = vs_stand_open(o->name, s, &own);
  const vs_figures_kind *kind = status ? NULL : kind_of(s);
  if (!kind && !status) tell_of_no_bench(s, bench);
  if (kind) status = try_part(s, kind, &own);
  if (kind && !status) kind->measure(s, &f);
  if (!status) plausibility_warn(s, &f, bench->warnings);
  if (f.count) tell_figures(s, &f, bench);
  if (f.count) tell_of_models(s, &f, bench);
  if (f.count && o->folder) status = write_folder(o, &f, s->subcircuit, &own);
  if (status) *err = (own.findings = err->findings, own);
  vs_figures_free(&f);
  vs_stand_close(s);
  free(s);
  return status;
}
