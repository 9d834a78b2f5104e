/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a complaint of ngspice's speaks of, looked for in one line of the netlist. Each function
 * returns where it begins in the line; NULL: it is not in this line. */
#ifndef VS_NETLIST_SUBJECT_H
#define VS_NETLIST_SUBJECT_H

#include <stdbool.h>

/* The parameter that is not defined, the expression that cannot be read, the element or the word
 * that is named. */
const char *vs_subject_find(const char *line, const char *message);

/* The node that is named: "check node b", "trouble with node "xa.b"", of which the last part is
 * looked for in lines of elements. */
const char *vs_subject_node(const char *line, const char *message);

/* The function whose argument was out of its range. */
const char *vs_subject_function(const char *line, const char *message);

/* True where the message quotes that line of an element, all of it. */
bool vs_subject_is_quoted(const char *line, const char *message);

#endif
