/* SPDX-License-Identifier: GPL-3.0-or-later
 * The pictures of a study's report: the kinds its methods name, drawn for its columns. */
#ifndef VS_REPORT_ALBUM_H
#define VS_REPORT_ALBUM_H

#include "plot/sketch.h"

enum { VS_ALBUM = 128 }; /* pictures at most */
typedef struct vs_album {
  vs_picture item[VS_ALBUM]; /* the one that answers the study's question comes first */
  size_t count;
  size_t left_out; /* pictures there was no room for */
} vs_album;

/* Draws the pictures that the study's methods ask for (vs_method_report). Of several methods the
 * last, whose index runs fastest, says how each column is shown. A study of none that this program
 * has is shown as a grid is. Errors: the study can no longer be read. vs_album_free even then. */
vs_status vs_album_make(const vs_folder *table, const vs_survey *survey, vs_album *album,
                        vs_error *err);
void vs_album_free(vs_album *album);

/* True where there is a kind of picture of that name, which a method may name; for tests. */
bool vs_album_knows(const char *name);

#endif
