# SPDX-License-Identifier: MIT
# A law of control as a process on a pipe: the same as trim.c, number for number. One line of JSON in, one out.
import json
import sys

WANTED_M = 1e-3  # the swing of p, half peak to peak
GAIN_DEG_M = 2000  # by how much earlier to fire, for each metre that is missing
FIRST_DEG = 150
LEAST_DEG, MOST_DEG = 90, 170

for line in sys.stdin:
    firing = json.loads(line)
    if "p_meas_m" not in firing["now"]:
        answer = {"error": "wants an instrument p, whose column is p_meas_m"}
    else:
        if firing["firing"] == 1:
            angle_deg = FIRST_DEG
        else:
            swing_m = (firing["largest"]["p_meas_m"] - firing["least"]["p_meas_m"]) / 2
            angle_deg -= GAIN_DEG_M * (WANTED_M - swing_m)
        angle_deg = max(LEAST_DEG, min(MOST_DEG, angle_deg))
        answer = {"angle_deg": angle_deg}
    print(json.dumps(answer), flush=True)
