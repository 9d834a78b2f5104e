/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/catalogue.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/jail.h"
#include "base/text.h"
#include "netlist/words.h"

static const vs_shelf TABLES = {"table of parts", "parts", ".tab"}, NAMED = {"table", "parts", ""};
static const char ROWS[] = "rows";

/* ---- paths ---- */

bool vs_catalogue_is_row(const char *path) {
  size_t n = vs_error_file_size(path);
  return path[n] == '#' && path[n + 1];
}

void vs_catalogue_file(const char *path, char file[VS_PATH_SIZE]) {
  snprintf(file, VS_PATH_SIZE, "%.*s", (int)vs_error_file_size(path), path);
}

const char *vs_catalogue_name(const char *path, size_t *length) {
  const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
  if (vs_catalogue_is_row(path)) name = path + vs_error_file_size(path) + 1;
  *length = strcspn(name, ".");
  return name;
}

static bool is_file(const char *path) {
  struct stat s;
  return !stat(path, &s) && S_ISREG(s.st_mode);
}

/* ---- a table ---- */

enum { MOST_COLUMNS = 63 };

/* A table's lines, and the words of its line "rows". */
typedef struct table {
  const char *path;
  vs_source source;
  size_t rows; /* index of the line "rows"; source.count: there is none */
  vs_word column[MOST_COLUMNS + 1];
  size_t columns;
} table;

static vs_where place_in_table(const table *t, size_t line, const char *at) {
  return (vs_where){t->path, (int)line + 1, vs_text_column(t->source.line[line], at)};
}

/* What stands behind "*$" and blanks; NULL: the line is none of the contract's. */
static const char *contract_of(const char *line) {
  line += strspn(line, " \t");
  if (strncmp(line, "*$", 2)) return NULL;
  return line + 2 + strspn(line + 2, " \t");
}

/* The line's words up to MOST_COLUMNS and one more, without the quotes of ngspice's. */
static size_t split_columns(const char *text, vs_word words[MOST_COLUMNS + 1]) {
  size_t count = 0;
  for (const char *s = text + strspn(text, " \t"); *s && count <= MOST_COLUMNS;) {
    size_t n = strcspn(s, " \t");
    words[count++] = (vs_word){s, n};
    s += n + strspn(s + n, " \t");
  }
  return count;
}

static bool is_row_line(const char *line) {
  line += strspn(line, " \t");
  return *line && *line != '*';
}

static vs_status read_table_head(table *t, vs_error *err) {
  const char *head = contract_of(t->source.line[t->rows]) + sizeof ROWS - 1;
  t->columns = split_columns(head, t->column);
  if (t->columns == 0 || !vs_words_is(t->column[0], "NAME"))
    return vs_fail_at(err, place_in_table(t, t->rows, head),
                      "'rows NAME COLUMN...' is wanted here");
  if (t->columns > MOST_COLUMNS)
    return vs_fail_at(err, place_in_table(t, t->rows, head), "more than %d columns", MOST_COLUMNS);
  for (size_t k = 1; k < t->columns; k++)
    for (size_t n = 0; n < k; n++)
      if (!vs_words_compare(t->column[k], t->column[n]))
        return vs_fail_at(err, place_in_table(t, t->rows, t->column[k].at),
                          "column %.*s stands here a second time", (int)t->column[k].n,
                          t->column[k].at);
  return VS_OK;
}

/* Reads the file; free_table is due also after an error. */
static vs_status read_part_table(const char *path, table *t, vs_error *err) {
  *t = (table){.path = path};
  vs_status status = vs_source_read(path, &t->source, err);
  if (status) return status;
  while (t->rows < t->source.count) {
    const char *text = contract_of(t->source.line[t->rows]);
    if (text && vs_words_begin(text, ROWS)) return read_table_head(t, err);
    t->rows++;
  }
  return vs_fail_at(err, (vs_where){.file = path},
                    "has no line '*$ rows NAME COLUMN...', behind which a table's parts stand");
}

static void free_table(table *t) {
  vs_source_free(&t->source);
}

/* ---- a row ---- */

typedef struct row {
  size_t line;
  vs_word cell[MOST_COLUMNS + 1];
} row;

/* Fails: the table has no row of that name. The message names the nearest of the rows there are. */
static vs_status refuse_row_name(const table *t, const char *name, vs_error *err) {
  size_t count = 0;
  char **names = vs_alloc(t->source.count, sizeof *names);
  for (size_t k = t->rows + 1; k < t->source.count; k++) {
    vs_word cell[MOST_COLUMNS + 1];
    if (is_row_line(t->source.line[k]) && split_columns(t->source.line[k], cell))
      names[count++] = vs_alloc_part(cell[0].at, cell[0].n);
  }
  vs_status status = vs_fail_at(err, (vs_where){.file = t->path}, "has no row '%s'%s", name,
                                vs_text_hint(name, (const char *const *)names, count, "").text);
  for (size_t k = 0; k < count; k++) free(names[k]);
  free(names);
  return status;
}

/* A name becomes a subcircuit's. */
static vs_status check_name(const table *t, size_t line, vs_word name, vs_error *err) {
  for (size_t k = 0; k < name.n; k++)
    if (!isalnum((unsigned char)name.at[k]) && (k == 0 || !strchr("_-", name.at[k])))
      return vs_fail_at(err, place_in_table(t, line, name.at),
                        "'%.*s' is no name of a part; letters, digits, '_' and '-' are wanted",
                        (int)name.n, name.at);
  return VS_OK;
}

static vs_status find_row(const table *t, const char *name, row *r, vs_error *err) {
  vs_status status = VS_OK;
  r->line = 0;
  for (size_t k = t->rows + 1; k < t->source.count && !status; k++) {
    vs_word cell[MOST_COLUMNS + 1];
    if (!is_row_line(t->source.line[k])) continue;
    size_t count = split_columns(t->source.line[k], cell);
    if (!vs_words_is(cell[0], name)) continue;
    status = check_name(t, k, cell[0], err);
    if (!status && r->line)
      status = vs_fail_at(err, place_in_table(t, k, cell[0].at),
                          "%s stands here a second time, as in line %zu", name, r->line + 1);
    if (!status && count != t->columns)
      status = vs_fail_at(
          err, place_in_table(t, k, count > t->columns ? cell[t->columns].at : cell[0].at),
          "%s has %s%zu cells, and the line 'rows' has %zu columns; '-' is a cell "
          "of which the source says nothing",
          name, count > MOST_COLUMNS ? "more than " : "",
          count > MOST_COLUMNS ? (size_t)MOST_COLUMNS : count, t->columns);
    r->line = k;
    memcpy(r->cell, cell, sizeof cell);
  }
  return status || r->line ? status : refuse_row_name(t, name, err);
}

/* ---- the lines that a row makes ---- */

/* A part's text while it is made. */
typedef struct making {
  const table *t;
  const row *r;
  vs_text text;
  int *column; /* for each byte of the text */
  int cell;    /* column of the first cell of the line; 0: it has none yet */
  bool skip;   /* the line asks for a cell '-' */
  vs_error *err;
} making;

static void put_bytes(making *m, const char *bytes, size_t n, int column) {
  for (size_t k = 0; k < n; k++) {
    m->column = vs_alloc_grow(m->column, m->text.length + k, sizeof *m->column);
    m->column[m->text.length + k] = column;
  }
  vs_text_add(&m->text, "%.*s", (int)n, bytes);
}

/* A cell without its mark, "?" for assumed, "~" for typical. */
static vs_word number_of(vs_word cell) {
  if (cell.n > 1 && strchr("?~", cell.at[cell.n - 1])) cell.n--;
  return cell;
}

static bool is_number(vs_word cell) {
  char text[64], *end;
  if (cell.n == 0 || cell.n >= sizeof text) return false;
  snprintf(text, sizeof text, "%.*s", (int)cell.n, cell.at);
  if (!isdigit((unsigned char)*text) && !strchr("+-.", *text)) return false;
  return !isnan(vs_text_to_number(text, &end)) && !*end;
}

/* Puts the cell of a column. `quoted`: into a text, where it need be no number. */
static vs_status put_cell(making *m, vs_word name, size_t line, bool contract, bool quoted) {
  const bool marks = name.n > 1 && name.at[name.n - 1] == '?';
  size_t k = 0;
  name.n -= marks;
  while (k < m->t->columns && vs_words_compare(m->t->column[k], name)) k++;
  if (k == m->t->columns)
    return vs_fail_at(m->err, place_in_table(m->t, line, name.at),
                      "the line 'rows' has no column '%.*s'", (int)name.n, name.at);
  const vs_word cell = m->r->cell[k], number = number_of(cell);
  const vs_where where = place_in_table(m->t, m->r->line, cell.at);
  const bool none = vs_words_is(cell, "-");
  if (!m->cell) m->cell = where.column;
  m->skip = m->skip || (none && contract);
  if (m->skip) return VS_OK;
  if (none)
    return vs_fail_at(m->err, where, "%.*s: a number is wanted, as the model is made of it",
                      (int)name.n, name.at);
  if (marks) {
    const char *word = cell.at[number.n] == '?' ? "assumed" : "typical";
    if (number.n < cell.n) put_bytes(m, word, strlen(word), where.column);
    return VS_OK;
  }
  if (!quoted && k > 0 && !is_number(number))
    return vs_fail_at(
        m->err, where,
        "%.*s: a number is wanted, with a '?' behind it if it is assumed, a '~' if it is "
        "typical, or '-', not '%.*s'",
        (int)name.n, name.at, (int)cell.n, cell.at);
  put_bytes(m, number.at, number.n, where.column);
  return VS_OK;
}

/* Puts a line of the law, with the row's cells in it. */
static vs_status put_line(making *m, size_t line, bool contract) {
  const char *s = m->t->source.line[line];
  const vs_word name = m->r->cell[0];
  bool quoted = false;
  vs_status status = VS_OK;
  m->cell = 0;
  m->skip = false;
  while (*s && !status) {
    size_t n = *s == '@' ? strcspn(s + 1, "@ \t") : 0;
    quoted = quoted != (*s == '"');
    if (n == 0 || s[n + 1] != '@') {
      put_bytes(m, s++, 1, m->cell);
      continue;
    }
    const vs_word word = {s + 1, n};
    if (n == strlen("SUBCKT") && !strncmp(word.at, "SUBCKT", n))
      for (size_t k = 0; k < name.n; k++)
        put_bytes(m, (char[]){(char)tolower((unsigned char)name.at[k])}, 1,
                  place_in_table(m->t, m->r->line, name.at).column);
    else
      status = put_cell(m, word, line, contract, quoted);
    s += n + 2;
  }
  return status;
}

/* Where a line of the contract has a cell, it has the row's place; else its own. A line of the
 * netlist has its own place, as what is wrong with it is the law's. */
static vs_status make_part(making *m, vs_catalogue_part *part) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < m->t->rows && !status; k++) {
    const char *line = m->t->source.line[k] + strspn(m->t->source.line[k], " \t");
    const bool contract = contract_of(line) != NULL;
    const size_t begin = m->text.length;
    if (!*line || (*line == '*' && !contract)) continue;
    status = put_line(m, k, contract);
    if (m->skip) {
      m->text.length = begin;
      continue;
    }
    put_bytes(m, "\n", 1, m->cell);
    part->line = vs_resize(part->line, part->source.count + 1, sizeof *part->line);
    part->line[part->source.count++] = (int)(contract && m->cell ? m->r->line : k) + 1;
    for (size_t b = begin; b < m->text.length; b++)
      if (!contract || !m->column[b]) m->column[b] = contract ? m->cell : 0;
  }
  return status;
}

/* Takes the text apart. */
static void take_text_apart(making *m, vs_catalogue_part *part) {
  part->source.text = m->text.text;
  part->source.line = vs_alloc(part->source.count + 1, sizeof *part->source.line);
  part->column = m->column;
  m->text = (vs_text){0};
  m->column = NULL;
  char *at = part->source.text;
  for (size_t k = 0; k < part->source.count; k++) {
    part->source.line[k] = at;
    at = strchr(at, '\n');
    *at++ = '\0';
  }
}

vs_status vs_catalogue_read(const char *path, vs_catalogue_part *part, vs_error *err) {
  char file[VS_PATH_SIZE];
  table t;
  row r;
  *part = (vs_catalogue_part){0};
  vs_catalogue_file(path, file);
  vs_status status = read_part_table(file, &t, err);
  if (!status) status = find_row(&t, path + strlen(file) + 1, &r, err);
  making m = {.t = &t, .r = &r, .err = err};
  if (!status) status = make_part(&m, part);
  if (status)
    part->source.count = 0;
  else
    take_text_apart(&m, part);
  vs_text_free(&m.text);
  free(m.column);
  free_table(&t);
  return status;
}

void vs_catalogue_free(vs_catalogue_part *part) {
  vs_source_free(&part->source);
  free(part->line);
  free(part->column);
  *part = (vs_catalogue_part){0};
}

/* ---- all that there is ---- */

/* Who is told of the rows of tables. */
typedef struct telling {
  void (*each)(void *, const char *);
  void *ctx;
} telling;

static void tell_rows(void *ctx, const char *path) {
  const telling *to = ctx;
  table t;
  vs_error unread = {0};
  char whole[2 * VS_PATH_SIZE];
  vs_status status = read_part_table(path, &t, &unread);
  for (size_t k = t.rows + 1; !status && k < t.source.count; k++) {
    vs_word cell[MOST_COLUMNS + 1];
    if (!is_row_line(t.source.line[k]) || !split_columns(t.source.line[k], cell)) continue;
    snprintf(whole, sizeof whole, "%s#%.*s", path, (int)cell[0].n, cell[0].at);
    to->each(to->ctx, whole);
  }
  free_table(&t);
}

void vs_catalogue_list(const vs_shelf *shelf, void (*each)(void *, const char *), void *ctx) {
  telling to = {each, ctx};
  vs_path_list(shelf, each, ctx);
  vs_path_list(&TABLES, tell_rows, &to);
}

/* ---- by name ---- */

typedef struct search {
  const char *name;
  char *path; /* of the best so far */
  bool found; /* one whose name is the same but for capitals */
  bool exact; /* the very name */
  char **all; /* every name that begins as it does, for what may have been meant: the first letter
                 of a part's name says what it is, as in BC337 and AC03, or 1N4007 */
  size_t count;
} search;

static void look_in_table(void *ctx, const char *path) {
  search *s = ctx;
  size_t n;
  const char *name = vs_catalogue_name(path, &n);
  const bool alike = strlen(s->name) == n && !strncasecmp(name, s->name, n),
             same = alike && !strncmp(name, s->name, n);
  if (!strncasecmp(name, s->name, 1)) {
    s->all = vs_alloc_grow(s->all, s->count, sizeof *s->all);
    s->all[s->count++] = vs_alloc_part(name, n);
  }
  if (strlen(path) >= VS_PATH_SIZE || !(same ? !s->exact : alike && !s->found)) return;
  snprintf(s->path, VS_PATH_SIZE, "%s", path);
  s->found = true;
  s->exact = same;
}

static void end_search(search *s) {
  for (size_t k = 0; k < s->count; k++) free(s->all[k]);
  free(s->all);
}

bool vs_catalogue_shipped(const vs_shelf *shelf, const char *name, char path[VS_PATH_SIZE]) {
  if (vs_path_shipped(shelf, name, path)) return true;
  search s = {.name = name, .path = path};
  vs_catalogue_list(shelf, look_in_table, &s);
  end_search(&s);
  return s.found;
}

/* A row by its table: at the path given, else on the shelf. */
static vs_status find_by_table(const char *name, vs_where where, char path[VS_PATH_SIZE],
                               vs_error *err) {
  char file[VS_PATH_SIZE], found[VS_PATH_SIZE];
  vs_catalogue_file(name, file);
  vs_status status = VS_OK;
  if (is_file(file))
    snprintf(found, sizeof found, "%s", file);
  else
    status = vs_path_find(&NAMED, file, where, found, err);
  if (!status) status = vs_jail_check(found, where, err);
  if (!status && snprintf(path, VS_PATH_SIZE, "%s%s", found, name + strlen(file)) >= VS_PATH_SIZE)
    status = vs_fail_at(err, where, "%s: name too long", name);
  return status;
}

vs_status vs_catalogue_find(const vs_shelf *shelf, const char *name, vs_where where,
                            char path[VS_PATH_SIZE], vs_error *err) {
  struct stat there;
  if (vs_catalogue_is_row(name)) return find_by_table(name, where, path, err);
  if (strchr(name, '/') || strlen(name) >= VS_PATH_SIZE / 2 || !stat(name, &there) ||
      vs_path_shipped(shelf, name, path))
    return vs_path_find(shelf, name, where, path, err);
  search s = {.name = name, .path = path};
  vs_catalogue_list(shelf, look_in_table, &s);
  vs_status status =
      s.found ? vs_jail_check(path, where, err)
              : vs_fail_at(err, where,
                           "no %s '%s': not a file, and not a %s that comes with the program%s",
                           shelf->what, name, shelf->what,
                           vs_text_hint(name, (const char *const *)s.all, s.count,
                                        "; a row of a table of your own is FILE.tab#NAME")
                               .text);
  end_search(&s);
  return status;
}

vs_status vs_catalogue_hash(const char *path, char text[VS_HASH_TEXT], vs_error *err) {
  vs_catalogue_part part;
  vs_hash hash;
  if (!vs_catalogue_is_row(path)) return vs_hash_file(path, text, err);
  vs_status status = vs_catalogue_read(path, &part, err);
  vs_hash_begin(&hash);
  for (size_t k = 0; k < part.source.count; k++) {
    vs_hash_add(&hash, part.source.line[k], strlen(part.source.line[k]));
    vs_hash_add(&hash, "\n", 1);
  }
  vs_hash_end(&hash, text);
  vs_catalogue_free(&part);
  return status;
}
