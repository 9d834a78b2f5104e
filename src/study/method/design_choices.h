/* SPDX-License-Identifier: GPL-3.0-or-later
 * The search of `design`: which parts hold all cases for the least money. A candidate is a choice
 * of an option for each key under `choose`; a case is a point of `operation` or a threat
 * (method/design_cases.h). */
#pragma once

#include "method/design_cases.h"
#include "study/hold.h"
#include "study/plan.h"
#include "study/price_list.h"

enum { VS_DESIGN_CHOICES = 16, VS_DESIGN_LIMITS = 8, VS_DESIGN_DEVICES = 8, VS_DESIGN_KINDS = 8 };

/* The row of an option that is nothing. */
#define VS_DESIGN_NONE SIZE_MAX

/* A row of the list of prices that an option may be bought as. Rows of one option differ only in
 * what they bear and cost. */
typedef struct vs_design_class {
  size_t row;
  double price;                   /* what is to be least, of one of them */
  double limit[VS_DESIGN_LIMITS]; /* SI; NaN: the row says nothing */
} vs_design_class;

/* A part by name, or a value. */
typedef struct vs_design_option {
  double number;            /* of the axis */
  vs_design_class *classes; /* [n_classes], the cheapest first; owned */
  size_t n_classes;
} vs_design_option;

/* A key under `choose`. Keys that are to be the same (same_as) have one leader, which has the
 * options of all of them. */
typedef struct vs_design_choice {
  const vs_node *node;
  const char *device;                          /* what the key ends in: "r1" of circuit.r1 */
  const struct vs_kind *kind[VS_DESIGN_KINDS]; /* [n_kinds]; of a value the only one */
  size_t n_kinds;
  size_t axis, leader;      /* leader: its own number where it leads */
  size_t tolerance;         /* the axis of its spread, from 1; 0: there is none */
  int number;               /* how many of it are bought */
  vs_design_option *option; /* [n_options]: values rise, parts by name get dearer; owned */
  size_t n_options;
  /* `or: none`: the number of that option, and the devices that it leaves out, each with the 0 V
   * source in series that is opened then. */
  bool may_lack;
  double lacking;
  char lacked[VS_DESIGN_DEVICES][VS_DECK_NAME], source[VS_DESIGN_DEVICES][VS_DECK_NAME];
  size_t n_lacked;
  /* The limits that the list of prices has columns for, with the study's columns of what this
   * choice's device bears, and the lines that these are held as. */
  size_t n_limits;
  const struct vs_device_measure *measure[VS_DESIGN_LIMITS];
  size_t limit_column[VS_DESIGN_LIMITS]; /* of the list */
  int column[VS_DESIGN_LIMITS];          /* of the plan */
  size_t line[VS_DESIGN_LIMITS];         /* of hold */
} vs_design_choice;

typedef struct vs_design {
  vs_price_list list;
  const vs_node *aim; /* the formula */
  vs_node usual_aim;  /* where the study has none */
  vs_design_choice choice[VS_DESIGN_CHOICES];
  size_t n_choices;
  vs_design_cases cases;
  vs_hold hold;
  char (*line_name)[VS_JUDGED_NAME + 8]; /* of hold's lines; owned */
  int *margin; /* of each line of hold the plan's column of its margin, its error behind it; -1: it
                  is a limit of the list of prices alone; owned */
  const vs_node *waived; /* the list `waive`, which is printed; NULL: there is none */
  uint64_t width;        /* how many cases are asked for at a time */
  uint64_t most_runs;    /* of the budget */
  uint64_t random;       /* how many draws prove the answer */
  uint64_t searched,
      restarts; /* the worst of each threat is searched for by so many runs; 0: not */
  bool neighbours;
  bool verify;        /* the answer's margins get their errors, which the scene does not ask for */
  size_t verify_axis; /* then: of run.verify, 0 as the scene has it, 1 always */
  uint64_t *order;    /* [n_candidates], the cheapest first; owned */
  uint64_t n_candidates;
} vs_design;

/* ---- candidates ---- */

/* The option of a choice that candidate number k has. */
size_t vs_design_choices_option(const vs_design *d, uint64_t k, size_t choice);
/* The number of the candidate that has another option there. */
uint64_t vs_design_choices_with(const vs_design *d, uint64_t k, size_t choice, size_t option);
/* What it costs with these classes of its options, class[n_choices]; NULL: the cheapest ones. */
double vs_design_choices_price(const vs_design *d, uint64_t k, const size_t *class);
/* What the dearest bill costs that the choices allow. */
double vs_design_choices_dearest(const vs_design *d);
/* Writes the option of that choice: "330 ohm". */
void vs_design_choices_write_option(const vs_design *d, const vs_plan *plan, uint64_t k,
                                    size_t choice, vs_text *text);
/* Writes "TYN1212, s20k510, 330 ohm, 47 nF". */
void vs_design_choices_write(const vs_design *d, const vs_plan *plan, uint64_t k, vs_text *text);

/* True if the verdict's line is of a device that is made of the choice: its name is what the key
 * ends in, or its part's is. */
bool vs_design_choices_makes_line(const vs_design_choice *choice, const vs_deck *deck,
                                  const char *line);
/* The part's name in the list of prices, or "none". */
const char *vs_design_choices_part(const vs_design *d, const vs_design_class *class);
/* True if the point leaves the device out that the verdict's line is of. */
bool vs_design_choices_lacks(const vs_design *d, const double *point, const char *line);
/* Takes what leaves a part out from a tree that may have another point. */
void vs_design_choices_put_back(const vs_design *d, const vs_plan *plan, vs_tree *tree);
/* Puts the option of that choice into the tree. */
void vs_design_choices_put(const vs_design *d, const vs_plan *plan, size_t choice,
                           const double *point, vs_tree *tree);

/* ---- reading ---- */

/* Reads the choices under `choose`, each with its axis, its options and their prices. Errors, with
 * their place: nothing to choose from, a part or a column that the list has not. */
vs_status vs_design_choices_read(vs_plan *plan, vs_design *d, const vs_node *section,
                                 vs_error *err);
/* Orders the candidates, once the choices are read. Error: they are too many. */
vs_status vs_design_choices_rank(const vs_node *section, vs_design *d, vs_error *err);
extern const vs_inside vs_design_choices_keys; /* of `choose` */
