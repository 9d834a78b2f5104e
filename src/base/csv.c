/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/csv.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/compressed.h"

static const char BLANKS[] = " \t";

/* What may stand around a cell. */
static const char *blanks_beside(char separator) {
  return separator == '\t' ? " " : BLANKS;
}

/* ---- one cell ---- */

typedef struct cell {
  char *text;        /* without its quotes */
  const char *begin; /* the cell's first character in the row, or its opening quote */
  bool open;         /* its closing quote is missing */
  bool stray;        /* something stands between the closing quote and the comma */
} cell;

/* Removes a cell's quotes in place; *at then points behind its closing quote. */
static char *take_quoted(char **at, bool *open) {
  char *s = *at + 1, *out = *at;
  while (*s && (*s != '"' || s[1] == '"')) {
    s += *s == '"';
    *out++ = *s++;
  }
  *open = !*s;
  *at = *s ? s + 1 : s;
  return out;
}

/* Cuts the cell that begins at *rest off the row; *rest becomes the beginning of the next one, or
 * NULL. Text between a closing quote and the separator is added to the cell. */
static cell take_cell(char **rest, char separator, bool trim) {
  const char ends[] = {separator, '\0'}, *blanks = blanks_beside(separator);
  char *s = *rest;
  if (trim) s += strspn(s, blanks);
  cell c = {.text = s, .begin = s};
  char *out = s;
  const char *kept = s; /* blanks before it are the cell's own */
  if (*s == '"') {
    out = take_quoted(&s, &c.open);
    kept = out;
    if (trim) s += strspn(s, blanks);
    c.stray = *s && *s != separator;
  }
  for (size_t n = strcspn(s, ends); n; n--) *out++ = *s++;
  while (trim && out > kept && strchr(blanks, out[-1])) out--;
  *rest = *s ? s + 1 : NULL;
  *out = '\0';
  return c;
}

/* Returns what is wrong with a cell; NULL: nothing is. */
static const char *flaw_of(const cell *c) {
  return c->open    ? "a cell in quotes that has no closing quote"
         : c->stray ? "behind a cell in quotes a comma is wanted"
                    : NULL;
}

size_t vs_csv_split(char *row, char **cells, size_t most, vs_csv_flaw *flaw) {
  const char *begin = row, *end = strpbrk(row, "\r\n");
  vs_csv_flaw first = {0};
  size_t n = 0;
  if (end) first = (vs_csv_flaw){"a line end inside a row", (size_t)(end - row)};
  while (row && n < most) {
    const cell c = take_cell(&row, ',', false);
    if (!first.why) first = (vs_csv_flaw){flaw_of(&c), (size_t)(c.begin - begin)};
    cells[n++] = c.text;
  }
  if (flaw) *flaw = first;
  return n;
}

void vs_csv_cell(vs_text *row, const char *word) {
  if (!strpbrk(word, ",\"\r\n")) {
    vs_text_put(row, word, strlen(word));
    return;
  }
  vs_text_add(row, "\"");
  for (; *word; word++) {
    bool breaks = *word == '\n' || *word == '\r';
    vs_text_add(row, *word == '"' ? "\"\"" : "%c", breaks ? ' ' : *word);
  }
  vs_text_add(row, "\"");
}

/* ---- a file of them ---- */

/* True if this line ends inside a quoted cell, so that the row goes on in the next one. open tells
 * whether it begins inside one. */
static bool ends_open(const vs_csv *csv, const char *line, bool open) {
  const char ends[] = {csv->separator, '\0'}, *blanks = blanks_beside(csv->separator);
  for (const char *s = line;; s++) { /* s stands where a cell begins, or inside the quoted one */
    if (csv->trim && !open) s += strspn(s, blanks);
    if (open || *s == '"') {
      for (s += !open; *s && (*s != '"' || s[1] == '"'); s++) s += *s == '"';
      if (!*s) return true;
    }
    open = false;
    s += strcspn(s, ends);
    if (!*s) return false;
  }
}

/* Adds the file's next line to the row, whose bytes so far *size counts. Returns false at the
 * file's end, and with errno EFBIG where the row becomes too long. */
static bool append_line(vs_csv *csv, size_t *size) {
  char *line = NULL;
  size_t room = 0;
  const size_t most = VS_CSV_LONGEST - *size;
  const ssize_t n = *size ? vs_alloc_row(&line, &room, most, csv->stream)
                          : vs_alloc_row(&csv->text, &csv->room, most, csv->stream);
  if (n >= 0 && *size) {
    if (csv->room < *size + (size_t)n + 1) {
      csv->room = 2 * (*size + (size_t)n + 1);
      csv->text = vs_resize(csv->text, csv->room, 1);
    }
    memcpy(csv->text + *size, line, (size_t)n + 1);
  }
  free(line);
  if (n < 0) return false;
  csv->begins = vs_alloc_grow(csv->begins, csv->n_lines, sizeof *csv->begins);
  csv->begins[csv->n_lines++] = *size;
  *size += (size_t)n;
  return true;
}

/* True if the row is a line that is to be passed over. */
static bool is_comment(const vs_csv *csv) {
  const char *s = csv->text + strspn(csv->text, " \t\r\n");
  return csv->comments && (!*s || *s == '#');
}

/* What stands between the cells of the first row, and so of all. */
static char find_separator(const vs_csv *csv) {
  static const char OTHERS[] = ";\t";
  bool quoted = false, seen[2] = {false};
  for (const char *s = csv->text; csv->guess && *s; s++) {
    quoted = quoted != (*s == '"');
    if (quoted) continue;
    if (*s == ',') return ',';
    for (int k = 0; k < 2; k++) seen[k] = seen[k] || *s == OTHERS[k];
  }
  return seen[0] ? OTHERS[0] : seen[1] ? OTHERS[1] : ',';
}

/* Reads all lines of the next row and takes the last line's end off. csv->n_lines is 0 at the
 * file's end. */
static vs_status read_row_lines(vs_csv *csv, vs_error *err) {
  static const char MARK[] = "\xEF\xBB\xBF"; /* some programs begin a UTF-8 text with it */
  size_t size = 0;
  bool open = false;
  csv->line += (int)csv->n_lines;
  const bool first = !csv->line;
  csv->line += first;
  csv->n_lines = 0;
  errno = 0;
  while (append_line(csv, &size)) {
    const size_t begin = csv->begins[csv->n_lines - 1];
    if (begin + strlen(csv->text + begin) != size)
      return vs_fail_at(err, (vs_where){csv->file, csv->line + (int)csv->n_lines - 1, 1},
                        "a zero byte; text in UTF-8 is wanted");
    if (first && !strncmp(csv->text, MARK, strlen(MARK))) {
      size -= strlen(MARK);
      memmove(csv->text, csv->text + strlen(MARK), size + 1);
    }
    if (!csv->separator && !is_comment(csv)) csv->separator = find_separator(csv);
    open = ends_open(csv, csv->text + csv->begins[csv->n_lines - 1], open);
    if (!open || is_comment(csv)) break;
  }
  if (errno == EFBIG)
    return vs_fail_at(err, (vs_where){csv->file, csv->line, 1},
                      "a row of more than %d bytes; a quote that is never closed, or no line ends",
                      VS_CSV_LONGEST);
  if (!csv->n_lines && !first) csv->line--;
  if (ferror(csv->stream))
    return vs_fail_at(err, (vs_where){.file = csv->file}, "cannot be read: %s",
                      vs_compressed_strerror(errno));
  if (size && csv->text[size - 1] == '\n') csv->text[--size] = '\0';
  if (size && csv->text[size - 1] == '\r') csv->text[--size] = '\0';
  return VS_OK;
}

static vs_status cut_into_cells(vs_csv *csv, vs_error *err) {
  size_t room = 1, line = 0;
  for (const char *s = csv->text; *s; s++) room += *s == csv->separator;
  if (room > csv->most) {
    csv->most = room;
    csv->cell = vs_resize(csv->cell, room, sizeof *csv->cell);
    csv->where = vs_resize(csv->where, room, sizeof *csv->where);
  }
  for (char *rest = csv->text; rest;) {
    const cell c = take_cell(&rest, csv->separator, csv->trim);
    const size_t begin = (size_t)(c.begin - csv->text);
    while (line + 1 < csv->n_lines && csv->begins[line + 1] <= begin) line++;
    const vs_where where = {csv->file, csv->line + (int)line, (int)(begin - csv->begins[line]) + 1};
    const char *why = flaw_of(&c);
    if (why) return vs_fail_at(err, where, "%s", why);
    csv->cell[csv->count] = c.text;
    csv->where[csv->count++] = where;
  }
  return VS_OK;
}

vs_status vs_csv_next(vs_csv *csv, vs_error *err) {
  vs_status status = VS_OK;
  csv->count = 0;
  do status = read_row_lines(csv, err);
  while (!status && csv->n_lines && is_comment(csv));
  return status || !csv->n_lines ? status : cut_into_cells(csv, err);
}

bool vs_csv_is_blank(const vs_csv *csv) {
  return csv->count == 1 && !csv->cell[0][strspn(csv->cell[0], BLANKS)];
}

void vs_csv_free(vs_csv *csv) {
  free(csv->cell);
  free(csv->where);
  free(csv->text);
  free(csv->begins);
  *csv = (vs_csv){0};
}
