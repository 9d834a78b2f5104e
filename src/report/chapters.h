/* SPDX-License-Identifier: GPL-3.0-or-later
 * Sections of a run's page that are made of its summary.json alone. */
#ifndef VS_REPORT_CHAPTERS_H
#define VS_REPORT_CHAPTERS_H

#include "report/html.h"
#include "base/tree.h"

/* Adds all that stands before the first section, up to and with the title. */
void vs_chapter_head(vs_html *html, const char *folder, const vs_node *summary, double until_s);
/* Adds the verdict: the word of the whole, what is weakest, all lines. */
void vs_chapter_verdict(vs_html *html, const vs_node *summary);
void vs_chapter_measures(vs_html *html, const vs_node *summary);
/* Adds every effective key of the scene. */
void vs_chapter_parameters(vs_html *html, const vs_node *summary);

#endif
