/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/events.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"
#include "base/units.h"

/* ---- the kinds ---- */

/* The tables of kinds, in the order in which they are listed. */
static const vs_event_kind *const TABLES[] = {vs_generators, vs_disturbances, vs_pulses, vs_faults};
enum { N_TABLES = sizeof TABLES / sizeof *TABLES };

const vs_event_kind *vs_events_kind(size_t number) {
  for (size_t t = 0; t < N_TABLES; t++)
    for (const vs_event_kind *kind = TABLES[t]; kind->name; kind++)
      if (number-- == 0) return kind;
  return NULL;
}

const vs_event_kind *vs_events_find(const char *name) {
  const vs_event_kind *kind;
  for (size_t n = 0; (kind = vs_events_kind(n)); n++)
    if (!strcmp(name, kind->name)) return kind;
  return NULL;
}

/* ---- reading ---- */

/* Finds the kind that an event's map names. NULL, with an error in *status: there is none of that
 * name. */
static const vs_event_kind *find_kind(const vs_node *map, const char *name, vs_status *status,
                                      vs_error *err) {
  const vs_node *node = vs_tree_child(map, "kind");
  const char *word = node && node->kind == VS_NODE_TEXT ? node->text : "";
  const vs_event_kind *kind = vs_events_find(word);
  size_t count = 0, n = 0;
  if (kind) return kind;
  while (vs_events_kind(count)) count++;
  const char **names = vs_alloc(count, sizeof *names);
  vs_text all = {0};
  for (; (kind = vs_events_kind(n)); n++) {
    names[n] = kind->name;
    vs_text_add(&all, "%s%s", n ? ", " : "", kind->name);
  }
  *status =
      vs_error_keep(err, vs_fail_at(err, node ? node->where : map->where,
                                    "events.%s.kind: there is no kind '%s'; there are: %s%s", name,
                                    word, all.text, vs_text_hint(word, names, count, "").text));
  vs_text_free(&all);
  free(names);
  return NULL;
}

/* Sets the event's start, from `at` or from cycle and angle, and its end. */
static vs_status place_in_time(const vs_node *map, const vs_timeline *t, vs_scene_event *e,
                               vs_error *err) {
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
  if (e->v.count > 1) e->end_s += (e->v.count - 1) * e->period_s;
  return VS_OK;
}

/* Sets since when a generator's network lies on the line, once its start is known. */
static vs_status place_on_line(const vs_node *map, vs_scene_event *e, vs_error *err) {
  char why[200];
  const vs_node *from = vs_tree_child(map, "from");
  if (!e->kind->network || !strcmp(e->v.from, "start")) return VS_OK;
  if (!strcmp(e->v.from, "strike"))
    e->on_line_s = e->start_s;
  else if (!vs_units_read(e->v.from, "ms", &e->on_line_s, why, sizeof why) || e->on_line_s < 0)
    return vs_fail_at(err, from->where,
                      "events.%s.from: '%s' is none of: start, strike, a time as 15 ms", e->name,
                      e->v.from);
  if (e->on_line_s <= e->start_s) return VS_OK;
  return vs_fail_at(err, from->where,
                    "events.%s.from: its network would come onto the line at %.9g s, behind its "
                    "wave, which begins at %.9g s; let it come before that, or write strike",
                    e->name, e->on_line_s, e->start_s);
}

/* True where the mains cycle, counted from 1, has a firing. */
static bool has_firing(const vs_firing_values *f, int cycle) {
  int behind = cycle - f->first_cycle;
  return f->every > 0 ? behind >= 0 && behind % f->every == 0 : behind == 0;
}

/* Error: the event changes the pulse of a cycle that has none, or would shorten it to more than its
 * length. */
static vs_status check_pulse(const vs_node *map, const vs_timeline *t, const vs_scene_event *e,
                             vs_error *err) {
  const vs_firing_values *f = &t->firing;
  if (!e->kind->pulse) return VS_OK;
  const vs_node *cycle = vs_tree_child(map, "cycle"), *duration = vs_tree_child(map, "duration");
  if (!has_firing(f, e->v.cycle))
    return vs_fail_at(
        err, cycle->where,
        f->every > 0 ? "events.%s: there is no gate pulse in cycle %d; firing.first_cycle = "
                       "%d and firing.every = %d have them in cycles %d, %d, ..."
                     : "events.%s: there is no gate pulse in cycle %d; firing.first_cycle = "
                       "%d and firing.every: once have one",
        e->name, e->v.cycle, f->first_cycle, f->every, f->first_cycle, f->first_cycle + f->every);
  if (e->v.duration_s > f->pulse_width_s)
    return vs_fail_at(err, duration ? duration->where : e->where,
                      "events.%s.duration: %g ms is more than the pulse's own length, "
                      "firing.pulse_width = %g ms",
                      e->name, 1e3 * e->v.duration_s, 1e3 * f->pulse_width_s);
  return VS_OK;
}

static vs_status read_gate(const vs_node *map, vs_scene_event *e, vs_error *err) {
  if (!*e->v.gate || !strcmp(e->v.gate, "all") || vs_port_read_gate(e->v.gate, &e->gate_rad))
    return VS_OK;
  return vs_fail_at(err, vs_tree_child(map, "gate")->where,
                    "events.%s.gate: 'all' or a gate port is wanted, as gate or gate+180deg",
                    e->name);
}

/* Error: an event of this kind needs an element, and none is said. */
static vs_status check_element(const vs_scene_event *e, vs_error *err) {
  if (!e->kind->wants_element || *e->v.element) return VS_OK;
  return vs_fail_at(err, e->where,
                    "events.%s: 'element' is wanted: the deck's to %s, by its name, as R1", e->name,
                    e->kind->name);
}

/* Error: a repetition, which comes a cycle after the one before it, overlaps that one. */
static vs_status check_count(const vs_node *map, const vs_timeline *t, const vs_scene_event *e,
                             vs_error *err) {
  if (e->v.count <= 1 || e->v.duration_s < t->period_s) return VS_OK;
  return vs_fail_at(err, vs_tree_child(map, "count")->where,
                    "events.%s.count: one of %g ms reaches into the next one; with a count, "
                    "'duration' must be below a cycle, %g ms",
                    e->name, 1e3 * e->v.duration_s, 1e3 * t->period_s);
}

static bool events_overlap(const vs_scene_event *a, const vs_scene_event *b) {
  return a->start_s <= b->end_s && b->start_s <= a->end_s;
}

/* Error: the pulses of a generator follow one another faster than the run is long, which has one of
 * them; or another event repeats the run already. */
static vs_status check_times(const vs_node *map, const vs_events *events, double until_s,
                             const vs_scene_event *e, vs_error *err) {
  const vs_scene_event *other = vs_scene_event_repeated(events);
  if (e->v.times <= 1) return VS_OK;
  const vs_node *times = vs_tree_child(map, "times"), *every = vs_tree_child(map, "every");
  if (e->v.every_s < until_s)
    return vs_fail_at(err, (every ? every : times)->where,
                      "events.%s.every: %g s is less than the run, of run.until = %g s, which has "
                      "one of the pulses; let the run be shorter, or 'every' longer",
                      e->name, e->v.every_s, until_s);
  return other ? vs_fail_at(err, times->where,
                            "events.%s.times: events.%s repeats the run already; leave one of the "
                            "two out",
                            e->name, other->name)
               : VS_OK;
}

/* Error: the event and one before it act at the same time, and one would hide the other. Generators
 * do not: each is coupled to the line on its own, and what they bring adds up. */
static vs_status clash(const vs_events *events, const vs_scene_event *e, vs_error *err) {
  for (size_t k = 0; k < events->count; k++) {
    const vs_scene_event *o = &events->item[k];
    bool gate = vs_scene_event_at_gate(e, o->gate_rad) || vs_scene_event_at_gate(o, e->gate_rad);
    bool cycle = e->kind->pulse && o->kind->pulse && e->v.cycle == o->v.cycle && gate;
    bool mains = e->kind->mains && e->kind == o->kind && !e->kind->adds_up && events_overlap(e, o);
    bool added = e->kind->adds_pulse && o->kind->adds_pulse && events_overlap(e, o) && gate;
    if (cycle || mains || added)
      return vs_fail_at(err, e->where, "events.%s: it clashes with events.%s: %s", e->name, o->name,
                        cycle ? "the same pulse" : "at the same time");
  }
  return VS_OK;
}

/* Error: the event acts on what the scene's supply and valve have not. */
static vs_status check_supply(const vs_timeline *t, const vs_scene_event *e, vs_error *err) {
  const vs_event_kind *kind = e->kind;
  if (t->supply.direct && kind->mains && kind->stage != VS_MAINS_FACTOR)
    return vs_fail_at(err, e->where,
                      "events.%s: supply.kind: step is direct voltage, to which a %s is nothing; "
                      "take a sag, a swell, an interruption or a notch",
                      e->name, kind->name);
  if (t->firing.no_valve && (kind->pulse || kind->adds_pulse))
    return vs_fail_at(err, e->where,
                      "events.%s: with firing.valve: none there is no gate for a %s; leave the "
                      "event or the key out",
                      e->name, kind->name);
  return VS_OK;
}

/* Reads one event, to `built` or `unbuilt`. What is not built may be wrong with the rest of the
 * scene.
 */
static vs_status read_event(const vs_node *map, const vs_timeline *t, double until_s,
                            vs_events *events, vs_error *err) {
  vs_scene_event e = {.period_s = t->period_s, .gate_rad = NAN, .where = map->key_where};
  vs_status status = VS_OK;
  snprintf(e.name, sizeof e.name, "%s", map->key);
  if (map->kind != VS_NODE_MAP)
    return vs_error_keep(err, vs_fail_at(err, map->where,
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
  e.v.polarity %= 2; /* + and positive are the same choice, and so are - and negative */
  if (!status && vs_error_count(err) == found)
    status = vs_error_keep(err, place_in_time(map, t, &e, err));
  if (!status && vs_error_count(err) == found && (e.v.off || !(e.start_s < until_s))) {
    events->unbuilt[events->n_unbuilt++] = e;
    return status;
  }
  if (!status && vs_error_count(err) == found) status = vs_error_keep(err, read_gate(map, &e, err));
  if (!status && vs_error_count(err) == found) status = vs_error_keep(err, check_element(&e, err));
  if (!status && vs_error_count(err) == found)
    status = vs_error_keep(err, check_supply(t, &e, err));
  if (!status && vs_error_count(err) == found)
    status = vs_error_keep(err, check_count(map, t, &e, err));
  if (!status && vs_error_count(err) == found)
    status = vs_error_keep(err, place_on_line(map, &e, err));
  if (!status && vs_error_count(err) == found)
    status = vs_error_keep(err, check_times(map, events, until_s, &e, err));
  if (!status && vs_error_count(err) == found)
    status = vs_error_keep(err, check_pulse(map, t, &e, err));
  if (!status && vs_error_count(err) == found) status = vs_error_keep(err, clash(events, &e, err));
  if (!status && vs_error_count(err) == found) events->item[events->count++] = e;
  return status;
}

vs_status vs_events_read(const vs_node *map, const vs_timeline *t, double until_s,
                         vs_events *events, vs_error *err) {
  vs_status status = VS_OK;
  events->count = events->n_unbuilt = 0;
  if (!map || (map->kind == VS_NODE_TEXT && !*map->text)) return VS_OK;
  if (map->kind != VS_NODE_MAP)
    return vs_error_keep(err, vs_fail_at(err, map->where,
                                         "events: a map of names is wanted: {surge1: {kind: surge, "
                                         "cycle: 3, angle: 90 deg}}"));
  for (const vs_node *n = map->child; n && !status; n = n->next)
    status = events->count + events->n_unbuilt < VS_EVENTS_MOST
                 ? read_event(n, t, until_s, events, err)
                 : vs_fail_at(err, n->key_where, "events: more than %d", VS_EVENTS_MOST);
  return status;
}

/* Error: the gate that the event names is none of the deck's ports. */
static vs_status check_gate(const vs_scene_event *e, const vs_deck *deck, vs_error *err) {
  bool found = isnan(e->gate_rad) || deck->lost & VS_LOST_PORT;
  for (size_t p = 0; p < deck->n_ports && !found; p++) {
    const vs_signal *s = &deck->ports[p].signal;
    found = vs_port_is_gated(s) && vs_scene_event_at_gate(e, s->shift_rad);
  }
  return found
             ? VS_OK
             : vs_fail_at(err, e->where, "events.%s: the deck has no port %s", e->name, e->v.gate);
}

/* The element of the deck that the event changes; "": none. */
static const char *element_of(const vs_scene_event *e, const vs_deck *deck) {
  return e->kind->element ? e->kind->element(e, deck) : "";
}

/* Error: an event before this one changes the same element. Each would be wired as if the other
 * were not there. */
static vs_status check_switch(const vs_events *events, size_t k, const vs_deck *deck,
                              vs_error *err) {
  const vs_scene_event *e = &events->item[k];
  for (size_t n = 0; n < k && *element_of(e, deck); n++)
    if (!strcasecmp(element_of(e, deck), element_of(&events->item[n], deck)))
      return vs_fail_at(err, e->where, "events.%s: it clashes with events.%s: the same element",
                        e->name, events->item[n].name);
  return VS_OK;
}

vs_status vs_events_wire(const vs_events *events, vs_deck *deck, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < events->count && !status; k++)
    status = vs_error_keep(err, check_gate(&events->item[k], deck, err));
  size_t found = vs_error_count(err);
  for (size_t k = 0; k < events->count && !status; k++)
    status = vs_error_keep(err, check_switch(events, k, deck, err));
  if (vs_error_count(err) > found) return status;
  for (size_t k = 0; k < events->count && !status; k++)
    if (events->item[k].kind->wire)
      status = vs_error_keep(err, events->item[k].kind->wire(&events->item[k], k, deck, err));
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
