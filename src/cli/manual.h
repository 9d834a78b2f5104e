/* SPDX-License-Identifier: GPL-3.0-or-later
 * The manual page, made from the table of commands. */
#ifndef VS_CLI_MANUAL_H
#define VS_CLI_MANUAL_H

#include "command.h"

/* Prints vibrospice(1) as a source of man(7) on standard output. */
void vs_manual_print(const vs_command *const *commands, size_t count);

#endif
