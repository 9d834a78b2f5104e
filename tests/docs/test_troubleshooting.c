/* SPDX-License-Identifier: GPL-3.0-or-later
 * docs/troubleshooting.md quotes messages. Each must be one that the program has: what stands
 * between the dots of a quotation must stand, in that order, in one string of the source. Strings
 * that follow one another in the source are one, as in C. */
#include <glob.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "program.h"

#define SOURCES VS_TEST_FOLDER "/../src/{*,*/*,*/include/*}/*.[ch]"
#define PAGE VS_TEST_FOLDER "/../docs/troubleshooting.md"

/* Adds the string that begins behind the quote at s, and returns what stands behind its end. */
static const char *take_string(const char *s, vs_text *strings) {
  for (; *s && *s != '"'; s++) {
    if (*s == '\\' && s[1] == '\n')
      s++;
    else if (*s == '\\')
      vs_text_add(strings, "%c", *++s == 'n' ? ' ' : *s);
    else
      vs_text_add(strings, "%c", *s);
  }
  return *s ? s + 1 : s;
}

/* Adds each string of a source as a line. */
static void take_source(const char *source, vs_text *strings) {
  for (const char *s = source; *s;) {
    if (*s == '\'' && s[1] && s[2] && (s[2] == '\'' || s[1] == '\\')) { /* '"' begins no string */
      s = strchr(s + 2 + (s[1] == '\\'), '\'');
      s = s ? s + 1 : "";
      continue;
    }
    if (!strncmp(s, "/*", 2)) {
      s = strstr(s, "*/");
      s = s ? s + 2 : "";
      continue;
    }
    if (*s++ != '"') continue;
    s = take_string(s, strings);
    const char *next = s + strspn(s, " \t\n");
    if (*next != '"')
      vs_text_add(strings, "\n");
    else
      s = next;
  }
}

static char *read_strings(void) {
  vs_text strings = {0};
  glob_t files;
  CU_ASSERT_EQUAL_FATAL(glob(SOURCES, GLOB_BRACE, NULL, &files), 0);
  for (size_t k = 0; k < files.gl_pathc; k++) {
    char *source = read_file(files.gl_pathv[k]);
    take_source(source, &strings);
    free(source);
  }
  globfree(&files);
  return strings.text;
}

/* True if the line has the quotation's parts in their order. */
static bool has_parts(const char *line, const char *quotation) {
  char *copy = vs_copy(quotation), *part = copy;
  bool all = true;
  while (all && part) {
    char *dots = strstr(part, "...");
    if (dots) *dots = '\0';
    const char *at = strstr(line, part);
    all = at != NULL;
    if (all) line = at + strlen(part);
    part = dots ? dots + 3 : NULL;
  }
  free(copy);
  return all;
}

static bool is_said(char *strings, const char *quotation) {
  bool said = false;
  for (char *line = strings, *end; !said && *line; line = end + 1) {
    end = line + strcspn(line, "\n");
    bool last = !*end;
    *end = '\0';
    said = has_parts(line, quotation);
    if (last) break;
    *end = '\n';
  }
  return said;
}

/* The first cell of each row of a table whose first column is "message". */
static void quotations(void) {
  char *page = read_file(PAGE), *strings = read_strings(), *rest = page;
  bool messages = false;
  int quoted = 0;
  for (char *line; (line = strsep(&rest, "\n"));) {
    if (*line != '|') messages = false;
    if (!strncmp(line, "| message |", 11)) messages = true;
    if (!messages) continue;
    line[strcspn(line + 1, "|") + 1] = '\0';
    for (char *s = line, *end; (s = strchr(s, '`')) && (end = strchr(s + 1, '`')); s = end + 1) {
      *end = '\0';
      quoted++;
      EXPECT(is_said(strings, s + 1), "no message of the program is '%s'", s + 1);
    }
  }
  EXPECT(quoted >= 30, "%d messages are quoted", quoted);
  EXPECT(!is_said(strings, "the cat ... the mat"), "%s", "anything is said");
  free(strings);
  free(page);
}

static const vs_test TESTS[] = {{"quotations", quotations}};

int main(void) {
  return program_suite("troubleshooting", TESTS, COUNT(TESTS));
}
