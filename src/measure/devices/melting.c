/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "devices/melting.h"

#include <math.h>

/* What melting.h defines. */
static const double HOTTER = 3, STEP_V = 10, SHARE = 0.1, LEAST_A = 1e-3, LEAKS_S = 1e-5,
                    REST_S = 1e-3;

/* How far the voltage is beyond that of a whole fuse, V. */
static double beyond_whole_fuse_v(double ohm, double v, double i) {
  return fabs(v) - HOTTER * ohm * fabs(i) - STEP_V;
}

/* Returns when it melts in the step; NaN: it does not. */
static double melts(vs_melting *m, const vs_course_step *c) {
  double ohm = m->i2_s > 0 ? fmax(m->vi_s / m->i2_s, 0) : 0;
  double b0 = beyond_whole_fuse_v(ohm, c->from[VS_OF_V], c->from[VS_OF_I]);
  double b1 = beyond_whole_fuse_v(ohm, c->to[VS_OF_V], c->to[VS_OF_I]);
  m->vi_s += c->more[VS_OF_POWER];
  m->i2_s += c->more[VS_OF_I2];
  if (b1 <= 0 || c->more[VS_OF_I2] > SHARE * m->i2_s) return NAN;
  m->melted = true;
  m->gone_s = NAN;
  return m->melted_s = b0 < 0 ? c->t0_s + b0 / (b0 - b1) * c->h_s : c->t0_s;
}

static bool is_gone(const double course[VS_COURSES]) {
  return fabs(course[VS_OF_I]) <= LEAST_A + LEAKS_S * fabs(course[VS_OF_V]);
}

vs_melting_news vs_melting_follow(vs_melting *m, const vs_course_step *c) {
  vs_melting_news news = {NAN, NAN, NAN, fabs(c->to[VS_OF_I]), NAN};
  if (!m->melted) {
    news.melts_s = melts(m, c);
    news.i2_s = m->i2_s;
    return news;
  }
  if (!is_gone(c->to)) {
    if (m->cleared) news.again_s = c->t1_s;
    m->again = m->again || m->cleared;
    m->arc_v = fmax(m->arc_v, fabs(c->to[VS_OF_V]));
    m->cleared = false;
    m->gone_s = NAN;
    return news;
  }
  if (isnan(m->gone_s)) m->gone_s = c->t1_s;
  if (m->cleared || c->t1_s - m->gone_s < REST_S) return news;
  m->cleared = true;
  news.cleared_s = m->gone_s;
  return news;
}
