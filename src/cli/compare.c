/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `compare`: in what two runs, or two studies, differ. */
#include <stdio.h>

#include "commands.h"
#include "options.h"
#include "report/compare.h"
#include "report/compare_page.h"
#include "study/methods.h"

static vs_status compare_command(const void *given, vs_error *err) {
  const vs_arguments *a = given;
  if (a->n_names != 2)
    return vs_fail(err, VS_INPUT,
                   "compare: wants two folders, of two runs or of two studies; see vibrospice "
                   "compare --help");
  vs_compare_options o = {a->names[0], a->names[1], true, vs_methods_all};
  vs_text json = {0}, table = {0};
  vs_status status = a->output ? vs_compare_page_check(a->output, err) : VS_OK;
  if (!status && (a->json || a->output)) status = vs_compare_tell(&o, &json, err);
  o.json = false;
  if (!status && !a->json) status = vs_compare_tell(&o, &table, err);
  if (!status && a->output) status = vs_compare_page_write(json.text, a->output, err);
  if (!status && !a->quiet) fputs(a->json ? json.text : table.text, stdout);
  if (!status && !a->quiet && !a->json && a->output) printf("%s/report.html\n", a->output);
  vs_text_free(&json);
  vs_text_free(&table);
  return status;
}

static const vs_option COMPARE_OPTIONS[] = {
    VS_OPTIONS_OUTPUT("DIR",
                      "also writes a page, report.html, into DIR: both side by side, and of runs "
                      "the curves over one another"),
    VS_OPTIONS_JSON, VS_OPTIONS_FLAG(vs_arguments, quiet, "quiet", "prints nothing"),
    VS_OPTIONS_JAIL, VS_OPTIONS_END};

const vs_command vs_compare_cli = {
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
    .size = sizeof(vs_arguments),
    .run = compare_command};
