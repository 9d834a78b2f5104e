/* SPDX-License-Identifier: GPL-3.0-or-later
 * The machine as numbers: M q" + B q' + K q = f0 - F c, where c says how each coordinate opens the
 * air gap, z = D + d + c.q. Constant once it is built (plant/build.h). */
#pragma once

#include "plant/actuator.h"
#include "plant/machine.h"

/* A state x is (q, q'): as many numbers as the machine has coordinates, twice, without a gap. In m
 * and rad, or whatever the machine's file says. */
enum { VS_MOST_DOF = VS_MACHINE_COORDINATES, VS_MOST_STATES = 2 * VS_MOST_DOF };

typedef struct vs_load_values {
  double density_kg_m3, volume_m3;
  double fraction; /* lambda_t; NaN: `auto`, found with the scene's orbit (orbit/fraction.h) */
} vs_load_values;
extern const vs_section vs_model_load_section;

/* The paper's range of the throw coefficient K, the largest acceleration of the trough along
 * load.along over g, and the lambda_t at its two ends. */
typedef struct vs_load_range {
  double least_k, most_k, least, most;
} vs_load_range;
extern const vs_load_range vs_model_load_range;
/* The paper's empirical lambda_t for a throw coefficient: linear over the range, held at its ends.
 */
double vs_model_fraction(double k);

/* g as the paper has it, m/s2. */
extern const double vs_model_gravity_m_s2;

/* A mode of the free motion. */
typedef struct vs_mode {
  double re_1_s, im_rad_s; /* its eigenvalue s */
  double frequency_hz;     /* |s|/2 pi */
  double time_constant_s;  /* -1/Re s; infinite when undamped */
  double damping_ratio;    /* -Re s/|s| */
  double drive;            /* the size of its share in c.q after a unit impulse of F, m/(N s) */
  double shape_re[VS_MOST_DOF],
      shape_im[VS_MOST_DOF]; /* of q, scaled to a largest component of 1 */
} vs_mode;
/* Matrices and vectors are filled up to `dof`. Units follow from the coordinates': with m and rad,
 * M is in kg, kg m and kg m2, and the others likewise. */
typedef struct vs_model {
  const vs_machine *machine; /* the file; names, units and probes */
  vs_machine_values parameters;
  vs_actuator_values actuator;
  vs_load_values load;
  double riding; /* lambda_t in effect: load.fraction, or what was found for `auto` */
  vs_coil coil;
  vs_stops stops;
  int dof;
  double along[VS_MOST_DOF]; /* c: the gap's opening per coordinate */
  int alone; /* 1 + the number of the coordinate that alone opens the gap, by as much as it moves;
                0: there is none, and c.q is to be computed */
  double constant[VS_MOST_DOF];               /* f0: forces that never change, N or N m */
  bool loaded;                                /* f0 is not 0 */
  double mass[VS_MOST_DOF][VS_MOST_DOF];      /* M */
  double damping[VS_MOST_DOF][VS_MOST_DOF];   /* B */
  double stiffness[VS_MOST_DOF][VS_MOST_DOF]; /* K */
  double mb_column[VS_MOST_DOF][VS_MOST_DOF]; /* M^-1 B; [j][i] is row i, column j */
  double mk_column[VS_MOST_DOF][VS_MOST_DOF]; /* M^-1 K; laid out the same */
  double mf[VS_MOST_DOF];                     /* -M^-1 c: the accelerations per newton of F */
  double m0[VS_MOST_DOF];                     /* M^-1 f0 */
  double compliance_m_n;  /* c.K^-1 c: how far one newton along the gap moves it at rest; INFINITY
                             where a coordinate has no spring */
  double per_newton_m_s2; /* c.mf: the gap's acceleration per newton of F; negative */
  double way[VS_MACHINE_WAYS][VS_MOST_DOF]; /* how the trough moves, m per coordinate; all 0 where
                                               the machine's file does not say */
  bool reloaded;                            /* events change the load in the run (engine/setup.h) */
  bool pulls_in; /* direct voltage drives it against a stop, so that it has the measures of that */
  bool plain; /* the coil is square and the stop, if there is one, is a single linear one
                 at the pole cover: the motion is polynomials' products (engine/ideal/taylor.h) */
  vs_mode mode[VS_MOST_STATES]; /* of the free motion, as vs_mechanics_modes sorts them */
  double growth_1_s; /* the largest Re s of the modes that is more than rounding; 0: none grows */
  double fastest_rad_s; /* the largest |s| of the mechanics' modes; 0 for a free mass */
  double contact_rad_s; /* a bound of |s| while a stop is touched; without a stop it is
                           fastest_rad_s */
  double working_rad_s; /* |s| of the mode that F drives hardest along the gap */
} vs_model;
