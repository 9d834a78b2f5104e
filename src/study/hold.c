/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/hold.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/units.h"
#include "measure/expect.h"
#include "run/keys.h"

const char *const vs_hold_words[] = {"held", "violated", "undecided"};

/* ---- what is asked ---- */

size_t vs_hold_find(const vs_hold *h, const char *name) {
  for (size_t k = 0; k < h->count; k++)
    if (!strcmp(h->line[k].name, name)) return k;
  return SIZE_MAX;
}

vs_status vs_hold_need(const vs_hold *h, const char *key, const char *name, vs_where where,
                       size_t *line, vs_error *err) {
  *line = vs_hold_find(h, name);
  if (*line != SIZE_MAX) return VS_OK;
  const char **names = vs_alloc(h->count + 1, sizeof *names);
  for (size_t k = 0; k < h->count; k++) names[k] = h->line[k].name;
  vs_fail_at(err, where, "%s: %s have no line '%s'%s", key, h->where, name,
             vs_text_hint(name, names, h->count, h->hint).text);
  free(names);
  return VS_INPUT;
}

vs_status vs_hold_each(vs_hold *h, const vs_node *map, const char *key, vs_hold_take take,
                       vs_error *err) {
  char name[2 * VS_KEY_SIZE];
  vs_status status = VS_OK;
  if (map && map->kind != VS_NODE_MAP)
    return vs_fail_at(err, map->where, "%s: a line is wanted: %s.thyristor.v_reverse=...%s", key,
                      key, *key == 'h' ? ", or hold.margin=..." : "");
  for (const vs_node *n = map ? map->child : NULL; n && !status; n = n->next) {
    if (n->kind != VS_NODE_MAP) status = take(h, n->key, n, err);
    for (const vs_node *m = n->kind == VS_NODE_MAP ? n->child : NULL; m && !status; m = m->next) {
      snprintf(name, sizeof name, "%.90s.%.90s", n->key, m->key);
      status = vs_error_keep(err, take(h, name, m, err));
    }
    status = vs_error_keep(err, status);
  }
  return status;
}

vs_status vs_hold_check_sense(const vs_hold_line *l, const char *key, vs_where where,
                              vs_error *err) {
  if (l->sense) return VS_OK;
  return vs_fail_at(err, where,
                    "%s.%s: a limit of 0, two ends on one side of 0 or limits that differ in kind "
                    "have no part; give `vibrospice study` another rating",
                    key, l->name);
}

vs_status vs_hold_one(vs_hold *h, const char *name, const vs_node *value, vs_error *err) {
  char why[160];
  double number;
  size_t k;
  if (value->kind != VS_NODE_TEXT || !vs_units_read(value->text, "", &number, why, sizeof why))
    return vs_fail_at(err, value->where, "hold.%s: a number is wanted, as 10 %% or 0.8", name);
  if (!strcmp(name, "margin")) {
    if (!(number >= 0 && number < 1))
      return vs_fail_at(err, value->where,
                        "hold.margin: a part of the limit is wanted, 0 to 1 (1 excluded)");
    h->margin = number;
    return VS_OK;
  }
  vs_status status = vs_hold_need(h, "hold", name, value->key_where, &k, err);
  if (status) return status;
  vs_hold_line *l = &h->line[k];
  if (!(number > 0 && isfinite(number)))
    return vs_fail_at(err, value->where, "hold.%s: a part of the limit is wanted, above 0", name);
  l->part = l->sense < 0 ? 1 / number : number;
  return vs_hold_check_sense(l, "hold", value->where, err);
}

const vs_inside vs_hold_waiver = {
    .rows = VS_ROWS({"line", .kind = VS_NEEDED | VS_TEXT}, {"because", .kind = VS_TEXT})};

/* A line, or all lines of a device. */
static vs_status waive_one(vs_hold *h, const vs_node *n, vs_error *err) {
  const vs_node *line = n->kind == VS_NODE_MAP ? vs_tree_child(n, "line") : n,
                *because = n->kind == VS_NODE_MAP ? vs_tree_child(n, "because") : NULL;
  const char *name = line && line->kind == VS_NODE_TEXT ? line->text : "";
  const size_t length = strlen(name);
  size_t k, waived = 0;
  vs_status status =
      n->kind == VS_NODE_MAP ? vs_field_map_keys(n, "waive", &vs_hold_waiver, err) : VS_OK;
  if (!status && (!line || (because && because->kind != VS_NODE_TEXT)))
    status = vs_fail_at(err, n->where,
                        "waive: {line: thyristor.di_dt, because: a text} is wanted, or a line");
  for (k = 0; !status && *name && k < h->count; k++) {
    if (strncmp(h->line[k].name, name, length) != 0 ||
        (h->line[k].name[length] && h->line[k].name[length] != '.'))
      continue;
    h->line[k].waived = true;
    h->line[k].because = because ? because->text : NULL;
    waived++;
  }
  return status || waived ? status : vs_hold_need(h, "waive", name, line->where, &k, err);
}

vs_status vs_hold_waive(vs_hold *h, const vs_node *list, vs_error *err) {
  vs_status status = VS_OK;
  for (const vs_node *n = !list                        ? NULL
                          : list->kind == VS_NODE_LIST ? list->child
                                                       : list;
       n && !status; n = list->kind == VS_NODE_LIST ? n->next : NULL)
    status = vs_error_keep(err, waive_one(h, n, err));
  return status;
}

/* ---- rows ---- */

/* As vs_verdict_word has it. */
static vs_hold_word word_of(double margin, double error) {
  if (isnan(margin) || fabs(margin) <= error) return VS_HOLD_UNDECIDED;
  return margin < 0 ? VS_HOLD_VIOLATED : VS_HOLD_HELD;
}

static vs_hold_word worse(vs_hold_word a, vs_hold_word b) {
  return a == VS_HOLD_VIOLATED || b == VS_HOLD_VIOLATED     ? VS_HOLD_VIOLATED
         : a == VS_HOLD_UNDECIDED || b == VS_HOLD_UNDECIDED ? VS_HOLD_UNDECIDED
                                                            : VS_HOLD_HELD;
}

bool vs_hold_is_weaker(double m, double e, double other, double of_other) {
  const bool sure = word_of(m, e) == VS_HOLD_VIOLATED,
             other_sure = word_of(other, of_other) == VS_HOLD_VIOLATED;
  if (sure != other_sure) return sure;
  return m - (sure || isnan(e) ? 0 : e) <= other - (sure || isnan(of_other) ? 0 : of_other);
}

/* True if the scene waived that, a line or a device: not_judged ends with "a.b, c.d (waived)". */
static bool was_waived(const char *not_judged, const char *name) {
  static const char END[] = " (waived)";
  const size_t size = strlen(not_judged), n = strlen(name);
  if (size < strlen(END) || strcmp(not_judged + size - strlen(END), END) != 0) return false;
  const char *list = not_judged;
  for (const char *s; (s = strstr(list, "; "));) list = s + 2;
  for (const char *s = list; (s = strstr(s, name)); s += n)
    if ((s == list || s[-1] == ' ') && (s[n] == ',' || s[n] == ' ')) return true;
  return false;
}

/* True if all of the line's device were. */
static bool was_device_waived(const char *not_judged, const char *line) {
  char device[VS_DECK_NAME];
  snprintf(device, sizeof device, "%.*s", (int)strcspn(line, "."), line);
  return strchr(line, '.') && was_waived(not_judged, device);
}

/* Copies the first of what happened, "WHAT of DEVICE at ... | ..." (study/workers/case.c), and
 * moves on behind it. NULL: there is nothing more. */
static char *next_happening(const char **rest) {
  const char *s = *rest, *end = strstr(s, " | ");
  *rest = end ? end + strlen(" | ") : s + strlen(s);
  return *s ? vs_alloc_part(s, end ? (size_t)(end - s) : strlen(s)) : NULL;
}

static const char EXPECTED[] = ", as expected", UNSURE[] = ", in one of two runs",
                  NEVER[] = " did not happen, though expected";

/* True if the criterion allows what that is, "WHAT of DEVICE ...". */
static bool is_allowed(int criterion, const char *one) {
  char what[VS_DECK_NAME];
  snprintf(what, sizeof what, "%.*s", (int)strcspn(one, " "), one);
  return vs_expect_spares(criterion, what);
}

/* The number of the criterion asked for; -1: that of the rows. */
static int criterion_of(const vs_hold *h) {
  return h->criterion ? (int)(h->criterion - vs_expect_criteria) : -1;
}

/* True if something that the criterion asked for allows happened to the line's device, in both
 * runs behind its errors. */
static bool did_happen(const vs_hold *h, const vs_hold_line *l, const char *happened) {
  char *one, device[VS_DECK_NAME + 16];
  bool did = false;
  snprintf(device, sizeof device, " of %.*s at ", (int)strcspn(l->name, "."), l->name);
  for (; (one = next_happening(&happened)); free(one))
    did = did || (strstr(one, device) && !strstr(one, UNSURE) && is_allowed(criterion_of(h), one));
  return did;
}

/* True if the criterion asked for leaves the line out, as it does in a run. */
static bool is_left_out(const vs_hold *h, const vs_hold_line *l, const char *happened) {
  if (!l->left_out_by || criterion_of(h) < l->left_out_by) return false;
  return l->left_out_by < VS_CRITERION_OPENS || did_happen(h, l, happened);
}

/* What a waived line comes to now. Under criterion A one that is broken is undecided where it may
 * be the row's own criterion that waived it: a row does not say who did. */
static vs_hold_word waived_word(const vs_hold *h, const vs_hold_line *l, vs_hold_word word) {
  const bool by_criterion = criterion_of(h) == 0 && l->left_out_by == VS_CRITERION_FIRES;
  return by_criterion && word != VS_HOLD_HELD ? VS_HOLD_UNDECIDED : VS_HOLD_HELD;
}

/* The margin to the limit asked for. A margin m to a most limit L leaves the stress at L (1 - m),
 * to a least one at L (1 + m); of the new limit `part` L the house wants its share besides. */
static double margin_now(const vs_hold *h, const vs_hold_line *l, double m) {
  if (l->part == 1) return m - h->margin;
  return (l->sense < 0 ? (1 + m) / l->part - 1 : 1 - (1 - m) / l->part) - h->margin;
}

/* What the margin's error may be then. A part of it is of the stress, and grows with 1 / part, a
 * part is of the limit; which, a row does not say. So it is never made smaller than it was. */
static double error_now(const vs_hold_line *l, double e) {
  return e * fmax(1, 1 / l->part);
}

void vs_hold_judge(const vs_hold *h, size_t line, double m, double e, const char *not_judged,
                   vs_hold_row *r, vs_hold_word came[2]) {
  const vs_hold_line *l = &h->line[line];
  const double now = margin_now(h, l, m), error = error_now(l, e);
  const bool device = !l->own && was_device_waived(not_judged, l->name),
             waived = device || (!l->own && was_waived(not_judged, l->name)),
             left_out = device || l->waived || is_left_out(h, l, r->happened);
  came[0] = waived ? VS_HOLD_HELD : word_of(m, e);
  came[1] = left_out ? VS_HOLD_HELD
            : waived ? waived_word(h, l, word_of(now, error))
                     : word_of(now, error);
  r->stored = worse(r->stored, came[0]);
  r->now = worse(r->now, came[1]);
  if (waived || left_out || !isfinite(now)) return;
  if (r->weakest != SIZE_MAX && !vs_hold_is_weaker(now, error, r->margin, r->error)) return;
  r->margin = now;
  r->error = error;
  r->weakest = line;
}

void vs_hold_happened(const vs_hold *h, vs_hold_row *r) {
  const int criterion = criterion_of(h);
  const char *rest = r->happened;
  for (char *one; (one = next_happening(&rest)); free(one)) {
    const vs_hold_word w = strstr(one, UNSURE) ? VS_HOLD_UNDECIDED : VS_HOLD_VIOLATED;
    bool spared = strstr(one, EXPECTED) && w == VS_HOLD_VIOLATED;
    if (!spared) r->stored = worse(r->stored, w);
    if (criterion == 0)
      spared = strstr(one, NEVER) != NULL;
    else if (criterion > 0)
      spared = spared || is_allowed(criterion, one) || strstr(one, NEVER);
    if (!spared) r->now = worse(r->now, w);
  }
}

bool vs_hold_rest(const vs_hold *h, bool broken, const char *warnings, vs_hold_row *r) {
  if (!broken && r->stored != VS_HOLD_HELD) return false;
  if (broken && r->stored == VS_HOLD_HELD) r->stored = r->now = worse(r->now, VS_HOLD_UNDECIDED);
  if (h->margin > 0 && strstr(warnings, " has no column: its margin is "))
    r->now = worse(r->now, VS_HOLD_UNDECIDED);
  return true;
}
