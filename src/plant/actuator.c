/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plant/actuator.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* ---- keys ---- */

#define A_(member) offsetof(vs_actuator_values, member)
#define S_(member) offsetof(vs_stop_values, member)
#define I_(member) offsetof(vs_saturation_values, member)

/* The keys of a stop; the unit of its stiffness is that of its kind. */
#define STOP_ROWS_(unit, standard, most)                                                           \
  {"stiffness", VS_REAL, unit, standard, 0, most, true, S_(stiffness), "k of the elastic stop",    \
   NULL,        NULL},                                                                             \
      {"damping",                                                                                  \
       VS_REAL,                                                                                    \
       "N.s/m",                                                                                    \
       "300 N.s/m",                                                                                \
       0,                                                                                          \
       1e9,                                                                                        \
       false,                                                                                      \
       S_(damping_ns_m),                                                                           \
       "c of the elastic stop",                                                                    \
       NULL,                                                                                       \
       NULL},                                                                                      \
      {"kind",                                                                                     \
       VS_CHOICE,                                                                                  \
       "",                                                                                         \
       "linear",                                                                                   \
       0,                                                                                          \
       0,                                                                                          \
       false,                                                                                      \
       S_(kind),                                                                                   \
       "F(delta) of the stop: k delta + c delta'; or, with the stiffness in N/m2, k delta^2 with " \
       "its damping clipped",                                                                      \
       VS_STOP_WORDS,                                                                              \
       NULL},                                                                                      \
      {"at",                                                                                       \
       VS_REAL,                                                                                    \
       "mm",                                                                                       \
       "pole_cover",                                                                               \
       0,                                                                                          \
       1e3,                                                                                        \
       false,                                                                                      \
       S_(at_m),                                                                                   \
       "gap z at which it is met; from the gap at rest on it is one that ends the opening",        \
       "pole_cover",                                                                               \
       NULL},
enum { STOP_KIND = 2 }; /* which of the rows is the key kind */
static const vs_field LINEAR[] = {STOP_ROWS_("N/m", "1e7 N/m", 1e12)};
static const vs_field QUADRATIC[] = {STOP_ROWS_("N/m2", "1e11 N/m2", 1e18)};
#undef STOP_ROWS_
#define STOP_SECTION_(rows)                                                                        \
  { "actuator.stop", rows, sizeof rows / sizeof *rows }
static const vs_section STOP_FORMS[] = {STOP_SECTION_(LINEAR), STOP_SECTION_(QUADRATIC)};
static const vs_inside STOP = {STOP_SECTION_(LINEAR), STOP_FORMS, STOP_KIND, VS_MOST_STOPS,
                               .size = sizeof(vs_stop_values)};

static const vs_field SATURATION_ROWS[] = {
    {"law", VS_CHOICE, "", "series", 0, 0, false, I_(law),
     "series: i grows by current (lambda/flux)^exponent; multiplicative: i is multiplied by 1 + "
     "(lambda/flux)^exponent",
     "series|multiplicative", NULL},
    {"flux", VS_REAL, "Wb", "1 Wb", 0, 1e6, true, I_(flux_wb), "flux linkage of saturation", NULL,
     NULL},
    {"exponent", VS_REAL, "", "7", 1, 100, false, I_(exponent), "how sharply the iron saturates",
     NULL, NULL},
    {"current", VS_REAL, "A", "0.2 A", 0, 1e6, false, I_(current_a),
     "law series: current that the iron takes at that flux linkage", NULL, NULL},
};
enum { SATURATION_KEYS = sizeof SATURATION_ROWS / sizeof *SATURATION_ROWS };
#define SATURATION_(count)                                                                         \
  { "actuator.saturation", SATURATION_ROWS, count }
static const vs_section SATURATION_FORMS[] = {SATURATION_(SATURATION_KEYS),
                                              SATURATION_(SATURATION_KEYS - 1)};
static const vs_inside SATURATION = {SATURATION_(SATURATION_KEYS), SATURATION_FORMS, 0, 1,
                                     .size = sizeof(vs_saturation_values)};

#define E_(member) offsetof(vs_rung_values, member)
static const vs_field RUNG_ROWS[] = {
    {"inductance", VS_REAL, "H", "0 H", 0, 1e4, false, E_(inductance_h),
     "leakage inductance of the secondary, as seen from all turns of the coil", NULL, NULL},
    {"resistance", VS_REAL, "ohm", "15 kohm", 0, 1e9, true, E_(resistance_ohm),
     "resistance of the secondary, as seen from all turns of the coil", NULL, NULL},
    {"coupling", VS_REAL, "", "1", 0, 1, false, E_(coupling),
     "share of the coil's flux linkage that the secondary encloses", NULL, NULL},
};
static const vs_inside EDDY = {{"actuator.eddy", RUNG_ROWS, sizeof RUNG_ROWS / sizeof *RUNG_ROWS},
                               .most = VS_MOST_RUNGS,
                               .size = sizeof(vs_rung_values)};

#define W_(member) offsetof(vs_winding_values, member)
static const vs_field WINDING_ROWS[] = {
    {"temperature", VS_REAL, "degC", "20 degC", -60, 500, false, W_(temperature_degc),
     "of the winding as the run begins; actuator.resistance is that at 20 degC", NULL, NULL},
    {"coefficient", VS_REAL, "", "0.00393", 0, 0.01, false, W_(coefficient_1_k),
     "by which the resistance grows per K, as a part of that at 20 degC; copper", NULL, NULL},
    {"r_th", VS_REAL, "K/W", "0 K/W", 0, 1e6, false, W_(r_th[0]),
     "thermal resistance from winding to core, or to the ambient where the core has none", NULL,
     NULL},
    {"c_th", VS_REAL, "J/K", "0 J/K", 0, 1e9, false, W_(c_th[0]),
     "heat capacity of the winding; 0: not known", NULL, NULL},
    {"core_r_th", VS_REAL, "K/W", "0 K/W", 0, 1e6, false, W_(r_th[1]),
     "thermal resistance from core to ambient", NULL, NULL},
    {"core_c_th", VS_REAL, "J/K", "0 J/K", 0, 1e9, false, W_(c_th[1]), "heat capacity of the core",
     NULL, NULL},
    {"ambient", VS_REAL, "degC", "25 degC", -60, 200, false, W_(ambient_degc),
     "temperature of the air around the coil", NULL, NULL},
};
static const vs_inside WINDING = {
    {"actuator.winding", WINDING_ROWS, sizeof WINDING_ROWS / sizeof *WINDING_ROWS},
    .most = 1,
    .size = sizeof(vs_winding_values)};

static const vs_field ACTUATOR[] = {
    {"gap", VS_REAL, "mm", "6 mm", 0, 1e3, true, A_(gap_m),
     "D, from the armature to the pole cover, or to the bare pole, at rest", NULL, NULL},
    {"pole_cover", VS_REAL, "mm", "0.5 mm", 0, 1e3, false, A_(pole_cover_m),
     "d, non-magnetic cover of the pole; what is left of the gap when it is closed", NULL, NULL},
    {"inductance", VS_REAL, "H", "1.6 H", 0, 1e4, true, A_(inductance_h),
     "L(0), of the coil with the armature at rest", NULL, NULL},
    {"resistance", VS_REAL, "ohm", "92 ohm", 0, 1e6, true, A_(resistance_ohm), "R_c, of the coil",
     NULL, NULL},
    {"stop", VS_OPTION, "", "none", 0, 0, false, A_(stop),
     "what the armature meets, at the pole cover unless `at` says more; with none a run that gets "
     "there ends with an error",
     "none", &STOP},
    {"law", VS_NAME, "", "reluctance", 0, 0, false, A_(law),
     "how current and force follow from flux linkage and gap: see 'list laws'; or a table, a file "
     "that ends in .csv",
     "reluctance|moving_coil|formula|FILE.csv", NULL},
    {"leakage", VS_REAL, "H", "0 H", 0, 1e4, false, A_(leakage_h),
     "law reluctance: L_k, inductance of the flux that does not cross the gap", NULL, NULL},
    {"saturation", VS_OPTION, "", "none", 0, 0, false, A_(saturation),
     "law reluctance: what the iron adds to the current", "none", &SATURATION},
    {"linear_to", VS_REAL, "Wb", "none", 0, 1e6, true, A_(linear_to_wb),
     "law reluctance: flux linkage up to which the iron is known not to saturate; a run beyond it "
     "without "
     "`saturation` is warned of",
     "none", NULL},
    {"eddy", VS_OPTION, "", "none", 0, 0, true, A_(eddy),
     "eddy currents and core loss: one to three shorted secondaries beside the coil", "none",
     &EDDY},
    {"winding", VS_OPTION, "", "none", 0, 0, true, A_(winding),
     "how warm the coil is, and what that makes of its resistance", "none", &WINDING},
    {"emf_constant", VS_REAL, "V.s/m", "1 V.s/m", -1e9, 1e9, false, A_(emf_constant_vs_m),
     "law moving_coil: voltage per speed at which the gap opens", NULL, NULL},
    {"force_constant", VS_REAL, "N/A", "emf_constant", -1e9, 1e9, false, A_(force_constant_n_a),
     "law moving_coil: force per current that opens the gap; if equal, no energy is lost between",
     "emf_constant", NULL},
};
const vs_section vs_actuator_section = {"actuator", ACTUATOR, sizeof ACTUATOR / sizeof *ACTUATOR};

/* ---- laws ---- */

/* To add a law: a file with its vs_law, of which force and current are derivatives of one energy,
 * and a row here. A key of its own is a row of ACTUATOR and a member in values.h. A member that is
 * left out is NULL: without `netlist`, tier circuit and `export` refuse the law by name.
 * test_coils and test_laws hold its functions against its energy, test_laws_on_ideal and
 * test_circuit_laws its runs. */
const vs_law *const vs_actuator_laws[] = {&vs_reluctance_law, &vs_moving_coil_law, &vs_formulas_law,
                                          &vs_table_law, NULL};

static bool ends_in(const char *word, const char *ending) {
  size_t n = strlen(word), m = strlen(ending);
  return n > m && !strcmp(word + n - m, ending);
}

/* Finds the law of that name, or the one that reads files of that ending. */
static vs_status find_law(const char *name, const vs_node *map, const vs_law **law, vs_error *err) {
  enum { MOST = sizeof vs_actuator_laws / sizeof *vs_actuator_laws };
  const char *names[MOST];
  size_t n = 0;
  vs_text all = {0};
  for (const vs_law *const *l = vs_actuator_laws; *l; l++) {
    bool files = (*l)->ending != NULL;
    *law = *l;
    if (files ? ends_in(name, (*l)->ending) : !strcmp(name, (*l)->name)) break;
    *law = NULL;
    if (!files) names[n++] = (*l)->name;
    vs_text_add(&all, "%s%s", l > vs_actuator_laws ? ", " : "", (*l)->name);
  }
  const vs_node *node = vs_tree_child(map, "law");
  vs_status status = VS_OK;
  if (!*law)
    status = vs_fail_at(err, node ? node->where : (vs_where){0},
                        "actuator.law: no law '%s'; there are: %s%s", name, all.text,
                        vs_text_hint(name, names, n, "").text);
  vs_text_free(&all);
  return status;
}

/* True if the word is one of those between the bars of "one|two". */
static bool is_one_of(const char *word, const char *words) {
  size_t n = strlen(word);
  for (const char *s = words; s && *s;) {
    const char *bar = strchr(s, '|');
    if (!strncmp(s, word, n) && (!s[n] || s[n] == '|')) return true;
    s = bar ? bar + 1 : NULL;
  }
  return false;
}

/* Error: the scene gives a key that only other laws use. */
static vs_status refuse_unused(const vs_law *law, const vs_node *map, vs_error *err) {
  vs_status status = VS_OK;
  for (const vs_node *n = map && map->kind == VS_NODE_MAP ? map->child : NULL; n && !status;
       n = n->next) {
    bool own = false;
    for (const vs_law *const *l = vs_actuator_laws; *l && !own; l++)
      own = is_one_of(n->key, (*l)->keys);
    if (own && !is_one_of(n->key, law->keys))
      status = vs_error_keep(
          err, vs_fail_at(err, n->key_where,
                          "actuator.%s: law %s has no use for it; leave it out, or choose a law "
                          "that has",
                          n->key, law->name));
  }
  return status;
}

void vs_actuator_end(vs_coil *coil) {
  if (coil->law && coil->law->end) coil->law->end(coil);
}

/* ---- stops ---- */

/* A stop that is met at the gap at rest limits the opening. A place that differs from the gap at
 * rest by less than this part of it differs by the rounding of D + d alone. */
static const double ROUNDING = 1e-12;

static vs_stop stop_of(const vs_actuator_values *v, const vs_stop_values *s) {
  const double rest_m = v->gap_m + v->pole_cover_m;
  const bool standard = isnan(s->at_m);
  const double z_m = standard ? v->pole_cover_m : s->at_m;
  double at_m = standard ? -v->gap_m : s->at_m - rest_m;
  if (fabs(at_m) <= ROUNDING * rest_m) at_m = 0;
  return (vs_stop){.kind = vs_stop_kinds[s->kind],
                   .side = at_m < 0 ? 1 : -1,
                   .at_m = at_m,
                   .stiffness = s->stiffness,
                   .damping_ns_m = s->damping_ns_m,
                   .scale_m = at_m < 0 ? -at_m : rest_m,
                   .deepest_m = at_m < 0 && z_m > 0 ? z_m : rest_m};
}

/* The stops that end the closing stand first. */
static void build_stops(const vs_actuator_values *v, vs_stops *stops) {
  *stops = (vs_stops){0};
  for (int side = 1; side >= -1; side -= 2)
    for (int k = 0; k < VS_MOST_STOPS && v->stop[k].present; k++) {
      vs_stop stop = stop_of(v, &v->stop[k]);
      if (stop.side == side) stops->item[stops->count++] = stop;
    }
}

/* A secondary without leakage is a conductance; several of them are one. */
static void build_rungs(const vs_actuator_values *v, vs_coil *coil) {
  for (int n = 0; n < VS_MOST_RUNGS && v->eddy[n].present; n++) {
    const vs_rung_values *e = &v->eddy[n];
    const double k = e->coupling;
    if (k == 0) continue;
    coil->eddies = true;
    if (e->inductance_h == 0) {
      coil->core_s += k * k / e->resistance_ohm;
      continue;
    }
    coil->rung[coil->rungs++] =
        (vs_rung){k, e->resistance_ohm, k / e->inductance_h, e->resistance_ohm / e->inductance_h};
    coil->leak_1_h += k * k / e->inductance_h;
  }
}

vs_status vs_actuator_build(const vs_actuator_values *v, const vs_node *map,
                            const vs_law_formulas *formulas, vs_coil *coil, vs_stops *stops,
                            vs_error *err) {
  *coil = (vs_coil){.resistance_ohm = v->resistance_ohm, .gap_rest_m = v->gap_m + v->pole_cover_m};
  vs_status status = find_law(v->law, map, &coil->law, err);
  if (!status) status = refuse_unused(coil->law, map, err);
  if (!status) status = coil->law->build(v, map, formulas, coil, err);
  if (status) { /* a check carries on without a coil */
    vs_actuator_end(coil);
    coil->law = NULL;
  } else {
    build_stops(v, stops);
    build_rungs(v, coil);
    coil->cold_ohm = v->resistance_ohm;
    coil->resistance_ohm =
        vs_winding_ohm(&v->winding, v->resistance_ohm, v->winding.temperature_degc);
    coil->heat = vs_winding_begin(&v->winding);
  }
  return status;
}
