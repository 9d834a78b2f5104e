/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/probes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/units.h"

/* Units that columns of run.csv end in. */
static const char *const UNITS[] = {"m",   "rad", "m/s", "rad/s", "m/s2", "rad/s2", "Wb",
                                    "A",   "N",   "V",   "W",     "Hz",   "K",      "J",
                                    "ohm", "s",   "C",   "N.m",   "degC"};

/* Where the unit of a column begins, behind its '_'; its end: it has none. */
static const char *unit_of(const char *column, const char **unit) {
  for (const char *s = column; (s = strchr(s, '_')); s++)
    for (size_t k = 0; k < sizeof UNITS / sizeof *UNITS; k++) {
      char suffix[32];
      vs_units_suffix(UNITS[k], suffix, sizeof suffix);
      if (s == column || strcmp(s + 1, suffix) != 0) continue;
      *unit = UNITS[k];
      return s + 1;
    }
  *unit = "";
  return column + strlen(column);
}

/* Lengths and angles are shown in thousandths. */
static void fill(vs_probe_shown *p, const char *column) {
  const char *unit, *at = unit_of(column, &unit);
  int length = (int)(at - column) - (*at != '\0');
  bool small = !strcmp(unit, "m") || !strcmp(unit, "rad");
  snprintf(p->column, sizeof p->column, "%s", column);
  if (*unit)
    snprintf(p->label, sizeof p->label, "%.*s / %s%s", length, column, small ? "m" : "", unit);
  else
    snprintf(p->label, sizeof p->label, "%s", column);
  p->scale = small ? 1e3 : 1;
}

static bool is_named(const char *column, const char *word) {
  const char *unit, *at = unit_of(column, &unit);
  size_t length = (size_t)(at - column) - (*at != '\0');
  return !strcmp(column, word) || (strlen(word) == length && !strncmp(column, word, length));
}

static vs_status find_one(const char *word, const vs_traces *t, vs_probes_shown *p, vs_error *err) {
  for (size_t c = 1; c < t->columns; c++)
    if (is_named(t->name[c], word) && strlen(t->name[c]) < VS_PROBE_SIZE) {
      if (p->count == VS_PROBES_MOST)
        return vs_fail(err, VS_INPUT, "--probe: at most %d probes fit a picture", VS_PROBES_MOST);
      fill(&p->item[p->count++], t->name[c]);
      return VS_OK;
    }
  const char *nearest = vs_text_nearest(word, (const char *const *)t->name + 1, t->columns - 1);
  return vs_fail(err, VS_INPUT, "--probe: %s has no column '%.100s'%s%s%s", t->path, word,
                 nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
}

/* The first column, which is a coordinate where these are recorded, and what every tier has. */
static void take_usual(const vs_traces *t, vs_probes_shown *p) {
  static const char *const USUAL[] = {"force_n", "i_a", "v_eva_v", "v_mains_v"};
  if (t->columns > 1 && strlen(t->name[1]) < VS_PROBE_SIZE) fill(&p->item[p->count++], t->name[1]);
  for (size_t k = 0; k < sizeof USUAL / sizeof *USUAL; k++)
    if (vs_traces_find(t, USUAL[k]) > 1) fill(&p->item[p->count++], USUAL[k]);
}

vs_status vs_probes_find(const char *words, const vs_traces *t, vs_probes_shown *p, vs_error *err) {
  vs_status status = VS_OK;
  if (!words) {
    take_usual(t, p);
    return p->count ? VS_OK : vs_fail_at(err, (vs_where){t->path, 1, 1}, "records nothing to draw");
  }
  char *copy = vs_copy(words), *rest = copy;
  for (char *word; !status && (word = strsep(&rest, ","));)
    status = find_one(word + strspn(word, " "), t, p, err);
  free(copy);
  return status;
}

bool vs_probes_rate(const vs_probe_shown *probe, const vs_traces *t, vs_probe_shown *rate) {
  char column[VS_PROBE_SIZE + 4];
  const char *unit;
  unit_of(probe->column, &unit);
  snprintf(column, sizeof column, "v%s%s", probe->column, *unit ? "_s" : "");
  if (vs_traces_find(t, column) < 1 || strlen(column) >= VS_PROBE_SIZE) return false;
  fill(rate, column);
  return true;
}

void vs_probes_named(const vs_probe_shown *probe, const char *word, char *name, size_t size) {
  const char *unit, *at = unit_of(probe->column, &unit);
  int length = (int)(at - probe->column) - (*at != '\0');
  snprintf(name, size, "%.*s_%s%s%s", length, probe->column, word, *at ? "_" : "", at);
}
