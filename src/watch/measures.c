/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "watch/measures.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <string.h>

#include "base/text.h"

const vs_measure vs_measures_known[VS_MEASURES] = {
#define VS_MEASURE_ROW(id, name, unit, text) {name, unit, text},
    VS_MEASURE_LIST(VS_MEASURE_ROW)
#undef VS_MEASURE_ROW
};

/* which measure is which extreme; the order of vs_measures.extremes */
static const struct {
  int measure, channel, sense;
} STANDARD[VS_STANDARD_EXTREMES] = {
    {VS_M_I_PEAK, VS_CH_I, 1},   {VS_M_FORCE_PEAK, VS_CH_FORCE, 1}, {VS_M_P_MIN, VS_CH_P, -1},
    {VS_M_P_MAX, VS_CH_P, 1},    {VS_M_AP_PEAK, VS_CH_AP, 0},       {VS_M_AU_PEAK, VS_CH_AU, 0},
    {VS_M_AW_PEAK, VS_CH_AW, 0},
};

/* The resonance and the decay are read up to here, as the paper's figures are. */
static const double SWING_ENDS_S = 1.0;
/* An extremum this much smaller than a later one was no motion peak but a ripple before it. */
static const double RIPPLE = 0.01;

vs_measures *vs_measures_new(const vs_frame *frame) {
  vs_measures *m = vs_alloc(1, sizeof *m);
  m->frame = frame;
  for (int k = 0; k < VS_STANDARD_EXTREMES; k++)
    m->extremes[m->n_extremes++] =
        (vs_extreme){.channel = STANDARD[k].channel, .sense = STANDARD[k].sense};
  for (int c = VS_CH_DECK; c < vs_channel_count(frame); c++)
    for (int sense = -1; sense <= 1; sense += 2)
      m->extremes[m->n_extremes++] = (vs_extreme){.channel = c, .sense = sense};
  for (int k = 0; k < m->n_extremes; k++) m->parts |= vs_parts_of(&m->extremes[k].channel, 1);
  for (int k = 0; k < VS_DECK_MOST; k++) m->passed_s[k] = NAN;
  m->fired_s = m->extinct_s = m->refired_s = NAN;
  m->solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
  return m;
}

void vs_measures_free(vs_measures *m) {
  if (m) gsl_root_fsolver_free(m->solver);
  free(m);
}

/* ---- roots on the dense output of the last two steps ---- */

typedef struct course {
  const vs_measures *measures;
  int channel;
  double delta_s; /* > 0: the slope is meant, by differences over this; 0: the value */
} course;

static double value_at(const course *c, double t_s) {
  const vs_kept_step *newer = &c->measures->kept[c->measures->last];
  const vs_kept_step *older = &c->measures->kept[1 - c->measures->last];
  const vs_kept_step *in = c->measures->steps > 1 && t_s < newer->from.t_s ? older : newer;
  return vs_step_channel(&in->step, t_s, c->channel);
}

/* value, or slope by the central difference of fourth order: (8 D(d) - D(2d))/12d, D(d) = f(t+d) -
 * f(t-d) */
static double course_function(double t_s, void *user) {
  const course *c = user;
  double d = c->delta_s;
  if (d <= 0) return value_at(c, t_s);
  return (8 * (value_at(c, t_s + d) - value_at(c, t_s - d)) -
          (value_at(c, t_s + 2 * d) - value_at(c, t_s - 2 * d))) /
         (12 * d);
}

/* Root of the function between lo and hi; NaN when it does not change sign there. */
static double find_root(const vs_measures *m, course *c, double lo, double hi) {
  gsl_function f = {course_function, c};
  double at_lo = course_function(lo, c), at_hi = course_function(hi, c);
  if (!(lo < hi) || !(at_lo * at_hi < 0)) return NAN;
  if (gsl_root_fsolver_set(m->solver, &f, lo, hi)) return NAN;
  for (int n = 0; n < 100; n++) {
    if (gsl_root_fsolver_iterate(m->solver)) break;
    double a = gsl_root_fsolver_x_lower(m->solver), b = gsl_root_fsolver_x_upper(m->solver);
    if (gsl_root_test_interval(a, b, 0, 1e-14) == GSL_SUCCESS) break;
  }
  return gsl_root_fsolver_root(m->solver);
}

/* The extremum of a channel around the middle of three knots. */
static vs_value refine(const vs_measures *m, int channel) {
  const vs_kept_step *older = &m->kept[1 - m->last], *newer = &m->kept[m->last];
  double lo = older->from.t_s, hi = newer->to.t_s, middle = newer->from.t_s;
  course c = {m, channel, 0.01 * fmin(middle - lo, hi - middle)};
  if (channel < VS_CH_VP) c = (course){m, channel + VS_CH_VP, 0}; /* its slope is a channel */
  double t = find_root(m, &c, lo + 2 * c.delta_s, hi - 2 * c.delta_s);
  vs_value at_knot = {true, m->y[1][channel], middle};
  if (isnan(t)) return at_knot;
  c = (course){m, channel, 0};
  return (vs_value){true, value_at(&c, t), t};
}

/* The extremum of a displacement in the newest step, which its velocity says is there. */
static vs_value refine_in_step(const vs_measures *m, int channel) {
  const vs_kept_step *step = &m->kept[m->last];
  course slope = {m, channel + VS_CH_VP, 0}, c = {m, channel, 0};
  double t = find_root(m, &slope, step->from.t_s, step->to.t_s);
  if (isnan(t)) t = step->to.t_s; /* the velocity is 0 there */
  return (vs_value){true, value_at(&c, t), t};
}

/* ---- what is followed from step to step ---- */

/* +1: the middle of the three values is a maximum, -1: a minimum, 0: neither */
static int turn(const vs_measures *m, int channel) {
  double a = m->y[0][channel], b = m->y[1][channel], c = m->y[2][channel];
  return b >= a && b > c ? 1 : b <= a && b < c ? -1 : 0;
}

/* The same of a displacement in the newest step, by its velocity. */
static int turn_in_step(const vs_measures *m, int channel) {
  double before = m->y[1][channel + VS_CH_VP], now = m->y[2][channel + VS_CH_VP];
  return before > 0 && now <= 0 ? 1 : before < 0 && now >= 0 ? -1 : 0;
}

static void follow_extreme(vs_measures *m, vs_extreme *e) {
  double now = m->y[2][e->channel], sign = e->sense, begin = m->y[1][e->channel];
  if (!e->best.known)
    e->best = (vs_value){true, e->sense ? begin : fabs(begin), m->kept[m->last].from.t_s};
  if (!e->sense) sign = now < 0 ? -1 : 1;
  double reach = e->sense ? e->sense * e->best.value : e->best.value;
  if (sign * now > reach) {
    reach = sign * now;
    e->best = (vs_value){true, e->sense ? now : fabs(now), m->kept[m->last].to.t_s};
  }
  bool slope = e->channel < VS_CH_VP; /* is a channel, too */
  int turns = slope ? turn_in_step(m, e->channel) : m->steps > 1 ? turn(m, e->channel) : 0;
  double middle = m->y[1][e->channel];
  if (!turns || (e->sense && turns != e->sense) || (!e->sense && turns * middle < 0)) return;
  if (turns * middle < reach - 0.1 * fabs(reach))
    return; /* between knots it cannot gain that much */
  vs_value v = slope ? refine_in_step(m, e->channel) : refine(m, e->channel);
  if (turns * v.value > reach)
    e->best = (vs_value){true, e->sense ? v.value : fabs(v.value), v.at_s};
  else if (e->best.at_s == m->kept[m->last].from.t_s)
    e->best.at_s = v.at_s; /* a plateau to rounding: the root says when */
}

/* When the probe of a rating first leaves its range. */
static void follow_rating(vs_measures *m, size_t k) {
  const vs_rating *r = &m->frame->deck->ratings[k];
  double before = m->y[1][VS_CH_DECK + r->probe], now = m->y[2][VS_CH_DECK + r->probe];
  if (!isnan(m->passed_s[k]) || (now <= r->max && now >= r->min)) return;
  const vs_kept_step *s = &m->kept[m->last];
  double part = ((now > r->max ? r->max : r->min) - before) / (now - before);
  m->passed_s[k] = s->from.t_s + fmin(fmax(part, 0), 1) * (s->to.t_s - s->from.t_s);
}

static bool swings_freely(const vs_measures *m, double t_s) {
  return t_s > m->extinct_s && t_s <= SWING_ENDS_S && !(t_s > m->refired_s);
}

/* Motion peaks after the first firing; in the free swing also ln of half the way between
 * neighbouring extremes, which slower modes below the swing do not move. */
static void follow_peaks(vs_measures *m) {
  if (m->steps < 2 || !turn(m, VS_CH_P)) return;
  double middle = m->kept[m->last].from.t_s;
  bool free_swing = swings_freely(m, middle);
  bool wanted =
      !m->first.known || !m->second.known || fabs(m->first.value) < RIPPLE * fabs(m->y[1][VS_CH_P]);
  if (!(middle > m->fired_s) || (!wanted && !free_swing)) return;
  vs_value v = refine(m, VS_CH_P);
  if (!m->first.known || fabs(m->first.value) < RIPPLE * fabs(v.value)) {
    m->first = v;
    m->second.known = false;
  } else if (!m->second.known)
    m->second = v;
  if (!free_swing) return;
  if (m->swing.known) {
    double t = (m->swing.at_s + v.at_s) / 2, l = log(fabs(m->swing.value - v.value) / 2);
    m->n++;
    m->st += t;
    m->sl += l;
    m->stt += t * t;
    m->stl += t * l;
  }
  m->swing = v;
}

static void follow_crossings(vs_measures *m) {
  const vs_kept_step *s = &m->kept[m->last];
  if (!(m->y[1][VS_CH_P] < 0 && m->y[2][VS_CH_P] > 0) || !swings_freely(m, s->to.t_s)) return;
  course c = {m, VS_CH_P, 0};
  double t = find_root(m, &c, s->from.t_s, s->to.t_s);
  if (isnan(t) || !swings_freely(m, t)) return;
  if (!m->crossings++) m->first_crossing_s = t;
  m->last_crossing_s = t;
}

/* Below its latching current a thyristor goes out between two sub-pulses of its gate, and is fired
 * by the next one: it was no extinction, and what was read of a free swing is none. */
static bool goes_on(const vs_measures *m, double t_s) {
  return t_s - m->extinct_s <= 1.01 / m->frame->timeline->firing.burst_hz && isnan(m->refired_s);
}

static void follow_event(vs_measures *m, vs_event event, double t_s) {
  if (event == VS_EV_FIRES && isnan(m->fired_s))
    m->fired_s = t_s;
  else if (event == VS_EV_FIRES && goes_on(m, t_s)) {
    m->extinct_s = NAN;
    m->n = m->st = m->sl = m->stt = m->stl = m->crossings = 0;
    m->swing.known = false;
  } else if (event == VS_EV_FIRES && isnan(m->refired_s))
    m->refired_s = t_s;
  if (event == VS_EV_EXTINCT && isnan(m->extinct_s)) m->extinct_s = t_s;
}

void vs_measures_accept(vs_measures *m, const vs_step *step) {
  for (int k = 0; k < 2; k++) follow_event(m, step->event[k], step->event_s[k]);
  if (step->to->t_s == step->from->t_s) return;
  m->last = 1 - m->last;
  if (m->steps < 2) m->steps++;
  vs_kept_step *kept = &m->kept[m->last];
  vs_knot_copy(m->frame, step->from, &kept->from);
  vs_knot_copy(m->frame, step->to, &kept->to);
  kept->step = *step;
  kept->step.from = &kept->from;
  kept->step.to = &kept->to;
  size_t row = (size_t)vs_channel_count(m->frame) * sizeof(double);
  if (m->steps == 1) {
    vs_step_parts_at(step, step->from->t_s, m->parts, m->y[1]);
  } else {
    memcpy(m->y[0], m->y[1], row);
    memcpy(m->y[1], m->y[2], row);
  }
  vs_step_parts_at(step, step->to->t_s, m->parts, m->y[2]);
  for (int k = 0; k < m->n_extremes; k++) follow_extreme(m, &m->extremes[k]);
  for (size_t k = 0; m->frame->deck && k < m->frame->deck->n_ratings; k++) follow_rating(m, k);
  follow_peaks(m);
  follow_crossings(m);
}

void vs_measures_finish(const vs_measures *m, vs_value values[VS_MEASURES]) {
  for (int k = 0; k < VS_MEASURES; k++) values[k] = (vs_value){.at_s = NAN};
  for (int k = 0; k < VS_STANDARD_EXTREMES; k++) values[STANDARD[k].measure] = m->extremes[k].best;
  values[VS_M_P_FIRST] = m->first;
  values[VS_M_P_SECOND] = m->second;
  if (!isnan(m->fired_s)) values[VS_M_T_FIRE] = (vs_value){true, m->fired_s, NAN};
  if (!isnan(m->extinct_s)) {
    values[VS_M_T_EXTINCTION] = (vs_value){true, m->extinct_s, NAN};
    values[VS_M_CONDUCTION] = (vs_value){true, m->extinct_s - m->fired_s, NAN};
  }
  if (m->crossings >= 2)
    values[VS_M_F_RESONANCE] =
        (vs_value){true, (m->crossings - 1) / (m->last_crossing_s - m->first_crossing_s), NAN};
  /* ln A = const - t/tau, least squares */
  double slope = (m->n * m->stl - m->st * m->sl) / (m->n * m->stt - m->st * m->st);
  if (m->n >= 3 && slope < 0) values[VS_M_TAU_P] = (vs_value){true, -1 / slope, NAN};
}
