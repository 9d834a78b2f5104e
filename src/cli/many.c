/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "many.h"

#include <stdio.h>
#include <string.h>

#include "base/leave.h"
#include "options.h"
#include "fit/aims.h"
#include "study/methods.h"
#include "report/fitting.h"
#include "study/format.h"
#include "study/merge.h"
#include "study/study.h"

/* ---- study, merge ---- */

static vs_status study(const vs_arguments *a, vs_error *err) {
  const vs_format *format;
  vs_status status = vs_format_find(a->format, &format, err);
  if (status) return status;
  const vs_study_options o = {.name = vs_command_name(a),
                              .methods = vs_methods_all,
                              .folder = a->output,
                              .sets = a->sets,
                              .n_sets = a->n_sets,
                              .format = format,
                              .jobs = a->jobs,
                              .shard = a->shard,
                              .resume = a->resume,
                              .again = a->again,
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

static void explain_formats(vs_text *help) {
  vs_text_add(help, "\nFormats of the rows (--format):\n");
  for (const vs_format *f = vs_format_all; f->name; f++)
    vs_text_add(help, "  %-8s %s\n", f->name, f->text);
}

/* What a study file may ask for. */
static void explain_study(vs_text *help) {
  vs_text_add(help, "\nA study has, besides scene, set and report:\n");
  for (const vs_method *const *m = vs_methods_all; *m; m++)
    vs_text_add(help, "  %-8s %-12s %s\n", (*m)->key, (*m)->name, (*m)->text);
  vs_text_add(help, "  %-8s %-12s %s\n", "steady", "",
              "each case is one period of its orbit, as `vibrospice steady` finds it: true, or "
              "{period: N}");
  explain_formats(help);
}

#define FORMAT                                                                                     \
  VS_COMMAND_VALUE("format", VS_KEY_FORMAT, VS_FORMAT_WORDS,                                       \
                   "how the rows are written (default csv); see below")

static const struct argp_option STUDY_OPTIONS[] = {
    VS_COMMAND_SET,
    VS_COMMAND_VALUE("output", 'o', "DIR",
                     "writes study.csv, failures.csv and manifest.json there; without it study.csv "
                     "goes to standard output"),
    FORMAT,
    VS_COMMAND_VALUE("jobs", VS_KEY_JOBS, "N",
                     "worker processes (default: the cores this process may use)"),
    VS_COMMAND_VALUE("shard", VS_KEY_SHARD, "I/N",
                     "only every N-th case, from the I-th on; auto: by the variables of a Slurm "
                     "job array"),
    VS_COMMAND_FLAG("resume", VS_KEY_RESUME,
                    "goes on with what DIR has; begins where there is nothing"),
    VS_COMMAND_VALUE("again", VS_KEY_AGAIN, "failed",
                     "with --resume: runs the cases again that failed"),
    VS_COMMAND_FLAG("overwrite", VS_KEY_OVERWRITE,
                    "replaces what another study, or this one, has left in DIR; else that is "
                    "refused"),
    VS_COMMAND_VALUE("case-timeout", VS_KEY_TIMEOUT, "T",
                     "a case that takes longer fails (default 3600 s; 0: none does)"),
    VS_COMMAND_VALUE("progress", VS_KEY_PROGRESS, "json",
                     "a line of JSON a second on standard output"),
    VS_COMMAND_VALUE(
        "keep", VS_KEY_KEEP, "runs",
        "stores each case's run.csv as DIR/runs/CASE/run.csv, and peaks.csv beside it where "
        "peaks lie between its rows"),
    VS_COMMAND_FLAG("no-sharing", VS_KEY_ALONE,
                    "runs each case from its beginning, also where cases have the same past; the "
                    "results are the same"),
    VS_COMMAND_FLAG("quiet", VS_KEY_QUIET, "no table, no progress"),
    VS_COMMAND_ALLOW_CODE,
    VS_COMMAND_JAIL,
    VS_COMMAND_NO_JAIL,
    VS_COMMAND_HELP,
    {0}};

static vs_status merge(const vs_arguments *a, vs_error *err) {
  vs_merge_options o = {a->names, a->n_names, a->output, NULL, a->overwrite, a->quiet};
  vs_status status = vs_format_find(a->format, &o.format, err);
  return status ? status : vs_merge_command(&o, err);
}

static const struct argp_option MERGE_OPTIONS[] = {
    VS_COMMAND_VALUE("output", 'o', "DIR",
                     "writes the whole study there (default: the one DIR named)"),
    FORMAT,
    VS_COMMAND_FLAG("overwrite", VS_KEY_OVERWRITE,
                    "over another study's result, too; else that is refused"),
    VS_COMMAND_FLAG("quiet", VS_KEY_QUIET, "prints nothing"),
    VS_COMMAND_JAIL,
    VS_COMMAND_NO_JAIL,
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
    VS_OPTIONS_DIGITS,
    VS_COMMAND_ALLOW_CODE,
    VS_COMMAND_JAIL,
    VS_COMMAND_NO_JAIL,
    VS_COMMAND_HELP,
    {0}};

const vs_command vs_many_study = {
    .name = "study",
    .argument = "STUDY",
    .text =
        "runs many scenes: what a study file varies, samples or looks for, one row for each case",
    .examples = "  vibrospice study snubber_map -o map && vibrospice plot map\n"
                "  vibrospice study my.yaml --shard 2/7 -o shards/2\n"
                "  vibrospice study my.yaml --resume -o map\n",
    .options = STUDY_OPTIONS,
    .run = study,
    .explain = explain_study};

const vs_command vs_many_merge = {
    .name = "merge",
    .argument = "DIR...",
    .text = "joins the shards of one study; DIR: a shard's folder, or one that holds such",
    .examples = "  vibrospice merge shards\n  vibrospice merge one two three -o whole\n",
    .takes_many = true,
    .options = MERGE_OPTIONS,
    .results = true,
    .run = merge,
    .explain = explain_formats};

const vs_command vs_many_fit = {
    .name = "fit",
    .argument = "FIT",
    .text = "finds parameters of scenes from measurements: estimates, errors, and what the data "
            "cannot tell apart",
    .examples = "  vibrospice fit paper\n"
                "  vibrospice fit my.yaml --profile all -o fitted\n",
    .options = FIT_OPTIONS,
    .run = fit,
    .explain = explain_fit};
