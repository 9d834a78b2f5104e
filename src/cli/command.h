/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a command of the program is, and how the words behind it become its arguments. */
#ifndef VS_CLI_COMMAND_H
#define VS_CLI_COMMAND_H

#include <argp.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"
#include "base/text.h"

/* What stands behind a command. All words are borrowed from the command line; a word that was not
 * given is NULL. */
typedef struct vs_arguments {
  char **names; /* those that are no options: a scene, a kind, folders */
  size_t n_names;
  char **sets; /* KEY=VALUE of each --set, and of each shortcut of it */
  size_t n_sets;
  const char *tier, *output, *deck, *machine, *overlay, *shard, *of, *to, *along, *step, *at,
      *profile, *mains, *gate, *coil, *pins, *library, *scene, *wrap, *probe, *from, *format;
  bool json, all, quiet, reproducible, raw, corners, list, deep, help, resume, overwrite, keep_runs,
      progress_json, steady, no_sharing, linear, allow_code, fft, orbit, jail, no_jail, again;
  int digits; /* 1..17 */
  int jobs;   /* 0: not given */
  int period; /* 1 or more */
  double timeout_s;
} vs_arguments;

/* The first name; NULL: there is none. */
const char *vs_command_name(const vs_arguments *arguments);

/* One command: a plug of the program's table. */
typedef struct vs_command {
  const char *name, *text;
  const char *argument; /* what is to stand behind it: "SCENE" */
  const char *examples; /* whole lines, for --help */
  bool may_be_alone;    /* the argument may be left out */
  bool takes_many;      /* arguments */
  bool results; /* its arguments are folders of results: in the jail, and ngspice is not called */
  bool jailed;  /* in the jail (base/jail.h) unless --no-jail says otherwise */
  const struct argp_option *options; /* made of the macros below; ended by {0} */
  vs_status (*run)(const vs_arguments *arguments, vs_error *err);
  void (*explain)(vs_text *help); /* adds to --help, behind the examples; NULL: nothing */
} vs_command;

/* The keys of options that have no letter of their own. */
enum {
  VS_KEY_JSON = 256,
  VS_KEY_QUIET,
  VS_KEY_REPRODUCIBLE,
  VS_KEY_DIGITS,
  VS_KEY_RAW,
  VS_KEY_CORNERS,
  VS_KEY_SET,
  VS_KEY_TIER,
  VS_KEY_DECK,
  VS_KEY_MACHINE,
  VS_KEY_OVERLAY,
  VS_KEY_LIST,
  VS_KEY_JOBS,
  VS_KEY_PERIOD,
  VS_KEY_STEADY,
  VS_KEY_OF,
  VS_KEY_TO,
  VS_KEY_ALONG,
  VS_KEY_STEP,
  VS_KEY_AT,
  VS_KEY_SHARD,
  VS_KEY_RESUME,
  VS_KEY_OVERWRITE,
  VS_KEY_TIMEOUT,
  VS_KEY_PROGRESS,
  VS_KEY_KEEP,
  VS_KEY_ALONE,
  VS_KEY_PROFILE,
  VS_KEY_MAINS,
  VS_KEY_GATE,
  VS_KEY_COIL,
  VS_KEY_PINS,
  VS_KEY_LIBRARY,
  VS_KEY_SCENE,
  VS_KEY_LINEAR,
  VS_KEY_ALLOW_CODE,
  VS_KEY_WRAP,
  VS_KEY_ALL,
  VS_KEY_DEEP,
  VS_KEY_UNTIL,
  VS_KEY_TOLERANCE,
  VS_KEY_ANGLE,
  VS_KEY_PROBE,
  VS_KEY_FROM,
  VS_KEY_FFT,
  VS_KEY_ORBIT,
  VS_KEY_FORMAT,
  VS_KEY_JAIL,
  VS_KEY_NO_JAIL,
  VS_KEY_AGAIN
};

/* Rows of vs_command.options: an option that takes a value, and one that takes none. */
#define VS_COMMAND_VALUE(name, key, value, text)                                                   \
  { name, key, value, 0, text, 0 }
#define VS_COMMAND_FLAG(name, key, text)                                                           \
  { name, key, NULL, 0, text, 0 }
#define VS_COMMAND_HELP                                                                            \
  { "help", 'h', NULL, 0, "prints this and ends", -1 }
#define VS_COMMAND_SET                                                                             \
  VS_COMMAND_VALUE("set", VS_KEY_SET, "KEY=VALUE",                                                 \
                   "sets a scene key over what the file says; may stand several times")
/* Shortcuts: an option that sets one scene key, as --set KEY=VALUE does. */
#define VS_COMMAND_UNTIL                                                                           \
  VS_COMMAND_VALUE("until", VS_KEY_UNTIL, "T", "the same as --set run.until=T")
#define VS_COMMAND_TOLERANCE                                                                       \
  VS_COMMAND_VALUE("tolerance", VS_KEY_TOLERANCE, "X", "the same as --set run.tolerance=X")
#define VS_COMMAND_ANGLE                                                                           \
  VS_COMMAND_VALUE("angle", VS_KEY_ANGLE, "A", "the same as --set firing.angle=A, as 95deg")
#define VS_COMMAND_JSON                                                                            \
  VS_COMMAND_FLAG("json", VS_KEY_JSON, "JSON on standard output instead of the table")
#define VS_COMMAND_QUIET                                                                           \
  VS_COMMAND_FLAG("quiet", VS_KEY_QUIET, "no table, no warnings, no progress")
#define VS_COMMAND_ALLOW_CODE                                                                      \
  VS_COMMAND_FLAG("allow-code", VS_KEY_ALLOW_CODE,                                                 \
                  "lets a scene run code of its own: a control with the law object or pipe")
#define VS_COMMAND_JAIL                                                                            \
  VS_COMMAND_FLAG("jail", VS_KEY_JAIL,                                                             \
                  "for a stranger's files: what they name is read only from the folder of the "    \
                  "file that you give, from the working directory if it holds that file, and "     \
                  "from what comes with the program; of a folder of results, only what lies in "   \
                  "it; no network, no code of their own. check, plot, compare and merge do so "    \
                  "always")
#define VS_COMMAND_NO_JAIL                                                                         \
  VS_COMMAND_FLAG("no-jail", VS_KEY_NO_JAIL, "reads every file that the given one names")

/* Runs the command whose name is argv[1] with what stands behind it, or prints its help. Prints one
 * line on standard error where it fails. Writes into argv[1]. */
vs_status vs_command_run(const vs_command *command, int argc, char **argv);

#endif
