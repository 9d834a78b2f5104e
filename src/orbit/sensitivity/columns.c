/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/columns.h"

#include <math.h>
#include <string.h>

#include "measure/chunk.h"

enum { NODES = VS_LOWPASS_TERMS };

void vs_columns_begin(vs_columns *c, const vs_setup *setup) {
  *c = (vs_columns){.n = 2 * setup->model.dof, .machine = 2 * setup->model.dof};
  vs_variation_begin(&c->variation, setup);
  vs_variation_add_delay(&c->variation);
}

void vs_columns_end(vs_columns *c) {
  vs_variation_end(&c->variation);
}

/* The machine's columns, and the delay's as the last. */
static int driven(const vs_columns *c) {
  return c->machine + 1;
}

int vs_columns_add(vs_columns *c, const vs_seen *seen) {
  if (!seen->states) return -1;
  vs_column_filter *f = &c->filter[c->filters++];
  *f = (vs_column_filter){.seen = seen, .first = c->n};
  for (int j = 0; j < driven(c) + 2; j++) {
    f->column[j] = seen->lowpass;
    memset(f->column[j].x, 0, sizeof f->column[j].x);
  }
  for (int k = 0; k < seen->states; k++) f->column[driven(c) + k].x[k] = 1;
  c->n += seen->states;
  return f->first;
}

/* ---- what they are ---- */

/* What the variation's column j makes of a signal. The rates are there already. */
static double signal_of(vs_columns *c, const vs_seen *seen, int j) {
  int dof = c->variation.model->dof;
  double sum = 0;
  for (int i = 0; i < 2 * dof; i++) sum += seen->k[i] * vs_variation_get(&c->variation, i, j);
  for (int i = 0; i < dof; i++)
    sum += seen->k[2 * dof + i] * c->rates[j * c->variation.rows + dof + i];
  return sum;
}

double vs_columns_signal(vs_columns *c, const vs_step *step, const vs_seen *seen, int j) {
  if (j >= c->machine && j < c->n) return 0; /* a low-pass moves nothing */
  vs_variation_rates(&c->variation, step, c->rates);
  return signal_of(c, seen, j < c->n ? j : c->machine);
}

double vs_columns_state(vs_columns *c, int i, int j) {
  bool own = j >= c->machine && j < c->n; /* of a low-pass */
  int column = j < c->n ? j : c->machine; /* of the variation */
  if (i < c->machine) return own ? 0 : vs_variation_get(&c->variation, i, column);
  for (int k = 0; k < c->filters; k++) {
    const vs_column_filter *f = &c->filter[k];
    int row = i - f->first, theirs = j - f->first, states = f->seen->states;
    if (row < 0 || row >= states) continue;
    if (!own) return f->column[column].x[row];
    return theirs >= 0 && theirs < states ? f->column[driven(c) + theirs].x[row] : 0;
  }
  return 0;
}

/* ---- on the way ---- */

static void take_node(vs_columns *c, const vs_step *step, int node) {
  vs_variation_rates(&c->variation, step, c->rates);
  for (int k = 0; k < c->filters; k++) {
    vs_column_filter *f = &c->filter[k];
    for (int j = 0; j < driven(c); j++) f->nodes[j][node] = signal_of(c, f->seen, j);
  }
}

static void advance(vs_column_filter *f, int columns, double h_s) {
  const double none[NODES] = {0};
  double u[NODES];
  for (int j = 0; j < columns; j++) {
    const vs_chunk chunk = vs_chunk_through(f->nodes[j]);
    vs_chunk_powers(&chunk, u);
    vs_lowpass_advance(&f->column[j], h_s, u);
  }
  for (int k = 0; k < 2; k++) vs_lowpass_advance(&f->column[columns + k], h_s, none);
}

vs_status vs_columns_to(vs_columns *c, const vs_step *step, double t_s, vs_error *err) {
  double from_s = c->t_s;
  vs_status status = VS_OK;
  if (!(t_s > from_s)) return VS_OK;
  for (int node = c->filters ? NODES - 1 : 0; node >= 0 && !status; node--) {
    status = vs_variation_to(&c->variation, step, vs_chunk_instant(node, from_s, t_s), err);
    if (c->filters && !status) take_node(c, step, node);
  }
  for (int k = 0; k < c->filters && !status; k++) advance(&c->filter[k], driven(c), t_s - from_s);
  c->t_s = t_s;
  return status;
}

vs_status vs_columns_accept(vs_columns *c, const vs_step *step, vs_error *err) {
  return vs_variation_accept(&c->variation, step, err);
}
