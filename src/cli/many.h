/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command line of studies and fits: options, words and what they call. */
#ifndef VS_CLI_MANY_H
#define VS_CLI_MANY_H

#include "command.h"

extern const vs_command vs_many_study, vs_many_merge, vs_many_fit;

#endif
