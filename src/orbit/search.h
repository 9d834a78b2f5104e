/* SPDX-License-Identifier: GPL-3.0-or-later
 * A search for the orbit of a scene on tier circuit (orbit/picard.h): the prelude of one run. What
 * picard.c and pairs.c both work on stands here. */
#ifndef VS_ORBIT_SEARCH_H
#define VS_ORBIT_SEARCH_H

#include "orbit/shooting.h"
#include "engine/budget.h"
#include "copies.h"
#include "corrections.h"
#include "creep.h"

/* The longest period that the machine is asked for where it is left to itself. */
enum { VS_SEARCH_LONGEST = 6 };

/* What a pass is for: */
typedef enum vs_search_pass {
  VS_SEARCH_STEERED, /* Newton's step behind it, with the Phi there is */
  VS_SEARCH_FREE,    /* none: the machine is left to itself */
  VS_SEARCH_FIRST,   /* the first of a pair, from which the circuit's own Phi comes, */
  VS_SEARCH_SECOND   /* and the second of it */
} vs_search_pass;

typedef struct vs_search {
  const vs_setup *setup;
  vs_orbit *orbit;   /* where the search begins, and the Phi in use; the pilot's */
  bool guessed;      /* it is one of tier switched, or of a scene that is nearly the same */
  bool own_phi;      /* the Phi in use is the circuit's own */
  vs_budget *budget; /* what the search may take; borrowed */
  int of_mains;      /* cycles of the mains in a firing period */
  double *next;      /* the machine's state where the next firing period begins; the pilot's */
  int count;         /* of the states */
  int passed;        /* firing periods of the present pass, which has orbit->n of them */
  int cycles;        /* in all */
  double x[VS_MOST_STATES];                       /* where the present pass began */
  double inverse[VS_MOST_STATES][VS_MOST_STATES]; /* (I - Phi)^-1 */
  double peak[VS_MOST_STATES + 1],
      scale[VS_MOST_STATES + 1]; /* largest sizes of the states, and of lambda: in this pass; in the
                                    last one */
  double (
      *between)[VS_MOST_STATES]; /* the states at the ends of the pass's firing periods; owned */
  vs_corrections corrections;
  vs_copies copies;
  vs_creep creep;
  vs_search_pass pass;
  int steered;                          /* passes that were steered */
  int left;                             /* so many passes more the machine is left to itself */
  bool marched;                         /* it was for long */
  int pairs;                            /* since it was last */
  double pair[2][VS_MOST_STATES];       /* where the last pair's passes ended */
  double past_m[2 * VS_SEARCH_LONGEST]; /* the travel where the last firing periods ended */
  double travel_m;                      /* the largest size of the travel so far */
} vs_search;

/* Begins, where orbit, guessed, own_phi, budget, of_mains, next and between are set, with orbit->x
 * and orbit's Phi. */
void vs_search_begin(vs_search *search, const vs_setup *setup);

/* Sets the scales from the peaks of the pass that has ended. */
void vs_search_scale(vs_search *search);

/* Sets `inverse` from the Phi in use. Returns false where there is none. */
bool vs_search_invert(vs_search *search);

/* Counts so many passes on the budget: those of this process, or of copies. Error: VS_RUN, it has
 * none left. */
vs_status vs_search_take(vs_search *search, int passes, vs_error *err);

/* Where the machine is to go on from. */
void vs_search_go_on(vs_search *search, const double *x);

#endif
