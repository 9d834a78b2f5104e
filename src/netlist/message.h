/* SPDX-License-Identifier: GPL-3.0-or-later
 * The words in which ngspice complains: the names that stand in them, and what would be right. */
#ifndef VS_NETLIST_MESSAGE_H
#define VS_NETLIST_MESSAGE_H

#include <stdbool.h>
#include <stddef.h>

/* What stands between `open` and the next `close`, and its length; NULL: nothing does. */
const char *vs_message_between(const char *message, const char *open, char close, size_t *length);

/* The name of the parameter that is not defined; NULL: the message is of something else. */
const char *vs_message_parameter(const char *message, size_t *length);

/* The name of the model that is not there; NULL: the message is of something else. */
const char *vs_message_model(const char *message, size_t *length);

/* The name of the function whose argument is out of its range, up to the next blank; NULL: the
 * message is of something else. */
const char *vs_message_function(const char *message);

/* True where that function is a power, x^y, however it is written. */
bool vs_message_is_of_power(const char *message);

/* Goes behind the path in an element's name, as ngspice gives it to one within a subcircuit: to
 * "bk" in "b.xs.bk". */
const char *vs_message_behind_path(const char *name);

/* What would be right, with "; " before it; empty where the complaint says so itself. */
const char *vs_message_remedy(const char *message);

#endif
