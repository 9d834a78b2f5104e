/* SPDX-License-Identifier: GPL-3.0-or-later
 * Formulas of a machine's file: how they are read, and what they may name. */
#pragma once

#include "plant/machine.h"

/* What a formula may name besides parameters and the lets above it. */
typedef enum vs_expression_kind {
  VS_EXPRESSION_CONSTANT, /* nothing */
  VS_EXPRESSION_LET,      /* lambda and z; others may then name it only where they may, too */
  VS_EXPRESSION_LAW,      /* lambda and z, as terms 0 and 1 */
  VS_EXPRESSION_PROBE,    /* what a probe may: VS_MACHINE_TERM_... */
  VS_EXPRESSION_MOTION    /* the coordinates, as terms 0, 1, ... */
} vs_expression_kind;

/* What a formula is read for. */
typedef struct vs_expression_use {
  vs_expression_kind kind;
  const char *what;           /* its name in messages */
  const vs_dimension *wanted; /* what it must have; NULL: it may have any */
} vs_expression_use;

/* Reads the node's formula, or its number with a unit ("20 kN/m", with a blank between), into out,
 * which keeps nothing after an error. Errors with their place in the text: it is no formula; it
 * names what is not known, or not allowed; its units do not fit. */
vs_status vs_expression_read(const vs_machine *machine, const vs_node *node,
                             const vs_expression_use *use, vs_expression *out, vs_error *err);

/* Evaluates an expression with these values of the machine's names, in SI. Returns false where the
 * value is not finite. */
bool vs_expression_value(vs_expression *expression, const double values[VS_MACHINE_NAMES],
                         double *value);
