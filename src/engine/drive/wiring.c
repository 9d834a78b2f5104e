/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "drive/wiring.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"
#include "netlist/contract.h"
#include "netlist/words.h"

void vs_wiring_line(vs_deck *deck, vs_where where, const char *format, ...) {
  char text[512];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  vs_line line = {0};
  vs_line_join(&line, text, where);
  vs_deck_add_line(deck, line);
}

/* Adds a port of the event, with the source that it drives. */
static vs_status add_event_port(vs_deck *deck, const vs_scene_event *e, const vs_signal *signal,
                                const char *source, vs_error *err) {
  vs_port port = {.signal = *signal, .where = e->where};
  if (deck->n_ports >= VS_DECK_MOST)
    return vs_fail_at(err, e->where, "events.%s: more than %d ports", e->name, VS_DECK_MOST);
  snprintf(port.source, sizeof port.source, "v%s", source);
  deck->ports[deck->n_ports++] = port;
  return VS_OK;
}

vs_status vs_wiring_source(vs_deck *deck, const vs_scene_event *e, size_t index, const char *plus,
                           const char *minus, vs_error *err) {
  char name[VS_DECK_NAME - 1];
  snprintf(name, sizeof name, "vs_e%zu", index);
  const vs_signal signal = {.drive = VS_PORT_EVENT, .event = index};
  vs_status status = add_event_port(deck, e, &signal, name, err);
  if (!status) vs_wiring_line(deck, e->where, "V%s %s %s external", name, plus, minus);
  return status;
}

vs_status vs_wiring_on_line(vs_deck *deck, const vs_scene_event *e, size_t index, vs_error *err) {
  char name[VS_DECK_NAME - 1];
  snprintf(name, sizeof name, "vs_w%zu", index);
  const vs_signal signal = {.drive = VS_PORT_ON_LINE, .event = index};
  vs_status status = add_event_port(deck, e, &signal, name, err);
  if (!status) vs_wiring_line(deck, e->where, "V%s %s 0 external", name, name);
  return status;
}

vs_status vs_wiring_account(vs_deck *deck, const vs_scene_event *e, const char *line,
                            vs_error *err) {
  vs_error why = {0};
  return vs_contract_line(deck, line, (vs_where){.column = 1}, &why)
             ? vs_fail_at(err, e->where, "events.%s: %s", e->name, why.text)
             : VS_OK;
}

vs_status vs_wiring_loss(vs_deck *deck, const vs_scene_event *e, size_t index, const char *between,
                         vs_error *err) {
  char line[300];
  snprintf(line, sizeof line, "*$ loss %s = v(%s)*i(vvs_s%zu)", e->name, between, index);
  return vs_wiring_account(deck, e, line, err);
}

/* What of an element a formula may reckon with: its parameter, an index into the deck's names, and
 * its voltage, as terms have it. */
typedef struct reckoned {
  int name;
  char node[2][VS_DECK_NAME]; /* "v(a)" */
  const vs_wiring_element *element;
} reckoned;

static bool is_across(const vs_term *t, const reckoned *r) {
  return (!strcasecmp(t->plus, r->node[0]) && !strcasecmp(t->minus, r->node[1])) ||
         (!strcasecmp(t->plus, r->node[1]) && !strcasecmp(t->minus, r->node[0]));
}

static bool reckons(const vs_deck *deck, const vs_formula *f, const reckoned *r) {
  bool name = false, voltage = false;
  for (size_t k = 0; k < f->count; k++) {
    const vs_op *op = &f->ops[k];
    name = name || (op->kind == VS_OP_NAME && op->index == r->name);
    voltage = voltage || (op->kind == VS_OP_TERM && is_across(&deck->terms[op->index], r));
  }
  return name && voltage;
}

static bool is_doubted(const vs_deck *deck, const char *name) {
  for (size_t k = 0; k < deck->n_devices; k++)
    if (deck->devices[k].doubtful && !strcmp(deck->devices[k].name, name)) return true;
  return false;
}

static void add_to_list(vs_text *lines, const char *name) {
  vs_text_add(lines, "%s%s", lines->length ? ", " : "", name);
}

/* True for v(a,b)/{r}, the current of a resistor, whose first operation is number k. */
static bool is_current(const vs_formula *f, size_t k, const reckoned *r) {
  return k + 2 < f->count && vs_formula_name_of(&f->ops[k + 1]) == r->name &&
         f->ops[k + 2].kind == VS_OP_FUNCTION + VS_DIVIDE;
}

static bool is_voltage(const vs_deck *deck, const vs_op *op, const reckoned *r) {
  return op->kind == VS_OP_TERM && is_across(&deck->terms[op->index], r);
}

static bool is_forward(const vs_deck *deck, const vs_op *op, const reckoned *r) {
  return !strcasecmp(deck->terms[op->index].plus, r->node[0]);
}

/* Adds the current past the element to its own, wherever the formula has that. */
static void add_past(const vs_deck *deck, vs_formula *f, const reckoned *r, int past) {
  vs_op *ops = vs_alloc(3 * f->count, sizeof *ops);
  size_t n = 0;
  for (size_t k = 0; k < f->count; k++) {
    ops[n++] = f->ops[k];
    if (!is_voltage(deck, &f->ops[k], r)) continue;
    const bool forward = is_forward(deck, &f->ops[k], r);
    ops[n++] = f->ops[++k];
    ops[n++] = f->ops[++k];
    ops[n++] = (vs_op){VS_OP_TERM, past, 0, f->ops[k].at};
    ops[n++] = (vs_op){VS_OP_FUNCTION + (forward ? VS_ADD : VS_SUBTRACT), 0, 0, f->ops[k].at};
  }
  free(f->ops);
  f->ops = ops;
  f->count = n;
}

/* Mends an account that reckons so, as the books would be open: one of the element alone keeps to
 * its voltage, and one of another element's current has that through the event besides. False: what
 * the formula means by the element's voltage is not known. */
static bool mend(vs_deck *deck, vs_formula *f, const reckoned *r) {
  bool own = true, known = true;
  for (size_t k = 0; k < f->count; k++) {
    const bool voltage = is_voltage(deck, &f->ops[k], r);
    own = own && (voltage || f->ops[k].kind != VS_OP_TERM);
    known = known && (!voltage || is_current(f, k, r));
  }
  const char *inner = r->element->inner, *minus = r->element->node[1];
  const vs_where where = {0};
  if (!(own || known) || f->count > VS_FORMULA_DEPTH) return false;
  if (!inner && own) return true;
  const int term[2] = {inner ? vs_deck_add_term(deck, where, 'v', inner, minus)
                             : vs_deck_add_term(deck, where, 'i', r->element->past, "0"),
                       inner ? vs_deck_add_term(deck, where, 'v', minus, inner) : 0};
  if (term[0] < 0 || term[1] < 0) return false;
  if (!inner) add_past(deck, f, r, term[0]);
  for (size_t k = 0; inner && k < f->count; k++)
    if (is_voltage(deck, &f->ops[k], r)) f->ops[k].index = term[!is_forward(deck, &f->ops[k], r)];
  return true;
}

/* Lists the accounts that reckon so and cannot be mended, but for those that are listed as devices
 * already. */
static void list_accounts(vs_deck *deck, vs_accounts *all, const reckoned *r, vs_text *lines) {
  for (size_t k = 0; k < all->count; k++)
    if (reckons(deck, &all->item[k].formula, r) && !mend(deck, &all->item[k].formula, r) &&
        !is_doubted(deck, all->item[k].name))
      add_to_list(lines, all->item[k].name);
}

static void list_all(vs_deck *deck, const reckoned *r, vs_text *lines) {
  for (size_t k = 0; k < deck->n_devices; k++) {
    vs_device *d = &deck->devices[k];
    if (!reckons(deck, &d->current, r) && !reckons(deck, &d->voltage, r)) continue;
    d->doubtful = true;
    add_to_list(lines, d->name);
  }
  list_accounts(deck, &deck->losses, r, lines);
  list_accounts(deck, &deck->stores, r, lines);
}

void vs_wiring_doubt(vs_deck *deck, const vs_scene_event *e, const vs_wiring_element *element) {
  reckoned r = {0};
  for (int n = 0; n < 2; n++) snprintf(r.node[n], VS_DECK_NAME, "v(%.58s)", element->node[n]);
  r.element = element;
  for (; r.name < (int)deck->n_names; r.name++) {
    const char *name = deck->names[r.name].name;
    vs_text lines = {0};
    if (vs_words_find(element->value, element->value, name, strlen(name)))
      list_all(deck, &r, &lines);
    if (lines.length)
      vs_deck_remark(deck, e->where,
                     "events.%s: once %s is changed, lines of the deck that reckon with {%s} are "
                     "not right any more: those of %s; a 0 V source in series, and i() of it, "
                     "would be",
                     e->name, element->name, name, lines.text);
    vs_text_free(&lines);
  }
}
