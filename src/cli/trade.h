/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command line of netlists and parts that come in and go out: options, words and what they
 * call. */
#ifndef VS_CLI_TRADE_H
#define VS_CLI_TRADE_H

#include "command.h"

extern const vs_command vs_trade_part, vs_trade_export, vs_trade_import;

#endif
