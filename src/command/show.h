/* SPDX-License-Identifier: GPL-3.0-or-later
 * The result of one run as a table for people. */
#ifndef VS_COMMAND_SHOW_H
#define VS_COMMAND_SHOW_H

#include <stdio.h>

#include "scene/result.h"

/* Prints scene, tier, every measure, the verdict and the cost. Limits and stresses are in the unit
 * that the rating's or the limit's line was written in. */
void vs_show_result(const vs_result *result, FILE *out);

/* Prints for each class of apparatus which harmonic takes most of its limit, and how much. */
void vs_show_classes(const vs_drawn *drawn, FILE *out);

#endif
