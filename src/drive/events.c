/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "drive/events.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "drive/faults.h"
#include "drive/timeline.h"

#define V_(member) offsetof(vs_event_values, member)

/* ---- keys ---- */

#define KIND                                                                                       \
  { "kind", VS_NAME, "", "-", 0, 0, false, V_(kind), "what happens", NULL, NULL }
#define CYCLE                                                                                      \
  { "cycle", VS_COUNT, "", "1", 1, 1e9, false, V_(cycle), "cycle of the mains, from 1", NULL, NULL }
#define AT                                                                                         \
  {"at", VS_REAL, "ms", "0 ms", 0, 1e9, false, V_(at_s), "when it begins; or cycle and angle",     \
   NULL, NULL},                                                                                    \
      CYCLE, {                                                                                     \
    "angle", VS_REAL, "deg", "0 deg", 0, 360, false, V_(angle_rad),                                \
        "from the rising zero crossing of the mains", NULL, NULL                                   \
  }
#define DURATION(value)                                                                            \
  {                                                                                                \
    "duration", VS_REAL, "ms", value, 0, 1e9, true, V_(duration_s), "how long it lasts", NULL,     \
        NULL                                                                                       \
  }
/* YAML has no bare - as a value: it begins a list. The odd ones are negative. */
#define POLARITY                                                                                   \
  {                                                                                                \
    "polarity", VS_CHOICE, "", "+", 0, 0, false, V_(polarity),                                     \
        "of the generator; - in quotes: '-'", "+|-|positive|negative", NULL                        \
  }
#define LEVEL(value, min, max, text)                                                               \
  { "level", VS_REAL, "kV", value, min, max, false, V_(level_v), text, NULL, NULL }
#define PART(key, value, min, max, text)                                                           \
  { key, VS_REAL, "%", value, min, max, false, V_(part), text, NULL, NULL }
#define ELEMENT                                                                                    \
  {                                                                                                \
    "element", VS_NAME, "", "-", 0, 0, false, V_(element),                                         \
        "the deck's, of two nodes: R1, Xeva, Xf2", NULL, NULL                                      \
  }

#define GATE                                                                                       \
  {                                                                                                \
    "gate", VS_NAME, "", "all", 0, 0, false, V_(gate),                                             \
        "the port it acts on: all, gate, gate+180deg", NULL, NULL                                  \
  }

static const vs_field SURGE[] = {
    KIND, AT, LEVEL("1 kV", 0.5, 4, "open-circuit voltage of the generator (IEC 61000-4-5)"),
    POLARITY};
static const vs_field RING_WAVE[] = {
    KIND,
    AT,
    LEVEL("1 kV", 0.25, 6, "open-circuit peak of the generator (IEEE C62.41)"),
    POLARITY,
    {"impedance", VS_REAL, "ohm", "12 ohm", 12, 200, false, V_(impedance_ohm), "of the generator",
     NULL, NULL}};
static const vs_field EFT[] = {
    KIND,
    AT,
    LEVEL("1 kV", 0.25, 4, "open-circuit peak of the generator (IEC 61000-4-4)"),
    POLARITY,
    {"frequency", VS_REAL, "kHz", "5 kHz", 1, 100, false, V_(frequency_hz), "of the pulses", NULL,
     NULL},
    DURATION("15 ms")};
static const vs_field SAG[] = {KIND, AT, DURATION("20 ms"),
                               PART("level", "40 %", 0, 100, "what is left of the voltage")};
static const vs_field SWELL[] = {KIND, AT, DURATION("20 ms"),
                                 PART("level", "120 %", 100, 300, "what it becomes")};
static const vs_field INTERRUPTION[] = {KIND, AT, DURATION("20 ms")};
static const vs_field NOTCH[] = {KIND,
                                 AT,
                                 DURATION("0.5 ms"),
                                 PART("depth", "100 %", 0, 100, "what is gone of the voltage"),
                                 {"count", VS_COUNT, "", "1", 1, 1e6, false, V_(count),
                                  "in so many cycles, one after the other", NULL, NULL}};
static const vs_field PHASE_JUMP[] = {KIND,
                                      AT,
                                      {"jump", VS_REAL, "deg", "30 deg", -180, 180, false,
                                       V_(phase_rad), "the mains go on so much earlier", NULL,
                                       NULL}};
static const vs_field HARMONIC[] = {KIND,
                                    AT,
                                    DURATION("1e8 ms"),
                                    PART("level", "5 %", 0, 100, "of the fundamental's amplitude"),
                                    {"order", VS_COUNT, "", "5", 2, 100, false, V_(order),
                                     "times the mains' frequency", NULL, NULL},
                                    {"phase", VS_REAL, "deg", "0 deg", -360, 360, false,
                                     V_(phase_rad), "at the mains' rising zero crossing", NULL,
                                     NULL}};
static const vs_field MISSING_PULSE[] = {KIND, CYCLE, GATE};
static const vs_field SHORT_PULSE[] = {KIND, CYCLE, DURATION("0.1 ms"), GATE};
static const vs_field WEAK_PULSE[] = {KIND, CYCLE, PART("level", "20 %", 0, 100, "of its voltage"),
                                      GATE};
static const vs_field SPURIOUS_PULSE[] = {KIND, AT, DURATION("0.1 ms"), GATE};
static const vs_field OPEN[] = {KIND, AT, ELEMENT,
                                LEVEL("1 kV", 0.01, 100, "at which the contact arcs (assumed)")};
static const vs_field SHORT[] = {KIND, AT, ELEMENT};
static const vs_field JAM[] = {KIND, AT};
static const vs_field COIL_SHORT[] = {
    KIND,
    AT,
    {"fraction", VS_REAL, "%", "100 %", 1, 100, false, V_(part), "of the turns", NULL, NULL}};

/* ---- what they do to the mains ---- */

/* Has it begun? A step that ends with the edge, to rounding, still sees what was before. */
bool vs_occurrence_is_on(const vs_occurrence *e, double t_s) {
  double slack = vs_timeline_rounding(t_s);
  return t_s > e->start_s + slack && t_s <= e->end_s + slack;
}

static double scaled(const vs_occurrence *e, const vs_timeline *t, double t_s, double angle_rad) {
  (void)t, (void)angle_rad;
  return vs_occurrence_is_on(e, t_s) ? e->v.part : 1;
}

static double interrupted(const vs_occurrence *e, const vs_timeline *t, double t_s,
                          double angle_rad) {
  (void)t, (void)angle_rad;
  return vs_occurrence_is_on(e, t_s) ? 0 : 1;
}

/* The cycle of the notch that t is in or behind, from 0. */
static double notch_number(const vs_occurrence *e, double period_s, double t_s) {
  double n = ceil((t_s - e->start_s) / period_s) - 1;
  return fmin(fmax(n, 0), e->v.count - 1);
}

static double notched(const vs_occurrence *e, const vs_timeline *t, double t_s, double angle_rad) {
  (void)angle_rad;
  double since = t_s - e->start_s - notch_number(e, t->period_s, t_s) * t->period_s;
  double slack = vs_timeline_rounding(t_s);
  return since > slack && since <= e->v.duration_s + slack ? 1 - e->v.part : 1;
}

static double jumped(const vs_occurrence *e, const vs_timeline *t, double t_s, double angle_rad) {
  (void)t, (void)angle_rad;
  return vs_occurrence_is_on(e, t_s) ? e->v.phase_rad : 0;
}

static double distorted(const vs_occurrence *e, const vs_timeline *t, double t_s,
                        double angle_rad) {
  (void)t;
  return vs_occurrence_is_on(e, t_s) ? e->v.part * sin(e->v.order * angle_rad + e->v.phase_rad) : 0;
}

/* ---- what they do at the gate ---- */

static void missing(const vs_occurrence *e, double *width_s, double *voltage) {
  (void)e;
  *width_s = *voltage = 0;
}

static void shorter(const vs_occurrence *e, double *width_s, double *voltage) {
  (void)voltage;
  *width_s = fmin(*width_s, e->v.duration_s);
}

static void weaker(const vs_occurrence *e, double *width_s, double *voltage) {
  (void)width_s;
  *voltage *= e->v.part;
}

/* ---- when ---- */

static double ends(const vs_occurrence *e, double t_s) {
  return t_s < e->start_s ? e->start_s : t_s < e->end_s ? e->end_s : INFINITY;
}

/* Of each repetition; the period follows from the last one's end. */
static double notch_edges(const vs_occurrence *e, double t_s) {
  double period = (e->end_s - e->start_s - e->v.duration_s) / fmax(e->v.count - 1, 1), n = 0;
  if (e->v.count > 1) n = floor((t_s - e->start_s) / period + 1e-9); /* an edge reached is passed */
  n = fmin(fmax(n, 0), e->v.count - 1);
  double start = e->start_s + n * period, end = start + e->v.duration_s;
  if (t_s < e->start_s) return e->start_s;
  if (t_s < end) return end;
  return n + 1 < e->v.count ? start + period : INFINITY;
}

/* ---- the table ---- */

#define KEYS(fields) fields, sizeof fields / sizeof *fields
const vs_event_kind vs_events_kinds[VS_EVENT_KINDS] = {
    {"surge", "1.2/50-8/20 us generator of IEC 61000-4-5 from line to line, through 18 uF",
     KEYS(SURGE), .source = vs_faults_surge_source, .edge = ends,
     .longest = vs_faults_surge_longest, .wire = vs_faults_surge_wire},
    {"ring_wave", "100 kHz ring wave of IEEE C62.41 from line to line", KEYS(RING_WAVE),
     .source = vs_faults_ring_source, .edge = ends, .longest = vs_faults_ring_longest,
     .wire = vs_faults_ring_wire},
    {"eft", "burst of 5/50 ns pulses of IEC 61000-4-4", KEYS(EFT), .source = vs_faults_eft_source,
     .edge = vs_faults_eft_edge, .longest = vs_faults_eft_longest, .wire = vs_faults_eft_wire},
    {"sag", "the mains are lower for a while", KEYS(SAG), .mains = scaled, .stage = VS_MAINS_FACTOR,
     .edge = ends, .ideal = true},
    {"swell", "the mains are higher for a while", KEYS(SWELL), .mains = scaled,
     .stage = VS_MAINS_FACTOR, .edge = ends, .ideal = true},
    {"interruption", "the mains are 0 V for a while", KEYS(INTERRUPTION), .mains = interrupted,
     .stage = VS_MAINS_FACTOR, .edge = ends, .ideal = true},
    {"notch", "a part of the mains' voltage is gone for part of a cycle", KEYS(NOTCH),
     .mains = notched, .stage = VS_MAINS_FACTOR, .edge = notch_edges, .ideal = true},
    {"phase_jump", "the mains jump in phase; the gate's pulses stay where they were",
     KEYS(PHASE_JUMP), .mains = jumped, .stage = VS_MAINS_ANGLE, .edge = ends, .ideal = true},
    {"harmonic", "a harmonic on the mains", KEYS(HARMONIC), .mains = distorted,
     .stage = VS_MAINS_ADDED, .edge = ends, .ideal = true},
    {"missing_pulse", "no gate pulse in that cycle", KEYS(MISSING_PULSE), .at_cycle = true,
     .pulse = missing, .ideal = true},
    {"short_pulse", "a shorter gate pulse in that cycle", KEYS(SHORT_PULSE), .at_cycle = true,
     .pulse = shorter, .ideal = true},
    {"weak_pulse", "a weaker gate pulse in that cycle", KEYS(WEAK_PULSE), .at_cycle = true,
     .pulse = weaker},
    {"spurious_pulse", "one more gate pulse", KEYS(SPURIOUS_PULSE), .adds_pulse = true,
     .edge = ends, .ideal = true},
    {"open", "an element of the deck is cut off", KEYS(OPEN), .source = vs_faults_source,
     .edge = ends, .wire = vs_faults_open_wire},
    {"short", "an element of the deck is shorted", KEYS(SHORT), .source = vs_faults_source,
     .edge = ends, .wire = vs_faults_short_wire},
    {"coil_short", "the EVA's coil is shorted, whole or in part", KEYS(COIL_SHORT),
     .source = vs_faults_source, .edge = ends, .wire = vs_faults_turns_wire},
    {"jam", "the armature is stuck: p stays what it is", KEYS(JAM), .jams = true, .edge = ends,
     .ideal = true},
};

/* ---- reading ---- */

static const vs_event_kind *find_kind(const vs_node *map, const char *name, vs_status *status,
                                      vs_error *err) {
  const char *names[VS_EVENT_KINDS];
  const vs_node *node = vs_tree_child(map, "kind");
  const char *word = node && node->kind == VS_NODE_TEXT ? node->text : "";
  for (size_t k = 0; k < VS_EVENT_KINDS; k++) {
    names[k] = vs_events_kinds[k].name;
    if (!strcmp(word, names[k])) return &vs_events_kinds[k];
  }
  const char *nearest = *word ? vs_text_nearest(word, names, VS_EVENT_KINDS) : NULL;
  vs_text all = {0};
  for (size_t k = 0; k < VS_EVENT_KINDS; k++) vs_text_add(&all, "%s%s", k ? ", " : "", names[k]);
  *status =
      vs_error_carry_on(err, vs_fail_at(err, node ? node->where : map->where,
                                        "events.%s.kind: '%s' is none; there are: %s%s%s%s", name,
                                        word, all.text, nearest ? "; did you mean '" : "",
                                        nearest ? nearest : "", nearest ? "'?" : ""));
  vs_text_free(&all);
  return NULL;
}

/* Its start, from `at` or from cycle and angle, and its end. */
static vs_status place_in_time(const vs_node *map, const vs_timeline *t, double until_s,
                               vs_occurrence *e, vs_error *err) {
  const vs_node *at = vs_tree_child(map, "at"), *cycle = vs_tree_child(map, "cycle"),
                *angle = vs_tree_child(map, "angle");
  if (at && (cycle || angle))
    return vs_fail_at(err, (cycle ? cycle : angle)->key_where,
                      "events.%s: 'at' says when already; cycle and angle are the other way to",
                      e->name);
  if (!at && !cycle)
    return vs_fail_at(err, e->where, "events.%s: 'at', or 'cycle'%s, is wanted: when it begins",
                      e->name, e->kind->at_cycle ? "" : " and 'angle'");
  double turns = e->v.cycle - 1 + e->v.angle_rad / (2 * M_PI);
  e->start_s = at ? e->v.at_s : t->first_zero_s + turns * t->period_s;
  e->end_s = e->v.duration_s > 0 ? e->start_s + e->v.duration_s : INFINITY;
  if (e->v.count > 1) e->end_s += (e->v.count - 1) * t->period_s;
  if (e->start_s < until_s) return VS_OK;
  return vs_fail_at(err, (at ? at : cycle)->where,
                    "events.%s: it would begin at %.6g s, and the run ends at run.until = %g s",
                    e->name, e->start_s, until_s);
}

bool vs_occurrence_at_gate(const vs_occurrence *e, double shift_rad) {
  return isnan(e->gate_rad) || fabs(e->gate_rad - shift_rad) < 1e-9;
}

static vs_status read_gate(const vs_node *map, vs_occurrence *e, vs_error *err) {
  if (!*e->v.gate || !strcmp(e->v.gate, "all") || vs_gate_named(e->v.gate, &e->gate_rad))
    return VS_OK;
  return vs_fail_at(err, vs_tree_child(map, "gate")->where,
                    "events.%s.gate: 'all' or a gate port is wanted, as gate or gate+180deg",
                    e->name);
}

/* What an element's switch acts on has no default. */
static vs_status check_element(const vs_occurrence *e, vs_error *err) {
  bool wanted = e->kind->fields == OPEN || e->kind->fields == SHORT;
  if (!wanted || *e->v.element) return VS_OK;
  return vs_fail_at(err, e->where,
                    "events.%s: 'element' is wanted: the deck's to %s, by its name, as R1", e->name,
                    e->kind->name);
}

/* A repetition comes a cycle after the one before it. */
static vs_status check_count(const vs_node *map, const vs_timeline *t, const vs_occurrence *e,
                             vs_error *err) {
  if (e->v.count <= 1 || e->v.duration_s < t->period_s) return VS_OK;
  return vs_fail_at(err, vs_tree_child(map, "count")->where,
                    "events.%s.count: one of %g ms reaches into the next one; with a count, "
                    "'duration' must be below a cycle, %g ms",
                    e->name, 1e3 * e->v.duration_s, 1e3 * t->period_s);
}

static bool meet(const vs_occurrence *a, const vs_occurrence *b) {
  return a->start_s <= b->end_s && b->start_s <= a->end_s;
}

/* Two of a kind at the same time, where one would hide the other. Generators are none of these:
 * each stands at the line with a coupling of its own, and what they bring adds up. */
static vs_status clash(const vs_events *events, const vs_occurrence *e, vs_error *err) {
  for (size_t k = 0; k < events->count; k++) {
    const vs_occurrence *o = &events->item[k];
    bool gate = vs_occurrence_at_gate(e, o->gate_rad) || vs_occurrence_at_gate(o, e->gate_rad);
    bool cycle = e->kind->pulse && o->kind->pulse && e->v.cycle == o->v.cycle && gate;
    bool mains = e->kind->mains && e->kind == o->kind && e->kind->mains != distorted && meet(e, o);
    bool added = e->kind->adds_pulse && o->kind->adds_pulse && meet(e, o) && gate;
    if (cycle || mains || added)
      return vs_fail_at(err, e->where, "events.%s: it clashes with events.%s: %s", e->name, o->name,
                        cycle ? "the same pulse" : "at the same time");
  }
  return VS_OK;
}

static vs_status read_event(const vs_node *map, const vs_timeline *t, double until_s,
                            vs_events *events, vs_error *err) {
  vs_occurrence e = {.gate_rad = NAN, .where = map->key_where};
  vs_status status = VS_OK;
  snprintf(e.name, sizeof e.name, "%s", map->key);
  if (map->kind != VS_NODE_MAP)
    return vs_error_carry_on(err, vs_fail_at(err, map->where,
                                             "events.%s: a map is wanted: {kind: "
                                             "surge, cycle: 3, angle: 90 deg}",
                                             map->key));
  e.kind = find_kind(map, map->key, &status, err);
  if (!e.kind) return status;
  char section_name[VS_EVENT_NAME + 8];
  snprintf(section_name, sizeof section_name, "events.%s", map->key);
  const vs_section section = {section_name, e.kind->fields, e.kind->n_fields};
  size_t found = vs_error_count(err);
  status = vs_field_section_read(&section, map, &e.v, err);
  if (!strcmp(e.v.element, "-")) *e.v.element = '\0';
  e.v.polarity %= 2; /* the word and the sign are one */
  if (!status && vs_error_count(err) == found)
    status = vs_error_carry_on(err, read_gate(map, &e, err));
  if (!status && vs_error_count(err) == found)
    status = vs_error_carry_on(err, check_element(&e, err));
  if (!status && vs_error_count(err) == found)
    status = vs_error_carry_on(err, check_count(map, t, &e, err));
  if (!status && vs_error_count(err) == found)
    status = vs_error_carry_on(err, place_in_time(map, t, until_s, &e, err));
  if (!status && vs_error_count(err) == found)
    status = vs_error_carry_on(err, clash(events, &e, err));
  if (!status && vs_error_count(err) == found) events->item[events->count++] = e;
  return status;
}

vs_status vs_events_read(const vs_node *map, const vs_timeline *t, double until_s,
                         vs_events *events, vs_error *err) {
  vs_status status = VS_OK;
  *events = (vs_events){0};
  if (!map || (map->kind == VS_NODE_TEXT && !*map->text)) return VS_OK;
  if (map->kind != VS_NODE_MAP)
    return vs_error_carry_on(err,
                             vs_fail_at(err, map->where,
                                        "events: a map of names is wanted: {surge1: {kind: surge, "
                                        "cycle: 3, angle: 90 deg}}"));
  for (const vs_node *n = map->child; n && !status; n = n->next)
    status = events->count < VS_EVENTS_MOST
                 ? read_event(n, t, until_s, events, err)
                 : vs_fail_at(err, n->key_where, "events: more than %d", VS_EVENTS_MOST);
  return status;
}

/* The gate it names is one of the deck's ports. */
static vs_status check_gate(const vs_occurrence *e, const vs_deck *deck, vs_error *err) {
  bool found = isnan(e->gate_rad) || deck->lost & VS_LOST_PORT;
  for (size_t p = 0; p < deck->n_ports && !found; p++) {
    const vs_signal *s = &deck->ports[p].signal;
    found = vs_drives[s->drive].shifts && vs_occurrence_at_gate(e, s->shift_rad);
  }
  return found
             ? VS_OK
             : vs_fail_at(err, e->where, "events.%s: the deck has no port %s", e->name, e->v.gate);
}

/* The element it opens or shorts; "": none. */
static const char *element_of(const vs_occurrence *e, const vs_deck *deck) {
  return e->kind->fields == COIL_SHORT ? deck->eva : e->v.element;
}

/* Two switches at one element would each be put where the other one is not. */
static vs_status check_switch(const vs_events *events, size_t k, const vs_deck *deck,
                              vs_error *err) {
  const vs_occurrence *e = &events->item[k];
  for (size_t n = 0; n < k && *element_of(e, deck); n++)
    if (!strcasecmp(element_of(e, deck), element_of(&events->item[n], deck)))
      return vs_fail_at(err, e->where, "events.%s: it clashes with events.%s: the same element",
                        e->name, events->item[n].name);
  return VS_OK;
}

vs_status vs_events_wire(const vs_events *events, vs_deck *deck, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < events->count && !status; k++)
    status = vs_error_carry_on(err, check_gate(&events->item[k], deck, err));
  size_t found = vs_error_count(err);
  for (size_t k = 0; k < events->count && !status; k++)
    status = vs_error_carry_on(err, check_switch(events, k, deck, err));
  if (vs_error_count(err) > found) return status;
  for (size_t k = 0; k < events->count && !status; k++)
    if (events->item[k].kind->wire)
      status = vs_error_carry_on(err, events->item[k].kind->wire(&events->item[k], k, deck, err));
  return status;
}

double vs_events_edge(const vs_events *events, double t_s) {
  double next = INFINITY;
  for (size_t k = 0; k < events->count; k++)
    if (events->item[k].kind->edge)
      next = fmin(next, events->item[k].kind->edge(&events->item[k], t_s));
  return next;
}

double vs_events_longest(const vs_events *events, double t_s) {
  double longest = INFINITY;
  for (size_t k = 0; k < events->count; k++)
    if (events->item[k].kind->longest)
      longest = fmin(longest, events->item[k].kind->longest(&events->item[k], t_s));
  return longest;
}
