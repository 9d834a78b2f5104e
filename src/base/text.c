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

/* Powers of ten that a double holds exactly. */
enum { LARGEST_POWER = 22, MOST_DIGITS = 12 };
static const double TEN[LARGEST_POWER + 1] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                              1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                              1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/* Returns the first `digits` digits of a > 0 as a whole number; the first of them is worth
 * 10^*tens. It returns 0 where one multiplication cannot tell how to round, as a is too near to the
 * middle between two such numbers, and where a is too large or small for TEN. */
static uint64_t leading_digits(double a, int digits, int *tens) {
  int binary;
  frexp(a, &binary);
  *tens =
      (int)floor((binary - 1) * 0.30102999566398120); /* an estimate, which may be one too small */
  double scaled = 0;
  for (int again = 0; again < 2; again++) {
    int shift = digits - 1 - *tens;
    if (abs(shift) > LARGEST_POWER) return 0;
    scaled =
        shift < 0 ? a / TEN[-shift] : a * TEN[shift]; /* one rounding, as both factors are exact */
    if (scaled < TEN[digits]) break;
    ++*tens;
  }
  double whole = floor(scaled), rest = scaled - whole;
  if (fabs(rest - 0.5) < 1e-15 * TEN[digits]) return 0;
  uint64_t number = (uint64_t)whole + (rest > 0.5);
  if (number < (uint64_t)TEN[digits]) return number;
  ++*tens;
  return number / 10;
}

size_t vs_text_number(char text[VS_NUMBER_SIZE], double value, int digits) {
  int tens = 0, count = digits;
  uint64_t number = 0;
  if (isfinite(value) && value != 0 && digits > 0 && digits <= MOST_DIGITS)
    number = leading_digits(fabs(value), digits, &tens);
  if (!number && (value != 0 || signbit(value)))
    return (size_t)snprintf(text, VS_NUMBER_SIZE, "%.*g", digits, value);
  for (; count > 1 && number % 10 == 0; count--) number /= 10;
  char digit[MOST_DIGITS], *to = text;
  for (int k = count; k-- > 0; number /= 10) digit[k] = (char)('0' + number % 10);
  if (value < 0) *to++ = '-';
  bool fixed = tens >= -4 && tens < digits;
  int point = fixed ? tens : 0; /* the last digit before it */
  if (point < 0) {
    *to++ = '0';
    *to++ = '.';
    for (int k = -1; k > point; k--) *to++ = '0';
  }
  for (int k = 0; k < count || k <= point; k++) {
    *to++ = k < count ? digit[k] : '0';
    if (k == point && k + 1 < count) *to++ = '.';
  }
  if (!fixed) { /* the exponent has two digits, as leading_digits() goes no further */
    *to++ = 'e';
    *to++ = tens < 0 ? '-' : '+';
    *to++ = (char)('0' + abs(tens) / 10);
    *to++ = (char)('0' + abs(tens) % 10);
  }
  *to = '\0';
  return (size_t)(to - text);
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
