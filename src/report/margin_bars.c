/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/margin_bars.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"
#include "members.h"
#include "netlist/deck.h"
#include "report/scale.h"
#include "run/engineering.h"
#include "run_pair.h"

enum { MOST_BARS = 12, LONGEST = 100 /* characters of a label */ };

/* In pixels: a row, the space above and below the rows, the axis, and the space to its right. A
 * character is 8 wide on average. */
enum { ROW = 30, ABOVE = 48, LINE = 22, BELOW = 62, AXIS = 420, RIGHT = 110, CHARACTER = 8 };

/* ---- the lines ---- */

typedef enum rank { VIOLATED, UNDECIDED, HELD, WAIVED } rank;

typedef struct bar {
  const vs_node *line;
  const char *word;
  rank rank;
  double margin, error; /* as parts of the limit; NaN: not known, or there is none */
  size_t number;        /* of the line in the verdict */
} bar;

static rank rank_of(const char *word) {
  if (!strncmp(word, "violated", strlen("violated"))) return VIOLATED; /* verified or not */
  if (!strcmp(word, "undecided")) return UNDECIDED;
  return strcmp(word, "waived") ? HELD : WAIVED;
}

static const char *colour_of(const bar *b) {
  if (b->rank == VIOLATED) return vs_scale_colour_bad;
  if (b->rank == UNDECIDED) return vs_scale_colours[1]; /* orange */
  return strcmp(b->word, "held") ? "#999999" : vs_scale_colour_good;
}

/* The margin to sort by. An unknown margin of a violated or undecided line may be the least of all;
 * a held line without a margin comes last. */
static double order_of(const bar *b) {
  return !isnan(b->margin) ? b->margin : b->rank < HELD ? -INFINITY : INFINITY;
}

static int tightest_first(const void *a, const void *b) {
  const bar *one = a, *other = b;
  const double x = order_of(one), y = order_of(other);
  if (one->rank != other->rank) return (int)one->rank - (int)other->rank;
  return x != y ? (x > y) - (x < y) : (one->number > other->number) - (one->number < other->number);
}

/* The verdict's lines in the order in which they are drawn; the caller frees them. */
static bar *list_bars(const vs_node *verdict, size_t *count) {
  size_t n = 0;
  for (const vs_node *m = verdict ? verdict->child : NULL; m; m = m->next) n++;
  bar *all = vs_alloc(n + 1, sizeof *all);
  n = 0;
  for (const vs_node *m = verdict ? verdict->child : NULL; m; m = m->next) {
    if (vs_margin_bars_repeats(verdict, m)) continue;
    const char *word = vs_run_pair_word(m);
    all[n] = (bar){.line = m,
                   .word = word,
                   .rank = rank_of(word),
                   .margin = vs_member_number(vs_tree_child(m, "margin")),
                   .error = vs_member_number(vs_tree_child(m, "margin_error")),
                   .number = n};
    n++;
  }
  *count = n;
  qsort(all, *count, sizeof *all, tightest_first);
  return all;
}

/* ---- labels ---- */

static void add_number(vs_text *out, double value) {
  vs_text_add(out, fabs(value) >= 1e4 && fabs(value) < 1e6 ? "%.0f" : "%.4g", value);
}

static double number_of(const vs_node *line, const char *key) {
  return vs_member_number(vs_tree_child(line, key));
}

/* How much the margin differs from the room to this end of a rating; INFINITY: there is no such
 * end. The room to an end of 0 is a part of the range. */
static double unlike(double margin, double value, double end, double sign, double range) {
  const double room = sign * (end - value) / (end != 0 ? fabs(end) : range);
  return isnan(end) ? INFINITY : isnan(room) ? 1e300 : fabs(room - margin);
}

void vs_margin_bars_stress(const vs_node *line, double *value, double *limit) {
  const double min = number_of(line, "min"), max = number_of(line, "max"), range = max - min,
               least = number_of(line, "least"), largest = number_of(line, "largest"),
               margin = number_of(line, "margin");
  const bool low = unlike(margin, least, min, -1, range) < unlike(margin, largest, max, 1, range);
  const bool device = *vs_member_word(line, "device");
  *value = device ? number_of(line, "stress") : low ? least : largest;
  *limit = device ? number_of(line, "limit") : low ? min : max;
}

/* True where a line of a device has this value and limit, signs aside. *same becomes true if it
 * also has the rating's word and margin. */
static bool is_covered(const vs_node *verdict, const vs_node *rating, double value, double limit,
                       bool *same) {
  bool covered = isnan(limit);
  for (const vs_node *m = verdict->child; m && !isnan(limit); m = m->next) {
    if (!*vs_member_word(m, "device") || number_of(m, "stress") != fabs(value) ||
        number_of(m, "limit") != fabs(limit) ||
        strcmp(vs_member_word(m, "unit"), vs_member_word(rating, "unit")))
      continue;
    covered = true;
    *same = *same || (!strcmp(vs_run_pair_word(m), vs_run_pair_word(rating)) &&
                      number_of(m, "margin") == number_of(rating, "margin"));
  }
  return covered;
}

bool vs_margin_bars_repeats(const vs_node *verdict, const vs_node *line) {
  bool same = false;
  return !*vs_member_word(line, "device") &&
         is_covered(verdict, line, number_of(line, "least"), number_of(line, "min"), &same) &&
         is_covered(verdict, line, number_of(line, "largest"), number_of(line, "max"), &same) &&
         same;
}

/* "happened, 3 times", of something that must not happen or is expected to */
static void add_times(vs_text *out, double times, bool expected) {
  vs_text_add(out, times > 0 ? " happened" : " did not happen");
  if (times > 1) vs_text_add(out, ", %.0f times", times);
  if (expected) vs_text_add(out, times > 0 ? ", as expected" : ", though expected");
}

const char *vs_margin_bars_unsure(const vs_node *line) {
  const unsigned assumed = !strcmp(vs_member_word(line, "assumed"), "true"),
                 typical = !strcmp(vs_member_word(line, "typical"), "true");
  return vs_deck_unsure_notes[assumed * VS_ASSUMED + typical * VS_TYPICAL];
}

/* "175 of 200 V/us", "5566 of at least 50 us", "45 of 500 V (assumed)" */
static void add_amounts(vs_text *out, const bar *b, double value, double limit, const char *unit) {
  const bool least = (value > limit) == (b->margin > 0) && limit > 0;
  if (isnan(value) || isnan(limit)) return;
  vs_text_add(out, " ");
  add_number(out, value);
  vs_text_add(out, least ? " of at least " : " of ");
  add_number(out, limit);
  vs_text_add(out, "%s%s%s", *unit ? " " : "", unit, vs_margin_bars_unsure(b->line));
}

/* "thyristor.dv_dt 175 of 200 V/us, held" */
static void write_label(const bar *b, vs_text *out) {
  const char *device = vs_member_word(b->line, "device"), *unit = vs_member_word(b->line, "unit"),
             *unknown = vs_member_word(b->line, "unknown");
  double value, limit;
  if (*device)
    vs_text_add(out, "%s.%s", device, vs_member_word(b->line, "measure"));
  else
    vs_text_add(out, "%s", vs_member_word(b->line, "rating"));
  vs_margin_bars_stress(b->line, &value, &limit);
  if (*unknown)
    vs_text_add(out, ": %s", unknown);
  else if (*device && !*unit) /* what happened is counted */
    add_times(out, value, limit > 0);
  else
    add_amounts(out, b, value, limit, unit);
  vs_text_shorten(out, LONGEST - strlen(", violated, unverified"));
  vs_text_add(out, ", %s", b->word);
}

/* "7 more: 2 waived, the rest above 94 %": the least margin of the lines without a bar that are
 * judged, rounded down */
static void write_rest(const bar *rest, size_t count, vs_text *out) {
  double least = INFINITY;
  size_t waived = 0;
  for (size_t k = 0; k < count; k++)
    if (rest[k].rank == WAIVED)
      waived++;
    else
      least = fmin(least, rest[k].margin);
  vs_text_add(out, "%zu more", count);
  if (waived) vs_text_add(out, waived < count ? ": %zu waived" : ", waived", waived);
  if (isfinite(least))
    vs_text_add(out, "%s above %.0f %%", waived ? ", the rest" : "", fmin(floor(100 * least), 100));
}

/* ---- the title ---- */

static void write_title(const vs_node *summary, vs_text *out) {
  const vs_node *corners = vs_tree_child(summary, "corners");
  vs_text_add(out, "verdict: %s, ", vs_run_pair_whole(vs_tree_child(summary, "verdict")));
  if (corners && corners->child)
    vs_text_add(out, "%s of %s corners held", vs_member_word(corners, "held"),
                vs_member_word(corners, "of"));
  else
    vs_text_add(out, "nominal values");
}

/* Writes the first entry of what happened; if nothing did, the first of what was expected and did
 * not happen; else nothing. The cause is left out if there is no room for it beside what may
 * follow. */
static void write_happened(const vs_node *summary, size_t most, vs_text *out) {
  enum { ENDING = 30 };
  char at[VS_ENGINEERING_SIZE];
  const vs_node *list = vs_tree_child(summary, "happened");
  const bool happened = list && list->child;
  if (!happened) list = vs_tree_child(summary, "did_not_happen");
  const vs_node *first = list ? list->child : NULL;
  size_t more = 0;
  if (!first) return;
  for (const vs_node *m = first->next; m; m = m->next) more++;
  vs_text_add(out, "%s: %s of %s", happened ? "happened" : "did not happen, though expected",
              vs_member_word(first, "what"), vs_member_word(first, "device"));
  const double at_s = vs_member_number(vs_tree_child(first, "at_s"));
  if (!isnan(at_s)) vs_text_add(out, " at %s", vs_engineering_text(at_s, "s", at));
  const char *cause = vs_member_word(first, "cause"), *expected = vs_member_word(first, "expected");
  if (*cause && vs_text_characters(out->text) + vs_text_characters(cause) + ENDING < most)
    vs_text_add(out, " (%s)", cause);
  if (happened && !strcmp(expected, "true")) vs_text_add(out, ", as expected");
  if (more) vs_text_add(out, ", and %zu more", more);
  vs_text_shorten(out, most);
}

/* ---- the picture ---- */

/* A margin in per cent, limited to the ends of the axis. */
static double on_axis(double margin) {
  return 100 * fmax(-1, fmin(1, margin));
}

/* The interval in which the margin lies, by its error. An undecided margin without an error may be
 * anywhere; any other one without an error is a point. */
static void find_span(const bar *b, double span[2]) {
  const double wide = b->rank == UNDECIDED ? INFINITY : 0;
  const double error = isnan(b->error) ? wide : fabs(b->error);
  span[0] = on_axis(b->margin - error);
  span[1] = on_axis(b->margin + error);
}

/* Writes the margin as text to the right of its bar. */
static void add_margin(vs_script *script, const bar *b, double right, int row) {
  char text[48];
  snprintf(text, sizeof text, "%.3g %%", 100 * b->margin);
  if (fabs(b->margin) > 1)
    snprintf(text, sizeof text, b->margin > 0 ? "above 100 %%" : "below -100 %%");
  vs_gnuplot_add(script, "set label %s at first %.6g, first %d left offset 0.8,0 front\n", text,
                 fmax(right, 0), row);
}

static void add_bar(vs_script *script, const bar *b, int row) {
  double span[2];
  if (isnan(b->margin)) return;
  find_span(b, span);
  const double end = on_axis(b->margin);
  vs_gnuplot_add(script,
                 "set object rectangle from first %.6g, first %.2f to first %.6g, first %.2f "
                 "fillstyle solid 0.9 noborder fillcolor rgb %s\n",
                 fmin(end, 0), row - 0.34, fmax(end, 0), row + 0.34, colour_of(b));
  if (span[1] > span[0])
    vs_gnuplot_add(script,
                   "set arrow from first %.6g, first %d to first %.6g, first %d heads size "
                   "screen 0.005,90 front lc rgb '#202020' lw 1.2\n",
                   span[0], row, span[1], row);
  add_margin(script, b, fmax(end, span[1]), row);
}

static void add_label(vs_script *script, const char *text, int row, const char *colour) {
  vs_gnuplot_add(script, "set label %s at graph 0, first %d right offset -0.8,0 textcolor rgb %s\n",
                 text, row, colour);
}

/* Writes a line of the title. */
static void add_title(vs_script *script, const char *text, int from_top, int height, int points) {
  vs_gnuplot_add(script, "set label %s at screen 0.015, screen %.5f left font 'sans,%d'\n", text,
                 1 - (double)from_top / height, points);
}

/* Writes the labels of the bars, and one for the lines without a bar if there are any. Returns
 * their number. */
static size_t write_labels(const bar *all, size_t count, vs_text *label) {
  const size_t shown = count < MOST_BARS ? count : MOST_BARS;
  for (size_t k = 0; k < shown; k++) write_label(&all[k], &label[k]);
  if (count > shown) write_rest(all + shown, count - shown, &label[shown]);
  return shown + (count > shown);
}

static void add_frame(vs_script *script, const int size[2], int left, int top, size_t rows,
                      bool svg) {
  vs_gnuplot_code(script, svg ? "set terminal svg dynamic" : "set terminal pngcairo");
  vs_gnuplot_add(script,
                 " noenhanced size %d,%d font 'sans,%d' background rgb 'white'\nset lmargin at "
                 "screen %.5f\nset rmargin at screen %.5f\nset tmargin at screen %.5f\nset bmargin "
                 "at screen %.5f\nset yrange [%.1f:-0.5]\n",
                 size[0], size[1], svg ? 13 : 10, (double)left / size[0],
                 (double)(left + AXIS) / size[0], 1 - (double)top / size[1],
                 (double)BELOW / size[1], (double)rows - 0.5);
  vs_gnuplot_code(script,
                  "unset key\nunset ytics\nset border 1 lc rgb '#404040'\nset xrange [-100:100]\n"
                  "set xtics -100,50,100 nomirror\nset grid x lt 1 lw 0.5 lc rgb '#d0d0d0'\n"
                  "set xlabel 'margin / % of the limit'\nset arrow from first 0, graph 0 to first "
                  "0, graph 1 nohead front lc rgb '#404040'\n");
}

bool vs_margin_bars_script(const vs_node *summary, bool svg, vs_script *script, int size[2]) {
  vs_text label[MOST_BARS + 1] = {0}, title = {0}, happened = {0};
  size_t count, longest = 0;
  bar *all = list_bars(vs_tree_child(summary, "verdict"), &count);
  const size_t rows = write_labels(all, count, label), shown = rows < MOST_BARS ? rows : MOST_BARS;
  for (size_t k = 0; k < rows; k++) {
    const size_t length = vs_text_characters(label[k].text);
    if (length > longest) longest = length;
  }
  const int left = CHARACTER * (int)longest + 24;
  size[0] = left + AXIS + RIGHT;
  write_title(summary, &title);
  write_happened(summary, (size_t)(size[0] / CHARACTER - 4), &happened);
  const int top = ABOVE + (happened.length ? LINE : 0);
  size[1] = top + ROW * (int)rows + BELOW;
  if (count) {
    add_frame(script, size, left, top, rows, svg);
    add_title(script, title.text, LINE, size[1], svg ? 17 : 13);
    if (happened.length) add_title(script, happened.text, 2 * LINE, size[1], svg ? 13 : 10);
    for (size_t k = 0; k < rows; k++)
      add_label(script, label[k].text, (int)k, k < shown ? "#000000" : "#606060");
    for (size_t k = 0; k < shown; k++) add_bar(script, &all[k], (int)k);
    vs_gnuplot_code(script, "plot NaN\n");
  }
  for (size_t k = 0; k < rows; k++) vs_text_free(&label[k]);
  vs_text_free(&title);
  vs_text_free(&happened);
  free(all);
  return count > 0;
}

vs_status vs_margin_bars_draw(const char *folder, bool quiet, vs_error *err) {
  char run[VS_PATH_SIZE], path[VS_PATH_SIZE];
  vs_tree summary = {0};
  snprintf(run, sizeof run, "%s/run.csv", folder);
  snprintf(path, sizeof path, "%s/summary.json", folder);
  if (access(run, R_OK) || access(path, R_OK)) return VS_OK;
  vs_status status = vs_tree_read(path, &summary, err);
  for (int svg = 0; svg < 2 && !status; svg++) {
    vs_script script = {0};
    int size[2];
    if (vs_margin_bars_script(summary.root, svg, &script, size))
      status = vs_gnuplot_draw(script.text.text, folder, svg ? "verdict.svg" : "verdict.png", quiet,
                               err);
    vs_gnuplot_free(&script);
  }
  vs_tree_free(&summary);
  return status;
}

vs_status vs_margin_bars_add(const vs_node *summary, vs_html *html, vs_error *err) {
  vs_script script = {0};
  char *svg = NULL;
  size_t bytes;
  int size[2];
  if (!vs_margin_bars_script(summary, true, &script, size)) return VS_OK;
  vs_status status = vs_gnuplot_picture(script.text.text, &svg, &bytes, err);
  const vs_html_picture picture = {"verdict", "The margin of each limit. A thin line is its error.",
                                   svg,       size[0],
                                   size[1],   NULL};
  vs_html_add(html, "<div class=\"margins\">\n");
  if (!status) vs_html_picture_add(html, &picture);
  vs_html_add(html, "</div>\n");
  free(svg);
  vs_gnuplot_free(&script);
  return status;
}
