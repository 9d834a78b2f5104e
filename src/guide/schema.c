/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "guide/schema.h"

#include <stdio.h>
#include <string.h>

#include "base/json.h"
#include "drive/events.h"
#include "guide/ground.h"
#include "machine/blueprint.h"
#include "scene/sections.h"
#include "syntax/units.h"

/* ---- values ---- */

static void put_type(vs_json *j, const char *type) {
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_text(j, "type", type);
  vs_json_end(j);
}

static void put_word(vs_json *j, const char *word) {
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_text(j, "const", word);
  vs_json_end(j);
}

/* A pure number, in the range that is allowed, or any number where min is above max. */
static void put_number(vs_json *j, const char *type, const vs_field *f) {
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_text(j, "type", type);
  vs_json_number(j, f->open ? "exclusiveMinimum" : "minimum", f->min, 12);
  vs_json_number(j, f->open ? "exclusiveMaximum" : "maximum", f->max, 12);
  vs_json_end(j);
}

static void put_pattern(vs_json *j, const char *unit) {
  vs_text pattern = {0};
  vs_units_pattern(unit, &pattern);
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_text(j, "type", "string");
  vs_json_text(j, "pattern", pattern.text);
  vs_json_end(j);
  vs_text_free(&pattern);
}

/* 0, which needs no unit, as a number and as the text that YAML 1.1 makes of 0e0. */
static void put_zero(vs_json *j) {
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_number(j, "const", 0, 1);
  vs_json_end(j);
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_text(j, "type", "string");
  vs_json_text(j, "pattern", "^[+-]?0*\\.?0*([eE][+-]?[0-9]+)?$");
  vs_json_end(j);
}

/* The alternatives of one number with its unit. */
static void put_quantity(vs_json *j, const vs_field *f) {
  if (*f->unit)
    put_zero(j);
  else
    put_number(j, "number", f);
  put_pattern(j, f->unit);
}

static void put_any_quantity(vs_json *j, const vs_field *f) {
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_array(j, "anyOf", VS_JSON_ROW);
  put_quantity(j, f);
  vs_json_end(j);
  vs_json_end(j);
}

/* A list of exactly two quantities. */
static void put_two(vs_json *j, const vs_field *first, const vs_field *second) {
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_text(j, "type", "array");
  vs_json_whole(j, "minItems", 2);
  vs_json_whole(j, "maxItems", 2);
  vs_json_array(j, "prefixItems", VS_JSON_ROW);
  put_any_quantity(j, first);
  put_any_quantity(j, second);
  vs_json_end(j);
  vs_json_end(j);
}

/* A list of points over time. */
static void put_points(vs_json *j, const vs_field *f) {
  static const vs_field TIME = {.unit = "s"};
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_text(j, "type", "array");
  vs_json_whole(j, "minItems", 1);
  vs_json_whole(j, "maxItems", VS_PROFILE_MOST);
  vs_json_key(j, "items");
  vs_json items = vs_json_new(j->text);
  put_two(&items, &TIME, f);
  vs_json_end(j);
}

static void put_words(vs_json *j, const char *choices) {
  char words[256], *rest = words;
  snprintf(words, sizeof words, "%s", choices);
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_array(j, "enum", VS_JSON_ROW);
  for (char *word; (word = strsep(&rest, "|"));) vs_json_text(j, NULL, word);
  vs_json_end(j);
  vs_json_end(j);
}

static void put_whole(vs_json *j, const vs_field *f) {
  put_number(j, "integer", f);
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_text(j, "type", "string");
  vs_json_text(j, "pattern", "^[+-]?[0-9.]+([eE][+-]?[0-9]+)? *$");
  vs_json_end(j);
}

/* ---- keys ---- */

static void put_keys(vs_json *j, const vs_field *fields, size_t count);

static void put_maps(vs_json *j, const vs_field *f) {
  const vs_section *keys = &f->options->keys;
  vs_json_object(j, NULL, VS_JSON_ROW);
  put_keys(j, keys->fields, keys->count);
  vs_json_end(j);
  if (f->options->most == 1) return;
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_text(j, "type", "array");
  vs_json_whole(j, "maxItems", f->options->most);
  vs_json_key(j, "items");
  vs_json items = vs_json_new(j->text);
  vs_json_object(&items, NULL, VS_JSON_ROW);
  put_keys(&items, keys->fields, keys->count);
  vs_json_end(&items);
  vs_json_end(j);
}

/* One row for each kind of field: the values that it may have. */
static void put_values(vs_json *j, const vs_field *f) {
  const bool has_word = f->choices && f->kind != VS_CHOICE;
  if (has_word) put_word(j, f->choices);
  if (vs_field_is_real(f)) put_quantity(j, f);
  if (f->kind == VS_PROFILE) put_points(j, f);
  if (f->kind == VS_PAIR) put_two(j, f, f);
  if (f->kind == VS_CHOICE) put_words(j, f->choices);
  if (f->kind == VS_COUNT) put_whole(j, f);
  if (f->kind == VS_OPTION) put_maps(j, f);
  if (f->kind != VS_NAME) return;
  put_type(j, "string");
  put_type(j, "number"); /* a name of digits */
}

static void put_field(vs_json *j, const vs_field *f) {
  vs_json_object(j, f->key, VS_JSON_ROW);
  vs_json_text(j, "description", f->text);
  vs_json_text(j, "default", f->default_text);
  vs_json_array(j, "anyOf", VS_JSON_ROW);
  put_values(j, f);
  vs_json_end(j);
  vs_json_end(j);
}

/* The members of a schema of a map that has these keys and no others. */
static void put_keys(vs_json *j, const vs_field *fields, size_t count) {
  vs_json_text(j, "type", "object");
  vs_json_object(j, "properties", VS_JSON_LINES);
  for (size_t k = 0; k < count; k++) put_field(j, &fields[k]);
  vs_json_end(j);
  vs_json_bool(j, "additionalProperties", false);
}

/* ---- a scene ---- */

static void begin(vs_json *j, const char *title) {
  vs_json_object(j, NULL, VS_JSON_LINES);
  vs_json_text(j, "$schema", "https://json-schema.org/draft/2020-12/schema");
  vs_json_text(j, "title", title);
  vs_json_text(j, "type", "object");
}

/* A key of any value. */
static void put_open(vs_json *j, const char *key) {
  vs_json_object(j, key, VS_JSON_ROW);
  vs_json_end(j);
}

/* A section; NULL stands for one that says nothing more than its name. own: the key that names a
 * file which declares the section's keys; with it any key passes. */
static void put_section(vs_json *j, const vs_section *s, const char *own) {
  vs_json_object(j, s->name, VS_JSON_ROW);
  vs_json_array(j, "anyOf", VS_JSON_ROW);
  put_type(j, "null");
  if (own) {
    vs_json_object(j, NULL, VS_JSON_ROW);
    vs_json_text(j, "type", "object");
    vs_json_array(j, "required", VS_JSON_ROW);
    vs_json_text(j, NULL, own);
    vs_json_end(j);
    vs_json_end(j);
  }
  vs_json_object(j, NULL, VS_JSON_ROW);
  put_keys(j, s->fields, s->count);
  vs_json_end(j);
  vs_json_end(j);
  vs_json_end(j);
}

/* The section start, whose keys are the coordinates of the machine: only where it names none. */
static void put_start(vs_json *j) {
  vs_json_object(j, "start", VS_JSON_ROW);
  vs_json_array(j, "anyOf", VS_JSON_ROW);
  put_type(j, "null");
  put_type(j, "object");
  put_word(j, "steady");
  vs_json_end(j);
  vs_json_end(j);
}

static void put_event(vs_json *j, const vs_event_kind *kind) {
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_array(j, "required", VS_JSON_ROW);
  vs_json_text(j, NULL, "kind");
  vs_json_end(j);
  vs_json_text(j, "type", "object");
  vs_json_text(j, "description", kind->text);
  vs_json_object(j, "properties", VS_JSON_ROW);
  vs_json_key(j, "kind");
  vs_json word = vs_json_new(j->text);
  put_word(&word, kind->name);
  for (size_t k = 1; k < kind->n_fields; k++) put_field(j, &kind->fields[k]);
  vs_json_end(j);
  vs_json_bool(j, "additionalProperties", false);
  vs_json_end(j);
}

static void put_events(vs_json *j) {
  const vs_event_kind *kind;
  vs_json_object(j, "events", VS_JSON_ROW);
  vs_json_array(j, "type", VS_JSON_ROW);
  vs_json_text(j, NULL, "object");
  vs_json_text(j, NULL, "null");
  vs_json_end(j);
  vs_json_object(j, "additionalProperties", VS_JSON_ROW);
  vs_json_array(j, "anyOf", VS_JSON_LINES);
  for (size_t k = 0; (kind = vs_events_kind(k)); k++) put_event(j, kind);
  vs_json_end(j);
  vs_json_end(j);
  vs_json_end(j);
}

/* The key of a section that names the file which declares the others; NULL: there is none. */
static const char *own_key(const char *section) {
  if (!strcmp(section, vs_section_keys[VS_SECTION_KEY_circuit])) return vs_deck_key.key;
  if (!strcmp(section, vs_section_keys[VS_SECTION_KEY_machine])) return vs_machine_key.key;
  return NULL;
}

static void put_scene(vs_json *j, const vs_ground *ground) {
  begin(j, "a scene of VibroSpice");
  vs_json_object(j, "properties", VS_JSON_LINES);
  for (int s = 0; s < VS_SECTIONS; s++) {
    const vs_section *section = vs_section_fields(ground->machine, ground->deck, s);
    if (s == VS_SECTION_NUMBER_start)
      put_start(j);
    else
      put_section(j, section, own_key(section->name));
  }
  put_events(j);
  static const int OPEN[] = {VS_SECTION_KEY_instruments, VS_SECTION_KEY_control,
                             VS_SECTION_KEY_record, VS_SECTION_KEY_measured,
                             VS_SECTION_KEY_quality};
  for (size_t k = 0; k < sizeof OPEN / sizeof *OPEN; k++) put_open(j, vs_section_keys[OPEN[k]]);
  vs_json_end(j);
  vs_json_bool(j, "additionalProperties", false);
  vs_json_end(j);
}

/* ---- studies and machines: their keys ---- */

static void put_study(vs_json *j, const vs_ground *ground) {
  (void)ground;
  static const char *const KEYS[] = {"scene", "set", "steady", "report"};
  begin(j, "a study of VibroSpice");
  vs_json_object(j, "properties", VS_JSON_LINES);
  for (size_t k = 0; k < sizeof KEYS / sizeof *KEYS; k++) put_open(j, KEYS[k]);
  const char *before = "";
  for (const vs_method *const *m = vs_methods_all; *m; before = (*m)->key, m++)
    if (strcmp(before, (*m)->key) != 0) put_open(j, (*m)->key);
  vs_json_end(j);
  vs_json_bool(j, "additionalProperties", false);
  vs_json_end(j);
}

static void put_machine(vs_json *j, const vs_ground *ground) {
  (void)ground;
  begin(j, "a machine of VibroSpice");
  vs_json_object(j, "properties", VS_JSON_LINES);
  for (const char *const *key = vs_blueprint_keys; *key; key++) put_open(j, *key);
  vs_json_end(j);
  vs_json_bool(j, "additionalProperties", false);
  vs_json_end(j);
}

/* ---- the command ---- */

static const struct kind {
  const char *name;
  void (*put)(vs_json *j, const vs_ground *ground);
} KINDS[] = {{"scene", put_scene}, {"study", put_study}, {"machine", put_machine}};
enum { N_KINDS = sizeof KINDS / sizeof *KINDS };

vs_status vs_schema_command(const vs_schema_options *o, vs_error *err) {
  size_t k = 0;
  while (o->kind && k < N_KINDS && strcmp(o->kind, KINDS[k].name) != 0) k++;
  if (k == N_KINDS)
    return vs_fail(err, VS_INPUT, "schema: no kind '%s'; there are: scene, study, machine",
                   o->kind);
  vs_ground ground;
  vs_text text = {0};
  vs_json j = vs_json_new(&text);
  vs_status status = vs_ground_read(o->deck, o->machine, &ground, err);
  if (!status) KINDS[k].put(&j, &ground);
  if (!status) puts(text.text);
  vs_text_free(&text);
  vs_ground_free(&ground);
  return status;
}
