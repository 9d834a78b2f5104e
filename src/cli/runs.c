/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "runs.h"

#include <stdio.h>
#include <string.h>

#include "base/leave.h"
#include "orbit/branch.h"
#include "orbit/marks.h"
#include "run/run.h"
#include "sensitivity.h"
#include "steady.h"
#include "options.h"
#include "report/tornado.h"
#include "orbit/steady.h"

/* ---- run ---- */

/* What `run` and `steady` are asked for alike. */
static vs_run_options run_options(const vs_arguments *a) {
  return (vs_run_options){.scene = vs_command_name(a),
                          .steady = vs_steady_start,
                          .tier = a->tier,
                          .folder = a->output,
                          .sets = a->sets,
                          .n_sets = a->n_sets,
                          .json = a->json,
                          .all = a->all,
                          .quiet = a->quiet,
                          .reproducible = a->reproducible,
                          .raw = a->raw,
                          .corners = a->corners,
                          .allow_code = a->allow_code,
                          .digits = a->digits,
                          .stop = &vs_leave_requested};
}

static vs_status run(const vs_arguments *a, vs_error *err) {
  const vs_run_options o = run_options(a);
  return vs_run_command(&o, err);
}

static const struct argp_option RUN_OPTIONS[] = {
    VS_COMMAND_SET,
    VS_COMMAND_UNTIL,
    VS_COMMAND_TOLERANCE,
    VS_COMMAND_ANGLE,
    VS_OPTIONS_TIER,
    VS_COMMAND_VALUE(
        "output", 'o', "DIR",
        "writes run.csv, events.csv and summary.json there, and peaks.csv, which is run.csv "
        "with further rows, where peaks lie between the rows of run.csv"),
    VS_COMMAND_JSON,
    VS_COMMAND_QUIET,
    VS_OPTIONS_ALL,
    VS_OPTIONS_REPRODUCIBLE,
    VS_OPTIONS_DIGITS,
    VS_COMMAND_FLAG("corners", VS_KEY_CORNERS,
                    "runs the scene at all ends of its key spread besides, without one of the "
                    "mains +- 10 % and of each varistor's tolerance and ageing; a corner that "
                    "breaks breaks the verdict"),
    VS_COMMAND_FLAG("raw", VS_KEY_RAW,
                    "tier circuit, with -o: writes run.raw too, every voltage and current of the "
                    "circuit at every step, for ngspice's 'load'; a run that fails leaves "
                    "run.partial.raw"),
    VS_COMMAND_ALLOW_CODE,
    VS_COMMAND_JAIL,
    VS_COMMAND_NO_JAIL,
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
              "Branches are followed on tier %s alone; a scene that would take another one "
              "wants --tier %s.\n",
              vs_tiers_automatic(false)->name, vs_tiers_automatic(false)->name);
}

static const struct argp_option STEADY_OPTIONS[] = {
    VS_COMMAND_SET,
    VS_COMMAND_TOLERANCE,
    VS_COMMAND_ANGLE,
    VS_OPTIONS_TIER,
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
    VS_COMMAND_VALUE(
        "output", 'o', "DIR",
        "writes run.csv of one period, events.csv and summary.json there, and peaks.csv "
        "where peaks lie between the rows of run.csv; with "
        "--along branch.csv, branch.json and branch.png"),
    VS_COMMAND_JSON,
    VS_COMMAND_QUIET,
    VS_OPTIONS_ALL,
    VS_OPTIONS_REPRODUCIBLE,
    VS_OPTIONS_DIGITS,
    VS_COMMAND_JAIL,
    VS_COMMAND_NO_JAIL,
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
    VS_OPTIONS_TIER,
    VS_COMMAND_VALUE("output", 'o', "DIR",
                     "writes sensitivity.csv, summary.json and the picture tornado there"),
    VS_COMMAND_JSON,
    VS_COMMAND_QUIET,
    VS_COMMAND_ALLOW_CODE,
    VS_COMMAND_JAIL,
    VS_COMMAND_NO_JAIL,
    VS_COMMAND_HELP,
    {0}};

const vs_command vs_runs_run = {
    .name = "run",
    .argument = "SCENE",
    .text = "runs one scene; SCENE is a file, or the name of one that comes with the program",
    .examples = "  vibrospice run paper --tier circuit -o out\n"
                "  vibrospice run paper --angle 95deg --until 0.5s --set circuit.r1=220ohm\n"
                "  vibrospice run my.yaml --json --quiet > result.json\n",
    .options = RUN_OPTIONS,
    .run = run};

const vs_command vs_runs_steady = {
    .name = "steady",
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
    .explain = explain_steady};

const vs_command vs_runs_sensitivity = {
    .name = "sensitivity",
    .argument = "SCENE",
    .text = "logarithmic derivatives of measures with respect to keys of the scene, of its run or "
            "of its orbit, each with its error",
    .examples =
        "  vibrospice sensitivity paper --of p_first_peak --to firing.angle,supply.voltage\n"
        "  vibrospice sensitivity paper --steady --set firing.every=1 --of p_min,power_in --to "
        "firing.angle,actuator.gap -o tornado\n",
    .options = SENSITIVITY_OPTIONS,
    .run = sensitivity};
