/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "workers/journal_head.h"

#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/json.h"
#include "study/plan.h"

/* Versions of the journal: 1 had no copies of the head (H) and no rows called back (~). A journal
 * of version 1 is read as one of 2 that happens to have none. */
static const char MAGIC[] = "vibrospice journal 2", OLDER[] = "vibrospice journal 1",
                  BEFORE_VERSION[] = "vibrospice journal ";

/* The head's texts, in the order of their lines. */
static const struct {
  const char *name;
  size_t offset;
} TEXTS[] = {{"identity", offsetof(vs_journal_head, identity)},
             {"columns", offsetof(vs_journal_head, columns)},
             {"failures", offsetof(vs_journal_head, failures)},
             {"manifest_begin", offsetof(vs_journal_head, manifest_begin)},
             {"manifest_end", offsetof(vs_journal_head, manifest_end)}};
enum { N_TEXTS = sizeof TEXTS / sizeof *TEXTS, MANIFEST = 3 /* the first text of it */ };

static char **text_of_head(vs_journal_head *head, size_t k) {
  return (char **)(void *)((char *)head + TEXTS[k].offset);
}

static const char *text_in(const vs_journal_head *head, size_t k) {
  return *(char *const *)(const void *)((const char *)head + TEXTS[k].offset);
}

void vs_journal_head_free(vs_journal_head *head) {
  for (size_t k = 0; k < N_TEXTS; k++) free(*text_of_head(head, k));
  *head = (vs_journal_head){0};
}

void vs_journal_head_line(vs_text *to, char kind, const char *text, size_t length) {
  vs_text line = {0};
  vs_text_add(&line, "%c ", kind);
  const char *end = text + length;
  for (const char *s = text; s < end;) {
    const char *stop = memchr(s, '\n', (size_t)(end - s));
    vs_text_add(&line, "%.*s%s", (int)((stop ? stop : end) - s), s, stop ? "\\n" : "");
    s = stop ? stop + 1 : end;
  }
  vs_text_add(to, "%08" PRIx32 " %s\n", vs_hash_crc32(line.text, line.length), line.text);
  vs_text_free(&line);
}

char vs_journal_head_kind(const char *line, size_t length) {
  char *after;
  const bool good =
      length > VS_HEAD_TEXT && strlen(line) == length &&
      strtoull(line, &after, 16) == vs_hash_crc32(line + VS_HEAD_KIND, length - VS_HEAD_KIND) &&
      after == line + VS_HEAD_KIND - 1;
  return good ? line[VS_HEAD_KIND] : '\0';
}

/* In the texts a backslash is written twice, as it begins a line end. */
static void print_lines(vs_text *to, char kind, const vs_journal_head *head) {
  vs_text line = {0};
  for (size_t k = 0; k < N_TEXTS; k++) {
    line.length = 0;
    vs_text_add(&line, "%s=", TEXTS[k].name);
    for (const char *s = text_in(head, k); *s; s++)
      vs_text_add(&line, "%s%c", *s == '\\' ? "\\" : "", *s);
    vs_journal_head_line(to, kind, line.text, line.length);
  }
  line.length = 0;
  vs_text_add(&line, "counts=%" PRIu64 " %" PRIu64 " %" PRIu64, head->cases, head->shard,
              head->shards);
  vs_journal_head_line(to, kind, line.text, line.length);
  vs_text_free(&line);
}

void vs_journal_head_print(vs_text *to, const vs_journal_head *head) {
  vs_journal_head_line(to, 'h', MAGIC, strlen(MAGIC));
  print_lines(to, 'h', head);
}

void vs_journal_head_print_copy(vs_text *to, const vs_journal_head *head) {
  print_lines(to, 'H', head);
}

void vs_journal_head_fill(vs_journal_head *head, const vs_journal_head *copy) {
  for (size_t k = 0; k < N_TEXTS; k++)
    if (!*text_of_head(head, k) && text_in(copy, k))
      *text_of_head(head, k) = vs_copy(text_in(copy, k));
  if (head->shards) return;
  head->cases = copy->cases;
  head->shard = copy->shard;
  head->shards = copy->shards;
}

bool vs_journal_head_is_foreign(const char *text) {
  return !strncmp(text, BEFORE_VERSION, sizeof BEFORE_VERSION - 1) && strcmp(text, MAGIC) != 0 &&
         strcmp(text, OLDER) != 0;
}

/* Turns \n back into line ends, and two backslashes into one. */
static char *unfold_line_ends(const char *text) {
  char *copy = vs_copy(text), *out = copy;
  for (const char *s = copy; *s; s++)
    if (s[0] == '\\' && (s[1] == 'n' || s[1] == '\\'))
      *out++ = *++s == 'n' ? '\n' : '\\';
    else
      *out++ = *s;
  *out = '\0';
  return copy;
}

/* Reads a count that is digits and nothing else, up to `most`. */
static bool read_count(const char **at, char end, uint64_t most, uint64_t *count) {
  size_t n = strspn(*at, "0123456789");
  *count = strtoull(*at, NULL, 10);
  if (!n || n > 18 || (*at)[n] != end || *count > most) return false;
  *at += n + 1;
  return true;
}

/* Reads the line of counts. Counts that no study has are not taken, and the head then lacks them.
 * *twice becomes true where the head has others. */
static bool read_counts(vs_journal_head *head, const char *text, bool *twice) {
  vs_journal_head h;
  if (!read_count(&text, ' ', VS_PLAN_CASES, &h.cases) ||
      !read_count(&text, ' ', VS_MOST_SHARDS, &h.shard) ||
      !read_count(&text, '\0', VS_MOST_SHARDS, &h.shards) || !h.shard || h.shard > h.shards)
    return false;
  *twice = *twice || (head->shards && (head->cases != h.cases || head->shard != h.shard ||
                                       head->shards != h.shards));
  if (head->shards) return *twice;
  head->cases = h.cases;
  head->shard = h.shard;
  head->shards = h.shards;
  return true;
}

bool vs_journal_head_read(vs_journal_head *head, const char *text, bool first, bool *twice) {
  static const char COUNTS[] = "counts=";
  if (!strcmp(text, MAGIC) || !strcmp(text, OLDER)) return first;
  for (size_t k = 0; k < N_TEXTS; k++) {
    size_t n = strlen(TEXTS[k].name);
    if (strncmp(text, TEXTS[k].name, n) || text[n] != '=') continue;
    char *now = unfold_line_ends(text + n + 1), **at = text_of_head(head, k);
    const bool again = *at && !strcmp(*at, now);
    *twice = *twice || (*at && !again);
    if (*at)
      free(now);
    else
      *at = now;
    return !again;
  }
  if (strncmp(text, COUNTS, sizeof COUNTS - 1)) return false;
  return read_counts(head, text + sizeof COUNTS - 1, twice);
}

bool vs_journal_head_is_whole(const vs_journal_head *head) {
  for (size_t k = 0; k < N_TEXTS; k++)
    if (!text_in(head, k)) return false;
  return head->shards > 0 && head->shard > 0 && head->shard <= head->shards;
}

void vs_journal_head_manifest(const vs_journal_head *head, const vs_journal_head_counts *counts,
                              bool merged, const char *more, vs_text *text) {
  vs_text_add(text, "%s", head->manifest_begin);
  vs_json json = vs_json_inside(text);
  vs_json_whole(&json, "cases", (int64_t)counts->cases);
  vs_json_whole(&json, "done", (int64_t)counts->done);
  vs_json_whole(&json, "failed", (int64_t)counts->failed);
  vs_json_whole(&json, "violated", (int64_t)counts->violated);
  vs_text_add(text, "%s%s", head->manifest_end, more ? more : "");
  vs_json_array(&json, "shard", VS_JSON_ROW);
  vs_json_whole(&json, NULL, merged ? 1 : (int64_t)head->shard);
  vs_json_whole(&json, NULL, merged ? 1 : (int64_t)head->shards);
  vs_json_end(&json);
  vs_json_end(&json);
}

bool vs_journal_head_has_manifest(const vs_journal_head *head) {
  const vs_journal_head_counts none = {0};
  vs_text text = {0};
  vs_journal_head_manifest(head, &none, false, NULL, &text);
  const bool whole = vs_json_is_whole(text.text);
  vs_text_free(&text);
  return whole;
}

/* True if both texts are the same but for how files and the study are named, which may differ from
 * machine to machine. Their contents are in the identity. */
static bool says_the_same(const char *a, const char *b) {
  static const char *const BEFORE[] = {"\"path\": \"", "\"study\": \"", "\"study\", \""};
  for (; *a && *a == *b; a++, b++)
    for (size_t k = 0; k < sizeof BEFORE / sizeof *BEFORE; k++) {
      const size_t n = strlen(BEFORE[k]);
      if (strncmp(a, BEFORE[k], n) || strncmp(b, BEFORE[k], n)) continue;
      const char *end = vs_json_string_end(a + n - 1), *end_too = vs_json_string_end(b + n - 1);
      if (!end || !end_too) return false;
      a = end - 1;
      b = end_too - 1;
      break;
    }
  return *a == *b;
}

const char *vs_journal_head_differs(const vs_journal_head *a, const vs_journal_head *b) {
  for (size_t k = 0; k < N_TEXTS; k++) {
    const bool manifest = k >= MANIFEST;
    if (manifest ? !says_the_same(text_in(a, k), text_in(b, k))
                 : strcmp(text_in(a, k), text_in(b, k)) != 0)
      return TEXTS[k].name;
  }
  return a->cases != b->cases || a->shard != b->shard || a->shards != b->shards ? "counts" : NULL;
}

/* Writes which program has written the head; false: it does not say so. */
static bool name_program(const vs_journal_head *head, char *text, size_t size) {
  char version[32], ngspice[32], gsl[32];
  const char *at = strstr(head->manifest_begin, "\"program\": {");
  if (!at || sscanf(at,
                    "\"program\": {\"version\": \"%31[^\"]\", \"ngspice\": \"%31[^\"]\", "
                    "\"gsl\": \"%31[^\"]\"",
                    version, ngspice, gsl) != 3)
    return false;
  snprintf(text, size, "vibrospice %s (ngspice %s, GSL %s)", version, ngspice, gsl);
  return true;
}

bool vs_journal_head_programs(const vs_journal_head *a, const vs_journal_head *b, char *of_a,
                              char *of_b, size_t size) {
  if (!name_program(a, of_a, size) || !name_program(b, of_b, size)) return false;
  if (strcmp(of_a, of_b) != 0) return true;
  /* What the identity is made of stands in the other lines, but for the program's sources. */
  const char *differs = vs_journal_head_differs(a, b);
  if (!differs || strcmp(differs, "identity") ||
      !says_the_same(a->manifest_begin, b->manifest_begin) ||
      !says_the_same(a->manifest_end, b->manifest_end))
    return false;
  snprintf(of_a, size, "another build of ");
  return name_program(b, of_a + strlen(of_a), size - strlen(of_a));
}
