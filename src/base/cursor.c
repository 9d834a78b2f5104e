/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/cursor.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"

vs_where vs_cursor_here(const vs_cursor *c) {
  vs_where w = c->line;
  w.column = c->column ? c->column[c->at - c->start] : vs_text_column(c->start, c->at);
  return w;
}

void vs_cursor_lower(char *s) {
  for (; *s; s++) *s = (char)tolower((unsigned char)*s);
}

void vs_cursor_skip(vs_cursor *c) {
  c->at += strspn(c->at, " \t");
}

bool vs_cursor_take(vs_cursor *c, char symbol) {
  vs_cursor_skip(c);
  if (*c->at != symbol) return false;
  c->at++;
  return true;
}

static size_t word_length(const char *at, const char *also) {
  size_t n = 0;
  while (isalnum((unsigned char)at[n]) || at[n] == '_' || (at[n] && strchr(also, at[n]))) n++;
  return n;
}

bool vs_cursor_word(vs_cursor *c, const char *also, char *word, size_t size) {
  vs_cursor_skip(c);
  size_t n = word_length(c->at, also);
  if (n == 0 || n >= size) return false;
  memcpy(word, c->at, n);
  word[n] = '\0';
  c->at += n;
  return true;
}

bool vs_cursor_is(vs_cursor *c, const char *word) {
  vs_cursor_skip(c);
  size_t n = word_length(c->at, "");
  if (n != strlen(word) || strncmp(c->at, word, n)) return false;
  c->at += n;
  return true;
}

void vs_cursor_token(vs_cursor *c, char *token, size_t size) {
  vs_cursor_skip(c);
  size_t n = strcspn(c->at, " \t");
  snprintf(token, size, "%.*s", (int)n, c->at);
  c->at += n;
}

vs_status vs_cursor_text(vs_cursor *c, char *text, size_t size, vs_error *err) {
  *text = '\0';
  vs_cursor_skip(c);
  if (!*c->at) return VS_OK;
  size_t n = *c->at == '"' ? strcspn(c->at + 1, "\"") : 0;
  if (*c->at != '"' || c->at[n + 1] != '"' || n >= size)
    return vs_fail_at(err, vs_cursor_here(c),
                      "a description in \"quotes\" (shorter than %zu bytes) is wanted here", size);
  memcpy(text, c->at + 1, n);
  text[n] = '\0';
  c->at += n + 2;
  vs_cursor_skip(c);
  return *c->at ? vs_fail_at(err, vs_cursor_here(c), "nothing may follow the description") : VS_OK;
}

vs_status vs_cursor_name(vs_cursor *c, char *name, size_t size, vs_error *err) {
  vs_cursor_skip(c);
  vs_where where = vs_cursor_here(c);
  return vs_cursor_word(c, "", name, size) && vs_cursor_take(c, '=')
             ? VS_OK
             : vs_fail_at(err, where, "'NAME = ...' is wanted here");
}
