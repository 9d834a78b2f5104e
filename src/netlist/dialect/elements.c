/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dialect/elements.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "netlist/words.h"

/* What becomes of a parameter. */
typedef enum fate { RATING, HINT, R_SERIES, L_SERIES, R_PARALLEL, C_PARALLEL, R_SHUNT, NEVER } fate;
enum {
  PARTS = R_SHUNT + 1
}; /* as many fates as have a value to be kept, RATING and HINT included */

typedef struct parameter {
  const char *letters; /* of the elements that may have it */
  const char *name;
  fate fate;
  const char *instead; /* NEVER: what to write */
} parameter;

static const parameter PARAMETERS[] = {
    {"rclv", "mfg", RATING, NULL},
    {"rclv", "pn", RATING, NULL},
    {"rcl", "type", RATING, NULL},
    {"r", "tol", RATING, NULL},
    {"r", "pwr", RATING, NULL},
    {"c", "v", RATING, NULL},
    {"c", "irms", RATING, NULL},
    {"l", "ipk", RATING, NULL},
    {"b", "tripdv", HINT, NULL},
    {"b", "tripdt", HINT, NULL},
    {"clv", "rser", R_SERIES, NULL},
    {"c", "lser", L_SERIES, NULL},
    {"clb", "rpar", R_PARALLEL, NULL},
    {"clvb", "cpar", C_PARALLEL, NULL},
    {"c", "rlshunt", R_SHUNT, NULL},
    {"l", "flux", NEVER,
     "write it as a B source and a capacitor of 1 F, whose voltage is the flux"},
    {"l", "hc", NEVER,
     "ngspice has no such core; write L with a fixed inductance, or a part of it"},
    {"b", "laplace", NEVER, "write it with R, L and C"},
    {"b", "delay", NEVER, "a line delays: T1 a 0 b 0 z0=50 td=1u, with 50 ohm at its end"},
    {"eg", "laplace", NEVER, "write it with R, L and C"},
    {"vi", "wavefile", NEVER, "a deck reads no files; write pwl(...)"},
    {"vi", "file", NEVER, "a deck reads no files; 'import' writes their points, as pwl(...)"},
    {"vi", "time_scale_factor", NEVER, "write the points' times as they come out"},
    {"vi", "value_scale_factor", NEVER, "write the points' values as they come out"},
    {"vi", "trigger", NEVER, "write a course without it"},
    {"i", "tbl", NEVER, "write B1 a b I=pwl(v(a,b), ...)"},
};

static const char TOLD_RATINGS[] =
    "ratings and tolerances of an element (mfg, pn, type, tol, pwr, V, Irms, Ipk) are no part of "
    "the circuit and left out";
static const char TOLD_HINTS[] =
    "tripdv and tripdt say how LTspice cuts its steps, and are left out; run.tolerance is what "
    "holds here";
static const char TOLD_PARTS[] =
    "Rser, Lser, Rpar, Cpar and RLshunt, LTspice's, become elements of their own: in series behind "
    "the second node, in parallel from node to node";

static const char TOLD_NOUGHT[] =
    "Rser, Lser, Rpar, Cpar and RLshunt of 0 are read as no such part, as LTspice means them";

static char letter_of(const vs_rewriting *r) {
  return (char)tolower((unsigned char)*r->text.text);
}

/* The values that an element has of its parasitic parts; empty where it has none. */
typedef struct parts {
  char value[PARTS][64];
  bool any;
} parts;

/* LTspice writes a 0 where an element has no such part: 0 ohm in parallel would be a short. */
static bool is_zero(vs_word value) {
  char *end;
  return strtod(value.at, &end) == 0 && end > value.at && end == value.at + value.n;
}

/* Takes a parameter out of the line. */
static vs_status take_out(vs_rewriting *r, const parameter *p, parts *all) {
  vs_word whole, value;
  const char *text = r->text.text;
  if (!vs_words_parameter(text + strcspn(text, " \t"), p->name, &whole, &value)) return VS_OK;
  vs_where where = vs_rewriting_place(r, whole.at, whole.n);
  if (p->fate == NEVER) return vs_fail_at(r->err, where, "%s=, LTspice's: %s", p->name, p->instead);
  if (value.n == 0 || value.n >= sizeof all->value[0])
    return vs_fail_at(r->err, where, "%s= has no value, or one that is too long", p->name);
  if (p->fate <= HINT || !is_zero(value)) {
    snprintf(all->value[p->fate], sizeof all->value[0], "%.*s", (int)value.n, value.at);
    all->any = all->any || p->fate > HINT;
  } else
    vs_tally_add(r->tally, TOLD_NOUGHT, where);
  if (p->fate <= HINT) vs_tally_add(r->tally, p->fate == HINT ? TOLD_HINTS : TOLD_RATINGS, where);
  vs_rewriting_replace(r, (size_t)(whole.at - text), whole.n, "");
  return VS_OK;
}

/* Adds an element beside the line's own: KIND NAME__WHAT a b value. */
static void add_part(vs_rewriting *r, char kind, const char *what, const char *a, const char *b,
                     const char *value) {
  vs_text_add(&r->more, "%c%.*s__%s %s %s %s\n", kind, (int)strcspn(r->line->text, " \t"),
              r->line->text, what, a, b, value);
}

/* Writes the parasitic parts: element, Rser and Lser in a chain between the two nodes. */
static vs_status write_parts(vs_rewriting *r, const parts *all) {
  vs_word w[VS_WORDS_MOST], whole, value;
  const char *text = r->text.text;
  if (vs_words_split(text, w) < 4 || w[1].n >= 64 || w[2].n >= 64 || w[0].n >= 64)
    return vs_fail_at(r->err, r->line->where, "'NAME node node VALUE ...' is wanted here");
  if (vs_words_parameter(text, "m", &whole, &value))
    return vs_fail_at(r->err, vs_rewriting_place(r, whole.at, whole.n),
                      "m= together with Rser, Lser, Rpar or Cpar: write the %.*s elements one by "
                      "one",
                      (int)value.n, value.at);
  char a[64], b[64], from[80], to[80], name[64];
  snprintf(name, sizeof name, "%.*s", (int)w[0].n, w[0].at);
  snprintf(a, sizeof a, "%.*s", (int)w[1].n, w[1].at);
  snprintf(b, sizeof b, "%.*s", (int)w[2].n, w[2].at);
  bool rser = *all->value[R_SERIES], lser = *all->value[L_SERIES];
  snprintf(from, sizeof from, "%s__ser", name);
  snprintf(to, sizeof to, lser ? "%s__lser" : "%s", lser ? name : b);
  if (rser) add_part(r, 'R', "ser", from, to, all->value[R_SERIES]);
  if (lser) add_part(r, 'L', "lser", rser ? to : from, b, all->value[L_SERIES]);
  if (lser && *all->value[R_SHUNT])
    add_part(r, 'R', "lshunt", rser ? to : from, b, all->value[R_SHUNT]);
  if (*all->value[R_PARALLEL]) add_part(r, 'R', "par", a, b, all->value[R_PARALLEL]);
  if (*all->value[C_PARALLEL]) add_part(r, 'C', "par", a, b, all->value[C_PARALLEL]);
  if (rser || lser) vs_rewriting_replace(r, (size_t)(w[2].at - text), w[2].n, from);
  vs_rewriting_tell(r, TOLD_PARTS);
  return VS_OK;
}

static vs_status rewrite_parameters(vs_rewriting *r) {
  parts all = {0};
  vs_status status = VS_OK;
  if (!strchr(r->text.text, '=')) return VS_OK;
  for (size_t k = 0; k < sizeof PARAMETERS / sizeof *PARAMETERS && !status; k++)
    if (strchr(PARAMETERS[k].letters, letter_of(r))) status = take_out(r, &PARAMETERS[k], &all);
  return status || !all.any ? status : write_parts(r, &all);
}

/* D1 a b MODEL 2: ngspice 39 takes a number there for the model's name, but not area=2. */
static void rewrite_area(vs_rewriting *r) {
  vs_word w[VS_WORDS_MOST];
  size_t count = vs_words_split(r->text.text, w);
  if (r->pspice || count < 5 || memchr(w[4].at, '=', w[4].n) || !strchr(".0123456789{'", *w[4].at))
    return;
  vs_rewriting_replace(r, (size_t)(w[4].at - r->text.text), 0, "area=");
}

/* R1 a b 1 TC=0.001,0.002 of any passive: ngspice has tc1 and tc2, and tc= of a resistor alone. */
static void rewrite_temperature(vs_rewriting *r) {
  vs_word whole, value;
  if (!vs_words_parameter(r->text.text, "tc", &whole, &value)) return;
  const char *comma = memchr(value.at, ',', value.n);
  if (!comma && letter_of(r) == 'r') return;
  const char *second = comma ? comma + 1 + strspn(comma + 1, " \t") : NULL;
  size_t first = comma ? (size_t)(comma - value.at) : value.n;
  size_t n = comma ? strcspn(second, " \t") : 0;
  const char *end = comma ? second + n : value.at + value.n;
  char by[128];
  snprintf(by, sizeof by, comma ? "tc1=%.*s tc2=%.*s" : "tc1=%.*s", (int)first, value.at, (int)n,
           second);
  vs_rewriting_replace(r, (size_t)(whole.at - r->text.text), (size_t)(end - whole.at), by);
}

/* C1 a b Q=1n*x: LTspice's x is the capacitor's voltage, which ngspice calls v(a,b). */
static void rewrite_charge(vs_rewriting *r) {
  vs_word w[VS_WORDS_MOST], whole, value;
  vs_text voltage = {0};
  if (vs_words_split(r->text.text, w) < 4 ||
      !vs_words_parameter(w[2].at + w[2].n, "q", &whole, &value))
    return;
  const size_t from = (size_t)(value.at - r->text.text), name = (size_t)(whole.at - r->text.text);
  vs_text_add(&voltage, "v(%.*s,%.*s)", (int)w[1].n, w[1].at, (int)w[2].n, w[2].at);
  for (const char *x = value.at; (x = vs_words_find(r->text.text, x, "x", 1));) {
    const size_t at = (size_t)(x - r->text.text);
    vs_rewriting_replace(r, at, 1, voltage.text);
    x = r->text.text + at + voltage.length;
  }
  if (vs_words_parameter(r->text.text + name, "q", &whole, &value) && *value.at != '{') {
    vs_rewriting_replace(r, from + value.n, 0, "}");
    vs_rewriting_replace(r, from, 0, "{");
  }
  vs_text_free(&voltage);
}

/* Returns the '}' of a '{'; NULL: it has none. */
static const char *closing(const char *open) {
  int depth = 0;
  for (const char *s = open; *s; s++) {
    depth += (*s == '{') - (*s == '}');
    if (depth == 0) return s;
  }
  return NULL;
}

/* R1 a b 3.3*{x}: ngspice ends the value at its brace. The whole of it stands in braces then, and
 * the inner ones become brackets. */
static void rewrite_product(vs_rewriting *r) {
  static const char OPERATORS[] = "*/+-";
  vs_word w[VS_WORDS_MOST];
  for (size_t k = vs_words_split(r->text.text, w); k-- > 3;) {
    vs_words_split(r->text.text, w); /* the text may be another one than before */
    const char *equals = memchr(w[k].at, '=', w[k].n), *end = w[k].at + w[k].n;
    const char *at = equals ? equals + 1 : w[k].at, *open = memchr(at, '{', (size_t)(end - at));
    if (!open || memchr(at, '(', (size_t)(open - at))) continue; /* PULSE(0 {x} ...) */
    const char *close = closing(open);
    bool before = open > at && strchr(OPERATORS, open[-1]);
    bool behind = close && close + 1 < end && strchr(OPERATORS, close[1]);
    if (!close || close >= end || (!before && !behind)) continue;
    vs_text by = {0};
    vs_text_add(&by, "{");
    for (; at < end; at++) vs_text_add(&by, "%c", *at == '{' ? '(' : *at == '}' ? ')' : *at);
    vs_text_add(&by, "}");
    at = equals ? equals + 1 : w[k].at;
    vs_rewriting_replace(r, (size_t)(at - r->text.text), (size_t)(end - at), by.text);
    vs_text_free(&by);
  }
}

/* ---- tables ---- */

/* Adds ", x1, y1, ..." of points in any brackets. Braces around a single value make a formula. */
static void add_points(vs_text *text, const char *points) {
  static const char BETWEEN[] = "()[]<>{}, \t";
  for (const char *p = points; *(p += strspn(p, *p == '{' ? "" : "()[]<>}, \t"));) {
    const char *close = *p == '{' ? closing(p) : NULL;
    const bool formula = close && !memchr(p, ',', (size_t)(close - p));
    const size_t n = formula ? (size_t)(close - p) + 1 : strcspn(p, BETWEEN);
    if (formula) vs_text_add(text, ",(%.*s)", (int)n - 2, p + 1);
    if (!formula && n) vs_text_add(text, ",%.*s", (int)n, p);
    p += n ? n : 1;
  }
}

/* Writes "E1 p n TABLE {x} = (x1, y1) (x2, y2)", and LTspice's "E1 p n a b table=(x1, y1, ...)", as
 * "E1 p n VALUE={table(x, x1, y1, ...)}", which functions.c goes on with. ngspice's own TABLE
 * rounds each corner over a tenth of what is beside it. */
static vs_status rewrite_table(vs_rewriting *r) {
  vs_word w[VS_WORDS_MOST];
  const char *text = r->text.text, *end;
  size_t count = vs_words_split(text, w);
  bool controlled = count > 5 && !strncasecmp(w[5].at, "table", 5);
  size_t at = controlled ? 5 : 3;
  if (count <= at || strncasecmp(w[at].at, "table", 5) || vs_words_goes_on(w[at].at[5]))
    return VS_OK;
  const char *s = w[at].at + 5;
  s += strspn(s, " \t=");
  end = *s == '{' ? closing(s) : NULL;
  if (!controlled && !end)
    return vs_fail_at(r->err, vs_rewriting_place(r, w[at].at, 5),
                      "'TABLE {x} = (x1, y1) (x2, y2) ...' is wanted here");
  vs_text changed = {0};
  vs_text_add(&changed, "%.*s VALUE={table(", (int)(w[2].at + w[2].n - text), text);
  if (controlled) {
    vs_text_add(&changed, "v(%.*s,%.*s)", (int)w[3].n, w[3].at, (int)w[4].n, w[4].at);
    add_points(&changed, s);
  } else {
    vs_text_add(&changed, "%.*s", (int)(end - s - 1), s + 1);
    add_points(&changed, end + 1 + strspn(end + 1, " \t="));
  }
  vs_text_add(&changed, ")}");
  vs_text_free(&r->text);
  r->text = changed;
  return VS_OK;
}

/* E1 p n LAPLACE {x} = {...}, FREQ, CHEBYSHEV: ngspice 39 reads none of them. */
static vs_status check_transfer(const vs_rewriting *r) {
  static const char *const KINDS[] = {"laplace", "freq", "chebyshev"};
  vs_word w[VS_WORDS_MOST];
  size_t count = vs_words_split(r->text.text, w);
  for (size_t k = 0; count > 3 && k < sizeof KINDS / sizeof *KINDS; k++) {
    size_t n = strlen(KINDS[k]);
    if (!strncasecmp(w[3].at, KINDS[k], n) && !vs_words_goes_on(w[3].at[n]))
      return vs_fail_at(r->err, vs_rewriting_place(r, w[3].at, n),
                        "%s: ngspice has no such source; write the transfer function with R, L "
                        "and C, or as a code model s_xfer",
                        KINDS[k]);
  }
  return VS_OK;
}

/* ---- B sources ---- */

static vs_status check_b(const vs_rewriting *r) {
  vs_word whole, value;
  const char *text = r->text.text + strcspn(r->text.text, " \t");
  if ((vs_words_parameter(text, "v", &whole, &value) ||
       vs_words_parameter(text, "i", &whole, &value)) &&
      value.n)
    return VS_OK;
  bool resistance = vs_words_parameter(text, "r", &whole, &value);
  return vs_fail_at(r->err, r->line->where,
                    resistance ? "a B source gives V=... or I=...; R=..., LTspice's, is written "
                                 "R1 a b R={...}"
                               : "a B source wants V=... or I=... behind its two nodes");
}

/* ---- A devices ---- */

/* LTspice's A devices have eight nodes and the name of what they are; ngspice's are code models. */
static vs_status check_gate(const vs_rewriting *r) {
  static const char *const KINDS[] = {
      "srflop",    "and",      "or",           "xor",        "buf",        "inv",
      "schmitt",   "dflop",    "schmtbuf",     "schmtinv",   "phasedet",   "diffschmitt",
      "counter",   "varistor", "ota",          "diffbuf",    "samplehold", "modulate",
      "modulator", "dlatch",   "diffschmtbuf", "dffschmtinv"};
  vs_word w[VS_WORDS_MOST];
  size_t count = vs_words_split(r->text.text, w);
  for (size_t k = 0; count > 9 && k < sizeof KINDS / sizeof *KINDS; k++)
    if (vs_words_is(w[9], KINDS[k]))
      return vs_fail_at(
          r->err, vs_rewriting_place(r, w[9].at, w[9].n),
          "%s is a device of LTspice's own, which no other program has; write it with "
          "B sources and switches",
          KINDS[k]);
  return VS_OK;
}

/* ---- couplings ---- */

/* K1 L1 L2 L3 0.99, of LTspice and PSpice: a coupling of each two of them. */
static vs_status rewrite_coupling(vs_rewriting *r) {
  vs_word w[VS_WORDS_MOST];
  vs_text changed = {0};
  size_t count = vs_words_split(r->text.text, w), last = count - 1;
  if (count < 5) return VS_OK;
  for (size_t n = 1; n < last; n++)
    if (tolower((unsigned char)*w[n].at) != 'l')
      return vs_fail_at(r->err, vs_rewriting_place(r, w[n].at, w[n].n),
                        "inductors and a factor are wanted behind %.*s; a core's model ngspice has "
                        "not: write the inductances of the windings",
                        (int)w[0].n, w[0].at);
  for (size_t n = 1; n < last; n++)
    for (size_t m = n + 1; m < last; m++) {
      bool first = n == 1 && m == 2;
      vs_text *text = first ? &changed : &r->more;
      vs_text_add(text, "%.*s", (int)w[0].n, w[0].at);
      if (!first) vs_text_add(text, "__%zu_%zu", n, m);
      vs_text_add(text, " %.*s %.*s %.*s%s", (int)w[n].n, w[n].at, (int)w[m].n, w[m].at,
                  (int)w[last].n, w[last].at, first ? "" : "\n");
    }
  vs_text_free(&r->text);
  r->text = changed;
  vs_rewriting_tell(r, "K of several inductors is read as one of each two of them");
  return VS_OK;
}

/* ---- points that repeat ---- */

/* Where points between two brackets are those of a pulse, 0 V0 [T1 V0] T2 V1 T3 V1 T4 V0 T5 V0,
 * adds the `head` of the line and that as a PULSE, whose edges end ngspice's steps. Numbers may be
 * expressions; they are compared as texts. */
static bool add_as_pulse(const char *open, const char *close, int head, const char *text,
                         vs_text *out) {
  vs_text inner = {0};
  vs_word w[VS_WORDS_MOST];
  vs_text_add(&inner, "%.*s", (int)(close - open - 1), open + 1);
  for (char *s = inner.text; *s; s++)
    if (*s == ',') *s = ' ';
  size_t count = vs_words_split(inner.text, w), n = count == 12 ? 2 : 0;
  const vs_word *low = w + 1, *t = w + n, *high = t + 3;
  bool is = count == 10 || count == 12;
  for (size_t k = 1; k < count && is; k += 2) {
    const vs_word *like = k == n + 3 || k == n + 5 ? high : low;
    is = w[k].n == like->n && !strncasecmp(w[k].at, like->at, like->n);
  }
  if (is)
    vs_text_add(out,
                "%.*sPULSE(%.*s %.*s %.*s {(%.*s)-(%.*s)} {(%.*s)-(%.*s)} {(%.*s)-(%.*s)} %.*s)",
                head, text, (int)low->n, low->at, (int)high->n, high->at, (int)t->n, t->at,
                (int)t[2].n, t[2].at, (int)t->n, t->at, (int)t[6].n, t[6].at, (int)t[4].n, t[4].at,
                (int)t[4].n, t[4].at, (int)t[2].n, t[2].at, (int)t[8].n, t[8].at);
  vs_text_free(&inner);
  return is;
}

/* PWL REPEAT FOREVER (0 0 1u 1 ...) ENDREPEAT, of LTspice and PSpice, is PWL(0 0 1u 1 ...) r=0 in
 * ngspice. */
static vs_status rewrite_points(vs_rewriting *r) {
  const char *text = r->text.text, *pwl = strcasestr(text, "pwl");
  if (!pwl || pwl == text || !strchr(" \t", pwl[-1]) || vs_words_goes_on(pwl[3])) return VS_OK;
  const char *s = pwl + 3 + strspn(pwl + 3, " \t"), *open = strchr(s, '(');
  const char *close = open ? strchr(open, ')') : NULL;
  bool repeats = !strncasecmp(s, "repeat", 6);
  if (!repeats) return VS_OK;
  vs_word w[VS_WORDS_MOST];
  size_t count = vs_words_split(s, w);
  bool forever = count > 2 && vs_words_is(w[1], "forever") && open && close &&
                 !memchr(open + 1, '(', (size_t)(close - open - 1)) && strtod(open + 1, NULL) == 0;
  if (!forever)
    return vs_fail_at(
        r->err, vs_rewriting_place(r, s, 6),
        "of PWL's REPEAT only 'REPEAT FOREVER (0 V0 T1 V1 ...) ENDREPEAT' can be said "
        "in ngspice, as 'PWL(0 V0 T1 V1 ...) r=0'; write all points, or a PULSE");
  vs_text changed = {0};
  bool edges = add_as_pulse(open, close, (int)(pwl - text), text, &changed);
  if (!edges)
    vs_text_add(&changed, "%.*s%.*s r=0", (int)(pwl + 3 - text), text, (int)(close + 1 - open),
                open);
  vs_text_free(&r->text);
  r->text = changed;
  vs_rewriting_tell(r, edges ? "PWL REPEAT FOREVER (...), LTspice's and PSpice's, is read as PULSE"
                             : "PWL REPEAT FOREVER (...), LTspice's and PSpice's, is read as "
                               "PWL(...) r=0; ngspice may step over edges that are repeated: a "
                               "fifth of the shortest as run.max_step prevents it");
  return VS_OK;
}

vs_status vs_elements_rewrite(vs_rewriting *r) {
  char letter = letter_of(r);
  vs_status status = VS_OK;
  if (!isalpha((unsigned char)letter)) return VS_OK;
  if (letter == 'b') status = check_b(r);
  if (letter == 'd') rewrite_area(r);
  if (letter == 'a') status = check_gate(r);
  if (strchr("rcl", letter)) rewrite_temperature(r);
  if (strchr("rclvix", letter)) rewrite_product(r);
  if (letter == 'k') status = rewrite_coupling(r);
  if (letter == 'v' || letter == 'i') status = rewrite_points(r);
  if (letter == 'e' || letter == 'g') status = check_transfer(r);
  if (!status && (letter == 'e' || letter == 'g')) status = rewrite_table(r);
  if (!status) status = rewrite_parameters(r);
  if (!status && letter == 'c') rewrite_charge(r); /* of the nodes that it has then */
  return status;
}
