/* SPDX-License-Identifier: GPL-3.0-or-later
 * A study's report as one page of HTML. */
#pragma once

#include "plot/study_pictures.h"
#include "report/html.h"

/* Adds the page. svg: the text of each picture. */
void vs_study_page_write(const vs_folder *table, const vs_study_results *survey,
                         const vs_study_pictures *album, char *const *svg, vs_html *html);

/* Gives the ends of the 95 % interval of the true share if `good` of `n` random draws were good:
 * Wilson's score interval (J. American Statistical Association, 1927). For tests. */
void vs_study_page_wilson(double good, double n, double *least, double *largest);

/* Returns the share in per cent, rounded down to two decimals so that 100 means all. For tests. */
double vs_study_page_share(long part, long whole);
