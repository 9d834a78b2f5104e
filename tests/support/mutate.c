/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mutate.h"

#include <ctype.h>
#include <string.h>

#include "base/alloc.h"
#include "suite.h"

/* xorshift64*, as in S. Vigna, ACM Transactions on Mathematical Software 42 (2016) 30. */
size_t mutate_below(uint64_t *state, size_t n) {
  uint64_t x = *state ? *state : 1;
  x ^= x >> 12;
  x ^= x << 25;
  x ^= x >> 27;
  *state = x;
  return (size_t)((x * 2685821657736338717u >> 33) % n);
}

/* A stretch of a text: bytes from `at`, `size` of them, in whose place `put` comes. */
typedef struct change {
  size_t at, size;
  const char *put;
  size_t put_size;
} change;

typedef struct source {
  const char *text;
  size_t size;
  uint64_t *state;
} source;

static size_t line_begin(const source *s, size_t at) {
  while (at && s->text[at - 1] != '\n') at--;
  return at;
}

/* Behind its newline. */
static size_t line_end(const source *s, size_t at) {
  while (at < s->size && s->text[at] != '\n') at++;
  return at + (at < s->size);
}

static size_t somewhere(const source *s) {
  return mutate_below(s->state, s->size);
}

static bool in_word(char c) {
  return isalnum((unsigned char)c) || c == '_' || c == '.' || c == '-' || c == '+' || c == '$';
}

/* Chooses a word, or one that begins with a digit, and its place. Comments are long: a word of one
 * is mostly passed over. Returns false where some tries find none. */
static bool find_word(const source *s, bool number, size_t *at, size_t *size) {
  for (int n = 0; n < 60; n++) {
    size_t a = somewhere(s), b;
    if (!in_word(s->text[a])) continue;
    char first = s->text[line_begin(s, a)];
    bool comment = first == '#' || (first == '*' && s->text[line_begin(s, a) + 1] != '$');
    if (comment && n < 50) continue;
    for (; a && in_word(s->text[a - 1]); a--) {
    }
    for (b = a; b < s->size && in_word(s->text[b]); b++) {
    }
    if (number && !isdigit((unsigned char)s->text[a]) && s->text[a] != '-' && s->text[a] != '.')
      continue;
    *at = a;
    *size = b - a;
    return true;
  }
  return false;
}

static change one_line(const source *s) {
  size_t at = line_begin(s, somewhere(s));
  return (change){.at = at, .size = line_end(s, at) - at};
}

static change delete_line(const source *s) {
  return one_line(s);
}

static change double_line(const source *s) {
  change c = one_line(s);
  return (change){c.at, 0, s->text + c.at, c.size};
}

static change move_line(const source *s) {
  change c = one_line(s);
  return (change){line_begin(s, somewhere(s)), 0, s->text + c.at, c.size};
}

static change join_lines(const source *s) {
  change c = one_line(s);
  return (change){.at = c.at + c.size - (c.size > 0), .size = c.size > 0};
}

static change cut_off(const source *s) {
  size_t at = somewhere(s);
  return (change){.at = at, .size = s->size - at};
}

static change put_in(const source *s, const char *put, size_t size) {
  return (change){somewhere(s), 0, put, size};
}

static change zero_byte(const source *s) {
  return put_in(s, "", 1);
}

static change no_utf8(const source *s) {
  return put_in(s, mutate_below(s->state, 2) ? "\xff" : "\xc3", 1);
}

static change sign(const source *s) {
  static const char SIGNS[] = "{}[](),:;=\"'#*$&%@!<>|~^/\\-+.\t\n\r 09aexZ";
  return put_in(s, SIGNS + mutate_below(s->state, sizeof SIGNS - 1), 1);
}

static change lost_byte(const source *s) {
  return (change){.at = somewhere(s), .size = 1};
}

static change lost_word(const source *s) {
  change c = {0};
  find_word(s, false, &c.at, &c.size);
  return c;
}

static change double_word(const source *s) {
  change c = {0};
  if (find_word(s, false, &c.at, &c.put_size)) c.put = s->text + c.at;
  return c;
}

/* A key, a node or a unit of elsewhere in the text. */
static change moved_word(const source *s) {
  change c = {0};
  size_t from;
  if (find_word(s, false, &c.at, &c.size) && find_word(s, false, &from, &c.put_size))
    c.put = s->text + from;
  return c;
}

static change one_of(const source *s, bool number, const char *const *words, size_t count) {
  change c = {0};
  if (!find_word(s, number, &c.at, &c.size)) return c;
  c.put = words[mutate_below(s->state, count)];
  c.put_size = strlen(c.put);
  return c;
}

static change other_word(const source *s) {
  static const char *const WORDS[] = {"nonsense", "all",    "none",   "0",     "-1",        "[]",
                                      "{}",       "[1, 2]", "{a: 1}", "true",  "~",         "\"\"",
                                      "a b",      "x.inc",  "../x",   "run",   "thyristor", "part",
                                      "param",    "V=",     "v(a)",   "i(v1)", "{x}",       "*"};
  return one_of(s, false, WORDS, COUNT(WORDS));
}

static change other_number(const source *s) {
  static const char *const NUMBERS[] = {"0",
                                        "-1",
                                        "1e308",
                                        "1e-300",
                                        "1e999",
                                        "nan",
                                        "inf",
                                        "1.5",
                                        "1e3",
                                        "-5e6",
                                        "12345678901234567890",
                                        "1,5",
                                        "0x10",
                                        "1e",
                                        "--1",
                                        "1k",
                                        "07",
                                        "x"};
  return one_of(s, true, NUMBERS, COUNT(NUMBERS));
}

static change other_unit(const source *s) {
  static const char *const UNITS[] = {"V",  "A",  "mm", "kg",      "s",     "deg",   "ohm",
                                      "nF", "Hz", "%",  "furlong", "N.s/m", "kV/us", "K"};
  change c = {0};
  for (int n = 0; n < 60; n++) {
    size_t from, size;
    if (!find_word(s, true, &from, &size)) return c;
    for (from += size; from < s->size && s->text[from] == ' '; from++) {
    }
    for (c.at = from; from < s->size && (in_word(s->text[from]) || s->text[from] == '/'); from++) {
    }
    c.size = from - c.at;
    if (!c.size || !isalpha((unsigned char)s->text[c.at])) continue;
    c.put = UNITS[mutate_below(s->state, COUNT(UNITS))];
    c.put_size = strlen(c.put);
    return c;
  }
  return (change){0};
}

static change slip(const source *s) {
  change c = {0};
  size_t size;
  if (!find_word(s, false, &c.at, &size)) return c;
  c.at += mutate_below(s->state, size);
  c.size = 1;
  c.put = "abcdefghijklmnopqrstuvwxyz_" + mutate_below(s->state, 27);
  c.put_size = 1;
  return c;
}

static change odd_line(const source *s) {
  static const char *const LINES[] = {"nonsense\n",
                                      "nonsense: 1\n",
                                      "  nonsense: {a: 1}\n",
                                      "- 1\n",
                                      "*$ nonsense\n",
                                      "*$ param x = 1 V\n",
                                      "R9 a b\n",
                                      "X9 a b none\n",
                                      "Bx a 0 1\n",
                                      "D9 a 0 nomodel\n",
                                      ".include none.inc\n",
                                      ".model d9 d(\n",
                                      ".ends\n",
                                      ".subckt s9 a b\n",
                                      "+ 1\n",
                                      ",,,\n",
                                      "1,2,3\n",
                                      "{\n",
                                      "R8 a 0 {nonsense}\n",
                                      "V8 a 0 0\nV8 a 0 0\n",
                                      ".end\n",
                                      "\"\n",
                                      "*$ port mains = V1\n"};
  size_t k = mutate_below(s->state, COUNT(LINES));
  return (change){line_begin(s, somewhere(s)), 0, LINES[k], strlen(LINES[k])};
}

static change nothing_left(const source *s) {
  return mutate_below(s->state, 8) ? cut_off(s) : (change){.size = s->size};
}

/* `of_a_line`: it is one line that is wrong then, that where the change begins. */
static const struct {
  const char *name;
  change (*of)(const source *s);
  bool of_a_line;
} MISTAKES[] = {{"a line deleted", delete_line, false},
                {"a line twice", double_line, false},
                {"a line elsewhere", move_line, false},
                {"two lines joined", join_lines, true},
                {"cut off", nothing_left, false},
                {"a zero byte", zero_byte, true},
                {"no UTF-8", no_utf8, true},
                {"a sign put in", sign, true},
                {"a byte lost", lost_byte, true},
                {"a word lost", lost_word, true},
                {"a word twice", double_word, true},
                {"a word of elsewhere", moved_word, true},
                {"another word", other_word, true},
                {"another number", other_number, true},
                {"another unit", other_unit, true},
                {"a slip of the pen", slip, true},
                {"an odd line put in", odd_line, true}};

static int line_of(const source *s, size_t at) {
  int line = 1;
  for (size_t k = 0; k < at; k++) line += s->text[k] == '\n';
  return line;
}

char *mutate(const char *text, size_t size, uint64_t *state, size_t *new_size, mutation *what) {
  const source s = {text, size, state};
  char *made = NULL;
  for (int n = 0; n < 100; n++) {
    size_t k = mutate_below(state, COUNT(MISTAKES));
    change c = size ? MISTAKES[k].of(&s) : (change){0};
    *what = (mutation){MISTAKES[k].name, MISTAKES[k].of_a_line ? line_of(&s, c.at) : 0};
    *new_size = size - c.size + c.put_size;
    made = vs_alloc(*new_size + 1, 1);
    memcpy(made, text, c.at);
    if (c.put_size) memcpy(made + c.at, c.put, c.put_size);
    memcpy(made + c.at + c.put_size, text + c.at + c.size, size - c.at - c.size);
    if (*new_size != size || memcmp(made, text, size)) return made;
    if (n < 99) free(made);
  }
  return made;
}
