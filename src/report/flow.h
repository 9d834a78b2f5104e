/* SPDX-License-Identifier: GPL-3.0-or-later
 * Where the energy of a run went, as a table with bars. */
#ifndef VS_REPORT_FLOW_H
#define VS_REPORT_FLOW_H

#include "report/html.h"
#include "base/tree.h"

/* Adds the section. energy: that member of summary.json; NULL: nothing is added. */
void vs_flow_add(vs_html *html, const vs_node *energy);

#endif
