/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "copying.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/path.h"
#include "netlist/kinds.h"
#include "netlist/statements.h"
#include "netlist/words.h"

void vs_copying_free(vs_copying *b) {
  vs_text_free(&b->text);
  free(b->origins);
  *b = (vs_copying){0};
}

typedef struct writer {
  vs_fate *p;
  const vs_elements *w;
  const char *folder;
  vs_copying *body;
  vs_text *out;   /* the body's text */
  int lines;      /* of the text so far */
  size_t counted; /* bytes of the text in which lines were counted */
} writer;

/* ---- elements ---- */

static const char *node(writer *b, const vs_element *e, int n) {
  return vs_elements_node_of(b->w, e, n);
}

/* Adds a text in which the current of the netlist's coil is that of the EVA. */
static void add_expression(writer *b, const char *text) {
  for (const char *at; *b->p->eva_sense && (at = vs_fate_coil_current(b->p, text));) {
    vs_text_add(b->out, "%.*si(%s)", (int)(at - text), text, b->p->eva_sense);
    text = strchr(at, ')') + 1;
  }
  vs_text_add(b->out, "%s", text);
}

/* Adds the rest of an element's line after its nodes, with its value replaced by the deck's
 * parameter. */
static void add_rest(writer *b, const vs_element *e, const vs_fate_element *own) {
  const vs_word rest = vs_elements_rest(e, e->n_nodes + 1 + (*own->param != '\0'));
  vs_text renamed = {0};
  if (*own->param) vs_text_add(b->out, " {%s}", own->param);
  vs_elements_rename(b->w, rest.at, &renamed);
  if (rest.n) vs_text_add(b->out, " ");
  add_expression(b, renamed.text);
  vs_text_add(b->out, "\n");
  vs_text_free(&renamed);
}

/* Copies an element, with the deck's names of nodes, its value as a parameter, and the source that
 * senses its current. */
static void add_element(writer *b, const vs_element *e, const vs_fate_element *own) {
  if (*own->sense)
    vs_text_add(b->out, "%s %s %s 0\n", own->sense, node(b, e, own->sensed_at), own->inner);
  if (*own->gate_sense)
    vs_text_add(b->out, "%s %s %s 0\n", own->gate_sense, node(b, e, own->pins.gate),
                own->gate_inner);
  vs_text_add(b->out, "%s", e->name);
  for (int k = 0; k < e->n_nodes; k++) {
    bool from = *own->sense && k == own->sensed_at, gate = *own->gate_sense && k == own->pins.gate;
    vs_text_add(b->out, " %s", from ? own->inner : gate ? own->gate_inner : node(b, e, k));
  }
  add_rest(b, e, own);
}

/* Adds a part. Its pins come in the order a k g, whatever order the netlist has. */
static void add_part(writer *b, const vs_element *e, const vs_fate_element *own) {
  if (*own->sense)
    vs_text_add(b->out, "%s %s %s 0\n", own->sense, node(b, e, own->sensed_at), own->inner);
  if (*own->gate_sense)
    vs_text_add(b->out, "%s %s %s 0\n", own->gate_sense, node(b, e, own->pins.gate),
                own->gate_inner);
  vs_text_add(b->out, "%s %s %s%s%s %s\n", e->name, own->inner, node(b, e, own->pins.to),
              *own->gate_sense ? " " : "", own->gate_inner, own->part);
}

/* ---- sources that the program drives ---- */

/* Adds the series resistance that LTspice puts into a source (Rser) as an element of its own.
 * Returns the node to connect the source to: the source's first node where it has no Rser. */
static const char *add_series(writer *b, const vs_element *e, char inner[VS_ELEMENTS_NAME + 8]) {
  const vs_word rser = vs_elements_option(b->w, e, "rser");
  double ohm;
  snprintf(inner, VS_ELEMENTS_NAME + 8, "%s", node(b, e, 0));
  if (rser.n && (!vs_values_of(b->p->values, rser, &ohm) || ohm != 0)) {
    const char *stem = vs_fate_of(b->p, e)->stem;
    snprintf(inner, VS_ELEMENTS_NAME + 8, "%s_ser", stem);
    vs_text_add(b->out, "Rser_%s %s %s %.*s\n", stem, node(b, e, 0), inner, (int)rser.n, rser.at);
  }
  return inner;
}

static void add_mains(writer *b, const vs_element *e) {
  char inner[VS_ELEMENTS_NAME + 8];
  const char *plus = add_series(b, e, inner);
  vs_text_add(b->out, "%s %s %s external\n", e->name, plus, node(b, e, 1));
}

/* The program's pulse has no rise and fall times. Where the netlist's are longer than this, a
 * capacitance of 1 nF makes them. A constant current charges it until a thousandth of the pulse is
 * left, so that di/dt of what the gate fires is the netlist's, too. (With 2 % left, the voltage at
 * a gate's transformer was off by 1.2 % of its peak.) */
static const double SHORT_EDGE_S = 1e-7;

bool vs_copying_has_edges(const vs_course_pulse *p) {
  return p->rise_s >= SHORT_EDGE_S || p->fall_s >= SHORT_EDGE_S;
}

/* Adds a gate's pulse of 1 V, and writes the node that carries it into `on`. */
static void add_pulse(writer *b, const char *stem, const vs_course_pulse *p, const char *two,
                      char on[VS_ELEMENTS_NAME + 8]) {
  double rise_s = fmax(p->rise_s, SHORT_EDGE_S / 10), fall_s = fmax(p->fall_s, SHORT_EDGE_S / 10);
  vs_text_add(b->out, "Vgate%s_%s %s_on%s 0 external\n", two, stem, stem, two);
  snprintf(on, VS_ELEMENTS_NAME + 8, "%s_on%s", stem, two);
  if (!vs_copying_has_edges(p)) return;
  vs_text_add(b->out, "Bedge%s_%s 0 %s_edge%s I = max(-%.9g, min(%.9g, %.9g*v(%s,%s_edge%s)))\n",
              two, stem, stem, two, 1e-9 / fall_s, 1e-9 / rise_s, 1e-6 / fmin(rise_s, fall_s), on,
              stem, two);
  vs_text_add(b->out, "Cedge%s_%s %s_edge%s 0 1n ic=0\n", two, stem, stem, two);
  snprintf(on, VS_ELEMENTS_NAME + 8, "%s_edge%s", stem, two);
}

/* Adds a gate's source: the program's pulse times its level, added to the level between pulses. */
static void add_gate(writer *b, const vs_element *e, const vs_roles_gate *g) {
  char inner[VS_ELEMENTS_NAME + 8], other[VS_ELEMENTS_NAME + 8], on[VS_ELEMENTS_NAME + 8];
  const char *at = add_series(b, e, inner);
  const vs_fate_element *own = vs_fate_of(b->p, e);
  bool voltage = e->letter == 'v';
  for (int n = 0; n < g->each; n++) {
    const char *two = n ? "2" : "";
    add_pulse(b, own->stem, &g->pulse, two, on);
    snprintf(other, sizeof other, "%s_low%s", own->stem, two);
    vs_text_add(b->out, "%cgate%s_%s %s %s %s 0 {%s}\n", voltage ? 'E' : 'G', two, own->stem, at,
                voltage ? other : node(b, e, 1), on, own->level);
    if (voltage) snprintf(inner, sizeof inner, "%s", other);
  }
  vs_text_add(b->out, "%s %s %s %.15g\n", e->name, at, node(b, e, 1), g->pulse.low);
}

static void add_coil(writer *b, const vs_element *e) {
  const vs_roles *r = b->p->roles;
  vs_text_add(b->out, "* of the EVA: %s\n", b->w->listing->cards[e->card].text);
  if (e != r->coil) return;
  const char *plus = b->w->nodes[r->coil_plus].name, *minus = b->w->nodes[r->coil_minus].name;
  if (*b->p->eva_sense) vs_text_add(b->out, "%s %s %s 0\n", b->p->eva_sense, plus, b->p->eva_in);
  vs_text_add(b->out, "%s %s %s eva\n", b->p->eva, *b->p->eva_in ? b->p->eva_in : plus, minus);
  for (const char *letter = "rc"; *letter; letter++) { /* across it, LTspice's */
    const char *name = *letter == 'r' ? "rpar" : "cpar";
    const vs_word value = vs_elements_option(b->w, e, name);
    if (vs_elements_sets(b->w, b->p->values, e, name))
      vs_text_add(b->out, "%c%s__par %s %s %.*s\n", toupper(*letter), e->name, plus, minus,
                  (int)value.n, value.at);
  }
}

/* True where both texts are the same, apart from capitals and the amount of white space. */
static bool is_same(const char *a, const char *b) {
  for (;;) {
    size_t n = strspn(a, " \t"), m = strspn(b, " \t\n");
    a += n;
    b += m;
    if (!*a || !*b) return !*a && !*b;
    if ((n > 0) != (m > 0) || tolower((unsigned char)*a++) != tolower((unsigned char)*b++))
      return false;
  }
}

/* Adds the element's lines. Lines that would say the same as the netlist's stay as they were
 * written. */
static void write_element(writer *b, const vs_element *e) {
  const vs_fate_element *own = vs_fate_of(b->p, e);
  int gate = vs_roles_gate_of(b->p->roles, e);
  const vs_card *card = &b->w->listing->cards[e->card];
  size_t before = b->body->text.length;
  if (vs_fate_is_coil(b->p, e))
    add_coil(b, e);
  else if (e == b->p->roles->mains)
    add_mains(b, e);
  else if (gate >= 0)
    add_gate(b, e, &b->p->roles->gates[gate]);
  else if (*own->part)
    add_part(b, e, own);
  else
    add_element(b, e, own);
  if (!is_same(card->text, b->body->text.text + before)) return;
  b->body->text.length = before;
  b->body->text.text[before] = '\0';
  vs_text_add(b->out, "%s\n", card->raw);
}

/* ---- statements ---- */

/* True for a statement that the deck leaves out: an analysis, an option, an output. If the
 * statement means another circuit, or several runs, a note tells what to use instead. */
static bool is_skipped(writer *b, const vs_card *card) {
  static const char *const OURS[] = {".title",    ".stmlib",       ".wave",     ".watch",
                                     ".external", ".autoconverge", ".loadbias", ".savebias"};
  vs_skipped skipped = {.count = 0};
  vs_error why = {0};
  bool skip = false;
  if (vs_statements_judge(card->text, card->where, &skipped, &skip, &why)) {
    vs_declared_note(&b->p->sheet.left, "line %d: %s", card->where.line, why.text + why.place_size);
    skip = true;
  }
  vs_statements_free(&skipped);
  return skip || VS_WORDS_AMONG(vs_words_at(card->text), OURS);
}

/* Reads the end of the run from ".tran step end ..." or from LTspice's ".tran end". */
static void read_tran(writer *b, const vs_card *card) {
  vs_word w[VS_WORDS_MOST];
  double end_s;
  const size_t n = vs_words_split(card->text, w);
  if ((n > 2 && vs_values_of(b->p->values, w[2], &end_s)) ||
      (n > 1 && vs_values_of(b->p->values, w[1], &end_s)))
    b->body->until_s = end_s;
}

/* Writes the .param lines of a card whose parameters are expressions; those that are numbers become
 * parameters of the deck. */
static void write_params(writer *b, size_t card) {
  const vs_values *v = b->p->values;
  for (size_t k = 0; k < v->count; k++) {
    const vs_value_param *p = &v->item[k];
    if (p->card != card || (p->number && vs_values_find(v, p->name) == p)) continue;
    if (vs_deck_is_standard(p->name) || vs_values_find(v, p->name) != p) continue;
    bool braces = !strchr("{'\"", *p->text);
    vs_text_add(b->out, ".param %s=%s", p->name, braces ? "{" : "");
    vs_text_add(b->out, "%s", p->text);
    vs_text_add(b->out, "%s\n", braces ? "}" : "");
  }
}

/* True where the file was found, but at another place than its line says. */
static bool is_elsewhere(const vs_card *card, const char *path) {
  const char *slash = strrchr(card->where.file, '/');
  size_t folder = slash ? (size_t)(slash - card->where.file + 1) : 0;
  char *said = vs_copy(card->text);
  for (char *c = said; *c; c++)
    if (*c == '\\') *c = '/';
  bool absolute = strncmp(path, card->where.file, folder) != 0;
  const char *name = path + (absolute ? 0 : folder), *at = strstr(said, name);
  bool elsewhere = !at || at == said || !strchr(" \t\"'", at[-1]);
  free(said);
  return elsewhere;
}

static void write_include(writer *b, const vs_card *card) {
  char path[VS_PATH_SIZE], full[VS_PATH_SIZE];
  vs_listing_finds(card, path);
  if (!*path) {
    vs_declared_note(&b->p->sheet.did,
                     "line %d: '%s' is not here and left out: every model that is "
                     "used is defined elsewhere",
                     card->where.line, card->text);
    return;
  }
  if (is_elsewhere(card, path))
    vs_declared_note(&b->p->sheet.did, "line %d: '%s' is not here; taken is %s", card->where.line,
                     card->text, path);
  size_t n = strlen(b->folder);
  if (realpath(path, full))
    vs_text_add(b->out, ".include \"%s\"\n",
                !strncmp(full, b->folder, n) && full[n] == '/' ? full + n + 1 : full);
}

/* Adds the same initial value for the nodes that were put between the elements at that node and the
 * sources that sense their currents. */
static void add_inner_values(writer *b, vs_word name, vs_word value) {
  for (size_t k = 0; k < b->w->count; k++) {
    const vs_element *e = &b->w->elements[k];
    const vs_fate_element *own = &b->p->of[k];
    if (*own->sense && vs_words_is(name, node(b, e, own->sensed_at)))
      vs_text_add(b->out, " v(%s)=%.*s", own->inner, (int)value.n, value.at);
    if (*own->gate_sense && vs_words_is(name, node(b, e, own->pins.gate)))
      vs_text_add(b->out, " v(%s)=%.*s", own->gate_inner, (int)value.n, value.at);
  }
}

/* Adds the initial values of inner nodes for each entry "v(NODE)=VALUE" of an .ic line. */
static void add_inner_starts(writer *b, const char *line) {
  static const char BLANKS[] = " \t";
  for (const char *s = line; (s = strpbrk(s, "vV")); s++) {
    const char *at = s + 1 + strspn(s + 1, BLANKS);
    if (s == line || !strchr(" \t,", s[-1]) || *at++ != '(') continue;
    at += strspn(at, BLANKS);
    const vs_word name = {at, strcspn(at, " \t)")};
    at += name.n + strspn(at + name.n, " \t)");
    if (*at++ != '=') continue;
    at += strspn(at, BLANKS);
    size_t n = strcspn(at, *at == '{' ? "}" : " \t,");
    if (at[n] == '}') n++;
    add_inner_values(b, name, (vs_word){at, n});
  }
}

static void write_statement(writer *b, size_t card_number) {
  const vs_card *card = &b->w->listing->cards[card_number];
  char path[VS_PATH_SIZE];
  vs_text renamed = {0};
  if (vs_listing_is(card, ".tran")) read_tran(b, card);
  if (!strncasecmp(card->text, ".opt", 4) && strcasestr(card->text, "gear")) b->body->gear = true;
  if (is_skipped(b, card)) {
    b->body->skipped += !vs_listing_is(card, ".end");
    if (!vs_listing_is(card, ".end")) vs_text_add(b->out, "* left out: %s\n", card->text);
  } else if (!strncasecmp(card->text, ".param", 6))
    write_params(b, card_number);
  else if (vs_listing_finds(card, path))
    write_include(b, card);
  else {
    vs_elements_rename(b->w, card->text, &renamed); /* .ic, .nodeset, .global */
    vs_text_add(b->out, "%s", renamed.text);
    if (vs_listing_is(card, ".ic")) add_inner_starts(b, renamed.text);
    vs_text_add(b->out, "\n");
    vs_text_free(&renamed);
  }
}

/* ---- the whole ---- */

/* Signs of PSpice's own dialect. A netlist that PSpice wrote is read in that dialect as a whole
 * where it has any of them; another one where it has one of the first ALWAYS. The others the reader
 * of decks translates one by one (docs/from_ltspice.md), so that all else in such a netlist keeps
 * ngspice's meaning. */
static bool wants_pspice(const vs_listing *l) {
  static const char *const SIGNS[] = {
      "limit(",   "ako:",      " vswitch", " iswitch", "t_abs=",  "t_abs =", "params:", "value={",
      "value ={", "value = {", "value {",  "value{",   "table {", "table{",  "if(",     "pwrs(",
      " res(",    " res (",    " cap(",    " cap (",   " ind(",   " ind ("};
  enum { ALWAYS = 6 };
  size_t count = l->origin == VS_ORIGIN_PSPICE ? sizeof SIGNS / sizeof *SIGNS : ALWAYS;
  for (size_t k = 0; k < l->count; k++)
    for (size_t s = 0; s < count; s++)
      if (l->cards[k].kind != VS_CARD_COMMENT && strcasestr(l->cards[k].text, SIGNS[s]))
        return true;
  return false;
}

static void note_origin(writer *b, const vs_card *card) {
  vs_copying *body = b->body;
  for (; b->counted < body->text.length; b->counted++)
    b->lines += body->text.text[b->counted] == '\n';
  body->origins = vs_alloc_grow(body->origins, body->count, sizeof *body->origins);
  body->origins[body->count++] = (vs_copying_origin){b->lines + 1, card->where};
}

/* Adds the node whose voltage is the sum of the thyristors' currents. It tells when one of them
 * fires or goes out. */
static void write_sum(writer *b) {
  const char *first[VS_DECK_DEVICES];
  size_t count = 0;
  for (size_t k = 0; k < b->w->count && count < VS_DECK_DEVICES; k++) {
    const vs_fate_element *own = &b->p->of[k];
    if (vs_kinds_latches(own->pins.kind)) first[count++] = own->sense;
  }
  if (count < 2) return;
  const char *sum = b->p->sum;
  for (size_t k = 0; k < count; k++)
    vs_text_add(b->out, "F%s 0 %s %s 1\n", first[k] + 1, sum, first[k]);
  vs_text_add(b->out, "R%s %s 0 1\n", sum, sum);
}

static void write_comment(writer *b, const vs_card *card) {
  const char *text = card->raw + strspn(card->raw, " \t");
  if (*text == ';') vs_text_add(b->out, "*");
  vs_text_add(b->out, "%s%s\n", !strncmp(text, "*$", 2) ? "* " : "", *text ? text : "");
}

void vs_copying_write(vs_fate *p, const char *folder, const char *library, vs_copying *body) {
  writer b = {.p = p, .w = p->wiring, .folder = folder, .body = body, .out = &body->text};
  const vs_listing *l = p->wiring->listing;
  char full[VS_PATH_SIZE];
  size_t element = 0;
  body->until_s = NAN;
  body->pspice = wants_pspice(l);
  if (library && realpath(library, full)) vs_text_add(b.out, ".include \"%s\"\n", full);
  for (size_t k = 0; k < l->count; k++) {
    const vs_card *card = &l->cards[k];
    if (card->included) continue;
    note_origin(&b, card);
    if (card->kind == VS_CARD_COMMAND) {
      if (vs_listing_is(card, "tran")) read_tran(&b, card);
      body->skipped++;
      continue;
    }
    if (card->kind == VS_CARD_COMMENT)
      write_comment(&b, card);
    else if (card->depth > 0) {
      vs_text_add(b.out, "%s\n", card->raw);
    } else if (card->kind == VS_CARD_STATEMENT)
      write_statement(&b, k);
    else
      write_element(&b, &p->wiring->elements[element++]);
  }
  write_sum(&b);
}
