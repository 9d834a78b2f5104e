/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a law of the user's own is shown when it decides a firing: the last sample of each
 * instrument and of each estimate, and its least and largest since the firing before was decided. A
 * law that runs once in a cycle finds half of a swing, peak to peak, in that. And what becomes of
 * its answer. */
#pragma once

#define VIBROSPICE_LAW_READER
#include <vibrospice/law.h>

#include "control/regulator.h"

enum {
  VS_VIEW_MOST = VS_INSTRUMENT_MOST + VS_MOST_STATES, /* channels */
  VS_VIEW_NAME = 64                                   /* bytes of a name, its end included */
};

/* Begins as zeros. Not to be moved: it points into itself. */
typedef struct vs_law_input {
  vibrospice_firing firing; /* what laws are given; the channels follow it without a gap */
  vibrospice_channel channel[VS_VIEW_MOST];
  double unit[VS_VIEW_MOST]; /* of each channel, SI */
  char name[VS_VIEW_MOST][VS_VIEW_NAME];
} vs_law_input;

/* Gives the view its channels: the instruments and the estimates, called as their columns
 * in run.csv. */
void vs_law_input_begin(vs_law_input *view, const vs_control_input *sight);
/* Notes the present samples. */
void vs_law_input_tick(vs_law_input *view, const vs_control_input *sight);
/* The firing that is to be decided now. */
void vs_law_input_ask(vs_law_input *view, const vs_control_input *sight);

/* Takes the answer of the law, which messages call `who`: an angle, deg, or NaN for none, unless
 * `trouble` is not empty. Sets *angle_rad, and lets least and largest begin anew, with the last
 * sample. Errors, VS_RUN: the trouble, in one line; an angle that no firing can have. */
vs_status vs_law_input_answer(vs_law_input *view, const char *who, double angle_deg,
                              const char *trouble, double *angle_rad, vs_error *err);

/* How many bytes of the view, from its start, change from firing to firing. */
size_t vs_law_input_size(const vs_law_input *view);

/* Writes the path of a file that a law's key names: in the folder of the scene or study that names
 * it, or in the working folder where the command line does. False: it is too long. */
bool vs_law_input_path(const char *name, vs_where where, char path[VS_PATH_SIZE]);
