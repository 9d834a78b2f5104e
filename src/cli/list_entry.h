/* SPDX-License-Identifier: GPL-3.0-or-later
 * Entries of a listing, told once and written either as lines for people or as JSON. */
#pragma once

#include <stdbool.h>

#include "base/json.h"
#include "base/text.h"

/* A listing that is being written. Start from {.filter = ..., .as_json = ...}; what it wrote is in
 * `out`. The other members are its own. */
typedef struct vs_entries {
  const char *filter; /* only entries whose lines have it, capitals aside; NULL: all. Borrowed */
  bool as_json;
  vs_text out; /* lines, or the members of a JSON array without its brackets */
  int count;   /* how many entries were written */
  vs_text heads; /* the lines without details */
  bool inside, matched, detailed;
  vs_text lines, sought, object; /* sought: what the filter looks at */
  size_t head; /* bytes of the entry's lines that are no details; 0: all */
  vs_json json;
} vs_entries;

/* Begins an entry; vs_list_entry_end ends it. */
void vs_list_entry_begin(vs_entries *entries);
/* Adds the entry to what was written, if the filter lets it pass. An entry without lines of its own
 * goes with the one before it. */
void vs_list_entry_end(vs_entries *entries);

/* Ends what names the entry: the lines behind it are details, which the filter does not look at, and
 * which vs_list_entry_lines leaves out where there are many entries. only: all that the filter
 * looks at; NULL: the lines before. */
void vs_list_entry_details(vs_entries *entries, const char *only);

/* What people are shown: of more than three entries with details the lines that name them, and how
 * to see the rest. Borrowed. */
const char *vs_list_entry_lines(vs_entries *entries);

/* A column of a line, `width` bytes wide at least, and a member of the JSON object. */
void vs_list_entry_put(vs_entries *entries, const char *key, int width, const char *value);
/* A column that the filter does not look at: the folder in which a file lies is no property of it.
 */
void vs_list_entry_path(vs_entries *entries, const char *key, const char *path);
/* A part of a line that JSON does not have. */
void vs_list_entry_say(vs_entries *entries, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* Ends the line; the next column begins another. */
void vs_list_entry_line(vs_entries *entries);
/* Members that only JSON has. */
void vs_list_entry_text(vs_entries *entries, const char *key, const char *value);
void vs_list_entry_number(vs_entries *entries, const char *key, double value);
void vs_list_entry_true(vs_entries *entries, const char *key);

/* Begins and ends an array of objects inside the entry's. */
void vs_list_entry_array(vs_entries *entries, const char *key);
void vs_list_entry_array_end(vs_entries *entries);
void vs_list_entry_object(vs_entries *entries);
void vs_list_entry_object_end(vs_entries *entries);

void vs_list_entry_free(vs_entries *entries);
