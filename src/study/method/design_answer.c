/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "method/design_answer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/file.h"
#include "base/json.h"
#include "method/design_scene.h"
#include "method/design_search.h"
#include "method/search.h"

typedef struct answer {
  const vs_plan *plan;
  const vs_design *d;
  const vs_results *results;
  vs_design_search s;
  const char *folder;
  const vs_design_candidate *best; /* the answer; where the budget was spent without one, what came
                                      nearest; NULL: there is none */
  /* Of the best, of the lines of each choice's devices; run UINT64_MAX: no line is theirs. The
   * last: of all lines. */
  vs_design_mark least[VS_DESIGN_CHOICES + 1];
  uint64_t *scene; /* [n_scenes]: runs whose scenes are written */
  size_t n_scenes;
  size_t unjudged;        /* candidates below the answer's price that could not be judged */
  size_t cheaper;         /* candidates that cost less than the answer */
  uint64_t without_error; /* runs of the answer whose weakest margin has no error */
} answer;

/* ---- the least margin of each part ---- */

/* Takes a run of the answer: each line of it belongs to a choice, or to none. */
static void take_run_of_answer(answer *a, uint64_t number, uint64_t run) {
  const vs_design *d = a->d;
  const char *not_judged = a->results->words[run * VS_RESULT_WORDS + VS_RESULT_NOT_JUDGED];
  const vs_hold_row whole = vs_design_search_judge(&a->s, run);
  vs_hold_word came[2];
  if (whole.weakest != SIZE_MAX)
    vs_design_search_least(&a->least[d->n_choices],
                           (vs_design_mark){number, run, whole.weakest, whole.margin, whole.error});
  a->without_error += whole.weakest != SIZE_MAX && isnan(whole.error);
  for (size_t k = 0; k < d->hold.count; k++) {
    vs_hold_row row = VS_HOLD_ROW;
    if (d->margin[k] < 0 || vs_design_choices_lacks(d, &a->results->points[run * a->plan->n_axes],
                                                    d->hold.line[k].name))
      continue;
    vs_hold_judge(&d->hold, k, vs_plan_results_value(a->results, run, d->margin[k]),
                  vs_plan_results_value(a->results, run, d->margin[k] + 1),
                  not_judged ? not_judged : "", &row, came);
    if (row.weakest == SIZE_MAX) continue;
    for (size_t c = 0; c < d->n_choices; c++)
      if (vs_design_choices_makes_line(&d->choice[c], &a->plan->first->setup.deck,
                                       d->hold.line[k].name))
        vs_design_search_least(&a->least[c],
                               (vs_design_mark){number, run, k, row.margin, row.error});
  }
}

static const vs_design_class *class_of(const vs_design *d, const vs_design_candidate *c,
                                       size_t choice) {
  const vs_design_choice *leader = &d->choice[d->choice[choice].leader];
  return &leader->option[vs_design_choices_option(d, c->number, choice)]
              .classes[c->class[d->choice[choice].leader]];
}

/* The margin that the part's class has, or a lower one, at the most that there was. */
static void take_class(answer *a, size_t choice, const vs_design_class *class,
                       vs_design_mark *least) {
  const vs_design *d = a->d;
  const vs_design_choice *c = &d->choice[choice];
  vs_hold_word came[2];
  for (size_t l = 0; l < d->choice[c->leader].n_limits; l++) {
    vs_hold_row row = VS_HOLD_ROW;
    vs_design_mark mark = a->best->worst_at[choice][l];
    if (isnan(class->limit[l]) || !(a->best->worst[choice][l] > 0)) continue;
    vs_hold_judge(&d->hold, c->line[l], 1 - a->best->worst[choice][l] / class->limit[l], NAN, "",
                  &row, came);
    mark.line = c->line[l];
    mark.margin = row.margin;
    mark.error = NAN;
    if (row.weakest != SIZE_MAX) vs_design_search_least(least, mark);
  }
}

static void find_margins(answer *a) {
  const vs_design_search *s = &a->s;
  const vs_design_candidate *best = a->best;
  for (size_t c = 0; c <= a->d->n_choices; c++) a->least[c].run = UINT64_MAX;
  if (!best) return;
  for (size_t k = 0; k < s->n_list; k++)
    if (k < best->room && best->run[k]) take_run_of_answer(a, s->list[k], best->run[k] - 1);
  for (size_t k = 0; k < s->n_shown && best == s->answer; k++)
    take_run_of_answer(a, s->shown[k].number, s->shown[k].run);
  for (size_t c = 0; c < a->d->n_choices; c++)
    take_class(a, c, class_of(a->d, best, c), &a->least[c]);
}

static void count_cheaper(answer *a) {
  const vs_design_search *s = &a->s;
  const double price = s->answer ? s->answer->price : INFINITY;
  for (size_t k = 0; k < s->n_seen; k++) {
    const vs_design_candidate *c = s->seen[k];
    if (!(c->price < price)) continue; /* one of the same price would be no better */
    a->unjudged += c->state == VS_DESIGN_UNJUDGED;
    a->cheaper += c->state == VS_DESIGN_KILLED;
  }
}

/* ---- words ---- */

/* What decides: a line; where none is broken, what happened that must not, or why the run failed.
 * *margin: the line's; NaN: no line decides. */
static const char *line_name(const answer *a, const vs_design_mark *mark, double *margin) {
  const char *happened = a->results->words[mark->run * VS_RESULT_WORDS + VS_RESULT_HAPPENED];
  const char *why = a->results->words[mark->run * VS_RESULT_WORDS + VS_RESULT_WHY];
  vs_hold_row row = VS_HOLD_ROW;
  *margin = NAN;
  if (why) return why;
  if (happened) row.happened = happened;
  vs_hold_happened(&a->d->hold, &row);
  if (mark->line == SIZE_MAX || (mark->margin > 0 && row.now != VS_HOLD_HELD)) return row.happened;
  *margin = mark->margin;
  return a->d->hold.line[mark->line].name;
}

static void add_case(const answer *a, const vs_design_mark *mark, vs_text *text) {
  double point[VS_PLAN_AXES];
  vs_design_search_point(&a->s, mark->number, point);
  vs_design_cases_write(a->plan, &a->d->cases, point, text);
}

static void add_option(const answer *a, const vs_design_candidate *c, size_t choice,
                       vs_text *text) {
  vs_design_choices_write_option(a->d, a->plan, c->number, choice, text);
}

/* Adds "+6.3 % +- 0.2 %". */
static void add_margin(double margin, double error, vs_text *text) {
  vs_text_add(text, "%+.3g %%", 100 * margin);
  if (isfinite(error)) vs_text_add(text, " +- %.2g %%", 100 * error);
}

/* ---- scenes of the cases that decide ---- */

static void want_scene(answer *a, uint64_t run) {
  if (run == UINT64_MAX) return;
  for (size_t k = 0; k < a->n_scenes; k++)
    if (a->scene[k] == run) return;
  a->scene = vs_alloc_grow(a->scene, a->n_scenes, sizeof *a->scene);
  a->scene[a->n_scenes++] = run;
}

/* Those of the answer's least margins, of what rejects its neighbours, and of the last rejection
 * by each case of the list. */
static void want_scenes(answer *a) {
  const vs_design_search *s = &a->s;
  for (size_t c = 0; c < a->d->n_choices; c++) want_scene(a, a->least[c].run);
  for (size_t k = 0; k < s->n_worst; k++) want_scene(a, s->worst[k].mark.run);
  for (size_t k = 0; k < s->n_neighbours; k++)
    if (s->neighbour[k].killed) want_scene(a, s->neighbour[k].killer.run);
  for (size_t n = 0; n < s->n_list; n++)
    for (size_t k = s->n_seen; k-- > 0;)
      if (s->seen[k]->state != VS_DESIGN_OPEN && s->seen[k]->state != VS_DESIGN_HOLDS &&
          s->seen[k]->killer.number == s->list[n]) {
        want_scene(a, s->seen[k]->killer.run);
        break;
      }
}

/* ---- tables ---- */

static const char *state_word(const vs_design_candidate *c) {
  static const char *const WORDS[] = {"open", "violated", "unjudged", "held"};
  return WORDS[c->held ? VS_DESIGN_HOLDS : c->state];
}

/* A row a candidate, in the order in which they were begun. */
static void add_candidates(const answer *a, vs_text *text) {
  vs_text cell = {0};
  vs_text_add(text, "candidate,price");
  for (size_t c = 0; c < a->d->n_choices; c++) {
    vs_text_add(text, ",");
    vs_csv_cell(text, a->plan->axes[a->d->choice[c].axis].column);
  }
  vs_text_add(text, ",verdict,killer,line,margin,margin_error,case,runs\n");
  for (size_t k = 0; k < a->s.n_seen; k++) {
    const vs_design_candidate *c = a->s.seen[k];
    const bool killed = c->state == VS_DESIGN_KILLED || c->state == VS_DESIGN_UNJUDGED;
    vs_text_add(text, "%zu,%.12g", k, c->price);
    for (size_t n = 0; n < a->d->n_choices; n++) {
      char word[VS_NAME_SIZE];
      const vs_design_choice *leader = &a->d->choice[a->d->choice[n].leader];
      vs_axis_print(&a->plan->axes[leader->axis],
                    leader->option[vs_design_choices_option(a->d, c->number, n)].number, word,
                    sizeof word);
      vs_text_add(text, ",");
      vs_csv_cell(text, word);
    }
    vs_text_add(text, ",%s,", state_word(c));
    cell.length = 0;
    if (killed) add_case(a, &c->killer, &cell);
    vs_csv_cell(text, cell.length ? cell.text : "");
    vs_text_add(text, ",");
    double margin = NAN;
    vs_csv_cell(text, killed ? line_name(a, &c->killer, &margin) : "");
    vs_text_add(text, ",");
    if (isfinite(margin)) vs_text_add_number(text, margin, 12);
    vs_text_add(text, ",");
    if (isfinite(margin) && isfinite(c->killer.error))
      vs_text_add_number(text, c->killer.error, 12);
    vs_text_add(text, ",");
    if (killed) vs_text_add(text, "%llu", (unsigned long long)c->killer.run);
    vs_text_add(text, ",%llu\n", (unsigned long long)c->runs);
  }
  vs_text_free(&cell);
}

/* A row a key: what is bought for it, and all that the list of prices says of that. */
static void add_bill(const answer *a, vs_text *text) {
  const vs_price_list *l = &a->d->list;
  vs_text cell = {0};
  vs_text_add(text, "key,number,price_each,chosen");
  for (size_t c = 0; c < l->columns; c++) {
    vs_text_add(text, ",");
    vs_csv_cell(text, l->title[c]);
  }
  vs_text_add(text, "\n");
  for (size_t c = 0; c < a->d->n_choices && a->s.answer; c++) {
    const vs_design_class *class = class_of(a->d, a->s.answer, c);
    if (class->row == VS_DESIGN_NONE) continue; /* nothing is bought */
    vs_text_add(text, "%s,%d,%.12g,", a->d->choice[c].node->key, a->d->choice[c].number,
                class->price);
    cell.length = 0;
    add_option(a, a->s.answer, c, &cell);
    vs_csv_cell(text, cell.text);
    for (size_t n = 0; n < l->columns; n++) {
      vs_text_add(text, ",");
      vs_csv_cell(text, vs_price_list_cell(l, class->row, n)->text);
    }
    vs_text_add(text, "\n");
  }
  vs_text_free(&cell);
}

/* ---- the proof, in sentences that are true ---- */

static void add_proof_of_list(const answer *a, vs_text *text) {
  const vs_design_search *s = &a->s;
  vs_text_add(text, "List: the answer holds all %zu cases, each a run in ngspice", s->n_list);
  if (s->n_list > a->d->cases.count)
    vs_text_add(text, " (%zu of them found within the ranges)",
                s->n_list - (size_t)a->d->cases.count);
  if (a->without_error)
    vs_text_add(text, "; in %llu of its runs the weakest margin has no computed error",
                (unsigned long long)a->without_error);
  vs_text_add(text, ". Candidates that cost less and do not hold: %zu", a->cheaper);
  if (a->cheaper)
    vs_text_add(text, "; design.csv names the case of each%s",
                a->d->verify ? ", which was run again for the error of its margin if this was near "
                               "to the limit"
                             : "");
  if (a->unjudged) vs_text_add(text, ". Those that could not be judged: %zu", a->unjudged);
  vs_text_add(text, ".");
}

/* Adds the worst of a threat: "+6.3 % of thyristor.v_reverse under surge: angle 41.2 deg (case 812,
 * of 400 runs; of 8 restarts 5 came to this place and 6 to this value)". */
static void add_worst(const answer *a, const vs_design_worst *w, vs_text *text) {
  double margin;
  if (w->mark.run == UINT64_MAX) {
    vs_text_add(text, "no margin in %llu runs", (unsigned long long)w->n);
    return;
  }
  add_margin(w->mark.margin, w->mark.error, text);
  vs_text_add(text, " of %s under ", line_name(a, &w->mark, &margin));
  add_case(a, &w->mark, text);
  vs_text_add(text, " (case %llu, of %llu runs; ", (unsigned long long)w->mark.run,
              (unsigned long long)w->n);
  if (w->restarts > 1)
    vs_text_add(text, "of %zu restarts %zu came to this place and %zu to this value)", w->restarts,
                w->place, w->near);
  else
    vs_text_add(text, "a single search: nothing is known of other places)");
}

static void add_proof_of_ranges(const answer *a, vs_text *text) {
  const vs_design_search *s = &a->s;
  if (!a->d->cases.ranged) {
    vs_text_add(text, "Ranges: none is stated; nothing is said of values that are not listed.");
    return;
  }
  if (!a->d->searched) {
    vs_text_add(text,
                "Ranges: the list has samples of each range; the worst case between them was not "
                "searched for (proof: {search: {}} does so), and no bound is claimed.");
    return;
  }
  vs_text_add(text, "Ranges: the worst found, for each threat: ");
  for (size_t k = 0; k < s->n_worst; k++) {
    if (k) vs_text_add(text, "; ");
    add_worst(a, &s->worst[k], text);
  }
  vs_text_add(text, s->proved ? "." : "%sthe search was not done to its end.",
              s->n_worst ? "; " : "");
  vs_text_add(
      text,
      " A place is the same within %g %% of each range, a value within as much. No bound is "
      "claimed.",
      100 * VS_SEARCH_AGREE);
}

static void add_proof_by_draws(const answer *a, vs_text *text) {
  const vs_design_search *s = &a->s;
  if (!s->draws_held) {
    vs_text_add(text, "Random: nothing was drawn.");
    return;
  }
  /* of N draws none violates: (1 - p)^N = 0.05, for large N p = 3/N */
  vs_text_add(text,
              "Random: 0 of %llu draws after the last change violate; %llu were drawn in all. "
              "With 95 %% confidence, less than %.3g %% of such draws violate. A draw takes one "
              "threat, all being equally likely, with uniform values within its ranges, and each "
              "spread by its own distribution.",
              (unsigned long long)s->draws_held, (unsigned long long)s->draws,
              100 * (1 - pow(0.05, 1 / (double)s->draws_held)));
}

/* Adds the lines that hold waives, those that the list of prices judges, or those of another limit.
 */
static void add_lines(const answer *a, int which, vs_text *text) {
  static const char *const TITLE[] = {
      " Waived by hold: ", " Judged by the list of prices, without an error: ",
      " Limits that hold changes: "};
  const char *between = TITLE[which];
  for (size_t k = 0; k < a->d->hold.count; k++) {
    const vs_hold_line *l = &a->d->hold.line[k];
    const bool is[] = {l->waived, a->d->margin[k] < 0, l->part != 1};
    if (!is[which]) continue;
    vs_text_add(text, "%s%s", between, l->name);
    if (which == 0 && l->because) vs_text_add(text, " (because: %s)", l->because);
    if (which == 2) vs_text_add(text, " times %.6g", l->part);
    between = ", ";
  }
  if (between != TITLE[which]) vs_text_add(text, ".");
}

/* What no run judged, each group once, as the rows of the answer say it. */
static void add_not_judged(const answer *a, vs_text *text) {
  const vs_design_search *s = &a->s;
  vs_text all = {0};
  for (size_t k = 0; k < s->n_list; k++) {
    const uint64_t run = s->answer->run[k] - 1;
    const char *cell = a->results->words[run * VS_RESULT_WORDS + VS_RESULT_NOT_JUDGED];
    for (const char *g = cell; g && *g;) {
      const char *end = strstr(g, "; "), *reason = strchr(g, '(');
      /* a reason may have the sign, too */
      if (end && reason && reason < end && memchr(reason, ')', (size_t)(end - reason)) == NULL)
        end = strstr(strchr(reason, ')') ? strchr(reason, ')') : end, "; ");
      const size_t n = end ? (size_t)(end - g) : strlen(g);
      vs_text one = {0};
      vs_design_scene_group(a->d, g, n, &one);
      if (one.length && (!all.length || !strstr(all.text, one.text)))
        vs_text_add(&all, "%s%s", all.length ? "; " : "", one.text);
      vs_text_free(&one);
      g += n + (end ? 2 : 0);
    }
  }
  vs_text_add(text, "Not judged: %s.", all.length ? all.text : "nothing");
  for (int which = 0; which < 3; which++) add_lines(a, which, text);
  vs_design_scene_unsure(a->plan, &a->results->points[a->s.weakest_run * a->plan->n_axes], text);
  vs_text_free(&all);
}

static void (*const SENTENCES[])(const answer *, vs_text *) = {
    add_proof_of_list, add_proof_of_ranges, add_proof_by_draws, add_not_judged};
enum { PROOF = sizeof SENTENCES / sizeof *SENTENCES };

/* ---- JSON ---- */

static void put_mark(const answer *a, const char *key, const vs_design_mark *mark, vs_json *json) {
  vs_text text = {0};
  double margin;
  if (mark->run == UINT64_MAX) {
    vs_json_null(json, key);
    return;
  }
  add_case(a, mark, &text);
  vs_json_object(json, key, VS_JSON_ROW);
  vs_json_text(json, "line", line_name(a, mark, &margin));
  vs_json_number(json, "margin", margin, 12);
  vs_json_number(json, "margin_error", isnan(margin) ? NAN : mark->error, 12);
  vs_json_text(json, "threat", text.text);
  vs_json_text(json, "found_by", vs_design_search_found_by(&a->s, mark->number));
  vs_json_whole(json, "case", (int64_t)mark->run);
  vs_json_end(json);
  vs_text_free(&text);
}

static void put_choices(const answer *a, const vs_design_candidate *c, bool margins,
                        vs_json *json) {
  vs_json_object(json, "choice", margins ? VS_JSON_LINES : VS_JSON_ROW);
  for (size_t k = 0; k < a->d->n_choices; k++) {
    vs_text text = {0};
    const vs_design_class *class = class_of(a->d, c, k);
    add_option(a, c, k, &text);
    if (!margins) {
      vs_json_text(json, a->d->choice[k].node->key, text.text);
    } else {
      vs_json_object(json, a->d->choice[k].node->key, VS_JSON_ROW);
      vs_json_text(json, "chosen", text.text);
      vs_json_text(json, "part", vs_design_choices_part(a->d, class));
      vs_json_whole(json, "number", a->d->choice[k].number);
      vs_json_number(json, "price_each", class->price, 12);
      put_mark(a, "least", &a->least[k], json);
      vs_json_end(json);
    }
    vs_text_free(&text);
  }
  vs_json_end(json);
}

static void put_neighbours(const answer *a, vs_json *json) {
  const vs_design_search *s = &a->s;
  vs_json_array(json, "one_size_smaller", VS_JSON_LINES);
  for (size_t k = 0; k < s->n_neighbours; k++) {
    const vs_design_neighbour *n = &s->neighbour[k];
    vs_text text = {0};
    add_option(a, n->candidate, n->choice, &text);
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_json_text(json, "key", a->d->choice[n->choice].node->key);
    vs_json_text(json, "chosen", text.text);
    if (n->below) vs_json_text(json, "part", vs_design_choices_part(a->d, n->below));
    vs_json_number(json, "price", n->price, 12);
    vs_json_text(json, "verdict", n->below ? "violated" : state_word(n->candidate));
    if (n->killed) put_mark(a, "killer", &n->killer, json);
    vs_json_end(json);
    vs_text_free(&text);
  }
  vs_json_end(json);
  if (!s->runner_up) {
    vs_json_null(json, "runner_up");
    return;
  }
  vs_json_object(json, "runner_up", VS_JSON_ROW);
  vs_json_number(json, "price", s->runner_up->price, 12);
  put_choices(a, s->runner_up, false, json);
  vs_json_end(json);
}

static void put_worst(const answer *a, vs_json *json) {
  vs_json_array(json, "searched", VS_JSON_LINES);
  for (size_t k = 0; k < a->s.n_worst; k++) {
    const vs_design_worst *w = &a->s.worst[k];
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_json_whole(json, "n", (int64_t)w->n);
    vs_json_whole(json, "restarts", (int64_t)w->restarts);
    vs_json_whole(json, "agree_place", (int64_t)w->place);
    vs_json_whole(json, "agree_value", (int64_t)w->near);
    put_mark(a, "worst", &w->mark, json);
    vs_json_end(json);
  }
  vs_json_end(json);
}

static const char *status_word(vs_status status) {
  return status == VS_OK       ? "proved"
         : status == VS_RATING ? "nothing holds"
         : status == VS_BUDGET ? "budget spent"
                               : "not judged";
}

static void put_answer(const answer *a, vs_status status, vs_json *json) {
  const vs_design_search *s = &a->s;
  vs_json_object(json, NULL, VS_JSON_LINES);
  vs_json_whole(json, "status", status);
  vs_json_text(json, "word", status_word(status));
  vs_json_text(json, "least", a->d->aim->text);
  vs_json_number(json, "price", s->answer ? s->answer->price : NAN, 12);
  vs_json_number(json, "lower_bound",
                 status == VS_RATING ? vs_design_choices_dearest(a->d) : vs_design_search_bound(s),
                 12);
  vs_json_whole(json, "candidates", (int64_t)a->d->n_candidates);
  vs_json_whole(json, "looked_at", (int64_t)s->n_seen);
  vs_json_whole(json, "runs", (int64_t)a->results->count);
  vs_json_whole(json, "list", (int64_t)s->n_list);
  vs_json_whole(json, "draws", (int64_t)s->draws);
  vs_json_whole(json, "draws_held", (int64_t)s->draws_held);
  if (s->answer) put_choices(a, s->answer, true, json);
  put_worst(a, json);
  if (s->proved) put_neighbours(a, json);
  if (s->answer) {
    vs_json_array(json, "proof", VS_JSON_LINES);
    for (int k = 0; k < PROOF; k++) {
      vs_text text = {0};
      SENTENCES[k](a, &text);
      vs_json_text(json, NULL, text.text);
      vs_text_free(&text);
    }
    vs_json_end(json);
  }
  vs_json_end(json);
}

const char *const vs_design_answer_files[] = {"design.json", "design.csv", "design.txt", "bom.csv",
                                              NULL};

static vs_status write_files(answer *a, vs_status ended, const vs_text *page, vs_error *err) {
  vs_text text = {0};
  vs_json json = vs_json_new(&text);
  vs_status status;
  want_scenes(a);
  status = vs_design_scene_write(a->plan, a->results, a->scene, a->n_scenes, a->folder, err);
  add_candidates(a, &text);
  if (!status) status = vs_file_write(a->folder, "design.csv", text.text, err);
  if (!status) status = vs_file_write(a->folder, "design.txt", page->text, err);
  text.length = 0;
  add_bill(a, &text);
  if (!status) status = vs_file_write(a->folder, "bom.csv", text.text, err);
  text.length = 0;
  put_answer(a, ended, &json);
  vs_text_add(&text, "\n");
  if (!status) status = vs_file_write(a->folder, "design.json", text.text, err);
  vs_text_free(&text);
  return status;
}

/* ---- for people ---- */

/* Pads the text to a column's end. */
static void add_cell(vs_text *line, const char *text, size_t width) {
  vs_text_add(line, "%-*s  ", (int)width, text);
}

/* A margin, whose it is and under what. */
static void add_mark(const answer *a, const vs_design_mark *mark, vs_text *line) {
  vs_text text = {0};
  double margin;
  add_margin(mark->margin, mark->error, &text);
  add_cell(line, text.text, 18);
  add_cell(line, line_name(a, mark, &margin), 22);
  add_case(a, mark, line);
  vs_text_add(line, " (%s, case %llu)\n", vs_design_search_found_by(&a->s, mark->number),
              (unsigned long long)mark->run);
  vs_text_free(&text);
}

static void add_choice_row(const answer *a, size_t c, vs_text *line) {
  const vs_design_class *class = class_of(a->d, a->best, c);
  const vs_design_mark *least = &a->least[c];
  vs_text text = {0};
  add_option(a, a->best, c, &text);
  if (strcmp(text.text, vs_design_choices_part(a->d, class)) != 0)
    vs_text_add(&text, " (%s)", vs_design_choices_part(a->d, class));
  add_cell(line, a->d->choice[c].node->key, 20);
  add_cell(line, text.text, 22);
  vs_text_add(line, "%-3d  %-7.6g  ", a->d->choice[c].number, class->price);
  if (least->run == UINT64_MAX) {
    add_cell(line, "-", 18);
    vs_text_add(line, class->row == VS_DESIGN_NONE ? "left out\n" : "no limit of it is judged\n");
  } else {
    add_mark(a, least, line);
  }
  vs_text_free(&text);
}

/* Adds ", under surge: angle 41.2 deg (case 812)". */
static void add_where(const answer *a, const vs_design_mark *mark, vs_text *text) {
  vs_text_add(text, ", under ");
  add_case(a, mark, text);
  vs_text_add(text, " (case %llu)\n", (unsigned long long)mark->run);
}

static void add_violation(const answer *a, const vs_design_mark *mark, vs_text *text) {
  double margin;
  vs_text_add(text, " does not hold: %s", line_name(a, mark, &margin));
  if (isfinite(margin)) {
    vs_text_add(text, ", margin ");
    add_margin(margin, mark->error, text);
  }
  add_where(a, mark, text);
}

/* Adds why the candidate could not be judged. */
static void add_doubt(const answer *a, const vs_design_candidate *c, vs_text *text) {
  double margin;
  const char *name = line_name(a, &c->killer, &margin);
  const bool failed = a->results->status[c->killer.run] == 1,
             unknown = !failed && c->killer.line != SIZE_MAX && isnan(c->killer.margin);
  vs_text_add(text, " could not be judged: %s%s",
              failed || unknown ? "" : "its verdict is undecided",
              failed || unknown || !*name ? "" : " in ");
  vs_text_add(text, "%s%s", name, unknown ? " is not known" : "");
  add_where(a, &c->killer, text);
}

static void add_neighbour_row(const answer *a, const vs_design_neighbour *n, vs_text *text) {
  const vs_design_candidate *c = n->candidate;
  vs_text_add(text, "%-20s  ", a->d->choice[n->choice].node->key);
  if (n->below)
    vs_text_add(text, "as %s", vs_design_choices_part(a->d, n->below));
  else
    add_option(a, c, n->choice, text);
  if (n->killed)
    add_violation(a, &n->killer, text);
  else if (c->held)
    vs_text_add(text, " holds the list, too, for %.6g\n", c->price);
  else if (c->state == VS_DESIGN_OPEN)
    vs_text_add(text, " was not run to its end, as the budget is spent\n");
  else
    add_doubt(a, c, text);
}

static void add_around(const answer *a, vs_text *text) {
  const vs_design_search *s = &a->s;
  vs_text_add(text, "\none size smaller, or the part that is next in price\n");
  for (size_t k = 0; k < s->n_neighbours; k++) add_neighbour_row(a, &s->neighbour[k], text);
  vs_text_add(text, "\nrunner-up             ");
  if (!s->runner_up) {
    vs_text_add(text, s->spent ? "not looked for to the end: the budget is spent\n"
                               : "none: no other candidate holds the list\n");
    return;
  }
  vs_design_choices_write(a->d, a->plan, s->runner_up->number, text);
  vs_text_add(text, ", for %.6g more, holds the list; it was neither searched nor drawn for%s\n",
              s->runner_up->price - s->answer->price,
              a->d->verify && !s->runner_up->verified ? ", nor run for the errors of its margins"
                                                      : "");
}

static bool is_killed_so(const answer *a, const vs_design_candidate *c, uint64_t number,
                         const char *line) {
  double margin;
  return c->state == VS_DESIGN_KILLED && c->killer.number == number &&
         !strcmp(line_name(a, &c->killer, &margin), line);
}

/* Adds for each line, and the case that breaks it, how many candidates they reject, and which of
 * them comes nearest. */
static void add_killers(const answer *a, vs_text *text) {
  const vs_design_search *s = &a->s;
  double margin, here;
  for (size_t k = 0; k < s->n_seen; k++) {
    const vs_design_candidate *nearest = s->seen[k];
    if (nearest->state != VS_DESIGN_KILLED) continue;
    const uint64_t number = nearest->killer.number;
    const char *line = line_name(a, &nearest->killer, &margin);
    size_t n = 0, first = 0;
    while (!is_killed_so(a, s->seen[first], number, line)) first++;
    if (first < k) continue;
    for (size_t i = k; i < s->n_seen; i++) {
      if (!is_killed_so(a, s->seen[i], number, line)) continue;
      n++;
      line_name(a, &s->seen[i]->killer, &here);
      if (here > margin) nearest = s->seen[i], margin = here;
    }
    vs_text_add(text, "%s%zu candidate%s; %s", text->length ? "" : "what rejects them\n", n,
                n == 1 ? "" : "s", n == 1 ? "" : "the nearest: ");
    vs_design_choices_write(a->d, a->plan, nearest->number, text);
    add_violation(a, &nearest->killer, text);
  }
}

static void add_choices(const answer *a, vs_text *text) {
  if (a->d->hold.margin > 0)
    vs_text_add(text, "each margin is what is left beyond hold.margin, %.3g %% of the limit\n",
                100 * a->d->hold.margin);
  vs_text_add(text, "\n%-20s  %-22s  %-3s  %-7s  %-18s  %-22s  %s\n", "choice", "part", "no.",
              "each", "least margin", "whose", "under");
  const vs_design_mark *all = &a->least[a->d->n_choices];
  bool told = all->run == UINT64_MAX;
  for (size_t c = 0; c < a->d->n_choices; c++) {
    add_choice_row(a, c, text);
    told = told || (a->least[c].run == all->run && a->least[c].line == all->line);
  }
  if (told) return;
  vs_text_add(text, "%-58s  ", "of all lines, also of other parts and of ratings");
  add_mark(a, all, text);
}

/* What came nearest as the budget was spent, and what stands against it. */
static void add_nearest(const answer *a, vs_text *text) {
  const vs_design_candidate *c = a->best;
  vs_text_add(
      text,
      "none is known to hold; the nearest so far: %s = %.6g, where nothing below %.6g holds "
      "(%llu candidates, %llu runs)\n",
      a->d->aim->text, c->price, vs_design_search_bound(&a->s),
      (unsigned long long)a->d->n_candidates, (unsigned long long)a->results->count);
  add_choices(a, text);
  vs_text_add(text, "\nagainst it: it");
  if (c->state == VS_DESIGN_KILLED)
    add_violation(a, &c->killer, text);
  else if (c->doubtful)
    add_doubt(a, c, text);
  else
    vs_text_add(text, " held %llu run%s, and was not run to its end, as the budget is spent\n",
                (unsigned long long)c->runs, c->runs == 1 ? "" : "s");
  vs_text_add(text, "\n");
}

static void add_page(answer *a, vs_text *text) {
  const vs_design_search *s = &a->s;
  if (!s->answer) {
    vs_text killers = {0};
    if (a->best) add_nearest(a, text);
    add_killers(a, &killers);
    if (killers.length) vs_text_add(text, "%s", killers.text);
    vs_text_free(&killers);
    return;
  }
  vs_text_add(text, "%s: %s = %.6g of %llu candidates, after %llu runs",
              s->proved ? "cheapest that holds" : "best so far", a->d->aim->text, s->answer->price,
              (unsigned long long)a->d->n_candidates, (unsigned long long)a->results->count);
  if (s->proved)
    vs_text_add(text, "\n");
  else
    vs_text_add(text, "; nothing below %.6g holds, and it is not proved that this one does\n",
                vs_design_search_bound(s));
  add_choices(a, text);
  if (s->proved && a->d->neighbours) add_around(a, text);
  vs_text_add(text, "\nproof\n");
  for (int k = 0; k < PROOF; k++) {
    vs_text_add(text, "%d. ", k + 1);
    SENTENCES[k](a, text);
    vs_text_add(text, "\n");
  }
}

static void add_unjudged(const answer *a, vs_text *text) {
  const vs_design_search *s = &a->s;
  const double price = s->answer ? s->answer->price : INFINITY;
  for (size_t k = 0; k < s->n_seen; k++) {
    const vs_design_candidate *c = s->seen[k];
    if (c->state != VS_DESIGN_UNJUDGED || !(c->price < price)) continue;
    vs_design_choices_write(a->d, a->plan, c->number, text);
    vs_text_add(text, ", for %.6g,", c->price);
    add_doubt(a, c, text);
  }
}

/* ---- how it ended ---- */

static vs_status end_design(const answer *a, vs_error *err) {
  const vs_design_search *s = &a->s;
  if (a->unjudged && (s->proved || s->looked_at_all))
    return vs_fail(err, VS_RUN,
                   "%zu %scandidate%s could not be judged; %s, and nothing holds below %.6g",
                   a->unjudged, s->answer ? "cheaper " : "", a->unjudged > 1 ? "s" : "",
                   s->answer ? "one of them may hold for less" : "no other one holds",
                   vs_design_search_bound(s));
  if (s->proved) return VS_OK;
  if (s->looked_at_all)
    return vs_fail(
        err, VS_RATING,
        "nothing in the catalogue holds: all %llu candidates, up to %.6g, violate a case",
        (unsigned long long)a->d->n_candidates, vs_design_choices_dearest(a->d));
  char but[64] = "";
  if (a->unjudged) snprintf(but, sizeof but, "; %zu could not be judged", a->unjudged);
  return vs_fail(err, VS_BUDGET,
                 "budget.runs = %llu is spent: nothing below %.6g holds%s%s; a larger budget, "
                 "in another folder, would look further",
                 (unsigned long long)a->d->most_runs, vs_design_search_bound(s),
                 s->answer ? ", and the best so far is not proved" : "", but);
}

vs_status vs_design_answer_publish(const vs_plan *plan, const vs_plan_stage *stage,
                                   const vs_results *results, const char *folder, bool quiet,
                                   vs_error *err) {
  answer *a = vs_alloc(1, sizeof *a);
  vs_text text = {0};
  *a = (answer){.plan = plan, .d = stage->state, .results = results, .folder = folder};
  vs_design_search_run(&a->s, a->d, plan, results, NULL);
  a->best = a->s.answer ? a->s.answer : vs_design_search_nearest(&a->s);
  find_margins(a);
  count_cheaper(a);
  vs_error why = {0};
  const vs_status ended = end_design(a, &why);
  add_page(a, &text);
  add_unjudged(a, &text);
  const size_t printed = text.length; /* the last sentence is printed as an error */
  if (ended) vs_text_add(&text, "%s%s\n", printed ? "\n" : "", why.text);
  vs_status status = folder ? write_files(a, ended, &text, err) : VS_OK;
  if (text.text) text.text[text.length = printed] = '\0';
  if (!status && !quiet) {
    fputs(text.text ? text.text : "", stdout);
    if (folder)
      printf("\nwritten: design.txt, design.json, design.csv, bom.csv, cases/ in %s\n", folder);
  }
  if (!status && ended) *err = why;
  vs_text_free(&text);
  free(a->scene);
  vs_design_search_free(&a->s);
  free(a);
  return status ? status : ended;
}
