/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/meter.h"

#include <assert.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <math.h>
#include <string.h>

#include "base/hash.h"
#include "base/units.h"
#include "measure/chebyshev.h"

/* ---- noise ---- */

/* The generator keeps its state in the meter, so that it is copied with it. */
static gsl_rng generator(vs_meter *m) {
  assert(gsl_rng_ranlxd1->size <= sizeof m->random);
  return (gsl_rng){gsl_rng_ranlxd1, m->random};
}

/* The ratio method makes a number by arithmetic alone; a logarithm only decides whether it is
 * taken. So the last bits of a machine's C library do not show. */
static double noise(vs_meter *m) {
  if (m->noise == 0) return 0;
  gsl_rng r = generator(m);
  return gsl_ran_gaussian_ratio_method(&r, m->noise);
}

void vs_meter_begin(vs_meter *m, const vs_instrument *i, int seed) {
  *m = (vs_meter){.instrument = i, .value = NAN, .t_s = NAN, .beyond_s = NAN};
  double unit = vs_units_factor(i->unit);
  for (int k = 0; k < 2; k++) m->range[k] = i->v.range[k] / unit;
  m->noise = i->v.noise / unit;
  m->lowpass = vs_lowpass_make(i->v.bandwidth_hz, i->v.order, i->v.damping);
  if (i->on_orbit) memcpy(m->lowpass.x, i->x, sizeof i->x);
  gsl_rng r = generator(m);
  unsigned long name = vs_hash_crc32(i->name, strlen(i->name));
  gsl_rng_set(&r, (name ^ (unsigned long)seed * 2654435761UL) & 0x7fffffffUL);
}

/* ---- the sensor ---- */

/* What the sensor shows of y, which may be beyond its range. */
static double shown_by_sensor(vs_meter *m, double y) {
  double within = y < m->range[0] ? m->range[0] : y > m->range[1] ? m->range[1] : y;
  m->outside = m->outside || within != y;
  return within;
}

/* A part of a step is halved until a polynomial is as near to the channel as this part of the
 * range, or as this part of the channel itself, whose rounding no halving takes away; and until the
 * channel is either within the range or beyond it. It is halved at most so often, so that a jump
 * is met to a 2^-24th of the step, and a step is taken in at most about so many parts: where a
 * channel's rounding is larger than the range's steps, halves are no better than the whole. */
static const double NEAR = 1e-12, ROUNDING = 1e-14;
enum { HALVES = 24, PARTS = 400 };

/* A step that is taken in parts. */
typedef struct walk {
  const vs_step *step;
  int left; /* how often a part may still be halved */
} walk;

/* Takes the low-pass along the channel, as the sensor shows it, from one instant of the step to
 * another. depth: how often the part was halved. */
static void follow_sensor(vs_meter *m, walk *w, vs_span_s part, int depth) {
  const vs_chebyshev c = vs_chebyshev_of(w->step, m->instrument->channel, part.from_s, part.to_s);
  double low = c.a[0] - c.reach, high = c.a[0] + c.reach, u[VS_LOWPASS_TERMS] = {0};
  double near = fmax(NEAR * (m->range[1] - m->range[0]), ROUNDING * fmax(fabs(low), fabs(high)));
  bool is_beyond = high <= m->range[0] || low >= m->range[1] || !isfinite(c.reach),
       is_within = low >= m->range[0] - near && high <= m->range[1] + near;
  bool is_good = is_beyond || (is_within && vs_chebyshev_error(&c) <= near);
  double middle_s = (part.from_s + part.to_s) / 2;
  if (!is_good && depth < HALVES && w->left > 0 && middle_s > part.from_s && middle_s < part.to_s) {
    w->left--;
    follow_sensor(m, w, (vs_span_s){part.from_s, middle_s}, depth + 1);
    follow_sensor(m, w, (vs_span_s){middle_s, part.to_s}, depth + 1);
    return;
  }
  if (is_within)
    vs_chebyshev_powers(&c, u);
  else
    u[0] = shown_by_sensor(m, c.a[0]);
  vs_lowpass_advance(&m->lowpass, part.to_s - part.from_s, u);
}

static void take_on(vs_meter *m, const vs_step *step, double t_s) {
  for (int k = 0; k <= step->parts; k++) {
    const double to_s = fmin(vs_step_piece(step, k).to->t_s, t_s);
    walk w = {step, PARTS};
    if (k < step->parts && to_s <= m->t_s) continue;
    if (to_s > m->t_s && m->lowpass.rate > 0) follow_sensor(m, &w, (vs_span_s){m->t_s, to_s}, 0);
    m->t_s = to_s;
  }
  m->t_s = t_s;
}

/* ---- samples ---- */

/* How far y is above the middle between a code's step and the one below. The sign is exact: of the
 * difference and of the product, the part that rounding takes away is kept. */
static double above_middle(double low, double step, double code, double y) {
  double product = (code - 0.5) * step, product_rest = fma(code - 0.5, step, -product);
  double far = y - low, back = far - y, far_rest = (y - (far - back)) - (low + back);
  return (far - product) + (far_rest - product_rest);
}

double vs_meter_quantised(const double range[2], int bits, double y) {
  if (!bits) return y;
  double step = ldexp(range[1] - range[0], -bits), last = ldexp(1, bits) - 1;
  double code = fmin(fmax(floor((y - range[0]) / step + 0.5), 0), last);
  if (code > 0 && above_middle(range[0], step, code, y) < 0)
    code--; /* which rounding had put on the wrong side of the middle */
  else if (code < last && above_middle(range[0], step, code + 1, y) >= 0)
    code++;
  return range[0] + step * code;
}

/* What is shown where the low-pass has come to. */
static double output(vs_meter *m, const vs_step *step) {
  if (m->lowpass.rate > 0) return m->lowpass.x[0];
  return shown_by_sensor(m, vs_step_channel(step, m->t_s, m->instrument->channel));
}

static void make_sample(vs_meter *m, const vs_step *step) {
  double y = output(m, step);
  m->value = vs_meter_quantised(m->range, m->instrument->v.bits, y + noise(m));
  if (m->outside && !m->beyond++) m->beyond_s = m->t_s;
  m->outside = false;
  m->samples++;
}

double vs_meter_next_s(const vs_meter *m) {
  return (double)m->samples / m->instrument->v.rate_hz;
}

static void begin_at(vs_meter *m, const vs_step *step) {
  m->t_s = step->from->t_s;
  if (!m->instrument->on_orbit)
    vs_lowpass_settle(&m->lowpass,
                      shown_by_sensor(m, vs_step_channel(step, m->t_s, m->instrument->channel)));
}

/* Instants that are meant to be the same may differ by rounding. */
static const double SAME = 1e-9; /* of the time between two samples */

void vs_meter_to(vs_meter *m, const vs_step *step, double t_s) {
  double slack_s = SAME / m->instrument->v.rate_hz;
  if (isnan(m->t_s)) begin_at(m, step);
  for (double next_s; (next_s = vs_meter_next_s(m)) <= t_s + slack_s;) {
    take_on(m, step, fmin(next_s, step->to->t_s));
    make_sample(m, step);
  }
}

double vs_meter_shown(vs_meter *m, const vs_step *step, double t_s) {
  if (isnan(m->t_s)) begin_at(m, step);
  take_on(m, step, t_s);
  return output(m, step);
}

void vs_meter_accept(vs_meter *m, const vs_step *step) {
  if (step->to->t_s == step->from->t_s) return; /* the other side of an instant already shown */
  vs_meter_to(m, step, step->to->t_s);
  take_on(m, step, step->to->t_s);
}

/* ---- on the way to an orbit ---- */

static void begin_all_meters(vs_meter_pilot *o) {
  for (int k = 0; k < o->instruments->count; k++)
    vs_meter_begin(&o->meters[k], &o->instruments->item[k], o->instruments->v.seed);
}

static void take_start_of_pilot(vs_meter_pilot *o) {
  memcpy(o->pilot.x, o->steers->x, sizeof o->pilot.x);
}

static void begin_metered_pilot(void *self, const vs_setup *setup) {
  vs_meter_pilot *o = self;
  o->steers->begin(o->steers->self, setup);
  take_start_of_pilot(o);
}

static void accept_metered_pilot(void *self, const vs_step *step) {
  vs_meter_pilot *o = self;
  o->steers->accept(o->steers->self, step);
  for (int k = 0; k < o->instruments->count; k++) vs_meter_accept(&o->meters[k], step);
}

/* At the end of a part the clock goes back to 0, and the meters begin anew where their low-passes
 * are. */
static vs_status turn_metered_pilot(void *self, const vs_knot *end, bool *begins, vs_error *err) {
  vs_meter_pilot *o = self;
  vs_status status = o->steers->turn(o->steers->self, end, begins, err);
  bool whole = ++o->parts % o->pilot.of_orbit == 0;
  take_start_of_pilot(o);
  for (int k = 0; k < o->instruments->count; k++) {
    vs_lowpass *l = &o->meters[k].lowpass;
    vs_instrument *i = &o->instruments->item[k];
    if (*begins) vs_lowpass_close(l, o->from[k], o->pilot.of_orbit * o->pilot.period_s);
    memcpy(i->x, l->x, sizeof i->x);
    if (whole) memcpy(o->from[k], l->x, sizeof o->from[k]);
  }
  begin_all_meters(o);
  return status;
}

static double push_metered_pilot(void *self, double t_s) {
  const vs_meter_pilot *o = self;
  return o->steers->push(o->steers->self, t_s);
}

static void end_metered_pilot(void *self) {
  const vs_meter_pilot *o = self;
  o->steers->end(o->steers->self);
}

void vs_meter_pilot_begin(vs_meter_pilot *o, vs_orbit_search *steers, vs_instruments *instruments,
                          vs_meter *meters) {
  *o = (vs_meter_pilot){
      .pilot = *steers, .steers = steers, .instruments = instruments, .meters = meters};
  o->pilot.self = o;
  o->pilot.begin = begin_metered_pilot;
  o->pilot.accept = accept_metered_pilot;
  o->pilot.turn = turn_metered_pilot;
  o->pilot.push = push_metered_pilot;
  o->pilot.end = end_metered_pilot;
  for (int k = 0; k < instruments->count; k++) {
    vs_instrument *i = &instruments->item[k];
    i->on_orbit = true;
    memset(i->x, 0, sizeof i->x);
  }
  begin_all_meters(o);
}
