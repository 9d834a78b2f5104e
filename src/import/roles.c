/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "import/roles.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "netlist/words.h"

/* What a search for roles works on. */
typedef struct search {
  const vs_elements *w;
  const vs_values *v;
  vs_roles *roles;
  vs_error *err;
} search;

/* Finds the element that an option, such as "mains", names. Error, with the netlist's place: there
 * is none. */
static vs_status named(const search *f, const char *option, const char *name,
                       const vs_element **e) {
  *e = vs_elements_find(f->w, vs_words_of(name));
  if (*e) return VS_OK;
  const char **names = vs_alloc(f->w->count + 1, sizeof *names);
  for (size_t k = 0; k < f->w->count; k++) names[k] = f->w->elements[k].name;
  const char *nearest = vs_text_nearest(name, names, f->w->count);
  vs_status status = vs_fail_at(f->err, (vs_where){f->w->listing->files[0], 1, 1},
                                "--%s %s: there is no such element%s%s%s", option, name,
                                nearest ? "; did you mean " : " outside of subcircuits",
                                nearest ? nearest : "", nearest ? "?" : "");
  free(names);
  return status;
}

/* How many elements could have a role, the last of them, and the names of all. */
static size_t candidates(const search *f, bool (*could)(const search *, const vs_element *),
                         const char *between, const vs_element **last, vs_text *names) {
  size_t count = 0;
  *last = NULL;
  for (size_t k = 0; k < f->w->count; k++) {
    const vs_element *e = &f->w->elements[k];
    if (!could(f, e)) continue;
    vs_text_add(names, "%s%s", count++ ? between : "", e->name);
    *last = e;
  }
  return count;
}

int vs_roles_gate_of(const vs_roles *r, const vs_element *source) {
  for (size_t k = 0; k < r->n_gates; k++)
    if (r->gates[k].source == source) return (int)k;
  return -1;
}

/* ---- the coil ---- */

/* Finds the inductor of a netlist that is the coil of the EVA, and the resistor in series that
 * belongs to it. */

/* The value of an R, L or C: its first word after the nodes, or R=, L=, C=. */
static bool value_of(const search *f, const vs_element *e, double *value) {
  const vs_word option = vs_elements_option(f->w, e, (char[]){e->letter, '\0'});
  return vs_values_of(f->v, option.n ? option : vs_elements_word(e, e->n_nodes + 1), value);
}

/* True where the inductor's own line puts something across it: LTspice's Rpar= or Cpar=. */
static bool has_across(const search *f, const vs_element *coil) {
  return vs_elements_sets(f->w, f->v, coil, "rpar") || vs_elements_sets(f->w, f->v, coil, "cpar");
}

/* True where an expression, or a statement, asks for that voltage or current: v(NODE), v(a,NODE),
 * i(ELEMENT). */
static bool is_asked_for(const search *f, char quantity, const char *name) {
  const vs_listing *l = f->w->listing;
  size_t n = strcspn(name, " \t");
  for (size_t k = 0; k < l->count; k++) {
    const vs_card *card = &l->cards[k];
    if (card->depth > 0 || card->kind == VS_CARD_COMMENT || vs_listing_is(card, ".save")) continue;
    for (const char *at = card->text; (at = vs_words_find(card->text, at, name, n)); at += n) {
      const char *open = at;
      while (open > card->text && !strchr("()", open[-1])) open--;
      if (open > card->text + 1 && open[-1] == '(' && tolower((unsigned char)open[-2]) == quantity)
        return true;
    }
  }
  return false;
}

/* The resistor in series with an inductor, at either end; NULL: there is none, or it does not
 * belong to the coil because something is connected across the inductor alone, or because the
 * netlist asks for the voltage between the two or for the resistor's current. */
static const vs_element *resistor_of(const search *f, const vs_element *coil) {
  if (has_across(f, coil)) return NULL;
  for (int n = 1; n >= 0; n--) {
    const vs_element *next = vs_elements_next(f->w, coil, coil->nodes[n]);
    if (!next || next->letter != 'r' || is_asked_for(f, 'v', f->w->nodes[coil->nodes[n]].said) ||
        is_asked_for(f, 'i', f->w->listing->cards[next->card].text))
      continue;
    return next;
  }
  return NULL;
}

/* Sets the ends of the coil. Its current flows as the inductor's, from the first node on. */
static vs_status join(search *f, const vs_element *l, const vs_element *r) {
  vs_roles *roles = f->roles;
  roles->coil = l;
  roles->coil_r = r;
  roles->coil_plus = l->nodes[0];
  roles->coil_minus = l->nodes[1];
  for (int n = 0; n < 2 && r; n++) {
    if (vs_elements_next(f->w, l, l->nodes[n]) != r) continue;
    int far = r->nodes[0] == l->nodes[n] ? r->nodes[1] : r->nodes[0];
    *(n ? &roles->coil_minus : &roles->coil_plus) = far;
    return VS_OK;
  }
  return r ? vs_fail_at(f->err, vs_elements_where(f->w, r, 0),
                        "--coil %s+%s: they are not in series, one node alone between them",
                        l->name, r->name)
           : VS_OK;
}

/* Error: the element has an option that multiplies it or sets its temperature. */
static vs_status check_options(const search *f, const vs_element *e) {
  static const char *const OPTIONS[] = {"m", "scale", "temp", "dtemp"};
  for (size_t k = 0; k < sizeof OPTIONS / sizeof *OPTIONS; k++) {
    const vs_word value = vs_elements_option(f->w, e, OPTIONS[k]);
    if (value.n)
      return vs_fail_at(f->err, vs_elements_where(f->w, e, 0),
                        "%s: the coil's %s=%.*s is not taken; write the value that it makes",
                        e->name, OPTIONS[k], (int)value.n, value.at);
  }
  return VS_OK;
}

static vs_status set_coil(search *f, const vs_element *l, const vs_element *r) {
  vs_roles *roles = f->roles;
  vs_where where = vs_elements_where(f->w, l, 0);
  double own = 0;
  if (l->coupled)
    return vs_fail_at(f->err, where,
                      "%s is coupled with another inductor (K...); the EVA's coil is a branch of "
                      "its own: --coil names it",
                      l->name);
  if (!value_of(f, l, &roles->inductance_h) || !(roles->inductance_h > 0))
    return vs_fail_at(f->err, where, "%s: its inductance is not known before a run, as a number",
                      l->name);
  roles->resistance_ohm = 0;
  if (r && (!value_of(f, r, &roles->resistance_ohm) || roles->resistance_ohm < 0))
    return vs_fail_at(f->err, vs_elements_where(f->w, r, 0),
                      "%s: its resistance is not known before a run, as a number", r->name);
  const vs_word rser = vs_elements_option(f->w, l, "rser");
  if (rser.n && !vs_values_of(f->v, rser, &own))
    return vs_fail_at(f->err, where, "%s: Rser is not known before a run, as a number", l->name);
  if (r && has_across(f, l))
    return vs_fail_at(f->err, where,
                      "%s has Rpar or Cpar, which %s is not across; --coil %s takes the inductor "
                      "alone, and %s stays in the circuit",
                      l->name, r->name, l->name, r->name);
  roles->resistance_ohm += own;
  roles->begins_with_current = vs_elements_sets(f->w, f->v, l, "ic");
  roles->heats = vs_elements_heats(f->w, f->v, l)        ? l
                 : r && vs_elements_heats(f->w, f->v, r) ? r
                                                         : NULL;
  roles->modelled = vs_elements_has_model(f->w, l)        ? l
                    : r && vs_elements_has_model(f->w, r) ? r
                                                          : NULL;
  vs_status status = check_options(f, l);
  if (!status && r) status = check_options(f, r);
  return status ? status : join(f, l, r);
}

/* --coil L1+R4 */
static vs_status set_named_coil(search *f, const char *asked) {
  const vs_element *l = NULL, *r = NULL;
  char *all = vs_copy(asked), *rest = all;
  vs_status status = VS_OK;
  for (char *name; !status && (name = strsep(&rest, "+,"));) {
    const vs_element *e = NULL;
    status = named(f, "coil", name, &e);
    if (status) break;
    const vs_element **role = e->letter == 'l' ? &l : &r;
    if ((e->letter != 'l' && e->letter != 'r') || *role)
      status = vs_fail_at(f->err, vs_elements_where(f->w, e, 0),
                          "--coil %s: an inductor is wanted, and one resistor at most in series "
                          "with it",
                          asked);
    *role = e;
  }
  free(all);
  if (!status && !l)
    status = vs_fail_at(f->err, vs_elements_where(f->w, r, 0),
                        "--coil %s: the inductor is missing, as in L1+%s", asked, asked);
  return status ? status : set_coil(f, l, r);
}

/* Finds the coil. `asked` is what --coil says, "L1+R4"; NULL: nothing. Errors, with their place:
 * those of vs_cast_roles. */
static vs_status find_coil(search *f, const char *asked) {
  const vs_element *found = NULL;
  vs_text all = {0};
  size_t count = 0;
  if (asked) return set_named_coil(f, asked);
  for (size_t k = 0; k < f->w->count; k++) {
    const vs_element *e = &f->w->elements[k];
    if (e->letter != 'l' || e->coupled) continue;
    const vs_element *r = resistor_of(f, e);
    vs_text_add(&all, "%s%s%s%s", count++ ? ", " : "", e->name, r ? "+" : "", r ? r->name : "");
    found = e;
  }
  vs_status status = VS_OK;
  if (count > 1)
    status = vs_fail_at(f->err, vs_elements_where(f->w, found, 0),
                        "%zu inductors could be the EVA's coil: --coil says which, one of %s",
                        count, all.text);
  else if (!found)
    status = vs_fail_at(f->err, (vs_where){f->w->listing->files[0], 1, 1},
                        "no inductor, L..., outside of subcircuits and not coupled: the EVA's coil "
                        "is missing; --coil L1+R4 names one with its series resistor");
  else
    status = set_coil(f, found, resistor_of(f, found));
  f->roles->found_coil = found;
  vs_text_free(&all);
  return status;
}

/* ---- gates ---- */

/* Finds the sources of a netlist that fire thyristors, and the firing that they have in common. */

/* Tolerance, as a part, for comparing a period with the mains': netlists write 16.667m for 1/60. */
static const double NEAR = 2e-3;

static bool is_near(double a, double b) {
  return fabs(a - b) <= NEAR * b;
}

/* True for a pulse that repeats too fast to fire thyristors on the mains: a chopper's. */
static bool chops(const search *f, const vs_course_pulse *p) {
  return f->roles->mains && p->period_s < 0.4 / f->roles->hz;
}

static double cycles_to(const vs_roles *r, const vs_roles_gate *g);

/* Turns the pulse of a source that rests at the firing level, as PULSE(6 0 ...): the gate's pulse
 * is then the time between the source's own pulses. The first one counted is the last before the
 * source's delay; where the source fires even earlier, early_s says until when. Error: the source
 * does not return to its resting level. */
static vs_status turn(const search *f, vs_roles_gate *g) {
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

static vs_status add_gate(search *f, const vs_element *e) {
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

static vs_status add_named_gates(search *f, const char *asked) {
  char *all = vs_copy(asked), *rest = all;
  vs_status status = VS_OK;
  for (char *name; !status && (name = strsep(&rest, ",+"));) {
    const vs_element *e;
    status = named(f, "gate", name, &e);
    if (!status && vs_roles_gate_of(f->roles, e) >= 0)
      status = vs_fail_at(f->err, vs_elements_where(f->w, e, 0), "--gate names %s twice", e->name);
    if (!status) status = add_gate(f, e);
  }
  free(all);
  return status;
}

/* True for a source that shares a node other than 0 with the mains, such as a surge in the line. */
static bool in_the_line(const search *f, const vs_element *e) {
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
static bool may_fire(const search *f, const vs_element *e) {
  vs_course_pulse p;
  vs_error unread = {0};
  bool pulse = vs_course_has(e, "pulse"), points = vs_course_has(e, "pwl");
  if (!f->roles->mains || (!pulse && !points) || in_the_line(f, e)) return false;
  if (vs_course_read_pulse(f->w, f->v, e, &p, &unread)) return true; /* it is asked for, or told */
  return (!points || (isfinite(p.at_s) && isfinite(p.width_s))) && !chops(f, &p);
}

/* Finds the gates, once the mains are known. `asked` is what --gate says; NULL: nothing. Errors,
 * with their place: those of vs_cast_roles. */
static vs_status find_gates(search *f, const char *asked) {
  const vs_element *found;
  vs_text all = {0};
  if (asked) return strcasecmp(asked, "none") ? add_named_gates(f, asked) : VS_OK;
  const size_t count = candidates(f, may_fire, ",", &found, &all);
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
static vs_status check_reach(const search *f, const vs_roles_gate *g) {
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

/* A scene has one `firing` section, so gates may differ only in when they fire. Error, with its
 * place: they differ in something else. */
static vs_status check_alike(const search *f) {
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

/* Sets the scene's firing to that of the earliest gate; the other gates get a shift from it. */
static void set_firing(vs_roles *r) {
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

/* ---- the mains ---- */

static vs_status set_mains(search *f, const vs_element *e) {
  vs_course_sine s;
  vs_roles *r = f->roles;
  vs_where where = vs_elements_where(f->w, e, 0);
  vs_status status = vs_course_read_sine(f->w, f->v, e, &s, f->err);
  if (status) return status;
  if (e->letter != 'v')
    return vs_fail_at(f->err, where, "%s: the mains are a source of voltage, V...", e->name);
  if (s.offset_v != 0 || s.damping != 0)
    return vs_fail_at(f->err, where,
                      "%s: the mains have no %s; write that as a source of its own in series, or "
                      "say --mains none, which leaves %s as it is",
                      e->name, s.offset_v != 0 ? "offset" : "damping", e->name);
  if (!(s.hz > 0) || s.peak_v == 0)
    return vs_fail_at(f->err, where, "%s: SIN(0 amplitude frequency) is wanted of the mains",
                      e->name);
  if (isfinite(s.cycles))
    return vs_fail_at(f->err, where,
                      "%s: the mains do not end after %.9g cycles (the seventh number, LTspice's); "
                      "leave it out, and let the run end at %.9g s or give the scene an event "
                      "{kind: interruption, at: %.9g s, duration: ...}",
                      e->name, s.cycles, s.delay_s + s.cycles / s.hz, s.delay_s + s.cycles / s.hz);
  r->mains = e;
  r->rms_v = fabs(s.peak_v) / sqrt(2);
  r->hz = s.hz;
  r->delayed = s.delay_s > 0;
  r->phase_deg = remainder(s.phase_deg - 360 * s.hz * s.delay_s + (s.peak_v < 0 ? 180 : 0), 360);
  return VS_OK;
}

static bool is_sine(const search *f, const vs_element *e) {
  (void)f;
  return e->letter == 'v' && (vs_course_has(e, "sin") || vs_course_has(e, "sine"));
}

static vs_status find_mains(search *f, const char *asked) {
  const vs_element *found = NULL;
  vs_text all = {0};
  if (asked && !strcasecmp(asked, "none")) return VS_OK;
  if (asked) {
    vs_status status = named(f, "mains", asked, &found);
    return status ? status : set_mains(f, found);
  }
  const size_t count = candidates(f, is_sine, ", ", &found, &all);
  vs_status status = VS_OK;
  if (count > 1)
    status = vs_fail_at(f->err, vs_elements_where(f->w, found, 0),
                        "%zu sources are sines, %s: --mains NAME says which is the mains, --mains "
                        "none that none is",
                        count, all.text);
  else if (found)
    status = set_mains(f, found);
  f->roles->found_mains = found;
  vs_text_free(&all);
  return status;
}

/* ---- all ---- */

vs_status vs_roles_find(const vs_elements *w, const vs_values *v, const vs_roles_asked *asked,
                        vs_roles *roles, vs_error *err) {
  search f = {w, v, roles, err};
  *roles = (vs_roles){0};
  size_t before = vs_error_count(err);
  vs_status status = vs_error_keep(err, find_mains(&f, asked->mains));
  bool lost = vs_error_count(err) > before; /* without the mains a gate cannot be recognised */
  if (!status && !lost) status = vs_error_keep(err, find_gates(&f, asked->gate));
  if (!status) status = vs_error_keep(err, find_coil(&f, asked->coil));
  if (!status) status = check_alike(&f);
  if (!status) set_firing(roles);
  return status;
}
