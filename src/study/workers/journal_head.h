/* SPDX-License-Identifier: GPL-3.0-or-later
 * The head of a study's journal: what tells the study from others, and what its files need besides
 * the rows. journal.h says how its lines stand in the file. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/text.h"

enum { VS_MOST_SHARDS = 10000 };

/* Start from {0}, and free with vs_journal_head_free. The strings are the head's own. */
typedef struct vs_journal_head {
  char *identity;           /* SHA-256 over the plan and all it is made of */
  char *columns, *failures; /* header rows of study.csv and failures.csv */
  char *manifest_begin;     /* manifest.json up to the counts of cases */
  char *manifest_end;       /* manifest.json from behind the counts to the shard */
  uint64_t cases;           /* of the whole study; 0: not known before its end */
  uint64_t shard, shards;   /* this shard, from 1, and how many there are; case k belongs to shard
                               1 + k % shards */
} vs_journal_head;
void vs_journal_head_free(vs_journal_head *head);

/* Returns the name of the first line in which two heads differ; NULL: in none. How files and the
 * study are named in the manifest is no difference. */
const char *vs_journal_head_differs(const vs_journal_head *a, const vs_journal_head *b);

/* True if two heads of different identity were made by two programs. Each is then named, by its
 * version and those of its libraries; texts have room for `size` bytes. */
bool vs_journal_head_programs(const vs_journal_head *a, const vs_journal_head *b, char *of_a,
                              char *of_b, size_t size);

/* Adds a line of a journal, with its sum and its kind ('h', 'H', 'm', '=', '!', '~' or 'j'). The
 * text's own line ends are written as \n. */
void vs_journal_head_line(vs_text *to, char kind, const char *text, size_t length);

/* Where in such a line its kind stands, and its text. */
enum { VS_HEAD_KIND = 9, VS_HEAD_TEXT = 11 };

/* Returns the kind of such a line, whose end is cut off; 0: its sum is wrong, it has no text, or
 * one of its bytes is zero. Behind its `length` bytes a zero stands. */
char vs_journal_head_kind(const char *line, size_t length);

/* Adds all lines of a head. */
void vs_journal_head_print(vs_text *to, const vs_journal_head *head);

/* Adds the lines of a copy of the head, which are of kind 'H'. */
void vs_journal_head_print_copy(vs_text *to, const vs_journal_head *head);

/* Gives a head the lines that it lacks and `copy` has. */
void vs_journal_head_fill(vs_journal_head *head, const vs_journal_head *copy);

/* True for a head's first line that names another version of the journal than this program reads.
 */
bool vs_journal_head_is_foreign(const char *text);

/* Takes the text of a line of kind h, or of H into a head that has nothing but copies. first: it
 * begins the journal. What the head has already is not taken again; *twice becomes true if
 * it says something else. Returns false where it is no line of a head, or one that stands there
 * already: a block of the file was written twice. */
bool vs_journal_head_read(vs_journal_head *head, const char *text, bool first, bool *twice);

/* Returns true if every line was read. */
bool vs_journal_head_is_whole(const vs_journal_head *head);

/* How many cases a study has, and what has come of them. */
typedef struct vs_journal_head_counts {
  uint64_t cases, done, failed, violated;
} vs_journal_head_counts;

/* Adds the manifest. merged: the counts are those of all shards. more: further members, as a writer
 * inside it (vs_json_inside) adds them; NULL: none. */
void vs_journal_head_manifest(const vs_journal_head *head, const vs_journal_head_counts *counts,
                              bool merged, const char *more, vs_text *text);

/* True if the head's two parts of the manifest make one, with the counts between them. */
bool vs_journal_head_has_manifest(const vs_journal_head *head);
