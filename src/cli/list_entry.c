/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "list_entry.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

void vs_list_entry_begin(vs_entries *e) {
  e->lines.length = e->sought.length = e->object.length = 0;
  e->inside = false;
  e->head = 0;
  vs_text_add(&e->lines, "%s", "");
  vs_text_add(&e->sought, "%s", "");
  e->json = vs_json_new(&e->object);
  vs_json_object(&e->json, NULL, VS_JSON_ROW);
}

/* True if the text has the word, capitals aside. */
static bool text_has(const char *text, const char *word) {
  size_t n = strlen(word);
  for (; *text; text++)
    if (!strncasecmp(text, word, n)) return true;
  return !n;
}

void vs_list_entry_end(vs_entries *e) {
  vs_json_end(&e->json);
  if (e->lines.length) e->matched = !e->filter || text_has(e->sought.text, e->filter);
  if (!e->matched) return;
  if (e->as_json)
    vs_text_add(&e->out, "%s\n    %s", e->count ? "," : "", e->object.text);
  else
    vs_text_add(&e->out, "%s", e->lines.text);
  vs_text_add(&e->heads, "%.*s", (int)(e->head ? e->head : e->lines.length), e->lines.text);
  e->detailed = e->detailed || e->head;
  e->count++;
}

void vs_list_entry_details(vs_entries *e, const char *only) {
  if (only) e->sought.length = 0;
  if (only) vs_text_add(&e->sought, "%s", only);
  e->head = e->lines.length;
}

const char *vs_list_entry_lines(vs_entries *e) {
  enum { LONG = 4 }; /* more parts than fit on a screen with their limits */
  if (!e->detailed || e->count < LONG) return e->out.text;
  vs_text_add(&e->heads,
              "%d parts; up to %d are shown with limits and parameters: list parts NAME\n",
              e->count, LONG - 1);
  return e->heads.text;
}

void vs_list_entry_put(vs_entries *e, const char *key, int width, const char *value) {
  vs_text_add(&e->lines, "%s%-*s", e->inside ? " " : "", width, value);
  if (!e->head) vs_text_add(&e->sought, " %s", value);
  e->inside = true;
  vs_json_text(&e->json, key, value);
}

void vs_list_entry_path(vs_entries *e, const char *key, const char *path) {
  vs_text_add(&e->lines, "%s%s", e->inside ? " " : "", path);
  e->inside = true;
  vs_json_text(&e->json, key, path);
}

void vs_list_entry_say(vs_entries *e, const char *format, ...) {
  va_list arguments;
  char text[1024];
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  vs_text_add(&e->lines, "%s", text);
  if (!e->head) vs_text_add(&e->sought, "%s", text);
  e->inside = true;
}

void vs_list_entry_line(vs_entries *e) {
  vs_text_add(&e->lines, "\n");
  e->inside = false;
}

void vs_list_entry_text(vs_entries *e, const char *key, const char *value) {
  vs_json_text(&e->json, key, value);
}

void vs_list_entry_number(vs_entries *e, const char *key, double value) {
  vs_json_number(&e->json, key, value, 12);
}

void vs_list_entry_true(vs_entries *e, const char *key) {
  vs_json_bool(&e->json, key, true);
}

void vs_list_entry_array(vs_entries *e, const char *key) {
  vs_json_array(&e->json, key, VS_JSON_ROW);
}

void vs_list_entry_array_end(vs_entries *e) {
  vs_json_end(&e->json);
}

void vs_list_entry_object(vs_entries *e) {
  vs_json_object(&e->json, NULL, VS_JSON_ROW);
}

void vs_list_entry_object_end(vs_entries *e) {
  vs_json_end(&e->json);
}

void vs_list_entry_free(vs_entries *e) {
  vs_text_free(&e->out);
  vs_text_free(&e->heads);
  vs_text_free(&e->lines);
  vs_text_free(&e->sought);
  vs_text_free(&e->object);
}
