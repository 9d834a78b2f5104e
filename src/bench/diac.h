/* SPDX-License-Identifier: GPL-3.0-or-later
 * What blocks either way up to a voltage and then breaks over: a diac, a sidac, a thyristor for
 * surges. */
#pragma once

#include "test_circuit.h"

/* For the bench of a diode that is not what is asked: where the part breaks over both ways,
 * figures->shows says so, and which kind it is. */
void vs_diac_suspect(const vs_stand *stand, vs_figures *figures);
