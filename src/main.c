/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command line: the table of commands. */
#include <fcntl.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_version.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/shutdown.h"
#include "base/text.h"
#include "cli/commands.h"
#include "ngspice/ngspice.h"

void terminal_begin(void); /* terminal.c */

/* ---- the table ---- */

static const vs_command *const COMMANDS[] = {
    &vs_run_cli,   &vs_steady_cli,  &vs_sensitivity_cli, &vs_check_cli, &vs_part_cli,
    &vs_list_cli,  &vs_new_cli,     &vs_schema_cli,      &vs_modes_cli, &vs_export_cli,
    &vs_plot_cli,  &vs_compare_cli, &vs_validate_cli,    &vs_study_cli, &vs_merge_cli,
    &vs_judge_cli, &vs_cure_cli,    &vs_design_cli,      &vs_fit_cli,   &vs_import_cli,
    &vs_serve_cli, &vs_help_cli,    &vs_completion_cli,  NULL};
enum { N_COMMANDS = sizeof COMMANDS / sizeof *COMMANDS - 1 };

static void print_version(FILE *out) {
  fprintf(out, "vibrospice %s (ngspice %s, GSL %s)\n", VS_VERSION, vs_ngspice_version(),
          gsl_version);
}

static const vs_command *find_command(const char *word) {
  const char *names[N_COMMANDS];
  for (size_t k = 0; k < N_COMMANDS; k++) {
    if (!strcmp(word, COMMANDS[k]->name)) return COMMANDS[k];
    names[k] = COMMANDS[k]->name;
  }
  fprintf(stderr, "vibrospice: no command '%s'%s\n", word,
          vs_text_hint(word, names, N_COMMANDS, "; see vibrospice --help").text);
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
    vs_command_print_usage(COMMANDS, stderr);
    return VS_INPUT;
  }
  if (is_among(argv[1], HELP)) {
    vs_command_print_usage(COMMANDS, stdout);
    return (int)end_output();
  }
  if (is_among(argv[1], VERSION)) {
    print_version(stdout);
    return (int)end_output();
  }
  const vs_command *command = find_command(argv[1]);
  if (!command) return VS_INPUT;
  vs_shutdown_begin();
  signal(SIGXFSZ, SIG_IGN); /* a file that may not grow is an error to report, like a full disk */
  vs_status status = vs_command_run(COMMANDS, command, argc, argv);
  return (int)(status ? status : end_output());
}
