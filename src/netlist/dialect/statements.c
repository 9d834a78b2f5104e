/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/statements.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/cursor.h"
#include "netlist/words.h"

/* ---- what is skipped ---- */

void vs_statements_skip(vs_skipped *s, const char *what, vs_where where) {
  enum { SHOWN = 10 }; /* as many as fit into a message */
  s->count++;
  if (s->count == 1) {
    s->first = where;
    vs_text_add(&s->list, "%s", what);
  } else if (s->count > SHOWN)
    return;
  else if (!strcmp(s->first.file, where.file))
    vs_text_add(&s->list, ", %s (line %d)", what, where.line);
  else
    vs_text_add(&s->list, ", %s (%s:%d)", what, where.file, where.line);
  if (s->count == SHOWN) vs_text_add(&s->list, ", ...");
}

bool vs_statements_warn(const vs_skipped *s, vs_text *text) {
  if (s->count == 0) return false;
  vs_text_add(text,
              "skipped: %s: a deck is a circuit; how long and how finely it is computed and what "
              "is written say the scene and the command",
              s->list.text);
  return true;
}

void vs_statements_free(vs_skipped *s) {
  vs_text_free(&s->list);
  *s = (vs_skipped){0};
}

/* ---- what is refused ---- */

/* Options that make another circuit of the netlist, and the value at which they do not. */
static const struct option {
  const char *name;
  double neutral;
  const char *instead;
} OPTIONS[] = {
    {"temp", 27, "devices are at 27 degC here; 'temp=' of an element sets its own"},
    {"tnom", 27, "models are given for 27 degC here; 'tnom=' of a .model sets its own"},
    {"scale", 1, "write the sizes of transistors as they are"},
    {"rshunt", -1, "place the resistors from nodes to 0 that the circuit has"},
    {"cshunt", -1, "place the capacitors from nodes to 0 that the circuit has"},
};

/* Refuses an option that the circuit would be another without. */
static vs_status judge_options(const char *line, vs_where where, vs_error *err) {
  for (size_t k = 0; k < sizeof OPTIONS / sizeof *OPTIONS; k++) {
    const struct option *o = &OPTIONS[k];
    size_t n = strlen(o->name);
    for (const char *s = line; (s = strcasestr(s, o->name)); s += n) {
      const char *value = s + n + strspn(s + n, " \t");
      if (isalnum((unsigned char)s[-1]) || s[-1] == '_' || *value != '=') continue;
      char *end;
      value += 1 + strspn(value + 1, " \t");
      if (strtod(value, &end) == o->neutral && end != value) continue;
      return vs_fail_at(err, where, "option %s would make another circuit, and is not taken: %s",
                        o->name, o->instead);
    }
  }
  return VS_OK;
}

static vs_status judge_temperature(const char *line, vs_where where, vs_error *err) {
  const char *value = line + strcspn(line, " \t");
  char *end;
  double celsius = strtod(value, &end);
  return celsius == 27 && end != value && !end[strspn(end, " \t")]
             ? VS_OK
             : vs_fail_at(err, where, ".temp would make another circuit, and is not taken: %s",
                          OPTIONS[0].instead);
}

/* Statements that a deck is not refused for. */
static const char *const SKIPPED[] = {
    ".tran",  ".ac",      ".dc",       ".op",      ".noise",  ".tf",   ".sens",
    ".disto", ".pz",      ".save",     ".end",     ".print",  ".plot", ".probe",
    ".four",  ".meas",    ".width",    ".options", ".opt",    ".temp", ".measure",
    ".net",   ".fourier", ".backanno", ".option",  ".probe64"};

/* Statements that mean more than one circuit, which a study has. */
static const char *const STUDIES[] = {".step", ".mc", ".wcase", ".alter", ".data"};

vs_status vs_statements_judge(const char *line, vs_where where, vs_skipped *skipped, bool *skip,
                              vs_error *err) {
  char word[24], shown[28];
  snprintf(word, sizeof word, "%.*s", (int)strcspn(line, " \t=("), line);
  vs_cursor_lower(word);
  const vs_word said = vs_words_of(word);
  *skip = false;
  if (VS_WORDS_AMONG(said, STUDIES))
    return vs_fail_at(err, where,
                      "%s does not belong in a deck: of many circuits a study asks; with a line "
                      "'*$ param NAME = ...' its axis is circuit.NAME",
                      word);
  if (!strcmp(word, ".control") || !strcmp(word, ".endc"))
    return vs_fail_at(err, where,
                      "%s does not belong in a deck, which runs no commands: delete "
                      "the lines from .control to .endc",
                      word);
  if (!VS_WORDS_AMONG(said, SKIPPED)) return VS_OK;
  vs_status status = !strncmp(word, ".opt", 4) ? judge_options(line, where, err)
                     : !strcmp(word, ".temp")  ? judge_temperature(line, where, err)
                                               : VS_OK;
  if (status) return status;
  snprintf(shown, sizeof shown, "'%s'", word);
  vs_statements_skip(skipped, shown, where);
  *skip = true;
  return VS_OK;
}

/* ---- a title ---- */

/* True for a word that can be a value: a number, or an expression. */
static bool is_value(const char *word) {
  word += strspn(word, "+-");
  word += *word == '.';
  return isdigit((unsigned char)*word) || (*word && strchr("{'\"", *word));
}

/* True where the line has what an element of its letter needs. The words are counted from 0, and
 * `word` is the one in the place of the value; "" where there is none. */
static bool reads_as_element(const char *line, int words, const char *word) {
  static const char *const COURSES[] = {"dc",  "ac",  "external", "sin", "pulse",
                                        "pwl", "exp", "sffm",     "am"};
  bool numbered = line[strcspn(line, " \t0123456789")] > ' ';
  const vs_word course = {word, strcspn(word, " \t(")};
  switch (tolower((unsigned char)*line)) {
  case 'r':
  case 'c':
  case 'l':
  case 'k':
    return words > 3 && (is_value(word) || strchr(line, '='));
  case 'v':
  case 'i':
    return words > 3 && (is_value(word) || VS_WORDS_AMONG(course, COURSES));
  case 'b':
    return strchr(line, '=') != NULL;
  case 'x':
    return words > 2 && (numbered || !strncasecmp(word, "eva", 3));
  default:
    return words > 3 && numbered;
  }
}

bool vs_statements_is_title(const char *line) {
  const char *fourth = "";
  int words = 0;
  if (!isalnum((unsigned char)*line)) return false;
  for (const char *s = line; *s; words++) {
    if (words == 3) fourth = s;
    s += strcspn(s, " \t");
    s += strspn(s, " \t");
  }
  return !reads_as_element(line, words, fourth);
}
