/* SPDX-License-Identifier: GPL-3.0-or-later
 * A writer of JSON (RFC 8259). It adds objects, arrays and values to a vs_text and knows where
 * commas, line breaks and indents belong. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/text.h"

/* How the members of an object or array are laid out. */
typedef enum vs_json_layout {
  VS_JSON_ROW,  /* side by side: {"a": 1, "b": 2} */
  VS_JSON_LINES /* each on a line of its own, indented by 2 for every VS_JSON_LINES around it */
} vs_json_layout;

enum { VS_JSON_DEPTH = 24 }; /* most objects and arrays inside each other; asserted */

/* The members of this struct are the writer's own. */
typedef struct vs_json {
  vs_text *text; /* borrowed */
  struct {
    char close;
    bool lines, has_members;
  } level[VS_JSON_DEPTH];
  int depth;     /* how many of level are open */
  bool same_row; /* the next member stays on its predecessor's line */
} vs_json;

/* A writer of one value. The text may already hold something else. */
vs_json vs_json_new(vs_text *text);
/* A writer that goes on inside an object of layout VS_JSON_LINES whose beginning, with at least one
 * member, the text already holds. vs_json_end closes that object. */
vs_json vs_json_inside(vs_text *text);

/* In all of these key is the member's name in an object; it is NULL in an array and outermost. */
void vs_json_object(vs_json *json, const char *key, vs_json_layout layout);
void vs_json_array(vs_json *json, const char *key, vs_json_layout layout);
/* Closes the innermost object or array. */
void vs_json_end(vs_json *json);
void vs_json_text(vs_json *json, const char *key, const char *value); /* NULL gives null */
/* Writes what "%.*g" would; null where the value is not finite, as JSON has no word for that. */
void vs_json_number(vs_json *json, const char *key, double value, int digits);
void vs_json_whole(vs_json *json, const char *key, int64_t value);
void vs_json_bool(vs_json *json, const char *key, bool value);
void vs_json_null(vs_json *json, const char *key);
/* Begins a member whose value the caller then adds to the text itself. */
void vs_json_key(vs_json *json, const char *key);
/* Keeps the next member of a VS_JSON_LINES on the line of the one before it. */
void vs_json_same_row(vs_json *json);

/* Returns where the string that begins at text, with its opening quote, ends, behind its closing
 * one; NULL: it is none. */
const char *vs_json_string_end(const char *text);
/* True if the text is one JSON value, blanks around it, with at most VS_JSON_DEPTH levels. */
bool vs_json_is_whole(const char *text);

/* Adds the string alone, in quotes and escaped. */
void vs_json_string(vs_text *text, const char *string);
