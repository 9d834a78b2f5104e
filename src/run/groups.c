/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/groups.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "run/shown.h"
#include "run/amount.h"

enum { ROW = 40, WORTH_A_HEADING = 5 };

static const char *const HEADINGS[VS_SHOWN_GROUPS] = {[VS_SHOWN_MOTION] = "motion",
                                                      [VS_SHOWN_ELECTRICAL] = "electrical",
                                                      [VS_SHOWN_DEVICES] = "devices",
                                                      [VS_SHOWN_ENERGY] = "energy",
                                                      [VS_SHOWN_QUALITY] = "quality"};

/* One pass over the measures. */
typedef struct rows {
  const vs_result *result;
  const vs_groups_options *options;
  FILE *out;
  int standard; /* the first so many measures may have been measured */
  int group;    /* that is printed; -1: what is asked for */
  bool begun;   /* its heading is printed */
  int printed, lines;
} rows;

/* What a short table tells of every run. */
static const char *const ALWAYS[] = {"stroke", "i_peak", "t_extinction", "energy_in"};

/* ---- which ---- */

static const vs_value *measured_of(const rows *r, int k) {
  const vs_value *measured = &r->result->scene->measured[k < r->standard ? k : 0];
  return r->options->measured && k < r->standard && measured->known ? measured : NULL;
}

static bool begins_with_recorded(const rows *r, const char *name) {
  const vs_scene *s = r->result->scene;
  int listed[VS_CH_MOST];
  if (s->n_record == vs_channel_listed(&s->frame, listed)) return false; /* record: all */
  for (int k = 0; k < s->n_record; k++) {
    vs_channel channel = vs_channel_at(&s->frame, s->record[k]);
    size_t n = strlen(channel.name);
    if (!strncmp(name, channel.name, n) && name[n] == '_') return true;
  }
  return false;
}

static bool is_asked(const rows *r, const vs_shown *m, int k) {
  return measured_of(r, k) || begins_with_recorded(r, m->name);
}

static bool is_wanted(const rows *r, const vs_shown *m, int k) {
  if (is_asked(r, m, k)) return r->group < 0;
  if ((int)m->group != r->group) return false;
  if (r->options->most == INT_MAX) return true;
  for (size_t n = 0; n < sizeof ALWAYS / sizeof *ALWAYS; n++)
    if (!strcmp(m->name, ALWAYS[n])) return false;
  return m->value.known && m->value.value != 0 && !m->doubled;
}

/* ---- rows ---- */

static void begin(rows *r) {
  if (r->begun) return;
  fprintf(r->out, "\n%s\n", r->group < 0 ? "asked for" : HEADINGS[r->group]);
  r->begun = true;
  r->lines += 2;
}

/* The name to the left and the value to the right of a row. */
static void print_pair(const char *name, int length, const char *value, FILE *out) {
  int room = ROW - length;
  fprintf(out, "  %.*s %*s", length, name, room > 0 ? room : 0, value);
}

/* "   at 5.556 ms" */
static void print_at(double at_s, const char *before, FILE *out) {
  char at[VS_AMOUNT_SIZE];
  if (!isnan(at_s)) fprintf(out, "%s%s", before, vs_amount_text(at_s, "s", at));
}

static void print_row(rows *r, const vs_shown *m, int k) {
  char value[VS_AMOUNT_SIZE];
  const vs_value *measured = measured_of(r, k);
  if (!m->value.known) {
    print_pair(m->name, (int)strlen(m->name), "-\n", r->out);
    return;
  }
  print_pair(m->name, (int)strlen(m->name), vs_amount_text(m->value.value, m->unit, value), r->out);
  print_at(m->value.at_s, "   at ", r->out);
  if (measured) {
    fprintf(r->out, "   measured %s", vs_amount_text(measured->value, m->unit, value));
    if (measured->value != 0)
      fprintf(r->out, ": computed is %+.1f %%", 100 * (m->value.value / measured->value - 1));
  }
  if (m->over_v > 0) fprintf(r->out, "   over %s", vs_amount_text(m->over_v, "V", value));
  if (m->unjudged) fprintf(r->out, "   %s", m->unjudged);
  fputc('\n', r->out);
}

/* True where `largest` is the largest value of what `least` is the least of: "u_min", "u_max". */
static bool are_ends(const vs_shown *least, const vs_shown *largest) {
  size_t n = strlen(least->name);
  return n > 4 && n == strlen(largest->name) && !strcmp(least->name + n - 4, "_min") &&
         !strcmp(largest->name + n - 4, "_max") && !strncmp(least->name, largest->name, n - 4);
}

static void print_ends(rows *r, const vs_shown *least, const vs_shown *largest) {
  char range[2 * VS_AMOUNT_SIZE];
  print_pair(least->name, (int)strlen(least->name) - 4,
             vs_amount_range(least->value.value, largest->value.value, least->unit, range), r->out);
  print_at(least->value.at_s, "   at ", r->out);
  print_at(largest->value.at_s, ", ", r->out);
  fputc('\n', r->out);
}

/* Prints the k-th measure, and with it the next one where the two are the ends of a range. Returns
 * how many these were. */
static int print_next(rows *r, const vs_shown *m, int k) {
  const vs_frame *frame = &r->result->scene->frame;
  vs_shown next;
  const bool two = !measured_of(r, k) && vs_shown_at(frame, r->result, k + 1, &next) &&
                   !measured_of(r, k + 1) && is_asked(r, m, k) == is_asked(r, &next, k + 1) &&
                   are_ends(m, &next) &&
                   (r->options->most == INT_MAX || (next.value.known && next.value.value != 0));
  if (two)
    print_ends(r, m, &next);
  else
    print_row(r, m, k);
  r->lines++;
  r->printed += two ? 2 : 1;
  return two ? 2 : 1;
}

static void print_group(rows *r) {
  vs_shown m;
  r->begun = false;
  for (int k = 0; vs_shown_at(&r->result->scene->frame, r->result, k, &m);) {
    const bool prints = is_wanted(r, &m, k) && r->lines < r->options->most;
    if (prints) begin(r);
    k += prints ? print_next(r, &m, k) : 1;
  }
}

/* Prints the measure of that name where it says something and does not stand there already. */
static void print_named(rows *r, const char *name) {
  vs_shown m;
  for (int k = 0; vs_shown_at(&r->result->scene->frame, r->result, k, &m); k++)
    if (!strcmp(m.name, name) && m.value.known && m.value.value != 0 && !is_asked(r, &m, k))
      print_next(r, &m, k);
}

/* Prints what the deck's probes have of its first few currents. */
static void print_currents(rows *r) {
  enum { CURRENTS = 2 };
  vs_shown m;
  int printed = 0;
  for (int k = 0; vs_shown_at(&r->result->scene->frame, r->result, k, &m) && printed < CURRENTS;) {
    const bool prints = m.channel >= 0 && !strcmp(m.unit, "A") && m.value.known &&
                        r->lines < r->options->most && !is_asked(r, &m, k);
    printed += prints;
    k += prints ? print_next(r, &m, k) : 1;
  }
}

/* Prints what is asked for, what every short table tells, and the motion where there is room. */
static void print_few(rows *r) {
  r->group = -1;
  print_group(r);
  if (!r->begun) fputc('\n', r->out);
  for (size_t k = 0; k < sizeof ALWAYS / sizeof *ALWAYS && r->lines < r->options->most; k++)
    print_named(r, ALWAYS[k]);
  print_currents(r);
  r->group = VS_SHOWN_MOTION;
  if (r->options->most - r->lines >= WORTH_A_HEADING) print_group(r);
}

int vs_groups_print(const vs_result *result, const vs_groups_options *options, FILE *out) {
  const vs_scene *s = result->scene;
  rows r = {.result = result,
            .options = options,
            .out = out,
            .standard = vs_measures_count(&s->setup.model)};
  vs_shown m;
  int count = 0;
  bool measured = false;
  while (vs_shown_at(&s->frame, result, count, &m)) count++;
  for (int k = 0; k < r.standard; k++) measured = measured || s->measured[k].known;
  if (options->most < INT_MAX)
    print_few(&r);
  else
    for (r.group = -1; r.group < VS_SHOWN_GROUPS; r.group++) print_group(&r);
  if (measured && !options->measured)
    fputs("what was measured is not shown: --set has changed what it was measured of\n", out);
  return count - r.printed;
}
