/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "control/control.h"

#include <gsl/gsl_math.h>
#include <stdio.h>
#include <string.h>

#include "base/jail.h"
#include "control/regulators.h"

#define AT(member) offsetof(vs_control_values, member)
static const vs_field COMMON[] = {
    {"law", VS_NAME, "", "none", .offset = AT(law), .text = "see 'vibrospice list regulators'"},
    {"rate", VS_REAL, "Hz", "10 kHz", 0, 1e7, true, AT(rate_hz),
     .text = "how often it reads the instruments"},
    {"angle", VS_PAIR, "deg", "10 deg, 170 deg", 0, 180, .offset = AT(angle_rad),
     .text = "the least and the largest angle that it fires at"}};
const char vs_control_sensor[] = "sensor";
static const vs_field SENSOR = {vs_control_sensor,
                                VS_NAME,
                                "",
                                "NAME",
                                .offset = AT(sensor),
                                .text = "the instrument that it reads"};
#undef AT
enum { RATE = 1, N_COMMON = sizeof COMMON / sizeof *COMMON };
const vs_section vs_control_section = {"control", COMMON, N_COMMON};

size_t vs_control_keys(const vs_regulator *law, const vs_field *keys[VS_CONTROL_FIELDS]) {
  size_t n = 0;
  for (int k = 0; k < N_COMMON; k++) keys[n++] = &COMMON[k];
  if (law->senses) keys[n++] = &SENSOR;
  for (size_t k = 0; k < law->n_fields; k++) keys[n++] = &law->fields[k];
  return n;
}

/* Writes a unit in which "~" stands for the sensor's: "x/~" is "x.b/a" with
 * a sensor in "a/b". */
static void make_unit(const char *unit, const char *sensors, char *text, size_t size) {
  const char *mark = strchr(unit, '~'), *slash = strchr(sensors, '/');
  if (!mark || mark == unit) {
    snprintf(text, size, "%s", mark ? sensors : unit);
    return;
  }
  int before = (int)(mark - unit) - 1; /* without its '/' */
  if (!*sensors)
    snprintf(text, size, "%.*s%s%s", before, unit, mark[1] ? "/" : "", mark[1] ? mark + 2 : "");
  else if (!slash)
    snprintf(text, size, "%.*s/%s%s", before, unit, sensors, mark + 1);
  else
    snprintf(text, size, "%.*s.%s/%.*s%s", before, unit, slash + 1, (int)(slash - sensors), sensors,
             mark + 1);
}

static void add_control_field(vs_control *c, const vs_field *field) {
  size_t k = c->section.count++;
  c->fields[k] = *field;
  make_unit(field->unit, c->unit, c->units[k], sizeof c->units[k]);
  c->fields[k].unit = c->units[k];
}

/* Makes the keys of this control, as its law and its sensor's unit are now known. */
static void make_control_section(vs_control *c) {
  const vs_field *keys[VS_CONTROL_FIELDS];
  const size_t n = vs_control_keys(c->regulator, keys);
  c->section = (vs_section){vs_control_section.name, c->fields, 0};
  for (size_t k = 0; k < n; k++) add_control_field(c, keys[k]);
}

static vs_status find_law_of_control(const vs_node *section, vs_control *c, vs_error *err) {
  const vs_node *law = vs_tree_child(section, "law");
  const char *names[16], *named = law && law->kind == VS_NODE_TEXT ? law->text : "none";
  size_t n = 0;
  for (; vs_regulators[n]; n++) names[n] = vs_regulators[n]->name;
  c->regulator = vs_regulators_find(named);
  if (c->regulator) return VS_OK;
  return vs_fail_at(err, law->where, "control.law: there is no '%s'%s", named,
                    vs_text_hint(named, names, n, "; see 'vibrospice list regulators'").text);
}

/* Finds the instrument, or the estimate, that the section names. */
static vs_status find_sensor(const vs_node *section, const vs_instruments *all, vs_control *c,
                             vs_error *err) {
  const vs_node *node = vs_tree_child(section, SENSOR.key);
  const char *names[VS_INSTRUMENT_MOST + VS_MOST_STATES];
  int count = all->count + c->observing.estimates;
  if (!c->regulator->senses) return VS_OK;
  if (!node || node->kind != VS_NODE_TEXT)
    return vs_fail_at(err, node ? node->where : section->where,
                      "control: the law %s wants the key sensor: the name of an instrument%s%s%s",
                      c->regulator->name, all->count ? ", such as '" : "",
                      all->count ? all->item[0].name : "",
                      all->count ? "'" : ", of which the scene has none: add instruments: {}");
  for (int k = 0; k < count; k++) {
    names[k] = k < all->count ? all->item[k].name : c->observing.estimate[k - all->count].column;
    if (!strcmp(node->text, names[k])) c->sensor = k;
  }
  if (c->sensor >= 0) {
    c->unit = c->sensor < all->count ? all->item[c->sensor].unit
                                     : c->observing.estimate[c->sensor - all->count].unit;
    return VS_OK;
  }
  return vs_fail_at(
      err, node->where, "control.sensor: the scene has no instrument '%s'%s", node->text,
      vs_text_hint(node->text, names, (size_t)count, all->count ? "" : ": add instruments: {}")
          .text);
}

/* Looks at the key that names code of the user's own, where the law has one. */
static vs_status find_code(const vs_node *section, vs_control *c, vs_error *err) {
  const char *key = c->regulator->code;
  if (!key) return VS_OK;
  const vs_node *node = vs_tree_child(section, key);
  c->code = node ? node->where : section->where;
  if (!node)
    return vs_fail_at(err, section->where, "control: the law %s wants the key %s",
                      c->regulator->name, key);
  char path[VS_PATH_SIZE];
  vs_status status = VS_OK;
  for (int k = 0; !status && c->regulator->file(&c->v, c->code, k, path); k++)
    status = vs_jail_check(path, c->code, err);
  return status ? status : c->regulator->check(&c->v, c->code, err);
}

/* Reads the observer, whose samples come at the control's rate. */
static vs_status read_observer(const vs_node *section, const vs_setup *setup,
                               const vs_instruments *instruments, vs_control *c, vs_error *err) {
  const vs_node *map = vs_tree_child(section, vs_state_observer_key.key),
                *rate = vs_tree_child(section, COMMON[RATE].key);
  vs_control_values v;
  if (!map) return VS_OK;
  vs_status s = vs_field_section_read(&vs_control_section, NULL, &v, err);
  if (!s && rate) s = vs_field_read(&vs_control_section, &COMMON[RATE], rate, &v, err);
  if (s) return s;
  return vs_state_observer_read(map, &setup->model, instruments, v.rate_hz, &c->observing, err);
}

/* Reads the keys of this control, besides the observer's map. */
static vs_status read_keys(const vs_node *section, vs_control *c, vs_error *err) {
  const char *names[VS_CONTROL_FIELDS + 1] = {vs_state_observer_key.key};
  for (size_t k = 0; k < c->section.count; k++) names[1 + k] = c->fields[k].key;
  vs_status s = vs_field_known_keys(section, c->section.name, names, c->section.count + 1, err);
  for (size_t k = 0; k < c->section.count && !s; k++)
    s = vs_field_read_key(&c->section, &c->fields[k], vs_tree_child(section, c->fields[k].key),
                          &c->v, err);
  return s;
}

/* Error: the scene has no firings to decide, or the control no angle to choose. */
static vs_status check_scene_of_control(const vs_node *section, const vs_setup *setup,
                                        const vs_control *c, vs_error *err) {
  enum { MOST_TICKS = 1000000000 };
  const vs_timeline *t = &setup->timeline;
  const vs_node *angle = vs_tree_child(section, "angle"), *rate = vs_tree_child(section, "rate");
  if (t->firing.no_valve)
    return vs_fail_at(
        err, section->key_where,
        "control: with firing.valve: none nothing fires; leave the section control out");
  if (!t->firing.every)
    return vs_fail_at(err, section->key_where,
                      "control: firing.every is 'once', and a control decides one firing after the "
                      "other; write firing.every: 1");
  if (!(c->v.angle_rad[0] < c->v.angle_rad[1]))
    return vs_fail_at(err, angle ? angle->where : section->where,
                      "control.angle: the first must be the smaller one: [10 deg, 170 deg]");
  if (c->v.rate_hz * setup->run.until_s > MOST_TICKS)
    return vs_fail_at(
        err, rate ? rate->where : section->where,
        "control.rate: %g Hz reads the instruments %.3g times up to run.until = %g s; "
        "allowed there: at most %g Hz",
        c->v.rate_hz, c->v.rate_hz * setup->run.until_s, setup->run.until_s,
        MOST_TICKS / setup->run.until_s);
  return VS_OK;
}

/* Error: a column of the control's would have the name of a probe's or an instrument's. */
static vs_status check_columns_of_control(const vs_node *section, const vs_setup *setup,
                                          const vs_instruments *all, const vs_control *c,
                                          vs_error *err) {
  const vs_frame frame = {.model = &setup->model, .deck = &setup->deck};
  vs_control_column own;
  int numbers[VS_CH_MOST], n = vs_channel_listed(&frame, numbers);
  for (int k = 0; vs_control_column_at(c, k, &own); k++) {
    const vs_column column = vs_channel_column(own.name, own.unit, own.role, own.of);
    for (int i = 0; i < n; i++) {
      const vs_channel channel = vs_channel_at(&frame, numbers[i]);
      const vs_column other =
          vs_channel_column(channel.name, channel.unit, channel.role, channel.of);
      if (!strcmp(column.name, other.name))
        return vs_fail_at(err, section->key_where,
                          "control: its column %s would be that of probe %s, too; give the probe "
                          "another name",
                          column.name, channel.name);
    }
    for (int i = 0; i < all->count; i++) {
      const vs_instrument *item = &all->item[i];
      const vs_column other =
          vs_channel_column(item->column, item->unit, VS_COLUMN_INSTRUMENT, item->v.channel);
      if (!strcmp(column.name, other.name))
        return vs_fail_at(err, item->where,
                          "%s: its column %s would be that of the control, too; give it another "
                          "name",
                          item->path, column.name);
    }
  }
  return VS_OK;
}

vs_status vs_control_read(const vs_node *section, const vs_setup *setup,
                          const vs_instruments *instruments, vs_control *c, vs_error *err) {
  size_t found = vs_error_count(err);
  if (!section && !c->regulator && !c->observing.system && c->sensor < 0) return VS_OK;
  vs_control_free(c);
  *c = (vs_control){.sensor = -1, .unit = ""};
  if (!section || setup->machine->lost) return VS_OK;
  if (section->kind != VS_NODE_MAP)
    return vs_error_keep(
        err, vs_fail_at(err, section->where,
                        "control: a map is wanted: {law: amplitude, sensor: NAME, ...}"));
  vs_status s = vs_error_keep(err, find_law_of_control(section, c, err));
  if (s || !c->regulator) return s;
  s = vs_error_keep(err, read_observer(section, setup, instruments, c, err));
  if (!s && vs_error_count(err) == found)
    s = vs_error_keep(err, find_sensor(section, instruments, c, err));
  if (!s && vs_error_count(err) == found) {
    make_control_section(c);
    s = read_keys(section, c, err);
    if (!s && vs_error_count(err) == found) s = vs_error_keep(err, find_code(section, c, err));
    if (!s && vs_error_count(err) == found)
      s = vs_error_keep(err, check_scene_of_control(section, setup, c, err));
    if (!s && vs_error_count(err) == found)
      s = vs_error_keep(err, check_columns_of_control(section, setup, instruments, c, err));
  }
  if (s || vs_error_count(err) > found) c->regulator = NULL;
  return s;
}

int vs_control_outputs(const vs_control *c) {
  int n = 0;
  while (n < VS_REGULATOR_OUTPUTS && c->regulator->outputs[n].name) n++;
  return n;
}

void vs_control_free(vs_control *c) {
  vs_state_observer_free(&c->observing);
}

bool vs_control_column_at(const vs_control *c, int k, vs_control_column *column) {
  static const vs_regulator_output ANGLE = {"firing_angle", "rad", false};
  if (!c->regulator) return false;
  int outputs = vs_control_outputs(c), of_observer = k - 1 - outputs;
  if (of_observer >= c->observing.estimates) return false;
  if (of_observer >= 0) {
    const vs_estimated *e = &c->observing.estimate[of_observer];
    column->name = e->column;
    column->role = VS_COLUMN_ESTIMATE;
    snprintf(column->unit, sizeof column->unit, "%s", e->unit);
    snprintf(column->of, sizeof column->of, "%s", e->of);
    return true;
  }
  const vs_regulator_output *o = k ? &c->regulator->outputs[k - 1] : &ANGLE;
  column->name = o->name;
  column->role = o->set_point ? VS_COLUMN_SET_POINT : VS_COLUMN_MEASURE;
  snprintf(column->of, sizeof column->of, "%s", k ? c->v.sensor : "firing");
  make_unit(o->unit, c->unit, column->unit, sizeof column->unit);
  return true;
}

/* The key that names code of the user's own; NULL: there is none. */
static const char *code_of(const vs_control *c) {
  return c->regulator ? c->regulator->code : NULL;
}

void vs_control_describe(const vs_control *c, vs_text *text) {
  const char *key = code_of(c);
  if (key)
    vs_text_add(text, "; control.%s was not tried, as only a run with --allow-code runs it", key);
}

vs_status vs_control_allow(const vs_control *c, bool allowed, vs_error *err) {
  const char *key = code_of(c);
  if (!key || allowed) return VS_OK;
  return vs_fail_at(err, c->code,
                    "control.%s: the scene runs code of its own; if you trust it, allow that with "
                    "the option --allow-code",
                    key);
}

/* What of an amplitude may be missed is told of from here on. */
static const double MISSED = 0.01;

const char *vs_control_note(const vs_control *c, const vs_setup *setup,
                            const vs_instruments *instruments, char *text, size_t size) {
  if (!c->regulator || c->sensor < 0) return NULL;
  double rate_hz = c->v.rate_hz;
  if (c->sensor < instruments->count)
    rate_hz = fmin(rate_hz, instruments->item[c->sensor].v.rate_hz);
  double often = rate_hz * setup->timeline.period_s;
  double missed = often > 2 ? 1 - cos(M_PI / often) : 1;
  if (missed <= MISSED) return NULL;
  snprintf(
      text, size,
      "control.sensor: %s is read %.3g times in a cycle of the mains, so that up to %.2g %% of "
      "its amplitude may be missed; from %.3g Hz on, of control.rate and of the "
      "instrument's rate, it is at most %g %%",
      c->v.sensor, often, 100 * missed, M_PI / acos(1 - MISSED) / setup->timeline.period_s,
      100 * MISSED);
  return text;
}

bool vs_control_file(const vs_control *c, int k, char path[VS_PATH_SIZE]) {
  return code_of(c) && c->regulator->file(&c->v, c->code, k, path);
}
