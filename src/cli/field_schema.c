/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "field_schema.h"

#include <stdio.h>
#include <string.h>

#include "base/units.h"

void vs_field_schema_type(vs_json *j, const char *type) {
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_text(j, "type", type);
  vs_json_end(j);
}

void vs_field_schema_word(vs_json *j, const char *word) {
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_text(j, "const", word);
  vs_json_end(j);
}

/* A pure number, in the range that is allowed, or any number where min is above max. */
static void put_number(vs_json *j, const char *type, const vs_field *f) {
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_text(j, "type", type);
  if (f->min < f->max) {
    vs_json_number(j, f->open ? "exclusiveMinimum" : "minimum", f->min, 12);
    vs_json_number(j, f->open ? "exclusiveMaximum" : "maximum", f->max, 12);
  }
  vs_json_end(j);
}

static void put_pattern(vs_json *j, const char *unit) {
  vs_text pattern = {0};
  char wanted[128];
  vs_units_pattern(unit, &pattern);
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_text(j, "type", "string");
  vs_json_text(j, "pattern", pattern.text);
  snprintf(wanted, sizeof wanted, "a number in %s is wanted", *unit ? unit : "% or without a unit");
  vs_json_text(j, "patternErrorMessage", wanted); /* which editors show */
  vs_json_end(j);
  vs_text_free(&pattern);
}

/* 0, which needs no unit, as a number and as the text that YAML 1.1 makes of 0e0. */
static void put_zero(vs_json *j) {
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_text(j, "type", "integer");
  vs_json_number(j, "const", 0, 1);
  vs_json_end(j);
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_text(j, "type", "string");
  vs_json_text(j, "pattern", "^ *[+-]?(0+\\.?0*|\\.0+)([eE][+-]?[0-9]+)? *$");
  vs_json_end(j);
}

/* The alternatives of one number with its unit. */
static void put_quantity(vs_json *j, const vs_field *f) {
  if (!vs_units_known(f->unit)) {
    vs_field_schema_type(j, "string");
    vs_field_schema_type(j, "number");
    return;
  }
  put_pattern(j, f->unit);
  if (*f->unit)
    put_zero(j);
  else
    put_number(j, "number", f);
}

void vs_field_schema_quantity(vs_json *j, const vs_field *f) {
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
  vs_field_schema_quantity(j, first);
  vs_field_schema_quantity(j, second);
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

void vs_field_schema_words(vs_json *j, const char *choices) {
  char words[256], *rest = words;
  snprintf(words, sizeof words, "%s", choices);
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_array(j, "enum", VS_JSON_ROW);
  for (char *word; (word = strsep(&rest, "|"));) vs_json_text(j, NULL, word);
  vs_json_end(j);
  vs_json_end(j);
}

void vs_field_schema_whole(vs_json *j, const vs_field *f) {
  put_number(j, "integer", f);
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_text(j, "type", "string");
  vs_json_text(j, "pattern", "^[+-]?[0-9.]+([eE][+-]?[0-9]+)? *$");
  vs_json_end(j);
}

/* ---- keys ---- */

/* A map of an option's keys, in the form that one word of the chooser has; that word is `word`, or
 * NULL where there is one form alone. The first form is that of a map without the chooser. */
static void put_form(vs_json *j, const vs_options *o, size_t form, const char *word) {
  const vs_section *keys = o->forms ? &o->forms[form] : &o->keys;
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_field_schema_keys(j, keys->fields, keys->count);
  if (word && form) {
    vs_json_array(j, "required", VS_JSON_ROW);
    vs_json_text(j, NULL, o->keys.fields[o->chooser].key);
    vs_json_end(j);
  }
  if (word) {
    vs_json_array(j, "allOf", VS_JSON_ROW);
    vs_json_object(j, NULL, VS_JSON_ROW);
    vs_json_object(j, "properties", VS_JSON_ROW);
    vs_json_object(j, o->keys.fields[o->chooser].key, VS_JSON_ROW);
    vs_json_text(j, "const", word);
    vs_json_end(j);
    vs_json_end(j);
    vs_json_end(j);
    vs_json_end(j);
  }
  vs_json_end(j);
}

static void put_forms(vs_json *j, const vs_options *o) {
  char words[256], *rest = words;
  if (!o->forms) {
    put_form(j, o, 0, NULL);
    return;
  }
  snprintf(words, sizeof words, "%s", o->keys.fields[o->chooser].choices);
  size_t form = 0;
  for (char *word; (word = strsep(&rest, "|"));) put_form(j, o, form++, word);
}

static void put_maps(vs_json *j, const vs_field *f) {
  put_forms(j, f->options);
  if (f->options->most == 1) return;
  vs_json_object(j, NULL, VS_JSON_ROW);
  vs_json_text(j, "type", "array");
  vs_json_whole(j, "minItems", 1);
  vs_json_whole(j, "maxItems", f->options->most);
  vs_json_object(j, "items", VS_JSON_ROW);
  vs_json_array(j, "anyOf", VS_JSON_ROW);
  put_forms(j, f->options);
  vs_json_end(j);
  vs_json_end(j);
  vs_json_end(j);
}

/* Any name, which may be of digits; or one of `choices`, of which "FILE.csv" stands for files that
 * end so. */
static void put_name(vs_json *j, const vs_field *f) {
  static const char FILES[] = "FILE";
  char words[256], *rest = words;
  if (!f->choices) {
    vs_field_schema_type(j, "string");
    vs_field_schema_type(j, "number");
    return;
  }
  snprintf(words, sizeof words, "%s", f->choices);
  for (char *word; (word = strsep(&rest, "|"));) {
    vs_text ending = {0};
    if (strncmp(word, FILES, strlen(FILES)) != 0) {
      vs_field_schema_word(j, word);
      continue;
    }
    vs_text_add(&ending, ".\\%s$", word + strlen(FILES));
    vs_json_object(j, NULL, VS_JSON_ROW);
    vs_json_text(j, "type", "string");
    vs_json_text(j, "pattern", ending.text);
    vs_json_end(j);
    vs_text_free(&ending);
  }
}

/* One row for each kind of field: the values that it may have. */
void vs_field_schema_values(vs_json *j, const vs_field *f) {
  const bool has_word = f->choices && f->kind != VS_CHOICE && f->kind != VS_NAME;
  if (has_word) vs_field_schema_word(j, f->choices);
  if (vs_field_is_real(f)) put_quantity(j, f);
  if (f->kind == VS_PROFILE) put_points(j, f);
  if (f->kind == VS_PAIR) put_two(j, f, f);
  if (f->kind == VS_CHOICE) vs_field_schema_words(j, f->choices);
  if (f->kind == VS_COUNT) vs_field_schema_whole(j, f);
  if (f->kind == VS_OPTION) put_maps(j, f);
  if (f->kind == VS_NAME) put_name(j, f);
}

void vs_field_schema_field(vs_json *j, const vs_field *f) {
  vs_json_object(j, f->key, VS_JSON_ROW);
  vs_json_text(j, "description", f->text);
  vs_json_text(j, "default", f->default_text);
  vs_json_array(j, "anyOf", VS_JSON_ROW);
  vs_field_schema_values(j, f);
  vs_json_end(j);
  vs_json_end(j);
}

/* The members of a schema of a map that has these keys and no others. */
void vs_field_schema_keys(vs_json *j, const vs_field *fields, size_t count) {
  vs_json_text(j, "type", "object");
  vs_field_schema_properties(j, fields, count);
}

void vs_field_schema_properties(vs_json *j, const vs_field *fields, size_t count) {
  vs_json_object(j, "properties", VS_JSON_LINES);
  for (size_t k = 0; k < count; k++) vs_field_schema_field(j, &fields[k]);
  vs_json_end(j);
  vs_json_bool(j, "additionalProperties", false);
}
