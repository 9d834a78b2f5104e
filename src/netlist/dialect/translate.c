/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dialect/translate.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"
#include "dialect/elements.h"
#include "dialect/functions.h"
#include "dialect/rewriting.h"
#include "netlist/cards.h"
#include "netlist/expr.h"
#include "netlist/numbers.h"

/* ---- models: lines .model as PSpice and LTspice write them ---- */

static const char PSPICE[] = "is PSpice's; a line '*$ compat ps' has the deck read in its dialect";

/* Parameters that say what a part may bear and where it is from. ngspice takes a word behind '='
 * for a parameter's name, and ends there. */
static const char RATINGS[] = " mfg pn modtype type vpk ipk iave irms diss vceo icrating qg vds ";

/* Parameters of an ideal diode, which ngspice reads as a common one without them. */
static const char IDEAL[] = " vfwd vrev ron roff rrev epsilon ilimit revilimit revepsilon ";

/* Parameters that ngspice takes in PSpice's dialect only. */
static const char OF_PSPICE[] = " t_abs t_measured t_rel_global t_rel_local ";

/* The parameters that ngspice 39 knows of these types of model, from the tables of its devices. Of
 * others it says "unrecognized parameter - ignored", where nobody reads it. */
static const struct known {
  const char *types, *names;
} KNOWN[] = {
    {" d ", " level is js jsw isw tnom tref rs rsw trs trs1 trs2 n ns tt ttt1 ttt2 cjo cj0 cj vj "
            "pb m mj tm1 tm2 cjp cjsw php vjsw mjsw ikf ik ikr ikp nbv nz area pj tlev tlevc eg "
            "gap1 gap2 xti cta ctc ctp tpb tvj tphp jtun jtunsw ntun xtitun keg kf af fc fcs bv "
            "vb vrb var ibv ib tcv tbv1 isr nr vp fv_max bv_max id_max te_max pd_max rth0 cth0 lm "
            "lp wm wp xom xoi xm xp xw "},
    {" npn pnp ",
     " level subs tnom tref is ibe ibc bf nf vaf va ikf ik ise c2 ne br nr var vb ikr isc "
     "c4 nc rb irb rbm re rc cje vje pe mje me tf xtf vtf itf ptf cjc vjc pc mjc mc xcjc "
     "tr cjs csub ccs vjs ps mjs ms xtb eg xti fc kf af iss ns rco vo gamma qco tlev tlevc "
     "tbf1 tbf2 tbr1 tbr2 tikf1 tikf2 tikr1 tikr2 tirb1 tirb2 tnc1 tnc2 tne1 tne2 tnf1 "
     "tnf2 tnr1 tnr2 trb1 trb trb2 trc1 trc trc2 tre1 tre tre2 trm1 trm2 tvaf1 tvaf2 tvar1 "
     "tvar2 ctc cte cts tvjc tvje tvjs titf1 titf2 ttf1 ttf2 ttr1 ttr2 tmje1 tmje2 tmjc1 "
     "tmjc2 tmjs1 tmjs2 tns1 tns2 nkf nk tis1 tis2 tise1 tise2 tisc1 tisc2 tiss1 tiss2 "
     "quasimod vg cn d vbe_max vbc_max vce_max pd_max ic_max ib_max te_max rth0 "},
    {" sw ", " vt vh ron roff "},
    {" csw ", " it ih ron roff "},
    {" r res ",
     " rsh narrow dw dlr short tc1 tc1r tc2 tc2r tce defw w l kf af tnom r res bv_max lf "
     "wf ef "},
    {" c cap ",
     " cap c cj cox cjsw capsw defw w defl l narrow short del tc1 tc2 tnom di thick bv_max "},
    {" l ind ", " ind l tc1 tc2 tnom csect dia length nt mu "},
    {" njf pjf ",
     " level vt0 vto beta lambda rd rs cgs cgd pb is n fc b tnom tcv vtotc bex betatce xti "
     "eg kf af nlev gdsnoi "},
    {" vdmos vdmosn vdmosp ",
     " vto vth0 kp phi lambda theta rd rs rg tnom kf af rq vq mtriode tcvth vtotc mu bex "
     "texp0 texp1 trd1 trd2 trg1 trg2 trs1 trs2 trb1 trb2 subshift ksubthres tksubthres1 "
     "tksubthres2 bv ibv nbv rds rb n tt eg xti is vj vp cjo m fc cgdmin cgdmax a cgs "
     "rthjc rthca cthj vgs_max vgd_max vds_max vgsr_max vgdr_max pd_max id_max idr_max "
     "te_max rth_ext derating ron "},
};

static bool is_in_list(const char *list, vs_word w) {
  return w.n && vs_words_find(list, list, w.at, w.n);
}

static const struct known *known_of(vs_word type) {
  type.n = strcspn(type.at, " \t(");
  for (size_t k = 0; k < sizeof KNOWN / sizeof *KNOWN; k++)
    if (is_in_list(KNOWN[k].types, type)) return &KNOWN[k];
  return NULL;
}

/* The word behind which a model's parameters stand: the type is this one up to '('. */
static bool is_type(vs_word w, const char *type) {
  size_t n = strlen(type);
  return w.n >= n && !strncasecmp(w.at, type, n) && !vs_words_goes_on(w.at[n]);
}

static vs_status refuse_in_model(const vs_rewriting *r, vs_word w, const char *what,
                                 const char *why) {
  return vs_fail_at(r->err, vs_rewriting_place(r, w.at, w.n), "%s %s", what, why);
}

/* Leaves out "NAME = VALUE"; what stands behind it moves up. */
static void leave_out(vs_rewriting *r, vs_word name) {
  size_t begin = (size_t)(name.at - r->text.text);
  const char *value = strchr(name.at, '=') + 1;
  value += strspn(value, " \t");
  const char *end = strchr("\"'", *value) && *value ? strchr(value + 1, *value) : NULL;
  end = end ? end + 1 : value + strcspn(value, " \t,)");
  vs_tally_add(r->tally,
               "ratings in a .model (mfg, type, Vpk, Iave, Vceo, ...), LTspice's, are no part of "
               "the model and left out",
               vs_rewriting_place(r, name.at, name.n));
  vs_rewriting_replace(r, begin, (size_t)(end - name.at), "");
}

/* Types of models by which PSpice multiplies an element's value: R1 a b rm 1k, .model rm RES(R=2).
 * ngspice takes R= for the value of an element that has none, and so leaves it out. */
static const struct multiplier {
  const char *type, *name;
} MULTIPLIERS[] = {{"res", "r"}, {"cap", "c"}, {"ind", "l"}};

static vs_status judge_multiplier(vs_rewriting *r, vs_word type, vs_word name, const char *value) {
  bool is = false, of_ngspice = !r->pspice && is_type(type, "res");
  char *end;
  for (size_t k = 0; k < sizeof MULTIPLIERS / sizeof *MULTIPLIERS; k++)
    is = is || (is_type(type, MULTIPLIERS[k].type) && vs_words_is(name, MULTIPLIERS[k].name));
  if (!is || (strtod(value, &end) == 1 && end > value && !vs_words_goes_on(*end))) return VS_OK;
  if (!of_ngspice)
    return refuse_in_model(
        r, name, "this parameter",
        "multiplies what an element says, in PSpice; ngspice leaves it out: write the "
        "values that it makes at the elements, and here 1, or nothing");
  vs_tally_add(r->tally,
               "R= of a model RES multiplies a resistor's value in PSpice and LTspice; ngspice "
               "takes it for the value of resistors that have none",
               vs_rewriting_place(r, name.at, name.n));
  return VS_OK;
}

/* CAP and IND, PSpice's and LTspice's, are C and L in ngspice, which finds no model of these names.
 */
static void rewrite_type(vs_rewriting *r, size_t type) {
  static const char *const TYPES[][2] = {{"cap", "c"}, {"ind", "l"}};
  for (size_t k = 0; k < sizeof TYPES / sizeof *TYPES; k++)
    if (is_type((vs_word){r->text.text + type, strlen(r->text.text + type)}, TYPES[k][0])) {
      vs_rewriting_replace(r, type, strlen(TYPES[k][0]), TYPES[k][1]);
      return;
    }
}

/* KiCad writes "VDMOS NCHAN ( vto=3 ... )", from which ngspice 39 never comes back. Without these
 * brackets it reads the same. */
static void rewrite_channel(vs_rewriting *r, vs_word type, vs_word channel) {
  channel.n = strcspn(channel.at, "( \t");
  const char *open = channel.at + channel.n + strspn(channel.at + channel.n, " \t");
  if (!is_type(type, "vdmos") || *open != '(') return;
  if (!is_type(channel, "nchan") && !is_type(channel, "pchan")) return;
  char *close = strrchr(r->text.text, ')');
  r->text.text[open - r->text.text] = ' ';
  if (close) *close = ' ';
}

/* Judges one parameter of a model; *left_out says that it is not in the text any more. */
static vs_status judge_parameter(vs_rewriting *r, vs_word type, vs_word name, bool *left_out) {
  const struct known *known = known_of(type);
  if (!r->pspice && is_in_list(OF_PSPICE, name))
    return refuse_in_model(r, name, "this parameter", PSPICE);
  if (is_type(type, "d") && is_in_list(IDEAL, name))
    return refuse_in_model(
        r, name, "this parameter",
        "belongs to an ideal diode of LTspice's, which ngspice would read as a common "
        "one; a like one is d(is=1e-9 n=0.1 rs=RON), with bv= for Vrev");
  if (is_in_list(" t_rel_local ", name))
    return refuse_in_model(r, name, "this parameter",
                           "is left out by ngspice; write T_ABS, or T_REL_GLOBAL, which it knows");
  const char *value = strchr(name.at, '=') + 1;
  value += strspn(value, " \t");
  vs_status status = judge_multiplier(r, type, name, value);
  if (status) return status;
  bool passive = is_type(type, "res") || is_type(type, "cap") || is_type(type, "ind");
  if (is_type(type, "sw") && is_in_list(" vh ", name) && *value == '-')
    vs_tally_add(r->tally,
                 "Vh below 0: LTspice's switch goes over smoothly from Vt-|Vh| to Vt+|Vh|; "
                 "ngspice's jumps where it enters that range, a little sooner",
                 vs_rewriting_place(r, name.at, name.n));
  *left_out = is_in_list(RATINGS, name);
  if (*left_out)
    leave_out(r, name);
  else if (known && (!r->pspice || (passive && !is_in_list(OF_PSPICE, name))) &&
           !is_in_list(known->names, name))
    vs_tally_add(r->tally,
                 "ngspice has no such parameter in a model of this type, and leaves it out",
                 vs_rewriting_place(r, name.at, name.n));
  return VS_OK;
}

/* Adds what a switch of PSpice's leaves to its defaults: ngspice dies of one without Von or Voff.
 */
static void complete_switch(vs_rewriting *r, vs_word type) {
  static const struct {
    const char *type, *name, *value;
  } DEFAULTS[] = {{"vswitch", "ron", "1"},    {"vswitch", "roff", "1e6"},
                  {"vswitch", "von", "1"},    {"vswitch", "voff", "0"},
                  {"iswitch", "ron", "1"},    {"iswitch", "roff", "1e6"},
                  {"iswitch", "ion", "1e-3"}, {"iswitch", "ioff", "0"}};
  static const char TOLD[] =
      "a switch of PSpice's without Ron, Roff, Von or Voff (Ion, Ioff): 1 ohm, 1 Mohm, 1 V and 0 V "
      "(1 mA, 0 A) are taken, PSpice's own";
  vs_word whole, value;
  size_t at = (size_t)(type.at - r->text.text), n = strcspn(type.at, " \t(");
  char kind[8];
  snprintf(kind, sizeof kind, "%.*s", (int)n, type.at);
  char *bracket = strchr(r->text.text + at, '(');
  if (bracket) *bracket = ' ';
  bool vt = vs_words_parameter(r->text.text + at, "vt", &whole, &value) ||
            vs_words_parameter(r->text.text + at, "it", &whole, &value);
  vs_text added = {0};
  for (size_t k = 0; k < sizeof DEFAULTS / sizeof *DEFAULTS && !vt; k++)
    if (!strcasecmp(DEFAULTS[k].type, kind) &&
        !vs_words_parameter(r->text.text + at, DEFAULTS[k].name, &whole, &value))
      vs_text_add(&added, " %s=%s ", DEFAULTS[k].name, DEFAULTS[k].value);
  if (bracket) *bracket = '(';
  if (added.text) {
    size_t place = bracket ? (size_t)(bracket - r->text.text) + 1 : at + n;
    vs_rewriting_replace(r, place, 0, added.text);
    vs_rewriting_tell(r, TOLD);
  }
  vs_text_free(&added);
}

/* Leaves out ratings that a model tells besides (mfg, Vpk, ...), and tells it. Errors with their
 * place: what ngspice takes no notice of, or does not know, unless it reads PSpice's dialect; an
 * ideal diode of LTspice's. */
static vs_status models_rewrite(vs_rewriting *r) {
  vs_word w[VS_WORDS_MOST];
  if (strncasecmp(r->text.text, ".model", 6)) return VS_OK;
  size_t count = vs_words_split(r->text.text, w);
  if (count < 3) return VS_OK;
  if (!r->pspice && is_type(w[2], "ako")) return refuse_in_model(r, w[2], "AKO:", PSPICE);
  if (!r->pspice && (is_type(w[2], "vswitch") || is_type(w[2], "iswitch")))
    return refuse_in_model(r, w[2], "a switch of that name", PSPICE);
  if (count > 3) rewrite_channel(r, w[2], w[3]);
  size_t type = (size_t)(w[2].at - r->text.text), type_n = w[2].n;
  if (is_type(w[2], "vswitch") || is_type(w[2], "iswitch")) complete_switch(r, w[2]);
  for (size_t at = type; r->text.text[at]; at++) {
    const char *text = r->text.text, *end = text + at, *begin;
    if (*end != '=') continue;
    while (end > text + type && strchr(" \t", end[-1])) end--;
    for (begin = end; begin > text + type && vs_words_goes_on(begin[-1]);) begin--;
    vs_word name = {begin, (size_t)(end - begin)};
    bool left_out = false;
    size_t from = (size_t)(begin - text);
    vs_status status = VS_OK;
    if (name.n > 0 && name.n < 30)
      status = judge_parameter(r, (vs_word){text + type, type_n}, name, &left_out);
    if (status) return status;
    if (left_out) at = from > 0 ? from - 1 : 0;
  }
  rewrite_type(r, type);
  return VS_OK;
}

/* ---- all lines ---- */

/* Commas between assignments, "a=1, b=2", which ngspice never comes back from, become blanks. */
static void rewrite_commas(vs_rewriting *r) {
  int depth = 0;
  for (char *s = r->text.text; *s; s++) {
    depth += (strchr("({", *s) != NULL) - (strchr(")}", *s) != NULL);
    if (*s != ',' || depth) continue;
    const char *next = s + 1 + strspn(s + 1, " \t");
    if (!isalpha((unsigned char)*next)) continue;
    while (vs_words_goes_on(*next)) next++;
    next += strspn(next, " \t");
    if (*next == '=' && next[1] != '=') *s = ' ';
  }
}

/* Braces within braces, as {-3.5*{1-x}}, which ngspice does not know, become brackets. */
static void rewrite_nested(vs_rewriting *r) {
  int depth = 0;
  for (char *s = r->text.text; *s; s++) {
    if (*s == '{' && depth++) *s = '(';
    if (*s == '}' && depth && --depth) *s = ')';
  }
}

/* SIN(offset amplitude frequency delay damping phase cycles): ngspice takes no notice of cycles. */
static vs_status check_sine(const vs_rewriting *r) {
  const char *sine = strcasestr(r->text.text, "sin"), *open = sine ? strchr(sine, '(') : NULL;
  vs_word number;
  size_t count = 0;
  if (!strchr("vViI", *r->text.text) || !open || sine[-1] > ' ') return VS_OK;
  for (const char *s = open + 1; (s = vs_words_number(s, &number));) count++;
  return count < 7 ? VS_OK
                   : vs_fail_at(r->err, vs_rewriting_place(r, sine, 3),
                                "SIN has six numbers in ngspice; the seventh, LTspice's number of "
                                "cycles, it leaves out: write a B source with u(time)");
}

/* PWL(0 0 1m 0 +1u 5): LTspice counts a time with a plus sign from the one before it, ngspice from
 * t = 0. */
static vs_status check_points(const vs_rewriting *r) {
  const char *pwl = strcasestr(r->text.text, "pwl"), *open = pwl ? strchr(pwl, '(') : NULL;
  if (!strchr("vViI", *r->text.text) || !open || pwl[-1] > ' ') return VS_OK;
  vs_word number;
  int n = 0; /* which number it is: times are those of even n */
  for (const char *s = open + 1; (s = vs_words_number(s, &number)); n++)
    if (n > 0 && n % 2 == 0 && *number.at == '+')
      return vs_fail_at(r->err, vs_rewriting_place(r, number.at, number.n),
                        "%.*s: a time from the point before, LTspice's, which ngspice counts from "
                        "t = 0; write times from t = 0",
                        (int)number.n, number.at);
  return VS_OK;
}

/* True where the n-th number of a course is 0 or not there, so that ngspice takes its own. */
static bool is_left_out(const vs_word *w, size_t count, size_t n) {
  double value;
  return count <= n || (vs_numbers_read(w[n], &value) && value == 0);
}

/* PULSE(low high delay rise fall width period): for a rise or fall of 0, or none, ngspice takes the
 * step of its .tran, which is the run's largest one here. Without a width nothing falls. */
static void tell_of_edges(vs_rewriting *r) {
  enum { RISE = 3, FALL, WIDTH, MOST };
  vs_word w[MOST];
  size_t count = 0;
  const char *pulse = r->text.text;
  if (!*pulse || !strchr("vViI", *pulse)) return;
  for (int n = 0; n < 3; n++) pulse = vs_words_next(pulse);
  while (*pulse && !vs_words_is(vs_words_at(pulse), "pulse")) pulse = vs_words_next(pulse);
  if (!*pulse) return;
  for (const char *s = pulse + 5 + strspn(pulse + 5, " \t("); count < MOST; count++)
    if (!(s = vs_words_number(s, &w[count]))) break;
  if (is_left_out(w, count, RISE) || (!is_left_out(w, count, WIDTH) && is_left_out(w, count, FALL)))
    vs_tally_add(r->tally,
                 "an edge of PULSE that is 0 or left out lasts as long as the run's largest step, "
                 "which goes with run.tolerance; write its time, as 10n",
                 vs_rewriting_place(r, pulse, 5));
}

/* ---- values that ngspice does not read to their ends ---- */

static bool is_expression(vs_word v) {
  vs_expr e;
  vs_expr_read(&e, v);
  const bool is = e.whole;
  vs_expr_free(&e);
  return is;
}

/* True for what begins as a number and is none, as 2+1: ngspice reads the number alone. */
static bool goes_on_behind_number(vs_word v) {
  double value;
  if (v.n && strchr("+-", *v.at)) v = (vs_word){v.at + 1, v.n - 1};
  return v.n && isdigit((unsigned char)v.at[*v.at == '.']) && !vs_numbers_read(v, &value);
}

/* Where the value ends that begins at `from`: before `to`, and in the brackets that it stands in.
 */
static vs_word value_before(const char *from, const char *to) {
  int open = 0;
  for (const char *s = from; s < to; s++) {
    open += (*s == '(') - (*s == ')');
    if (open < 0) to = s;
  }
  while (to > from && strchr(" \t,", to[-1])) to--;
  return (vs_word){from, (size_t)(to - from)};
}

/* Where a value stands. */
typedef enum reading {
  TO_A_BLANK,   /* NAME=VALUE of .param and of an instance: a blank ends what ngspice reads */
  IN_A_HEAD,    /* of .subckt: a blank in brackets does, too */
  BESIDE_WORDS, /* of .model and elements: other words may stand behind it */
  BY_PLACE      /* VALUE behind an element's nodes: so may other values */
} reading;

/* Writes the value at `at` in braces where ngspice would read a part of it. Error, with its place:
 * it is no expression, or may be one value or two. */
static vs_status rewrite_value(vs_rewriting *r, size_t at, size_t n, reading how) {
  vs_word w[VS_WORDS_MOST];
  const vs_word v = {r->text.text + at, n};
  if (!n || strchr("<[\"", *v.at)) return VS_OK;
  vs_words_split(v.at, w);
  size_t rest = w[0].n + strspn(v.at + w[0].n, " \t");
  const bool cut = rest < n;
  bool partly = cut || (how >= BESIDE_WORDS && goes_on_behind_number(v));
  if (how == IN_A_HEAD && !strchr("{'", *v.at))
    partly = partly || memchr(v.at, ' ', n) || memchr(v.at, '\t', n);
  if (!partly) return VS_OK;
  if (!cut) rest = 0;
  const char *behind = v.at + rest;
  const vs_where where = vs_rewriting_place(r, behind, n - rest);
  const bool whole = is_expression(v), is_sign = strchr("+-", *behind);
  if (how == BY_PLACE && whole && cut && is_sign && !strchr(" \t", behind[1]))
    return vs_fail_at(r->err, where,
                      "'%.*s' may be a sum or two values, of which ngspice takes one; write {%.*s} "
                      "for a sum, or one value",
                      (int)n, v.at, (int)n, v.at);
  if (whole)
    vs_rewriting_brace(r, at, n);
  else if (how < BESIDE_WORDS || (how == BESIDE_WORDS && cut && strchr("+-*/^?", *behind)))
    return vs_fail_at(r->err, where,
                      "ngspice leaves out '%.*s' behind this value; one expression, as {a + b}, "
                      "another NAME=VALUE, or nothing is wanted",
                      (int)(n - rest), behind);
  return VS_OK;
}

/* True for a NAME=VALUE of which ngspice may read a part and say nothing: of E and G the formula,
 * of V and B the elements that it becomes. Of others "1 -2" may be a list. */
static bool is_read_partly(const vs_netlist_card *card, vs_word name) {
  static const char *const NAMES[] = {"value", "vol", "cur", "rser", "rpar", "cpar"};
  if (card->kind == VS_CARDS_MODEL) return true;
  if (strchr("rcl", card->letter)) return !vs_words_is(name, "tc");
  return strchr("egvb", card->letter) && VS_WORDS_AMONG(name, NAMES);
}

/* The value behind the nodes of R, C, L, or the gain of E, F, G, H, up to `to`. */
static vs_word value_by_place(const vs_cards *c, const char *text, const char *to) {
  static const char LETTERS[] = "rclfheg", PLACES[] = "2223344";
  vs_word w[VS_WORDS_MOST];
  const char *letter = strchr(LETTERS, c->card->letter);
  const size_t place = letter ? (size_t)(PLACES[letter - LETTERS] - '0') : 0;
  const vs_word first = vs_cards_word(c, c->card, place);
  if (!letter || !first.n || vs_words_split(text, w) < place + 2) return (vs_word){text, 0};
  const vs_word of = w[place + 1];
  const bool same = first.at >= of.at && first.at < of.at + of.n; /* no brackets around nodes */
  return same ? value_before(of.at, to) : (vs_word){text, 0};
}

/* In a subcircuit ngspice reads ".param a = b + 1" as b, and does the like in other lines. Goes
 * from the line's end to its beginning, so that what stands before a value keeps its place. */
static vs_status rewrite_each(vs_rewriting *r, const vs_cards *c) {
  const vs_netlist_card *card = c->card;
  const char *text = c->lines->text, *next = text + strlen(text);
  const bool element = card->kind == VS_CARDS_ELEMENT;
  const bool formulas = !element ? card->kind != VS_CARDS_MODEL : card->letter == 'x';
  const reading how = !formulas                       ? BESIDE_WORDS
                      : card->kind == VS_CARDS_SUBCKT ? IN_A_HEAD
                                                      : TO_A_BLANK;
  vs_status status = VS_OK;
  for (size_t k = card->first + card->count; k-- > card->first && !status;) {
    const vs_argument *a = &c->arguments[k];
    vs_word v = formulas ? a->value : value_before(a->value.at, next);
    if (a->name.n) {
      next = a->name.at;
      if (formulas && v.n && v.at[v.n - 1] == ':') { /* PARAMS: */
        while (v.n && !strchr(" \t", v.at[v.n - 1])) v.n--;
        v = value_before(v.at, v.at + v.n);
      }
      if (formulas || is_read_partly(card, a->name))
        status = rewrite_value(r, (size_t)(v.at - text), v.n, how);
    } else if (element && strchr("vi", card->letter) && k >= card->first + 2 &&
               goes_on_behind_number(a->value))
      status = rewrite_value(r, (size_t)(a->value.at - text), a->value.n, BESIDE_WORDS);
  }
  const vs_word v = value_by_place(c, text, next);
  return status ? status : rewrite_value(r, (size_t)(v.at - text), v.n, BY_PLACE);
}

static vs_status rewrite_values(vs_rewriting *r) {
  vs_line line = {.text = vs_copy(r->text.text)};
  const char letter = (char)tolower((unsigned char)*line.text);
  vs_status status = VS_OK;
  if (strchr(".x", letter) || (strchr("rclvibeghf", letter) && strpbrk(line.text, "+-*/^?<>&|"))) {
    vs_cards c;
    vs_cards_read(&c, &line, 1);
    if (c.card->kind <= VS_CARDS_PARAM && c.card->kind != VS_CARDS_ENDS)
      status = rewrite_each(r, &c);
    vs_cards_free(&c);
  }
  vs_line_free(&line);
  return status;
}

vs_status vs_translate(vs_rewriting *r) {
  vs_status status = vs_numbers_check(r->line, r->tally, r->err);
  if (status) return status;
  vs_text_add(&r->text, "%s", r->line->text);
  if (!strncasecmp(r->text.text, ".param", 6) || !strncasecmp(r->text.text, ".subckt", 7) ||
      tolower((unsigned char)*r->text.text) == 'x')
    rewrite_commas(r);
  vs_words_unbrace(r->text.text);
  rewrite_nested(r);
  status = rewrite_values(r);
  if (!status) status = check_sine(r);
  if (!status) status = check_points(r);
  if (!status) tell_of_edges(r);
  if (!status) status = models_rewrite(r);
  if (!status) status = vs_elements_rewrite(r);
  if (!status) status = vs_functions_rewrite(r);
  return status;
}

/* ---- names of subcircuits ---- */

static bool is_plain(vs_word name) {
  for (size_t k = 0; k < name.n; k++)
    if (!vs_words_goes_on(name.at[k])) return false;
  return true;
}

/* Writes '_' for each character of the n at `at` that no name of ngspice's parameters has. */
static void write_plain(char *at, size_t n) {
  for (size_t k = 0; k < n; k++)
    if (!vs_words_goes_on(at[k])) at[k] = '_';
}

/* True for a subcircuit that has parameters, in its head or in a .param of its own. */
static bool has_parameters(const vs_cards *c, size_t scope) {
  const vs_netlist_scope *of = &c->scope[scope];
  const vs_netlist_card *head = &c->card[of->first - 1];
  bool has = head->count > head->words;
  for (size_t k = of->first; k < of->last && !has; k = vs_cards_next(c, k))
    has = c->card[k].kind == VS_CARDS_PARAM;
  return has;
}

/* Finds the subcircuits that get other names, and tells of them. One stays as it is whose new name
 * another one has. */
static void find_renamed(const vs_cards *c, vs_names *renamed, vs_tally *tally) {
  vs_names taken = {0};
  for (size_t k = 1; k < c->n_scopes; k++)
    vs_names_put(&taken, c->scope[k].name.at, c->scope[k].name.n, k);
  for (size_t k = 1; k < c->n_scopes; k++) {
    const vs_word word = c->scope[k].name;
    if (is_plain(word) || !has_parameters(c, k)) continue;
    char *plain = vs_alloc_part(word.at, word.n);
    write_plain(plain, word.n);
    if (!vs_names_find(&taken, plain, word.n, NULL)) {
      vs_tally_add(tally,
                   "a subcircuit with parameters is found by ngspice if its name has letters, "
                   "digits and '_' only: other characters become '_'",
                   c->lines[c->scope[k].first - 1].where);
      vs_names_put(&taken, plain, word.n, k);
      vs_names_put(renamed, word.at, word.n, k);
    }
    free(plain);
  }
  vs_names_free(&taken);
}

/* ---- heads of subcircuits ---- */

/* Writes `by` in the place of n bytes at `at`, which lies in the line's text. */
static void change_line(vs_line *line, const char *at, size_t n, const char *by) {
  vs_text text = {0};
  vs_text_add(&text, "%.*s%s%s", (int)(at - line->text), line->text, by, at + n);
  vs_line_change(line, text.text);
}

/* Adds the nodes of "OPTIONAL: a=b ..." in a head, from one on: the names in it, or what an
 * instance that does not give them is connected to. */
static void add_optional(const vs_cards *c, const vs_netlist_card *head, vs_word all, size_t from,
                         bool names, vs_text *out) {
  size_t n = 0;
  vs_text_add(out, "%s", "");
  for (size_t k = head->first; k < head->first + head->count; k++) {
    const vs_argument *a = &c->arguments[k];
    const vs_word word = names ? a->name : a->value;
    if (a->name.n && a->name.at > all.at && a->name.at < all.at + all.n && n++ >= from)
      vs_text_add(out, " %.*s ", (int)word.n, word.at);
  }
}

/* Nodes behind OPTIONAL:, PSpice's, which an instance need not give: it is given them. */
static void give_optional(const vs_cards *c, vs_line *lines, size_t scope, vs_tally *tally) {
  const size_t number = c->scope[scope].first - 1;
  const vs_netlist_card *head = &c->card[number];
  const char *at = strcasestr(lines[number].text, "optional:");
  if (!at) return;
  const char *params = strcasestr(at, "params:"), *end = params ? params : at + strlen(at);
  const vs_word all = {at, (size_t)(end - at)};
  vs_text text = {0};
  for (size_t k = 0; k < c->count; k++) {
    const vs_netlist_card *card = &c->card[k];
    if (vs_cards_called(c, card) != scope || card->nodes < head->nodes) continue;
    add_optional(c, head, all, card->nodes - head->nodes, false, &text);
    change_line(&lines[k], card->model.at, 0, text.text);
    vs_text_free(&text);
  }
  add_optional(c, head, all, 0, true, &text);
  vs_tally_add(tally,
               "nodes behind OPTIONAL:, PSpice's, are read as nodes, to which an instance without "
               "them is given what stands behind their '='",
               lines[number].where);
  change_line(&lines[number], at, all.n, text.text);
  vs_text_free(&text);
}

/* True where the subcircuit's lines name it, and each of its instances gives it a value. */
static bool is_parameter(const vs_cards *c, size_t scope, vs_word name) {
  bool named = false, given = true;
  for (size_t k = c->scope[scope].first; k < c->scope[scope].last && !named; k++)
    named = vs_words_find(c->lines[k].text, c->lines[k].text, name.at, name.n);
  for (size_t k = 0; k < c->count && named && given; k++) {
    if (vs_cards_called(c, &c->card[k]) != scope) continue;
    given = false;
    for (size_t n = 0; n < c->card[k].count && !given; n++)
      given = !vs_words_compare(c->arguments[c->card[k].first + n].name, name);
  }
  return named && given;
}

/* Adds to the heads of subcircuits, by their scopes, the parameters that an instance gives and the
 * head lacks. LTspice's drawings have none in the heads of their blocks. Since each instance gives
 * them, their values there are no one's. */
static void find_parameters(const vs_cards *c, const vs_netlist_card *card, vs_text *heads) {
  const size_t scope = card->words < card->count ? vs_cards_called(c, card) : 0;
  for (size_t k = card->first; scope && k < card->first + card->count; k++) {
    const vs_word name = c->arguments[k].name;
    const char *own = heads[scope].text;
    if (!name.n || vs_words_is(name, "m") || vs_cards_find(c, scope, VS_CARDS_PARAM, name))
      continue;
    if (own && vs_words_find(own, own, name.at, name.n)) continue;
    if (is_parameter(c, scope, name)) vs_text_add(&heads[scope], " %.*s=0", (int)name.n, name.at);
  }
}

static void give_parameters(vs_line *lines, size_t count, vs_tally *tally) {
  vs_cards c;
  vs_cards_read(&c, lines, count);
  vs_text *heads = vs_alloc(c.n_scopes, sizeof *heads);
  for (size_t k = 0; k < count; k++) find_parameters(&c, &c.card[k], heads);
  for (size_t k = 1; k < c.n_scopes; k++) {
    vs_line *line = &lines[c.scope[k].first - 1];
    if (!heads[k].text) continue;
    change_line(line, line->text + strlen(line->text), 0, heads[k].text);
    vs_text_free(&heads[k]);
    vs_tally_add(tally,
                 "parameters that all instances of a subcircuit give and its .subckt does not "
                 "name, LTspice's, are read as if it did",
                 line->where);
  }
  free(heads);
  vs_cards_free(&c);
}

/* ---- currents of pins ---- */

/* The instance of that name, with or without its X, outside of subcircuits; count: there is none.
 */
static size_t instance_named(const vs_cards *c, vs_word name) {
  size_t k = 0;
  for (; k < c->count; k = vs_cards_next(c, k)) {
    const vs_word own = c->card[k].name, bare = {own.at + 1, own.n - (own.n > 0)};
    if (c->card[k].kind != VS_CARDS_ELEMENT || c->card[k].letter != 'x') continue;
    if (!vs_words_compare(own, name) || !vs_words_compare(bare, name)) break;
  }
  return k < c->count ? k : c->count;
}

/* Writes the call Ix(U1:A) at `at` in line k as the current of a source of 0 V before that pin. */
static vs_status read_current(const vs_cards *c, vs_line *lines, size_t k, const char *at,
                              vs_text *more, vs_error *err) {
  const char *open = strchr(at, '('), *colon = strchr(at, ':'), *close = strchr(at, ')');
  const vs_word name = {open + 1, colon && close > colon ? (size_t)(colon - open - 1) : 0};
  const vs_word pin = {name.n ? colon + 1 : at, name.n ? (size_t)(close - colon - 1) : 0};
  const size_t instance = c->card[k].scope ? c->count : instance_named(c, name);
  const size_t scope = instance < c->count ? vs_cards_called(c, &c->card[instance]) : 0;
  const vs_netlist_card *head = scope ? &c->card[c->scope[scope].first - 1] : NULL;
  size_t n = 0;
  while (head && n < head->nodes && vs_words_compare(vs_cards_word(c, head, n), pin)) n++;
  if (!head || n >= head->nodes || n >= c->card[instance].nodes)
    return vs_fail_at(
        err, vs_line_place_of(&lines[k], (vs_word){at, 2}),
        "Ix(INSTANCE:PIN), LTspice's, is read of an instance beside this line, outside "
        "of subcircuits, and a name in its .subckt; else put a source of 0 V before "
        "the pin, Vx a b 0, and write i(Vx)");
  const vs_word node = vs_cards_word(c, &c->card[instance], n);
  vs_text source = {0}, by = {0};
  vs_text_add(&source, "Vix_%.*s_%.*s", (int)name.n, name.at, (int)pin.n, pin.at);
  vs_text_add(&by, "i(%s)", source.text);
  if (vs_words_compare(node, vs_words_of(source.text + 1))) { /* it is not there yet */
    vs_text_add(more, "%s %.*s %s 0\n", source.text, (int)node.n, node.at, source.text + 1);
    change_line(&lines[instance], node.at, node.n, source.text + 1);
  }
  change_line(&lines[k], at, (size_t)(close + 1 - at), by.text);
  vs_text_free(&source);
  vs_text_free(&by);
  return VS_OK;
}

vs_status vs_translate_currents(vs_line *lines, size_t count, vs_text *more, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < count && !status; k++) {
    const char *at = lines[k].text;
    while ((at = vs_words_find(lines[k].text, at, "ix", 2)) && at[2] != '(') at += 2;
    if (!at || *lines[k].text == '.') continue;
    vs_cards c;
    vs_cards_read(&c, lines, count);
    status = vs_error_keep(err, read_current(&c, lines, k, at, more, err));
    const bool again =
        !status && lines[k].written && vs_words_find(lines[k].text, lines[k].text, "ix", 2);
    vs_cards_free(&c);
    k -= again && !vs_error_count(err);
  }
  return status;
}

/* Rewrites the heads of subcircuits. The cards are read anew behind each change. */
static void rewrite_heads(vs_line *lines, size_t count, vs_tally *tally) {
  bool given = false;
  for (size_t k = 0; k < count; k++) {
    given = given || (tolower((unsigned char)*lines[k].text) == 'x' && strchr(lines[k].text, '='));
    if (!vs_words_begin(lines[k].text, ".subckt") || !strcasestr(lines[k].text, "optional:"))
      continue;
    vs_cards c;
    vs_cards_read(&c, lines, count);
    give_optional(&c, lines, c.card[k].opens, tally);
    vs_cards_free(&c);
  }
  if (given) give_parameters(lines, count, tally);
}

void vs_translate_whole(vs_line *lines, size_t count, vs_tally *tally) {
  vs_cards c;
  vs_names renamed = {0};
  bool any = false;
  rewrite_heads(lines, count, tally);
  for (size_t k = 0; k < count && !any; k++)
    any = !strncasecmp(lines[k].text, ".subckt", 7) &&
          !is_plain(vs_words_at(vs_words_next(lines[k].text)));
  if (!any) return;
  vs_cards_read(&c, lines, count);
  find_renamed(&c, &renamed, tally);
  for (size_t k = 0; k < count && renamed.count; k++) {
    const vs_netlist_card *card = &c.card[k];
    const vs_word word = card->kind == VS_CARDS_SUBCKT ? card->name
                         : card->kind == VS_CARDS_ENDS ? vs_cards_word(&c, card, 0)
                         : card->letter == 'x'         ? card->model
                                                       : (vs_word){"", 0};
    if (!vs_names_find(&renamed, word.at, word.n, NULL)) continue;
    char *text = vs_copy(lines[k].text);
    write_plain(text + (word.at - lines[k].text), word.n);
    vs_line_change(&lines[k], text);
  }
  vs_names_free(&renamed);
  vs_cards_free(&c);
}
