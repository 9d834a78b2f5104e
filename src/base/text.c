/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/text.h"

#include <assert.h>
#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void vs_text_add(vs_text *t, const char *format, ...) {
  va_list args, again;
  va_start(args, format);
  va_copy(again, args);
  size_t room = t->capacity - t->length;
  int n = vsnprintf(t->text ? t->text + t->length : NULL, room, format, args);
  va_end(args);
  if (n < 0) vs_alloc_failed(0); /* the C library needs memory for long numbers */
  size_t need = t->length + (size_t)n + 1;
  if (need > t->capacity) {
    t->capacity = need * 2;
    t->text = vs_resize(t->text, t->capacity, 1);
    vsnprintf(t->text + t->length, t->capacity - t->length, format, again);
  }
  va_end(again);
  t->length = need - 1;
}

void vs_text_put(vs_text *t, const char *bytes, size_t length) {
  const size_t need = t->length + length + 1;
  if (need > t->capacity) {
    t->capacity = need * 2;
    t->text = vs_resize(t->text, t->capacity, 1);
  }
  memcpy(t->text + t->length, bytes, length);
  t->text[t->length = need - 1] = '\0';
}

void vs_text_free(vs_text *t) {
  free(t->text);
  *t = (vs_text){0};
}

/* Adds a number by one conversion, as "%.4g" or "%ld". */
static void add_number(vs_text *t, const char *conversion, va_list *args) {
  const size_t last = strlen(conversion) - 1;
  const char size = conversion[last - 1], kind = conversion[last];
  if (kind == 'd' && size != 'l')
    vs_text_add(t, conversion, va_arg(*args, int));
  else if (kind == 'd')
    vs_text_add(t, conversion, va_arg(*args, long));
  else if (kind == 'u' && size == 'z')
    vs_text_add(t, conversion, va_arg(*args, size_t));
  else {
    assert(strchr("feg", kind));
    vs_text_add(t, conversion, va_arg(*args, double));
  }
}

void vs_text_add_by(vs_text *t, void (*write)(void *ctx, const char *text), void *ctx,
                    const char *format, va_list args) {
  va_list own;
  va_copy(own, args);
  while (*format) {
    const size_t plain = strcspn(format, "%");
    vs_text_add(t, "%.*s", (int)plain, format);
    format += plain;
    if (!*format) break;
    char conversion[16];
    const size_t n = 2 + strcspn(format + 1, "%cdfegsu");
    assert(n < sizeof conversion);
    snprintf(conversion, sizeof conversion, "%.*s", (int)n, format);
    format += n;
    if (!strcmp(conversion, "%%"))
      vs_text_add(t, "%%");
    else if (!strcmp(conversion, "%s"))
      write(ctx, va_arg(own, const char *));
    else if (!strcmp(conversion, "%c"))
      vs_text_add(t, "%c", va_arg(own, int));
    else
      add_number(t, conversion, &own);
  }
  va_end(own);
}

enum { LONGEST_NAME = 63 };

static size_t min3(size_t a, size_t b, size_t c) {
  size_t m = a < b ? a : b;
  return m < c ? m : c;
}

/* Counts the insertions, deletions, substitutions and swaps of neighbours that turn a into b,
 * capitals aside. */
static size_t edit_distance(const char *a, const char *b) {
  size_t n = strlen(a), m = strlen(b);
  if (n > LONGEST_NAME || m > LONGEST_NAME) return n > m ? n : m;
  size_t row[3][LONGEST_NAME + 1];
  for (size_t j = 0; j <= m; j++) row[0][j] = j;
  for (size_t i = 1; i <= n; i++) {
    size_t *now = row[i % 3], *up = row[(i + 2) % 3], *up2 = row[(i + 1) % 3];
    now[0] = i;
    for (size_t j = 1; j <= m; j++) {
      int ca = tolower((unsigned char)a[i - 1]), cb = tolower((unsigned char)b[j - 1]);
      now[j] = min3(now[j - 1] + 1, up[j] + 1, up[j - 1] + (ca != cb));
      if (i > 1 && j > 1 && ca == tolower((unsigned char)b[j - 2]) &&
          cb == tolower((unsigned char)a[i - 2]) && up2[j - 2] + 1 < now[j])
        now[j] = up2[j - 2] + 1;
    }
  }
  return row[n % 3][m];
}

const char *vs_text_nearest(const char *name, const char *const *candidates, size_t count) {
  const char *best = NULL;
  size_t best_distance = strlen(name) / 2 + 2; /* a name that is farther away is another word */
  for (size_t k = 0; k < count; k++) {
    size_t d = edit_distance(name, candidates[k]);
    if (d < best_distance) {
      best_distance = d;
      best = candidates[k];
    }
  }
  return best;
}

vs_text_hinted vs_text_hint(const char *name, const char *const *candidates, size_t count,
                            const char *otherwise) {
  vs_text_hinted hint;
  const char *nearest = vs_text_nearest(name, candidates, count);
  snprintf(hint.text, sizeof hint.text, nearest ? "; did you mean '%s'?" : "%s",
           nearest ? nearest : otherwise);
  return hint;
}

/* Returns how many bytes the UTF-8 character at s has, where `left` bytes are left; 0: there is
 * none. */
static size_t utf8_size(const unsigned char *s, size_t left) {
  size_t size = s[0] < 0x80 ? 1 : s[0] < 0xc2 ? 0 : s[0] < 0xe0 ? 2 : s[0] < 0xf0 ? 3 : 4;
  if (size == 0 || s[0] > 0xf4 || size > left) return 0;
  for (size_t k = 1; k < size; k++)
    if ((s[k] & 0xc0) != 0x80) return 0;
  bool overlong = (s[0] == 0xe0 && s[1] < 0xa0) || (s[0] == 0xf0 && s[1] < 0x90);
  bool beyond = (s[0] == 0xed && s[1] >= 0xa0) || (s[0] == 0xf4 && s[1] >= 0x90);
  return overlong || beyond ? 0 : size;
}

const char *vs_text_not_utf8(const char *text, size_t length) {
  for (size_t at = 0, size; at < length; at += size) {
    bool plain = (unsigned char)text[at] < 0x80;
    size = plain ? 1 : utf8_size((const unsigned char *)text + at, length - at);
    if (!size) return text + at;
  }
  return NULL;
}

/* True for the code points of Unicode that are obeyed: controls (its category Cc), and the ends,
 * overrides, isolates and marks of direction (Bidi_Control) and ends of lines and paragraphs. */
static bool is_obeyed(unsigned long point) {
  static const struct {
    unsigned long first, last;
  } RANGES[] = {{0x00, 0x08},     {0x0b, 0x1f},     {0x7f, 0x9f},    {0x61c, 0x61c},
                {0x200e, 0x200f}, {0x2028, 0x202e}, {0x2066, 0x2069}};
  for (size_t k = 0; k < sizeof RANGES / sizeof *RANGES; k++)
    if (point >= RANGES[k].first && point <= RANGES[k].last) return true;
  return false;
}

size_t vs_text_next(const char *text, char shown[VS_SHOWN_SIZE]) {
  const unsigned char lead = (unsigned char)*text;
  const size_t wanted = lead < 0x80 ? 1 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
  const size_t n = strnlen(text, wanted);
  unsigned long point = n == 1 ? lead : lead & (0x7fu >> n);
  if (n < wanted || vs_text_not_utf8(text, n)) {
    snprintf(shown, VS_SHOWN_SIZE, "\\x%02x", lead);
    return 1;
  }
  for (size_t k = 1; k < n; k++) point = point << 6 | ((unsigned char)text[k] & 0x3fu);
  if (is_obeyed(point))
    snprintf(shown, VS_SHOWN_SIZE, "\\u%04lx", point);
  else
    snprintf(shown, VS_SHOWN_SIZE, "%.*s", (int)n, text);
  return n;
}

int vs_text_column(const char *line, const char *at) {
  int column = 1;
  for (; line < at; line++)
    column += (*line & 0xc0) != 0x80; /* bytes that continue a character do not count */
  return column;
}

/* Powers of five that 64 bits hold. */
enum { LARGEST_POWER = 27, MOST_DIGITS = 17 };
#define FOUR_(first) (first), (first)*5u, (first)*25u, (first)*125u
static const uint64_t FIVE[LARGEST_POWER + 1] = {FOUR_(UINT64_C(1)),
                                                 FOUR_(UINT64_C(625)),
                                                 FOUR_(UINT64_C(390625)),
                                                 FOUR_(UINT64_C(244140625)),
                                                 FOUR_(UINT64_C(152587890625)),
                                                 FOUR_(UINT64_C(95367431640625)),
                                                 FOUR_(UINT64_C(59604644775390625))};
#undef FOUR_

/* Returns the first `digits` digits of |value| as a whole number, rounded to nearest and a tie to
 * even, as printf does; the first of them is worth 10^*tens. It returns 0 where the steps below do
 * not tell them: of what is no number, and of numbers below some 10^(digits - 28) or from
 * 10^digits on.
 *
 * |value| is m 2^e with a whole m of 53 bits, so that |value| 10^n is m 5^n shifted by e + n bits.
 * The product has at most 53 + 63 bits: nothing of it is lost, and what is shifted out tells how to
 * round. */
static uint64_t leading_digits(double value, int digits, int *tens) {
#ifdef __SIZEOF_INT128__
  __extension__ typedef unsigned __int128 wide;
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  const int exponent = (int)(bits >> 52 & 0x7ff);
  const uint64_t one = UINT64_C(1) << 52, whole = (bits & (one - 1)) | one,
                 end = FIVE[digits] << digits; /* 10^digits */
  /* floor(log10(2^(exponent - 1023))) by 78913/2^18 = log10(2) - 8e-7, and 400 to be positive */
  *tens = (int)(((unsigned)exponent * 78913u + (400u << 18) - 1023u * 78913u) >> 18) - 400;
  for (int again = 0; again < 2; again++, ++*tens) { /* the estimate may be one too small */
    const int power = digits - 1 - *tens, out = 1075 - exponent - power;
    if (power < 0 || power > LARGEST_POWER || out < 1) return 0;
    const wide product = (wide)whole * FIVE[power], half = (wide)1 << (out - 1);
    uint64_t number = (uint64_t)(product >> out);
    if (number >= end) continue;
    const wide rest = product & (2 * half - 1);
    number += rest > half || (rest == half && number % 2);
    if (number < end) return number;
    ++*tens;
    return number / 10;
  }
#else
  (void)value, (void)digits, (void)tens;
#endif
  return 0;
}

/* Writes the number with so many digits, zeros before it included; two at a time, as a division
 * takes longer than a look. */
static void write_digits(char *digit, int count, uint64_t number) {
  static const char PAIRS[] =
      "0001020304050607080910111213141516171819202122232425262728293031323334"
      "3536373839404142434445464748495051525354555657585960616263646566676869"
      "707172737475767778798081828384858687888990919293949596979899";
  for (; count > 1; count -= 2, number /= 100)
    memcpy(digit + count - 2, PAIRS + 2 * (number % 100), 2);
  if (count) *digit = (char)('0' + number);
}

size_t vs_text_number(char text[VS_NUMBER_SIZE], double value, int digits) {
  int tens, count = digits;
  char digit[MOST_DIGITS], *to = text;
  if (value == 0 && !signbit(value)) return (size_t)(stpcpy(text, "0") - text);
  uint64_t number = digits > 0 && digits <= MOST_DIGITS ? leading_digits(value, digits, &tens) : 0;
  if (!number) return (size_t)snprintf(text, VS_NUMBER_SIZE, "%.*g", digits, value);
  write_digits(digit, count, number);
  while (digit[count - 1] == '0') count--;
  if (value < 0) *to++ = '-';
  const bool fixed = tens >= -4 && tens < digits;
  int before = fixed ? tens + 1 : 1; /* so many digits stand before the point */
  if (before <= 0) {
    memcpy(to, "0.000", 5);
    to += 2 - before, before = 0;
  } else if (before < count) {
    memcpy(to, digit, (size_t)before);
    to += before;
    *to++ = '.';
  } else { /* whole: zeros stand for the digits that it lacks */
    memcpy(to, digit, (size_t)count);
    memset(to + count, '0', (size_t)(before - count));
    to += before;
  }
  if (before < count)
    to = (char *)memcpy(to, digit + before, (size_t)(count - before)) + count - before;
  if (!fixed) { /* the exponent has two digits, as leading_digits() goes no further */
    *to++ = 'e';
    *to++ = tens < 0 ? '-' : '+';
    write_digits(to, 2, (uint64_t)abs(tens));
    to += 2;
  }
  *to = '\0';
  return (size_t)(to - text);
}

void vs_text_add_number(vs_text *t, double value, int digits) {
  char text[VS_NUMBER_SIZE];
  vs_text_put(t, text, vs_text_number(text, value, digits));
}

/* True where the digits before an exponent are not all 0. */
static bool has_digits(const char *text, const char *end) {
  const bool hexadecimal = strpbrk(text, "xX") && strpbrk(text, "xX") < end;
  for (const char *s = text; s < end && (hexadecimal || !strchr("eE", *s)); s++)
    if (*s >= '1' && *s <= '9') return true;
  return false;
}

const char *vs_text_out_of_range(const char *text) {
  char *end;
  const double value = strtod(text, &end);
  const size_t before = strspn(text, " \t+-");
  if (end == text || !strchr(".0123456789", text[before])) return NULL; /* as inf and nan */
  if (isinf(value)) return "too large a number: one below 1e300 is wanted";
  if (fabs(value) < DBL_MIN && has_digits(text, end))
    return "too small a number: 0, or one above 1e-300, is wanted";
  return NULL;
}

double vs_text_rounded(double value, int digits) {
  char text[VS_NUMBER_SIZE];
  snprintf(text, sizeof text, "%.*g", digits, value);
  return strtod(text, NULL);
}

double vs_text_to_number(const char *text, char **end) {
  const double value = strtod(text, end);
  return (isinf(value) || fabs(value) < DBL_MIN) && vs_text_out_of_range(text) ? NAN : value;
}

size_t vs_text_characters(const char *text) {
  size_t n = 0;
  for (; *text; text++) n += (*text & 0xC0) != 0x80;
  return n;
}

void vs_text_shorten(vs_text *t, size_t most) {
  if (!t->text || vs_text_characters(t->text) <= most) return;
  size_t at = 0, word = 0;
  for (size_t n = 0; n < most - 3; n++) {
    if (t->text[at] == ' ') word = at;
    for (at++; (t->text[at] & 0xC0) == 0x80;) at++;
  }
  if (t->text[at] == ' ') word = at;
  t->text[word ? word : at] = '\0';
  t->length = strlen(t->text);
  vs_text_add(t, "...");
}
