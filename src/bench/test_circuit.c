/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_circuit.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"

vs_status vs_test_circuit_run(const vs_stand *s, vs_test_circuit trial, vs_stand_record *r,
                              vs_error *err, const char *format, ...) {
  vs_text text = {0};
  char circuit[2048], wired[1024];
  va_list args;
  va_start(args, format);
  vsnprintf(circuit, sizeof circuit, format, args);
  va_end(args);
  const char *at = strstr(trial.wiring, "%s");
  snprintf(wired, sizeof wired, "%.*s%s%s", at ? (int)(at - trial.wiring) : 0, trial.wiring,
           s->subcircuit, at ? at + 2 : "");
  vs_text_add(&text, "Vm a t 0\n%s\nRa a 0 1e9\nRg g 0 1e6\n%s", wired, circuit);
  const vs_stand_circuit c = {text.text, trial.until_s, trial.step_s, 0};
  vs_status status = vs_stand_run(s, &c, r, err);
  vs_text_free(&text);
  return status;
}

vs_status vs_test_circuit_across(const vs_stand *s, vs_stand_circuit c, vs_stand_record *r,
                                 vs_error *err) {
  vs_text text = {0};
  vs_text_add(&text, "%s\nVm m a 0\nXdut a 0 %s\nRg g 0 1\n", c.text, s->subcircuit);
  c.text = text.text;
  vs_status status = vs_stand_run(s, &c, r, err);
  vs_text_free(&text);
  return status;
}

void vs_test_circuit_fail(vs_figure *row, const vs_error *err) {
  snprintf(row->why, sizeof row->why, "%.190s", err->text);
}

vs_figure *vs_test_circuit_row(const vs_stand *s, vs_figures *f, const char *const name_unit[2],
                               vs_test_circuit_source of, bool only_asked) {
  const vs_figures_asked none = {NAN, {0}};
  vs_figures_asked limit = of.limit ? vs_figures_limit(s, of.limit) : none,
                   own = of.param ? vs_figures_any(s, of.param) : none;
  bool is_own = isfinite(own.value) && (of.own_first || isnan(limit.value));
  if (only_asked && isnan(own.value) && isnan(limit.value)) return NULL;
  vs_figure *row =
      vs_figures_add(f, name_unit[0], name_unit[1], is_own ? own : limit,
                     is_own ? of.tolerance : of.slack, is_own ? VS_HELD_NEAR : of.held);
  if (of.limit) vs_figures_is(row, s, of.limit);
  return row;
}

void vs_test_circuit_draw(vs_figures *f, const vs_stand_record *r, vs_test_circuit_view w,
                          const double *column[2], const double unit[2]) {
  size_t first = 0, last;
  while (first < r->points && r->t_s[first] < w.from_s) first++;
  for (last = first; last < r->points && r->t_s[last] <= w.to_s;) last++;
  vs_figures_curve *c = vs_figures_add_curve(f, last - first);
  if (!c) return;
  c->title = w.title, c->x_label = w.x_label, c->y_label = w.y_label;
  for (size_t k = first; k < last; k++) {
    double x = column[0][k] - (column[0] == r->t_s ? w.from_s : 0);
    c->x[k - first] = x / unit[0];
    c->y[k - first] = column[1][k] / unit[1];
  }
}

double vs_test_circuit_energy(const vs_stand_record *r, double from_s, double to_s) {
  double energy_j = 0;
  for (size_t k = 1; k < r->points; k++)
    if (r->t_s[k] > from_s && r->t_s[k] <= to_s)
      energy_j += (r->v[k] * r->i[k] + r->v[k - 1] * r->i[k - 1]) / 2 * (r->t_s[k] - r->t_s[k - 1]);
  return energy_j;
}
