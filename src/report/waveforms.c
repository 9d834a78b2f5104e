/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "waveforms.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/gnuplot.h"
#include "plot/strips.h"
#include "report/html.h"

enum {
  WIDTH = 560,
  HEIGHT = 300,     /* pixels of a picture: two fit beside each other */
  MOST_ROWS = 50000 /* of a run that is drawn whole; with more the page would be too large */
};

/* ---- what is shown ---- */

static bool is_in_all(const vs_time_window *s, const vs_column *column) {
  for (size_t k = 0; k < s->runs; k++)
    if (vs_traces_like(&s->run[k].traces, column) < 1) return false;
  return true;
}

/* Keeps only the probes that all runs have. */
static void drop_alone(vs_time_window *s) {
  int kept = 0;
  for (int k = 0; k < s->probes.count; k++)
    if (is_in_all(s, s->probes.item[k].of)) s->probes.item[kept++] = s->probes.item[k];
  s->probes.count = kept;
}

/* True for a column of this machine, circuit, instruments or control; every run has the other
 * columns. */
static bool is_own(const vs_column *c) {
  return strcmp(c->role, VS_COLUMN_COORDINATE) && strcmp(c->role, VS_COLUMN_RATE) &&
         strcmp(c->role, VS_COLUMN_ACCELERATION) && !vs_channel_is_standard(c->quantity);
}

static bool is_chosen(const vs_time_window *s, const vs_column *c) {
  bool chosen = false;
  for (int k = 0; k < s->probes.count; k++) chosen = chosen || s->probes.item[k].of == c;
  return chosen;
}

static vs_status choose_waves(vs_time_window *s, vs_error *err) {
  const vs_traces *t = &s->run[0].traces;
  vs_status status = vs_time_window_find_probes(NULL, t, &s->probes, err);
  if (!status) drop_alone(s);
  for (size_t c = 1; !status && c < t->columns; c++)
    if (s->probes.count < VS_PROBES_MOST && is_own(&t->column[c]) && !is_chosen(s, &t->column[c]) &&
        is_in_all(s, &t->column[c]))
      status = vs_time_window_find_probes(t->name[c], t, &s->probes, err);
  return status;
}

static bool is_long(const vs_traces *t) {
  return t->drawn_rows > MOST_ROWS;
}

/* The first row of run.csv to draw, so that about MOST_ROWS are drawn from it to the end. The drawn
 * rows include those at peaks, which are assumed to be evenly spread. */
static size_t first_drawn(const vs_traces *t) {
  double rows = (double)MOST_ROWS * (double)t->rows / (double)t->drawn_rows;
  return t->rows - (size_t)fmax(rows, 1);
}

/* Of a run that is not drawn whole: begins before its first event, where that would not be shown.
 */
static void begin_at_event(vs_time_window *s) {
  const vs_traces *t = &s->run[0].traces;
  const double event_s = vs_time_window_first_event(&s->run[0].moments);
  if (s->runs > 1 || !is_long(t) || !(event_s < s->from_s)) return;
  const size_t rows = t->rows - first_drawn(t);
  size_t from = 0;
  while (from < t->rows && vs_trace_time(t, from) < event_s) from++;
  from = from > rows / 10 ? from - rows / 10 : 0;
  s->from_s = vs_trace_time(t, from);
  s->to_s = vs_trace_time(t, from + rows - 1);
}

static vs_status open_run(vs_time_window_run *run, const char *folder, vs_error *err) {
  run->folder = folder;
  vs_status status = vs_traces_read(folder, &run->traces, err);
  return status ? status : vs_time_window_read_moments(folder, &run->moments, err);
}

vs_status vs_waveforms_open(vs_time_window *s, const char *const *folders, size_t count,
                            vs_error *err) {
  double from = INFINITY, late = -INFINITY;
  vs_status status = VS_OK;
  s->to_s = -INFINITY;
  for (size_t k = 0; k < count && !status; k++) {
    const vs_traces *t = &s->run[k].traces;
    s->runs++;
    status = open_run(&s->run[k], folders[k], err);
    if (status) break;
    from = fmin(from, vs_trace_time(t, 0));
    if (is_long(t)) late = fmax(late, vs_trace_time(t, first_drawn(t)));
    s->to_s = fmax(s->to_s, vs_trace_time(t, t->rows - 1));
  }
  s->from_s = fmax(from, late);
  if (!status) begin_at_event(s);
  return status ? status : choose_waves(s, err);
}

void vs_waveforms_close(vs_time_window *s) {
  for (size_t k = 0; k < s->runs; k++) {
    vs_traces_free(&s->run[k].traces);
    vs_time_window_free_moments(&s->run[k].moments);
  }
}

/* ---- the section ---- */

static vs_status add_picture(const vs_time_window *s, int probe, vs_html *html, vs_error *err) {
  vs_script script = {0};
  char *svg = NULL;
  size_t size;
  const char *label = s->probes.item[probe].label;
  vs_gnuplot_add(&script,
                 "set terminal svg dynamic mousing standalone noenhanced size %d,%d font "
                 "'sans-serif,13' background rgb 'white'\n",
                 WIDTH, HEIGHT);
  vs_strips_one(s, probe, &script);
  vs_status status = vs_gnuplot_picture(script.text.text, &svg, &size, err);
  const vs_html_picture picture = {label,  s->probes.item[probe].column, svg, WIDTH,
                                   HEIGHT, vs_strips_time_unit(s)};
  if (!status) vs_html_picture_add(html, &picture);
  free(svg);
  vs_gnuplot_free(&script);
  return status;
}

vs_status vs_waveforms_add(const vs_time_window *s, vs_html *html, vs_error *err) {
  vs_status status = VS_OK;
  bool whole = true;
  for (size_t k = 0; k < s->runs; k++) whole = whole && !is_long(&s->run[k].traces);
  vs_html_add(html,
              "<section id=\"waveforms\">\n<h2>Waveforms</h2>\n<p class=\"of screen\">A click sets "
              "cursor A, the next one cursor B: below each picture stand the values there, and "
              "their difference. Ctrl and the wheel zoom, the right button goes back.</p>\n");
  if (!whole)
    vs_html_add(html, "<p>%s more than %d rows, and is drawn from %.6g s to %.6g s.</p>\n",
                s->runs > 1 ? "A run has" : "The run has", MOST_ROWS, s->from_s, s->to_s);
  if (!s->probes.count) vs_html_add(html, "<p>The runs have no column in common.</p>\n");
  vs_html_add(html, "<div class=\"pictures\">\n");
  for (int k = 0; k < s->probes.count && !status; k++) status = add_picture(s, k, html, err);
  vs_html_add(html, "</div>\n</section>\n");
  return status;
}
