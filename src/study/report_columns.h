/* SPDX-License-Identifier: GPL-3.0-or-later
 * The columns that a study's table has behind its axes: which measures are reported, with their
 * units and ratings. */
#pragma once

#include "study/plan.h"

/* Returns the index of that measure among the columns (VS_COLUMN_MARGIN for margin_least), and adds
 * it when nobody asked for it before. Whether there is such a measure is found out later; an error
 * then stands at `where`. */
int vs_report_columns_add(vs_plan *plan, const char *measure, vs_where where);

/* Adds the columns of these derivatives, for each measure and key d ln|measure|/d ln key and its
 * error. The order must last as long as the plan. Error: there is no room for them. */
vs_status vs_report_columns_derive(vs_plan *plan, const vs_sensitivity_order *order, vs_where where,
                                   vs_error *err);

/* Reads the key `report`: adds the columns it names or, where there is no such key, those of every
 * run or every orbit. Errors: it names something else than measures, or too many; a check carries
 * on. */
vs_status vs_report_columns_read(vs_plan *plan, vs_error *err);

/* Gives the columns the units and ratings that the scene has on that tier. Error: a measure that
 * the scene does not have there, with the place that asked for it. */
vs_status vs_report_columns_resolve(vs_plan *plan, const vs_scene *scene, const vs_tier *tier,
                                    vs_error *err);

/* Adds the numbers of all lines that the scene's verdict may have (vs_listed_line_at), as far as
 * they are no columns yet. Errors: there is no room for them; a device has the name of such a
 * number. */
vs_status vs_report_columns_add_lines(vs_plan *plan, const vs_scene *scene, vs_error *err);
