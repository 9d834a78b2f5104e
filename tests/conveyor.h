/* SPDX-License-Identifier: GPL-3.0-or-later
 * The paper's conveyor by its own names, for tests that know which machine they look at. */
#ifndef VS_TESTS_CONVEYOR_H
#define VS_TESTS_CONVEYOR_H

#include "machine/mechanics.h"
#include "sim/channel.h"

enum { P, U, W, PHI, VS_DOF, VS_STATES = 2 * VS_DOF };
enum {
  VS_CH_P = VS_CH_Q,
  VS_CH_U,
  VS_CH_W,
  VS_CH_PHI,
  VS_CH_VP,
  VS_CH_VU,
  VS_CH_VW,
  VS_CH_VPHI,
  VS_CH_AP,
  VS_CH_AU,
  VS_CH_AW,
  VS_CH_APHI
};

static inline double conveyor_gap(const vs_model *m, double p_m) {
  return vs_coil_gap(&m->coil, p_m);
}

#endif
