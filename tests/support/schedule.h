/* SPDX-License-Identifier: GPL-3.0-or-later
 * A scene's mains, gate and events without the rest of it. */
#pragma once

#include "engine/events.h"
#include "program.h"

/* Reads the timeline of a scene's text, with its events in a run of 2 s. The text must be good. */
vs_timeline schedule(const char *scene);
