/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command line of what looks at results: options, words and what they call. */
#ifndef VS_CLI_SIGHTS_H
#define VS_CLI_SIGHTS_H

#include "command.h"

extern const vs_command vs_sights_plot, vs_sights_compare, vs_sights_validate;

#endif
