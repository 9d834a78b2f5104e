/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "outline_schema.h"

#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "field_schema.h"
#include "run/keys.h"
#include "run/sections.h"

/* What a row is written for. */
typedef struct context {
  vs_json *j;
  const vs_default_models *ground; /* NULL: there are no scene keys */
  const char *scene_key;           /* that the value stands under; NULL: none that is known */
  const vs_field *field;           /* of that key */
} context;

static void put_alternatives(context c, const vs_outline *row);

static bool is_word(const vs_field *f) {
  return f && (f->kind == VS_CHOICE || f->kind == VS_NAME);
}

/* ---- plain values ---- */

static void put_nothing(context c, const vs_outline *row) {
  (void)row;
  vs_field_schema_type(c.j, "null");
}

static void put_text(context c, const vs_outline *row) {
  (void)row;
  vs_field_schema_type(c.j, "string");
  vs_field_schema_type(c.j, "number");
}

static void put_whole(context c, const vs_outline *row) {
  (void)row;
  vs_field_schema_whole(c.j, &(vs_field){.unit = ""});
}

static void put_part(context c, const vs_outline *row) {
  (void)row;
  vs_field_schema_quantity(c.j, &(vs_field){.unit = ""});
}

static void put_flag(context c, const vs_outline *row) {
  (void)row;
  vs_field_schema_type(c.j, "boolean");
}

static void put_word(context c, const vs_outline *row) {
  vs_field_schema_words(c.j, row->words);
}

static void put_list(context c, const vs_outline *row) {
  vs_json_object(c.j, NULL, VS_JSON_ROW);
  vs_json_text(c.j, "type", "array");
  vs_json_whole(c.j, "minItems", row->count < 0 ? 0 : row->count ? row->count : 1);
  if (row->count > 0) vs_json_whole(c.j, "maxItems", row->count);
  vs_json_object(c.j, "items", VS_JSON_ROW);
  vs_json_array(c.j, "anyOf", VS_JSON_ROW);
  put_alternatives(c, row->of);
  vs_json_end(c.j);
  vs_json_end(c.j);
  vs_json_end(c.j);
}

/* ---- instruments ---- */

static void put_instrument_keys(vs_json *j) {
  const vs_section *keys = &vs_instrument_section;
  vs_field fields[VS_INSTRUMENT_FIELDS];
  for (size_t k = 0; k < keys->count; k++) {
    fields[k] = keys->fields[k];
    if (vs_instruments_follows(&keys->fields[k])) fields[k].unit = "~"; /* whatever it is */
  }
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_field_schema_keys(j, fields, keys->count);
  vs_json_end(j);
}

void vs_outline_schema_instrument(vs_json *j) {
  vs_field_schema_type(j, "null");
  put_instrument_keys(j);
}

/* A machine's own set: its name, or a map. */
static void put_sensors(context c, const vs_outline *row) {
  put_text(c, row);
  vs_json_object(c.j, NULL, VS_JSON_ROW);
  vs_json_text(c.j, "type", "object");
  vs_json_object(c.j, "additionalProperties", VS_JSON_ROW);
  vs_json_array(c.j, "anyOf", VS_JSON_ROW);
  vs_outline_schema_instrument(c.j);
  vs_json_end(c.j);
  vs_json_end(c.j);
  vs_json_end(c.j);
}

/* ---- values of a scene's key ---- */

static void put_reference(context c, const vs_outline *row) {
  char path[VS_KEY_SIZE + 16];
  if (!c.scene_key) {
    put_text(c, row);
    return;
  }
  snprintf(path, sizeof path, "#/$defs/%s", c.scene_key);
  vs_json_object(c.j, NULL, VS_JSON_ROW);
  vs_json_text(c.j, "$ref", path);
  vs_json_end(c.j);
}

/* "5 % normal", "5 % normal within 2 sigma", "1 ohm uniform". Words and whole numbers have none. */
static void put_spread(context c, const vs_outline *row) {
  vs_text pattern = {0};
  if (is_word(c.field) || (c.field && c.field->kind == VS_COUNT)) return;
  if (!c.field) {
    put_text(c, row);
    return;
  }
  vs_text_add(&pattern, "(");
  vs_units_pattern(c.field->unit, &pattern);
  pattern.text[--pattern.length] = '\0'; /* its '$' */
  if (*c.field->unit) {
    vs_text_add(&pattern, "|");
    vs_units_pattern("", &pattern);
    pattern.text[--pattern.length] = '\0';
  }
  vs_text_add(&pattern, ") +(normal( +within +[0-9.]+ *sigma)?|uniform) *$");
  vs_json_object(c.j, NULL, VS_JSON_ROW);
  vs_json_text(c.j, "type", "string");
  vs_json_text(c.j, "pattern", pattern.text);
  vs_json_end(c.j);
  vs_text_free(&pattern);
}

static void put_setting(context c, const vs_outline *row) {
  (void)row;
  if (c.field) {
    vs_field_schema_values(c.j, c.field);
    return;
  }
  vs_json_object(c.j, NULL, VS_JSON_ROW);
  vs_json_end(c.j);
}

/* Calls each(ctx, key, field) for the scene's keys that are the same for all machines and decks. */
static void each_key(const vs_default_models *g,
                     void (*each)(void *, const char *, const vs_field *), void *ctx) {
  char name[VS_KEY_SIZE];
  for (int s = 0; s < VS_SECTIONS; s++) {
    if (vs_section_is_named(s)) continue;
    const vs_section *section = vs_section_fields(g->machine, g->deck, s);
    for (size_t k = 0; k < section->count; k++) {
      snprintf(name, sizeof name, "%s.%s", section->name, section->fields[k].key);
      each(ctx, name, &section->fields[k]);
    }
  }
}

/* A field as an axis of a study has it: one value, a number where it is one, of any size. */
static vs_field as_axis(const vs_field *f) {
  vs_field axis = *f;
  axis.min = axis.max = 0;
  if (axis.kind == VS_PROFILE) axis.kind = VS_REAL;
  if (axis.kind == VS_REAL) axis.choices = NULL;
  return axis;
}

static void put_definition(void *ctx, const char *key, const vs_field *f) {
  vs_json *j = ctx;
  const vs_field axis = as_axis(f);
  if (f->kind == VS_PAIR || f->kind == VS_OPTION) return;
  vs_json_object(j, key, VS_JSON_ROW);
  vs_json_array(j, "anyOf", VS_JSON_ROW);
  vs_field_schema_values(j, &axis);
  vs_json_end(j);
  vs_json_end(j);
}

void vs_outline_schema_definitions(vs_json *j, const vs_default_models *ground) {
  vs_json_object(j, "$defs", VS_JSON_LINES);
  each_key(ground, put_definition, j);
  vs_json_end(j);
}

/* ---- maps ---- */

typedef struct keyed {
  context c;
  const vs_outline *row;
} keyed;

static void put_keyed(void *ctx, const char *key, const vs_field *f) {
  const keyed *of = ctx;
  context c = of->c;
  const bool axis = !(of->row->takes & VS_OUTLINE_SETTING);
  if (axis && (f->kind == VS_PAIR || f->kind == VS_OPTION)) return; /* which is no axis */
  c.scene_key = key;
  c.field = f;
  vs_json_object(c.j, key, VS_JSON_ROW);
  vs_json_text(c.j, "description", f->text);
  vs_json_array(c.j, "anyOf", VS_JSON_ROW);
  put_alternatives(c, of->row);
  vs_json_end(c.j);
  vs_json_end(c.j);
}

/* The keys that depend on the scene, and maps of a section or an option. */
static void put_other_keys(const keyed *of) {
  const bool setting = of->row->takes & VS_OUTLINE_SETTING;
  vs_text pattern = {0};
  vs_text_add(&pattern, "^(");
  for (int s = 0; s < VS_SECTION_KEYS; s++)
    vs_text_add(&pattern, "%s%s", s ? "|" : "", vs_section_keys[s]);
  vs_text_add(&pattern, setting ? ")$|^(" : ")\\.[^.]+\\.|^(");
  const char *bar = "";
  for (int s = 0; s < VS_SECTION_KEYS; s++) {
    if (!vs_section_key_is_named(s)) continue;
    vs_text_add(&pattern, "%s%s", bar, vs_section_keys[s]);
    bar = "|";
  }
  vs_text_add(&pattern, ")\\.%s", setting ? "|\\..*\\." : "");
  vs_json_object(of->c.j, "patternProperties", VS_JSON_ROW);
  vs_json_object(of->c.j, pattern.text, VS_JSON_ROW);
  vs_json_array(of->c.j, "anyOf", VS_JSON_ROW);
  put_alternatives(of->c, of->row);
  vs_json_end(of->c.j);
  vs_json_end(of->c.j);
  vs_json_end(of->c.j);
  vs_text_free(&pattern);
}

void vs_outline_schema_required(vs_json *j, const vs_outline *keys) {
  vs_json_array(j, "required", VS_JSON_ROW);
  for (const vs_outline *row = keys; row->takes; row++)
    if (row->takes & VS_OUTLINE_NEEDED) vs_json_text(j, NULL, row->key);
  vs_json_end(j);
}

static void put_row(context c, const char *key, const vs_outline *row) {
  vs_json_object(c.j, key, VS_JSON_ROW);
  vs_json_array(c.j, "anyOf", VS_JSON_ROW);
  put_alternatives(c, row);
  vs_json_end(c.j);
  vs_json_end(c.j);
}

static bool of_scene_keys(const vs_outline *row) {
  return !row->key && row->takes & (VS_OUTLINE_VALUE | VS_OUTLINE_SPREAD | VS_OUTLINE_SETTING);
}

/* Sections as maps, {run: {until: 30 ms}}, where their keys are the same for all machines and
 * decks. */
static void put_sections(context c) {
  for (int s = 0; s < VS_SECTIONS; s++) {
    if (vs_section_is_named(s)) continue;
    const vs_section *section = vs_section_fields(c.ground->machine, c.ground->deck, s);
    vs_json_object(c.j, section->name, VS_JSON_ROW);
    vs_json_array(c.j, "anyOf", VS_JSON_ROW);
    vs_json_object(c.j, NULL, VS_JSON_ROW);
    vs_field_schema_keys(c.j, section->fields, section->count);
    vs_json_end(c.j);
    vs_field_schema_type(c.j, "null");
    vs_json_end(c.j);
    vs_json_end(c.j);
  }
}

static void put_map_keys(context c, const vs_outline *keys) {
  const vs_outline *row = keys, *any = NULL;
  vs_json_text(c.j, "type", "object");
  vs_json_object(c.j, "properties", VS_JSON_ROW);
  if (of_scene_keys(keys)) each_key(c.ground, put_keyed, &(keyed){c, keys});
  if (of_scene_keys(keys) && keys->takes & VS_OUTLINE_SETTING) put_sections(c);
  for (; row->takes; row++)
    if (row->key)
      put_row(c, row->key, row);
    else
      any = row;
  for (size_t k = 0; row->section && k < row->section->count; k++)
    vs_field_schema_field(c.j, &row->section->fields[k]);
  vs_json_end(c.j);
  vs_outline_schema_required(c.j, keys);
  if (of_scene_keys(keys)) put_other_keys(&(keyed){c, keys});
  if (any && !of_scene_keys(keys))
    put_row(c, "additionalProperties", any);
  else
    vs_json_bool(c.j, "additionalProperties", false);
}

static void put_map(context c, const vs_outline *row) {
  if (is_word(c.field)) return; /* a range of words there is not */
  vs_json_object(c.j, NULL, VS_JSON_ROW);
  put_map_keys(c, row->of);
  if (row->count > 0) {
    vs_json_whole(c.j, "minProperties", row->count);
    vs_json_whole(c.j, "maxProperties", row->count);
  }
  vs_json_end(c.j);
}

void vs_outline_schema_map(vs_json *j, const vs_outline *keys) {
  vs_json_object(j, NULL, VS_JSON_ROW);
  put_map_keys((context){.j = j}, keys);
  vs_json_end(j);
}

/* ---- all ---- */

static const struct writer {
  unsigned bit;
  void (*put)(context c, const vs_outline *row);
} WRITERS[] = {{VS_OUTLINE_NOTHING, put_nothing}, {VS_OUTLINE_TEXT, put_text},
               {VS_OUTLINE_WHOLE, put_whole},     {VS_OUTLINE_PART, put_part},
               {VS_OUTLINE_FLAG, put_flag},       {VS_OUTLINE_WORD, put_word},
               {VS_OUTLINE_LIST, put_list},       {VS_OUTLINE_MAP, put_map},
               {VS_OUTLINE_VALUE, put_reference}, {VS_OUTLINE_SPREAD, put_spread},
               {VS_OUTLINE_SETTING, put_setting}, {VS_OUTLINE_SENSORS, put_sensors}};

static void put_alternatives(context c, const vs_outline *row) {
  for (; row; row = row->instead)
    for (size_t k = 0; k < sizeof WRITERS / sizeof *WRITERS; k++)
      if (row->takes & WRITERS[k].bit) WRITERS[k].put(c, row);
}

void vs_outline_schema_row(vs_json *j, const char *key, const vs_outline *row,
                           const vs_default_models *ground) {
  put_row((context){.j = j, .ground = ground}, key, row);
}
