/* SPDX-License-Identifier: GPL-3.0-or-later */
/* GSL odeiv2 evolve, --method rk8pd | rkf45 | rkck | msadams; outputs by cubic/quintic Hermite
 * would hide error, so steps end on the 0.1 ms grid; current zero located by bisection+secant on
 * re-taken steps. */
#include "model.h"
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
typedef struct {
  model m;
  int on;
  long nf;
} ud;
static int f(double t, const double *y, double *d, void *p) {
  ud *q = p;
  q->nf++;
  rhs_f(&q->m, q->on, t, y, d);
  return GSL_SUCCESS;
}
int main(int ac, char **av) {
  args a = parse(ac, av, "rk8pd");
  ud u;
  rec r;
  double best = 1e9, toff = 0;
  long steps = 0;
  model_init(&u.m, a.pulses);
  rec_init(&r, &u.m);
  model *m = &u.m;
  const gsl_odeiv2_step_type *T = !strcmp(a.method, "rkf45")  ? gsl_odeiv2_step_rkf45
                                  : !strcmp(a.method, "rkck") ? gsl_odeiv2_step_rkck
                                                              : gsl_odeiv2_step_rk8pd;
  for (int rep = 0; rep < a.repeat; rep++) {
    double w0 = wall();
    u.on = 0;
    u.nf = 0;
    toff = 0;
    steps = 0;
    gsl_odeiv2_system S = {f, NULL, 9, &u};
    static const double sca[9] = {1e-3, 1e-3, 1e-3, 1e-2, .3, .3, .3, 3, 1};
    gsl_odeiv2_step *s = gsl_odeiv2_step_alloc(T, 9);
    gsl_odeiv2_control *c = gsl_odeiv2_control_scaled_new(a.rtol, a.rtol, 1, 0, sca, 9);
    gsl_odeiv2_evolve *e = gsl_odeiv2_evolve_alloc(9);
    double x[9] = {0}, t = 0, h = 1e-4, y0[9];
    int k = 0, kf = 0;
    rec_put(&r, k++, 0, 0, 0, 0, 0);
    while (k < r.n) {
      double tg = k * m->dt, tf = m->t_fire0 + kf * m->T, tn = tg;
      int fire = 0;
      if (!u.on && kf < m->pulses && tf <= tn) {
        tn = tf;
        fire = 1;
      }
      int off = 0;
      while (t < tn) {
        double tp = t;
        memcpy(y0, x, sizeof x);
        gsl_odeiv2_evolve_apply(e, c, s, &S, &t, tn, &h, x);
        steps++;
        if (u.on && x[8] <= 0 &&
            tp > m->t_fire0 + kf * m->T) { /* zero in (tp,t): Illinois on step length */
          double lo = 0, hi = t - tp, flo = y0[8], fhi = x[8], y[9], er[9];
          int side = 0;
          for (int it = 0; it < 60 && hi - lo > 1e-16; it++) {
            double q = (lo * fhi - hi * flo) / (fhi - flo);
            memcpy(y, y0, sizeof y);
            gsl_odeiv2_step_reset(s);
            gsl_odeiv2_step_apply(s, tp, q, y, er, NULL, NULL, &S);
            if (fabs(y[8]) < 1e-16) {
              hi = q;
              memcpy(x, y, sizeof x);
              break;
            }
            if (y[8] <= 0) {
              hi = q;
              fhi = y[8];
              memcpy(x, y, sizeof x);
              if (side == -1) flo /= 2;
              side = -1;
            } else {
              lo = q;
              flo = y[8];
              if (side == 1) fhi /= 2;
              side = 1;
            }
          }
          t = tp + hi;
          off = 1;
          break;
        }
      }
      if (off) {
        u.on = 0;
        kf++;
        if (toff == 0) toff = t;
        x[8] = 0;
        gsl_odeiv2_evolve_reset(e);
        gsl_odeiv2_step_reset(s);
        h = 1e-4;
      } else if (fire) {
        u.on = 1;
        x[8] = 0;
        gsl_odeiv2_evolve_reset(e);
        gsl_odeiv2_step_reset(s);
        h = 1e-5;
        if (tf < tg) continue;
      }
      if (t >= tg - 1e-16) {
        rec_put(&r, k, x[0], x[1], x[2], x[3], u.on ? cur(m, x) : 0);
        k++;
      }
    }
    gsl_odeiv2_evolve_free(e);
    gsl_odeiv2_control_free(c);
    gsl_odeiv2_step_free(s);
    double w = wall() - w0;
    if (w < best) best = w;
  }
  rec_report(&r, m, a.out, "gsl", a.method, a.rtol, best, toff, steps, u.nf);
  return 0;
}
