/* SPDX-License-Identifier: GPL-3.0-or-later
 * The pictures of a study's report: the kinds that its methods name, drawn for its columns. */
#pragma once

#include "plot/study_plot.h"

enum { VS_STUDY_PICTURES_MOST = 128 }; /* pictures at most */
typedef struct vs_study_pictures {
  vs_picture
      item[VS_STUDY_PICTURES_MOST]; /* the one that answers the study's question comes first */
  size_t count;
  size_t left_out; /* pictures there was no room for */
} vs_study_pictures;

/* Draws the pictures that the study's methods ask for (vs_method_report). If there are several
 * methods, the last, whose index runs fastest, decides how each column is shown. A study without a
 * method that this program knows is shown like a grid. Errors: the study can no longer be read.
 * vs_study_pictures_free is due even then. */
vs_status vs_study_pictures_make(const vs_folder *table, const vs_study_results *survey,
                                 vs_study_pictures *album, vs_error *err);
void vs_study_pictures_free(vs_study_pictures *album);

/* True where there is a kind of picture of that name, which a method may name; for tests. */
bool vs_study_pictures_knows(const char *name);
