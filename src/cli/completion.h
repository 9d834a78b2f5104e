/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `completion`: what a shell needs to complete commands and their options. */
#ifndef VS_CLI_COMPLETION_H
#define VS_CLI_COMPLETION_H

#include "command.h"

/* Prints the script for that shell, bash or fish, from the table of commands. Error: there is no
 * such shell. */
vs_status vs_completion_print(const char *shell, const vs_command *const *commands, size_t count,
                              vs_error *err);

#endif
