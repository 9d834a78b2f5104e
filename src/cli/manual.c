/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "manual.h"

#include <stdio.h>
#include <string.h>

/* Prints a text so that man(7) takes nothing in it for a request: a backslash and a hyphen are
 * escaped, and no line begins with a point or an apostrophe. */
static void print_text(const char *text) {
  bool begins = true;
  for (; *text; text++) {
    if (begins && strchr(".'", *text)) fputs("\\&", stdout);
    if (*text == '\\')
      fputs("\\e", stdout);
    else if (*text == '-')
      fputs("\\-", stdout);
    else
      putchar(*text);
    begins = *text == '\n';
  }
}

static void print_option(const struct argp_option *o) {
  fputs(".TP\n", stdout);
  if (o->key > ' ' && o->key < 127) printf("\\fB\\-%c\\fR, ", o->key);
  fputs("\\fB\\-\\-", stdout);
  print_text(o->name);
  fputs("\\fR", stdout);
  if (o->arg) fputs("=\\fI", stdout), print_text(o->arg), fputs("\\fR", stdout);
  putchar('\n');
  print_text(o->doc);
  putchar('\n');
}

static void print_command(const vs_command *c) {
  printf(".SS vibrospice %s ", c->name);
  print_text(c->argument);
  putchar('\n');
  print_text(c->text);
  putchar('\n');
  for (const struct argp_option *o = c->options; o->name; o++) print_option(o);
  fputs(".PP\nExamples:\n.PP\n.nf\n", stdout);
  print_text(c->examples);
  fputs(".fi\n", stdout);
}

void vs_manual_print(const vs_command *const *commands, size_t count) {
  printf(".TH VIBROSPICE 1 \"\" \"vibrospice %s\" \"User Commands\"\n", VS_VERSION);
  fputs(".SH NAME\nvibrospice \\- vibratory conveyor and thyristor converter, simulated together\n"
        ".SH SYNOPSIS\n.B vibrospice\n.I COMMAND\n[\\fIOPTION\\fR]... [\\fINAME\\fR]...\n"
        ".SH DESCRIPTION\n"
        "Integrates a resonant vibrating machine with GSL and its converter with ngspice, stepped\n"
        "together at every time step. For sizing snubbers, varistors and fuses.\n"
        ".SH COMMANDS\n",
        stdout);
  for (size_t k = 0; k < count; k++) print_command(commands[k]);
  fputs(".SH EXIT STATUS\n", stdout);
#define EXIT_ROW(name, status, text) printf(".TP\n%d\n%s\n", status, text);
  VS_STATUS_LIST(EXIT_ROW)
#undef EXIT_ROW
  fputs(".SH ENVIRONMENT\n.TP\nVIBROSPICE_PATH\nwhere decks, parts, machines and scenes are looked "
        "for before the shipped ones\n"
        ".TP\nNO_COLOR\nif set, the verdict has no colour on a terminal\n"
        ".SH SEE ALSO\n.BR ngspice (1)\n",
        stdout);
}
