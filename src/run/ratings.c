/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/ratings.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "engine/tiers.h"

static const char KEY[] = "ratings";
const char vs_ratings_none[] = "none";

/* ---- what can be rated ---- */

/* One measure or probe of a scene. */
typedef struct subject {
  char name[VS_JUDGED_NAME];
  const char *unit, *text; /* borrowed, text until the next subject is looked at */
  vs_rated_kind kind;
  int which, part;
  double factor;
} subject;

/* Where subjects come from. */
typedef struct source {
  const vs_setup *setup;
  const vs_quality_list *quality;
  vs_frame full; /* with all probes that the scene has on any tier */
  int channels[VS_CH_MOST], n_channels;
  vs_measure measure; /* the last one looked at, whose text a subject borrows */
} source;

static bool measure_at(source *s, int k, subject *of) {
  if (!vs_measure_at(&s->setup->model, k, &s->measure)) return false;
  *of = (subject){.unit = s->measure.unit,
                  .text = s->measure.text,
                  .kind = VS_RATED_MEASURE,
                  .which = s->measure.slot,
                  .factor = s->measure.factor};
  snprintf(of->name, sizeof of->name, "%s", s->measure.name);
  return true;
}

static bool extreme_at(source *s, int k, subject *of) {
  const vs_deck *deck = &s->setup->deck;
  if (k >= 2 * (int)deck->n_probes) return false;
  const vs_probe *probe = &deck->probes[k / 2];
  *of = (subject){.unit = probe->unit,
                  .text = probe->text,
                  .kind = VS_RATED_EXTREME,
                  .which = k / 2,
                  .part = k % 2,
                  .factor = 1};
  snprintf(of->name, sizeof of->name, "%s_%s", probe->name, k % 2 ? "max" : "min");
  return true;
}

static bool device_at(source *s, int k, subject *of) {
  const vs_deck *deck = &s->setup->deck;
  for (size_t d = 0; d < deck->n_devices; d++) {
    const vs_kind *kind = deck->devices[d].kind;
    const int count = kind ? (int)kind->n_measures : 0;
    if (k >= count) {
      k -= count;
      continue;
    }
    const vs_device_measure *m = &kind->measures[k];
    *of = (subject){.unit = m->unit,
                    .text = m->text,
                    .kind = VS_RATED_DEVICE,
                    .which = (int)d,
                    .part = k,
                    .factor = 1};
    snprintf(of->name, sizeof of->name, "%s.%s", deck->devices[d].name, m->name);
    return true;
  }
  return false;
}

static bool find_quality_at(source *s, int k, subject *of) {
  vs_quality_measure m;
  for (int q = 0; q < s->quality->count; q++) {
    vs_quality blank = {.name = ""};
    snprintf(blank.name, sizeof blank.name, "%s", s->quality->item[q].name);
    int n = 0;
    for (; vs_quality_at(&blank, n, true, &m); n++)
      if (n == k) {
        *of = (subject){.unit = m.unit,
                        .text = m.text,
                        .kind = VS_RATED_QUALITY,
                        .which = q,
                        .part = n,
                        .factor = vs_units_factor(m.unit)};
        snprintf(of->name, sizeof of->name, "%s", m.name);
        return true;
      }
    k -= n;
  }
  return false;
}

static bool probe_at(source *s, int k, subject *of) {
  if (k >= s->n_channels) return false;
  const vs_channel c = vs_channel_at(&s->full, s->channels[k]);
  *of = (subject){.unit = c.unit, .text = c.text, .kind = VS_RATED_PROBE, .factor = 1};
  snprintf(of->name, sizeof of->name, "%s", c.name);
  return true;
}

/* The k-th of those of one kind, from 0. False: there are no more. */
static bool (*const OF_KIND[])(source *s, int k, subject *of) = {measure_at, extreme_at, device_at,
                                                                 find_quality_at, probe_at};
enum { KINDS = sizeof OF_KIND / sizeof *OF_KIND };

static bool find_rated(source *s, const char *name, subject *of) {
  for (int kind = 0; kind < KINDS; kind++)
    for (int k = 0; OF_KIND[kind](s, k, of); k++)
      if (!strcmp(of->name, name)) return true;
  return false;
}

/* ---- the key ---- */

/* True for a measure of the quality of a current that the scene does not ask for. */
static bool lacks_quality(const source *s, const char *name, char *current, size_t size) {
  const char *dot = strchr(name, '.');
  vs_quality_measure m;
  vs_quality blank = {.name = ""};
  if (!dot || dot - name >= (int)sizeof blank.name) return false;
  snprintf(blank.name, sizeof blank.name, "%.*s", (int)(dot - name), name);
  snprintf(current, size, "%s", blank.name);
  if (strcmp(current, vs_quality_mains) != 0 && vs_channel_find(&s->full, current) < 0)
    return false;
  for (int k = 0; vs_quality_at(&blank, k, true, &m); k++)
    if (!strcmp(m.name, name)) return true;
  return false;
}

static vs_status refuse_rated_name(source *s, const char *name, vs_where where, vs_error *err) {
  enum { MOST = 2048 };
  char current[VS_JUDGED_NAME];
  size_t n = 0;
  /* a check carries on: it may be of that line */
  if (s->setup->deck.lost || s->setup->machine->lost) return VS_OK;
  if (lacks_quality(s, name, current, sizeof current))
    return vs_fail_at(err, where,
                      "ratings.%s: the scene does not ask for the quality of %s; write quality: "
                      "[%s]",
                      name, current, current);
  subject *all = vs_alloc(MOST, sizeof *all);
  const char **names = vs_alloc(MOST, sizeof *names);
  for (int kind = 0; kind < KINDS; kind++)
    for (int k = 0; n < MOST && OF_KIND[kind](s, k, &all[n]); k++) {
      names[n] = all[n].name;
      n++;
    }
  vs_fail_at(
      err, where, "ratings: no measure or probe '%s'%s", name,
      vs_text_hint(name, names, n, "; see 'vibrospice list measures' and 'vibrospice list probes'")
          .text);
  free(all);
  free(names);
  return VS_INPUT;
}

static char *trim(char *text) {
  while (isspace((unsigned char)*text)) text++;
  for (size_t n = strlen(text); n && isspace((unsigned char)text[n - 1]); n--) text[n - 1] = '\0';
  return text;
}

/* What stands behind the number of an end: its unit. */
static const char *unit_of_end(const char *end) {
  char *rest;
  strtod(end, &rest);
  while (isspace((unsigned char)*rest)) rest++;
  return rest;
}

/* Reads an end. unit: of its measure; other: the unit of the other end, for one without. */
static vs_status read_end_of_rating(const char *written, const char *unit, const char *other,
                                    const vs_own_rating *r, double *si, vs_where where,
                                    vs_error *err) {
  char text[256], why[256];
  if (!*written) return VS_OK; /* this end is open */
  const bool borrows = !*unit_of_end(written) && *other;
  snprintf(text, sizeof text, "%s%s%s", written, borrows ? " " : "", borrows ? other : "");
  if (vs_units_read(text, unit, si, why, sizeof why)) return VS_OK;
  return vs_fail_at(err, where, "ratings.%s: %s", r->name, why);
}

/* Reads "A .. B UNIT", ".. B UNIT" or "A UNIT ..". */
static vs_status read_range_of_rating(const vs_node *node, const char *unit, vs_own_rating *r,
                                      vs_error *err) {
  char text[256];
  vs_rating *of = &r->rating;
  bool long_one = snprintf(text, sizeof text, "%s", node->text) >= (int)sizeof text;
  char *dots = long_one ? NULL : strstr(text, "..");
  if (dots) *dots = '\0';
  const char *lower = dots ? trim(text) : "", *upper = dots ? trim(dots + 2) : "";
  if (!*lower && !*upper)
    return vs_fail_at(
        err, node->where, "ratings.%s: a range is wanted: 'A .. B%s%s', '.. B%s%s' or 'A%s%s ..'",
        r->name, *unit ? " " : "", unit, *unit ? " " : "", unit, *unit ? " " : "", unit);
  of->min = -INFINITY, of->max = INFINITY;
  const char *units[] = {unit_of_end(lower), unit_of_end(upper)};
  vs_status status = read_end_of_rating(lower, unit, units[1], r, &of->min, node->where, err);
  if (!status) status = read_end_of_rating(upper, unit, units[0], r, &of->max, node->where, err);
  if (status) return status;
  const char *shown = *units[1] ? units[1] : units[0];
  bool known = *shown && strlen(shown) < sizeof of->unit && vs_units_known(shown);
  snprintf(of->unit, sizeof of->unit, "%s", known ? shown : unit);
  if (of->min <= of->max) return VS_OK;
  double factor = vs_units_factor(of->unit);
  return vs_fail_at(err, node->where,
                    "ratings.%s: from %.9g to %.9g %s there is nothing; write the lesser end first",
                    r->name, of->min / factor, of->max / factor, of->unit);
}

static vs_status take_rating(source *s, const vs_node *node, const char *name, vs_ratings *ratings,
                             vs_error *err) {
  subject of = {.name = ""};
  vs_own_rating r = {.rating = {.probe = -1, .where = node->where}};
  if (node->kind != VS_NODE_TEXT)
    return vs_fail_at(err, node->where, "ratings.%s: a range is wanted, as '0 .. 5 mm'", name);
  if (strlen(name) >= sizeof r.name || !find_rated(s, name, &of))
    return refuse_rated_name(s, name, node->key_where, err);
  snprintf(r.name, sizeof r.name, "%s", name);
  snprintf(r.rating.text, sizeof r.rating.text, "%.*s", VS_DECK_TEXT - 1, of.text);
  r.kind = of.kind, r.which = of.which, r.part = of.part, r.factor = of.factor;
  for (int k = 0; k < ratings->count; k++)
    if (!strcmp(ratings->item[k].name, name))
      return vs_fail_at(err, node->key_where,
                        "ratings: %s stands here a second time; leave one out", name);
  if (!strcmp(node->text, vs_ratings_none)) return VS_OK;
  vs_status status = read_range_of_rating(node, of.unit, &r, err);
  if (status) return status;
  if (ratings->count == VS_RATINGS_MOST)
    return vs_fail_at(err, node->where, "ratings: more than %d", VS_RATINGS_MOST);
  ratings->item[ratings->count++] = r;
  return VS_OK;
}

vs_status vs_ratings_read(const vs_node *node, const vs_setup *setup,
                          const vs_quality_list *quality, vs_ratings *ratings, vs_error *err) {
  vs_status status = VS_OK;
  ratings->count = 0;
  if (!node ||
      (node->kind == VS_NODE_TEXT && (!*node->text || !strcmp(node->text, vs_ratings_none))))
    return VS_OK;
  if (node->kind != VS_NODE_MAP)
    return vs_error_keep(
        err, vs_fail_at(err, node->where,
                        "%s: a map is wanted: {stroke: 0.5 mm .. 1.5 mm, r1.power: .. 2 W}", KEY));
  source *s = vs_alloc(1, sizeof *s);
  s->setup = setup;
  s->quality = quality;
  s->full = vs_sim_frame(vs_tiers_automatic(true), setup);
  s->n_channels = vs_channel_listed(&s->full, s->channels);
  for (const vs_node *n = node->child; n && !status; n = n->next) {
    if (n->kind != VS_NODE_MAP)
      status = vs_error_keep(err, take_rating(s, n, n->key, ratings, err));
    /* {r1: {power: .. 2 W}}, as --set ratings.r1.power makes it */
    for (const vs_node *m = n->kind == VS_NODE_MAP ? n->child : NULL; m && !status; m = m->next) {
      char name[VS_NAME_SIZE];
      snprintf(name, sizeof name, "%.120s.%.120s", n->key, m->key);
      status = vs_error_keep(err, take_rating(s, m, name, ratings, err));
    }
  }
  free(s);
  return status;
}

/* ---- a run ---- */

bool vs_ratings_want_quality(const vs_ratings *ratings) {
  for (int k = 0; k < ratings->count; k++)
    if (ratings->item[k].kind == VS_RATED_QUALITY) return true;
  return false;
}

void vs_ratings_follow(const vs_ratings *ratings, vs_measures *m) {
  for (int k = 0; k < ratings->count; k++) {
    const vs_own_rating *r = &ratings->item[k];
    int channel = r->kind == VS_RATED_PROBE ? vs_channel_find(m->frame, r->name) : -1;
    if (channel >= 0) vs_measures_follow(m, channel, r->rating.min, r->rating.max);
  }
}

static const char NO_CIRCUIT[] = "this tier has no circuit",
                  NO_CHANNEL[] = "this tier does not compute it",
                  NO_VALUE[] = "it did not occur, or the run ends too early",
                  NOT_TOLD[] = "the quality of currents was not told";

/* A rating of one number. */
static void rate_value(vs_rated *rated, vs_value v, double factor, double until_s) {
  if (!v.known || !isfinite(v.value)) {
    rated->unknown = NO_VALUE;
    return;
  }
  v.value *= factor;
  rated->least = rated->largest = v;
  rated->passed_s = isnan(v.at_s) ? until_s : v.at_s;
}

static void rate_device(vs_rated *rated, const vs_own_rating *r, const vs_ratings_seen *seen) {
  const vs_devices *devices = seen->watchers->devices;
  if (!devices || (size_t)r->which >= devices->count) {
    rated->unknown = NO_CIRCUIT;
    return;
  }
  const vs_watched *w = &devices->item[r->which];
  const vs_reduced *of = &w->reduced[r->part];
  rate_value(rated, of->value, r->factor, seen->until_s);
  rated->is_rate = of->by->is_rate;
  rated->doubt = w->device->doubtful ? INFINITY : of->doubt;
  rated->spread = of->spread;
  if (of->by->hangs_on_sequence) rated->hangs = w->device;
}

static void rate_quality(vs_rated *rated, const vs_own_rating *r, const vs_ratings_seen *seen) {
  vs_quality_measure m;
  if (r->which < seen->n_quality && vs_quality_at(&seen->quality[r->which], r->part, true, &m))
    rate_value(rated, m.value, r->factor, seen->until_s);
  else
    rated->unknown = NOT_TOLD;
}

static void rate_probe(vs_rated *rated, const vs_own_rating *r, const vs_measures *m) {
  int channel = vs_channel_find(m->frame, r->name);
  const vs_followed *f = channel < 0 ? NULL : vs_measures_followed(m, channel);
  if (!f)
    rated->unknown = m->frame->deck ? NO_CHANNEL : NO_CIRCUIT;
  else if (!f->end[0].best.known)
    rated->unknown = NO_VALUE;
  if (rated->unknown) return;
  rated->least = f->end[0].best;
  rated->largest = f->end[1].best;
  rated->passed_s = f->passed_s;
}

/* What came not at all has lasted for longer than the limit all the same, or what came did not
 * last. */
static void rate_pull_in(vs_rated *rated, const vs_own_rating *r, const vs_ratings_seen *seen) {
  const vs_pull_in *p = &seen->watchers->measures->pull_in;
  const double least_s = r->which == VS_M_PULL_IN   ? vs_pull_in_waits_s(p)
                         : r->which == VS_M_RELEASE ? vs_pull_in_sticks_s(p)
                                                    : NAN;
  if (!vs_measure_pulls_in(r->which)) return;
  if (rated->unknown && least_s > r->rating.max) {
    rated->unknown = NULL;
    rate_value(rated, (vs_value){true, least_s, seen->until_s}, 1, seen->until_s);
    rated->passed_s = seen->until_s - (least_s - r->rating.max);
  } else if (rated->unknown && *seen->no_pull_in) {
    rated->unknown = seen->no_pull_in;
  } else if (*seen->lets_go && (rated->unknown || r->which == VS_M_PULL_IN)) {
    rated->unknown = seen->lets_go;
  }
}

static void rate(vs_rated *rated, const vs_own_rating *r, const vs_ratings_seen *seen) {
  const vs_measures *m = seen->watchers->measures;
  *rated = (vs_rated){.name = r->name,
                      .rating = &r->rating,
                      .least = {.value = NAN, .at_s = NAN},
                      .largest = {.value = NAN, .at_s = NAN},
                      .passed_s = NAN};
  switch (r->kind) {
  case VS_RATED_MEASURE:
    rate_value(rated, seen->values[r->which], r->factor, seen->until_s);
    rate_pull_in(rated, r, seen);
    if (r->which == VS_M_COIL_T) rated->doubt = vs_watchers_heat_doubt(seen->watchers);
    break;
  case VS_RATED_EXTREME:
    if (m->frame->deck)
      rate_value(rated, vs_measures_of_probe(m, r->which)[r->part].best, r->factor, seen->until_s);
    else
      rated->unknown = NO_CIRCUIT;
    break;
  case VS_RATED_DEVICE:
    rate_device(rated, r, seen);
    break;
  case VS_RATED_QUALITY:
    rate_quality(rated, r, seen);
    break;
  case VS_RATED_PROBE:
    rate_probe(rated, r, m);
    break;
  }
}

void vs_ratings_judge(const vs_ratings *ratings, const vs_ratings_seen *seen, vs_verdict *verdict) {
  vs_rated rated[VS_RATINGS_MOST];
  for (int k = 0; k < ratings->count; k++) rate(&rated[k], &ratings->item[k], seen);
  vs_verdict_rate(verdict, rated, (size_t)ratings->count,
                  seen->watchers->measures->frame->tolerance);
}

/* ---- told ---- */

enum { DIGITS = 12 };

void vs_ratings_json(const vs_ratings *ratings, vs_json *json) {
  if (!ratings->count) return;
  vs_json_object(json, KEY, VS_JSON_LINES);
  for (int k = 0; k < ratings->count; k++) {
    const vs_rating *r = &ratings->item[k].rating;
    double unit = vs_units_factor(r->unit);
    vs_json_object(json, ratings->item[k].name, VS_JSON_ROW);
    vs_json_number(json, "min", r->min / unit, DIGITS);
    vs_json_number(json, "max", r->max / unit, DIGITS);
    vs_json_text(json, "unit", r->unit);
    vs_json_end(json);
  }
  vs_json_end(json);
}

void vs_ratings_identify(const vs_ratings *ratings, vs_text *text) {
  for (int k = 0; k < ratings->count; k++)
    vs_text_add(text, "rating %s %.12g %.12g\n", ratings->item[k].name, ratings->item[k].rating.min,
                ratings->item[k].rating.max);
}
