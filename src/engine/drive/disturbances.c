/* SPDX-License-Identifier: GPL-3.0-or-later
 * Kinds of events that disturb the mains: sag, swell, interruption, notch, jump of phase,
 * harmonic. */
#include "engine/scene_event.h"

#include <math.h>

/* ---- sag, swell, interruption ---- */

static const vs_field SAG[] = {
    VS_EVENT_KIND, VS_EVENT_AT, VS_EVENT_DURATION("20 ms"),
    VS_EVENT_FRACTION("level", "40 %", 0, 100, "what is left of the voltage")};
static const vs_field SWELL[] = {VS_EVENT_KIND, VS_EVENT_AT, VS_EVENT_DURATION("20 ms"),
                                 VS_EVENT_FRACTION("level", "120 %", 100, 300, "what it becomes")};
static const vs_field INTERRUPTION[] = {VS_EVENT_KIND, VS_EVENT_AT, VS_EVENT_DURATION("20 ms")};

static double scaled(const vs_scene_event *e, double t_s, double angle_rad) {
  (void)angle_rad;
  return vs_scene_event_is_on(e, t_s) ? e->v.fraction : 1;
}

static double interrupted(const vs_scene_event *e, double t_s, double angle_rad) {
  (void)angle_rad;
  return vs_scene_event_is_on(e, t_s) ? 0 : 1;
}

/* ---- notch ---- */

static const vs_field NOTCH[] = {
    VS_EVENT_KIND,
    VS_EVENT_AT,
    VS_EVENT_DURATION("0.5 ms"),
    VS_EVENT_FRACTION("depth", "100 %", 0, 100, "what is gone of the voltage"),
    {"count", VS_COUNT, "", "1", 1, 1e6, false, VS_EVENT_V_(count),
     "in so many cycles, one after the other", NULL, NULL}};

static double notched(const vs_scene_event *e, double t_s, double angle_rad) {
  (void)angle_rad;
  /* the repetition that t is in or behind, from 0 */
  double n = fmin(fmax(ceil((t_s - e->start_s) / e->period_s) - 1, 0), e->v.count - 1);
  double since = t_s - e->start_s - n * e->period_s, slack = vs_scene_event_rounding(t_s);
  return since > slack && since <= e->v.duration_s + slack ? 1 - e->v.fraction : 1;
}

/* The edges of each repetition. The last one's end gives the period, so that the last edge is
 * exactly the event's end. */
static double notch_edge(const vs_scene_event *e, double t_s) {
  double period = (e->end_s - e->start_s - e->v.duration_s) / fmax(e->v.count - 1, 1), n = 0;
  if (e->v.count > 1) n = floor((t_s - e->start_s) / period + 1e-9); /* an edge reached is passed */
  n = fmin(fmax(n, 0), e->v.count - 1);
  double start = e->start_s + n * period, end = start + e->v.duration_s;
  if (t_s < e->start_s) return e->start_s;
  if (t_s < end) return end;
  return n + 1 < e->v.count ? start + period : INFINITY;
}

/* ---- jump of phase, harmonic ---- */

static const vs_field PHASE_JUMP[] = {VS_EVENT_KIND,
                                      VS_EVENT_AT,
                                      {"jump", VS_REAL, "deg", "30 deg", -180, 180, false,
                                       VS_EVENT_V_(phase_rad), "the mains go on so much earlier",
                                       NULL, NULL}};
static const vs_field HARMONIC[] = {
    VS_EVENT_KIND,
    VS_EVENT_AT,
    VS_EVENT_DURATION("1e8 ms"),
    VS_EVENT_FRACTION("level", "5 %", 0, 100, "of the fundamental's amplitude"),
    {"order", VS_COUNT, "", "5", 2, 100, false, VS_EVENT_V_(order), "times the mains' frequency",
     NULL, NULL},
    {"phase", VS_REAL, "deg", "0 deg", -360, 360, false, VS_EVENT_V_(phase_rad),
     "at the mains' rising zero crossing", NULL, NULL}};

static double jumped(const vs_scene_event *e, double t_s, double angle_rad) {
  (void)angle_rad;
  return vs_scene_event_is_on(e, t_s) ? e->v.phase_rad : 0;
}

static double distorted(const vs_scene_event *e, double t_s, double angle_rad) {
  return vs_scene_event_is_on(e, t_s) ? e->v.fraction * sin(e->v.order * angle_rad + e->v.phase_rad)
                                      : 0;
}

/* ---- the kinds ---- */

const vs_event_kind vs_disturbances[] = {
    {"sag", "the mains are lower for a while", VS_EVENT_KEYS(SAG), .ideal = true, .mains = scaled,
     .stage = VS_MAINS_FACTOR, .edge = vs_scene_event_edge},
    {"swell", "the mains are higher for a while", VS_EVENT_KEYS(SWELL), .ideal = true,
     .mains = scaled, .stage = VS_MAINS_FACTOR, .edge = vs_scene_event_edge},
    {"interruption", "the mains are 0 V for a while", VS_EVENT_KEYS(INTERRUPTION), .ideal = true,
     .mains = interrupted, .stage = VS_MAINS_FACTOR, .edge = vs_scene_event_edge},
    {"notch", "a part of the mains' voltage is gone for part of a cycle", VS_EVENT_KEYS(NOTCH),
     .ideal = true, .mains = notched, .stage = VS_MAINS_FACTOR, .edge = notch_edge},
    {"phase_jump", "the mains jump in phase; the gate's pulses stay where they were",
     VS_EVENT_KEYS(PHASE_JUMP), .ideal = true, .mains = jumped, .stage = VS_MAINS_ANGLE,
     .edge = vs_scene_event_edge},
    {"harmonic", "a harmonic on the mains", VS_EVENT_KEYS(HARMONIC), .ideal = true, .adds_up = true,
     .mains = distorted, .stage = VS_MAINS_ADDED, .edge = vs_scene_event_edge},
    {.name = NULL}};
