/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Taylor-series integrator for the paper scene; exact polynomial recurrences.
 * -DUSE_QUAD: reference in IEEE quad (error ~1e-28). Without: double-precision peer with adaptive
 * step. */
#ifdef USE_QUAD
#define REAL __float128
#endif
#include "model.h"
#ifdef USE_QUAD
#define N 36
#else
#define N 20
#endif
static REAL X[9][N + 1], S[N + 1], Co[N + 1];
static void series(const model *m, int on, REAL t) {
  S[0] = R_SIN(m->w * t);
  Co[0] = R_COS(m->w * t);
  REAL gl = 1 / (m->L0 * m->z0);
  for (int n = 0; n < N; n++) {
    REAL ll = 0, lp = 0;
    if (on) {
      for (int j = 0; j <= n; j++) {
        ll += X[8][j] * X[8][n - j];
        lp += X[8][j] * X[0][n - j];
      }
    }
    REAL F = ll * gl / 2, i = (m->z0 * X[8][n] + lp) * gl, inv = (REAL)1 / (n + 1);
    for (int r = 0; r < 4; r++) {
      REAL s = m->g[r] * F;
      for (int c = 0; c < 4; c++) s -= m->AK[r][c] * X[c][n] + m->AB[r][c] * X[4 + c][n];
      X[r][n + 1] = X[4 + r][n] * inv;
      X[4 + r][n + 1] = s * inv;
    }
    X[8][n + 1] = on ? (m->Um * S[n] - m->R * i) * inv : 0;
    S[n + 1] = m->w * Co[n] * inv;
    Co[n + 1] = -m->w * S[n] * inv;
  }
}
static REAL ev(int k, REAL h) {
  REAL s = X[k][N];
  for (int n = N - 1; n >= 0; n--) s = s * h + X[k][n];
  return s;
}
static REAL dev(int k, REAL h) {
  REAL s = N * X[k][N];
  for (int n = N - 1; n >= 1; n--) s = s * h + n * X[k][n];
  return s;
}
int main(int ac, char **av) {
  args a = parse(ac, av, "taylor");
  model m;
  model_init(&m, a.pulses);
  rec r;
  rec_init(&r, &m);
  double best = 1e9;
  long steps = 0;
  REAL toff1 = 0;
  for (int rep = 0; rep < a.repeat; rep++) {
    double t0 = wall();
    REAL t = 0;
    int on = 0, kf = 0, k = 0;
    steps = 0;
    toff1 = 0;
    REAL x[9] = {0};
    rec_put(&r, k++, 0, 0, 0, 0, 0);
    while (t < m.tend - 1e-15) {
      REAL tn = m.tend;
      if (!on && kf < m.pulses) {
        REAL tf = m.t_fire0 + kf * m.T;
        if (tf < tn) tn = tf;
      }
      for (int j = 0; j < 9; j++) X[j][0] = x[j];
      series(&m, on, t);
      steps++;
#ifdef USE_QUAD
      REAL h = 2.5e-4;
#else
      double sc = 1e-30, eN = 1e-300, eM = 1e-300; /* step from the last two terms, scaled by the
                                                      largest |q|,|lam| seen so far */
      static const double W[9] = {1e-3, 1e-3, 1e-3, 1e-2, .3, .3, .3, 3, 2};
      for (int j = 0; j < 9; j++) {
        double u = fabs(X[j][N]) / W[j], v = fabs(X[j][N - 1]) / W[j];
        if (u > eN) eN = u;
        if (v > eM) eM = v;
      }
      (void)sc;
      double h = fmin(pow(a.rtol / eN, 1.0 / N), pow(a.rtol / eM, 1.0 / (N - 1))) * 0.9;
      if (h > 0.02) h = 0.02; /* one mains period at most */
#endif
      int hit = 0;
      if (t + h >= tn) {
        h = tn - t;
        hit = 1;
      }
      REAL te = t + h;
      int off = 0;
      if (on) { /* lam = 0 with lam falling: search in the step */
        REAL lo = 0, hi = 0;
        int NS = 16;
        for (int s = 1; s <= NS; s++) {
          REAL hs = h * s / NS;
          if (ev(8, hs) <= 0 && (X[8][0] > 0 || s > 1)) {
            lo = h * (s - 1) / NS;
            hi = hs;
            off = 1;
            break;
          }
        }
        if (off) {
          REAL q = hi;
          for (int it = 0; it < 60; it++) {
            REAL f = ev(8, q), d = dev(8, q), qn = q - f / d;
            if (qn < lo || qn > hi) qn = (lo + hi) / 2;
            if (f < 0)
              hi = q;
            else
              lo = q;
            if (R_FABS(qn - q) < (sizeof(REAL) > 8 ? C(1e-30) : 1e-17)) {
              q = qn;
              break;
            }
            q = qn;
          }
          te = t + q;
        }
      }
      while (k < r.n) {
        REAL tk = (REAL)k / 10000;
        if (tk > te) break;
        REAL d = tk - t;
        REAL p = ev(0, d), l = ev(8, d);
        rec_put(&r, k++, (double)p, (double)ev(1, d), (double)ev(2, d), (double)ev(3, d),
                (double)(l * (m.z0 + p) / (m.L0 * m.z0)));
      }
      REAL d = te - t;
      REAL y[9];
      for (int j = 0; j < 9; j++) y[j] = ev(j, d);
      memcpy(x, y, sizeof x);
      t = te;
      if (off) {
        on = 0;
        x[8] = 0;
        kf++;
        if (toff1 == 0) toff1 = t;
      } else if (hit && !on && kf < m.pulses && t < m.tend) {
        on = 1;
        x[8] = 0;
      }
    }
    while (k < r.n) {
      rec_put(&r, k, (double)x[0], (double)x[1], (double)x[2], (double)x[3], 0);
      k++;
    }
    double w = wall() - t0;
    if (w < best) best = w;
  }
  rec_report(&r, &m, a.out, sizeof(REAL) > 8 ? "ref_quad" : "taylor_c", "taylor", a.rtol, best,
             (double)toff1, steps, 0);
  return 0;
}
