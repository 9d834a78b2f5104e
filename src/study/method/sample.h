/* SPDX-License-Identifier: GPL-3.0-or-later
 * The methods that stand under `sample`: points of what is not known exactly. */
#ifndef VS_STUDY_SAMPLE_H
#define VS_STUDY_SAMPLE_H

#include "study/method.h"

extern const vs_method vs_sample_sobol, vs_sample_latin, vs_sample_monte_carlo, vs_sample_corners;

#endif
