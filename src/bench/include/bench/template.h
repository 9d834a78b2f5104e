/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `part`: a file to be filled in from a data sheet. */
#ifndef VS_BENCH_TEMPLATE_H
#define VS_BENCH_TEMPLATE_H

#include <stdbool.h>

#include "base/error.h"
#include "base/text.h"

typedef struct vs_template_options {
  const char *kind;   /* NULL: prints which kinds there are */
  const char *output; /* the file to be; its name without ending is the part's */
  const char *wrap;   /* FILE or FILE:NAME of a vendor's; NULL: a model of the program's own */
  bool overwrite, quiet;
} vs_template_options;

/* Writes the template. Errors: VS_INPUT, there is no such kind, the name is none for a part, the
 * file is there already, the vendor's file has no such subcircuit; VS_RUN, it cannot be written. */
vs_status vs_template_command(const vs_template_options *options, vs_error *err);

/* Adds the kinds there are, one a line, for --help. */
void vs_template_explain(vs_text *help);

#endif
