/* SPDX-License-Identifier: GPL-3.0-or-later
 * Field tables: one line per key gives its parser, default, allowed range, help and print-out. */
#ifndef VS_BASE_FIELD_H
#define VS_BASE_FIELD_H

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"
#include "base/text.h"
#include "base/tree.h"

typedef enum vs_field_kind {
  VS_REAL,   /* double, SI */
  VS_PAIR,   /* double[2], SI, written [x, y] */
  VS_CHOICE, /* int: which of `choices` */
  VS_COUNT,  /* int: a whole number, or (where choices names one) that word, read as 0 */
  VS_NAME,   /* char[VS_NAME_SIZE] */
  VS_OPTION  /* a struct that begins with an int: 0 for the word `choices` names, 1 and the members
                of  `part` for a map of its keys */
} vs_field_kind;

enum { VS_NAME_SIZE = 256 };

typedef struct vs_field {
  const char *key;
  vs_field_kind kind;
  const char *unit;              /* as shown and as asked for; "" for a pure number */
  const char *default_text;      /* as a user would write it */
  double min, max;               /* allowed, in `unit` */
  bool open;                     /* min and max themselves are not allowed */
  size_t offset;                 /* of the member in the struct it fills */
  const char *text;              /* what it means, one line */
  const char *choices;           /* VS_CHOICE: "paper|derived"; VS_COUNT, VS_OPTION: a word for 0 */
  const struct vs_section *keys; /* VS_OPTION: what a map may hold */
} vs_field;

typedef struct vs_section {
  const char *name; /* of the map in the scene */
  const vs_field *fields;
  size_t count;
} vs_section;

/* Fills every member of out: from the scene's map where it names the key, else from the default.
 * map: NULL for "not there". Errors, each of which a check carries on from: unknown key (nearest
 * one named), wrong unit, out of range. */
vs_status vs_field_section_read(const vs_section *section, const vs_node *map, void *out,
                                vs_error *err);

/* Refuses keys of map that stand in no section's name; others are asked for by `names`. */
vs_status vs_field_known_keys(const vs_node *map, const char *what, const char *const *names,
                              size_t count, vs_error *err);

/* Adds the field's present value as JSON: {"value": 6, "unit": "mm"} or "paper". */
void vs_field_json(const vs_field *field, const void *values, vs_text *text);

/* "6..12 mm", "paper|derived", ...: what is allowed, for messages and listings. */
void vs_field_range(const vs_field *field, char *text, size_t size);

/* Reads one value for a field; place is where it stands. For values that come from elsewhere than a
 * scene. On error the value stays as it was. */
vs_status vs_field_read(const vs_section *section, const vs_field *field, const vs_node *node,
                        void *out, vs_error *err);

#endif
