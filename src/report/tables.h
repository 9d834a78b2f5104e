/* SPDX-License-Identifier: GPL-3.0-or-later
 * The tables of a study's report, as HTML. */
#ifndef VS_REPORT_TABLES_H
#define VS_REPORT_TABLES_H

#include "report/html.h"
#include "study/survey.h"

/* The worst cases, or the first ones where nothing ranks them. */
void vs_tables_cases(vs_html *html, const vs_folder *table, const vs_survey *survey);
/* What was varied. */
void vs_tables_axes(vs_html *html, const vs_folder *table, const vs_survey *survey);
/* What is reported. */
void vs_tables_columns(vs_html *html, const vs_folder *table, const vs_survey *survey);
/* All else that the manifest says: scene, fixed keys, versions, seed, hashes of the inputs. */
void vs_tables_manifest(vs_html *html, const vs_folder *table);

#endif
