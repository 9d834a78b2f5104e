/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/quality.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- the key ---- */

static const char KEY[] = "quality";
const char vs_quality_mains[] = "mains", vs_quality_none[] = "none";

/* How many cycles of the mains the means are over; NaN: no whole number. */
static double cycles_of_quality(const vs_setup *setup) {
  const double SAME = 1e-6; /* of a cycle: its length is written with few digits */
  double n = (setup->means.to_s - setup->means.from_s) / setup->timeline.period_s;
  return n > 0.5 && fabs(n - round(n)) < SAME ? round(n) : NAN;
}

static vs_status refuse_current(const vs_node *node, const vs_setup *setup, const vs_frame *frame,
                                vs_error *err) {
  const char *names[VS_CH_MOST + 1], *name = node->kind == VS_NODE_TEXT ? node->text : "a list";
  int numbers[VS_CH_MOST];
  size_t n = 0;
  vs_frame full = *frame;
  full.deck = &setup->deck;
  if (setup->deck.lost & VS_LOST_PROBE) return VS_OK; /* a check carries on: it may be that one */
  if (vs_channel_find(&full, name) >= 0)
    return vs_fail_at(err, node->where, "quality: %s exists only where a deck is run; take tier %s",
                      name, vs_setup_tier_words[VS_TIER_CIRCUIT]);
  for (int k = 0, listed = vs_channel_listed(&full, numbers); k < listed; k++)
    if (!strcmp(vs_channel_at(&full, numbers[k]).unit, "A"))
      names[n++] = vs_channel_at(&full, numbers[k]).name;
  names[n++] = vs_quality_mains;
  return vs_fail_at(
      err, node->where, "quality: no current '%s'%s", name,
      vs_text_hint(name, names, n, "; see 'vibrospice list probes', or write mains").text);
}

static vs_status take_current(const vs_node *node, const vs_setup *setup, const vs_frame *frame,
                              vs_quality_list *list, vs_error *err) {
  bool word = node->kind == VS_NODE_TEXT, mains = word && !strcmp(node->text, vs_quality_mains);
  int channel = mains ? VS_CH_I_MAINS : word ? vs_channel_find(frame, node->text) : -1;
  if (channel < 0) return refuse_current(node, setup, frame, err);
  const char *unit = vs_channel_at(frame, channel).unit;
  if (strcmp(unit, "A"))
    return vs_fail_at(err, node->where, "quality: %s is in %s; a current is wanted", node->text,
                      *unit ? unit : "no unit");
  for (int k = 0; k < list->count; k++)
    if (!strcmp(list->item[k].name, node->text))
      return vs_fail_at(err, node->where, "quality: %s stands here a second time; leave one out",
                        node->text);
  for (size_t k = 0; frame->deck && k < frame->deck->n_devices; k++)
    if (!strcmp(frame->deck->devices[k].name, node->text))
      return vs_fail_at(err, node->where,
                        "quality: a device of the deck is called %s, too, and both have measures "
                        "of that name; give the device another one",
                        node->text);
  if (list->count == VS_QUALITY_MOST)
    return vs_fail_at(err, node->where, "quality: more than %d currents", VS_QUALITY_MOST);
  vs_quality_current *c = &list->item[list->count++];
  snprintf(c->name, sizeof c->name, "%s", node->text);
  c->channel = channel;
  return VS_OK;
}

vs_status vs_quality_read(const vs_node *node, const vs_setup *setup, const vs_frame *frame,
                          bool of_period, vs_quality_list *list, vs_error *err) {
  const bool text = node && node->kind == VS_NODE_TEXT;
  vs_status s = VS_OK;
  list->count = 0;
  if (!node || (text && !*node->text) || (text && !strcmp(node->text, vs_quality_none)))
    return VS_OK;
  if (node->kind == VS_NODE_MAP || (node->kind == VS_NODE_LIST && !node->child))
    return vs_error_keep(
        err,
        vs_fail_at(err, node->where, "%s: a list of currents is wanted: [mains], or none", KEY));
  if (setup->timeline.supply.direct)
    return vs_error_keep(err, vs_fail_at(err, node->where,
                                         "%s: the mains are a direct voltage, without cycles; "
                                         "leave it out",
                                         KEY));
  for (const vs_node *n = text ? node : node->child; n && !s; n = text ? NULL : n->next)
    s = vs_error_keep(err, take_current(n, setup, frame, list, err));
  if (s || of_period || !isnan(cycles_of_quality(setup))) return s;
  return vs_error_keep(
      err, vs_fail_at(err, node->where,
                      "%s: whole cycles of the mains are wanted, and means are over %.9g s, which "
                      "is %.6g; write measure: {last: 5 cycles}",
                      KEY, setup->means.to_s - setup->means.from_s,
                      (setup->means.to_s - setup->means.from_s) / setup->timeline.period_s));
}

/* ---- along a run ---- */

void vs_quality_begin(vs_quality *q, const vs_quality_current *current, const vs_setup *setup) {
  *q = (vs_quality){.channel = current->channel, .over = setup->means};
  int every = setup->timeline.firing.every > 0 ? setup->timeline.firing.every : 1;
  double cycles = cycles_of_quality(setup);
  memcpy(q->name, current->name, sizeof q->name);
  q->cycles = isnan(cycles) ? 0 : (int)cycles;
  q->half = setup->at_work ? 0 : q->cycles / 2 / every * every;
  vs_spectrum_begin(&q->current, setup->timeline.omega_rad_s);
  vs_spectrum_begin_groups(&q->current, q->over.from_s, q->cycles,
                           setup->at_work ? q->cycles : every);
}

void vs_quality_end(vs_quality *q) {
  vs_spectrum_end(&q->current);
}

static void add_point_of_current(vs_quality *q, double t_s, double weight_s, const double *y) {
  double i = y[q->channel], v = y[VS_CH_V_MAINS], angle = q->current.omega_rad_s * t_s;
  vs_spectrum_add(&q->current, t_s, weight_s, i);
  q->voltage[0] += weight_s * v * cos(angle);
  q->voltage[1] += weight_s * v * sin(angle);
  q->voltage_squared += weight_s * v * v;
  q->energy_j += weight_s * v * i;
}

/* A piece of a step, over which the integrals are taken by one application of the rule. It lies
 * wholly within or without each of the two ends that are compared. */
static void add_piece_of_current(vs_quality *q, const vs_step *step, vs_span_s piece,
                                 const gsl_integration_glfixed_table *rule) {
  const unsigned groups = VS_GROUP_V_MAINS | vs_channel_groups(step->frame->model, &q->channel, 1);
  const double length_s = q->half * 2 * M_PI / q->current.omega_rad_s;
  double y[VS_CH_MOST], before = q->current.squared;
  for (size_t k = 0; k < rule->n; k++) {
    double t, weight;
    gsl_integration_glfixed_point(piece.from_s, piece.to_s, k, &t, &weight, rule);
    vs_step_groups_at(step, t, groups, y);
    add_point_of_current(q, t, weight, y);
  }
  double middle_s = (piece.from_s + piece.to_s) / 2, added = q->current.squared - before;
  if (middle_s < q->over.from_s + length_s) q->ends_squared[0] += added;
  if (middle_s > q->over.to_s - length_s) q->ends_squared[1] += added;
}

/* A stretch of a step, on one side of each cut, and within one cycle where groups are told. */
static void add_part_of_current(vs_quality *q, const vs_step *step, vs_span_s over) {
  const double length_s = over.to_s - over.from_s;
  gsl_integration_glfixed_table *rule;
  const int pieces = vs_spectrum_pieces(&q->current, length_s, &rule);
  for (int p = 0; p < pieces; p++)
    add_piece_of_current(
        q, step,
        (vs_span_s){over.from_s + length_s * p / pieces, over.from_s + length_s * (p + 1) / pieces},
        rule);
}

/* A stretch of a step, on one side of each cut. */
static void add_stretch_of_current(vs_quality *q, const vs_step *step, vs_span_s over) {
  double cut;
  for (; (cut = vs_spectrum_cut(&q->current, over.from_s)) < over.to_s; over.from_s = cut)
    add_part_of_current(q, step, (vs_span_s){over.from_s, cut});
  add_part_of_current(q, step, over);
}

void vs_quality_accept(vs_quality *q, const vs_step *step) {
  double from_s = fmax(step->from->t_s, q->over.from_s), to_s = fmin(step->to->t_s, q->over.to_s);
  const double ends_s = q->half * 2 * M_PI / q->current.omega_rad_s;
  const double cuts_s[] = {q->over.from_s + ends_s, q->over.to_s - ends_s};
  if (!(to_s > from_s)) return; /* the other side of an instant, or beyond the stretch */
  q->current.span_s += to_s - from_s;
  for (int k = 0; k < 2; k++)
    if (cuts_s[k] > from_s && cuts_s[k] < to_s) {
      add_stretch_of_current(q, step, (vs_span_s){from_s, cuts_s[k]});
      from_s = cuts_s[k];
    }
  add_stretch_of_current(q, step, (vs_span_s){from_s, to_s});
}

/* ---- what it comes to ---- */

double vs_quality_displacement(const double current[2], const double voltage[2]) {
  double product = current[0] * voltage[0] + current[1] * voltage[1];
  return product / (hypot(current[0], current[1]) * hypot(voltage[0], voltage[1]));
}

double vs_quality_thc(const vs_spectrum *s) {
  double sum = 0;
  for (int n = 2; n < VS_SPECTRUM_LINES; n++) {
    double each = vs_spectrum_harmonic(s, n);
    sum += each * each;
  }
  return sqrt(sum);
}

static double mean_power_w(const vs_quality *q) {
  return q->energy_j / q->current.span_s;
}

static double rms(const vs_quality *q) {
  return vs_spectrum_rms(&q->current);
}

static double mean(const vs_quality *q) {
  return vs_spectrum_mean(&q->current);
}

static double thc(const vs_quality *q) {
  return vs_quality_thc(&q->current);
}

static double thd(const vs_quality *q) {
  return thc(q) / vs_spectrum_harmonic(&q->current, 1);
}

/* What rounding leaves of nothing may be below 0. */
static double others(const vs_quality *q) {
  double sum = rms(q) * rms(q) - mean(q) * mean(q) - thc(q) * thc(q);
  return sqrt(fmax(sum - pow(vs_spectrum_harmonic(&q->current, 1), 2), 0));
}

static double power_factor(const vs_quality *q) {
  return mean_power_w(q) / (rms(q) * sqrt(q->voltage_squared / q->current.span_s));
}

static double displacement(const vs_quality *q) {
  const double current[2] = {q->current.cosine[1], q->current.sine[1]};
  return vs_quality_displacement(current, q->voltage);
}

static double worst_part_of_limits(const vs_quality *q) {
  const vs_drawn_current drawn = vs_quality_drawn(q);
  double part;
  vs_harmonic_classes_worst(&vs_harmonic_classes_all[0], &drawn, &part);
  return part;
}

vs_drawn_current vs_quality_drawn(const vs_quality *q) {
  return (vs_drawn_current){&q->current, mean_power_w(q), power_factor(q)};
}

/* A harmonic below this part of the root mean square is rounding. */
static const double NOTHING = 1e-12;

double vs_quality_phase(const vs_quality *q, int n) {
  if (n == 0 || !(vs_spectrum_harmonic(&q->current, n) > NOTHING * rms(q))) return NAN;
  return atan2(q->current.cosine[n], q->current.sine[n]);
}

static const struct {
  const char *name, *unit, *text;
  double (*of)(const vs_quality *q);
} MEASURES[] = {
    {"power", "W", "mean of the mains' voltage times this current", mean_power_w},
    {"i_rms", "A", "root mean square of the current", rms},
    {"i_dc", "A", "its mean, the direct part", mean},
    {"thc", "A", "root of the sum of squares of harmonics 2 to 40", thc},
    {"thd", "", "the same over harmonic 1", thd},
    {"i_other", "A", "rms of what is no harmonic from 0 to 40", others},
    {"power_factor", "", "power over the product of the voltage's and the current's rms",
     power_factor},
    {"displacement_factor", "", "cosine of the angle between harmonic 1 and that of the voltage",
     displacement},
    {"harmonic_part", "", "largest part that a harmonic takes of its limit in class A",
     worst_part_of_limits},
};
enum { N_MEASURES = sizeof MEASURES / sizeof *MEASURES };

bool vs_quality_at(const vs_quality *q, int k, bool harmonics, vs_quality_measure *m) {
  const bool known = q->current.span_s > 0;
  double value = NAN;
  int n = k - N_MEASURES;
  if (k >= N_MEASURES + (harmonics ? VS_SPECTRUM_LINES : 0)) return false;
  if (n < 0) {
    snprintf(m->name, sizeof m->name, "%s.%s", q->name, MEASURES[k].name);
    m->unit = MEASURES[k].unit;
    m->text = MEASURES[k].text;
    if (known) value = MEASURES[k].of(q);
  } else {
    snprintf(m->name, sizeof m->name, "%s.harmonic_%d", q->name, n);
    m->unit = "A";
    m->text = "rms of that harmonic of the current; 0: the size of its mean";
    if (known) value = vs_spectrum_harmonic(&q->current, n);
  }
  m->value = (vs_value){isfinite(value), value, NAN};
  return true;
}

bool vs_quality_warning(const vs_quality *q, const vs_setup *setup, char *text, size_t size) {
  /* harmonics are told to compare with limits in per cent */
  const double ALIKE = 0.01;
  double a = q->ends_squared[0], b = q->ends_squared[1];
  int every = setup->timeline.firing.every;
  if (every > 1 && q->cycles % every) {
    snprintf(text, size,
             "quality: %d cycles are no whole firing periods of %d cycles, so what is told of %s "
             "depends on where they begin, and its harmonics are held against no limits",
             q->cycles, every, q->name);
    return true;
  }
  if (!q->half || fabs(a - b) <= 2 * ALIKE * fmax(a, b)) return false;
  double span_s = q->half * setup->timeline.period_s;
  snprintf(text, size,
           "quality: %s has not settled: over the first %d of %d cycles its root mean square is "
           "%.4g A, over the last %d it is %.4g A; what is told is a mean of that",
           q->name, q->half, q->cycles, sqrt(a / span_s), q->half, sqrt(b / span_s));
  return true;
}
