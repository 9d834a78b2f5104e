/* SPDX-License-Identifier: GPL-3.0-or-later
 * Rows of a command's table of options, and what commands have in common. type, member: where a row
 * puts its value, in the command's struct. */
#pragma once

#include "command.h"
#include "engine/tiers.h"
#include "run/result.h"
#include "study/format.h"

/* The offset of a member of a command's struct, which has to be of that type. */
#define VS_OPTIONS_AT(type, member, of)                                                            \
  _Generic(((type *)NULL)->member, of : offsetof(type, member))

/* Rows of vs_command.options: a flag; a word; a word that names a file; a whole number; an option
 * with one value alone. type, member: where it goes. */
#define VS_OPTIONS_FLAG(type, member, called, says)                                                \
  { .name = called, .text = says, .read = vs_command_flag, .at = VS_OPTIONS_AT(type, member, bool) }
#define VS_OPTIONS_WORD(type, member, called, takes, says)                                         \
  {                                                                                                \
    .name = called, .value = takes, .text = says, .read = vs_command_word,                         \
    .at = VS_OPTIONS_AT(type, member, const char *)                                                \
  }
#define VS_OPTIONS_FILE(type, member, called, takes, says)                                         \
  {                                                                                                \
    .name = called, .value = takes, .text = says, .read = vs_command_word, .names_file = true,     \
    .at = VS_OPTIONS_AT(type, member, const char *)                                                \
  }
#define VS_OPTIONS_WHOLE(type, member, from, to, called, takes, says)                              \
  {                                                                                                \
    .name = called, .value = takes, .text = says, .read = vs_command_whole, .least = from,         \
    .most = to, .at = VS_OPTIONS_AT(type, member, int)                                             \
  }
#define VS_OPTIONS_ONLY(type, member, called, takes, says)                                         \
  {                                                                                                \
    .name = called, .value = takes, .text = says, .read = vs_command_only,                         \
    .at = VS_OPTIONS_AT(type, member, bool)                                                        \
  }
/* An option whose value the command reads by a function of its own. */
#define VS_OPTIONS_OWN(type, member, of, reader, called, takes, says)                              \
  {                                                                                                \
    .name = called, .value = takes, .text = says, .read = reader,                                  \
    .at = VS_OPTIONS_AT(type, member, of)                                                          \
  }

/* Rows that several commands have alike; END: the last one, and the end of the table. */
#define VS_OPTIONS_END                                                                             \
  {.name = "help",                                                                                 \
   .letter = 'h',                                                                                  \
   .text = "prints this and ends",                                                                 \
   .read = vs_command_flag,                                                                        \
   .at = offsetof(vs_arguments, help)},                                                            \
  {                                                                                                \
    0                                                                                              \
  }
#define VS_OPTIONS_OUTPUT(takes, says)                                                             \
  {                                                                                                \
    .name = "output", .letter = 'o', .value = takes, .text = says, .read = vs_command_word,        \
    .at = offsetof(vs_arguments, output)                                                           \
  }
#define VS_OPTIONS_SET                                                                             \
  {                                                                                                \
    .name = "set", .value = "KEY=VALUE", .read = vs_command_set,                                   \
    .text = "sets a scene key over what the file says; may stand several times"                    \
  }
/* Shortcuts: an option that sets one scene key, as --set KEY=VALUE does. */
#define VS_OPTIONS_UNTIL                                                                           \
  {                                                                                                \
    .name = "until", .value = "T", .read = vs_command_shortcut, .key = "run.until",                \
    .text = "the same as --set run.until=T"                                                        \
  }
#define VS_OPTIONS_TOLERANCE                                                                       \
  {                                                                                                \
    .name = "tolerance", .value = "X", .read = vs_command_shortcut, .key = "run.tolerance",        \
    .text = "the same as --set run.tolerance=X"                                                    \
  }
#define VS_OPTIONS_ANGLE                                                                           \
  {                                                                                                \
    .name = "angle", .value = "A", .read = vs_command_shortcut, .key = "firing.angle",             \
    .text = "the same as --set firing.angle=A, as 95deg"                                           \
  }
#define VS_OPTIONS_JSON                                                                            \
  VS_OPTIONS_FLAG(vs_arguments, json, "json", "JSON on standard output instead of the table")
#define VS_OPTIONS_QUIET                                                                           \
  VS_OPTIONS_FLAG(vs_arguments, quiet, "quiet", "no table, no warnings, no progress")
#define VS_OPTIONS_ALLOW_CODE                                                                      \
  VS_OPTIONS_FLAG(vs_arguments, allow_code, "allow-code",                                          \
                  "lets a scene run code of its own: a control with the law object or pipe")
#define VS_OPTIONS_JAIL                                                                            \
  VS_OPTIONS_FLAG(vs_arguments, jail, "jail",                                                      \
                  "for a stranger's files: what they name is read only from the folder of the "    \
                  "file that you give, from the working directory if it holds that file, and "     \
                  "from what comes with the program; of a folder of results, only what lies in "   \
                  "it; no network, no code of their own. check, plot, compare and merge do so "    \
                  "always"),                                                                       \
      VS_OPTIONS_FLAG(vs_arguments, no_jail, "no-jail",                                            \
                      "reads every file that the given one names")

#define VS_OPTIONS_TIER(type, member)                                                              \
  VS_OPTIONS_WORD(type, member, "tier", "NAME", VS_TIER_WORDS "; over the scene's run.tier")
#define VS_OPTIONS_REPRODUCIBLE(type, member)                                                      \
  VS_OPTIONS_FLAG(type, member, "reproducible", "leaves the cost (wall time) out of summary.json")
#define VS_OPTIONS_ALL(type, member)                                                               \
  VS_OPTIONS_FLAG(type, member, "all",                                                             \
                  "the table leaves nothing out: every line of the verdict, every measure")
#define VS_OPTIONS_DIGITS(type, member)                                                            \
  VS_OPTIONS_WHOLE(type, member, 1, 17, "digits", "N",                                             \
                   "significant digits in CSV, 1 to 17 (default 9; 17 is exact)")
#define VS_OPTIONS_FORMAT(type, member)                                                            \
  VS_OPTIONS_WORD(type, member, "format", VS_FORMAT_WORDS,                                         \
                  "how the rows are written (default csv); see below")

/* What `run` and `steady` have in common. */
typedef struct vs_run_options {
  const char *scene, *tier; /* as for vs_scene_read */
  const char *folder;       /* for the files; NULL: none are written */
  char *const *sets;        /* KEY=VALUE of each --set */
  size_t n_sets;
  bool json;                /* prints JSON instead of the table */
  bool all;                 /* the table leaves nothing out */
  bool quiet;               /* no table, no warnings, no progress */
  bool why;                 /* tells what makes the violated lines, or the weakest one */
  bool reproducible;        /* leaves the cost out of summary.json */
  bool raw;                 /* writes run.raw, too, which wants a folder and the circuit tier */
  bool allow_code;          /* the scene may run code of its own */
  bool corners;             /* runs the corners of the scene's key spread besides */
  const vs_corners *judged; /* what these came to; NULL: they were not run. The command sets it */
  int digits;               /* significant ones in CSV files, 1..17 */
  const volatile sig_atomic_t *stop; /* set by a signal: the run ends and keeps what there is */
} vs_run_options;

/* What they make of the line alike. asked: what their own options said. */
vs_run_options vs_options_of_run(const vs_run_options *asked, const vs_arguments *line);

/* Adds the formats of --format to --help. */
void vs_options_explain_formats(vs_text *help);
