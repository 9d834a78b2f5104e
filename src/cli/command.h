/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a command of the program is, and how the words behind it become its arguments. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "base/error.h"
#include "base/text.h"

typedef struct vs_command vs_command;

/* What may stand behind every command. The struct of a command's own begins with it. All words are
 * borrowed from the command line; a word that was not given is NULL. */
typedef struct vs_arguments {
  char **names; /* those that are no options: a scene, a kind, folders */
  size_t n_names;
  char **sets; /* KEY=VALUE of each --set, and of each shortcut of it */
  size_t n_sets;
  char **made; /* those sets that shortcuts were spelt out to; owned */
  size_t n_made;
  const char *output;
  bool json, quiet, help, allow_code, jail, no_jail;
  const vs_command *const
      *commands; /* the program's, for those that tell of them; NULL ends them */
} vs_arguments;

/* The first name; NULL: there is none. */
const char *vs_command_name(const vs_arguments *arguments);

/* One option: a row of a command's table, made by the macros of options.h. {0} ends the table. */
typedef struct vs_option vs_option;
struct vs_option {
  const char *name;
  int letter;        /* the short name; 0: none */
  const char *value; /* what --help calls its value; NULL: it takes none */
  const char *text;
  /* Puts the value into the member. Error: VS_INPUT, it is not allowed. */
  vs_status (*read)(const vs_option *option, char *value, void *member, vs_error *err);
  size_t at;       /* offset of that member in the command's struct */
  int least, most; /* of whole numbers */
  const char *key; /* the scene's, which the option sets as --set does */
  bool names_file; /* which the user chose: it may be read in the jail, too */
};

/* One command: a plug of the program's table (commands.h). */
struct vs_command {
  const char *name, *text;
  const char *argument; /* what is to stand behind it: "SCENE" */
  const char *examples; /* whole lines, for --help */
  bool may_be_alone;    /* the argument may be left out */
  bool takes_many;      /* arguments */
  bool results; /* its arguments are folders of results: in the jail, and ngspice is not called */
  bool jailed;  /* in the jail (base/jail.h) unless --no-jail says otherwise */
  const vs_option *options;
  size_t size;          /* of the struct that its options fill in, which begins with vs_arguments */
  const void *defaults; /* what that struct has before the line is read; NULL: zeros */
  vs_status (*run)(const void *line, vs_error *err); /* line: that struct, filled in */
  void (*explain)(vs_text *help); /* adds to --help, behind the examples; NULL: nothing */
};

/* How options read their values: as vs_option.read. */
vs_status vs_command_flag(const vs_option *option, char *value, void *flag, vs_error *err);
vs_status vs_command_word(const vs_option *option, char *value, void *word, vs_error *err);
/* A whole number from least to most. */
vs_status vs_command_whole(const vs_option *option, char *value, void *number, vs_error *err);
/* Sets a flag; the one value that there is, is the option's own. */
vs_status vs_command_only(const vs_option *option, char *value, void *flag, vs_error *err);
/* KEY=VALUE of --set; and the value of the option's own key. */
vs_status vs_command_set(const vs_option *option, char *value, void *arguments, vs_error *err);
vs_status vs_command_shortcut(const vs_option *option, char *value, void *arguments, vs_error *err);

/* Runs the command whose name is argv[1] with what stands behind it, or prints its help. Prints one
 * line on standard error where it fails. Writes into argv[1]. all: the program's commands. */
vs_status vs_command_run(const vs_command *const *all, const vs_command *command, int argc,
                         char **argv);

/* Prints what the program is, its commands, an example of each, and its exit statuses. */
void vs_command_print_usage(const vs_command *const *all, FILE *out);
