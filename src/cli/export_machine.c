/* SPDX-License-Identifier: GPL-3.0-or-later
 * Each state is the voltage of a 1 F capacitor, charged by a B source with the state's rate. States
 * are in mm, mm/s, mrad, mrad/s, so that ngspice's absolute tolerances (1 uV) are small beside
 * them; M^-1 B and M^-1 K are the same in these units as in SI. Whatever {expression} a B source
 * holds stands in brackets: ngspice pastes it as text. */
#include "export_machine.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "netlist/eva.h"
#include "plant/b_source.h"

/* ---- the machine's nodes ---- */

/* The name of a state: a coordinate, or its rate. */
const char *vs_export_machine_state(const vs_model *m, int k) {
  const vs_coordinate *c = &m->machine->coordinates[k % m->dof];
  return k < m->dof ? c->name : c->rate;
}

/* The coordinate that is the gap's travel by itself, as no other moves the gap; -1: there is none.
 */
int vs_export_machine_travel_is(const vs_model *m) {
  int one = -1;
  for (int i = 0; i < m->dof; i++) {
    if (m->along[i] == 0) continue;
    if (one >= 0 || m->along[i] != 1) return -1;
    one = i;
  }
  return one;
}

/* What the travel is called. */
const char *vs_export_machine_travel(const vs_model *m) {
  int one = vs_export_machine_travel_is(m);
  return one < 0 ? "travel" : vs_export_machine_state(m, one);
}

/* The nodes of the travel and of its rate, mm and mm/s, behind "vs_". */
const char *vs_export_machine_node(const vs_model *m, bool rate) {
  int one = vs_export_machine_travel_is(m);
  return one < 0 ? rate ? "vg" : "g" : vs_export_machine_state(m, rate ? m->dof + one : one);
}

/* The node behind "vs_" of a motion that the deck names. */
static const char *node_of(const vs_model *m, const vs_motion_node *motion) {
  return motion->state < 0 ? vs_export_machine_node(m, true)
                           : vs_export_machine_state(m, motion->state);
}

void vs_export_machine_motion(vs_text *t, const vs_setup *s, const char *name,
                              const char *const nodes[2]) {
  const char *node = vs_export_machine_node(&s->model, false), *rest = "({vs_gap})+";
  for (size_t k = 0; k < s->deck.n_motions; k++) {
    if (strcasecmp(s->deck.motions[k].name, nodes[0])) continue;
    node = node_of(&s->model, &s->deck.motions[k]);
    rest = "";
  }
  vs_text_add(t, "B%s %s %s V = %sv(vs_%s)/1000\n", name + 1, nodes[0], nodes[1], rest, node);
}

/* True for the name behind "vs_" of a node that the export makes besides the states', or of a
 * number that its commands go by, which a node of that name would hide. */
static bool is_our_node(const vs_deck *deck, const char *name) {
  static const char *const OURS[] = {"f", "i",     "g",    "vg",      "a",
                                     "d", "until", "fire", "reached", "travel"};
  for (size_t k = 0; k < sizeof OURS / sizeof *OURS; k++)
    if (!strcasecmp(OURS[k], name)) return true;
  for (size_t k = 0; k < deck->n_ports; k++)
    if (!strcasecmp(deck->ports[k].source, name)) return true; /* of bursts */
  static const char *const BEGIN[] = {"stop", "probe", "acc", "w_", "b_"};
  for (size_t k = 0; k < sizeof BEGIN / sizeof *BEGIN; k++)
    if (!strncasecmp(name, BEGIN[k], strlen(BEGIN[k]))) return true;
  return false;
}

/* Refuses a machine that calls a state as the export calls a node of its own, and a stop that has
 * no text. */
vs_status vs_export_machine_check(const vs_setup *s, vs_error *err) {
  const vs_model *m = &s->model;
  for (int k = 0; k < 2 * m->dof; k++) {
    const char *name = vs_export_machine_state(m, k);
    bool twice = is_our_node(&s->deck, name);
    for (int j = 0; j < k; j++) twice = twice || !strcasecmp(vs_export_machine_state(m, j), name);
    if (twice)
      return vs_fail_at(err, m->machine->coordinates[k % m->dof].where,
                        "export: coordinate %s: ngspice would have two nodes or numbers vs_%s, as "
                        "it takes no notice of capitals and the export has some of its own; give "
                        "the coordinate another name",
                        m->machine->coordinates[k % m->dof].name, name);
  }
  for (int k = 0; k < m->stops.count; k++)
    if (!m->stops.item[k].kind->netlist)
      return vs_fail(err, VS_INPUT, "export: a stop of kind %s cannot be written for ngspice",
                     m->stops.item[k].kind->name);
  return VS_OK;
}

/* Only one stop, a linear one at the pole cover, follows vs_d where that is changed. */
static bool plain_stop(const vs_model *m) {
  const vs_stop *stop = m->stops.item;
  return m->stops.count == 1 && stop->kind->linear && stop->side > 0 &&
         stop->at_m == -m->actuator.gap_m;
}

void vs_export_machine_params(vs_text *t, const vs_model *m) {
  const vs_stop *only = m->stops.item;
  if (plain_stop(m)) {
    vs_text_add(t, ".param vs_stop_k=%.17g ; N/m, of the elastic stop at %s = -D\n",
                only->stiffness, vs_export_machine_travel(m));
    vs_text_add(t, ".param vs_stop_c=%.17g ; N s/m\n", only->damping_ns_m);
    return;
  }
  for (int k = 0; k < m->stops.count; k++) {
    const vs_stop *stop = &m->stops.item[k];
    vs_text_add(t, ".param vs_stop%d_at=%.17g ; m, %s at which it is met\n", k + 1, stop->at_m,
                vs_export_machine_travel(m));
    vs_text_add(t, ".param vs_stop%d_k=%.17g ; SI, stiffness of the stop %s\n", k + 1,
                stop->stiffness, stop->kind->name);
    vs_text_add(t, ".param vs_stop%d_c=%.17g ; N s/m\n", k + 1, stop->damping_ns_m);
  }
}

/* The travel and its rate, where no coordinate is the travel by itself. */
static void add_travel(vs_text *t, const vs_model *m) {
  for (int rate = 0; rate < 2 && vs_export_machine_travel_is(m) < 0; rate++) {
    const char *node = vs_export_machine_node(m, rate), *sign = "";
    vs_text_add(t, "Bvs_%s vs_%s 0 V = ", node, node);
    for (int i = 0; i < m->dof; i++) {
      if (m->along[i] == 0) continue;
      vs_text_add(t, "%s(%.17g)*v(vs_%s)", sign, m->along[i],
                  vs_export_machine_state(m, rate ? m->dof + i : i));
      sign = "+";
    }
    vs_text_add(t, "\n");
  }
}

/* The force that closes the gap: by the plain law, or by the law's own text, in a subcircuit that
 * keeps its nodes apart from the deck's. Then the current is shown too. */
static void add_force(vs_text *t, const vs_setup *s) {
  const vs_coil *coil = &s->model.coil;
  const char *eva = s->deck.eva;
  vs_text lines = {0}, current = {0}, force = {0};
  if (coil->square) {
    vs_text_add(t, "Bvs_f vs_f 0 V = v(%s.lam)*v(%s.lam)/(4*({eva_a}))\n", eva, eva);
    if (coil->eddies) {
      vs_text_add(t, "Bvs_i vs_i 0 V = v(%s.lam)*v(%s.z)/(2*({eva_a}))", eva, eva);
      vs_eva_add_eddy_currents(&s->deck, t);
      vs_text_add(t, "\n");
    }
    return;
  }
  coil->law->netlist(coil, "v(lam)", "v(z)", &lines, &current, &force);
  vs_text_add(t,
              ".subckt vs_law lam z f i\n%sBf f 0 V = %s\nBi i 0 V = %s\n.ends vs_law\n"
              "Xvs_law %s.lam %s.z vs_f %s vs_law\n",
              lines.text ? lines.text : "", force.text, current.text, eva, eva,
              coil->eddies ? "vs_law_i" : "vs_i");
  if (coil->eddies) {
    vs_text_add(t, "Bvs_i vs_i 0 V = v(vs_law_i)");
    vs_eva_add_eddy_currents(&s->deck, t);
    vs_text_add(t, "\n");
  }
  vs_text_free(&lines);
  vs_text_free(&current);
  vs_text_free(&force);
}

/* What the stops add to the force that closes the gap. */
static void add_stops(vs_text *t, const vs_model *m) {
  const char *g = vs_export_machine_node(m, false), *vg = vs_export_machine_node(m, true);
  if (plain_stop(m)) {
    vs_text_add(t,
                "Bvs_stop vs_stop 0 V = v(vs_%s) < -1000*({vs_d}) ? "
                "({vs_stop_k})*(v(vs_%s)/1000+({vs_d}))+({vs_stop_c})*v(vs_%s)/1000 : 0\n",
                g, g, vg);
    return;
  }
  for (int k = 0; k < m->stops.count; k++) {
    const vs_stop *stop = &m->stops.item[k];
    char depth[VS_DECK_NAME + 64], rate[VS_DECK_NAME + 64], stiffness[32], damping[32];
    snprintf(depth, sizeof depth, "(%s(({vs_stop%d_at})-v(vs_%s)/1000))", stop->side < 0 ? "-" : "",
             k + 1, g);
    snprintf(rate, sizeof rate, "(%sv(vs_%s)/1000)", stop->side < 0 ? "" : "-", vg);
    snprintf(stiffness, sizeof stiffness, "({vs_stop%d_k})", k + 1);
    snprintf(damping, sizeof damping, "({vs_stop%d_c})", k + 1);
    vs_text_add(t, "Bvs_stop%d vs_stop%d 0 V = %s > 0 ? %s(", k + 1, k + 1, depth,
                stop->side < 0 ? "" : "-");
    stop->kind->netlist((const char *const[]){stiffness, damping, depth, rate}, t);
    vs_text_add(t, ") : 0\n");
  }
}

/* The force on the machine, as an expression. */
static void add_whole_force(vs_text *t, const vs_model *m) {
  if (!m->stops.count) {
    vs_text_add(t, "v(vs_f)");
    return;
  }
  vs_text_add(t, "(v(vs_f)");
  for (int k = 0; k < m->stops.count && !plain_stop(m); k++) vs_text_add(t, "+v(vs_stop%d)", k + 1);
  vs_text_add(t, plain_stop(m) ? "+v(vs_stop))" : ")");
}

/* The right side of the equation of motion, for people. */
static void add_right_side(vs_text *t, const vs_model *m) {
  vs_text_add(t, "(");
  for (int i = 0; i < m->dof; i++) {
    double c = m->along[i], f0 = m->constant[i];
    if (i) vs_text_add(t, ", ");
    if (f0 != 0) vs_text_add(t, "%g%s", f0, c > 0 ? " - " : c < 0 ? " + " : "");
    if (c == 0 && f0 == 0) vs_text_add(t, "0");
    if (c != 0 && f0 == 0 && c > 0) vs_text_add(t, "-");
    if (c != 0 && fabs(c) != 1) vs_text_add(t, "%g ", fabs(c));
    if (c != 0) vs_text_add(t, "F");
  }
  vs_text_add(t, ")");
}

/* A G source that charges state k's capacitor with `rate` times the voltage of `node`. */
static void add_rate(vs_text *t, const vs_model *m, int k, int *n, double rate, const char *node) {
  if (rate == 0) return;
  const char *state = vs_export_machine_state(m, k);
  vs_text_add(t, "Gvs_%d_%d 0 vs_%s vs_%s 0 %.17g\n", k + 1, ++*n, state, node, rate);
}

/* The equations of motion, first order: q' = v, v' = M^-1 (c F + f0 - B v - K q), mm/s2. */
static void add_equations(vs_text *t, const vs_model *m, int i) {
  const int v = m->dof + i;
  int of_q = 0, of_v = 0;
  char stop[32];
  add_rate(t, m, i, &of_q, 1, vs_export_machine_state(m, v));
  add_rate(t, m, v, &of_v, 1e3 * m->mf[i], "f");
  for (int k = 0; k < m->stops.count; k++) {
    snprintf(stop, sizeof stop, plain_stop(m) ? "stop" : "stop%d", k + 1);
    add_rate(t, m, v, &of_v, 1e3 * m->mf[i], stop);
  }
  for (int j = 0; j < m->dof; j++) {
    add_rate(t, m, v, &of_v, -m->mk_column[j][i], vs_export_machine_state(m, j));
    add_rate(t, m, v, &of_v, -m->mb_column[j][i], vs_export_machine_state(m, m->dof + j));
  }
  if (m->m0[i] != 0)
    vs_text_add(t, "Ivs_%d 0 vs_%s %.17g\n", v + 1, vs_export_machine_state(m, v), 1e3 * m->m0[i]);
}

/* The acceleration of a coordinate, mm/s2, as an expression. */
static void add_acceleration(vs_text *t, const vs_model *m, int i) {
  vs_text_add(t, "%.17g*", 1e3 * m->mf[i]);
  add_whole_force(t, m);
  for (int j = 0; j < 2 * m->dof; j++) {
    double rate = j < m->dof ? -m->mk_column[j][i] : -m->mb_column[j - m->dof][i];
    if (rate != 0)
      vs_text_add(t, " %c %.17g*v(vs_%s)", rate < 0 ? '-' : '+', fabs(rate),
                  vs_export_machine_state(m, j));
  }
  if (m->m0[i] != 0) vs_text_add(t, " %c %.17g", m->m0[i] < 0 ? '-' : '+', 1e3 * fabs(m->m0[i]));
}

/* True where a probe of the machine names the acceleration of coordinate i. */
static bool is_probed(const vs_model *m, int i) {
  for (int k = 0; k < m->machine->n_probes; k++)
    if (vs_formula_uses(&m->machine->probes[k].of, VS_MACHINE_TERM_Q + 2 * m->dof + i)) return true;
  return false;
}

/* What stands for the terms of the machine's probes. */
enum { TERMS = VS_MACHINE_TERM_Q + 3 * VS_MOST_DOF };
static void write_terms(const vs_setup *s, vs_text text[TERMS]) {
  const vs_model *m = &s->model;
  const char *eva = s->deck.eva;
  vs_text_add(&text[VS_MACHINE_TERM_Z], "v(%s.z)", eva);
  vs_text_add(&text[VS_MACHINE_TERM_LAMBDA], "v(%s.lam)", eva);
  if (m->coil.square && !m->coil.eddies)
    vs_text_add(&text[VS_MACHINE_TERM_I], "(v(%s.lam)*v(%s.z)/(2*({eva_a})))", eva, eva);
  else
    vs_text_add(&text[VS_MACHINE_TERM_I], "v(vs_i)");
  vs_text_add(&text[VS_MACHINE_TERM_FORCE], "v(vs_f)");
  for (int k = 0; k < 2 * m->dof; k++)
    vs_text_add(&text[VS_MACHINE_TERM_Q + k], "(v(vs_%s)/1000)", vs_export_machine_state(m, k));
  for (int i = 0; i < m->dof; i++)
    vs_text_add(&text[VS_MACHINE_TERM_Q + 2 * m->dof + i], "(v(vs_acc%d)/1000)", i + 1);
}

/* The machine's own probes, in their units, and the accelerations that they name, in mm/s2. */
static void add_probes(vs_text *t, const vs_setup *s) {
  const vs_model *m = &s->model;
  const char *terms[TERMS];
  vs_text text[TERMS] = {0};
  write_terms(s, text);
  for (int k = 0; k < TERMS; k++) terms[k] = text[k].text;
  for (int i = 0; i < m->dof; i++) {
    if (!is_probed(m, i)) continue;
    vs_text_add(t, "Bvs_acc%d vs_acc%d 0 V = ", i + 1, i + 1);
    add_acceleration(t, m, i);
    vs_text_add(t, "\n");
  }
  for (int k = 0; k < m->machine->n_probes; k++) {
    vs_text_add(t, "Bvs_probe%d vs_probe%d 0 V = ", k + 1, k + 1);
    vs_b_source_formula(t, &m->machine->probes[k].of, terms);
    vs_text_add(t, "\n");
  }
  for (int k = 0; k < TERMS; k++) vs_text_free(&text[k]);
}

void vs_export_machine_write(vs_text *t, const vs_setup *s) {
  const vs_model *m = &s->model;
  vs_text_add(t, "*\n* The machine: M q\" + B q' + K q = ");
  add_right_side(t, m);
  vs_text_add(t,
              ", solved for q\". Each state is the voltage of\n* 1 F: 1 V is 1 mm, 1 mrad, 1 mm/s, "
              "1 mrad/s; F, too, as 1 V/N.\n.global vs_%s\n",
              vs_export_machine_node(m, false));
  for (size_t k = 0; k < s->deck.n_motions; k++)
    vs_text_add(t, ".global vs_%s\n", node_of(m, &s->deck.motions[k]));
  add_force(t, s);
  add_travel(t, m);
  add_stops(t, m);
  for (int i = 0; i < m->dof; i++) {
    const char *q = vs_export_machine_state(m, i), *v = vs_export_machine_state(m, m->dof + i);
    vs_text_add(t, "Cvs_%s vs_%s 0 1 ic={1000*vs_%s0}\n", q, q, q);
    vs_text_add(t, "Cvs_%s vs_%s 0 1 ic={1000*vs_%s0}\n", v, v, v);
    add_equations(t, m, i);
  }
  add_probes(t, s);
}
