/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `merge`: the shards of a study become one. */
#include "study/merge.h"
#include "commands.h"
#include "options.h"

typedef struct merge_line {
  vs_arguments common;
  const char *format;
  bool overwrite;
} merge_line;

static vs_status merge_command(const void *given, vs_error *err) {
  const merge_line *line = given;
  const vs_arguments *a = &line->common;
  vs_merge_options o = {a->names, a->n_names, a->output, NULL, line->overwrite, a->quiet};
  vs_status status = vs_format_find(line->format, &o.format, err);
  return status ? status : vs_merge_command(&o, err);
}

static const vs_option MERGE_OPTIONS[] = {
    VS_OPTIONS_OUTPUT("DIR", "writes the whole study there (default: the one DIR named)"),
    VS_OPTIONS_FORMAT(merge_line, format),
    VS_OPTIONS_FLAG(merge_line, overwrite, "overwrite",
                    "over another study's result, too; else that is refused"),
    VS_OPTIONS_FLAG(vs_arguments, quiet, "quiet", "prints nothing"),
    VS_OPTIONS_JAIL,
    VS_OPTIONS_END};

const vs_command vs_merge_cli = {
    .name = "merge",
    .argument = "DIR...",
    .text = "joins the shards of one study; DIR: a shard's folder, or one that holds such",
    .examples = "  vibrospice merge shards\n  vibrospice merge one two three -o whole\n",
    .takes_many = true,
    .options = MERGE_OPTIONS,
    .results = true,
    .size = sizeof(merge_line),
    .run = merge_command,
    .explain = vs_options_explain_formats};
