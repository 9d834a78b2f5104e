/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/blame.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "message.h"
#include "scope.h"
#include "subject.h"
#include "netlist/netlist.h"
#include "netlist/reserved.h"

/* Finds the first line in which `find` finds what a message speaks of. */
static vs_where place_in_lines(const vs_deck *deck, const char *message,
                               const char *(*find)(const char *line, const char *message)) {
  const vs_scope in = vs_scope_find(deck, message);
  bool quoted = false; /* the message has a line as a whole, which is not another one then */
  for (size_t k = in.begin; k < in.end && !quoted; k++)
    quoted = vs_subject_is_quoted(deck->lines[k].text, message);
  for (size_t k = in.begin; k < in.end; k++) {
    const vs_line *line = &deck->lines[k];
    if (quoted && !vs_subject_is_quoted(line->text, message)) continue;
    const char *at = find(line->written ? line->written : line->text, message);
    if (!at && !(line->written && find(line->text, message))) continue;
    if (!vs_scope_has_what_lacks(deck, k, message))
      return at ? vs_line_place(line, at) : line->where;
  }
  return (vs_where){0};
}

/* The place within a line of what a message speaks of; else the line's. */
static vs_where place_in_line(const vs_line *line, const char *message) {
  const char *at = vs_subject_find(line->written ? line->written : line->text, message);
  return at ? vs_line_place(line, at) : line->where;
}

/* A wrong number of nodes is told of the instance. Where that comes with the program, or is none of
 * the deck's lines, the user's subcircuit is what has to be mended: its place. */
static vs_where place_of_pins(const vs_deck *deck, const char *message, vs_where where) {
  size_t n = 0;
  const char *name = vs_message_between(message, "parameters for subcircuit type \"", '"', &n);
  vs_scope in = {deck, 0, 0};
  if (!name || (where.file && !vs_deck_is_shipped(where.file)) || !vs_scope_enter(&in, name, n))
    return where;
  const vs_where its = deck->lines[in.begin - 1].where;
  return vs_deck_is_shipped(its.file) ? where : its;
}

/* Where a formula or a probe asks for the signal that is not there. */
static vs_where place_of_signal(const vs_deck *deck, const char *message) {
  static const char SAYS[] = "the circuit has no ";
  const char *signal = strstr(message, SAYS);
  if (signal) signal += strlen(SAYS);
  for (size_t k = deck->n_terms; signal && k-- > 0;)
    if (!strcmp(signal, deck->terms[k].plus) || !strcmp(signal, deck->terms[k].minus))
      return deck->terms[k].where;
  return (vs_where){0};
}

void vs_blame_locate(const vs_deck *deck, size_t culprit, vs_error *err) {
  const vs_line *line = vs_netlist_line(deck, culprit);
  vs_reserved_restore(err->text);
  vs_where where = place_of_signal(deck, err->text);
  if (!where.file && line) where = place_in_line(line, err->text);
  if (!where.file) where = place_in_lines(deck, err->text, vs_subject_find);
  if (!where.file) where = place_in_lines(deck, err->text, vs_subject_node);
  if (!where.file) where = place_in_lines(deck, err->text, vs_subject_function);
  where = place_of_pins(deck, err->text, where);
  vs_error plain = *err;
  char within[VS_PATH_SIZE] = "";
  if (!where.file)
    where.file = deck->files[0];
  else
    where = vs_deck_mendable(deck, where, within, sizeof within);
  vs_fail_at(err, where, "%s%s%s", plain.text, within, vs_message_remedy(plain.text));
}
