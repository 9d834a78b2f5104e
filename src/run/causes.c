/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/causes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "branches.h"
#include "lacks.h"
#include "netlist/kinds.h"
#include "run/engineering.h"

/* What is looked at: a value at an instant; a sum or mean over time, which is told by its largest
 * current or voltage; the stretch that a rate is the mean of, which for a fall ends at at_s. */
typedef enum form { AT_INSTANT, OVER_TIME, RISE, FALL } form;

/* Before the stretch of a rate the circuit is looked at from so long on, s: a solver's step may
 * begin before the stretch. Steps near what changes within a microsecond are shorter. */
static const double AHEAD_S = 20e-6;

/* All signals at the end of a step. */
typedef struct moment {
  double t_s;
  double *signals; /* owned */
} moment;
enum { MOMENTS_MOST = 4096 };

typedef struct happening {
  char what[VS_DECK_NAME + 32];
  double at_s; /* NaN: there is none */
} happening;

typedef struct cause {
  const vs_judgement *of;
  form form;
  bool voltage; /* of a voltage, not of a current */
  int device;   /* of the deck; -1: none */
  int term;     /* of the deck, where it is a probe's; -1: it is the device's formula */
  bool coil;    /* it is the coil's, not a device's */
  double sign;  /* of that term */
  double at_s;  /* the instant asked for; NaN: none is known */
  double from_s, to_s, over_s; /* what is looked at; how long a rate's stretch is */
  moment *seen;                /* owned */
  size_t n_seen;
  happening event, deed; /* the scene's event, and what a device did, last before the instant */
  int event_number;      /* -1: there is none */
  double period_s, part_from_s, part; /* of OVER_TIME: the cycle with the largest part */
  double sum, sum_before, cycle_s;    /* up to now; to the present cycle's beginning, and that */
  /* what comes out */
  bool told;
  double total, found_s, sum_error; /* by which the sum of the shares is above the total */
  vs_shares shares;
  char note[256]; /* why there are no shares; empty: there are */
  vs_text assumed,
      typical; /* the figures that the line depends on and that are that: "a.i2t, b.i_cm"
                */
} cause;

struct vs_causes {
  const vs_result *result;
  vs_branches branches;
  const char **more; /* the signals, borrowed from the branches; owned */
  cause item[VS_CAUSES_MOST];
  size_t count, left_out; /* left_out: how many more lines are violated */
  double last_s;          /* the run may end behind this */
  bool enough;
};

/* ---- which lines, and what is looked at of each ---- */

static const vs_deck *deck_of(const vs_causes *c) {
  return &c->result->scene->setup.deck;
}

static double period_of(const vs_causes *c) {
  const vs_timeline *t = &c->result->scene->setup.timeline;
  return t->supply.direct ? INFINITY : t->period_s;
}

static form form_of(const vs_device_measure *m) {
  switch (m->how) {
  case VS_R_PEAK:
  case VS_R_ARC:
  case VS_R_ARCS:
  case VS_R_DERATED:
  case VS_R_GATE_LEAST:
  case VS_R_OFFERED:
  case VS_R_MISFIRE:
  case VS_R_UNINTENDED:
  case VS_R_COMMUTATION_FAILURE:
    return AT_INSTANT;
  case VS_R_FALL:
    return FALL;
  case VS_R_STEEPEST:
  case VS_R_RISE:
  case VS_R_OFF_RATE:
  case VS_R_ON_RATE:
  case VS_R_RETURN_RISE:
    return RISE;
  default:
    return OVER_TIME;
  }
}

/* What a device was measured of at another instant: the peak of its current, or of its voltage. */
static double peak_of_device(const vs_result *r, int device, bool voltage) {
  const vs_devices *d = r->watchers.devices;
  double at_s = NAN, largest = 0;
  for (size_t n = 0; d && n < d->item[device].count; n++) {
    const vs_reduced *m = &d->item[device].reduced[n];
    if (m->measure->how != VS_R_PEAK || m->measure->of != (voltage ? VS_OF_V : VS_OF_I)) continue;
    if (!m->value.known || !(fabs(m->value.value) > largest)) continue;
    largest = fabs(m->value.value);
    at_s = m->value.at_s;
  }
  return at_s;
}

/* How long the stretch of a rate is, s. */
static double stretch_of(const vs_causes *c, const cause *k) {
  const vs_judgement *j = k->of;
  const vs_deck *deck = deck_of(c);
  const int part = deck->devices[k->device].part;
  double turn_on_s = 0;
  if (j->over_v > 0 && j->stress.value > 0) return j->over_v / j->stress.value;
  if (!k->voltage && part >= 0) turn_on_s = vs_parts_turn_on_s(deck, deck->parts[part].file);
  return turn_on_s > 0 ? turn_on_s : 1e-7;
}

static void look_at_device(vs_causes *c, cause *k, const vs_device_measure *m) {
  char at[VS_ENGINEERING_SIZE];
  k->form = form_of(m);
  k->voltage = m->of == VS_OF_V || m->of == VS_OF_V2 || m->of == VS_OF_FLUX;
  if (m->how == VS_R_UNINTENDED || m->how == VS_R_COMMUTATION_FAILURE || m->how == VS_R_MISFIRE)
    k->voltage = true;
  if (k->form == OVER_TIME) {
    c->last_s = fmax(c->last_s, isnan(k->at_s) ? c->result->scene->setup.run.until_s : k->at_s);
    k->at_s = peak_of_device(c->result, k->device, k->voltage);
    if (isnan(k->at_s)) k->at_s = peak_of_device(c->result, k->device, k->voltage = true);
  }
  if (k->form == RISE) k->over_s = stretch_of(c, k);
  if (k->form == FALL) k->over_s = vs_slope_fall_s;
  if (isnan(k->at_s))
    snprintf(k->note, sizeof k->note, "no instant is known at which it is decided");
  if (m->how == VS_R_OFFERED)
    snprintf(k->note, sizeof k->note, "it is a length of time, which ends at %s",
             vs_engineering_text(k->at_s, "s", at));
}

/* A probe of the deck, or one of its extremes. */
static void look_at_probe(vs_causes *c, cause *k, const char *name) {
  const vs_deck *deck = deck_of(c);
  for (size_t p = 0; p < deck->n_probes && k->term < 0; p++) {
    const vs_probe *probe = &deck->probes[p];
    const size_t n = strlen(probe->name);
    if (strncmp(probe->name, name, n) ||
        (name[n] && strcmp(name + n, "_min") && strcmp(name + n, "_max")))
      continue;
    k->term = probe->term;
    k->sign = probe->sign;
    k->voltage = *deck->terms[probe->term].plus == 'v';
  }
  k->coil = k->term < 0 && (!strcmp(name, "i") || !strcmp(name, "v_eva"));
  if (k->coil) k->voltage = *name == 'v';
  if (k->term < 0 && !k->coil)
    snprintf(k->note, sizeof k->note, "it is no device's current or voltage");
}

/* A measure of a device that the scene rates, as "r1.power". */
static bool look_at_measure(vs_causes *c, cause *k, const char *name) {
  const vs_deck *deck = deck_of(c);
  for (size_t d = 0; d < deck->n_devices; d++) {
    const size_t n = strlen(deck->devices[d].name);
    const vs_kind *kind = deck->devices[d].kind;
    if (strncmp(deck->devices[d].name, name, n) || name[n] != '.') continue;
    for (size_t m = 0; kind && m < kind->n_measures; m++)
      if (!strcmp(kind->measures[m].name, name + n + 1)) {
        k->device = (int)d;
        look_at_device(c, k, &kind->measures[m]);
        return true;
      }
  }
  return false;
}

/* The scene's event that began last before the instant, and did not end more than a cycle of the
 * mains before it. */
static void find_event(const vs_causes *c, cause *k) {
  const vs_timeline *t = &c->result->scene->setup.timeline;
  for (size_t n = 0; n < t->events.count; n++) {
    const vs_scene_event *e = &t->events.item[n];
    if (e->start_s > k->at_s || (k->event_number >= 0 && e->start_s < k->event.at_s)) continue;
    if (e->end_s < k->at_s - t->period_s) continue;
    if (isinf(e->end_s) && e->kind->source && e->kind->network &&
        e->start_s < k->at_s - t->period_s)
      continue;
    k->event_number = (int)n;
    k->event.at_s = e->start_s;
    snprintf(k->event.what, sizeof k->event.what, "%s", e->name);
  }
}

static void add_cause(vs_causes *c, const vs_judgement *j) {
  if (c->count == VS_CAUSES_MOST) {
    c->left_out++;
    return;
  }
  cause *k = &c->item[c->count++];
  *k = (cause){.of = j,
               .device = -1,
               .term = -1,
               .sign = 1,
               .at_s = j->stress.at_s,
               .event = {.at_s = NAN},
               .deed = {.at_s = NAN},
               .event_number = -1,
               .found_s = NAN,
               .period_s = period_of(c)};
  if (j->device) {
    k->device = (int)(j->device - deck_of(c)->devices);
    look_at_device(c, k, j->measure);
  } else if (j->probe) {
    look_at_probe(c, k, j->probe->name);
  } else if (!j->name || !look_at_measure(c, k, j->name)) {
    look_at_probe(c, k, j->name ? j->name : "");
  }
  const double ahead_s = k->form >= RISE ? AHEAD_S : 0;
  k->from_s = k->at_s - 1.5 * k->over_s - ahead_s;
  k->to_s = k->at_s + (k->form == RISE ? 1.5 * k->over_s : 0);
  find_event(c, k);
  if (!isnan(k->to_s) && !*k->note) c->last_s = fmax(c->last_s, k->to_s);
}

/* The lines that are violated, tightest first; else the weakest. */
static int by_margin(const void *left, const void *right) {
  const vs_judgement *a = *(const vs_judgement *const *)left,
                     *b = *(const vs_judgement *const *)right;
  return (a->margin > b->margin) - (a->margin < b->margin);
}

static void choose_lines(vs_causes *c) {
  const vs_verdict *v = &c->result->verdict;
  const vs_judgement **line = vs_alloc(v->count, sizeof *line);
  size_t count = 0;
  for (size_t k = 0; k < v->count; k++)
    if (v->item[k].margin < 0 && !v->item[k].waived && v->item[k].stress.known)
      line[count++] = &v->item[k];
  qsort(line, count, sizeof *line, by_margin);
  if (!count && v->weakest) line[count++] = v->weakest;
  for (size_t k = 0; k < count; k++)
    if (!vs_verdict_is_doubled(line, count, line[k])) add_cause(c, line[k]);
  free(line);
}

/* ---- looking ---- */

static void forget_moments(vs_causes *c) {
  for (size_t k = 0; k < c->count; k++) {
    for (size_t n = 0; n < c->item[k].n_seen; n++) free(c->item[k].seen[n].signals);
    c->item[k].n_seen = 0;
  }
}

static void begin_look(void *ctx, const vs_circuit_job *job, const char *const **signals,
                       size_t *count) {
  vs_causes *c = ctx;
  forget_moments(c);
  vs_branches_free(&c->branches);
  free(c->more);
  vs_branches_read(job, deck_of(c), &c->result->scene->setup.timeline.events, &c->branches);
  c->more = vs_alloc(c->branches.n_signals, sizeof *c->more);
  for (size_t k = 0; k < c->branches.n_signals; k++) c->more[k] = c->branches.signals[k];
  *signals = c->more;
  *count = c->branches.n_signals;
}

/* True for an instant of the line: of a value the first end of a step at it or behind it; of a
 * rate all around its stretch, and one behind. */
static bool is_wanted(const cause *k, double t_s) {
  const double last_s = k->n_seen ? k->seen[k->n_seen - 1].t_s : -INFINITY;
  if (*k->note || isnan(k->at_s) || k->n_seen == MOMENTS_MOST) return false;
  return t_s >= k->from_s - 1e-12 * fabs(k->from_s) && last_s < k->to_s - 1e-12 * fabs(k->to_s);
}

static void take_look(void *ctx, double t_s, const double *signals) {
  vs_causes *c = ctx;
  const size_t n = c->branches.n_signals;
  for (size_t k = 0; k < c->count; k++) {
    cause *one = &c->item[k];
    if (!is_wanted(one, t_s)) continue;
    one->seen = vs_alloc_grow(one->seen, one->n_seen, sizeof *one->seen);
    moment *m = &one->seen[one->n_seen++];
    *m = (moment){t_s, vs_alloc(n, sizeof *m->signals)};
    memcpy(m->signals, signals, n * sizeof *m->signals);
    vs_branches_complete(&c->branches, m->signals);
  }
}

static void note_deed(vs_causes *c, const char *device, const char *what, double at_s) {
  for (size_t k = 0; k < c->count; k++) {
    cause *one = &c->item[k];
    if (!(at_s <= one->at_s) || (!isnan(one->deed.at_s) && at_s < one->deed.at_s)) continue;
    if (at_s < one->at_s - one->period_s) continue;
    one->deed.at_s = at_s;
    const char *bracket = strstr(what, " (");
    snprintf(one->deed.what, sizeof one->deed.what, "%s %.*s", device,
             (int)(bracket ? bracket - what : 40), what);
  }
}

/* Where the deck's devices do not tell, the run's own firings are the thyristor's. */
static void note_deeds(vs_causes *c, const vs_step *step, const vs_devices *d) {
  for (int k = 0; k < 2; k++) {
    const bool fires = step->event[k] == VS_EV_FIRES;
    if ((fires || step->event[k] == VS_EV_EXTINCT) && !(d && d->tells))
      note_deed(c, "the thyristor", fires ? "fires" : "goes out", step->event_s[k]);
  }
  for (size_t k = 0; d && k < d->n_incidents; k++)
    note_deed(c, d->incidents[k].device, d->incidents[k].what, d->incidents[k].at_s);
}

/* Of a sum over time, the cycle of the mains with the largest part, of which the last may not be
 * whole. from_s: where the cycle of the step begins that is taken in. */
static void follow_sum(cause *k, const vs_devices *d, double from_s) {
  if (k->form != OVER_TIME || k->device < 0 || !d || !k->of->measure) return;
  if (from_s > k->cycle_s) {
    k->sum_before = k->sum;
    k->cycle_s = from_s;
  }
  const bool melts = k->of->measure->how == VS_R_OPENS; /* by int i^2 dt */
  k->sum = fabs(d->item[k->device].sum[melts ? VS_OF_I2 : k->of->measure->of]);
  if (k->sum - k->sum_before <= k->part) return;
  k->part = k->sum - k->sum_before;
  k->part_from_s = from_s;
}

static vs_status accept_step(void *ctx, const vs_step *step, const vs_result *r, vs_error *err) {
  vs_causes *c = ctx;
  const vs_devices *d = r->watchers.devices;
  note_deeds(c, step, d);
  for (size_t k = 0; k < c->count; k++) {
    cause *one = &c->item[k];
    const double n = floor(step->from->t_s / one->period_s + 1e-9);
    if (isfinite(one->period_s)) follow_sum(one, d, n * one->period_s);
  }
  bool waits = step->to->t_s <= c->last_s;
  for (size_t k = 0; k < c->count && !waits; k++) waits = is_wanted(&c->item[k], step->to->t_s);
  if (waits) return VS_OK;
  c->enough = true;
  return vs_fail(err, VS_RUN, "all that is asked for has been seen");
}

/* ---- what comes out ---- */

/* A node of the coil: 0 is where its current flows in. */
static size_t coil_node(const vs_causes *c, size_t n) {
  const size_t coil = vs_branches_coil(&c->branches);
  return coil < c->branches.n_tops ? c->branches.top[coil].node[n] : 0;
}

/* The value of a line's voltage or current by the deck's own formula. */
static double value_of(const vs_causes *c, const cause *k, const double *signals) {
  const vs_deck *deck = deck_of(c);
  double terms[VS_DECK_MOST];
  for (size_t t = 0; t < deck->n_terms; t++) {
    double v[2];
    for (int n = 0; n < 2; n++) {
      const char *name = n ? deck->terms[t].minus : deck->terms[t].plus;
      const size_t s = vs_branches_signal(&c->branches, name);
      v[n] = s < c->branches.n_signals ? signals[s] : strcmp(name, "v(0)") ? NAN : 0;
    }
    terms[t] = v[0] - v[1];
  }
  if (k->term >= 0) return k->sign * terms[k->term];
  if (k->coil && k->voltage) return signals[coil_node(c, 0)] - signals[coil_node(c, 1)];
  if (k->coil)
    return vs_branches_current(&c->branches, signals, vs_branches_coil(&c->branches),
                               coil_node(c, 0));
  const vs_device *d = &deck->devices[k->device];
  return vs_formula_value(k->voltage ? &d->voltage : &d->current, terms);
}

/* The signals at an instant, straight between two moments. */
static void signals_at(const vs_causes *c, const cause *k, double t_s, double *signals) {
  size_t n = 1;
  while (n + 1 < k->n_seen && k->seen[n].t_s < t_s) n++;
  const moment *a = &k->seen[n - 1], *b = &k->seen[n < k->n_seen ? n : n - 1];
  double part = b->t_s > a->t_s ? (t_s - a->t_s) / (b->t_s - a->t_s) : 0;
  part = fmin(fmax(part, 0), 1);
  for (size_t s = 0; s < c->branches.n_signals; s++)
    signals[s] = a->signals[s] + part * (b->signals[s] - a->signals[s]);
}

/* Finds the beginning of the stretch of that length that falls to zero, or has the largest rise:
 * one of its ends is at a moment. `from` and `to` become the signals at its ends. Returns the
 * beginning, s. */
static double find_stretch(const vs_causes *c, const cause *k, double *from, double *to) {
  double best = -INFINITY, best_s = k->at_s - (k->form == FALL ? k->over_s : 0);
  const int sense = k->of->measure ? k->of->measure->sense : 0;
  for (size_t n = 0; n < 2 * k->n_seen && k->form == RISE; n++) {
    const double t_s = k->seen[n / 2].t_s - (n % 2 ? k->over_s : 0);
    if (t_s < k->seen[0].t_s || t_s + k->over_s > k->seen[k->n_seen - 1].t_s) continue;
    if (fabs(t_s + k->over_s / 2 - k->at_s) > 1.6 * k->over_s) continue;
    signals_at(c, k, t_s, from);
    signals_at(c, k, t_s + k->over_s, to);
    const double rise = value_of(c, k, to) - value_of(c, k, from),
                 own = sense ? sense * rise : fabs(rise);
    if (own > best) best = own, best_s = t_s;
  }
  signals_at(c, k, best_s, from);
  signals_at(c, k, best_s + k->over_s, to);
  return best_s;
}

/* The nodes of a voltage: those of its probe or of its device's line. */
static bool nodes_of(const vs_causes *c, const cause *k, size_t node[2]) {
  const vs_deck *deck = deck_of(c);
  int term = k->term;
  double factor = k->sign;
  for (size_t n = 0; n < 2 && k->coil; n++) node[n] = coil_node(c, n);
  if (k->coil) return true;
  if (term < 0 && !vs_formula_is_term(&deck->devices[k->device].voltage, &term, &factor))
    return false;
  const vs_term *t = &deck->terms[term];
  const size_t plus = vs_branches_signal(&c->branches, factor < 0 ? t->minus : t->plus),
               minus = vs_branches_signal(&c->branches, factor < 0 ? t->plus : t->minus);
  node[0] = plus;
  node[1] = minus;
  return plus < c->branches.n_nodes && minus < c->branches.n_nodes;
}

/* The device whose current a probe is, or whose voltage. */
static int device_of_probe(const vs_causes *c, const cause *k) {
  const vs_deck *deck = deck_of(c);
  int term;
  double factor;
  for (size_t d = 0; d < deck->n_devices; d++) {
    const vs_formula *f = k->voltage ? &deck->devices[d].voltage : &deck->devices[d].current;
    if (vs_formula_is_term(f, &term, &factor) && term == k->term) return (int)d;
  }
  return -1;
}

/* The element whose current a probe is, i(VX); n_tops: there is none. */
static size_t top_of_probe(const vs_causes *c, const cause *k) {
  const vs_branches *b = &c->branches;
  const char *signal = deck_of(c)->terms[k->term].plus;
  size_t top = 0;
  while (top < b->n_tops && (strncmp(b->top[top].name, signal + 2, strlen(signal) - 3) ||
                             strlen(b->top[top].name) != strlen(signal) - 3))
    top++;
  return top;
}

/* A device's current is told at the first node of its voltage, that of a probe at an end of its
 * source. */
static bool share_current(vs_causes *c, cause *k, const double *signals) {
  const vs_branches *b = &c->branches;
  size_t node[2] = {coil_node(c, 0), 0}, top = vs_branches_coil(b);
  cause own = *k;
  own.term = -1;
  if (!k->coil && k->device >= 0 && nodes_of(c, &own, node)) {
    top = vs_branches_device(b, k->device, &node[0]);
  } else if (!k->coil) {
    top = k->term >= 0 ? top_of_probe(c, k) : b->n_tops;
    if (top == b->n_tops) return false;
    node[0] = b->top[top].node[b->top[top].node[0] == 0];
    k->total = vs_branches_current(b, signals, top, node[0]);
  }
  return vs_branches_share_current(b, signals, top, node[0], k->total, &k->shares);
}

/* False where what was seen is not what the line tells, as at an instant for which a law stood in
 * for the circuit. A rate is told by straight lines here, and by cubics there. */
static bool is_met(const cause *k) {
  static const double NEAR = 0.1;
  const vs_device_measure *m = k->of->measure;
  const double told = fabs(k->of->stress.value) * (k->form >= RISE ? k->over_s : 1);
  const bool same = k->form >= RISE || (m ? m->how == VS_R_PEAK : k->term >= 0 || k->coil);
  return !same || fabs(fabs(k->total) - told) <= NEAR * told;
}

static void work_out(vs_causes *c, cause *k) {
  if (!(k->deed.at_s >= k->event.at_s) && !isnan(k->event.at_s)) k->deed.at_s = NAN;
  const size_t n = c->branches.n_signals;
  double *from = vs_alloc(n, sizeof *from), *to = vs_alloc(n, sizeof *to);
  size_t node[2];
  double sum = 0;
  if (k->term >= 0) k->device = device_of_probe(c, k);
  if (k->form >= RISE && k->n_seen > 1) {
    k->found_s = find_stretch(c, k, from, to);
    k->total = value_of(c, k, to) - value_of(c, k, from);
    for (size_t s = 0; s < n; s++) to[s] -= from[s];
  } else {
    k->form = k->form >= RISE ? AT_INSTANT : k->form;
    memcpy(to, k->seen[0].signals, n * sizeof *to);
    k->found_s = k->seen[0].t_s;
    k->total = value_of(c, k, to);
  }
  if (!k->voltage)
    k->told = share_current(c, k, to);
  else if (nodes_of(c, k, node))
    k->told = vs_branches_share_voltage(&c->branches, to, k->device, k->event_number, node[0],
                                        node[1], &k->shares);
  for (size_t s = 0; s < k->shares.count; s++) sum += k->shares.item[s].value;
  if (!isfinite(k->total) || !isfinite(sum)) k->told = false;
  if (!k->told) snprintf(k->note, sizeof k->note, "the netlist does not tell what it is made of");
  if (k->told && !is_met(k)) {
    k->told = false;
    snprintf(k->note, sizeof k->note, "the run for it came to another value");
  }
  const double turned = k->total < 0 ? -1 : 1; /* shares that add to it are above 0 then */
  k->total *= turned;
  k->sum_error = turned * sum - k->total;
  for (size_t s = 0; s < k->shares.count; s++) k->shares.item[s].value *= turned;
  free(from);
  free(to);
}

/* ---- the run ---- */

static vs_status begin_attempt(void *ctx, vs_scene *scene, vs_error *err) {
  vs_causes *c = ctx;
  (void)err;
  for (size_t k = 0; k < c->count; k++) {
    c->item[k].deed.at_s = NAN;
    c->item[k].part = c->item[k].sum = c->item[k].sum_before = c->item[k].cycle_s = 0;
  }
  scene->order.tried = true;
  return VS_OK;
}

/* Reads the scene once more, on the tier whose solver tells the currents of elements, whatever
 * --tier says. */
static vs_status read_on_ngspice(const vs_scene *of, vs_scene *scene, vs_error *err) {
  static const char *const KEYS[] = {"run.verify=never", "run.tier=circuit"};
  return vs_scene_with(of, KEYS, of->tier->by_ngspice ? 1 : 2, scene, err);
}

static vs_status look_again(vs_causes *c, vs_causes_run *run, const volatile sig_atomic_t *stop,
                            vs_error *err) {
  const vs_scene *of = c->result->scene;
  const vs_circuit_look look = {c, begin_look, take_look};
  const vs_session_listener guest = {.ctx = c, .begin = begin_attempt, .accept = accept_step};
  const vs_session session = {.guest = &guest, .stop = stop};
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_result *result = vs_alloc(1, sizeof *result);
  vs_status status = read_on_ngspice(of, scene, err);
  scene->order.look = &look;
  if (!status) status = run(&session, scene, result, err);
  for (size_t k = 0; k < c->count && (!status || c->enough); k++)
    if (c->item[k].n_seen) work_out(c, &c->item[k]);
  vs_result_free(result);
  vs_scene_free(scene);
  free(result);
  free(scene);
  return c->enough ? VS_OK : status;
}

/* A line whose instant was not reached has the reason in the place of its shares. */
static void note_failure(vs_causes *c, const vs_error *err) {
  for (size_t k = 0; k < c->count; k++)
    if (!c->item[k].told && !*c->item[k].note)
      snprintf(c->item[k].note, sizeof c->item[k].note, "the run for it failed: %.200s", err->text);
}

/* Has the circuit looked into for all lines. Error: VS_SIGNAL. */
static vs_status look_at_lines(vs_causes *c, vs_causes_run *run, const volatile sig_atomic_t *stop,
                               vs_error *err) {
  const vs_tier *tier = c->result->scene->tier;
  if (!c->count || !isfinite(c->last_s)) return VS_OK;
  if (!tier->has_circuit) {
    for (size_t k = 0; k < c->count; k++)
      snprintf(c->item[k].note, sizeof c->item[k].note, "tier %s has no circuit", tier->name);
    return VS_OK;
  }
  vs_error why = {0};
  vs_status status = look_again(c, run, stop, &why);
  if (status == VS_SIGNAL) return vs_fail(err, status, "%s", why.text);
  if (status) note_failure(c, &why);
  return VS_OK;
}

/* ---- what is told ---- */

/* So many shares are printed, none below that part of the whole; the rest is summed. */
enum { SHOWN = 3 };
static const double SMALL = 0.01;
/* What the shares leave of the whole is told beyond this part of it. */
static const double TOLD = 1e-3;

vs_status vs_causes_find(const vs_result *result, vs_causes_run *run,
                         const volatile sig_atomic_t *stop, vs_causes **causes, vs_error *err) {
  vs_causes *c = *causes = vs_alloc(1, sizeof *c);
  c->result = result;
  c->last_s = -INFINITY;
  choose_lines(c);
  vs_status status = look_at_lines(c, run, stop, err);
  for (size_t k = 0; k < c->count; k++) {
    cause *one = &c->item[k];
    vs_lacks_list(&c->branches, deck_of(c), one->of, &one->shares, SHOWN, VS_ASSUMED,
                  &one->assumed);
    vs_lacks_list(&c->branches, deck_of(c), one->of, &one->shares, SHOWN, VS_TYPICAL,
                  &one->typical);
    if (!one->told && !*one->note)
      snprintf(one->note, sizeof one->note, "the run for it did not reach its instant");
  }
  return status;
}

void vs_causes_free(vs_causes *c) {
  if (!c) return;
  forget_moments(c);
  for (size_t k = 0; k < c->count; k++) {
    free(c->item[k].seen);
    vs_text_free(&c->item[k].assumed);
    vs_text_free(&c->item[k].typical);
  }
  vs_branches_free(&c->branches);
  free(c->more);
  free(c);
}

/* "819 V at 45 ms, made of 1.94 kV from surge1, -931 V from transformer" */
static void show_shares(const cause *k, FILE *out) {
  const char *unit = k->voltage ? "V" : "A";
  char text[VS_ENGINEERING_SIZE];
  double rest = 0;
  size_t n_rest = 0;
  if (k->form >= RISE) fprintf(out, "a %s of ", k->form == FALL ? "fall" : "rise");
  fputs(vs_engineering_text(vs_text_rounded(k->total, 3), unit, text), out);
  if (k->form >= RISE) fprintf(out, " within %s", vs_engineering_text(k->over_s, "s", text));
  fprintf(out, " at %s, made of", vs_engineering_text(k->found_s, "s", text));
  for (size_t n = 0; n < k->shares.count; n++) {
    const vs_share *s = &k->shares.item[n];
    if (n && (n >= SHOWN || fabs(s->value) < SMALL * k->total)) {
      rest += s->value;
      n_rest++;
      continue;
    }
    fprintf(out, "%s %s from %s", n ? "," : "",
            vs_engineering_text(vs_text_rounded(s->value, 3), unit, text), s->of);
  }
  if (fabs(rest) >= SMALL * k->total)
    fprintf(out, ", %s from %zu others", vs_engineering_text(vs_text_rounded(rest, 3), unit, text),
            n_rest);
  if (fabs(k->sum_error) > TOLD * k->total)
    fprintf(out, " (the sum of all shares differs by %.2g %%)",
            100 * fabs(k->sum_error) / k->total);
}

/* "; surge1 at 7.5 ms, 0.26 ms before" */
static void show_happening(const happening *h, double at_s, FILE *out) {
  char when[VS_ENGINEERING_SIZE], before[VS_ENGINEERING_SIZE];
  if (isnan(h->at_s)) return;
  fprintf(out, "; %s at %s", h->what, vs_engineering_text(h->at_s, "s", when));
  if (at_s > h->at_s)
    fprintf(out, ", %s before",
            vs_engineering_text(vs_text_rounded(at_s - h->at_s, 3), "s", before));
}

/* Of a sum over time: which cycle has most of it. */
static void show_sum(const cause *k, FILE *out) {
  char from[VS_ENGINEERING_SIZE], to[VS_ENGINEERING_SIZE];
  fputs("a sum over time", out);
  if (!isnan(k->of->stress.at_s))
    fprintf(out, " up to %s", vs_engineering_text(k->of->stress.at_s, "s", to));
  if (k->part > 0 && k->sum > 0)
    fprintf(out, ", %.0f %% of it from %s to %s", 100 * k->part / k->sum,
            vs_engineering_text(k->part_from_s, "s", from),
            vs_engineering_text(k->part_from_s + k->period_s, "s", to));
  fprintf(out, "; the run's largest %s is ", k->voltage ? "voltage" : "current");
}

/* What makes the line, as text; to be freed. */
static char *text_of(const cause *k) {
  char *text = NULL;
  size_t size;
  FILE *out = vs_alloc_stream(&text, &size);
  if (!k->told) fputs(k->note, out);
  if (k->told && k->form == OVER_TIME) show_sum(k, out);
  if (k->told) show_shares(k, out);
  show_happening(&k->event, k->at_s, out);
  show_happening(&k->deed, k->at_s, out);
  if (k->assumed.length) fprintf(out, "; assumed: %s", k->assumed.text);
  if (k->typical.length) fprintf(out, "; typical: %s", k->typical.text);
  vs_alloc_stream_close(out);
  return text;
}

/* Lines that the same makes are told together. */
void vs_causes_show(const vs_causes *c, FILE *out) {
  char name[VS_JUDGED_NAME], *text[VS_CAUSES_MOST];
  for (size_t k = 0; k < c->count; k++) text[k] = text_of(&c->item[k]);
  for (size_t k = 0; k < c->count; k++) {
    if (!text[k]) continue;
    fprintf(out, "why %s", vs_verdict_name(c->item[k].of, name));
    for (size_t n = k + 1; n < c->count; n++) {
      if (!text[n] || strcmp(text[n], text[k])) continue;
      fprintf(out, ", %s", vs_verdict_name(c->item[n].of, name));
      free(text[n]), text[n] = NULL;
    }
    fprintf(out, ": %s\n", text[k]);
    free(text[k]);
  }
  if (c->left_out)
    fprintf(out, "why: %zu more violated line%s left out\n", c->left_out,
            c->left_out > 1 ? "s are" : " is");
}

static void add_happening(vs_json *json, const happening *h, double at_s) {
  if (isnan(h->at_s)) return;
  vs_json_object(json, NULL, VS_JSON_ROW);
  vs_json_text(json, "what", h->what);
  vs_json_number(json, "at_s", h->at_s, 9);
  vs_json_number(json, "before_s", at_s - h->at_s, 6);
  vs_json_end(json);
}

void vs_causes_json(const vs_causes *c, const vs_judgement *of, vs_json *json) {
  static const char *const FORMS[] = {"value", "largest of a sum over time", "rise", "fall"};
  const cause *one = NULL;
  for (size_t k = 0; c && k < c->count; k++)
    if (c->item[k].of == of) one = &c->item[k];
  if (!one) return;
  vs_json_object(json, "cause", VS_JSON_ROW);
  if (one->told) {
    vs_json_text(json, "of", FORMS[one->form]);
    vs_json_number(json, "at_s", one->found_s, 9);
    if (one->form >= RISE) vs_json_number(json, "over_s", one->over_s, 9);
    if (one->form == OVER_TIME && one->sum > 0) {
      vs_json_number(json, "most_from_s", one->part_from_s, 9);
      vs_json_number(json, "most", one->part / one->sum, 6);
    }
    vs_json_number(json, "total", one->total, 9);
    vs_json_text(json, "unit", one->voltage ? "V" : "A");
    vs_json_array(json, "shares", VS_JSON_ROW);
    for (size_t n = 0; n < one->shares.count; n++) {
      vs_json_object(json, NULL, VS_JSON_ROW);
      vs_json_text(json, "from", one->shares.item[n].of);
      vs_json_number(json, "value", one->shares.item[n].value, 9);
      vs_json_end(json);
    }
    vs_json_end(json);
    vs_json_number(json, "sum_error", one->sum_error, 3);
  } else {
    vs_json_text(json, "unknown", one->note);
  }
  vs_json_array(json, "events", VS_JSON_ROW);
  add_happening(json, &one->event, one->at_s);
  add_happening(json, &one->deed, one->at_s);
  vs_json_end(json);
  vs_lacks_json("assumed", one->assumed.text, json);
  if (one->typical.length) vs_lacks_json("typical", one->typical.text, json);
  vs_json_end(json);
}
