/* SPDX-License-Identifier: GPL-3.0-or-later
 * A study's report as one page of HTML. */
#ifndef VS_REPORT_PAGE_H
#define VS_REPORT_PAGE_H

#include "picture/album.h"

/* svg: one text for each picture of the album. */
void vs_page_write(const vs_folder *table, const vs_survey *survey, const vs_album *album,
                   char *const *svg, vs_text *html);

/* Its parts: the worst cases; what was varied; what is reported; all else the manifest says: scene,
 * fixed keys, versions, seed, hashes of the inputs. */
void vs_tables_cases(vs_text *html, const vs_folder *table, const vs_survey *survey);
void vs_tables_axes(vs_text *html, const vs_folder *table, const vs_survey *survey);
void vs_tables_columns(vs_text *html, const vs_folder *table, const vs_survey *survey);
void vs_tables_manifest(vs_text *html, const vs_folder *table);

/* Where the true share lies with 95 % when `good` of `n` drawn at random were good (Wilson's score
 * interval; J. American Statistical Association, 1927). */
void vs_page_wilson(double good, double n, double *least, double *largest);

/* Per cent, cut to two places, so that 100 means all. */
double vs_page_share(long part, long whole);

#endif
