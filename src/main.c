/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command line: the table of commands, each with its options. */
#include <fcntl.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_version.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/leave.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/looks.h"
#include "cli/many.h"
#include "cli/runs.h"
#include "cli/sights.h"
#include "cli/trade.h"
#include "cli/completion.h"
#include "cli/manual.h"
#include "cli/topics.h"
#include "ngspice/ng.h"

void terminal_begin(void); /* terminal.c */

/* ---- the table ---- */

static vs_status help(const vs_arguments *a, vs_error *err);
static vs_status completion(const vs_arguments *a, vs_error *err);

static const struct argp_option HELP_OPTIONS[] = {VS_COMMAND_HELP, {0}};

static const vs_command help_command = {
    .name = "help",
    .argument = "[TOPIC]",
    .text = "tells of a command, of a section of a scene and its keys, of tiers, events, units, "
            "exit statuses; man: the manual page's source; without TOPIC: of the program, and "
            "which topics there are",
    .examples =
        "  vibrospice help firing\n  vibrospice help exit\n  vibrospice help man | man -l -\n",
    .may_be_alone = true,
    .options = HELP_OPTIONS,
    .run = help};

static const vs_command completion_command = {
    .name = "completion",
    .argument = "SHELL",
    .text = "prints what bash, fish or zsh needs to complete commands and options",
    .examples = "  vibrospice completion bash > vibrospice.bash\n",
    .options = HELP_OPTIONS,
    .run = completion};

static const vs_command *const COMMANDS[] = {
    &vs_runs_run,    &vs_runs_steady,    &vs_runs_sensitivity, &vs_looks_check,    &vs_trade_part,
    &vs_looks_list,  &vs_looks_new,      &vs_looks_schema,     &vs_looks_modes,    &vs_trade_export,
    &vs_sights_plot, &vs_sights_compare, &vs_sights_validate,  &vs_many_study,     &vs_many_merge,
    &vs_many_fit,    &vs_trade_import,   &help_command,        &completion_command};
enum { N_COMMANDS = sizeof COMMANDS / sizeof *COMMANDS };

static void print_version(FILE *out) {
  fprintf(out, "vibrospice %s (ngspice %s, GSL %s)\n", VS_VERSION, vs_ng_version(), gsl_version);
}

static void print_help(FILE *out) {
  fputs("Usage: vibrospice COMMAND ...\n"
        "Co-simulates a resonant electromagnetic vibratory conveyor with its thyristor "
        "converter.\n\n",
        out);
  for (size_t k = 0; k < N_COMMANDS; k++)
    fprintf(out, "  %-8s %-7s %s\n", COMMANDS[k]->name, COMMANDS[k]->argument, COMMANDS[k]->text);
  fputs("\nvibrospice COMMAND --help says more, with more examples than these:\n", out);
  for (size_t k = 0; k < N_COMMANDS; k++) {
    const char *first = COMMANDS[k]->examples;
    fprintf(out, "%.*s\n", (int)strcspn(first, "\n"), first);
  }
  fputs("\nExit status:", out);
#define EXIT_TEXT(name, status, text) fprintf(out, " %d %s.", status, text);
  VS_STATUS_LIST(EXIT_TEXT)
#undef EXIT_TEXT
  fputs("\nShipped files are looked up in $VIBROSPICE_PATH, then beside the program.\n", out);
}

static vs_status help(const vs_arguments *a, vs_error *err) {
  const char *names[N_COMMANDS], *topic = vs_command_name(a);
  if (!topic) {
    print_help(stdout);
    vs_topics_list();
    return VS_OK;
  }
  if (!strcmp(topic, "man")) {
    vs_manual_print(COMMANDS, N_COMMANDS);
    return VS_OK;
  }
  for (size_t k = 0; k < N_COMMANDS; k++) {
    char program[] = "vibrospice", name[32], option[] = "--help",
         *words[] = {program, name, option};
    names[k] = COMMANDS[k]->name;
    snprintf(name, sizeof name, "%s", topic);
    if (strcmp(topic, names[k]) != 0) continue;
    vs_status status = vs_command_run(COMMANDS[k], 3, words);
    if (status || !vs_topics_is_section(topic)) return status;
    printf("\nThe section %s of a scene:\n", topic);
    break;
  }
  return vs_topics_print(topic, names, N_COMMANDS, err);
}

static vs_status completion(const vs_arguments *a, vs_error *err) {
  return vs_completion_print(vs_command_name(a), COMMANDS, N_COMMANDS, err);
}

static const vs_command *find_command(const char *word) {
  const char *names[N_COMMANDS];
  for (size_t k = 0; k < N_COMMANDS; k++) {
    if (!strcmp(word, COMMANDS[k]->name)) return COMMANDS[k];
    names[k] = COMMANDS[k]->name;
  }
  const char *nearest = vs_text_nearest(word, names, N_COMMANDS);
  fprintf(stderr, "vibrospice: no command '%s'%s%s%s\n", word,
          nearest ? "; did you mean '" : "; see vibrospice --help", nearest ? nearest : "",
          nearest ? "'?" : "");
  return NULL;
}

static bool is_among(const char *word, const char *const *words) {
  for (; *words; words++)
    if (!strcmp(word, *words)) return true;
  return false;
}

/* A standard stream that is closed would be the first file that is opened, and what is printed
 * would get into that. Its place is taken by a file that cannot be written. */
static void fill_streams(void) {
  int file;
  do file = open("/dev/null", O_RDONLY);
  while (file >= 0 && file <= STDERR_FILENO);
  if (file >= 0) close(file);
}

/* What is printed may not have gone out, as into a file on a full disk. */
static vs_status end_output(void) {
  if (!fflush(stdout) && !ferror(stdout)) return VS_OK;
  fputs("vibrospice: standard output cannot be written\n", stderr);
  return VS_RUN;
}

int main(int argc, char **argv) {
  static const char *const HELP[] = {"--help", "-h", "-?", NULL}, *const VERSION[] = {"--version",
                                                                                      "-V", NULL};
  gsl_set_error_handler_off();
  fill_streams();
  terminal_begin();
  if (argc < 2) {
    print_help(stderr);
    return VS_INPUT;
  }
  if (is_among(argv[1], HELP)) {
    print_help(stdout);
    return (int)end_output();
  }
  if (is_among(argv[1], VERSION)) {
    print_version(stdout);
    return (int)end_output();
  }
  const vs_command *command = find_command(argv[1]);
  if (!command) return VS_INPUT;
  vs_leave_begin();
  signal(SIGXFSZ, SIG_IGN); /* a file that may not grow is an error to report, like a full disk */
  vs_status status = vs_command_run(command, argc, argv);
  return (int)(status ? status : end_output());
}
