/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `help TOPIC`: a section of a scene, a kind of things, how the program ends. */
#ifndef VS_CLI_TOPICS_H
#define VS_CLI_TOPICS_H

#include <stdbool.h>

#include "base/error.h"

/* Prints what there is to say of the topic: sections of a scene, the kinds of `list`, "scene",
 * "units", "exit". others: the program's commands, of which the caller tells; they are for the
 * message alone. Errors: there is no such topic, the nearest is named. */
vs_status vs_topics_print(const char *topic, const char *const *others, size_t n_others,
                          vs_error *err);

/* True if it is a section of a scene; a command may have that name, too. */
bool vs_topics_is_section(const char *topic);

/* Prints one line for each topic. */
void vs_topics_list(void);

#endif
