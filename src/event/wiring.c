/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "event/wiring.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

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
