/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command line of what looks at files and tables before a run: options, words and what they
 * call. */
#ifndef VS_CLI_LOOKS_H
#define VS_CLI_LOOKS_H

#include "command.h"

extern const vs_command vs_looks_check, vs_looks_list, vs_looks_new, vs_looks_schema,
    vs_looks_modes;

#endif
