/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plausibility.h"

#include <math.h>
#include <string.h>

#include "base/units.h"
#include "netlist/parts.h"

/* ---- numbers by themselves ---- */

/* What devices have. The ends are wide and assumed: they are to find a wrong unit or a slip of the
 * pen, not a poor device. */
static const struct range {
  const char *kind, *name, *unit;
  double least, most;
} RANGES[] = {{"thyristor", "v_drm", "V", 25, 15e3},
              {"thyristor", "v_rrm", "V", 10, 15e3},
              {"thyristor", "blocking_voltage", "V", 25, 15e3},
              {"thyristor", "i_t_rms", "A", 0.1, 2e4},
              {"thyristor", "di_dt", "A/us", 2, 5e3},
              {"thyristor", "dv_dt", "V/us", 2, 2e4},
              {"thyristor", "critical_dvdt", "V/us", 2, 2e4},
              {"thyristor", "t_q", "us", 1, 2e3},
              {"thyristor", "turn_off_time", "us", 1, 2e3},
              {"thyristor", "i_gt", "mA", 0.001, 1e3},
              {"thyristor", "gate_current", "mA", 0.001, 1e3},
              {"thyristor", "v_gt", "V", 0.55, 5},
              {"thyristor", "v_t", "V", 0.7, 6},
              {"thyristor", "on_voltage", "V", 0.5, 3},
              {"triac", "v_drm", "V", 25, 3e3},
              {"triac", "i_t_rms", "A", 0.1, 500},
              {"triac", "di_dt", "A/us", 1, 1e3},
              {"triac", "dv_dt", "V/us", 2, 2e4},
              {"triac", "dv_dt_c", "V/us", 0.05, 1e3},
              {"triac", "di_dt_c", "A/ms", 0.1, 1e3},
              {"triac", "i_gt", "mA", 0.1, 500},
              {"triac", "gate_current", "mA", 0.1, 500},
              {"triac", "v_gt", "V", 0.4, 5},
              {"triac", "v_t", "V", 0.7, 6},
              {"triac", "on_voltage", "V", 0.4, 3},
              {"diode", "v_rrm", "V", 5, 2e4},
              {"diode", "i_f_av", "A", 1e-3, 2e4},
              {"diode", "v_f", "V", 0.15, 10},
              {"diode", "on_voltage", "V", 0.1, 8},
              {"diode", "q_rr", "A*us", 1e-5, 1e5},
              {"diode", "recovered_charge", "A*us", 1e-5, 1e5},
              {"diode", "t_rr", "ns", 1, 2e5},
              {"mosfet", "v_dss", "V", 5, 5e3},
              {"mosfet", "i_d", "A", 0.01, 5e3},
              {"mosfet", "r_ds_on", "ohm", 1e-4, 1e3},
              {"mosfet", "on_resistance", "ohm", 1e-4, 1e3},
              {"mosfet", "v_gs_th", "V", 0.3, 10},
              {"mosfet", "threshold", "V", 0.3, 10},
              {"igbt", "v_ces", "V", 100, 1e4},
              {"igbt", "i_c", "A", 0.1, 1e4},
              {"igbt", "v_ce_sat", "V", 0.7, 8},
              {"igbt", "v_ge_th", "V", 2, 10},
              {"igbt", "threshold", "V", 2, 10},
              {"igbt", "e_off", "mJ", 1e-3, 1e5},
              {"igbt", "turn_off_energy", "mJ", 1e-3, 1e5},
              {"electrolytic", "v_rated", "V", 2, 1e3},
              {"electrolytic", "c_rated", "uF", 0.05, 1e7},
              {"electrolytic", "capacitance", "uF", 0.05, 1e7},
              {"electrolytic", "esr", "ohm", 3e-4, 1e3},
              {"electrolytic", "i_ripple", "A", 1e-3, 1e3},
              {"varistor", "v_rms", "V", 2, 2e4},
              {"varistor", "v_varistor", "V", 4, 5e4},
              {"varistor", "varistor_exponent", "", 10, 80},
              {"varistor", "i_surge", "A", 1, 2e5},
              {"varistor", "energy", "J", 0.01, 1e5},
              {"fuse", "i_rated", "A", 0.01, 1e4},
              {"fuse", "v_rated", "V", 5, 1e5},
              {"fuse", "i2t_melt", "A2.s", 1e-6, 1e8},
              {"fuse", "v_arc", "V", 10, 1e5}};

static void warn_of_range(const vs_stand *s, const struct range *range, vs_warnings *w) {
  vs_figures_asked limit = vs_figures_limit(s, range->name),
                   a = isfinite(limit.value) ? limit : vs_figures_any(s, range->name);
  double shown = a.value / vs_units_factor(range->unit);
  if (isnan(shown) || (shown >= range->least && shown <= range->most)) return;
  vs_fail_at(vs_warnings_add(w), a.where.file ? a.where : (vs_where){.file = s->name},
             "%s = %.4g %s is implausible: a%s %s has %.4g to %.4g %s; is the unit right?",
             range->name, shown, range->unit, strchr("aeio", *range->kind) ? "n" : "", range->kind,
             range->least, range->most, range->unit);
}

/* ---- numbers side by side ---- */

/* Adds a warning where a over b is not within these ends. `text` says what is usual. */
static void warn_of_ratio(vs_figures_asked a, vs_figures_asked b, const double ends[2],
                          const char *text, vs_warnings *w) {
  double ratio = a.value / b.value;
  if (isnan(ratio) || (ratio >= ends[0] && ratio <= ends[1])) return;
  vs_fail_at(vs_warnings_add(w), a.where, "implausible: %s; here it is %.4g", text, ratio);
}

static const struct pair {
  const char *kind, *one, *other;
  double ends[2];
  const char *text;
} PAIRS[] = {
    {"thyristor", "i_tsm", "i_t_rms", {3, 50}, "i_tsm is 3 to 50 times i_t_rms"},
    {"triac", "i_tsm", "i_t_rms", {3, 50}, "i_tsm is 3 to 50 times i_t_rms"},
    {"diode", "i_fsm", "i_f_av", {3, 100}, "i_fsm is 3 to 100 times i_f_av"},
    {"mosfet", "i_dm", "i_d", {1, 20}, "i_dm is 1 to 20 times i_d"},
    {"igbt", "i_cm", "i_c", {1, 20}, "i_cm is 1 to 20 times i_c"},
    {"varistor", "v_varistor", "v_rms", {1.35, 2.2}, "v_varistor is 1.35 to 2.2 times v_rms"},
    {"varistor", "v_clamp", "v_varistor", {1.05, 4}, "v_clamp is 1.05 to 4 times v_varistor"},
    {"fuse", "i2t_clear", "i2t_melt", {1, 100}, "i2t_clear is 1 to 100 times i2t_melt"},
    {"fuse", "i_fusing", "i_rated", {1.02, 4}, "i_fusing is 1.02 to 4 times i_rated"},
    {"fuse", "v_arc", "v_rated", {1, 10}, "v_arc is 1 to 10 times v_rated"}};

/* A half sine of 10 ms and the peak I has I^2 * 5 ms. */
static void warn_of_surge(const vs_stand *s, vs_warnings *w) {
  static const struct surge {
    const char *name, *text;
  } SURGES[] = {
      {"i_tsm", "i2t is 0.5 to 1.5 times what a half sine of 10 ms and i_tsm has, i_tsm^2 * 5 ms"},
      {"i_fsm", "i2t is 0.5 to 1.5 times what a half sine of 10 ms and i_fsm has, i_fsm^2 * 5 ms"}};
  for (size_t k = 0; k < sizeof SURGES / sizeof *SURGES; k++) {
    vs_figures_asked i2t = vs_figures_limit(s, "i2t"), surge = vs_figures_limit(s, SURGES[k].name);
    surge.value *= surge.value * 5e-3;
    warn_of_ratio(i2t, surge, (double[]){0.5, 1.5}, SURGES[k].text, w);
  }
}

/* A figure that stands in the file twice: as the limit that runs are held to, and as a parameter
 * that the model is made with. */
static void warn_of_twins(const vs_stand *s, vs_warnings *w) {
  static const char *const TWINS[][2] = {
      {"blocking_voltage", "v_drm"}, {"blocking_voltage", "v_dss"}, {"blocking_voltage", "v_ces"},
      {"critical_dvdt", "dv_dt"},    {"turn_off_time", "t_q"},      {"rated_voltage", "v_rated"},
      {"melting_i2t", "i2t_melt"},   {"rated_current", "i_rated"}};
  for (size_t k = 0; k < sizeof TWINS / sizeof *TWINS; k++) {
    vs_figures_asked param = vs_figures_any(s, TWINS[k][0]),
                     limit = vs_figures_limit(s, TWINS[k][1]);
    double ratio = param.value / limit.value;
    if (isnan(ratio) || fabs(ratio - 1) < 0.01) continue;
    vs_fail_at(vs_warnings_add(w), param.where.file ? param.where : limit.where,
               "%s, by which the model is made, is %.4g times the limit %s: a run is held to the "
               "one, and the model does the other",
               TWINS[k][0], ratio, TWINS[k][1]);
  }
}

/* ---- heat ---- */

/* The place of the line `*$ part`. */
static vs_where part_line(const vs_stand *s) {
  const vs_part_file *file = vs_parts_file(&s->deck, s->file);
  return (vs_where){s->name, file ? file->where.line : 0, 1};
}

/* The current that a kind of semiconductor is rated for, and what of it heats the chip: V mean and
 * R times the square of rms. A thyristor's and a diode's are half sines, whose rms is 1.57 times
 * the mean; a triac's are sines, whose mean size is 0.9 times the rms. */
static const struct heat {
  const char *kind, *current;
  double mean, rms; /* over the rated current */
} HEATS[] = {{"thyristor", "i_t_rms", 1 / 1.57, 1},
             {"triac", "i_t_rms", 0.9, 1},
             {"diode", "i_f_av", 1, 1.57},
             {"mosfet", "i_d", 0, 1},
             {"igbt", "i_c", 1, 1}};

/* Without zth nothing is computed of the junction. With it, the rated current must not heat it from
 * a case at 25 degC beyond t_j_max. */
static void warn_of_heat(const vs_stand *s, const struct heat *h, vs_warnings *w) {
  static const double WARM_K = 150; /* from 25 degC to 175 degC; few chips go beyond */
  double k_per_w = 0, i = vs_figures_limit(s, h->current).value,
         v0 = vs_figures_any(s, "on_voltage").value, r = vs_figures_any(s, "on_resistance").value;
  vs_where first = {0};
  for (size_t k = 0; k < s->deck.n_zth; k++) {
    const vs_zth *z = &s->deck.zth[k];
    if (strcmp(z->where.file, s->file)) continue;
    const vs_where where = {s->name, z->where.line, z->where.column};
    if (!first.file) first = where;
    k_per_w += z->k_per_w;
    if (z->tau_s < 1e-6 || z->tau_s > 1e4)
      vs_fail_at(vs_warnings_add(w), where,
                 "implausible: a time constant of %.4g s; chips and cases have 1 us to 10,000 s",
                 z->tau_s);
  }
  if (!first.file)
    vs_fail_at(vs_warnings_add(w), part_line(s),
               "no line 'zth': the junction's temperature is not computed, so that nothing tells "
               "when it is too hot; give the terms of Z_th(j-c)");
  double loss_w = h->mean * i;
  if (isfinite(r)) loss_w = (isfinite(v0) ? v0 : 0) * h->mean * i + r * h->rms * h->rms * i * i;
  if (first.file && k_per_w * loss_w > WARM_K)
    vs_fail_at(vs_warnings_add(w), first,
               "implausible: the lines zth make %.4g K/W, by which %s = %.4g A heats the "
               "junction by %.4g K",
               k_per_w, h->current, i, k_per_w * loss_w);
}

/* ---- what was measured ---- */

/* True where a warning speaks of that line. */
static bool is_named(const vs_warnings *w, int line) {
  for (size_t k = 0; k < w->count; k++)
    if (w->item[k].line == line && line) return true;
  return false;
}

/* A model may meet what is asked because it is ideal, as no device is. */
static void warn_of_figure(const vs_stand *s, const vs_figure *row, vs_warnings *w) {
  static const double FAR = 20; /* times better than what is asked */
  vs_where where = row->where.file ? row->where : part_line(s);
  double factor = vs_units_factor(row->unit), limit = vs_figures_limit(s, "di_dt").value;
  if (isnan(row->got)) return;
  if (!strcmp(row->name, "V_GT") && (row->got < 0.55 || row->got > 5))
    vs_fail_at(
        vs_warnings_add(w), where,
        "implausible: the model's gate fires at %.3g V; a gate's junction wants 0.55 to 5 V, "
        "and noise below that would fire it in a run",
        row->got);
  if (!strcmp(row->name, "di/dt") && row->got > 100 * limit)
    vs_fail_at(
        vs_warnings_add(w), vs_figures_limit(s, "di_dt").where,
        "implausible: di_dt = %.4g A/us, and the model turns on at %.3g A/us: a run's margin "
        "of di_dt would be %.2g %%, and tell nothing of the device; look at the unit, or "
        "give the circuit its inductance",
        limit * 1e-6, row->got * 1e-6, 100 * (1 - row->got / limit));
  if (is_named(w, row->where.line)) return; /* what is asked is wrong already */
  bool better = (row->held == VS_HELD_AT_MOST && row->got < row->asked / FAR) ||
                (row->held == VS_HELD_AT_LEAST && row->got > row->asked * FAR);
  if (better && isinf(row->got))
    vs_fail_at(vs_warnings_add(w), where,
               "implausible: the model never shows %s, and %.4g %s is asked: runs will not tell "
               "when the device would",
               row->name, row->asked / factor, row->unit);
  else if (better)
    vs_fail_at(vs_warnings_add(w), where,
               "implausible: %s is %.3g %s, and %.4g %s is asked: a model that is better than its "
               "device by so much hides what the device would do",
               row->name, row->got / factor, row->unit, row->asked / factor, row->unit);
}

static bool is_ideal(const vs_stand *s) {
  for (size_t k = 0; k < s->deck.n_limits; k++)
    if (isfinite(s->deck.limits[k].value)) return false;
  return true;
}

/* By line, in the order of the file. */
static void sort(vs_warnings *w, size_t first) {
  for (size_t k = first + 1; k < w->count; k++)
    for (size_t n = k; n > first && w->item[n - 1].line > w->item[n].line; n--) {
      vs_error other = w->item[n];
      w->item[n] = w->item[n - 1];
      w->item[n - 1] = other;
    }
}

void vs_plausibility_warn(const vs_stand *s, const vs_figures *figures, vs_warnings *w) {
  const vs_part_file *file = vs_parts_file(&s->deck, s->file);
  size_t first = w->count;
  if (!file || is_ideal(s)) return;
  for (size_t k = 0; k < sizeof RANGES / sizeof *RANGES; k++)
    if (!strcmp(RANGES[k].kind, file->kind)) warn_of_range(s, &RANGES[k], w);
  for (size_t k = 0; k < sizeof PAIRS / sizeof *PAIRS; k++)
    if (!strcmp(PAIRS[k].kind, file->kind))
      warn_of_ratio(vs_figures_limit(s, PAIRS[k].one), vs_figures_limit(s, PAIRS[k].other),
                    PAIRS[k].ends, PAIRS[k].text, w);
  warn_of_surge(s, w);
  warn_of_twins(s, w);
  for (size_t k = 0; k < sizeof HEATS / sizeof *HEATS; k++)
    if (!strcmp(HEATS[k].kind, file->kind)) warn_of_heat(s, &HEATS[k], w);
  for (size_t k = 0; k < figures->count; k++) warn_of_figure(s, &figures->row[k], w);
  sort(w, first);
}
