/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/source.h"

#include <ctype.h>
#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/hash.h"
#include "base/jail.h"
#include "base/path.h"
#include "base/text.h"
#include "netlist/numbers.h"
#include "netlist/words.h"

/* The bytes of a file as they are on the disk. */
typedef struct bytes {
  unsigned char *at; /* owned; a zero byte stands behind them */
  size_t count;
} bytes;

/* The largest file of text that is read, in bytes. A byte takes a dozen of memory until the netlist
 * is made. */
enum { LARGEST = 1 << 24 };

static vs_status read_bytes(const char *path, bytes *b, vs_error *err) {
  const vs_where place = {.file = path};
  struct stat s;
  vs_status status = vs_jail_check(path, place, err);
  if (status) return status;
  if (!stat(path, &s) && !S_ISREG(s.st_mode)) return vs_fail_at(err, place, "is no file of text");
  FILE *f;
  status = vs_hash_open(path, &f, err);
  if (status) return status;
  if (!f) return vs_fail_at(err, place, "cannot be opened: %s", strerror(errno));
  size_t room = 0, n;
  do {
    room = 2 * room + 4096;
    b->at = vs_resize(b->at, room, 1);
    n = fread(b->at + b->count, 1, room - 1 - b->count, f);
    b->count += n;
  } while (n > 0 && b->count == room - 1 && b->count <= LARGEST);
  b->at[b->count] = '\0';
  if (ferror(f)) status = vs_fail_at(err, place, "cannot be read: %s", strerror(errno));
  if (!status && b->count > LARGEST)
    status = vs_fail_at(err, place,
                        "more than %d bytes, and no netlist is so large; copy what the circuit "
                        "needs of it into a file of its own",
                        LARGEST);
  fclose(f);
  return status;
}

/* ---- which encoding ---- */

/* How a file is encoded: how many bytes its mark has, and which byte of UTF-16's two comes first.
 */
typedef struct encoding {
  size_t mark;
  bool utf16, big_end_first;
} encoding;

static encoding find_encoding(const bytes *b) {
  enum { ENOUGH = 32 }; /* characters; a file of text has no zero byte in any of them */
  const unsigned char *c = b->at;
  size_t even = 0, odd = 0, seen = b->count / 2 < ENOUGH ? b->count / 2 : ENOUGH;
  if (b->count >= 3 && !memcmp(c, "\xef\xbb\xbf", 3)) return (encoding){3, false, false};
  if (b->count >= 2 && !memcmp(c, "\xff\xfe", 2)) return (encoding){2, true, false};
  if (b->count >= 2 && !memcmp(c, "\xfe\xff", 2)) return (encoding){2, true, true};
  for (size_t k = 0; k < seen; k++) {
    even += c[2 * k] == 0;
    odd += c[2 * k + 1] == 0;
  }
  bool utf16 = seen > 0 && b->count % 2 == 0 && even + odd == seen && (!even || !odd);
  return (encoding){0, utf16, even > 0};
}

/* Writes a character as UTF-8, in at most four bytes, and returns the byte behind it. */
static char *put_utf8(char *to, uint32_t c) {
  if (c < 0x80) {
    *to++ = (char)c;
    return to;
  }
  int more = c < 0x800 ? 1 : c < 0x10000 ? 2 : 3; /* bytes of six bits that follow */
  static const unsigned char FIRST[] = {0, 0xc0, 0xe0, 0xf0};
  *to++ = (char)(FIRST[more] | (c >> (6 * more)));
  for (; more > 0; more--) *to++ = (char)(0x80 | ((c >> (6 * (more - 1))) & 0x3f));
  return to;
}

static int line_of(const char *text, const char *at) {
  int line = 1;
  for (const char *s = text; s < at; s++) line += *s == '\n';
  return line;
}

/* From UTF-16. Two units of it, 0xd800 to 0xdbff and 0xdc00 to 0xdfff, are one character beyond
 * 0xffff; neither stands alone. */
static vs_status from_utf16(const bytes *b, const encoding *e, const char *path, char *to,
                            vs_error *err) {
  const char *text = to;
  uint32_t first = 0;
  for (size_t k = e->mark; k + 1 < b->count; k += 2) {
    uint32_t unit = (uint32_t)b->at[k + !e->big_end_first] << 8 | b->at[k + e->big_end_first];
    bool high = unit >= 0xd800 && unit < 0xdc00, low = unit >= 0xdc00 && unit < 0xe000;
    bool alone = first ? !low : low;
    if (alone || unit == 0)
      return vs_fail_at(err, (vs_where){path, line_of(text, to), 1},
                        unit ? "half of a pair of UTF-16's; is this a text?"
                             : "a zero byte; a netlist is a text");
    if (first) unit = 0x10000 + ((first - 0xd800) << 10) + (unit - 0xdc00);
    first = high ? unit : 0;
    if (!high) to = put_utf8(to, unit);
  }
  *to = '\0';
  return first || (b->count - e->mark) % 2
             ? vs_fail_at(err, (vs_where){path, line_of(text, to), 1},
                          "UTF-16 that is cut off in the middle of a character")
             : VS_OK;
}

static vs_status from_bytes(const bytes *b, size_t mark, const char *path, char *to,
                            vs_error *err) {
  const char *from = (const char *)b->at + mark, *text = to;
  bool latin = vs_text_not_utf8(from, b->count - mark) != NULL;
  for (size_t k = mark; k < b->count; k++) {
    unsigned char c = b->at[k];
    if (c == 0)
      return vs_fail_at(err, (vs_where){path, line_of(text, to), 1},
                        "a zero byte; a netlist is a text");
    if (latin)
      to = put_utf8(to, c);
    else
      *to++ = (char)c;
  }
  *to = '\0';
  return VS_OK;
}

/* ---- lines ---- */

/* Ends the text at a Ctrl-Z behind which nothing but more of them, and ends of lines, stand. */
static void cut_end(char *text) {
  char *end = strchr(text, '\x1a');
  if (end && !end[strspn(end, "\x1a \t\r\n")]) *end = '\0';
}

/* Returns the length of the end of a line that begins here: CRs before an LF belong to it, others
 * are ends of their own. */
static size_t end_length(const char *s) {
  size_t n = strspn(s, "\r");
  return s[n] == '\n' ? n + 1 : n > 0;
}

static void split_lines(vs_source *s) {
  size_t room = 0;
  for (char *at = s->text; *at;) {
    if (s->count == room) {
      room = 2 * room + 64;
      s->line = vs_resize(s->line, room, sizeof *s->line);
    }
    s->line[s->count++] = at;
    at += strcspn(at, "\r\n");
    size_t n = end_length(at);
    *at = '\0';
    at += n;
  }
}

/* True for a line of at least eight bytes as pairs of digits of base 16. */
static bool is_hexadecimal(const char *line) {
  int pairs = 0;
  const char *s = line + strspn(line, " \t");
  for (; isxdigit((unsigned char)s[0]) && isxdigit((unsigned char)s[1]); pairs++)
    s += 2 + strspn(s + 2, " \t");
  return !*s && pairs >= 8;
}

/* Error: LTspice has made the file unreadable for others. */
static vs_status check_encryption(const vs_source *s, const char *path, vs_error *err) {
  for (size_t k = 0; k + 1 < s->count; k++)
    if (!strncmp(s->line[k], "* Begin:", 8) && is_hexadecimal(s->line[k + 1]))
      return vs_fail_at(
          err, (vs_where){path, (int)k + 1, 1},
          "is encrypted for LTspice, and no other program reads it; its maker may have "
          "a plain one, for PSpice");
  return VS_OK;
}

vs_status vs_source_read(const char *path, vs_source *source, vs_error *err) {
  bytes b = {0};
  *source = (vs_source){0};
  vs_status status = read_bytes(path, &b, err);
  if (!status) {
    encoding e = find_encoding(&b);
    source->text = vs_alloc(2 * b.count + 1, 1); /* a byte becomes two at most, two become three */
    status = e.utf16 ? from_utf16(&b, &e, path, source->text, err)
                     : from_bytes(&b, e.mark, path, source->text, err);
  }
  free(b.at);
  if (status) return status;
  cut_end(source->text);
  split_lines(source);
  return check_encryption(source, path, err);
}

void vs_source_free(vs_source *source) {
  free(source->text);
  free(source->line);
  *source = (vs_source){0};
}

static vs_status add_numbers(const vs_source *s, const char *path, vs_text *out, vs_error *err) {
  static const char BETWEEN[] = " \t,;()";
  double value;
  size_t count = 0, line = 0;
  for (; line < s->count; line++) {
    const char *at = s->line[line] + strspn(s->line[line], BETWEEN);
    for (; *at && !strchr("*#", *at); at += strspn(at, BETWEEN), count++) {
      const vs_word w = {at, strcspn(at, BETWEEN)};
      if (!vs_numbers_read(w, &value)) break;
      vs_text_add(out, "%s%.*s", count ? " " : "", (int)w.n, w.at);
      at += w.n;
    }
    if (*at && !strchr("*#", *at)) break;
  }
  return count && count % 2 == 0 && line == s->count
             ? VS_OK
             : vs_fail_at(err, (vs_where){path, (int)line + (line < s->count), 1},
                          "pairs 'TIME VALUE' are wanted in a file of PWL points, and no more");
}

vs_status vs_source_points(const char *line, vs_where where, vs_text *out, vs_error *err) {
  const char *pwl = strcasestr(line, "pwl");
  vs_word whole, value;
  if (!*line || !strchr("vViI", *line) || !pwl || !strchr(" \t", pwl[-1])) return VS_OK;
  const char *s = pwl + 3 + strspn(pwl + 3, " \t(");
  if (!vs_words_parameter(s, "file", &whole, &value) || whole.at != s) return VS_OK;
  char path[VS_PATH_SIZE], name[VS_PATH_SIZE / 2];
  const bool quoted = value.n > 2 && strchr("'\"", *value.at);
  const char *end = whole.at + whole.n;
  if (!quoted) value.n = strcspn(value.at, " \t)");
  if (!quoted) end = value.at + value.n;
  snprintf(name, sizeof name, "%.*s", (int)value.n - 2 * quoted, value.at + quoted);
  for (char *c = name; *c; c++)
    if (*c == '\\') *c = '/';
  const char *slash = strrchr(where.file, '/'), *last = strrchr(name, '/');
  const int folder = slash ? (int)(slash - where.file + 1) : 0;
  snprintf(path, sizeof path, "%.*s%s", *name == '/' ? 0 : folder, where.file, name);
  if (access(path, R_OK))
    snprintf(path, sizeof path, "%.*s%s", folder, where.file, last ? last + 1 : name);
  vs_status status = vs_jail_check(path, where, err);
  if (!status && access(path, R_OK))
    status = vs_fail_at(err, where, "the file %s of PWL points is not here; copy it beside %s",
                        name, where.file);
  vs_source source = {0};
  if (!status) status = vs_source_read(path, &source, err);
  if (!status) {
    vs_text_add(out, "%.*sPWL(", (int)(pwl - line), line);
    status = add_numbers(&source, path, out, err);
    end += strspn(end, " \t)");
    vs_text_add(out, ")%s%s", *end ? " " : "", end);
  }
  vs_source_free(&source);
  return status;
}

void vs_source_plain(char *line) {
  static const struct {
    const char *sign, *plain;
  } SIGNS[] = {
      {"\xc2\xb5", "u"},     /* micro sign */
      {"\xce\xbc", "u"},     /* Greek small letter mu */
      {"\xc2\xa0", " "},     /* blank that keeps words together */
      {"\xe2\x80\x89", " "}, /* thin blank */
      {"\xe2\x80\xaf", " "}, /* narrow blank that keeps words together */
      {"\xe2\x88\x92", "-"}, /* minus */
      {"\xe2\x80\x93", "-"}, /* dash as wide as an n */
      {"\xe2\x80\x8b", ""},  /* blank of no width: none of a name's characters */
      {"\xe2\x80\x8c", ""},  {"\xe2\x80\x8d", ""}, {"\xe2\x81\xa0", ""},
      {"\xef\xbb\xbf", ""},  {"\xc2\xad", ""}}; /* hyphen that shows at the end of a line alone */
  char *to = line;
  while (*to && (unsigned char)*to < 0x80) to++;
  for (const char *from = to; *from;) {
    size_t n = 0;
    for (size_t k = 0; k < sizeof SIGNS / sizeof *SIGNS && !n; k++)
      if (!strncmp(from, SIGNS[k].sign, strlen(SIGNS[k].sign))) {
        n = strlen(SIGNS[k].sign);
        if (*SIGNS[k].plain) *to++ = *SIGNS[k].plain;
      }
    if (!n) *to++ = *from, n = 1;
    from += n;
  }
  *to = '\0';
}
