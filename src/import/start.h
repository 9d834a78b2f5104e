/* SPDX-License-Identifier: GPL-3.0-or-later
 * How a netlist's run begins. A .tran without uic begins at the operating point. A run of this
 * program begins with every capacitor and inductor at 0 that has no IC=. */
#ifndef VS_IMPORT_START_H
#define VS_IMPORT_START_H

#include "import/roles.h"

typedef struct vs_start {
  const vs_card *tran; /* the .tran that begins at an operating point; NULL: there is none, or it
                          makes no difference */
  vs_text source;      /* the name of the first source that is not 0 at t = 0 */
  vs_text stores;      /* names of capacitors and inductors without an initial value */
} vs_start;

/* Looks at capacitors and inductors outside of subcircuits, but not at the coil, and at sources
 * there and in subcircuits that the netlist defines and uses. End with vs_start_free. */
void vs_start_find(const vs_elements *wiring, const vs_values *values, const vs_roles *roles,
                   vs_start *start);
void vs_start_free(vs_start *start);

#endif
