/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "npy.h"

#include <fcntl.h>
#include <math.h>
#include <search.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/csv.h"
#include "base/file.h"
#include "base/json.h"
#include "base/shutdown.h"
#include "workers/identity.h"

/* One of a column's words, and its number among them. */
typedef struct word {
  int32_t number;
  char text[];
} word;

typedef struct column column;

/* What an element of a column is. */
typedef struct element {
  const char *type; /* as numpy names it */
  /* Writes the cell's element. Error: the cell is none. */
  vs_status (*put)(column *c, const char *cell, vs_error *err);
} element;

struct column {
  vs_row_shape_column of;
  const element *element;
  bool numbers; /* all cells seen so far are numbers */
  char file[NAME_MAX + 1];
  vs_file out;
  void *sorted; /* the words as a tree of tsearch */
  word **words; /* the same, by number */
  size_t n_words, room;
};

struct vs_npy {
  column *column;
  char **cell; /* [count + 1], of the row that is being taken */
  size_t count;
  uint64_t rows, added;
  char folder[VS_PATH_SIZE]; /* empty: it is not open */
  int made;                  /* how many folders had to be made for it */
};

/* ---- elements ---- */

/* Writes the lowest `bytes` bytes of the number, the lowest first. */
static void put_bytes(FILE *out, uint64_t number, int bytes) {
  for (int k = 0; k < bytes; k++) putc((int)(number >> (8 * k) & 0xff), out);
}

static vs_status put_whole(column *c, const char *cell, vs_error *err) {
  (void)err;
  put_bytes(c->out.stream, (uint64_t)strtoll(cell, NULL, 10), 8);
  return VS_OK;
}

static vs_status put_number(column *c, const char *cell, vs_error *err) {
  const double number = *cell ? strtod(cell, NULL) : NAN;
  uint64_t bits;
  (void)err;
  memcpy(&bits, &number, sizeof bits);
  put_bytes(c->out.stream, bits, 8);
  return VS_OK;
}

static vs_status put_id(column *c, const char *cell, vs_error *err) {
  enum { SIZE = VS_ID_SIZE - 1 };
  char id[SIZE + 1] = {0};
  if (strlen(cell) > SIZE)
    return vs_fail(err, VS_INPUT, "'%.64s' is no id; one of %d characters is wanted", cell, SIZE);
  memcpy(id, cell, strlen(cell));
  fwrite(id, 1, SIZE, c->out.stream);
  return VS_OK;
}

static int by_text(const void *a, const void *b) {
  const word *x = a, *y = b;
  return strcmp(x->text, y->text);
}

/* Adds a word, which the column's tree has already. */
static void keep_word(column *c, word *w) {
  if (c->n_words == c->room) {
    c->room = c->room ? 2 * c->room : 16;
    c->words = vs_resize(c->words, c->room, sizeof *c->words);
  }
  w->number = (int32_t)c->n_words;
  c->words[c->n_words++] = w;
}

static vs_status put_word(column *c, const char *cell, vs_error *err) {
  const size_t size = strlen(cell) + 1;
  word *w = vs_alloc(1, sizeof *w + size);
  (void)err;
  memcpy(w->text, cell, size);
  word **found = vs_checked(tsearch(w, &c->sorted, by_text));
  if (*found == w)
    keep_word(c, w);
  else
    free(w);
  put_bytes(c->out.stream, (uint64_t)(*found)->number, 4);
  return VS_OK;
}

static const element WHOLE = {"<i8", put_whole}, NUMBER = {"<f8", put_number},
                     ID = {"|S16", put_id}, WORD = {"<i4", put_word};
_Static_assert(VS_ID_SIZE == 17, "an element of type ID is an id");

static const element *element_of(const column *c) {
  static const element *const ELEMENTS[] = {
      [VS_CELLS_TEXT] = &WORD,   [VS_CELLS_NUMBER] = &NUMBER, [VS_CELLS_VALUE] = &NUMBER,
      [VS_CELLS_LINE] = &NUMBER, [VS_CELLS_COUNT] = &WHOLE,   [VS_CELLS_STATUS] = &WHOLE};
  if (c->of.role == VS_ROLE_ID) return &ID;
  if (c->of.cells == VS_CELLS_EITHER) return c->numbers ? &NUMBER : &WORD;
  return ELEMENTS[c->of.cells];
}

/* ---- files ---- */

/* Writes the name of the file of column k. Where another column before it has the same, but for
 * slashes, the number k stands in it. */
static void name_array_file(char *const *names, size_t k, char file[NAME_MAX + 1]) {
  bool twice = false;
  for (size_t c = 0; c < k && !twice; c++) {
    const char *a = names[c], *b = names[k];
    while (*a && (*a == '/' ? '_' : *a) == (*b == '/' ? '_' : *b)) a++, b++;
    twice = !*a && !*b;
  }
  if (twice)
    snprintf(file, NAME_MAX + 1, "%.220s.%zu.npy", names[k], k);
  else
    snprintf(file, NAME_MAX + 1, "%.220s.npy", names[k]);
  for (char *s = file; *s; s++)
    if (*s == '/') *s = '_';
}

/* The header: magic bytes, version, the length of the text that follows, and that text, filled up
 * with blanks so that the elements begin at a multiple of 64 bytes. */
static void write_header(FILE *out, const char *type, uint64_t rows) {
  enum { BEFORE = 10, ALIGNED = 64 };
  char text[128];
  int n = snprintf(text, sizeof text, "{'descr': '%s', 'fortran_order': False, 'shape': (%llu,), }",
                   type, (unsigned long long)rows);
  const int length = (BEFORE + n + 1 + ALIGNED - 1) / ALIGNED * ALIGNED - BEFORE;
  fwrite("\x93NUMPY\x01\x00", 1, 8, out);
  put_bytes(out, (uint64_t)length, 2);
  fprintf(out, "%-*s\n", length - 1, text);
}

vs_npy *vs_npy_new(const vs_row_shape *shape) {
  vs_npy *a = vs_alloc(1, sizeof *a);
  a->count = vs_row_shape_columns(shape);
  a->column = vs_alloc(a->count, sizeof *a->column);
  a->cell = vs_alloc(a->count + 1, sizeof *a->cell);
  char **names = vs_alloc(a->count, sizeof *names);
  for (size_t k = 0; k < a->count; k++) {
    column *c = &a->column[k];
    c->of = vs_row_shape_column_at(shape, k);
    c->numbers = true;
    names[k] = (char *)c->of.name;
    name_array_file(names, k, c->file);
  }
  free(names);
  return a;
}

void vs_npy_free(vs_npy *a) {
  if (!a) return;
  for (size_t k = 0; k < a->count; k++) {
    column *c = &a->column[k];
    vs_file_discard(&c->out);
    tdestroy(c->sorted, free);
    free(c->words);
  }
  if (*a->folder) {
    vs_shutdown_forget(a->folder);
    vs_file_folder_unmake(a->folder, a->made); /* fails where files were committed */
  }
  free(a->column);
  free(a->cell);
  free(a);
}

bool vs_npy_must_look(const vs_npy *a) {
  for (size_t k = 0; k < a->count; k++)
    if (a->column[k].of.cells == VS_CELLS_EITHER) return true;
  return false;
}

void vs_npy_look(vs_npy *a, char *row) {
  const size_t n = vs_csv_split(row, a->cell, a->count, NULL);
  for (size_t k = 0; k < n; k++) {
    column *c = &a->column[k];
    if (c->of.cells == VS_CELLS_EITHER)
      c->numbers = c->numbers && vs_row_shape_is_number(a->cell[k]);
  }
}

vs_status vs_npy_open(vs_npy *a, const char *folder, uint64_t rows, vs_error *err) {
  snprintf(a->folder, sizeof a->folder, "%.4000s/" VS_ARRAY_FOLDER, folder);
  a->rows = rows;
  vs_status status = vs_file_folder_make(a->folder, &a->made, err);
  if (a->made) vs_shutdown_remove(a->folder);
  for (size_t k = 0; k < a->count && !status; k++) {
    column *c = &a->column[k];
    c->element = element_of(c);
    status = vs_file_open(&c->out, a->folder, c->file, err);
    if (!status) write_header(c->out.stream, c->element->type, rows);
  }
  return status;
}

vs_status vs_npy_add(vs_npy *a, char *row, vs_error *err) {
  const size_t n = vs_csv_split(row, a->cell, a->count + 1, NULL);
  vs_status status = VS_OK;
  if (n != a->count)
    return vs_fail(err, VS_RUN, "cells in a row: %zu; columns in its header: %zu", n, a->count);
  for (size_t k = 0; k < n && !status; k++)
    status = a->column[k].element->put(&a->column[k], a->cell[k], err);
  a->added++;
  return status;
}

/* ---- columns.json ---- */

static void add_array_column(const column *c, vs_json *json) {
  vs_json_object(json, NULL, VS_JSON_ROW);
  vs_json_text(json, "column", c->of.name);
  vs_json_text(json, "file", c->file);
  vs_json_text(json, "type", c->element->type);
  vs_json_key(json, "unit");
  vs_text_add(json->text, "%s", c->of.unit);
  if (c->element == &WORD) {
    vs_json_array(json, "words", VS_JSON_ROW);
    for (size_t k = 0; k < c->n_words; k++) vs_json_text(json, NULL, c->words[k]->text);
    vs_json_end(json);
  }
  vs_json_end(json);
}

static vs_status write_list(const vs_npy *a, vs_error *err) {
  static const char NAME[] = "columns.json";
  vs_file file;
  vs_text text = {0};
  vs_json json = vs_json_new(&text);
  vs_status status = vs_file_open(&file, a->folder, NAME, err);
  if (status) return status;
  vs_json_object(&json, NULL, VS_JSON_LINES);
  vs_json_whole(&json, "rows", (int64_t)a->rows);
  vs_json_array(&json, "columns", VS_JSON_LINES);
  for (size_t k = 0; k < a->count; k++) add_array_column(&a->column[k], &json);
  vs_json_end(&json);
  vs_json_end(&json);
  fprintf(file.stream, "%s\n", text.text);
  vs_text_free(&text);
  return vs_file_commit(&file, err);
}

vs_status vs_npy_commit(vs_npy *a, vs_error *err) {
  char list[VS_PATH_SIZE + 16];
  vs_status status = VS_OK;
  if (a->added != a->rows)
    return vs_fail(err, VS_RUN, "%s: rows: %llu; announced: %llu", a->folder,
                   (unsigned long long)a->added, (unsigned long long)a->rows);
  snprintf(list, sizeof list, "%s/columns.json", a->folder);
  unlink(list);
  for (size_t k = 0; k < a->count && !status; k++) status = vs_file_commit(&a->column[k].out, err);
  return status ? status : write_list(a, err);
}

/* ---- removing ---- */

void vs_npy_remove(int folder, const char *header) {
  char file[NAME_MAX + 1], *row = vs_copy(header);
  size_t most = 1;
  for (const char *c = row; *c; c++) most += *c == ',';
  char **names = vs_alloc(most, sizeof *names);
  const size_t count = vs_csv_split(row, names, most, NULL);
  int columns = openat(folder, VS_ARRAY_FOLDER, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (columns >= 0) vs_file_remove(columns, "columns.json");
  for (size_t k = 0; k < count && columns >= 0; k++) {
    name_array_file(names, k, file);
    vs_file_remove(columns, file);
  }
  if (columns >= 0) close(columns);
  unlinkat(folder, VS_ARRAY_FOLDER, AT_REMOVEDIR); /* if it is empty */
  free(names);
  free(row);
}
