/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/units.h"

#include <ctype.h>
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef struct unit {
  double factor; /* its SI value is factor * 10^tens */
  int tens, power[VS_UNIT_POWERS];
} unit;

/* Powers stand in the order of VS_UNIT_KG and so on. SI definitions (BIPM SI Brochure, 9th ed.,
 * tables 2, 4 and 8). The angle has a dimension of its own here, so that a number of degrees cannot
 * pass for a pure number. */
static const struct named {
  const char *name;
  unit unit;
  bool prefixed;
} UNITS[] = {
    {"m", {1, 0, {0, 1}}, true},
    {"g", {1, -3, {1}}, true},
    {"s", {1, 0, {0, 0, 1}}, true},
    {"A", {1, 0, {0, 0, 0, 1}}, true},
    {"V", {1, 0, {1, 2, -3, -1}}, true},
    {"W", {1, 0, {1, 2, -3}}, true},
    {"J", {1, 0, {1, 2, -2}}, true},
    {"N", {1, 0, {1, 1, -2}}, true},
    {"Hz", {1, 0, {0, 0, -1}}, true},
    {"ohm", {1, 0, {1, 2, -3, -2}}, true},
    {"Ohm", {1, 0, {1, 2, -3, -2}}, true},
    {"Ω", {1, 0, {1, 2, -3, -2}}, true},
    {"H", {1, 0, {1, 2, -2, -2}}, true},
    {"F", {1, 0, {-1, -2, 4, 2}}, true},
    {"Wb", {1, 0, {1, 2, -2, -1}}, true},
    {"T", {1, 0, {1, 0, -2, -1}}, true},
    {"rad", {1, 0, {0, 0, 0, 0, 1}}, true},
    {"deg", {3.14159265358979323846 / 180, 0, {0, 0, 0, 0, 1}}, false},
    {"°", {3.14159265358979323846 / 180, 0, {0, 0, 0, 0, 1}}, false},
    {"K", {1, 0, {0, 0, 0, 0, 0, 1}}, true},
    {"degC", {1, 0, {0, 0, 0, 0, 0, 0, 0, 1}}, false},
    {"sqrt_s", {1, 0, {[VS_UNIT_ROOT_S] = 1}}, false},
    {"√s", {1, 0, {[VS_UNIT_ROOT_S] = 1}}, false},
    {"%", {1, -2, {0}}, false},
    {"min", {60, 0, {0, 0, 1}}, false},
    {"cycle", {1, 0, {0, 0, 0, 0, 0, 0, 1}}, false},
    {"cycles", {1, 0, {0, 0, 0, 0, 0, 0, 1}}, false},
    {"1", {1, 0, {0}}, false},
};
static const struct {
  const char *text;
  int tens;
} PREFIXES[] = {{"", 0},   {"f", -15}, {"p", -12}, {"n", -9}, {"u", -6}, {"µ", -6},
                {"m", -3}, {"c", -2},  {"k", 3},   {"M", 6},  {"G", 9}};

/* Finds the unit by its name; with `lower` a capital of the name may be written small. */
static bool same_name(const char *text, const char *name, size_t length, bool lower) {
  for (size_t k = 0; k < length; k++)
    if (text[k] != name[k] && !(lower && text[k] == tolower((unsigned char)name[k]))) return false;
  return true;
}

static bool named_unit(const char *name, size_t length, bool lower, unit *out) {
  for (size_t k = 0; k < sizeof UNITS / sizeof *UNITS; k++) {
    size_t nu = strlen(UNITS[k].name),
           np = length - nu; /* how many bytes stand before the unit's name, as its prefix */
    if (nu > length || (np && !UNITS[k].prefixed)) continue;
    if (!same_name(name + np, UNITS[k].name, nu, lower)) continue;
    for (size_t p = 0; p < sizeof PREFIXES / sizeof *PREFIXES; p++) {
      if (strlen(PREFIXES[p].text) != np || strncmp(name, PREFIXES[p].text, np)) continue;
      *out = UNITS[k].unit;
      out->tens += PREFIXES[p].tens;
      return true;
    }
  }
  return false;
}

/* Reads a product of NAME[^][-]POWER terms with '.' or '*' between them; terms behind a '/' count
 * inversely. */
static bool parse_any_unit(const char *text, bool lower, unit *out) {
  *out = (unit){.factor = 1};
  int sign = 1;
  const char *s = text;
  while (*s == ' ') s++;
  if (!*s) return true;
  for (;;) {
    const char *start = s;
    if (*s == '1' && !isdigit((unsigned char)s[1])) s++; /* as in 1/s */
    while (*s && !strchr(".*/^ ", *s) && !isdigit((unsigned char)*s) && *s != '-') s++;
    unit u;
    size_t length = (size_t)(s - start);
    if (!length ||
        (!named_unit(start, length, false, &u) && !(lower && named_unit(start, length, true, &u))))
      return false;
    long power = 1;
    bool raised = *s == '^';
    s += raised;
    if (raised || isdigit((unsigned char)*s) || *s == '-') {
      char *end;
      power = strtol(s, &end, 10);
      if (end == s || power < -9 || power > 9) return false;
      s = end;
    }
    for (int d = 0; d < VS_UNIT_POWERS; d++) out->power[d] += sign * (int)power * u.power[d];
    out->factor *= pow(u.factor, (double)(sign * power));
    out->tens += sign * (int)power * u.tens;
    while (*s == ' ') s++;
    if (!*s) return true;
    if (*s == '/') {
      if (sign < 0) return false;
      sign = -1;
    } else if (*s != '.' && *s != '*')
      return false;
    s++;
    while (*s == ' ') s++;
  }
}

static bool parse_unit(const char *text, unit *out) {
  return parse_any_unit(text, false, out);
}

/* Powers of ten up to 22 are exact doubles, so that value in `u` rounds once: "6 mm" is 0.006. */
static double to_si(double value, const unit *u) {
  value *= u->factor;
  return u->tens < 0 ? value / pow(10, -u->tens) : value * pow(10, u->tens);
}

bool vs_units_known(const char *text) {
  unit u;
  return parse_unit(text, &u);
}

bool vs_units_same_kind(const char *text, const char *other) {
  unit a, b;
  return parse_unit(text, &a) && parse_unit(other, &b) && !memcmp(a.power, b.power, sizeof a.power);
}

bool vs_units_powers(const char *text, int power[VS_UNIT_POWERS]) {
  unit u;
  if (!parse_unit(text, &u)) return false;
  memcpy(power, u.power, sizeof u.power);
  return true;
}

double vs_units_factor(const char *text) {
  unit u;
  return parse_unit(text, &u) ? to_si(1, &u) : NAN;
}

/* Writes which unit is wanted: "mm"; where the unit has a prefix, also the unit without it, so that
 * nobody who left a unit out takes a factor of a thousand with the example: "ohm or kohm".
 * `number` stands before each, with a blank, in quotes; "" for none. */
static void wanted_units(const char *expected, const char *number, char *text, size_t size) {
  unit plain, with;
  const char *quote = *number ? "'" : "", *blank = *number ? " " : "";
  bool prefixed =
      parse_unit(expected, &with) && *expected && expected[1] && parse_unit(expected + 1, &plain) &&
      !memcmp(plain.power, with.power, sizeof plain.power) && to_si(1, &plain) != to_si(1, &with);
  size_t n = 0;
  if (prefixed)
    n = (size_t)snprintf(text, size, "%s%s%s%s%s or ", quote, number, blank, expected + 1, quote);
  snprintf(text + n, size - n, "%s%s%s%s%s", quote, number, blank, expected, quote);
}

/* Writes the units of that kind which `text` would be but for capitals: "ms or Ms" for MS. Returns
 * false where there is none. */
static bool other_case(const char *text, const unit *want, char *out, size_t size) {
  char name[16];
  size_t n = 0;
  for (size_t k = 0; k < sizeof UNITS / sizeof *UNITS; k++)
    for (size_t p = 0; p < sizeof PREFIXES / sizeof *PREFIXES && n < size; p++) {
      snprintf(name, sizeof name, "%s%s", PREFIXES[p].text, UNITS[k].name);
      if ((*PREFIXES[p].text && !UNITS[k].prefixed) || strcasecmp(name, text) != 0 ||
          memcmp(UNITS[k].unit.power, want->power, sizeof want->power) != 0)
        continue;
      n += (size_t)snprintf(out + n, size - n, "%s%s", n ? " or " : "", name);
    }
  return n;
}

/* A number that a double cannot hold, or not in SI. */
static bool refuse_size(const char *text, double value, char *why, size_t size) {
  snprintf(why, size,
           isfinite(value) ? "'%s' is too small a number; write 0, or one above 1e-300"
                           : "'%s' is not a finite number; write one below 1e300",
           text);
  return false;
}

/* ---- values as they stand in circuit diagrams ---- */

/* The name without a prefix of a unit that values of circuits have, as "F" of "nF"; NULL: it is of
 * another kind, of which a letter behind a number could be mistaken. */
static const char *circuit_unit(const char *expected) {
  static const char *const NAMES[] = {"ohm", "F", "H", "V", "A", "W", "J", "s", "Hz", "Wb"};
  unit want, base;
  if (!parse_unit(expected, &want) || want.factor == 0) return NULL;
  for (size_t k = 0; k < sizeof NAMES / sizeof *NAMES; k++)
    if (parse_unit(NAMES[k], &base) && !memcmp(base.power, want.power, sizeof base.power))
      return NAMES[k];
  return NULL;
}

/* Rewrites 47n as "47 nF", 4k7 as "4.7 kohm", 330R as "330 ohm" and 1meg as "1 Mohm", where a unit
 * of that kind is expected; `end` is what stands behind the number. Returns false, with *why empty,
 * where it is nothing of the kind; and with *why where it ends in m or M: that may be milli or
 * mega, and SPICE reads both as milli. */
static bool rewrite(const char *text, const char *end, const char *expected, char out[128],
                    char *why, size_t size) {
  static const char *const PREFIX[] = {"p", "n", "u", "µ", "k"};
  const char *base = circuit_unit(expected), *prefix = NULL, *behind = end + 1;
  const int digits = (int)(end - text);
  *why = '\0';
  if (!base || digits > 40) return false;
  if (!strcmp(end, "m") || !strcmp(end, "M")) {
    snprintf(why, size,
             "'%s' may be milli or mega, and SPICE reads both as milli; write '%.*s m%s' "
             "or '%.*s M%s'",
             text, digits, text, base, digits, text, base);
    return false;
  }
  for (size_t k = 0; k < sizeof PREFIX / sizeof *PREFIX && !prefix; k++)
    if (!strncmp(end, PREFIX[k], strlen(PREFIX[k])))
      prefix = PREFIX[k], behind = end + strlen(prefix);
  if (*end == 'R' && !strcmp(base, "ohm")) prefix = "";
  if (!strcasecmp(end, "meg")) prefix = "M", behind = end + 3;
  if (!prefix) return false;
  const size_t more = strspn(behind, "0123456789");
  const bool between = more && strspn(text, "+-0123456789") == (size_t)digits;
  if (behind[more] || (more && !between) || more > 20) return false;
  snprintf(out, 128, "%.*s%s%s %s%s", digits, text, more ? "." : "", behind, prefix, base);
  return true;
}

bool vs_units_read(const char *text, const char *expected, double *si, char *why, size_t size) {
  char *end;
  errno = 0;
  double value = vs_text_to_number(text, &end);
  const char *as = *expected ? expected : "a plain number";
  char wanted[160];
  if (end == text) {
    snprintf(why, size, "'%s' is not a number; write %s%s", text,
             *expected ? "a number with its unit, in " : "", as);
    return false;
  }
  if (!isfinite(value)) return refuse_size(text, strtod(text, NULL), why, size);
  unit want, got;
  while (*end == ' ') end++;
  parse_unit(expected, &want);
  if (*end == ',' && isdigit((unsigned char)end[1])) {
    snprintf(why, size, "'%s': the decimal sign is a point; write '%.*s.%s'", text,
             (int)(end - text), text, end + 1);
    return false;
  }
  const bool known = parse_unit(end, &got);
  if (*end && (!known || memcmp(want.power, got.power, sizeof want.power))) {
    char written[128];
    if (rewrite(text, end, expected, written, why, size))
      return vs_units_read(written, expected, si, why, size);
    if (*why) return false;
  }
  if (!known) {
    const bool capitals = other_case(end, &want, wanted, sizeof wanted);
    if (!capitals) wanted_units(expected, "", wanted, sizeof wanted);
    snprintf(why, size, "'%s' is no unit known here; write %s%s", end, *expected ? wanted : as,
             capitals ? ": capitals count" : "");
    return false;
  }
  if (!*end && *expected && value != 0) {
    wanted_units(expected, text, wanted, sizeof wanted);
    snprintf(why, size, "%s has no unit; write for example %s", text, wanted);
    return false;
  }
  if (*end && memcmp(want.power, got.power, sizeof want.power)) {
    snprintf(why, size, "'%s' has the wrong unit; write %s", text, as);
    return false;
  }
  *si = to_si(value, &got);
  return (isfinite(*si) && (value == 0 || fabs(*si) >= DBL_MIN)) ||
         refuse_size(text, *si, why, size);
}

double vs_units_suffix_factor(const char *suffix, const char *expected) {
  char text[64];
  unit want, got;
  size_t length = strlen(suffix);
  if (!length || length >= sizeof text || !parse_unit(expected, &want)) return NAN;
  /* any one of the signs that became '_' may have been the '/', the others were products */
  for (size_t slash = 0; slash <= length; slash++) {
    if (slash < length && suffix[slash] != '_') continue;
    for (size_t k = 0; k <= length; k++)
      text[k] = (char)(suffix[k] != '_' ? suffix[k] : k == slash ? '/' : '.');
    if (parse_any_unit(text, true, &got) && !memcmp(want.power, got.power, sizeof want.power))
      return to_si(1, &got);
  }
  return NAN;
}

void vs_units_suffix(const char *of, char *suffix, size_t size) {
  size_t n = 0;
  for (; *of && n + 1 < size; of++)
    suffix[n++] = isalnum((unsigned char)*of) ? (char)tolower((unsigned char)*of) : '_';
  suffix[n] = '\0';
}

/* ---- patterns ---- */

static bool same_powers(const unit *a, const unit *b) {
  return !memcmp(a->power, b->power, sizeof a->power);
}

/* Adds "([fpn...]?V|...)": every name of the same kind as UNITS[k], raised to the power. */
static void add_names(size_t k, int power, vs_text *pattern) {
  vs_text_add(pattern, "(");
  bool first = true;
  for (size_t n = 0; n < sizeof UNITS / sizeof *UNITS; n++) {
    if (!same_powers(&UNITS[n].unit, &UNITS[k].unit)) continue;
    vs_text_add(pattern, "%s%s%s", first ? "" : "|", UNITS[n].prefixed ? "[fpnuµmckMG]?" : "",
                UNITS[n].name);
    first = false;
  }
  vs_text_add(pattern, ")");
  if (power != 1) vs_text_add(pattern, "\\^?%d", power);
}

/* True if UNITS[k] is the first of its kind, and of a kind that is no pure number. */
static bool leads(size_t k) {
  const unit pure = {.factor = 1};
  for (size_t n = 0; n < k; n++)
    if (same_powers(&UNITS[n].unit, &UNITS[k].unit)) return false;
  return !same_powers(&UNITS[k].unit, &pure);
}

static bool is_product(const unit *want, size_t a, int pa, size_t b, int pb) {
  for (int d = 0; d < VS_UNIT_POWERS; d++)
    if (want->power[d] != pa * UNITS[a].unit.power[d] + pb * UNITS[b].unit.power[d]) return false;
  return true;
}

/* Adds every product and quotient of powers of two units that is of the kind wanted. */
static void add_pairs(const unit *want, vs_text *pattern) {
  enum { N = sizeof UNITS / sizeof *UNITS, MOST = 3 };
  for (size_t a = 0; a < N; a++)
    for (size_t b = 0; b < N && leads(a); b++)
      for (int p = 1; p <= MOST && leads(b); p++)
        for (int q = -MOST; q <= MOST; q++) {
          if (!q || (a == b && q < 0) || !is_product(want, a, p, b, q)) continue;
          vs_text_add(pattern, "|");
          add_names(a, p, pattern);
          vs_text_add(pattern, q < 0 ? "/" : "[.*]");
          add_names(b, q < 0 ? -q : q, pattern);
        }
}

/* Adds every power of one unit that is of the kind wanted; those below 0 also as quotients, "1/s2"
 * beside "s^-2". */
static void add_powers(const unit *want, vs_text *pattern) {
  const char *between = "";
  for (size_t k = 0; k < sizeof UNITS / sizeof *UNITS; k++)
    for (int p = -3; p <= 3 && leads(k); p++) {
      if (!p || !is_product(want, k, p, k, 0)) continue;
      vs_text_add(pattern, "%s", between);
      add_names(k, p, pattern);
      between = "|";
      if (p > 0) continue;
      vs_text_add(pattern, "|1/");
      add_names(k, -p, pattern);
    }
  if (!*between) vs_text_add(pattern, "(?!)"); /* nothing: what follows begins with '|' */
}

/* Adds the unit as it is written, each of its names replaced by all of its kind. */
static void add_as_written(const char *text, vs_text *pattern) {
  for (const char *s = text; *s;) {
    size_t n = strcspn(s, ".*/^0123456789-"), k = 0;
    unit u;
    if (n && named_unit(s, n, false, &u)) {
      while (!same_powers(&UNITS[k].unit, &u)) k++;
      add_names(k, 1, pattern);
    } else if (n)
      vs_text_add(pattern, "%.*s", (int)n, s);
    else if (strchr(".*", *s))
      vs_text_add(pattern, "[.*]");
    else
      vs_text_add(pattern, "%c", *s);
    s += n ? n : 1;
  }
}

void vs_units_pattern(const char *expected, vs_text *pattern) {
  unit want;
  vs_text_add(pattern, "^ *[+-]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][+-]?[0-9]+)? *");
  if (!*expected || !parse_unit(expected, &want)) {
    vs_text_add(pattern, "(%%|1)? *$");
    return;
  }
  vs_text_add(pattern, "(");
  add_powers(&want, pattern);
  add_pairs(&want, pattern);
  vs_text_add(pattern, "|");
  add_as_written(expected, pattern);
  vs_text_add(pattern, ") *$");
}
