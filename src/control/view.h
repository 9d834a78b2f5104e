/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a law of the user's own is shown when it decides a firing: each channel's last sample, and
 * its least and largest since the firing before was decided. A law that runs once in a cycle finds
 * half of a swing, peak to peak, in that. */
#ifndef VS_CONTROL_VIEW_H
#define VS_CONTROL_VIEW_H

#define VIBROSPICE_LAW_READER
#include <vibrospice/law.h>

#include "base/error.h"

enum { VS_VIEW_MOST = 64, VS_VIEW_NAME = 64 }; /* channels; bytes of a name */

/* Start from {0}. Not to be moved: it points into itself. */
typedef struct vs_view {
  vibrospice_firing firing; /* what laws are given; the channels follow it without a gap */
  vibrospice_channel channel[VS_VIEW_MOST];
  char name[VS_VIEW_MOST][VS_VIEW_NAME];
} vs_view;

/* Adds a channel, which is called "COLUMN_UNIT" as in run.csv. Beyond VS_VIEW_MOST none is added.
 */
void vs_view_add(vs_view *view, const char *column, const char *unit);

/* Notes the present sample of channel k. */
void vs_view_sample(vs_view *view, int k, double value);

/* A firing is to be decided now, at t_s. */
void vs_view_begin(vs_view *view, double t_s);
/* The law, which messages call `who`, has answered: with an angle, deg, or NaN for none, unless
 * `trouble` is not empty. Least and largest begin anew, with the last sample. Errors, VS_RUN: the
 * trouble, of which one line is shown; an angle that no firing can have. */
vs_status vs_view_end(vs_view *view, const char *who, double angle_deg, const char *trouble,
                      vs_error *err);

/* How many bytes of the view, from its start, change from firing to firing. */
size_t vs_view_size(const vs_view *view);

#endif
