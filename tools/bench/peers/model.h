/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Paper scene (Despotovic et al. 2016, Table 1, Eqs. 54-57, 72, 81): 8-state linear vibratory
 * conveyor mechanics
 * + RL coil with L(z)=L0*z0/z fed through one thyristor (ideal: no drop, turns off at i=0) from a
 * 50 Hz sine. States x: 0..3 q=(p,u,w,phi) [m,m,m,rad], 4..7 qdot, 8 flux linkage lam=L(z)*i [Wb].
 *   i = lam*z/(L0*z0), z = z0+p, F = a*i^2/z^2 = lam^2/(2*L0*z0), dlam/dt = u(t)-R*i (conducting)
 * else lam=0. Pulse k fires at omega*t = alpha + 2*pi*k, k = 0..pulses-1. */
#pragma once
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#ifndef REAL
#define REAL double
#endif
#define M_PIq 3.14159265358979323846264338327950288419716939937510L
typedef struct {
  REAL R, L0, z0, Um, w, t_fire0, T;
  REAL AK[4][4], AB[4][4], g[4]; /* qdd = -AK q - AB qd + g*F */
  int pulses;
  double tend, dt;
} model;
#ifdef USE_QUAD
#include <quadmath.h>
#define R_SIN sinq
#define R_COS cosq
#define R_SQRT sqrtq
#define R_FABS fabsq
#define R_PI M_PIq_128
#define M_PIq_128 3.14159265358979323846264338327950288Q
#define C(x) x##Q
#else
#define R_SIN sin
#define R_COS cos
#define R_SQRT sqrt
#define R_FABS fabs
#define R_PI 3.14159265358979323846
#define C(x) x
#endif
static void inv_apply(REAL M[4][4], REAL B[4][9], int nb) { /* B := M^-1 B, Gauss with pivoting */
  for (int c = 0; c < 4; c++) {
    int p = c;
    for (int r = c + 1; r < 4; r++)
      if (R_FABS(M[r][c]) > R_FABS(M[p][c])) p = r;
    for (int j = 0; j < 4; j++) {
      REAL t = M[c][j];
      M[c][j] = M[p][j];
      M[p][j] = t;
    }
    for (int j = 0; j < nb; j++) {
      REAL t = B[c][j];
      B[c][j] = B[p][j];
      B[p][j] = t;
    }
    REAL d = 1 / M[c][c];
    for (int j = 0; j < 4; j++) M[c][j] *= d;
    for (int j = 0; j < nb; j++) B[c][j] *= d;
    for (int r = 0; r < 4; r++)
      if (r != c) {
        REAL f = M[r][c];
        for (int j = 0; j < 4; j++) M[r][j] -= f * M[c][j];
        for (int j = 0; j < nb; j++) B[r][j] -= f * B[c][j];
      }
  }
}
static void model_init(model *m, int pulses) {
  memset(m, 0, sizeof *m);
  REAL al = 70 * R_PI / 180, mk = C(0.83), mb = 4, Jc = C(3.86e-3), Jb = C(0.017);
  REAL xB = C(0.194), yB = C(0.089), xC = C(0.092), yC = C(0.129), x3 = C(0.033), y3 = C(0.015),
       x4 = C(0.21183), y4 = C(0.015);
  REAL k = C(0.43e5), kx = C(0.08e5), ky = C(0.4e5), b = C(1.2), bx = C(0.1), by = C(0.5);
  REAL dx = xC - xB, dy = yC - yB, s = R_SIN(al), c = R_COS(al);
  REAL M[4][4] = {{mk, -mk * s, mk * c, 0},
                  {-mk * s, mk + mb, 0, -mk * dy},
                  {mk * c, 0, mk + mb, mk * dx},
                  {0, -mk * dy, mk * dx, Jc + Jb + mk * (dx * dx + dy * dy)}};
  REAL ya = yB - y3, yb = yB - y4, xa = x3 - xB, xb = x4 - xB;
  REAL W[4][9] = {{0}};
  W[0][0] = 2 * k;
  W[1][1] = 2 * kx;
  W[1][3] = W[3][1] = kx * (ya + yb);
  W[2][2] = 2 * ky;
  W[2][3] = W[3][2] = ky * (xa + xb);
  W[3][3] = kx * (ya * ya + yb * yb) + ky * (xa * xa + xb * xb);
  W[0][4] = 2 * b;
  W[1][5] = 2 * bx;
  W[1][7] = W[3][5] = bx * (ya + yb);
  W[2][6] = 2 * by;
  W[2][7] = W[3][6] = by * (xa + xb);
  W[3][7] = bx * (ya * ya + yb * yb) + by * (xa * xa + xb * xb);
  W[0][8] = -1;
  inv_apply(M, W, 9);
  for (int i = 0; i < 4; i++) {
    for (int j = 0; j < 4; j++) {
      m->AK[i][j] = W[i][j];
      m->AB[i][j] = W[i][4 + j];
    }
    m->g[i] = W[i][8];
  }
  m->R = 92;
  m->L0 = C(1.6);
  m->z0 = C(6.5e-3);
  m->Um = 440 * R_SQRT(2);
  m->w = 2 * R_PI * 50;
  m->T = C(0.02);
  m->t_fire0 = (100 * R_PI / 180) / m->w;
  m->pulses = pulses;
  m->tend = 2.0;
  m->dt = 1e-4;
}
static double wall(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}
/* uniform record every dt: p,u,w,phi,i */
typedef struct {
  int n;
  double *y;
} rec;
static void rec_init(rec *r, const model *m) {
  r->n = (int)(m->tend / m->dt + 1.5);
  r->y = calloc((size_t)r->n * 5, sizeof(double));
}
static void rec_put(rec *r, int k, double p, double u, double w, double ph, double i) {
  if (k < r->n) {
    double *y = r->y + 5 * k;
    y[0] = p;
    y[1] = u;
    y[2] = w;
    y[3] = ph;
    y[4] = i;
  }
}
static void rec_report(const rec *r, const model *m, const char *out, const char *tool,
                       const char *method, double rtol, double wall_s, double t_off, long steps,
                       long rhs) {
  double pp = 0, ip = 0;
  for (int k = 0; k < r->n; k++) {
    if (fabs(r->y[5 * k]) > pp) pp = fabs(r->y[5 * k]);
    if (r->y[5 * k + 4] > ip) ip = r->y[5 * k + 4];
  }
  const double *e = r->y + 5 * (r->n - 1);
  printf("%.6f,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%ld,%ld,%s,%s,%g,%d\n", wall_s, pp, ip,
         e[0], e[1], e[2], e[3], t_off, steps, rhs, tool, method, rtol, m->pulses);
  if (out) {
    FILE *f = fopen(out, "wb");
    fwrite(r->y, sizeof(double), (size_t)r->n * 5, f);
    fclose(f);
  }
}
#define HEADER                                                                                     \
  "wall_s,p_peak,i_peak,p_end,u_end,w_end,phi_end,t_off,steps,rhs,tool,method,rtol,pulses"
typedef struct {
  double rtol;
  int pulses;
  const char *out, *method;
  int repeat;
} args;
static args parse(int ac, char **av, const char *method) {
  args a = {1e-6, 1, NULL, method, 1};
  for (int i = 1; i < ac; i++) {
    if (!strcmp(av[i], "--header")) {
      puts(HEADER);
      exit(0);
    } else if (i + 1 < ac && !strcmp(av[i], "--rtol"))
      a.rtol = atof(av[++i]);
    else if (i + 1 < ac && !strcmp(av[i], "--pulses"))
      a.pulses = atoi(av[++i]);
    else if (i + 1 < ac && !strcmp(av[i], "--out"))
      a.out = av[++i];
    else if (i + 1 < ac && !strcmp(av[i], "--method"))
      a.method = av[++i];
    else if (i + 1 < ac && !strcmp(av[i], "--repeat"))
      a.repeat = atoi(av[++i]);
    else {
      fprintf(stderr, "usage: %s [--rtol X] [--pulses N] [--method M] [--out FILE] [--header]\n",
              av[0]);
      exit(2);
    }
  }
  return a;
}
static inline void rhs_f(const model *m, int on, double t, const double *x, double *d) {
  double F = 0;
  d[8] = 0;
  if (on) {
    double lam = x[8], i = lam * (m->z0 + x[0]) / (m->L0 * m->z0);
    F = lam * lam / (2 * m->L0 * m->z0);
    d[8] = m->Um * R_SIN(m->w * t) - m->R * i;
  }
  for (int r = 0; r < 4; r++) {
    double s = m->g[r] * F;
    for (int c = 0; c < 4; c++) s -= m->AK[r][c] * x[c] + m->AB[r][c] * x[4 + c];
    d[4 + r] = s;
    d[r] = x[4 + r];
  }
}
static inline double cur(const model *m, const double *x) {
  return x[8] * (m->z0 + x[0]) / (m->L0 * m->z0);
}
