/* SPDX-License-Identifier: GPL-3.0-or-later
 * The method that stands under `find`: a search for the worst case. */
#ifndef VS_STUDY_WORST_H
#define VS_STUDY_WORST_H

#include "study/method.h"

extern const vs_method vs_worst_method;

#endif
