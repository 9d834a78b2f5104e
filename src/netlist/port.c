/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/port.h"

#include <stdio.h>
#include <string.h>

#include "base/text.h"
#include "base/units.h"

/* What a deck may say, by VS_PORT_.... A drive without a name is put in by the program alone. */
static const struct drive {
  const char *name;
  bool gated;     /* follows gate pulses */
  bool modulated; /* follows pulse-width modulation */
} DRIVES[] = {[VS_PORT_MAINS] = {"mains", false, false},    [VS_PORT_GATE] = {"gate", true, false},
              [VS_PORT_BURST] = {"burst", true, false},     [VS_PORT_PWM] = {"pwm", false, true},
              [VS_PORT_PWM_LOW] = {"pwm_low", false, true}, [VS_PORT_EVENT] = {NULL, false, false},
              [VS_PORT_ON_LINE] = {NULL, false, false}};
_Static_assert(sizeof DRIVES / sizeof *DRIVES == VS_PORT_DRIVES, "a row for each drive");

/* True where the drive's pulses may be delayed by an angle. */
static bool may_shift(const struct drive *d) {
  return d->gated || d->modulated;
}

static vs_status unknown_port(const char *name, int length, vs_where where, vs_error *err) {
  vs_text all = {0};
  for (int k = 0; k < VS_PORT_DRIVES; k++) {
    const struct drive *d = &DRIVES[k];
    if (!d->name) continue;
    vs_text_add(&all, "%s%s", all.length ? ", " : "", d->name);
    if (may_shift(d)) vs_text_add(&all, ", %s+ANGLE", d->name);
  }
  vs_status status =
      vs_fail_at(err, where, "no port '%.*s'; there are: %s", length, name, all.text);
  vs_text_free(&all);
  return status;
}

vs_status vs_port_read(const char *name, vs_where where, vs_signal *signal, vs_error *err) {
  char why[200];
  size_t length = strcspn(name, "+");
  bool shifted = name[length];
  int drive = 0;
  *signal = (vs_signal){0};
  for (; drive < VS_PORT_DRIVES; drive++) {
    const struct drive *d = &DRIVES[drive];
    if (d->name && strlen(d->name) == length && !strncmp(name, d->name, length) &&
        (may_shift(d) || !shifted))
      break;
  }
  if (drive == VS_PORT_DRIVES) return unknown_port(name, (int)length, where, err);
  signal->drive = drive;
  if (shifted && !vs_units_read(name + length + 1, "deg", &signal->shift_rad, why, sizeof why))
    return vs_fail_at(err, where, "port %.*s: %s", (int)length, name, why);
  return VS_OK;
}

bool vs_port_read_gate(const char *name, double *shift_rad) {
  char why[200];
  if (strncmp(name, "gate", 4) || (name[4] && name[4] != '+')) return false;
  *shift_rad = 0;
  return !name[4] || vs_units_read(name + 5, "deg", shift_rad, why, sizeof why);
}

bool vs_port_is_gated(const vs_signal *signal) {
  return DRIVES[signal->drive].gated;
}

bool vs_port_is_modulated(const vs_signal *signal) {
  return DRIVES[signal->drive].modulated;
}

bool vs_port_is_burst(const vs_signal *s) {
  return s->drive == VS_PORT_BURST;
}
