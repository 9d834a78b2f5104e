/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/moments.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/path.h"
#include "base/text.h"

enum {
  FEW = 8,        /* so many moments are shown all at once */
  OFTEN = 4,      /* what happens this many times as often as the rarest makes that one rare */
  LAST_CYCLES = 3 /* shown of a run in which nothing stands out */
};

static vs_status take(vs_moments *m, const vs_csv *csv, vs_error *err) {
  char *end = csv->cell[0];
  double at = strtod(csv->cell[0], &end);
  vs_where where = {csv->file, csv->line, 1};
  if (csv->count != 2 || *end || end == csv->cell[0] || !isfinite(at))
    return vs_fail_at(err, where, "a time in s and what happened are wanted");
  m->item = vs_alloc_grow(m->item, m->count, sizeof *m->item);
  m->item[m->count++] =
      (vs_moment){at, vs_copy(csv->cell[1]), strstr(csv->cell[1], " begins (") != NULL};
  return VS_OK;
}

vs_status vs_moments_read(const char *folder, vs_moments *m, vs_error *err) {
  char path[VS_PATH_SIZE];
  if (strlen(folder) > VS_PATH_SIZE / 2)
    return vs_fail(err, VS_INPUT, "%.100s...: too long a name", folder);
  snprintf(path, sizeof path, "%s/events.csv", folder);
  vs_status status = vs_path_check_result(path, err);
  if (status) return status;
  FILE *f = fopen(path, "r");
  if (!f) return VS_OK;
  vs_csv csv = {.file = path, .stream = f, .comments = true};
  status = vs_csv_next(&csv, err); /* the header */
  while (!status && csv.count) {
    status = vs_csv_next(&csv, err);
    if (!status && csv.count) status = take(m, &csv, err);
  }
  vs_csv_free(&csv);
  fclose(f);
  return status;
}

void vs_moments_free(vs_moments *m) {
  for (size_t k = 0; k < m->count; k++) free(m->item[k].what);
  free(m->item);
  *m = (vs_moments){0};
}

bool vs_moments_eventful(const vs_moments *m) {
  for (size_t k = 0; k < m->count; k++)
    if (m->item[k].is_event) return true;
  return false;
}

/* How often that happens. */
static size_t times(const vs_moments *m, const char *what) {
  size_t n = 0;
  for (size_t k = 0; k < m->count; k++) n += !strcmp(m->item[k].what, what);
  return n;
}

/* True if the moment's kind happens once, and another OFTEN times. */
static bool is_rare(const vs_moments *m, size_t k) {
  if (times(m, m->item[k].what) > 1) return false;
  for (size_t other = 0; other < m->count && other < 64; other++)
    if (times(m, m->item[other].what) >= OFTEN) return true;
  return false;
}

static bool is_any(const vs_moments *m, size_t k) {
  (void)k;
  return m->count <= FEW;
}

static bool is_event(const vs_moments *m, size_t k) {
  return m->item[k].is_event;
}

const char *vs_moments_window(const vs_moments *m, double cycle_s, double until_s, double *from_s,
                              double *to_s) {
  static const struct {
    bool (*chosen)(const vs_moments *m, size_t k);
    const char *why;
  } RULES[] = {{is_event, "around the scene's events"},
               {is_rare, "around what happens once"},
               {is_any, "around what happens"}};
  for (size_t r = 0; r < sizeof RULES / sizeof *RULES; r++) {
    double first = INFINITY, last = -INFINITY;
    for (size_t k = 0; k < m->count; k++)
      if (RULES[r].chosen(m, k)) {
        first = fmin(first, m->item[k].at_s);
        last = fmax(last, m->item[k].at_s);
      }
    if (first > last) continue;
    *from_s = fmax(0, first - cycle_s);
    *to_s = fmin(until_s, last + 2 * cycle_s);
    return RULES[r].why;
  }
  *from_s = fmax(0, until_s - LAST_CYCLES * cycle_s);
  *to_s = until_s;
  return "the last cycles, as nothing stands out";
}
