/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "heat.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "netlist/parts.h"

/* A device, and the file of its part; "": it has none. */
typedef struct subject {
  const vs_watched *watched;
  const char *file;
  double span_s;
} subject;

static double power_w(const subject *s) {
  return s->watched->sum[VS_OF_POWER] / s->span_s;
}

/* Of a kind that turns power into heat. Where the kind has the mean power as a measure of its own,
 * it is shown already. */
static bool lacks_power(const subject *s) {
  const vs_kind *kind = s->watched->device->kind;
  bool heats = false;
  for (size_t k = 0; k < kind->n_measures; k++) {
    if (!strcmp(kind->measures[k].name, "power")) return false;
    heats = heats || kind->measures[k].of == VS_OF_POWER;
  }
  return heats;
}

/* The part's whole thermal resistance between junction and case; 0: its file says none. */
static double resistance_k_per_w(const subject *s) {
  const vs_deck *deck = s->watched->deck;
  double sum = 0;
  for (size_t k = 0; k < deck->n_zth; k++)
    if (!strcmp(deck->zth[k].where.file, s->file)) sum += deck->zth[k].k_per_w;
  return sum;
}

static const vs_reduced *largest_rise(const subject *s) {
  return vs_reducer_of(s->watched, VS_R_JUNCTION);
}

/* Its part has a network, and its kind a junction. */
static bool has_part_network(const subject *s) {
  return resistance_k_per_w(s) > 0 && largest_rise(s);
}

/* All of the network's time constants forget, so the mean rise is that of the mean power. */
static double mean_rise_k(const subject *s) {
  return resistance_k_per_w(s) * power_w(s);
}

static const vs_limit *junction_limit(const subject *s) {
  return *s->file ? vs_parts_find_limit(s->watched->deck, s->file, "t_j_max") : NULL;
}

static bool limits_case(const subject *s) {
  const vs_limit *limit = junction_limit(s);
  return has_part_network(s) && limit && isfinite(limit->value) &&
         vs_units_same_kind(limit->unit, "degC");
}

static double case_degc(const subject *s) {
  return junction_limit(s)->value - largest_rise(s)->value.value;
}

static const struct {
  const char *name, *unit, *text;
  bool (*has)(const subject *s);
  double (*value)(const subject *s);
} ROWS[] = {{"power", "W", "mean power", lacks_power, power_w},
            {"t_j_rise_mean", "K",
             "mean rise of the junction's temperature over the case, by the part's zth",
             has_part_network, mean_rise_k},
            {"t_case_max", "degC",
             "highest temperature of the case, as the junction stays below the part's t_j_max",
             limits_case, case_degc}};
enum { N_ROWS = sizeof ROWS / sizeof *ROWS };

bool vs_heat_at(const vs_devices *devices, double span_s, int k, vs_heat *heat) {
  for (size_t d = 0; devices && d < devices->count; d++) {
    const vs_watched *w = &devices->item[d];
    const char *file = w->device->part < 0 ? NULL : w->deck->parts[w->device->part].file;
    const subject s = {w, file ? file : "", span_s};
    for (int row = 0; row < N_ROWS; row++) {
      if (!ROWS[row].has(&s) || k-- > 0) continue;
      double value = ROWS[row].value(&s);
      snprintf(heat->name, sizeof heat->name, "%s.%s", w->device->name, ROWS[row].name);
      heat->unit = ROWS[row].unit;
      heat->text = ROWS[row].text;
      heat->value = (vs_value){isfinite(value), value, NAN};
      return true;
    }
  }
  return false;
}
