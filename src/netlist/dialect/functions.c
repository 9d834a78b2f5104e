/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dialect/functions.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "netlist/expr.h"
#include "netlist/words.h"

/* A call as it stands in r->text: from `at` to before `end`. */
typedef struct call {
  size_t at, length;
  vs_word argument[VS_WORDS_MOST];
  size_t count;
} call;

/* A function of others. Either `as` says what it is in ngspice, where $1 is its first argument; or
 * `write` makes it; or neither can, and `instead` says what the user may write. */
typedef struct function {
  const char *name;
  size_t least, most; /* how many arguments it has */
  const char *as;
  vs_status (*write)(vs_rewriting *r, const struct function *f, const call *c, vs_text *text);
  const char *told;    /* the warning where it was rewritten */
  const char *instead; /* follows the function's name in a message */
  bool native;         /* ngspice knows it in PSpice's dialect */
  bool isspice;        /* it is another one in IsSpice's */
} function;

/* Writes a table for where ngspice has no pwl, as in a .param: y1 and, for each stretch, the share
 * of it that lies below x times its rise. */
static void write_sum(const call *c, vs_text *text) {
  const vs_word *a = c->argument;
  vs_text_add(text, "(%.*s", (int)a[2].n, a[2].at);
  for (size_t k = 3; k + 1 < c->count; k += 2)
    vs_text_add(text, "+((%.*s)-(%.*s))*min(max(((%.*s)-(%.*s))/((%.*s)-(%.*s)),0),1)",
                (int)a[k + 1].n, a[k + 1].at, (int)a[k - 1].n, a[k - 1].at, (int)a[0].n, a[0].at,
                (int)a[k - 2].n, a[k - 2].at, (int)a[k].n, a[k].at, (int)a[k - 2].n, a[k - 2].at);
  vs_text_add(text, ")");
}

/* table(x, x1, y1, ...): between the points straight lines, beyond them the last value. ngspice's
 * pwl goes on straight, so that x is held between the first and the last point. */
static vs_status write_table(vs_rewriting *r, const function *f, const call *c, vs_text *text) {
  const vs_word *a = c->argument;
  (void)f;
  if (c->count % 2 == 0)
    return vs_fail_at(r->err, vs_rewriting_place(r, r->text.text + c->at, strlen(f->name)),
                      "%s: an x and pairs of numbers are wanted", f->name);
  if (!strchr("bBeEgG", *r->line->text)) {
    write_sum(c, text);
    return VS_OK;
  }
  vs_text_add(text, "pwl(min(max(%.*s,%.*s),%.*s)", (int)a[0].n, a[0].at, (int)a[1].n, a[1].at,
              (int)a[c->count - 2].n, a[c->count - 2].at);
  for (size_t k = 1; k < c->count; k++) vs_text_add(text, ",%.*s", (int)a[k].n, a[k].at);
  vs_text_add(text, ")");
  return VS_OK;
}

/* idt(x, begin): a current x into 1 F makes a voltage that is the integral of x. The capacitor and
 * its source stand beside the line, under names of their own. */
static vs_status write_integral(vs_rewriting *r, const function *f, const call *c, vs_text *text) {
  const vs_word *a = c->argument;
  vs_word name = {r->line->text, strcspn(r->line->text, " \t")};
  if (!strchr("bBeEgG", *r->line->text))
    return vs_fail_at(r->err, vs_rewriting_place(r, r->text.text + c->at, strlen(f->name)),
                      "%s: an integral belongs into a B source: B1 i 0 V=%s(...), of which others "
                      "use v(i)",
                      f->name, f->name);
  char node[80];
  snprintf(node, sizeof node, "%.*s__int%d", (int)name.n, name.at, ++r->integrals);
  vs_text_add(&r->more, "B%s 0 %s I=%.*s\nC%s %s 0 1 ic={%.*s}\n", node, node, (int)a[0].n, a[0].at,
              node, node, c->count > 1 ? (int)a[1].n : 1, c->count > 1 ? a[1].at : "0");
  vs_text_add(text, "v(%s)", node);
  return VS_OK;
}

static const char CHANCE[] = "is random anew in each run, and a run could not be repeated";
static const char SMOOTH[] =
    "is LTspice's, which says nowhere how it is rounded; write min(x, most) or max(x, least), "
    "which have a corner";

/* At most 32, as a mask has a bit for each.
 *
 * To add a function of another program: a row here, told by test_dialects and listed in
 * docs/from_ltspice.md. */
static const function FUNCTIONS[] = {
    {"if", 3, 3,
     .as = "ternary_fcn(($1)>0.5,$2,$3)", /* a condition is 0 or 1; LTspice takes any number */
     .native = true, .told = "IF(a, b, c), PSpice's and LTspice's, is read as a > 0.5 ? b : c"},
    {"stp", 1, 1, .as = "ternary_fcn(($1)>0,1,0)", .native = true,
     .told = "STP(x), PSpice's, is read as x > 0 ? 1 : 0"},
    {"pwrs", 2, 2, /* straight up to 1e-15: ngspice ends at a slope that is infinite, as that of a
                    * power below 1 is where x is 0, and Newton's iteration does not leave that
                    * place where the slope is none */
     .as = "(($1)*pow(max(abs($1),1e-15),($2)-1))",
     .told = "PWRS(x, y), PSpice's and LTspice's, is read as sgn(x)*pow(abs(x), y)"},
    {"table", 3, VS_WORDS_MOST, .write = write_table,
     .told = "table(x, ...) is read as pwl(...), held at its ends"},
    {"tbl", 3, VS_WORDS_MOST, .write = write_table,
     .told = "tbl(x, ...) is read as pwl(...), held at its ends"},
    {"buf", 1, 1, .as = "ternary_fcn(($1)>0.5,1,0)",
     .told = "buf(x), LTspice's, is read as x > 0.5 ? 1 : 0"},
    {"inv", 1, 1, .as = "ternary_fcn(($1)>0.5,0,1)",
     .told = "inv(x), LTspice's, is read as x > 0.5 ? 0 : 1"},
    {"hypot", 2, 2, .as = "sqrt(($1)*($1)+($2)*($2))",
     .told = "hypot(x, y) is read as sqrt(x*x + y*y)"},
    {"round", 1, 1, .as = "floor(($1)+0.5)", .told = "round(x) is read as floor(x + 0.5)"},
    {"int", 1, 1, .as = "(sgn($1)*floor(abs($1)))",
     .told = "int(x) is read as sgn(x)*floor(abs(x))"},
    {"log", 1, 1,
     .as = "log10(max($1,1e-30))", /* ngspice ends at one of Newton's trials that is below 0 */
     .isspice = true, .told = "LOG(x), IsSpice's, is read as log10(x)"},
    {"arctan", 1, 1, .as = "atan($1)", .told = "arctan is read as atan"},
    {"arcsin", 1, 1, .as = "asin($1)", .told = "arcsin is read as asin"},
    {"arccos", 1, 1, .as = "acos($1)", .told = "arccos is read as acos"},
    {"idt", 1, 2, .write = write_integral,
     .told = "idt(x), LTspice's integral, is read as the voltage of a capacitor of 1 F that x "
             "charges from t = 0 on"},
    {"sdt", 1, 2, .write = write_integral,
     .told = "sdt(x), the integral, is read as the voltage of a capacitor of 1 F that x charges "
             "from t = 0 on"},
    {.name = "dnlim", .instead = SMOOTH},
    {.name = "uplim", .instead = SMOOTH},
    {.name = "idtmod",
     .instead = "is LTspice's; write the integral by a B source into a capacitor "
                "of 1 F and take its remainder"},
    {.name = "atan2", .instead = "is LTspice's; for x > 0 atan2(y, x) is atan(y/x)"},
    {.name = "delay",
     .instead = "is LTspice's; a line delays: 'T1 a 0 b 0 z0=50 td=1u', with 50 "
                "ohm at its end"},
    {.name = "absdelay",
     .instead = "is LTspice's; a line delays: 'T1 a 0 b 0 z0=50 td=1u', with "
                "50 ohm at its end"},
    {.name = "rand", .instead = CHANCE},
    {.name = "random", .instead = CHANCE},
    {.name = "white", .instead = CHANCE},
};

/* Writes the function's pattern with its arguments. */
static void write_pattern(const char *pattern, const call *c, vs_text *text) {
  for (const char *s = pattern; *s; s++)
    if (*s == '$') {
      const vs_word *a = &c->argument[*++s - '1'];
      vs_text_add(text, "%.*s", (int)a->n, a->at);
    } else
      vs_text_add(text, "%c", *s);
}

/* A function within itself, of which each is written out with its argument twice, doubles the line
 * with each: twenty of them would make megabytes. No line that is meant needs as much. */
enum { LONGEST = 100000 };

/* Rewrites the call of f whose name stands at `at`. */
static vs_status rewrite(vs_rewriting *r, const function *f, const char *at, const char *open) {
  call c = {.at = (size_t)(at - r->text.text)};
  const char *end = NULL;
  vs_where where = vs_rewriting_place(r, at, strlen(f->name));
  if (f->instead) return vs_fail_at(r->err, where, "%s %s", f->name, f->instead);
  c.count = vs_words_arguments(open, c.argument, &end);
  if (c.count < f->least || c.count > f->most || c.argument[0].n == 0)
    return vs_fail_at(r->err, where, "%s: %zu %s wanted in its brackets, and it has %zu", f->name,
                      f->least, f->most > f->least ? "arguments or more are" : "are", c.count);
  vs_text text = {0};
  vs_status status = VS_OK;
  if (f->as)
    write_pattern(f->as, &c, &text);
  else
    status = f->write(r, f, &c, &text);
  if (!status) {
    vs_rewriting_replace(r, c.at, (size_t)(end - at), text.text);
    vs_tally_add(r->tally, f->told, where);
  }
  vs_text_free(&text);
  return status;
}

/* The function of the name that ends before `end`; NULL: it is none of these. */
static const function *function_before(const vs_rewriting *r, const char *end, const char **at) {
  const char *begin = end;
  while (begin > r->text.text && vs_words_goes_on(begin[-1])) begin--;
  if (begin == end || (begin > r->text.text && strchr(".#", begin[-1]))) return NULL;
  const vs_word name = {begin, (size_t)(end - begin)};
  for (size_t k = 0; k < sizeof FUNCTIONS / sizeof *FUNCTIONS; k++) {
    const function *f = &FUNCTIONS[k];
    if (!vs_words_is(name, f->name)) continue;
    if ((f->native && r->pspice) || (f->isspice && !r->isspice) || r->own >> k & 1) return NULL;
    *at = begin;
    return f;
  }
  return NULL;
}

/* The last call whose bracket does not stand behind the first `until` bytes, so that what a call
 * has as arguments is done before it. */
static const function *find_last(const vs_rewriting *r, size_t until, const char **at,
                                 const char **open) {
  for (const char *s = r->text.text + until; s > r->text.text; s--) {
    if (*s != '(') continue;
    const char *end = s;
    while (end > r->text.text && strchr(" \t", end[-1])) end--;
    const function *f = function_before(r, end, at);
    *open = s;
    if (f) return f;
  }
  return NULL;
}

/* PSpice and LTspice write "and", "or" and "not" as & | and ~. */
static void rewrite_operators(vs_rewriting *r) {
  static const struct {
    char sign;
    const char *as;
  } SIGNS[] = {{'&', "&&"}, {'|', "||"}, {'~', "!"}};
  for (size_t k = 0; k < sizeof SIGNS / sizeof *SIGNS; k++)
    for (size_t at = 0; r->text.text[at]; at++) {
      const char *s = r->text.text + at;
      if (*s != SIGNS[k].sign) continue;
      if (s[1] == *s) { /* ngspice's own */
        at++;
        continue;
      }
      vs_rewriting_replace(r, at, 1, SIGNS[k].as);
      at += strlen(SIGNS[k].as) - 1;
      vs_rewriting_tell(r, "& | and ~ between conditions are read as && || and !");
    }
}

/* True for a text that may be below 0: one with a voltage or a current, and of no function that
 * keeps it above. */
static bool may_be_negative(const char *text, size_t n) {
  static const char *const ABOVE[] = {"abs(", "exp(", "sqrt(", "max(", "uramp("};
  for (size_t k = 0; k < sizeof ABOVE / sizeof *ABOVE; k++)
    if (!strncasecmp(text, ABOVE[k], strlen(ABOVE[k]))) return false;
  for (size_t k = 0; k + 1 < n; k++)
    if (strchr("vViI", text[k]) && text[k + 1] == '(' && (!k || !vs_words_goes_on(text[k - 1])))
      return true;
  return false;
}

static bool is_even(const char *exponent) {
  char *end;
  double y = strtod(exponent, &end);
  return end > exponent && fmod(y, 2) == 0 && !vs_words_goes_on(*end);
}

/* True for the tree of V(...), I(...) or a bracket. */
static bool is_base(const vs_expr_node *n) {
  return (n->kind == VS_EXPR_BRACKET && *n->word.at == '(') ||
         (n->kind == VS_EXPR_CALL && (vs_words_is(n->word, "v") || vs_words_is(n->word, "i")));
}

/* ngspice 39 takes the size of x in x^y, x**y and pow(x, y), so that an odd power has no sign. */
static void tell_powers(vs_rewriting *r) {
  static const char TOLD[] = "x^y, x**y and pow(x, y) are powers of |x| in ngspice: where x may be "
                             "below 0 and y is odd, write sgn(x)*abs(x)^y";
  vs_expr e;
  vs_expr_read(&e, vs_words_of(r->text.text));
  for (size_t k = 1; k < e.count; k++) {
    const vs_expr_node *n = &e.node[k], *x = &e.node[n->child], *y = &e.node[x->next];
    const bool power = n->kind == VS_EXPR_OPERATOR &&
                       (vs_words_is(n->word, "^") || vs_words_is(n->word, "**")) && is_base(x);
    if (!power && !(n->kind == VS_EXPR_CALL && vs_words_is(n->word, "pow") && n->child)) continue;
    const size_t bracket = *x->whole.at == '(';
    const char *base = x->whole.at + bracket;
    if (x->next && !y->next && !is_even(y->whole.at) && may_be_negative(base, x->whole.n - bracket))
      vs_tally_add(r->tally, TOLD, vs_rewriting_place(r, base, 1));
  }
  vs_expr_free(&e);
}

/* True for a line that may have expressions: elements with a formula, parameters and functions. */
static bool has_expressions(const char *line) {
  if (*line == '.')
    return !strncasecmp(line, ".param", 6) || !strncasecmp(line, ".func", 5) ||
           !strncasecmp(line, ".subckt", 7) || !strncasecmp(line, ".if", 3) ||
           !strncasecmp(line, ".elseif", 7);
  return strpbrk(line, "={'") != NULL;
}

vs_status vs_functions_rewrite(vs_rewriting *r) {
  const char *at = NULL, *open = NULL;
  const function *f;
  if (!has_expressions(r->text.text)) return VS_OK;
  if (!r->pspice) rewrite_operators(r);
  const char *text = r->text.text;
  if (strchr(text, '^') || strstr(text, "**") || strcasestr(text, "pow")) tell_powers(r);
  size_t until = r->text.length;
  while ((f = find_last(r, until, &at, &open))) {
    until = (size_t)(at - r->text.text); /* what is written there has no call of these */
    if (r->text.length > LONGEST)
      return vs_fail_at(r->err, vs_rewriting_place(r, at, strlen(f->name)),
                        "%s: written out for ngspice, the line is longer than %d characters; give "
                        "inner functions sources of their own: B1 x 0 V=%s(...), and then v(x)",
                        f->name, LONGEST, f->name);
    vs_status status = rewrite(r, f, at, open);
    if (status) return status;
  }
  return VS_OK;
}

void vs_functions_own(const char *line, unsigned long *own) {
  line += strspn(line, " \t");
  if (strncasecmp(line, ".func", 5)) return;
  line += strcspn(line, " \t");
  line += strspn(line, " \t");
  for (size_t k = 0; k < sizeof FUNCTIONS / sizeof *FUNCTIONS; k++) {
    size_t n = strlen(FUNCTIONS[k].name);
    if (!strncasecmp(line, FUNCTIONS[k].name, n) && strchr(" \t(", line[n])) *own |= 1UL << k;
  }
}
