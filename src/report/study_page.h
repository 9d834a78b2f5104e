/* SPDX-License-Identifier: GPL-3.0-or-later
 * A study's report as one page of HTML. */
#ifndef VS_REPORT_STUDY_PAGE_H
#define VS_REPORT_STUDY_PAGE_H

#include "plot/study_pictures.h"
#include "report/html.h"

/* Adds the page. svg: one text for each picture of the album. */
void vs_study_page_write(const vs_folder *table, const vs_study_results *survey,
                         const vs_study_pictures *album, char *const *svg, vs_html *html);

/* Gives the ends of the interval in which the true share lies with 95 % when `good` of `n` drawn at
 * random were good: Wilson's score interval (J. American Statistical Association, 1927). For tests.
 */
void vs_study_page_wilson(double good, double n, double *least, double *largest);

/* Returns the share in per cent, cut to two places, so that 100 means all. For tests. */
double vs_study_page_share(long part, long whole);

#endif
