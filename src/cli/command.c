/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "command.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/jail.h"
#include "base/path.h"
#include "ngspice/confine.h"
#include "base/units.h"

typedef struct parser {
  const vs_command *command;
  vs_arguments arguments;
  char **made; /* sets that shortcuts were spelt out to, to be freed */
  size_t n_made;
  vs_error err;
} parser;

const char *vs_command_name(const vs_arguments *a) {
  return a->n_names ? a->names[0] : NULL;
}

static error_t fail(parser *p, const char *what, const char *word) {
  const char *name = p->command->name;
  vs_fail(&p->err, VS_INPUT, "%s: %s '%s'; see vibrospice %s --help", name, what, word, name);
  return EINVAL;
}

static error_t fail_with(parser *p, const char *text) {
  vs_fail(&p->err, VS_INPUT, "%s", text);
  return EINVAL;
}

/* ---- options that set one member and nothing else ---- */

static bool *flag_of(vs_arguments *a, int key) {
  const struct {
    int key;
    bool *flag;
  } FLAGS[] = {{'h', &a->help},
               {VS_KEY_JSON, &a->json},
               {VS_KEY_ALL, &a->all},
               {VS_KEY_QUIET, &a->quiet},
               {VS_KEY_REPRODUCIBLE, &a->reproducible},
               {VS_KEY_STEADY, &a->steady},
               {VS_KEY_RAW, &a->raw},
               {VS_KEY_CORNERS, &a->corners},
               {VS_KEY_DEEP, &a->deep},
               {VS_KEY_LINEAR, &a->linear},
               {VS_KEY_LIST, &a->list},
               {VS_KEY_RESUME, &a->resume},
               {VS_KEY_OVERWRITE, &a->overwrite},
               {VS_KEY_ALLOW_CODE, &a->allow_code},
               {VS_KEY_FFT, &a->fft},
               {VS_KEY_ORBIT, &a->orbit},
               {VS_KEY_JAIL, &a->jail},
               {VS_KEY_NO_JAIL, &a->no_jail}};
  for (size_t k = 0; k < sizeof FLAGS / sizeof *FLAGS; k++)
    if (FLAGS[k].key == key) return FLAGS[k].flag;
  return NULL;
}

static const char **word_of(vs_arguments *a, int key) {
  const struct {
    int key;
    const char **word;
  } WORDS[] = {{'o', &a->output},
               {VS_KEY_TIER, &a->tier},
               {VS_KEY_DECK, &a->deck},
               {VS_KEY_MACHINE, &a->machine},
               {VS_KEY_OVERLAY, &a->overlay},
               {VS_KEY_ALONG, &a->along},
               {VS_KEY_STEP, &a->step},
               {VS_KEY_AT, &a->at},
               {VS_KEY_SHARD, &a->shard},
               {VS_KEY_OF, &a->of},
               {VS_KEY_TO, &a->to},
               {VS_KEY_PROFILE, &a->profile},
               {VS_KEY_MAINS, &a->mains},
               {VS_KEY_GATE, &a->gate},
               {VS_KEY_COIL, &a->coil},
               {VS_KEY_PINS, &a->pins},
               {VS_KEY_LIBRARY, &a->library},
               {VS_KEY_SCENE, &a->scene},
               {VS_KEY_WRAP, &a->wrap},
               {VS_KEY_PROBE, &a->probe},
               {VS_KEY_FROM, &a->from},
               {VS_KEY_FORMAT, &a->format}};
  for (size_t k = 0; k < sizeof WORDS / sizeof *WORDS; k++)
    if (WORDS[k].key == key) return WORDS[k].word;
  return NULL;
}

/* ---- shortcuts of --set ---- */

/* The scene key that the option sets; NULL: it is no such option. */
static const char *key_of(int option) {
  static const struct {
    int option;
    const char *key;
  } SHORT[] = {{VS_KEY_UNTIL, "run.until"},
               {VS_KEY_TOLERANCE, "run.tolerance"},
               {VS_KEY_ANGLE, "firing.angle"}};
  for (size_t k = 0; k < sizeof SHORT / sizeof *SHORT; k++)
    if (SHORT[k].option == option) return SHORT[k].key;
  return NULL;
}

/* Adds KEY=VALUE to the sets; of two for one key the later one holds, as of two --set. */
static error_t add_set(parser *p, const char *key, const char *value) {
  vs_text set = {0};
  vs_text_add(&set, "%s=%s", key, value);
  p->made[p->n_made++] = set.text;
  p->arguments.sets[p->arguments.n_sets++] = set.text;
  return 0;
}

/* ---- options with a value of their own ---- */

/* A whole number in a range; false: the word is none. */
static bool read_whole(const char *word, int least, int most, int *value) {
  char *end;
  *value = (int)strtol(word, &end, 10);
  return *word && !*end && *value >= least && *value <= most;
}

static error_t parse_value(parser *p, int key, char *value) {
  vs_arguments *a = &p->arguments;
  char why[256];
  switch (key) {
  case VS_KEY_SET:
    a->sets[a->n_sets++] = value;
    return 0;
  case VS_KEY_DIGITS:
    if (read_whole(value, 1, 17, &a->digits)) return 0;
    vs_fail(&p->err, VS_INPUT, "--digits %s: allowed: 1 to 17", value);
    return EINVAL;
  case VS_KEY_JOBS:
    return read_whole(value, 1, 4096, &a->jobs) ? 0 : fail_with(p, "--jobs: allowed: 1 to 4096");
  case VS_KEY_PERIOD:
    if (read_whole(value, 1, 1000, &a->period)) return 0;
    vs_fail(&p->err, VS_INPUT, "--period %s: allowed: 1 to 1000", value);
    return EINVAL;
  case VS_KEY_TIMEOUT:
    if (vs_units_read(value, "s", &a->timeout_s, why, sizeof why) && a->timeout_s >= 0) return 0;
    vs_fail(&p->err, VS_INPUT, "--case-timeout %s: a time is wanted, as 20s", value);
    return EINVAL;
  case VS_KEY_PROGRESS:
    a->progress_json = true;
    return strcmp(value, "json") ? fail_with(p, "--progress: there is: json") : 0;
  case VS_KEY_AGAIN:
    a->again = true;
    return strcmp(value, "failed") ? fail_with(p, "--again: there is: failed") : 0;
  case VS_KEY_ALONE:
    a->no_sharing = true;
    return 0;
  case VS_KEY_KEEP:
    a->keep_runs = true;
    return strcmp(value, "runs") ? fail_with(p, "--keep: there is: runs") : 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

/* ---- the whole line ---- */

static error_t parse(int key, char *value, struct argp_state *state) {
  parser *p = state->input;
  vs_arguments *a = &p->arguments;
  bool *flag = flag_of(a, key);
  const char **word = word_of(a, key), *scene_key = key_of(key);
  if (flag) return *flag = true, 0;
  if (word) return *word = value, 0;
  if (scene_key) return add_set(p, scene_key, value);
  switch (key) {
  case ARGP_KEY_ARG:
    if (a->n_names && !p->command->takes_many) return fail(p, "one argument too many:", value);
    a->names[a->n_names++] = value;
    return 0;
  case ARGP_KEY_END:
    if (!a->n_names && !p->command->may_be_alone && !a->help)
      return fail(p, "wants one argument:", p->command->argument);
    return 0;
  case ARGP_KEY_ERROR: /* getopt's own, if nobody said anything yet */
    if (!*p->err.text)
      fail(p, "unknown option, or one that lacks its argument:", state->argv[state->next - 1]);
    return 0;
  default:
    return parse_value(p, key, value);
  }
}

/* Enters the jail, where that is asked for. What the command line names is the user's own choice;
 * of --set that is the value of a key that holds a file's name. */
static vs_status enter_jail(const vs_command *c, const vs_arguments *a, vs_error *err) {
  const char *const words[] = {a->deck, a->machine, a->library,
                               a->pins, a->scene,   c->results ? a->output : NULL};
  if (a->jail && a->no_jail)
    return vs_fail(err, VS_INPUT, "--jail and --no-jail: give one of them");
  if (a->jail && a->allow_code)
    return vs_fail(err, VS_INPUT,
                   "--allow-code runs what the scene brings along, --jail trusts it with nothing; "
                   "give one of them");
  if (!a->jail && ((!c->jailed && !c->results) || a->no_jail)) return VS_OK;
  if (!c->results && !vs_confine_works() && !a->quiet)
    fputs(
        "vibrospice: warning: this kernel has no filter of calls (seccomp), so that ngspice could "
        "reach the network if a netlist misused a fault in it\n",
        stderr);
  vs_jail_begin(a->jail ? "leave out --jail" : "give --no-jail");
  vs_path_allow_shipped();
  for (size_t k = 0; k < a->n_names; k++) vs_jail_allow_named(a->names[k]);
  for (size_t k = 0; k < sizeof words / sizeof *words; k++)
    if (words[k]) vs_jail_allow_named(words[k]);
  for (size_t k = 0; k < a->n_sets; k++) {
    vs_text label = {0};
    vs_text_add(&label, "--set %s", a->sets[k]);
    vs_jail_allow_place(label.text);
    vs_text_free(&label);
  }
  return VS_OK;
}

static vs_status parse_and_run(parser *p, int argc, char **argv) {
  const vs_command *c = p->command;
  vs_text doc = {0}, program = {0};
  vs_text_add(&doc, "%s\vExamples:\n%s", c->text, c->examples);
  if (c->explain) c->explain(&doc);
  vs_text_add(&program, "vibrospice %s", c->name);
  argv[1] = program.text; /* argp's name for the program in its messages */
  const struct argp argp = {c->options, parse, c->argument, doc.text, NULL, NULL, NULL};
  error_t failed = argp_parse(&argp, argc - 1, argv + 1, ARGP_NO_ERRS | ARGP_NO_HELP, NULL, p);
  vs_status status = failed ? VS_INPUT : VS_OK;
  if (!failed && p->arguments.help)
    argp_help(&argp, stdout, ARGP_HELP_USAGE | ARGP_HELP_LONG | ARGP_HELP_DOC, program.text);
  else if (!failed)
    status = enter_jail(c, &p->arguments, &p->err);
  if (!status && !p->arguments.help) status = c->run(&p->arguments, &p->err);
  vs_text_free(&doc);
  vs_text_free(&program);
  return status;
}

vs_status vs_command_run(const vs_command *command, int argc, char **argv) {
  parser p = {.command = command,
              .made = vs_alloc((size_t)argc, sizeof(char *)),
              .arguments = {.digits = 9,
                            .period = 1,
                            .timeout_s = 3600,
                            .sets = vs_alloc((size_t)argc, sizeof(char *)),
                            .names = vs_alloc((size_t)argc, sizeof(char *))}};
  vs_status status = parse_and_run(&p, argc, argv);
  if (status && *p.err.text) fprintf(stderr, "vibrospice: %s\n", p.err.text);
  for (size_t k = 0; k < p.n_made; k++) free(p.made[k]);
  free(p.made);
  free(p.arguments.sets);
  free(p.arguments.names);
  return status;
}
