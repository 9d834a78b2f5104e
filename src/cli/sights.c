/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sights.h"

#include <stdio.h>
#include <string.h>

#include "base/leave.h"
#include "report/closeup.h"
#include "report/compare.h"
#include "report/bars.h"
#include "report/digest.h"
#include "report/versus.h"
#include "study/methods.h"
#include "report/plot.h"
#include "report/harmonics.h"
#include "report/report.h"
#include "report/tornado.h"
#include "study/folder.h"
#include "validate/validate.h"

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
  const bool all = !a->output && !a->overlay;
  vs_status status = vs_plot_check(o, err);
  if (!status && all) status = vs_bars_draw(o->folder, a->quiet, err);
  if (!status) status = vs_plot_command(o, err);
  if (status || !all) return status;
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
    VS_COMMAND_FLAG(
        "fft", VS_KEY_FFT,
        "the spectrum of the probes over the whole cycles of the mains in that time, and "
        "its numbers as CSV"),
    VS_COMMAND_FLAG("orbit", VS_KEY_ORBIT,
                    "each probe, a coordinate, and its rate over one another"),
    VS_COMMAND_VALUE("overlay", VS_KEY_OVERLAY, "FILE",
                     "draws measured curves over the computed ones: a CSV file, t_s or t_ms first, "
                     "then columns named as in run.csv, also in other units (p_mm, i_ma)"),
    VS_COMMAND_QUIET,
    VS_COMMAND_JAIL,
    VS_COMMAND_NO_JAIL,
    VS_COMMAND_HELP,
    {0}};

/* ---- compare ---- */

static vs_status compare(const vs_arguments *a, vs_error *err) {
  if (a->n_names != 2)
    return vs_fail(err, VS_INPUT,
                   "compare: wants two folders, of two runs or of two studies; see vibrospice "
                   "compare --help");
  vs_compare_options o = {a->names[0], a->names[1], true, vs_methods_all};
  vs_text json = {0}, table = {0};
  vs_status status = a->output ? vs_versus_check(a->output, err) : VS_OK;
  if (!status && (a->json || a->output)) status = vs_compare_tell(&o, &json, err);
  o.json = false;
  if (!status && !a->json) status = vs_compare_tell(&o, &table, err);
  if (!status && a->output) status = vs_versus_write(json.text, a->output, err);
  if (!status && !a->quiet) fputs(a->json ? json.text : table.text, stdout);
  if (!status && !a->quiet && !a->json && a->output) printf("%s/report.html\n", a->output);
  vs_text_free(&json);
  vs_text_free(&table);
  return status;
}

static const struct argp_option COMPARE_OPTIONS[] = {
    VS_COMMAND_VALUE("output", 'o', "DIR",
                     "also writes a page, report.html, into DIR: both side by side, and of runs "
                     "the curves over one another"),
    VS_COMMAND_JSON,
    VS_COMMAND_FLAG("quiet", VS_KEY_QUIET, "prints nothing"),
    VS_COMMAND_JAIL,
    VS_COMMAND_NO_JAIL,
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

const vs_command vs_sights_plot = {
    .name = "plot",
    .argument = "DIR...",
    .text = "draws a run, as PNG and SVG: displacements, accelerations, force, current and "
            "voltage, and report.html; or a "
            "study: report.html and its pictures as PNG",
    .examples = "  vibrospice plot out\n  vibrospice plot out -o sheet.svg --overlay measured.csv\n"
                "  vibrospice plot before after --probe v_ak,i_thyristor --from 60ms --to 70ms\n"
                "  vibrospice plot out --probe i --fft\n",
    .takes_many = true,
    .results = true,
    .options = PLOT_OPTIONS,
    .run = plot};

const vs_command vs_sights_compare = {
    .name = "compare",
    .argument = "A B",
    .text = "tells in what two runs, or two studies, differ: keys, verdicts, measures, curves; "
            "that they differ is no failure",
    .examples = "  vibrospice compare before after\n"
                "  vibrospice compare before after -o page\n"
                "  vibrospice compare before after --json\n",
    .takes_many = true,
    .results = true,
    .options = COMPARE_OPTIONS,
    .run = compare};

const vs_command vs_sights_validate = {
    .name = "validate",
    .argument = "[WORD]",
    .text = "compares with closed forms and reference solutions, and tier with tier, each with "
            "its error; "
            "WORD: only checks whose names have it",
    .examples =
        "  vibrospice validate\n  vibrospice validate snubber\n  vibrospice validate --json\n",
    .may_be_alone = true,
    .options = VALIDATE_OPTIONS,
    .run = validate};
