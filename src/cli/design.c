/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `design`: which parts to buy. A design is a study whose method chooses parts
 * (study/method/design.c); its folder is a study's, with the answer besides. */
#include "base/shutdown.h"
#include "commands.h"
#include "options.h"
#include "study/methods.h"
#include "study/study.h"

typedef struct design_line {
  vs_arguments common;
  vs_study_options o;
} design_line;

static vs_status design_command(const void *given, vs_error *err) {
  const design_line *line = given;
  const vs_arguments *a = &line->common;
  vs_study_options o = line->o;
  if (!a->output)
    return vs_fail(err, VS_INPUT, "design: a folder for the answer is wanted: -o DIR");
  o.name = vs_command_name(a);
  o.methods = vs_methods_all;
  o.method = &vs_design_method;
  o.format = vs_format_all;
  o.folder = a->output;
  o.sets = a->sets;
  o.n_sets = a->n_sets;
  o.quiet = a->quiet;
  o.allow_code = a->allow_code;
  o.stop = &vs_shutdown_requested;
  return vs_study_command(&o, err);
}

static const vs_option DESIGN_OPTIONS[] = {
    VS_OPTIONS_SET,
    VS_OPTIONS_OUTPUT("DIR", "writes design.txt, design.json, design.csv, bom.csv and cases/ "
                             "there, besides what a study writes"),
    VS_OPTIONS_WHOLE(design_line, o.jobs, 1, 4096, "jobs", "N",
                     "worker processes (default: the cores this process may use)"),
    VS_OPTIONS_WORD(design_line, o.shard, "shard", "I/N",
                    "runs every N-th case, from the I-th on, and takes the others from the N - 1 "
                    "processes whose folders lie beside DIR; auto: by the variables of a Slurm job "
                    "array"),
    VS_OPTIONS_FLAG(design_line, o.resume, "resume",
                    "goes on with what DIR has; begins where there is nothing"),
    VS_OPTIONS_FLAG(design_line, o.overwrite, "overwrite",
                    "replaces what another study, or this one, has left in DIR; else that is "
                    "refused"),
    VS_OPTIONS_FLAG(vs_arguments, quiet, "quiet", "no answer on standard output, no progress"),
    VS_OPTIONS_ALLOW_CODE,
    VS_OPTIONS_JAIL,
    VS_OPTIONS_END};

const vs_command vs_design_cli = {
    .name = "design",
    .argument = "DESIGN",
    .text = "finds the cheapest parts of a list of prices that hold under all threats",
    .examples = "  vibrospice design my.design.yaml -o answer\n"
                "  vibrospice design my.design.yaml -o parts/2 --shard 2/4\n"
                "  vibrospice design my.design.yaml -o answer --resume\n",
    .options = DESIGN_OPTIONS,
    .size = sizeof(design_line),
    .defaults = &(const design_line){.o.timeout_s = 3600},
    .run = design_command};
