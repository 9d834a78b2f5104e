/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `check`: tells all that can be known of a scene, a deck or a part before a run. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/jail.h"
#include "base/json.h"
#include "base/path.h"
#include "bench/acceptance.h"
#include "commands.h"
#include "fit/fit_problem.h"
#include "import/hint.h"
#include "measure/unjudged.h"
#include "netlist/cards.h"
#include "netlist/catalogue.h"
#include "netlist/netlist.h"
#include "netlist/parts.h"
#include "netlist/source.h"
#include "ngspice/self_test.h"
#include "options.h"
#include "plant/machine_file.h"
#include "report/fit_command.h"
#include "run/findings.h"
#include "run/session.h"
#include "run/table.h"
#include "study/methods.h"
#include "study/study_check.h"

/* ---- print-out ---- */

/* Prints the line that a place speaks of and a caret below the column. Prints nothing where the
 * file cannot be read again. */
static void print_source(const char *path, int number, int column) {
  vs_source source;
  vs_error unread = {0};
  if (!vs_source_read(path, &source, &unread) && number <= (int)source.count) {
    char *line = source.line[number - 1];
    for (char *c = line; *c; c++)
      if ((unsigned char)*c < ' ' && *c != '\t') *c = ' '; /* nothing a terminal would obey */
    fprintf(stderr, " %s\n ", line);
    for (const char *c = line; *c && column > 1; c++) {
      if ((*c & 0xc0) != 0x80) fputc(*c == '\t' ? '\t' : ' ', stderr); /* a character begins */
      if ((c[1] & 0xc0) != 0x80) column--;
    }
    fputs("^\n", stderr);
  }
  vs_source_free(&source);
}

/* name: of the file under check, for a finding that knows no place of its own. */
static void print_finding(const char *name, const char *kind, const vs_error *e) {
  char file[sizeof e->text];
  snprintf(file, sizeof file, "%.*s", e->file_size, e->text);
  if (e->place_size)
    fprintf(stderr, "%.*s", e->place_size, e->text);
  else
    fprintf(stderr, "%s: ", name);
  fprintf(stderr, "%s%s\n", kind, e->text + e->place_size);
  if (e->line) print_source(file, e->line, e->column);
}

/* Adds a row. level: "warning"; NULL: it is a mistake. */
static void add_finding_json(const char *name, const vs_error *e, const char *level,
                             vs_json *json) {
  char file[sizeof e->text];
  snprintf(file, sizeof file, "%.*s", e->file_size, e->text);
  vs_json_object(json, NULL, VS_JSON_ROW);
  vs_json_text(json, "file", e->place_size ? file : name);
  vs_json_number(json, "line", e->line ? (double)e->line : (double)NAN, 12);
  vs_json_number(json, "column", e->line ? (double)e->column : (double)NAN, 12);
  vs_json_text(json, "message", e->text + e->place_size);
  if (level) vs_json_text(json, "level", level);
  vs_json_end(json);
}

/* ---- what is checked ---- */

typedef struct report {
  const vs_check_options *options;
  vs_text good; /* describes the file, where nothing was found */
  vs_warnings warnings;
  vs_check_bench bench;   /* of a part */
  vs_check_options named; /* the options, for a part that comes with the program */
  char *part;             /* where that one lies; owned */
  bool may_try;           /* the file is of a kind that --deep tries */
} report;

static void warn_of_deck(report *r, const vs_deck *deck) {
  const vs_where file = {.file = deck->files[0]};
  const char *mains = vs_warnings_without_mains(deck);
  bool fires =
      vs_deck_has_port(deck, vs_port_is_modulated) && !vs_deck_has_port(deck, vs_port_is_gated);
  for (size_t k = 0; k < deck->n_probes; k++) /* without a gate there is nothing to be found */
    fires = fires || !strcmp(deck->probes[k].name, "i_thyristor");
  if (!fires)
    vs_fail_at(vs_warnings_add(&r->warnings), file,
               "no probe i_thyristor, so that firing and extinction will not be found");
  if (mains) vs_fail_at(vs_warnings_add(&r->warnings), file, "%s", mains);
}

/* The place of the first key of section firing; no place where the scene has none. */
static vs_where where_of_firing(const vs_scene *s) {
  const vs_node *firing = vs_tree_child(s->tree.root, "firing");
  return firing && firing->child ? firing->child->key_where : (vs_where){0};
}

/* A check is to end soon: it looks at this many cycles, which takes some tenths of a second. What
 * is behind them is not spoken of. */
static const double MOST_CYCLES = 1e5;

/* Warns of what a run would say once it is over: nothing can fire. In a circuit something may:
 * there a capacitor or the coil can drive a thyristor while the mains do not. */
static void warn_of_firing(report *r, const vs_scene *s) {
  double until_s = s->setup.run.until_s;
  if (s->setup.timeline.firing.no_valve) return;
  double seen_s = fmin(until_s, MOST_CYCLES * s->setup.timeline.period_s);
  double first_s = vs_warnings_first_chance(&s->setup, &s->frame, seen_s);
  if (!isinf(first_s) || seen_s < until_s) return;
  vs_fail_at(vs_warnings_add(&r->warnings), where_of_firing(s),
             "%s: %s before run.until = %.9g s%s; look at firing.first_cycle, firing.angle and "
             "firing.pulse_width",
             s->frame.deck ? "it may be that nothing fires" : "nothing can fire",
             vs_warnings_no_chance(&s->frame), until_s,
             s->frame.deck ? ", so that only what the circuit has stored could drive a thyristor"
                           : "");
}

/* Warns of a table that run -o would refuse to write; without -o there is none. */
static void warn_of_table(report *r, const vs_scene *s) {
  const vs_table table = {.frame = &s->frame,
                          .instruments = &s->instruments,
                          .control = &s->control,
                          .count = s->n_record,
                          .digits = 9,
                          .sample_s = s->setup.run.sample_s,
                          .until_s = s->setup.run.until_s};
  vs_error e = {0};
  if (vs_table_check(&table, s->tree.root, s->setup.limits.csv_bytes, &e))
    *vs_warnings_add(&r->warnings) = e;
}

/* Looks through the circuit, if that could be read. */
static void look_through(report *r, const vs_deck *deck, const vs_error *err) {
  r->bench.warnings = &r->warnings;
  if (r->options->look && !vs_error_count(err)) r->options->look(r->options, deck, &r->bench);
}

/* Tries the beginning of a run, where that is asked for and nothing was found. */
static vs_status try_deep(report *r, bool is_deck, vs_status status, vs_error *err) {
  const vs_check_options *o = r->options;
  r->may_try = true;
  return status || vs_error_count(err) || !o->deep || !o->trial
             ? status
             : o->trial(o, is_deck, &r->bench, err);
}

/* Names the limits that the deck's parts state and that no run will judge. */
static void describe_left(const vs_deck *deck, vs_text *good) {
  vs_text left = {0};
  vs_unjudged_write_left(deck, &left);
  if (left.length) vs_text_add(good, "; stated, and nothing is held to it: %s", left.text);
  vs_text_free(&left);
}

static vs_status check_scene(report *r, vs_error *err) {
  const vs_check_options *o = r->options;
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_status status = vs_scene_read(o->name, o->sets, o->n_sets, NULL, scene, err);
  if (!status && scene->frame.deck) look_through(r, scene->frame.deck, err);
  vs_spreads spreads;
  if (!status) status = vs_key_spreads(scene, &spreads, err);
  if (!status && !vs_error_count(err)) status = vs_session_try(scene->tier, &scene->setup, err);
  if (!status && !vs_error_count(err)) {
    vs_text_add(&r->good, "a good scene: tier %s (%s)", scene->tier->name, scene->why);
    vs_control_describe(&scene->control, &r->good);
    if (scene->frame.deck) describe_left(scene->frame.deck, &r->good);
    for (size_t w = 0; w < scene->warnings.count; w++)
      *vs_warnings_add(&r->warnings) = scene->warnings.item[w];
    if (scene->frame.deck) warn_of_deck(r, scene->frame.deck);
    warn_of_firing(r, scene);
    warn_of_table(r, scene);
  }
  vs_scene_free(scene);
  free(scene);
  return try_deep(r, false, status, err);
}

static void describe_deck(const vs_deck *deck, vs_text *good) {
  size_t n_params = deck->section.count - 1 - deck->n_parts;
  for (size_t d = 0; d < deck->n_devices; d++) n_params -= deck->devices[d].scale_at > 0;
  const struct {
    const char *what;
    size_t count;
  } COUNTS[] = {{"parameter", n_params},      {"part", deck->n_parts},
                {"port", deck->n_ports},      {"probe", deck->n_probes},
                {"loss", deck->losses.count}, {"store", deck->stores.count},
                {"rating", deck->n_ratings},  {"device", deck->n_devices}};
  vs_text_add(good, "a good deck: %s%sEVA between %s and %s", deck->title, *deck->title ? "; " : "",
              deck->eva_plus, deck->eva_minus);
  for (size_t k = 0; k < sizeof COUNTS / sizeof *COUNTS; k++)
    if (COUNTS[k].count)
      vs_text_add(good, ", %zu %s%s", COUNTS[k].count, COUNTS[k].what,
                  COUNTS[k].count == 1              ? ""
                  : !strcmp(COUNTS[k].what, "loss") ? "es"
                                                    : "s");
}

/* A deck is checked in the scene that names it and nothing else. */
static vs_status check_deck(report *r, vs_error *err) {
  const vs_check_options *o = r->options;
  if (o->n_sets)
    return vs_fail(err, VS_INPUT, "--set %s: a deck has no keys to set; check a scene with it",
                   o->sets[0]);
  vs_node deck = vs_tree_word(vs_deck_key.key, o->name, (vs_where){0});
  vs_node circuit = vs_tree_map("circuit", &deck);
  const vs_node scene = vs_tree_map(NULL, &circuit);
  vs_setup *setup = vs_alloc(1, sizeof *setup);
  char text[VS_DECK_TEXT + VS_NAME_SIZE];
  vs_status status = vs_setup_build(&scene, setup, err);
  if (!status) look_through(r, &setup->deck, err);
  if (!status && !vs_error_count(err))
    status = vs_session_try(vs_tiers_automatic(true), setup, err);
  if (!status && !vs_error_count(err)) {
    describe_deck(&setup->deck, &r->good);
    /* modulated switches are made for a voltage that only their scene names */
    bool known = !vs_deck_has_port(&setup->deck, vs_port_is_modulated);
    for (size_t p = 0; known && p < setup->deck.n_parts; p++)
      if (vs_parts_below_mains(&setup->deck, p, setup->timeline.supply.voltage_v, text,
                               sizeof text))
        vs_fail_at(vs_warnings_add(&r->warnings), (vs_where){.file = setup->deck.files[0]}, "%s",
                   text);
    vs_warnings_of_netlist(&setup->deck, &r->warnings);
    vs_warnings_of_limits(&setup->deck, &r->warnings);
    warn_of_deck(r, &setup->deck);
  }
  vs_setup_free(setup);
  free(setup);
  return try_deep(r, true, status, err);
}

/* Checks the machine's own set, where it has one. */
static vs_status check_own_instruments(const vs_setup *setup, vs_error *err) {
  if (!vs_tree_child(setup->machine->tree.root, "instruments")) return VS_OK;
  vs_instruments *all = vs_alloc(1, sizeof *all);
  const vs_node section = vs_tree_word("instruments", "", (vs_where){0});
  const vs_frame frame = vs_sim_frame(vs_tiers_automatic(true), setup);
  vs_status status = vs_instruments_read(&section, setup, &frame, all, err);
  vs_instruments_free(all);
  free(all);
  return status;
}

/* A machine is checked in the scene that names it and nothing else. */
static vs_status check_machine(report *r, vs_error *err) {
  const vs_check_options *o = r->options;
  if (o->n_sets)
    return vs_fail(err, VS_INPUT, "--set %s: a machine has no keys to set; check a scene with it",
                   o->sets[0]);
  vs_node model = vs_tree_word(vs_machine_key.key, o->name, (vs_where){0});
  vs_node machine = vs_tree_map("machine", &model);
  const vs_node scene = vs_tree_map(NULL, &machine);
  vs_setup *setup = vs_alloc(1, sizeof *setup);
  vs_status status = vs_setup_build(&scene, setup, err);
  const vs_machine *m = setup->machine;
  if (!status && !vs_error_count(err)) status = check_own_instruments(setup, err);
  if (!status && !vs_error_count(err))
    /* the section's first key is `model`, the others are the machine's parameters */
    vs_text_add(&r->good, "a good machine: %s%s%d coordinate%s, %zu parameter%s, %d probe%s",
                m->title, *m->title ? "; " : "", m->dof, m->dof == 1 ? "" : "s",
                m->section.count - 1, m->section.count == 2 ? "" : "s", m->n_probes,
                m->n_probes == 1 ? "" : "s");
  vs_setup_free(setup);
  free(setup);
  return status;
}

/* Of a part's file its own lines are checked, and what it does on the bench. What a deck asks of
 * the part is found with the deck. */
static vs_status check_part(report *r, vs_error *err) {
  vs_deck *part = vs_alloc(1, sizeof *part);
  vs_status status = vs_netlist_read_part(r->options->name, part, err);
  if (!status && !vs_error_count(err) && !part->n_part_files)
    status =
        vs_fail_at(err, (vs_where){r->options->name, 1, 1}, "has no line '*$ part KIND \"TEXT\"'");
  if (!status && !vs_error_count(err))
    vs_text_add(&r->good, "a good part: %s, %s; %zu limits, %zu parameters",
                part->part_files[0].kind, part->part_files[0].text, part->n_limits,
                part->section.count - 1);
  for (size_t k = 0, left = 0; r->good.length && k < part->n_limits; k++)
    if (vs_parts_limit_is_left(part, &part->limits[k]))
      vs_text_add(&r->good, "%s%s", left++ ? ", " : "; nothing is held to ", part->limits[k].name);
  if (!status && !vs_error_count(err)) {
    vs_warnings_of_netlist(part, &r->warnings);
    vs_warnings_of_limits(part, &r->warnings);
  }
  vs_deck_free(part);
  free(part);
  if (status || vs_error_count(err) || !r->options->bench) return status;
  r->bench.warnings = &r->warnings;
  return r->options->bench(r->options, &r->bench, err);
}

/* Endings of decks, as programs of all kinds write them. */
static const char *const DECKS[] = {".cir", ".net", ".sp", ".ckt", ".spi", ".spice"};

/* Of a library its own lines are checked. One that has an EVA or a port is a deck. */
static vs_status check_library(report *r, vs_error *err) {
  vs_deck *library = vs_alloc(1, sizeof *library);
  size_t subcircuits = 0, models = 0;
  vs_status status = vs_netlist_read_library(r->options->name, library, err);
  bool is_deck = *library->eva || library->n_ports;
  const vs_cards *cards = vs_deck_cards(library);
  for (size_t k = 0; k < cards->n_definitions; k++) {
    subcircuits += cards->definition[k].kind == VS_CARDS_SUBCKT;
    models += cards->definition[k].kind == VS_CARDS_MODEL;
  }
  if (!status && !vs_error_count(err) && !is_deck) {
    vs_text_add(&r->good,
                "a good library: %zu subcircuit%s, %zu model%s; what ngspice says of them is seen "
                "with a deck that uses them",
                subcircuits, subcircuits == 1 ? "" : "s", models, models == 1 ? "" : "s");
    vs_warnings_of_netlist(library, &r->warnings);
  }
  vs_deck_free(library);
  free(library);
  return status || vs_error_count(err) || !is_deck ? status : check_deck(r, err);
}

static bool has_ending(const char *name, const char *ending) {
  size_t n = strlen(name), m = strlen(ending);
  return n > m && !strcmp(name + n - m, ending);
}

/* True for a file whose keys are a machine's. */
static bool is_machine(const char *name) {
  vs_tree tree = {0};
  vs_error unread = {0};
  bool is = !vs_tree_read(name, &tree, &unread) && vs_machine_file_has_keys(&tree);
  vs_tree_free(&tree);
  return is;
}

/* The name's ending says which kind of file it is, and of a YAML file its keys. A name without one
 * is looked for among the scenes that come with the program, then among decks, machines and parts.
 */
static vs_status check_by_kind(report *r, vs_error *err) {
  const char *name = r->options->name;
  char path[VS_PATH_SIZE];
  vs_error none = {0};
  if (r->options->other) return r->options->other(r->options, &r->good, err);
  for (size_t k = 0; k < sizeof DECKS / sizeof *DECKS; k++)
    if (has_ending(name, DECKS[k])) return check_deck(r, err);
  if (has_ending(name, ".lib")) return check_library(r, err);
  if (has_ending(name, ".inc")) return check_part(r, err);
  if (has_ending(name, ".tab"))
    return vs_fail_at(err, (vs_where){.file = name},
                      "a table of parts is checked row by row: check '%s#NAME'", name);
  if (is_machine(name)) return check_machine(r, err);
  if (has_ending(name, ".yaml") || has_ending(name, ".yml") ||
      !vs_path_find(&vs_scene_shelf, name, (vs_where){0}, path, &none))
    return check_scene(r, err);
  if (!vs_path_find(&vs_deck_shelf, name, (vs_where){0}, path, &none)) return check_deck(r, err);
  if (!vs_path_find(&vs_machine_shelf, name, (vs_where){0}, path, &none))
    return check_machine(r, err);
  if (vs_catalogue_is_row(name) || vs_catalogue_shipped(&vs_deck_parts_shelf, name, path)) {
    r->named = *r->options;
    if (!vs_catalogue_is_row(name)) r->named.name = r->part = vs_copy(path);
    r->options = &r->named;
    return check_part(r, err);
  }
  vs_status status =
      vs_error_keep(err, vs_path_find(&vs_scene_shelf, name, (vs_where){0}, path, err));
  return status ? status : vs_path_find(&vs_deck_shelf, name, (vs_where){0}, path, err);
}

/* Prints mistakes, warnings and what the bench saw as one array. */
static void print_findings_json(const report *r, const vs_findings *all) {
  vs_text text = {0};
  vs_json json = vs_json_new(&text);
  bool any = all->count || r->warnings.count || r->bench.rows.text || *vs_self_test_text();
  vs_json_array(&json, NULL, any ? VS_JSON_LINES : VS_JSON_ROW);
  for (size_t k = 0; k < all->count; k++)
    add_finding_json(r->options->name, &all->item[k], NULL, &json);
  for (size_t k = 0; k < r->warnings.count; k++)
    add_finding_json(r->options->name, &r->warnings.item[k], "warning", &json);
  vs_error library = {0};
  if (*vs_self_test_text()) {
    vs_fail(&library, VS_RUN, "%s", vs_self_test_text());
    add_finding_json(r->options->name, &library, "warning", &json);
  }
  char *rows = vs_copy(r->bench.rows.text ? r->bench.rows.text : ""), *rest = rows;
  for (char *row; (row = strsep(&rest, "\n"));)
    if (*row) {
      vs_json_key(&json, NULL);
      vs_text_add(&text, "%s", row);
    }
  vs_json_end(&json);
  puts(text.text);
  free(rows);
  vs_text_free(&text);
}

/* Reads the file to its end, and takes the first step of a run and no more. Prints all findings to
 * standard error, each with its line of the file, or as JSON to standard output. Without findings
 * it prints one line that describes the file, and warnings, and of a part what the bench found.
 * Errors: VS_INPUT where there are findings, with an empty err, or with one line more where there
 * were too many to keep; VS_RUN where a part does not do what its file asks. */
static vs_status check_and_tell(const vs_check_options *o, vs_error *err) {
  vs_findings *all = vs_alloc(1, sizeof *all);
  report r = {.options = o};
  vs_error own = {.findings = all};
  vs_status status = vs_error_keep(&own, check_by_kind(&r, &own));
  if (o->deep && !r.may_try)
    vs_text_add(&r.bench.table, "\nnothing is tried: --deep tries a scene or a deck");
  for (size_t k = 0; k < all->count && !o->json; k++) print_finding(o->name, "", &all->item[k]);
  for (size_t k = 0; k < r.warnings.count && !o->quiet; k++)
    print_finding(o->name, "warning: ", &r.warnings.item[k]);
  if (o->json)
    print_findings_json(&r, all);
  else if (!status && !all->count && !o->quiet)
    printf("%s: %s%s\n", o->name, r.good.text, r.bench.table.text ? r.bench.table.text : "");
  if (status == VS_INPUT) vs_fail(err, status, "%s: and more than these", o->name); /* no room */
  if (status && status != VS_INPUT) vs_fail(err, status, "%s", own.text);
  if (!status && all->count) status = VS_INPUT;
  if (!status && r.bench.off)
    status = vs_fail(err, VS_RUN, "%s: %zu of %zu figures are not what is asked", o->name,
                     r.bench.off, r.bench.figures);
  vs_text_free(&r.bench.table);
  vs_text_free(&r.bench.rows);
  vs_text_free(&r.good);
  free(r.part);
  vs_warnings_free(&r.warnings);
  free(all);
  return status;
}

/* ---- the command line ---- */

typedef struct check_line {
  vs_arguments common;
  bool deep;
} check_line;

static vs_status check_study(const vs_check_options *o, vs_text *good, vs_error *err) {
  return vs_study_check_read(o, vs_methods_all, good, err);
}

/* A file is read more than once: for its kind, for what it says, for the lines that messages quote.
 * A pipe gives its text once. /dev/stdin of a file is called as the file is, whose ending tells the
 * kind; `path` has room for that. */
static vs_status find_named_file(const char **name, char path[VS_PATH_SIZE], vs_error *err) {
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

static vs_status check_command(const void *given, vs_error *err) {
  const check_line *line = given;
  const vs_arguments *a = &line->common;
  const char *name = vs_command_name(a);
  char path[VS_PATH_SIZE];
  vs_status status = find_named_file(&name, path, err);
  if (status) return status;
  const vs_check_options o = {.name = name,
                              .sets = a->sets,
                              .n_sets = a->n_sets,
                              .json = a->json,
                              .quiet = a->quiet,
                              .bench = vs_acceptance_try,
                              .look = vs_hint_look,
                              .deep = line->deep,
                              .trial = vs_hint_try,
                              .folder = a->output,
                              .other = vs_fit_problem_is(name) ? vs_fit_command_check
                                       : vs_study_check_is_study(name, vs_methods_all) ? check_study
                                                                                       : NULL};
  return check_and_tell(&o, err);
}

static const vs_option CHECK_OPTIONS[] = {
    VS_OPTIONS_SET,
    VS_OPTIONS_OUTPUT("DIR",
                      "of a part: writes what was asked and what the bench got as bench.csv and "
                      "bench.json there, and draws bench.png"),
    VS_OPTIONS_FLAG(check_line, deep, "deep",
                    "of a scene or deck: also tries the beginning of its run, with each of the "
                    "solver's rules, and tells what was measured and what may help"),
    VS_OPTIONS_FLAG(vs_arguments, json, "json",
                    "findings as a JSON array of {file, line, column, message} on standard output; "
                    "of a part also each figure of the bench, with further members"),
    VS_OPTIONS_FLAG(vs_arguments, quiet, "quiet", "prints nothing but findings"),
    VS_OPTIONS_JAIL,
    VS_OPTIONS_END};

const vs_command vs_check_cli = {
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
    .size = sizeof(check_line),
    .run = check_command};
