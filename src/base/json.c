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

void vs_json_string(vs_text *t, const char *string) {
  const char *bad = vs_text_not_utf8(string, strlen(string));
  vs_text_add(t, "\"");
  for (const unsigned char *s = (const unsigned char *)string; *s; s++) {
    if (bad == (const char *)s) {
      vs_text_add(t, "\\ufffd");
      bad = vs_text_not_utf8(bad + 1, strlen(bad + 1));
    } else if (*s == '"' || *s == '\\')
      vs_text_add(t, "\\%c", *s);
    else if (*s < 0x20)
      vs_text_add(t, "\\u%04x", *s);
    else
      vs_text_add(t, "%c", *s);
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

static void begin(vs_json *json, const char *key, vs_json_layout layout, const char *brackets) {
  vs_json_key(json, key);
  assert(json->depth < VS_JSON_DEPTH);
  json->level[json->depth].close = brackets[1];
  json->level[json->depth].lines = layout == VS_JSON_LINES;
  json->level[json->depth].has_members = false;
  json->depth++;
  vs_text_add(json->text, "%c", brackets[0]);
}

void vs_json_object(vs_json *json, const char *key, vs_json_layout layout) {
  begin(json, key, layout, "{}");
}

void vs_json_array(vs_json *json, const char *key, vs_json_layout layout) {
  begin(json, key, layout, "[]");
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
  vs_text_add(json->text, "%.*g", digits, value);
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
