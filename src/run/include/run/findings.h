/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the command `check` is asked, and what its hooks find out. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"
#include "base/text.h"
#include "netlist/deck.h"
#include "run/warnings.h"

/* What is found out about a part, a deck or a scene by looking through it or trying it. */
typedef struct vs_check_bench {
  vs_text
      table;    /* lines to stand behind the one that describes the part, each begun by a newline */
  vs_text rows; /* for --json: an object with file, line, column, message and more on each line */
  size_t figures, off;   /* how many were held to what is asked, and how many are not so */
  vs_warnings *warnings; /* gets what is implausible; borrowed */
} vs_check_bench;

typedef struct vs_check_options vs_check_options;
struct vs_check_options {
  const char *name; /* a path, or the name of a scene, or else of a deck or machine, that comes with
                      the program */
  char *const *sets; /* KEY=VALUE of each --set; for scenes only */
  size_t n_sets;
  bool json;  /* findings as a JSON array on standard output */
  bool quiet; /* prints nothing but findings */
  /* Hook for another kind of file, such as studies. On success it appends one line to `good` that
   * describes the file. NULL: the file is a scene, a deck, a machine or a part. */
  vs_status (*other)(const vs_check_options *options, vs_text *good, vs_error *err);
  /* Hook that tries a part which has no findings. NULL: a part is read and no more. */
  vs_status (*bench)(const vs_check_options *options, vs_check_bench *bench, vs_error *err);
  const char *folder; /* for that hook: where its files go; NULL: it writes none */
  /* Hook that looks through the circuit of a deck or scene, also where the solver cannot begin with
   * it. NULL: nobody does. */
  void (*look)(const vs_check_options *options, const vs_deck *deck, vs_check_bench *bench);
  bool deep; /* a deck or scene without findings is tried by the hook below */
  vs_status (*trial)(const vs_check_options *options, bool is_deck, vs_check_bench *bench,
                     vs_error *err);
};
