/* SPDX-License-Identifier: GPL-3.0-or-later
 * Which pictures a study's question asks for. */
#ifndef VS_PICTURE_ALBUM_H
#define VS_PICTURE_ALBUM_H

#include "picture/sketch.h"

enum { VS_ALBUM = 128 };
typedef struct vs_album {
  vs_picture item[VS_ALBUM]; /* the one that answers the question first */
  size_t count;
  size_t left_out; /* columns there was no room for */
} vs_album;

/* Do its cases stand for what a spread makes of the parts, so that a share of them is a yield? */
bool vs_album_is_sampled(const vs_folder *table);

/* Errors: the study can no longer be read. vs_album_free even then. */
vs_status vs_album_make(const vs_folder *table, const vs_survey *survey, vs_album *album,
                        vs_error *err);
void vs_album_free(vs_album *album);

#endif
