/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foreign/listing.h"

#include <ctype.h>
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/path.h"
#include "base/text.h"
#include "dialect/source.h"

const char *const vs_listing_origins[VS_ORIGINS] = {"plain SPICE", "LTspice", "KiCad", "PSpice"};

/* ---- what is no netlist ---- */

/* Drawings and other files that are taken for netlists, with how to get one. */
static const struct drawing {
  const char *begins, *says;
} DRAWINGS[] = {
    {"Version 4", "is LTspice's drawing, no netlist: LTspice writes one by View, SPICE Netlist, or "
                  "as 'LTspice -netlist X.asc'"},
    {"(kicad_sch", "is KiCad's drawing, no netlist: 'kicad-cli sch export netlist --format spice "
                   "X.kicad_sch' writes one"},
    {"(export", "is KiCad's list of parts and nets, no netlist of SPICE's: export it with the "
                "format SPICE"},
    {"<?xml", "is no netlist of SPICE's"}};

static vs_status refuse_drawing(const char *path, const char *text, vs_error *err) {
  for (size_t k = 0; k < sizeof DRAWINGS / sizeof *DRAWINGS; k++)
    if (!strncmp(text, DRAWINGS[k].begins, strlen(DRAWINGS[k].begins)))
      return vs_fail_at(err, (vs_where){path, 1, 1}, "%s", DRAWINGS[k].says);
  return VS_OK;
}

/* ---- lines ---- */

bool vs_listing_is(const vs_card *card, const char *word) {
  size_t n = strlen(word);
  return !strncasecmp(card->text, word, n) && (!card->text[n] || strchr(" \t", card->text[n]));
}

/* Cuts what ends a line as a comment: from ';' on, or from a '$' between blanks. */
static void cut_comment(char *text) {
  size_t n = 0;
  for (; text[n] && text[n] != ';'; n++)
    if (text[n] == '$' && n > 0 && strchr(" \t", text[n - 1]) && strchr(" \t", text[n + 1])) break;
  while (n > 0 && isspace((unsigned char)text[n - 1])) n--;
  text[n] = '\0';
}

static vs_card *add_card(vs_listing *l, const char *line, vs_where where) {
  const char *text = line + where.column - 1;
  if ((l->count & (l->count + 1)) == 0) {
    l->cards = realloc(l->cards, (2 * l->count + 2) * sizeof *l->cards);
    if (!l->cards) vs_out_of_memory();
  }
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

/* Counts subcircuits. */
static void set_depth(vs_card *card, int *open) {
  if (vs_listing_is(card, ".subckt")) ++*open;
  card->depth = *open;
  if (vs_listing_is(card, ".ends") && *open > 0) --*open;
}

static vs_status add_file(vs_listing *l, const char *path, vs_error *err);

/* Takes in the file of a line that includes one, if it is there and was not taken yet. */
static vs_status follow(vs_listing *l, size_t card, vs_error *err) {
  char path[VS_PATH_SIZE];
  if (!vs_listing_finds(&l->cards[card], path) || !*path) return VS_OK;
  for (size_t k = 0; k < l->n_files; k++)
    if (!strcmp(l->files[k], path)) return VS_OK;
  return add_file(l, path, err);
}

/* Takes a line of a file. *last is the card that '+' would continue; SIZE_MAX: there is none. */
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

static vs_status add_lines(vs_listing *l, const char *file, const vs_source *source,
                           vs_error *err) {
  bool whole = l->n_files == 1; /* the netlist itself */
  bool commands = false;
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
    card->included = !whole;
    set_depth(card, &open);
    commands = commands || vs_listing_is(card, ".control");
    if (commands) card->kind = VS_CARD_COMMAND;
    if (vs_listing_is(card, ".endc")) commands = false;
    if (vs_listing_is(card, ".end")) break;
  }
  return !status && last != SIZE_MAX ? follow(l, last, err) : status;
}

static vs_status add_file(vs_listing *l, const char *path, vs_error *err) {
  if (l->n_files >= VS_LISTING_FILES)
    return vs_fail_at(err, (vs_where){.file = path}, "more than %d files", VS_LISTING_FILES);
  char *file = l->files[l->n_files++] = vs_copy(path);
  vs_source source = {0};
  vs_status status = vs_source_read(path, &source, err);
  if (!status && l->n_files == 1 && source.count)
    status = refuse_drawing(file, source.line[0], err);
  if (!status) status = add_lines(l, file, &source, err);
  vs_source_free(&source);
  return status;
}

bool vs_listing_finds(const vs_card *card, char *path) {
  if (!vs_listing_is(card, ".include") && !vs_listing_is(card, ".inc") &&
      !vs_listing_is(card, ".lib"))
    return false;
  char name[VS_PATH_SIZE / 2];
  const char *from = card->text + strcspn(card->text, " \t");
  from += strspn(from, " \t");
  char quote = *from == '"' || *from == '\'' ? *from++ : '\0';
  snprintf(name, sizeof name, "%.*s", (int)(quote ? strcspn(from, "\"'") : strcspn(from, " \t")),
           from);
  for (char *c = name; *c; c++)
    if (*c == '\\') *c = '/';
  const char *slash = strrchr(card->where.file, '/');
  int folder = slash && *name != '/' ? (int)(slash - card->where.file + 1) : 0;
  struct stat s;
  snprintf(path, VS_PATH_SIZE, "%.*s%s", folder, card->where.file, name);
  if (!*name || stat(path, &s) || !S_ISREG(s.st_mode)) *path = '\0';
  return true;
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

/* Error: the netlist is a deck of the program's already. */
static vs_status refuse_deck(const vs_listing *l, vs_error *err) {
  static const char *const WORDS[] = {"*$ port ", "*$ title ", "*$ probe ", "*$ param "};
  for (size_t k = 0; k < l->count; k++)
    for (size_t w = 0; w < sizeof WORDS / sizeof *WORDS; w++)
      if (!l->cards[k].included && !strncmp(l->cards[k].text, WORDS[w], strlen(WORDS[w])))
        return vs_fail_at(err, l->cards[k].where,
                          "this is a deck already: 'vibrospice check' tells what is wrong with it");
  return VS_OK;
}

vs_status vs_listing_read(vs_listing *l, const char *path, const char *library, vs_error *err) {
  vs_status status = add_file(l, path, err);
  if (!status) status = refuse_deck(l, err);
  if (status) return status;
  l->origin = find_origin(l);
  return library ? add_file(l, library, err) : VS_OK;
}

void vs_listing_free(vs_listing *l) {
  for (size_t k = 0; k < l->n_files; k++) free(l->files[k]);
  for (size_t k = 0; k < l->count; k++) {
    free(l->cards[k].text);
    free(l->cards[k].raw);
  }
  free(l->cards);
  *l = (vs_listing){0};
}
