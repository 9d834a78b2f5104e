/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "verdict_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/alloc.h"
#include "base/units.h"
#include "measure/unjudged.h"
#include "run/engineering.h"

/* ---- a line of the verdict ---- */

/* A margin beyond this is told as more than it, and one below its negative as less: a time that is
 * many times the one that is wanted, a stress that is many times its limit. */
static const double FAR = 9.99;

/* "12.3 %", ">999 %", "<-999 %"; of a margin that is not known "-". */
static const char *margin_text(double margin, char text[VS_ENGINEERING_SIZE]) {
  if (isnan(margin))
    snprintf(text, VS_ENGINEERING_SIZE, "-");
  else if (fabs(margin) > FAR)
    snprintf(text, VS_ENGINEERING_SIZE, margin > 0 ? ">%.0f %%" : "<-%.0f %%", 100 * FAR);
  else
    snprintf(text, VS_ENGINEERING_SIZE, "%.1f %%", 100 * margin);
  return text;
}

/* "  12.3 % +- 0.04 %", padded where it stands in a column. */
static void print_number(const vs_judgement *j, bool padded, FILE *out) {
  char margin[VS_ENGINEERING_SIZE], error[VS_ENGINEERING_SIZE] = "";
  const bool told = !isnan(j->margin) && fabs(j->margin) <= FAR && !isnan(j->margin_error);
  const double percent = 100 * j->margin_error;
  if (told && isfinite(percent))
    snprintf(error, sizeof error, percent < 99.5 ? "+- %-*.2g %%" : "+- %-*.0f %%", padded ? 6 : 0,
             percent);
  else if (told)
    snprintf(error, sizeof error, "+- ?");
  margin_text(j->margin, margin);
  if (padded)
    fprintf(out, "%9s %11s", margin, error);
  else
    fprintf(out, "%s%s%s", margin, *error ? " " : "", error);
}

/* How far the models that it hangs on are from their sheets: "  (model v_clamp -6 % of sheet)". */
static void print_models(const vs_judgement *j, const char *before, const char *after, FILE *out) {
  vs_text text = {0};
  vs_verdict_models(j, &text);
  if (text.length) fprintf(out, "%s%s%s", before, text.text, after);
  vs_text_free(&text);
}

static void print_verdict_word(const vs_judgement *j, FILE *out) {
  vs_finding word = vs_verdict_word(j);
  fprintf(out, "  %s%s", word == VS_UNVERIFIED && j->margin < 0 ? "violated, " : "",
          vs_verdict_words[word]);
  if (j->torn) fprintf(out, ", as the sequence is");
}

/* "  12.3 % +- 0.04 %  held" */
static void print_margin(const vs_judgement *j, FILE *out) {
  print_number(j, true, out);
  print_verdict_word(j, out);
}

/* What is rated, in the unit that its limit was written in: "76.54 A/us". */
static const char *text_as_written(double si, const char *unit, char text[VS_ENGINEERING_SIZE]) {
  snprintf(text, VS_ENGINEERING_SIZE, "%.4g %s", si / vs_units_factor(unit), unit);
  return text;
}

/* One end of the allowed range, in the rating's unit; "-" where a rating of the scene leaves that
 * end open. */
static const char *end_text(const vs_judgement *j, double si, char text[VS_ENGINEERING_SIZE]) {
  bool open = j->name && isinf(si);
  snprintf(text, VS_ENGINEERING_SIZE, open ? "-" : "%.4g", si / vs_units_factor(j->rating->unit));
  return text;
}

/* A row of the table of ratings: name, least allowed, least and largest seen (dashes where that is
 * not known), largest allowed, unit, margin, and how well the models behind it meet their data
 * sheets. */
static void print_rating(const vs_judgement *j, int width, FILE *out) {
  char name[VS_JUDGED_NAME], end[VS_ENGINEERING_SIZE];
  double unit = vs_units_factor(j->rating->unit);
  fprintf(out, "  %-*s %11s ", width, vs_verdict_name(j, name), end_text(j, j->rating->min, end));
  if (j->unknown)
    fprintf(out, "%11s %11s", "-", "-");
  else
    fprintf(out, "%11.4g %11.4g", j->least.value / unit, j->largest.value / unit);
  fprintf(out, " %11s %-5s ", end_text(j, j->rating->max, end), j->rating->unit);
  print_margin(j, out);
  print_models(j, "  (", ")", out);
  if (j->unknown) fprintf(out, ": %s", j->unknown);
  fprintf(out, "%s%s\n", j->unsure ? "  " : "", vs_deck_unsure_words[j->unsure]);
}

/* The end of what is allowed that the stress is nearer to, or further beyond. */
static double allowed(const vs_judgement *j) {
  if (j->limit) return j->limit->value;
  return j->room[0] < j->room[1] ? j->rating->min : j->rating->max;
}

static void print_device(const vs_judgement *j, int width, FILE *out) {
  char name[VS_JUDGED_NAME], at[VS_ENGINEERING_SIZE] = "", why[2 * VS_DECK_NAME + 16];
  const char *unit_name = vs_verdict_unit(j);
  double unit = vs_units_factor(unit_name);
  if (!isnan(j->stress.at_s)) vs_engineering_text(j->stress.at_s, "s", at);
  fprintf(out, "  %-*s %11.4g ", width, vs_verdict_name(j, name), j->stress.value / unit);
  if (j->lacks)
    fprintf(out, "%11s", "-");
  else
    fprintf(out, "%11.4g", allowed(j) / unit);
  fprintf(out, " %-5s %11s ", unit_name, at);
  print_margin(j, out);
  print_models(j, "  (", ")", out);
  if (j->lacks) fprintf(out, ": %s", vs_verdict_unknown(j, why, sizeof why));
  if (j->over_v > 0) fprintf(out, "  over %.4g V", j->over_v);
  if (j->device && !isnan(j->over_from_s)) fprintf(out, "  from %.6g s on", j->over_from_s);
  if (j->ward) fprintf(out, "  limit of %s", j->ward->name);
  if (j->measure && j->measure->how == VS_R_RETURN_RISE)
    fputs("  compared: a model need not obey it", out);
  fprintf(out, "%s%s\n", j->unsure ? "  " : "", vs_deck_unsure_words[j->unsure]);
}

/* "undecided: v_ak, t_fire (it did not occur, or the run ends too early)", and a line for each
 * limit that a part does not state: "undecided: varistor_1.power: s20k510 states no p_max; waive:
 * [varistor_1.power] leaves it out"
 */
static void print_undecided(const vs_verdict *v, bool lacking, FILE *out) {
  char name[VS_JUDGED_NAME], why[2 * VS_DECK_NAME + 16];
  size_t n = 0;
  for (size_t k = 0; k < v->count; k++)
    if (vs_verdict_word(&v->item[k]) == VS_UNDECIDED && !v->item[k].lacks) {
      fprintf(out, "%s%s", n++ ? ", " : "undecided: ", vs_verdict_name(&v->item[k], name));
      if (v->item[k].unknown) fprintf(out, " (%s)", v->item[k].unknown);
    }
  if (n) fputc('\n', out);
  for (size_t k = 0; lacking && k < v->count; k++) {
    const vs_judgement *j = &v->item[k];
    if (!j->lacks || j->waived) continue;
    vs_verdict_name(j, name);
    fprintf(out, "undecided: %s: %s; waive: [%s] leaves it out\n", name,
            vs_verdict_unknown(j, why, sizeof why), name);
  }
}

/* "waived: varistor_1.power, thyristor.t_q" */
static void print_waived(const vs_expects *expects, FILE *out) {
  char name[2 * VS_DECK_NAME];
  for (size_t k = 0; k < expects->n_waivers; k++)
    fprintf(out, "%s%s", k ? ", " : "waived: ", vs_expect_waiver_name(&expects->waiver[k], name));
  if (expects->n_waivers) fputc('\n', out);
}

/* "happened: thyristor fires without a gate pulse at 40.83 ms, 3 times (dv/dt of 324 V/us up to
 * 406 V)", and whether the scene expects it. */
static void print_happening(const vs_judgement *j, FILE *out) {
  const char *device = j->device->name, *verb = vs_kinds_happening(j->measure)->verb;
  char at[VS_ENGINEERING_SIZE];
  if (!(j->stress.value > 0)) {
    fprintf(out, "did not happen, though expected: %s %s\n", device, verb);
    return;
  }
  fprintf(out, "happened: %s %s at %s", device, verb, vs_engineering_text(j->stress.at_s, "s", at));
  if (j->stress.value > 1) fprintf(out, ", %.0f times", j->stress.value);
  fprintf(out, " (%s", j->cause);
  print_models(j, "; ", "", out);
  const bool opens = !strcmp(vs_kinds_happening(j->measure)->what, "fuse_opens");
  fprintf(out, ")%s%s\n",
          j->expected || j->allowed ? ", as expected"
          : opens                   ? "; expect: [C] allows it, and judges what else is at stake"
                                    : "",
          vs_verdict_word(j) == VS_UNDECIDED ? ", in one of two runs" : "");
}

/* "weakest: thyristor.di_dt, 76.54 A/us where 50 A/us is allowed, margin -53.1 % ..." */
static void print_weakest(const vs_judgement *j, FILE *out) {
  char name[VS_JUDGED_NAME], stress[VS_ENGINEERING_SIZE], limit[VS_ENGINEERING_SIZE];
  const char *unit = vs_verdict_unit(j);
  fprintf(out, "weakest: %s, %s where %s%s is allowed, margin ", vs_verdict_name(j, name),
          text_as_written(j->stress.value, unit, stress), text_as_written(allowed(j), unit, limit),
          vs_deck_unsure_notes[j->unsure]);
  print_number(j, false, out);
  print_models(j, " (", ")", out);
  print_verdict_word(j, out);
  fputc('\n', out);
}

static void print_first_to_fail(const vs_judgement *j, FILE *out) {
  char name[VS_JUDGED_NAME], at[VS_ENGINEERING_SIZE];
  fprintf(out, "first to fail: %s, at %s\n", vs_verdict_name(j, name),
          vs_engineering_text(j->failed_s, "s", at));
}

static vs_finding word_of_breach(vs_finding word, double margin) {
  return margin < 0 && word == VS_UNVERIFIED ? VS_VIOLATED : word;
}

/* The word of the corners where it is worse than that of the nominal values. One that failed is not
 * judged. */
static vs_finding word_of_corners(const vs_corners *c, vs_finding nominal) {
  if (!c || nominal == VS_VIOLATED) return nominal;
  const vs_corner *worst = c->worst < c->count ? &c->item[c->worst] : NULL;
  vs_finding word = worst && worst->breaks ? word_of_breach(worst->word, worst->margin) : nominal;
  return c->failed && word != VS_VIOLATED ? VS_UNDECIDED : word;
}

void vs_verdict_table_word(const vs_result *r, FILE *out) {
  const vs_verdict *v = &r->verdict;
  static const char *const COLOURS[VS_WORDS] = {[VS_HELD] = "32",
                                                [VS_VIOLATED] = "31",
                                                [VS_UNDECIDED] = "33",
                                                [VS_UNVERIFIED] = "33",
                                                [VS_WAIVED] = "33"};
  const vs_judgement *breach = vs_verdict_breach(v);
  vs_finding word = VS_WAIVED; /* of all lines, where nothing else is said */
  for (size_t k = 0; k < v->count; k++) {
    vs_finding own = vs_verdict_word(&v->item[k]);
    if (own == VS_UNVERIFIED || (own == VS_HELD && word == VS_WAIVED)) word = own;
  }
  if (breach) word = word_of_breach(vs_verdict_word(breach), breach->margin);
  const vs_finding nominal = word;
  word = word_of_corners(r->corners, nominal);
  const char *terminal = getenv("TERM");
  bool coloured = out == stdout && isatty(STDOUT_FILENO) && !getenv("NO_COLOR") &&
                  !(terminal && !strcmp(terminal, "dumb")); /* it would show the codes */
  fflush(out);
  if (coloured)
    dprintf(STDOUT_FILENO, "verdict: \033[1;%sm%s\033[0m", COLOURS[word], vs_verdict_words[word]);
  else
    fprintf(out, "verdict: %s", vs_verdict_words[word]);
  if (word != nominal)
    fprintf(out, " at a corner, %s at nominal values", vs_verdict_words[nominal]);
  fputc('\n', out);
}

static int width_of_names(const vs_verdict *v) {
  char name[VS_JUDGED_NAME];
  int width = 18;
  for (size_t k = 0; k < v->count; k++) {
    int n = (int)strlen(vs_verdict_name(&v->item[k], name));
    if (n > width) width = n;
  }
  return width;
}

/* The ratings come first; limits and stresses are shown in the unit they were written in. */
static void print_verdict_lines(const vs_verdict *v, FILE *out) {
  int width = width_of_names(v);
  size_t k = 0;
  if (v->item[0].rating)
    fprintf(out, "\n  %-*s %11s %11s %11s %11s %-5s %8s\n", width, "rating", "min", "least",
            "largest", "max", "", "margin +- its numerical error");
  for (; k < v->count && v->item[k].rating; k++) print_rating(&v->item[k], width, out);
  if (k < v->count && !vs_verdict_is_happening(&v->item[v->count - 1]))
    fprintf(out, "\n  %-*s %11s %11s %-5s %11s %8s\n", width, "device", "stress", "limit", "", "at",
            "margin +- its numerical error");
  for (; k < v->count; k++)
    if (!vs_verdict_is_happening(&v->item[k])) print_device(&v->item[k], width, out);
}

/* "not judged: r1.power, c1.v_peak (no limit stated)" */
static void print_not_judged(const vs_result *r, FILE *out) {
  vs_text text = {0};
  vs_unjudged_write(r->watchers.devices, &r->verdict, &text);
  if (text.length) fprintf(out, "not judged: %s\n", text.text);
  vs_text_free(&text);
}

/* "varistor_1.i_peak     -6.1 % +- 0.01 %  violated", or why the corner has no such line. */
static void print_corner(const vs_corner *one, FILE *out) {
  if (!*one->line) {
    fprintf(out, "%s%s%s%s", *one->failed ? "failed: " : "nothing is rated", one->failed,
            *one->note ? "; " : "", one->note);
    return;
  }
  fprintf(out, "%s ", one->line);
  char margin[VS_ENGINEERING_SIZE];
  fprintf(out, "%9s", margin_text(one->margin, margin));
  if (isfinite(one->error)) fprintf(out, " +- %.2g %%", 100 * one->error);
  fprintf(out, "  %s%s%s", vs_verdict_words[one->word], *one->note ? "; " : "", one->note);
}

/* "corners: 7 of 8 held, 2 without pull_in, 1 failed; " */
static void print_held(const vs_corners *c, FILE *out) {
  size_t rests = 0;
  for (size_t k = 0; k < c->count; k++) rests += *c->item[k].note != '\0';
  fprintf(out, "corners: %zu of %zu held", c->held, c->count);
  if (rests) fprintf(out, ", %zu without pull_in", rests);
  if (c->failed) fprintf(out, ", %zu failed", c->failed);
  fputs("; ", out);
}

/* What was varied: nothing, or the corners, with the worst line of each. */
void vs_verdict_table_corners(const vs_result *r, FILE *out) {
  char at[1024];
  const vs_corners *c = r->corners;
  if (!c) {
    fputs("nominal values; corners not judged\n", out);
    return;
  }
  print_held(c, out);
  fputs("the worst line of each:\n", out);
  for (size_t k = 0; k < c->count; k++) {
    fprintf(out, "  %s: ", vs_result_corner(c, k, at, sizeof at));
    print_corner(&c->item[k], out);
    fputs(k == c->worst && c->count > 1 ? "  worst\n" : "\n", out);
  }
}

/* How the errors of the margins were found, and what would decide those that are not. */
void vs_verdict_table_second(const vs_result *r, FILE *out) {
  const vs_second_run *second = &r->second;
  if (second->done)
    fprintf(out, "errors of margins: by a second run at run.tolerance = %.3g", second->tolerance);
  else if (r->verdict.count)
    fprintf(out, "errors of margins: not computed (%s)",
            second->stopped   ? "the second run was stopped by a signal"
            : *second->failed ? "the second run failed"
                              : "run.verify");
  if (second->decides > 0)
    fprintf(out, "; run.tolerance = %.1g may decide what is undecided", second->decides);
  if (second->done || r->verdict.count) fputc('\n', out);
}

/* Something is limited, and nothing of that is judged. */
bool vs_verdict_table_judges_nothing(const vs_result *r) {
  return vs_unjudged_is_told(r->watchers.devices, &r->verdict);
}

/* Why there is no verdict, and how to have one. */
void vs_verdict_table_none(const vs_result *r, FILE *out) {
  if (vs_verdict_table_judges_nothing(r)) {
    fputs("verdict: none, as nothing that the deck and its parts limit is judged\n", out);
    return;
  }
  const bool has_circuit = r->scene->tier->has_circuit;
  fprintf(out, "verdict: none, as %s%s\n",
          has_circuit ? "the deck and its parts rate nothing"
                      : "this tier has no circuit whose parts could be rated",
          has_circuit && !r->second.done
              ? "; run.verify: always would tell which extremes hang on the steps"
              : "");
  if (has_circuit)
    fputs("to have one: choose parts that have limits, as circuit.thyristor ('vibrospice list "
          "parts'), or write a line '*$ rating' into the deck\n",
          out);
}

/* ---- the whole verdict ---- */

void vs_verdict_table_whole(const vs_result *r, FILE *out) {
  const vs_verdict *v = &r->verdict;
  if (!v->count) {
    vs_verdict_table_none(r, out);
    if (!vs_verdict_table_judges_nothing(r)) return;
    print_waived(&r->scene->expects, out);
    print_not_judged(r, out);
    return;
  }
  vs_verdict_table_word(r, out);
  for (size_t k = 0; k < v->count; k++)
    if (vs_verdict_is_happening(&v->item[k])) print_happening(&v->item[k], out);
  if (v->weakest && !vs_verdict_is_happening(v->weakest)) print_weakest(v->weakest, out);
  if (v->first_to_fail) print_first_to_fail(v->first_to_fail, out);
  print_undecided(v, true, out);
  print_waived(&r->scene->expects, out);
  print_not_judged(r, out);
  vs_verdict_table_corners(r, out);
  print_verdict_lines(v, out);
  vs_verdict_table_second(r, out);
}

/* ---- the verdict in short ---- */

/* So many happenings, names of what is not judged, and weakest lines are told. */
enum { WEAK = 3, HAPPENINGS = 3, NAMES = 3 };

/* Devices without a line that are named with their tightest margin; further ones are counted. */
enum { OTHERS = 10 };

/* Devices none of whose margins is below this are counted and not shown, besides the weakest. */
static const double AMPLE = 0.9;

/* What was not expected goes before what was. */
static void tell_happenings(const vs_verdict *v, FILE *out) {
  int told = 0, left = 0;
  for (int expected = 0; expected < 2; expected++)
    for (size_t k = 0; k < v->count; k++) {
      const vs_judgement *j = &v->item[k];
      if (!vs_verdict_is_happening(j) || (j->margin > 0) != (bool)expected) continue;
      if (told < HAPPENINGS)
        print_happening(j, out), told++;
      else
        left++;
    }
  if (left) fprintf(out, "happened: %d more of that (--all)\n", left);
}

/* All that leaves the verdict undecided is named; limits that parts do not state on one line. */
static void tell_undecided(const vs_verdict *v, FILE *out) {
  char name[VS_JUDGED_NAME];
  vs_text lacking = {0};
  size_t n = 0;
  for (size_t k = 0; k < v->count; k++)
    if (v->item[k].lacks && !v->item[k].waived)
      vs_text_add(&lacking, "%s%s", n++ ? ", " : "", vs_verdict_name(&v->item[k], name));
  print_undecided(v, n < 2, out);
  if (n > 1)
    fprintf(out, "undecided: %s: their parts state no such limit; waive: [%s] leaves them out\n",
            lacking.text, lacking.text);
  vs_text_free(&lacking);
}

/* "not judged: fuse_2.v_open, varistor_1.power, varistor_1.v_rms and 5 more (--all)" */
void vs_verdict_table_not_judged(const vs_result *r, FILE *out) {
  const vs_devices *devices = r->watchers.devices;
  vs_unjudged entry;
  size_t count = 0;
  while (vs_unjudged_at(devices, &r->verdict, count, &entry)) count++;
  if (count <= NAMES) {
    print_not_judged(r, out);
    return;
  }
  for (size_t k = 0; k < NAMES && vs_unjudged_at(devices, &r->verdict, k, &entry); k++)
    fprintf(out, "%s%s", k ? ", " : "not judged: ", entry.name);
  fprintf(out, " and %zu more (--all)\n", count - NAMES);
}

static int by_weakness(const void *left, const void *right) {
  const vs_judgement *a = *(const vs_judgement *const *)left,
                     *b = *(const vs_judgement *const *)right;
  if (vs_verdict_is_weaker(a, b)) return -1;
  return vs_verdict_is_weaker(b, a) ? 1 : (a < b) - (a > b); /* as of v->weakest */
}

/* True where none of the first n lines is of what the line is of. */
static bool is_first_of_its(const vs_judgement *j, const vs_judgement *const *line, size_t n) {
  for (size_t k = 0; k < n; k++)
    if (j->device && line[k]->device == j->device) return false;
  return true;
}

/* "; fuse_2 69 %, r1 99 %, varistor_1 99 %": of each device that none of the first shown lines is
 * of, its tightest margin, rounded down. */
static void tell_others(const vs_judgement *const *line, size_t shown, size_t count, FILE *out) {
  size_t told = 0, left = 0;
  for (size_t k = shown; k < count; k++) {
    if (!line[k]->device || !is_first_of_its(line[k], line, k)) continue;
    if (told == OTHERS) {
      left++;
      continue;
    }
    double least = line[k]->margin;
    for (size_t m = k + 1; m < count; m++)
      if (line[m]->device == line[k]->device) least = fmin(least, line[m]->margin);
    const double percent = fmin(floor(100 * least + 1e-9), 99);
    fprintf(out, "%s%s %.0f %%", told++ ? ", " : "; ", line[k]->device->name, percent);
  }
  if (left) fprintf(out, " and %zu more", left);
}

/* "11 more above 41 %, 9 of them above 90 %; c1 41 %, varistor_1 99 %". The first shown lines have
 * been printed. */
static void tell_rest(const vs_judgement *const *all, size_t shown, size_t of_all, FILE *out) {
  const vs_judgement *const *line = all + shown;
  const size_t count = of_all - shown;
  double least = INFINITY;
  size_t ample = 0;
  for (size_t k = 0; k < count; k++) {
    least = fmin(least, line[k]->margin);
    ample += line[k]->margin > AMPLE;
  }
  if (!count) return;
  least = ample == count ? AMPLE : least;
  fprintf(out, "  %zu more above %.0f %%", count, floor(100 * least + 1e-9));
  if (ample && ample < count) fprintf(out, ", %zu of them above %.0f %%", ample, 100 * AMPLE);
  tell_others(all, shown, of_all, out);
  fputc('\n', out);
}

static bool is_failing(const vs_judgement *j) {
  return j->margin < 0 || vs_verdict_word(j) == VS_UNDECIDED;
}

/* All that is violated or undecided, each stress once. Of the others the weakest lines whatever
 * they are of, and the tightest of each other device, as far as there is room. */
void vs_verdict_table_tightest(const vs_verdict *v, int room, FILE *out) {
  const vs_judgement **line = vs_alloc(v->count, sizeof *line);
  size_t count = 0, shown = 0;
  for (size_t k = 0; k < v->count; k++)
    if (isfinite(v->item[k].margin) && !v->item[k].waived && !vs_verdict_is_happening(&v->item[k]))
      line[count++] = &v->item[k];
  qsort(line, count, sizeof *line, by_weakness);
  for (size_t k = count; k-- > 0;)
    if (line[k] != v->weakest && vs_verdict_is_doubled(line, count, line[k]))
      memmove(line + k, line + k + 1, (--count - k) * sizeof *line);
  for (size_t k = 0; k < count; k++) room -= is_failing(line[k]);
  const int width = width_of_names(v);
  if (count)
    fprintf(out, "\n  %-*s %11s %11s %-5s %11s %8s\n", width, "tightest", "stress", "limit", "",
            "at", "margin +- its numerical error");
  for (size_t k = 0; k < count; k++) {
    const vs_judgement *j = line[k];
    const bool weak = k < WEAK || (j->margin < AMPLE && is_first_of_its(j, line, k));
    if (!is_failing(j) && !(weak && room-- > 0)) continue;
    print_device(j, width, out);
    memmove(line + shown + 1, line + shown, (k - shown) * sizeof *line);
    line[shown++] = j;
  }
  tell_rest(line, shown, count, out);
  free(line);
}

void vs_verdict_table_head(const vs_result *r, FILE *out) {
  const vs_verdict *v = &r->verdict;
  const vs_corners *c = r->corners;
  char at[1024];
  tell_happenings(v, out);
  if (v->weakest && !vs_verdict_is_happening(v->weakest)) print_weakest(v->weakest, out);
  if (v->first_to_fail) print_first_to_fail(v->first_to_fail, out);
  tell_undecided(v, out);
  print_waived(&r->scene->expects, out);
  if (!c) return;
  print_held(c, out);
  fprintf(out, "the worst is %s: ", vs_result_corner(c, c->worst, at, sizeof at));
  print_corner(&c->item[c->worst], out);
  fputc('\n', out);
}
