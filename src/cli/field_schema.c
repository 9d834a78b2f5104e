/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "field_schema.h"

#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "netlist/kinds.h"
#include "run/keys.h"
#include "run/sections.h"

void vs_field_schema_open(vs_json *j, const char *key, const char *type) {
  vs_json_object(j, key, VS_JSON_ROW);
  vs_json_text(j, "type", type);
}

void vs_field_schema_either(vs_json *j, const char *key) {
  vs_json_object(j, key, VS_JSON_ROW);
  vs_json_array(j, "anyOf", VS_JSON_ROW);
}

void vs_field_schema_close(vs_json *j, int levels) {
  while (levels-- > 0) vs_json_end(j);
}

void vs_field_schema_type(vs_json *j, const char *type) {
  vs_field_schema_open(j, NULL, type);
  vs_json_end(j);
}

void vs_field_schema_word(vs_json *j, const char *key, const char *word) {
  vs_json_object(j, key, VS_JSON_ROW);
  vs_json_text(j, "const", word);
  vs_json_end(j);
}

void vs_field_schema_pattern(vs_json *j, const char *key, const char *pattern) {
  vs_field_schema_open(j, key, "string");
  vs_json_text(j, "pattern", pattern);
  vs_json_end(j);
}

/* ---- plain values ---- */

/* What a row is written for. */
typedef struct context {
  vs_json *j;
  const vs_default_models *ground; /* NULL: there are no scene keys */
  const char *scene_key;           /* that the value stands under; NULL: none that is known */
  const vs_field *field;           /* of that key */
} context;

/* A pure number, in the range that is allowed, or any number where min is not below max. */
static void put_number(vs_json *j, const char *type, const vs_field *f) {
  vs_field_schema_open(j, NULL, type);
  if (f->min < f->max) {
    vs_json_number(j, f->open ? "exclusiveMinimum" : "minimum", f->min, 12);
    vs_json_number(j, f->open ? "exclusiveMaximum" : "maximum", f->max, 12);
  }
  vs_json_end(j);
}

static void put_unit(vs_json *j, const char *unit) {
  vs_text pattern = {0};
  char wanted[128];
  vs_units_pattern(unit, &pattern);
  vs_field_schema_open(j, NULL, "string");
  vs_json_text(j, "pattern", pattern.text);
  snprintf(wanted, sizeof wanted, "a number in %s is wanted", *unit ? unit : "% or without a unit");
  vs_json_text(j, "patternErrorMessage", wanted); /* which editors show */
  vs_json_end(j);
  vs_text_free(&pattern);
}

/* The alternatives of one number with its unit. 0 needs no unit, as a number and as the text that
 * YAML 1.1 makes of 0e0. */
static void put_quantity(context c, const vs_field *f) {
  if (!vs_units_known(f->unit)) {
    vs_field_schema_type(c.j, "string");
    vs_field_schema_type(c.j, "number");
    return;
  }
  put_unit(c.j, f->unit);
  if (!*f->unit) {
    put_number(c.j, "number", f);
    return;
  }
  vs_field_schema_open(c.j, NULL, "integer");
  vs_json_number(c.j, "const", 0, 1);
  vs_json_end(c.j);
  vs_field_schema_pattern(c.j, NULL, "^ *[+-]?(0+\\.?0*|\\.0+)([eE][+-]?[0-9]+)? *$");
}

void vs_field_schema_quantity(vs_json *j, const vs_field *f) {
  vs_field_schema_either(j, NULL);
  put_quantity((context){.j = j}, f);
  vs_field_schema_close(j, 2);
}

/* A list of exactly two quantities. */
static void put_two(vs_json *j, const char *key, const vs_field *first, const vs_field *second) {
  vs_field_schema_open(j, key, "array");
  vs_json_whole(j, "minItems", 2);
  vs_json_whole(j, "maxItems", 2);
  vs_json_array(j, "prefixItems", VS_JSON_ROW);
  vs_field_schema_quantity(j, first);
  vs_field_schema_quantity(j, second);
  vs_field_schema_close(j, 2);
}

static void put_pair(context c, const vs_field *f) {
  put_two(c.j, NULL, f, f);
}

/* A list of points over time. */
static void put_points(context c, const vs_field *f) {
  static const vs_field TIME = {.unit = "s"};
  vs_field_schema_open(c.j, NULL, "array");
  vs_json_whole(c.j, "minItems", 1);
  vs_json_whole(c.j, "maxItems", VS_PROFILE_MOST);
  put_two(c.j, "items", &TIME, f);
  vs_json_end(c.j);
}

static void put_choices(context c, const vs_field *row) {
  char words[256], *rest = words;
  snprintf(words, sizeof words, "%s", row->choices);
  vs_json_object(c.j, NULL, VS_JSON_ROW);
  vs_json_array(c.j, "enum", VS_JSON_ROW);
  for (char *word; (word = strsep(&rest, "|"));) vs_json_text(c.j, NULL, word);
  vs_field_schema_close(c.j, 2);
}

/* The word that may stand instead of a value. */
static void put_own_word(context c, const vs_field *row) {
  if (row->choices) vs_field_schema_word(c.j, NULL, row->choices);
}

static void put_whole(context c, const vs_field *row) {
  put_number(c.j, "integer", row);
  vs_field_schema_pattern(c.j, NULL, "^[+-]?[0-9.]+([eE][+-]?[0-9]+)? *$");
}

static void put_nothing(context c, const vs_field *row) {
  (void)row;
  vs_field_schema_type(c.j, "null");
}

static void put_part(context c, const vs_field *row) {
  (void)row;
  vs_field_schema_quantity(c.j, &(vs_field){.unit = ""});
}

static void put_flag(context c, const vs_field *row) {
  (void)row;
  vs_field_schema_type(c.j, "boolean");
}

/* Any name, which may be of digits; or one of `choices`, of which "FILE.csv" stands for files that
 * end so. */
static void put_name(context c, const vs_field *row) {
  static const char FILES[] = "FILE";
  char words[256], *rest = words;
  if (!row->choices) {
    vs_field_schema_type(c.j, "string");
    vs_field_schema_type(c.j, "number");
    return;
  }
  snprintf(words, sizeof words, "%s", row->choices);
  for (char *word; (word = strsep(&rest, "|"));) {
    char ending[sizeof words + 8];
    const bool file = !strncmp(word, FILES, strlen(FILES));
    snprintf(ending, sizeof ending, ".\\%s$", file ? word + strlen(FILES) : "");
    if (file)
      vs_field_schema_pattern(c.j, NULL, ending);
    else
      vs_field_schema_word(c.j, NULL, word);
  }
}

/* ---- maps of a section's keys, and of an option's ---- */

static void put_section(vs_json *j, const vs_section *keys) {
  vs_json_text(j, "type", "object");
  vs_field_schema_properties(j, keys);
}

/* A map of an option's keys, in the form that one word of the chooser has; that word is `word`, or
 * NULL where there is one form alone. The first form is that of a map without the chooser. */
static void put_form(vs_json *j, const vs_inside *o, size_t form, const char *word) {
  const char *chooser = o->keys.fields[o->chooser].key;
  vs_json_object(j, NULL, VS_JSON_ROW);
  put_section(j, o->forms ? &o->forms[form] : &o->keys);
  if (word && form) {
    vs_json_array(j, "required", VS_JSON_ROW);
    vs_json_text(j, NULL, chooser);
    vs_json_end(j);
  }
  if (word) {
    vs_json_array(j, "allOf", VS_JSON_ROW);
    vs_json_object(j, NULL, VS_JSON_ROW);
    vs_json_object(j, "properties", VS_JSON_ROW);
    vs_field_schema_word(j, chooser, word);
    vs_field_schema_close(j, 3);
  }
  vs_json_end(j);
}

static void put_forms(vs_json *j, const vs_inside *o) {
  char words[256], *rest = words;
  size_t form = 0;
  snprintf(words, sizeof words, "%s", o->forms ? o->keys.fields[o->chooser].choices : "");
  if (!o->forms) put_form(j, o, 0, NULL);
  for (char *word; o->forms && (word = strsep(&rest, "|"));) put_form(j, o, form++, word);
}

static void put_maps(context c, const vs_field *f) {
  put_forms(c.j, f->inside);
  if (f->inside->most == 1) return;
  vs_field_schema_open(c.j, NULL, "array");
  vs_json_whole(c.j, "minItems", 1);
  vs_json_whole(c.j, "maxItems", f->inside->most);
  vs_field_schema_either(c.j, "items");
  put_forms(c.j, f->inside);
  vs_field_schema_close(c.j, 3);
}

/* ---- instruments ---- */

void vs_field_schema_instrument(vs_json *j) {
  vs_field fields[VS_INSTRUMENT_FIELDS];
  const vs_section keys = {NULL, fields, vs_instrument_section.count};
  for (size_t k = 0; k < keys.count; k++) {
    fields[k] = vs_instrument_section.fields[k];
    if (vs_instruments_follows(&vs_instrument_section.fields[k]))
      fields[k].unit = "~"; /* whatever it is */
  }
  vs_field_schema_type(j, "null");
  vs_json_object(j, NULL, VS_JSON_ROW);
  put_section(j, &keys);
  vs_json_end(j);
}

/* A machine's own set: its name, or a map. */
static void put_sensors(context c, const vs_field *row) {
  put_name(c, row);
  vs_field_schema_open(c.j, NULL, "object");
  vs_field_schema_either(c.j, "additionalProperties");
  vs_field_schema_instrument(c.j);
  vs_field_schema_close(c.j, 3);
}

/* ---- values of a scene's key ---- */

static void put_alternatives(context c, const vs_field *row);

static bool is_word(const vs_field *f) {
  return f && f->kind & (VS_CHOICE | VS_NAME);
}

/* 'A .. B', in the key's unit or in per cent of its value. */
static void put_dots(context c) {
  if (c.field && !is_word(c.field))
    vs_field_schema_pattern(c.j, NULL,
                            "^ *[-+.0-9][^ ]*( [^ ]+)? +\\.\\. +[-+.0-9][^ ]*( [^ ]+)? *$");
}

static void put_reference(context c, const vs_field *row) {
  char path[VS_KEY_SIZE + 16];
  if (!c.scene_key) {
    put_name(c, row);
    return;
  }
  snprintf(path, sizeof path, "#/$defs/%s", c.scene_key);
  vs_json_object(c.j, NULL, VS_JSON_ROW);
  vs_json_text(c.j, "$ref", path);
  vs_json_end(c.j);
}

/* "5 % normal", "5 % normal within 2 sigma", "1 ohm uniform", "-20 % .. 5 %", "ageing". Words and
 * whole numbers have none. */
static void put_spread(context c, const vs_field *row) {
  vs_text pattern = {0};
  if (is_word(c.field) || (c.field && c.field->kind == VS_COUNT)) return;
  if (!c.field) {
    put_name(c, row);
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
  vs_field_schema_pattern(c.j, NULL, pattern.text);
  vs_text_free(&pattern);
  put_dots(c);
  vs_field_schema_pattern(c.j, NULL, "^(tolerance|ageing|tolerance and ageing)$");
}

static void put_setting(context c, const vs_field *row) {
  (void)row;
  if (c.field) {
    put_alternatives(c, c.field);
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

/* True for a key that is no axis of a study. */
static bool is_no_axis(const vs_field *f) {
  return f->kind & (VS_PAIR | VS_OPTION);
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
  const vs_field axis = as_axis(f);
  if (is_no_axis(f)) return;
  vs_field_schema_either(ctx, key);
  put_alternatives((context){.j = ctx}, &axis);
  vs_field_schema_close(ctx, 2);
}

void vs_field_schema_definitions(vs_json *j, const vs_default_models *ground) {
  vs_json_object(j, "$defs", VS_JSON_LINES);
  each_key(ground, put_definition, j);
  vs_json_end(j);
}

/* ---- maps ---- */

typedef struct keyed {
  context c;
  const vs_field *row;
} keyed;

/* A member: what it means, its default where it has one, and what it may be. */
static void put_member(context c, const char *key, const vs_field *of, const vs_field *row) {
  vs_json_object(c.j, key, VS_JSON_ROW);
  if (of->text) vs_json_text(c.j, "description", of->text);
  if (of == row && of->default_text) vs_json_text(c.j, "default", of->default_text);
  vs_json_array(c.j, "anyOf", VS_JSON_ROW);
  put_alternatives(c, row);
  vs_field_schema_close(c.j, 2);
}

static void put_keyed(void *ctx, const char *key, const vs_field *f) {
  const keyed *of = ctx;
  context c = of->c;
  if (!(of->row->kind & VS_SETTING) && is_no_axis(f)) return;
  c.scene_key = key;
  c.field = f;
  put_member(c, key, f, of->row);
}

/* The keys that depend on the scene, and maps of a section or an option. */
static void put_other_keys(context c, const vs_field *row) {
  const bool setting = row->kind & VS_SETTING;
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
  for (const vs_kind *k = vs_kinds_all; k->name && row->kind & VS_SPREAD; k++)
    vs_text_add(&pattern, "|^%s$", k->name);
  vs_json_object(c.j, "patternProperties", VS_JSON_ROW);
  put_member(c, pattern.text, row, row);
  vs_json_end(c.j);
  vs_text_free(&pattern);
}

/* Sections as maps, {run: {until: 30 ms}}, where their keys are the same for all machines and
 * decks. */
static void put_sections(context c) {
  for (int s = 0; s < VS_SECTIONS; s++) {
    if (vs_section_is_named(s)) continue;
    const vs_section *section = vs_section_fields(c.ground->machine, c.ground->deck, s);
    vs_field_schema_either(c.j, section->name);
    vs_json_object(c.j, NULL, VS_JSON_ROW);
    put_section(c.j, section);
    vs_json_end(c.j);
    vs_field_schema_type(c.j, "null");
    vs_field_schema_close(c.j, 2);
  }
}

void vs_field_schema_required(vs_json *j, const vs_field *rows) {
  vs_json_array(j, "required", VS_JSON_ROW);
  for (const vs_field *row = rows; row && row->kind; row++)
    if (row->kind & VS_NEEDED) vs_json_text(j, NULL, row->key);
  vs_json_end(j);
}

static void put_map(context c, const vs_field *map) {
  const vs_inside *inside = map->inside;
  const vs_field *row = inside->rows, *any = NULL;
  for (const vs_field *r = row; r && r->kind; r++)
    if (!r->key) any = r;
  const vs_field *scene = any && any->kind & (VS_VALUE | VS_SPREAD | VS_SETTING) ? any : NULL;
  if (is_word(c.field)) return; /* a range of words there is not */
  vs_field_schema_open(c.j, NULL, "object");
  vs_json_object(c.j, "properties", VS_JSON_ROW);
  if (scene) each_key(c.ground, put_keyed, &(keyed){c, scene});
  if (scene && scene->kind & VS_SETTING) put_sections(c);
  for (; row && row->kind; row++)
    if (row->key) put_member(c, row->key, row, row);
  for (size_t k = 0; inside->besides && k < inside->besides->count; k++)
    vs_field_schema_field(c.j, &inside->besides->fields[k]);
  vs_json_end(c.j);
  vs_field_schema_required(c.j, inside->rows);
  if (scene) put_other_keys(c, scene);
  if (any && !scene)
    put_member(c, "additionalProperties", any, any);
  else
    vs_json_bool(c.j, "additionalProperties", false);
  if (inside->count > 0) vs_json_whole(c.j, "minProperties", inside->count);
  if (inside->count > 0) vs_json_whole(c.j, "maxProperties", inside->count);
  vs_json_end(c.j);
}

static void put_list(context c, const vs_field *list) {
  const int count = list->inside->count;
  vs_field_schema_open(c.j, NULL, "array");
  vs_json_whole(c.j, "minItems", count < 0 ? 0 : count ? count : 1);
  if (count > 0) vs_json_whole(c.j, "maxItems", count);
  vs_field_schema_either(c.j, "items");
  put_alternatives(c, list->inside->rows);
  vs_field_schema_close(c.j, 3);
}

/* ---- all ---- */

enum { IS_NUMBER = VS_REAL | VS_FACTOR | VS_PROFILE };
/* What each kind may be, in the order of alternatives. To add a kind: a row here. */
static const struct writer {
  unsigned kinds;
  void (*put)(context c, const vs_field *row);
} WRITERS[] = {
    {VS_NOTHING, put_nothing}, {IS_NUMBER | VS_PAIR | VS_COUNT | VS_OPTION, put_own_word},
    {IS_NUMBER, put_quantity}, {VS_PROFILE, put_points},
    {VS_PAIR, put_pair},       {VS_NAME | VS_TEXT, put_name},
    {VS_COUNT, put_whole},     {VS_PART, put_part},
    {VS_FLAG, put_flag},       {VS_CHOICE, put_choices},
    {VS_OPTION, put_maps},     {VS_LIST, put_list},
    {VS_MAP, put_map},         {VS_VALUE, put_reference},
    {VS_SPREAD, put_spread},   {VS_SETTING, put_setting},
    {VS_SENSORS, put_sensors}};

static void put_alternatives(context c, const vs_field *row) {
  for (; row; row = row->inside ? row->inside->instead : NULL)
    for (size_t k = 0; k < sizeof WRITERS / sizeof *WRITERS; k++)
      if (row->kind & WRITERS[k].kinds) WRITERS[k].put(c, row);
}

void vs_field_schema_row(vs_json *j, const vs_field *row, const vs_default_models *ground) {
  put_member((context){.j = j, .ground = ground}, row->key, row, row);
}

void vs_field_schema_field(vs_json *j, const vs_field *f) {
  vs_field_schema_row(j, f, NULL);
}

void vs_field_schema_properties(vs_json *j, const vs_section *keys) {
  vs_json_object(j, "properties", VS_JSON_LINES);
  for (size_t k = 0; k < keys->count; k++) vs_field_schema_field(j, &keys->fields[k]);
  vs_json_end(j);
  vs_json_bool(j, "additionalProperties", false);
}
