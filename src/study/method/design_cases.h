/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a design has to hold: a list of cases, which are points of operation and those of the
 * study's threats, and random draws behind them. */
#pragma once

#include "study/plan.h"

typedef struct vs_design_cases {
  const vs_node *points; /* the map `operation`; NULL: the scene as it is */
  size_t n_points;
  size_t axis;                  /* of the point of operation, where there are some */
  const vs_scene *scene;        /* over which they are laid; borrowed */
  const vs_plan_stage *threats; /* NULL: the study has none */
  uint64_t count;               /* of the list; numbers from here on are draws */
  bool ranged;                  /* draws come to something that the list does not have */
} vs_design_cases;

/* Reads the cases, and adds the axis of the points of operation. Errors, with their place. */
vs_status vs_design_cases_read(vs_plan *plan, vs_design_cases *cases, vs_error *err);
/* Counts them, once the threats are read. */
void vs_design_cases_count(const vs_plan *plan, vs_design_cases *cases);

/* Writes the numbers of a case into the point, on its own axes. */
void vs_design_cases_point(const vs_plan *plan, const vs_design_cases *cases, uint64_t number,
                           double *point);
/* Called once all axes are there. Error: a point says a key that is chosen, or spread: a row would
 * not have been run with what its columns say. */
vs_status vs_design_cases_check(const vs_plan *plan, const vs_design_cases *cases, vs_error *err);

/* Puts the point's operation into a scene's tree, which may have another's. */
void vs_design_cases_put(const vs_plan *plan, const vs_design_cases *cases, const double *point,
                         vs_tree *tree);

/* Writes the case of that point as people say it: "surge: angle 41.2 deg, level 1 kV". */
void vs_design_cases_write(const vs_plan *plan, const vs_design_cases *cases, const double *point,
                           vs_text *text);
extern const vs_inside vs_design_cases_operation;
