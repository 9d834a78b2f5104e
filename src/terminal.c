/* SPDX-License-Identifier: GPL-3.0-or-later
 * What is printed for people.
 *
 * All that this program prints on standard output and standard error passes through here, whatever
 * printed it: names, units and messages may be a stranger's, out of a scene or a folder of results,
 * and a terminal obeys what follows an ESC byte. Such characters are written as their numbers
 * (vs_text_next in base/text.h). In JSON these numbers are its own escapes. What the program itself
 * tells a terminal, as colours and the line of progress, goes past, by dprintf. */
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"

/* A stream: the file that it ends in, and the beginning of a character whose end was not printed
 * yet. */
typedef struct outlet {
  int file;
  char begun[4];
  size_t count;
} outlet;

static outlet outlets[] = {{.file = STDOUT_FILENO}, {.file = STDERR_FILENO}};

/* How many bytes at the end of the text are the beginning of a character of UTF-8. */
static size_t begun_in(const char *text, size_t size) {
  for (size_t n = 1; n <= 3 && n <= size; n++) {
    const unsigned char byte = (unsigned char)text[size - n];
    if (byte >= 0xc0) return n < (byte >= 0xf0 ? 4u : byte >= 0xe0 ? 3u : 2u) ? n : 0;
    if (byte < 0x80) return 0;
  }
  return 0;
}

static bool put(int file, const char *text, size_t size) {
  while (size) {
    const ssize_t n = write(file, text, size);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    text += n;
    size -= (size_t)n;
  }
  return true;
}

/* Adds the text with what a terminal obeys as numbers; other bytes are added as they come. */
static void add_shown(vs_text *out, const char *text) {
  static const char BLANKS[] = "\n\t";
  char shown[VS_SHOWN_SIZE];
  while (*text) {
    size_t plain = 0;
    while ((text[plain] >= ' ' && text[plain] < 0x7f) ||
           (text[plain] && strchr(BLANKS, text[plain])))
      plain++;
    vs_text_add(out, "%.*s", (int)plain, text);
    text += plain;
    if (!*text) break;
    text += vs_text_next(text, shown);
    vs_text_add(out, "%s", shown);
  }
}

/* Writes all but the beginning of a character at the end, which it keeps. */
static ssize_t print(void *cookie, const char *from, size_t size) {
  outlet *o = cookie;
  vs_text out = {0};
  const size_t had = o->count, all = had + size;
  char *in = vs_alloc(all + 1, 1);
  memcpy(in, o->begun, had);
  memcpy(in + had, from, size);
  for (char *zero; (zero = memchr(in, '\0', all));) *zero = '\x7f'; /* it would end the text */
  o->count = begun_in(in, all);
  memcpy(o->begun, in + all - o->count, o->count);
  in[all - o->count] = '\0';
  add_shown(&out, in);
  const bool good = put(o->file, out.text ? out.text : "", out.length);
  vs_text_free(&out);
  free(in);
  return good ? (ssize_t)size : 0;
}

void terminal_begin(void);

void terminal_begin(void) {
  enum { LINES = 1 << 16 }; /* bytes of standard output that are written at once */
  const cookie_io_functions_t functions = {.write = print};
  stdout = vs_checked(fopencookie(&outlets[0], "w", functions));
  stderr = vs_checked(fopencookie(&outlets[1], "w", functions));
  setvbuf(stdout, NULL, _IOLBF, LINES); /* so that a warning never stands within a line */
  setvbuf(stderr, NULL, _IONBF, 0);
}
