/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "workers/platform.h"

#include <gsl/gsl_version.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#ifdef __GLIBC__
#include <gnu/libc-version.h>
#endif

#include "base/hash.h"
#include "ngspice/ngspice.h"

/* ---- what is here ---- */

static double power(double x) {
  return pow(x, 0.7 + 0.01 * x);
}

static double logarithm(double x) {
  return log(x + 20.001);
}

static double angle(double x) {
  return atan2(x, 1.7);
}

static double raised(double x) {
  return power(x + 20.001);
}

/* Adds what a function returns for arguments from -20 to 20. Of glibc's functions with and without
 * fused multiply-add one result in some hundred to some ten thousand differs. */
static void add_function(vs_hash *hash, double (*volatile function)(double)) {
  enum { ARGUMENTS = 8192 };
  for (int k = 0; k < ARGUMENTS; k++) {
    const double y = function(-20 + 40 * (k + 0.31) / ARGUMENTS);
    vs_hash_add(hash, &y, sizeof y);
  }
}

static void digest_libm(char digest[VS_HASH_TEXT]) {
  static double (*const FUNCTIONS[])(double) = {sin,  cos,  tan,   exp,   logarithm, raised,
                                                sinh, tanh, expm1, angle, cbrt,      exp2};
  vs_hash hash;
  vs_hash_begin(&hash);
  for (size_t k = 0; k < sizeof FUNCTIONS / sizeof *FUNCTIONS; k++)
    add_function(&hash, FUNCTIONS[k]);
  vs_hash_end(&hash, digest);
}

static const char *c_library(void) {
#ifdef __GLIBC__
  return gnu_get_libc_version();
#else
  return "none";
#endif
}

const char *vs_platform_here(void) {
  static char line[160];
  struct utsname system;
  char digest[VS_HASH_TEXT];
  if (*line) return line;
  digest_libm(digest);
  snprintf(line, sizeof line, "%.32s, libm %.8s, glibc %.16s, ngspice %.16s, GSL %.16s",
           uname(&system) ? "unknown" : system.machine, digest, c_library(), vs_ngspice_version(),
           gsl_version);
  return line;
}

/* ---- lists ---- */

static bool has_line_of_bits(const vs_text *list, const char *line, size_t n) {
  for (const char *s = list->text; s && *s; s += strcspn(s, "\n") + 1)
    if (strcspn(s, "\n") == n && !strncmp(s, line, n)) return true;
  return false;
}

void vs_platform_add(vs_text *list, const char *lines) {
  for (const char *s = lines; s && *s;) {
    const size_t n = strcspn(s, "\n");
    if (!has_line_of_bits(list, s, n)) vs_text_add(list, "%.*s\n", (int)n, s);
    s += n + (s[n] == '\n');
  }
}

bool vs_platform_differ(const vs_text *list) {
  return list->length && strchr(list->text, '\n') != list->text + list->length - 1;
}

void vs_platform_json(const vs_text *list, vs_json *json) {
  if (!vs_platform_differ(list)) return;
  vs_json_array(json, "computed_on", VS_JSON_LINES);
  for (const char *s = list->text; *s; s += strcspn(s, "\n") + 1) {
    char *line = vs_alloc_part(s, strcspn(s, "\n"));
    vs_json_text(json, NULL, line);
    free(line);
  }
  vs_json_end(json);
}

/* ---- the warning ---- */

/* True for a unit per microsecond. Such a rate is decided by a few steps of the solver. */
static bool is_rate(const vs_row_shape_column *column) {
  return strstr(column->unit, "/us\"") != NULL;
}

/* Writes the names of the measured columns that are rates, or of those that are none. Behind the
 * axes all numbers are measured. */
static void list_columns(const vs_row_shape *shape, bool rates, vs_text *to) {
  to->length = 0;
  for (size_t k = vs_row_shape_first_measure(shape); k < vs_row_shape_columns(shape); k++) {
    const vs_row_shape_column c = vs_row_shape_column_at(shape, k);
    if (c.cells == VS_CELLS_VALUE && is_rate(&c) == rates)
      vs_text_add(to, "%s%s", to->length ? ", " : "", c.name);
  }
}

void vs_platform_warn(const vs_text *list, const vs_row_shape *shape, const char *path) {
  vs_text columns = {0};
  fprintf(stderr, "vibrospice: warning: %s: its rows are made on ", path);
  for (const char *s = list->text; *s; s += strcspn(s, "\n") + 1)
    fprintf(stderr, "%s%.*s", s == list->text ? "" : "; and on ", (int)strcspn(s, "\n"), s);
  fprintf(stderr, "; their last bits may differ. Columns at risk: ");
  list_columns(shape, true, &columns);
  if (columns.length)
    fprintf(stderr, "%s (rates, which few steps decide: by a per cent or so); ", columns.text);
  list_columns(shape, false, &columns);
  fprintf(stderr, "%s (by less than run.tolerance)\n", columns.text);
  vs_text_free(&columns);
}
