/* SPDX-License-Identifier: GPL-3.0-or-later
 * The table of all methods. A new one is a file with its const struct, and a row in the table. */
#ifndef VS_STUDY_METHODS_H
#define VS_STUDY_METHODS_H

#include "study/method.h"

/* NULL ends it. Of several methods that claim a section the first is taken. In this order a study's
 * methods are numbered: the first one's index runs slowest, and one that searches comes behind
 * those whose axes it takes. */
extern const vs_method *const vs_methods_all[];

#endif
