/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/json.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

vs_json vs_json_new(vs_text *text) {
  return (vs_json){.text = text};
}

vs_json vs_json_inside(vs_text *text) {
  return (vs_json){.text = text, .level = {{'}', .lines = true, .has_members = true}}, .depth = 1};
}

static bool is_plain(char c) {
  return (unsigned char)c >= 0x20 && c != '"' && c != '\\';
}

void vs_json_string(vs_text *t, const char *string) {
  const char *bad = vs_text_not_utf8(string, strlen(string));
  vs_text_add(t, "\"");
  for (const char *s = string; *s; s++) {
    size_t plain = 0; /* characters that stand for themselves */
    while (s + plain != bad && is_plain(s[plain])) plain++;
    vs_text_add(t, "%.*s", (int)plain, s);
    s += plain;
    if (!*s) break;
    if (s == bad) {
      vs_text_add(t, "\\ufffd");
      bad = vs_text_not_utf8(bad + 1, strlen(bad + 1));
    } else if (*s == '"' || *s == '\\')
      vs_text_add(t, "\\%c", *s);
    else
      vs_text_add(t, "\\u%04x", (unsigned char)*s);
  }
  vs_text_add(t, "\"");
}

static void break_line(vs_json *json) {
  int indent = 0;
  for (int k = 0; k < json->depth; k++) indent += json->level[k].lines ? 2 : 0;
  vs_text_add(json->text, "\n%*s", indent, "");
}

void vs_json_key(vs_json *json, const char *key) {
  if (json->depth) {
    bool lines = json->level[json->depth - 1].lines && !json->same_row;
    bool *has_members = &json->level[json->depth - 1].has_members;
    vs_text_add(json->text, "%s", !*has_members ? "" : lines ? "," : ", ");
    if (lines) break_line(json);
    *has_members = true;
  }
  json->same_row = false;
  if (!key) return;
  vs_json_string(json->text, key);
  vs_text_add(json->text, ": ");
}

static void begin_level(vs_json *json, const char *key, vs_json_layout layout,
                        const char *brackets) {
  vs_json_key(json, key);
  assert(json->depth < VS_JSON_DEPTH);
  json->level[json->depth].close = brackets[1];
  json->level[json->depth].lines = layout == VS_JSON_LINES;
  json->level[json->depth].has_members = false;
  json->depth++;
  vs_text_add(json->text, "%c", brackets[0]);
}

void vs_json_object(vs_json *json, const char *key, vs_json_layout layout) {
  begin_level(json, key, layout, "{}");
}

void vs_json_array(vs_json *json, const char *key, vs_json_layout layout) {
  begin_level(json, key, layout, "[]");
}

void vs_json_end(vs_json *json) {
  assert(json->depth > 0);
  bool lines = json->level[--json->depth].lines;
  if (lines) break_line(json);
  vs_text_add(json->text, "%c", json->level[json->depth].close);
}

void vs_json_text(vs_json *json, const char *key, const char *value) {
  if (!value) {
    vs_json_null(json, key);
    return;
  }
  vs_json_key(json, key);
  vs_json_string(json->text, value);
}

void vs_json_number(vs_json *json, const char *key, double value, int digits) {
  if (!isfinite(value)) {
    vs_json_null(json, key);
    return;
  }
  vs_json_key(json, key);
  vs_text_add_number(json->text, value, digits);
}

void vs_json_whole(vs_json *json, const char *key, int64_t value) {
  vs_json_key(json, key);
  vs_text_add(json->text, "%" PRId64, value);
}

void vs_json_bool(vs_json *json, const char *key, bool value) {
  vs_json_key(json, key);
  vs_text_add(json->text, value ? "true" : "false");
}

void vs_json_null(vs_json *json, const char *key) {
  vs_json_key(json, key);
  vs_text_add(json->text, "null");
}

void vs_json_same_row(vs_json *json) {
  json->same_row = true;
}

/* ---- checking ---- */

static const char BLANKS[] = " \t\r\n", DIGITS[] = "0123456789";

const char *vs_json_string_end(const char *text) {
  const char *s = text;
  if (*s++ != '"') return NULL;
  for (; *s != '"'; s++) {
    if ((unsigned char)*s < ' ') return NULL; /* the text's end, too */
    if (*s != '\\') continue;
    s++;
    if (!*s || !strchr("\"\\/bfnrtu", *s)) return NULL;
    if (*s == 'u' && strspn(s + 1, "0123456789abcdefABCDEF") < 4) return NULL;
  }
  return s + 1;
}

/* Each of these returns where the thing that begins at s ends; NULL: it is none. */

static const char *end_of_digits(const char *s) {
  size_t n = strspn(s, DIGITS);
  return n ? s + n : NULL;
}

static const char *end_of_number(const char *s) {
  s += *s == '-';
  s = *s == '0' ? s + 1 : end_of_digits(s);
  if (s && *s == '.') s = end_of_digits(s + 1);
  if (!s || (*s != 'e' && *s != 'E')) return s;
  s++;
  return end_of_digits(s + (*s == '+' || *s == '-'));
}

static const char *end_of_word(const char *s) {
  static const char *const WORDS[] = {"true", "false", "null"};
  for (size_t k = 0; k < sizeof WORDS / sizeof *WORDS; k++)
    if (!strncmp(s, WORDS[k], strlen(WORDS[k]))) return s + strlen(WORDS[k]);
  return NULL;
}

/* Of what is neither an object nor an array. */
static const char *end_of_plain(const char *s) {
  if (*s == '"') return vs_json_string_end(s);
  return *s == '-' || strspn(s, DIGITS) ? end_of_number(s) : end_of_word(s);
}

/* Of a member's name in an object, and the colon behind it. */
static const char *end_of_name(const char *s) {
  s = vs_json_string_end(s);
  if (s) s += strspn(s, BLANKS);
  return s && *s == ':' ? s + 1 + strspn(s + 1, BLANKS) : NULL;
}

bool vs_json_is_whole(const char *text) {
  char close[VS_JSON_DEPTH]; /* of what is open */
  int depth = 0;
  const char *s = text + strspn(text, BLANKS);
  for (bool value = true; s; s += strspn(s, BLANKS)) { /* value: one may begin at s */
    const char open = *s;
    if (value && (open == '{' || open == '[')) {
      if (depth == VS_JSON_DEPTH) return false;
      close[depth++] = open == '{' ? '}' : ']';
      s += 1 + strspn(s + 1, BLANKS);
      value = *s != close[depth - 1]; /* it may be empty */
      if (value && open == '{') s = end_of_name(s);
      if (!s) return false;
      continue;
    }
    if (value) {
      s = end_of_plain(s);
      value = false;
    } else if (!depth)
      return !*s;
    else if (*s == close[depth - 1]) {
      depth--;
      s++;
    } else if (*s != ',')
      return false;
    else {
      s += 1 + strspn(s + 1, BLANKS);
      if (close[depth - 1] == '}') s = end_of_name(s);
      value = true;
    }
    if (!s) return false;
  }
  return false;
}
