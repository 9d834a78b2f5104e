/* SPDX-License-Identifier: GPL-3.0-or-later
 * The course over time of a V or I source: pulse, sin, pwl, as ngspice has them (its manual,
 * section 4.1), with the parameters given that it would else take from its analysis. */
#pragma once

#include "parameters.h"

/* Begins as zeros: it is no course. */
typedef struct vs_course {
  const struct vs_course_kind *kind;
  double *value; /* what stands behind the word; owned */
  int count;
} vs_course;

/* Is there such a course? */
bool vs_course_is(vs_word word);
/* Reads the words of the card from that course's on. vs_course_free is due also after an error. */
vs_status vs_course_read(const vs_cards *cards, vs_parameters *in, const vs_netlist_card *card,
                         size_t first, vs_course *course, vs_error *err);
void vs_course_free(vs_course *course);

/* V or A at t_s; and the first instant behind it at which the course has a corner, s. INFINITY:
 * there is none. */
double vs_course_at(const vs_course *course, double t_s);
double vs_course_edge(const vs_course *course, double t_s);
/* How long a radian of its swing lasts, s; INFINITY: it has none. */
double vs_course_radian(const vs_course *course);
