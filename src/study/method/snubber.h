/* SPDX-License-Identifier: GPL-3.0-or-later
 * The method that stands under `snubber`: a search for the cheapest snubber that holds. */
#ifndef VS_STUDY_SNUBBER_H
#define VS_STUDY_SNUBBER_H

#include "study/method.h"

extern const vs_method vs_snubber_method;

#endif
