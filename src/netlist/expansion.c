/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/expansion.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "netlist/rules.h"
#include "netlist/words.h"
#include "lint/slips.h"

/* A subcircuit, or the deck's own top level, which has no name. */
typedef struct body {
  const char *name; /* borrowed from its line */
  size_t length;
  size_t from, to; /* its lines, those of subcircuits that are defined within it too */
  double devices;
  enum { UNCOUNTED, COUNTING, COUNTED } state;
} body;

typedef struct tally {
  const vs_deck *deck;
  body *bodies; /* sorted by name; owned */
  size_t count;
  size_t *end;              /* by a line that begins a subcircuit: the line behind it; owned */
  const vs_line *most_line; /* the instance at the top that comes to most; NULL: none so far */
  double most;
} tally;

static int compare_names(const char *a, size_t n, const char *b, size_t m) {
  int order = strncasecmp(a, b, n < m ? n : m);
  return order ? order : (n > m) - (n < m);
}

static int by_name(const void *a, const void *b) {
  const body *x = a, *y = b;
  return compare_names(x->name, x->length, y->name, y->length);
}

/* Finds all subcircuits, and the end of each: the line behind the .ends that belongs to it. */
static void find_bodies(tally *t) {
  const vs_deck *deck = t->deck;
  for (size_t k = 0; k < deck->n_lines; k++)
    t->count += vs_words_begin(deck->lines[k].text, ".subckt");
  t->bodies = vs_alloc(t->count + 1, sizeof *t->bodies);
  t->end = vs_alloc(deck->n_lines + 1, sizeof *t->end);
  size_t *open = vs_alloc(t->count + 1, sizeof *open), depth = 0, begun = 0;
  for (size_t k = 0; k < deck->n_lines; k++) {
    const char *text = deck->lines[k].text;
    if (vs_words_begin(text, ".ends") && depth > 0) t->bodies[open[--depth]].to = k + 1;
    if (!vs_words_begin(text, ".subckt")) continue;
    const char *name = text + strlen(".subckt");
    name += strspn(name, " \t");
    open[depth++] = begun;
    t->bodies[begun++] =
        (body){.name = name, .length = strcspn(name, " \t"), .from = k + 1, .to = deck->n_lines};
  }
  free(open);
  for (size_t k = 0; k < t->count; k++) t->end[t->bodies[k].from - 1] = t->bodies[k].to;
  qsort(t->bodies, t->count, sizeof *t->bodies, by_name);
}

/* The subcircuit of that name, or of the part that the scene has chosen for it; NULL: none. */
static body *find_body(const tally *t, const char *name, size_t length) {
  const vs_deck *deck = t->deck;
  for (size_t p = 0; p < deck->n_parts; p++) {
    const vs_part *part = &deck->parts[p];
    if (compare_names(part->name, strlen(part->name), name, length) || !*part->subcircuit) continue;
    name = part->subcircuit;
    length = strlen(name);
  }
  const body wanted = {.name = name, .length = length};
  return t->count ? bsearch(&wanted, t->bodies, t->count, sizeof *t->bodies, by_name) : NULL;
}

/* Counts a stretch of lines. The depth of its calls is that of subcircuits within subcircuits; a
 * chain of more than DEEPEST is counted as if it ended there, as ngspice itself does not take it.
 */
static double count(tally *t, size_t from, size_t to, int depth);

static double count_body(tally *t, body *b, int depth) {
  enum { DEEPEST = 200 };
  if (!b || b->state == COUNTING || depth > DEEPEST) return 1;
  if (b->state == COUNTED) return b->devices;
  b->state = COUNTING;
  b->devices = count(t, b->from, b->to, depth);
  b->state = COUNTED;
  return b->devices;
}

static double count(tally *t, size_t from, size_t to, int depth) {
  double sum = 0;
  for (size_t k = from; k < to; k++) {
    const vs_line *line = &t->deck->lines[k];
    size_t n = 0;
    if (vs_words_begin(line->text, ".subckt")) {
      k = t->end[k] - 1;
      continue;
    }
    const char *name = vs_rules_instance_of(line->text, &n);
    double of_line =
        name ? count_body(t, find_body(t, name, n), depth + 1)
             : isalpha((unsigned char)*line->text) || vs_words_begin(line->text, ".model");
    of_line += 2 * vs_slips_segments(line->text);
    sum += of_line;
    if (depth > 0 || of_line <= t->most) continue;
    t->most = of_line;
    t->most_line = line;
  }
  return sum;
}

static double count_all(tally *t) {
  find_bodies(t);
  double sum = count(t, 0, t->deck->n_lines, 0);
  free(t->bodies);
  free(t->end);
  return sum;
}

vs_status vs_expansion_check(const vs_deck *deck, double most, vs_error *err) {
  tally t = {.deck = deck};
  double devices = count_all(&t);
  if (devices <= most) return VS_OK;
  return vs_fail_at(
      err, t.most_line->where,
      "the circuit comes to %.4g devices with its subcircuits taken apart, %.4g of "
      "them by this line; limits.devices = %.9g allows no more: take fewer, or raise it",
      devices, t.most, most);
}
