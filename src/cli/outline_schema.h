/* SPDX-License-Identifier: GPL-3.0-or-later
 * JSON Schemas of what the tables of keys of studies and machines take (base/field.h). */
#ifndef VS_CLI_OUTLINE_SCHEMA_H
#define VS_CLI_OUTLINE_SCHEMA_H

#include "base/field.h"
#include "base/json.h"
#include "default_models.h"

/* Adds the member `key` with what the row takes. A study's scene keys are the ground's; those of a
 * machine, a deck and what a scene names itself may have any value. */
void vs_outline_schema_row(vs_json *json, const char *key, const vs_outline *row,
                           const vs_default_models *ground);

/* Adds a map of the table's keys to an array of alternatives. */
void vs_outline_schema_map(vs_json *json, const vs_outline *keys);
/* Adds the member that says which keys of the table a map must have. */
void vs_outline_schema_required(vs_json *json, const vs_outline *keys);
/* Adds the alternatives of what may be said of one instrument. */
void vs_outline_schema_instrument(vs_json *json);

/* Adds the member that a schema of studies refers to: the values of each of the scene's keys. */
void vs_outline_schema_definitions(vs_json *json, const vs_default_models *ground);

#endif
