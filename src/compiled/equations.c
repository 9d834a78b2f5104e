/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "equations.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

int vs_equations_signal(const vs_equations *e, const char *name) {
  size_t number;
  if (!strcmp(name, "v(0)")) return -1;
  return vs_names_find(&e->number, name, strlen(name), &number) ? (int)number : -2;
}

void vs_equations_free(vs_equations *e) {
  for (int k = 0; k < e->n; k++) free(e->name[k]);
  free(e->name);
  vs_names_free(&e->number);
  vs_matrix_free(&e->matrix);
  free(e->mass);
  free(e->linear);
  free(e->constant);
  free(e->level);
  free(e->source);
  for (int k = 0; k < e->courses; k++) vs_course_free(&e->course[k]);
  free(e->course);
  for (int k = 0; k < e->devices; k++) vs_program_free(&e->device[k].program);
  free(e->device);
  free(e->charge);
  free(e->share);
  free(e->first);
  free(e->rest);
  free(e->of_law);
  *e = (vs_equations){0};
}

static double at(const double *y, int k) {
  return k < 0 ? 0 : y[k];
}

static void add_entries(const vs_entry *list, int count, const double *y, double *f) {
  for (const vs_entry *at = list, *end = list + count; at < end; at++)
    f[at->row] += at->value * y[at->column];
}

void vs_equations_follow(const vs_equations *e, double *y, bool change) {
  const int count = e->follow - e->rows;
  double *of = y + e->rows;
  for (int k = 0; k < count; k++) of[k] = change ? 0 : e->rest[k];
  if (count) add_entries(e->share, e->first[count], y, y);
}

static void add_to(const vs_equations *e, double *jacobian, int row, int column, double value) {
  if (row < 0 || column < 0) return;
  const int *place = e->matrix.place + row * e->rows, k = column - e->rows;
  if (k < 0) jacobian[place[column]] += value;
  for (int l = k < 0 ? 0 : e->first[k]; k >= 0 && l < e->first[k + 1]; l++)
    jacobian[place[e->share[l].column]] += e->share[l].value * value;
}

/* A current that leaves the node of row a for that of b; its slope by the voltage from c to d. */
static void leave(double *f, int a, int b, double i) {
  if (a >= 0) f[a] -= i;
  if (b >= 0) f[b] += i;
}

static void slope_of(const vs_equations *e, double *jacobian, int a, int b, int c, int d,
                     double g) {
  const int *of_a = e->matrix.place + a * e->rows, *of_b = e->matrix.place + b * e->rows;
  if (c < e->rows && d < e->rows) { /* as it is mostly: no others follow from them */
    if (a >= 0 && c >= 0) jacobian[of_a[c]] -= g;
    if (a >= 0 && d >= 0) jacobian[of_a[d]] += g;
    if (b >= 0 && c >= 0) jacobian[of_b[c]] += g;
    if (b >= 0 && d >= 0) jacobian[of_b[d]] -= g;
    return;
  }
  add_to(e, jacobian, a, c, -g);
  add_to(e, jacobian, a, d, g);
  add_to(e, jacobian, b, c, g);
  add_to(e, jacobian, b, d, -g);
}

/* Does the machine's k-th rate depend on its l-th state, or, behind these, on the flux linkage?
 * That of a coordinate is a state. */
static bool depends(const vs_equations *e, int k, int l) {
  const int half = e->states / 2;
  return k >= half || l == k + half;
}

/* x' of the machine, and its slopes, added to what is constant in the Jacobian. These are
 * differences, over steps that are small beside any gap, and without a linear law beside how deep
 * an armature rests in its stop. Those by x are kept for as long as its law is the same linear one,
 * which must hold over the difference: beside a stop it is taken the other way. With the stop's
 * stiffness kept a valve's plunger was off by 0.1 of the root of the tolerance. */
static void value_of_machine(vs_equations *e, const double *y, double *f, double *jacobian) {
  static const double STEP = 1e-7, SHORT_STEP = 1e-10;
  const vs_circuit_machine *m = &e->host->machine;
  double x[VS_MACHINE_STATES], rate[VS_MACHINE_STATES];
  const double flux_wb = at(y, e->flux);
  memcpy(x, y + e->machine, (size_t)e->states * sizeof *x);
  m->rates(e->host->ctx, x, flux_wb, f + e->machine);
  if (!jacobian) return;
  const void *law = m->linear ? m->linear(e->host->ctx, x) : NULL;
  const bool kept = law && law == e->law;
  const size_t size = (size_t)e->matrix.count * sizeof *jacobian;
  for (int l = 0; l < e->states && !kept; l++) {
    double step = law ? STEP : SHORT_STEP;
    x[l] += step;
    if (law && m->linear(e->host->ctx, x) != law) x[l] = y[e->machine + l] + (step = -STEP);
    m->rates(e->host->ctx, x, flux_wb, rate);
    x[l] = y[e->machine + l];
    for (int k = 0; k < e->states; k++)
      if (depends(e, k, l))
        add_to(e, jacobian, e->machine + k, e->machine + l, (rate[k] - f[e->machine + k]) / step);
  }
  memcpy(kept ? jacobian : e->of_law, kept ? e->of_law : jacobian, size);
  e->law = law;
  m->rates(e->host->ctx, x, flux_wb + STEP, rate);
  for (int k = e->states / 2; k < e->states; k++)
    add_to(e, jacobian, e->machine + k, e->flux, (rate[k] - f[e->machine + k]) / STEP);
}

static void value_of_program(const vs_equations *e, const vs_compiled_device *d, const double *y,
                             double *f, double *jacobian) {
  double slope[VS_PROGRAM_SIGNALS];
  const vs_compiled_program *p = &d->program;
  if (!p->n_live && p->value[p->result] == 0) return;
  const double value = d->factor * vs_program_value(p, y, jacobian ? slope : NULL);
  if (d->branch >= 0)
    f[d->branch] -= value;
  else
    leave(f, d->row[0], d->row[1], value);
  for (int k = 0; jacobian && k < p->signals; k++) {
    const double g = d->factor * slope[k];
    if (g == 0) continue;
    if (d->branch >= 0) {
      add_to(e, jacobian, d->branch, p->signal[k].plus, -g);
      add_to(e, jacobian, d->branch, p->signal[k].minus, g);
    } else {
      slope_of(e, jacobian, d->row[0], d->row[1], p->signal[k].plus, p->signal[k].minus, g);
    }
  }
}

/* The voltage at which a junction is evaluated; *limited becomes true where that is another one. */
static double taken_at(vs_compiled_device *d, int k, const vs_diode *diode, double v, bool limits,
                       bool *limited) {
  if (!limits) return v;
  double taken = vs_junction_limit(diode, v, d->before[k]);
  *limited = *limited || fabs(taken - v) > 1e-6 * diode->n * VS_JUNCTION_VT;
  return d->before[k] = taken;
}

static void value_of_diode(vs_equations *e, vs_compiled_device *d, const double *y, bool limits,
                           bool *limited, double *f, double *jacobian) {
  const int a = d->pin[0], k = d->pin[1];
  double g, v = at(y, a) - at(y, k), taken = taken_at(d, 0, &d->diode, v, limits, limited);
  double i = vs_junction_current(&d->diode, taken, &g);
  i += g * (v - taken);
  leave(f, d->row[0], d->row[1], i);
  if (jacobian) slope_of(e, jacobian, d->row[0], d->row[1], a, k, g);
  if (d->charge[0] < 0) return;
  f[d->charge[0]] -= d->diode.transit_s * i;
  if (!jacobian) return;
  add_to(e, jacobian, d->charge[0], a, -d->diode.transit_s * g);
  add_to(e, jacobian, d->charge[0], k, d->diode.transit_s * g);
}

static void value_of_bipolar(vs_equations *e, vs_compiled_device *d, const double *y, bool limits,
                             bool *limited, double *f, double *jacobian) {
  const vs_bipolar *q = &d->bipolar;
  const int c = d->pin[0], b = d->pin[1], x = d->pin[2];
  const double way = q->way, vbe = way * (at(y, b) - at(y, x)), vbc = way * (at(y, b) - at(y, c));
  const double be = taken_at(d, 0, &q->junction, vbe, limits, limited);
  const double bc = taken_at(d, 1, &q->junction, vbc, limits, limited);
  double ic, ib, dc[2], db[2];
  vs_junction_transistor(q, be, bc, &ic, &ib, dc, db);
  ic += dc[0] * (vbe - be) + dc[1] * (vbc - bc);
  ib += db[0] * (vbe - be) + db[1] * (vbc - bc);
  const int *row = d->row;
  leave(f, row[0], row[2], way * ic);
  leave(f, row[1], row[2], way * ib);
  if (!jacobian) return;
  slope_of(e, jacobian, row[0], row[2], b, x, dc[0]);
  slope_of(e, jacobian, row[0], row[2], b, c, dc[1]);
  slope_of(e, jacobian, row[1], row[2], b, x, db[0]);
  slope_of(e, jacobian, row[1], row[2], b, c, db[1]);
}

/* The row of a charge q - Q(v), with v from node a to node b. */
static void value_of_charge(const vs_equations *e, int q, int a, int b, double charge, double c,
                            double *f, double *jacobian) {
  f[q] -= charge;
  if (!jacobian) return;
  add_to(e, jacobian, q, a, -c);
  add_to(e, jacobian, q, b, c);
}

static void value_of_mosfet(vs_equations *e, vs_compiled_device *device, const double *y,
                            bool limits, bool *limited, double *f, double *jacobian) {
  const vs_vdmos *m = &device->vdmos;
  const int d = device->pin[0], g = device->pin[1], s = device->pin[2];
  const double vgs = at(y, g) - at(y, s), vds = at(y, d) - at(y, s);
  double slope[2], conductance, c;
  const int row_d = device->row[0], row_s = device->row[2];
  leave(f, row_d, row_s, vs_junction_channel(m, vgs, vds, slope));
  const double taken = taken_at(device, 0, &m->body, -vds, limits, limited);
  leave(f, row_s, row_d,
        vs_junction_current(&m->body, taken, &conductance) + conductance * (-vds - taken));
  double charge = vs_junction_gate_charge(m, vgs - vds, &c);
  value_of_charge(e, device->charge[0], g, d, charge, c, f, jacobian);
  charge = vs_junction_body_charge(m, -vds, &c);
  value_of_charge(e, device->charge[1], s, d, charge, c, f, jacobian);
  if (!jacobian) return;
  slope_of(e, jacobian, row_d, row_s, g, s, slope[0]);
  slope_of(e, jacobian, row_d, row_s, d, s, slope[1]);
  slope_of(e, jacobian, row_s, row_d, s, d, conductance);
}

bool vs_equations_value(vs_equations *e, const double *y, const double *source, bool limits,
                        double *f, double *jacobian) {
  bool limited = false;
  if (jacobian) memcpy(jacobian, e->constant, (size_t)e->matrix.count * sizeof *jacobian);
  memcpy(f, e->level, (size_t)e->rows * sizeof *f);
  add_entries(e->linear, e->linears, y, f);
  if (e->states) value_of_machine(e, y, f, jacobian);
  for (int k = 0; k < e->sources; k++) f[e->source[k].row] += e->source[k].factor * source[k];
  for (int k = 0; k < e->devices; k++) {
    vs_compiled_device *d = &e->device[k];
    if (d->kind == VS_DEVICE_PROGRAM) {
      value_of_program(e, d, y, f, jacobian);
    } else if (d->kind == VS_DEVICE_DIODE) {
      value_of_diode(e, d, y, limits, &limited, f, jacobian);
    } else if (d->kind == VS_DEVICE_VDMOS) {
      value_of_mosfet(e, d, y, limits, &limited, f, jacobian);
    } else if (d->kind == VS_DEVICE_BIPOLAR) {
      value_of_bipolar(e, d, y, limits, &limited, f, jacobian);
    } else {
      const double g = d->on ? d->on_s : d->off_s;
      leave(f, d->row[0], d->row[1], g * (at(y, d->pin[0]) - at(y, d->pin[1])));
      if (jacobian) slope_of(e, jacobian, d->row[0], d->row[1], d->pin[0], d->pin[1], g);
    }
  }
  return limited;
}

static const int JUNCTIONS[] = {
    [VS_DEVICE_DIODE] = 1, [VS_DEVICE_BIPOLAR] = 2, [VS_DEVICE_VDMOS] = 1, [VS_DEVICE_SWITCH] = 0};

/* The k-th junction of a device, with its voltage at y; NULL: it has no more. */
static const vs_diode *junction_at(const vs_compiled_device *d, int k, const double *y, double *v) {
  const int *pin = d->pin;
  if (d->kind == VS_DEVICE_DIODE && k == 0) {
    *v = at(y, pin[0]) - at(y, pin[1]);
    return &d->diode;
  }
  if (d->kind == VS_DEVICE_BIPOLAR && k < 2) {
    *v = d->bipolar.way * (at(y, pin[1]) - at(y, pin[k ? 0 : 2]));
    return &d->bipolar.junction;
  }
  if (d->kind != VS_DEVICE_VDMOS || k) return NULL;
  *v = at(y, pin[2]) - at(y, pin[0]);
  return &d->vdmos.body;
}

/* What the error of a step says of a junction is a part of n vt, which is less than any voltage's
 * tolerance, however large the current that it stands for. A transistor multiplies it; a diode does
 * not, and only OF_DIODE of its own counts. With a tenth it may stay above 1 however short the step
 * is, as what the step before it left behind. */
static const double OF_DIODE = 1.0 / 3;

double vs_equations_imbalance(vs_equations *e, const double *y, const double *next,
                              const double *change) {
  double most = 0, v, slope, before, by, none;
  for (int n = 0; n < e->devices; n++) {
    vs_compiled_device *d = &e->device[n];
    const vs_diode *j;
    for (int k = 0; (j = junction_at(d, k, y, &v)); k++) {
      vs_junction_current(j, v, &slope);
      junction_at(d, k, next, &v);
      junction_at(d, k, change, &by);
      before = vs_junction_current(j, v - by, &none);
      const double counts = d->kind == VS_DEVICE_DIODE ? OF_DIODE : 1;
      d->last_a[k] = vs_junction_current(j, v, &none);
      const double off = counts * fabs(d->last_a[k] - before - slope * by);
      const double peak = fabs(before) > d->peak_a[k] ? fabs(before) : d->peak_a[k];
      if (peak > 0 && !(off <= most * peak)) most = off / peak;
    }
  }
  return most;
}

void vs_equations_note_peaks(vs_equations *e, const double *y) {
  double v, g;
  for (int n = 0; n < e->devices; n++) {
    vs_compiled_device *d = &e->device[n];
    const vs_diode *j;
    for (int k = 0; k < JUNCTIONS[d->kind]; k++) {
      if (y && (j = junction_at(d, k, y, &v))) d->last_a[k] = vs_junction_current(j, v, &g);
      if (fabs(d->last_a[k]) > d->peak_a[k]) d->peak_a[k] = fabs(d->last_a[k]);
    }
  }
}

void vs_equations_mass(const vs_equations *e, const double *v, double *r) {
  memset(r, 0, (size_t)e->rows * sizeof *r);
  vs_equations_add_mass(e, v, r);
}

void vs_equations_add_mass(const vs_equations *e, const double *v, double *r) {
  add_entries(e->mass, e->masses, v, r);
}

static bool choose_of(vs_compiled_device *d, const double *y, bool only_ask) {
  if (d->kind == VS_DEVICE_PROGRAM) return vs_program_choose(&d->program, y, only_ask);
  if (d->kind != VS_DEVICE_SWITCH) return false;
  const double v = at(y, d->control[0]) - at(y, d->control[1]);
  const bool due = v > d->threshold + (d->on ? -d->hysteresis : d->hysteresis),
             other = due != d->on;
  if (!only_ask) d->on = due;
  return other;
}

bool vs_equations_asks(vs_equations *e, int device, const double *y) {
  return choose_of(&e->device[device], y, true);
}

void vs_equations_turn(vs_equations *e, int device, const double *y) {
  vs_compiled_device *d = &e->device[device];
  if (d->kind == VS_DEVICE_SWITCH)
    d->on = !d->on;
  else
    choose_of(d, y, false);
}

bool vs_equations_choose(vs_equations *e, const double *y, bool only_ask) {
  bool other = false;
  for (vs_compiled_device *d = e->device, *end = d + e->devices; d < end; d++) {
    d->asks = choose_of(d, y, only_ask);
    other = other || d->asks;
  }
  return other;
}

bool vs_equations_still_asks(vs_equations *e, const double *y) {
  for (vs_compiled_device *d = e->device, *end = d + e->devices; d < end; d++)
    if (d->asks && choose_of(d, y, true)) return true;
  return false;
}

/* ---- the pattern ---- */

static void add_place(vs_equations *e, int row, int column) {
  const int k = column - e->rows;
  if (row < 0 || column < 0) return;
  if (k < 0) vs_matrix_place(&e->matrix, row, column);
  for (int l = k < 0 ? 0 : e->first[k]; k >= 0 && l < e->first[k + 1]; l++)
    vs_matrix_place(&e->matrix, row, e->share[l].column);
}

static void add_places_of(vs_equations *e, const vs_compiled_device *d) {
  const int pins = d->kind == VS_DEVICE_BIPOLAR || d->kind == VS_DEVICE_VDMOS ? 3 : 2;
  if (d->kind == VS_DEVICE_PROGRAM) {
    for (int k = 0; k < d->program.signals; k++)
      for (int side = 0; side < 2; side++) {
        int column = side ? d->program.signal[k].minus : d->program.signal[k].plus;
        add_place(e, d->branch >= 0 ? d->branch : d->row[0], column);
        if (d->branch < 0) add_place(e, d->row[1], column);
      }
    return;
  }
  for (int a = 0; a < pins; a++)
    for (int b = 0; b < pins; b++) add_place(e, d->row[a], d->pin[b]);
  for (int q = 0; q < 2 && d->charge[q] >= 0; q++)
    for (int b = 0; b < pins; b++) add_place(e, d->charge[q], d->pin[b]);
}

/* Entries of one place become one. */
static void join_entries(const vs_equations *e, vs_entry *list, int *count) {
  int *at = vs_alloc((size_t)e->matrix.count, sizeof *at), kept = 0;
  for (int k = 0; k < *count; k++) {
    int *first = &at[list[k].place];
    if (*first)
      list[*first - 1].value += list[k].value;
    else {
      list[kept] = list[k];
      *first = ++kept;
    }
  }
  *count = kept;
  free(at);
}

void vs_equations_make_pattern(vs_equations *e) {
  vs_matrix_free(&e->matrix);
  vs_matrix_begin(&e->matrix, e->rows);
  for (int k = 0; k < e->linears; k++)
    e->linear[k].place = vs_matrix_place(&e->matrix, e->linear[k].row, e->linear[k].column);
  for (int k = 0; k < e->masses; k++)
    e->mass[k].place = vs_matrix_place(&e->matrix, e->mass[k].row, e->mass[k].column);
  for (int k = 0; k < e->devices; k++) add_places_of(e, &e->device[k]);
  for (int k = 0; k < e->states; k++) {
    for (int l = 0; l <= e->states; l++)
      if (depends(e, k, l)) add_place(e, e->machine + k, l == e->states ? e->flux : e->machine + l);
  }
  free(e->constant);
  free(e->of_law);
  e->constant = vs_alloc((size_t)e->matrix.count, sizeof *e->constant);
  e->of_law = vs_alloc((size_t)e->matrix.count, sizeof *e->of_law);
  e->law = NULL;
  for (int k = 0; k < e->linears; k++) e->constant[e->linear[k].place] += e->linear[k].value;
  join_entries(e, e->linear, &e->linears);
  join_entries(e, e->mass, &e->masses);
}
