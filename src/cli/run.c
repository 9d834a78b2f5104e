/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `run`: one scene. */
#include "commands.h"
#include "options.h"

typedef struct run_line {
  vs_arguments common;
  vs_run_options run;
} run_line;

static vs_status run_command(const void *given, vs_error *err) {
  const run_line *line = given;
  const vs_run_options o = vs_options_of_run(&line->run, &line->common);
  return vs_run_command(&o, err);
}

static const vs_option RUN_OPTIONS[] = {
    VS_OPTIONS_SET,
    VS_OPTIONS_UNTIL,
    VS_OPTIONS_TOLERANCE,
    VS_OPTIONS_ANGLE,
    VS_OPTIONS_TIER(run_line, run.tier),
    VS_OPTIONS_OUTPUT(
        "DIR", "writes run.csv, events.csv and summary.json there, and peaks.csv, which is run.csv "
               "with further rows, where peaks lie between the rows of run.csv"),
    VS_OPTIONS_JSON,
    VS_OPTIONS_QUIET,
    VS_OPTIONS_ALL(run_line, run.all),
    VS_OPTIONS_REPRODUCIBLE(run_line, run.reproducible),
    VS_OPTIONS_DIGITS(run_line, run.digits),
    VS_OPTIONS_FLAG(run_line, run.corners, "corners",
                    "runs the scene at all ends of its key spread besides, without one of the "
                    "mains +- 10 % and of each varistor's tolerance and ageing; a corner that "
                    "breaks breaks the verdict"),
    VS_OPTIONS_FLAG(run_line, run.raw, "raw",
                    "tier circuit, with -o: writes run.raw too, every voltage and current of the "
                    "circuit at every step, for ngspice's 'load'; a run that fails leaves "
                    "run.partial.raw"),
    VS_OPTIONS_ALLOW_CODE,
    VS_OPTIONS_JAIL,
    VS_OPTIONS_NO_JAIL,
    VS_OPTIONS_HELP,
    {0}};

const vs_command vs_run_cli = {
    .name = "run",
    .argument = "SCENE",
    .text = "runs one scene; SCENE is a file, or the name of one that comes with the program",
    .examples = "  vibrospice run paper --tier circuit -o out\n"
                "  vibrospice run paper --angle 95deg --until 0.5s --set circuit.r1=220ohm\n"
                "  vibrospice run my.yaml --json --quiet > result.json\n",
    .options = RUN_OPTIONS,
    .size = sizeof(run_line),
    .defaults = &(const run_line){.run.digits = 9},
    .run = run_command};
