/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/measures.h"

#include <assert.h>
#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/gate.h"
#include "netlist/devices.h"
#include "netlist/kinds.h"

/* ---- names ---- */

static const struct {
  const char *name, *unit, *text;
} STANDARD[VS_STANDARD_MEASURES] = {
#define VS_MEASURE_ROW(id, name, unit, text) {name, unit, text},
    VS_MEASURE_LIST(VS_MEASURE_ROW)
#undef VS_MEASURE_ROW
};

/* The one coordinate that opens or closes the gap by as much as it moves; -1: there is none. */
static int sole(const vs_model *model) {
  int found = -1, movers = 0;
  for (int i = 0; i < model->dof; i++)
    if (model->along[i] != 0) found = i, movers++;
  return movers == 1 && fabs(model->along[found]) == 1 ? found : -1;
}

bool vs_measure_has_alias(const vs_model *model) {
  return sole(model) >= 0;
}

bool vs_measure_pulls_in(int slot) {
  return slot >= VS_M_PULL_IN && slot < VS_M_PULL_IN + VS_PULL_IN_MEASURES;
}

static const vs_coordinate *coordinate_of_measure(const vs_model *model, int i) {
  return &model->machine->coordinates[i];
}

/* Writes a text in which %s may stand for a name. */
static void write_named(char *out, size_t size, const char *text, const char *name) {
  const char *gap = strstr(text, "%s");
  if (gap)
    snprintf(out, size, "%.*s%s%s", (int)(gap - text), text, name, gap + 2);
  else
    snprintf(out, size, "%s", text);
}

static void standard(const vs_model *model, int id, vs_measure *m) {
  int opens = sole(model);
  *m = (vs_measure){.unit = STANDARD[id].unit, .slot = id, .factor = 1};
  snprintf(m->name, sizeof m->name, "%s", STANDARD[id].name);
  write_named(m->text, sizeof m->text, STANDARD[id].text,
              opens < 0 ? "the travel" : coordinate_of_measure(model, opens)->name);
}

/* A measure of the travel under the name of the coordinate that has the same. */
static void alias(const vs_model *model, int id, vs_measure *m) {
  static const struct {
    const char *name, *text;
  } ALIASES[VS_STANDARD_MEASURES] = {
      [VS_M_GAP_FIRST] = {"%s_first_peak", "first peak of %s after the first firing"},
      [VS_M_GAP_SECOND] = {"%s_second_peak", "the extremum of %s after its first peak"},
      [VS_M_TAU_GAP] = {"tau_%s", "decay time of %s in the free swing, by its extremes"}};
  int i = sole(model);
  const vs_coordinate *c = coordinate_of_measure(model, i);
  bool is_time = id == VS_M_TAU_GAP;
  *m = (vs_measure){
      .unit = is_time ? "s" : c->unit, .slot = id, .factor = is_time ? 1 : model->along[i]};
  write_named(m->name, sizeof m->name, ALIASES[id].name, c->name);
  write_named(m->text, sizeof m->text, ALIASES[id].text, c->name);
}

static void of_coordinate(const vs_model *model, int i, int which, vs_measure *m) {
  const vs_coordinate *c = coordinate_of_measure(model, i);
  static const struct {
    const char *name, *text;
  } OF[VS_OF_COORDINATE] = {[VS_LEAST] = {"%s_min", "least %s"},
                            [VS_LARGEST] = {"%s_max", "largest %s"},
                            [VS_PEAK] = {"%s_peak", "largest |acceleration| of %s"}};
  *m = (vs_measure){.unit = which == VS_PEAK ? c->rate2_unit : c->unit,
                    .slot = VS_M_OF_COORDINATE(i, which),
                    .factor = 1};
  write_named(m->name, sizeof m->name, OF[which].name, which == VS_PEAK ? c->rate2 : c->name);
  write_named(m->text, sizeof m->text, OF[which].text, c->name);
}

int vs_measures_count(const vs_model *model) {
  const int left_out =
      (model->pulls_in ? 0 : VS_PULL_IN_MEASURES) + (model->actuator.winding.present ? 0 : 1);
  return VS_STANDARD_MEASURES - left_out + VS_OF_COORDINATE * model->dof +
         (sole(model) < 0 ? 0 : 3);
}

/* Takes the next `count` measures off k; true: the k-th was among them. */
static bool is_among(int *k, int count) {
  if (*k < count) return true;
  *k -= count;
  return false;
}

bool vs_measure_at(const vs_model *model, int k, vs_measure *m) {
  int own = sole(model), dof = model->dof, others = own < 0 ? dof : dof - 1;
  if (k >= vs_measures_count(model)) return false;
  if (is_among(&k, VS_M_GAP_FIRST))
    standard(model, k, m);
  else if (own >= 0 && is_among(&k, 2))
    alias(model, VS_M_GAP_FIRST + k, m);
  else if (own >= 0 && is_among(&k, 2))
    of_coordinate(model, own, k, m);
  else if (is_among(&k, VS_M_F_RESONANCE - VS_M_GAP_FIRST))
    standard(model, VS_M_GAP_FIRST + k, m);
  else if (is_among(&k, 2 * others))
    of_coordinate(model, k / 2 + (own >= 0 && k / 2 >= own), k % 2, m);
  else if (is_among(&k, dof))
    of_coordinate(model, k, VS_PEAK, m);
  else if (is_among(&k, 1))
    standard(model, VS_M_F_RESONANCE, m);
  else if (own >= 0 && is_among(&k, 1))
    alias(model, VS_M_TAU_GAP, m);
  else if (is_among(&k, VS_M_PULL_IN - VS_M_TAU_GAP))
    standard(model, VS_M_TAU_GAP + k, m);
  else if (model->pulls_in && is_among(&k, VS_PULL_IN_MEASURES))
    standard(model, VS_M_PULL_IN + k, m);
  else
    standard(model, VS_M_COIL_T, m);
  return true;
}

/* ---- beginning ---- */

const double vs_measures_swing_ends_s = 1.0;
const double vs_measures_ripple = 0.01;

enum { OF_CURRENT, OF_FORCE, OF_COORDINATES }; /* where these extremes stand */

static void add_measured_extreme(vs_measures *m, int channel, int sense) {
  m->extremes[m->n_extremes++] = (vs_extreme){.channel = channel, .sense = sense};
}

/* Lets be what nobody wants: extremes, of which the travel's may be a coordinate's, and the turns
 * of the travel. */
static void leave_idle(vs_measures *m, const vs_measure_set *wants) {
  const bool travel =
      wants->has[VS_M_GAP_MIN] || wants->has[VS_M_GAP_MAX] || wants->has[VS_M_STROKE];
  for (int i = 0; i < m->frame->model->dof; i++) {
    const bool *of = &wants->has[VS_M_OF_COORDINATE(i, 0)];
    const bool own = of[VS_LEAST] || of[VS_LARGEST] || of[VS_PEAK];
    for (int k = 0; k < VS_OF_COORDINATE; k++)
      m->extremes[OF_COORDINATES + VS_OF_COORDINATE * i + k].idle =
          !own && !(travel && i == sole(m->frame->model));
  }
  for (int k = m->of_travel; k < m->of_probes; k++) m->extremes[k].idle = !travel;
  m->extremes[OF_FORCE].idle = !wants->has[VS_M_FORCE_PEAK];
  m->no_turns = !m->frame->deck && !wants->has[VS_M_GAP_FIRST] && !wants->has[VS_M_GAP_SECOND] &&
                !wants->has[VS_M_F_RESONANCE] && !wants->has[VS_M_TAU_GAP];
}

vs_measures *vs_measures_new(const vs_frame *frame, const vs_measure_set *wants) {
  const vs_model *model = frame->model;
  vs_measures *m = vs_alloc(1, sizeof *m);
  m->frame = frame;
  add_measured_extreme(m, VS_CH_I, 0);
  add_measured_extreme(m, VS_CH_FORCE,
                       model->coil.square ? 1 : 0); /* a square force only closes the gap */
  for (int i = 0; i < model->dof; i++) {
    add_measured_extreme(m, VS_CH_Q + i, -1);
    add_measured_extreme(m, VS_CH_Q + i, 1);
    add_measured_extreme(m, vs_channel_rates2(model) + i, 0);
  }
  m->of_travel = m->n_extremes;
  for (int sense = -1; sense <= 1 && sole(model) < 0; sense += 2)
    add_measured_extreme(m, VS_CH_TRAVEL, sense);
  m->of_probes = m->n_extremes;
  for (int c = vs_channel_deck(model); c < vs_channel_count(frame); c++)
    for (int sense = -1; sense <= 1; sense += 2) add_measured_extreme(m, c, sense);
  if (wants) leave_idle(m, wants);
  for (int k = 0; k < VS_DECK_MOST; k++) m->passed_s[k] = NAN;
  m->fired_s = m->extinct_s = m->refired_s = m->rested_s = NAN;
  m->drives_s = frame->timeline->firing.no_valve ? 0 : NAN;
  m->solver = vs_checked(gsl_root_fsolver_alloc(gsl_root_fsolver_brent));
  return m;
}

void vs_measures_free(vs_measures *m) {
  if (m) gsl_root_fsolver_free(m->solver);
  if (m) free(m->followed);
  free(m);
}

void vs_measures_follow(vs_measures *m, int channel, double min, double max) {
  m->followed = vs_alloc_grow(m->followed, m->n_followed, sizeof *m->followed);
  m->followed[m->n_followed++] =
      (vs_followed){.channel = channel,
                    .min = min,
                    .max = max,
                    .end = {{.channel = channel, .sense = -1}, {.channel = channel, .sense = 1}},
                    .passed_s = NAN};
}

const vs_followed *vs_measures_followed(const vs_measures *m, int channel) {
  for (size_t k = 0; k < m->n_followed; k++)
    if (m->followed[k].channel == channel) return &m->followed[k];
  return NULL;
}

/* ---- roots on the dense output of the last two steps ---- */

typedef struct course {
  const vs_measures *measures;
  int channel;
} course;

static double travel_at(double t_s, void *user) {
  const course *c = user;
  const vs_kept_step *newer = &c->measures->kept[c->measures->last];
  const vs_kept_step *older = &c->measures->kept[1 - c->measures->last];
  const vs_kept_step *in = c->measures->steps > 1 && t_s < newer->from.t_s ? older : newer;
  return vs_step_channel(&in->step, t_s, c->channel);
}

/* The instant between lo and hi at which the channel is 0; NaN where it does not change sign there.
 */
static double find_root(const vs_measures *m, course *c, double lo, double hi) {
  gsl_function f = {travel_at, c};
  double at_lo = travel_at(lo, c), at_hi = travel_at(hi, c);
  if (!(lo < hi) || !(at_lo * at_hi < 0)) return NAN;
  if (gsl_root_fsolver_set(m->solver, &f, lo, hi)) return NAN;
  for (int n = 0; n < 100; n++) {
    if (gsl_root_fsolver_iterate(m->solver)) break;
    double a = gsl_root_fsolver_x_lower(m->solver), b = gsl_root_fsolver_x_upper(m->solver);
    if (gsl_root_test_interval(a, b, 0, 1e-14) == GSL_SUCCESS) break;
  }
  return gsl_root_fsolver_root(m->solver);
}

/* The extremum of the travel around the middle of three knots. */
static vs_value refine(const vs_measures *m) {
  vs_value turn = {true, m->travel_m[1], m->kept[m->last].from.t_s};
  if (!vs_extreme_turn_of_travel(&m->kept[1 - m->last].step, &turn))
    vs_extreme_turn_of_travel(&m->kept[m->last].step, &turn);
  return turn;
}

/* ---- what is followed from step to step ---- */

/* True: the middle one of the three travels is an extremum. */
static bool turns(const vs_measures *m) {
  double a = m->travel_m[0], b = m->travel_m[1], c = m->travel_m[2];
  return (b >= a && b > c) || (b <= a && b < c);
}

const vs_extreme *vs_measures_of_probe(const vs_measures *m, int probe) {
  const vs_extreme *pair = &m->extremes[m->of_probes + 2 * probe];
  assert(pair[0].channel == vs_channel_deck(m->frame->model) + probe && pair[0].sense < 0);
  assert(pair[1].channel == vs_channel_deck(m->frame->model) + probe && pair[1].sense > 0);
  return pair;
}

/* A smooth maximum has steps beside it that are almost as high: with 32 steps in a period of a sine
 * they are lower by a fiftieth. */
static const double SHARP = 0.02;

/* What an extreme of a probe stands out by, in parts of the probe's largest magnitude. Of a current
 * what the coil's may be off by counts at least: nA of a place that is empty are rounding. */
static double sharpness(const vs_measures *m, int probe, int which) {
  const vs_extreme *pair = vs_measures_of_probe(m, probe);
  double size = fmax(fabs(pair[0].best.value), fabs(pair[1].best.value));
  if (!strcmp(m->frame->deck->probes[probe].unit, "A"))
    size = fmax(size, m->frame->tolerance * fabs(m->extremes[OF_CURRENT].best.value));
  return pair[which].best.known && size > 0 ? pair[which].stands / size : 0;
}

/* What a probe may go to either way: the bound of its rating, or the limit of the device whose peak
 * it is; INFINITY: nothing is said. */
static double allowed_of_probe(const vs_deck *deck, int probe) {
  const int term = deck->probes[probe].term;
  double most = INFINITY;
  for (size_t k = 0; k < deck->n_ratings; k++)
    if (deck->ratings[k].probe == probe)
      most = fmin(most, fmin(fabs(deck->ratings[k].min), fabs(deck->ratings[k].max)));
  for (size_t d = 0; d < deck->n_devices; d++) {
    const vs_device *of = &deck->devices[d];
    for (size_t m = 0; of->kind && m < of->kind->n_measures; m++) {
      const vs_device_measure *peak = &of->kind->measures[m];
      int own;
      double factor;
      if (peak->how != VS_R_PEAK || !peak->limit ||
          !vs_formula_is_term(peak->of == VS_OF_I ? &of->current : &of->voltage, &own, &factor) ||
          own != term)
        continue;
      const vs_limit *limit = vs_devices_own_limit(deck, of, peak->limit);
      if (limit) most = fmin(most, limit->value / fabs(factor));
    }
  }
  return most;
}

/* An extreme that is as uncertain as it stands out, and yet far from all that it is held against.
 */
static const double FAR = 0.1;
static bool is_of_no_account(const vs_measures *m, int probe, int which) {
  const vs_extreme *e = &vs_measures_of_probe(m, probe)[which];
  const double most = allowed_of_probe(m->frame->deck, probe);
  return isfinite(most) && fabs(e->best.value) + e->stands < FAR * most;
}

bool vs_measures_are_sharp(const vs_measures *m, char *text, size_t size) {
  const vs_deck *deck = m->frame->deck;
  int worst = -1, which = 0, count = 0;
  for (int k = 0; deck && k < 2 * (int)deck->n_probes; k++) {
    double sharp = sharpness(m, k / 2, k % 2);
    if (!(sharp > SHARP) || is_of_no_account(m, k / 2, k % 2)) continue;
    count++;
    if (worst < 0 || sharp > sharpness(m, worst, which)) worst = k / 2, which = k % 2;
  }
  if (worst < 0) return false;
  const vs_extreme *e = &vs_measures_of_probe(m, worst)[which];
  const vs_probe *probe = &deck->probes[worst];
  snprintf(text, size,
           "%s_%s: %.4g %s at %.9g s is met by one step alone, and %.2g %s from the steps beside "
           "it: it is as uncertain as that (%d such extreme%s); is a capacitance straight across a "
           "switch? a "
           "resistor in series with it, or a finer run.tolerance, gives it a width",
           probe->name, which ? "max" : "min", e->best.value, probe->unit, e->best.at_s, e->stands,
           probe->unit, count, count > 1 ? "s" : "");
  return true;
}

double vs_measures_slack(const vs_measures *m, const vs_rating *r) {
  const vs_extreme *pair = vs_measures_of_probe(m, r->probe);
  double range = r->max - r->min, size = fmax(fabs(pair[0].best.value), fabs(pair[1].best.value));
  return m->frame->tolerance * (isfinite(range) ? range : size);
}

/* Notes when the probe of a rating first leaves the rating's range. */
static void follow_rating(vs_measures *m, size_t k, vs_piece p) {
  const vs_rating *r = &m->frame->deck->ratings[k];
  const vs_probe *probe = &m->frame->deck->probes[r->probe];
  double before = probe->sign * p.from->terms[probe->term];
  double now = probe->sign * p.to->terms[probe->term];
  if (!isnan(m->passed_s[k]) || (now <= r->max && now >= r->min)) return;
  double end = now > r->max ? r->max : r->min;
  if (end == 0 && fabs(now) <= vs_measures_slack(m, r)) return;
  double part = (end - before) / (now - before);
  m->passed_s[k] = p.from->t_s + fmin(fmax(part, 0), 1) * (p.to->t_s - p.from->t_s);
}

static double largest_size(const vs_followed *f) {
  return fmax(fabs(f->end[0].best.value), fabs(f->end[1].best.value));
}

/* Follows a channel's extremes, and notes when it first leaves its range: on the straight line over
 * a piece of the step where it does so there, else at the extreme inside the step. */
static void follow_channel(vs_followed *f, const vs_step *step, double tolerance) {
  for (int k = 0; k < 2; k++) vs_extreme_follow_any(&f->end[k], step);
  if (!isnan(f->passed_s)) return;
  const double range = f->max - f->min,
               slack = tolerance * (isfinite(range) ? range : largest_size(f));
  const double most = f->max == 0 ? slack : f->max, least = f->min == 0 ? -slack : f->min;
  const bool above = f->end[1].best.value > most;
  if (!above && f->end[0].best.value >= least) return;
  const double end = above ? f->max : f->min;
  f->passed_s = f->end[above].best.at_s;
  for (int k = 0; k <= step->parts; k++) {
    const vs_piece p = vs_step_piece(step, k);
    const double from = vs_step_channel(step, p.from->t_s, f->channel),
                 now = vs_step_channel(step, p.to->t_s, f->channel);
    if (!(above ? now > end : now < end)) continue;
    f->passed_s =
        p.from->t_s + fmin(fmax((end - from) / (now - from), 0), 1) * (p.to->t_s - p.from->t_s);
    return;
  }
}

static bool swings_freely(const vs_measures *m, double t_s) {
  return t_s > m->extinct_s && t_s <= vs_measures_swing_ends_s && !(t_s > m->refired_s);
}

/* Follows the motion peaks after the first firing. In the free swing it also sums up the logarithm
 * of half the way between neighbouring extremes, which slower modes below the swing do not move. */
static void follow_peaks(vs_measures *m) {
  if (m->steps < 2 || !turns(m)) return;
  double middle = m->kept[m->last].from.t_s;
  bool free_swing = swings_freely(m, middle);
  bool wanted = !m->first.known || !m->second.known ||
                fabs(m->first.value) < vs_measures_ripple * fabs(m->travel_m[1]);
  if (!(middle > m->drives_s) || (!wanted && !free_swing)) return;
  vs_value v = refine(m);
  if (!m->first.known || fabs(m->first.value) < vs_measures_ripple * fabs(v.value)) {
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
    m->fired_s = m->drives_s = t_s;
  else if (event == VS_EV_FIRES && goes_on(m, t_s)) {
    m->extinct_s = NAN;
    m->n = m->st = m->sl = m->stt = m->stl = m->crossings = 0;
    m->swing.known = false;
  } else if (event == VS_EV_FIRES && isnan(m->refired_s))
    m->refired_s = t_s;
  if (event == VS_EV_EXTINCT && isnan(m->fired_s))
    m->rested_s = t_s; /* of a conduction that was there as the run began */
  else if (event == VS_EV_EXTINCT && isnan(m->extinct_s))
    m->extinct_s = t_s;
  if (event == VS_EV_LOADS && !isnan(m->extinct_s) && isnan(m->refired_s)) m->refired_s = t_s;
  if (event == VS_EV_JAMS) m->jammed = true;
}

/* Keeps the step, of some length, as the newer of two. */
static void keep_step(vs_measures *m, const vs_step *step) {
  m->last = 1 - m->last;
  if (m->steps < 2) m->steps++;
  vs_kept_step *kept = &m->kept[m->last];
  vs_step_copy_knot(m->frame, step->from, &kept->from);
  vs_step_copy_knot(m->frame, step->to, &kept->to);
  kept->step = *step;
  kept->step.from = &kept->from;
  kept->step.to = &kept->to;
  kept->step.parts = 0;
  m->travel_m[0] =
      m->steps == 1 ? vs_mechanics_travel(m->frame->model, step->from->x) : m->travel_m[1];
  m->travel_m[1] = vs_mechanics_travel(m->frame->model, step->from->x);
  m->travel_m[2] = vs_mechanics_travel(m->frame->model, step->to->x);
}

void vs_measures_accept(vs_measures *m, const vs_step *step) {
  for (int k = 0; k < 2; k++) follow_event(m, step->event[k], step->event_s[k]);
  if (m->frame->model->pulls_in) vs_pull_in_accept(&m->pull_in, step);
  if (step->to->t_s == step->from->t_s) return;
  if (!m->no_turns) keep_step(m, step);
  vs_extreme_follow(&m->extremes[OF_CURRENT], step, m->jammed);
  vs_extreme_follow(&m->extremes[OF_FORCE], step, m->jammed);
  vs_extreme_follow_motion(&m->extremes[OF_COORDINATES], step, m->jammed);
  for (int k = m->of_travel; k < m->of_probes; k++)
    vs_extreme_follow(&m->extremes[k], step, m->jammed);
  if (m->frame->deck) vs_extreme_follow_probes(&m->extremes[m->of_probes], step);
  for (size_t k = 0; m->frame->deck && k < m->frame->deck->n_ratings; k++)
    for (int n = 0; n <= step->parts; n++) follow_rating(m, k, vs_step_piece(step, n));
  for (size_t k = 0; k < m->n_followed; k++)
    follow_channel(&m->followed[k], step, m->frame->tolerance);
  if (m->no_turns) return;
  follow_peaks(m);
  follow_crossings(m);
}

/* The least and the largest travel. Where one coordinate opens the gap they are that one's, the
 * other way round where it closes it. */
static void finish_travel(const vs_measures *m, vs_value *least, vs_value *largest) {
  const vs_model *model = m->frame->model;
  int own = sole(model);
  const vs_extreme *pair =
      own < 0 ? &m->extremes[m->of_travel] : &m->extremes[OF_COORDINATES + VS_OF_COORDINATE * own];
  bool closes = own >= 0 && model->along[own] < 0;
  *least = pair[closes ? VS_LARGEST : VS_LEAST].best;
  *largest = pair[closes ? VS_LEAST : VS_LARGEST].best;
  if (!closes) return;
  least->value = 0 - least->value; /* no -0 */
  largest->value = 0 - largest->value;
}

void vs_measures_finish(const vs_measures *m, vs_value values[VS_MEASURES]) {
  for (int k = 0; k < VS_MEASURES; k++) values[k] = (vs_value){.at_s = NAN};
  values[VS_M_I_PEAK] = m->extremes[OF_CURRENT].best;
  values[VS_M_FORCE_PEAK] = m->extremes[OF_FORCE].best;
  for (int k = OF_COORDINATES; k < m->of_travel; k++)
    values[VS_STANDARD_MEASURES + k - OF_COORDINATES] = m->extremes[k].best;
  finish_travel(m, &values[VS_M_GAP_MIN], &values[VS_M_GAP_MAX]);
  const vs_value *least = &values[VS_M_GAP_MIN], *largest = &values[VS_M_GAP_MAX];
  if (least->known && largest->known)
    values[VS_M_STROKE] = (vs_value){true, largest->value - least->value, NAN};
  values[VS_M_PULL_IN] = vs_pull_in_time(&m->pull_in);
  values[VS_M_RELEASE] = vs_pull_in_release(&m->pull_in);
  values[VS_M_BOUNCE_TIME] = vs_pull_in_bounce_time(&m->pull_in);
  values[VS_M_BOUNCES] = vs_pull_in_bounces(&m->pull_in);
  values[VS_M_IMPACT_SPEED] = vs_pull_in_speed(&m->pull_in);
  values[VS_M_GAP_FIRST] = m->first;
  values[VS_M_GAP_SECOND] = m->second;
  if (!isnan(m->fired_s)) values[VS_M_T_FIRE] = (vs_value){true, m->fired_s, NAN};
  double extinct_s = m->extinct_s; /* on an orbit it may be the next period's */
  if (isnan(extinct_s) && m->frame->at_work) extinct_s = m->rested_s + m->frame->means.to_s;
  if (!isnan(extinct_s) && !isnan(m->fired_s)) {
    values[VS_M_T_EXTINCTION] = (vs_value){true, extinct_s, NAN};
    values[VS_M_CONDUCTION] = (vs_value){true, extinct_s - m->fired_s, NAN};
  }
  if (m->crossings >= 2)
    values[VS_M_F_RESONANCE] =
        (vs_value){true, (m->crossings - 1) / (m->last_crossing_s - m->first_crossing_s), NAN};
  /* ln A = const - t/tau, least squares */
  double slope = (m->n * m->stl - m->st * m->sl) / (m->n * m->stt - m->st * m->st);
  if (m->n >= 3 && slope < 0) values[VS_M_TAU_GAP] = (vs_value){true, -1 / slope, NAN};
}
