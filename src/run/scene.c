/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/scene.h"

#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "engine/tiers.h"
#include "run/sections.h"

const vs_shelf vs_scene_shelf = {"scene", "scenes", ".yaml"},
               vs_scene_study_shelf = {"study", "studies", ".yaml"},
               vs_scene_fit_shelf = {"fit", "fits", ".yaml"};

static vs_status unknown_probe(const vs_scene *s, const vs_node *node, vs_error *err) {
  vs_frame full = vs_sim_frame(vs_tiers_automatic(true), &s->setup);
  const char *names[VS_CH_MOST];
  size_t n = 0;
  const char *name = node->kind == VS_NODE_TEXT ? node->text : "a list or map";
  /* a check carries on: it may be that one */
  if (s->setup.deck.lost & VS_LOST_PROBE || s->setup.machine->lost) return VS_OK;
  if (vs_channel_find(&full, name) >= 0)
    return vs_fail_at(err, node->where,
                      "record: probe %s exists only on tier %s, and this is tier %s", name,
                      vs_tiers_circuit(), s->tier->name);
  int numbers[VS_CH_MOST], listed = vs_channel_listed(&full, numbers);
  for (int k = 0; k < listed; k++) names[n++] = vs_channel_at(&full, numbers[k]).name;
  for (int k = 0; k < s->instruments.count; k++)
    if (!strcmp(name, s->instruments.item[k].column))
      return vs_fail_at(err, node->where,
                        "record: %s is an instrument's column, which comes along by itself; leave "
                        "it out",
                        name);
  return vs_fail_at(err, node->where, "record: no probe '%s'%s", name,
                    vs_text_hint(name, names, n, "; see 'vibrospice list probes'").text);
}

static vs_status take_probe(vs_scene *s, const vs_node *node, vs_error *err) {
  int channel = node->kind == VS_NODE_TEXT ? vs_channel_find(&s->frame, node->text) : -1;
  if (channel < 0) return unknown_probe(s, node, err);
  for (int k = 0; k < s->n_record; k++)
    if (s->record[k] == channel)
      return vs_fail_at(err, node->where,
                        "record: probe %s stands here a second time; leave one out", node->text);
  s->record[s->n_record++] = channel;
  return VS_OK;
}

const char vs_scene_all_probes[] = "all";

/* Reads `record`, the probes that run.csv has, into s->record: all (also where the key is missing
 * or empty), one NAME, or a list [NAME, ...]. Does not empty s->record first. */
static vs_status read_record(vs_scene *s, vs_error *err) {
  const vs_node *node = vs_tree_child(s->tree.root, "record");
  if (!node ||
      (node->kind == VS_NODE_TEXT && (!*node->text || !strcmp(node->text, vs_scene_all_probes)))) {
    s->n_record = vs_channel_listed(&s->frame, s->record);
    return VS_OK;
  }
  if (node->kind == VS_NODE_MAP || (node->kind == VS_NODE_LIST && !node->child))
    return vs_fail_at(err, node->where,
                      "record: 'all' or a list of probes is wanted: [p, i, v_ak]");
  if (node->kind == VS_NODE_TEXT) return take_probe(s, node, err);
  vs_status status = VS_OK;
  for (const vs_node *item = node->child; item && !status; item = item->next)
    status = vs_error_keep(err, take_probe(s, item, err));
  return status;
}

/* measured: {NAME: VALUE UNIT, ...} */
static vs_status read_measured(vs_scene *s, vs_error *err) {
  const vs_node *map = vs_tree_child(s->tree.root, "measured");
  vs_measure all[VS_MOST_MEASURES];
  const char *names[VS_MOST_MEASURES];
  size_t count = 0;
  if (map && map->kind == VS_NODE_TEXT && !*map->text) map = NULL;
  if (map && map->kind != VS_NODE_MAP)
    return vs_fail_at(err, map->where, "measured: a map is wanted: {i_peak: 0.95 A, ...}");
  for (; vs_measure_at(&s->setup.model, (int)count, &all[count]); count++)
    names[count] = all[count].name;
  vs_status status = vs_field_known_keys(map, "measured", names, count, err);
  for (size_t k = 0; k < count && !status; k++) {
    const vs_node *node = vs_tree_child(map, names[k]);
    char why[256];
    if (!node) continue;
    s->measured[k].known = true;
    if (node->kind != VS_NODE_TEXT ||
        !vs_units_read(node->text, all[k].unit, &s->measured[k].value, why, sizeof why))
      status =
          vs_error_keep(err, vs_fail_at(err, node->where, "measured.%s: %s", names[k],
                                        node->kind == VS_NODE_TEXT ? why : "one value is wanted"));
  }
  return status;
}

static vs_status check_tolerance(const vs_scene *s, vs_error *err) {
  if (s->setup.run.tolerance >= s->tier->finest ||
      !vs_tier_choice_is_known(s->tree.root, &s->setup))
    return VS_OK;
  return vs_fail_at(err, vs_tree_place(s->tree.root, "run.tolerance"),
                    "run.tolerance: %g is finer than tier %s can hold; allowed there: %g..0.1",
                    s->setup.run.tolerance, s->tier->name, s->tier->finest);
}

enum { MOST_ROWS = 1000000000 }; /* of run.csv: some hundred gigabytes */

static vs_status check_rows_of_csv(const vs_scene *s, vs_error *err) {
  const vs_run_values *run = &s->setup.run;
  const vs_node *map = vs_tree_child(s->tree.root, "run"), *node = vs_tree_child(map, "sample");
  if (run->until_s / run->sample_s <= MOST_ROWS) return VS_OK;
  return vs_fail_at(err, node ? node->where : vs_tree_place(s->tree.root, "run.until"),
                    "run.sample: %g ms makes %.3g rows up to run.until = %g s; allowed there: "
                    "at least %g ms, for %d rows",
                    1e3 * run->sample_s, run->until_s / run->sample_s, run->until_s,
                    1e3 * run->until_s / MOST_ROWS, MOST_ROWS);
}

/* What the control's observer is not told. */
static void warn_of_observer(vs_scene *s) {
  const vs_node *section = vs_tree_child(s->tree.root, vs_control_section.name);
  const vs_state_observer *o = &s->control.observing;
  char text[512];
  if (o->system && vs_state_observer_note(o, &s->setup, text, sizeof text))
    vs_fail_at(vs_warnings_add(&s->warnings), section->key_where, "%s", text);
}

static void take_control_off(vs_scene *s) {
  const vs_node *section = vs_tree_child(s->tree.root, vs_control_section.name);
  if (!s->control.regulator) return;
  s->control.regulator = NULL;
  vs_fail_at(vs_warnings_add(&s->warnings), section->key_where,
             "control: it is off here: the orbit is that of the angle firing.angle = %g deg",
             s->setup.timeline.firing.angle.first / vs_units_factor("deg"));
}

/* Finds the warnings anew. */
static void find_warnings(vs_scene *s) {
  s->warnings.count = 0;
  vs_warnings_of_scene(s->tree.root, &s->setup, &s->frame, &s->warnings);
  vs_warnings_of_instruments(&s->instruments, &s->warnings);
  vs_warnings_of_control(s->tree.root, &s->setup, &s->control, &s->instruments, &s->warnings);
  warn_of_observer(s);
  if (s->held) take_control_off(s);
}

void vs_scene_disable_control(vs_scene *s) {
  s->held = true;
  take_control_off(s);
}

void vs_scene_warn(const vs_scene *s) {
  for (size_t k = 0; k < s->warnings.count; k++)
    fprintf(stderr, "vibrospice: warning: %s\n", vs_warnings_text(&s->warnings.item[k]));
}

vs_status vs_scene_open(const char *name, vs_where where, vs_scene *s, vs_error *err) {
  if (s->opened) *s = (vs_scene){0};
  s->opened = true;
  vs_status status = vs_path_find(&vs_scene_shelf, name, where, s->path, err);
  return status ? status : vs_tree_read(s->path, &s->tree, err);
}

/* `start: steady` wants a tier that knows orbits. */
static vs_status check_start(const vs_scene *s, vs_error *err) {
  if (!s->setup.steady || !vs_tier_choice_is_known(s->tree.root, &s->setup)) return VS_OK;
  return vs_tiers_require_orbits("start: steady", s->tier, s->why,
                                 vs_tree_place(s->tree.root, "start"), err);
}

/* What follows from the setup. */
static vs_status follow_from_setup(vs_scene *s, const char *tier, vs_error *err) {
  vs_status status = vs_tier_choice_make(s->tree.root, &s->setup, tier, &s->tier, s->why, err);
  if (status) return status;
  s->frame = vs_sim_frame(s->tier, &s->setup);
  status = vs_tier_choice_check(s->tree.root, &s->setup, s->tier, s->why, err);
  if (!status) status = vs_error_keep(err, check_start(s, err));
  if (!status) status = vs_error_keep(err, check_tolerance(s, err));
  if (!status) status = vs_error_keep(err, check_rows_of_csv(s, err));
  return status;
}

/* Reads what names channels, of which another tier has others. */
static vs_status read_instruments(vs_scene *s, vs_error *err) {
  const vs_node *currents = vs_tree_child(s->tree.root, "quality");
  vs_status status =
      vs_quality_read(currents, &s->setup, &s->frame, s->of_period, &s->quality, err);
  if (!status && s->tier->has_circuit)
    status = vs_expect_read(s->tree.root, &s->setup.deck, &s->expects, err);
  const vs_node *ratings = vs_tree_child(s->tree.root, "ratings");
  if (!status) status = vs_ratings_read(ratings, &s->setup, &s->quality, &s->ratings, err);
  if (status) return status;
  const vs_node *section = vs_tree_child(s->tree.root, "instruments");
  status = vs_instruments_read(section, &s->setup, &s->frame, &s->instruments, err);
  section = vs_tree_child(s->tree.root, vs_control_section.name);
  return status ? status : vs_control_read(section, &s->setup, &s->instruments, &s->control, err);
}

vs_status vs_scene_read_sections(vs_scene *s, const char *tier, vs_error *err) {
  vs_status status =
      vs_field_known_keys(s->tree.root, "a scene", vs_section_keys, VS_SECTION_KEYS, err);
  s->tier_named = tier;
  s->order = vs_tiers_order;
  if (!status) status = vs_setup_build(s->tree.root, &s->setup, err);
  if (!status) status = follow_from_setup(s, tier, err);
  if (status) return status;
  status = read_instruments(s, err);
  if (!status) status = vs_error_keep(err, read_record(s, err));
  if (!status) status = read_measured(s, err);
  find_warnings(s);
  return status;
}

vs_status vs_scene_reread(vs_scene *s, vs_error *err) {
  if (!vs_setup_keeps_deck(s->tree.root, &s->setup)) s->order.tried = false;
  vs_status status = vs_setup_again(s->tree.root, &s->setup, err);
  if (!status) status = follow_from_setup(s, NULL, err);
  if (!status) status = read_instruments(s, err);
  if (!status) find_warnings(s);
  return status;
}

vs_status vs_scene_with(const vs_scene *s, const char *const *keys, size_t n_keys, vs_scene *other,
                        vs_error *err) {
  *other = (vs_scene){0};
  memcpy(other->path, s->path, sizeof other->path);
  other->allow_code = s->allow_code;
  other->held = s->held;
  other->of_period = s->of_period;
  vs_tree_copy(&s->tree, &other->tree);
  const char *tier = s->tier_named;
  vs_status status = VS_OK;
  for (size_t k = 0; k < n_keys && !status; k++) {
    if (!strncmp(keys[k], "run.tier=", 9)) tier = NULL;
    status = vs_tree_set(&other->tree, keys[k], err);
  }
  if (!status) status = vs_scene_read_sections(other, tier, err);
  return status || !s->asks ? status : vs_scene_take_circuit(other, s->asks, err);
}

vs_status vs_scene_read(const char *name, char *const *sets, size_t n_sets, const char *tier,
                        vs_scene *s, vs_error *err) {
  vs_status status = vs_scene_open(name, (vs_where){0}, s, err);
  for (size_t k = 0; k < n_sets && !status; k++)
    status = vs_error_keep(err, vs_tree_set(&s->tree, sets[k], err));
  return status ? status : vs_scene_read_sections(s, tier, err);
}

vs_status vs_scene_take_circuit(vs_scene *s, const char *asks, vs_error *err) {
  const char *tier = s->tier_named;
  s->asks = asks;
  if (s->tier->by_ngspice) return VS_OK;
  if (tier ? strcmp(tier, "auto") != 0 : s->setup.run.tier > 0) {
    /* where --tier says so, the scene has no place of it */
    const vs_where where = tier ? (vs_where){0} : vs_tree_place(s->tree.root, "run.tier");
    return vs_fail_at(
        err, where, "%s: only tier %s can do that, and this is tier %s (%s); take tier %s or auto",
        asks, vs_tiers_circuit(), s->tier->name, s->why, vs_tiers_circuit());
  }
  s->tier = vs_tiers_automatic(true);
  snprintf(s->why, sizeof s->why, "auto: %s asks for it", asks);
  s->frame = vs_sim_frame(s->tier, &s->setup);
  find_warnings(s);
  s->n_record = 0;
  vs_status status = vs_tier_choice_check(s->tree.root, &s->setup, s->tier, s->why, err);
  if (!status) status = check_start(s, err);
  if (!status) status = check_tolerance(s, err);
  if (!status) status = read_instruments(s, err); /* another tier has other channels */
  return status ? status : read_record(s, err);
}

void vs_scene_free(vs_scene *s) {
  vs_control_free(&s->control);
  vs_instruments_free(&s->instruments);
  vs_warnings_free(&s->warnings);
  vs_setup_free(&s->setup);
  vs_tree_free(&s->tree);
}
