/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/text.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void out_of_memory(void) {
  fputs("vibrospice: out of memory\n", stderr);
  exit(1);
}

void *vs_alloc(size_t count, size_t size) {
  void *memory = calloc(count ? count : 1, size ? size : 1);
  if (!memory) out_of_memory();
  return memory;
}

char *vs_copy(const char *string) {
  char *copy = strdup(string);
  if (!copy) out_of_memory();
  return copy;
}

void vs_text_add(vs_text *t, const char *format, ...) {
  va_list args, again;
  va_start(args, format);
  va_copy(again, args);
  int n = vsnprintf(NULL, 0, format, args);
  va_end(args);
  size_t need = t->length + (n > 0 ? (size_t)n : 0) + 1;
  if (need > t->capacity) {
    t->capacity = need * 2;
    t->text = realloc(t->text, t->capacity);
    if (!t->text) out_of_memory();
  }
  vsnprintf(t->text + t->length, t->capacity - t->length, format, again);
  va_end(again);
  t->length = need - 1;
}

void vs_text_json(vs_text *t, const char *string) {
  vs_text_add(t, "\"");
  for (const unsigned char *s = (const unsigned char *)string; *s; s++) {
    if (*s == '"' || *s == '\\')
      vs_text_add(t, "\\%c", *s);
    else if (*s < 0x20)
      vs_text_add(t, "\\u%04x", *s);
    else
      vs_text_add(t, "%c", *s);
  }
  vs_text_add(t, "\"");
}

void vs_text_free(vs_text *t) {
  free(t->text);
  *t = (vs_text){0};
}

enum { LONGEST_NAME = 63 };

static size_t min3(size_t a, size_t b, size_t c) {
  size_t m = a < b ? a : b;
  return m < c ? m : c;
}

/* Insertions, deletions, substitutions and swaps of neighbours, capitals aside. */
static size_t edit_distance(const char *a, const char *b) {
  size_t n = strlen(a), m = strlen(b);
  if (n > LONGEST_NAME || m > LONGEST_NAME) return n > m ? n : m;
  size_t row[3][LONGEST_NAME + 1];
  for (size_t j = 0; j <= m; j++) row[0][j] = j;
  for (size_t i = 1; i <= n; i++) {
    size_t *now = row[i % 3], *up = row[(i + 2) % 3], *up2 = row[(i + 1) % 3];
    now[0] = i;
    for (size_t j = 1; j <= m; j++) {
      int ca = tolower((unsigned char)a[i - 1]), cb = tolower((unsigned char)b[j - 1]);
      now[j] = min3(now[j - 1] + 1, up[j] + 1, up[j - 1] + (ca != cb));
      if (i > 1 && j > 1 && ca == tolower((unsigned char)b[j - 2]) &&
          cb == tolower((unsigned char)a[i - 2]) && up2[j - 2] + 1 < now[j])
        now[j] = up2[j - 2] + 1;
    }
  }
  return row[n % 3][m];
}

const char *vs_nearest(const char *name, const char *const *candidates, size_t count) {
  const char *best = NULL;
  size_t best_distance = strlen(name) / 2 + 2; /* farther than this is another word */
  for (size_t k = 0; k < count; k++) {
    size_t d = edit_distance(name, candidates[k]);
    if (d < best_distance) {
      best_distance = d;
      best = candidates[k];
    }
  }
  return best;
}

int vs_column(const char *line, const char *at) {
  int column = 1;
  for (; line < at; line++) column += (*line & 0xc0) != 0x80; /* not one that goes on */
  return column;
}

void vs_unit_suffix(const char *unit, char *suffix, size_t size) {
  size_t n = 0;
  for (; *unit && n + 1 < size; unit++)
    suffix[n++] = isalnum((unsigned char)*unit) ? (char)tolower((unsigned char)*unit) : '_';
  suffix[n] = '\0';
}
