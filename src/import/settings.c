/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "settings.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void add(vs_settings *s, const char *section, const char *key, double value,
                const char *unit) {
  vs_setting *item = &s->item[s->count++];
  *item = (vs_setting){section, key, ""};
  snprintf(item->value, sizeof item->value, "%.12g%s%s", value, *unit ? " " : "", unit);
}

/* A parameter of the netlist that the program has under the same name. */
static void add_standard(vs_settings *s, const vs_values *values, const char *name, const char *key,
                         const char *unit) {
  const vs_value_param *p = vs_values_find(values, name);
  if (p && p->known) add(s, "supply", key, p->value, unit);
}

void vs_settings_make(vs_settings *s, const vs_roles *r, const vs_values *values, double until_s,
                      bool gear) {
  *s = (vs_settings){.count = 0};
  if (r->mains) {
    add(s, "supply", "voltage", r->rms_v, "V");
    add(s, "supply", "frequency", r->hz, "Hz");
    if (r->phase_deg != 0) add(s, "supply", "phase", r->phase_deg, "deg");
  }
  add_standard(s, values, "r_source", "resistance", "ohm");
  add_standard(s, values, "l_source", "inductance", "H");
  if (r->n_gates && !isnan(r->angle_deg)) {
    add(s, "firing", "angle", r->angle_deg, "deg");
    add(s, "firing", "pulse_width", r->width_s * 1e3, "ms");
    if (r->every)
      add(s, "firing", "every", r->every, "");
    else
      s->item[s->count++] = (vs_setting){"firing", "every", "once"};
    if (r->first_cycle != 1) add(s, "firing", "first_cycle", r->first_cycle, "");
  }
  add(s, "actuator", "inductance", r->inductance_h, "H");
  add(s, "actuator", "resistance", fmax(r->resistance_ohm, 1e-3), "ohm");
  s->item[s->count++] = (vs_setting){"run", "tier", "circuit"};
  if (gear) s->item[s->count++] = (vs_setting){"run", "method", "gear"};
  if (until_s > 0) add(s, "run", "until", until_s, "s");
}

void vs_settings_write(const vs_settings *s, const char *deck, const char *before, vs_text *out) {
  bool plain = !strpbrk(deck, ":#{}[],&*!|>'\"%@` ");
  vs_text_add(out, "%scircuit: {deck: ", before);
  if (plain)
    vs_text_add(out, "%s", deck);
  else
    vs_json_string(out, deck);
  vs_text_add(out, "}");
  const char *section = "";
  for (size_t k = 0; k < s->count; k++) {
    const vs_setting *item = &s->item[k];
    bool goes_on = !strcmp(section, item->section);
    if (goes_on)
      vs_text_add(out, ", ");
    else
      vs_text_add(out, "%s\n%s%s: {", k ? "}" : "", before, item->section);
    vs_text_add(out, "%s: %s", item->key, item->value);
    section = item->section;
  }
  vs_text_add(out, "}\n");
}

void vs_settings_json(const vs_settings *s, const char *deck, vs_json *json) {
  char key[64];
  vs_json_object(json, "scene", VS_JSON_LINES);
  vs_json_text(json, "circuit.deck", deck);
  for (size_t k = 0; k < s->count; k++) {
    snprintf(key, sizeof key, "%s.%s", s->item[k].section, s->item[k].key);
    vs_json_text(json, key, s->item[k].value);
  }
  vs_json_end(json);
}
