/* SPDX-License-Identifier: GPL-3.0-or-later
 * A law of the user's own as a shared object (vibrospice/law.h):
 *
 *   control: {law: object, file: ./mylaw.so}
 *
 * The object is loaded into a child process, which is asked once for each firing. */
#ifndef VS_CONTROL_OBJECT_H
#define VS_CONTROL_OBJECT_H

#include "control/regulator.h"

extern const vs_regulator vs_object_regulator;

#endif
