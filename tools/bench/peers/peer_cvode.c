/* SPDX-License-Identifier: GPL-3.0-or-later */
/* SUNDIALS CVODE with rootfinding: --method adams (fixed-point) | bdf (Newton, dense). */
#include "model.h"
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
typedef struct {
  model m;
  int on;
  long nf;
} ud;
static int f(realtype t, N_Vector y, N_Vector d, void *u) {
  ud *q = u;
  q->nf++;
  rhs_f(&q->m, q->on, t, N_VGetArrayPointer(y), N_VGetArrayPointer(d));
  return 0;
}
static int g(realtype t, N_Vector y, realtype *o, void *u) {
  (void)t;
  ud *q = u;
  o[0] = q->on ? N_VGetArrayPointer(y)[8] : 1.0;
  return 0;
}
int main(int ac, char **av) {
  args a = parse(ac, av, "adams");
  ud u;
  rec r;
  double best = 1e9, toff = 0;
  long steps = 0;
  model_init(&u.m, a.pulses);
  rec_init(&r, &u.m);
  model *m = &u.m;
  for (int rep = 0; rep < a.repeat; rep++) {
    double w0 = wall();
    SUNContext sc;
    SUNContext_Create(NULL, &sc);
    N_Vector y = N_VNew_Serial(9, sc), at = N_VNew_Serial(9, sc), yk = N_VNew_Serial(9, sc);
    N_VConst(0, y);
    static const double sca[9] = {1e-3, 1e-3, 1e-3, 1e-2, .3, .3, .3, 3, 1};
    for (int j = 0; j < 9; j++) N_VGetArrayPointer(at)[j] = a.rtol * sca[j];
    int bdf = !strcmp(a.method, "bdf");
    void *c = CVodeCreate(bdf ? CV_BDF : CV_ADAMS, sc);
    u.on = 0;
    u.nf = 0;
    toff = 0;
    steps = 0;
    CVodeInit(c, f, 0, y);
    CVodeSVtolerances(c, a.rtol, at);
    CVodeSetUserData(c, &u);
    CVodeSetMaxNumSteps(c, 10000000);
    CVodeSetMaxStep(c, 0.005);
    SUNMatrix A = NULL;
    SUNLinearSolver L = NULL;
    SUNNonlinearSolver NL = NULL;
    if (bdf) {
      A = SUNDenseMatrix(9, 9, sc);
      L = SUNLinSol_Dense(y, A, sc);
      CVodeSetLinearSolver(c, L, A);
    } else {
      NL = SUNNonlinSol_FixedPoint(y, 0, sc);
      CVodeSetNonlinearSolver(c, NL);
    }
    CVodeRootInit(c, 1, g);
    int dir = -1;
    CVodeSetRootDirection(c, &dir);
    CVodeSetNoInactiveRootWarn(c);
    double t = 0;
    int k = 0, kf = 0;
    double *x = N_VGetArrayPointer(y), *z = N_VGetArrayPointer(yk);
    long nst;
    rec_put(&r, k++, 0, 0, 0, 0, 0);
    while (t < m->tend) {
      double tn = m->tend, tf = m->t_fire0 + kf * m->T;
      int fire = 0;
      if (!u.on && kf < m->pulses && tf < tn) {
        tn = tf;
        fire = 1;
      }
      CVodeSetStopTime(c, tn);
      int fl = CVode(c, tn, y, &t, CV_ONE_STEP);
      if (fl < 0) return 1;
      double ti;
      for (; k < r.n && (ti = k * m->dt) <= t + 1e-13; k++) {
        if (ti > t) ti = t;
        CVodeGetDky(c, ti, 0, yk);
        rec_put(&r, k, z[0], z[1], z[2], z[3], u.on ? cur(m, z) : 0);
      }
      if (fl == CV_ROOT_RETURN) {
        u.on = 0;
        kf++;
        if (toff == 0) toff = t;
        x[8] = 0;
        CVodeGetNumSteps(c, &nst);
        steps += nst;
        CVodeReInit(c, t, y);
      } else if (fl == CV_TSTOP_RETURN && fire) {
        u.on = 1;
        x[8] = 0;
        CVodeGetNumSteps(c, &nst);
        steps += nst;
        CVodeReInit(c, t, y);
      }
    }
    CVodeGetNumSteps(c, &nst);
    steps += nst;
    CVodeFree(&c);
    if (A) {
      SUNLinSolFree(L);
      SUNMatDestroy(A);
    }
    if (NL) SUNNonlinSolFree(NL);
    N_VDestroy(y);
    N_VDestroy(at);
    N_VDestroy(yk);
    SUNContext_Free(&sc);
    double w = wall() - w0;
    if (w < best) best = w;
  }
  rec_report(&r, m, a.out, "cvode", a.method, a.rtol, best, toff, steps, u.nf);
  return 0;
}
