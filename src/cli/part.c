/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `part`: a template of a part's file, to be filled in from a data sheet. */
#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/path.h"
#include "commands.h"
#include "options.h"
#include "wrap.h"

typedef struct part_line {
  vs_arguments common;
  const char *wrap; /* FILE or FILE:NAME of a vendor's; NULL: a model of the program's own */
  const char *pins; /* of the vendor's subcircuit, by letters; NULL: it is to be found out */
  bool overwrite;
} part_line;

static const vs_shelf SHELF = {"template of a part", "templates", ".inc"};
static const char WRAPPED[] = "_wrapped";

/* ---- names ---- */

/* What stands in a template for what is only known when it is written, and what takes its place. */
enum { NAME, SUBCKT, FILE_NAME, CALLED, VENDOR, CALL, PINS, DIALECT, WORDS };
static const char *const WORD[WORDS] = {"@NAME@",   "@SUBCKT@", "@FILE@", "@CALLED@",
                                        "@VENDOR@", "@CALL@",   "@PINS@", "@DIALECT@"};

static const char *base_of(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

/* The part's name: the file's own, without its ending. It becomes a subcircuit's name and the
 * beginning of parameters' names, so that few characters are allowed, and at most half of the bytes
 * that a name may have: parameters add a word to it. */
static vs_status read_name(const char *output, char name[VS_WRAP_NAME], vs_error *err) {
  const char *base = base_of(output);
  size_t n = strlen(base), ending = strlen(SHELF.ending);
  bool good =
      n > ending && !strcmp(base + n - ending, SHELF.ending) && n - ending < VS_WRAP_NAME / 2;
  for (size_t k = 0; good && k < n - ending; k++)
    good = isalnum((unsigned char)base[k]) || (k > 0 && base[k] == '_');
  if (!good || !isalpha((unsigned char)*base))
    return vs_fail(
        err, VS_INPUT,
        "-o %s: a file NAME.inc is wanted, NAME of letters, digits and '_', at most %d of "
        "them, a letter first",
        output, VS_WRAP_NAME / 2 - 1);
  snprintf(name, VS_WRAP_NAME, "%.*s", (int)(n - ending), base);
  return VS_OK;
}

/* ---- writing ---- */

static void add_filled_line(const char *line, const char *const with[WORDS], vs_text *text) {
  while (*line) {
    int word = 0;
    while (word < WORDS && strncmp(line, WORD[word], strlen(WORD[word]))) word++;
    if (word < WORDS)
      vs_text_add(text, "%s", with[word]);
    else
      vs_text_add(text, "%c", *line);
    line += word < WORDS ? strlen(WORD[word]) : 1;
  }
}

/* The template without its first line, which names the program's licence: what is filled in is the
 * user's own. */
static vs_status fill_in_template(const char *path, const char *const with[WORDS], vs_text *text,
                                  vs_error *err) {
  FILE *f = fopen(path, "r");
  if (!f) return vs_fail(err, VS_RUN, "%s: cannot be read: %s", path, strerror(errno));
  char *line = NULL;
  size_t size = 0;
  for (int n = 0; vs_alloc_line(&line, &size, f) >= 0; n++)
    if (n > 0) add_filled_line(line, with, text);
  vs_status status = vs_file_was_read(f, path, err);
  free(line);
  fclose(f);
  return status;
}

static vs_status write_part(const char *output, const vs_text *text, vs_error *err) {
  char folder[VS_PATH_SIZE];
  vs_file file;
  snprintf(folder, sizeof folder, "%.*s", (int)(base_of(output) - output), output);
  size_t n = strlen(folder);
  if (n > 1) folder[n - 1] = '\0';
  vs_status status = vs_file_open(&file, folder, base_of(output), err);
  if (status) return status;
  fwrite(text->text, 1, text->length, file.stream);
  return vs_file_commit(&file, err);
}

/* ---- kinds ---- */

static void add_kind(void *ctx, const char *path) {
  const char *base = base_of(path);
  if (strstr(base, WRAPPED)) return;
  vs_text_add(ctx, "  %.*s\n", (int)strcspn(base, "."), base);
}

static void add_wrapped_kind(void *ctx, const char *path) {
  const char *base = base_of(path), *end = strstr(base, WRAPPED);
  vs_text *kinds = ctx;
  if (end) vs_text_add(kinds, "%s%.*s", kinds->length ? ", " : "", (int)(end - base), base);
}

/* What is looked for on the shelf, and its path; empty: it is not there. */
typedef struct wanted {
  const char *name;
  char path[VS_PATH_SIZE];
} wanted;

static void take_template(void *ctx, const char *path) {
  wanted *w = ctx;
  const char *base = base_of(path);
  size_t n = strlen(w->name);
  if (!*w->path && !strncmp(base, w->name, n) && !strcmp(base + n, SHELF.ending))
    snprintf(w->path, sizeof w->path, "%s", path);
}

/* Finds the template of the kind. Error: there is none; the message says which there are. */
static vs_status find_template(const part_line *o, char path[VS_PATH_SIZE], vs_error *err) {
  const char *kind = vs_command_name(&o->common);
  char name[VS_WRAP_NAME];
  snprintf(name, sizeof name, "%.40s%s", kind, o->wrap ? WRAPPED : "");
  wanted w = {.name = name};
  if (!strstr(kind, WRAPPED)) vs_path_list(&SHELF, take_template, &w);
  memcpy(path, w.path, VS_PATH_SIZE);
  if (*path) return VS_OK;
  if (!o->wrap)
    return vs_fail(err, VS_INPUT, "part: '%s' is no kind with a template; see vibrospice part",
                   kind);
  vs_text kinds = {0};
  vs_path_list(&SHELF, add_wrapped_kind, &kinds);
  vs_status status = vs_fail(
      err, VS_INPUT, "part --wrap: no template of '%s' around a vendor's model; there are: %s",
      kind, kinds.text ? kinds.text : "none");
  vs_text_free(&kinds);
  return status;
}

/* Adds the kinds there are, one a line, for --help. */
static void explain_kinds(vs_text *help) {
  vs_text_add(help, "\nKinds:\n");
  vs_path_list(&SHELF, add_kind, help);
}

static vs_status print_template_kinds(void) {
  vs_text kinds = {0};
  vs_path_list(&SHELF, add_kind, &kinds);
  printf("%s", kinds.text ? kinds.text : "");
  vs_text_free(&kinds);
  return VS_OK;
}

/* ---- the command ---- */

static vs_status write_template(const part_line *o, const char *path, const char name[VS_WRAP_NAME],
                                vs_error *err) {
  const char *kind = vs_command_name(&o->common), *output = o->common.output;
  char subckt[VS_WRAP_NAME] = {0};
  vs_wrap wrap = {0};
  vs_text text = {0};
  for (size_t k = 0; name[k]; k++) subckt[k] = (char)tolower((unsigned char)name[k]);
  vs_status status = VS_OK;
  if (o->wrap)
    status = vs_wrap_find(o->wrap, kind, o->pins, (const char *[]){output, subckt}, &wrap, err);
  if (!status && wrap.second)
    fprintf(
        stderr,
        "%s:%d:1: warning: a second .subckt %s: ngspice takes the first, of line %d, and so does "
        "the part; leave one out, or give it another name\n",
        wrap.path, wrap.second, wrap.called, wrap.line);
  const char *const with[WORDS] = {
      name,      subckt,    base_of(output), wrap.called,
      wrap.file, wrap.call, wrap.pins,       wrap.pspice ? "*$ compat ps\n" : ""};
  if (!status) status = fill_in_template(path, with, &text, err);
  if (!status) status = write_part(output, &text, err);
  if (!status && !o->common.quiet)
    printf("%s: fill in the numbers marked assumed, then: vibrospice check %s\n", output, output);
  vs_text_free(&text);
  return status;
}

/* Writes the template. Errors: VS_INPUT, there is no such kind, the name is none for a part, the
 * file is there already, the vendor's file has no such subcircuit; VS_RUN, it cannot be written. */
static vs_status part_command(const void *given, vs_error *err) {
  const part_line *o = given;
  const char *output = o->common.output;
  char path[VS_PATH_SIZE], name[VS_WRAP_NAME];
  if (!vs_command_name(&o->common)) return print_template_kinds();
  vs_status status = find_template(o, path, err);
  if (status) return status;
  if (o->pins && !o->wrap)
    return vs_fail(err, VS_INPUT,
                   "part: --pins says which pin of a vendor's subcircuit is what, and "
                   "goes with --wrap FILE:NAME");
  if (!output) return vs_fail(err, VS_INPUT, "part: wants -o NAME.inc; see vibrospice part --help");
  status = read_name(output, name, err);
  if (status) return status;
  if (!o->overwrite && !access(output, F_OK))
    return vs_fail(err, VS_INPUT, "%s: is there already; another name or --overwrite is wanted",
                   output);
  return write_template(o, path, name, err);
}

static const vs_option PART_OPTIONS[] = {
    VS_OPTIONS_OUTPUT("NAME.inc", "writes the template there; NAME is the part's"),
    VS_OPTIONS_WORD(part_line, wrap, "wrap", "FILE[:SUBCKT]",
                    "around the subcircuit of a vendor's file, instead of a model of the "
                    "program's own, where the kind has such a template"),
    VS_OPTIONS_WORD(
        part_line, pins, "pins", "LETTERS",
        "with --wrap: which of its pins is what, in their order, as akg of a thyristor, "
        "2g1 of a triac, dgs, cge"),
    VS_OPTIONS_FLAG(part_line, overwrite, "overwrite", "replaces a file that is there already"),
    VS_OPTIONS_FLAG(vs_arguments, quiet, "quiet", "prints nothing"),
    VS_OPTIONS_END};

const vs_command vs_part_cli = {
    .name = "part",
    .argument = "[KIND]",
    .text = "writes a template of a part, to be filled in from its data sheet; without KIND: which "
            "kinds there are",
    .examples = "  vibrospice part thyristor -o my.inc && vibrospice check my.inc -o bench\n"
                "  vibrospice part thyristor --wrap vendor.lib:NAME -o my.inc\n",
    .may_be_alone = true,
    .options = PART_OPTIONS,
    .size = sizeof(part_line),
    .run = part_command,
    .explain = explain_kinds};
