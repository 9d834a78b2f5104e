/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnosis/note.h"

#include <math.h>
#include <stdio.h>

#include "base/json.h"

vs_note *vs_note_add(vs_notes *notes, const char *kind, const char *level) {
  if (notes->count == VS_NOTES_MOST) notes->count--;
  vs_note *note = &notes->item[notes->count++];
  *note = (vs_note){.kind = kind, .level = level};
  return note;
}

void vs_note_number_add(vs_note *note, const char *name, double value) {
  if (note->numbers < VS_NOTE_NUMBERS)
    note->number[note->numbers++] = (vs_note_number){name, value};
}

static void add_row(const vs_note *note, const char *file, vs_text *rows) {
  const vs_error *e = &note->text;
  char own[sizeof e->text];
  snprintf(own, sizeof own, "%.*s", e->file_size, e->text);
  vs_json json = vs_json_new(rows);
  vs_json_object(&json, NULL, VS_JSON_ROW);
  vs_json_text(&json, "file", e->file_size ? own : file);
  vs_json_number(&json, "line", e->line ? (double)e->line : (double)NAN, 12);
  vs_json_number(&json, "column", e->line ? (double)e->column : (double)NAN, 12);
  vs_json_text(&json, "message", e->text + e->place_size);
  vs_json_text(&json, "kind", note->kind);
  vs_json_text(&json, "level", note->level);
  for (int k = 0; k < note->numbers; k++)
    vs_json_number(&json, note->number[k].name, note->number[k].value, 6);
  vs_json_end(&json);
  vs_text_add(rows, "\n");
}

void vs_note_rows(const vs_notes *notes, const char *file, vs_text *rows) {
  for (size_t k = 0; k < notes->count; k++) add_row(&notes->item[k], file, rows);
}
