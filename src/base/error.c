/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/error.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* Keeps a message on one line, whatever text of the user's stands in it. */
static void one_line(char *text) {
  for (; *text; text++)
    if ((unsigned char)*text < 0x20 || *text == 0x7f) *text = ' ';
}

vs_status vs_fail(vs_error *err, vs_status status, const char *format, ...) {
  va_list args;
  va_start(args, format);
  vsnprintf(err->text, sizeof err->text, format, args);
  va_end(args);
  err->file_size = err->place_size = err->line = err->column = 0;
  err->gave_up = err->conducts = false;
  one_line(err->text);
  return status;
}

size_t vs_error_file_size(const char *file) {
  static const char TABLE[] = ".tab#";
  const char *mark = strstr(file, TABLE);
  return mark ? (size_t)(mark - file) + sizeof TABLE - 2 : strlen(file);
}

vs_status vs_fail_at(vs_error *err, vs_where where, const char *format, ...) {
  int n = 0, size = where.file ? (int)vs_error_file_size(where.file) : 0;
  if (where.file && where.line > 0)
    n = snprintf(err->text, sizeof err->text, "%.*s:%d:%d: ", size, where.file, where.line,
                 where.column);
  else if (where.file)
    n = snprintf(err->text, sizeof err->text, "%.*s: ", size, where.file);
  if (n < 0 || (size_t)n >= sizeof err->text) n = 0;
  va_list args;
  va_start(args, format);
  vsnprintf(err->text + n, sizeof err->text - (size_t)n, format, args);
  va_end(args);
  err->file_size = n ? size : 0;
  err->place_size = n;
  err->line = n ? where.line : 0;
  err->column = err->line ? where.column : 0;
  err->gave_up = err->conducts = false;
  one_line(err->text);
  return VS_INPUT;
}

/* ---- findings ---- */

static bool same_file(const vs_error *a, const vs_error *b) {
  return a->file_size == b->file_size && !memcmp(a->text, b->text, (size_t)a->file_size);
}

static bool comes_before(const vs_error *a, const vs_error *b) {
  return a->line != b->line ? a->line < b->line : a->column < b->column;
}

/* Inserts the error behind those of its file with no later line; the first error of a file goes to
 * the end. */
static size_t position_of(const vs_findings *all, const vs_error *err) {
  bool begun = false;
  for (size_t k = 0; k < all->count; k++) {
    bool same = same_file(&all->item[k], err);
    if (same ? comes_before(err, &all->item[k]) : begun) return k;
    begun = same;
  }
  return all->count;
}

vs_status vs_error_keep(vs_error *err, vs_status status) {
  vs_findings *all = err->findings;
  if (status != VS_INPUT || !all || all->count >= VS_MOST_FINDINGS) return status;
  size_t position = position_of(all, err);
  for (size_t k = 0; k < all->count; k++)
    if (!strcmp(all->item[k].text, err->text)) return VS_OK;
  memmove(&all->item[position + 1], &all->item[position],
          (all->count - position) * sizeof *all->item);
  all->item[position] = *err;
  all->count++;
  return VS_OK;
}

size_t vs_error_count(const vs_error *err) {
  return err->findings ? err->findings->count : 0;
}
