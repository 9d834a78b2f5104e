/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "watch/measures.h"

#include <assert.h>
#include <gsl/gsl_errno.h>
#include <math.h>

#include "base/text.h"
#include "drive/gate.h"

const vs_measure vs_measures_standard[VS_MEASURES] = {
#define VS_MEASURE_ROW(id, name, unit, text) {name, unit, text},
    VS_MEASURE_LIST(VS_MEASURE_ROW)
#undef VS_MEASURE_ROW
};

static const struct {
  int measure, channel, sense;
} STANDARD[] = {
#define VS_EXTREME_ROW(measure, channel, sense) {measure, channel, sense},
    VS_EXTREME_LIST(VS_EXTREME_ROW)
#undef VS_EXTREME_ROW
};
_Static_assert(sizeof STANDARD / sizeof *STANDARD == VS_STANDARD_EXTREMES, "counted by its rows");

/* The resonance and the decay are read up to this instant, as the paper's figures are. */
static const double SWING_ENDS_S = 1.0;
/* An extremum this much smaller than a later one was no motion peak but a ripple before it. */
static const double RIPPLE = 0.01;

vs_measures *vs_measures_new(const vs_frame *frame) {
  vs_measures *m = vs_alloc(1, sizeof *m);
  m->frame = frame;
  for (int k = 0; k < VS_STANDARD_EXTREMES; k++) {
    int channel = STANDARD[k].channel;
    if (channel < 0) channel = vs_channel_rates2(frame->model) - 1 - channel;
    m->extremes[m->n_extremes++] = (vs_extreme){.channel = channel, .sense = STANDARD[k].sense};
  }
  for (int c = vs_channel_deck(frame->model); c < vs_channel_count(frame); c++)
    for (int sense = -1; sense <= 1; sense += 2)
      m->extremes[m->n_extremes++] = (vs_extreme){.channel = c, .sense = sense};
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
} course;

static double value_at(double t_s, void *user) {
  const course *c = user;
  const vs_kept_step *newer = &c->measures->kept[c->measures->last];
  const vs_kept_step *older = &c->measures->kept[1 - c->measures->last];
  const vs_kept_step *in = c->measures->steps > 1 && t_s < newer->from.t_s ? older : newer;
  return vs_step_channel(&in->step, t_s, c->channel);
}

/* The instant between lo and hi at which the channel is 0; NaN where it does not change sign there.
 */
static double find_root(const vs_measures *m, course *c, double lo, double hi) {
  gsl_function f = {value_at, c};
  double at_lo = value_at(lo, c), at_hi = value_at(hi, c);
  if (!(lo < hi) || !(at_lo * at_hi < 0)) return NAN;
  if (gsl_root_fsolver_set(m->solver, &f, lo, hi)) return NAN;
  for (int n = 0; n < 100; n++) {
    if (gsl_root_fsolver_iterate(m->solver)) break;
    double a = gsl_root_fsolver_x_lower(m->solver), b = gsl_root_fsolver_x_upper(m->solver);
    if (gsl_root_test_interval(a, b, 0, 1e-14) == GSL_SUCCESS) break;
  }
  return gsl_root_fsolver_root(m->solver);
}

/* The extremum of p around the middle of three knots. */
static vs_value refine(const vs_measures *m) {
  vs_value turn = {true, m->travel_m[1], m->kept[m->last].from.t_s};
  if (!vs_extreme_turn_of_travel(&m->kept[1 - m->last].step, &turn))
    vs_extreme_turn_of_travel(&m->kept[m->last].step, &turn);
  return turn;
}

/* ---- what is followed from step to step ---- */

/* True: the middle one of the three values of p is an extremum. */
static bool turns(const vs_measures *m) {
  double a = m->travel_m[0], b = m->travel_m[1], c = m->travel_m[2];
  return (b >= a && b > c) || (b <= a && b < c);
}

const vs_extreme *vs_measures_of_probe(const vs_measures *m, int probe) {
  const vs_extreme *pair = &m->extremes[VS_STANDARD_EXTREMES + 2 * probe];
  assert(pair[0].channel == vs_channel_deck(m->frame->model) + probe && pair[0].sense < 0);
  assert(pair[1].channel == vs_channel_deck(m->frame->model) + probe && pair[1].sense > 0);
  return pair;
}

double vs_measures_slack(const vs_measures *m, const vs_rating *r) {
  const vs_extreme *pair = vs_measures_of_probe(m, r->probe);
  double range = r->max - r->min, size = fmax(fabs(pair[0].best.value), fabs(pair[1].best.value));
  return m->frame->tolerance * (isfinite(range) ? range : size);
}

/* Notes when the probe of a rating first leaves the rating's range. */
static void follow_rating(vs_measures *m, size_t k) {
  const vs_rating *r = &m->frame->deck->ratings[k];
  const vs_probe *probe = &m->frame->deck->probes[r->probe];
  const vs_kept_step *s = &m->kept[m->last];
  double before = probe->sign * s->from.terms[probe->term];
  double now = probe->sign * s->to.terms[probe->term];
  if (!isnan(m->passed_s[k]) || (now <= r->max && now >= r->min)) return;
  double end = now > r->max ? r->max : r->min;
  if (end == 0 && fabs(now) <= vs_measures_slack(m, r)) return;
  double part = (end - before) / (now - before);
  m->passed_s[k] = s->from.t_s + fmin(fmax(part, 0), 1) * (s->to.t_s - s->from.t_s);
}

static bool swings_freely(const vs_measures *m, double t_s) {
  return t_s > m->extinct_s && t_s <= SWING_ENDS_S && !(t_s > m->refired_s);
}

/* Follows the motion peaks after the first firing. In the free swing it also sums up the logarithm
 * of half the way between neighbouring extremes, which slower modes below the swing do not move. */
static void follow_peaks(vs_measures *m) {
  if (m->steps < 2 || !turns(m)) return;
  double middle = m->kept[m->last].from.t_s;
  bool free_swing = swings_freely(m, middle);
  bool wanted =
      !m->first.known || !m->second.known || fabs(m->first.value) < RIPPLE * fabs(m->travel_m[1]);
  if (!(middle > m->fired_s) || (!wanted && !free_swing)) return;
  vs_value v = refine(m);
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
  if (!(m->travel_m[1] < 0 && m->travel_m[2] > 0) || !swings_freely(m, s->to.t_s)) return;
  course c = {m, VS_CH_TRAVEL};
  double t = find_root(m, &c, s->from.t_s, s->to.t_s);
  if (isnan(t) || !swings_freely(m, t)) return;
  if (m->crossings++ == 0) m->first_crossing_s = t;
  m->last_crossing_s = t;
}

/* True: the firing at t_s goes on with the conduction before it. Below its latching current a
 * thyristor goes out between two sub-pulses of its gate and is fired by the next one. That was no
 * extinction, and no free swing followed it. */
static bool goes_on(const vs_measures *m, double t_s) {
  return t_s - m->extinct_s <= 1.01 / m->frame->timeline->firing.burst_hz && isnan(m->refired_s) &&
         vs_gate_is_on(m->frame->timeline, 0, t_s);
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
  if (event == VS_EV_JAMS) m->jammed = true;
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
  m->travel_m[0] =
      m->steps == 1 ? vs_mechanics_travel(m->frame->model, step->from->x) : m->travel_m[1];
  m->travel_m[1] = vs_mechanics_travel(m->frame->model, step->from->x);
  m->travel_m[2] = vs_mechanics_travel(m->frame->model, step->to->x);
  for (int k = 0; k < m->n_extremes; k++) vs_extreme_follow(&m->extremes[k], step, m->jammed);
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
