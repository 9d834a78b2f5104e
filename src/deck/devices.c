/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "deck/devices.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "deck/parts.h"
#include "syntax/units.h"

/* ---- reading ---- */

/* Reads a word of the line before '='. Returns false where it does not belong there. */
static bool read_word(vs_device *d, vs_cursor *c) {
  char word[VS_DECK_NAME];
  vs_where where = vs_cursor_here(c);
  if (!vs_cursor_word(c, "+.", word, sizeof word)) return false;
  if (!strcmp(word, "protects") && !*d->ward) {
    vs_cursor_skip(c);
    d->where_ward = vs_cursor_here(c);
    return vs_cursor_word(c, "", d->ward, sizeof d->ward);
  }
  vs_named_port port = {.where = where};
  vs_error none = {0};
  if (!vs_port_read(word, where, &port.signal, &none) && port.signal.drive != VS_PORT_MAINS) {
    if (d->n_ports == VS_DEVICE_PORTS) return false;
    d->ports[d->n_ports++] = port;
    return true;
  }
  if (*d->of) return false;
  memcpy(d->of, word, sizeof d->of);
  d->where_of = where;
  return true;
}

/* device NAME [PART or KIND] [PORT]... [protects DEVICE] = VOLTAGE, CURRENT [, FLUX] "TEXT" */
vs_status vs_devices_line(vs_deck *deck, vs_cursor *c, vs_error *err) {
  static const char WANTED[] =
      "'device NAME [PART or KIND] [PORT]... [protects DEVICE] = VOLTAGE, CURRENT [, FLUX] "
      "\"TEXT\"' is wanted here";
  if (deck->n_devices >= VS_DECK_DEVICES)
    return vs_fail_at(err, c->line, "more than %d devices", VS_DECK_DEVICES);
  vs_device *d = &deck->devices[deck->n_devices];
  *d = (vs_device){.part = -1, .protects = -1};
  vs_cursor_skip(c);
  d->where = d->where_of = vs_cursor_here(c);
  if (!vs_cursor_word(c, "", d->name, sizeof d->name))
    return vs_fail_at(err, vs_cursor_here(c), "%s", WANTED);
  for (size_t k = 0; k < deck->n_devices; k++)
    if (!strcmp(deck->devices[k].name, d->name))
      return vs_fail_at(err, d->where, "device %s stands here a second time; leave one out",
                        d->name);
  while (!vs_cursor_take(c, '=')) {
    vs_where where = vs_cursor_here(c);
    if (!read_word(d, c)) return vs_fail_at(err, where, "%s", WANTED);
  }
  deck->n_devices++; /* its formulas are freed with the deck, also when they are not good */
  vs_status status = vs_deck_add_formula(deck, c, ",", &d->voltage, err);
  if (!status && !vs_cursor_take(c, ','))
    status =
        vs_fail_at(err, vs_cursor_here(c), "',' and the formula of its current are wanted here");
  if (!status) status = vs_deck_add_formula(deck, c, ",\"", &d->current, err);
  vs_cursor_skip(c);
  d->where_flux = vs_cursor_here(c);
  d->has_flux = !status && vs_cursor_take(c, ',');
  if (d->has_flux) status = vs_deck_add_formula(deck, c, "\"", &d->flux, err);
  return status ? status : vs_cursor_text(c, d->text, sizeof d->text, err);
}

/* Reads a positive number with a unit, as "0.5 K/W". */
static bool read_positive(vs_cursor *c, const char *unit, double *si) {
  char value[VS_DECK_NAME], written[VS_DECK_NAME], both[2 * VS_DECK_NAME], why[200];
  vs_cursor_token(c, value, sizeof value);
  vs_cursor_token(c, written, sizeof written);
  snprintf(both, sizeof both, "%s %s", value, written);
  return vs_units_read(both, unit, si, why, sizeof why) && *si > 0;
}

/* zth R K/W TAU s [assumed] "TEXT" */
vs_status vs_devices_zth(vs_deck *deck, vs_cursor *c, vs_error *err) {
  vs_zth zth = {.where = c->line};
  char text[VS_DECK_TEXT];
  vs_cursor_skip(c);
  vs_where where = vs_cursor_here(c);
  if (!read_positive(c, "K/W", &zth.k_per_w) || !read_positive(c, "s", &zth.tau_s))
    return vs_fail_at(err, where,
                      "zth: a thermal resistance and its time constant are wanted here, both "
                      "positive, as 0.5 K/W 1 ms");
  zth.assumed = vs_cursor_is(c, "assumed");
  vs_status status = vs_cursor_text(c, text, sizeof text, err);
  size_t same = 0;
  for (size_t k = 0; k < deck->n_zth; k++) same += !strcmp(deck->zth[k].where.file, c->line.file);
  if (!status && (same >= VS_PART_ZTH || deck->n_zth >= VS_DECK_LIMITS))
    status = vs_fail_at(err, c->line, "more than %d of these lines", VS_PART_ZTH);
  if (!status) deck->zth[deck->n_zth++] = zth;
  return status;
}

/* pulse WIDTH us NUMBER CURRENT A [assumed] "TEXT" */
vs_status vs_devices_pulse(vs_deck *deck, vs_cursor *c, vs_error *err) {
  vs_derating d = {.where = c->line};
  char text[VS_DECK_TEXT], number[VS_DECK_NAME], *end;
  vs_cursor_skip(c);
  vs_where where = vs_cursor_here(c);
  bool good = read_positive(c, "s", &d.width_s);
  vs_cursor_token(c, number, sizeof number);
  d.number = strtod(number, &end);
  good = good && end != number && !*end && d.number >= 1 && read_positive(c, "A", &d.current_a);
  if (!good)
    return vs_fail_at(err, where,
                      "pulse: a width, a number and a current are wanted here, as 20 us 10 2500 A");
  d.assumed = vs_cursor_is(c, "assumed");
  vs_status status = vs_cursor_text(c, text, sizeof text, err);
  if (!status && deck->n_deratings >= VS_DECK_LIMITS)
    status = vs_fail_at(err, c->line, "more than %d of these lines", VS_DECK_LIMITS);
  if (!status) deck->deratings[deck->n_deratings++] = d;
  return status;
}

/* ---- once the parts are chosen ---- */

/* The index of the deck's part of that name; -1: there is none. */
static int find_part(const vs_deck *deck, const char *name) {
  for (size_t p = 0; p < deck->n_parts; p++)
    if (!strcmp(deck->parts[p].name, name)) return (int)p;
  return -1;
}

static vs_status unknown_kind(const vs_deck *deck, const vs_device *d, const char *said,
                              vs_error *err) {
  vs_text kinds = {0};
  size_t n_kinds = 0, n = 0;
  while (vs_kinds_all[n_kinds].name) n_kinds++;
  const char **names = vs_alloc(deck->n_parts + n_kinds, sizeof *names);
  for (size_t p = 0; p < deck->n_parts; p++) names[n++] = deck->parts[p].name;
  for (size_t k = 0; k < n_kinds; k++) {
    vs_text_add(&kinds, "%s%s", k ? ", " : "", vs_kinds_all[k].name);
    names[n++] = vs_kinds_all[k].name;
  }
  const char *nearest = vs_text_nearest(said, names, n);
  vs_status status = vs_fail_at(
      err, d->where_of, "device %s: '%s' is no part of this deck and no kind; there are: %s%s%s%s",
      d->name, said, kinds.text, nearest ? "; did you mean '" : "", nearest ? nearest : "",
      nearest ? "'?" : "");
  vs_text_free(&kinds);
  free(names);
  return status;
}

/* Gives the device its part, and its kind: that of the part's file, else the one the line says. */
static vs_status resolve_kind(const vs_deck *deck, vs_device *d, vs_error *err) {
  const char *said = *d->of ? d->of : d->name;
  d->part = find_part(deck, said);
  if (d->part < 0) d->part = find_part(deck, d->name);
  d->kind = vs_kinds_find(said);
  bool known = d->kind || find_part(deck, said) >= 0;
  if (!known) return deck->lost & VS_LOST_PARAM ? VS_OK : unknown_kind(deck, d, said, err);
  if (d->part < 0) return VS_OK;
  const vs_part *part = &deck->parts[d->part];
  if (!part->file) return VS_OK; /* its file was not found, and a check carries on */
  const vs_part_file *file = vs_parts_file(deck, part->file);
  if (!file && !d->kind)
    return vs_fail_at(err, (vs_where){part->file, 1, 1},
                      "has no line '*$ part KIND \"TEXT\"', which the device %s at %s:%d asks for",
                      d->name, d->where.file, d->where.line);
  if (!file) return VS_OK;
  if (d->kind && *d->of && strcmp(d->of, part->name) && strcmp(d->of, file->kind))
    return vs_fail_at(err, d->where_of, "device %s: its part %s is of kind %s, not %s", d->name,
                      part->subcircuit, file->kind, d->of);
  d->kind = vs_kinds_find(file->kind);
  return d->kind ? VS_OK
                 : vs_fail_at(err, d->where_of,
                              "device %s: its part %s is of kind %s, of which nothing is measured",
                              d->name, part->subcircuit, file->kind);
}

static bool is_same_signal(const vs_signal *a, const vs_signal *b) {
  return a->drive == b->drive && fabs(a->shift_rad - b->shift_rad) <= 1e-9;
}

/* True where the deck has the port, or, of a port of gate pulses, one with the same pulses. */
static bool has_port(const vs_deck *deck, const vs_signal *wanted) {
  for (size_t p = 0; p < deck->n_ports; p++) {
    vs_signal signal = deck->ports[p].signal;
    if (vs_port_is_gated(&signal) && vs_port_is_gated(wanted)) signal.drive = wanted->drive;
    if (is_same_signal(&signal, wanted)) return true;
  }
  return false;
}

/* Adds the pulses of a gate port, unless they are among the device's already. */
static void add_gate(vs_device *d, const vs_signal *signal) {
  bool new = vs_port_is_gated(signal) && d->gates.count < VS_DEVICE_PORTS;
  for (size_t g = 0; g < d->gates.count; g++)
    new = new &&fabs(d->gates.rad[g] - signal->shift_rad) > 1e-9;
  if (new) d->gates.rad[d->gates.count++] = signal->shift_rad;
}

/* Error: the device's kind has no use for the port, or the deck has not got it. */
static vs_status check_port(const vs_deck *deck, const vs_device *d, const vs_named_port *port,
                            vs_error *err) {
  const vs_kind *kind = d->kind;
  if (kind && !kind->gated && !kind->driven)
    return vs_fail_at(err, port->where, "device %s: a %s has no gate", d->name, kind->name);
  if (kind && kind->gated && !vs_port_is_gated(&port->signal))
    return vs_fail_at(err, port->where, "device %s: a %s goes by gate pulses: gate+ANGLE is wanted",
                      d->name, kind->name);
  if (has_port(deck, &port->signal) || deck->lost & VS_LOST_PORT) return VS_OK;
  return vs_fail_at(err, port->where, "device %s: the deck has no such port", d->name);
}

/* Gives the device the gate pulses of the ports that it names; else of the deck's first gate port,
 * or, where it conducts both ways, of all of them. */
static vs_status resolve_gates(const vs_deck *deck, vs_device *d, vs_error *err) {
  vs_status status = VS_OK;
  d->gates.count = 0;
  for (size_t n = 0; n < d->n_ports && !status; n++) {
    status = check_port(deck, d, &d->ports[n], err);
    add_gate(d, &d->ports[n].signal);
  }
  bool all = d->kind && d->kind->both_ways;
  for (size_t p = 0; p < deck->n_ports && !d->n_ports; p++)
    if (all || !d->gates.count) add_gate(d, &deck->ports[p].signal);
  return status;
}

static vs_status check_flux(const vs_device *d, vs_error *err) {
  bool can = !d->kind || !d->has_flux;
  for (size_t k = 0; d->kind && k < d->kind->n_measures; k++)
    can = can || d->kind->measures[k].of == VS_OF_FLUX;
  return can ? VS_OK
             : vs_fail_at(err, d->where_flux,
                          "device %s: of a %s two formulas are wanted, not three", d->name,
                          d->kind->name);
}

/* Finds the device that this one protects. Errors: its kind has no measure to hold against another
 * device; there is no such device. */
static vs_status resolve_ward(const vs_deck *deck, vs_device *d, vs_error *err) {
  const char *names[VS_DECK_DEVICES];
  bool can = !d->kind;
  if (!*d->ward) return VS_OK;
  for (size_t k = 0; d->kind && k < d->kind->n_measures; k++)
    can = can || d->kind->measures[k].held == VS_WARD_AT_MOST;
  if (!can)
    return vs_fail_at(err, d->where_ward, "device %s: a %s protects nothing; a fuse does", d->name,
                      d->kind->name);
  for (size_t k = 0; k < deck->n_devices; k++) {
    names[k] = deck->devices[k].name;
    if (!strcmp(names[k], d->ward)) d->protects = (int)k;
  }
  if (d->protects >= 0) return VS_OK;
  const char *nearest = vs_text_nearest(d->ward, names, deck->n_devices);
  return vs_fail_at(err, d->where_ward, "device %s: no device '%s' stands in the deck%s%s%s",
                    d->name, d->ward, nearest ? "; did you mean '" : "", nearest ? nearest : "",
                    nearest ? "'?" : "");
}

static const char *file_of(const vs_deck *deck, const vs_device *d) {
  return d->part < 0 ? NULL : deck->parts[d->part].file;
}

const vs_limit *vs_devices_limit(const vs_deck *deck, const vs_device *d,
                                 const vs_device_measure *m) {
  bool ward = m->held == VS_WARD_AT_MOST;
  if (ward && d->protects < 0) return NULL;
  const char *file = file_of(deck, ward ? &deck->devices[d->protects] : d);
  const vs_limit *limit = file && m->limit ? vs_parts_find_limit(deck, file, m->limit) : NULL;
  return limit && isfinite(limit->value) ? limit : NULL;
}

bool vs_devices_lacks(const vs_deck *deck, const vs_device *d, const vs_device_measure *m) {
  const char *file = file_of(deck, d);
  bool real = false, own = m->limit && m->held != VS_WARD_AT_MOST;
  if (!file || !own || !vs_kinds_decides(d->kind->name, m->limit)) return false;
  for (size_t k = 0; k < deck->n_limits && !real; k++)
    real = isfinite(deck->limits[k].value) && !strcmp(deck->limits[k].where.file, file);
  return real && !vs_parts_find_limit(deck, file, m->limit);
}

double vs_devices_dv_dt_over(const vs_deck *deck, const vs_device *d) {
  return vs_parts_dv_dt_over(deck, file_of(deck, d));
}

/* ---- a table of pulses ---- */

bool vs_devices_has_pulses(const vs_deck *deck, const vs_device *d) {
  const char *file = file_of(deck, d);
  for (size_t k = 0; file && k < deck->n_deratings; k++)
    if (!strcmp(deck->deratings[k].where.file, file)) return true;
  return false;
}

/* Two neighbours in a table, at or below x and at or above it; y: what they have. */
typedef struct bracket {
  double x[2], y[2];
} bracket;

static const bracket NONE = {{-INFINITY, INFINITY}, {NAN, NAN}};

static void narrow(bracket *b, double x, double at, double y) {
  if (x <= at && x >= b->x[0]) b->x[0] = x, b->y[0] = y;
  if (x >= at && x <= b->x[1]) b->x[1] = x, b->y[1] = y;
}

/* The power law between them. Below the first row it is that row's; above the last it is NaN. */
static double between(const bracket *b, double at) {
  if (isinf(b->x[1])) return NAN;
  if (isinf(b->x[0]) || b->x[0] == b->x[1]) return b->y[1];
  double part = log(at / b->x[0]) / log(b->x[1] / b->x[0]);
  return b->y[0] * pow(b->y[1] / b->y[0], part);
}

/* The current of the rows of one number, at that width. */
static double at_width(const vs_deck *deck, const char *file, double number, double width_s,
                       bool *assumed) {
  bracket b = NONE;
  for (size_t k = 0; k < deck->n_deratings; k++) {
    const vs_derating *d = &deck->deratings[k];
    if (strcmp(d->where.file, file) || d->number != number) continue;
    narrow(&b, d->width_s, width_s, d->current_a);
    *assumed = *assumed || d->assumed;
  }
  return between(&b, width_s);
}

double vs_devices_bears(const vs_deck *deck, const vs_device *device, double width_s, double number,
                        bool *assumed) {
  const char *file = file_of(deck, device);
  bracket b = NONE;
  *assumed = false;
  for (size_t k = 0; file && k < deck->n_deratings; k++)
    if (!strcmp(deck->deratings[k].where.file, file))
      narrow(&b, deck->deratings[k].number, number, 0);
  for (int n = 0; n < 2; n++)
    b.y[n] = isinf(b.x[n]) ? NAN : at_width(deck, file, b.x[n], width_s, assumed);
  return between(&b, number);
}

static vs_status check_limits(const vs_deck *deck, const vs_device *d, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; d->kind && k < d->kind->n_measures && !status; k++) {
    const vs_device_measure *m = &d->kind->measures[k];
    const vs_limit *limit = vs_devices_limit(deck, d, m);
    if (!limit) continue;
    bool fits = vs_units_same_kind(limit->unit, m->unit);
    if (fits && limit->value > 0) continue;
    if (fits)
      status = vs_fail_at(err, limit->where,
                          "limit %s: it must be above 0, as margins are parts of it, for %s.%s",
                          limit->name, d->name, m->name);
    else
      status = vs_fail_at(err, limit->where, "limit %s: a unit as %s is wanted, for %s.%s",
                          limit->name, m->unit, d->name, m->name);
    status = vs_error_carry_on(err, status);
  }
  return status;
}

vs_status vs_devices_resolve(vs_deck *deck, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < deck->n_devices && !status; k++) {
    vs_device *d = &deck->devices[k];
    status = vs_error_carry_on(err, resolve_kind(deck, d, err));
    if (!status) status = vs_error_carry_on(err, resolve_gates(deck, d, err));
    if (!status) status = vs_error_carry_on(err, check_flux(d, err));
    if (!status) status = vs_error_carry_on(err, resolve_ward(deck, d, err));
  }
  for (size_t k = 0; k < deck->n_devices && !status; k++)
    status = check_limits(deck, &deck->devices[k], err);
  return status;
}

bool vs_devices_fails_ward(const vs_deck *deck, size_t device, char *text, size_t size) {
  const vs_device *d = &deck->devices[device];
  if (d->protects < 0) return false;
  const vs_device *ward = &deck->devices[d->protects];
  const char *own = file_of(deck, d), *its = file_of(deck, ward);
  const vs_limit *clears = own ? vs_parts_find_limit(deck, own, "i2t_clear") : NULL;
  const vs_limit *bears = its ? vs_parts_find_limit(deck, its, "i2t") : NULL;
  if (!clears || !bears || !isfinite(clears->value) || clears->value <= bears->value) return false;
  snprintf(text, size, "%s: i2t_clear of %s, %s, is above i2t of %s, %s, which it is to protect",
           d->name, deck->parts[d->part].subcircuit, clears->written,
           deck->parts[ward->part].subcircuit, bears->written);
  return true;
}
