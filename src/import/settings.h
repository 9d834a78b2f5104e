/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a netlist says that belongs into a scene instead of a deck: its mains, its firing, its coil.
 */
#pragma once

#include "base/json.h"
#include "import/roles.h"

enum { VS_SETTINGS = 20 };

/* A key of the scene, "supply.voltage", and its value with its unit. */
typedef struct vs_setting {
  const char *section, *key;
  char value[64];
} vs_setting;

typedef struct vs_settings {
  vs_setting item[VS_SETTINGS];
  size_t count;
} vs_settings;

/* until_s: the end of the netlist's own run; NaN: it does not say. gear: its options ask for Gear's
 * rule. */
void vs_settings_make(vs_settings *settings, const vs_roles *roles, const vs_values *values,
                      double until_s, bool gear);

/* Adds the text of a scene with these values that names the deck; each line begins with `before`.
 */
void vs_settings_write(const vs_settings *settings, const char *deck, const char *before,
                       vs_text *out);

/* Adds the member "scene": {"supply.voltage": "230 V", ...}. */
void vs_settings_json(const vs_settings *settings, const char *deck, vs_json *json);
