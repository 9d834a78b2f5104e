/* SPDX-License-Identifier: GPL-3.0-or-later
 * Notes on a circuit that may be slow or fail to converge: a text with its place, and numbers for
 * --json. */
#pragma once

#include "base/error.h"
#include "base/text.h"

enum { VS_NOTES_MOST = 64, VS_NOTE_NUMBERS = 10 };

/* A number of a note; its name ends with its unit. */
typedef struct vs_note_number {
  const char *name;
  double value;
} vs_note_number;

typedef struct vs_note {
  const char *kind;  /* "floating", "method", ... */
  const char *level; /* "warning": something is wrong with the deck; "hint": it may be faster or
                        safer; "note": what was tried */
  vs_error text;     /* with its place */
  vs_note_number number[VS_NOTE_NUMBERS];
  int numbers;
} vs_note;

/* Begins as {0}. */
typedef struct vs_notes {
  vs_note item[VS_NOTES_MOST];
  size_t count;
} vs_notes;

/* Adds a note; the caller writes its text with vs_fail_at. Beyond VS_NOTES_MOST the last note is
 * overwritten. */
vs_note *vs_note_add(vs_notes *notes, const char *kind, const char *level);
void vs_note_number_add(vs_note *note, const char *name, double value);

/* Adds each note as an object of check's JSON array, on a line of its own. `file` is used for notes
 * without a place. */
void vs_note_rows(const vs_notes *notes, const char *file, vs_text *rows);
