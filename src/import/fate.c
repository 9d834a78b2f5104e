/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fate.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/formula.h"
#include "declared.h"
#include "import/elements.h"
#include "netlist/reserved.h"

/* ---- values ---- */

/* The values of resistors, capacitors and inductors: as parameters of the deck, and as formulas of
 * these in its lines `loss` and `store`. */

/* Only numbers a formula's names and terms. */
static int any_name(void *ctx, const char *at, const char *name) {
  (void)at;
  (void)name;
  return (*(int *)ctx)++;
}

static bool is_formula(const char *text) {
  int count = 0;
  char why[200];
  const char *bad = NULL;
  const vs_formula_scope scope = {.ctx = &count, .name = any_name};
  vs_formula formula = {0};
  const char *end = vs_formula_read(text, &scope, &formula, &bad, why, sizeof why);
  vs_formula_free(&formula);
  return end && !*end;
}

/* Writes an expression in terms of the deck's parameters alone; other parameters are replaced by
 * what they stand for. */
static void expand(const vs_fate *p, vs_word text, int level, vs_text *out) {
  vs_text_add(out, "(");
  for (const char *s = text.at; s < text.at + text.n;) {
    char name[VS_VALUES_NAME];
    size_t n = strspn(s, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789.");
    snprintf(name, sizeof name, "%.*s", (int)n, s);
    const vs_value_param *v = n ? vs_values_find(p->values, name) : NULL;
    bool other = v && level < 20 && (!v->number || p->wiring->listing->cards[v->card].included);
    if (other)
      expand(p, vs_words_of(v->text), level + 1, out);
    else if (n)
      vs_text_add(out, "%.*s", (int)n, s);
    else if (!strchr("'\"", *s))
      vs_text_add(out, "%c", *s == '{' ? '(' : *s == '}' ? ')' : *s);
    s += n ? n : 1;
  }
  vs_text_add(out, ")");
}

/* True where the element's value depends on temperature and its temperature is set. Without temp=
 * and dtemp= coefficients have no effect: a deck runs at 27 degC, which they refer to. */
static bool is_warm(const vs_fate *p, const vs_element *e) {
  return vs_elements_heats(p->wiring, p->values, e) &&
         (vs_elements_option(p->wiring, e, "temp").n ||
          vs_elements_sets(p->wiring, p->values, e, "dtemp"));
}

/* Adds "*2" or "/2" for an option that the element has. Returns false where the option is no number
 * above 0 that is known before a run. */
static bool add_factor(const vs_fate *p, const vs_element *e, const char *name, char sign,
                       vs_text *out) {
  double value = 1;
  const vs_word text = vs_elements_option(p->wiring, e, name);
  if (!text.n) return true;
  if (!vs_values_of(p->values, text, &value) || !(value > 0)) return false;
  vs_text_add(out, "%c", sign);
  if (vs_values_number(p->values, text, &value))
    vs_text_add(out, "%.15g", value);
  else
    expand(p, text, 0, out);
  return true;
}

/* Applies m= and scale= to the value: m resistors or inductors in parallel are less, m capacitors
 * are more. Empties the formula where the value is not known. */
static void multiply(const vs_fate *p, const vs_element *e, vs_text *value) {
  vs_text factors = {0}, whole = {0};
  bool known = value->text && !is_warm(p, e) && add_factor(p, e, "scale", '*', &factors) &&
               add_factor(p, e, "m", e->letter == 'c' ? '*' : '/', &factors);
  if (known && factors.text) vs_text_add(&whole, "(%s%s)", value->text, factors.text);
  vs_text_free(&factors);
  if (known && !whole.text) return;
  vs_text_free(value);
  *value = whole;
}

/* Adds a parameter with the element's value, a number, and its name as a formula. */
static void add_param(vs_fate *p, const vs_element *e, double number, char *param,
                      vs_text *formula) {
  vs_declared *sheet = &p->sheet;
  static const char *const WHAT[] = {"resistor", "capacitor", "inductor"};
  char wanted[VS_DECK_NAME], text[VS_DECK_TEXT];
  bool taken = vs_deck_is_standard(e->key) || vs_reserved_is(e->key, false);
  snprintf(wanted, sizeof wanted, "%.50s%s", e->key, taken ? "_value" : "");
  vs_declared_name(sheet, wanted, param);
  size_t before = sheet->counts[VS_DECLARED_PARAM];
  snprintf(text, sizeof text, "%s %s", WHAT[strchr("rcl", e->letter) - "rcl"], e->name);
  vs_declared_param(sheet, param, e->letter, number, text);
  if (sheet->counts[VS_DECLARED_PARAM] == before) *param = '\0'; /* no room: it stays */
  if (*param)
    vs_text_add(formula, "{%s}", param);
  else
    vs_text_add(formula, "%.15g", number);
}

/* Adds an expression, or the name of a deck's parameter if it is just that. */
static void add_expression(const vs_fate *p, vs_word word, vs_text *formula) {
  char name[VS_VALUES_NAME];
  const size_t n = strcspn(word.at + 1, "}");
  snprintf(name, sizeof name, "%.*s", *word.at == '{' && n < sizeof name ? (int)n : 0, word.at + 1);
  const vs_value_param *v = vs_values_find(p->values, name);
  if (v && v->number && !p->wiring->listing->cards[v->card].included)
    vs_text_add(formula, "{%s}", v->name);
  else
    expand(p, word, 0, formula);
}

/* Declares a parameter for an R, C or L whose value is a number, and writes its name into
 * own->param; empty: there is none. own->value becomes the value that the element has in a run,
 * with m= and scale=; NULL where it is not known: beside a .model, or with a temperature
 * coefficient and temp= or dtemp=. */
static void set_value(vs_fate *p, const vs_element *e, vs_fate_element *own) {
  const vs_word word = vs_elements_word(e, e->n_nodes + 1);
  double value;
  vs_text formula = {0};
  /* ngspice does not see the model after "{r1}", so that the netlist's number stays there */
  if (vs_elements_has_model(p->wiring, e))
    *own->param = '\0';
  else if (vs_values_number(p->values, word, &value) && value > 0)
    add_param(p, e, value, own->param, &formula);
  else if (vs_values_of(p->values, word, &value) && value > 0)
    add_expression(p, word, &formula);
  multiply(p, e, &formula);
  if (formula.text && is_formula(formula.text))
    own->value = formula.text;
  else
    vs_text_free(&formula);
}

/* ---- new names ---- */

/* New names for the deck: for parameters, and for nodes and elements that are put between those of
 * the netlist. A new name differs from all names in the netlist. */

/* True where a node, an element, a parameter or a function of the netlist has this name. */
static bool is_taken(const vs_fate *p, const char *name) {
  const vs_cards *n = &p->wiring->listing->netlist;
  bool taken = vs_elements_is_taken(p->wiring, name) || vs_values_find(p->values, name) ||
               vs_names_find(&n->globals, name, strlen(name), NULL);
  for (size_t k = 0; k < n->n_definitions && !taken; k++)
    taken = n->definition[k].kind == VS_CARDS_FUNC && vs_words_is(n->definition[k].name, name);
  return taken;
}

/* Makes the name FIRST KEY LAST. If it is taken, "_2", "_3", ... is appended. */
static void name_free(const vs_fate *p, const char *first, const char *key, const char *last,
                      char name[VS_ELEMENTS_NAME]) {
  snprintf(name, VS_ELEMENTS_NAME, "%s%.44s%s", first, key, last);
  for (int k = 2; is_taken(p, name); k++)
    snprintf(name, VS_ELEMENTS_NAME, "%s%.40s%s_%d", first, key, last, k);
}

/* True where one of the names made of this stem is taken in the netlist, or the stem belongs to
 * another element already. */
static bool is_stem_used(const vs_fate *p, const vs_element *source, const char *stem) {
  static const char *const MADE[][2] = {
      {"", "_on"},     {"", "_on2"},    {"", "_edge"},   {"", "_edge2"},  {"", "_low"},
      {"", "_low2"},   {"", "_ser"},    {"Vgate_", ""},  {"Vgate2_", ""}, {"Egate_", ""},
      {"Egate2_", ""}, {"Ggate_", ""},  {"Ggate2_", ""}, {"Bedge_", ""},  {"Bedge2_", ""},
      {"Cedge_", ""},  {"Cedge2_", ""}, {"Rser_", ""}};
  const vs_element *other = vs_elements_find(p->wiring, vs_words_of(stem));
  char name[VS_ELEMENTS_NAME];
  bool used = other && other != source;
  for (size_t k = 0; k < sizeof MADE / sizeof *MADE && !used; k++) {
    snprintf(name, sizeof name, "%s%.50s%s", MADE[k][0], stem, MADE[k][1]);
    used = is_taken(p, name);
  }
  return used;
}

/* Makes the stem for all names that replace a source: the source's key, or that with "_2", ...
 * appended, so that STEM_on, Egate_STEM and the like are free. */
static void name_stem(const vs_fate *p, const vs_element *source, char stem[VS_ELEMENTS_NAME]) {
  snprintf(stem, VS_ELEMENTS_NAME, "%.44s", source->key);
  for (int k = 2; is_stem_used(p, source, stem); k++)
    snprintf(stem, VS_ELEMENTS_NAME, "%.40s_%d", source->key, k);
}

/* ---- elements ---- */

bool vs_fate_is_coil(const vs_fate *p, const vs_element *e) {
  return e == p->roles->coil || e == p->roles->coil_r;
}

const vs_fate_element *vs_fate_of(const vs_fate *p, const vs_element *e) {
  return &p->of[e - p->wiring->elements];
}

/* ---- models ---- */

/* Error: the model or subcircuit of an element is defined nowhere, and no part has its name. */
static vs_status check_model(const vs_fate *p, const vs_element *e, const vs_pins *pins,
                             vs_error *err) {
  char *model = vs_elements_model(p->wiring, e);
  double number;
  vs_status status = VS_OK;
  bool wanted =
      model && *model && !*pins->part && !vs_values_number(p->values, vs_words_of(model), &number);
  if (wanted && vs_elements_defined(p->wiring->listing, vs_words_of(model)) < 0)
    status = vs_fail_at(err, vs_elements_where(p->wiring, e, 0),
                        "%s: %s '%s' is defined nowhere; write it into the netlist, or name the "
                        "file that has it by --library FILE",
                        e->name, e->letter == 'x' ? "subcircuit" : "model", model);
  free(model);
  return status;
}

/* Error: ngspice would read the element as something other than the netlist's author meant. */
static vs_status check_element(const vs_fate *p, const vs_element *e, vs_error *err) {
  const vs_elements *w = p->wiring;
  vs_where where = vs_elements_where(w, e, 0);
  const vs_word word = vs_elements_word(e, e->n_nodes + 1);
  const char *text = w->listing->cards[e->card].text, *behind = word.at + word.n;
  vs_status status = VS_OK;
  double number;
  bool passive = strchr("rcl", e->letter) != NULL;
  if (passive && *behind == ',' && isdigit((unsigned char)behind[1]))
    status = vs_fail_at(err, where, "%s: '%.*s%.*s': the decimal sign is a point", e->name,
                        (int)word.n, word.at, (int)strcspn(behind, " \t"), behind);
  else if (passive && isalpha((unsigned char)*word.at) && !strpbrk(text, "={'") &&
           e->n_words == e->n_nodes + 2 && !vs_values_of(p->values, word, &number) &&
           vs_elements_defined(w->listing, word) < 0)
    status = vs_fail_at(err, where, "%s: '%.*s' is no value: write a number there, as 4.7k",
                        e->name, (int)word.n, word.at);
  else if (e->letter == 'u')
    status = vs_fail_at(err, where,
                        "%s: with U begin PSpice's digital parts, which ngspice does not have: "
                        "write what it does as a source, E1 out 0 VALUE={IF(V(in)>2.5, 5, 0)}; a "
                        "subcircuit's name begins with X, as KiCad's symbols with a simulation "
                        "model do",
                        e->name);
  else if (strchr("vi", e->letter) && strcasestr(text, "stimulus"))
    status = vs_fail_at(err, where,
                        "%s: the stimulus was drawn in PSpice's editor; write it as PULSE(...), "
                        "PWL(...) or SIN(...)",
                        e->name);
  return status;
}

/* ---- parameters ---- */

/* Adds the parameters that are the heights of the gates' pulses. */
static void add_levels(vs_fate *p) {
  for (size_t g = 0; g < p->roles->n_gates; g++) {
    const vs_roles_gate *gate = &p->roles->gates[g];
    vs_fate_element *own = &p->of[gate->source - p->wiring->elements];
    char wanted[VS_DECK_NAME];
    snprintf(wanted, sizeof wanted, "%.50s_level", gate->source->key);
    vs_declared_name(&p->sheet, wanted, own->level);
    vs_declared_param(&p->sheet, own->level, gate->source->letter,
                      gate->pulse.high - gate->pulse.low, "height of its pulses");
  }
}

/* The letter of the R, C or L whose value is this parameter alone; '\0': there is none. */
static char letter_of_use(const vs_fate *p, const char *name) {
  for (size_t k = 0; k < p->wiring->count; k++) {
    const vs_element *e = &p->wiring->elements[k];
    if (!strchr("rcl", e->letter)) continue;
    vs_word word = vs_elements_word(e, e->n_nodes + 1);
    if (*word.at == '{') word = (vs_word){word.at + 1, word.n - 1 - (word.at[word.n - 1] == '}')};
    if (vs_words_is(word, name)) return e->letter;
  }
  return '\0';
}

/* True where the text uses this name as a whole word, other than to assign a value to it. */
static bool names(vs_word text, const char *name) {
  const size_t n = strlen(name);
  for (const char *s = text.at; (s = vs_words_find(text.at, s, name, n)); s++)
    if (s < text.at + text.n && !vs_words_is_given(s + n)) return true;
  return false;
}

/* For an element that the program takes over: true where its Rser, Rpar or Cpar, which LTspice puts
 * into a source or across a coil and which the deck keeps, uses the name. */
static bool names_in_parts(const vs_fate *p, const vs_element *e, const char *name) {
  static const char *const PARTS[] = {"rser", "rpar", "cpar"};
  bool found = false;
  for (size_t k = 0; k < sizeof PARTS / sizeof *PARTS && !found; k++)
    found = names(vs_elements_option(p->wiring, e, PARTS[k]), name);
  return found;
}

/* True where the part of the element that the deck keeps uses the name. */
static bool is_used_in_element(const vs_fate *p, const vs_element *e, const char *name) {
  bool taken = vs_fate_is_coil(p, e) || e == p->roles->mains || vs_roles_gate_of(p->roles, e) >= 0;
  return taken ? names_in_parts(p, e, name) : names(vs_elements_rest(e, e->n_nodes + 1), name);
}

/* True where a line that the deck keeps uses the parameter; its own line does not count. */
static bool is_used(const vs_fate *p, const vs_value_param *v) {
  const vs_listing *l = p->wiring->listing;
  bool used = false;
  for (size_t k = 0; k < l->count && !used; k++)
    used = k != v->card && l->cards[k].kind == VS_CARD_STATEMENT &&
           !vs_listing_is(&l->cards[k], ".tran") && names(vs_words_of(l->cards[k].text), v->name);
  for (size_t k = 0; k < l->count && !used; k++)
    used = l->cards[k].kind == VS_CARD_ELEMENT && (l->cards[k].depth > 0 || l->cards[k].included) &&
           names(vs_words_of(l->cards[k].text), v->name);
  for (size_t k = 0; k < p->wiring->count && !used; k++)
    used = is_used_in_element(p, &p->wiring->elements[k], v->name);
  for (size_t k = 0; k < p->values->count && !used; k++) /* another parameter on the same line */
    used = &p->values->item[k] != v && p->values->item[k].card == v->card &&
           names(vs_words_of(p->values->item[k].text), v->name);
  return used;
}

/* True for a statement that makes no part of the circuit, and for a .func line, which is looked at
 * separately. */
static bool is_left_out(const vs_card *c) {
  static const char *const WORDS[] = {".tran", ".meas", ".measure", ".step", ".func"};
  return VS_WORDS_AMONG(vs_words_at(c->text), WORDS);
}

/* True where a statement at the netlist's top level uses the name; v(NAME) of a node does not
 * count. */
static bool is_used_in_statement(const vs_card *c, const char *name) {
  static const char *const WORDS[] = {".model", ".ic", ".nodeset", ".if", ".elseif"};
  const bool counts = VS_WORDS_AMONG(vs_words_at(c->text), WORDS);
  for (const char *s = c->text; counts && (s = vs_words_find(c->text, s, name, strlen(name)));
       s++) {
    bool node = s - c->text > 1 && s[-1] == '(' && strchr("vV", s[-2]);
    if (!node && names(vs_words_of(s), name)) return true;
  }
  return false;
}

/* True where a line of a subcircuit or a library uses the name, and that subcircuit has no
 * parameter of its own that hides it. */
static bool is_used_within(const vs_fate *p, const char *name) {
  const vs_listing *l = p->wiring->listing;
  for (size_t k = 0; k < l->count; k++) {
    const vs_card *c = &l->cards[k];
    bool within = c->depth > 0 || c->included;
    if (!within || !names(vs_words_of(c->text), name)) continue;
    if (c->kind == VS_CARD_STATEMENT ? is_left_out(c) : c->kind != VS_CARD_ELEMENT) continue;
    size_t scope = l->netlist.card[k].scope;
    while (l->netlist.scope[scope].outer) scope = l->netlist.scope[scope].outer;
    const char *own =
        scope ? vs_words_find(l->cards[l->netlist.scope[scope].first - 1].text,
                              l->cards[l->netlist.scope[scope].first - 1].text, name, strlen(name))
              : NULL;
    if (!own || !vs_words_is_given(own + strlen(name))) return true;
  }
  return false;
}

/* True where a function of the netlist uses the name and has no argument of that name. */
static bool is_used_in_functions(const vs_fate *p, const char *name) {
  const vs_listing *l = p->wiring->listing;
  for (size_t k = 0; k < l->count; k++) {
    const vs_card *c = &l->cards[k];
    const char *body = strchr(c->text, ')'),
               *argument = vs_words_find(c->text, c->text, name, strlen(name));
    if (c->kind == VS_CARD_STATEMENT && vs_listing_is(c, ".func") && body &&
        names(vs_words_of(body), name) && !(argument && argument < body))
      return true;
  }
  return false;
}

/* True where the deck will use the parameter: in an element that stays, a .model, a function, or
 * another parameter that is itself used. seen: for each parameter of the netlist, whether it was
 * looked at already; all false at first. left: how many more parameters are looked at, as each look
 * goes through the whole netlist; beyond that the answer is true. */
static bool is_used_by_deck(const vs_fate *p, const char *name, bool *seen, int *left) {
  const vs_listing *l = p->wiring->listing;
  bool used = is_used_within(p, name) || is_used_in_functions(p, name);
  for (size_t k = 0; k < l->count && !used; k++)
    used = l->cards[k].kind == VS_CARD_STATEMENT && is_used_in_statement(&l->cards[k], name);
  for (size_t k = 0; k < p->wiring->count && !used; k++)
    used = is_used_in_element(p, &p->wiring->elements[k], name);
  for (size_t k = 0; k < p->values->count && !used; k++) {
    if (seen[k] || !names(vs_words_of(p->values->item[k].text), name)) continue;
    seen[k] = true;
    used = --*left < 0 || is_used_by_deck(p, p->values->item[k].name, seen, left);
  }
  return used;
}

/* True where the program gives every deck a parameter of this name with the same value as the
 * netlist's. This is noted. */
static bool is_as_ours(vs_fate *p, const vs_value_param *v) {
  const vs_roles *r = p->roles;
  const struct {
    int standard;
    const char *key;
    double value;
  } OURS[] = {{VS_STANDARD_U_RMS, "voltage", r->mains ? r->rms_v : NAN},
              {VS_STANDARD_F_MAINS, "frequency", r->mains ? r->hz : NAN},
              {VS_STANDARD_PHASE, "phase", r->mains ? r->phase_deg * M_PI / 180 : NAN}};
  for (size_t k = 0; k < sizeof OURS / sizeof *OURS && v->known; k++)
    if (!strcmp(v->name, vs_deck_standard_names[OURS[k].standard]) &&
        fabs(v->value - OURS[k].value) <= 1e-9 * fabs(v->value)) {
      vs_declared_note(&p->sheet.did,
                       "line %d: %s is the program's own by that name, and has the same value: it "
                       "follows the scene's supply.%s",
                       p->wiring->listing->cards[v->card].where.line, v->name, OURS[k].key);
      return true;
    }
  return false;
}

/* True for the mains' resistance or inductance: the scene takes the netlist's value, which a note
 * tells, and gives it to the deck. */
static bool is_of_scene(vs_fate *p, const vs_value_param *v) {
  bool supply = !strcmp(v->name, vs_deck_standard_names[VS_STANDARD_R_SOURCE]) ||
                !strcmp(v->name, vs_deck_standard_names[VS_STANDARD_L_SOURCE]);
  if (!supply || !v->known) return false;
  vs_declared_note(&p->sheet.did,
                   "line %d: %s is the program's own by that name: the scene's supply.%s has its "
                   "%.6g, and gives it to the deck",
                   p->wiring->listing->cards[v->card].where.line, v->name,
                   *v->name == 'r' ? "resistance" : "inductance", v->value);
  return true;
}

enum { MOST_LOOKS = 64 };

/* Error, with its place: the deck would use a parameter of the netlist to which the program gives
 * another value in every deck. */
static vs_status check_standard(vs_fate *p, const vs_value_param *v, vs_error *err) {
  const vs_card *card = &p->wiring->listing->cards[v->card];
  if (!vs_deck_is_standard(v->name) || vs_values_find(p->values, v->name) != v) return VS_OK;
  bool *seen = vs_alloc(p->values->count, sizeof *seen);
  int left = MOST_LOOKS;
  bool used = is_used_by_deck(p, v->name, seen, &left);
  free(seen);
  if (!used || is_as_ours(p, v) || is_of_scene(p, v)) return VS_OK;
  const char *at = vs_words_find(card->text, card->text, v->name, strlen(v->name));
  return vs_fail_at(err, at ? vs_listing_place(card, at) : card->where,
                    "parameter %s is the program's, which has another value; give the netlist's "
                    "another name, as %s_2, here and where it is used",
                    v->name, v->name);
}

/* The netlist's parameters that are numbers become parameters of the deck. Those that only
 * described what the program takes over, such as the mains' peak, are dropped. */
static void add_params(vs_fate *p) {
  for (size_t k = 0; k < p->values->count; k++) {
    const vs_value_param *v = &p->values->item[k];
    const vs_card *card = &p->wiring->listing->cards[v->card];
    char name[VS_DECK_NAME];
    if (vs_values_find(p->values, v->name) != v || vs_deck_is_standard(v->name)) continue;
    vs_declared_name(&p->sheet, v->name, name);
    if (v->number && !card->included && is_used(p, v))
      vs_declared_param(&p->sheet, name, letter_of_use(p, v->name), v->value, "of the netlist");
  }
}

/* ---- senses ---- */

static void set_senses(vs_fate *p, const vs_element *e, vs_fate_element *own) {
  bool known = own->pins.kind, no_formula = strchr("r", e->letter) && !own->value;
  bool source = e->letter == 'v' || vs_roles_gate_of(p->roles, e) >= 0;
  if ((!known && !strchr("cbefghi", e->letter) && !no_formula) || source || vs_fate_is_coil(p, e))
    return;
  own->sensed_at = known ? own->pins.from : 0;
  name_free(p, "Vi_", e->key, "", own->sense);
  name_free(p, "", e->key, "_in", own->inner);
  if (e->letter != 'x' || own->pins.gate < 0) return;
  name_free(p, "Vg_", e->key, "", own->gate_sense);
  name_free(p, "", e->key, "_g", own->gate_inner);
}

/* Names the parameter that selects a part: after the part's kind, or after the element where
 * several parts are of that kind. */
static void set_part(vs_fate *p, const vs_element *e, vs_fate_element *own) {
  size_t count = 0;
  if (!*own->pins.part || !own->pins.kind) return;
  for (size_t k = 0; k < p->wiring->count; k++) {
    const vs_pins *other = &p->of[k].pins;
    count += other->kind && *other->part && !strcmp(other->kind, own->pins.kind);
  }
  vs_declared_name(&p->sheet, count == 1 ? own->pins.kind : e->key, own->part);
  if (!vs_declared_add(&p->sheet, VS_DECLARED_PARAM, "%s = %s part %s \"%s\"", own->part,
                       own->pins.part, own->pins.kind, e->name))
    *own->part = '\0';
}

const char *vs_fate_coil_current(const vs_fate *p, const char *text) {
  const char *said = p->wiring->listing->cards[p->roles->coil->card].text;
  size_t n = strcspn(said, " \t");
  for (const char *s = text; (s = vs_words_find(text, s, said, n)); s += n)
    if (s > text + 1 && s[-1] == '(' && strchr("iI", s[-2]) && s[n] == ')') return s - 2;
  return NULL;
}

/* True where an element's expression asks for the current of the coil. */
static bool asks_for_coil(const vs_fate *p) {
  const vs_elements *w = p->wiring;
  for (size_t k = 0; k < w->count; k++) {
    const char *text = w->listing->cards[w->elements[k].card].text;
    if (!strchr("befghi", w->elements[k].letter)) continue;
    if (p->roles->coil && vs_fate_coil_current(p, text)) return true;
  }
  return false;
}

static void name_functions(vs_fate *p) {
  const vs_cards *c = &p->wiring->listing->netlist;
  char name[VS_VALUES_NAME], kept[VS_DECK_NAME];
  for (size_t k = 0; k < c->n_definitions; k++) {
    if (c->definition[k].kind != VS_CARDS_FUNC) continue;
    snprintf(name, sizeof name, "%.*s", (int)c->definition[k].name.n, c->definition[k].name.at);
    vs_declared_name(&p->sheet, name, kept);
  }
}

/* Names what replaces the sources and the coil. Names of the netlist's functions are reserved, so
 * that no parameter gets them. */
static void name_all(vs_fate *p) {
  const vs_elements *w = p->wiring;
  for (size_t k = 0; k < w->count; k++) {
    const vs_element *e = &w->elements[k];
    if (e == p->roles->mains || vs_roles_gate_of(p->roles, e) >= 0) name_stem(p, e, p->of[k].stem);
  }
  name_free(p, "", "i_sum", "", p->sum);
  name_free(p, "", "Xeva", "", p->eva);
  if (asks_for_coil(p)) {
    name_free(p, "Vi_", p->roles->coil->key, "", p->eva_sense);
    name_free(p, "", p->roles->coil->key, "_in", p->eva_in);
  }
  name_functions(p);
}

vs_status vs_fate_make(vs_fate *p, const char *asked, vs_error *err) {
  const vs_elements *w = p->wiring;
  vs_status status = vs_error_keep(err, vs_pins_check(w, asked, err));
  p->of = vs_alloc(w->count + 1, sizeof *p->of);
  for (size_t k = 0; k < w->count && !status; k++) {
    const vs_element *e = &w->elements[k];
    status = vs_error_keep(err, vs_pins_find(w, asked, e, &p->of[k].pins, err));
    if (!status) status = vs_error_keep(err, check_model(p, e, &p->of[k].pins, err));
    if (!status) status = vs_error_keep(err, check_element(p, e, err));
  }
  for (size_t k = 0; k < p->values->count && !status; k++)
    status = vs_error_keep(err, check_standard(p, &p->values->item[k], err));
  if (status) return status;
  name_all(p);
  add_params(p);
  add_levels(p);
  for (size_t k = 0; k < w->count; k++) {
    const vs_element *e = &w->elements[k];
    if (strchr("rcl", e->letter) && !vs_fate_is_coil(p, e)) set_value(p, e, &p->of[k]);
    set_part(p, e, &p->of[k]);
    set_senses(p, e, &p->of[k]);
  }
  return VS_OK;
}

void vs_fate_free(vs_fate *p) {
  for (size_t k = 0; p->of && k < p->wiring->count; k++) free(p->of[k].value);
  free(p->of);
  vs_declared_free(&p->sheet);
  *p = (vs_fate){0};
}
