/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/error.h"

#include <stdarg.h>
#include <stdio.h>

/* A message is one line whatever the user's words in it hold. */
static void one_line(char *text) {
  for (; *text; text++)
    if ((unsigned char)*text < 0x20 || *text == 0x7f) *text = ' ';
}

vs_status vs_fail(vs_error *err, vs_status status, const char *format, ...) {
  va_list args;
  va_start(args, format);
  vsnprintf(err->text, sizeof err->text, format, args);
  va_end(args);
  one_line(err->text);
  return status;
}

vs_status vs_fail_at(vs_error *err, vs_where where, const char *format, ...) {
  int n = 0;
  if (where.file && where.line > 0)
    n = snprintf(err->text, sizeof err->text, "%s:%d:%d: ", where.file, where.line, where.column);
  else if (where.file)
    n = snprintf(err->text, sizeof err->text, "%s: ", where.file);
  if (n < 0 || (size_t)n >= sizeof err->text) n = 0;
  va_list args;
  va_start(args, format);
  vsnprintf(err->text + n, sizeof err->text - (size_t)n, format, args);
  va_end(args);
  one_line(err->text);
  return VS_INPUT;
}
