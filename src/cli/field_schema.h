/* SPDX-License-Identifier: GPL-3.0-or-later
 * JSON Schemas of what the rows of a table of keys take (base/field.h). */
#pragma once

#include "base/field.h"
#include "base/json.h"
#include "default_models.h"

/* In all of these key is the member's name in an object; it is NULL in an array. */

/* Begins a schema of values of that type, as JSON Schema calls it, which one vs_json_end closes;
 * and one with a list of alternatives, which two close. */
void vs_field_schema_open(vs_json *json, const char *key, const char *type);
void vs_field_schema_either(vs_json *json, const char *key);
/* Closes so many objects and arrays. */
void vs_field_schema_close(vs_json *json, int levels);

/* Each adds a schema: any value of that type; one word; a text of that pattern; a quantity of the
 * field's unit. */
void vs_field_schema_type(vs_json *json, const char *type);
void vs_field_schema_word(vs_json *json, const char *key, const char *word);
void vs_field_schema_pattern(vs_json *json, const char *key, const char *pattern);
void vs_field_schema_quantity(vs_json *json, const vs_field *field);
/* Adds the alternatives of what may be said of one instrument. */
void vs_field_schema_instrument(vs_json *json);

/* Adds the member of an object that is called as the row, with its meaning, its default, and all
 * that it takes. A field whose min is not below its max has no range; a unit that is none, as "~",
 * stands for any. A study's scene keys are the ground's, which is NULL elsewhere; those of a
 * machine, a deck and what a scene names itself may have any value. */
void vs_field_schema_row(vs_json *json, const vs_field *row, const vs_default_models *ground);
void vs_field_schema_field(vs_json *json, const vs_field *field);

/* Adds the members of a schema of a map that has these keys and no others; without its type. */
void vs_field_schema_properties(vs_json *json, const vs_section *keys);
/* Adds the member that says which of the rows a map must have. */
void vs_field_schema_required(vs_json *json, const vs_field *rows);

/* Adds the member that a schema of studies refers to: the values of each of the scene's keys. */
void vs_field_schema_definitions(vs_json *json, const vs_default_models *ground);
