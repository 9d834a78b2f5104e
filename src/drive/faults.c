/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "drive/faults.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "deck/contract.h"
#include "deck/rules.h"
#include "drive/timeline.h"

/* ---- putting something into the deck ---- */

static void add_line(vs_deck *deck, vs_where where, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static void add_line(vs_deck *deck, vs_where where, const char *format, ...) {
  char text[512];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  deck->lines = realloc(deck->lines, (deck->n_lines + 1) * sizeof *deck->lines);
  deck->lines[deck->n_lines++] = (vs_line){vs_copy(text), strlen(text), where};
}

/* The source number `index`, between two nodes, that the event drives. */
static vs_status add_source(vs_deck *deck, const vs_occurrence *e, size_t index, const char *plus,
                            const char *minus, vs_error *err) {
  vs_port port = {.signal = {.drive = VS_DRIVE_EVENT, .event = index}, .where = e->where};
  if (deck->n_ports >= VS_DECK_MOST)
    return vs_fail_at(err, e->where, "events.%s: more than %d ports", e->name, VS_DECK_MOST);
  snprintf(port.source, sizeof port.source, "vvs_e%zu", index);
  deck->ports[deck->n_ports++] = port;
  add_line(deck, e->where, "Vvs_e%zu %s %s external", index, plus, minus);
  return VS_OK;
}

static vs_status add_account(vs_deck *deck, const vs_occurrence *e, const char *line,
                             vs_error *err) {
  vs_error why = {0};
  return vs_contract_line(deck, line, (vs_where){.column = 1}, &why)
             ? vs_fail_at(err, e->where, "events.%s: %s", e->name, why.text)
             : VS_OK;
}

/* What goes into the event, for the energy audit: a loss, negative where it delivers. between: its
 * two nodes; the current is that of source vvs_s<index>. */
static vs_status add_loss(vs_deck *deck, const vs_occurrence *e, size_t k, const char *between,
                          vs_error *err) {
  char line[300];
  snprintf(line, sizeof line, "*$ loss %s = v(%s)*i(vvs_s%zu)", e->name, between, k);
  return add_account(deck, e, line, err);
}

/* A generator stands at the deck's line. Node `vs_g<index>` is the source's, `vs_l<index>` where
 * its coupling capacitor ends. */
static vs_status at_line(const vs_occurrence *e, size_t index, vs_deck *deck, vs_error *err) {
  char node[VS_DECK_NAME], nodes[2 * VS_DECK_NAME + 1];
  if (!*deck->line[0])
    return vs_fail_at(err, e->where,
                      "events.%s: the deck has no line '*$ line NODE NODE', which says where a %s "
                      "couples in",
                      e->name, e->kind->name);
  snprintf(nodes, sizeof nodes, "%s,%s", deck->line[0], deck->line[1]);
  add_line(deck, e->where, "Vvs_s%zu %s vs_l%zu 0", index, deck->line[0], index);
  vs_status status = add_loss(deck, e, index, nodes, err);
  if (status) return status;
  snprintf(node, sizeof node, "vs_g%zu", index);
  return add_source(deck, e, index, node, deck->line[1], err);
}

/* ---- generators ---- */

static double sign(const vs_occurrence *e) {
  return e->v.polarity % 2 ? -1 : 1;
}

double vs_faults_surge_source(const vs_occurrence *e, double t_s) {
  return t_s > e->start_s + vs_timeline_rounding(t_s) ? sign(e) * 1.06044 * e->v.level_v : 0;
}

/* What a wave needs in its front, in its tail, and while what it stirred up rings. */
static double steps_of(double since_s, double front_s, double tail_s) {
  if (since_s < 0) return INFINITY;
  return since_s < 5 * front_s ? front_s / 20 : since_s < 4 * tail_s ? tail_s / 400 : INFINITY;
}

/* Behind the wave the mains' inductance rings with the 18 uF, at some kHz and tens of amperes: a
 * step of 5 us there leaves 1 mJ in the energy audit, by h di dv/12 of that inductance. */
double vs_faults_surge_longest(const vs_occurrence *e, double t_s) {
  double since = t_s - e->start_s, rings = since >= 0 && since < 600e-6 ? 2e-6 : INFINITY;
  return fmin(steps_of(since, 1.2e-6, 50e-6), rings);
}

vs_status vs_faults_surge_wire(const vs_occurrence *e, size_t k, vs_deck *deck, vs_error *err) {
  vs_status status = at_line(e, k, deck, err);
  if (status) return status;
  const char *back = deck->line[1];
  add_line(deck, e->where, "Cvs_g%zu vs_g%zu vs_h%zu 5.9302u ic=0", k, k, k);
  add_line(deck, e->where, "Rvs_g%zu vs_h%zu %s 20.154", k, k, back);
  add_line(deck, e->where, "Lvs_g%zu vs_h%zu vs_i%zu 10.871u ic=0", k, k, k);
  add_line(deck, e->where, "Rvs_i%zu vs_i%zu vs_o%zu 0.81412", k, k, k);
  add_line(deck, e->where, "Rvs_o%zu vs_o%zu %s 26.151", k, k, back);
  add_line(deck, e->where, "Cvs_o%zu vs_o%zu vs_l%zu 18u ic=0", k, k, k);
  return VS_OK;
}

double vs_faults_ring_source(const vs_occurrence *e, double t_s) {
  double t_us = 1e6 * (t_s - e->start_s);
  if (t_us <= 0 || t_us > 300) return 0; /* 5e-14 of the peak */
  return sign(e) * e->v.level_v * 1.590 * (1 - exp(-t_us / 0.533)) * exp(-t_us / 9.788) *
         cos(2 * M_PI * 0.1 * t_us);
}

double vs_faults_ring_longest(const vs_occurrence *e, double t_s) {
  return steps_of(t_s - e->start_s, 0.5e-6, 10e-6);
}

vs_status vs_faults_ring_wire(const vs_occurrence *e, size_t k, vs_deck *deck, vs_error *err) {
  vs_status status = at_line(e, k, deck, err);
  if (status) return status;
  add_line(deck, e->where, "Rvs_g%zu vs_g%zu vs_o%zu %.17g", k, k, k, e->v.impedance_ohm);
  add_line(deck, e->where, "Cvs_o%zu vs_o%zu vs_l%zu 18u ic=0", k, k, k);
  return VS_OK;
}

/* The pulse of IEC 61000-4-4, its peak 1: t in ns. */
static double eft_pulse(double t_ns) {
  const double v1 = 0.92, rise = 3.5, fall = 51, n = 1.8;
  double scale = exp(-rise / fall * pow(n * fall / rise, 1 / n));
  double x = pow(t_ns / rise, n);
  return t_ns > 0 ? v1 / scale * x / (1 + x) * exp(-t_ns / fall) : 0;
}

/* Time since the last pulse of the burst began, s; negative: none did. */
static double since_pulse(const vs_occurrence *e, double t_s) {
  double n = ceil((t_s - e->start_s) * e->v.frequency_hz) - 1;
  double most = ceil(e->v.duration_s * e->v.frequency_hz) - 1;
  return n < 0 ? -1 : t_s - e->start_s - fmin(n, most) / e->v.frequency_hz;
}

double vs_faults_eft_source(const vs_occurrence *e, double t_s) {
  double since = since_pulse(e, t_s);
  return since > 0 && since < 2e-6 ? sign(e) * e->v.level_v * eft_pulse(1e9 * since) : 0;
}

double vs_faults_eft_edge(const vs_occurrence *e, double t_s) {
  double n = t_s < e->start_s ? 0 : floor((t_s - e->start_s) * e->v.frequency_hz + 1e-9) + 1;
  return n / e->v.frequency_hz < e->v.duration_s ? e->start_s + n / e->v.frequency_hz : INFINITY;
}

double vs_faults_eft_longest(const vs_occurrence *e, double t_s) {
  return steps_of(since_pulse(e, t_s), 5e-9, 50e-9);
}

vs_status vs_faults_eft_wire(const vs_occurrence *e, size_t k, vs_deck *deck, vs_error *err) {
  vs_status status = at_line(e, k, deck, err);
  if (status) return status;
  add_line(deck, e->where, "Rvs_g%zu vs_g%zu vs_o%zu 50", k, k, k);
  add_line(deck, e->where, "Cvs_o%zu vs_o%zu vs_l%zu 33n ic=0", k, k, k);
  return VS_OK;
}

/* ---- switches ---- */

/* Control of the switch: above zero it conducts. What is opened conducts until then. */
double vs_faults_source(const vs_occurrence *e, double t_s) {
  bool then = t_s > e->start_s + vs_timeline_rounding(t_s);
  return (e->kind->wire == vs_faults_open_wire) != then ? 1 : -1;
}

typedef struct element {
  vs_line *line;
  char name[VS_DECK_NAME], node[2][VS_DECK_NAME];
  const char *rest; /* of its line, behind the first node */
} element;

static bool has_two_nodes(const char *line) {
  size_t n = 0;
  const char *kind = vs_rules_instance_of(line, &n);
  char head[4 * VS_DECK_NAME], word[4][VS_DECK_NAME];
  if (!kind) return strchr("rclbdvi", line[0] | 0x20) != NULL;
  snprintf(head, sizeof head, "%.*s", (int)(kind - line), line);
  return sscanf(head, "%63s %63s %63s %63s", word[0], word[1], word[2], word[3]) == 3;
}

static vs_status find_element(vs_deck *deck, const vs_occurrence *e, const char *wanted,
                              element *found, vs_error *err) {
  enum { MOST = 4 * VS_DECK_MOST }; /* names to choose the nearest from */
  const char *names[MOST];
  char text[MOST][VS_DECK_NAME];
  size_t count = 0;
  int depth = 0;
  for (size_t k = 0; k < deck->n_lines; k++) {
    const char *line = deck->lines[k].text;
    depth += !strncasecmp(line, ".subckt", 7) - !strncasecmp(line, ".ends", 5);
    if (depth || *line == '.' || count == MOST) continue;
    element at = {.line = &deck->lines[k]};
    int n = 0;
    if (sscanf(line, "%63s %63s%n %63s", at.name, at.node[0], &n, at.node[1]) != 3) continue;
    if (strcasecmp(at.name, wanted)) {
      snprintf(text[count], sizeof text[0], "%s", at.name);
      names[count] = text[count];
      count++;
      continue;
    }
    if (!has_two_nodes(line))
      return vs_fail_at(err, e->where, "events.%s: %s is no element of two nodes", e->name, wanted);
    at.rest = line + n;
    *found = at;
    return VS_OK;
  }
  const char *nearest = vs_text_nearest(wanted, names, count);
  return vs_fail_at(err, e->where, "events.%s.element: the deck has no element '%s'%s%s%s", e->name,
                    wanted, nearest ? "; did you mean '" : "", nearest ? nearest : "",
                    nearest ? "'?" : "");
}

/* The switch between two nodes, number `index`, and what it takes. */
static vs_status add_switch(vs_deck *deck, const vs_occurrence *e, size_t k,
                            const char *const nodes[2], vs_error *err) {
  char control[VS_DECK_NAME], between[2 * VS_DECK_NAME + 1];
  snprintf(control, sizeof control, "vs_c%zu", k);
  snprintf(between, sizeof between, "%s,%s", nodes[0], nodes[1]);
  vs_status status = add_source(deck, e, k, control, "0", err);
  if (!status) status = add_loss(deck, e, k, between, err);
  if (status) return status;
  add_line(deck, e->where, "Vvs_s%zu %s vs_l%zu 0", k, nodes[0], k);
  add_line(deck, e->where, "Svs_f%zu vs_l%zu %s vs_c%zu 0 vs_f%zu %s", k, k, nodes[1], k, k,
           vs_faults_source(e, 0) > 0 ? "on" : "off");
  add_line(deck, e->where, ".model vs_f%zu sw(ron=1m roff=1g vt=0 vh=0.5)", k);
  return VS_OK;
}

vs_status vs_faults_open_wire(const vs_occurrence *e, size_t k, vs_deck *deck, vs_error *err) {
  element at;
  char node[VS_DECK_NAME], line[1024];
  const char *const nodes[] = {at.node[0], node};
  vs_status status = find_element(deck, e, e->v.element, &at, err);
  if (status) return status;
  snprintf(node, sizeof node, "vs_n%zu", k);
  snprintf(line, sizeof line, "%s vs_n%zu%s", at.name, k, at.rest);
  if (!strcasecmp(at.name, deck->eva))
    snprintf(deck->eva_plus, sizeof deck->eva_plus, "vs_n%zu", k);
  free(at.line->text);
  at.line->text = vs_copy(line);
  status = add_switch(deck, e, k, nodes, err);
  /* an opening contact arcs; without that a coil's current would have nowhere to go */
  add_line(
      deck, e->where,
      "Bvs_a%zu vs_l%zu vs_n%zu I = abs(v(vs_l%zu,vs_n%zu)) < %.17g ? "
      "pwr(v(vs_l%zu,vs_n%zu)/%.17g,30) : sgn(v(vs_l%zu,vs_n%zu))*(1+30*(abs(v(vs_l%zu,vs_n%zu)"
      ")/%.17g-1))",
      k, k, k, k, k, e->v.level_v, k, k, e->v.level_v, k, k, k, k, e->v.level_v);
  add_line(deck, e->where, "Cvs_a%zu vs_l%zu vs_n%zu 100p ic=0", k, k, k);
  return status;
}

/* All the turns: the coil is shorted at its terminals. Some: another EVA, and what goes in at its
 * terminals beyond what the energy audit takes for the coil's is the event's. */
vs_status vs_faults_turns_wire(const vs_occurrence *e, size_t k, vs_deck *deck, vs_error *err) {
  element at;
  char line[1024], control[VS_DECK_NAME], plus[VS_DECK_NAME];
  if (e->v.part >= 1) return vs_faults_short_wire(e, k, deck, err);
  vs_status status = find_element(deck, e, deck->eva, &at, err);
  if (status) return status;
  deck->eva_file = "eva_shorted";
  snprintf(control, sizeof control, "vs_c%zu", k);
  snprintf(line, sizeof line, "%s %s %s %s eva", at.name, at.node[0], at.node[1], control);
  free(at.line->text);
  at.line->text = vs_copy(line);
  add_line(deck, e->where, ".param vs_shorted_part=%.17g", e->v.part);
  snprintf(plus, sizeof plus, "%.50s.whole", deck->eva);
  snprintf(line, sizeof line, "*$ loss %s = v(%s,%s)*i(v.%s.vmain)-v(%s,%s)*i(v.%s.vcoil)", e->name,
           deck->eva_plus, deck->eva_minus, deck->eva, plus, deck->eva_minus, deck->eva);
  memcpy(deck->eva_plus, plus, sizeof plus);
  status = add_account(deck, e, line, err);
  return status ? status : add_source(deck, e, k, control, "0", err);
}

vs_status vs_faults_short_wire(const vs_occurrence *e, size_t k, vs_deck *deck, vs_error *err) {
  element at;
  const char *const nodes[] = {at.node[0], at.node[1]};
  vs_status status = find_element(deck, e, *e->v.element ? e->v.element : deck->eva, &at, err);
  if (status) return status;
  return add_switch(deck, e, k, nodes, err);
}
