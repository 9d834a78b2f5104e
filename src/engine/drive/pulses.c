/* SPDX-License-Identifier: GPL-3.0-or-later
 * Kinds of events at the gate: a pulse that is missing, short, weak, or one too many. */
#include "engine/scene_event.h"

#include <math.h>

#define GATE                                                                                       \
  {                                                                                                \
    "gate", VS_NAME, "", "all", 0, 0, false, VS_EVENT_V_(gate),                                    \
        "the port it acts on: all, gate, gate+180deg", NULL, NULL                                  \
  }

static const vs_field MISSING_PULSE[] = {VS_EVENT_KIND, VS_EVENT_CYCLE, GATE};
static const vs_field SHORT_PULSE[] = {VS_EVENT_KIND, VS_EVENT_CYCLE, VS_EVENT_DURATION("0.1 ms"),
                                       GATE};
static const vs_field WEAK_PULSE[] = {VS_EVENT_KIND, VS_EVENT_CYCLE,
                                      VS_EVENT_FRACTION("level", "20 %", 0, 100, "of its voltage"),
                                      GATE};
static const vs_field SPURIOUS_PULSE[] = {VS_EVENT_KIND, VS_EVENT_AT, VS_EVENT_DURATION("0.1 ms"),
                                          GATE};

static void missing(const vs_scene_event *e, double *width_s, double *voltage) {
  (void)e;
  *width_s = *voltage = 0;
}

static void shorter(const vs_scene_event *e, double *width_s, double *voltage) {
  (void)voltage;
  *width_s = fmin(*width_s, e->v.duration_s);
}

static void weaker(const vs_scene_event *e, double *width_s, double *voltage) {
  (void)width_s;
  *voltage *= e->v.fraction;
}

const vs_event_kind vs_pulses[] = {
    {"missing_pulse", "no gate pulse in that cycle", VS_EVENT_KEYS(MISSING_PULSE), .at_cycle = true,
     .ideal = true, .pulse = missing},
    {"short_pulse", "a shorter gate pulse in that cycle", VS_EVENT_KEYS(SHORT_PULSE),
     .at_cycle = true, .ideal = true, .pulse = shorter},
    {"weak_pulse", "a weaker gate pulse in that cycle", VS_EVENT_KEYS(WEAK_PULSE), .at_cycle = true,
     .pulse = weaker},
    {"spurious_pulse", "one more gate pulse", VS_EVENT_KEYS(SPURIOUS_PULSE), .ideal = true,
     .adds_pulse = true, .edge = vs_scene_event_edge},
    {.name = NULL}};
