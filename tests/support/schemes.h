/* SPDX-License-Identifier: GPL-3.0-or-later
 * Schemes that couple machine and circuit at macro steps of one fixed length H, which exist only to
 * be compared: none of them is the product's.
 *
 * The circuit is the coil with its resistance behind an ideal thyristor, the machine the product's
 * model. Inside a macro step each is solved by the classical Runge-Kutta rule in substeps of at
 * most 0.02 rad of the fastest thing there is (1e-9 of the result), firing and extinction located:
 * what is left of an error is the scheme's. As H goes to 0 all schemes, but "7c_no_emf", go to the
 * switched tier. All SI.
 *
 *   cosim c;
 *   cosim_begin(&c, scheme_find("flux_seidel"), &setup->model, &setup->timeline, 50e-6);
 *   while (c.t_s < until_s && cosim_step(&c)) { look at c.x, c.flux_wb, or have c.show called }
 *   cosim_end(&c); */
#pragma once

#include "conveyor.h"
#include "engine/timeline.h"
#include "plant/mechanics.h"
#include "engine/step.h"

/* What the circuit takes for the coil. */
typedef enum coil_form {
  COIL_FLUX,  /* lambda' = u - R lambda z/2a, z as the machine told */
  COIL_7C,    /* L i' = u - R i - i dL/dt, with L and dL/dt held from the step's beginning */
  COIL_NO_EMF /* the same without dL/dt */
} coil_form;

/* What the circuit tells the machine; the machine tells the gap (COIL_7C: and its rate). */
typedef enum exchanged {
  TELLS_I,    /* F = a i^2/z^2 with the machine's own z */
  TELLS_FLUX, /* F = lambda^2/4a */
  TELLS_FORCE /* F, by the circuit's own z */
} exchanged;

typedef struct cosim cosim;
typedef struct scheme {
  const char *name, *text;
  double kappa; /* numerical damping is kappa H <F/z> (NAN: not of first order, or not known) */
  coil_form form;
  exchanged tells;
  bool linear;            /* what is told runs on a straight line inside a step, and is not held */
  double relaxation;      /* iterated: part of each correction that is taken */
  bool (*step)(cosim *c); /* one macro step; false: it did not converge */
} scheme;

extern const scheme schemes[];
extern const size_t n_schemes;
const scheme *scheme_find(const char *name); /* NULL: there is none */

/* State, and the books: what the circuit takes in, by its own current; what its resistance loses;
 * what the force does, as the machine has it. */
enum { BOOK_TAKEN, BOOK_COPPER, BOOK_WORK, BOOKS };
typedef struct cosim_state {
  double x[VS_STATES];
  double y; /* the circuit's: lambda, Wb (COIL_FLUX) or i, A */
  bool on;
  double fires_s; /* when it is off: the next time */
  double book_j[BOOKS];
} cosim_state;

/* Value at the beginning of a step, and slope. */
typedef struct course {
  double at, rate;
} course;

struct cosim {
  const scheme *scheme;
  const vs_model *model;
  const vs_timeline *timeline;
  double step_s; /* H */
  long n;        /* macro steps done */
  double t_s;    /* n H */
  cosim_state now;
  double z_m, told;               /* what was last exchanged, and */
  double z_before_m, told_before; /* one step before */
  double slope;                   /* condensed: d(told anew)/d(told), as last seen */
  double p_min_m, p_max_m;        /* at substeps */
  double collapsed_s, diverged_s; /* when z <= 0, when the iteration found no end; NAN: not */
  long iterations;                /* of all steps: solutions of circuit and machine */
  /* Called with each substep of an accepted macro step when it is set: knots with x, q", q"',
   * lambda (of COIL_7C: 2a i/z), lambda', v_eva_v (the mains while it conducts) and i_mains_a. */
  void (*show)(void *ctx, const vs_knot *from, const vs_knot *to);
  void *ctx;
  long substeps;          /* per macro step */
  double (*x)[VS_STATES]; /* at the substeps' ends, [substeps + 1] */
  double *y, *y_rate;     /* the circuit's there */
  bool *conducts;         /* in the substep that ends there */
  vs_knot *knots;         /* two, of the substep shown */
};

/* From rest, at t = 0. */
void cosim_begin(cosim *c, const scheme *s, const vs_model *model, const vs_timeline *timeline,
                 double step_s);
/* Then: the machine somewhere else, still at t = 0 without current. */
void cosim_place(cosim *c, const double x[VS_STATES]);
/* One macro step; false: z <= 0, or no convergence, and the run is over. */
bool cosim_step(cosim *c);
/* Until t_s >= until_s to rounding; false as above. */
bool cosim_run(cosim *c, double until_s);
void cosim_end(cosim *c);

double cosim_flux(const cosim *c); /* lambda at t_s, Wb; of COIL_7C: 2a i/z */
/* What the books leave over: taken - copper - work - gained in the air gap, J. */
double cosim_left(const cosim *c);
