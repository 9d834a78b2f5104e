/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "part_rows.h"

#include "base/text.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

double number_of(const char *json, const char *figure, int nth, const char *key) {
  char mark[64];
  const char *row = json;
  snprintf(mark, sizeof mark, "\"figure\": \"%s\"", figure);
  for (int n = 0; row && n <= nth; n++) row = strstr(row + (n > 0), mark);
  snprintf(mark, sizeof mark, "\"%s\": ", key);
  const char *at = row ? strstr(row, mark) : NULL;
  char *end = NULL;
  double value = at ? strtod(at + strlen(mark), &end) : NAN;
  return at && end > at + strlen(mark) ? value : NAN;
}

void alter(const char *from, const char *to, const char *old, const char *new) {
  char *text = read_file(from), *at = strstr(text, old);
  vs_text changed = {0};
  EXPECT(at, "%s has no '%s'", from, old);
  if (at) vs_text_add(&changed, "%.*s%s%s", (int)(at - text), text, new, at + strlen(old));
  if (at) write_file(to, changed.text);
  vs_text_free(&changed);
  free(text);
}

void expect_warning(const ran *r, const char *file, int line, const char *says) {
  char place[64];
  snprintf(place, sizeof place, "%s:%d:", file, line);
  for (const char *at = r->err; at && *at; at = strchr(at, '\n')) {
    at += *at == '\n';
    const char *end = strchr(at, '\n'), *there = strstr(at, says);
    if (!strncmp(at, place, strlen(place)) && there && there < end) return;
    if (!end) break;
  }
  EXPECT(false, "no warning at %s that says '%s': %s", place, says, r->err);
}
