/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `schema`: JSON Schemas (draft 2020-12) of the program's files, made from the tables
 * of keys, for editors that complete and check YAML. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "control/regulators.h"
#include "default_models.h"
#include "engine/events.h"
#include "field_schema.h"
#include "options.h"
#include "plant/build.h"
#include "plant/machine_file.h"
#include "run/sections.h"
#include "study/methods.h"
#include "study/plan.h"

/* ---- a scene ---- */

static void begin_schema(vs_json *j, const char *title) {
  vs_json_object(j, NULL, VS_JSON_LINES);
  vs_json_text(j, "$schema", "https://json-schema.org/draft/2020-12/schema");
  vs_json_text(j, "title", title);
  vs_json_text(j, "type", "object");
}

/* Begins a member that may be an object or null. */
static void open_object_or_null(vs_json *j, const char *key) {
  vs_json_object(j, key, VS_JSON_ROW);
  vs_json_array(j, "type", VS_JSON_ROW);
  vs_json_text(j, NULL, "object");
  vs_json_text(j, NULL, "null");
  vs_json_end(j);
}

static void put_required(vs_json *j, const char *key) {
  vs_json_array(j, "required", VS_JSON_ROW);
  vs_json_text(j, NULL, key);
  vs_json_end(j);
}

/* A section; NULL stands for one that says nothing more than its name. own: the key that names a
 * file which declares the section's keys; with it any key passes. */
static void put_section_schema(vs_json *j, const vs_section *s, const char *own) {
  open_object_or_null(j, s->name);
  if (own) {
    vs_json_object(j, "properties", VS_JSON_ROW);
    for (size_t k = 0; k < s->count; k++)
      if (!strcmp(s->fields[k].key, own)) vs_field_schema_field(j, &s->fields[k]);
    vs_json_end(j);
    vs_json_object(j, "if", VS_JSON_ROW);
    put_required(j, own);
    vs_json_end(j);
    vs_json_object(j, "else", VS_JSON_ROW);
  }
  vs_field_schema_properties(j, s);
  vs_field_schema_close(j, own ? 2 : 1);
}

/* Ends a member with alternatives. null is the last of them, as editors tell of the first why a
 * value is none of them. */
static void end_or_null(vs_json *j) {
  vs_field_schema_type(j, "null");
  vs_field_schema_close(j, 2);
}

static void put_event(vs_json *j, const vs_event_kind *kind) {
  vs_json_object(j, NULL, VS_JSON_ROW);
  put_required(j, "kind");
  vs_json_text(j, "type", "object");
  vs_json_text(j, "description", kind->text);
  vs_json_object(j, "properties", VS_JSON_ROW);
  vs_field_schema_word(j, "kind", kind->name);
  for (size_t k = 1; k < kind->n_fields; k++) vs_field_schema_field(j, &kind->fields[k]);
  vs_json_end(j);
  vs_json_bool(j, "additionalProperties", false);
  vs_json_end(j);
}

static void put_events(vs_json *j) {
  const vs_event_kind *kind;
  open_object_or_null(j, "events");
  vs_json_object(j, "additionalProperties", VS_JSON_ROW);
  vs_json_array(j, "anyOf", VS_JSON_LINES);
  for (size_t k = 0; (kind = vs_events_kind(k)); k++) put_event(j, kind);
  vs_field_schema_close(j, 3);
}

/* The key of a section that names the file which declares the others; NULL: there is none. */
static const char *own_key(const char *section) {
  if (!strcmp(section, vs_section_keys[VS_SECTION_KEY_circuit])) return vs_deck_key.key;
  if (!strcmp(section, vs_section_keys[VS_SECTION_KEY_machine])) return vs_machine_key.key;
  return NULL;
}

/* ---- what the machine and the deck name ---- */

/* Names that a list may have, each once. */
typedef struct names {
  const char *item[VS_CH_MOST + 1];
  size_t count;
} names;

/* One of the names, or a list of them; word: what may stand instead. */
static void put_names(vs_json *j, const char *key, const char *word, const names *n) {
  vs_field_schema_either(j, key);
  vs_field_schema_word(j, NULL, word);
  for (int list = 0; list < 2; list++) {
    vs_json_object(j, NULL, VS_JSON_ROW);
    if (list) {
      vs_json_text(j, "type", "array");
      vs_json_whole(j, "minItems", 1);
      vs_json_bool(j, "uniqueItems", true);
      vs_json_object(j, "items", VS_JSON_ROW);
    }
    vs_json_array(j, "enum", VS_JSON_ROW);
    for (size_t k = 0; k < n->count; k++) vs_json_text(j, NULL, n->item[k]);
    vs_json_end(j);
    vs_field_schema_close(j, list ? 2 : 1);
  }
  end_or_null(j);
}

static void put_channels(vs_json *j, const vs_default_models *ground) {
  const vs_model model = {.machine = ground->machine, .dof = ground->machine->dof};
  const vs_frame frame = {.model = &model, .deck = ground->deck};
  int numbers[VS_CH_MOST], count = vs_channel_listed(&frame, numbers);
  names all = {.count = 0}, currents = {.count = 0};
  for (int k = 0; k < count; k++) {
    const vs_channel c = vs_channel_at(&frame, numbers[k]);
    all.item[all.count++] = c.name;
    if (!strcmp(c.unit, "A")) currents.item[currents.count++] = c.name;
  }
  currents.item[currents.count++] = vs_quality_mains;
  put_names(j, vs_section_keys[VS_SECTION_KEY_record], vs_scene_all_probes, &all);
  put_names(j, vs_section_keys[VS_SECTION_KEY_quality], vs_quality_none, &currents);
}

static void put_measured(vs_json *j, const vs_default_models *ground) {
  vs_model *model = vs_alloc(1, sizeof *model);
  vs_error err = {0};
  vs_measure m;
  vs_build_model(NULL, ground->machine, model, &err); /* names follow, even where numbers do not */
  vs_field_schema_either(j, vs_section_keys[VS_SECTION_KEY_measured]);
  vs_field_schema_open(j, NULL, "object");
  vs_json_object(j, "properties", VS_JSON_ROW);
  for (int k = 0; vs_measure_at(model, k, &m); k++) {
    vs_field_schema_either(j, m.name);
    vs_field_schema_quantity(j, &(vs_field){.unit = m.unit});
    vs_field_schema_close(j, 2);
  }
  vs_json_end(j);
  vs_json_bool(j, "additionalProperties", false);
  vs_json_end(j);
  end_or_null(j);
  vs_actuator_end(&model->coil);
  free(model);
}

static void put_start(vs_json *j, const vs_default_models *ground) {
  vs_field_schema_either(j, vs_section_keys[VS_SECTION_KEY_start]);
  vs_field_schema_open(j, NULL, "object");
  vs_field_schema_properties(j, &ground->machine->start);
  vs_json_end(j);
  vs_field_schema_word(j, NULL, vs_setup_steady);
  end_or_null(j);
}

/* A scene that names a machine or a deck of its own. */
static void put_names_own(vs_json *j, int section, const char *key) {
  vs_json_object(j, NULL, VS_JSON_ROW);
  put_required(j, vs_section_keys[section]);
  vs_json_object(j, "properties", VS_JSON_ROW);
  vs_field_schema_open(j, vs_section_keys[section], "object");
  put_required(j, key);
  vs_field_schema_close(j, 3);
}

/* Sections whose keys and words are names of the machine's and the deck's: told only of scenes
 * that name neither. */
static void put_named_schema(vs_json *j, const vs_default_models *ground) {
  vs_field_schema_either(j, "if");
  put_names_own(j, VS_SECTION_KEY_machine, vs_machine_key.key);
  put_names_own(j, VS_SECTION_KEY_circuit, vs_deck_key.key);
  vs_field_schema_close(j, 2);
  vs_json_object(j, "else", VS_JSON_ROW);
  vs_json_object(j, "properties", VS_JSON_LINES);
  put_start(j, ground);
  put_measured(j, ground);
  put_channels(j, ground);
  vs_field_schema_close(j, 2);
}

/* ---- instruments and control ---- */

static void put_instruments(vs_json *j) {
  vs_field_schema_either(j, vs_section_keys[VS_SECTION_KEY_instruments]);
  vs_field_schema_open(j, NULL, "object");
  vs_json_object(j, "properties", VS_JSON_LINES);
  for (size_t k = 0; k < vs_instruments_section.count; k++)
    vs_field_schema_field(j, &vs_instruments_section.fields[k]);
  vs_json_end(j);
  vs_field_schema_either(j, "additionalProperties");
  vs_field_schema_word(j, NULL, vs_instruments_left_out);
  vs_field_schema_instrument(j);
  vs_field_schema_close(j, 3);
  end_or_null(j);
}

/* Each is a range, or a map of a device's. */
static void put_ratings(vs_json *j) {
  vs_field_schema_either(j, vs_section_keys[VS_SECTION_KEY_ratings]);
  vs_field_schema_open(j, NULL, "object");
  vs_field_schema_either(j, "additionalProperties");
  vs_field_schema_type(j, "string");
  vs_field_schema_type(j, "object");
  vs_field_schema_close(j, 3);
  vs_field_schema_word(j, NULL, vs_ratings_none);
  end_or_null(j);
}

/* The section control with one law, of which `law` must be the name unless it is the default. */
static void put_law(vs_json *j, const vs_regulator *law) {
  const vs_field *keys[VS_CONTROL_FIELDS];
  const size_t n = vs_control_keys(law, keys);
  vs_field_schema_open(j, NULL, "object");
  vs_json_text(j, "description", law->text);
  vs_json_object(j, "properties", VS_JSON_LINES);
  vs_field_schema_word(j, keys[0]->key, law->name);
  for (size_t k = 1; k < n; k++) vs_field_schema_field(j, keys[k]);
  vs_field_schema_field(j, &vs_state_observer_key);
  vs_json_end(j);
  vs_json_array(j, "required", VS_JSON_ROW);
  if (strcmp(law->name, keys[0]->default_text) != 0) vs_json_text(j, NULL, keys[0]->key);
  if (law->senses) vs_json_text(j, NULL, vs_control_sensor);
  if (law->code) vs_json_text(j, NULL, law->code);
  vs_json_end(j);
  vs_json_bool(j, "additionalProperties", false);
  vs_json_end(j);
}

static void put_control(vs_json *j) {
  vs_json_object(j, vs_section_keys[VS_SECTION_KEY_control], VS_JSON_ROW);
  vs_json_array(j, "anyOf", VS_JSON_LINES);
  for (const vs_regulator *const *law = vs_regulators; *law; law++) put_law(j, *law);
  vs_field_schema_close(j, 2);
}

/* A device and what is said of it, or a list of such: what happens to it, "fuse_2 opens", or one of
 * its limits, "varistor_1.power". */
static void put_of_devices(vs_json *j, int key, const char *pattern) {
  vs_field_schema_either(j, vs_section_keys[key]);
  vs_field_schema_pattern(j, NULL, pattern);
  vs_field_schema_open(j, NULL, "array");
  vs_field_schema_pattern(j, "items", pattern);
  vs_json_end(j);
  end_or_null(j);
}

/* A map from devices to what their heat sinks have. */
static void put_heatsink(vs_json *j) {
  vs_field_schema_either(j, vs_section_keys[VS_SECTION_KEY_heatsink]);
  vs_field_schema_open(j, NULL, "object");
  vs_json_text(j, "description", vs_cooling_heatsink.text);
  vs_field_schema_either(j, "additionalProperties");
  vs_field_schema_quantity(j, &vs_cooling_heatsink);
  vs_field_schema_close(j, 3);
  end_or_null(j);
}

static void put_scene(vs_json *j, const vs_default_models *ground) {
  static const int NAMED[] = {VS_SECTION_KEY_start, VS_SECTION_KEY_record, VS_SECTION_KEY_measured,
                              VS_SECTION_KEY_quality};
  begin_schema(j, "a scene of VibroSpice");
  vs_json_object(j, "properties", VS_JSON_LINES);
  for (int s = 0; s < VS_SECTIONS; s++) {
    const vs_section *section = vs_section_fields(ground->machine, ground->deck, s);
    if (s != VS_SECTION_NUMBER_start) put_section_schema(j, section, own_key(section->name));
  }
  put_events(j);
  put_instruments(j);
  put_control(j);
  put_of_devices(j, VS_SECTION_KEY_expect, "^[^ ]+ .*$");
  put_of_devices(j, VS_SECTION_KEY_waive, "^[^ .]+[.][^ ]+$");
  put_ratings(j);
  vs_field_schema_field(j, &vs_cooling_ambient);
  put_heatsink(j);
  vs_field_schema_open(j, vs_section_keys[VS_SECTION_KEY_spread], "object");
  vs_json_end(j);
  for (size_t k = 0; k < sizeof NAMED / sizeof *NAMED; k++) {
    vs_json_object(j, vs_section_keys[NAMED[k]], VS_JSON_ROW);
    vs_json_end(j);
  }
  vs_json_end(j);
  put_named_schema(j, ground);
  vs_json_bool(j, "additionalProperties", false);
  vs_json_end(j);
}

/* ---- studies and machines ---- */

static void put_study(vs_json *j, const vs_default_models *ground) {
  begin_schema(j, "a study of VibroSpice");
  vs_field_schema_definitions(j, ground);
  vs_json_object(j, "properties", VS_JSON_LINES);
  for (const vs_field *row = vs_plan_keys; row->kind; row++) vs_field_schema_row(j, row, ground);
  const char *before = "";
  for (const vs_method *const *m = vs_methods_all; *m; before = (*m)->key, m++) {
    if (strcmp(before, (*m)->key) != 0) vs_field_schema_row(j, (*m)->keys, ground);
    for (const vs_field *row = (*m)->besides; row && row->key; row++)
      vs_field_schema_row(j, row, ground);
  }
  vs_json_end(j);
  vs_json_bool(j, "additionalProperties", false);
  vs_json_end(j);
}

static void put_machine(vs_json *j, const vs_default_models *ground) {
  begin_schema(j, "a machine of VibroSpice");
  vs_json_object(j, "properties", VS_JSON_LINES);
  for (const vs_field *row = vs_machine_file_keys.rows; row->kind; row++)
    vs_field_schema_row(j, row, ground);
  vs_json_end(j);
  vs_field_schema_required(j, vs_machine_file_keys.rows);
  vs_json_bool(j, "additionalProperties", false);
  vs_json_end(j);
}

/* ---- the command ---- */

static const struct kind {
  const char *name;
  void (*put)(vs_json *j, const vs_default_models *ground);
} KINDS[] = {{"scene", put_scene}, {"study", put_study}, {"machine", put_machine}};
enum { N_KINDS = sizeof KINDS / sizeof *KINDS };

typedef struct schema_line {
  vs_arguments common;
  const char *deck, *machine; /* whose keys a scene has that names none; NULL: those of an empty
                                 scene */
} schema_line;

/* Prints the schema. It tells unknown and missing keys, words, kinds of values and units of the
 * wrong dimension; ranges only of a scene's pure numbers. Of a scene that names a deck or a machine
 * of its own, it lets any key pass in the sections that these declare. It looks into no formula and
 * no name. Errors: there is no such kind; those of
 * reading deck and machine. */
static vs_status schema_command(const void *given, vs_error *err) {
  const schema_line *o = given;
  const char *kind = vs_command_name(&o->common);
  size_t k = 0;
  while (kind && k < N_KINDS && strcmp(kind, KINDS[k].name) != 0) k++;
  if (k == N_KINDS)
    return vs_fail(err, VS_INPUT, "schema: no kind '%s'; there are: scene, study, machine", kind);
  vs_default_models ground;
  vs_text text = {0};
  vs_json j = vs_json_new(&text);
  vs_status status = vs_default_models_read(o->deck, o->machine, &ground, err);
  if (!status) KINDS[k].put(&j, &ground);
  if (!status) puts(text.text);
  vs_text_free(&text);
  vs_default_models_free(&ground);
  return status;
}

static const vs_option SCHEMA_OPTIONS[] = {
    VS_OPTIONS_FILE(schema_line, deck, "deck", "DECK", "whose keys the section circuit has"),
    VS_OPTIONS_FILE(schema_line, machine, "machine", "MACHINE",
                    "whose keys the section machine has"),
    VS_OPTIONS_END};

const vs_command vs_schema_cli = {
    .name = "schema",
    .argument = "[scene|study|machine]",
    .text = "prints a JSON Schema of such files (default: scene), for editors that complete and "
            "check YAML",
    .examples = "  vibrospice schema scene > scene.schema.json\n",
    .may_be_alone = true,
    .options = SCHEMA_OPTIONS,
    .size = sizeof(schema_line),
    .run = schema_command};
