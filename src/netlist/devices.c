/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/devices.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/units.h"
#include "netlist/parts.h"

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

/* Reads a number of any sign, with that unit as it stands; NULL: without one. */
static bool read_plain(vs_cursor *c, const char *unit, double *value) {
  char number[VS_DECK_NAME], written[VS_DECK_NAME] = "", *end;
  vs_cursor_token(c, number, sizeof number);
  if (unit) vs_cursor_token(c, written, sizeof written);
  *value = vs_text_to_number(number, &end);
  return end != number && !*end && (!unit || !strcmp(written, unit));
}

/* Reads [assumed | typical] "TEXT", the end of a row, of which there may be `most`. */
static vs_status end_row(vs_cursor *c, unsigned *unsure, size_t count, int most, vs_error *err) {
  char text[VS_DECK_TEXT];
  *unsure = vs_deck_unsure(c);
  vs_status status = vs_cursor_text(c, text, sizeof text, err);
  return status || count < (size_t)most
             ? status
             : vs_fail_at(err, c->line, "more than %d of these lines", most);
}

/* zth R K/W TAU s [assumed] "TEXT" */
vs_status vs_devices_zth(vs_deck *deck, vs_cursor *c, vs_error *err) {
  vs_zth zth = {.where = c->line};
  vs_cursor_skip(c);
  vs_where where = vs_cursor_here(c);
  if (!read_positive(c, "K/W", &zth.k_per_w) || !read_positive(c, "s", &zth.tau_s))
    return vs_fail_at(err, where,
                      "zth: a thermal resistance and its time constant are wanted here, both "
                      "positive, as 0.5 K/W 1 ms");
  size_t same =
      deck->n_zth < VS_DECK_LIMITS ? 0 : VS_PART_ZTH; /* of the part; or the deck is full */
  for (size_t k = 0; k < deck->n_zth; k++) same += !strcmp(deck->zth[k].where.file, c->line.file);
  vs_status status = end_row(c, &zth.unsure, same, VS_PART_ZTH, err);
  if (!status) deck->zth[deck->n_zth++] = zth;
  return status;
}

/* time_current TIME CURRENT [assumed] "TEXT" */
vs_status vs_devices_time_current(vs_deck *deck, vs_cursor *c, vs_error *err) {
  vs_melting_row row = {.where = c->line};
  const vs_melting_row *last = deck->n_melting ? &deck->melting[deck->n_melting - 1] : NULL;
  vs_cursor_skip(c);
  vs_where where = vs_cursor_here(c);
  if (!read_positive(c, "s", &row.time_s) || !read_positive(c, "A", &row.current_a))
    return vs_fail_at(err, where,
                      "time_current: a time and the current that melts the fuse in it are wanted "
                      "here, both positive, as 0.1 s 12.6 A");
  if (last && !strcmp(last->where.file, c->line.file) &&
      !(row.time_s > last->time_s && row.current_a < last->current_a))
    return vs_fail_at(err, where,
                      "time_current: behind %.9g s and %.9g A a longer time and a smaller current "
                      "are wanted, not %.9g s and %.9g A",
                      last->time_s, last->current_a, row.time_s, row.current_a);
  vs_status status = end_row(c, &row.unsure, deck->n_melting, VS_DECK_LIMITS, err);
  if (!status) deck->melting[deck->n_melting++] = row;
  return status;
}

/* The last row of the limit's that stands above in the same file; NULL: there is none. */
static const vs_ambient_row *last_ambient(const vs_deck *deck, const char *file,
                                          const char *limit) {
  const vs_ambient_row *last = NULL;
  for (size_t k = 0; k < deck->n_ambients; k++)
    if (!strcmp(deck->ambients[k].where.file, file) && !strcmp(deck->ambients[k].limit, limit))
      last = &deck->ambients[k];
  return last;
}

/* Reads a temperature and a factor, as "70 degC 100 %". */
static bool read_ambient(vs_cursor *c, vs_ambient_row *row) {
  double percent;
  if (!read_plain(c, "degC", &row->ambient_degc) || !isfinite(row->ambient_degc)) return false;
  if (!read_plain(c, "%", &percent)) return false;
  row->factor = percent / 100;
  return row->factor >= 0 && row->factor < 10;
}

/* derate LIMIT TEMPERATURE degC FACTOR % [assumed] "TEXT" */
vs_status vs_devices_derate(vs_deck *deck, vs_cursor *c, vs_error *err) {
  vs_ambient_row row = {.where = c->line};
  vs_cursor_skip(c);
  vs_where where = vs_cursor_here(c);
  if (!vs_cursor_word(c, "", row.limit, sizeof row.limit) || !read_ambient(c, &row))
    return vs_fail_at(err, where,
                      "derate: a limit, an ambient temperature and what is left of the limit there "
                      "are wanted here, as p_rated 70 degC 100 %%");
  const vs_ambient_row *last = last_ambient(deck, c->line.file, row.limit);
  if (last && !(row.ambient_degc > last->ambient_degc && row.factor <= last->factor))
    return vs_fail_at(err, where,
                      "derate %s: behind %.9g degC and %.9g %% a higher temperature and no larger "
                      "a part are wanted, not %.9g degC and %.9g %%",
                      row.limit, last->ambient_degc, 100 * last->factor, row.ambient_degc,
                      100 * row.factor);
  vs_status status = end_row(c, &row.unsure, deck->n_ambients, VS_DECK_MOST, err);
  if (!status) deck->ambients[deck->n_ambients++] = row;
  return status;
}

/* A row of a table of pulses that this one contradicts: it has the same width and number, or it is
 * of no shorter and no fewer pulses and allows more. NULL: there is none. */
static const vs_derating *contradicted(const vs_deck *deck, const vs_derating *d) {
  for (size_t k = 0; k < deck->n_deratings; k++) {
    const vs_derating *o = &deck->deratings[k];
    if (strcmp(o->where.file, d->where.file)) continue;
    bool above = d->width_s >= o->width_s && d->number >= o->number,
         below = d->width_s <= o->width_s && d->number <= o->number;
    if ((above && below) || (above && d->current_a > o->current_a) ||
        (below && d->current_a < o->current_a))
      return o;
  }
  return NULL;
}

/* pulse WIDTH us NUMBER CURRENT A [assumed] "TEXT" */
vs_status vs_devices_pulse(vs_deck *deck, vs_cursor *c, vs_error *err) {
  vs_derating d = {.where = c->line};
  vs_cursor_skip(c);
  vs_where where = vs_cursor_here(c);
  if (!read_positive(c, "s", &d.width_s) || !read_plain(c, NULL, &d.number) || !(d.number >= 1) ||
      !read_positive(c, "A", &d.current_a))
    return vs_fail_at(err, where,
                      "pulse: a width, a number and a current are wanted here, as 20 us 10 2500 A");
  const vs_derating *other = contradicted(deck, &d);
  if (other)
    return vs_fail_at(err, where,
                      "pulse: %.9g A in %.9g pulses of %.9g us does not fit %.9g A in %.9g of %.9g "
                      "us, at line %d: each width and number stands once, and longer or more "
                      "pulses bear no more",
                      d.current_a, d.number, 1e6 * d.width_s, other->current_a, other->number,
                      1e6 * other->width_s, other->where.line);
  vs_status status = end_row(c, &d.unsure, deck->n_deratings, VS_DECK_LIMITS, err);
  if (!status) deck->deratings[deck->n_deratings++] = d;
  return status;
}

/* surge NUMBER CURRENT A [assumed] "TEXT" */
vs_status vs_devices_surge(vs_deck *deck, vs_cursor *c, vs_error *err) {
  vs_surge_row row = {.where = c->line};
  vs_cursor_skip(c);
  vs_where where = vs_cursor_here(c);
  if (!read_plain(c, NULL, &row.number) || !isfinite(row.number) || row.number < 1 ||
      !read_positive(c, "A", &row.current_a))
    return vs_fail_at(
        err, where,
        "surge: a number of cycles, from 1 on, and a peak current are wanted here, as "
        "10 95 A");
  vs_status status = end_row(c, &row.unsure, deck->n_surges, VS_DECK_LIMITS, err);
  for (size_t k = 0; k < deck->n_surges && !status; k++)
    if (!strcmp(deck->surges[k].where.file, c->line.file) && deck->surges[k].number == row.number)
      status = vs_fail_at(err, where, "surge: %g cycles stand here a second time; leave one out",
                          row.number);
  if (!status) deck->surges[deck->n_surges++] = row;
  return status;
}

/* at TEMPERATURE degC NAME = VALUE UNIT [assumed] "TEXT" */
vs_status vs_devices_at(vs_deck *deck, vs_cursor *c, vs_error *err) {
  vs_limit_at at = {.where = c->line};
  char value[VS_DECK_NAME], unit[VS_DECK_NAME], both[2 * VS_DECK_NAME], why[200];
  vs_cursor_skip(c);
  vs_where where = vs_cursor_here(c);
  vs_cursor_token(c, value, sizeof value);
  vs_cursor_token(c, unit, sizeof unit);
  snprintf(both, sizeof both, "%s %s", value, unit);
  if (!vs_units_read(both, "degC", &at.at_degc, why, sizeof why))
    return vs_fail_at(
        err, where,
        "at: a temperature of the junction and a limit are wanted here, as 25 degC t_q "
        "= 20 us");
  vs_status status = vs_cursor_name(c, at.name, sizeof at.name, err);
  if (status) return status;
  vs_cursor_skip(c);
  where = vs_cursor_here(c);
  const char *usual = vs_kinds_limit_unit(at.name);
  if (!usual || !read_positive(c, usual, &at.value))
    return vs_fail_at(err, where, "at: a positive value of limit %s is wanted here%s%s", at.name,
                      usual ? ", in a unit as " : "; no limit of that name is known",
                      usual ? usual : "");
  status = end_row(c, &at.unsure, deck->n_limits_at, VS_DECK_MOST, err);
  if (!status) deck->limits_at[deck->n_limits_at++] = at;
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
  vs_status status = vs_fail_at(
      err, d->where_of, "device %s: '%s' is no part of this deck and no kind; there are: %s%s",
      d->name, said, kinds.text, vs_text_hint(said, names, n, "").text);
  vs_text_free(&kinds);
  free(names);
  return status;
}

/* Gives the device its part, and its kind: that of the part's file, else the one the line says. A
 * part NAME_part says what the device NAME is, and is no element of the netlist. */
static vs_status resolve_kind(const vs_deck *deck, vs_device *d, vs_error *err) {
  const char *said = *d->of ? d->of : d->name;
  char series[VS_DECK_NAME + sizeof VS_DEVICE_PART];
  snprintf(series, sizeof series, "%s%s", d->name, VS_DEVICE_PART);
  d->part = find_part(deck, said);
  if (d->part < 0) d->part = find_part(deck, d->name);
  if (d->part < 0) d->part = find_part(deck, series);
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
  return vs_fail_at(err, d->where_ward, "device %s: no device '%s' stands in the deck%s", d->name,
                    d->ward, vs_text_hint(d->ward, names, deck->n_devices, "").text);
}

static const char *file_of(const vs_deck *deck, const vs_device *d) {
  return d->part < 0 ? NULL : deck->parts[d->part].file;
}

static const vs_limit *find_limit(const vs_deck *deck, const vs_device *d,
                                  const vs_device_measure *m) {
  bool ward = m->held == VS_WARD_AT_MOST;
  if (ward && d->protects < 0) return NULL;
  const char *file = file_of(deck, ward ? &deck->devices[d->protects] : d);
  const vs_limit *limit = file && m->limit ? vs_parts_find_limit(deck, file, m->limit) : NULL;
  return limit && isfinite(limit->value) ? limit : NULL;
}

void vs_devices_hold(vs_deck *deck) {
  static_assert(VS_DECK_LIMITS <= UCHAR_MAX, "a limit's number is a byte of vs_device.held");
  for (vs_device *d = deck->devices; d < deck->devices + deck->n_devices; d++)
    for (size_t k = 0; d->kind && k < d->kind->n_measures; k++) {
      assert(k < VS_DEVICE_MOST);
      const vs_limit *limit = find_limit(deck, d, &d->kind->measures[k]);
      d->held[k] = limit ? (unsigned char)(limit - deck->limits + 1) : 0;
    }
}

const vs_limit *vs_devices_limit(const vs_deck *deck, const vs_device *d,
                                 const vs_device_measure *m) {
  const size_t number = d->held[m - d->kind->measures];
  return number ? &deck->limits[number - 1] : NULL;
}

const vs_limit *vs_devices_own_limit(const vs_deck *deck, const vs_device *d, const char *name) {
  const char *file = file_of(deck, d);
  return file ? vs_parts_find_limit(deck, file, name) : NULL;
}

bool vs_devices_lacks(const vs_deck *deck, const vs_device *d, const vs_device_measure *m) {
  const char *file = file_of(deck, d);
  bool own = m->limit && m->held != VS_WARD_AT_MOST;
  return file && own && vs_kinds_decides(d->kind->name, m->limit) && vs_parts_is_real(deck, file) &&
         !vs_parts_find_limit(deck, file, m->limit);
}

double vs_devices_dv_dt_over(const vs_deck *deck, const vs_device *d) {
  return vs_parts_dv_dt_over(deck, file_of(deck, d));
}

/* ---- a table of pulses ---- */

double vs_devices_least_pulse(const vs_deck *deck, const vs_device *d) {
  const char *file = file_of(deck, d);
  double least_a = INFINITY;
  for (size_t k = 0; file && k < deck->n_deratings; k++)
    if (!strcmp(deck->deratings[k].where.file, file))
      least_a = fmin(least_a, deck->deratings[k].current_a);
  return isfinite(least_a) ? least_a : 0;
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
static double power_law_between(const bracket *b, double at) {
  if (isinf(b->x[1])) return NAN;
  if (isinf(b->x[0]) || b->x[0] == b->x[1]) return b->y[1];
  double part = log(at / b->x[0]) / log(b->x[1] / b->x[0]);
  return b->y[0] * pow(b->y[1] / b->y[0], part);
}

/* The current of the rows of one number, at that width. */
static double at_width(const vs_deck *deck, const char *file, double number, double width_s,
                       unsigned *unsure) {
  bracket b = NONE;
  for (size_t k = 0; k < deck->n_deratings; k++) {
    const vs_derating *d = &deck->deratings[k];
    if (strcmp(d->where.file, file) || d->number != number) continue;
    narrow(&b, d->width_s, width_s, d->current_a);
    *unsure |= d->unsure;
  }
  return power_law_between(&b, width_s);
}

double vs_devices_bears(const vs_deck *deck, const vs_device *device, double width_s, double number,
                        unsigned *unsure) {
  const char *file = file_of(deck, device);
  bracket b = NONE;
  *unsure = 0;
  for (size_t k = 0; file && k < deck->n_deratings; k++)
    if (!strcmp(deck->deratings[k].where.file, file))
      narrow(&b, deck->deratings[k].number, number, 0);
  for (int n = 0; n < 2; n++)
    b.y[n] = isinf(b.x[n]) ? NAN : at_width(deck, file, b.x[n], width_s, unsure);
  return power_law_between(&b, number);
}

/* ---- a time-current curve ---- */

bool vs_devices_curve(const vs_deck *deck, const vs_device *device, double span_s[2]) {
  const char *file = file_of(deck, device);
  span_s[0] = INFINITY;
  span_s[1] = 0;
  for (size_t k = 0; file && k < deck->n_melting; k++) {
    if (strcmp(deck->melting[k].where.file, file)) continue;
    span_s[0] = fmin(span_s[0], deck->melting[k].time_s);
    span_s[1] = fmax(span_s[1], deck->melting[k].time_s);
  }
  return span_s[1] > 0;
}

double vs_devices_melts_at(const vs_deck *deck, const vs_device *device, double time_s,
                           unsigned *unsure) {
  const char *file = file_of(deck, device);
  bracket b = NONE;
  *unsure = 0;
  for (size_t k = 0; file && k < deck->n_melting; k++) {
    const vs_melting_row *row = &deck->melting[k];
    if (strcmp(row->where.file, file)) continue;
    narrow(&b, row->time_s, time_s, row->current_a);
    *unsure |= row->unsure;
  }
  return isinf(b.x[0]) ? NAN : power_law_between(&b, time_s);
}

/* ---- what is left at an ambient temperature ---- */

/* The part of the limit that is left; 1: no line names it. NaN: the lines end before. */
static double left_at(const vs_deck *deck, const vs_limit *limit, double degc, unsigned *unsure) {
  const vs_ambient_row *below = NULL, *above = NULL;
  for (size_t k = 0; k < deck->n_ambients; k++) {
    const vs_ambient_row *row = &deck->ambients[k];
    if (strcmp(row->where.file, limit->where.file) || strcmp(row->limit, limit->name)) continue;
    *unsure |= row->unsure;
    if (row->ambient_degc <= degc) below = row;
    if (row->ambient_degc >= degc && !above) above = row;
  }
  if (!below && !above) return 1;
  if (!above) return below->factor > 0 ? NAN : 0;
  if (!below || below == above) return above->factor;
  double part = (degc - below->ambient_degc) / (above->ambient_degc - below->ambient_degc);
  return below->factor + part * (above->factor - below->factor);
}

const vs_limit *vs_devices_derated(const vs_deck *deck, const vs_limit *limit, double ambient_degc,
                                   vs_limit *own) {
  static const double NOTHING = 1e-9;
  unsigned unsure = 0;
  double factor = left_at(deck, limit, ambient_degc, &unsure);
  if (factor == 1) return limit;
  if (isnan(factor)) return NULL;
  *own = *limit;
  own->value *= fmax(factor, NOTHING);
  own->unsure = limit->unsure | unsure;
  snprintf(own->text, sizeof own->text, "%.4g %% of %s at %.4g degC", 100 * factor, limit->written,
           ambient_degc);
  snprintf(own->written, sizeof own->written, "%.4g %s", own->value / vs_units_factor(limit->unit),
           limit->unit);
  return own;
}

/* Error: a line names a limit that its file does not state, and which therefore leaves nothing; a
 * point of a time-current curve below the rated current, at which the fuse never melts. */
static vs_status check_tables(const vs_deck *deck, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < deck->n_ambients && !status; k++) {
    const vs_ambient_row *row = &deck->ambients[k];
    if (vs_parts_find_limit(deck, row->where.file, row->limit)) continue;
    status = vs_error_keep(
        err, vs_fail_at(err, row->where,
                        "derate %s: the file has no line '*$ limit %s = VALUE UNIT', of which this "
                        "would be a part",
                        row->limit, row->limit));
  }
  for (size_t k = 0; k < deck->n_melting && !status; k++) {
    const vs_melting_row *row = &deck->melting[k];
    const vs_limit *rated = vs_parts_find_limit(deck, row->where.file, "i_rated");
    if (!rated || isinf(rated->value) || row->current_a > rated->value) continue;
    status = vs_error_keep(
        err, vs_fail_at(err, row->where,
                        "time_current: %.9g A is no more than i_rated, %s, which the fuse carries "
                        "for ever; a current above that is wanted",
                        row->current_a, rated->written));
  }
  return status;
}

/* ---- surges, temperatures, thermal resistances ---- */

double vs_devices_bears_surge(const vs_deck *deck, const vs_device *device, double number,
                              unsigned *unsure) {
  const char *file = file_of(deck, device);
  bracket b = NONE;
  *unsure = 0;
  for (size_t k = 0; file && k < deck->n_surges; k++) {
    const vs_surge_row *row = &deck->surges[k];
    if (strcmp(row->where.file, file)) continue;
    narrow(&b, row->number, number, row->current_a);
    *unsure |= row->unsure;
  }
  return power_law_between(&b, number);
}

double vs_devices_most_surges(const vs_deck *deck, const vs_device *device) {
  const char *file = file_of(deck, device);
  double most = 0;
  for (size_t k = 0; file && k < deck->n_surges; k++)
    if (!strcmp(deck->surges[k].where.file, file)) most = fmax(most, deck->surges[k].number);
  return most;
}

const vs_limit_at *vs_devices_limit_at(const vs_deck *deck, const vs_device *device,
                                       const char *limit, double *t_j_max_degc) {
  const char *file = file_of(deck, device);
  const vs_limit *most = file ? vs_parts_find_limit(deck, file, "t_j_max") : NULL;
  if (!most || !isfinite(most->value)) return NULL;
  *t_j_max_degc = most->value;
  for (size_t k = 0; k < deck->n_limits_at; k++)
    if (!strcmp(deck->limits_at[k].where.file, file) && !strcmp(deck->limits_at[k].name, limit))
      return &deck->limits_at[k];
  return NULL;
}

double vs_devices_r_th(const vs_deck *deck, const vs_device *device, const char *name,
                       unsigned *unsure) {
  const char *file = file_of(deck, device);
  double sum = 0;
  if (!file) return NAN;
  for (size_t k = 0; k < deck->n_zth && !strcmp(name, "r_th_jc"); k++)
    if (!strcmp(deck->zth[k].where.file, file)) {
      sum += deck->zth[k].k_per_w;
      *unsure |= deck->zth[k].unsure;
    }
  if (sum > 0) return sum;
  const vs_limit *limit = vs_parts_find_limit(deck, file, name);
  if (!limit || !isfinite(limit->value)) return NAN;
  *unsure |= limit->unsure;
  return limit->value;
}

/* ---- what does not fit together ---- */

/* What makers state of a part's heat agrees within this; lines zth are read off a curve. */
static const double AGREES = 0.2;

/* The value of the part's finite limit of that name; NaN: it has none. */
static double limit_value(const vs_deck *deck, const char *file, const char *name) {
  const vs_limit *limit = vs_parts_find_limit(deck, file, name);
  return limit && isfinite(limit->value) ? limit->value : NAN;
}

/* Errors: r_th_jc that is not what the lines zth add up to, r_th_ja below r_th_jc. */
static vs_status check_heat(const vs_deck *deck, const vs_device *d, vs_error *err) {
  const char *file = file_of(deck, d);
  unsigned unsure = 0;
  double r_jc = vs_devices_r_th(deck, d, "r_th_jc", &unsure);
  const vs_limit *jc = file ? vs_parts_find_limit(deck, file, "r_th_jc") : NULL;
  const vs_limit *ja = file ? vs_parts_find_limit(deck, file, "r_th_ja") : NULL;
  vs_status status = VS_OK;
  if (jc && isfinite(jc->value) && fabs(jc->value - r_jc) > AGREES * r_jc)
    status = vs_error_keep(
        err, vs_fail_at(err, jc->where,
                        "limit r_th_jc: %s contradicts the lines zth, whose terms add up to %.4g "
                        "K/W; a value within 20 %% of that is wanted, or other terms",
                        jc->written, r_jc));
  if (!status && ja && ja->value < r_jc)
    status = vs_error_keep(
        err, vs_fail_at(err, ja->where,
                        "limit r_th_ja: %s is less than from junction to case alone, %.4g K/W; a "
                        "larger value is wanted",
                        ja->written, r_jc));
  return status;
}

/* Error: the part bears in one cycle of its table another surge than it states besides. */
static vs_status check_first_surge(const vs_surge_row *row, const vs_deck *deck, const char *file,
                                   vs_error *err) {
  const vs_limit *limit = vs_parts_find_limit(deck, file, "i_tsm");
  if (!limit) limit = vs_parts_find_limit(deck, file, "i_fsm");
  if (row->number != 1 || !limit || !isfinite(limit->value)) return VS_OK;
  if (fabs(row->current_a - limit->value) <= AGREES * limit->value) return VS_OK;
  return vs_fail_at(
      err, row->where,
      "surge: %g A in 1 cycle contradicts limit %s of %s (line %d); a value within 20 "
      "%% of that is wanted",
      row->current_a, limit->name, limit->written, limit->where.line);
}

/* Errors: more current in more cycles of surge, or not that of i_tsm in one. A line `at` of a limit
 * that the part does not state, without t_j_max or not below it. */
static vs_status check_rows(const vs_deck *deck, const char *file, vs_error *err) {
  vs_status status = VS_OK;
  double t_j_max = limit_value(deck, file, "t_j_max");
  for (size_t k = 0; k < deck->n_surges && !status; k++) {
    const vs_surge_row *a = &deck->surges[k];
    if (!strcmp(a->where.file, file)) status = check_first_surge(a, deck, file, err);
    for (size_t n = 0; n < deck->n_surges && !status; n++) {
      const vs_surge_row *b = &deck->surges[n];
      if (strcmp(a->where.file, file) || strcmp(b->where.file, file)) continue;
      if (a->number <= b->number || a->current_a <= b->current_a) continue;
      status = vs_fail_at(err, a->where,
                          "surge: %g A in %g cycles is more than %g A in %g cycles (line %d); what "
                          "is borne falls as the number grows",
                          a->current_a, a->number, b->current_a, b->number, b->where.line);
    }
  }
  for (size_t k = 0; k < deck->n_limits_at && !status; k++) {
    const vs_limit_at *at = &deck->limits_at[k];
    if (strcmp(at->where.file, file)) continue;
    if (!vs_parts_find_limit(deck, file, at->name))
      status = vs_fail_at(err, at->where,
                          "at: the part has no line '*$ limit %s = VALUE UNIT', which says what it "
                          "is at t_j_max",
                          at->name);
    else if (!(at->at_degc < t_j_max))
      status = vs_fail_at(err, at->where,
                          "at: the limit %s is that at t_j_max: a line '*$ limit t_j_max = VALUE "
                          "degC' is wanted, and here a temperature below it",
                          at->name);
  }
  return vs_error_keep(err, status);
}

static vs_status check_limits(const vs_deck *deck, const vs_device *d, vs_error *err) {
  vs_status status = check_heat(deck, d, err);
  const char *file = file_of(deck, d);
  if (!status && file) status = check_rows(deck, file, err);
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
    status = vs_error_keep(err, status);
  }
  return status;
}

vs_status vs_devices_resolve(vs_deck *deck, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < deck->n_devices && !status; k++) {
    vs_device *d = &deck->devices[k];
    status = vs_error_keep(err, resolve_kind(deck, d, err));
    if (!status) status = vs_error_keep(err, resolve_gates(deck, d, err));
    if (!status) status = vs_error_keep(err, check_flux(d, err));
    if (!status) status = vs_error_keep(err, resolve_ward(deck, d, err));
  }
  vs_devices_hold(deck);
  for (size_t k = 0; k < deck->n_devices && !status; k++)
    status = check_limits(deck, &deck->devices[k], err);
  return status ? status : check_tables(deck, err);
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
