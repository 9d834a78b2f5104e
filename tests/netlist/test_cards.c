/* SPDX-License-Identifier: GPL-3.0-or-later
 * A netlist taken apart: what its lines are, what names mean in nested subcircuits, as ngspice 39
 * was seen to take them, and how many devices it comes to. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "netlist/cards.h"
#include "netlist/catalogue.h"
#include "netlist/expr.h"
#include "netlist/netlist.h"
#include "program.h"
#include "suite.h"

enum { MOST = 64 };

/* Takes a text apart into lines, and these into cards. */
static size_t read_cards(const char *text, vs_line lines[MOST], vs_cards *c) {
  char *copy = vs_copy(text), *rest = copy;
  size_t count = 0;
  for (char *line; (line = strsep(&rest, "\n"));) {
    if (!*line) continue;
    lines[count] = (vs_line){0};
    vs_line_join(&lines[count++], line, (vs_where){"t.cir", (int)count, 1});
  }
  free(copy);
  vs_cards_read(c, lines, count);
  return count;
}

static void free_cards(vs_line *lines, size_t count, vs_cards *c) {
  vs_cards_free(c);
  for (size_t k = 0; k < count; k++) vs_line_free(&lines[k]);
}

/* What a card says, as "name nodes|words|NAME=VALUE ... model". */
static void tell_card(const vs_cards *c, const vs_netlist_card *card, char *text, size_t size) {
  int n = snprintf(text, size, "%.*s", (int)card->name.n, card->name.at);
  for (size_t k = 0; k < card->count; k++) {
    const vs_argument *a = &c->arguments[card->first + k];
    n += snprintf(text + n, size - (size_t)n, "%s", k == card->nodes ? " | " : " ");
    if (a->name.n) n += snprintf(text + n, size - (size_t)n, "%.*s=", (int)a->name.n, a->name.at);
    n += snprintf(text + n, size - (size_t)n, "%.*s", (int)a->value.n, a->value.at);
  }
  if (card->model.n)
    snprintf(text + n, size - (size_t)n, " : %.*s", (int)card->model.n, card->model.at);
}

static void lines_are_taken_apart(void) {
  static const char *const ROWS[][2] = {
      {"R1 a b 1k", "R1 a b | 1k"},
      {"R1 (a,b) {r*(1+x)} tc1=1m m = 2", "R1 a b | {r*(1+x)} tc1=1m m=2"},
      {"C1 a b 10n ic={u0 + 1}", "C1 a b | 10n ic={u0 + 1}"},
      {"V1 a 0 dc 0 sin(0 {u} 50)", "V1 a 0 | dc 0 sin 0 {u} 50"},
      {"B1 a b V = v(a,b) <= 2 ? 1 : exp(v(c))", "B1 a b | V=v(a,b) <= 2 ? 1 : exp(v(c))"},
      {"E1 a b c d 2", "E1 a b c d | 2"},
      {"E1 a b VALUE = {v(c)*2}", "E1 a b | VALUE={v(c)*2}"},
      {"E1 a b vol='v(c)*2'", "E1 a b | vol='v(c)*2'"},
      {"E1 a b POLY(2) c 0 d 0 0 1 1", "E1 a b | POLY 2 c 0 d 0 0 1 1"},
      {"F1 a b V1 2", "F1 a b | V1 2"},
      {"S1 a b c d sw1 on", "S1 a b c d | sw1 on : sw1"},
      {"W1 a b V1 sw1", "W1 a b | V1 sw1 : sw1"},
      {"D1 a k dx area=2", "D1 a k | dx area=2 : dx"},
      {"Q1 c b e qx", "Q1 c b e | qx : qx"},
      {"Q1 c b e s qm", "Q1 c b e s | qm : qm"},
      {"M1 d g s vm", "M1 d g s | vm : vm"},
      {"A1 [a b] c code", "A1 | [a b] c code : code"},
      {"X1 a b sub r=1 s = {2 + 3}", "X1 a b | sub r=1 s={2 + 3} : sub"},
      {"X1 a b sub PARAMS: r=1", "X1 a b | sub r=1 : sub"},
      {"X1 a b a-1 c-d=3", "X1 a b | a-1 c-d=3 : a-1"},
      {".subckt s1 p q PARAMS: r=1 s=2", "s1 p q | r=1 s=2"},
      {".model qm npn(bf=100 is=1e-14)", "qm | npn bf=100 is=1e-14 : npn"},
      {".param a = 1 + 2 b={a == 1}", " | a=1 + 2 b={a == 1}"},
      {".func f(x,y) {x*y}", "f"},
      {".ends s1", " | s1"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_line lines[MOST];
    vs_cards c;
    char text[300], got[300];
    snprintf(text, sizeof text, "%s\n.model qm npn\n.model vm vdmos\n", ROWS[k][0]);
    const size_t count = read_cards(text, lines, &c);
    tell_card(&c, &c.card[0], got, sizeof got);
    EXPECT(!strcmp(got, ROWS[k][1]), "%s: %s", ROWS[k][0], got);
    free_cards(lines, count, &c);
  }
}

/* ngspice 39 was given each of these circuits, with resistors that tell which one it took: the
 * inner definition before an outer one, the first of two, and never that of who calls. */
static void names_mean_what_ngspice_takes(void) {
  vs_line lines[MOST];
  vs_cards c;
  const size_t count = read_cards(".subckt inner p q\nR1 p q 1k\n.ends\n"
                                  ".subckt outer p q\n.subckt inner p q\nR1 p q 2k\n.ends\n"
                                  "Xi p q inner\nXo p q other\n.model m d(n=1)\n.ends\n"
                                  ".subckt other p q\nXi p q inner\n.param r=1\n.ends\n"
                                  ".subckt inner p q\nR1 p q 3k\n.ends\n"
                                  "X1 a 0 outer\nX2 a 0 inner\nX3 a 0 none\nX4 a 0 chosen\n",
                                  lines, &c);
  const vs_netlist_definition *d = vs_cards_find(&c, 0, VS_CARDS_SUBCKT, vs_words_of("INNER"));
  CU_ASSERT_EQUAL_FATAL(count, 22);
  CU_ASSERT_EQUAL(c.n_scopes, 6);
  CU_ASSERT_EQUAL(vs_cards_called(&c, &c.card[7]), 3);  /* Xi in outer: its own inner */
  CU_ASSERT_EQUAL(vs_cards_called(&c, &c.card[12]), 1); /* Xi in other, which outer calls */
  CU_ASSERT_EQUAL(vs_cards_called(&c, &c.card[18]), 2);
  CU_ASSERT_EQUAL(vs_cards_called(&c, &c.card[19]), 1); /* the first of two */
  CU_ASSERT_EQUAL(vs_cards_called(&c, &c.card[20]), 0);
  CU_ASSERT_EQUAL(vs_cards_called(&c, &c.card[21]), 0);
  CU_ASSERT_TRUE(d && d->twin && d->card == 0);
  c.choice[c.n_choices++] = (vs_cards_choice){"chosen", "outer"};
  CU_ASSERT_EQUAL(vs_cards_called(&c, &c.card[21]), 2);
  CU_ASSERT_PTR_NOT_NULL(vs_cards_resolve(&c, 3, VS_CARDS_MODEL, vs_words_of("m")));
  CU_ASSERT_PTR_NULL(vs_cards_resolve(&c, 0, VS_CARDS_MODEL, vs_words_of("m")));
  CU_ASSERT_PTR_NULL(vs_cards_find(&c, 3, VS_CARDS_MODEL, vs_words_of("m")));
  CU_ASSERT_PTR_NOT_NULL(vs_cards_find(&c, 4, VS_CARDS_PARAM, vs_words_of("r")));
  free_cards(lines, count, &c);
}

static int tell_element(void *ctx, const vs_instance *in, size_t number) {
  const vs_cards *c = ((void *const *)ctx)[0];
  const vs_netlist_card *card = &c->card[number];
  vs_text *out = ((void *const *)ctx)[1];
  if (vs_cards_called(c, card)) return in->depth < 3 ? VS_CARDS_ENTER : VS_CARDS_STOP;
  vs_cards_add_name(in, card->name, out);
  for (size_t k = 0; k < card->nodes; k++) {
    vs_text_add(out, " ");
    vs_cards_add_node(c, in, vs_cards_word(c, card, k), out);
  }
  vs_text_add(out, "\n");
  return VS_CARDS_PASS;
}

/* The names are those that ngspice 39 has in its vectors. */
static void circuits_are_unfolded(void) {
  vs_line lines[MOST];
  vs_cards c;
  vs_text out = {0};
  size_t count =
      read_cards(".global vcc\n.subckt s p q\n.subckt t a b\nR1 a N 1\nR2 vcc b 1\n.ends\n"
                 "XT p m t\nR3 m gnd 1\nR4 q 0 1\n.ends\nX1 A 0 s\nX2 b n none\n",
                 lines, &c);
  void *const ctx[] = {&c, &out};
  CU_ASSERT_TRUE(vs_cards_expand(&c, tell_element, (void *)(size_t)ctx));
  EXPECT(!strcmp(out.text, "x1.xt.r1 a x1.xt.n\nx1.xt.r2 vcc x1.m\nx1.r3 x1.m 0\nx1.r4 0 0\n"
                           "x2 b n\n"),
         "%s", out.text);
  vs_text_free(&out);
  free_cards(lines, count, &c);
  count = read_cards(".subckt s p q\nX1 p q s\n.ends\nX1 a 0 s\n", lines, &c);
  CU_ASSERT_FALSE(vs_cards_expand(&c, tell_element, (void *)(size_t)ctx)); /* not without end */
  free_cards(lines, count, &c);
}

static bool is_same(vs_word a, vs_word b) {
  return a.n == b.n && !memcmp(a.at, b.at, a.n);
}

/* What is written from the cards of a file has the same cards. */
static void round_trip(void *ctx, const char *path) {
  vs_deck *deck = vs_alloc(1, sizeof *deck);
  vs_error err = {0};
  size_t *files = ctx, differ = 0;
  if (vs_netlist_read_library(path, deck, &err)) EXPECT(strstr(path, "eva"), "%s", err.text);
  const vs_cards *a = vs_deck_cards(deck);
  vs_line *written = vs_alloc(a->count + 1, sizeof *written);
  vs_cards b;
  for (size_t k = 0; k < a->count; k++) {
    vs_text text = {0};
    vs_cards_write(a, k, &text);
    vs_line_join(&written[k], text.text, (vs_where){"w.cir", (int)k + 1, 1});
    vs_text_free(&text);
  }
  vs_cards_read(&b, written, a->count);
  CU_ASSERT_TRUE(a->n_arguments == b.n_arguments && a->n_definitions == b.n_definitions);
  for (size_t k = 0; k < a->n_arguments && k < b.n_arguments; k++)
    differ += !is_same(a->arguments[k].name, b.arguments[k].name) ||
              !is_same(a->arguments[k].value, b.arguments[k].value);
  for (size_t k = 0; k < a->count; k++) {
    const vs_netlist_card *x = &a->card[k], *y = &b.card[k];
    differ += x->kind != y->kind || x->scope != y->scope || x->opens != y->opens ||
              x->nodes != y->nodes || !is_same(x->name, y->name) || !is_same(x->model, y->model);
  }
  EXPECT(differ == 0, "%s: %zu", path, differ);
  ++*files;
  vs_cards_free(&b);
  for (size_t k = 0; k < a->count; k++) vs_line_free(&written[k]);
  free(written);
  vs_deck_free(deck);
  free(deck);
}

static void shipped_files_go_round(void) {
  const vs_shelf decks = {"deck", "", ".cir"}, laws = {"part", "", ".inc"};
  size_t files = 0;
  vs_path_list(&decks, round_trip, &files);
  vs_path_list(&laws, round_trip, &files);
  vs_catalogue_list(&vs_deck_parts_shelf, round_trip, &files);
  EXPECT(files > 100, "%zu files", files);
}

/* The same 12,000 resistors, whatever else is defined by the name of an inner subcircuit, before or
 * behind it. ngspice makes as many of each. */
static void order_of_text_does_not_count(void) {
  static const char SMALL[] = ".subckt small p q\n.subckt inner p q\nR1 p q 1meg\n.ends\n"
                              "Xi p q inner\n.ends\n";
  char *base = read_file(VS_TEST_FOLDER "/../spice/halfwave_snubbed.cir");
  for (int order = 0; order < 3; order++) {
    vs_text deck = {0};
    vs_text_add(&deck, "%s\n%s.subckt large p q\n.subckt inner p q\n", base,
                order == 2 ? SMALL : "");
    for (int k = 1; k <= 200; k++) vs_text_add(&deck, "R%d p q 1meg\n", k);
    vs_text_add(&deck, ".ends\nXi p q inner\n.ends\n%s", order == 1 ? SMALL : "");
    for (int k = 1; k <= 60; k++) vs_text_add(&deck, "Xs%d a 0 large\n", k);
    write_file("n.cir", deck.text);
    write_file("n.yaml", "circuit: {deck: n.cir}\nlimits: {devices: 12000}\nrun: {until: 1 ms}\n");
    vs_text_free(&deck);
    ran r = run("run n.yaml");
    EXPECT(r.status == 2 && strstr(r.err, "the circuit comes to 1.203e+04 devices"), "%d: %d %s",
           order, r.status, r.err);
    free_ran(&r);
  }
  free(base);
}

/* ---- expressions ---- */

/* Writes the tree of a text with each operation in brackets. */
static void write_bound(const vs_expr *e, size_t node, vs_text *out) {
  const vs_expr_node *n = &e->node[node];
  const bool bound = n->kind == VS_EXPR_OPERATOR || n->kind == VS_EXPR_CHOICE;
  size_t k = 0;
  if (!bound) {
    if (n->kind == VS_EXPR_SIGN) vs_text_add(out, "(%.1s", n->word.at);
    if (!n->child && n->kind != VS_EXPR_CALL) vs_text_add(out, "%.*s", (int)n->word.n, n->word.at);
    if (n->kind == VS_EXPR_CALL) vs_text_add(out, "%.*s", (int)n->word.n, n->word.at);
  }
  if (bound || n->kind == VS_EXPR_CALL) vs_text_add(out, "(");
  for (size_t child = n->child; child; child = e->node[child].next, k++) {
    if (k && !bound) vs_text_add(out, ",");
    if (k && bound) vs_text_add(out, "%.*s", k > 1 ? 1 : (int)n->word.n, k > 1 ? ":" : n->word.at);
    write_bound(e, child, out);
  }
  if (bound || n->kind == VS_EXPR_CALL || n->kind == VS_EXPR_SIGN) vs_text_add(out, ")");
}

/* As ngspice's B sources bind; values of these were seen there: -2^2 = -4, 2^3^2 = 64. */
static void expressions_are_bound(void) {
  static const char *const ROWS[][2] = {
      {"a+b*c", "(a+(b*c))"},
      {"a*b+c", "((a*b)+c)"},
      {"a-b-c", "((a-b)-c)"},
      {"-2^2", "(-(2^2))"},
      {"2^3^2", "((2^3)^2)"},
      {"2**-1*3", "((2**(-1))*3)"},
      {"{1.5e-3k * Tr}", "(1.5e-3k*Tr)"},
      {"a > b && c != 0 || !d", "(((a>b)&&(c!=0))||(!d))"},
      {"a ? b : c ? d : e", "(a?b:(c?d:e))"},
      {"v(a-1,0) + i(V1)/max(x, {y})", "(v(a-1,0)+(i(V1)/max(x,y)))"},
      {"pwl(v(x), 0,0, 1,'k*2')", "pwl(v(x),0,0,1,(k*2))"},
      {"f()*\"a b\"", "(f()*\"a b\")"}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_expr e, again;
    vs_text bound = {0}, written = {0}, twice = {0};
    vs_expr_read(&e, vs_words_of(ROWS[k][0]));
    write_bound(&e, e.node[0].child, &bound);
    EXPECT(e.whole && !strcmp(bound.text, ROWS[k][1]), "%s: %s", ROWS[k][0], bound.text);
    vs_expr_write(&e, 0, &written);
    vs_expr_read(&again, vs_words_of(written.text));
    vs_expr_write(&again, 0, &twice);
    EXPECT(again.count == e.count && !strcmp(written.text, twice.text), "%s, %s", written.text,
           twice.text);
    vs_expr_free(&e);
    vs_expr_free(&again);
    vs_text_free(&bound);
    vs_text_free(&written);
    vs_text_free(&twice);
  }
}

/* A text that is no expression has its names all the same. */
static void odd_texts_have_their_names(void) {
  static const char *const ROWS[][2] = {{"", ""},
                                        {"a b", "ab"},
                                        {"a +", "a"},
                                        {"(a", "a"},
                                        {")a]", "a"},
                                        {"f(a,,b", "ab"},
                                        {"@m[id] + c ? d", "midcd"},
                                        {"'a", "a"},
                                        {"3x4 + \"t", ""}};
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    vs_expr e;
    char names[64] = "";
    vs_expr_read(&e, vs_words_of(ROWS[k][0]));
    for (size_t n = 1; n < e.count; n++)
      if (e.node[n].kind == VS_EXPR_NAME) strncat(names, e.node[n].word.at, e.node[n].word.n);
    EXPECT(!e.whole && !strcmp(names, ROWS[k][1]), "%s: %s", ROWS[k][0], names);
    vs_expr_free(&e);
  }
  char *deep = vs_alloc(200002, 1);
  memset(deep, '(', 200000);
  vs_expr e;
  vs_expr_read(&e, vs_words_of(deep)); /* ends, and in a moment */
  CU_ASSERT_FALSE(e.whole);
  vs_expr_free(&e);
  free(deep);
}

static const vs_test TESTS[] = {
    {"lines are taken apart", lines_are_taken_apart},
    {"names mean what ngspice takes", names_mean_what_ngspice_takes},
    {"expressions are bound", expressions_are_bound},
    {"odd texts have their names", odd_texts_have_their_names},
    {"circuits are unfolded", circuits_are_unfolded},
    {"shipped files go round", shipped_files_go_round},
    {"order of text does not count", order_of_text_does_not_count},
};
int main(void) {
  return program_suite("cards", TESTS, COUNT(TESTS));
}
