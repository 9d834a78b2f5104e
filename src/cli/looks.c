/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "looks.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "bench/acceptance.h"
#include "base/jail.h"
#include "base/path.h"
#include "check.h"
#include "modes.h"
#include "fresh.h"
#include "list.h"
#include "schema.h"
#include "import/hint.h"
#include "fit/inquiry.h"
#include "study/methods.h"
#include "study/inspect.h"
#include "report/fitting.h"

/* ---- check ---- */

static vs_status check_study(const vs_check_options *o, vs_text *good, vs_error *err) {
  return vs_inspect_study(o, vs_methods_all, good, err);
}

/* A file is read more than once: for its kind, for what it says, for the lines that messages quote.
 * A pipe gives its text once. /dev/stdin of a file is called as the file is, whose ending tells the
 * kind; `path` has room for that. */
static vs_status find_file(const char **name, char path[VS_PATH_SIZE], vs_error *err) {
  static const char DEVICES[] = "/dev/";
  struct stat s;
  if (stat(*name, &s)) return VS_OK;
  if (!S_ISREG(s.st_mode) && !S_ISDIR(s.st_mode))
    return vs_fail(err, VS_INPUT,
                   "%s is a pipe or a device; check reads a file more than once: write it to a "
                   "file, with the ending of its kind (.yaml, .cir, .inc)",
                   *name);
  char *real = strncmp(*name, DEVICES, sizeof DEVICES - 1) ? NULL : realpath(*name, NULL);
  if (real && strlen(real) < VS_PATH_SIZE) {
    snprintf(path, VS_PATH_SIZE, "%s", real);
    vs_jail_allow_named(path);
    *name = path;
  }
  free(real);
  return VS_OK;
}

static vs_status check(const vs_arguments *a, vs_error *err) {
  const char *name = vs_command_name(a);
  char path[VS_PATH_SIZE];
  vs_status status = find_file(&name, path, err);
  if (status) return status;
  const vs_check_options o = {.name = name,
                              .sets = a->sets,
                              .n_sets = a->n_sets,
                              .json = a->json,
                              .quiet = a->quiet,
                              .bench = vs_acceptance_try,
                              .look = vs_hint_look,
                              .deep = a->deep,
                              .trial = vs_hint_try,
                              .folder = a->output,
                              .other = vs_inquiry_is(name) ? vs_fitting_check
                                       : vs_inspect_is_study(name, vs_methods_all) ? check_study
                                                                                   : NULL};
  return vs_check_command(&o, err);
}

static const struct argp_option CHECK_OPTIONS[] = {
    VS_COMMAND_SET,
    VS_COMMAND_VALUE("output", 'o', "DIR",
                     "of a part: writes what was asked and what the bench got as bench.csv and "
                     "bench.json there, and draws bench.png"),
    VS_COMMAND_FLAG("deep", VS_KEY_DEEP,
                    "of a scene or deck: also tries the beginning of its run, with each of the "
                    "solver's rules, and tells what was measured and what may help"),
    VS_COMMAND_FLAG("json", VS_KEY_JSON,
                    "findings as a JSON array of {file, line, column, message} on standard output; "
                    "of a part also each figure of the bench, with further members"),
    VS_COMMAND_FLAG("quiet", VS_KEY_QUIET, "prints nothing but findings"),
    VS_COMMAND_JAIL,
    VS_COMMAND_NO_JAIL,
    VS_COMMAND_HELP,
    {0}};

/* ---- list, new, schema, modes ---- */

static vs_status list(const vs_arguments *a, vs_error *err) {
  if (a->n_names > 2)
    return vs_fail(err, VS_INPUT, "list: one argument too many: '%s'; see vibrospice list --help",
                   a->names[2]);
  const vs_list_options o = {.kind = vs_command_name(a),
                             .filter = a->n_names > 1 ? a->names[1] : NULL,
                             .deck = a->deck,
                             .machine = a->machine,
                             .json = a->json};
  return vs_list_command(&o, err);
}

static const struct argp_option LIST_OPTIONS[] = {
    VS_COMMAND_VALUE("deck", VS_KEY_DECK, "DECK",
                     "whose probes and parameters (default halfwave_snubbed)"),
    VS_COMMAND_VALUE("machine", VS_KEY_MACHINE, "MACHINE", "likewise (default conveyor)"),
    VS_COMMAND_FLAG("json", VS_KEY_JSON,
                    "an object with an array of entries for each kind, on standard output"),
    VS_COMMAND_HELP,
    {0}};

static vs_status new (const vs_arguments *a, vs_error *err) {
  const vs_fresh_options o = {vs_command_name(a), a->deck, a->machine, a->quiet};
  return vs_fresh_command(&o, err);
}

static const struct argp_option NEW_OPTIONS[] = {
    VS_COMMAND_VALUE("deck", VS_KEY_DECK, "DECK", "with that deck, and its keys"),
    VS_COMMAND_VALUE("machine", VS_KEY_MACHINE, "MACHINE", "with that machine, and its keys"),
    VS_COMMAND_FLAG("quiet", VS_KEY_QUIET, "prints nothing"),
    VS_COMMAND_HELP,
    {0}};

static vs_status schema(const vs_arguments *a, vs_error *err) {
  const vs_schema_options o = {vs_command_name(a), a->deck, a->machine};
  return vs_schema_command(&o, err);
}

static const struct argp_option SCHEMA_OPTIONS[] = {
    VS_COMMAND_VALUE("deck", VS_KEY_DECK, "DECK", "whose keys the section circuit has"),
    VS_COMMAND_VALUE("machine", VS_KEY_MACHINE, "MACHINE", "whose keys the section machine has"),
    VS_COMMAND_HELP,
    {0}};

static vs_status modes(const vs_arguments *a, vs_error *err) {
  return vs_modes_command(vs_command_name(a), a->sets, a->n_sets, a->output, a->json, a->quiet,
                          err);
}

static const struct argp_option MODES_OPTIONS[] = {
    VS_COMMAND_SET,
    VS_COMMAND_VALUE("output", 'o', "DIR",
                     "writes modes.csv and the state space there: A.csv, B.csv, C.csv, D.csv"),
    VS_COMMAND_JSON,
    VS_COMMAND_FLAG("quiet", VS_KEY_QUIET, "no table"),
    VS_COMMAND_JAIL,
    VS_COMMAND_NO_JAIL,
    VS_COMMAND_HELP,
    {0}};

const vs_command vs_looks_check = {
    .name = "check",
    .argument = "FILE",
    .text =
        "tells all that can be known of a scene, study, fit, machine or deck before a run: every "
        "mistake, with its line; of a part also whether its model does what its file asks",
    .examples = "  vibrospice check my.yaml\n"
                "  vibrospice check my.cir\n"
                "  vibrospice check my.inc -o bench\n"
                "  vibrospice check my.yaml --deep\n"
                "  vibrospice check paper --set run.tier=circuit --json\n",
    .jailed = true,
    .options = CHECK_OPTIONS,
    .run = check};

const vs_command vs_looks_list = {
    .name = "list",
    .argument = "[KIND [FILTER]]",
    .text = "lists scenes, studies, fits, machines, decks, parts, instruments, kinds, tiers, laws, "
            "regulators, probes, measures, "
            "parameters (with "
            "unit, default, range); FILTER: only what has that text",
    .examples = "  vibrospice list parameters\n  vibrospice list probes --deck my.cir\n"
                "  vibrospice list parameters angle --json\n"
                "  vibrospice list parameters --machine two_mass\n",
    .may_be_alone = true,
    .takes_many = true,
    .options = LIST_OPTIONS,
    .run = list};

const vs_command vs_looks_new = {
    .name = "new",
    .argument = "FILE",
    .text = "writes a scene that has every key, with its default, range and meaning, behind a '#'",
    .examples = "  vibrospice new my.yaml && vibrospice run my.yaml\n"
                "  vibrospice new my.yaml --machine two_mass\n",
    .options = NEW_OPTIONS,
    .run = new};

const vs_command vs_looks_schema = {
    .name = "schema",
    .argument = "[scene|study|machine]",
    .text = "prints a JSON Schema of such files (default: scene), for editors that complete and "
            "check YAML",
    .examples = "  vibrospice schema scene > scene.schema.json\n",
    .may_be_alone = true,
    .options = SCHEMA_OPTIONS,
    .run = schema};

const vs_command vs_looks_modes = {
    .name = "modes",
    .argument = "SCENE",
    .text = "prints eigenfrequencies, damping and shapes; exports the state space",
    .examples =
        "  vibrospice modes paper\n  vibrospice modes paper --set machine.m14=derived -o modes\n",
    .options = MODES_OPTIONS,
    .run = modes};
