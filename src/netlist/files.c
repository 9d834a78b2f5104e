/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "files.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/jail.h"
#include "base/text.h"
#include "dialect/functions.h"
#include "dialect/translate.h"
#include "library.h"
#include "lint/slips.h"
#include "netlist/catalogue.h"
#include "netlist/contract.h"
#include "netlist/source.h"
#include "netlist/statements.h"
#include "netlist/words.h"
#include "rules.h"

/* Where includes are found that are not beside the file that includes them. */
static const vs_shelf INCLUDE_SHELF = {"include file", "", ""},
                      PARTS_SHELF = {"include file", "parts", ""};

static vs_status read_file(vs_deck *deck, const char *path, bool library, vs_error *err);

bool vs_files_has(const vs_deck *deck, const char *path) {
  for (size_t k = 0; k < deck->n_files; k++)
    if (!strcmp(deck->files[k], path)) return true;
  return false;
}

/* Reads the name in a line ".include FILE", in quotes or not. */
static vs_status include_name(const char *line, vs_where where, char name[VS_PATH_SIZE / 2],
                              vs_error *err) {
  const char *from = line + strcspn(line, " \t");
  from += strspn(from, " \t");
  char quote = *from == '"' || *from == '\'' ? *from++ : '\0';
  size_t n = quote ? strcspn(from, (char[]){quote, '\0'}) : strcspn(from, " \t");
  const char *after = from + n + (quote && from[n] == quote);
  const char *more = after + strspn(after, " \t");
  if (*more && n && vs_words_begin(line, ".lib"))
    return vs_fail_at(
        err, where,
        "sections of libraries, as %.*s, are not read; copy what the circuit needs of "
        "it into a file of its own and write '.include FILE'",
        (int)strcspn(more, " \t"), more);
  if (n == 0 || n >= VS_PATH_SIZE / 2 || *more)
    return vs_fail_at(err, where, "'.include FILE' is wanted here, one file and nothing more");
  snprintf(name, VS_PATH_SIZE / 2, "%.*s", (int)n, from);
  return VS_OK;
}

static bool is_same_file(const char *a, const char *b) {
  struct stat left, right;
  return !stat(a, &left) && !stat(b, &right) && left.st_dev == right.st_dev &&
         left.st_ino == right.st_ino;
}

static bool is_shipped(const char *name, char path[VS_PATH_SIZE]) {
  return vs_path_shipped(&INCLUDE_SHELF, name, path) || vs_path_shipped(&PARTS_SHELF, name, path);
}

/* Finds a file by its name in the folder of the file `where`, else among those that come with the
 * program; never in the working directory. Of a path of Windows', which programs write into
 * netlists for their own libraries, the file's name alone is looked for; a library that is not
 * there is told, and *path is empty: ngspice names what it misses then. A file that has the name of
 * what it includes means the one that comes with the program. *ours: it is one that does. */
static vs_status find_include(vs_deck *deck, const char *name, vs_where where,
                              char path[VS_PATH_SIZE], bool *ours, vs_error *err) {
  const char *slash = strrchr(where.file, '/'), *back = strrchr(name, '\\');
  const char *base = back ? back + 1 : name;
  snprintf(path, VS_PATH_SIZE, "%.*s%s", slash && *base != '/' ? (int)(slash - where.file + 1) : 0,
           where.file, base);
  char shipped[VS_PATH_SIZE];
  vs_status status = vs_jail_check(path, where, err);
  if (status) return status;
  *ours = true;
  if (is_same_file(path, where.file) && is_shipped(base, shipped)) {
    snprintf(path, VS_PATH_SIZE, "%s", shipped);
    return VS_OK;
  }
  *ours = false;
  for (size_t k = 0; k < deck->n_files; k++) /* what is beside a file of the program's own */
    *ours = *ours || (deck->files[k] == where.file && deck->included[k].file);
  if (!access(path, R_OK)) return vs_path_check_plain(path, where, err);
  *ours = true;
  if (is_shipped(base, path)) return vs_jail_check(path, where, err);
  if (!back) {
    const char *looked = *base == '/' ? "not a file" : "not beside the file that includes it";
    return vs_path_find_shipped(&INCLUDE_SHELF, base, where, looked, path, err);
  }
  *path = '\0';
  vs_deck_remark(deck, where,
                 "%s is not on this machine, and skipped; if the circuit needs a model of it, copy "
                 "%s beside the deck",
                 name, base);
  return VS_OK;
}

/* What is known of a file, whatever dialect the deck is read in: that it is PSpice's or IsSpice's.
 */
static bool is_of(const vs_deck *deck, const bool of[VS_DECK_FILES], const char *file) {
  for (size_t k = 0; k < deck->n_files; k++)
    if (deck->files[k] == file) return of[k];
  return false;
}

/* The same file may go by several paths. */
static bool has_been_read(const vs_deck *deck, const char *path) {
  for (size_t k = 0; k < deck->n_files; k++)
    if (is_same_file(deck->files[k], path)) return true;
  return false;
}

/* Takes in the file of a line ".include FILE", from the folder of the file it stands in, else from
 * those that come with the program. ngspice does not include it itself, so that its lines are held
 * to the same rules. A file is taken in once, as two parts may rest on the same one; within a
 * subcircuit its lines are the subcircuit's own, and it is taken in each time. */
static vs_status include(vs_deck *deck, const char *line, vs_where where, vs_error *err) {
  char name[VS_PATH_SIZE / 2], path[VS_PATH_SIZE];
  bool ours = false;
  vs_status status = include_name(line, where, name, err);
  if (!status) status = find_include(deck, name, where, path, &ours, err);
  if (status || !*path) return status;
  if (is_same_file(path, where.file))
    return vs_fail_at(err, where, "%s includes itself; leave this line out", where.file);
  if (deck->subcircuits == 0 && has_been_read(deck, path)) return VS_OK;
  if (deck->n_files >= VS_DECK_FILES)
    return vs_fail_at(err, where, "more than %d files; does one include itself?", VS_DECK_FILES);
  deck->included[deck->n_files] = ours ? where : (vs_where){0};
  deck->pspice[deck->n_files] = !vs_deck_is_shipped(path) && is_of(deck, deck->pspice, where.file);
  return read_file(deck, path, true, err);
}

/* Adds lines that one of that place needs besides, each ended by a newline. */
static void add_more(vs_deck *deck, vs_where where, char *rest) {
  for (char *more; rest && (more = strsep(&rest, "\n"));) {
    vs_line beside = {0};
    if (!*more) continue;
    vs_line_join(&beside, more, where);
    vs_deck_add_line(deck, beside);
  }
}

/* Adds a line to the netlist as ngspice is to be given it, and those that it needs besides. */
static void add_rewritten(vs_deck *deck, vs_line line, vs_rewriting *r) {
  if (strcmp(r->text.text, line.text)) vs_line_change(&line, vs_copy(r->text.text));
  vs_deck_add_line(deck, line);
  add_more(deck, line.where, r->more.text);
}

/* Holds a line to the rules, rewrites it and adds it to the netlist; *skip: or passes it by. */
static vs_status take_circuit(vs_deck *deck, vs_line *line, bool *skip, vs_error *err) {
  const char letter = (char)tolower((unsigned char)*line->text);
  const bool judged = strchr(".xkefghvi", letter); /* by its words; most lines, by their letter */
  vs_netlist_card bare = {.letter = letter, .name = vs_words_at(line->text)};
  vs_cards one = {.lines = line, .card = &bare};
  if (judged) vs_cards_read(&one, line, 1);
  vs_status status = *line->text == '.' ? vs_rules_statement(deck, &one, skip, err)
                                        : vs_rules_element(deck, &one, err);
  if (!status && !*skip) status = vs_slips_line(&one, err);
  if (judged) vs_cards_free(&one);
  if (status || *skip) return status;
  vs_rewriting r = {.line = line,
                    .pspice = *deck->compat != 0,
                    .isspice = is_of(deck, deck->isspice, line->where.file),
                    .own = deck->own_functions,
                    .tally = &deck->changes,
                    .err = err};
  status = vs_translate(&r);
  if (!status) add_rewritten(deck, *line, &r);
  vs_rewriting_free(&r);
  return status;
}

/* Takes a line, joined with those that continue it, into the deck. The line is the deck's then, or
 * freed. */
static vs_status take_line_into_deck(vs_deck *deck, vs_line line, vs_error *err) {
  const char *text = line.text;
  char word[16];
  snprintf(word, sizeof word, "%.*s", (int)strcspn(text, " \t"), text);
  vs_cursor_lower(word);
  bool other_file = !strcmp(word, ".include") || !strcmp(word, ".inc") || !strcmp(word, ".lib");
  bool skip = other_file;
  vs_status status = other_file ? include(deck, text, line.where, err)
                                : vs_rules_random(&line, *deck->compat != 0, err);
  if (!status && !other_file) status = take_circuit(deck, &line, &skip, err);
  if (status && (other_file || (*text != '.' && !isalpha((unsigned char)*text))))
    deck->lost |= VS_LOST_ALL; /* it may have been anything */
  else if (status && (*text != '.' || !strcmp(word, ".subckt") || !strncmp(word, ".if", 3)))
    deck->lost |= VS_LOST_ELEMENT;
  if (status || skip) vs_line_free(&line);
  return status;
}

/* A file while it is read. */
typedef struct reading {
  vs_line line;       /* that may still be continued; no text: there is none */
  bool library;       /* the file is included: others may use "*$" for themselves there */
  size_t unknown;     /* lines of it that begin with "*$" and are none of the contract's */
  vs_where unknown_1; /* the first of these */
  const vs_catalogue_part *row; /* the file is a row of a table; NULL: it is none */
  char word[24];                /* what stands in it */
  bool *unread;                 /* for each line of a library: it is read only if it is called;
                                   owned; NULL: all are read */
  size_t prose;                 /* lines of the library that are no lines of a netlist */
  vs_where prose_1;
} reading;

/* True for a line of a library, outside of its subcircuits, that is neither element nor statement,
 * or closes what is not open. "Copyright A 1995" would be a capacitor. */
static bool is_prose(const vs_deck *deck, const reading *r, const char *text) {
  if (!r->unread || deck->subcircuits) return false;
  if (*text == '.') return vs_words_begin(text, ".ends");
  return !vs_rules_is_element(text) || vs_statements_is_title(text) ||
         vs_words_begin(text, "copyright");
}

/* Takes the line begun, if there is one, as whole. */
static vs_status end_line(vs_deck *deck, reading *r, vs_error *err) {
  vs_line line = r->line;
  r->line = (vs_line){0};
  if (line.text && is_prose(deck, r, line.text)) {
    if (r->prose++ == 0) r->prose_1 = line.where;
    vs_line_free(&line);
    return VS_OK;
  }
  return line.text ? vs_error_keep(err, take_line_into_deck(deck, line, err)) : VS_OK;
}

/* Cuts the end of a line that ngspice takes for a comment: from ';' or '//' on, or from a '$'
 * behind a blank or comma (in PSpice's dialect that is a name). */
static void cut_comment(const vs_deck *deck, char *text) {
  size_t n = 0;
  for (; text[n]; n++) {
    bool parted = n > 0 && strchr(" \t,", text[n - 1]);
    if (text[n] == ';' || (text[n] == '/' && text[n + 1] == '/') ||
        (text[n] == '$' && parted && !*deck->compat))
      break;
  }
  while (n > 0 && strchr(" \t", text[n - 1])) n--;
  text[n] = '\0';
}

/* Finds a node of PSpice's, as $N_0001, which begins a comment but in PSpice's dialect. */
static const char *find_dollar(const vs_deck *deck, const char *text) {
  for (const char *s = text; !*deck->compat && (s = strchr(s, '$')); s++)
    if (s > text && strchr(" \t", s[-1]) && strchr("NnGgDd", s[1]) && s[1] && s[2] == '_') return s;
  return NULL;
}

/* Reads a line that begins with "*$". Alone that is a comment: PSpice's libraries have it between
 * their parts. */
static vs_status read_contract(vs_deck *deck, const char *line, vs_where where, reading *r,
                               vs_error *err) {
  const char *word = line + where.column + 1;
  word += strspn(word, " \t");
  if (!*word) return VS_OK;
  if (!r->library || vs_contract_knows(word)) return vs_contract_line(deck, line, where, err);
  if (r->unknown++ == 0) {
    r->unknown_1 = where;
    snprintf(r->word, sizeof r->word, "%.*s", (int)strcspn(word, " \t"), word);
  }
  return VS_OK;
}

/* True for the first line of a deck if it is the title; deck->title is that then. */
static bool is_title(vs_deck *deck, const char *text, vs_where where) {
  if (where.line != 1 || !deck->has_title_line || deck->n_files > 1) return false;
  if (!vs_statements_is_title(text)) return false;
  snprintf(deck->title, sizeof deck->title, "%s", text);
  vs_deck_remark(deck, where,
                 "taken for the title, which is what the first line of a netlist is; an element "
                 "would have to stand below it");
  return true;
}

/* Reads a line of a file. The line of the netlist that it begins lasts as long as lines with '+'
 * follow. */
static vs_status read_line(vs_deck *deck, char *line, vs_where where, reading *r, vs_error *err) {
  char *text = line + where.column - 1;
  for (const char *c = line; *c; c++)
    if ((unsigned char)*c < ' ' && *c != '\t') {
      where.column = vs_text_column(line, c);
      return vs_fail_at(err, where, "a control character (%d)", *c);
    }
  if (!strncmp(text, "*$", 2)) return read_contract(deck, line, where, r, err);
  if (is_title(deck, text, where)) return VS_OK;
  const char *dollar = *text != '*' ? find_dollar(deck, text) : NULL;
  if (dollar) {
    where.column = vs_text_column(line, dollar);
    return vs_fail_at(err, where,
                      "%.*s begins a comment here; with a line '*$ compat ps' it is a node, as in "
                      "PSpice",
                      (int)strcspn(dollar, " \t"), dollar);
  }
  if (*text != '*') cut_comment(deck, text);
  if (!*text || *text == '*') return VS_OK;
  if (strncasecmp(text, ".inc", 4) && strncasecmp(text, ".lib", 4)) vs_source_plain(text);
  if (*text == '+') {
    if (!r->line.text) return vs_fail_at(err, where, "'+' goes on with a line, and there is none");
    where.column++;
    vs_line_join(&r->line, text + 1, where);
    return VS_OK;
  }
  vs_status status = end_line(deck, r, err);
  vs_line_join(&r->line, text, where);
  return status;
}

/* Passes by what stands behind a line '.end', where every program ends. */
static void skip_rest(vs_deck *deck, const char *file, const vs_source *source, size_t from) {
  for (size_t k = from; k < source->count; k++) {
    const char *text = source->line[k] + strspn(source->line[k], " \t");
    if (!*text || (*text == '*' && text[1] != '$')) continue;
    vs_statements_skip(&deck->skipped, "all that stands behind '.end'",
                       (vs_where){file, (int)k + 1, 1});
    return;
  }
}

/* Blanks before it count for nothing. */
static bool is_statement(const char *line, const char *word) {
  return vs_words_begin(line + strspn(line, " \t"), word);
}

/* Reads the lines of a file from k up to before `end`. Commands from .control to .endc are refused
 * with their first line. */
static vs_status read_lines(vs_deck *deck, const char *file, const vs_source *source, size_t k,
                            size_t end, reading *r, vs_error *err) {
  vs_status status = VS_OK;
  const size_t count = end;
  for (; k < end && !status; k++) {
    if (r->unread && r->unread[k]) continue;
    char *line = source->line[k];
    bool commands = is_statement(line, ".control");
    vs_where where = {file, r->row ? r->row->line[k] : (int)k + 1, (int)strspn(line, " \t") + 1};
    const int *column = r->row ? r->row->column + (line - source->text) : NULL;
    deck->column = column && *column ? column : NULL;
    if (is_statement(line, ".end")) end = k;
    status = vs_error_keep(err, read_line(deck, line, where, r, err));
    deck->column = NULL;
    while (commands && k + 1 < end && !is_statement(source->line[k], ".endc")) k++;
  }
  if (!status) status = end_line(deck, r, err);
  if (!status && end < count) skip_rest(deck, file, source, end + 1);
  if (r->unknown)
    vs_deck_remark(deck, r->unknown_1,
                   "'*$ %s' is none of the contract's lines and taken for a comment (%zu such %s "
                   "in this file)",
                   r->word, r->unknown, r->unknown == 1 ? "line" : "lines");
  if (r->prose)
    vs_deck_remark(deck, r->prose_1,
                   "%zu lines outside of this library's subcircuits are no elements and no "
                   "statements, and passed by; the first is here",
                   r->prose);
  return status;
}

/* Finds the dialect and the functions that the file defines, which say how every line is read,
 * those before their own too. What else that
 * line may say is found when it is read. */
static void find_dialect(vs_deck *deck, const vs_source *source) {
  char word[8], name[8], more;
  for (size_t k = 0; k < source->count; k++) {
    const char *line = source->line[k], *brace = strchr(line, '{');
    vs_functions_own(line, &deck->own_functions);
    if (brace && vs_words_begin(line, ".subckt") && !memchr(line, '=', (size_t)(brace - line)))
      deck->isspice[deck->n_files - 1] = true;
    if (strstr(source->line[k], "*$") && strstr(source->line[k], "compat") &&
        sscanf(source->line[k], " *$ %7s %7s %c", word, name, &more) == 2 &&
        !strcmp(word, "compat") && !strcmp(name, "ps")) {
      memcpy(deck->compat, "ps", sizeof "ps");
      deck->pspice[deck->n_files - 1] = true;
    }
  }
}

/* A deck's lines stay in memory as long as it does, each with some hundred bytes. */
enum { MOST_LINES = 250000 };

static vs_status read_file(vs_deck *deck, const char *path, bool library, vs_error *err) {
  if (deck->n_files >= VS_DECK_FILES)
    return vs_fail_at(err, (vs_where){.file = path}, "more than %d files; does one include itself?",
                      VS_DECK_FILES);
  const char *file = deck->files[deck->n_files++] = vs_copy(path);
  vs_catalogue_part row = {0};
  vs_source source = {0};
  const bool is_row = vs_catalogue_is_row(path);
  vs_status status =
      is_row ? vs_catalogue_read(path, &row, err) : vs_source_read(path, &source, err);
  if (is_row) source = row.source;
  if (!status && deck->n_lines + source.count > MOST_LINES)
    status = vs_fail_at(err, (vs_where){.file = file},
                        "with it the deck has more than %d lines; copy what the circuit needs of "
                        "it into a file of its own",
                        MOST_LINES);
  bool kept = false;
  if (!status) {
    reading r = {.library = library, .row = is_row ? &row : NULL};
    find_dialect(deck, &source);
    const bool ours = is_row || deck->included[deck->n_files - 1].file || vs_deck_is_shipped(file);
    if (library && deck->n_files > 1 && !ours && !deck->subcircuits)
      r.unread = vs_library_add(deck->library, file, &source);
    kept = r.unread;
    status = read_lines(deck, file, &source, 0, source.count, &r, err);
    vs_line_free(&r.line);
    free(r.unread);
  }
  if (kept) return status;
  if (is_row)
    vs_catalogue_free(&row);
  else
    vs_source_free(&source);
  return status;
}

/* Writes the last pwr(x, y) of the line so that the sign of x is kept in every dialect. False:
 * there is none. */
static bool keep_sign(vs_line *line) {
  vs_word a[VS_WORDS_MOST];
  const char *at = NULL, *end;
  for (const char *s = line->text; (s = strcasestr(s, "pwr(")); s++)
    if ((s == line->text || !vs_words_goes_on(s[-1])) && vs_words_arguments(s + 3, a, &end) == 2)
      at = s;
  if (!at || vs_words_arguments(at + 3, a, &end) != 2) return false;
  vs_text text = {0};
  vs_text_add(&text, "%.*s(sgn(%.*s)*pow(abs(%.*s),%.*s))%s", (int)(at - line->text), line->text,
              (int)a[0].n, a[0].at, (int)a[0].n, a[0].at, (int)a[1].n, a[1].at, end);
  vs_line_change(line, text.text);
  return true;
}

/* One part in PSpice's dialect has ngspice read the whole deck in it, and there pwr(x, y) has no
 * sign, which the varistors of a deck that is not PSpice's need. */
static void keep_signs(vs_deck *deck) {
  for (size_t k = 0; k < deck->n_lines && *deck->compat; k++)
    while (!is_of(deck, deck->pspice, deck->lines[k].where.file) && keep_sign(&deck->lines[k]))
      continue;
}

/* Warns of pwr() in a netlist that others' constructs were found in: it keeps the sign of x here.
 */
static void tell_pwr(vs_deck *deck) {
  if (*deck->compat || deck->changes.count == 0) return;
  for (size_t k = 0; k < deck->n_lines; k++) {
    const vs_line *line = &deck->lines[k];
    const char *text = line->written ? line->written : line->text, *s = text;
    while ((s = strcasestr(s, "pwr(")) && s > text && vs_words_goes_on(s[-1])) s++;
    if (!s) continue;
    vs_deck_remark(
        deck, vs_line_place(line, s),
        "pwr(x, y) is sgn(x)*|x|^y in ngspice; if this netlist is LTspice's or PSpice's, "
        "it is |x|^y, for which write pow(x, y)");
    return;
  }
}

/* Says what was skipped and what was changed in the files that were read. */
static void tell_skipped(vs_deck *deck) {
  vs_text warning = {0};
  if (vs_statements_warn(&deck->skipped, &warning))
    vs_deck_remark(deck, deck->skipped.first, "%s", warning.text);
  vs_text_free(&warning);
  vs_statements_free(&deck->skipped);
  for (size_t k = 0; k < deck->changes.count; k++) {
    char text[512];
    vs_tally_tell(&deck->changes, k, text, sizeof text);
    vs_deck_remark(deck, deck->changes.item[k].first, "%s", text);
  }
  tell_pwr(deck);
  deck->changes.count = 0;
}

static vs_status check_closed(vs_deck *deck, vs_error *err) {
  if (deck->subcircuits == 0) return VS_OK;
  deck->subcircuits = 0;
  deck->lost |= VS_LOST_ELEMENT; /* of what stands behind it, it is not known where that belongs */
  return vs_error_keep(
      err, vs_fail_at(err, deck->subcircuit,
                      "this .subckt has no .ends that closes it; write one behind its last line"));
}

static vs_status read_block(vs_deck *deck, const vs_library *lib, const vs_library_block *b,
                            vs_error *err) {
  const vs_library_file file = lib->file[b->file];
  reading r = {.library = true};
  vs_status status = read_lines(deck, file.name, &file.source, b->from, b->to, &r, err);
  vs_line_free(&r.line);
  return status ? status : check_closed(deck, err);
}

/* Reads what the deck's lines call of the libraries that it includes, and what that calls. */
static vs_status read_called(vs_deck *deck, vs_error *err) {
  const vs_library_block *b;
  vs_status status = VS_OK;
  while (!status && (b = vs_library_next(deck->library, deck->lines, deck->n_lines)))
    status = read_block(deck, deck->library, b, err);
  return status;
}

static vs_status read_currents(vs_deck *deck, vs_error *err) {
  vs_text more = {0};
  vs_status status = vs_translate_currents(deck->lines, deck->n_lines, &more, err);
  if (more.text) add_more(deck, (vs_where){deck->files[0], 1, 1}, more.text);
  vs_deck_changed(deck);
  vs_text_free(&more);
  return status;
}

void vs_files_tell_unread(vs_deck *deck) {
  const vs_library *lib = deck->library;
  vs_deck *apart = vs_alloc(1, sizeof *apart);
  vs_findings *found = vs_alloc(1, sizeof *found);
  vs_error own = {.findings = found}, first = {0};
  const char *file = NULL;
  size_t count = 0;
  for (size_t k = 0; k < lib->n_blocks; k++) {
    if (lib->block[k].called) continue;
    vs_deck_begin(apart);
    memcpy(apart->compat, deck->compat, sizeof apart->compat);
    found->count = 0;
    if (read_block(apart, lib, &lib->block[k], &own) || found->count) count++;
    if (count == 1 && !*first.text) {
      first = found->count ? found->item[0] : own;
      file = lib->file[lib->block[k].file].name;
    }
    vs_deck_free(apart);
  }
  if (count)
    vs_deck_remark(deck, (vs_where){file, first.line, first.column},
                   "passed by, as nothing calls what this stands in (%zu subcircuits and models "
                   "that nothing calls have slips): %s",
                   count, first.text + first.place_size);
  free(found);
  free(apart);
}

vs_status vs_files_call(vs_deck *deck, const char *path, vs_error *err) {
  size_t n;
  const char *name = vs_catalogue_name(path, &n);
  vs_library_call(deck->library, (vs_word){name, n});
  return read_called(deck, err);
}

vs_status vs_files_read(vs_deck *deck, const char *path, bool library, vs_error *err) {
  const size_t before = deck->n_lines;
  vs_status status = read_file(deck, path, library, err);
  const vs_status closed = status ? VS_OK : check_closed(deck, err);
  if (!status && !closed) status = vs_files_call(deck, path, err);
  if (!status && !deck->lost && deck->n_lines > before)
    status =
        vs_error_keep(err, vs_slips_conditions(deck->lines + before, deck->n_lines - before, err));
  if (!status && !closed) status = read_currents(deck, err);
  vs_translate_whole(deck->lines, deck->n_lines, &deck->changes);
  keep_signs(deck);
  vs_deck_changed(deck);
  tell_skipped(deck);
  return status ? status : closed;
}
