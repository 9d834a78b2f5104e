/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `new`: a scene that names every key, made from the tables of keys. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/path.h"
#include "commands.h"
#include "default_models.h"
#include "engine/events.h"
#include "options.h"
#include "run/scene.h"
#include "run/sections.h"

typedef struct new_line {
  vs_arguments common;
  const char *deck, *machine; /* the scene's, a path or a name; NULL: those of an empty scene */
} new_line;

static const char ENDING[] = ".yaml";

static const char HEAD[] =
    "# A scene for VibroSpice: vibrospice run %s\n"
    "#\n"
    "# Every key of a scene is here, off, behind a '#'. Take that '#' away and change the value.\n"
    "# Behind each: its default unit and range, and what it means. 'vibrospice check %s' tells\n"
    "# mistakes with their line, 'vibrospice help SECTION' more of a section.\n";

/* Sections without a table of keys: an example, and what it is for. */
static const struct other {
  const char *line, *text;
} OTHERS[] = {
    {"record: all", "columns of run.csv: all, or a list as [p, i]; see 'vibrospice list probes'"},
    {"measured: {i_peak: 0.95 A}",
     "what was measured, printed beside what is computed; see 'vibrospice list measures'"},
    {"expect: [fuse_2 opens]",
     "what may happen to the deck's devices, and has to; see 'vibrospice help expect'"},
    {"waive: [varistor_1.power]",
     "limits of devices that the verdict leaves out; see 'vibrospice help waive'"},
    {"spread: {supply.voltage: 10 %}",
     "what is not known exactly; 'vibrospice run --corners' runs the ends; see 'vibrospice help "
     "spread'"},
    {"ratings: {stroke: 0.5 mm .. 1.5 mm}", "what you allow of measures and probes, as lines of "
                                            "the verdict; see 'vibrospice help ratings'"},
    {"ambient: 25 degC", "temperature of the air around the circuit's devices"},
    {"heatsink: {thyristor: 12 K/W}",
     "from devices' heat sinks to the ambient; see 'vibrospice help heatsink'"},
    {"instruments: {set: own}", "sensors; see 'vibrospice list instruments'"},
    {"control: {law: LAW}", "what decides the firing angle; see 'vibrospice list regulators'"},
};

/* The default as YAML: a pair stands in brackets. */
static void add_default_value(const vs_field *f, vs_text *text) {
  vs_text_add(text, f->kind == VS_PAIR ? "[%s]" : "%s", f->default_text);
}

static void add_key(const vs_field *f, const char *set, vs_text *text) {
  char range[160];
  size_t begin = text->length;
  vs_text_add(text, "  %s%s: ", set ? "" : "#", f->key);
  if (set)
    vs_text_add(text, "%s", set);
  else
    add_default_value(f, text);
  vs_field_range(f, range, sizeof range);
  int wide = (int)(text->length - begin), pad = wide < 36 ? 36 - wide : 1;
  vs_text_add(text, "%*s# %s%s%s\n", pad, "", f->kind == VS_NAME ? "" : range,
              f->kind == VS_NAME ? "" : ": ", f->text);
}

static const char *value_of(const vs_field *f, const new_line *o) {
  return !strcmp(f->key, vs_deck_key.key)      ? o->deck
         : !strcmp(f->key, vs_machine_key.key) ? o->machine
                                               : NULL;
}

static void add_scene_section(const vs_section *section, const new_line *o, vs_text *text) {
  vs_text_add(text, "\n%s:\n", section->name);
  for (size_t k = 0; k < section->count; k++)
    add_key(&section->fields[k], value_of(&section->fields[k], o), text);
}

static void add_others(vs_text *text) {
  const vs_event_kind *first = vs_events_kind(0);
  vs_text_add(text,
              "\n# what goes wrong, and when; see 'vibrospice list events'\n"
              "#events:\n#  a_name: {kind: %s, at: 0.1 s}\n",
              first->name);
  for (size_t k = 0; k < sizeof OTHERS / sizeof *OTHERS; k++)
    vs_text_add(text, "\n# %s\n#%s\n", OTHERS[k].text, OTHERS[k].line);
}

/* The first line, by which an editor finds the schema; nothing where the program is not installed.
 */
static void add_schema(vs_text *text) {
  static const vs_shelf SCHEMAS = {"schema", "schema", ".schema.json"};
  char path[VS_PATH_SIZE];
  char *whole = vs_path_shipped(&SCHEMAS, "scene", path) ? realpath(path, NULL) : NULL;
  if (whole) vs_text_add(text, "# yaml-language-server: $schema=%s\n", whole);
  free(whole);
}

static vs_status write_scene(const char *path, const vs_text *text, vs_error *err) {
  const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path;
  char folder[VS_PATH_SIZE];
  vs_file file;
  int n = slash == path ? 1 : slash ? (int)(slash - path) : 0;
  snprintf(folder, sizeof folder, "%.*s", n, path);
  vs_status status = vs_file_open(&file, folder, base, err);
  if (status) return status;
  fwrite(text->text, 1, text->length, file.stream);
  return vs_file_commit(&file, err);
}

static vs_status check_path(const char *path, vs_error *err) {
  size_t n = strlen(path), ending = strlen(ENDING);
  if (n <= ending || strcmp(path + n - ending, ENDING) != 0 || path[n - ending - 1] == '/')
    return vs_fail(err, VS_INPUT, "new %s: a file whose name ends in %s is wanted, as my%s", path,
                   ENDING, ENDING);
  if (!access(path, F_OK))
    return vs_fail(err, VS_INPUT, "new %s: is there already; give another name", path);
  return VS_OK;
}

/* Says what comes next. Some machines want more keys than their name before they run, as a moving
 * coil wants firing.valve. */
static void say_next(const char *path) {
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_error wanted = {0};
  if (vs_scene_read(path, NULL, 0, NULL, scene, &wanted))
    printf("written: %s; before it runs, mend this: %s\n", path, wanted.text);
  else
    printf("written: %s; next: vibrospice run %s\n", path, path);
  vs_scene_free(scene);
  free(scene);
}

/* Writes a scene in which every key stands behind a '#', with its default, what is allowed and what
 * it means; only the deck and the machine asked for are set. So it runs as it is. Where the program
 * is installed the first line names the schema. Errors: VS_INPUT, the file is there already, or has
 * another ending; those of reading deck and machine. */
static vs_status new_command(const void *given, vs_error *err) {
  const new_line *o = given;
  const char *path = vs_command_name(&o->common);
  vs_default_models ground;
  vs_text text = {0};
  vs_status status = check_path(path, err);
  if (status) return status;
  status = vs_default_models_read(o->deck, o->machine, &ground, err);
  if (!status) {
    add_schema(&text);
    vs_text_add(&text, HEAD, path, path);
    for (int s = 0; s < VS_SECTIONS; s++)
      add_scene_section(vs_section_fields(ground.machine, ground.deck, s), o, &text);
    add_others(&text);
    status = write_scene(path, &text, err);
  }
  if (!status && !o->common.quiet) say_next(path);
  vs_text_free(&text);
  vs_default_models_free(&ground);
  return status;
}

static const vs_option NEW_OPTIONS[] = {
    VS_OPTIONS_FILE(new_line, deck, "deck", "DECK", "with that deck, and its keys"),
    VS_OPTIONS_FILE(new_line, machine, "machine", "MACHINE", "with that machine, and its keys"),
    VS_OPTIONS_FLAG(vs_arguments, quiet, "quiet", "prints nothing"), VS_OPTIONS_END};

const vs_command vs_new_cli = {
    .name = "new",
    .argument = "FILE",
    .text = "writes a scene that has every key, with its default, range and meaning, behind a '#'",
    .examples = "  vibrospice new my.yaml && vibrospice run my.yaml\n"
                "  vibrospice new my.yaml --machine two_mass\n",
    .options = NEW_OPTIONS,
    .size = sizeof(new_line),
    .run = new_command};
