/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "elements.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

/* An element of the circuit, with the instance that it stands in. */
typedef struct placed {
  vs_parameters *in;
  size_t card;
  int branch; /* the unknown that is its current; -1: it has none */
} placed;

typedef struct making {
  const vs_circuit_job *job;
  const vs_cards *cards;
  vs_equations *e;
  placed *element;
  size_t elements;
  vs_parameters **instance; /* owned */
  size_t instances;
  vs_error *err;
} making;

/* ---- unknowns ---- */

static int add_unknown(making *m, const char *name) {
  vs_equations *e = m->e;
  size_t number;
  if (vs_names_find(&e->number, name, strlen(name), &number)) return (int)number;
  e->name = vs_alloc_grow(e->name, (size_t)e->n, sizeof *e->name);
  e->name[e->n] = vs_copy(name);
  vs_names_put(&e->number, name, strlen(name), (size_t)e->n);
  return e->n++;
}

static char *node_name(const making *m, const vs_parameters *in, vs_word node) {
  vs_text t = {0};
  vs_text_add(&t, "v(");
  vs_cards_add_node(m->cards, &in->in, node, &t);
  vs_text_add(&t, ")");
  return t.text;
}

/* "i(vs)" of the circuit, "i(v.x1.vs)" in an instance. */
static char *current_name(const vs_parameters *in, vs_word name) {
  vs_text t = {0};
  vs_text_add(&t, in->in.outer ? "i(%c." : "i(", *name.at | 0x20);
  vs_cards_add_name(&in->in, name, &t);
  vs_text_add(&t, ")");
  return t.text;
}

static int node(making *m, const vs_parameters *in, vs_word word) {
  char *name = node_name(m, in, word);
  int k = strcmp(name, "v(0)") ? add_unknown(m, name) : -1;
  free(name);
  return k;
}

static int node_of_program(void *ctx, const vs_parameters *in, vs_word word) {
  const making *m = ctx;
  char *name = node_name(m, in, word);
  int k = vs_equations_signal(m->e, name);
  free(name);
  return k;
}

static int current_of_program(void *ctx, const vs_parameters *in, vs_word word) {
  const making *m = ctx;
  char *name = current_name(in, word);
  int k = vs_equations_signal(m->e, name);
  free(name);
  return k == -1 ? -2 : k;
}

/* ---- entries ---- */

static void add_entry(vs_entry **list, int *count, int row, int column, double value) {
  if (row < 0 || column < 0 || value == 0) return;
  *list = vs_alloc_grow(*list, (size_t)*count, sizeof **list);
  (*list)[(*count)++] = (vs_entry){row, column, -1, value};
}

static void add_linear(making *m, int row, int column, double value) {
  add_entry(&m->e->linear, &m->e->linears, row, column, value);
}

static void add_mass(making *m, int row, int column, double value) {
  add_entry(&m->e->mass, &m->e->masses, row, column, value);
}

/* A current of g times the voltage from c to d, from node a to node b. */
static void add_conductance(making *m, int a, int b, int c, int d, double g) {
  add_linear(m, a, c, -g);
  add_linear(m, a, d, g);
  add_linear(m, b, c, g);
  add_linear(m, b, d, -g);
}

/* The current of a branch leaves a and comes back to b; its row begins as v(a) - v(b). */
static void add_branch(making *m, int a, int b, int branch) {
  add_linear(m, a, branch, -1);
  add_linear(m, b, branch, 1);
  add_linear(m, branch, a, 1);
  add_linear(m, branch, b, -1);
}

/* factor x (a source, or what is constant: where it has neither port nor course). */
static void add_source(making *m, int row, vs_compiled_source source, double constant) {
  if (row < 0) return;
  if (source.port < 0 && source.course < 0) {
    m->e->level[row] += source.factor * constant;
    return;
  }
  source.row = row;
  m->e->source = vs_alloc_grow(m->e->source, (size_t)m->e->sources, sizeof *m->e->source);
  m->e->source[m->e->sources++] = source;
}

static vs_compiled_device *add_device(making *m, int kind) {
  vs_equations *e = m->e;
  e->device = vs_alloc_grow(e->device, (size_t)e->devices, sizeof *e->device);
  e->device[e->devices] =
      (vs_compiled_device){.kind = kind, .branch = -1, .charge = {-1, -1}, .factor = 1};
  return &e->device[e->devices++];
}

/* ---- elements ---- */

static vs_word word_of(const making *m, const placed *p, size_t n) {
  return vs_cards_word(m->cards, &m->cards->card[p->card], n);
}

static vs_status value_of(const making *m, const placed *p, vs_word word, double *value) {
  if (!word.n) return vs_fail(m->err, VS_INPUT, "a value is missing");
  return vs_parameters_of(m->cards, p->in, word, value, m->err);
}

/* The value of NAME=, or of the word in that place. */
static vs_status value_or(const making *m, const placed *p, const char *name, size_t n,
                          double *value) {
  vs_word w = vs_cards_value(m->cards, &m->cards->card[p->card], name);
  return value_of(m, p, w.n ? w : word_of(m, p, n), value);
}

static vs_status initial_of(const making *m, const placed *p, double *value) {
  vs_word w = vs_cards_value(m->cards, &m->cards->card[p->card], "ic");
  *value = 0;
  return w.n ? value_of(m, p, w, value) : VS_OK;
}

/* Error: the element has a parameter that is not among these, which are parted by blanks. */
static vs_status allow_only(const making *m, const placed *p, const char *names) {
  const vs_netlist_card *card = &m->cards->card[p->card];
  for (size_t k = card->first; k < card->first + card->count; k++) {
    const vs_argument *a = &m->cards->arguments[k];
    if (a->name.n && !vs_words_find(names, names, a->name.at, a->name.n))
      return vs_fail(m->err, VS_INPUT, "the parameter '%.*s' is not known here", (int)a->name.n,
                     a->name.at);
  }
  return VS_OK;
}

static int pin(making *m, const placed *p, size_t n) {
  return node(m, p->in, word_of(m, p, n));
}

static vs_status add_resistor(making *m, const placed *p) {
  double r;
  vs_status status = allow_only(m, p, "r");
  if (!status) status = value_or(m, p, "r", 2, &r);
  if (!status && r == 0) status = vs_fail(m->err, VS_INPUT, "a resistance of 0");
  if (status) return status;
  int a = pin(m, p, 0), b = pin(m, p, 1);
  add_conductance(m, a, b, a, b, 1 / r);
  return VS_OK;
}

static vs_status add_capacitor(making *m, const placed *p) {
  double c, v;
  vs_status status = allow_only(m, p, "c ic");
  if (!status) status = value_or(m, p, "c", 2, &c);
  if (!status) status = initial_of(m, p, &v);
  if (status) return status;
  int a = pin(m, p, 0), b = pin(m, p, 1);
  add_mass(m, a, a, c);
  add_mass(m, a, b, -c);
  add_mass(m, b, a, -c);
  add_mass(m, b, b, c);
  if (a >= 0) m->e->charge[a] += c * v;
  if (b >= 0) m->e->charge[b] -= c * v;
  return VS_OK;
}

static vs_status add_inductor(making *m, const placed *p) {
  double l, i;
  vs_status status = allow_only(m, p, "l ic");
  if (!status) status = value_or(m, p, "l", 2, &l);
  if (!status) status = initial_of(m, p, &i);
  if (status) return status;
  add_branch(m, pin(m, p, 0), pin(m, p, 1), p->branch);
  add_mass(m, p->branch, p->branch, l);
  m->e->charge[p->branch] += l * i;
  return VS_OK;
}

static const placed *find_element(const making *m, const placed *beside, vs_word name) {
  for (size_t k = 0; k < m->elements; k++)
    if (m->element[k].in == beside->in &&
        !vs_words_compare(m->cards->card[m->element[k].card].name, name))
      return &m->element[k];
  return NULL;
}

/* K couples two inductors: M = k sqrt(L1 L2). */
static vs_status add_coupling(making *m, const placed *p) {
  const vs_netlist_card *card = &m->cards->card[p->card];
  double k, l[2], i[2];
  const placed *of[2];
  if (card->words != 3) return vs_fail(m->err, VS_INPUT, "two inductors and a number are wanted");
  vs_status status = value_of(m, p, word_of(m, p, 2), &k);
  for (size_t n = 0; n < 2 && !status; n++) {
    of[n] = find_element(m, p, word_of(m, p, n));
    if (!of[n]) return vs_fail(m->err, VS_INPUT, "its inductor is not there");
    status = value_or(m, of[n], "l", 2, &l[n]);
    if (!status) status = initial_of(m, of[n], &i[n]);
  }
  if (status) return status;
  const double mutual = k * sqrt(l[0] * l[1]);
  for (int n = 0; n < 2; n++) {
    add_mass(m, of[n]->branch, of[1 - n]->branch, mutual);
    m->e->charge[of[n]->branch] += mutual * i[1 - n];
  }
  return VS_OK;
}

/* The port that drives an external source; -1: there is none. */
static int port_of(const making *m, const placed *p) {
  char *signal = current_name(p->in, m->cards->card[p->card].name);
  const char *name = signal + 2; /* without "i(" and ")" */
  int port = -1;
  for (size_t k = 0; k < m->job->n_ports; k++)
    if (strlen(m->job->ports[k]) == strlen(name) - 1 &&
        !strncmp(m->job->ports[k], name, strlen(name) - 1))
      port = (int)k;
  free(signal);
  return port;
}

/* A source that is the machine's gap or the like: it is linear in the machine's states. False: it
 * is another one. */
static bool add_of_machine(making *m, int row, int port, double factor) {
  const vs_circuit_machine *machine = &m->e->host->machine;
  double x[VS_MACHINE_STATES] = {0}, at_rest, value;
  if (row < 0 || port < 0 || !machine->port ||
      !machine->port(m->e->host->ctx, (size_t)port, x, &at_rest))
    return false;
  m->e->level[row] += factor * at_rest;
  for (int k = 0; k < m->e->states; k++) {
    x[k] = 1;
    machine->port(m->e->host->ctx, (size_t)port, x, &value);
    x[k] = 0;
    add_linear(m, row, m->e->machine + k, factor * (value - at_rest));
  }
  return true;
}

/* [[dc] VALUE] [COURSE ...]. A value before a course holds at an operating point alone. */
static vs_status read_course(making *m, const placed *p, vs_compiled_source *s, double *constant) {
  const vs_netlist_card *card = &m->cards->card[p->card];
  const size_t at = vs_words_is(word_of(m, p, 2), "dc") ? 3 : 2;
  const size_t course = vs_course_is(word_of(m, p, at)) ? at : at + 1;
  vs_status status = course > at ? value_of(m, p, word_of(m, p, at), constant) : VS_OK;
  if (status) return status;
  if (card->words > course && !vs_course_is(word_of(m, p, course)))
    return vs_fail(m->err, VS_INPUT, "'%.*s' is not known here", (int)word_of(m, p, course).n,
                   word_of(m, p, course).at);
  if (card->words <= course) return allow_only(m, p, "");
  vs_equations *e = m->e;
  e->course = vs_alloc_grow(e->course, (size_t)e->courses, sizeof *e->course);
  s->course = e->courses++;
  return vs_course_read(m->cards, p->in, card, course, &e->course[s->course], m->err);
}

/* V and I: external, a constant, or a course over time. */
static vs_status add_independent(making *m, const placed *p) {
  const vs_netlist_card *card = &m->cards->card[p->card];
  const bool external = vs_cards_is_external(m->cards, card);
  int a = pin(m, p, 0), b = pin(m, p, 1);
  vs_compiled_source s = {.port = external ? port_of(m, p) : -1, .factor = -1, .course = -1};
  if (external && s.port < 0) return vs_fail(m->err, VS_INPUT, "nothing drives it");
  double constant = 0;
  vs_status status = external ? VS_OK : read_course(m, p, &s, &constant);
  if (status) return status;
  if (card->letter == 'v') {
    add_branch(m, a, b, p->branch);
    if (!add_of_machine(m, p->branch, s.port, -1)) add_source(m, p->branch, s, constant);
  } else {
    if (!add_of_machine(m, a, s.port, -1)) add_source(m, a, s, constant);
    s.factor = 1;
    if (!add_of_machine(m, b, s.port, 1)) add_source(m, b, s, constant);
  }
  return VS_OK;
}

/* A current, or the voltage of a branch, by an expression. */
static vs_status add_program(making *m, const placed *p, vs_word text, double factor) {
  const vs_program_scope scope = {m, node_of_program, current_of_program};
  int a = pin(m, p, 0), b = pin(m, p, 1);
  vs_compiled_device *d = add_device(m, VS_DEVICE_PROGRAM);
  d->pin[0] = a;
  d->pin[1] = b;
  d->factor = factor;
  d->branch = p->branch;
  if (d->branch >= 0) add_branch(m, a, b, p->branch);
  return vs_program_read(m->cards, p->in, text, &scope, &d->program, m->err);
}

static vs_status add_expression(making *m, const placed *p) {
  const vs_netlist_card *card = &m->cards->card[p->card];
  vs_word current = vs_cards_value(m->cards, card, "i"),
          times = vs_cards_value(m->cards, card, "m");
  double factor = 1;
  vs_status status = allow_only(m, p, "i v m");
  if (!status && times.n) status = value_of(m, p, times, &factor);
  if (status) return status;
  return add_program(m, p, current.n ? current : vs_cards_value(m->cards, card, "v"), factor);
}

/* POLY(n) with n voltages or currents, and its coefficients: those of 1, x, y, x^2, x y, y^2 and so
 * on. */
enum { DEGREES = 16 };

static vs_status add_polynomial(making *m, const placed *p, bool by_voltage) {
  const vs_netlist_card *card = &m->cards->card[p->card];
  const size_t each = by_voltage ? 2 : 1, of = card->words - 3;
  double n = 0, k;
  size_t factor[DEGREES] = {0}, degree = 0; /* of the next term: the variables, in rising order */
  vs_text text = {0};
  vs_status status = value_of(m, p, word_of(m, p, 3), &n);
  const size_t inputs = n >= 1 && n * (double)each < (double)of ? (size_t)n : 0;
  const size_t first = 4 + each * inputs;
  if (status || !inputs || card->count != card->words)
    return vs_fail(m->err, VS_INPUT, "POLY(n), n inputs and numbers are wanted");
  for (size_t at = first; at < card->words && !status; at++) {
    status = value_of(m, p, word_of(m, p, at), &k);
    vs_text_add(&text, "+(%.17g)", k);
    for (size_t l = 0; l < degree; l++) {
      const vs_word a = word_of(m, p, 4 + each * factor[l]),
                    b = word_of(m, p, 5 + each * factor[l]);
      if (by_voltage)
        vs_text_add(&text, "*v(%.*s,%.*s)", (int)a.n, a.at, (int)b.n, b.at);
      else
        vs_text_add(&text, "*i(%.*s)", (int)a.n, a.at);
    }
    size_t last = degree;
    while (last && factor[last - 1] == inputs - 1) last--;
    const size_t next = last ? factor[last - 1] + 1 : 0;
    if (!last && ++degree > DEGREES)
      status = vs_fail(m->err, VS_INPUT, "POLY has a degree above %d", DEGREES);
    for (size_t l = last ? last - 1 : 0; l < degree && !status; l++) factor[l] = next;
  }
  if (!status) status = add_program(m, p, vs_words_of(text.text), 1);
  vs_text_free(&text);
  return status;
}

/* E and G, by a voltage or an expression. */
static vs_status add_by_voltage(making *m, const placed *p) {
  static const char *const FORMULAS[] = {"value", "vol", "cur"};
  const vs_netlist_card *card = &m->cards->card[p->card];
  double gain;
  for (size_t k = 0; k < sizeof FORMULAS / sizeof *FORMULAS; k++) {
    const vs_word text = vs_cards_value(m->cards, card, FORMULAS[k]);
    if (text.n && card->words == 2 && card->count == 3) return add_program(m, p, text, 1);
  }
  if (vs_words_is(word_of(m, p, 2), "poly")) return add_polynomial(m, p, true);
  if (card->nodes != 4 || card->words != 5 || card->count != 5)
    return vs_fail(m->err, VS_INPUT, "only a gain, VALUE={...} and POLY are known here");
  vs_status status = value_of(m, p, word_of(m, p, 4), &gain);
  if (status) return status;
  int a = pin(m, p, 0), b = pin(m, p, 1), c = pin(m, p, 2), d = pin(m, p, 3);
  if (card->letter == 'g') {
    add_conductance(m, a, b, c, d, gain);
  } else {
    add_branch(m, a, b, p->branch);
    add_linear(m, p->branch, c, -gain);
    add_linear(m, p->branch, d, gain);
  }
  return VS_OK;
}

/* F and H, by the currents of sources. */
static vs_status add_by_current(making *m, const placed *p) {
  const vs_netlist_card *card = &m->cards->card[p->card];
  double gain;
  if (vs_words_is(word_of(m, p, 2), "poly")) return add_polynomial(m, p, false);
  if (card->words != 4 || card->count != 4)
    return vs_fail(m->err, VS_INPUT, "only a gain of one current and POLY are known here");
  int control = current_of_program(m, p->in, word_of(m, p, 2));
  if (control < 0) return vs_fail(m->err, VS_INPUT, "its source is not there");
  vs_status status = value_of(m, p, word_of(m, p, 3), &gain);
  if (status) return status;
  int a = pin(m, p, 0), b = pin(m, p, 1);
  if (card->letter == 'f') {
    add_linear(m, a, control, -gain);
    add_linear(m, b, control, gain);
  } else {
    add_branch(m, a, b, p->branch);
    add_linear(m, p->branch, control, -gain);
  }
  return VS_OK;
}

/* The card of an element's .model, and where its values are to be read. */
static const vs_netlist_card *model_of(const making *m, const placed *p, const char *types,
                                       vs_parameters **in) {
  const vs_netlist_card *card = &m->cards->card[p->card];
  for (*in = p->in; *in; *in = (*in)->caller) {
    const vs_netlist_definition *d =
        vs_cards_resolve(m->cards, (*in)->in.scope, VS_CARDS_MODEL, card->model);
    if (!d) continue;
    const vs_netlist_card *model = &m->cards->card[d->card];
    /* what a model of the circuit itself names is the circuit's */
    while ((*in)->caller && (*in)->in.scope != model->scope) *in = (*in)->caller;
    if (vs_words_find(types, types, model->model.at, model->model.n)) return model;
    vs_fail(m->err, VS_INPUT, "a model of the type '%.*s' is not known here", (int)model->model.n,
            model->model.at);
    return NULL;
  }
  vs_fail(m->err, VS_INPUT, "its .model is not there");
  return NULL;
}

/* An inner node of an element, "x1.d1#inner". */
static int inner_node(making *m, const placed *p, const char *what) {
  vs_text t = {0};
  vs_cards_add_name(&p->in->in, m->cards->card[p->card].name, &t);
  vs_text_add(&t, "#%s", what);
  int k = add_unknown(m, t.text);
  vs_text_free(&t);
  return k;
}

/* Each charge q is an unknown of its own: 0 = q - Q(v), and q' leaves the first of its nodes. */
static int add_charge(making *m, const placed *p, const char *what, int from, int to) {
  int q = inner_node(m, p, what);
  add_linear(m, q, q, 1);
  add_mass(m, from, q, 1);
  add_mass(m, to, q, -1);
  return q;
}

static vs_status add_diode(making *m, const placed *p) {
  vs_parameters *in;
  vs_diode model;
  const vs_netlist_card *card = model_of(m, p, "d", &in);
  vs_status status = card ? vs_junction_diode(m->cards, in, card, &model, m->err) : VS_INPUT;
  if (!status) status = allow_only(m, p, "");
  if (status) return status;
  int a = pin(m, p, 0), k = pin(m, p, 1);
  if (model.resistance_ohm > 0) {
    int inner = inner_node(m, p, "inner");
    add_conductance(m, a, inner, a, inner, 1 / model.resistance_ohm);
    a = inner;
  }
  vs_compiled_device *d = add_device(m, VS_DEVICE_DIODE);
  d->diode = model;
  d->pin[0] = a;
  d->pin[1] = k;
  if (!(model.transit_s > 0)) return VS_OK;
  const int q = add_charge(m, p, "charge", a, k); /* tt i */
  m->e->device[m->e->devices - 1].charge[0] = q;
  return VS_OK;
}

static vs_status add_bipolar(making *m, const placed *p) {
  vs_parameters *in;
  vs_bipolar model;
  const vs_netlist_card *card = model_of(m, p, "npn pnp", &in);
  vs_status status = card ? vs_junction_bipolar(m->cards, in, card, &model, m->err) : VS_INPUT;
  if (!status) status = allow_only(m, p, "");
  if (status) return status;
  vs_compiled_device *d = add_device(m, VS_DEVICE_BIPOLAR);
  d->bipolar = model;
  for (size_t k = 0; k < 3; k++) d->pin[k] = pin(m, p, k);
  return VS_OK;
}

static vs_status add_mosfet(making *m, const placed *p) {
  vs_parameters *in;
  vs_vdmos model;
  const vs_netlist_card *card = model_of(m, p, "vdmos", &in);
  vs_status status = card ? vs_junction_vdmos(m->cards, in, card, &model, m->err) : VS_INPUT;
  if (!status) status = allow_only(m, p, "");
  if (!status && m->cards->card[p->card].nodes != 3)
    status = vs_fail(m->err, VS_INPUT, "only three nodes are known here");
  if (status) return status;
  const int d = pin(m, p, 0), g = pin(m, p, 1), s = pin(m, p, 2);
  const int gd = add_charge(m, p, "gd", g, d), ds = add_charge(m, p, "ds", s, d);
  add_mass(m, g, g, model.cgs_f);
  add_mass(m, g, s, -model.cgs_f);
  add_mass(m, s, g, -model.cgs_f);
  add_mass(m, s, s, model.cgs_f);
  vs_compiled_device *device = add_device(m, VS_DEVICE_VDMOS);
  device->vdmos = model;
  device->pin[0] = d;
  device->pin[1] = g;
  device->pin[2] = s;
  device->charge[0] = gd;
  device->charge[1] = ds;
  return VS_OK;
}

/* A switch with a hysteresis, S by a voltage or W by a current: it is on above vt + vh, or it + ih,
 * and off below vt - vh, or it - ih. */
static vs_status add_switch(making *m, const placed *p) {
  vs_parameters *in;
  double ron = 1, roff = 1e12, vt = 0, vh = 0;
  const vs_netlist_card *card = &m->cards->card[p->card], *model;
  const bool by_current = card->letter == 'w';
  if (!(model = model_of(m, p, by_current ? "csw" : "sw", &in))) return VS_INPUT;
  const struct {
    const char *name;
    double *value;
  } known[] = {{"ron", &ron},
               {"roff", &roff},
               {by_current ? "it" : "vt", &vt},
               {by_current ? "ih" : "vh", &vh}};
  for (size_t k = model->first; k < model->first + model->count; k++) {
    const vs_argument *a = &m->cards->arguments[k];
    size_t n = 0;
    if (!a->name.n) continue;
    while (n < 4 && !vs_words_is(a->name, known[n].name)) n++;
    if (n == 4)
      return vs_fail(m->err, VS_INPUT, "its model's parameter '%.*s' is not known here",
                     (int)a->name.n, a->name.at);
    vs_status status = vs_parameters_of(m->cards, in, a->value, known[n].value, m->err);
    if (status) return status;
  }
  const vs_word word = vs_cards_word(m->cards, card, by_current ? 4 : 5);
  const int current = by_current ? current_of_program(m, p->in, word_of(m, p, 2)) : -1;
  if (by_current && current < 0) return vs_fail(m->err, VS_INPUT, "its source is not there");
  if (vh < 0) return vs_fail(m->err, VS_INPUT, "a hysteresis below 0 is not known here");
  if (word.n && !vs_words_is(word, "on") && !vs_words_is(word, "off"))
    return vs_fail(m->err, VS_INPUT, "'%.*s' is not on or off", (int)word.n, word.at);
  vs_compiled_device *d = add_device(m, VS_DEVICE_SWITCH);
  for (size_t k = 0; k < 2; k++) d->pin[k] = pin(m, p, k);
  for (size_t k = 0; k < 2; k++) d->control[k] = by_current ? -1 : pin(m, p, 2 + k);
  if (by_current) d->control[0] = current;
  d->on_s = 1 / ron;
  d->off_s = 1 / roff;
  d->threshold = vt;
  d->hysteresis = vh;
  d->on = vs_words_is(word, "on");
  return VS_OK;
}

static const struct sort {
  char letter;
  vs_status (*add)(making *m, const placed *p);
  size_t words; /* at most, behind its name; 0: `add` counts them. Of a device with a model: the
                   model and no more behind its nodes */
  bool has_branch;
} SORTS[] = {{'r', add_resistor, 3, false},   {'c', add_capacitor, 3, false},
             {'l', add_inductor, 3, true},    {'k', add_coupling, 0, false},
             {'v', add_independent, 0, true}, {'i', add_independent, 0, false},
             {'e', add_by_voltage, 0, true},  {'g', add_by_voltage, 0, false},
             {'f', add_by_current, 0, false}, {'h', add_by_current, 0, true},
             {'b', add_expression, 2, false}, {'d', add_diode, 3, false},
             {'q', add_bipolar, 4, false},    {'s', add_switch, 6, false},
             {'w', add_switch, 5, false},     {'m', add_mosfet, 4, false}};

static const struct sort *sort_of(char letter) {
  for (size_t k = 0; k < sizeof SORTS / sizeof *SORTS; k++)
    if (SORTS[k].letter == letter) return &SORTS[k];
  return NULL;
}

/* ---- the whole ---- */

/* A complaint begins with the element's name, or the statement's word, and says which line it is.
 */
static vs_status blame(making *m, const placed *p) {
  const vs_netlist_card *card = &m->cards->card[p->card];
  vs_text name = {0};
  char why[512];
  snprintf(why, sizeof why, "%.500s", m->err->text);
  if (card->kind == VS_CARDS_ELEMENT)
    vs_cards_add_name(&p->in->in, card->name, &name);
  else
    vs_text_add(&name, "%.*s", (int)vs_words_at(m->cards->lines[p->card].text).n,
                m->cards->lines[p->card].text);
  vs_status status =
      vs_fail(m->err, VS_INPUT, "tier compiled: %s: %s; run.tier: circuit leaves it to ngspice",
              name.text, why);
  if (m->job->locate) m->job->locate(m->job->author, p->card, m->err);
  vs_text_free(&name);
  return status;
}

/* What an instance is called with must be parameters of its subcircuit: others, as m, mean
 * something to the solver. */
static vs_status check_instance(const making *m, const vs_netlist_card *card, size_t scope) {
  for (size_t k = card->first; k < card->first + card->count; k++) {
    const vs_word name = m->cards->arguments[k].name;
    if (name.n && !vs_cards_find(m->cards, scope, VS_CARDS_PARAM, name))
      return vs_fail(m->err, VS_INPUT, "its subcircuit has no parameter '%.*s'", (int)name.n,
                     name.at);
  }
  return VS_OK;
}

static vs_status check_words(const making *m, const vs_netlist_card *card, size_t most) {
  if (strchr("dqm", card->letter)) most = card->nodes + 1;
  const vs_word next = vs_cards_word(m->cards, card, most);
  if (!most || card->words <= most) return VS_OK;
  return vs_fail(m->err, VS_INPUT, "the word '%.*s' is not known here", (int)next.n, next.at);
}

/* True for a statement that makes another circuit: an initial voltage, or a choice between lines.
 * What a .nodeset says helps in the search for an operating point, and there is none here. */
static bool changes(const making *m, size_t line) {
  static const char *const WORDS[] = {".ic", ".if", ".elseif", ".else"};
  bool is = false;
  for (size_t k = 0; k < sizeof WORDS / sizeof *WORDS; k++)
    is = is || vs_words_is(vs_words_at(m->cards->lines[line].text), WORDS[k]);
  return is;
}

/* Lists the elements of an instance and of those within it, with the unknowns that they bring. */
static vs_status list_elements(making *m, vs_parameters *in) {
  const vs_netlist_scope *of = &m->cards->scope[in->in.scope];
  for (size_t k = of->first; k < of->last; k = vs_cards_next(m->cards, k)) {
    const vs_netlist_card *card = &m->cards->card[k];
    placed p = {in, k, -1};
    if (card->kind == VS_CARDS_IF || (card->kind == VS_CARDS_OTHER && changes(m, k))) {
      vs_fail(m->err, VS_INPUT, "the statement is not known here");
      return blame(m, &p);
    }
    if (card->kind != VS_CARDS_ELEMENT) continue;
    if (card->letter == 'x') {
      size_t scope = vs_cards_called(m->cards, card);
      if (!scope) vs_fail(m->err, VS_INPUT, "its subcircuit is not there");
      if (!scope || check_instance(m, card, scope)) return blame(m, &p);
      vs_parameters *inner = vs_alloc(1, sizeof *inner);
      *inner = (vs_parameters){.in = {&in->in, card, scope, in->in.depth + 1}, .caller = in};
      m->instance = vs_alloc_grow(m->instance, m->instances, sizeof *m->instance);
      m->instance[m->instances++] = inner;
      vs_status status = list_elements(m, inner);
      if (status) return status;
      continue;
    }
    const struct sort *sort = sort_of(card->letter);
    if (!sort)
      vs_fail(m->err, VS_INPUT, "an element %c is not known here", card->letter - 'a' + 'A');
    const bool twice = sort && find_element(m, &p, card->name);
    if (twice) vs_fail(m->err, VS_INPUT, "the circuit has two elements of that name");
    if (!sort || twice || check_words(m, card, sort->words)) return blame(m, &p);
    for (size_t n = 0; n < card->nodes; n++) node(m, in, vs_cards_word(m->cards, card, n));
    if (sort->has_branch || (card->letter == 'b' && !vs_cards_value(m->cards, card, "i").n)) {
      char *name = current_name(in, card->name);
      p.branch = add_unknown(m, name);
      free(name);
    }
    m->element = vs_alloc_grow(m->element, m->elements, sizeof *m->element);
    m->element[m->elements++] = p;
  }
  return VS_OK;
}

/* The machine's states are unknowns with a mass of 1. */
static void add_machine(making *m) {
  m->e->states = (int)m->e->host->machine.states;
  m->e->machine = m->e->n;
  for (int k = 0; k < m->e->states; k++) {
    char name[32];
    snprintf(name, sizeof name, "x#%d", k);
    const int x = add_unknown(m, name);
    add_mass(m, x, x, 1);
  }
}

static vs_status make_equations(making *m, vs_parameters *circuit) {
  add_machine(m);
  vs_status status = list_elements(m, circuit);
  if (status) return status;
  int unknowns = m->e->n + 2 * (int)m->elements; /* with the inner ones to come */
  m->e->charge = vs_alloc((size_t)unknowns, sizeof *m->e->charge);
  m->e->level = vs_alloc((size_t)unknowns, sizeof *m->e->level);
  for (size_t k = 0; k < m->elements; k++) {
    const placed *p = &m->element[k];
    m->err->text[0] = '\0';
    if (sort_of(m->cards->card[p->card].letter)->add(m, p)) return blame(m, p);
  }
  if (m->e->states)
    m->e->flux = vs_equations_signal(m->e, m->job->signals[m->e->host->machine.flux]);
  if (m->e->n > VS_MATRIX_MOST)
    return vs_fail(m->err, VS_INPUT,
                   "tier compiled: the circuit has %d unknowns, and at most %d are known here; "
                   "run.tier: circuit leaves it to ngspice",
                   m->e->n, VS_MATRIX_MOST);
  for (int k = 0; k < m->e->devices; k++)
    memcpy(m->e->device[k].row, m->e->device[k].pin, sizeof m->e->device[k].row);
  m->e->rows = m->e->follow = m->e->n;
  vs_equations_make_pattern(m->e);
  return VS_OK;
}

vs_status vs_elements_make(const vs_circuit_job *job, const vs_circuit_host *host, vs_equations *e,
                           vs_error *err) {
  vs_line *lines = vs_alloc(job->lines, sizeof *lines);
  vs_cards cards;
  vs_parameters circuit = {0};
  *e = (vs_equations){.host = host};
  for (size_t k = 0; k < job->lines; k++)
    vs_line_join(&lines[k], k ? job->netlist[k] : "* title", (vs_where){0});
  vs_cards_read(&cards, lines, job->lines);
  making m = {.job = job, .cards = &cards, .e = e, .err = err};
  circuit.pspice = *job->dialect != 0;
  vs_status status = make_equations(&m, &circuit);
  vs_cards_free(&cards);
  for (size_t k = 0; k < job->lines; k++) vs_line_free(&lines[k]);
  free(lines);
  for (size_t k = 0; k < m.instances; k++) {
    vs_parameters_free(m.instance[k]);
    free(m.instance[k]);
  }
  vs_parameters_free(&circuit);
  free(m.instance);
  free(m.element);
  return status;
}
