/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/cooling.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "netlist/devices.h"
#include "netlist/parts.h"

/* The default is the temperature at which sheets give what they do not give for a hot junction. */
const vs_field vs_cooling_ambient = {.key = "ambient",
                                     .kind = VS_REAL,
                                     .unit = "degC",
                                     .default_text = "25 degC",
                                     .min = -60,
                                     .max = 200,
                                     .offset = offsetof(vs_cooling, ambient_degc),
                                     .text = "temperature of the air around the devices"},
               vs_cooling_heatsink = {
                   .key = "heatsink",
                   .kind = VS_REAL,
                   .unit = "K/W",
                   .default_text = "none",
                   .min = 0,
                   .max = 1e4,
                   .open = true,
                   .text = "thermal resistance from a device's heat sink to the ambient"};

/* ---- reading ---- */

static vs_status refuse_unknown_device(const vs_node *node, const vs_deck *deck, vs_error *err) {
  const char *names[VS_DECK_DEVICES];
  for (size_t k = 0; k < deck->n_devices; k++) names[k] = deck->devices[k].name;
  return vs_fail_at(
      err, node->key_where, "heatsink: the deck has no device '%s'%s", node->key,
      vs_text_hint(node->key, names, deck->n_devices, "; see 'vibrospice list measures'").text);
}

/* Error: of such a device no junction is told, or its part states no thermal resistance. */
static vs_status check_resistance(const vs_node *node, const vs_deck *deck, const vs_device *d,
                                  vs_error *err) {
  bool junction = false;
  unsigned unsure = 0;
  for (size_t k = 0; d->kind && k < d->kind->n_measures; k++)
    junction = junction || d->kind->measures[k].how == VS_R_HOTTEST;
  if (!junction)
    return vs_fail_at(err, node->key_where,
                      "heatsink: %s is a %s, of which no junction is told; 'vibrospice list kinds' "
                      "shows which kinds have a measure t_j",
                      d->name, d->kind ? d->kind->name : "device without a kind");
  if (isfinite(vs_devices_r_th(deck, d, "r_th_jc", &unsure))) return VS_OK;
  const char *file = d->part < 0 ? NULL : deck->parts[d->part].file;
  return vs_fail_at(err, node->key_where,
                    "heatsink: nothing says how the junction of %s heats its case; lines '*$ zth R "
                    "K/W TAU s' or '*$ limit r_th_jc = R K/W' are wanted in %s",
                    d->name, file ? file : "a part's file, and the device has no part");
}

static vs_status read_sink(const vs_node *node, const vs_deck *deck, vs_cooling *cooling,
                           vs_error *err) {
  char why[256];
  double k_per_w = 0;
  size_t k = 0;
  while (k < deck->n_devices && strcmp(deck->devices[k].name, node->key)) k++;
  if (k == deck->n_devices) return refuse_unknown_device(node, deck, err);
  if (node->kind != VS_NODE_TEXT)
    return vs_fail_at(err, node->where, "heatsink.%s: one thermal resistance is wanted, as 12 K/W",
                      node->key);
  if (!vs_units_read(node->text, "K/W", &k_per_w, why, sizeof why))
    return vs_fail_at(err, node->where, "heatsink.%s: %s", node->key, why);
  if (!(k_per_w > 0) || k_per_w > vs_cooling_heatsink.max)
    return vs_fail_at(err, node->where,
                      "heatsink.%s: '%s' is out of range; allowed: above 0, up to %g K/W",
                      node->key, node->text, vs_cooling_heatsink.max);
  vs_status status = check_resistance(node, deck, &deck->devices[k], err);
  if (!status) cooling->sink_k_per_w[k] = k_per_w;
  return status;
}

static vs_status read_sinks(const vs_node *map, const vs_deck *deck, vs_cooling *cooling,
                            vs_error *err) {
  vs_status status = VS_OK;
  if (map->kind == VS_NODE_TEXT && !*map->text) return VS_OK;
  if (map->kind != VS_NODE_MAP)
    return vs_error_keep(
        err, vs_fail_at(err, map->where,
                        "heatsink: a map of devices is wanted: {thyristor: 12 K/W, ...}"));
  for (const vs_node *n = map->child; n && !status; n = n->next)
    status = vs_error_keep(err, read_sink(n, deck, cooling, err));
  return status;
}

/* Error: at the ambient alone a junction would be as hot as its part allows. */
static vs_status check_ambient(const vs_node *node, const vs_deck *deck, const vs_cooling *cooling,
                               vs_error *err) {
  for (size_t k = 0; k < deck->n_devices; k++) {
    const vs_device *d = &deck->devices[k];
    const char *file = d->part < 0 ? NULL : deck->parts[d->part].file;
    const vs_limit *most = file ? vs_parts_find_limit(deck, file, "t_j_max") : NULL;
    if (!most || cooling->ambient_degc < most->value) continue;
    return vs_fail_at(err, node->where,
                      "ambient: %.6g degC is not below t_j_max of %s, the part of %s, %s; a "
                      "temperature below that is wanted",
                      cooling->ambient_degc, deck->parts[d->part].subcircuit, d->name,
                      most->written);
  }
  return VS_OK;
}

vs_status vs_cooling_read(const vs_node *scene, const vs_deck *deck, vs_cooling *cooling,
                          vs_error *err) {
  const vs_node *ambient = vs_tree_child(scene, vs_cooling_ambient.key),
                *sinks = vs_tree_child(scene, vs_cooling_heatsink.key);
  const vs_section top = {"scene", &vs_cooling_ambient, 1};
  vs_status status = VS_OK;
  char why[256];
  *cooling = (vs_cooling){.stated = ambient || sinks};
  vs_units_read(vs_cooling_ambient.default_text, "degC", &cooling->ambient_degc, why, sizeof why);
  if (ambient && (ambient->kind != VS_NODE_TEXT || *ambient->text))
    status = vs_error_keep(err, vs_field_read(&top, &vs_cooling_ambient, ambient, cooling, err));
  if (status || deck->lost) return status;
  if (ambient) status = vs_error_keep(err, check_ambient(ambient, deck, cooling, err));
  return status || !sinks ? status : read_sinks(sinks, deck, cooling, err);
}

/* ---- the path of heat ---- */

static double sink_of(const vs_cooling *cooling, const vs_deck *deck, const vs_device *d) {
  return cooling->sink_k_per_w[d - deck->devices];
}

bool vs_cooling_has(const vs_cooling *cooling, const vs_deck *deck, const vs_device *d) {
  unsigned unsure = 0;
  return sink_of(cooling, deck, d) > 0 || isfinite(vs_devices_r_th(deck, d, "r_th_ja", &unsure));
}

double vs_cooling_to_ambient(const vs_cooling *cooling, const vs_deck *deck, const vs_device *d,
                             unsigned *unsure) {
  double sink = sink_of(cooling, deck, d);
  if (sink > 0) {
    double r_cs = vs_devices_r_th(deck, d, "r_th_cs", unsure);
    return sink + (isfinite(r_cs) ? r_cs : 0);
  }
  double r_ja = vs_devices_r_th(deck, d, "r_th_ja", unsure);
  if (isnan(r_ja)) return NAN;
  double r_jc = vs_devices_r_th(deck, d, "r_th_jc", unsure);
  return r_ja - (isfinite(r_jc) ? r_jc : 0);
}

void vs_cooling_write(const vs_cooling *cooling, const vs_deck *deck, const vs_device *d,
                      vs_text *text) {
  unsigned unsure = 0;
  double r_jc = vs_devices_r_th(deck, d, "r_th_jc", &unsure), sink = sink_of(cooling, deck, d);
  double r_cs = vs_devices_r_th(deck, d, "r_th_cs", &unsure),
         r_ja = vs_devices_r_th(deck, d, "r_th_ja", &unsure);
  vs_text_add(text, "%s: junction", d->name);
  if (sink > 0 || isnan(r_ja)) {
    if (isfinite(r_jc)) vs_text_add(text, " over case %.4g K/W", r_jc);
    if (sink > 0 && isfinite(r_cs)) vs_text_add(text, ", over sink's face %.4g K/W", r_cs);
    if (sink > 0) vs_text_add(text, ", over heat sink %.4g K/W", sink);
  } else
    vs_text_add(text, " over ambient %.4g K/W (r_th_ja)", r_ja);
  vs_text_add(text, ", over ambient %.4g degC%s%s%s", cooling->ambient_degc,
              unsure ? " (r_th " : "", vs_deck_unsure_words[unsure], unsure ? ")" : "");
}

/* ---- told ---- */

enum { DIGITS = 12 };

void vs_cooling_json(const vs_cooling *cooling, const vs_deck *deck, vs_json *json) {
  bool begun = false;
  if (!cooling->stated) return;
  vs_json_object(json, vs_cooling_ambient.key, VS_JSON_ROW);
  vs_json_number(json, "value", cooling->ambient_degc, DIGITS);
  vs_json_text(json, "unit", vs_cooling_ambient.unit);
  vs_json_end(json);
  for (size_t k = 0; k < deck->n_devices; k++) {
    if (!(cooling->sink_k_per_w[k] > 0)) continue;
    if (!begun) vs_json_object(json, vs_cooling_heatsink.key, VS_JSON_LINES);
    begun = true;
    vs_json_object(json, deck->devices[k].name, VS_JSON_ROW);
    vs_json_number(json, "value", cooling->sink_k_per_w[k], DIGITS);
    vs_json_text(json, "unit", vs_cooling_heatsink.unit);
    vs_json_end(json);
  }
  if (begun) vs_json_end(json);
}

void vs_cooling_identify(const vs_cooling *cooling, const vs_deck *deck, vs_text *text) {
  if (!cooling->stated) return;
  vs_text_add(text, "ambient %.12g\n", cooling->ambient_degc);
  for (size_t k = 0; k < deck->n_devices; k++)
    if (cooling->sink_k_per_w[k] > 0)
      vs_text_add(text, "heatsink %s %.12g\n", deck->devices[k].name, cooling->sink_k_per_w[k]);
}
