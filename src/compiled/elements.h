/* SPDX-License-Identifier: GPL-3.0-or-later
 * The elements of a netlist, put into its equations. */
#pragma once

#include "equations.h"

/* Makes the equations of a job's netlist. Errors: VS_INPUT names the element that is not known
 * here. vs_equations_free is due also after an error. */
vs_status vs_elements_make(const vs_circuit_job *job, const vs_circuit_host *host, vs_equations *e,
                           vs_error *err);
