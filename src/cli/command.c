/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "command.h"

#include <argp.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/jail.h"
#include "base/path.h"
#include "ngspice/sandbox.h"

typedef struct parser {
  const vs_command *command;
  struct argp_option *rows; /* of argp: one for each of the command's options, with its key */
  char *line;               /* the command's struct */
  vs_arguments *arguments;  /* its first member */
  vs_error err;
} parser;

const char *vs_command_name(const vs_arguments *a) {
  return a->n_names ? a->names[0] : NULL;
}

static error_t refuse_word(parser *p, const char *what, const char *word) {
  const char *name = p->command->name;
  vs_fail(&p->err, VS_INPUT, "%s: %s '%s'; see vibrospice %s --help", name, what, word, name);
  return EINVAL;
}

/* ---- how options read their values ---- */

vs_status vs_command_flag(const vs_option *option, char *value, void *flag, vs_error *err) {
  (void)option, (void)value, (void)err;
  *(bool *)flag = true;
  return VS_OK;
}

vs_status vs_command_word(const vs_option *option, char *value, void *word, vs_error *err) {
  (void)option, (void)err;
  *(const char **)word = value;
  return VS_OK;
}

vs_status vs_command_whole(const vs_option *option, char *value, void *number, vs_error *err) {
  char *end;
  int *n = number;
  *n = (int)strtol(value, &end, 10);
  if (*value && !*end && *n >= option->least && *n <= option->most) return VS_OK;
  return vs_fail(err, VS_INPUT, "--%s %s: allowed: %d to %d", option->name, value, option->least,
                 option->most);
}

vs_status vs_command_only(const vs_option *option, char *value, void *flag, vs_error *err) {
  *(bool *)flag = true;
  if (!strcmp(value, option->value)) return VS_OK;
  return vs_fail(err, VS_INPUT, "--%s: there is: %s", option->name, option->value);
}

vs_status vs_command_set(const vs_option *option, char *value, void *arguments, vs_error *err) {
  vs_arguments *a = arguments;
  (void)option, (void)err;
  a->sets[a->n_sets++] = value;
  return VS_OK;
}

/* Adds KEY=VALUE to the sets; of two for one key the later one holds, as of two --set. */
vs_status vs_command_shortcut(const vs_option *option, char *value, void *arguments,
                              vs_error *err) {
  vs_arguments *a = arguments;
  vs_text set = {0};
  vs_text_add(&set, "%s=%s", option->key, value);
  a->made[a->n_made++] = set.text;
  return vs_command_set(option, set.text, arguments, err);
}

/* ---- the whole line ---- */

/* The key by which argp knows an option: its letter, or a number that is no letter. */
static int key_of(const vs_command *c, size_t k) {
  enum { BEHIND_LETTERS = 256 };
  return c->options[k].letter ? c->options[k].letter : BEHIND_LETTERS + (int)k;
}

/* The command's options as argp wants them; the caller frees them. --help stands last. */
static struct argp_option *argp_rows(const vs_command *c) {
  size_t count = 0;
  while (c->options[count].name) count++;
  struct argp_option *rows = vs_alloc(count + 1, sizeof *rows);
  for (size_t k = 0; k < count; k++) {
    const vs_option *o = &c->options[k];
    rows[k] = (struct argp_option){o->name, key_of(c, k), o->value,
                                   0,       o->text,      o->letter == 'h' ? -1 : 0};
  }
  return rows;
}

static error_t parse_word(int key, char *value, struct argp_state *state) {
  parser *p = state->input;
  const vs_command *c = p->command;
  vs_arguments *a = p->arguments;
  for (size_t k = 0; c->options[k].name; k++) {
    const vs_option *o = &c->options[k];
    if (key_of(c, k) == key) return o->read(o, value, p->line + o->at, &p->err) ? EINVAL : 0;
  }
  switch (key) {
  case ARGP_KEY_ARG:
    if (a->n_names && !c->takes_many) return refuse_word(p, "one argument too many:", value);
    a->names[a->n_names++] = value;
    return 0;
  case ARGP_KEY_END:
    if (!a->n_names && !c->may_be_alone && !a->help)
      return refuse_word(p, "wants one argument:", c->argument);
    return 0;
  case ARGP_KEY_ERROR: /* getopt's own, if nobody said anything yet */
    if (!*p->err.text)
      refuse_word(p,
                  "unknown option, or one that lacks its argument:", state->argv[state->next - 1]);
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

/* Enters the jail, where that is asked for. What the command line names is the user's own choice;
 * of --set that is the value of a key that holds a file's name. */
static vs_status enter_jail(const vs_command *c, const char *line, vs_error *err) {
  const vs_arguments *a = (const void *)line;
  if (a->jail && a->no_jail)
    return vs_fail(err, VS_INPUT, "--jail and --no-jail: give one of them");
  if (a->jail && a->allow_code)
    return vs_fail(err, VS_INPUT,
                   "--allow-code runs what the scene brings along, --jail trusts it with nothing; "
                   "give one of them");
  if (!a->jail && ((!c->jailed && !c->results) || a->no_jail)) return VS_OK;
  if (!c->results && !vs_sandbox_works() && !a->quiet)
    fputs(
        "vibrospice: warning: this kernel has no filter of calls (seccomp), so that ngspice could "
        "reach the network if a netlist misused a fault in it\n",
        stderr);
  vs_jail_begin(a->jail ? "leave out --jail" : "give --no-jail");
  vs_path_allow_shipped();
  for (size_t k = 0; k < a->n_names; k++) vs_jail_allow_named(a->names[k]);
  for (const vs_option *o = c->options; o->name; o++) {
    const char *const *file = (const void *)(line + o->at);
    if (o->names_file && *file) vs_jail_allow_named(*file);
  }
  if (c->results && a->output) vs_jail_allow_named(a->output);
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
  const struct argp argp = {p->rows, parse_word, c->argument, doc.text, NULL, NULL, NULL};
  error_t failed = argp_parse(&argp, argc - 1, argv + 1, ARGP_NO_ERRS | ARGP_NO_HELP, NULL, p);
  vs_status status = failed ? VS_INPUT : VS_OK;
  if (!failed && p->arguments->help)
    argp_help(&argp, stdout, ARGP_HELP_USAGE | ARGP_HELP_LONG | ARGP_HELP_DOC, program.text);
  else if (!failed)
    status = enter_jail(c, p->line, &p->err);
  if (!status && !p->arguments->help) status = c->run(p->line, &p->err);
  vs_text_free(&doc);
  vs_text_free(&program);
  return status;
}

vs_status vs_command_run(const vs_command *const *all, const vs_command *command, int argc,
                         char **argv) {
  char *line = vs_alloc(1, command->size);
  if (command->defaults) memcpy(line, command->defaults, command->size);
  vs_arguments *a = (void *)line;
  a->commands = all;
  a->sets = vs_alloc((size_t)argc, sizeof *a->sets);
  a->made = vs_alloc((size_t)argc, sizeof *a->made);
  a->names = vs_alloc((size_t)argc, sizeof *a->names);
  parser p = {.command = command, .rows = argp_rows(command), .line = line, .arguments = a};
  vs_status status = parse_and_run(&p, argc, argv);
  if (status && *p.err.text) fprintf(stderr, "vibrospice: %s\n", p.err.text);
  for (size_t k = 0; k < a->n_made; k++) free(a->made[k]);
  free(a->made);
  free(a->sets);
  free(a->names);
  free(p.rows);
  free(line);
  return status;
}

/* ---- of all commands ---- */

void vs_command_print_usage(const vs_command *const *all, FILE *out) {
  fputs("Usage: vibrospice COMMAND ...\n"
        "Co-simulates an electromagnetic machine with the circuit that feeds it: a vibratory "
        "feeder and its\nthyristor converter, a relay or a valve and its switch.\n\n",
        out);
  for (size_t k = 0; all[k]; k++)
    fprintf(out, "  %-8s %-7s %s\n", all[k]->name, all[k]->argument, all[k]->text);
  fputs("\nvibrospice COMMAND --help says more, with more examples than these:\n", out);
  for (size_t k = 0; all[k]; k++) {
    const char *first = all[k]->examples;
    fprintf(out, "%.*s\n", (int)strcspn(first, "\n"), first);
  }
  fputs("\nExit status:", out);
#define EXIT_TEXT(name, status, text) fprintf(out, " %d %s.", status, text);
  VS_STATUS_LIST(EXIT_TEXT)
#undef EXIT_TEXT
  fputs("\nShipped files are looked up in $VIBROSPICE_PATH, then beside the program.\n", out);
}
