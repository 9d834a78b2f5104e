/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/timeline.h"

#include <math.h>
#include <string.h>

static const char NO_VALVE[] = "with firing.valve: none";

/* Error: a key of the firing where there is nothing to fire, or of a sine where the voltage is
 * direct. `why` tells why nothing fires. */
static vs_status refuse_unused(const vs_node *scene, const vs_timeline *t, const char *why,
                               vs_error *err) {
  const vs_node *firing = vs_tree_child(scene, "firing"), *supply = vs_tree_child(scene, "supply");
  const vs_node *phase = t->supply.direct ? vs_tree_child(supply, "phase") : NULL;
  const bool has_keys =
      firing && firing->kind == VS_NODE_MAP; /* another kind is refused elsewhere */
  for (const vs_node *n = has_keys ? firing->child : NULL; n; n = n->next)
    if (strcmp(n->key, "valve") != 0 || why != NO_VALVE)
      return vs_fail_at(err, n->key_where, "firing.%s: %s nothing fires; leave it out%s", n->key,
                        why,
                        why == NO_VALVE && !vs_tree_child(firing, "valve")
                            ? ", or write firing.valve: thyristor and supply.kind: sine, as the "
                              "machine has neither"
                            : "");
  return phase ? vs_fail_at(err, phase->key_where,
                            "supply.phase: with supply.kind: step the voltage is direct; leave it "
                            "out")
               : VS_OK;
}

/* The section with the machine's defaults; without, where there is no machine that could be read.
 */
static const vs_section *section_of(const vs_machine *machine, bool firing) {
  const vs_section *plain = firing ? &vs_feed_firing : &vs_feed_supply;
  if (!machine || machine->lost) return plain;
  return firing ? &machine->firing : &machine->supply;
}

/* Error: neither the scene nor the machine's file says what the coil is fed from, or how it is
 * fired, and what another machine takes may be too much for it. Scenes that the program makes up
 * stand in no file, and defaults alone (scene NULL) in no scene; nothing is run of them. */
static vs_status require_feed(const vs_node *scene, const vs_timeline *t, const vs_machine *machine,
                              vs_error *err) {
  const vs_node *named = vs_tree_child(vs_tree_child(scene, "machine"), "model");
  const vs_node *supply = vs_tree_child(scene, "supply"), *firing = vs_tree_child(scene, "firing");
  const bool fed =
      vs_tree_child(supply, "voltage") || vs_tree_child(machine->own_supply, "voltage");
  const bool fired = t->firing.no_valve || vs_tree_child(firing, "angle") ||
                     vs_tree_child(machine->own_firing, "angle") || vs_tree_child(scene, "control");
  if (!scene || !scene->where.file || machine->lost || (fed && fired)) return VS_OK;
  return vs_fail_at(err, named ? named->where : scene->where,
                    "machine %s: neither its file nor the scene says %s; write %s into the scene, "
                    "or into the machine's file",
                    machine->path,
                    fed     ? "how it is fired"
                    : fired ? "which voltage it is fed from"
                            : "which voltage it is fed from, nor how it is fired",
                    fed     ? "firing: {angle: ... deg} or firing: {valve: none}"
                    : fired ? "supply: {voltage: ... V}"
                            : "supply: {voltage: ... V} and firing: {angle: ... deg}");
}

vs_status vs_timeline_build(const vs_node *scene, const vs_machine *machine, vs_timeline *t,
                            vs_section_cache *memo, vs_error *err) {
  t->events.count = t->events.n_unbuilt = 0; /* its items are many, and count no more */
  t->program = NULL;
  t->spares = NULL;
  size_t found = vs_error_count(err);
  const vs_node *firing = vs_tree_child(scene, "firing");
  vs_status s =
      vs_section_cache_read(memo, section_of(machine, false), vs_tree_child(scene, "supply"),
                            &t->supply, sizeof t->supply, err);
  if (!s)
    s = vs_section_cache_read(memo, section_of(machine, true), firing, &t->firing, sizeof t->firing,
                              err);
  const vs_node *pwm = vs_tree_child(scene, vs_pwm_section.name);
  if (!s) s = vs_section_cache_read(memo, &vs_pwm_section, pwm, &t->pwm, sizeof t->pwm, err);
  if (s) return s;
  t->peak_v = t->supply.voltage_v * (t->supply.direct ? 1 : M_SQRT2);
  t->omega_rad_s = 2 * M_PI * t->supply.frequency_hz;
  t->period_s = 1 / t->supply.frequency_hz;
  double turns = -t->supply.phase_rad / (2 * M_PI);
  t->first_zero_s = (turns - floor(turns)) * t->period_s;
  if (vs_error_count(err) > found) return VS_OK;
  s = vs_error_keep(err, vs_pwm_check(pwm, &t->pwm, err));
  if (s || t->supply.direct) return s;
  if (t->firing.no_valve) return refuse_unused(scene, t, NO_VALVE, err);
  if (t->firing.every && t->firing.pulse_width_s >= t->firing.every * t->period_s) {
    return vs_fail_at(
        err, vs_tree_place(scene, "firing.pulse_width"),
        "firing.pulse_width: %g ms reaches into the next pulse; allowed here: below %g ms",
        1e3 * t->firing.pulse_width_s, 1e3 * t->firing.every * t->period_s);
  }
  return VS_OK;
}

/* True if the scene's firing drives something: a gate of the deck, or the thyristor of an ideal
 * tier, which no deck with pulse-width modulation is run on. */
static bool is_fired(const vs_deck *deck) {
  return vs_deck_has_port(deck, vs_port_is_gated) || !vs_deck_has_port(deck, vs_port_is_modulated);
}

vs_status vs_timeline_settle(const vs_node *scene, const vs_machine *machine, vs_timeline *t,
                             const vs_deck *deck, vs_error *err) {
  bool no_valve = t->firing.no_valve;
  if (!is_fired(deck)) t->firing.no_valve = 1;
  const vs_status lacks = require_feed(scene, t, machine, err);
  if (lacks) return lacks;
  if (t->supply.direct && !t->firing.no_valve)
    return vs_fail_at(
        err, vs_tree_place(scene, "supply.kind"),
        "supply.kind: step%s is a direct voltage, which has no cycles for a "
        "thyristor to fire in; write firing.valve: none, or supply.kind: sine",
        vs_tree_child(vs_tree_child(scene, "supply"), "kind") ? "" : ", of the machine's file,");
  if (no_valve && !t->supply.direct) return VS_OK; /* vs_timeline_build has looked */
  return t->firing.no_valve
             ? refuse_unused(scene, t, no_valve ? NO_VALVE : "the deck has no port gate, and", err)
             : VS_OK;
}

/* The numbers of all events of a stage, multiplied where they are factors, else added. */
static double staged(const vs_timeline *t, vs_mains_stage stage, double t_s, double angle_rad) {
  double number = stage == VS_MAINS_FACTOR ? 1 : 0;
  for (size_t k = 0; k < t->events.count; k++) {
    const vs_scene_event *e = &t->events.item[k];
    if (!e->kind->mains || e->kind->stage != stage) continue;
    double own = e->kind->mains(e, t_s, angle_rad);
    number = stage == VS_MAINS_FACTOR ? number * own : number + own;
  }
  return number;
}

double vs_timeline_voltage(const vs_timeline *t, double t_s) {
  double angle = t->omega_rad_s * t_s + t->supply.phase_rad;
  if (t->supply.direct) return t->peak_v * staged(t, VS_MAINS_FACTOR, t_s, angle);
  if (!t->events.count) return t->peak_v * sin(angle);
  angle += staged(t, VS_MAINS_ANGLE, t_s, angle);
  return t->peak_v * (sin(angle) + staged(t, VS_MAINS_ADDED, t_s, angle)) *
         staged(t, VS_MAINS_FACTOR, t_s, angle);
}

double vs_timeline_stage(const vs_timeline *t, vs_mains_stage stage, double t_s) {
  return staged(t, stage, t_s, 0); /* only harmonics ask for the angle */
}

double vs_timeline_phase(const vs_timeline *t, double t_s) {
  double turns = (t_s - t->first_zero_s) / t->period_s;
  return 2 * M_PI * (turns - floor(turns));
}
