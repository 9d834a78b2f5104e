/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "import/listing.h"

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

const char *const vs_listing_origins[VS_ORIGINS] = {"plain SPICE", "LTspice", "KiCad", "PSpice"};

/* ---- text ---- */

/* Adds a character as UTF-8. */
static void add_character(vs_text *t, unsigned c) {
  if (c < 0x80)
    vs_text_add(t, "%c", (int)c);
  else if (c < 0x800)
    vs_text_add(t, "%c%c", (int)(0xc0 | c >> 6), (int)(0x80 | (c & 0x3f)));
  else
    vs_text_add(t, "%c%c%c", (int)(0xe0 | c >> 12), (int)(0x80 | (c >> 6 & 0x3f)),
                (int)(0x80 | (c & 0x3f)));
}

/* Turns the bytes of a file into UTF-8 without marks; an end of text, Ctrl-Z, ends it. */
static void decode(const unsigned char *bytes, size_t size, vs_text *out) {
  bool little = size >= 2 && bytes[0] == 0xff && bytes[1] == 0xfe;
  bool big = size >= 2 && bytes[0] == 0xfe && bytes[1] == 0xff;
  bool marked = size >= 3 && !memcmp(bytes, "\xef\xbb\xbf", 3);
  bool utf8 = !vs_text_not_utf8((const char *)bytes, size);
  vs_text_add(out, "%s", "");
  for (size_t k = little || big ? 2 : marked ? 3 : 0; k < size; k++) {
    unsigned c = bytes[k];
    if ((little || big) && k + 1 < size) {
      c = little ? bytes[k] | (unsigned)bytes[k + 1] << 8 : (unsigned)bytes[k] << 8 | bytes[k + 1];
      k++;
    }
    if (c == 0x1a) break;
    if (c == '\0') c = ' ';
    if (utf8 && !little && !big)
      vs_text_add(out, "%c", (int)c);
    else
      add_character(out, c);
  }
}

static vs_status read_text(const char *path, vs_text *out, vs_error *err) {
  const vs_where place = {.file = path};
  struct stat s;
  if (!stat(path, &s) && !S_ISREG(s.st_mode)) return vs_fail_at(err, place, "is no file of text");
  FILE *f = fopen(path, "rb");
  if (!f) return vs_fail_at(err, place, "cannot be opened: %s", strerror(errno));
  char part[4096], *bytes = NULL;
  size_t size = 0, n;
  while ((n = fread(part, 1, sizeof part, f)) > 0) {
    bytes = realloc(bytes, size + n);
    if (!bytes) vs_out_of_memory();
    memcpy(bytes + size, part, n);
    size += n;
  }
  bool bad = ferror(f);
  fclose(f);
  if (!bad) decode((const unsigned char *)bytes, size, out);
  free(bytes);
  return bad ? vs_fail_at(err, place, "cannot be read") : VS_OK;
}

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

static vs_status add_lines(vs_listing *l, const char *file, char *text, vs_error *err) {
  bool whole = l->n_files == 1; /* the netlist itself, whose first line is its title */
  int open = 0, number = 0;
  bool commands = false;
  size_t last = SIZE_MAX; /* the card that '+' would continue */
  vs_status status = VS_OK;
  for (char *line; !status && (line = strsep(&text, "\n"));) {
    number++;
    line[strcspn(line, "\r")] = '\0';
    vs_where where = {file, number, (int)strspn(line, " \t\f") + 1};
    const char *begin = line + where.column - 1;
    if (*begin == '+' && last != SIZE_MAX) {
      continue_card(&l->cards[last], line, begin + 1);
      continue;
    }
    if (last != SIZE_MAX && !strchr("*;", *begin)) { /* nothing more can continue it */
      status = follow(l, last, err);
      last = SIZE_MAX;
    }
    if (whole && number == 1 && *begin != '*' && *begin) {
      const char *title = !strncasecmp(begin, ".title", 6) ? begin + 6 : begin;
      snprintf(l->title, sizeof l->title, "%s", title + strspn(title, " \t"));
      continue;
    }
    vs_card *card = add_card(l, line, where);
    card->included = !whole;
    set_depth(card, &open);
    commands = commands || vs_listing_is(card, ".control");
    if (commands) card->kind = VS_CARD_COMMAND;
    if (vs_listing_is(card, ".endc")) commands = false;
    if (card->kind != VS_CARD_COMMENT) last = l->count - 1;
    if (vs_listing_is(card, ".end")) break;
  }
  return !status && last != SIZE_MAX ? follow(l, last, err) : status;
}

static vs_status add_file(vs_listing *l, const char *path, vs_error *err) {
  if (l->n_files >= VS_LISTING_FILES)
    return vs_fail_at(err, (vs_where){.file = path}, "more than %d files", VS_LISTING_FILES);
  char *file = l->files[l->n_files++] = vs_copy(path);
  vs_text text = {0};
  vs_status status = read_text(path, &text, err);
  if (!status && l->n_files == 1) status = refuse_drawing(file, text.text, err);
  if (!status) status = add_lines(l, file, text.text, err);
  vs_text_free(&text);
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

vs_status vs_listing_read(vs_listing *l, const char *path, const char *library, vs_error *err) {
  vs_status status = add_file(l, path, err);
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
