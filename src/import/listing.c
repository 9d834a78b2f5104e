/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "import/listing.h"

#include <ctype.h>
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/jail.h"
#include "base/path.h"
#include "base/text.h"
#include "netlist/source.h"

const char *const vs_listing_origins[VS_ORIGINS] = {"plain SPICE", "LTspice", "KiCad", "PSpice"};

/* ---- what is no netlist ---- */

/* Drawings and other files that users mistake for netlists, and how to get a netlist from each. */
static const struct drawing {
  const char *begins, *says;
} DRAWINGS[] = {
    {"Version 4", "is LTspice's drawing, no netlist: LTspice writes one by View, SPICE Netlist, or "
                  "as 'LTspice -netlist X.asc'"},
    {"(kicad_sch", "is KiCad's drawing, no netlist: 'kicad-cli sch export netlist --format spice "
                   "X.kicad_sch' writes one"},
    {"EESchema Schematic",
     "is KiCad's drawing, no netlist: File, Export, Netlist, SPICE writes one"},
    {"*version ",
     "is a drawing of PSpice's Schematics, no netlist: Analysis, Create Netlist writes "
     "one, NAME.net"},
    {"<Qucs Schematic",
     "is Qucs' drawing, no netlist: 'qucs-s -n --ngspice -i X.sch -o X.cir' writes one"},
    {"$ 1 ", "is circuitjs' drawing, no netlist, and it writes none: draw it in LTspice or KiCad"},
    {"v {xschem", "is xschem's drawing, no netlist: 'xschem -n -q X.sch' writes one"},
    {"(export", "is KiCad's list of parts and nets, no netlist of SPICE's: export it with the "
                "format SPICE"},
    {"<?xml", "is no netlist of SPICE's"}};

static vs_status refuse_drawing(const char *path, const char *text, vs_error *err) {
  for (size_t k = 0; k < sizeof DRAWINGS / sizeof *DRAWINGS; k++)
    if (!strncmp(text, DRAWINGS[k].begins, strlen(DRAWINGS[k].begins)))
      return vs_fail_at(err, (vs_where){path, 1, 1}, "%s", DRAWINGS[k].says);
  return VS_OK;
}

/* ---- where an included file lies ---- */

bool vs_listing_is(const vs_card *card, const char *word) {
  return vs_words_begin(card->text, word);
}

vs_where vs_listing_place(const vs_card *card, const char *at) {
  vs_where where = card->where;
  if ((size_t)(at - card->text) + (size_t)where.column <= strcspn(card->raw, "\n"))
    where.column += vs_text_column(card->text, at) - 1;
  return where;
}

static bool is_file(const char *path) {
  struct stat s;
  return !stat(path, &s) && S_ISREG(s.st_mode);
}

/* Corrects the case of the name in `path` to that of a file in its folder. False: there is no such
 * file. */
static bool find_capitals(char *path) {
  char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
  char folder[VS_PATH_SIZE];
  bool found = false;
  snprintf(folder, sizeof folder, "%.*s", (int)(name - path), path);
  DIR *dir = opendir(*folder ? folder : ".");
  for (struct dirent *entry; !found && dir && (entry = readdir(dir));) {
    if (strcasecmp(entry->d_name, name)) continue;
    memcpy(name, entry->d_name, strlen(name)); /* as long as the other */
    found = is_file(path);
  }
  if (dir) closedir(dir);
  return found;
}

/* Looks for a file where its name says, then by its last part beside the file that includes it,
 * ignoring case: paths of another computer lead nowhere here, and Windows ignores case. */
static bool find_beside(const char *name, const char *by, char *path) {
  const char *slash = strrchr(by, '/'), *last = strrchr(name, '/');
  int folder = slash ? (int)(slash - by + 1) : 0;
  snprintf(path, VS_PATH_SIZE, "%.*s%s", *name != '/' ? folder : 0, by, name);
  if (is_file(path)) return true;
  snprintf(path, VS_PATH_SIZE, "%.*s%s", folder, by, last ? last + 1 : name);
  return is_file(path) || find_capitals(path);
}

bool vs_listing_finds(const vs_card *card, char *path) {
  static const char *const WORDS[] = {".include", ".inc", ".lib"};
  char name[VS_PATH_SIZE / 2];
  if (!VS_WORDS_AMONG(vs_words_at(card->text), WORDS)) return false;
  const char *from = card->text + strcspn(card->text, " \t");
  from += strspn(from, " \t");
  char quote = *from == '"' || *from == '\'' ? *from++ : '\0';
  snprintf(name, sizeof name, "%.*s", (int)(quote ? strcspn(from, "\"'") : strcspn(from, " \t")),
           from);
  for (char *c = name; *c; c++)
    if (*c == '\\') *c = '/';
  if (!*name || !find_beside(name, card->where.file, path)) *path = '\0';
  return true;
}

/* ---- lines ---- */

/* Cuts off a comment at the end of a line: from ';' on, or from a '$' between blanks. */
static void cut_comment(char *text) {
  size_t n = 0;
  for (; text[n] && text[n] != ';'; n++)
    if (text[n] == '$' && n > 0 && strchr(" \t", text[n - 1]) && strchr(" \t", text[n + 1])) break;
  while (n > 0 && isspace((unsigned char)text[n - 1])) n--;
  text[n] = '\0';
}

static vs_card *add_card(vs_listing *l, const char *line, vs_where where) {
  const char *text = line + where.column - 1;
  l->cards = vs_alloc_grow(l->cards, l->count, sizeof *l->cards);
  vs_card *card = &l->cards[l->count++];
  *card = (vs_card){.text = vs_copy(text), .raw = vs_copy(line), .where = where};
  card->kind = !*text || strchr("*;", *text) ? VS_CARD_COMMENT
               : *text == '.'                ? VS_CARD_STATEMENT
                                             : VS_CARD_ELEMENT;
  if (card->kind != VS_CARD_COMMENT) cut_comment(card->text);
  return card;
}

static void continue_card(vs_card *card, const char *line, const char *more) {
  vs_text text = {0}, raw = {0};
  vs_text_add(&text, "%s %s", card->text, more);
  vs_text_add(&raw, "%s\n%s", card->raw, line);
  free(card->text);
  free(card->raw);
  card->text = text.text;
  card->raw = raw.text;
  cut_comment(card->text);
}

/* Notes in how many open subcircuits the card stands. */
static void set_depth(vs_card *card, int *open) {
  if (vs_listing_is(card, ".subckt")) ++*open;
  card->depth = *open;
  if (vs_listing_is(card, ".ends") && *open > 0) --*open;
}

static vs_status add_file(vs_listing *l, const char *path, bool may_be_netlist, vs_error *err);

/* Turns a line that includes a part of the netlist into a comment, which says that the part
 * replaces it. */
static void write_replaced(vs_card *card) {
  vs_text text = {0};
  vs_text_add(&text, "* in the place of this line stands what it includes: %s", card->raw);
  free(card->raw);
  card->raw = text.text;
  card->kind = VS_CARD_COMMENT;
}

/* Reads the file that a line includes, if it exists and was not read before. A library of models,
 * .lib, is no part of the netlist, and neither is what a library includes. */
static vs_status follow(vs_listing *l, size_t card, vs_error *err) {
  char path[VS_PATH_SIZE];
  vs_card *c = &l->cards[card];
  if (c->kind == VS_CARD_ELEMENT) {
    vs_text text = {0};
    vs_status status = vs_source_points(c->text, c->where, &text, err);
    if (text.text) {
      free(c->text);
      free(c->raw);
      c->raw = vs_copy(text.text);
      c->text = text.text;
    }
    return status;
  }
  if (!vs_listing_finds(&l->cards[card], path) || !*path) return VS_OK;
  for (size_t k = 0; k < l->n_files; k++)
    if (!strcmp(l->files[k], path)) return VS_OK;
  bool may = !l->cards[card].included && l->cards[card].depth == 0 &&
             !vs_listing_is(&l->cards[card], ".lib");
  size_t first = l->count;
  vs_status status = vs_jail_check(path, l->cards[card].where, err);
  if (!status) status = vs_path_check_plain(path, l->cards[card].where, err);
  if (!status) status = add_file(l, path, may, err);
  if (may && first < l->count && !l->cards[first].included) write_replaced(&l->cards[card]);
  return status;
}

/* Adds a line of a file. *last is the card that a '+' would continue; SIZE_MAX: there is none. */
static vs_status add_line(vs_listing *l, char *line, vs_where where, size_t *last, vs_error *err) {
  const char *begin = line + where.column - 1;
  if (*begin == '+' && *last != SIZE_MAX) {
    continue_card(&l->cards[*last], line, begin + 1);
    return VS_OK;
  }
  vs_status status = VS_OK;
  if (*last != SIZE_MAX && !strchr("*;", *begin)) { /* nothing more can continue it */
    status = follow(l, *last, err);
    *last = SIZE_MAX;
  }
  if (add_card(l, line, where)->kind != VS_CARD_COMMENT) *last = l->count - 1;
  return status;
}

/* The first line of a netlist is its title, unless it is a comment. */
static bool take_title(vs_listing *l, const char *line) {
  line += strspn(line, " \t\f");
  if (!*line || *line == '*') return false;
  if (!strncasecmp(line, ".title", 6)) line += 6;
  snprintf(l->title, sizeof l->title, "%s", line + strspn(line, " \t"));
  return true;
}

/* True where the file has elements outside of subcircuits: it is then a part of the netlist, such
 * as the .net that an OrCAD profile includes. */
static bool has_elements(const vs_source *source) {
  int depth = 0;
  for (size_t k = 0; k < source->count; k++) {
    const char *s = source->line[k] + strspn(source->line[k], " \t\f");
    if (!strncasecmp(s, ".subckt", 7)) depth++;
    if (!strncasecmp(s, ".ends", 5)) depth--;
    if (depth <= 0 && isalpha((unsigned char)*s)) return true;
  }
  return false;
}

/* Blocks that describe no circuit, by their first and last lines. */
static const char *const BLOCKS[][2] = {{".control", ".endc"}, {".aliases", ".endaliases"}};

/* Marks the card if it is in such a block. *block is the open block; -1: there is none. */
static void mark_block(vs_card *card, int *block) {
  for (int k = 0; k < 2 && *block < 0; k++)
    if (vs_listing_is(card, BLOCKS[k][0])) *block = k;
  if (*block < 0) return;
  card->kind = VS_CARD_COMMAND;
  if (vs_listing_is(card, BLOCKS[*block][1])) *block = -1;
}

static vs_status add_lines(vs_listing *l, const vs_source *source, bool part, vs_error *err) {
  const char *file = l->files[l->n_files - 1];
  bool whole = l->n_files == 1; /* the netlist itself */
  int block = -1;
  int open = 0;
  size_t last = SIZE_MAX, before = l->count;
  vs_status status = VS_OK;
  for (size_t k = 0; k < source->count && !status; k++) {
    char *line = source->line[k];
    vs_where where = {file, (int)k + 1, (int)strspn(line, " \t\f") + 1};
    if (whole && k == 0 && take_title(l, line)) continue;
    vs_source_plain(line);
    status = add_line(l, line, where, &last, err);
    vs_card *card = &l->cards[l->count - 1];
    if (l->count == before || card->where.line != where.line || card->where.file != file) continue;
    card->included = !whole && !part;
    set_depth(card, &open);
    mark_block(card, &block);
    if (vs_listing_is(card, ".end")) break;
  }
  return !status && last != SIZE_MAX ? follow(l, last, err) : status;
}

/* `may_be_netlist`: if the file has elements it is a part of the netlist. */
static vs_status add_file(vs_listing *l, const char *path, bool may_be_netlist, vs_error *err) {
  if (l->n_files >= VS_LISTING_FILES)
    return vs_fail_at(err, (vs_where){.file = path}, "more than %d files", VS_LISTING_FILES);
  char *file = l->files[l->n_files++] = vs_copy(path);
  vs_source source = {0};
  vs_status status = vs_source_read(path, &source, err);
  if (!status && l->n_files == 1 && source.count)
    status = refuse_drawing(file, source.line[0], err);
  if (!status) status = add_lines(l, &source, may_be_netlist && has_elements(&source), err);
  vs_source_free(&source);
  return status;
}

/* ---- who wrote it ---- */

static bool has_word(const vs_listing *l, const char *word) {
  for (size_t k = 0; k < l->count; k++)
    if (!l->cards[k].included && strcasestr(l->cards[k].raw, word)) return true;
  return false;
}

static int find_origin(const vs_listing *l) {
  bool drawn = l->count && strcasestr(l->cards[0].raw, ".asc");
  if (drawn || has_word(l, ".backanno")) return VS_ORIGIN_LTSPICE;
  if (strcasestr(l->title, "kicad") || has_word(l, "Net-_")) return VS_ORIGIN_KICAD;
  if (strcasestr(l->title, "pspice") || has_word(l, "* source ") || has_word(l, ".probe") ||
      has_word(l, "params:") || has_word(l, ".stmlib") || has_word(l, "pspice"))
    return VS_ORIGIN_PSPICE;
  return VS_ORIGIN_PLAIN;
}

/* Error: the netlist is already a deck of this program. */
static vs_status refuse_deck(const vs_listing *l, vs_error *err) {
  static const char *const WORDS[] = {"*$ port ", "*$ title ", "*$ probe ", "*$ param "};
  for (size_t k = 0; k < l->count; k++)
    for (size_t w = 0; w < sizeof WORDS / sizeof *WORDS; w++)
      if (!l->cards[k].included && !strncmp(l->cards[k].text, WORDS[w], strlen(WORDS[w])))
        return vs_fail_at(err, l->cards[k].where,
                          "this is a deck already: 'vibrospice check' tells what is wrong with it");
  return VS_OK;
}

static void take_apart(vs_listing *l) {
  static char nothing[] = "";
  l->lines = vs_alloc(l->count, sizeof *l->lines);
  for (size_t k = 0; k < l->count; k++) {
    const vs_card *card = &l->cards[k];
    vs_words_unbrace(card->text);
    const bool of_netlist = card->kind == VS_CARD_ELEMENT || card->kind == VS_CARD_STATEMENT;
    l->lines[k] = (vs_line){.text = of_netlist ? card->text : nothing, .where = card->where};
  }
  vs_cards_read(&l->netlist, l->lines, l->count);
}

vs_status vs_listing_read(vs_listing *l, const char *path, const char *library, vs_error *err) {
  vs_status status = add_file(l, path, false, err);
  if (!status) status = refuse_deck(l, err);
  if (status) return status;
  l->origin = find_origin(l);
  if (library) status = add_file(l, library, false, err);
  take_apart(l);
  return status;
}

void vs_listing_free(vs_listing *l) {
  vs_cards_free(&l->netlist);
  free(l->lines);
  for (size_t k = 0; k < l->n_files; k++) free(l->files[k]);
  for (size_t k = 0; k < l->count; k++) {
    free(l->cards[k].text);
    free(l->cards[k].raw);
  }
  free(l->cards);
  *l = (vs_listing){0};
}
