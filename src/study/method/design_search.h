/* SPDX-License-Identifier: GPL-3.0-or-later
 * The cheapest candidate that holds every case. The search is a pure function of the results so far
 * and goes through them from the first each time, so a resumed study has the same answer.
 *
 * The cheapest candidate that is not rejected is run next, beginning with the case that was the
 * last to reject another one. No candidate is skipped because of how another one ended: margins are
 * not monotonic in a part's size. A candidate that holds the list is searched for its worst case
 * within the ranges of each threat (method/search.h), and shown random draws; a case that it does
 * not hold is added to the list for all. After the answer its neighbours are run, to be reported.
 */
#pragma once

#include "method/design_choices.h"

/* How a candidate stands. */
typedef enum vs_design_state {
  VS_DESIGN_OPEN,     /* it was not run with all cases, or something cheaper came between */
  VS_DESIGN_KILLED,   /* it violates `killer` */
  VS_DESIGN_UNJUDGED, /* a case of it failed or is undecided, and none is violated */
  VS_DESIGN_HOLDS
} vs_design_state;

/* A case of a candidate that decides: which, its run, and the line that it comes to. */
typedef struct vs_design_mark {
  uint64_t number, run;
  size_t line; /* of hold; SIZE_MAX: what happened, or a run that failed */
  double margin, error;
} vs_design_mark;

typedef struct vs_design_candidate {
  uint64_t number, rank;
  vs_design_state state;
  bool held;                       /* it was run with all cases, and held them */
  bool verified;                   /* and with the errors of its margins */
  bool doubtful;                   /* a case of it failed or is undecided; `killer` is the first */
  double price;                    /* with the classes that its runs so far ask for */
  size_t class[VS_DESIGN_CHOICES]; /* of the leaders */
  double worst[VS_DESIGN_CHOICES][VS_DESIGN_LIMITS]; /* what each choice's device bore, SI */
  vs_design_mark worst_at[VS_DESIGN_CHOICES][VS_DESIGN_LIMITS];
  uint64_t *run; /* of each case of the search's list its run + 1; 0: none yet; owned */
  size_t room;
  uint64_t runs;         /* how many it took */
  vs_design_mark killer; /* of one that is killed or unjudged */
} vs_design_candidate;

/* What the search within the ranges of a threat found. */
typedef struct vs_design_worst {
  uint64_t n;
  size_t restarts, place, near; /* see vs_search_agree */
  vs_design_mark mark;          /* run UINT64_MAX: no run has a margin */
} vs_design_worst;

/* A neighbour of the answer: another option of one choice, or a lower class of the same. */
typedef struct vs_design_neighbour {
  size_t choice;
  const vs_design_candidate *candidate;
  const vs_design_class *below; /* NULL: it is another option */
  double price;
  bool killed; /* by the killer */
  vs_design_mark killer;
} vs_design_neighbour;

typedef struct vs_design_search {
  const vs_design *d;
  const vs_plan *plan;
  const vs_results *results;
  vs_generation *generation;  /* where cases are asked for; NULL: none are */
  uint64_t used;              /* how many of the results were taken */
  bool waits;                 /* for cases that were asked for */
  bool spent;                 /* the budget is */
  bool looked_at_all;         /* no candidate is left */
  vs_design_candidate **seen; /* [n_seen], in the order in which they were begun; owned */
  size_t n_seen;
  uint64_t next_rank; /* the first of d->order that is not seen */
  /* The cases that all candidates have to hold: numbers of d->cases; when each last rejected one,
   * made it dearer or left it unjudged, 0: never. */
  uint64_t *list, *killed_at, kills;
  size_t n_list;
  vs_design_candidate *answer, *runner_up; /* NULL: there is none */
  bool proved;                             /* no draw broke the answer */
  uint64_t draws, draws_held;              /* how many were asked for in all; of the last round */
  vs_design_mark *shown; /* [n_shown]: searched and drawn cases that the answer held; owned */
  size_t n_shown;
  double *found; /* [n_found][axes of the threats]: all points that were searched; owned */
  size_t n_found;
  vs_design_worst *worst; /* [n_worst], a threat each, of the last round; owned */
  size_t n_worst;
  vs_design_neighbour neighbour[2 * VS_DESIGN_CHOICES];
  size_t n_neighbours;
  uint64_t weakest_run; /* of the answer */
} vs_design_search;

/* Goes through the results, and asks for what comes next. vs_design_search_free. */
void vs_design_search_run(vs_design_search *search, const vs_design *design, const vs_plan *plan,
                          const vs_results *results, vs_generation *generation);
void vs_design_search_free(vs_design_search *search);

/* What the run of that index comes to under the design's hold, whatever its classes. */
vs_hold_row vs_design_search_judge(const vs_design_search *search, uint64_t run);

/* Writes the numbers of a case, on its own axes, whether it is listed, drawn or searched for. */
void vs_design_search_point(const vs_design_search *search, uint64_t number, double *point);
/* How the case came up: "list", "search" or "draw". */
const char *vs_design_search_found_by(const vs_design_search *search, uint64_t number);

/* The price below which nothing holds: the least of what is not rejected, be it judged or not. */
double vs_design_search_bound(const vs_design_search *search);

/* Where the budget was spent without an answer the candidate that came nearest to one; NULL: all
 * were looked at, or none was begun. */
const vs_design_candidate *vs_design_search_nearest(const vs_design_search *search);

/* Takes a mark with a weaker margin than `least`, of which run UINT64_MAX: there is none yet. */
void vs_design_search_least(vs_design_mark *least, vs_design_mark mark);
