/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/manner.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>

const char vs_manner_tier_words[VS_TIERS][16] = {
#define TIER_WORD_(id, file, word) word,
    VS_TIER_LIST(TIER_WORD_)
#undef TIER_WORD_
};

#define R_(member) offsetof(vs_run_values, member)
#define OR_TIER_(id, file, word) "|" word

static const vs_field RUN[] = {
    {"tier", VS_CHOICE, "", "auto", 0, 0, false, R_(tier),
     "how much is modelled; auto: no more than the scene needs", "auto" VS_TIER_LIST(OR_TIER_),
     NULL},
    {"until", VS_REAL, "s", "2 s", 0, 1e6, true, R_(until_s), "end of the run, which starts at 0",
     NULL, NULL},
    {"sample", VS_REAL, "ms", "0.1 ms", 0, 1e9, true, R_(sample_s),
     "step of the rows in run.csv; does not change the run", NULL, NULL},
    {"tolerance", VS_REAL, "", "1e-4", 1e-10, 0.1, false, R_(tolerance),
     "largest error of p, u, w, phi, force and i, each relative to its peak", NULL, NULL},
    {"max_step", VS_REAL, "us", "0 us", 0, 1e6, false, R_(max_step_s),
     "largest step; 0: chosen from the tolerance", NULL, NULL},
    {"first_step", VS_REAL, "", "1e-7", 1e-12, 1, false, R_(first_step),
     "circuit tier: first step of a run whose mains are not at their zero, as a part of the "
     "largest",
     NULL, NULL},
    {"trtol", VS_REAL, "", "7", 1, 1e4, false, R_(trtol),
     "ngspice's: how much larger than tolerated its estimate of a step's truncation error may be",
     NULL, NULL},
    {"pivrel", VS_REAL, "", "0.05", 1e-6, 1, false, R_(pivrel),
     "ngspice's: how small a pivot may be in its column; decides the order of elimination", NULL,
     NULL},
    {"method", VS_CHOICE, "", "trap", 0, 0, false, R_(gear),
     "circuit tier's rule: trap, or gear, which damps the ringing of stiff circuits and needs half "
     "the step",
     "trap|gear", NULL},
    {"ladder", VS_CHOICE, "", "climb", 0, 0, false, R_(ladder),
     "when ngspice gives up: climb, to other methods and steps, and say so; ideal, to an ideal "
     "thyristor in the place of the scene's besides; or stay",
     VS_LADDER_WORDS, NULL},
    {"verify", VS_CHOICE, "", "auto", 0, 0, false, R_(verify),
     "a second, coarser run tells the numerical error of each margin: auto, in run where something "
     "is rated; always, in studies too; never",
     VS_VERIFY_WORDS, NULL},
    {"leave_circuit", VS_CHOICE, "", "when_quiet", 0, 0, false, R_(stays),
     "circuit tier: go on without ngspice once nothing fires any more and what that costs is "
     "bounded well below the tolerance",
     "when_quiet|never", NULL},
};
#undef OR_TIER_
#undef R_
const vs_section vs_manner_run = {"run", RUN, sizeof RUN / sizeof *RUN};

static const vs_field MEASURE[] = {
    {"from", VS_REAL, "s", "0 s", 0, 1e6, false, offsetof(vs_measure_values, from_s),
     "means (power, i_mean, i_rms) are taken from here on", NULL, NULL},
    {"to", VS_REAL, "s", "0 s", 0, 1e6, false, offsetof(vs_measure_values, to_s),
     "up to here; 0: run.until", NULL, NULL},
    {"last", VS_REAL, "cycles", "0 cycles", 0, 1e9, false, offsetof(vs_measure_values, last_cycles),
     "instead of from and to: over the last cycles of the mains before run.until", NULL, NULL},
};
const vs_section vs_manner_measure = {"measure", MEASURE, sizeof MEASURE / sizeof *MEASURE};

/* Returns the key at which the stretch of time that means are taken over is wrong, with what is
 * wrong in `text`; NULL: nothing is. */
static const char *wrong_means(const vs_measure_values *v, const vs_node *map, double period_s,
                               double until_s, char *text, size_t size) {
  bool from = vs_tree_child(map, "from"), to = vs_tree_child(map, "to");
  double end_s = to ? v->to_s : until_s;
  if (vs_tree_child(map, "last")) {
    if (from || to) {
      snprintf(text, size, "stands beside %s; write from and to, or last", from ? "from" : "to");
      return "last";
    }
    snprintf(text, size, "%g cycles of %g s are none, or more than run.until = %g s",
             v->last_cycles, period_s, until_s);
    return v->last_cycles > 0 && v->last_cycles * period_s <= until_s * (1 + 1e-12) ? NULL : "last";
  }
  snprintf(text, size, "%g s is beyond run.until = %g s", end_s, until_s);
  if (end_s > until_s * (1 + 1e-12)) return "to";
  snprintf(text, size, "%g s is not before the end of what means are over, %g s", v->from_s, end_s);
  return v->from_s < end_s ? NULL : from ? "from" : "to";
}

vs_status vs_manner_means(const vs_measure_values *v, const vs_node *map, double until_s,
                          double period_s, vs_span_s *means, vs_error *err) {
  char text[160];
  const char *key = wrong_means(v, map, period_s, until_s, text, sizeof text);
  const vs_node *node = key ? vs_tree_child(map, key) : NULL;
  if (key) return vs_fail_at(err, node ? node->where : map->where, "measure.%s: %s", key, text);
  bool to = vs_tree_child(map, "to");
  double first_s = v->last_cycles > 0 ? until_s - v->last_cycles * period_s : v->from_s;
  *means = (vs_span_s){fmax(first_s, 0), to ? fmin(v->to_s, until_s) : until_s};
  return VS_OK;
}
