/* SPDX-License-Identifier: GPL-3.0-or-later
 * New names for the deck: for parameters, and for nodes and elements that are put between those of
 * the netlist. A new name differs from all names in the netlist. */
#ifndef VS_IMPORT_COINED_H
#define VS_IMPORT_COINED_H

#include "import/elements.h"

/* What has names already. Both are borrowed. */
typedef struct vs_coined {
  const vs_elements *wiring;
  const vs_values *values;
} vs_coined;

/* Makes the name FIRST KEY LAST. If it is taken, "_2", "_3", ... is appended. */
void vs_coined_name(const vs_coined *coined, const char *first, const char *key, const char *last,
                    char name[VS_ELEMENTS_NAME]);

/* Makes the stem for all names that replace a source: the source's key, or that with "_2", ...
 * appended, so that STEM_on, Egate_STEM and the like are free. */
void vs_coined_stem(const vs_coined *coined, const vs_element *source, char stem[VS_ELEMENTS_NAME]);

#endif
