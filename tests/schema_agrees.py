#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""schema_agrees.py PROGRAM SPICE - `vibrospice schema` and `vibrospice check` must agree.

Each of the scenes below is one mutation of a good one. Only what a schema can tell is mutated: keys, words, kinds of values
and units. Every shipped scene, study and machine must pass its schema. Prints each disagreement; exit status 1 when there is
one, 77 where jsonschema or yaml is not installed."""
import glob
import json
import os
import subprocess
import sys

try:
    import yaml
    from jsonschema import Draft202012Validator
except ImportError:
    sys.exit(77)

SCENES = """firing: {angle: 95 deg}
firing: {angle: 95deg}
firing: {angle: 1.6 rad}
firing: {angle: "100 °"}
firing: {angle: 95}
firing: {angle: 95 s}
firing: {angle: 95 furlong}
firing: {angle: [[0 s, 90 deg], [1 s, 100 deg]]}
firing: {angle: [[0 s, 90 deg], [1 s, 100 V]]}
firing: {angle: [[0 s], [1 s, 100 deg]]}
firing: {angle: []}
firing: {angle: {at: 3 deg}}
firing: {angel: 95 deg}
firing: {every: once}
firing: {every: 3}
firing: {every: twice}
firing: {every: 1.5}
firing: {every: 0}
firing: {valve: none}
firing: {valve: triode}
firing: [1, 2]
firing:
fire: {angle: 95 deg}
supply: {voltage: 0.44 kV}
supply: {voltage: 440 mV}
supply: {voltage: 440 A.ohm}
supply: {voltage: 440 A}
supply: {voltage: 440 V.s}
supply: {frequency: 50 1/s}
supply: {frequency: 50 Hz}
supply: {frequency: 50 s}
machine: {spring_stiffness: 43 kN/m}
machine: {spring_stiffness: 43000 kg/s2}
machine: {spring_stiffness: 43 N.m}
machine: {spring_damping: 1.2 N*s/m}
machine: {spring_damping: 1.2 kg/s}
machine: {spring_damping: 1.2 N/m}
machine: {trough_inertia: 3.86e-3 kg.m2}
machine: {trough_inertia: 38.6 kg.cm^2}
machine: {trough_inertia: 38.6 kg.cm}
machine: {base_com: [194 mm, 9 cm]}
machine: {base_com: [194 mm, 9 s]}
machine: {base_com: [194 mm]}
machine: {base_com: 194 mm}
machine: {m14: derived}
machine: {m14: own}
machine: {trough_mas: 1 kg}
actuator: {stop: none}
actuator: {stop: {stiffness: 1e7 N/m, damping: 300 N.s/m}}
actuator: {stop: {stiffness: 1e7 N, damping: 300 N.s/m}}
actuator: {stop: {stifness: 1e7 N/m}}
actuator: {stop: 3}
actuator: {gap: 0.6 cm}
actuator: {gap: 6 mm2}
load: {density: 1600 kg/m3, fraction: 0.3}
load: {density: 1.6 g/cm3, fraction: 30 %}
load: {density: 1.6 g/cm2, fraction: 0.3}
load: {fraction: 2}
load: {volume: 0.38 m3}
circuit: {r1: 0.22 kohm, c1: 220 nF}
circuit: {r1: 220 nF}
circuit: {r99: 220 ohm}
run: {until: 0.5 min}
run: {until: 0.5 mm}
run: {tier: switched}
run: {tier: best}
run: {tolerance: 1e-3}
run: {tolerance: 0.1 V}
measure: {last: 5 cycles}
measure: {last: 5 s}
start: steady
start: sometime
events: {e: {kind: sag, at: 20 ms, level: 40 %}}
events: {e: {kind: sagg, at: 20 ms}}
events: {e: {kind: sag, at: 20 mm}}
events: {e: {kind: sag, at: 20 ms, depth: 3}}
events: {e: {at: 20 ms}}
events: [sag]"""


def main():
    program, spice = sys.argv[1:]
    # firing.every where an orbit is wanted
    more = {"start: steady": "\nfiring: {every: 1}"}

    def schema(kind, *options):
        out = subprocess.run([program, "schema", kind, *options], check=True, capture_output=True, text=True).stdout
        return Draft202012Validator(json.loads(out))

    wrong = 0
    of_scene = schema("scene")
    for text in SCENES.split("\n"):
        text += more.get(text, "")
        with open("mutated.yaml", "w", encoding="utf-8") as file:
            file.write(text + "\n")
        checked = subprocess.run([program, "check", "mutated.yaml", "--quiet"], capture_output=True, text=True)
        taken = of_scene.is_valid(yaml.safe_load(text))
        if taken != (checked.returncode == 0):
            print(f"{text}: the schema {'takes' if taken else 'refuses'} it; check: {checked.stderr.splitlines()[:1]}")
            wrong += 1
    for kind, folder in (("scene", "scenes"), ("study", "studies"), ("machine", "machines")):
        of_kind = schema(kind)
        for path in sorted(glob.glob(os.path.join(spice, folder, "*.yaml"))):
            with open(path, encoding="utf-8") as file:
                for error in of_kind.iter_errors(yaml.safe_load(file) or {}):
                    print(f"{path}: {error.json_path}: {error.message[:200]}")
                    wrong += 1
    print(f"{len(SCENES.splitlines())} scenes, {wrong} disagreements")
    sys.exit(1 if wrong else 0)


main()
