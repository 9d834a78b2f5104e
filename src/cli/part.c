/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `part`: a template of a part's file. */
#include "bench/template.h"
#include "commands.h"
#include "options.h"

typedef struct part_line {
  vs_arguments common;
  const char *wrap;
  bool overwrite;
} part_line;

static vs_status part_command(const void *given, vs_error *err) {
  const part_line *line = given;
  const vs_arguments *a = &line->common;
  const vs_template_options o = {vs_command_name(a), a->output, line->wrap, line->overwrite,
                                 a->quiet};
  return vs_template_command(&o, err);
}

static const vs_option PART_OPTIONS[] = {
    VS_OPTIONS_OUTPUT("NAME.inc", "writes the template there; NAME is the part's"),
    VS_OPTIONS_WORD(part_line, wrap, "wrap", "FILE[:SUBCKT]",
                    "around the subcircuit of a vendor's file, instead of a model of the "
                    "program's own; of a thyristor, triac, diode, MOSFET, IGBT, varistor or fuse"),
    VS_OPTIONS_FLAG(part_line, overwrite, "overwrite", "replaces a file that is there already"),
    VS_OPTIONS_FLAG(vs_arguments, quiet, "quiet", "prints nothing"),
    VS_OPTIONS_HELP,
    {0}};

const vs_command vs_part_cli = {
    .name = "part",
    .argument = "[KIND]",
    .text = "writes a template of a part, to be filled in from its data sheet; without KIND: which "
            "kinds there are",
    .examples = "  vibrospice part thyristor -o my.inc && vibrospice check my.inc -o bench\n"
                "  vibrospice part thyristor --wrap vendor.lib:NAME -o my.inc\n",
    .may_be_alone = true,
    .options = PART_OPTIONS,
    .size = sizeof(part_line),
    .run = part_command,
    .explain = vs_template_explain};
