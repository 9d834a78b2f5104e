/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupled/signal_map.h"

#include <stdio.h>

/* The next name is written into the next free text, and stands at a place of its list. */
#define NAMED(place, ...)                                                                          \
  (snprintf(n->text[used], sizeof n->text[used], __VA_ARGS__), (place) = n->text[used++])

/* The sources in eva_led.inc, by the port each is. */
static const char *const SOURCES[VS_EVA_PORTS] = {[VS_EVA_PORT_GAP] = "v.%s.vgap",
                                                  [VS_EVA_PORT_CORRECTS_FLUX] = "i.%s.iamend_l",
                                                  [VS_EVA_PORT_CORRECTS_CURRENT] = "i.%s.iamend_i",
                                                  [VS_EVA_PORT_FLUX] = "i.%s.igoal_l",
                                                  [VS_EVA_PORT_VOLTAGE] = "i.%s.igoal_v",
                                                  [VS_EVA_PORT_RATE] = "i.%s.irate",
                                                  [VS_EVA_PORT_CONDUCTANCE] = "i.%s.ilead"};

static size_t name_own_ports(const vs_deck *deck, vs_signal_map *n, size_t used) {
  const char **of_eva = n->ports + deck->n_ports;
  for (size_t p = 0; p < deck->n_ports; p++) NAMED(n->ports[p], "%s", deck->ports[p].source);
  size_t count = deck->eva_led ? VS_EVA_PORTS : VS_EVA_PORTS_LEADING;
  for (size_t p = 0; p < count; p++) NAMED(of_eva[p], SOURCES[p], deck->eva);
  n->n_ports = deck->n_ports + count;
  return used;
}

static size_t name_ports(const vs_deck *deck, vs_signal_map *n) {
  size_t used = name_own_ports(deck, n, 0);
  for (size_t k = 0; k < deck->n_motions; k++)
    NAMED(n->ports[n->n_ports++], "v.%s.v%s", deck->eva, deck->motions[k].name);
  return used;
}

static void name_signals(const vs_deck *deck, vs_signal_map *n, size_t used) {
  const char *mains = NULL;
  for (size_t p = 0; p < deck->n_ports; p++)
    if (deck->ports[p].signal.drive == VS_PORT_MAINS) mains = deck->ports[p].source;
  NAMED(n->signals[VS_SIG_FLUX], "v(%s.lam)", deck->eva);
  NAMED(n->signals[VS_SIG_COIL], "v(%s.x)", deck->eva);
  NAMED(n->signals[VS_SIG_MINUS], "v(%s)", deck->eva_minus);
  NAMED(n->signals[VS_SIG_PLUS], "v(%s)", deck->eva_plus);
  if (mains)
    NAMED(n->signals[VS_SIG_I_MAINS], "i(%s)", mains);
  else
    NAMED(n->signals[VS_SIG_I_MAINS], "v(0)");
  for (size_t t = 0; t < deck->n_terms; t++) {
    NAMED(n->signals[VS_SIG_TERMS + 2 * t], "%s", deck->terms[t].plus);
    NAMED(n->signals[VS_SIG_TERMS + 2 * t + 1], "%s", deck->terms[t].minus);
  }
  n->n_signals = VS_SIG_TERMS + 2 * deck->n_terms;
}

void vs_signal_map_of(const vs_deck *deck, const vs_circuit_states *memories, vs_signal_map *n) {
  name_signals(deck, n, name_ports(deck, n));
  n->n_memories = memories ? memories->count : 0;
  for (size_t k = 0; k < n->n_memories; k++) {
    n->signals[n->n_signals++] = memories->item[k].plus;
    n->signals[n->n_signals++] = memories->item[k].minus;
  }
}

void vs_signal_map_take_terms(const vs_deck *deck, const double *signals, vs_knot *k) {
  k->i_mains_a = -signals[VS_SIG_I_MAINS];
  for (size_t n = 0; n < deck->n_terms; n++)
    k->terms[n] = signals[VS_SIG_TERMS + 2 * n] - signals[VS_SIG_TERMS + 2 * n + 1];
}

void vs_signal_map_take_coil(const double *signals, vs_knot *k) {
  k->flux_wb = signals[VS_SIG_FLUX];
  k->flux_rate_v = signals[VS_SIG_COIL] - signals[VS_SIG_MINUS];
  k->v_eva_v = signals[VS_SIG_PLUS] - signals[VS_SIG_MINUS];
}

void vs_signal_map_take_memory(const vs_signal_map *n, const double *signals,
                               double memory[VS_CIRCUIT_STATES_MOST]) {
  const double *s = signals + n->n_signals - 2 * n->n_memories;
  for (size_t k = 0; k < n->n_memories; k++) memory[k] = s[2 * k] - s[2 * k + 1];
}
