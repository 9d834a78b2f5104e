/* SPDX-License-Identifier: GPL-3.0-or-later
 * JSON Schemas of what the fields of a table take (base/field.h). */
#ifndef VS_CLI_FIELD_SCHEMA_H
#define VS_CLI_FIELD_SCHEMA_H

#include "base/field.h"
#include "base/json.h"

/* Each adds a schema to an array of alternatives: any value of that type, as JSON Schema calls it;
 * one word; one of the words "one|other"; a whole number in the field's range; a pure number or a
 * quantity of the field's unit. A field whose min is not below its max has no range; a unit that is
 * none, as "~", stands for any. */
void vs_field_schema_type(vs_json *json, const char *type);
void vs_field_schema_word(vs_json *json, const char *word);
void vs_field_schema_words(vs_json *json, const char *choices);
void vs_field_schema_whole(vs_json *json, const vs_field *field);
void vs_field_schema_quantity(vs_json *json, const vs_field *field);

/* Adds all alternatives that the field takes. */
void vs_field_schema_values(vs_json *json, const vs_field *field);

/* Adds the member of an object that is called as the field, with its meaning and default. */
void vs_field_schema_field(vs_json *json, const vs_field *field);

/* Adds the members of a schema of a map that has these keys and no others. */
void vs_field_schema_keys(vs_json *json, const vs_field *fields, size_t count);
/* The same members without the type. */
void vs_field_schema_properties(vs_json *json, const vs_field *fields, size_t count);

#endif
