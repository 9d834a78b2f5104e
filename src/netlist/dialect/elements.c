/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dialect/elements.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "netlist/numbers.h"
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
  vs_where where = vs_rewriting_place(r, whole.at, (size_t)(value.at - whole.at));
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
    vs_rewriting_brace(r, (size_t)(at - r->text.text), (size_t)(end - at));
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

/* LTspice's A devices have five inputs, the outputs /Q and Q, a common node, and the name of their
 * kind (LTspice's help, "A. Special Functions"; of SRFLOP and SCHMITT also public models that use
 * them). An input or output at the common node is not there. NAME becomes nodes of its own:
 *
 * m: a capacitor that is charged to 1 or to 0 within 1 ns, or held. What brings it from between to
 *    0 or 1 is slow beside a step, so that no iteration of ngspice's can change what it remembers.
 * y: 0 or 1 by m; with Trise, Tfall or Tau behind an RC, which takes half of Trise to the middle.
 * d: y after Td, at the end of a line. x: d, but before Td what y was at first, h. A line draws a
 *    parabola through three steps: one that is longer than Td goes on beyond them, from 0 1 1 to 0.
 *    So y's charge shortens steps here, behind an RC of Td/1000 where there is no other.
 *
 * Q is Vlow + (Vhigh - Vlow) x behind Rlow or Rhigh; without Td it is y's. LTspice begins at the
 * operating point: so s is 1 up to 1 ns, in which m, y and h become what the inputs say, within
 * some ps. A flip-flop begins at IC instead.
 *
 * LTspice's gates do not shorten its steps, and without Td these do not either: m, y and h stand on
 * b, -1 kV, so that their charge is large beside its changes. Else ngspice would look for the
 * instant of an edge without a rise until its step is too small. */
enum { GATE_INPUTS = 5, NOT_Q, GATE_Q, COMMON, GATE_KIND };
enum { VHIGH, VLOW, REF, TRISE, TFALL, TAU, TD, ROUT, RHIGH, RLOW, COUT, VT, VH, IC, GATE_VALUES };

static const struct gate_value {
  const char *name, *usual; /* NULL: it follows others */
} VALUES[GATE_VALUES] = {{"vhigh", "1"},  {"vlow", "0"},  {"ref", NULL},  {"trise", NULL},
                         {"tfall", NULL}, {"tau", NULL},  {"td", NULL},   {"rout", "1"},
                         {"rhigh", NULL}, {"rlow", NULL}, {"cout", NULL}, {"vt", "0.5"},
                         {"vh", "0.1"},   {"ic", "0"}};

typedef struct gate gate;

typedef struct gate_kind {
  const char *name;
  int inputs;
  bool holds; /* it begins at IC, not at what its inputs say */
  void (*sets)(const gate *g, vs_text *out);
  void (*resets)(const gate *g, vs_text *out); /* NULL: what does not set it */
} gate_kind;

struct gate {
  vs_rewriting *r;
  const gate_kind *kind;
  char name[64];                /* of its nodes and elements */
  char node[COMMON + 1][64];    /* from 1; of inputs and outputs empty: not there */
  char value[GATE_VALUES][100]; /* in brackets; empty: not given, and no usual one */
};

/* Adds the side of the threshold on which an input is, from -1 to 1 within some 1e-5 of the levels'
 * difference, as LTspice's has no width; -1 where it is not there. */
static void add_side(const gate *g, int input, vs_text *out) {
  const char *high = g->value[VHIGH], *low = g->value[VLOW], *ref = g->value[REF];
  if (!*g->node[input])
    vs_text_add(out, "(-1)");
  else
    vs_text_add(out, "tanh((v(%s,%s)-({%s%s%s%s%s}))/({max(1e-5*abs(%s-%s),1e-6)}))",
                g->node[input], g->node[COMMON], *ref ? ref : "0.5*(", *ref ? "" : high,
                *ref ? "" : "+", *ref ? "" : low, *ref ? "" : ")", high, low);
}

/* Adds 1 where an input is above the threshold, 0 where it is below. */
static void add_high(const gate *g, int input, vs_text *out) {
  vs_text_add(out, "(0.5+0.5*");
  add_side(g, input, out);
  vs_text_add(out, ")");
}

/* The same, and no more than 0 below the threshold: a flip-flop adds up what it gets. */
static void add_only_above(const gate *g, int input, vs_text *out) {
  vs_text_add(out, "max(0,");
  add_side(g, input, out);
  vs_text_add(out, ")");
}

static void add_and(const gate *g, vs_text *out) {
  vs_text_add(out, "1");
  for (int k = 1; k <= GATE_INPUTS; k++) {
    if (!*g->node[k]) continue;
    vs_text_add(out, "*");
    add_high(g, k, out);
  }
}

/* The product of what is low, but for one input; 0: for none. */
static void add_low(const gate *g, int but, vs_text *out) {
  for (int k = 1; k <= GATE_INPUTS; k++) {
    if (!*g->node[k] || k == but) continue;
    vs_text_add(out, "*(1-");
    add_high(g, k, out);
    vs_text_add(out, ")");
  }
}

static void add_or(const gate *g, vs_text *out) {
  vs_text_add(out, "1-1");
  add_low(g, 0, out);
}

/* One of them and no other, as LTspice's XOR of more than two. */
static void add_xor(const gate *g, vs_text *out) {
  vs_text_add(out, "0");
  for (int one = 1; one <= GATE_INPUTS; one++) {
    if (!*g->node[one]) continue;
    vs_text_add(out, "+");
    add_high(g, one, out);
    add_low(g, one, out);
  }
}

/* The first input less the second one is above Vt + Vh, or below Vt - Vh. */
static void add_beyond(const gate *g, int sign, vs_text *out) {
  const char *a = *g->node[1] ? g->node[1] : g->node[COMMON],
             *b = *g->node[2] ? g->node[2] : g->node[COMMON];
  vs_text_add(out, "0.5%c0.5*tanh((v(%s,%s)-({%s%c%s}))/({max(1e-4*%s,1e-6)}))", sign, a, b,
              g->value[VT], sign, g->value[VH], g->value[VH]);
}

static void add_above(const gate *g, vs_text *out) {
  add_beyond(g, '+', out);
}

static void add_below(const gate *g, vs_text *out) {
  add_beyond(g, '-', out);
}

/* The reset wins. */
static void add_set(const gate *g, vs_text *out) {
  add_only_above(g, 1, out);
  vs_text_add(out, "*(1-");
  add_high(g, 2, out);
  vs_text_add(out, ")");
}

static void add_reset(const gate *g, vs_text *out) {
  add_only_above(g, 2, out);
}

static const gate_kind GATES[] = {
    {"buf", 1, false, add_and, NULL},           {"inv", 1, false, add_and, NULL},
    {"and", GATE_INPUTS, false, add_and, NULL}, {"or", GATE_INPUTS, false, add_or, NULL},
    {"xor", GATE_INPUTS, false, add_xor, NULL}, {"schmitt", 2, false, add_above, add_below},
    {"srflop", 2, true, add_set, add_reset}};

static const char TOLD_GATES[] =
    "an A device of LTspice's becomes B sources of its law, levels and delay; edges are "
    "exponential, and where a flip-flop is set and reset at once the reset wins (assumed)";

/* Error: what is connected that the kind has not. */
static vs_status read_nodes(gate *g, const vs_word *w) {
  const int inputs = g->kind->inputs;
  bool inverts = !strcmp(g->kind->name, "inv");
  for (int k = 1; k <= COMMON; k++) {
    if (w[k].n >= sizeof g->node[k])
      return vs_fail_at(g->r->err, vs_rewriting_place(g->r, w[k].at, w[k].n),
                        "a node's name is too long here; at most 63 letters");
    if (memchr(w[k].at, '(', w[k].n) || memchr(w[k].at, ')', w[k].n))
      return vs_fail_at(g->r->err, vs_rewriting_place(g->r, w[k].at, w[k].n),
                        "%.*s: a node with brackets in its name cannot stand in the formula that "
                        "this becomes; give the net a name without them",
                        (int)w[k].n, w[k].at);
    bool none = k < COMMON && (!vs_words_compare(w[k], w[COMMON]) ||
                               (vs_words_is_ground(w[k]) && vs_words_is_ground(w[COMMON])));
    snprintf(g->node[k], sizeof g->node[k], "%.*s", none ? 0 : (int)w[k].n, w[k].at);
    bool is = k <= inputs || k == NOT_Q || (k == GATE_Q && !inverts) || k == COMMON;
    if (!is && !none)
      return vs_fail_at(g->r->err, vs_rewriting_place(g->r, w[k].at, w[k].n),
                        "%s: node %d is none of its pins, which are inputs up to %d, /Q at 6%s and "
                        "the common at 8; what is not connected stands at the common, %.*s",
                        g->kind->name, k, inputs, inverts ? "" : ", Q at 7", (int)w[COMMON].n,
                        w[COMMON].at);
  }
  for (int k = 1; k <= inputs; k++)
    if (*g->node[k]) return VS_OK;
  return vs_fail_at(
      g->r->err, vs_rewriting_place(g->r, w[1].at, w[1].n),
      "%s: all of its inputs stand at the common, %.*s, which means that they are not "
      "there; connect one",
      g->kind->name, (int)w[COMMON].n, w[COMMON].at);
}

/* Error: a number that makes no sense; what is a formula is not looked at. */
static vs_status check_value(const gate *g, int k, vs_word value, vs_word whole) {
  const bool is_ohm = k == ROUT || k == RHIGH || k == RLOW;
  double x = 1;
  if (k == VHIGH || k == VLOW || k == REF || k == VT || k == IC || !vs_numbers_read(value, &x) ||
      x > 0 || (x == 0 && !is_ohm))
    return VS_OK;
  return vs_fail_at(g->r->err, vs_rewriting_place(g->r, whole.at, whole.n), "%.*s: %s is wanted%s",
                    (int)whole.n, whole.at, is_ohm ? "more than 0" : "0 or more",
                    is_ohm ? "; 1m is as good as none" : "");
}

/* Error: a parameter that is not known here, or its number makes no sense. */
static vs_status read_values(gate *g, vs_word kind) {
  const char *behind = kind.at + kind.n;
  char *left = vs_copy(behind);
  vs_status status = VS_OK;
  for (int k = 0; k < GATE_VALUES && !status; k++) {
    vs_word whole, value;
    double x;
    const char *usual = VALUES[k].usual;
    if (usual) snprintf(g->value[k], sizeof g->value[k], "(%s)", usual);
    if ((k == IC && !g->kind->holds) || !vs_words_parameter(left, VALUES[k].name, &whole, &value))
      continue;
    const bool braces = value.n > 1 && strchr("{'", *value.at);
    if (value.n <= 2 * (size_t)braces || value.n + 2 > sizeof g->value[k])
      continue; /* told below */
    snprintf(g->value[k], sizeof g->value[k], "(%.*s)", (int)value.n - 2 * braces,
             value.at + braces);
    const bool zero = vs_numbers_read(value, &x) && x == 0;
    if ((k == TRISE || k == TFALL || k == TAU || k == TD) && zero) *g->value[k] = '\0';
    status = check_value(g, k, value, (vs_word){behind + (whole.at - left), whole.n});
    memset(left + (whole.at - left), ' ', whole.n);
  }
  const char *unknown = behind + strspn(left, " \t,");
  free(left);
  if (status) return status;
  size_t n = strcspn(unknown, " \t=");
  return !*unknown
             ? VS_OK
             : vs_fail_at(g->r->err, vs_rewriting_place(g->r, unknown, n),
                          "%.*s: no parameter of %s that is known here, or given twice, or it has "
                          "no value, or one that is too long; known are Vhigh=, Vlow=, "
                          "Ref=, Trise=, Tfall=, Tau=, Td=, Rout=, Rhigh=, Rlow=, Cout=, Vt= and "
                          "Vh= of SCHMITT, IC= of SRFLOP",
                          (int)n, unknown, g->kind->name);
}

/* Adds m: it is set, reset, and else held. */
static void write_memory(const gate *g, vs_text *out) {
  const char *n = g->name;
  const gate_kind *kind = g->kind;
  /* No two gates are equal, else neither of two that hold each other would win. */
  vs_text_add(out, "B%s__m 0 %s__m I=%d*", n, n, 1000 + 100 * (g->r->line->where.line % 8));
  if (!kind->holds) vs_text_add(out, "(1+1000*v(%s__s))*", n);
  vs_text_add(out, "((");
  kind->sets(g, out);
  vs_text_add(out, ")*(1-v(%s__m))-(%s", n, kind->resets ? "" : "1-(");
  (kind->resets ? kind->resets : kind->sets)(g, out);
  vs_text_add(out, "%s)*v(%s__m))+1m*(0.5+0.5*tanh(1e5*(v(%s__m)-0.5))-v(%s__m))\n",
              kind->resets ? "" : ")", n, n, n);
  vs_text_add(out, "C%s__m %s__m %s__b 1u ic={1e3+%s}\nV%s__b %s__b 0 -1e3\n", n, n, n,
              g->value[IC], n, n);
  if (!kind->holds) vs_text_add(out, "V%s__s %s__s 0 PWL(0 1 1n 1 2n 0)\n", n, n);
}

static bool has_edges(const gate *g) {
  return *g->value[TRISE] || *g->value[TFALL] || *g->value[TAU];
}

/* Adds y. */
static void write_edges(const gate *g, vs_text *out) {
  const char *n = g->name, *rise = g->value[TRISE], *tau = g->value[TAU], *td = g->value[TD],
             *fall = *g->value[TFALL] ? g->value[TFALL] : rise;
  char aim[128], rising[256], falling[256], of_delay[128];
  snprintf(aim, sizeof aim, "(0.5+0.5*tanh(1e5*(v(%s__m)-0.5)))", n);
  if (!has_edges(g) && !*td) {
    vs_text_add(out, "B%s__y %s__y 0 V=%s\n", n, n, aim);
    return;
  }
  snprintf(of_delay, sizeof of_delay, "1e-3*%s", td);
  if (!has_edges(g)) tau = of_delay;
  static const char TIME[] = "max(1n,0%s%s/1.38629%s%s)"; /* 2 ln 2: half of it to the middle */
  snprintf(rising, sizeof rising, TIME, *rise ? "+" : "*", *rise ? rise : "1", *tau ? "+" : "",
           tau);
  snprintf(falling, sizeof falling, TIME, *fall ? "+" : "*", *fall ? fall : "1", *tau ? "+" : "",
           tau);
  vs_text_add(out, "B%s__y 0 %s__y I=", n, n);
  if (!g->kind->holds) vs_text_add(out, "(1+v(%s__s)*({1e12*%s}))*", n, rising);
  vs_text_add(out, "(%s*(1-v(%s__y))/({1e6*%s})-(1-%s)*v(%s__y)/({1e6*%s}))\n", aim, n, rising, aim,
              n, falling);
  if (*td)
    vs_text_add(out, "C%s__y %s__y 0 1u ic={%s}\n", n, n, g->value[IC]);
  else
    vs_text_add(out, "C%s__y %s__y %s__b 1u ic={1e3+%s}\n", n, n, n, g->value[IC]);
}

/* Adds x: what is at the end of the line, and before Td what was at first. */
static void write_delay(const gate *g, vs_text *out) {
  const char *n = g->name, *td = g->value[TD];
  vs_text_add(out, "E%s__e %s__e 0 %s__y 0 1\nT%s__d %s__e 0 %s__d 0 z0=1 td=", n, n, n, n, n, n);
  if (has_edges(g))
    vs_text_add(out, "{%s}\n", td);
  else /* less the time that y's own RC takes to the middle */
    vs_text_add(out, "{max(%s-0.693147*max(1n,1e-3*%s),1p)}\n", td, td);
  vs_text_add(out, "R%s__d %s__d 0 1\nB%s__x %s__x 0 V=time<({%s}) ? ", n, n, n, n, td);
  if (g->kind->holds)
    vs_text_add(out, "({%s})", g->value[IC]);
  else
    vs_text_add(out, "v(%s__h)", n);
  vs_text_add(out, has_edges(g) ? " : v(%s__d)\n" : " : 0.5+0.5*tanh(1e5*(v(%s__d)-0.5))\n", n);
  if (g->kind->holds) return;
  vs_text_add(out,
              "B%s__h 0 %s__h I=v(%s__s)*(v(%s__y)-v(%s__h))*1e6\nC%s__h %s__h %s__b 1u ic=1e3\n",
              n, n, n, n, n, n, n, n);
}

static void write_output(const gate *g, int node, vs_text *out) {
  char x[100];
  const char *at = g->node[node], *common = g->node[COMMON], *high = g->value[RHIGH],
             *low = g->value[RLOW], *usual = g->value[ROUT];
  snprintf(x, sizeof x, "%smin(max(v(%s__%c),0),1))", node == NOT_Q ? "(1-" : "(", g->name,
           *g->value[TD] ? 'x' : 'y');
  vs_text_add(out, "B%s__%d %s %s I=(({%s})+({%s-%s})*%s-v(%s,%s))*(%s/({%s})+(1-%s)/({%s}))\n",
              g->name, node, common, at, g->value[VLOW], g->value[VHIGH], g->value[VLOW], x, at,
              common, x, *high ? high : usual, x, *low ? low : usual);
  if (*g->value[COUT])
    vs_text_add(out, "C%s__%d %s %s {%s}\n", g->name, node, at, common, g->value[COUT]);
}

static vs_status refuse_gate(const vs_rewriting *r, vs_word kind) {
  static const char *const OTHERS[] = {"dflop",       "schmtbuf",   "schmtinv",     "phasedet",
                                       "diffschmitt", "counter",    "varistor",     "ota",
                                       "diffbuf",     "modulate",   "diffschmtbuf", "diffschmtinv",
                                       "dlatch",      "samplehold", "modulator"};
  for (size_t k = 0; k < sizeof OTHERS / sizeof *OTHERS; k++)
    if (vs_words_is(kind, OTHERS[k]))
      return vs_fail_at(r->err, vs_rewriting_place(r, kind.at, kind.n),
                        "%s is a device of LTspice's own that is not translated; write it with "
                        "BUF, INV, AND, OR, XOR, SCHMITT and SRFLOP, which are, and with B sources "
                        "and switches",
                        OTHERS[k]);
  return VS_OK;
}

static vs_status rewrite_gate(vs_rewriting *r) {
  vs_word w[VS_WORDS_MOST];
  parts none = {0};
  vs_status status = VS_OK;
  size_t count = vs_words_split(r->text.text, w);
  if (count <= GATE_KIND) return VS_OK;
  gate g = {.r = r};
  for (size_t k = 0; k < sizeof GATES / sizeof *GATES; k++)
    if (vs_words_is(w[GATE_KIND], GATES[k].name)) g.kind = &GATES[k];
  if (!g.kind) return refuse_gate(r, w[GATE_KIND]);
  for (size_t k = 0; k < sizeof PARAMETERS / sizeof *PARAMETERS && !status; k++)
    if (PARAMETERS[k].fate == HINT) status = take_out(r, &PARAMETERS[k], &none);
  if (status) return status;
  vs_words_split(r->text.text, w);
  snprintf(g.name, sizeof g.name, "%.*s", (int)w[0].n, w[0].at);
  for (char *s = g.name; *s; s++) *s = vs_words_goes_on(*s) ? *s : '_';
  status = read_nodes(&g, w);
  if (!status) status = read_values(&g, w[GATE_KIND]);
  if (status) return status;
  vs_text all = {0};
  write_memory(&g, &all);
  write_edges(&g, &all);
  if (*g.value[TD]) write_delay(&g, &all);
  for (int node = NOT_Q; node <= GATE_Q; node++)
    if (*g.node[node]) write_output(&g, node, &all);
  size_t n = strcspn(all.text, "\n");
  vs_text_free(&r->text);
  vs_text_add(&r->text, "%.*s", (int)n, all.text);
  vs_text_add(&r->more, "%s", all.text + n + 1);
  vs_text_free(&all);
  vs_rewriting_tell(r, TOLD_GATES);
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

/* Where points in brackets are those of a pulse, 0 V0 [T1 V0] T2 V1 T3 V1 T4 V0 T5 V0,
 * adds the `head` of the line and that as a PULSE, whose edges end ngspice's steps. Numbers may be
 * expressions; they are compared as texts. */
static bool add_as_pulse(const char *open, int head, const char *text, vs_text *out) {
  enum { MOST = 12 };
  vs_word w[MOST + 1];
  size_t count = 0;
  for (const char *s = open + 1; count <= MOST; count++)
    if (!(s = vs_words_number(s, &w[count]))) break;
  const size_t n = count == MOST ? 2 : 0;
  const vs_word *low = w + 1, *t = w + n, *high = t + 3;
  bool is = count == 10 || count == MOST;
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
  bool edges = add_as_pulse(open, (int)(pwl - text), text, &changed);
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
  if (letter == 'a') return rewrite_gate(r);
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
