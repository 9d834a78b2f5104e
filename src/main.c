/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command line: the table of commands, each with its options. */
#include <fcntl.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_version.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "acceptance/acceptance.h"
#include "acceptance/template.h"
#include "base/leave.h"
#include "branch/branch.h"
#include "branch/marks.h"
#include "closeup/closeup.h"
#include "command/check.h"
#include "command/command.h"
#include "command/export.h"
#include "command/modes.h"
#include "command/run.h"
#include "command/sensitivity.h"
#include "command/steady.h"
#include "compare/compare.h"
#include "digest/digest.h"
#include "guide/completion.h"
#include "guide/fresh.h"
#include "guide/list.h"
#include "guide/schema.h"
#include "guide/topics.h"
#include "hint/hint.h"
#include "import/import.h"
#include "inquiry/aims.h"
#include "inquiry/inquiry.h"
#include "method/methods.h"
#include "picture/plot.h"
#include "report/fitting.h"
#include "report/harmonics.h"
#include "report/report.h"
#include "report/tornado.h"
#include "solver/circuit.h"
#include "solver/ng.h"
#include "steady/steady.h"
#include "study/merge.h"
#include "study/study.h"
#include "survey/folder.h"
#include "validate/validate.h"

/* ---- run ---- */

/* What `run` and `steady` are asked for alike. */
static vs_run_options run_options(const vs_arguments *a) {
  return (vs_run_options){.scene = vs_command_name(a),
                          .tier = a->tier,
                          .folder = a->output,
                          .sets = a->sets,
                          .n_sets = a->n_sets,
                          .json = a->json,
                          .all = a->all,
                          .quiet = a->quiet,
                          .reproducible = a->reproducible,
                          .raw = a->raw,
                          .allow_code = a->allow_code,
                          .digits = a->digits,
                          .stop = &vs_leave_requested};
}

static vs_status run(const vs_arguments *a, vs_error *err) {
  const vs_run_options o = run_options(a);
  return vs_run_command(&o, err);
}

/* Options of both. */
#define TIER_OPTION                                                                                \
  VS_COMMAND_VALUE("tier", VS_KEY_TIER, "NAME", VS_TIER_WORDS "; over the scene's run.tier")
#define REPRODUCIBLE_OPTION                                                                        \
  VS_COMMAND_FLAG("reproducible", VS_KEY_REPRODUCIBLE,                                             \
                  "leaves the cost (wall time) out of summary.json")
#define ALL_OPTION                                                                                 \
  VS_COMMAND_FLAG("all", VS_KEY_ALL, "the table leaves nothing out: zeros, unknowns, doubles")
#define DIGITS_OPTION                                                                              \
  VS_COMMAND_VALUE("digits", VS_KEY_DIGITS, "N",                                                   \
                   "significant digits in CSV, 1 to 17 (default 9; 17 is exact)")

static const struct argp_option RUN_OPTIONS[] = {
    VS_COMMAND_SET,
    VS_COMMAND_UNTIL,
    VS_COMMAND_TOLERANCE,
    VS_COMMAND_ANGLE,
    TIER_OPTION,
    VS_COMMAND_VALUE("output", 'o', "DIR", "writes run.csv, events.csv and summary.json there"),
    VS_COMMAND_JSON,
    VS_COMMAND_QUIET,
    ALL_OPTION,
    REPRODUCIBLE_OPTION,
    DIGITS_OPTION,
    VS_COMMAND_FLAG("raw", VS_KEY_RAW,
                    "tier circuit, with -o: writes run.raw too, every voltage and current of the "
                    "circuit at every step, for ngspice's 'load'; a run that fails leaves "
                    "run.partial.raw"),
    VS_COMMAND_ALLOW_CODE,
    VS_COMMAND_HELP,
    {0}};

/* ---- steady ---- */

static vs_status steady(const vs_arguments *a, vs_error *err) {
  const vs_run_options o = run_options(a);
  const vs_branch_options branch = {&o, {a->along, a->step, a->at}, a->period};
  if ((a->step || a->at) && !a->along)
    return vs_fail(err, VS_INPUT, "--%s: it goes with --along; see vibrospice steady --help",
                   a->step ? "step" : "at");
  if (a->linear && a->along)
    return vs_fail(err, VS_INPUT, "--linear: it is about one orbit, and does not go with --along");
  return a->along ? vs_branch_command(&branch, err)
                  : vs_steady_command(&o, a->period, a->linear, err);
}

static void explain_steady(vs_text *help) {
  vs_text_add(help, "\nOver one period it reports, besides the measures of every run:\n");
  vs_steady_measure m;
  const vs_steady none = {0};
  for (int k = 0; vs_steady_at(&none, k, &m); k++)
    vs_text_add(help, "  %-17s %-2s %s\n", m.name, m.unit, m.text);
  vs_text_add(help, "  %-17s    %s\n  %-17s    %s\n", "reaction_NAME",
              "largest size of what springs and dampers do along the coordinate NAME",
              "reaction_NAME_rms", "its root mean square");
  vs_text_add(help, "With --along it reports, besides points of the branch:\n");
  for (const vs_mark_kind *const *kind = vs_mark_kinds; *kind; kind++)
    vs_text_add(help, "  %-17s    %s\n", (*kind)->name, (*kind)->text);
  vs_text_add(help,
              "Orbits are computed on tier %s alone; a scene that would take another one "
              "wants --tier %s.\n",
              vs_tiers_automatic(false)->name, vs_tiers_automatic(false)->name);
}

static const struct argp_option STEADY_OPTIONS[] = {
    VS_COMMAND_SET,
    VS_COMMAND_TOLERANCE,
    VS_COMMAND_ANGLE,
    TIER_OPTION,
    VS_COMMAND_VALUE("period", VS_KEY_PERIOD, "N",
                     "the orbit repeats after N firing periods, of firing.every cycles of the "
                     "mains each (default 1)"),
    VS_COMMAND_VALUE("along", VS_KEY_ALONG, "KEY=FROM..TO",
                     "follows the orbit over a scene key, around folds: where it grazes a stop, "
                     "turns, loses its stability"),
    VS_COMMAND_VALUE("at", VS_KEY_AT, "VALUE",
                     "with --along: reports every orbit of the branch at that value of the key"),
    VS_COMMAND_VALUE("step", VS_KEY_STEP, "S",
                     "the key's largest change from point to point (default a 50th of the range)"),
    VS_COMMAND_FLAG("linear", VS_KEY_LINEAR,
                    "linear models about the orbit, from the firing angle to the state at the next "
                    "firing and to the amplitude; with -o linear.json and linear_*.csv, too"),
    VS_COMMAND_VALUE("output", 'o', "DIR",
                     "writes run.csv of one period, events.csv and summary.json there; with "
                     "--along branch.csv, branch.json and branch.png"),
    VS_COMMAND_JSON,
    VS_COMMAND_QUIET,
    ALL_OPTION,
    REPRODUCIBLE_OPTION,
    DIGITS_OPTION,
    VS_COMMAND_HELP,
    {0}};

/* ---- sensitivity ---- */

static vs_status sensitivity(const vs_arguments *a, vs_error *err) {
  const vs_sensitivity_options o = {.scene = vs_command_name(a),
                                    .tier = a->tier,
                                    .sets = a->sets,
                                    .n_sets = a->n_sets,
                                    .of = a->of,
                                    .to = a->to,
                                    .steady = a->steady,
                                    .period = a->period,
                                    .folder = a->output,
                                    .json = a->json,
                                    .quiet = a->quiet,
                                    .allow_code = a->allow_code,
                                    .stop = &vs_leave_requested};
  vs_status status = vs_sensitivity_command(&o, err);
  vs_error why = {0};
  if (!status && a->output && vs_tornado_draw(a->output, a->quiet || a->json, &why))
    fprintf(stderr, "vibrospice: warning: there is no picture: %s\n", why.text);
  return status;
}

static const struct argp_option SENSITIVITY_OPTIONS[] = {
    VS_COMMAND_VALUE("of", VS_KEY_OF, "MEASURE,...", "of which measures"),
    VS_COMMAND_VALUE("to", VS_KEY_TO, "KEY,...", "with respect to which keys of the scene"),
    VS_COMMAND_FLAG("steady", VS_KEY_STEADY,
                    "of a period of the orbit (see steady), instead of the scene's run"),
    VS_COMMAND_VALUE("period", VS_KEY_PERIOD, "N",
                     "with --steady: of N firing periods (default 1)"),
    VS_COMMAND_SET,
    TIER_OPTION,
    VS_COMMAND_VALUE("output", 'o', "DIR",
                     "writes sensitivity.csv, summary.json and the picture tornado there"),
    VS_COMMAND_JSON,
    VS_COMMAND_QUIET,
    VS_COMMAND_ALLOW_CODE,
    VS_COMMAND_HELP,
    {0}};

/* ---- check ---- */

static vs_status check_study(const vs_check_options *o, vs_text *good, vs_error *err) {
  return vs_study_check(o, vs_methods_all, good, err);
}

static vs_status check(const vs_arguments *a, vs_error *err) {
  const char *name = vs_command_name(a);
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
                              .other = vs_inquiry_is(name)                 ? vs_fitting_check
                                       : vs_study_is(name, vs_methods_all) ? check_study
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
                    "of a part also each figure of the bench, with members more"),
    VS_COMMAND_FLAG("quiet", VS_KEY_QUIET, "prints nothing but findings"),
    VS_COMMAND_HELP,
    {0}};

/* ---- part ---- */

static vs_status part(const vs_arguments *a, vs_error *err) {
  const vs_template_options o = {vs_command_name(a), a->output, a->wrap, a->overwrite, a->quiet};
  return vs_template_command(&o, err);
}

static const struct argp_option PART_OPTIONS[] = {
    VS_COMMAND_VALUE("output", 'o', "NAME.inc", "writes the template there; NAME is the part's"),
    VS_COMMAND_VALUE("wrap", VS_KEY_WRAP, "FILE[:SUBCKT]",
                     "around the subcircuit of a vendor's file, instead of a model of the "
                     "program's own; of a thyristor, a varistor or a fuse"),
    VS_COMMAND_FLAG("overwrite", VS_KEY_OVERWRITE, "replaces a file that is there already"),
    VS_COMMAND_FLAG("quiet", VS_KEY_QUIET, "prints nothing"),
    VS_COMMAND_HELP,
    {0}};

/* ---- list, modes, export ---- */

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
  return vs_modes_command(vs_command_name(a), a->sets, a->n_sets, a->output, a->json, err);
}

static const struct argp_option MODES_OPTIONS[] = {
    VS_COMMAND_SET,
    VS_COMMAND_VALUE("output", 'o', "DIR",
                     "writes modes.csv and the state space there: A.csv, B.csv, C.csv, D.csv"),
    VS_COMMAND_JSON,
    VS_COMMAND_HELP,
    {0}};

static vs_status export(const vs_arguments *a, vs_error *err) {
  if (!a->output)
    return vs_fail(err, VS_INPUT, "export: wants -o FILE; see vibrospice export --help");
  return vs_export_command(vs_command_name(a), a->sets, a->n_sets, a->output, err);
}

static const struct argp_option EXPORT_OPTIONS[] = {
    VS_COMMAND_SET,
    VS_COMMAND_VALUE("output", 'o', "FILE", "writes the netlist there"),
    VS_COMMAND_HELP,
    {0}};

/* ---- plot ---- */

/* A run's close-up: what was asked for, or where an event of the scene begins. */
static vs_status close_up(const vs_arguments *a, vs_error *err) {
  const vs_closeup_options o = {.folders = a->names,
                                .n_folders = a->n_names,
                                .probes = a->probe,
                                .from = a->from,
                                .to = a->to,
                                .output = a->output,
                                .fft = a->fft,
                                .orbit = a->orbit,
                                .quiet = a->quiet};
  return vs_closeup_command(&o, err);
}

/* All pictures of a run. */
static vs_status plot_run(const vs_arguments *a, const vs_plot_options *o, vs_error *err) {
  vs_status status = vs_plot_command(o, err);
  if (status || a->output || a->overlay) return status;
  status = vs_harmonics_draw(o->folder, a->quiet, err);
  if (!status && vs_closeup_wanted(o->folder)) status = close_up(a, err);
  return status ? status : vs_digest_write(o->folder, a->quiet, err);
}

static vs_status plot(const vs_arguments *a, vs_error *err) {
  const char *folder = vs_command_name(a);
  const vs_plot_options o = {folder, a->output, a->overlay, a->quiet};
  bool close = a->n_names > 1 || a->probe || a->from || a->to || a->fft || a->orbit;
  if (close && a->overlay)
    return vs_fail(err, VS_INPUT,
                   "--overlay: it goes with the one folder alone, without --probe "
                   "and its like");
  for (size_t k = 0; close && k < a->n_names; k++)
    if (vs_folder_here(a->names[k]))
      return vs_fail(err, VS_INPUT, "%.500s holds a study; a close-up is of runs", a->names[k]);
  if (close) return close_up(a, err);
  if (vs_tornado_here(folder) && !a->output && !a->overlay)
    return vs_tornado_draw(folder, a->quiet, err);
  if (vs_folder_here(folder)) return vs_report_command(&o, vs_methods_all, err);
  return plot_run(a, &o, err);
}

static const struct argp_option PLOT_OPTIONS[] = {
    VS_COMMAND_VALUE("output", 'o', "FILE",
                     "one sheet (of a study, the first picture) into FILE, which ends in .png or "
                     ".svg, instead of the set in DIR"),
    VS_COMMAND_VALUE("probe", VS_KEY_PROBE, "NAME,...",
                     "of runs: one picture of these columns, named as in run.csv, with or without "
                     "unit; runs of several DIR lie over one another"),
    VS_COMMAND_VALUE("from", VS_KEY_FROM, "T",
                     "the picture's first instant, as 60ms (default: where something happens)"),
    VS_COMMAND_VALUE("to", VS_KEY_TO, "T", "its last instant"),
    VS_COMMAND_FLAG("fft", VS_KEY_FFT,
                    "the spectrum of the probes over the whole cycles of the mains in that time"),
    VS_COMMAND_FLAG("orbit", VS_KEY_ORBIT,
                    "each probe, a coordinate, and its rate over one another"),
    VS_COMMAND_VALUE("overlay", VS_KEY_OVERLAY, "FILE",
                     "draws measured curves over the computed ones: a CSV file, t_s or t_ms first, "
                     "then columns named as in run.csv, also in other units (p_mm, i_ma)"),
    VS_COMMAND_QUIET,
    VS_COMMAND_HELP,
    {0}};

/* ---- compare ---- */

static vs_status compare(const vs_arguments *a, vs_error *err) {
  if (a->n_names != 2)
    return vs_fail(err, VS_INPUT,
                   "compare: wants two folders, of two runs or of two studies; see vibrospice "
                   "compare --help");
  const vs_compare_options o = {a->names[0], a->names[1], a->json, a->quiet, vs_methods_all};
  return vs_compare_command(&o, err);
}

static const struct argp_option COMPARE_OPTIONS[] = {
    VS_COMMAND_JSON,
    VS_COMMAND_FLAG("quiet", VS_KEY_QUIET, "prints nothing"),
    VS_COMMAND_HELP,
    {0}};

/* ---- validate ---- */

static vs_status validate(const vs_arguments *a, vs_error *err) {
  const vs_validate_options o = {.word = vs_command_name(a),
                                 .json = a->json,
                                 .quiet = a->quiet,
                                 .list = a->list,
                                 .stop = &vs_leave_requested};
  return vs_validate_command(&o, err);
}

static const struct argp_option VALIDATE_OPTIONS[] = {
    VS_COMMAND_FLAG("list", VS_KEY_LIST, "names the checks and does none"),
    VS_COMMAND_JSON,
    VS_COMMAND_FLAG("quiet", VS_KEY_QUIET, "says only what is off"),
    VS_COMMAND_HELP,
    {0}};

/* ---- study, merge ---- */

static vs_status study(const vs_arguments *a, vs_error *err) {
  const vs_study_options o = {.name = vs_command_name(a),
                              .methods = vs_methods_all,
                              .folder = a->output,
                              .sets = a->sets,
                              .n_sets = a->n_sets,
                              .jobs = a->jobs,
                              .shard = a->shard,
                              .resume = a->resume,
                              .overwrite = a->overwrite,
                              .alone = a->no_sharing,
                              .keep_runs = a->keep_runs,
                              .progress_json = a->progress_json,
                              .quiet = a->quiet,
                              .allow_code = a->allow_code,
                              .timeout_s = a->timeout_s,
                              .stop = &vs_leave_requested};
  return vs_study_command(&o, err);
}

/* What a study file may ask for. */
static void explain_study(vs_text *help) {
  vs_text_add(help, "\nA study has, besides scene, set and report:\n");
  for (const vs_method *const *m = vs_methods_all; *m; m++)
    vs_text_add(help, "  %-8s %-12s %s\n", (*m)->key, (*m)->name, (*m)->text);
  vs_text_add(help, "  %-8s %-12s %s\n", "steady", "",
              "each case is one period of its orbit, as `vibrospice steady` finds it: true, or "
              "{period: N}");
}

static const struct argp_option STUDY_OPTIONS[] = {
    VS_COMMAND_SET,
    VS_COMMAND_VALUE("output", 'o', "DIR",
                     "writes study.csv, failures.csv and manifest.json there; without it study.csv "
                     "goes to standard output"),
    VS_COMMAND_VALUE("jobs", VS_KEY_JOBS, "N",
                     "worker processes (default: the cores this process may use)"),
    VS_COMMAND_VALUE("shard", VS_KEY_SHARD, "I/N",
                     "only every N-th case, from the I-th on; auto: by the variables of a Slurm "
                     "job array"),
    VS_COMMAND_FLAG("resume", VS_KEY_RESUME,
                    "goes on with what DIR has; begins where there is nothing"),
    VS_COMMAND_FLAG("overwrite", VS_KEY_OVERWRITE,
                    "replaces what another study, or this one, has left in DIR; else that is "
                    "refused"),
    VS_COMMAND_VALUE("case-timeout", VS_KEY_TIMEOUT, "T",
                     "a case that takes longer fails (default 3600 s; 0: none does)"),
    VS_COMMAND_VALUE("progress", VS_KEY_PROGRESS, "json",
                     "a line of JSON a second on standard output"),
    VS_COMMAND_VALUE("keep", VS_KEY_KEEP, "runs",
                     "stores each case's run.csv as DIR/runs/CASE/run.csv"),
    VS_COMMAND_FLAG("no-sharing", VS_KEY_ALONE,
                    "runs each case from its beginning, also where cases have the same past; the "
                    "results are the same"),
    VS_COMMAND_FLAG("quiet", VS_KEY_QUIET, "no table, no progress"),
    VS_COMMAND_ALLOW_CODE,
    VS_COMMAND_HELP,
    {0}};

static vs_status merge(const vs_arguments *a, vs_error *err) {
  const vs_merge_options o = {a->names, a->n_names, a->output, a->overwrite, a->quiet};
  return vs_merge_command(&o, err);
}

static const struct argp_option MERGE_OPTIONS[] = {
    VS_COMMAND_VALUE("output", 'o', "DIR",
                     "writes the whole study there (default: the one DIR named)"),
    VS_COMMAND_FLAG("overwrite", VS_KEY_OVERWRITE,
                    "over another study's result, too; else that is refused"),
    VS_COMMAND_FLAG("quiet", VS_KEY_QUIET, "prints nothing"),
    VS_COMMAND_HELP,
    {0}};

/* ---- fit ---- */

static vs_status fit(const vs_arguments *a, vs_error *err) {
  const vs_fitting_options o = {.name = vs_command_name(a),
                                .sets = a->sets,
                                .n_sets = a->n_sets,
                                .profile = a->profile,
                                .folder = a->output,
                                .json = a->json,
                                .quiet = a->quiet,
                                .allow_code = a->allow_code,
                                .digits = a->digits};
  return vs_fitting_command(&o, err);
}

static void explain_fit(vs_text *help) {
  vs_text_add(help, "\nBesides the measures of every run, and with steady: true those of steady, a "
                    "fit may use:\n");
  vs_aim_explain(help);
}

static const struct argp_option FIT_OPTIONS[] = {
    VS_COMMAND_SET,
    VS_COMMAND_VALUE("profile", VS_KEY_PROFILE, "KEY,...",
                     "the profile likelihood of these free keys, or of all: chi2 over the value, "
                     "all others fitted anew"),
    VS_COMMAND_VALUE("output", 'o', "DIR",
                     "writes fit.json, residuals.csv, profile.csv and a picture there"),
    VS_COMMAND_JSON,
    VS_COMMAND_QUIET,
    DIGITS_OPTION,
    VS_COMMAND_ALLOW_CODE,
    VS_COMMAND_HELP,
    {0}};

/* ---- import ---- */

static vs_status import(const vs_arguments *a, vs_error *err) {
  const vs_import_options o = {.name = vs_command_name(a),
                               .output = a->output,
                               .scene = a->scene,
                               .pins = a->pins,
                               .library = a->library,
                               .asked = {a->mains, a->gate, a->coil},
                               .json = a->json,
                               .quiet = a->quiet};
  return vs_import_command(&o, err);
}

static const struct argp_option IMPORT_OPTIONS[] = {
    VS_COMMAND_VALUE("output", 'o', "FILE.cir", "writes the deck there"),
    VS_COMMAND_VALUE("mains", VS_KEY_MAINS, "V1",
                     "the source that is the mains, or none (default: the only SIN)"),
    VS_COMMAND_VALUE("gate", VS_KEY_GATE, "V3[,V4]",
                     "the sources that fire thyristors, or none (default: the only PULSE); their "
                     "levels are kept"),
    VS_COMMAND_VALUE("coil", VS_KEY_COIL, "L1[+R4]",
                     "the inductor that is the EVA's coil, and its resistance in series (default: "
                     "the only inductor)"),
    VS_COMMAND_VALUE(
        "pins", VS_KEY_PINS, "X1=akg,...",
        "what an element is, by its pins in their order (akg thyristor, 21g triac, dgs "
        "mosfet, cge igbt, ak diode), or varistor, fuse, none"),
    VS_COMMAND_VALUE("library", VS_KEY_LIBRARY, "FILE", "a file of models besides the netlist's"),
    VS_COMMAND_VALUE("scene", VS_KEY_SCENE, "FILE.yaml",
                     "also writes a scene with the netlist's own mains, firing and coil"),
    VS_COMMAND_FLAG("json", VS_KEY_JSON, "what was done as JSON on standard output"),
    VS_COMMAND_FLAG("quiet", VS_KEY_QUIET, "does not say what was done"),
    VS_COMMAND_HELP,
    {0}};

/* ---- the table ---- */

static vs_status help(const vs_arguments *a, vs_error *err);
static vs_status completion(const vs_arguments *a, vs_error *err);

static const struct argp_option HELP_OPTIONS[] = {VS_COMMAND_HELP, {0}};

static const vs_command COMMANDS[] = {
    {.name = "run",
     .argument = "SCENE",
     .text = "runs one scene; SCENE is a file, or the name of one that comes with the program",
     .examples = "  vibrospice run paper --tier circuit -o out\n"
                 "  vibrospice run paper --angle 95deg --until 0.5s --set circuit.r1=220ohm\n"
                 "  vibrospice run my.yaml --json --quiet > result.json\n",
     .options = RUN_OPTIONS,
     .run = run},
    {.name = "steady",
     .argument = "SCENE",
     .text = "finds the periodic motion of a machine that is fired in every cycle: stability, "
             "power, harmonics, measures of one period",
     .examples = "  vibrospice steady paper --set firing.every=1\n"
                 "  vibrospice steady two_mass --set firing.every=1 --set firing.angle=130deg -o "
                 "work\n"
                 "  vibrospice steady paper --set firing.every=1 --linear -o model\n"
                 "  vibrospice steady paper --set firing.every=1 --along "
                 "firing.angle=130deg..70deg -o branch\n",
     .options = STEADY_OPTIONS,
     .run = steady,
     .explain = explain_steady},
    {.name = "sensitivity",
     .argument = "SCENE",
     .text = "logarithmic derivatives of measures with respect to keys of the scene, of its run or "
             "of its orbit, each with its error",
     .examples =
         "  vibrospice sensitivity paper --of p_first_peak --to firing.angle,supply.voltage\n"
         "  vibrospice sensitivity paper --steady --set firing.every=1 --of p_min,power_in --to "
         "firing.angle,actuator.gap -o tornado\n",
     .options = SENSITIVITY_OPTIONS,
     .run = sensitivity},
    {.name = "check",
     .argument = "FILE",
     .text =
         "tells all that can be known of a scene, study, fit, machine or deck before a run: every "
         "mistake, with its line; of a part also whether its model does what its file asks",
     .examples = "  vibrospice check my.yaml\n"
                 "  vibrospice check my.cir\n"
                 "  vibrospice check my.inc -o bench\n"
                 "  vibrospice check my.yaml --deep\n"
                 "  vibrospice check paper --set run.tier=circuit --json\n",
     .options = CHECK_OPTIONS,
     .run = check},
    {.name = "part",
     .argument = "[KIND]",
     .text =
         "writes a template of a part, to be filled in from its data sheet; without KIND: which "
         "kinds there are",
     .examples = "  vibrospice part thyristor -o my.inc && vibrospice check my.inc -o bench\n"
                 "  vibrospice part thyristor --wrap vendor.lib:NAME -o my.inc\n",
     .may_be_alone = true,
     .options = PART_OPTIONS,
     .run = part,
     .explain = vs_template_explain},
    {.name = "list",
     .argument = "[KIND [FILTER]]",
     .text =
         "lists scenes, studies, fits, machines, decks, parts, instruments, kinds, tiers, laws, "
         "regulators, probes, measures, "
         "parameters (with "
         "unit, default, range); FILTER: only what has that text",
     .examples = "  vibrospice list parameters\n  vibrospice list probes --deck my.cir\n"
                 "  vibrospice list parameters angle --json\n"
                 "  vibrospice list parameters --machine two_mass\n",
     .may_be_alone = true,
     .takes_many = true,
     .options = LIST_OPTIONS,
     .run = list},
    {.name = "new",
     .argument = "FILE",
     .text = "writes a scene that has every key, with its default, range and meaning, behind a '#'",
     .examples = "  vibrospice new my.yaml && vibrospice run my.yaml\n"
                 "  vibrospice new my.yaml --machine two_mass\n",
     .options = NEW_OPTIONS,
     .run = new},
    {.name = "schema",
     .argument = "[scene|study|machine]",
     .text = "prints a JSON Schema of such files (default: scene), for editors that complete and "
             "check YAML",
     .examples = "  vibrospice schema scene > scene.schema.json\n",
     .may_be_alone = true,
     .options = SCHEMA_OPTIONS,
     .run = schema},
    {.name = "modes",
     .argument = "SCENE",
     .text = "prints eigenfrequencies, damping and shapes; exports the state space",
     .examples =
         "  vibrospice modes paper\n  vibrospice modes paper --set machine.m14=derived -o modes\n",
     .options = MODES_OPTIONS,
     .run = modes},
    {.name = "export",
     .argument = "SCENE",
     .text =
         "writes one netlist for plain ngspice: the scene's circuit tier, with the machine in it",
     .examples = "  vibrospice export paper -o paper.cir && ngspice -b paper.cir\n"
                 "  vibrospice export my.yaml --set run.until=0.1s -o my.cir\n",
     .options = EXPORT_OPTIONS,
     .run = export},
    {.name = "plot",
     .argument = "DIR...",
     .text = "draws a run, as PNG and SVG: displacements, accelerations, force, current and "
             "voltage, and report.html; or a "
             "study: report.html and its pictures as PNG",
     .examples =
         "  vibrospice plot out\n  vibrospice plot out -o sheet.svg --overlay measured.csv\n"
         "  vibrospice plot before after --probe v_ak,i_thyristor --from 60ms --to 70ms\n"
         "  vibrospice plot out --probe i --fft\n",
     .takes_many = true,
     .options = PLOT_OPTIONS,
     .run = plot},
    {.name = "compare",
     .argument = "A B",
     .text = "tells in what two runs, or two studies, differ: keys, verdicts, measures, curves; "
             "that they differ is no failure",
     .examples = "  vibrospice compare before after\n"
                 "  vibrospice compare before after --json\n",
     .takes_many = true,
     .options = COMPARE_OPTIONS,
     .run = compare},
    {.name = "validate",
     .argument = "[WORD]",
     .text = "compares with closed forms and reference solutions, and tier with tier, each with "
             "its error; "
             "WORD: only checks whose names have it",
     .examples =
         "  vibrospice validate\n  vibrospice validate snubber\n  vibrospice validate --json\n",
     .may_be_alone = true,
     .options = VALIDATE_OPTIONS,
     .run = validate},
    {.name = "study",
     .argument = "STUDY",
     .text = "runs many scenes: what a study file varies, samples or looks for, one row a case",
     .examples = "  vibrospice study snubber_map -o map && vibrospice plot map\n"
                 "  vibrospice study my.yaml --shard 2/7 -o shards/2\n"
                 "  vibrospice study my.yaml --resume -o map\n",
     .options = STUDY_OPTIONS,
     .run = study,
     .explain = explain_study},
    {.name = "merge",
     .argument = "DIR...",
     .text = "joins the shards of one study; DIR: a shard's folder, or one that holds such",
     .examples = "  vibrospice merge shards\n  vibrospice merge one two three -o whole\n",
     .takes_many = true,
     .options = MERGE_OPTIONS,
     .run = merge},
    {.name = "fit",
     .argument = "FIT",
     .text = "finds parameters of scenes from measurements: estimates, errors, and what the data "
             "cannot tell apart",
     .examples = "  vibrospice fit paper\n"
                 "  vibrospice fit my.yaml --profile all -o fitted\n",
     .options = FIT_OPTIONS,
     .run = fit,
     .explain = explain_fit},
    {.name = "import",
     .argument = "NETLIST",
     .text = "makes a deck of a netlist that LTspice, KiCad, PSpice or a person wrote for SPICE",
     .examples = "  vibrospice import drawing.net -o my.cir --scene my.yaml\n"
                 "  vibrospice import drawing.net --mains V1 --gate V3 --coil L1+R4 -o my.cir\n",
     .options = IMPORT_OPTIONS,
     .run = import},
    {.name = "help",
     .argument = "[TOPIC]",
     .text = "tells of a command, of a section of a scene and its keys, of tiers, events, units, "
             "exit statuses; without TOPIC: of the program, and which topics there are",
     .examples = "  vibrospice help firing\n  vibrospice help exit\n",
     .may_be_alone = true,
     .options = HELP_OPTIONS,
     .run = help},
    {.name = "completion",
     .argument = "SHELL",
     .text = "prints what bash or fish needs to complete commands and options",
     .examples = "  vibrospice completion bash > vibrospice.bash\n",
     .options = HELP_OPTIONS,
     .run = completion},
};
enum { N_COMMANDS = sizeof COMMANDS / sizeof *COMMANDS };

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

static vs_status help(const vs_arguments *a, vs_error *err) {
  const char *names[N_COMMANDS], *topic = vs_command_name(a);
  if (!topic) {
    print_help(stdout);
    vs_topics_list();
    return VS_OK;
  }
  for (size_t k = 0; k < N_COMMANDS; k++) {
    char program[] = "vibrospice", name[32], option[] = "--help",
         *words[] = {program, name, option};
    names[k] = COMMANDS[k].name;
    snprintf(name, sizeof name, "%s", topic);
    if (strcmp(topic, names[k]) != 0) continue;
    vs_status status = vs_command_run(&COMMANDS[k], 3, words);
    if (status || !vs_topics_is_section(topic)) return status;
    printf("\nThe section %s of a scene:\n", topic);
    break;
  }
  return vs_topics_print(topic, names, N_COMMANDS, err);
}

static vs_status completion(const vs_arguments *a, vs_error *err) {
  return vs_completion_print(vs_command_name(a), COMMANDS, N_COMMANDS, err);
}

static const vs_command *find_command(const char *word) {
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

static bool is_among(const char *word, const char *const *words) {
  for (; *words; words++)
    if (!strcmp(word, *words)) return true;
  return false;
}

/* A standard stream that is closed would be the first file that is opened, and what is printed
 * would get into that. Its place is taken by a file that cannot be written. */
static void fill_streams(void) {
  int file;
  do file = open("/dev/null", O_RDONLY);
  while (file >= 0 && file <= STDERR_FILENO);
  if (file >= 0) close(file);
}

enum { LINES = 1 << 16 }; /* bytes of standard output that are written at once */

int main(int argc, char **argv) {
  static const char *const HELP[] = {"--help", "-h", "-?", NULL}, *const VERSION[] = {"--version",
                                                                                      "-V", NULL};
  gsl_set_error_handler_off();
  fill_streams();
  setvbuf(stdout, NULL, _IOLBF, LINES); /* so that a warning never stands within a line */
  if (argc < 2) {
    print_help(stderr);
    return VS_INPUT;
  }
  if (is_among(argv[1], HELP)) {
    print_help(stdout);
    return VS_OK;
  }
  if (is_among(argv[1], VERSION)) {
    print_version(stdout);
    return VS_OK;
  }
  const vs_command *command = find_command(argv[1]);
  if (!command) return VS_INPUT;
  vs_leave_begin();
  signal(SIGXFSZ, SIG_IGN); /* a file that may not grow is an error to report, like a full disk */
  vs_status status = vs_command_run(command, argc, argv);
  if (!status && (fflush(stdout) || ferror(stdout))) {
    fputs("vibrospice: standard output cannot be written\n", stderr);
    status = VS_RUN;
  }
  return (int)status;
}
