/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dialect/models.h"

#include <string.h>
#include <strings.h>

#include "dialect/words.h"

static const char PSPICE[] = "is PSpice's; a line '*$ compat ps' has the deck read in its dialect";

/* Parameters that say what a part may bear and where it is from. ngspice takes a word behind '='
 * for a parameter's name, and ends there. */
static const char *const RATINGS[] = {"mfg",  "pn",   "type", "vpk",      "ipk", "iave",
                                      "irms", "diss", "vceo", "icrating", "qg",  "vds"};

/* Parameters of an ideal diode, which ngspice reads as a common one without them. */
static const char *const IDEAL[] = {"vfwd",    "vrev",   "ron",       "roff",      "rrev",
                                    "epsilon", "ilimit", "revilimit", "revepsilon"};

/* Parameters that ngspice takes in PSpice's dialect only. */
static const char *const OF_PSPICE[] = {"t_abs", "t_measured", "t_rel_global", "t_rel_local"};

/* Finds a parameter of the model, also within the brackets. */
static bool find(const vs_rewriting *r, const char *from, const char *name, vs_word *whole) {
  vs_word value;
  (void)r;
  for (const char *s = from; s; s = strpbrk(s + 1, "("))
    if (vs_words_parameter(*s == '(' ? s + 1 : s, name, whole, &value)) return true;
  return false;
}

/* The word behind which a model's type stands: the type is this one up to '('. */
static bool is_type(vs_word w, const char *type) {
  size_t n = strlen(type);
  return w.n >= n && !strncasecmp(w.at, type, n) && !vs_words_goes_on(w.at[n]);
}

static vs_status refuse(const vs_rewriting *r, vs_word w, const char *what, const char *why) {
  return vs_fail_at(r->err, vs_rewriting_place(r, w.at, w.n), "%s %s", what, why);
}

vs_status vs_models_rewrite(vs_rewriting *r) {
  vs_word w[VS_WORDS_MOST], found;
  size_t count = vs_words_split(r->text.text, w);
  if (count < 3 || !vs_words_is(w[0], ".model")) return VS_OK;
  if (!r->pspice) {
    if (is_type(w[2], "ako")) return refuse(r, w[2], "AKO:", PSPICE);
    if (is_type(w[2], "vswitch") || is_type(w[2], "iswitch"))
      return refuse(r, w[2], "a switch of that name", PSPICE);
    for (size_t k = 0; k < sizeof OF_PSPICE / sizeof *OF_PSPICE; k++)
      if (find(r, w[2].at, OF_PSPICE[k], &found)) return refuse(r, found, OF_PSPICE[k], PSPICE);
  }
  for (size_t k = 0; is_type(w[2], "d") && k < sizeof IDEAL / sizeof *IDEAL; k++)
    if (find(r, w[2].at, IDEAL[k], &found))
      return refuse(r, found, IDEAL[k],
                    "belongs to an ideal diode of LTspice's, which ngspice would read as a common "
                    "one; a like one is d(is=1e-9 n=0.1 rs=RON), with bv= for Vrev");
  for (size_t k = 0; k < sizeof RATINGS / sizeof *RATINGS; k++)
    if (find(r, r->text.text + (w[2].at - w[0].at), RATINGS[k], &found)) {
      size_t n = found.n;
      while (n > 0 && found.at[n - 1] == ')') n--;
      vs_rewriting_replace(r, (size_t)(found.at - r->text.text), n, "");
      vs_rewriting_tell(r, "ratings in a .model (mfg, type, Vpk, Iave, Vceo, ...), LTspice's, are "
                           "no part of the model and left out");
      count = vs_words_split(r->text.text, w);
    }
  return VS_OK;
}
