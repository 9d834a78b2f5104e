/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `fit`: parameters of scenes from what was measured. */
#include "commands.h"
#include "fit/targets.h"
#include "options.h"
#include "report/fit_command.h"

typedef struct fit_line {
  vs_arguments common;
  vs_fit_command_options o;
} fit_line;

static vs_status fit_command(const void *given, vs_error *err) {
  const fit_line *line = given;
  const vs_arguments *a = &line->common;
  vs_fit_command_options o = line->o;
  o.name = vs_command_name(a);
  o.sets = a->sets;
  o.n_sets = a->n_sets;
  o.folder = a->output;
  o.json = a->json;
  o.quiet = a->quiet;
  o.allow_code = a->allow_code;
  return vs_fit_command_run(&o, err);
}

static void explain_fit(vs_text *help) {
  vs_text_add(help, "\nBesides the measures of every run, and with steady: true those of steady, a "
                    "fit may use:\n");
  vs_target_explain(help);
}

static const vs_option FIT_OPTIONS[] = {
    VS_OPTIONS_SET,
    VS_OPTIONS_WORD(fit_line, o.profile, "profile", "KEY,...",
                    "the profile likelihood of these free keys, or of all: chi2 over the value, "
                    "all others fitted anew"),
    VS_OPTIONS_OUTPUT("DIR", "writes fit.json, residuals.csv, profile.csv and a picture there"),
    VS_OPTIONS_JSON,
    VS_OPTIONS_QUIET,
    VS_OPTIONS_DIGITS(fit_line, o.digits),
    VS_OPTIONS_ALLOW_CODE,
    VS_OPTIONS_JAIL,
    VS_OPTIONS_END};

const vs_command vs_fit_cli = {
    .name = "fit",
    .argument = "FIT",
    .text = "finds parameters of scenes from measurements: estimates, errors, and what the data "
            "cannot tell apart",
    .examples = "  vibrospice fit paper\n"
                "  vibrospice fit my.yaml --profile all -o fitted\n",
    .options = FIT_OPTIONS,
    .size = sizeof(fit_line),
    .defaults = &(const fit_line){.o.digits = 9},
    .run = fit_command,
    .explain = explain_fit};
