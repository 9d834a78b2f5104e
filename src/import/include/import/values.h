/* SPDX-License-Identifier: GPL-3.0-or-later
 * Numbers and expressions in a netlist, and its .param lines. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/names.h"
#include "import/listing.h"

enum { VS_VALUES_NAME = 64 };

/* One assignment of a .param line outside of subcircuits. */
typedef struct vs_value_param {
  char name[VS_VALUES_NAME]; /* in lower case */
  char *text;                /* its value as written; owned */
  double value;
  bool tried;  /* `known` has been found out */
  bool known;  /* `value` is its value: a number, or an expression of numbers */
  bool number; /* it is written as a number */
  size_t card; /* index of its line */
} vs_value_param;

/* Begins as {0}; ends with vs_values_free. */
typedef struct vs_values {
  vs_value_param *item; /* owned */
  size_t count;
  vs_names names;            /* index of the last one of each name */
  bool rkm;                  /* 4k7 means 4.7k, as LTspice and KiCad read it */
  const vs_listing *listing; /* for its .func lines; borrowed */
} vs_values;

void vs_values_read(vs_values *values, const vs_listing *listing);
void vs_values_free(vs_values *values);

/* Reads a SPICE number with its suffix (t g meg k m mil u n p f); letters after it are ignored.
 * Returns false where the text is no number, or one that programs read differently, such as 4k7
 * unless values->rkm is set. */
bool vs_values_number(const vs_values *values, vs_word text, double *number);

/* Evaluates a number, a name, or an expression, with or without braces. Returns false where the
 * value is not known before a run. */
bool vs_values_of(const vs_values *values, vs_word text, double *value);

/* The parameter of that name, ignoring case; NULL: there is none. */
const vs_value_param *vs_values_find(const vs_values *values, const char *name);
