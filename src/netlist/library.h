/* SPDX-License-Identifier: GPL-3.0-or-later
 * Libraries that a deck includes. Of a maker's file only the subcircuits and models are read that
 * something calls, so that a slip in another part of it is no error of the deck's. */
#pragma once

#include <stdbool.h>

#include "base/names.h"
#include "netlist/line.h"
#include "netlist/source.h"

/* A subcircuit outside of all others, or a model, with the lines of its file from `from` up to
 * before `to`, counted from 0. */
typedef struct vs_library_block {
  size_t file; /* index into vs_library.file */
  size_t from, to;
  size_t before; /* 1 + the number of an earlier block of the same name; 0: there is none */
  bool called;
} vs_library_block;

typedef struct vs_library_file {
  const char *name; /* borrowed */
  vs_source source;
} vs_library_file;

/* What is there to be called. Begins as {0}; ends with vs_library_free. */
typedef struct vs_library {
  vs_library_file *file;
  size_t n_files;
  vs_library_block *block;
  size_t n_blocks;
  vs_names names; /* of the blocks, each with the last one's number */
  size_t *called; /* numbers of the blocks that are called, in the order of the calls */
  size_t n_called, n_taken;
  size_t n_lines; /* lines of the deck that have been looked through */
} vs_library;

/* Finds the blocks of a file. Returns for each of its lines whether it is in one, which the caller
 * frees; the source is then the library's. Returns NULL where the file has no block. */
bool *vs_library_add(vs_library *lib, const char *name, const vs_source *source);

/* Calls the blocks of that name. */
void vs_library_call(vs_library *lib, vs_word name);

/* Returns the next block that is called by the lines of the deck, or by vs_library_call, and has
 * not been returned; NULL: there is none. A word of that name anywhere in a line calls. */
const vs_library_block *vs_library_next(vs_library *lib, const vs_line *lines, size_t count);

void vs_library_free(vs_library *lib);
