/* SPDX-License-Identifier: GPL-3.0-or-later
 * An axis: one scene key that differs from case to case, its unit, and what a study lists of it. */
#pragma once

#include <stdint.h>

#include "base/field.h"
#include "run/keys.h"
#include "run/scene.h"

/* All numbers of an axis are in `unit`. */
typedef struct vs_axis {
  char key[VS_KEY_SIZE];         /* "circuit.r1" */
  char column[VS_KEY_SIZE + 24]; /* its column in study.csv: "circuit.r1_ohm" */
  char section[VS_KEY_SIZE];     /* "circuit" */
  const vs_field *field;         /* the scene key's; lives as long as the scene it was found in */
  const char *unit;              /* the field's; "" for words and pure numbers */
  const char *by;                /* the study's key it stands under: "vary", "sample", ... */
  vs_where where;                /* of the key in the study */
  size_t about;   /* of a tolerance of what another axis has: that axis' number, from 1; else 0. Its
                     own number is that axis' with the tolerance on it, and is the one that is run */
  bool is_word;   /* a choice or a name: its numbers are indices into word, and it has no range */
  double nominal; /* what the scene and `set` say; NaN: a word, or the scene has none */
  char **word;    /* owned by the axis, as are word_where, value and own */
  vs_where *word_where;
  size_t n_words;
  double *value; /* those listed, or those its range is cut into; NULL: none */
  size_t n_values;
  bool ranged; /* all of from..to is meant, and value cuts it */
  bool log;    /* the range is even in the logarithm */
  double from, to;
  void *own; /* what the method that made the axis keeps of it; freed with free() */
} vs_axis;

/* Makes the axis of the scene key that a study's node has for its key ("circuit.r1"). by: the
 * study's key it stands under. Errors: the scene has no such key (the nearest is named); the key
 * has no single value. */
vs_status vs_axis_init(vs_axis *axis, const vs_scene *scene, const vs_node *node, const char *by,
                       vs_error *err);
void vs_axis_free(vs_axis *axis);

/* Reads what a key under vary may say: one value; [a, b, ...]; 'A .. B'; {from, to, step};
 * {log: [a, b], n}; {lin: [a, b], n}. */
extern const vs_field vs_axis_many; /* all of these but one value */
vs_status vs_axis_values(vs_axis *axis, const vs_node *node, vs_error *err);

/* Reads one value, with its unit and within the key's range, as the axis' number: to 12 digits, as
 * many as study.csv has; of a word its index, under which it is added when it is new. */
vs_status vs_axis_number(vs_axis *axis, const vs_node *node, double *number, vs_error *err);

/* Reads a whole number from a key of a map, for the keys of methods and of ranges. *value stays as
 * it is when the map has no such key. */
vs_status vs_axis_whole(const vs_node *map, const char *key, uint64_t least, uint64_t most,
                        uint64_t *value, vs_error *err);
/* Reads which of the words, "one|other|...", a key of a map has: *which is its place, from 0, and
 * stays as it is when the map has no such key. name: "SECTION.KEY", for errors. */
vs_status vs_axis_word(const vs_node *map, const char *name, const char *words, int *which,
                       vs_error *err);

/* Returns the number at the share u, 0..1, of the way from one end of the range to the other. */
double vs_axis_between(const vs_axis *axis, double u);

/* Writes the axis' number as it stands in study.csv: a number of 12 digits, for which it returns
 * true, or a word; nothing of NaN, a case that has no such number. */
bool vs_axis_print(const vs_axis *axis, double number, char *text, size_t size);

/* Puts the axis' number, with so many digits and its unit, or its word into a scene's tree. Where
 * study.csv has 12 digits of it, the scene has no more. */
void vs_axis_put(const vs_axis *axis, double number, int digits, vs_tree *tree);
