/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "control/view.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>

#include "syntax/units.h"

void vs_view_add(vs_view *view, const char *column, const char *unit) {
  const int k = view->firing.count;
  char suffix[32];
  if (k == VS_VIEW_MOST) return;
  vs_units_suffix(unit, suffix, sizeof suffix);
  snprintf(view->name[k], VS_VIEW_NAME, "%s%s%s", column, *suffix ? "_" : "", suffix);
  view->channel[k] = (vibrospice_channel){view->name[k], NAN, NAN, NAN};
  view->firing.channel = view->channel;
  view->firing.count++;
  view->firing.last_angle_deg = NAN;
}

void vs_view_sample(vs_view *view, int k, double value) {
  vibrospice_channel *c = &view->channel[k];
  c->now = value;
  c->least = fmin(c->least, value);
  c->largest = fmax(c->largest, value);
}

void vs_view_begin(vs_view *view, double t_s) {
  view->firing.t_s = t_s;
  view->firing.number++;
}

vs_status vs_view_end(vs_view *view, const char *who, double angle_deg, const char *trouble,
                      vs_error *err) {
  const double t_s = view->firing.t_s;
  if (*trouble) {
    char line[VIBROSPICE_LAW_TEXT];
    snprintf(line, sizeof line, "%s", trouble);
    for (char *c = line; *c; c++)
      if ((unsigned char)*c < ' ' || *c == 127) *c = ' ';
    return vs_fail(err, VS_RUN, "t = %.9g s: control: %s says: %s", t_s, who, line);
  }
  if (!isnan(angle_deg) && !(angle_deg > 0 && angle_deg < 180))
    return vs_fail(err, VS_RUN,
                   "t = %.9g s: control: %s answered an angle of %.9g deg; allowed: 0..180 deg, "
                   "without the ends",
                   t_s, who, angle_deg);
  view->firing.last_angle_deg = angle_deg;
  for (int k = 0; k < view->firing.count; k++)
    view->channel[k].least = view->channel[k].largest = view->channel[k].now;
  return VS_OK;
}

size_t vs_view_size(const vs_view *view) {
  return offsetof(vs_view, channel) + (size_t)view->firing.count * sizeof *view->channel;
}
