/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/tiers.h"

#include <string.h>

#include "macromodel/macromodel.h"
#include "ngspice/self_test.h"

const vs_tier *const vs_tiers_all[VS_TIERS] = {
#define TIER_ROW(id, file, word) [id] = &vs_##file##_tier,
    VS_TIER_LIST(TIER_ROW)
#undef TIER_ROW
};

const char vs_tiers_words[] = VS_TIER_WORDS;

const char vs_tiers_on_at_rest[] =
    "t = 0 s: the coil carries a current at the deck's operating point";

const vs_run_order vs_tiers_order = {.solver = &vs_self_test_kind,
                                     .stand_in = &vs_oneport_macromodel};

const vs_tier *vs_tiers_find(const char *name) {
  for (int k = 0; k < VS_TIERS; k++)
    if (!strcmp(vs_tiers_all[k]->name, name)) return vs_tiers_all[k];
  return NULL;
}

const vs_tier *vs_tiers_automatic(bool circuit) {
  for (int k = 0; k < VS_TIERS; k++)
    if (vs_tiers_all[k]->automatic && vs_tiers_all[k]->has_circuit == circuit)
      return vs_tiers_all[k];
  return NULL;
}

const char *vs_tiers_circuit(void) {
  return vs_tiers_automatic(true)->name;
}

const vs_tier *vs_tiers_of_orbit(const vs_tier *tier) {
  return tier->gap_at_rest ? vs_tiers_automatic(false) : tier;
}

vs_status vs_tiers_require_orbits(const char *who, const vs_tier *tier, const char *why,
                                  vs_where where, vs_error *err) {
  const char *known = vs_tiers_automatic(false)->name;
  if (!tier->gap_at_rest) return VS_OK;
  return vs_fail_at(err, where,
                    "%s: this is tier %s (%s), which knows no orbits; write --tier %s, or "
                    "run.tier: %s",
                    who, tier->name, why, known, known);
}
