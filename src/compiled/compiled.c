/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "compiled/compiled.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "rodas.h"

/* A run under way. */
typedef struct compiled {
  const vs_circuit_job *job;
  const vs_circuit_host *host;
  vs_equations e;
  vs_rodas r;
  int *signal;          /* the unknown of each of the job's signals; owned */
  double *shown;        /* their values, as accept() is given them; owned */
  double *most;         /* of each signal so far, its size; owned */
  double *peak;         /* of each unknown so far; owned */
  bool *counts;         /* of each unknown: its error counts; owned */
  double *of_tolerance; /* of each unknown; owned */
  double *small;        /* of each unknown, what is none; owned */
  double *of_peak;      /* of each unknown: that part of its peak; owned */
  double from_s;        /* where the stretch began whose tries are counted */
  long tries;
  double *charge;  /* M y where a restart begins; owned */
  double *between; /* a state within a step; owned */
} compiled;

/* ---- sources ---- */

static void drive(void *ctx, double t_s, double *value) {
  const compiled *c = ctx;
  for (int k = 0; k < c->e.sources; k++) {
    const vs_source *s = &c->e.source[k];
    bool same = k && s[-1].port == s->port && s->port >= 0;
    value[k] = s->port < 0 ? s->constant
               : same      ? value[k - 1]
                           : c->host->source(c->host->ctx, (size_t)s->port, t_s);
  }
}

/* ---- shown ---- */

static double signal_at(const compiled *c, size_t k, double part) {
  const int u = c->signal[k];
  return u < 0 ? 0 : part == 1 ? c->r.next[u] : vs_rodas_dense_of(&c->r, u, part);
}

/* Shows what holds at a part of the step of h that was tried. */
static vs_status show(compiled *c, double h, double part, vs_error *err) {
  for (size_t k = 0; k < c->job->n_signals; k++) {
    c->shown[k] = c->signal[k] == -2 ? NAN : signal_at(c, k, part);
    c->most[k] = fmax(c->most[k], fabs(c->shown[k]));
  }
  return c->host->accept(c->host->ctx, c->r.t_s + part * h, c->shown, err);
}

/* The host takes signals for straight lines between what it is shown. A step is shown in so many
 * parts that this leaves CHORD of the tolerance of each signal's peak. */
static const double CHORD = 1;
enum { MOST_PARTS = 100 };

static int parts_of(const compiled *c) {
  double most = 1;
  for (size_t k = 0; k < c->job->n_signals; k++) {
    if (c->signal[k] < 0) continue;
    const double from = c->r.y[c->signal[k]], to = c->r.next[c->signal[k]];
    const double off = fabs(signal_at(c, k, 0.5) - (from + to) / 2);
    const double peak = fmax(c->most[k], fmax(fabs(from), fabs(to)));
    if (off > 0) most = fmax(most, off / (CHORD * c->job->tolerance * peak));
  }
  return (int)fmin(ceil(sqrt(most)), MOST_PARTS);
}

static vs_status show_step(compiled *c, double h, vs_error *err) {
  const int parts = parts_of(c);
  vs_status status = VS_OK;
  for (int k = 1; k <= parts && !status; k++)
    status = show(c, h, k == parts ? 1 : (double)k / parts, err);
  return status;
}

/* ---- the error of a step ---- */

/* An error is measured by OF_TOLERANCE of the tolerance of an unknown's size, and of OF_PEAK of
 * what it has been at most. Below SMALL, V or A, it is none. */
static const double OF_TOLERANCE = 0.1, OF_PEAK = 0.1, SMALL_V = 1, SMALL_M = 1e-5, OF_SHOWN = 0.1,
                    NO_MEMORY = 10;

static double error_of(const compiled *c) {
  double most = 0;
  for (int k = 0; k < c->e.n; k++) {
    if (!c->counts[k]) continue;
    const double size = fmax(fabs(c->r.y[k]), fabs(c->r.next[k]));
    const double scale = size + c->of_peak[k] * c->peak[k] + c->small[k];
    const double off = fabs(c->r.error[k]) / (c->of_tolerance[k] * scale);
    most = isfinite(off) ? fmax(most, off) : INFINITY;
  }
  return most / c->job->tolerance;
}

static void take_peaks(compiled *c) {
  for (int k = 0; k < c->e.n; k++) c->peak[k] = fmax(c->peak[k], fabs(c->r.y[k]));
}

/* ---- branches ---- */

static bool asks_at(compiled *c, double part) {
  vs_rodas_dense(&c->r, part, c->between);
  return vs_equations_choose(&c->e, c->between, true);
}

/* The part of the step at which a branch or a switch first wants to be another; 2: none does. */
static double changes_at(compiled *c) {
  double lo = 0, hi = asks_at(c, 0.5) ? 0.5 : 1;
  if (hi == 1 && !vs_equations_choose(&c->e, c->r.next, true)) return 2;
  if (hi == 1) lo = 0.5;
  while (hi - lo > 1e-9) {
    const double mid = (lo + hi) / 2;
    if (asks_at(c, mid))
      hi = mid;
    else
      lo = mid;
  }
  return hi;
}

/* Takes the branches and switches that the last state asks for. Returns whether the equations jump
 * by that: by more than JUMPS, A or V. Most branches of expressions are two formulas for one curve.
 */
static const double JUMPS = 1e-7;

static bool choose(compiled *c) {
  double *f0 = c->r.k[0], *f1 = c->r.k[1], most = 0;
  drive(c, c->r.t_s, c->r.source[0]);
  vs_equations_value(&c->e, c->r.y, c->r.source[0], false, f0, NULL);
  vs_equations_choose(&c->e, c->r.y, false);
  vs_equations_value(&c->e, c->r.y, c->r.source[0], false, f1, NULL);
  for (int k = 0; k < c->e.n; k++) most = fmax(most, fabs(f1[k] - f0[k]));
  return most > JUMPS;
}

/* ---- a run ---- */

/* Behind a jump a step of the backward Euler rule has RESTART_S, and the first one of RODAS'
 * FIRST_S at most. What is shorter than LEAST_S makes no progress. */
static const double RESTART_S = 1e-11, FIRST_S = 2e-8, LEAST_S = 1e-13;
enum { CHANGES = 100 };

static vs_status give_up(const compiled *c, const char *what, vs_error *err) {
  const double t_s = c->host->clock ? c->host->clock(c->host->ctx, c->r.t_s) : c->r.t_s;
  vs_fail(err, VS_RUN, "t = %.9g s: tier compiled: %s", t_s, what);
  err->gave_up = true;
  return VS_RUN;
}

/* Goes on behind a jump: branches and switches are those that the state behind it asks for. */
static long n_stuck, n_try, n_acc, n_rest, n_cut;
static vs_status restart(compiled *c, double *charge, vs_error *err) {
  if (c->e.states) /* what happened may have moved or changed the machine */
    c->host->machine.state(c->host->ctx, charge + c->e.machine);
  static const double LONGER[] = {1, 10, 100, 0.1, 1000};
  n_rest++;
  for (int k = 0; k < CHANGES; k++) {
    double h = 0;
    for (size_t n = 0; n < sizeof LONGER / sizeof *LONGER && !(h > 0); n++)
      if (vs_rodas_restart(&c->r, charge, LONGER[n] * RESTART_S)) h = LONGER[n] * RESTART_S;
    if (!(h > 0)) return give_up(c, "the circuit's equations have no solution behind a jump", err);
    if (vs_equations_choose(&c->e, c->r.next, false)) continue;
    vs_status status = show(c, h, 1, err);
    vs_rodas_take(&c->r, h);
    take_peaks(c);
    return status;
  }
  return give_up(c, "a switch or a branch of an expression opens and closes without end", err);
}

/* So many tries within PROGRESS_S are no progress, as of ngspice's (ngspice/ngspice.c). */
enum { PROGRESS_TRIES = 100000 };
static const double PROGRESS_S = 1e-5;

static bool progress_made(compiled *c) {
  if (c->r.t_s - c->from_s >= PROGRESS_S) {
    c->from_s = c->r.t_s;
    c->tries = 0;
  }
  return ++c->tries < PROGRESS_TRIES;
}

/* Tries steps of at most *h until one is right, and makes *h what the next one may be. *taken: the
 * length; *jumps: a switch or branch is another behind it. */
static vs_status step(compiled *c, double *h, double *taken, bool *jumps, vs_error *err) {
  for (;;) {
    if (!(*h > LEAST_S)) { /* a restart may get past it */
      *taken = 0;
      return VS_OK;
    }
    if (c->job->tries) ++*c->job->tries;
    if (!progress_made(c)) return give_up(c, "the run makes no progress", err);
    n_try++;
    const double off = vs_rodas_try(&c->r, *h) ? error_of(c) : INFINITY;
    const double factor = isfinite(off) ? fmin(fmax(0.9 * pow(off, -0.25), 1.0 / 6), 5) : 1.0 / 6;
    *taken = *h;
    if (!(off <= 1)) {
      *h *= fmin(factor, 0.9);
      continue;
    }
    const double part = changes_at(c);
    *jumps = part <= 1;
    if (part < 1 && part * *h > RESTART_S) {
      *h *= part;
      if (!vs_rodas_try(&c->r, *h)) return give_up(c, "the equations are singular", err);
      *taken = *h;
    }
    *h *= factor;
    return VS_OK;
  }
}

static long n_try, n_acc, n_rest, n_cut;
static vs_status run(void *circuit, vs_error *err) {
  compiled *c = circuit;
  const vs_circuit_host *host = c->host;
  const double until_s = c->job->until_s;
  double h = FIRST_S, last_stuck_s = -1;
  vs_equations_choose(&c->e, c->r.y, false);
  vs_status status = restart(c, c->e.charge, err);
  while (!status && c->r.t_s < until_s - RESTART_S && !(host->enough && host->enough(host->ctx))) {
    const double t_s = c->r.t_s, edge_s = fmin(host->edge(host->ctx, t_s), until_s);
    const double left = edge_s - t_s;
    double most = fmin(fmin(host->longest(host->ctx, t_s), c->job->max_step_s), h), taken = 0;
    bool at_edge = most >= left * (1 - 1e-6), jumps = false;
    if (!at_edge && 2 * most > left) most = left / 2;
    if (at_edge) most = left;
    if (left > RESTART_S) {
      h = most;
      status = step(c, &h, &taken, &jumps, err);
      n_acc++;
      n_cut += jumps;
      if (getenv("DBG2")) {
        int w = 0;
        double best = 0;
        for (int k = 0; k < c->e.n; k++) {
          double q = c->counts[k] * fabs(c->r.error[k]) /
                     (fmax(fabs(c->r.y[k]), fabs(c->r.next[k])) + c->of_peak[k] * c->peak[k] +
                      c->small[k]) /
                     c->of_tolerance[k];
          if (q > best) best = q, w = k;
        }
        fprintf(stderr, "S %.9g %.3g %s %d %d\n", c->r.t_s, taken, c->e.name[w], parts_of(c),
                jumps);
      }
      if (!status && !(taken > 0)) {
        if (last_stuck_s == c->r.t_s - RESTART_S) return give_up(c, "no step is short enough", err);
        vs_equations_mass(&c->e, c->r.y, c->charge);
        status = restart(c, c->charge, err);
        last_stuck_s = c->r.t_s;
        n_stuck++;
        h = FIRST_S / 100;
        continue;
      }
      if (!status) status = show_step(c, taken, err);
      vs_rodas_take(&c->r, taken);
      take_peaks(c);
    }
    at_edge = c->r.t_s >= edge_s - RESTART_S;
    jumps = jumps && choose(c);
    if (status || (!jumps && !(at_edge && edge_s < until_s))) continue;
    vs_equations_mass(&c->e, c->r.y, c->charge);
    status = restart(c, c->charge, err);
    h = FIRST_S;
  }
  if (getenv("DBG"))
    fprintf(stderr, "n %d tries %ld accepted %ld restarts %ld stuck %ld cuts %ld nnz %d ops %d\n",
            c->e.n, n_try, n_acc, n_rest, n_stuck, n_cut, c->e.matrix.filled,
            c->e.matrix.eliminations);
  return status;
}

static void free_circuit(void *circuit) {
  compiled *c = circuit;
  if (!c) return;
  vs_rodas_free(&c->r);
  vs_equations_free(&c->e);
  free(c->signal);
  free(c->shown);
  free(c->most);
  free(c->peak);
  free(c->charge);
  free(c->counts);
  free(c->of_peak);
  free(c->small);
  free(c->of_tolerance);
  free(c->between);
  free(c);
}

/* Errors count of all but currents that nobody asks for: those of a voltage source beside a
 * capacitance are its slope, of which the method knows less. */
static vs_status find_signals(compiled *c, vs_error *err) {
  const vs_circuit_job *job = c->job;
  c->counts = vs_alloc((size_t)c->e.n, sizeof *c->counts);
  const double current_a = job->current_tolerance_a / job->relative_tolerance;
  c->of_tolerance = vs_alloc((size_t)c->e.n, sizeof *c->of_tolerance);
  c->small = vs_alloc((size_t)c->e.n, sizeof *c->small);
  c->of_peak = vs_alloc((size_t)c->e.n, sizeof *c->of_peak);
  for (int k = 0; k < c->e.n; k++) {
    c->counts[k] = c->e.name[k][0] != 'i';
    const bool moves = k >= c->e.machine && k < c->e.machine + c->e.states;
    c->of_peak[k] = OF_PEAK;
    c->small[k] = moves ? SMALL_M : c->e.name[k][0] == 'i' ? current_a : SMALL_V;
  }
  for (int k = 0; k < c->e.n; k++) c->of_tolerance[k] = NO_MEMORY * OF_TOLERANCE;
  for (int k = 0; k < c->e.masses; k++) {
    c->counts[c->e.mass[k].column] = true;
    c->of_tolerance[c->e.mass[k].column] = OF_TOLERANCE;
  }
  c->signal = vs_alloc(job->n_signals + 1, sizeof *c->signal);
  for (size_t k = 0; k < job->n_signals; k++) {
    c->signal[k] = vs_equations_signal(&c->e, job->signals[k]);
    if (c->signal[k] == -2 && k + job->n_wanted < job->n_signals)
      return vs_fail(err, VS_INPUT, "the netlist has no %s", job->signals[k]);
    if (c->signal[k] < 0) continue;
    c->counts[c->signal[k]] = true;
    if (c->of_peak[c->signal[k]] < 1) c->small[c->signal[k]] *= OF_SHOWN;
    c->of_peak[c->signal[k]] = 1;
  }
  return VS_OK;
}

static vs_status load(const vs_circuit_job *job, const vs_circuit_host *host, void **circuit,
                      vs_error *err) {
  compiled *c = *circuit = vs_alloc(1, sizeof *c);
  c->job = job;
  c->host = host;
  vs_status status = vs_equations_make(job, host, &c->e, err);
  if (!status) status = find_signals(c, err);
  if (status) return status;
  const vs_rodas_drive of_host = {c, drive};
  const size_t n = (size_t)c->e.n;
  vs_rodas_begin(&c->r, &c->e, &of_host);
  c->shown = vs_alloc(job->n_signals + 1, sizeof *c->shown);
  c->most = vs_alloc(job->n_signals + 1, sizeof *c->most);
  c->peak = vs_alloc(n, sizeof *c->peak);
  c->charge = vs_alloc(n, sizeof *c->charge);
  c->between = vs_alloc(n, sizeof *c->between);
  return VS_OK;
}

const vs_circuit_kind vs_compiled_kind = {
    .name = "compiled", .load = load, .run = run, .free = free_circuit};
