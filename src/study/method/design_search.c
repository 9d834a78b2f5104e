/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "method/design_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "engine/tiers.h"
#include "method/search.h"
#include "method/span.h"
#include "run/session.h"

/* Draws are asked for this many at a time. When the first is violated, the others were run in vain.
 */
enum { DRAWS = 16 };
/* Numbers of cases from here on are points that were searched. */
static const uint64_t FOUND = 1ull << 62;
/* Steps of a search within the ranges of a threat are no shorter, in parts of each range. */
static const double FINEST = 1e-3;

void vs_design_search_point(const vs_design_search *s, uint64_t number, double *point) {
  const vs_design_cases *c = &s->d->cases;
  if (number < FOUND) {
    vs_design_cases_point(s->plan, c, number, point);
    return;
  }
  if (c->n_points) point[c->axis] = 0;
  memcpy(point + c->threats->axis, s->found + (size_t)(number - FOUND) * c->threats->n,
         c->threats->n * sizeof *point);
}

const char *vs_design_search_found_by(const vs_design_search *s, uint64_t number) {
  return number >= FOUND ? "search" : number < s->d->cases.count ? "list" : "draw";
}

/* ---- what a run comes to ---- */

static const char *word_of(const vs_results *r, uint64_t run, int word) {
  const char *text = r->words[run * VS_RESULT_WORDS + (size_t)word];
  return text ? text : "";
}

vs_hold_row vs_design_search_judge(const vs_design_search *s, uint64_t run) {
  const vs_design *d = s->d;
  const char *not_judged = word_of(s->results, run, VS_RESULT_NOT_JUDGED);
  vs_hold_row row = VS_HOLD_ROW;
  row.happened = word_of(s->results, run, VS_RESULT_HAPPENED);
  vs_hold_word came[2];
  for (size_t k = 0; k < d->hold.count; k++) {
    if (d->margin[k] < 0) continue;
    const double margin = vs_plan_results_value(s->results, run, d->margin[k]),
                 error = vs_plan_results_value(s->results, run, d->margin[k] + 1);
    if (isnan(margin)) continue; /* no such line; or nothing to judge, which the status tells */
    if (vs_design_choices_lacks(d, &s->results->points[run * s->plan->n_axes],
                                d->hold.line[k].name)) {
      vs_hold_line gone = d->hold.line[k]; /* what it says is of no part */
      const vs_hold one = {.line = &gone, .count = 1};
      gone.waived = true;
      vs_hold_judge(&one, 0, margin, error, not_judged, &row, came);
      continue;
    }
    vs_hold_judge(&d->hold, k, margin, error, not_judged, &row, came);
  }
  vs_hold_happened(&d->hold, &row);
  if (!vs_hold_rest(&d->hold, s->results->status[run] == 3,
                    word_of(s->results, run, VS_RESULT_WARNINGS), &row))
    row.now = VS_HOLD_UNDECIDED;
  return row;
}

/* The margin that a class leaves of a limit of the list, as it is held; infinite where the class
 * does not say it. */
static double margin_of_class(const vs_design *d, const vs_design_class *class, size_t limit,
                              size_t line, double worst) {
  vs_hold_row row = VS_HOLD_ROW;
  vs_hold_word came[2];
  if (isnan(class->limit[limit]) || d->hold.line[line].waived) return INFINITY;
  vs_hold_judge(&d->hold, line, 1 - worst / class->limit[limit], NAN, "", &row, came);
  return row.margin;
}

/* True if the class bears what the choice's devices bore in all runs of the candidate. Else *mark
 * is what it does not. */
static bool class_bears(const vs_design *d, const vs_design_candidate *c, size_t leader,
                        const vs_design_class *class, vs_design_mark *mark) {
  bool bears = true;
  for (size_t k = 0; k < d->n_choices; k++) {
    if (d->choice[k].leader != leader) continue;
    for (size_t l = 0; l < d->choice[leader].n_limits; l++) {
      const double margin = margin_of_class(d, class, l, d->choice[k].line[l], c->worst[k][l]);
      if (margin >= 0 || (!bears && margin > mark->margin)) continue;
      *mark = c->worst_at[k][l];
      mark->margin = margin;
      bears = false;
    }
  }
  return bears;
}

/* True if the case's event makes the deck's line of the device untrue, as where its element is
 * opened: the run warns of it (engine/drive/wiring.c). */
static bool is_untrue(const vs_results *r, uint64_t run, const char *device) {
  static const char NOT_RIGHT[] = "are not right any more: those of ";
  const size_t n = strlen(device);
  const char *list = strstr(word_of(r, run, VS_RESULT_WARNINGS), NOT_RIGHT);
  if (!list) return false;
  list += strlen(NOT_RIGHT);
  const char *end = list + strcspn(list, ";|");
  for (const char *s = list; s < end; s += strcspn(s, ",;|"), s += strspn(s, ", "))
    if (!strncmp(s, device, n) && strchr(",;|", s[n])) return true;
  return false;
}

/* Takes what the devices of the list's limits bore, and returns the line of one that is not known;
 * SIZE_MAX: all are. */
static size_t take_stresses(const vs_design_search *s, vs_design_candidate *c, uint64_t number,
                            uint64_t run) {
  const vs_design *d = s->d;
  size_t unknown = SIZE_MAX;
  for (size_t k = 0; k < d->n_choices; k++)
    for (size_t l = 0; l < d->choice[d->choice[k].leader].n_limits; l++) {
      const int column = d->choice[k].column[l];
      if (column < 0) continue;
      const double x = fabs(vs_plan_results_value(s->results, run, column)) *
                       vs_units_factor(s->plan->columns[column].unit);
      const bool untrue = is_untrue(s->results, run, d->choice[k].device);
      if (isnan(x) || untrue) unknown = d->choice[k].line[l];
      if (untrue) continue;
      if (!(x > c->worst[k][l])) continue;
      c->worst[k][l] = x;
      c->worst_at[k][l] = (vs_design_mark){number, run, d->choice[k].line[l], NAN, NAN};
    }
  return unknown;
}

/* Takes the cheapest classes that bear what there was so far. False: of one choice none does;
 * *mark says what the one that bears most does not. */
static bool take_classes(const vs_design *d, vs_design_candidate *c, vs_design_mark *mark) {
  for (size_t k = 0; k < d->n_choices; k++) {
    if (d->choice[k].leader != k || !d->choice[k].n_limits) continue;
    const vs_design_option *o = &d->choice[k].option[vs_design_choices_option(d, c->number, k)];
    vs_design_mark here = {0}, best = {.margin = -INFINITY};
    size_t n = 0;
    for (; n < o->n_classes && !class_bears(d, c, k, &o->classes[n], &here); n++)
      if (here.margin > best.margin) best = here;
    if (n == o->n_classes) {
      *mark = best;
      return false;
    }
    c->class[k] = n;
  }
  return true;
}

/* ---- candidates ---- */

static vs_design_candidate *find_seen(const vs_design_search *s, uint64_t number) {
  for (size_t k = 0; k < s->n_seen; k++)
    if (s->seen[k]->number == number) return s->seen[k];
  return NULL;
}

static vs_design_candidate *begin_candidate(vs_design_search *s, uint64_t number, uint64_t rank) {
  vs_design_candidate *c = vs_alloc(1, sizeof *c);
  *c = (vs_design_candidate){
      .number = number, .rank = rank, .price = vs_design_choices_price(s->d, number, NULL)};
  s->seen = vs_alloc_grow(s->seen, s->n_seen, sizeof *s->seen);
  return s->seen[s->n_seen++] = c;
}

/* Passes over those that were begun out of turn. */
static void skip_seen(vs_design_search *s) {
  while (s->next_rank < s->d->n_candidates && find_seen(s, s->d->order[s->next_rank]))
    s->next_rank++;
}

/* The cheapest open candidate that is none of not[n]; NULL: there is none left. */
static vs_design_candidate *cheapest(vs_design_search *s, vs_design_candidate *const * not,
                                     size_t n) {
  vs_design_candidate *best = NULL;
  for (size_t k = 0; k < s->n_seen; k++) {
    vs_design_candidate *c = s->seen[k];
    bool out = c->state != VS_DESIGN_OPEN;
    for (size_t i = 0; i < n; i++) out = out || not [i] == c;
    if (out) continue;
    if (!best || c->price < best->price || (c->price == best->price && c->rank < best->rank))
      best = c;
  }
  skip_seen(s);
  if (s->next_rank == s->d->n_candidates) return best;
  const uint64_t number = s->d->order[s->next_rank];
  const double price = vs_design_choices_price(s->d, number, NULL);
  if (best && (best->price < price || (best->price == price && best->rank < s->next_rank)))
    return best;
  return begin_candidate(s, number, s->next_rank++);
}

/* ---- asking ---- */

typedef struct asked {
  vs_design_candidate *candidate;
  uint64_t number; /* of the case */
  size_t place;    /* in the search's list; SIZE_MAX: it is a draw */
  bool verify;     /* with the errors of its margins */
} asked;

/* Returns the first of n runs that were asked for; UINT64_MAX: they are not there yet, or the
 * budget is spent. */
static uint64_t ask(vs_design_search *s, const asked *one, size_t n) {
  double point[VS_PLAN_AXES];
  const uint64_t first = s->used;
  if (s->used + n <= s->results->count) {
    s->used += n;
    return first;
  }
  s->spent = s->used + n > s->d->most_runs;
  s->waits = true;
  for (size_t k = 0; k < n && !s->spent && s->generation; k++) {
    vs_design_search_point(s, one[k].number, point);
    if (s->d->verify) point[s->d->verify_axis] = one[k].verify;
    for (size_t c = 0; c < s->d->n_choices; c++) {
      const vs_design_choice *leader = &s->d->choice[s->d->choice[c].leader];
      const size_t option = vs_design_choices_option(s->d, one[k].candidate->number, c);
      point[s->d->choice[c].axis] = leader->option[option].number;
      const size_t tolerance = s->d->choice[c].tolerance;
      if (tolerance)
        point[tolerance - 1] *=
            leader->option[option].number / vs_span_nominal(&s->plan->axes[tolerance - 1]);
    }
    vs_plan_generation_add(s->generation, point);
  }
  return UINT64_MAX;
}

/* ---- a candidate and a case ---- */

static void make_room(const vs_design_search *s, vs_design_candidate *c) {
  if (c->room >= s->n_list) return;
  c->run = vs_resize(c->run, s->n_list, sizeof *c->run);
  memset(c->run + c->room, 0, (s->n_list - c->room) * sizeof *c->run);
  c->room = s->n_list;
}

/* True if the run cannot begin, as a part of the candidate conducts at rest: it cannot hold. */
static bool cannot_begin(const vs_design_search *s, uint64_t run) {
  return s->results->status[run] == 1 &&
         strstr(word_of(s->results, run, VS_RESULT_WHY), vs_tiers_on_at_rest);
}

/* Takes the run of a case that the list has in that place. One that is rejected already stays so.
 */
static void take_run(vs_design_search *s, vs_design_candidate *c, size_t place, uint64_t run) {
  const uint64_t number = s->list[place];
  vs_design_mark mark;
  make_room(s, c);
  c->run[place] = run + 1;
  c->runs++;
  if (c->state == VS_DESIGN_KILLED) return;
  const bool failed = s->results->status[run] == 1;
  const vs_hold_row row = vs_design_search_judge(s, run);
  bool doubtful = failed || row.now == VS_HOLD_UNDECIDED;
  bool killed = failed ? cannot_begin(s, run) : row.now == VS_HOLD_VIOLATED;
  mark = (vs_design_mark){number, run, row.weakest, row.margin, row.error};
  const size_t unknown = failed ? SIZE_MAX : take_stresses(s, c, number, run);
  if (unknown != SIZE_MAX && !doubtful && !killed)
    mark = (vs_design_mark){number, run, unknown, NAN, NAN};
  doubtful = doubtful || unknown != SIZE_MAX;
  if (!failed && !killed) killed = !take_classes(s->d, c, &mark);
  if (killed) {
    c->state = VS_DESIGN_KILLED;
    c->killer = mark;
    s->killed_at[place] = ++s->kills;
  } else if (doubtful && !c->doubtful)
    c->killer = mark;
  if (!killed && doubtful) c->doubtful = true;
  if (killed) return;
  const double before = c->price;
  c->price = vs_design_choices_price(s->d, c->number, c->class);
  /* what asks for a dearer class, or leaves one unjudged, is likely to do so to others, too */
  if (doubtful || c->price > before) s->killed_at[place] = ++s->kills;
}

/* True if the run violates a line by less than a margin may be wrong by, and nobody knows its
 * error: to be rejected for it, the candidate is run once more. All lines are taken for as
 * uncertain as a rate, as a rate may have made one more firing or less. */
static bool is_near(const vs_design_search *s, uint64_t run) {
  if (!s->d->verify || s->results->status[run] == 1) return false;
  const vs_hold_row row = vs_design_search_judge(s, run);
  const double tolerance = s->plan->first->setup.run.tolerance;
  return row.now == VS_HOLD_VIOLATED && isnan(row.error) && row.margin < 0 &&
         -row.margin <= vs_session_resolution(tolerance, true);
}

/* Runs one[n] of the list, those that are near to a limit with the errors of their margins. False:
 * the search waits. */
static bool run_cases(vs_design_search *s, const asked *one, size_t n) {
  asked again[64];
  uint64_t run[64], first = ask(s, one, n);
  size_t m = 0;
  if (first == UINT64_MAX) return false;
  for (size_t k = 0; k < n; k++) run[k] = first + k;
  for (size_t k = 0; k < n; k++) {
    if (one[k].verify || !is_near(s, run[k])) continue;
    again[m] = one[k];
    again[m++].verify = true;
  }
  first = m ? ask(s, again, m) : 0;
  if (first == UINT64_MAX) return false;
  for (size_t k = 0; k < n; k++) {
    if (!one[k].verify && is_near(s, run[k])) {
      run[k] = first++;
      one[k].candidate->runs++;
    }
    take_run(s, one[k].candidate, one[k].place, run[k]);
  }
  return true;
}

/* The case that the candidate is run with next: of those it has not been, the one that rejected
 * another candidate last, or made it dearer. SIZE_MAX: it has been run with all. taken[n]: those
 * asked for already. */
static size_t next_case(const vs_design_search *s, vs_design_candidate *c, const asked *taken,
                        size_t n) {
  size_t best = SIZE_MAX;
  make_room(s, c);
  for (size_t k = 0; k < s->n_list; k++) {
    bool out = c->run[k] != 0;
    for (size_t i = 0; i < n; i++) out = out || (taken[i].candidate == c && taken[i].place == k);
    if (!out && (best == SIZE_MAX || s->killed_at[k] > s->killed_at[best])) best = k;
  }
  return best;
}

/* Fills one[width] with what is run next. The candidate at hand is likely to be rejected by a case
 * that has rejected another one; the rest of the width then goes to those behind it. */
static size_t choose_runs(vs_design_search *s, vs_design_candidate *c, bool alone, asked *one) {
  vs_design_candidate *in[64];
  size_t n = 0;
  size_t place = next_case(s, c, NULL, 0);
  const bool likely = s->killed_at[place] > 0;
  one[n++] = (asked){c, s->list[place], place, false};
  in[0] = c;
  while (n < s->d->width && !alone && likely) {
    vs_design_candidate *other = cheapest(s, in, n);
    place = other ? next_case(s, other, NULL, 0) : SIZE_MAX;
    if (place == SIZE_MAX || !s->killed_at[place]) break;
    in[n] = other;
    one[n++] = (asked){other, s->list[place], place, false};
  }
  while (n < s->d->width && (alone || !likely) && (place = next_case(s, c, one, n)) != SIZE_MAX)
    one[n++] = (asked){c, s->list[place], place, false};
  return n;
}

/* Runs the candidate until it is rejected, dearer than another one, or has been run with all cases;
 * then its state says what it is. alone: whatever it costs, and no other is run besides. */
static void run_candidate(vs_design_search *s, vs_design_candidate *c, bool alone) {
  asked one[64];
  const double price = c->price;
  while (c->state == VS_DESIGN_OPEN && (alone || c->price == price)) {
    if (next_case(s, c, NULL, 0) == SIZE_MAX) {
      c->held = !c->doubtful;
      c->state = c->held ? VS_DESIGN_HOLDS : VS_DESIGN_UNJUDGED;
      return;
    }
    const size_t n = choose_runs(s, c, alone, one);
    if (!run_cases(s, one, n)) return;
  }
}

/* Runs the list again for the errors of its margins. False: it does not hold with them, or these
 * are waited for. */
static bool verify_candidate(vs_design_search *s, vs_design_candidate *c) {
  asked one[64];
  const double price = c->price;
  if (!s->d->verify || c->verified) return true;
  c->state = VS_DESIGN_OPEN;
  for (size_t k = 0; k < s->n_list && c->state == VS_DESIGN_OPEN;) {
    size_t n = 0;
    while (n < s->d->width && k + n < s->n_list) {
      one[n] = (asked){c, s->list[k + n], k + n, true};
      n++;
    }
    if (!run_cases(s, one, n)) return false;
    k += n;
  }
  c->verified = c->state == VS_DESIGN_OPEN && !c->doubtful && c->price == price;
  c->held = c->verified;
  if (c->verified) c->state = VS_DESIGN_HOLDS;
  if (c->state == VS_DESIGN_OPEN && c->doubtful) c->state = VS_DESIGN_UNJUDGED;
  return c->verified;
}

/* The cheapest candidate that holds the list; sure: with the errors of its margins. NULL: the
 * search waits, or none does. */
static vs_design_candidate *find_cheapest(vs_design_search *s, bool sure) {
  vs_design_candidate *c;
  while ((c = cheapest(s, NULL, 0)) && !s->waits) {
    run_candidate(s, c, false);
    if (s->waits) return NULL;
    if (c->state == VS_DESIGN_HOLDS && (!sure || verify_candidate(s, c))) return c;
  }
  s->looked_at_all = !c;
  return NULL;
}

/* ---- cases that are not listed ---- */

static void add_case(vs_design_search *s, uint64_t number) {
  s->list = vs_alloc_grow(s->list, s->n_list, sizeof *s->list);
  s->killed_at = vs_alloc_grow(s->killed_at, s->n_list, sizeof *s->killed_at);
  s->killed_at[s->n_list] = 0;
  s->list[s->n_list++] = number;
}

/* True if the run leaves the candidate as it is. *mark: its weakest line, those that the list of
 * prices has limits for among them. */
static bool case_holds(const vs_design_search *s, const vs_design_candidate *c, uint64_t number,
                       uint64_t run, vs_design_mark *mark) {
  const vs_design *d = s->d;
  vs_design_candidate alone = {.number = c->number}, after = *c;
  vs_design_mark here = {.margin = NAN};
  const vs_hold_row row = vs_design_search_judge(s, run);
  *mark = (vs_design_mark){number, run, row.weakest, row.margin, row.error};
  if (s->results->status[run] == 1 || take_stresses(s, &alone, number, run) != SIZE_MAX) {
    mark->margin = NAN;
    return false;
  }
  for (size_t k = 0; k < d->n_choices; k++) {
    const vs_design_choice *leader = &d->choice[d->choice[k].leader];
    const vs_design_option *o = &leader->option[vs_design_choices_option(d, c->number, k)];
    for (size_t l = 0; l < leader->n_limits; l++) {
      const double margin = margin_of_class(d, &o->classes[c->class[d->choice[k].leader]], l,
                                            d->choice[k].line[l], alone.worst[k][l]);
      if (!isfinite(margin) || mark->margin <= margin) continue;
      *mark = (vs_design_mark){number, run, d->choice[k].line[l], margin, NAN};
    }
  }
  take_stresses(s, &after, number, run);
  return row.now == VS_HOLD_HELD && take_classes(d, &after, &here) &&
         !memcmp(after.class, c->class, sizeof after.class);
}

/* Shows the candidate one[n], n <= DRAWS, which no candidate has seen, and writes mark[n]. The
 * weakest of those that it does not hold becomes a case of the list, and the candidate's first run
 * of it. False: that, or the search waits. */
static bool show_cases(vs_design_search *s, const asked *one, size_t n, vs_design_mark *mark) {
  vs_design_candidate *c = one->candidate;
  const uint64_t first = ask(s, one, n);
  size_t broken = SIZE_MAX;
  if (first == UINT64_MAX) return false;
  c->runs += n;
  for (size_t k = 0; k < n; k++) {
    if (case_holds(s, c, one[k].number, first + k, &mark[k])) continue;
    if (broken == SIZE_MAX || mark[k].margin < mark[broken].margin ||
        (isnan(mark[broken].margin) && !isnan(mark[k].margin)))
      broken = k;
  }
  if (broken != SIZE_MAX) {
    add_case(s, one[broken].number);
    c->state = VS_DESIGN_OPEN;
    c->verified = c->held = false;
    if (is_near(s, first + broken)) return false; /* it is run with its error, as one of the list */
    c->runs--;                                    /* take_run counts it */
    take_run(s, c, s->n_list - 1, first + broken);
    return false;
  }
  for (size_t k = 0; k < n; k++) {
    s->shown = vs_alloc_grow(s->shown, s->n_shown, sizeof *s->shown);
    s->shown[s->n_shown++] = mark[k];
    take_stresses(s, c, one[k].number, first + k);
  }
  return true;
}

/* Shows it fresh draws. True: it held all. */
static bool hold_draws(vs_design_search *s, vs_design_candidate *c) {
  asked one[DRAWS];
  vs_design_mark mark[DRAWS];
  while (s->draws_held < s->d->random) {
    const uint64_t left = s->d->random - s->draws_held, base = s->d->cases.count + s->draws;
    const size_t n = left < DRAWS ? (size_t)left : DRAWS;
    for (size_t k = 0; k < n; k++) one[k] = (asked){c, base + k, SIZE_MAX, false};
    const bool held = show_cases(s, one, n, mark);
    if (s->waits) return false;
    s->draws += n;
    if (!held) return false;
    s->draws_held += n;
  }
  return true;
}

/* ---- the worst within the ranges ---- */

/* Where the points of a threat lie. */
typedef struct ranges {
  size_t which, n;
  const vs_axis *axis[VS_PLAN_AXES];
} ranges;

static uint64_t keep_point(vs_design_search *s, const ranges *r, const double *share) {
  const vs_plan_stage *t = s->d->cases.threats;
  const size_t row = t->n * sizeof *s->found;
  s->found = vs_alloc_grow(s->found, s->n_found, row);
  t->method->place(s->plan, t, r->which, share, s->found + s->n_found * t->n);
  return FOUND + s->n_found++;
}

static vs_search *begin_search(const vs_design_search *s, const ranges *r) {
  vs_search_setup setup = {.axes = r->n,
                           .seed = s->plan->seed + r->which,
                           .most = (size_t)s->d->searched,
                           .restarts = (size_t)s->d->restarts,
                           .finest = FINEST};
  for (size_t k = 0; k < r->n; k++) {
    setup.levels[k] = (int)vs_span_levels(r->axis[k]);
    setup.period[k] = vs_span_period(s->plan, r->axis[k]);
  }
  return vs_search_new(&setup);
}

/* Shows the candidate a generation of the search, a few points at a time, so that little is run in
 * vain behind one that it does not hold. */
static bool hold_generation(vs_design_search *s, vs_design_candidate *c, const ranges *r,
                            const double *share, size_t count, double *value,
                            vs_design_mark *least) {
  asked one[DRAWS];
  vs_design_mark mark[DRAWS];
  for (size_t k = 0; k < count; k += DRAWS) {
    const size_t n = count - k < DRAWS ? count - k : DRAWS;
    for (size_t i = 0; i < n; i++)
      one[i] = (asked){c, keep_point(s, r, share + (k + i) * r->n), SIZE_MAX, false};
    if (!show_cases(s, one, n, mark)) return false;
    for (size_t i = 0; i < n; i++) {
      value[k + i] = mark[i].margin;
      if (least->run == UINT64_MAX || mark[i].margin < least->margin) *least = mark[i];
    }
  }
  return true;
}

/* Searches the ranges of a threat for the candidate's least margin, and runs the worst once more
 * for its error. True: it held all that was looked at. */
static bool hold_threat(vs_design_search *s, vs_design_candidate *c, const ranges *r) {
  vs_search *search = begin_search(s, r);
  vs_design_worst worst = {.mark.run = UINT64_MAX};
  bool held = true;
  size_t count;
  for (const double *share; held && (share = vs_search_ask(search, &count), count);) {
    double *value = vs_alloc(count, sizeof *value);
    held = hold_generation(s, c, r, share, count, value, &worst.mark);
    if (held) vs_search_tell(search, value);
    worst.n += count;
    free(value);
  }
  worst.restarts = vs_search_restarts(search);
  worst.place = vs_search_agree(search, &worst.near);
  vs_search_free(search);
  if (held && s->d->verify && worst.mark.run != UINT64_MAX) {
    const asked again = {c, worst.mark.number, SIZE_MAX, true};
    held = show_cases(s, &again, 1, &worst.mark);
  }
  if (!held) return false;
  s->worst = vs_alloc_grow(s->worst, s->n_worst, sizeof *s->worst);
  s->worst[s->n_worst++] = worst;
  return true;
}

static bool hold_ranges(vs_design_search *s, vs_design_candidate *c) {
  const vs_plan_stage *t = s->d->cases.threats;
  ranges r = {0};
  for (; t && (r.n = t->method->ranges(s->plan, t, r.which, r.axis)) != SIZE_MAX; r.which++)
    if (r.n && !hold_threat(s, c, &r)) return false;
  return true;
}

/* Shows the candidate what the list has not. True: nothing broke it. */
static bool prove_candidate(vs_design_search *s, vs_design_candidate *c) {
  s->n_shown = s->n_worst = 0;
  s->draws_held = 0;
  if (!s->d->cases.ranged) return true;
  return (!s->d->searched || hold_ranges(s, c)) && hold_draws(s, c);
}

/* ---- what stands around the answer ---- */

static vs_design_candidate *candidate_of(vs_design_search *s, uint64_t number) {
  vs_design_candidate *c = find_seen(s, number);
  uint64_t rank = 0;
  if (c) return c;
  while (s->d->order[rank] != number) rank++;
  return begin_candidate(s, number, rank);
}

/* The answer with the class below its own, which does not bear what the answer's bears. */
static void add_class_below(vs_design_search *s, size_t choice) {
  const vs_design_choice *c = &s->d->choice[choice];
  vs_design_candidate below = *s->answer;
  vs_design_neighbour n = {choice, s->answer, NULL, 0, true, {0}};
  if (c->leader != choice || !below.class[choice]) return;
  n.below = &c->option[vs_design_choices_option(s->d, below.number, choice)]
                 .classes[--below.class[choice]];
  n.price = vs_design_choices_price(s->d, below.number, below.class);
  class_bears(s->d, &below, choice, n.below, &n.killer);
  s->neighbour[s->n_neighbours++] = n;
}

static void look_around(vs_design_search *s) {
  for (size_t k = 0; k < s->d->n_choices && !s->waits; k++) {
    const size_t option = vs_design_choices_option(s->d, s->answer->number, k);
    if (s->d->choice[k].leader != k || !option) continue;
    vs_design_candidate *c =
        candidate_of(s, vs_design_choices_with(s->d, s->answer->number, k, option - 1));
    run_candidate(s, c, true);
    s->neighbour[s->n_neighbours++] =
        (vs_design_neighbour){k, c, NULL, c->price, c->state == VS_DESIGN_KILLED, c->killer};
    if (c->state == VS_DESIGN_HOLDS) c->state = VS_DESIGN_OPEN; /* it may be the runner-up */
  }
  for (size_t k = 0; k < s->d->n_choices; k++) add_class_below(s, k);
  if (!s->waits) s->runner_up = find_cheapest(s, false);
}

static void find_weakest_run(vs_design_search *s) {
  double least = INFINITY;
  for (size_t k = 0; k < s->n_list; k++) {
    const uint64_t run = s->answer->run[k] - 1;
    const vs_hold_row row = vs_design_search_judge(s, run);
    if (k && !(row.margin < least)) continue;
    least = row.margin;
    s->weakest_run = run;
  }
}

void vs_design_search_run(vs_design_search *s, const vs_design *d, const vs_plan *plan,
                          const vs_results *results, vs_generation *generation) {
  *s = (vs_design_search){.d = d, .plan = plan, .results = results, .generation = generation};
  for (uint64_t k = 0; k < d->cases.count; k++) add_case(s, k);
  while (!s->waits && (s->answer = find_cheapest(s, true)) && !prove_candidate(s, s->answer)) {
    if (s->waits) break;
    s->answer = NULL;
  }
  s->proved = s->answer && !s->waits;
  if (s->answer) find_weakest_run(s);
  if (s->proved && d->neighbours) look_around(s);
}

double vs_design_search_bound(const vs_design_search *s) {
  double price = INFINITY;
  for (size_t k = 0; k < s->n_seen; k++)
    if (s->seen[k]->state != VS_DESIGN_KILLED) price = fmin(price, s->seen[k]->price);
  if (s->next_rank < s->d->n_candidates)
    price = fmin(price, vs_design_choices_price(s->d, s->d->order[s->next_rank], NULL));
  return price;
}

/* True where a came nearer to holding than b: not rejected before not judged before violated; of
 * two not rejected the one with more runs, of two violated the one that is violated by less; then
 * the cheaper one. */
static bool is_nearer(const vs_design_candidate *a, const vs_design_candidate *b) {
  static const int RANK[] = {[VS_DESIGN_HOLDS] = 3,
                             [VS_DESIGN_OPEN] = 2,
                             [VS_DESIGN_UNJUDGED] = 1,
                             [VS_DESIGN_KILLED] = 0};
  if (a->state != b->state) return RANK[a->state] > RANK[b->state];
  if (a->state == VS_DESIGN_OPEN && a->runs != b->runs) return a->runs > b->runs;
  if (a->state == VS_DESIGN_KILLED && a->killer.margin != b->killer.margin)
    return a->killer.margin > b->killer.margin || isnan(b->killer.margin);
  return a->price < b->price;
}

const vs_design_candidate *vs_design_search_nearest(const vs_design_search *s) {
  const vs_design_candidate *best = NULL;
  for (size_t k = 0; k < s->n_seen && !s->looked_at_all; k++)
    if (!best || is_nearer(s->seen[k], best)) best = s->seen[k];
  return best;
}

void vs_design_search_free(vs_design_search *s) {
  for (size_t k = 0; k < s->n_seen; k++) {
    free(s->seen[k]->run);
    free(s->seen[k]);
  }
  free(s->seen);
  free(s->list);
  free(s->killed_at);
  free(s->shown);
  free(s->found);
  free(s->worst);
}

void vs_design_search_least(vs_design_mark *least, vs_design_mark mark) {
  if (!isfinite(mark.margin)) return;
  if (least->run == UINT64_MAX ||
      vs_hold_is_weaker(mark.margin, mark.error, least->margin, least->error))
    *least = mark;
}
