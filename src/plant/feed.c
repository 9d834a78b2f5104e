/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plant/feed.h"

#include <stddef.h>

#define S_(member) offsetof(vs_supply_values, member)
#define F_(member) offsetof(vs_firing_values, member)

static const vs_field SUPPLY[] = {
    {"kind", VS_CHOICE, "", "sine", 0, 0, false, S_(direct),
     "sine: the mains; step: direct voltage from t = 0 on, on ideal tiers and for decks with a "
     "port "
     "pwm",
     "sine|step", NULL},
    {"voltage", VS_REAL, "V", "440 V", 0, 1e6, true, S_(voltage_v),
     "U, of the mains, rms at the converter, or the direct voltage", NULL, NULL},
    {"frequency", VS_REAL, "Hz", "50 Hz", 0.1, 1e4, false, S_(frequency_hz), "f, of the mains",
     NULL, NULL},
    {"phase", VS_REAL, "deg", "0 deg", -360, 360, false, S_(phase_rad), "of the mains at t = 0",
     NULL, NULL},
    {"resistance", VS_REAL, "ohm", "0.5 ohm", 0, 1e5, false, S_(resistance_ohm),
     "R_s, source; the default is that of mains, also of a direct supply; circuit tier only", NULL,
     NULL},
    {"inductance", VS_REAL, "mH", "0.5 mH", 0, 1e5, false, S_(inductance_h),
     "L_s, source; the default is that of mains, also of a direct supply; circuit tier only", NULL,
     NULL},
    {"decoupling", VS_REAL, "mH", "0 mH", 0, 1e5, false, S_(decoupling_h),
     "of a coupling/decoupling network, in series with L_s; 1.5 mH: IEC 61000-4-5; circuit tier "
     "only",
     NULL, NULL},
};
static const vs_field FIRING[] = {
    {"valve", VS_CHOICE, "", "thyristor", 0, 0, false, F_(no_valve),
     "what stands between mains and coil; none: the coil is on the mains from t = 0, current both "
     "ways, ideal tiers only",
     "thyristor|none", NULL},
    {"angle", VS_PROFILE, "deg", "100 deg", 0, 180, true, F_(angle),
     "alpha*, from the rising zero crossing of the mains (Eq. 92)", NULL, NULL},
    {"pulse_width", VS_REAL, "ms", "8 ms", 0, 1e6, true, F_(pulse_width_s),
     "t_pulse, length of the gate pulse train", NULL, NULL},
    {"every", VS_COUNT, "", "once", 1, 1e6, false, F_(every), "fires in every n-th cycle", "once",
     NULL},
    {"first_cycle", VS_COUNT, "", "1", 0, 1e9, false, F_(first_cycle),
     "cycle of the first firing, from 1 on; 0: the cycle that is under way at t = 0", NULL, NULL},
    {"burst_frequency", VS_REAL, "kHz", "5 kHz", 0.01, 1000, false, F_(burst_hz),
     "of the sub-pulses that fill a gate pulse; decks with a port burst", NULL, NULL},
    {"burst_duty", VS_REAL, "%", "30 %", 0, 100, true, F_(burst_duty),
     "part of each sub-pulse's period in which it is there", NULL, NULL},
};
const vs_section vs_feed_supply = {"supply", SUPPLY, sizeof SUPPLY / sizeof *SUPPLY};
const vs_section vs_feed_firing = {"firing", FIRING, sizeof FIRING / sizeof *FIRING};
