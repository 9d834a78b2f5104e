/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/sensitivity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/units.h"
#include "orbit/sensitivity_problem.h"
#include "orbit/tangent.h"
#include "run/session.h"

/* What is being found. */
typedef struct search {
  const vs_sensitivity_order *order;
  vs_budget budget;
  vs_sensitivity_problem subject;
  vs_parameter *looked; /* of each key, by vs_parameter_look; owned */
  vs_sensitivity *out;
} search;

/* ---- names ---- */

static vs_status unknown_measure(const vs_measured *m, const vs_asked *asked, vs_error *err) {
  size_t count = 0;
  vs_measured_value v;
  while (vs_measured_at(m, (int)count, &v)) count++;
  char(*names)[VS_JUDGED_NAME] = vs_alloc(count, sizeof *names);
  const char **list = vs_alloc(count, sizeof *list);
  for (size_t k = 0; k < count; k++) {
    vs_measured_at(m, (int)k, &v);
    snprintf(names[k], sizeof names[k], "%s", v.name);
    list[k] = names[k];
  }
  vs_fail_at(err, asked->where, "no measure '%s' on tier %s%s", asked->name,
             m->result.scene->tier->name,
             vs_text_hint(asked->name, list, count, "; see 'vibrospice list measures'").text);
  free(list);
  free(names);
  return VS_INPUT;
}

vs_status vs_sensitivity_check(const vs_scene *scene, const vs_sensitivity_order *order,
                               vs_error *err) {
  const vs_orbit none = {0};
  vs_measured *m = vs_alloc(1, sizeof *m);
  vs_key key;
  vs_status status = VS_OK;
  vs_measured_begin(m, scene, order->periods ? &none : NULL);
  for (size_t k = 0; k < order->n_of && !status; k++)
    if (vs_measured_find(m, order->of[k].name) < 0) status = unknown_measure(m, &order->of[k], err);
  for (size_t k = 0; k < order->n_to && !status; k++)
    status = vs_key_find(scene, order->to[k].name, order->to[k].where, &key, err);
  vs_measured_free(m);
  free(m);
  return status;
}

/* ---- its budget ---- */

/* Runs that one key may take: those of three steps of exact derivatives, each twice, are 18, and
 * those of differences 7 more. As many of them may look for an orbit as ORBITS. */
enum { RUNS = 40, ORBITS = 8 };
/* Cycles of the mains that the search for an orbit takes at most, for each in its period, if it
 * ends well: docs/operation.md and docs/power.md. */
enum { ORBIT_IDEAL = 4300, ORBIT_CIRCUIT = 60 };
static const double MOST_CYCLES = 2e9; /* that a long holds on every machine */

static vs_budget budget_of(const vs_scene *scene, const vs_sensitivity_order *order) {
  const vs_setup *setup = &scene->setup;
  const int every = setup->timeline.firing.every > 1 ? setup->timeline.firing.every : 1;
  const double period = (double)(order->periods ? order->periods : 1) * every;
  const bool orbit = order->periods || setup->steady || setup->wants_fraction;
  const int kind = scene->tier->has_circuit ? VS_BUDGET_CIRCUIT : VS_BUDGET_IDEAL;
  double cycles[VS_BUDGET_KINDS] = {0};
  cycles[kind] = RUNS * (order->periods ? period : (double)vs_session_cycles(scene));
  if (orbit) cycles[VS_BUDGET_IDEAL] += ORBITS * ORBIT_IDEAL * period;
  if (orbit && scene->tier->has_circuit)
    cycles[VS_BUDGET_CIRCUIT] += ORBITS * ORBIT_CIRCUIT * period;
  vs_budget b = {.what = "sensitivity", .shows = scene->order.shows};
  for (int k = 0; k < VS_BUDGET_KINDS; k++)
    b.most[k] = order->most_cycles
                    ? order->most_cycles
                    : lround(fmin(fmax((double)order->n_to * cycles[k], 1), MOST_CYCLES));
  return b;
}

static bool is_spent(const search *s) {
  return s->budget.out[VS_BUDGET_IDEAL] || s->budget.out[VS_BUDGET_CIRCUIT];
}

/* The budget is spent before the derivatives to this key are all there: those to it and to the keys
 * behind it are not known. */
static vs_status refuse_spent_search(search *s, size_t to, vs_error *err) {
  const int kind = s->budget.out[VS_BUDGET_CIRCUIT] ? VS_BUDGET_CIRCUIT : VS_BUDGET_IDEAL;
  for (size_t k = to; k < s->order->n_to; k++)
    for (size_t m = 0; m < s->order->n_of; m++)
      *vs_sensitivity_at(s->out, m, k) = (vs_sensitivity_entry){NAN, NAN, false};
  s->out->told = to;
  return vs_fail(err, VS_BUDGET,
                 "the search's budget of %ld cycles of the mains %s is spent: the derivatives to "
                 "%zu of %zu keys are told, and those from %s on are not; ask for fewer keys at a "
                 "time",
                 s->budget.most[kind],
                 kind == VS_BUDGET_CIRCUIT ? "in the circuit" : "on the ideal tiers", to,
                 s->order->n_to, s->order->to[to].name);
}

/* ---- one key ---- */

/* The step of differences of runs, in parts of the key. What is left out goes with its sixth power,
 * what the runs are wrong by is divided by it. On an ideal tier runs are right to some 1e-11. */
static const double STEP_CIRCUIT = 0.02, STEP_IDEAL = 1e-3;
/* What a difference may be off by besides, in parts of the measure. The error of a circuit's run
 * goes along with the key, so that of their difference little more than run.tolerance is left: 4
 * times that was the most seen among peaks, energies and a thyristor's reverse voltage at 1e-4 and
 * 1e-5, held against 1e-6. On an ideal tier it is divided by the step. */
static const double UNRESOLVED = 10;
/* An exact derivative with an error above this, relative to the measure, is not resolved: the
 * measure has a corner, on which its watcher stops. A difference of runs is looked at then. */
static const double RESOLVED = 1e-7;

/* Above this, relative to the measure, the slopes on either side of a key differ for good. */
static const double BENDS = 1e-3;

/* Says it once, however often the derivative is looked for. */
static void say_bend(search *s, const vs_parameter *p, size_t of, double bend) {
  char of_what[VS_JUDGED_NAME + VS_KEY_SIZE + 64];
  snprintf(of_what, sizeof of_what, "%s to %s: the derivatives on either side of",
           s->order->of[of].name, p->key.name);
  if (strstr(s->out->notes.text, of_what)) return;
  vs_text_add(&s->out->notes, "%s %.6g %s differ by %.3g; the mean is given\n", of_what,
              p->value / vs_units_factor(p->key.field->unit), p->key.field->unit, bend);
}

/* Tier compiled takes neighbours along the steps of the scene's own run. What differs between them
 * is smooth, so that they may lie as near to it as their rounding allows. */
static bool is_alike(const search *s) {
  const vs_scene *scene = s->subject.scene;
  return scene->tier->has_circuit && !scene->tier->by_ngspice && !scene->setup.steady &&
         !scene->setup.wants_fraction;
}

static void take_entry(search *s, const vs_stencil *fan, size_t of, size_t to, bool exact) {
  vs_sensitivity_entry *e = vs_sensitivity_at(s->out, of, to);
  vs_slope_of slope = vs_stencil_slope(fan, s->order->of[of].name);
  double per = slope.value != 0 ? slope.value : 1;
  const vs_parameter *p = &fan->parameter;
  if (!slope.known) {
    *e = (vs_sensitivity_entry){NAN, NAN, exact};
    return;
  }
  /* a key that is 0 has p in its own unit */
  *e = (vs_sensitivity_entry){slope.slope / per + 0.0, vs_text_rounded(slope.error / fabs(per), 2),
                              exact};
  /* the mean of two slopes is half of their difference off either of them */
  if ((!exact || is_alike(s)) && slope.bend > BENDS * fabs(per))
    e->error = vs_text_rounded(fmax(slope.error, slope.bend / 2) / fabs(per), 2);
  const bool bends = !exact || !is_alike(s); /* else it may be of the knots alone */
  if (bends && slope.bend > BENDS * fabs(per) && slope.bend > 10 * slope.error)
    say_bend(s, p, of, slope.bend / fabs(per));
}

/* The measures' values, as the scene itself has them. Error: one is not there. */
static vs_status take_values(search *s, const vs_stencil *fan, vs_error *err) {
  for (size_t k = 0; k < s->order->n_of; k++) {
    const vs_asked *asked = &s->order->of[k];
    vs_measured_value v;
    int n = vs_measured_find(fan->measured[0], asked->name);
    if (n < 0 || !vs_measured_at(fan->measured[0], n, &v) || !v.value.known)
      return vs_fail_at(err, asked->where, "%s: this run has none", asked->name);
    vs_sensitivity_name *name = &s->out->of[k];
    snprintf(name->name, sizeof name->name, "%s", asked->name);
    snprintf(name->unit, sizeof name->unit, "%s", v.unit);
    name->value = v.value.value;
  }
  return VS_OK;
}

static bool is_resolved(const vs_sensitivity_entry *e) {
  return e->error <= RESOLVED * fmax(1, fabs(e->value));
}

/* Where the force or the current has a corner, such as that of a stop whose damping is clipped, or
 * of a table, the motion between two knots is no polynomial, and a measure taken there is off by
 * what hangs on where the knots lie. The two attempts have theirs elsewhere: by how much they
 * differ, and a margin, as both may err to one side, is what each may be off by. */
static bool has_corners(const search *s) {
  return !s->subject.scene->setup.model.plain;
}
static const double MARGIN = 10;

/* Of two attempts the better one. */
static vs_sensitivity_entry better_entry(vs_sensitivity_entry a, vs_sensitivity_entry b) {
  double apart = fabs(a.value - b.value);
  vs_sensitivity_entry best = b.error < a.error ? b : a;
  if (apart > MARGIN * (a.error + b.error)) best.error = vs_text_rounded(MARGIN * apart, 2);
  return best;
}

static void say_missing(search *s, size_t of, size_t to) {
  if (isnan(vs_sensitivity_at(s->out, of, to)->value))
    vs_text_add(&s->out->notes, "%s to %s: not known, as runs with a little else have no %s\n",
                s->order->of[of].name, s->order->to[to].name, s->order->of[of].name);
}

/* Takes from differences of runs what is better known by them. */
static vs_status take_differences(search *s, size_t to, bool exact, vs_error *err) {
  const vs_asked *asked = &s->order->to[to];
  const vs_scene *scene = s->subject.scene;
  bool circuit = scene->tier->has_circuit;
  double tolerance = circuit ? scene->setup.run.tolerance : scene->tier->finest;
  vs_stencil *fan = vs_alloc(1, sizeof *fan);
  vs_status status =
      vs_stencil_begin(fan, &s->subject, asked->name, asked->where,
                       circuit ? STEP_CIRCUIT : STEP_IDEAL, tolerance, &s->looked[to], err);
  if (!status) {
    fan->unresolved = UNRESOLVED * tolerance / (circuit ? 1 : STEP_IDEAL);
    status = vs_stencil_run(fan, &s->subject, tolerance, false, err);
  }
  if (!status && !exact) status = take_values(s, fan, err);
  for (size_t k = 0; k < s->order->n_of && !status; k++) {
    vs_sensitivity_entry *e = vs_sensitivity_at(s->out, k, to), before = *e;
    if (exact && is_resolved(e)) continue;
    take_entry(s, fan, k, to, false);
    if (exact && !(e->error < before.error)) *e = before;
  }
  vs_stencil_end(fan);
  free(fan);
  return status;
}

/* The same where there are exact ones already: where runs with another value of the key fail, these
 * stay, with the errors that they have. */
static vs_status add_differences(search *s, size_t to, vs_error *err) {
  vs_error why = {0};
  vs_status status = take_differences(s, to, true, &why);
  if (status == VS_SIGNAL || is_spent(s)) return vs_fail(err, status, "%s", why.text);
  if (status)
    vs_text_add(&s->out->notes,
                "%s: where a measure has a corner the exact derivative has a larger error, and "
                "differences of runs tell no more: %s\n",
                s->order->to[to].name, why.text);
  return VS_OK;
}

/* A contact that so small a change of a key makes come or go is said. */
static const double GRAZES = 1e-6;

static void say_grazing(search *s, const vs_stencil *fan) {
  if (fan->grazing.by >= GRAZES) return;
  vs_text_add(
      &s->out->notes,
      "%s: at t = %.9g s a contact with a stop comes or goes when it changes by %.2g of its "
      "value; behind that the derivatives are others\n",
      fan->parameter.key.name, fan->grazing.at_s, fan->grazing.by);
}

/* Takes the exact derivatives. *whole: all are resolved. */
static vs_status take_kin(search *s, size_t to, bool again, bool *whole, vs_error *err) {
  vs_stencil *fan = vs_alloc(1, sizeof *fan);
  vs_status status =
      vs_tangent_find(fan, &s->subject, &s->order->to[to], &s->looked[to], again, err);
  if (!status && !again) say_grazing(s, fan);
  if (!status && !again) status = take_values(s, fan, err);
  *whole = true;
  for (size_t k = 0; k < s->order->n_of && !status; k++) {
    vs_sensitivity_entry *e = vs_sensitivity_at(s->out, k, to), before = *e;
    if (again && is_resolved(e) && !has_corners(s)) continue;
    take_entry(s, fan, k, to, true);
    if (again) *e = better_entry(before, *e);
    *whole = *whole && is_resolved(e);
  }
  vs_stencil_end(fan);
  free(fan);
  return status;
}

/* The step of the key there: first as usual, then where an event passes another within that. */
static const double STEPS_ALIKE[] = {1e-5, 1e-6};
enum { N_STEPS_ALIKE = sizeof STEPS_ALIKE / sizeof *STEPS_ALIKE };
/* The derivative is that of the steps. Another one, of COARSER steps, differs from it by OFF of
 * what it is off by at least, as where an extreme lies between two knots that the key moves; and it
 * is known to no more than OF_RUN of run.tolerance. With halfwave_snubbed at
 * 100 and 130 degrees no error was above the told one, at 1e-3 to 1e-5 against 1e-6. */
static const double COARSER = 3, OFF = 0.25, OF_RUN = 1;

static vs_status take_alike_at(search *s, size_t to, double tolerance, double step, vs_error *err) {
  const vs_asked *asked = &s->order->to[to];
  const bool first = tolerance == s->subject.scene->setup.run.tolerance;
  vs_stencil *fan = vs_alloc(1, sizeof *fan);
  vs_status status = vs_stencil_begin(fan, &s->subject, asked->name, asked->where, step, tolerance,
                                      &s->looked[to], err);
  if (!status) status = vs_stencil_run(fan, &s->subject, tolerance, true, err);
  if (!status && first) status = take_values(s, fan, err);
  for (size_t k = 0; k < s->order->n_of && !status; k++) {
    vs_sensitivity_entry *e = vs_sensitivity_at(s->out, k, to), before = *e;
    take_entry(s, fan, k, to, true);
    if (first || isnan(before.value)) continue;
    if (isnan(e->value))
      status = vs_fail(err, VS_RUN, "a run in coarser steps has no %s", s->order->of[k].name);
    const double off = fabs(before.value - e->value) / OFF;
    const double known = OF_RUN * s->subject.scene->setup.run.tolerance;
    const double size = before.value != 0 ? 1 + fabs(before.value) : 0;
    before.error = vs_text_rounded(before.error + fmax(off, known * size), 2);
    *e = before;
  }
  vs_stencil_end(fan);
  free(fan);
  return status;
}

/* Takes the derivatives to a key so. *found: false where a neighbour needs other steps, which is
 * noted. */
static vs_status take_alike(search *s, size_t to, bool *found, vs_error *err) {
  const double tolerance = s->subject.scene->setup.run.tolerance;
  vs_error why = {0};
  vs_status status = VS_RUN;
  for (int n = 0; n < N_STEPS_ALIKE && status == VS_RUN; n++) {
    why = (vs_error){0};
    status = take_alike_at(s, to, tolerance, STEPS_ALIKE[n], &why);
    if (!status) status = take_alike_at(s, to, COARSER * tolerance, STEPS_ALIKE[n], &why);
  }
  *found = !status;
  if (status == VS_SIGNAL || status == VS_INPUT || is_spent(s))
    return vs_fail(err, status, "%s", why.text);
  if (status)
    vs_text_add(&s->out->notes, "%s: by differences of runs: %s\n", s->order->to[to].name,
                why.text);
  return VS_OK;
}

/* All measures to one key. */
static vs_status find_key(search *s, size_t to, vs_error *err) {
  bool exact = !s->subject.inexact, whole = false;
  vs_status status = is_alike(s) ? take_alike(s, to, &whole, err)
                     : exact     ? take_kin(s, to, false, &whole, err)
                                 : VS_OK;
  if (!status && exact && (!whole || has_corners(s))) status = take_kin(s, to, true, &whole, err);
  if (!status && !whole)
    status = exact ? add_differences(s, to, err) : take_differences(s, to, false, err);
  for (size_t k = 0; k < s->order->n_of && !status; k++) say_missing(s, k, to);
  return status;
}

/* What the key itself is, and whether anything hears it. */
static vs_status look_at_key(search *s, size_t to, vs_error *err) {
  const vs_asked *asked = &s->order->to[to];
  vs_sensitivity_name *name = &s->out->to[to];
  vs_parameter *p = &s->looked[to];
  vs_status status = vs_parameter_look(p, s->subject.scene, asked->name, asked->where, err);
  if (!status) {
    snprintf(name->name, sizeof name->name, "%s", asked->name);
    snprintf(name->unit, sizeof name->unit, "%s", p->key.field->unit);
    name->value = p->value / vs_units_factor(p->key.field->unit);
    if (p->idle)
      vs_text_add(&s->out->notes, "%s enters no equation here: %s\n", asked->name, p->why);
  }
  return status;
}

/* Says of a key that all derivatives are 0, where they are. */
static void say_zero(search *s, size_t to) {
  for (size_t k = 0; k < s->order->n_of; k++)
    if (vs_sensitivity_at(s->out, k, to)->value != 0) return;
  vs_text_add(&s->out->notes, "%s: no measure asked for depends on it, all derivatives are 0\n",
              s->order->to[to].name);
}

/* ---- when it is over ---- */

/* Fills the values of the machine that the measures are. False: one is no such value. */
static bool find_values(const search *s, vs_measure_set *values) {
  vs_measure m;
  for (size_t of = 0; of < s->order->n_of; of++) {
    int k = 0;
    while (vs_measure_at(&s->subject.scene->setup.model, k, &m) &&
           strcmp(m.name, s->order->of[of].name))
      k++;
    if (strcmp(m.name, s->order->of[of].name)) return false;
    values->has[m.slot] = true;
  }
  return true;
}

/* The runs go on for a cycle, in which all coordinates come to move: by their sizes the steps of
 * the key are chosen. Neighbours' instants are moved by a thousandth of their time at most
 * (orbit/tangent.c). */
static const double LATER = 1.01;

/* Returns from when on nothing that is asked for changes: where a run that is for these values
 * alone leaves out its rest. What is settled for the scene is so for its neighbours, which lie as
 * near as a derivative asks for. INFINITY: it needs all of its steps, or fails, which is told
 * later. */
static double settled_from(const search *s) {
  vs_measure_set values = {0};
  vs_error none = {0};
  double from_s = INFINITY;
  if (s->subject.inexact || s->subject.calm || s->order->periods || !find_values(s, &values))
    return INFINITY;
  const vs_session session = {.wants = &values, .stop = s->order->stop};
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_result *r = vs_alloc(1, sizeof *r);
  *scene = *s->subject.scene;
  scene->warnings = (vs_warnings){0};
  if (!vs_session_run(&session, scene, r, &none) && r->watchers.left)
    from_s = LATER * (r->watchers.left_s + scene->setup.timeline.period_s);
  vs_result_free(r);
  vs_warnings_free(&scene->warnings);
  free(r);
  free(scene);
  return from_s;
}

/* ---- all of it ---- */

static vs_status find_all_entries(search *s, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < s->order->n_to && !status; k++) status = look_at_key(s, k, err);
  for (size_t k = 0; k < s->order->n_to && !status; k++) {
    if (s->order->stop && *s->order->stop)
      return vs_fail(err, VS_SIGNAL, "stopped by a signal before %s", s->order->to[k].name);
    snprintf(s->budget.stage, sizeof s->budget.stage, "key %zu of %zu", k + 1, s->order->n_to);
    status = find_key(s, k, err);
    if (is_spent(s)) status = refuse_spent_search(s, k, err);
    if (!status) s->out->told = k + 1;
    if (!status) say_zero(s, k);
  }
  for (size_t k = 0; k < s->order->n_of && !status; k++)
    if (s->out->of[k].value == 0)
      vs_text_add(&s->out->notes, "%s is 0: its derivatives are its own, in %s\n",
                  s->out->of[k].name, *s->out->of[k].unit ? s->out->of[k].unit : "parts of 1");
  for (size_t k = 0; k < s->order->n_to && !status; k++)
    if (s->out->to[k].value == 0)
      vs_text_add(&s->out->notes, "%s is 0: the derivatives are per %s of it\n", s->out->to[k].name,
                  *s->out->to[k].unit ? s->out->to[k].unit : "1");
  if (!status && s->subject.calm && !s->subject.orbit.stable)
    vs_text_add(&s->out->notes, "the orbit is unstable: the machine does not stay on it\n");
  if (!status && s->subject.inexact && !is_alike(s))
    vs_text_add(&s->out->notes, "by differences of runs, as %s\n", s->subject.inexact);
  return status;
}

vs_status vs_sensitivity_find(const vs_scene *scene, const vs_sensitivity_order *order,
                              vs_sensitivity *out, vs_error *err) {
  search s = {.order = order, .out = out};
  *out = (vs_sensitivity){.n_of = order->n_of, .n_to = order->n_to};
  vs_text_add(&out->notes, "%s", "");
  vs_status status = vs_sensitivity_check(scene, order, err);
  if (status) return status;
  out->of = vs_alloc(order->n_of, sizeof *out->of);
  out->to = vs_alloc(order->n_to, sizeof *out->to);
  out->entry = vs_alloc(order->n_of * order->n_to, sizeof *out->entry);
  s.budget = budget_of(scene, order);
  vs_scene *counted = vs_alloc(1, sizeof *counted); /* borrows all that the scene owns */
  *counted = *scene;
  counted->order.budget = &s.budget;
  status = vs_sensitivity_problem_begin(&s.subject, counted, order->periods, err);
  s.subject.stop = order->stop;
  if (!status) s.subject.until_s = settled_from(&s);
  if (status && is_spent(&s)) status = refuse_spent_search(&s, 0, err);
  s.looked = vs_alloc(order->n_to, sizeof *s.looked);
  if (!status) status = find_all_entries(&s, err);
  free(s.looked);
  vs_budget_end(&s.budget);
  vs_sensitivity_problem_end(&s.subject);
  free(counted);
  return status;
}

void vs_sensitivity_free(vs_sensitivity *s) {
  free(s->of);
  free(s->to);
  free(s->entry);
  vs_text_free(&s->notes);
  *s = (vs_sensitivity){0};
}
