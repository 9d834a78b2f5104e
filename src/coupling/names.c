/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupling/names.h"

#include <stdio.h>

void vs_names_of(const vs_deck *deck, vs_names *n) {
  size_t k = 0;
#define VS_NAMED(list, count, ...)                                                                 \
  (snprintf(n->text[k], sizeof n->text[k], __VA_ARGS__), n->list[n->count++] = n->text[k], k++)
  VS_NAMED(signals, n_signals, "v(%s.lam)", deck->eva);
  VS_NAMED(signals, n_signals, "v(%s.x)", deck->eva);
  VS_NAMED(signals, n_signals, "v(%s)", deck->eva_minus);
  VS_NAMED(signals, n_signals, "v(%s)", deck->eva_plus);
  const char *mains = NULL;
  for (size_t p = 0; p < deck->n_ports; p++) {
    VS_NAMED(ports, n_ports, "%s", deck->ports[p].source);
    if (deck->ports[p].signal.drive == VS_PORT_MAINS) mains = deck->ports[p].source;
  }
  VS_NAMED(ports, n_ports, "v.%s.vgap", deck->eva);
  static const char *const LEADING[] = {"igoal_l", "igoal_v", "irate", "ilead"};
  for (size_t p = 0; deck->eva_led && p < VS_EVA_PORTS - 1; p++)
    VS_NAMED(ports, n_ports, "i.%s.%s", deck->eva, LEADING[p]);
  if (mains)
    VS_NAMED(signals, n_signals, "i(%s)", mains);
  else
    VS_NAMED(signals, n_signals, "v(0)");
  for (size_t t = 0; t < deck->n_terms; t++) {
    VS_NAMED(signals, n_signals, "%s", deck->terms[t].plus);
    VS_NAMED(signals, n_signals, "%s", deck->terms[t].minus);
  }
#undef VS_NAMED
}
