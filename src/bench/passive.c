/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "bench/passive.h"

#include <math.h>
#include <stdio.h>

#include "base/text.h"

static vs_status try_out(const vs_stand *s, const char *source, double until_s, vs_stand_record *r,
                         vs_error *err) {
  vs_text text = {0};
  vs_text_add(&text, "%s\nVm m a 0\nXdut a 0 %s\nRg g 0 1\n", source, s->subcircuit);
  const vs_stand_circuit c = {text.text, until_s, until_s / 200, 1e-6};
  vs_status status = vs_stand_run(s, &c, r, err);
  vs_text_free(&text);
  return status;
}

static void fail(vs_figure *row, const vs_error *err) {
  snprintf(row->why, sizeof row->why, "%.190s", err->text);
}

/* 1 V, after 1 s, when its inductance is long past. */
static void measure_resistor(const vs_stand *s, vs_figures *f) {
  vs_figure *row =
      vs_figures_add(f, "R", "ohm", vs_figures_own(s, "resistance"), 0.01, VS_HELD_NEAR);
  vs_stand_record r = {0};
  vs_error err = {0};
  snprintf(row->text, sizeof row->text, "at 1 V");
  vs_status status = try_out(s, "Vs m 0 pwl(0 0 1m 1)", 1, &r, &err);
  if (status)
    fail(row, &err);
  else
    row->got = vs_stand_at(&r, r.v, 0.99) / vs_stand_at(&r, r.i, 0.99);
  vs_stand_free(&r);
}

/* The voltage rises by 10 V in 10 ms: i = C dv/dt, read over the second half, without leakage. */
static void capacitance(const vs_stand *s, vs_figure *row) {
  vs_stand_record r = {0};
  vs_error err = {0};
  vs_status status = try_out(s, "Vs m 0 pwl(0 0 10m 10)", 10e-3, &r, &err);
  snprintf(row->text, sizeof row->text, "at 1 V/ms");
  if (status)
    fail(row, &err);
  else
    row->got = vs_stand_at(&r, r.i, 9e-3) / 1e3;
  vs_stand_free(&r);
}

/* A current that is switched on within a thousandth of the time: v = R i + i t/C. The line through
 * two instants says what stood there at once. */
static void series_resistance(const vs_stand *s, double c_f, vs_figure *row) {
  double guess = isfinite(row->asked) ? row->asked : 0.1, until_s = guess * c_f;
  vs_stand_record r = {0};
  vs_error err = {0};
  char source[128];
  snprintf(source, sizeof source, "Is 0 m pwl(0 0 %.9g 1)", until_s / 1000);
  vs_status status = try_out(s, source, until_s, &r, &err);
  snprintf(row->text, sizeof row->text, "in series, at 1 A");
  if (status)
    fail(row, &err);
  else
    row->got =
        2 * vs_stand_at(&r, r.v, 0.5 * until_s + 0.25e-3 * until_s) - vs_stand_at(&r, r.v, until_s);
  vs_stand_free(&r);
}

static void measure_capacitor(const vs_stand *s, vs_figures *f) {
  vs_figure *row =
                vs_figures_add(f, "C", "uF", vs_figures_own(s, "capacitance"), 0.01, VS_HELD_NEAR),
            *esr = vs_figures_add(f, "ESR", "mohm", vs_figures_own(s, "esr"), 0.02, VS_HELD_NEAR);
  capacitance(s, row);
  if (row->got > 0)
    series_resistance(s, row->got, esr);
  else
    snprintf(esr->why, sizeof esr->why, "its capacitance is not known");
}

const vs_figures_kind vs_passive_resistor = {"resistor", "t 0", measure_resistor},
                      vs_passive_capacitor = {"capacitor", "t 0", measure_capacitor};
