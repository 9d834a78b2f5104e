/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gates.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Tolerance, as a part, for comparing a period with the mains': netlists write 16.667m for 1/60. */
static const double NEAR = 2e-3;

static bool is_near(double a, double b) {
  return fabs(a - b) <= NEAR * b;
}

/* True for a pulse that repeats too fast to fire thyristors on the mains: a chopper's. */
static bool chops(const vs_roles_search *f, const vs_course_pulse *p) {
  return f->roles->mains && p->period_s < 0.4 / f->roles->hz;
}

static double cycles_to(const vs_roles *r, const vs_roles_gate *g);

/* Turns the pulse of a source that rests at the firing level, as PULSE(6 0 ...): the gate's pulse
 * is then the time between the source's own pulses. The first one counted is the last before the
 * source's delay; where the source fires even earlier, early_s says until when. Error: the source
 * does not return to its resting level. */
static vs_status turn(const vs_roles_search *f, vs_roles_gate *g) {
  const vs_course_pulse own = g->pulse;
  bool repeats = isfinite(own.period_s), both_signs = own.low < 0 && own.high > 0;
  double edges_s = own.rise_s + own.fall_s, back_s = own.at_s + own.width_s;
  if (isnan(own.at_s) || both_signs || fabs(own.low) <= fabs(own.high)) return VS_OK;
  g->pulse = (vs_course_pulse){own.high,
                               own.low,
                               repeats ? back_s - own.period_s : back_s,
                               own.period_s - own.width_s,
                               own.fall_s,
                               own.rise_s,
                               own.period_s,
                               own.cycles};
  vs_course_pulse *p = &g->pulse;
  if (!isfinite(back_s) || !(p->width_s > edges_s))
    return vs_fail_at(f->err, vs_elements_where(f->w, g->source, 0),
                      "%s: it rests at %.9g and does not come back to that from %.9g, so that no "
                      "pulse fires; write PULSE(low high delay rise fall width period), or say "
                      "--gate none, which leaves %s as it is",
                      g->source->name, own.low, own.high, g->source->name);
  g->turned = true;
  if (repeats && (p->at_s + p->width_s <= edges_s || cycles_to(f->roles, g) < -1))
    p->at_s += p->period_s;
  if (own.at_s > edges_s && p->at_s > edges_s) g->early_s = own.at_s;
  return VS_OK;
}

static vs_status add_gate(vs_roles_search *f, const vs_element *e) {
  vs_roles *r = f->roles;
  vs_where where = vs_elements_where(f->w, e, 0);
  if (r->n_gates == VS_ROLES_GATES)
    return vs_fail_at(f->err, where, "more than %d gates", VS_ROLES_GATES);
  vs_roles_gate *g = &r->gates[r->n_gates];
  *g = (vs_roles_gate){.source = e, .each = 1};
  if (e->letter != 'v' && e->letter != 'i')
    return vs_fail_at(f->err, where, "--gate %s: a source is wanted, V... or I...", e->name);
  vs_status status = vs_course_read_pulse(f->w, f->v, e, &g->pulse, f->err);
  if (status) return status;
  if (g->pulse.at_s < 0)
    return vs_fail_at(f->err, where, "%s: its PULSE has a delay below 0; add a period to it",
                      e->name);
  if (isfinite(g->pulse.period_s) && isfinite(g->pulse.cycles))
    return vs_fail_at(f->err, where,
                      "%s: a scene fires until its run ends, not %.9g times (the eighth number); "
                      "leave it out and let the run end before %.9g s; --gate none leaves %s as it "
                      "is",
                      e->name, g->pulse.cycles, g->pulse.at_s + g->pulse.cycles * g->pulse.period_s,
                      e->name);
  if (!r->mains)
    return vs_fail_at(f->err, where,
                      "%s: a gate is fired by the angle of the mains, and there are none; --gate "
                      "none leaves it as it is",
                      e->name);
  double cycles = g->pulse.period_s * r->hz;
  if (is_near(cycles, 0.5))
    g->each = 2;
  else if (!isinf(cycles) && (cycles < 0.9 || !is_near(cycles, rint(cycles))))
    return vs_fail_at(f->err, where,
                      "%s comes every %.9g s, which is neither a whole number of the mains' cycles "
                      "of %.9g s nor half of one; --gate none leaves it as it is",
                      e->name, g->pulse.period_s, 1 / r->hz);
  status = turn(f, g);
  if (!status) r->n_gates++;
  return status;
}

static vs_status add_named_gates(vs_roles_search *f, const char *asked) {
  char *all = vs_copy(asked), *rest = all;
  vs_status status = VS_OK;
  for (char *name; !status && (name = strsep(&rest, ",+"));) {
    const vs_element *e;
    status = vs_roles_named(f, "gate", name, &e);
    if (!status && vs_roles_gate_of(f->roles, e) >= 0)
      status = vs_fail_at(f->err, vs_elements_where(f->w, e, 0), "--gate names %s twice", e->name);
    if (!status) status = add_gate(f, e);
  }
  free(all);
  return status;
}

/* True for a source that shares a node other than 0 with the mains, such as a surge in the line. */
static bool in_the_line(const vs_roles_search *f, const vs_element *e) {
  const int *mains = f->roles->mains->nodes;
  for (int k = 0; k < 2; k++)
    for (int n = 0; n < 2; n++)
      if (mains[k] == e->nodes[n] && strcmp(f->w->nodes[mains[k]].name, "0")) {
        const vs_element *other = vs_elements_next(f->w, e, mains[k]);
        if (other == f->roles->mains) return true; /* nothing else is connected there: in series */
      }
  return false;
}

/* True for a source that may be a gate's: it has a PULSE, or a PWL that rises and returns once. */
static bool may_fire(const vs_roles_search *f, const vs_element *e) {
  vs_course_pulse p;
  vs_error unread = {0};
  bool pulse = vs_course_has(f->w, e, "pulse"), points = vs_course_has(f->w, e, "pwl");
  if (!f->roles->mains || (!pulse && !points) || in_the_line(f, e)) return false;
  if (vs_course_read_pulse(f->w, f->v, e, &p, &unread)) return true; /* it is asked for, or told */
  return (!points || (isfinite(p.at_s) && isfinite(p.width_s))) && !chops(f, &p);
}

vs_status vs_gates_find(vs_roles_search *f, const char *asked) {
  const vs_element *found = NULL;
  vs_text all = {0};
  size_t count = 0;
  if (asked) return strcasecmp(asked, "none") ? add_named_gates(f, asked) : VS_OK;
  for (size_t k = 0; k < f->w->count; k++)
    if (may_fire(f, &f->w->elements[k])) {
      vs_text_add(&all, "%s%s", count++ ? "," : "", f->w->elements[k].name);
      found = &f->w->elements[k];
    }
  vs_status status = VS_OK;
  if (count > 1)
    status = vs_fail_at(f->err, vs_elements_where(f->w, found, 0),
                        "%zu sources are pulses: --gate %s says that all of them fire thyristors, "
                        "--gate NAME that one does, --gate none that none does",
                        count, all.text);
  else if (found)
    status = add_gate(f, found);
  f->roles->found_gate = found;
  vs_text_free(&all);
  return status;
}

/* A pulse closer than this to a zero of the mains, in cycles, counts as at the zero: the numbers in
 * a netlist are rounded. */
static const double AT_ZERO = 1e-9;

/* Cycles of the mains from their first rising zero to the gate's first pulse. Negative, down to -1:
 * the pulse lies in the cycle that is under way at t = 0. */
static double cycles_to(const vs_roles *r, const vs_roles_gate *g) {
  double zero = -r->phase_deg / 360;
  double x = g->pulse.at_s * r->hz - (zero - floor(zero));
  return fabs(x - rint(x)) < AT_ZERO ? rint(x) : x;
}

/* The gate fires once in this many cycles; 0: only once. */
static int every_of(const vs_roles *r, const vs_roles_gate *g) {
  return isinf(g->pulse.period_s) ? 0 : g->each == 2 ? 1 : (int)rint(g->pulse.period_s * r->hz);
}

/* Error: the gate's pulses begin, or repeat, later than firing.first_cycle and firing.every can
 * express. */
static vs_status check_reach(const vs_roles_search *f, const vs_roles_gate *g) {
  static const double MOST_CYCLES = 1e8; /* the longest run has fewer */
  double at = cycles_to(f->roles, g), period = g->pulse.period_s * f->roles->hz;
  if (fabs(at) < MOST_CYCLES && (isinf(g->pulse.period_s) || fabs(period) < MOST_CYCLES))
    return VS_OK;
  return vs_fail_at(
      f->err, vs_elements_where(f->w, g->source, 0),
      "%s: it fires first at %.9g s and then every %.9g s, which is more cycles of the "
      "mains than a run has; --gate none says that it fires nothing",
      g->source->name, g->pulse.at_s, g->pulse.period_s);
}

vs_status vs_gates_check_alike(const vs_roles_search *f) {
  const vs_roles *r = f->roles;
  const vs_roles_gate *first = NULL;
  for (size_t k = 0; k < r->n_gates; k++) {
    const vs_roles_gate *g = &r->gates[k];
    if (isnan(g->pulse.at_s)) continue;
    vs_status status = check_reach(f, g);
    if (status) return status;
    if (!first) first = g;
    bool often = every_of(r, g) != every_of(r, first);
    double a = g->pulse.width_s, b = first->pulse.width_s;
    if (!often && (a == b || fabs(a - b) <= 1e-6 * b)) continue;
    return vs_fail_at(f->err, vs_elements_where(f->w, g->source, 0),
                      "%s: its pulses %s other than those of %s (%.9g s and %.9g s); all that fire "
                      "are to do so alike; --gate names those that do",
                      g->source->name, often ? "come in a period" : "have a length",
                      first->source->name, often ? g->pulse.period_s : a,
                      often ? first->pulse.period_s : b);
  }
  return VS_OK;
}

void vs_gates_set_firing(vs_roles *r) {
  double first = INFINITY;
  r->angle_deg = r->width_s = NAN;
  r->every = 0;
  r->first_cycle = 1;
  for (size_t k = 0; k < r->n_gates; k++) {
    const vs_roles_gate *g = &r->gates[k];
    if (isnan(g->pulse.at_s)) continue;
    double x = cycles_to(r, g);
    if (x >= first) continue;
    first = x;
    r->first_cycle = 1 + (int)floor(x);
    r->angle_deg = 360 * (x - floor(x));
    r->width_s = fmin(g->pulse.width_s, 999); /* a scene takes less than 1000 s */
    r->every = every_of(r, g);
  }
  if (isnan(r->angle_deg)) return;
  double begin = first - r->angle_deg / 360;
  if (r->angle_deg >= 180) r->angle_deg -= 180; /* the first gate is then half a cycle late */
  r->at_zero = r->angle_deg < 1e-3;
  if (r->at_zero) r->angle_deg = 1e-3;
  for (size_t k = 0; k < r->n_gates; k++) {
    vs_roles_gate *g = &r->gates[k];
    if (isnan(g->pulse.at_s)) continue;
    double shift = 360 * (cycles_to(r, g) - begin) - (r->at_zero ? 0 : r->angle_deg);
    g->shift_deg = fabs(shift) < 1e-6 ? 0 : shift;
  }
}
