/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the last bits of numbers hang on besides scene and program: the processor's family, the C
 * library with its functions (sin, exp, pow, ... have other last bits on a processor without fused
 * multiply-add), ngspice and GSL. A study's journal says on what its rows were made, so that rows
 * of two kinds are not joined in silence. */
#pragma once

#include <stdio.h>

#include "base/json.h"
#include "workers/row_shape.h"

/* What this process computes on, in one line: "x86_64, libm 1a2b3c4d, glibc 2.36, ngspice 39, GSL
 * 2.7.1". The word behind libm is a digest over what its functions return for many arguments. */
const char *vs_platform_here(void);

/* A list of such lines, each with a line end. Adds those of `lines` that the list lacks; the last
 * of them may lack its line end. */
void vs_platform_add(vs_text *list, const char *lines);
/* True if the list has two lines or more. */
bool vs_platform_differ(const vs_text *list);
/* Adds a differing list as the member "computed_on"; any other adds nothing. */
void vs_platform_json(const vs_text *list, vs_json *json);

/* Warns that rows were made on all that the list has, and of the columns of that shape whose digits
 * may differ for that. */
void vs_platform_warn(const vs_text *list, const vs_row_shape *shape, const char *path);
