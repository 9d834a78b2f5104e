/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/strips.h"

#include <math.h>
#include <string.h>

#include "base/gnuplot.h"

enum {
  MOST_LINES = 200, /* of moments */
  APART = 40,       /* words are at least a 40th of the width apart */
  CLOSE_UP = 8,     /* points of the words there, and in a strip that stands alone */
  ALONE = 12,
  SINGLE = 300, /* with fewer rows in a window each can be told from the next */
  CROWD = 8     /* with more moments than this, equal words stand only once */
};

static double time_scale(const vs_time_window *s) {
  return s->to_s <= 2 ? 1e3 : 1;
}

const char *vs_strips_time_unit(const vs_time_window *s) {
  return time_scale(s) > 1 ? "ms" : "s";
}

static bool is_shown(const vs_time_window *s, const vs_moment *m) {
  return m->at_s >= s->from_s && m->at_s <= s->to_s;
}

/* True where a moment with the same words was marked before, and there are many moments. */
static bool is_repeated(const vs_time_window *s, const vs_moments *m, size_t k) {
  size_t shown = 0;
  bool before = false;
  for (size_t other = 0; other < m->count; other++) {
    if (!is_shown(s, &m->item[other])) continue;
    shown++;
    before = before || (other < k && !strcmp(m->item[other].what, m->item[k].what));
  }
  return before && shown > CROWD;
}

/* True where an event of the scene, whose words always stand, follows within that time. */
static bool is_crowded(const vs_moments *m, size_t k, double room) {
  for (size_t n = k + 1; n < m->count && m->item[n].at_s - m->item[k].at_s < room; n++)
    if (m->item[n].is_event) return true;
  return false;
}

/* Adds a line for each moment of a run. If `words` is not 0, also the moment's text, which may be
 * as long as `words` strips are high, in letters of `size` points. */
static void add_moments(const vs_time_window *s, size_t run, int words, int size,
                        vs_script *script) {
  const vs_moments *m = &s->run[run].moments;
  double scale = time_scale(s), last = -INFINITY,
         room = (s->to_s - s->from_s) * size / (CLOSE_UP * APART);
  int lines = 0;
  const int room_pixels = words * VS_TIME_WINDOW_HEIGHT;
  for (size_t k = 0; k < m->count && lines < MOST_LINES; k++) {
    const vs_moment *now = &m->item[k];
    if (!is_shown(s, now)) continue;
    lines++;
    vs_gnuplot_add(script,
                   "set arrow from first %.9g, graph 0 to first %.9g, graph 1 nohead lc rgb %s lw "
                   "%.1f dt 3 back\n",
                   scale * now->at_s, scale * now->at_s,
                   s->runs > 1 ? vs_time_window_colour(run) : "#808080", now->is_event ? 1.8 : 0.9);
    if (!words || (!now->is_event &&
                   (now->at_s - last < room || is_repeated(s, m, k) || is_crowded(m, k, room))))
      continue;
    last = fmax(now->at_s, last + room); /* words never stand on others */
    vs_gnuplot_add(script, "set label ");
    vs_gnuplot_caption(script, now->what, room_pixels, size);
    vs_gnuplot_add(script,
                   " at first %.9g, graph 0.96 rotate by 90 right offset 0.7,0 font ',%d' tc "
                   "rgb '#505050' back\n",
                   scale * last, size);
  }
}

/* Adds the time axis' name, and how far the rows are apart where a picture shows single ones: an
 * edge between two of them is drawn as a slope. */
static void add_time_axis(const vs_time_window *s, vs_script *script) {
  const vs_traces *t = &s->run[0].traces;
  const double span = vs_trace_time(t, t->rows - 1) - vs_trace_time(t, 0),
               apart = t->rows > 1 ? span / (double)(t->rows - 1) : 0;
  vs_gnuplot_add(script, time_scale(s) > 1 ? "set xlabel 't / ms" : "set xlabel 't / s");
  if (apart * SINGLE > s->to_s - s->from_s && apart > 0)
    vs_gnuplot_add(script, "    (rows are %.3g ms apart, closer at peaks: run.sample)",
                   1e3 * apart);
  vs_gnuplot_add(script, "'\n");
}

/* Adds one strip. The first strip has the words, the last one the time axis; a strip that stands
 * alone has both. */
static void add_strip(const vs_time_window *s, int probe, bool alone, vs_script *script) {
  const vs_probe_shown *p = &s->probes.item[probe];
  bool legend = s->runs > 1 && (alone || !probe);
  vs_gnuplot_add(script, "unset label\nunset arrow\n");
  for (size_t r = 0; r < s->runs; r++)
    add_moments(s, r,
                r       ? 0
                : alone ? 1
                : probe ? 0
                        : s->probes.count,
                alone ? ALONE : CLOSE_UP, script);
  vs_gnuplot_add(script, legend ? "set key tmargin right horizontal reverse Left samplen 2\n"
                                : "unset key\n");
  if (alone || probe + 1 == s->probes.count) add_time_axis(s, script);
  vs_gnuplot_add(script, "set ylabel ");
  vs_gnuplot_quoted(script, p->label);
  vs_gnuplot_add(script, "\nplot ");
  for (size_t r = 0; r < s->runs; r++) {
    const vs_traces *t = &s->run[r].traces;
    vs_gnuplot_add(script, r ? ", " : "");
    vs_gnuplot_path(script, t->drawn);
    vs_gnuplot_add(script, " using ($1*%g):($%d*%g) skip 1 with lines lc rgb %s lw 1.2 title ",
                   time_scale(s), vs_traces_find(t, p->column) + 1, p->scale,
                   vs_time_window_colour(r));
    vs_gnuplot_quoted(script, s->run[r].folder);
  }
  vs_gnuplot_add(script, "\n");
}

void vs_strips_add(const vs_time_window *s, vs_script *script) {
  double scale = time_scale(s);
  vs_time_window_begin(script);
  vs_gnuplot_add(script, "set multiplot layout %d,1\nset xrange [%.9g:%.9g]\n", s->probes.count,
                 scale * s->from_s, scale * s->to_s);
  for (int k = 0; k < s->probes.count; k++) add_strip(s, k, false, script);
  vs_gnuplot_add(script, "unset multiplot\n");
}

void vs_strips_one(const vs_time_window *s, int probe, vs_script *script) {
  double scale = time_scale(s);
  vs_time_window_begin(script);
  vs_gnuplot_add(script, "set xrange [%.9g:%.9g]\n", scale * s->from_s, scale * s->to_s);
  add_strip(s, probe, true, script);
}
