/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `study`: many scenes. */
#include "study/study.h"
#include "base/shutdown.h"
#include "base/units.h"
#include "commands.h"
#include "options.h"
#include "study/methods.h"

typedef struct study_line {
  vs_arguments common;
  vs_study_options o;
  const char *format;
} study_line;

/* More workers than any machine has cores is taken for a typing error. */
static vs_status read_jobs(const vs_option *option, char *value, void *jobs, vs_error *err) {
  const vs_option within = {.name = option->name, .least = 1, .most = 4096};
  vs_error with_value = {0};
  return vs_command_whole(&within, value, jobs, &with_value)
             ? vs_fail(err, VS_INPUT, "--jobs: allowed: 1 to 4096")
             : VS_OK;
}

static vs_status read_timeout(const vs_option *option, char *value, void *member, vs_error *err) {
  double *timeout_s = member;
  char why[256];
  (void)option;
  if (vs_units_read(value, "s", timeout_s, why, sizeof why) && *timeout_s >= 0) return VS_OK;
  return vs_fail(err, VS_INPUT, "--case-timeout %s: a time is wanted, as 20s", value);
}

static vs_status study_command(const void *given, vs_error *err) {
  const study_line *line = given;
  const vs_arguments *a = &line->common;
  vs_study_options o = line->o;
  vs_status status = vs_format_find(line->format, &o.format, err);
  if (status) return status;
  o.name = vs_command_name(a);
  o.methods = vs_methods_all;
  o.folder = a->output;
  o.sets = a->sets;
  o.n_sets = a->n_sets;
  o.quiet = a->quiet;
  o.allow_code = a->allow_code;
  o.stop = &vs_shutdown_requested;
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
  vs_options_explain_formats(help);
}

static const vs_option STUDY_OPTIONS[] = {
    VS_OPTIONS_SET,
    VS_OPTIONS_OUTPUT(
        "DIR", "writes study.csv, failures.csv and manifest.json there; without it study.csv "
               "goes to standard output"),
    VS_OPTIONS_FORMAT(study_line, format),
    VS_OPTIONS_OWN(study_line, o.jobs, int, read_jobs, "jobs", "N",
                   "worker processes (default: the cores this process may use)"),
    VS_OPTIONS_WORD(study_line, o.shard, "shard", "I/N",
                    "only every N-th case, from the I-th on; auto: by the variables of a Slurm "
                    "job array"),
    VS_OPTIONS_FLAG(study_line, o.resume, "resume",
                    "goes on with what DIR has; begins where there is nothing"),
    VS_OPTIONS_ONLY(study_line, o.again, "again", "failed",
                    "with --resume: runs the cases again that failed"),
    VS_OPTIONS_FLAG(study_line, o.overwrite, "overwrite",
                    "replaces what another study, or this one, has left in DIR; else that is "
                    "refused"),
    VS_OPTIONS_OWN(study_line, o.timeout_s, double, read_timeout, "case-timeout", "T",
                   "a case that takes longer fails (default 3600 s; 0: none does)"),
    VS_OPTIONS_ONLY(study_line, o.progress_json, "progress", "json",
                    "a line of JSON a second on standard output"),
    VS_OPTIONS_ONLY(
        study_line, o.keep_runs, "keep", "runs",
        "stores each case's run.csv as DIR/runs/CASE/run.csv, and peaks.csv beside it where "
        "peaks lie between its rows"),
    VS_OPTIONS_FLAG(study_line, o.alone, "no-sharing",
                    "runs each case from its beginning, also where cases have the same past; the "
                    "results are the same"),
    VS_OPTIONS_FLAG(vs_arguments, quiet, "quiet", "no table, no progress"),
    VS_OPTIONS_ALLOW_CODE,
    VS_OPTIONS_JAIL,
    VS_OPTIONS_END};

const vs_command vs_study_cli = {
    .name = "study",
    .argument = "STUDY",
    .text =
        "runs many scenes: what a study file varies, samples or looks for, one row for each case",
    .examples = "  vibrospice study snubber_map -o map && vibrospice plot map\n"
                "  vibrospice study my.yaml --shard 2/7 -o shards/2\n"
                "  vibrospice study my.yaml --resume -o map\n",
    .options = STUDY_OPTIONS,
    .size = sizeof(study_line),
    .defaults = &(const study_line){.o.timeout_s = 3600},
    .run = study_command,
    .explain = explain_study};
