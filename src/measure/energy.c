/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/energy.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/batch.h"
#include "measure/extremes.h"
#include "plant/coil.h"

const char *const vs_energy_names[VS_ENERGIES] = {
#define VS_ENERGY_NAME(id, name, text) name,
    VS_ENERGY_LIST(VS_ENERGY_NAME)
#undef VS_ENERGY_NAME
};

const char *const vs_energy_balance_names[VS_BALANCES] = {
#define VS_BALANCE_NAME(id, name, text) name,
    VS_BALANCE_LIST(VS_BALANCE_NAME)
#undef VS_BALANCE_NAME
};
static const char *const BALANCE_TEXTS[VS_BALANCES] = {
#define VS_BALANCE_TEXT(id, name, text) text,
    VS_BALANCE_LIST(VS_BALANCE_TEXT)
#undef VS_BALANCE_TEXT
};

/* Gauss-Legendre rules on [0,1] (Abramowitz & Stegun, table 25.4). Five points are exact to degree
 * 9, which the product of two quintics nearly is. Two points are exact to degree 3, which the step
 * of a second-order circuit needs. */
static const struct {
  int count;
  double at[5], weight[5];
} GAUSS[2] = {
    {2, {0.21132486540518712, 0.78867513459481288}, {0.5, 0.5}},
    {5,
     {0.04691007703066800, 0.23076534494715845, 0.5, 0.76923465505284155, 0.95308992296933200},
     {0.11846344252809454, 0.23931433524968324, 0.28444444444444444, 0.23931433524968324,
      0.11846344252809454}},
};

bool vs_energy_has(const vs_model *model, int term) {
  if (term == VS_E_LOAD) return model->reloaded;
  if (term == VS_E_EDDY) return model->coil.eddies;
  return term != VS_E_TRANSDUCER || model->coil.law->transducer_w;
}

static double magnetic(const vs_frame *frame, const vs_knot *k) {
  const vs_model *m = frame->model;
  double j = vs_coil_energy(&m->coil, k->flux_wb,
                            frame->gap_at_rest ? m->coil.gap_rest_m : vs_mechanics_gap(m, k->x));
  for (int n = 0; n < m->coil.rungs; n++) {
    const vs_rung *r = &m->coil.rung[n];
    const double flux = k->psi_wb[n] - r->share * k->flux_wb;
    j += flux * flux * r->per_h / (2 * r->share);
  }
  return j;
}

static double mechanical(const vs_model *m, const vs_knot *k) {
  double g = vs_mechanics_travel(m, k->x);
  return vs_mechanics_kinetic_energy(m, k->x + m->dof) + vs_mechanics_elastic_energy(m, k->x) +
         vs_stops_energy(&m->stops, vs_stops_touched(&m->stops, g), g);
}

static void take_energy_model(vs_energy *e, const vs_model *m) {
  e->model = m;
  e->n_damping = 0;
  for (int i = 0; i < m->dof; i++)
    for (int j = 0; j < m->dof; j++)
      if (m->damping[i][j] != 0) {
        e->damping[e->n_damping].i = i;
        e->damping[e->n_damping].j = j;
        e->damping[e->n_damping++].b = m->damping[i][j];
      }
}

static void begin_energy(vs_energy *e, const vs_step *step) {
  const vs_deck *deck = step->frame->deck;
  e->first = *step->from;
  e->began_j = mechanical(step->frame->model, step->from);
  take_energy_model(e, step->frame->model);
  for (size_t n = 0; deck && n < deck->losses.count; n++)
    e->loss_w[n] = vs_formula_value(&deck->losses.item[n].formula, e->first.terms);
}

/* Fills what is stored, which the first and the last knot alone tell, and takes the balances. */
static void take_stock(vs_energy *e) {
  const vs_deck *deck = e->frame->deck;
  e->joule[VS_E_MAGNETIC] = magnetic(e->frame, &e->last) - magnetic(e->frame, &e->first);
  e->joule[VS_E_MECHANICAL] = mechanical(e->model, &e->last) - e->began_j;
  for (size_t n = 0; deck && n < deck->stores.count; n++) {
    double held[2];
    vs_formula_pair(&deck->stores.item[n].formula, e->first.terms, e->last.terms, held);
    e->store_j[n] = held[1] - held[0];
  }
  const double *j = e->joule;
  double *left = e->left_j;
  left[VS_B_EVA] =
      j[VS_E_PORT] - j[VS_E_COPPER] - j[VS_E_MAGNETIC] - (e->frame->gap_at_rest ? 0 : j[VS_E_WORK]);
  left[VS_B_EVA] -= j[VS_E_TRANSDUCER] + j[VS_E_EDDY];
  left[VS_B_MECHANICAL] = j[VS_E_WORK] - j[VS_E_DAMPING] - j[VS_E_STOP] - j[VS_E_MECHANICAL];
  left[VS_B_MECHANICAL] += j[VS_E_LOAD];
  left[VS_B_CIRCUIT] = j[VS_E_SOURCE] - j[VS_E_PORT];
  for (size_t k = 0; deck && k < deck->losses.count; k++) left[VS_B_CIRCUIT] -= e->loss_j[k];
  for (size_t k = 0; deck && k < deck->stores.count; k++) left[VS_B_CIRCUIT] -= e->store_j[k];
  for (int b = 0; b < VS_BALANCES; b++)
    if (fabs(left[b]) > fabs(e->furthest_j[b])) {
      e->furthest_j[b] = left[b];
      e->furthest_s[b] = e->last.t_s;
    }
}

enum { STOCK_TAKING = 32 }; /* steps between two looks at the books */
_Static_assert((int)STOCK_TAKING <= (int)VS_BATCH_STEPS, "a batch has room for them");

bool vs_energy_is_due(const vs_energy *e) {
  return e->steps % STOCK_TAKING == 0;
}

/* Integrates a loss by Simpson's rule, with the deck's terms on straight lines between the ends of
 * a step. That is exact for a voltage times a current on such lines, and off by the square of the
 * step, as the solver is. Where the circuit is periodic the trapezoidal rule adds up whole cycles
 * exactly. */
static void add_loss(vs_energy *e, size_t n, const vs_batch *b) {
  const vs_formula_prepared loss = {.formula = &e->frame->deck->losses.item[n].formula};
  vs_pair power[VS_BATCH_STEPS];
  vs_batch_evaluate(&loss, b, power);
  for (size_t k = 0; k < b->count; k++) {
    double from = e->loss_w[n], to = power[k][1];
    double mid = b->periodic[k] ? (from + to) / 2 : power[k][0];
    e->loss_j[n] += (b->t1_s[k] - b->t0_s[k]) * (from + 4 * mid + to) / 6;
    e->loss_w[n] = to;
  }
}

void vs_energy_take_losses(vs_energy *e, const vs_batch *b, bool all) {
  for (size_t n = 0; n < e->frame->deck->losses.count; n++) add_loss(e, n, b);
  if (all && vs_energy_is_due(e)) take_stock(e);
}

/* q'.B q', W. */
static double damping_power(const vs_energy *e, const double *v) {
  double lost = 0;
  for (int n = 0; n < e->n_damping; n++)
    lost += v[e->damping[n].i] * e->damping[n].b * v[e->damping[n].j];
  return lost;
}

/* Adds what the channels y at one instant bring, which stands for w seconds. */
static void add_energy_instant(vs_energy *e, const double *y, double w, bool flows) {
  const vs_model *m = e->model;
  const double *v = y + vs_channel_rates(m);
  double at = y[VS_CH_TRAVEL], g_rate = vs_mechanics_travel(m, v);
  unsigned touched = vs_stops_touched(&m->stops, at);
  e->joule[VS_E_DAMPING] += w * damping_power(e, v);
  if (touched) e->joule[VS_E_STOP] += w * vs_stops_loss(&m->stops, touched, at, g_rate);
  if (!flows) return;
  e->joule[VS_E_SOURCE] += w * y[VS_CH_V_MAINS] * y[VS_CH_I_MAINS];
  e->joule[VS_E_PORT] += w * y[VS_CH_V_EVA] * y[VS_CH_I];
  e->joule[VS_E_COPPER] += w * m->coil.resistance_ohm * y[VS_CH_I] * y[VS_CH_I];
  if (m->coil.eddies) e->joule[VS_E_EDDY] += w * y[VS_CH_EDDY];
  e->joule[VS_E_WORK] -= w * y[VS_CH_FORCE] * g_rate;
  if (m->coil.law->transducer_w)
    e->joule[VS_E_TRANSDUCER] +=
        w * m->coil.law->transducer_w(&m->coil, y[VS_CH_LAMBDA], y[VS_CH_Z], g_rate);
}

/* Into how many parts a step is cut for the sums. A stop that is not linear has corners, and
 * changes its force as the step's polynomials do not. */
static int parts_of(const vs_step *step) {
  enum { IN_A_STOP = 8 };
  const vs_model *m = step->frame->model;
  if (m->plain || !m->stops.count) return 1;
  unsigned touched = vs_stops_touched(&m->stops, vs_mechanics_travel(m, step->from->x)) |
                     vs_stops_touched(&m->stops, vs_mechanics_travel(m, step->to->x));
  return touched ? IN_A_STOP : 1;
}

/* What a step without a current and without stops changes: only what damping takes. */
static void take_free_swing(vs_energy *e, const vs_step *step) {
  double h = step->to->t_s - step->from->t_s, v[VS_MOST_DOF];
  for (int g = step->cubic_flux ? 0 : 1, k = 0; k < GAUSS[g].count; k++) {
    vs_step_velocities_at(step, step->from->t_s + h * GAUSS[g].at[k], v);
    e->joule[VS_E_DAMPING] += h * GAUSS[g].weight[k] * damping_power(e, v);
  }
}

/* True where no stop can be touched in the step: both its ends are less than half way to one. A
 * step is at most one radian of the fastest mode long, within which a travel may be 1.14 times what
 * it is at the ends. */
static bool is_far(const vs_step *step) {
  const vs_model *m = step->frame->model;
  double from = vs_mechanics_travel(m, step->from->x), to = vs_mechanics_travel(m, step->to->x);
  return !m->stops.count ||
         (vs_stops_nearness(&m->stops, from) < 0.5 && vs_stops_nearness(&m->stops, to) < 0.5);
}

static void integrate_energies(vs_energy *e, const vs_step *step, bool flows) {
  unsigned groups = VS_GROUP_VELOCITIES | (flows ? VS_GROUP_V_EVA | VS_GROUP_V_MAINS : 0);
  const int g = step->cubic_flux ? 0 : 1, parts = parts_of(step);
  double y[VS_CH_MOST];
  if (step->open) { /* no current, and so no power */
    groups = VS_GROUP_VELOCITIES;
    y[VS_CH_V_EVA] = y[VS_CH_V_MAINS] = 0;
  }
  for (int n = 0; n <= step->parts; n++) { /* currents and voltages bend from piece to piece */
    const vs_piece piece = vs_step_piece(step, n);
    const double h = (piece.to->t_s - piece.from->t_s) / parts;
    for (int part = 0; part < parts; part++)
      for (int k = 0; k < GAUSS[g].count; k++) {
        vs_step_groups_at(step, piece.from->t_s + h * part + h * GAUSS[g].at[k], groups, y);
        add_energy_instant(e, y, h * GAUSS[g].weight[k], flows);
      }
  }
}

/* Keeps of the last knot what tells the energies stored there. */
static void note_end(vs_energy *e, const vs_knot *k) {
  const vs_deck *deck = e->frame->deck;
  e->last.t_s = k->t_s;
  e->last.flux_wb = k->flux_wb;
  if (e->frame->model->coil.rungs) memcpy(e->last.psi_wb, k->psi_wb, sizeof k->psi_wb);
  memcpy(e->last.x, k->x, 2 * (size_t)e->frame->model->dof * sizeof *k->x);
  if (deck) memcpy(e->last.terms, k->terms, deck->n_terms * sizeof *k->terms);
}

void vs_energy_accept(vs_energy *e, const vs_step *step) {
  const vs_model *m = step->frame->model;
  bool flows = !(step->frame->source_is_coil && vs_step_is_quiet(step));
  if (!e->steps++) begin_energy(e, step);

  /* Jumps of what the machine stores: a load that changes (q and q' go on, M jumps), and an
   * armature that jams, in a step of no length, whose kinetic energy the stop takes. */
  if (m != e->model) {
    e->joule[VS_E_LOAD] += mechanical(m, step->to) - mechanical(e->model, step->from);
    take_energy_model(e, m);
  } else if (step->to->t_s == step->from->t_s)
    e->joule[VS_E_STOP] += mechanical(m, step->from) - mechanical(m, step->to);

  /* The integrals over the step. The tier itself tells what damping takes of a swing that it goes
   * along in one step. */
  if (step->glides)
    e->joule[VS_E_DAMPING] += step->lost_j;
  else if (flows || !is_far(step))
    integrate_energies(e, step, flows);
  else
    take_free_swing(e, step);

  /* With a deck the balances wait for its losses (vs_energy_take_losses). */
  note_end(e, step->to);
  if (!step->frame->deck && vs_energy_is_due(e)) take_stock(e);
}

/* The residual's scale is at least this share of what was drawn. Where the machine hardly moves
 * (not fired, or at 1 Hz), what is left over would else be told as a multiple of next to nothing. A
 * machine that is driven takes 9 to 25 % of what is drawn. */
static const double LEAST_SHARE = 0.01;

/* What moves the machine besides the actuator, J: what it had at the first knot, and what damping
 * took where a constant force feeds it. */
static double other_work(const vs_energy *e) {
  const vs_model *m = e->frame->model;
  double most = fmax(fabs(e->began_j), fabs(e->joule[VS_E_LOAD]));
  for (int i = 0; i < m->dof; i++)
    if (m->constant[i] != 0) most = fmax(most, fabs(e->joule[VS_E_DAMPING]));
  return most;
}

void vs_energy_finish(vs_energy *e) {
  const vs_deck *deck = e->frame->deck;
  take_stock(e);
  double scale = fmax(fabs(e->joule[VS_E_WORK]), LEAST_SHARE * fabs(e->joule[VS_E_SOURCE]));
  if (scale == 0)
    scale = 1;
  else
    scale = fmax(scale, other_work(e));
  for (int b = 0; b < VS_BALANCES; b++) {
    e->balanced[b] = b != VS_B_CIRCUIT || !deck || deck->losses.count || deck->stores.count;
    e->residual[b] = e->left_j[b] / scale;
    if (e->balanced[b]) e->worst = fmax(e->worst, fabs(e->residual[b]));
  }
}

void vs_energy_round_off(vs_energy *e) {
  const vs_deck *deck = e->frame->deck;
  double whole = 0;
  for (int k = 0; k < VS_ENERGIES; k++) whole = fmax(whole, fabs(e->joule[k]));
  for (int k = 0; k < VS_ENERGIES; k++) e->joule[k] = vs_extreme_told(e->joule[k], whole);
  for (size_t k = 0; deck && k < deck->losses.count; k++)
    e->loss_j[k] = vs_extreme_told(e->loss_j[k], whole);
  for (size_t k = 0; deck && k < deck->stores.count; k++)
    e->store_j[k] = vs_extreme_told(e->store_j[k], whole);
  for (int b = 0; b < VS_BALANCES; b++) e->residual[b] = vs_extreme_told(e->residual[b], 1);
  e->worst = vs_extreme_told(e->worst, 1);
}

double vs_energy_whole(const vs_energy *e) {
  double moved = fmax(fabs(e->joule[VS_E_DAMPING]), fabs(e->began_j));
  moved = fmax(moved, fabs(e->joule[VS_E_LOAD]));
  /* a deck without a port mains feeds the coil from sources of its own */
  if (e->joule[VS_E_SOURCE] == 0) moved = fmax(moved, fabs(e->joule[VS_E_PORT]));
  return fmax(fmax(fabs(e->joule[VS_E_WORK]), fabs(e->joule[VS_E_SOURCE])), moved);
}

/* What stands in a balance besides, where the machine has it. */
static const char *besides(const vs_model *m, int b) {
  if (b == VS_B_EVA && vs_energy_has(m, VS_E_EDDY)) return " - eddy";
  if (b == VS_B_EVA && vs_energy_has(m, VS_E_TRANSDUCER)) return " - transducer";
  return b == VS_B_MECHANICAL && vs_energy_has(m, VS_E_LOAD) ? " + load" : "";
}

const char *vs_energy_open(const vs_energy *e, double tolerance, char *buffer, size_t size) {
  double whole = vs_energy_whole(e);
  for (int b = 0; b < VS_BALANCES; b++) {
    if (!e->balanced[b] || !(fabs(e->furthest_j[b]) > VS_ENERGY_ALLOWED * tolerance * whole))
      continue;
    snprintf(buffer, size,
             "the energy books do not close (%s): %s%s leaves %.3g J of %.3g J at %.6g s%s",
             vs_energy_balance_names[b], BALANCE_TEXTS[b], besides(e->frame->model, b),
             e->furthest_j[b], whole, e->furthest_s[b],
             b == VS_B_CIRCUIT ? "; is a loss or store line of the deck missing or wrong?" : "");
    return buffer;
  }
  return NULL;
}
