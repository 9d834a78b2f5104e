/* SPDX-License-Identifier: GPL-3.0-or-later
 * The study's key sensitivity: logarithmic derivatives as columns of each case. */
#ifndef VS_STUDY_DERIVATIVES_H
#define VS_STUDY_DERIVATIVES_H

#include "study/method.h"

extern const vs_method vs_derivative_method;

#endif
