/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the fuzzers of this folder share. A target is one reader of the program, with a function
 * that gives it any bytes. The reader must return: no crash, no leak, no exit, nothing that takes
 * seconds. tests/fuzz/README.md says how targets are run. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "base/path.h"

typedef struct fuzz_grammar fuzz_grammar;

typedef struct fuzz_target {
  const char *name;
  /* Gives the text to the reader. A zero byte stands behind its end; it may have others. */
  void (*take)(const char *text, size_t size);
  const fuzz_grammar *grammar; /* of what the target reads; NULL: bytes are changed as they come */
  /* Makes a changed text such as its reader looks into at all, as by mending its checksums. The
   * text has room for `most` bytes; returns its new size. NULL: nothing is to be mended. */
  size_t (*mend)(char *text, size_t size, size_t most);
} fuzz_target;

/* All targets, for the test that takes the corpora. NULL ends them. */
extern const fuzz_target *const fuzz_targets[];

/* Call it once. Scenes that name no machine or deck then get those of tests/fuzz/library. */
void fuzz_begin(void);

/* Gives any bytes to a target. */
void fuzz_take(const fuzz_target *target, const uint8_t *bytes, size_t size);

/* ---- files ---- */

/* A folder of this process' own, which is removed at its end. */
const char *fuzz_folder(void);

/* Writes the file fuzz_folder()/name, and its path. */
void fuzz_write(const char *name, const char *text, size_t size, char path[VS_PATH_SIZE]);

/* Writes several files, of which the text is made. The first is called `first`. A line "%%% NAME"
 * begins another one, where NAME is one of `others`, whose last is NULL. Those of `others` that the
 * text does not have are removed. path is that of the first. */
void fuzz_write_all(const char *text, size_t size, const char *first, const char *const *others,
                    char path[VS_PATH_SIZE]);

/* ---- what a reader returns ---- */

/* Aborts where a reader breaks its word: a status other than VS_OK and VS_INPUT, an error without a
 * text or with a line break. With VS_FUZZ_PLACES set in the environment it prints messages that
 * name no line. */
void fuzz_judge(vs_status status, const vs_error *err);

/* Calls read(path, NULL), as `run` would, and where that fails for some of the texts also
 * read(path, findings), as `check` would, which goes on behind mistakes. */
void fuzz_read(vs_status (*read)(const char *path, vs_findings *all), const char *path,
               size_t size);

/* Aborts, and says what does not hold. */
#define FUZZ_HOLDS(good)                                                                           \
  do {                                                                                             \
    if (!(good)) fuzz_broken(__FILE__, __LINE__, #good);                                           \
  } while (0)
_Noreturn void fuzz_broken(const char *file, int line, const char *what);

/* ---- grammars ---- */

/* A context-free grammar of lines. In a form '@x' stands for any form of the rule x, and "@@" for
 * '@'; everything else stands for itself. Rule 'L' makes a line. Where the text is one of several
 * files (fuzz_write_all), rule 'F' makes the line that begins one. */
typedef struct fuzz_rule {
  char name;
  const char *const *forms; /* NULL ends them */
} fuzz_rule;
struct fuzz_grammar {
  const fuzz_rule *rules;
  size_t count;
};

/* Changes some lines of a text by the grammar: adds, doubles, removes, moves lines, and puts words
 * in the place of words. The text has room for `most` bytes. Returns its new size. */
size_t fuzz_grammar_change(const fuzz_grammar *grammar, char *text, size_t size, size_t most,
                           unsigned seed);

extern const fuzz_grammar fuzz_grammar_deck, fuzz_grammar_part, fuzz_grammar_netlist,
    fuzz_grammar_yaml;
