/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "library.h"

#include <stdlib.h>
#include <string.h>

#include "netlist/words.h"

/* ---- what is in a file ---- */

/* A file while its blocks are found. */
typedef struct cutting {
  vs_library *lib;
  const vs_source *source;
  bool nested; /* subcircuits may stand in others: each .subckt of the file has its .ends */
  bool *within;
} cutting;

static const char *line_of(const cutting *c, size_t k) {
  return c->source->line[k] + strspn(c->source->line[k], " \t");
}

/* How many subcircuits are open behind line k, where `depth` are before it. */
static int depth_behind(const cutting *c, size_t k, int depth) {
  return depth + vs_words_begin(line_of(c, k), ".subckt") - vs_words_begin(line_of(c, k), ".ends");
}

/* True where all subcircuits are closed. */
static bool is_closed(const cutting *c) {
  int depth = 0;
  for (size_t k = 0; k < c->source->count && depth >= 0; k++) depth = depth_behind(c, k, depth);
  return depth == 0;
}

/* The line behind the subcircuit that begins with line k: behind its .ends, or where the next
 * subcircuit begins that cannot stand in it. */
static size_t behind_subcircuit(const cutting *c, size_t k) {
  int depth = depth_behind(c, k++, 0);
  for (; k < c->source->count && depth > 0; k++) {
    if (!c->nested && vs_words_begin(line_of(c, k), ".subckt")) break;
    depth = depth_behind(c, k, depth);
  }
  return k;
}

/* The line behind the last one that goes on with line k. */
static size_t behind_statement(const cutting *c, size_t k) {
  size_t last = k;
  for (k++; k < c->source->count && (!*line_of(c, k) || strchr("+*", *line_of(c, k))); k++)
    if (*line_of(c, k) == '+') last = k;
  return last + 1;
}

/* Adds the block that begins with line k, and returns the line behind it. What has a line
 * "*$ WORD", a model with sizes of its own (nmos.1) and what has no name is no block: it is read
 * where it stands. */
static size_t add_block(cutting *c, size_t k, bool model) {
  vs_library *lib = c->lib;
  const size_t to = model ? behind_statement(c, k) : behind_subcircuit(c, k);
  const vs_word word = vs_words_at(vs_words_next(line_of(c, k)));
  bool is = word.n && !(model && memchr(word.at, '.', word.n));
  for (size_t n = k; n < to; n++)
    is = is &&
         (strncmp(line_of(c, n), "*$", 2) || !line_of(c, n)[2 + strspn(line_of(c, n) + 2, " \t")]);
  if (!is) return to;
  for (size_t n = k; n < to; n++) c->within[n] = true;
  size_t other;
  const bool again = vs_names_find(&lib->names, word.at, word.n, &other);
  lib->block = vs_alloc_grow(lib->block, lib->n_blocks, sizeof *lib->block);
  lib->block[lib->n_blocks] = (vs_library_block){lib->n_files, k, to, again ? other + 1 : 0, false};
  vs_names_put(&lib->names, word.at, word.n, lib->n_blocks++);
  return to;
}

bool *vs_library_add(vs_library *lib, const char *name, const vs_source *source) {
  const size_t before = lib->n_blocks;
  cutting c = {lib, source, false, vs_alloc(source->count + 1, sizeof *c.within)};
  c.nested = is_closed(&c);
  int conditions = 0;
  for (size_t k = 0; k < source->count && !vs_words_begin(line_of(&c, k), ".end");) {
    const char *line = line_of(&c, k);
    const bool model = vs_words_begin(line, ".model");
    conditions += vs_words_begin(line, ".if") - vs_words_begin(line, ".endif");
    k = conditions == 0 && (model || vs_words_begin(line, ".subckt")) ? add_block(&c, k, model)
                                                                      : k + 1;
  }
  if (lib->n_blocks == before) {
    free(c.within);
    return NULL;
  }
  lib->file = vs_alloc_grow(lib->file, lib->n_files, sizeof *lib->file);
  lib->file[lib->n_files++] = (vs_library_file){name, *source};
  return c.within;
}

/* ---- what is called ---- */

/* Of several blocks of one name the first of the file is read first: ngspice takes it. */
void vs_library_call(vs_library *lib, vs_word name) {
  size_t k, from = lib->n_called;
  if (!vs_names_find(&lib->names, name.at, name.n, &k)) return;
  for (size_t next = k + 1; next && !lib->block[next - 1].called; next = lib->block[k].before) {
    k = next - 1;
    lib->block[k].called = true;
    lib->called = vs_alloc_grow(lib->called, lib->n_called, sizeof *lib->called);
    lib->called[lib->n_called++] = k;
  }
  for (size_t to = lib->n_called; from + 1 < to; from++) {
    k = lib->called[from];
    lib->called[from] = lib->called[--to];
    lib->called[to] = k;
  }
}

/* The words of a line are looked up as they are, and what stands behind a colon: AKO:NAME. */
static void look_through(vs_library *lib, const vs_line *line) {
  static const char ENDS[] = VS_WORDS_BETWEEN "={}'\"";
  const char *s = line->written ? line->written : line->text;
  for (; *(s += strspn(s, ENDS)); s += strcspn(s, ENDS)) {
    const vs_word word = {s, strcspn(s, ENDS)};
    const char *colon = memchr(s, ':', word.n);
    vs_library_call(lib, word);
    if (colon) vs_library_call(lib, (vs_word){colon + 1, word.n - (size_t)(colon + 1 - s)});
  }
}

const vs_library_block *vs_library_next(vs_library *lib, const vs_line *lines, size_t count) {
  for (; lib->n_blocks && lib->n_lines < count; lib->n_lines++)
    look_through(lib, &lines[lib->n_lines]);
  return lib->n_taken < lib->n_called ? &lib->block[lib->called[lib->n_taken++]] : NULL;
}

void vs_library_free(vs_library *lib) {
  for (size_t k = 0; k < lib->n_files; k++) vs_source_free(&lib->file[k].source);
  free(lib->file);
  free(lib->block);
  free(lib->called);
  vs_names_free(&lib->names);
  *lib = (vs_library){0};
}
