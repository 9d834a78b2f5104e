/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tell/groups.h"

#include <math.h>
#include <string.h>

#include "scene/shown.h"
#include "tell/amount.h"

/* Measures of devices stand in cells side by side. */
enum { ROW = 40, NAME_WIDTH = 18, CELL = 30, CELLS = 3 };

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
  int printed;
  int column; /* of a line of cells, counted from the first cell */
} rows;

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
  if (r->options->all) return true;
  return m->value.known && m->value.value != 0 && !m->doubled;
}

/* ---- rows ---- */

static void begin(rows *r) {
  if (!r->begun) fprintf(r->out, "\n%s\n", r->group < 0 ? "asked for" : HEADINGS[r->group]);
  r->begun = true;
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

static void print_group(rows *r) {
  const vs_frame *frame = &r->result->scene->frame;
  vs_shown m, next;
  r->begun = false;
  for (int k = 0; vs_shown_at(frame, r->result, k, &m); k++) {
    if (!is_wanted(r, &m, k)) continue;
    begin(r);
    r->printed++;
    if (!measured_of(r, k) && vs_shown_at(frame, r->result, k + 1, &next) &&
        is_wanted(r, &next, k + 1) && !measured_of(r, k + 1) && are_ends(&m, &next)) {
      print_ends(r, &m, &next);
      r->printed++, k++;
    } else
      print_row(r, &m, k);
  }
}

/* ---- devices ---- */

/* Prints one measure in a cell behind those of the same device. */
static void print_cell(rows *r, const vs_shown *m, const char *device, int *cells) {
  char value[VS_AMOUNT_SIZE];
  const char *dot = strchr(m->name, '.');
  if (*cells % CELLS == 0)
    r->column = fprintf(r->out, "%s  %-*.*s ", *cells ? "\n" : "", NAME_WIDTH,
                        *cells ? 0 : (int)strlen(device), device) -
                (*cells > 0) - (NAME_WIDTH + 3);
  fprintf(r->out, "%*s", *cells % CELLS * CELL - r->column, "");
  r->column = *cells % CELLS * CELL +
              fprintf(r->out, "%s %s", dot + 1, vs_amount_text(m->value.value, m->unit, value));
  if (m->over_v > 0)
    r->column += fprintf(r->out, " over %s", vs_amount_text(m->over_v, "V", value));
  ++*cells;
}

static void print_devices(rows *r) {
  const vs_frame *frame = &r->result->scene->frame;
  char device[VS_JUDGED_NAME] = "";
  vs_shown m;
  int cells = 0;
  r->begun = false;
  for (int k = 0; vs_shown_at(frame, r->result, k, &m); k++) {
    if (!is_wanted(r, &m, k)) continue;
    begin(r);
    size_t n = strcspn(m.name, ".");
    if (strncmp(device, m.name, n) || device[n]) {
      if (*device) fputc('\n', r->out);
      snprintf(device, sizeof device, "%.*s", (int)n, m.name);
      cells = 0;
    }
    print_cell(r, &m, device, &cells);
    r->printed++;
  }
  if (r->begun) fputc('\n', r->out);
  for (int k = 0; vs_shown_at(frame, r->result, k, &m); k++)
    if (is_wanted(r, &m, k) && m.unjudged) fprintf(r->out, "  %s: %s\n", m.name, m.unjudged);
}

void vs_groups_print(const vs_result *result, const vs_groups_options *options, FILE *out) {
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
  for (r.group = -1; r.group < VS_SHOWN_GROUPS; r.group++)
    if (r.group == VS_SHOWN_DEVICES && !options->all)
      print_devices(&r);
    else
      print_group(&r);
  if (measured && !options->measured)
    fputs("\nwhat was measured is not shown: --set has changed what it was measured of\n", out);
  if (count > r.printed)
    fprintf(out, "\n%d measures are left out, which are zero, unknown or doubled: --all\n",
            count - r.printed);
}
