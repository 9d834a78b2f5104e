/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/linear.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "measure/chebyshev.h"
#include "orbit/grazing.h"
#include "orbit/linear_signal.h"
#include "orbit/steady.h"
#include "orbit/variation.h"
#include "run/session.h"

/* ---- columns of the state, and of signals behind low-passes ---- */

/* What a change of the state at a run's beginning, or a delay of its firing, makes of the state and
 * of signals on the way: the columns of orbit/variation.h, and beside them the states of low-passes
 * through which signals are seen.
 *
 * The columns of x are the machine's, q then q', and behind them those of each low-pass, whose
 * signals' number and order are the caller's. A low-pass goes along exact polynomials of each
 * column's signal. */

/* What becomes of one low-pass: by the machine's columns, the delay's, then its own states. */
typedef struct column_filter {
  const vs_linear_signal *seen; /* borrowed */
  int first;                    /* of its states in x */
  vs_lowpass column[VS_VARIATION_MOST + 1 + 2];
  double nodes[VS_VARIATION_MOST]
              [VS_LOWPASS_TERMS]; /* the columns' signals in one part of a step */
} column_filter;

/* Begin with columns_begin, end with columns_end. */
typedef struct state_columns {
  int n;       /* states in x */
  int machine; /* of these the machine's own */
  vs_variation variation;
  double rates[VS_VARIATION_MOST * (VS_VARIATION_MOST + 1)]; /* of its columns */
  column_filter filter[VS_LINEAR_FILTERED];
  int filters;
  double t_s; /* how far they have come */
} state_columns;

enum { NODES = VS_LOWPASS_TERMS };

/* The run begins at the start of the setup, which must outlive this; it has a valve. */
static void columns_begin(state_columns *c, const vs_setup *setup) {
  *c = (state_columns){.n = 2 * setup->model.dof, .machine = 2 * setup->model.dof};
  vs_variation_begin(&c->variation, setup);
  vs_variation_add_delay(&c->variation);
}

static void columns_end(state_columns *c) {
  vs_variation_end(&c->variation);
}

/* The machine's columns, and the delay's as the last. */
static int driven_columns(const state_columns *c) {
  return c->machine + 1;
}

/* Adds the states of a signal's low-pass. Returns the first one's place in x, -1 where the signal
 * has none. To be called before the first step. The signal must outlive this. */
static int columns_add(state_columns *c, const vs_linear_signal *seen) {
  if (!seen->states) return -1;
  column_filter *f = &c->filter[c->filters++];
  *f = (column_filter){.seen = seen, .first = c->n};
  for (int j = 0; j < driven_columns(c) + 2; j++) {
    f->column[j] = seen->lowpass;
    memset(f->column[j].x, 0, sizeof f->column[j].x);
  }
  for (int k = 0; k < seen->states; k++) f->column[driven_columns(c) + k].x[k] = 1;
  c->n += seen->states;
  return f->first;
}

/* What the variation's column j makes of a signal. The rates are there already. */
static double signal_of(state_columns *c, const vs_linear_signal *seen, int j) {
  int dof = c->variation.model->dof;
  double sum = 0;
  for (int i = 0; i < 2 * dof; i++) sum += seen->k[i] * vs_variation_get(&c->variation, i, j);
  for (int i = 0; i < dof; i++)
    sum += seen->k[2 * dof + i] * c->rates[j * c->variation.rows + dof + i];
  return sum;
}

/* The same of a signal that is not seen through a low-pass, at an instant of this step. */
static double columns_signal(state_columns *c, const vs_step *step, const vs_linear_signal *seen,
                             int j) {
  if (j >= c->machine && j < c->n) return 0; /* a low-pass moves nothing */
  vs_variation_rates(&c->variation, step, c->rates);
  return signal_of(c, seen, j < c->n ? j : c->machine);
}

/* What column j makes of state i at the instant that was come to; j = n: what a delay of the firing
 * does, per second. */
static double columns_state(state_columns *c, int i, int j) {
  bool own = j >= c->machine && j < c->n; /* of a low-pass */
  int column = j < c->n ? j : c->machine; /* of the variation */
  if (i < c->machine) return own ? 0 : vs_variation_get(&c->variation, i, column);
  for (int k = 0; k < c->filters; k++) {
    const column_filter *f = &c->filter[k];
    int row = i - f->first, theirs = j - f->first, states = f->seen->states;
    if (row < 0 || row >= states) continue;
    if (!own) return f->column[column].x[row];
    return theirs >= 0 && theirs < states ? f->column[driven_columns(c) + theirs].x[row] : 0;
  }
  return 0;
}

static void take_filter_node(state_columns *c, const vs_step *step, int node) {
  vs_variation_rates(&c->variation, step, c->rates);
  for (int k = 0; k < c->filters; k++) {
    column_filter *f = &c->filter[k];
    for (int j = 0; j < driven_columns(c); j++) f->nodes[j][node] = signal_of(c, f->seen, j);
  }
}

static void advance_lowpasses(column_filter *f, int columns, double h_s) {
  const double none[NODES] = {0};
  double u[NODES];
  for (int j = 0; j < columns; j++) {
    const vs_chebyshev chunk = vs_chebyshev_through(f->nodes[j]);
    vs_chebyshev_powers(&chunk, u);
    vs_lowpass_advance(&f->column[j], h_s, u);
  }
  for (int k = 0; k < 2; k++) vs_lowpass_advance(&f->column[columns + k], h_s, none);
}

/* Goes on to an instant within the step that is to be accepted next, not further than a part of it
 * (vs_linear_signal_parts). Errors: as of vs_variation_accept. */
static vs_status columns_to(state_columns *c, const vs_step *step, double t_s, vs_error *err) {
  double from_s = c->t_s;
  vs_status status = VS_OK;
  if (!(t_s > from_s)) return VS_OK;
  for (int node = c->filters ? NODES - 1 : 0; node >= 0 && !status; node--) {
    status = vs_variation_to(&c->variation, step, vs_chebyshev_instant(node, from_s, t_s), err);
    if (c->filters && !status) take_filter_node(c, step, node);
  }
  for (int k = 0; k < c->filters && !status; k++)
    advance_lowpasses(&c->filter[k], driven_columns(c), t_s - from_s);
  c->t_s = t_s;
  return status;
}

/* Accepts the step, to whose end they have come. */
static vs_status columns_accept(state_columns *c, const vs_step *step, vs_error *err) {
  return vs_variation_accept(&c->variation, step, err);
}

enum { N = VS_LINEAR_STATES };

/* ---- the rows on the way ---- */

/* An instant at which rows are taken. */
typedef struct mark {
  double t_s;
  int output;   /* whose turn this is; -1: the firing */
  double share; /* of the turn in the amplitude: 1/2 or -1/2 */
  bool taken;
} mark;

typedef struct walk {
  vs_linear *out;
  state_columns columns;
  mark marks[2 * VS_LINEAR_OUTPUTS + 1];
  int n_marks;
  double per_rad; /* delay of the firing, s/rad */
} walk;

/* What column j of x, or the delay's, makes of an output. */
static double output_of(walk *w, const vs_step *step, const vs_linear_output *o, int j) {
  return o->first >= 0 ? columns_state(&w->columns, o->first, j)
                       : columns_signal(&w->columns, step, &o->seen, j);
}

static void take_mark(walk *w, const mark *m, const vs_step *step) {
  vs_linear *l = w->out;
  for (int i = 0; m->output < 0 && i < l->n; i++)
    for (int j = 0; j < l->n; j++) l->to_firing[i][j] = columns_state(&w->columns, i, j);
  if (m->output < 0) return;
  const vs_linear_output *o = &l->output[m->output];
  for (int j = 0; j < l->n; j++) l->c[m->output][j] += m->share * output_of(w, step, o, j);
  l->d[m->output] += m->share * output_of(w, step, o, l->n) * w->per_rad;
}

/* The first mark that is not taken, up to an instant; NULL: there is none. */
static mark *mark_until(walk *w, double to_s) {
  mark *first = NULL;
  for (int k = 0; k < w->n_marks; k++) {
    mark *m = &w->marks[k];
    if (!m->taken && m->t_s <= to_s && (!first || m->t_s < first->t_s)) first = m;
  }
  return first;
}

static vs_status go_marks(walk *w, const vs_step *step, double to_s, vs_error *err) {
  vs_status status = VS_OK;
  for (mark *m; !status && (m = mark_until(w, to_s));) {
    status = columns_to(&w->columns, step, m->t_s, err);
    if (!status) take_mark(w, m, step);
    m->taken = true;
  }
  return status ? status : columns_to(&w->columns, step, to_s, err);
}

static vs_status accept_walk(void *ctx, const vs_step *step, const vs_result *result,
                             vs_error *err) {
  walk *w = ctx;
  double from_s = step->from->t_s, h_s = step->to->t_s - from_s;
  int parts = h_s > 0 ? vs_linear_signal_parts(step) : 0;
  vs_status status = VS_OK;
  (void)result;
  for (int n = 1; n <= parts && !status; n++)
    status = go_marks(w, step, n < parts ? from_s + n * (h_s / parts) : step->to->t_s, err);
  return status ? status : columns_accept(&w->columns, step, err);
}

/* ---- along the orbit ---- */

/* The run that shows one period to the outputs' signals. */
typedef struct look {
  vs_linear *out;
  int firings;
} look;

static void look_at_firing(vs_linear *l, const vs_step *step) {
  l->fires_s = step->to->t_s;
  memcpy(l->x_firing, step->to->x, (size_t)l->machine * sizeof *l->x_firing);
  for (int k = 0; k < l->outputs; k++) {
    const vs_linear_output *o = &l->output[k];
    for (int i = 0; i < o->seen.states; i++) l->x_firing[o->first + i] = o->seen.lowpass.x[i];
  }
}

static void look_at_event(vs_linear *out, const vs_step *step, int *firings) {
  for (int k = 0; k < 2; k++) {
    if (step->event[k] == VS_EV_FIRES && !(*firings)++) look_at_firing(out, step);
    if (step->event[k] == VS_EV_EXTINCT) out->extinct_s = step->event_s[k];
    if (step->event[k] == VS_EV_MEETS_STOP) out->contacts++;
  }
}

static vs_status accept_look(void *ctx, const vs_step *step, const vs_result *result,
                             vs_error *err) {
  look *l = ctx;
  (void)result, (void)err;
  vs_linear_look(l->out, step, &l->firings);
  return VS_OK;
}

void vs_linear_look(vs_linear *out, const vs_step *step, int *firings) {
  const vs_stops *stops = &step->frame->model->stops;
  look_at_event(out, step, firings);
  if (!(step->to->t_s > step->from->t_s)) return;
  for (int k = 0; k < out->outputs; k++) vs_linear_signal_accept(&out->output[k].seen, step);
  for (int k = 0; k < stops->count; k++) {
    double depth = fabs(vs_grazing_depth(step, &stops->item[k]));
    if (!(depth < out->grazing_m) && !(isnan(out->grazing_m) && !isnan(depth))) continue;
    out->grazing_m = depth;
    out->grazing_s = step->to->t_s;
  }
}

/* Runs one period of the orbit. */
static vs_status run_period(const vs_scene *scene, const vs_setup *setup,
                            const vs_session_listener *guest, vs_error *err) {
  const vs_session session = {.guest = guest, .bare = true, .unguarded = true};
  vs_scene *own = vs_alloc(1, sizeof *own);
  vs_result *none = vs_alloc(1, sizeof *none);
  *own = *scene;
  own->setup = *setup;
  own->control.regulator = NULL; /* the orbit is that of one angle */
  own->frame = vs_sim_frame(scene->tier, &own->setup);
  vs_status status = vs_session_run(&session, own, none, err);
  vs_result_free(none);
  free(none);
  free(own);
  return status;
}

static vs_status look_twice(const vs_scene *scene, const vs_setup *setup, vs_linear *l,
                            vs_error *err) {
  look seen = {l, 0};
  const vs_session_listener guest = {.ctx = &seen, .accept = accept_look};
  vs_status status = run_period(scene, setup, &guest, err);
  for (int k = 0; k < l->outputs; k++) vs_linear_signal_close(&l->output[k].seen, l->period_s);
  l->contacts = seen.firings = 0;
  if (!status) status = run_period(scene, setup, &guest, err);
  if (status) return status;
  if (seen.firings != 1)
    return vs_fail(
        err, VS_RUN,
        "the thyristor fires %d times in a period of the orbit: a linear model goes from "
        "the angle of the one firing; a shorter firing.pulse_width keeps it to one",
        seen.firings);
  double asked_s = l->angle_rad / setup->timeline.omega_rad_s;
  if (!(fabs(l->fires_s - asked_s) <= 1e-9 * l->period_s))
    return vs_fail(err, VS_RUN,
                   "the thyristor fires at %.9g s of the cycle and not at its angle, %.9g s: the "
                   "motion does not hang on the angle",
                   l->fires_s, asked_s);
  return VS_OK;
}

/* ---- the model ---- */

static void name_states(vs_linear *l, const vs_model *m, const vs_orbit *orbit) {
  for (int i = 0; i < m->dof; i++) {
    const vs_coordinate *c = &m->machine->coordinates[i];
    vs_linear_name *q = &l->state[i], *rate = &l->state[m->dof + i];
    snprintf(q->name, sizeof q->name, "%s", c->name);
    snprintf(q->unit, sizeof q->unit, "%s", c->unit);
    snprintf(rate->name, sizeof rate->name, "%s", c->rate);
    snprintf(rate->unit, sizeof rate->unit, "%s", c->rate_unit);
  }
  l->n = l->machine = 2 * m->dof;
  memcpy(l->x, orbit->x, (size_t)l->n * sizeof *l->x);
  memcpy(l->scale, orbit->scale, (size_t)l->n * sizeof *l->scale);
}

/* The states of an output's low-pass join x. */
static void add_filter(vs_linear *l, vs_linear_output *o) {
  char name[200];
  snprintf(name, sizeof name, "%.190s", o->seen.order.name);
  o->first = o->seen.states ? l->n : -1;
  for (int k = 0; k < o->seen.states; k++) {
    vs_linear_name *s = &l->state[l->n++];
    snprintf(s->name, sizeof s->name, "%s%s", name, k ? "_lag" : "");
    snprintf(s->unit, sizeof s->unit, "%s", o->seen.unit);
  }
}

static vs_status add_outputs(const vs_frame *frame, const vs_linear_signal_order *signals,
                             int count, vs_linear *l, vs_error *err) {
  vs_status status = VS_OK;
  int filters = 0;
  for (int k = 0; k < count && k < VS_LINEAR_OUTPUTS && !status; k++) {
    vs_linear_output *o = &l->output[l->outputs++];
    status = vs_linear_signal_begin(&o->seen, frame, &signals[k], err);
    filters += o->seen.states > 0;
    if (!status && filters <= VS_LINEAR_FILTERED) add_filter(l, o);
  }
  if (status || (count <= VS_LINEAR_OUTPUTS && filters <= VS_LINEAR_FILTERED)) return status;
  return vs_fail(err, VS_INPUT, "a linear model has at most %d outputs, %d of them with a low-pass",
                 (int)VS_LINEAR_OUTPUTS, (int)VS_LINEAR_FILTERED);
}

static vs_status begin_walk(walk *w, const vs_setup *setup, vs_error *err) {
  vs_linear *l = w->out;
  w->per_rad = 1 / setup->timeline.omega_rad_s;
  columns_begin(&w->columns, setup);
  w->marks[w->n_marks++] = (mark){.t_s = l->fires_s, .output = -1};
  for (int k = 0; k < l->outputs; k++) {
    const vs_linear_output *o = &l->output[k];
    double amplitude = vs_linear_signal_amplitude(&o->seen);
    if (!(amplitude > 0))
      return vs_fail(err, VS_RUN,
                     "%s does not move on the orbit, so that its amplitude has no slope",
                     o->seen.order.name);
    for (int side = 0; side < 2; side++)
      w->marks[w->n_marks++] = (mark){o->seen.best[side].at_s, k, side ? -0.5 : 0.5, false};
    columns_add(&w->columns, &o->seen);
    for (int i = 0; i < o->seen.states; i++) {
      l->x[o->first + i] = o->seen.start[i];
      l->scale[o->first + i] = amplitude;
    }
  }
  return VS_OK;
}

static vs_status walk_along(const vs_scene *scene, const vs_setup *setup, vs_linear *l,
                            vs_error *err) {
  walk *w = vs_alloc(1, sizeof *w);
  w->out = l;
  const vs_session_listener guest = {.ctx = w, .accept = accept_walk};
  vs_status status = begin_walk(w, setup, err);
  if (!status) status = run_period(scene, setup, &guest, err);
  for (int i = 0; i < l->n && !status; i++) {
    for (int j = 0; j < l->n; j++) l->a[i][j] = columns_state(&w->columns, i, j);
    l->b[i] = columns_state(&w->columns, i, l->n) * w->per_rad;
  }
  columns_end(&w->columns);
  free(w);
  return status;
}

/* ---- the other section ---- */

/* A fast low-pass has forgotten at the firing what it was at the section, exp(-740) being 0. There
 * is no way back then. */
static void leave_section_out(vs_linear *l) {
  for (int j = 0; j < l->n; j++) {
    l->b_firing[j] = NAN;
    for (int i = 0; i < l->n; i++) l->a_firing[i][j] = NAN;
    for (int i = 0; i < l->outputs; i++) l->c_firing[i][j] = NAN;
  }
}

/* x_f = T x, so that x_f[k+1] = T A T^-1 x_f[k] + T B a[k], y = C T^-1 x_f[k] + D a[k]. */
static vs_status move_section(vs_linear *l, vs_error *err) {
  size_t n = (size_t)l->n, order[N];
  double *t = vs_alloc(n * n, sizeof *t), *inverse = vs_alloc(n * n, sizeof *inverse);
  double *ta = vs_alloc(n * n, sizeof *ta);
  int sign;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) t[i * n + j] = l->to_firing[i][j];
  gsl_matrix_view of = gsl_matrix_view_array(t, n, n), to = gsl_matrix_view_array(inverse, n, n);
  gsl_permutation p = {n, order};
  bool good = !gsl_linalg_LU_decomp(&of.matrix, &p, &sign) &&
              !gsl_linalg_LU_invert(&of.matrix, &p, &to.matrix);
  for (size_t i = 0; i < n && good; i++) {
    for (size_t j = 0; j < n; j++) {
      l->b_firing[i] += l->to_firing[i][j] * l->b[j];
      for (size_t k = 0; k < n; k++) ta[i * n + j] += l->to_firing[i][k] * l->a[k][j];
    }
  }
  for (size_t i = 0; i < n && good; i++)
    for (size_t j = 0; j < n; j++)
      for (size_t k = 0; k < n; k++) l->a_firing[i][j] += ta[i * n + k] * inverse[k * n + j];
  for (int i = 0; i < l->outputs && good; i++)
    for (size_t j = 0; j < n; j++)
      for (size_t k = 0; k < n; k++) l->c_firing[i][j] += l->c[i][k] * inverse[k * n + j];
  free(ta);
  free(inverse);
  free(t);
  if (good) return VS_OK;
  if (l->n == l->machine)
    return vs_fail(err, VS_RUN, "the free flight up to the firing cannot be turned back");
  leave_section_out(l);
  return VS_OK;
}

/* ---- the gain ---- */

vs_status vs_linear_gain(const vs_linear *l, double gain[VS_LINEAR_OUTPUTS], vs_error *err) {
  size_t n = (size_t)l->n, order[N];
  double matrix[N * N], side[N], x[N];
  int sign;
  for (size_t i = 0; i < n; i++) {
    side[i] = l->b[i] / l->scale[i];
    for (size_t j = 0; j < n; j++)
      matrix[i * n + j] = (i == j) - l->a[i][j] * l->scale[j] / l->scale[i];
  }
  gsl_matrix_view of = gsl_matrix_view_array(matrix, n, n);
  gsl_vector_view b = gsl_vector_view_array(side, n), by = gsl_vector_view_array(x, n);
  gsl_permutation p = {n, order};
  if (gsl_linalg_LU_decomp(&of.matrix, &p, &sign) ||
      gsl_linalg_LU_solve(&of.matrix, &p, &b.vector, &by.vector))
    return vs_fail(err, VS_RUN, "a multiplier of the orbit is 1, so that there is no gain");
  for (int k = 0; k < l->outputs; k++) {
    gain[k] = l->d[k];
    for (size_t i = 0; i < n; i++) gain[k] += l->c[k][i] * l->scale[i] * x[i];
  }
  return VS_OK;
}

/* ---- all of it ---- */

vs_status vs_linear_check(const vs_scene *scene, int periods, vs_error *err) {
  if (scene->tier->by_ngspice)
    return vs_fail_at(
        err, vs_tree_place(scene->tree.root, "run.tier"),
        "--linear: the circuit's equations are its solver's own, and are not linearised; "
        "tier %s has a linear model, and tier compiled one with this circuit",
        vs_tiers_automatic(false)->name);
  if (scene->setup.timeline.firing.no_valve)
    return vs_fail_at(err, vs_tree_place(scene->tree.root, "firing.valve"),
                      "--linear: firing.valve is none, so that there is no firing angle; write "
                      "firing.valve: thyristor");
  if (scene->setup.model.coil.eddies)
    return vs_fail_at(err, vs_tree_place(scene->tree.root, "actuator.eddy"),
                      "--linear: eddy currents keep a flux behind the firing, for which no linear "
                      "model is made; write actuator.eddy: none");
  if (periods != 1)
    return vs_fail(
        err, VS_INPUT,
        "--linear: an orbit of %d firing periods has a map for each of its firings, which "
        "is not made; --period 1 has one",
        periods);
  return VS_OK;
}

/* The coordinates, and the travel where no coordinate is the same. Returns how many there are. */
static int usual_signals(const vs_frame *frame, vs_linear_signal_order *signals) {
  const vs_model *m = frame->model;
  int count = m->dof + (m->alone ? 0 : 1);
  for (int k = 0; k < count; k++) {
    int channel = k < m->dof ? VS_CH_Q + k : VS_CH_TRAVEL;
    signals[k] = (vs_linear_signal_order){.channel = channel, .bandwidth_hz = NAN};
    snprintf(signals[k].name, sizeof signals[k].name, "%s", vs_channel_at(frame, channel).name);
  }
  return count;
}

int vs_linear_travel(const vs_linear *l, const vs_model *m) {
  int channel = m->alone ? VS_CH_Q + m->alone - 1 : VS_CH_TRAVEL;
  for (int k = 0; k < l->outputs; k++)
    if (l->output[k].first < 0 && l->output[k].seen.order.channel == channel) return k;
  return -1;
}

vs_status vs_linear_begin(const vs_scene *scene, const vs_setup *setup, const vs_orbit *orbit,
                          const vs_linear_signal_order *signals, int count, vs_linear *l,
                          vs_error *err) {
  vs_linear_signal_order *usual = vs_alloc(VS_LINEAR_OUTPUTS, sizeof *usual);
  *l = (vs_linear){.grazing_m = NAN, .grazing_s = NAN, .fires_s = NAN, .extinct_s = NAN};
  l->angle_rad = setup->timeline.firing.angle.first;
  l->period_s = orbit->period_s;
  l->stable = orbit->stable;
  vs_status status = vs_linear_check(scene, orbit->n, err);
  if (!status) name_states(l, &setup->model, orbit);
  if (!signals) count = usual_signals(&scene->frame, usual);
  if (!status) status = add_outputs(&scene->frame, signals ? signals : usual, count, l, err);
  free(usual);
  return status;
}

vs_status vs_linear_find(const vs_scene *scene, const vs_orbit *orbit,
                         const vs_linear_signal_order *signals, int count, vs_linear *l,
                         vs_error *err) {
  vs_run_values run = scene->setup.run;
  run.until_s = orbit->period_s;
  run.tolerance = scene->tier->finest;
  const vs_setup setup = vs_steady_setup(scene, &run, orbit);
  vs_status status = vs_linear_begin(scene, &setup, orbit, signals, count, l, err);
  if (!status) status = look_twice(scene, &setup, l, err);
  if (!status) status = walk_along(scene, &setup, l, err);
  if (!status) status = move_section(l, err);
  return status;
}
