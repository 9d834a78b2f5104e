/* SPDX-License-Identifier: GPL-3.0-or-later
 * A scene's mains, gate and events without the rest of it. */
#ifndef VS_TESTS_SCHEDULE_H
#define VS_TESTS_SCHEDULE_H

#include "engine/events.h"
#include "program.h"

/* Reads the timeline of a scene's text, with its events in a run of 2 s. The text must be good. */
vs_timeline schedule(const char *scene);

#endif
