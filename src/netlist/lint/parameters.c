/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lint/parameters.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

/* Returns the length of the name at s; 0: none begins there. */
static size_t name_at(const char *s) {
  size_t n = 0;
  if (isdigit((unsigned char)*s)) return 0;
  while (vs_words_goes_on(s[n])) n++;
  return n;
}

/* Finds a name at the line's end behind a value that is a number or stands in braces; *at is empty
 * where there is none. Of other values it is not known where they end. */
static vs_word word_behind(const char *value) {
  vs_word w[VS_WORDS_MOST], none = {value, 0};
  if (vs_words_split(value, w) != 2) return none;
  const char *digit = w[0].at + strspn(w[0].at, "+-.");
  if (!isdigit((unsigned char)*digit) && *w[0].at != '{') return none;
  if (w[0].at[w[0].n - 1] != '}' && !isalnum((unsigned char)w[0].at[w[0].n - 1])) return none;
  return name_at(w[1].at) == w[1].n ? w[1] : none;
}

static vs_status check_instance(const vs_cards *c, size_t number, vs_error *err) {
  const vs_netlist_card *card = &c->card[number];
  const vs_line *line = &c->lines[number];
  vs_word extra = {"", 0};
  for (size_t k = card->first; card->letter == 'x' && k < card->first + card->count; k++) {
    const vs_argument *a = &c->arguments[k];
    const int n = (int)a->name.n;
    if (n && isdigit((unsigned char)*a->name.at))
      return vs_fail_at(
          err, vs_line_place_of(line, a->name),
          "'%.*s' stands before a '=', and a name is wanted there: a letter of one is "
          "missing behind it; NAME=VALUE, in a copy of the file if it is a maker's",
          n, a->name.at);
    if (n && !a->value.n)
      return vs_fail_at(err, vs_line_place_of(line, a->name),
                        "%.*s has no value; write one behind its '=', or leave %.*s out", n,
                        a->name.at, n, a->name.at);
    extra = n ? word_behind(a->value.at) : extra;
  }
  return extra.n ? vs_fail_at(err, vs_line_place_of(line, extra),
                              "ngspice leaves out '%.*s' behind the parameters; write NAME=VALUE, "
                              "or leave it out",
                              (int)extra.n, extra.at)
                 : VS_OK;
}

vs_status vs_parameters_check(const vs_cards *c, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < c->count && !status; k++)
    status = vs_error_keep(err, check_instance(c, k, err));
  return status;
}

/* ---- gains ---- */

/* The gain of "E1 a 0 b 0 gain" or "F1 a 0 Vx gain", alone or before "m=", where it is a name; its
 * length is 0 where it is none. */
static vs_word gain_of(const vs_cards *c, const vs_netlist_card *card) {
  static const char *const FORMS[] = {"poly", "value", "vol", "cur", "table", "laplace", "freq"};
  const vs_word none = {"", 0};
  if (card->kind != VS_CARDS_ELEMENT || !strchr("efgh", card->letter)) return none;
  if (strpbrk(card->name.at, "{'\"[")) return none;
  const size_t at = strchr("eg", card->letter) ? 4 : 3;
  for (size_t k = 0; k < at; k++)
    for (size_t f = 0; f < sizeof FORMS / sizeof *FORMS; f++)
      if (vs_words_is(vs_cards_word(c, card, k), FORMS[f])) return none;
  const vs_word gain = vs_cards_word(c, card, at);
  const bool last =
      card->words == at + 1 && (card->count == card->words ||
                                vs_words_is(c->arguments[card->first + card->words].name, "m"));
  return last && name_at(gain.at) == gain.n ? gain : none;
}

/* Error, with its place: the gain is a bare name that ngspice takes for 0. */
static vs_status check_gain(const vs_cards *c, size_t number, const vs_names *known,
                            vs_error *err) {
  const vs_line *line = &c->lines[number];
  const vs_word gain = gain_of(c, &c->card[number]);
  const int n = (int)gain.n;
  if (!n) return VS_OK;
  if (!vs_names_find(known, gain.at, gain.n, NULL))
    return vs_fail_at(err, vs_line_place_of(line, gain),
                      "ngspice takes the gain %.*s for 0, as no .param defines it; write a number, "
                      "or a line '.param %.*s=...'",
                      n, gain.at, n, gain.at);
  const char *comma = strchr(line->text, ',');
  if (gain.at[-1] != '(' && (!comma || comma > gain.at)) return VS_OK;
  return vs_fail_at(err, vs_line_place_of(line, gain),
                    "ngspice takes the gain %.*s for 0 beside brackets and commas; write {%.*s}", n,
                    gain.at, n, gain.at);
}

vs_status vs_parameters_check_gains(const vs_cards *c, vs_names *known, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < c->n_definitions; k++) {
    if (c->definition[k].kind != VS_CARDS_PARAM) continue;
    char *name = vs_alloc_part(c->definition[k].name.at, c->definition[k].name.n);
    vs_names_put(known, name, k);
    free(name);
  }
  for (size_t k = 0; k < c->count && !status; k++)
    status = vs_error_keep(err, check_gain(c, k, known, err));
  return status;
}
