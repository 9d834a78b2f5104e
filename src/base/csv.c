/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/csv.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const char BLANKS[] = " \t";

/* ---- one cell ---- */

typedef struct cell {
  char *text;        /* without its quotes */
  const char *begin; /* the cell's first character in the row, or its opening quote */
  bool open;         /* its closing quote is missing */
  bool stray;        /* something stands between the closing quote and the comma */
} cell;

/* Takes a quoted cell's text, in place; *at stands behind its closing quote then. */
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

/* Takes off the row the cell that begins at *rest; afterwards *rest is where the next one begins,
 * or NULL. Text between a closing quote and the comma is added to the cell. */
static cell take_cell(char **rest, bool trim) {
  char *s = *rest;
  if (trim) s += strspn(s, BLANKS);
  cell c = {.text = s, .begin = s};
  char *out = s;
  const char *kept = s; /* blanks before it are the cell's own */
  if (*s == '"') {
    out = take_quoted(&s, &c.open);
    kept = out;
    if (trim) s += strspn(s, BLANKS);
    c.stray = *s && *s != ',';
  }
  while (*s && *s != ',') *out++ = *s++;
  while (trim && out > kept && strchr(BLANKS, out[-1])) out--;
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
    const cell c = take_cell(&row, false);
    if (!first.why) first = (vs_csv_flaw){flaw_of(&c), (size_t)(c.begin - begin)};
    cells[n++] = c.text;
  }
  if (flaw) *flaw = first;
  return n;
}

void vs_csv_cell(vs_text *row, const char *word) {
  if (!strpbrk(word, ",\"\r\n")) {
    vs_text_add(row, "%s", word);
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
static bool ends_open(const char *line, bool open, bool trim) {
  for (const char *s = line;; s++) { /* s stands where a cell begins, or inside the quoted one */
    if (trim && !open) s += strspn(s, BLANKS);
    if (open || *s == '"') {
      for (s += !open; *s && (*s != '"' || s[1] == '"'); s++) s += *s == '"';
      if (!*s) return true;
    }
    open = false;
    s += strcspn(s, ",");
    if (!*s) return false;
  }
}

/* Adds the file's next line to the row, whose bytes so far *size counts. Returns false at the
 * file's end. */
static bool add_line(vs_csv *csv, size_t *size) {
  char *line = NULL;
  size_t room = 0;
  const ssize_t n =
      *size ? getline(&line, &room, csv->stream) : getline(&csv->text, &csv->room, csv->stream);
  if (n >= 0 && *size) {
    if (csv->room < *size + (size_t)n + 1) {
      csv->room = 2 * (*size + (size_t)n + 1);
      csv->text = realloc(csv->text, csv->room);
      if (!csv->text) vs_out_of_memory();
    }
    memcpy(csv->text + *size, line, (size_t)n + 1);
  }
  free(line);
  if (n < 0) return false;
  csv->begins = realloc(csv->begins, (csv->n_lines + 1) * sizeof *csv->begins);
  if (!csv->begins) vs_out_of_memory();
  csv->begins[csv->n_lines++] = *size;
  *size += (size_t)n;
  return true;
}

/* True if the row is a line that is to be passed over. */
static bool is_comment(const vs_csv *csv) {
  const char *s = csv->text + strspn(csv->text, " \t\r\n");
  return csv->comments && (!*s || *s == '#');
}

/* Reads all lines of the next row and takes the last line's end off. csv->n_lines is 0 at the
 * file's end. */
static vs_status read_lines(vs_csv *csv, vs_error *err) {
  static const char MARK[] = "\xEF\xBB\xBF"; /* some programs begin a UTF-8 text with it */
  size_t size = 0;
  bool open = false;
  csv->line += (int)csv->n_lines;
  const bool first = !csv->line;
  csv->line += first;
  csv->n_lines = 0;
  while (add_line(csv, &size)) {
    if (strlen(csv->text) != size)
      return vs_fail_at(err, (vs_where){csv->file, csv->line + (int)csv->n_lines - 1, 1},
                        "a zero byte; this is no text");
    if (first && !strncmp(csv->text, MARK, strlen(MARK))) {
      size -= strlen(MARK);
      memmove(csv->text, csv->text + strlen(MARK), size + 1);
    }
    open = ends_open(csv->text + csv->begins[csv->n_lines - 1], open, csv->trim);
    if (!open || is_comment(csv)) break;
  }
  if (!csv->n_lines && !first) csv->line--;
  if (ferror(csv->stream))
    return vs_fail_at(err, (vs_where){.file = csv->file}, "cannot be read: %s", strerror(errno));
  if (size && csv->text[size - 1] == '\n') csv->text[--size] = '\0';
  if (size && csv->text[size - 1] == '\r') csv->text[--size] = '\0';
  return VS_OK;
}

static vs_status cut(vs_csv *csv, vs_error *err) {
  size_t room = 1, line = 0;
  for (const char *s = csv->text; *s; s++) room += *s == ',';
  if (room > csv->most) {
    csv->most = room;
    csv->cell = realloc(csv->cell, room * sizeof *csv->cell);
    csv->where = realloc(csv->where, room * sizeof *csv->where);
    if (!csv->cell || !csv->where) vs_out_of_memory();
  }
  for (char *rest = csv->text; rest;) {
    const cell c = take_cell(&rest, csv->trim);
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
  do status = read_lines(csv, err);
  while (!status && csv->n_lines && is_comment(csv));
  return status || !csv->n_lines ? status : cut(csv, err);
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
