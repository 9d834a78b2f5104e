/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "event/wiring.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"
#include "deck/contract.h"

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

vs_status vs_wiring_source(vs_deck *deck, const vs_occurrence *e, size_t index, const char *plus,
                           const char *minus, vs_error *err) {
  vs_port port = {.signal = {.drive = VS_PORT_EVENT, .event = index}, .where = e->where};
  if (deck->n_ports >= VS_DECK_MOST)
    return vs_fail_at(err, e->where, "events.%s: more than %d ports", e->name, VS_DECK_MOST);
  snprintf(port.source, sizeof port.source, "vvs_e%zu", index);
  deck->ports[deck->n_ports++] = port;
  vs_wiring_line(deck, e->where, "Vvs_e%zu %s %s external", index, plus, minus);
  return VS_OK;
}

vs_status vs_wiring_account(vs_deck *deck, const vs_occurrence *e, const char *line,
                            vs_error *err) {
  vs_error why = {0};
  return vs_contract_line(deck, line, (vs_where){.column = 1}, &why)
             ? vs_fail_at(err, e->where, "events.%s: %s", e->name, why.text)
             : VS_OK;
}

vs_status vs_wiring_loss(vs_deck *deck, const vs_occurrence *e, size_t index, const char *between,
                         vs_error *err) {
  char line[300];
  snprintf(line, sizeof line, "*$ loss %s = v(%s)*i(vvs_s%zu)", e->name, between, index);
  return vs_wiring_account(deck, e, line, err);
}

static bool names(const vs_formula *f, int name) {
  for (size_t k = 0; k < f->count; k++)
    if (f->ops[k].kind == VS_OP_NAME && f->ops[k].index == name) return true;
  return false;
}

static bool is_doubted(const vs_deck *deck, const char *name) {
  for (size_t k = 0; k < deck->n_devices; k++)
    if (deck->devices[k].doubtful && !strcmp(deck->devices[k].name, name)) return true;
  return false;
}

/* Lists the accounts in which the name stands, but for those that are named as devices already. */
static void list_accounts(const vs_deck *deck, const vs_accounts *all, int name, vs_text *lines) {
  for (size_t k = 0; k < all->count; k++)
    if (names(&all->item[k].formula, name) && !is_doubted(deck, all->item[k].name))
      vs_text_add(lines, "%s%s", lines->length ? ", " : "", all->item[k].name);
}

/* The index of the deck's name that is the value {NAME}; -1: the value is another one. */
static int name_of(const vs_deck *deck, const char *value) {
  char name[VS_DECK_NAME];
  const char *open = strchr(value, '{');
  if (!open || sscanf(open, "{ %63[A-Za-z0-9_] }", name) != 1) return -1;
  for (size_t k = 0; k < deck->n_names; k++)
    if (!strcasecmp(deck->names[k].name, name)) return (int)k;
  return -1;
}

void vs_wiring_doubt(vs_deck *deck, const vs_occurrence *e, const char *element,
                     const char *value) {
  vs_text lines = {0};
  const int name = name_of(deck, value);
  if (name < 0) return;
  for (size_t k = 0; k < deck->n_devices; k++) {
    vs_device *d = &deck->devices[k];
    if (!names(&d->current, name) && !names(&d->voltage, name)) continue;
    d->doubtful = true;
    vs_text_add(&lines, "%s%s", lines.length ? ", " : "", d->name);
  }
  list_accounts(deck, &deck->losses, name, &lines);
  list_accounts(deck, &deck->stores, name, &lines);
  if (lines.length)
    vs_deck_remark(deck, e->where,
                   "events.%s: once %s is changed, lines of the deck that reckon with {%s} are not "
                   "right any more: those of %s; a 0 V source in series, and i() of it, would be",
                   e->name, element, deck->names[name].name, lines.text);
  vs_text_free(&lines);
}
