/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "law_input.h"

#include <gsl/gsl_math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"
#include "base/units.h"

static const double RAD_PER_DEG = M_PI / 180;

static void add_channel_to_view(vs_law_input *view, const char *column, const char *unit) {
  const int k = view->firing.count++;
  char suffix[32];
  vs_units_suffix(unit, suffix, sizeof suffix);
  snprintf(view->name[k], VS_VIEW_NAME, "%s%s%s", column, *suffix ? "_" : "", suffix);
  view->channel[k] = (vibrospice_channel){view->name[k], NAN, NAN, NAN};
  view->unit[k] = vs_units_factor(unit);
}

void vs_law_input_begin(vs_law_input *view, const vs_control_input *sight) {
  const vs_instruments *all = sight->instruments;
  const vs_state_observer *o = sight->observing;
  view->firing.channel = view->channel;
  for (int k = 0; k < all->count; k++)
    add_channel_to_view(view, all->item[k].column, all->item[k].unit);
  for (int k = 0; k < o->estimates; k++)
    add_channel_to_view(view, o->estimate[k].column, o->estimate[k].unit);
}

void vs_law_input_tick(vs_law_input *view, const vs_control_input *sight) {
  for (int k = 0; k < view->firing.count; k++) {
    vibrospice_channel *c = &view->channel[k];
    c->now = sight->value[k] / view->unit[k];
    c->least = fmin(c->least, c->now); /* fmin passes a NaN over */
    c->largest = fmax(c->largest, c->now);
  }
}

void vs_law_input_ask(vs_law_input *view, const vs_control_input *sight) {
  vs_law_input_tick(view, sight);
  view->firing.t_s = sight->t_s;
  view->firing.number = sight->firing + 1;
  view->firing.last_angle_deg = sight->last_rad / RAD_PER_DEG;
}

/* Makes one line of a law's trouble, which may hold anything: its beginning, up to what is not
 * UTF-8 (as where it was cut within a character). */
static void make_one_line(const char *trouble, char line[VIBROSPICE_LAW_TEXT]) {
  const char *wrong = vs_text_not_utf8(trouble, strnlen(trouble, VIBROSPICE_LAW_TEXT - 1));
  snprintf(line, VIBROSPICE_LAW_TEXT, "%.*s",
           wrong ? (int)(wrong - trouble) : VIBROSPICE_LAW_TEXT - 1, trouble);
  for (char *c = line; *c; c++)
    if ((unsigned char)*c < ' ' || *c == 127) *c = ' ';
}

vs_status vs_law_input_answer(vs_law_input *view, const char *who, double angle_deg,
                              const char *trouble, double *angle_rad, vs_error *err) {
  const double t_s = view->firing.t_s;
  if (*trouble) {
    char line[VIBROSPICE_LAW_TEXT];
    make_one_line(trouble, line);
    return vs_fail(err, VS_RUN, "t = %.9g s: control: %s says: %s", t_s, who, line);
  }
  if (!isnan(angle_deg) && !(angle_deg > 0 && angle_deg < 180))
    return vs_fail(err, VS_RUN,
                   "t = %.9g s: control: %s answered an angle of %.9g deg; allowed: 0..180 deg "
                   "(ends excluded)",
                   t_s, who, angle_deg);
  for (int k = 0; k < view->firing.count; k++)
    view->channel[k].least = view->channel[k].largest = view->channel[k].now;
  *angle_rad = angle_deg * RAD_PER_DEG;
  return VS_OK;
}

size_t vs_law_input_size(const vs_law_input *view) {
  return offsetof(vs_law_input, channel) + (size_t)view->firing.count * sizeof *view->channel;
}

bool vs_law_input_path(const char *name, vs_where where, char path[VS_PATH_SIZE]) {
  static const char SET[] = "--set ";
  const bool line = !where.file || !strncmp(where.file, SET, sizeof SET - 1);
  const char *slash = line || *name == '/' ? NULL : strrchr(where.file, '/');
  const int folder = slash ? (int)(slash + 1 - where.file) : 0;
  return snprintf(path, VS_PATH_SIZE, "%.*s%s", folder, folder ? where.file : "", name) <
         VS_PATH_SIZE;
}
