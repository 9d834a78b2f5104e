/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command line: one table of commands, one parser for their options. */
#include <argp.h>
#include <errno.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_version.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/leave.h"
#include "base/text.h"
#include "base/units.h"
#include "command/check.h"
#include "command/export.h"
#include "command/list.h"
#include "command/modes.h"
#include "command/plot.h"
#include "command/run.h"
#include "method/methods.h"
#include "report/report.h"
#include "solver/circuit.h"
#include "solver/ng.h"
#include "study/merge.h"
#include "study/study.h"
#include "survey/folder.h"
#include "validate/validate.h"

typedef struct arguments {
  const struct command *command;
  const char *name; /* what stands behind the command: a scene, a kind, a folder */
  const char *tier, *output, *deck, *overlay;
  char **sets;
  size_t n_sets;
  bool json, quiet, reproducible, raw, list, help;
  int digits;
  char **names; /* what stands behind a command that takes several */
  size_t n_names;
  const char *shard;
  bool resume, overwrite, keep_runs, progress_json;
  int jobs;
  double timeout_s;
  vs_error err; /* of the parser */
} arguments;

static vs_status do_run(const arguments *a, vs_error *err) {
  const vs_run_options o = {.scene = a->name,
                            .tier = a->tier,
                            .folder = a->output,
                            .sets = a->sets,
                            .n_sets = a->n_sets,
                            .json = a->json,
                            .quiet = a->quiet,
                            .reproducible = a->reproducible,
                            .raw = a->raw,
                            .digits = a->digits,
                            .stop = &vs_leave_requested};
  return vs_run_command(&o, err);
}
static vs_status check_study(const vs_check_options *o, vs_text *good, vs_error *err) {
  return vs_study_check(o, vs_methods_all, good, err);
}
static vs_status do_check(const arguments *a, vs_error *err) {
  const vs_check_options o = {.name = a->name,
                              .sets = a->sets,
                              .n_sets = a->n_sets,
                              .json = a->json,
                              .quiet = a->quiet,
                              .other = vs_study_is(a->name, vs_methods_all) ? check_study : NULL};
  return vs_check_command(&o, err);
}
static vs_status do_list(const arguments *a, vs_error *err) {
  return vs_list_command(a->name, a->deck, err);
}
static vs_status do_modes(const arguments *a, vs_error *err) {
  return vs_modes_command(a->name, a->sets, a->n_sets, a->output, a->json, err);
}
static vs_status do_export(const arguments *a, vs_error *err) {
  if (!a->output)
    return vs_fail(err, VS_INPUT, "export: wants -o FILE; see vibrospice export --help");
  return vs_export_command(a->name, a->sets, a->n_sets, a->output, err);
}
static vs_status do_plot(const arguments *a, vs_error *err) {
  const vs_plot_options o = {a->name, a->output, a->overlay, a->quiet};
  return vs_folder_here(a->name) ? vs_report_command(&o, vs_methods_all, err)
                                 : vs_plot_command(&o, err);
}
static vs_status do_validate(const arguments *a, vs_error *err) {
  const vs_validate_options o = {.word = a->name,
                                 .json = a->json,
                                 .quiet = a->quiet,
                                 .list = a->list,
                                 .stop = &vs_leave_requested};
  return vs_validate_command(&o, err);
}
static vs_status do_study(const arguments *a, vs_error *err) {
  const vs_study_options o = {.name = a->name,
                              .methods = vs_methods_all,
                              .folder = a->output,
                              .sets = a->sets,
                              .n_sets = a->n_sets,
                              .jobs = a->jobs,
                              .shard = a->shard,
                              .resume = a->resume,
                              .overwrite = a->overwrite,
                              .keep_runs = a->keep_runs,
                              .progress_json = a->progress_json,
                              .quiet = a->quiet,
                              .timeout_s = a->timeout_s,
                              .stop = &vs_leave_requested};
  return vs_study_command(&o, err);
}
static vs_status do_merge(const arguments *a, vs_error *err) {
  const vs_merge_options o = {a->names, a->n_names, a->output, a->overwrite, a->quiet};
  return vs_merge_command(&o, err);
}

enum {
  KEY_JSON = 256,
  KEY_QUIET,
  KEY_REPRODUCIBLE,
  KEY_DIGITS,
  KEY_RAW,
  KEY_SET,
  KEY_TIER,
  KEY_DECK,
  KEY_OVERLAY,
  KEY_LIST,
  KEY_JOBS,
  KEY_SHARD,
  KEY_RESUME,
  KEY_OVERWRITE,
  KEY_TIMEOUT,
  KEY_PROGRESS,
  KEY_KEEP
};
#define OPT_HELP                                                                                   \
  { "help", 'h', NULL, 0, "prints this and ends", -1 }
#define OPT_SET                                                                                    \
  {                                                                                                \
    "set", KEY_SET, "KEY=VALUE", 0,                                                                \
        "sets a scene key over what the file says; may stand several times", 0                     \
  }
#define OPT_JSON                                                                                   \
  { "json", KEY_JSON, NULL, 0, "JSON on standard output instead of the table", 0 }
#define OPT_QUIET                                                                                  \
  { "quiet", KEY_QUIET, NULL, 0, "no table, no warnings, no progress", 0 }

static const struct argp_option RUN_OPTIONS[] = {
    OPT_SET,
    {"tier", KEY_TIER, "NAME", 0, "auto, analytic, switched or circuit; over the scene's run.tier",
     0},
    {"output", 'o', "DIR", 0, "writes run.csv, events.csv and summary.json there", 0},
    OPT_JSON,
    OPT_QUIET,
    {"reproducible", KEY_REPRODUCIBLE, NULL, 0, "leaves the cost (wall time) out of summary.json",
     0},
    {"digits", KEY_DIGITS, "N", 0, "significant digits in CSV, 1 to 17 (default 9; 17 is exact)",
     0},
    {"raw", KEY_RAW, NULL, 0,
     "tier circuit, with -o: writes run.raw too, every voltage and current of the circuit at every "
     "step, for ngspice's 'load'; a run that fails leaves run.partial.raw",
     0},
    OPT_HELP,
    {0}};
static const struct argp_option CHECK_OPTIONS[] = {
    OPT_SET,
    {"json", KEY_JSON, NULL, 0,
     "findings as a JSON array of {file, line, column, message} on standard output", 0},
    {"quiet", KEY_QUIET, NULL, 0, "prints nothing but findings", 0},
    OPT_HELP,
    {0}};
static const struct argp_option LIST_OPTIONS[] = {
    {"deck", KEY_DECK, "DECK", 0, "whose probes and parameters (default halfwave_snubbed)", 0},
    OPT_HELP,
    {0}};
static const struct argp_option MODES_OPTIONS[] = {
    OPT_SET,
    {"output", 'o', "DIR", 0,
     "writes modes.csv and the state space there: A.csv, B.csv, C.csv, D.csv", 0},
    OPT_JSON,
    OPT_HELP,
    {0}};
static const struct argp_option EXPORT_OPTIONS[] = {
    OPT_SET, {"output", 'o', "FILE", 0, "writes the netlist there", 0}, OPT_HELP, {0}};
static const struct argp_option PLOT_OPTIONS[] = {
    {"output", 'o', "FILE", 0,
     "one sheet (of a study, the first picture) into FILE, which ends in .png or .svg, instead of "
     "the set in DIR",
     0},
    {"overlay", KEY_OVERLAY, "FILE", 0,
     "draws measured curves over the computed ones: a CSV file, t_s or t_ms first, then columns "
     "named as in run.csv, also in other units (p_mm, i_ma)",
     0},
    OPT_QUIET,
    OPT_HELP,
    {0}};

static const struct argp_option VALIDATE_OPTIONS[] = {
    {"list", KEY_LIST, NULL, 0, "names the checks and does none", 0},
    OPT_JSON,
    {"quiet", KEY_QUIET, NULL, 0, "says only what is off", 0},
    OPT_HELP,
    {0}};
static const struct argp_option STUDY_OPTIONS[] = {
    OPT_SET,
    {"output", 'o', "DIR", 0,
     "writes study.csv, failures.csv and manifest.json there; without it study.csv goes to "
     "standard output",
     0},
    {"jobs", KEY_JOBS, "N", 0, "worker processes (default: the cores this process may use)", 0},
    {"shard", KEY_SHARD, "I/N", 0,
     "only every N-th case, from the I-th on; auto: by the variables of a Slurm job array", 0},
    {"resume", KEY_RESUME, NULL, 0, "goes on with what DIR has; begins where there is nothing", 0},
    {"overwrite", KEY_OVERWRITE, NULL, 0,
     "replaces what another study, or this one, has left in DIR; else that is refused", 0},
    {"case-timeout", KEY_TIMEOUT, "T", 0,
     "a case that takes longer fails (default 3600 s; 0: none does)", 0},
    {"progress", KEY_PROGRESS, "json", 0, "a line of JSON a second on standard output", 0},
    {"keep", KEY_KEEP, "runs", 0, "stores each case's run.csv as DIR/runs/CASE/run.csv", 0},
    {"quiet", KEY_QUIET, NULL, 0, "no table, no progress", 0},
    OPT_HELP,
    {0}};
static const struct argp_option MERGE_OPTIONS[] = {
    {"output", 'o', "DIR", 0, "writes the whole study there (default: the one DIR named)", 0},
    {"overwrite", KEY_OVERWRITE, NULL, 0, "over another study's result, too; else that is refused",
     0},
    {"quiet", KEY_QUIET, NULL, 0, "prints nothing", 0},
    OPT_HELP,
    {0}};

static const struct command {
  const char *name, *argument, *text, *examples;
  bool may_be_alone;
  const struct argp_option *options;
  vs_status (*act)(const arguments *, vs_error *);
  bool takes_many; /* arguments */
} COMMANDS[] = {
    {"run", "SCENE",
     "runs one scene; SCENE is a file, or the name of one that comes with the program",
     "  vibrospice run paper --tier circuit -o out\n"
     "  vibrospice run paper --set firing.angle=95deg --set circuit.r1=220ohm\n"
     "  vibrospice run my.yaml --json --quiet > result.json\n",
     false, RUN_OPTIONS, do_run, false},
    {"check", "FILE",
     "tells all that can be known of a scene or deck before a run: every mistake, with its line",
     "  vibrospice check my.yaml\n"
     "  vibrospice check my.cir\n"
     "  vibrospice check paper --set run.tier=circuit --json\n",
     false, CHECK_OPTIONS, do_check, false},
    {"list", "[KIND]",
     "lists scenes, decks, parts, tiers, probes, measures, parameters (with unit, default, range)",
     "  vibrospice list parameters\n  vibrospice list probes --deck my.cir\n", true, LIST_OPTIONS,
     do_list, false},
    {"modes", "SCENE", "prints eigenfrequencies, damping and shapes; exports the state space",
     "  vibrospice modes paper\n  vibrospice modes paper --set machine.m14=derived -o modes\n",
     false, MODES_OPTIONS, do_modes, false},
    {"export", "SCENE",
     "writes one netlist for plain ngspice: the scene's circuit tier, with the machine in it",
     "  vibrospice export paper -o paper.cir && ngspice -b paper.cir\n"
     "  vibrospice export my.yaml --set run.until=0.1s -o my.cir\n",
     false, EXPORT_OPTIONS, do_export, false},
    {"plot", "DIR",
     "draws a run, as PNG and SVG: displacements, accelerations, force, current and voltage; or a "
     "study: report.html and its pictures as PNG",
     "  vibrospice plot out\n  vibrospice plot out -o sheet.svg --overlay measured.csv\n", false,
     PLOT_OPTIONS, do_plot, false},
    {"validate", "[WORD]",
     "compares with closed forms and reference solutions, and tier with tier, each with its error; "
     "WORD: only checks whose names have it",
     "  vibrospice validate\n  vibrospice validate snubber\n  vibrospice validate --json\n", true,
     VALIDATE_OPTIONS, do_validate, false},
    {"study", "STUDY",
     "runs many scenes: what a study file varies, samples or looks for, one row a case",
     "  vibrospice study snubber_map -o map && vibrospice plot map\n"
     "  vibrospice study my.yaml --shard 2/7 -o shards/2\n"
     "  vibrospice study my.yaml --resume -o map\n",
     false, STUDY_OPTIONS, do_study, false},
    {"merge", "DIR...",
     "joins the shards of one study; DIR: a shard's folder, or one that holds such",
     "  vibrospice merge shards\n  vibrospice merge one two three -o whole\n", false, MERGE_OPTIONS,
     do_merge, true},
};
enum { N_COMMANDS = sizeof COMMANDS / sizeof *COMMANDS };

static error_t fail(arguments *a, const char *what, const char *word) {
  vs_fail(&a->err, VS_INPUT, "%s: %s '%s'; see vibrospice %s --help", a->command->name, what, word,
          a->command->name);
  return EINVAL;
}

static error_t fail_with(arguments *a, const char *text) {
  vs_fail(&a->err, VS_INPUT, "%s", text);
  return EINVAL;
}

/* Those of study. */
static error_t parse_study_option(int key, char *value, arguments *a) {
  char *end, why[256];
  switch (key) {
  case KEY_SHARD:
    a->shard = value;
    return 0;
  case KEY_RESUME:
    a->resume = true;
    return 0;
  case KEY_OVERWRITE:
    a->overwrite = true;
    return 0;
  case KEY_JOBS:
    a->jobs = (int)strtol(value, &end, 10);
    if (!*value || *end || a->jobs < 1 || a->jobs > 4096)
      return fail_with(a, "--jobs: allowed: 1 to 4096");
    return 0;
  case KEY_TIMEOUT:
    if (!vs_units_read(value, "s", &a->timeout_s, why, sizeof why) || a->timeout_s < 0) {
      vs_fail(&a->err, VS_INPUT, "--case-timeout %s: a time is wanted, as 20s", value);
      return EINVAL;
    }
    return 0;
  case KEY_PROGRESS:
    a->progress_json = true;
    return strcmp(value, "json") ? fail_with(a, "--progress: there is: json") : 0;
  case KEY_KEEP:
    a->keep_runs = true;
    return strcmp(value, "runs") ? fail_with(a, "--keep: there is: runs") : 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static error_t parse_option(int key, char *value, struct argp_state *state) {
  arguments *a = state->input;
  char *end;
  switch (key) {
  case KEY_SET:
    a->sets[a->n_sets++] = value;
    return 0;
  case KEY_TIER:
    a->tier = value;
    return 0;
  case KEY_DECK:
    a->deck = value;
    return 0;
  case KEY_OVERLAY:
    a->overlay = value;
    return 0;
  case KEY_JSON:
    a->json = true;
    return 0;
  case KEY_QUIET:
    a->quiet = true;
    return 0;
  case KEY_REPRODUCIBLE:
    a->reproducible = true;
    return 0;
  case KEY_RAW:
    a->raw = true;
    return 0;
  case KEY_LIST:
    a->list = true;
    return 0;
  case 'h':
    a->help = true;
    return 0;
  case 'o':
    a->output = value;
    return 0;
  case KEY_DIGITS:
    a->digits = (int)strtol(value, &end, 10);
    if (!*value || *end || a->digits < 1 || a->digits > 17) {
      vs_fail(&a->err, VS_INPUT, "--digits %s: allowed: 1 to 17", value);
      return EINVAL;
    }
    return 0;
  case ARGP_KEY_ARG:
    if (a->name && !a->command->takes_many) return fail(a, "one argument too many:", value);
    a->name = value;
    a->names[a->n_names++] = value;
    return 0;
  case ARGP_KEY_END:
    if (!a->name && !a->command->may_be_alone && !a->help)
      return fail(a, "wants one argument:", a->command->argument);
    return 0;
  case ARGP_KEY_ERROR: /* getopt's own, if nobody said anything yet */
    if (!*a->err.text)
      fail(a, "unknown option, or one that lacks its argument:", state->argv[state->next - 1]);
    return 0;
  default:
    return parse_study_option(key, value, a);
  }
}

static void print_version(FILE *out) {
  fprintf(out, "vibrospice %s (ngspice %s, GSL %s)\n", VS_VERSION, vs_ng_version(), gsl_version);
}

static void print_help(FILE *out) {
  fputs("Usage: vibrospice COMMAND ...\n"
        "Co-simulates a resonant electromagnetic vibratory conveyor with its thyristor "
        "converter.\n\n",
        out);
  for (size_t k = 0; k < N_COMMANDS; k++)
    fprintf(out, "  %-8s %-7s %s\n", COMMANDS[k].name, COMMANDS[k].argument, COMMANDS[k].text);
  fputs("\nvibrospice COMMAND --help says more. Examples:\n", out);
  for (size_t k = 0; k < N_COMMANDS; k++) fputs(COMMANDS[k].examples, out);
  fputs("\nExit status:", out);
#define EXIT_TEXT(name, status, text) fprintf(out, " %d %s.", status, text);
  VS_STATUS_LIST(EXIT_TEXT)
#undef EXIT_TEXT
  fputs("\nShipped files are looked up in $VIBROSPICE_PATH, then beside the program.\n", out);
}

/* What a study file may ask for. */
static void add_methods(vs_text *doc) {
  vs_text_add(doc, "\nA study has, besides scene, set and report:\n");
  for (const vs_method *const *m = vs_methods_all; *m; m++)
    vs_text_add(doc, "  %-8s %-12s %s\n", (*m)->key, (*m)->name, (*m)->text);
}

static const struct command *find_command(const char *word) {
  const char *names[N_COMMANDS];
  for (size_t k = 0; k < N_COMMANDS; k++) {
    if (!strcmp(word, COMMANDS[k].name)) return &COMMANDS[k];
    names[k] = COMMANDS[k].name;
  }
  const char *nearest = vs_text_nearest(word, names, N_COMMANDS);
  fprintf(stderr, "vibrospice: no command '%s'%s%s%s\n", word,
          nearest ? "; did you mean '" : "; see vibrospice --help", nearest ? nearest : "",
          nearest ? "'?" : "");
  return NULL;
}

int main(int argc, char **argv) {
  gsl_set_error_handler_off();
  if (argc < 2) {
    print_help(stderr);
    return VS_INPUT;
  }
  if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h") || !strcmp(argv[1], "-?") ||
      !strcmp(argv[1], "help")) {
    print_help(stdout);
    return VS_OK;
  }
  if (!strcmp(argv[1], "--version") || !strcmp(argv[1], "-V")) {
    print_version(stdout);
    return VS_OK;
  }
  const struct command *command = find_command(argv[1]);
  if (!command) return VS_INPUT;
  vs_leave_begin();
  signal(SIGXFSZ, SIG_IGN); /* a file that may not grow is an error to report, like a full disk */

  arguments a = {.command = command,
                 .digits = 9,
                 .timeout_s = 3600,
                 .sets = vs_alloc((size_t)argc, sizeof(char *)),
                 .names = vs_alloc((size_t)argc, sizeof(char *))};
  vs_text doc = {0}, program = {0};
  vs_text_add(&doc,
              "%s\v"
              "Examples:\n%s",
              command->text, command->examples);
  if (command->act == do_study) add_methods(&doc);
  vs_text_add(&program, "vibrospice %s", command->name);
  argv[1] = program.text; /* argp's name for the program in its messages */
  const struct argp parser = {
      command->options, parse_option, command->argument, doc.text, NULL, NULL, NULL};
  error_t failed = argp_parse(&parser, argc - 1, argv + 1, ARGP_NO_ERRS | ARGP_NO_HELP, NULL, &a);
  vs_status status = failed ? VS_INPUT : VS_OK;
  if (!failed && a.help)
    argp_help(&parser, stdout, ARGP_HELP_USAGE | ARGP_HELP_LONG | ARGP_HELP_DOC, program.text);
  else if (!failed)
    status = command->act(&a, &a.err);
  if (status && *a.err.text) fprintf(stderr, "vibrospice: %s\n", a.err.text);
  if (!status && (fflush(stdout) || ferror(stdout))) {
    fputs("vibrospice: standard output cannot be written\n", stderr);
    status = VS_RUN;
  }
  vs_text_free(&doc);
  vs_text_free(&program);
  free(a.sets);
  free(a.names);
  return (int)status;
}
