/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "macromodel/outlook.h"

#include <math.h>

/* Where the signals may go, and behind the last of them the EVA's voltage. */
typedef struct range {
  double least[VS_SIGNALS + 1], most[VS_SIGNALS + 1];
} range;

/* Sets the range of signal n, or of the EVA's voltage behind the last one: as far as it went over
 * the cycle in view, and half of that more at either end, for the beat of the machine with the
 * mains. A signal that drifts has no limits. */
static void see_range_of(const vs_record *r, const vs_oneport *port, size_t n, range *out) {
  bool of_eva = n == vs_record_signals(r);
  double least = INFINITY, most = -INFINITY;
  for (size_t k = 0; k < r->n_seen; k++) {
    const vs_seen *seen = r->seen[k];
    double value = of_eva ? seen->knot.v_eva_v : vs_responses_seen(r->frame, seen, n);
    least = fmin(least, value);
    most = fmax(most, value);
  }
  double slack = (most - least) / 2 + (of_eva ? 0 : vs_record_allowed(r, n));
  bool drifts = !of_eva && vs_responses_drift(vs_oneport_responses(port), n) != 0;
  out->least[n] = drifts ? -INFINITY : least - slack;
  out->most[n] = drifts ? INFINITY : most + slack;
}

static void see_range(const vs_record *r, const vs_oneport *port, range *out) {
  for (size_t n = 0; n <= vs_record_signals(r); n++) see_range_of(r, port, n, out);
}

static bool in_range(const vs_record *r, const vs_oneport *port, const range *seen, double t_s,
                     const vs_coil_state *c) {
  double signal[VS_SIGNALS];
  size_t count = vs_record_signals(r);
  vs_responses_at(vs_oneport_responses(port), t_s, c, signal);
  for (size_t n = 0; n < count; n++)
    if (!(signal[n] >= seen->least[n] && signal[n] <= seen->most[n])) return false;
  return c->v_v >= seen->least[count] && c->v_v <= seen->most[count];
}

static double largest_flux(const vs_record *r) {
  double most = 0;
  for (size_t k = 0; k < r->n_seen; k++) most = fmax(most, fabs(r->seen[k]->knot.flux_wb));
  return most;
}

bool vs_outlook_find(const vs_record *r, vs_oneport *port, double until_s, vs_outlook *o) {
  double y[VS_ONEPORT_STATES], t = r->last.knot.t_s, now = largest_flux(r);
  double h = r->setup->timeline.period_s / VS_OUTLOOK_STEPS;
  range seen;
  see_range(r, port, &seen);
  vs_oneport_state(&r->last.knot, y);
  *o = (vs_outlook){.reach = 1};
  for (int cycle = 0; cycle < VS_OUTLOOK_CYCLES && t < until_s; cycle++)
    for (int n = 0; n < VS_OUTLOOK_STEPS; n++, t += h) {
      if (!vs_oneport_advance(port, t, t + h, y)) return false;
      vs_coil_state c = vs_oneport_coil(port, t + h, y);
      if (!in_range(r, port, &seen, t + h, &c)) return false;
      o->ratio[cycle] = fmax(o->ratio[cycle], fabs(c.flux_wb) / now);
      o->reach = fmax(o->reach, vs_oneport_reach(port, t + h, &c));
    }
  return true;
}

/* Behind the cycles that were looked at, the last one's ratio goes on. A mode that decays holds no
 * more than its errors of 1/(1 - exp(-T/tau)) cycles: the sum of a geometric series. */
double vs_outlook_times(const vs_outlook *o, const vs_mode *m, double cycles, double period_s,
                        double *walked) {
  double sum = 0, rest = fmax(cycles - VS_OUTLOOK_CYCLES, 0);
  double last = o->ratio[VS_OUTLOOK_CYCLES - 1], from = VS_OUTLOOK_CYCLES;
  *walked = 0;
  for (int n = 0; n < VS_OUTLOOK_CYCLES && n < cycles; n++) {
    sum += o->ratio[n];
    *walked += (n + 1) * o->ratio[n];
  }
  double held = -1 / expm1(-period_s / m->time_constant_s);
  if (isfinite(m->time_constant_s) && held < rest) {
    from = cycles - held;
    rest = held;
  }
  *walked = o->reach * (*walked + rest * (from + cycles) / 2 * last);
  return o->reach * (sum + rest * last);
}
