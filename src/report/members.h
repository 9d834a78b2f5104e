/* SPDX-License-Identifier: GPL-3.0-or-later
 * Members of two maps matched by their keys, and JSON values as text. */
#pragma once

#include <stdbool.h>

#include "base/text.h"
#include "base/tree.h"
#include "run/engineering.h"

/* Calls visit for each key of either map: those of A in their order, then those that only B has. A
 * missing member is NULL; a map may be NULL, too. */
typedef void (*vs_member_visit)(void *ctx, const char *key, const vs_node *a, const vs_node *b);
void vs_members_join(const vs_node *a, const vs_node *b, vs_member_visit visit, void *ctx);

/* The same for each dotted key of nested maps whose values differ as text. A map with the member
 * "value" counts as a value. */
void vs_members_unlike(const vs_node *a, const vs_node *b, vs_member_visit visit, void *ctx);

/* Adds the value in one line: "95 deg" of {value: 95, unit: deg}; "-" of NULL. */
void vs_member_text(const vs_node *node, vs_text *out);

/* Returns the number in a text; NaN: the text is no number, such as null, or there is no node. */
double vs_member_number(const vs_node *node);
/* Writes the value with the prefix that leaves one to three digits before the point, as
 * vs_engineering_text does, also where its unit has another prefix: "4.072 A" of 0.004072 kA.
 * Returns the text. */
const char *vs_member_amount(double value, const char *unit, char text[VS_ENGINEERING_SIZE]);
/* Returns the text of the map's member; "" where there is none. */
const char *vs_member_word(const vs_node *map, const char *key);
