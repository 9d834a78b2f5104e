/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/budget.h"

#include <math.h>
#include <stdio.h>
#include <time.h>

double vs_budget_clock_s(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* The part of the budget that is spent: of the kind of cycle that is nearer to its end. */
static double part_spent(const vs_budget *b) {
  double part = 0;
  for (int k = 0; k < VS_BUDGET_KINDS; k++)
    part = fmax(part, (double)b->spent[k] / (double)b->most[k]);
  return part;
}

static void show_progress(vs_budget *b) {
  double now = vs_budget_clock_s();
  if (b->began_s == 0) b->began_s = now;
  double spent = now - b->began_s, part = part_spent(b);
  if (spent < 1 || now - b->shown_s < 0.25) return;
  b->shown_s = now;
  fprintf(stderr, "\r%s: %s%s%.0f %% of the budget, at most %.0f s left \033[K", b->what, b->stage,
          *b->stage ? "; " : "", 100 * part, spent * (1 - part) / part);
}

vs_status vs_budget_take(vs_budget *b, bool has_circuit, long cycles, vs_error *err) {
  int kind = has_circuit ? VS_BUDGET_CIRCUIT : VS_BUDGET_IDEAL;
  if (!b) return VS_OK;
  b->out[kind] = b->out[kind] || cycles > b->most[kind] - b->spent[kind];
  if (b->out[kind])
    return vs_fail(err, VS_BUDGET, "the search's budget of %ld cycles of the mains %s is spent",
                   b->most[kind], has_circuit ? "in the circuit" : "on the ideal tiers");
  vs_status status = vs_budget_take(b->of, has_circuit, cycles, err);
  if (status) return status;
  b->spent[kind] += cycles;
  if (b->shows) show_progress(b);
  return VS_OK;
}

void vs_budget_end(vs_budget *b) {
  if (b->shown_s > 0) fputs("\r\033[K", stderr);
  b->shown_s = 0;
}
