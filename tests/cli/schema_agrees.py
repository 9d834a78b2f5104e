#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""schema_agrees.py PROGRAM SPICE - `vibrospice schema` and `vibrospice check` must agree.

Each line below is one mutation of a good scene, study or machine. Only what a schema can tell is mutated: keys, words, kinds
of values and units. Every shipped scene, study and machine must pass its schema. Prints each disagreement; exit status 1 when
there is one, 77 where jsonschema or yaml is not installed."""
import glob
import json
import os
import re
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
actuator: {gap: " 6 mm "}
actuator: {pole_cover: " 0 "}
actuator: {pole_cover: ""}
actuator: {law: reluctance}
actuator: {law: hysteresis}
actuator: {law: iron.dat}
machine: {model: {}}
circuit: {deck: [halfwave_bare]}
supply: {frequency: 50 s^-1}
supply: {frequency: 50 s-1}
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


# Sections that name things of the machine, of the deck or of the scene itself.
NAMING = """start: {p: 1 mm}
start: {p: 1 mm, vphi: 2 rad/s}
start: {p: 1 s}
start: {q: 1 mm}
start: [1 mm]
start:
record: all
record: [p, i, v_ak]
record: p
record: [p, nothing]
record: []
record: [p, p]
record: {p: 1}
measured: {i_peak: 0.95 A}
measured: {i_peak: 950 mA, p_min: 0}
measured: {i_peak: 0.95 V}
measured: {i_top: 0.95 A}
measured: [i_peak]
measured:
quality: [mains]
quality: mains
quality: none
quality: [mains, i]
quality: [v_ak]
quality: [mians]
quality: {mains: 1}
quality: [mains, mains]
instruments: {}
instruments:
instruments: {set: own, seed: 3}
instruments: {seed: 1.5}
instruments: {p: none}
instruments: {p: nothing}
instruments: {p: {rate: 5 kHz}}
instruments: {p: {rate: 5 s}}
instruments: {p: {bits: 10}}
instruments: {p: {bits: many}}
instruments: {p: {bandwith: 1 kHz}}
instruments: {p: {range: [-3 mm, 3 mm], noise: 1 um}}
instruments: {p: {range: 3 mm}}
instruments: {q: {channel: p, range: [-3 mm, 3 mm], bandwidth: none}}
instruments: [p]
control: {law: none}
control: {rate: 5 kHz}
control: {law: amplitude, sensor: p, setpoint: 1 mm, gain: -2 deg/mm}
control: {law: amplitude, setpoint: 1 mm}
control: {law: amplitude, sensor: p, setpont: 1 mm}
control: {law: amplitude, sensor: p, setpoint: [[0 s, 1 mm], [1 s, 2 mm]]}
control: {law: amplitude, sensor: p, setpoint: [[0 s, 1 mm], [1 mm]]}
control: {law: amplitude, sensor: p, angle: [90 deg, 170 deg]}
control: {law: amplitude, sensor: p, angle: [90 s, 170 deg]}
control: {law: amplitude, sensor: p, sensor_gain: auto}
control: {law: amplitude, sensor: p, sensor_gain: some}
control: {law: amplitude, sensor: p, phase: 90 deg}
control: {law: phase, sensor: p, phase: 90 deg}
control: {law: phase, sensor: p, phase: 90 mm}
control: {law: fuzzy, sensor: p}
control: {law: none, sensor: p}
control: {law: pipe}
control: {law: none, observer: {}}
control: {law: none, observer: {kind: kalman, sensors: [p], force_noise: 2 N}}
control: {law: none, observer: {kind: best}}
control: {law: none, observer: {knid: kalman}}
control: {law: none, observer: {force_noise: 2 V}}
control: {law: none, observer: {start: run}}
control: {law: none, observer: [p]}
control: [amplitude]
machine: {model: two_mass}, start: {x: 1 mm}
actuator: {stop: {kind: quadratic, stiffness: 1e11 N/m2}}
actuator: {stop: {kind: quadratic, stiffness: 1e7 N/m}}
actuator: {stop: {kind: cubic}}
actuator: {saturation: {law: series, flux: 1 Wb, current: 0.2 A}}
actuator: {saturation: {law: multiplicative, current: 0.2 A}}"""

STUDY = """scene: paper
set: {run.until: 20 ms}
vary: {firing.angle: [95 deg]}"""
STUDIES = """scene: paper
scene: [paper]
scen: paper
set: {run.until: 30 ms, run.tier: switched}
set: {run.until: 30 mm}
set: {run.tier: best}
set: {run: {until: 30 ms}}
set: {run: {until: 30 mm}}
set: {run: {untill: 30 ms}}
set: {firing: []}
set: {firing: }
set: {circuit.r1: 100 ohm}
set: {machine.spring_stiffness: 43 kN/m}
set: {run.untill: 30 ms}
set: {actuator.stop: {}}
set: {actuator.stop: {stiffness: 1e7 N/m}}
set: {actuator.stop: {stifness: 1e7 N/m}}
set: [run.until]
set:
vary: {firing.angle: 95 deg}
vary: {firing.angle: [95 deg, 100 deg]}
vary: {firing.angle: [95 deg, 100 V]}
vary: {firing.angle: []}
vary: {firing.angel: [95 deg]}
vary: {fire.angle: [95 deg]}
vary: {firing.angle: {from: 95 deg, to: 100 deg, step: 5 deg}}
vary: {firing.angle: {from: 95 deg, to: 100 deg, step: 5 mm}}
vary: {firing.angle: {from: 95 deg, step: 5 deg}}
vary: {firing.angle: {from: 95 deg, to: 100 deg, stp: 5 deg}}
vary: {firing.angle: {lin: [95 deg, 100 deg], n: 3}}
vary: {firing.angle: {lin: [95 deg], n: 3}}
vary: {firing.angle: {lin: [95 deg, 100 deg], n: 2.5}}
vary: {firing.angle: {log: [95 deg, 100 deg], n: 3}}
vary: {firing.angle: {log: [95 deg, 100 s], n: 3}}
vary: {load.fraction: [0, 0.1, 30 %]}
vary: {load.fraction: [0 mm]}
vary: {run.tier: [analytic, switched]}
vary: {run.tier: [analytic, best]}
vary: {run.tier: {from: analytic, to: switched}}
vary: {firing.every: [1, 2]}
vary: {firing.every: [1.5]}
vary: {circuit.r1: [100 ohm, 1 kohm]}
vary: {actuator.gap: [5 mm, 6 mm]}
vary: {actuator.stop: [none]}
vary: [firing.angle]
sample: {n: 4, spread: {supply.voltage: 5 % normal}, method: sobol}
sample: {n: 4, spread: {supply.voltage: 5 % normal}}
sample: {n: 4, spread: {supply.voltage: 5 % normal within 2 sigma}}
sample: {n: 4, spread: {supply.voltage: 5 V uniform}}
sample: {spread: {varistr: 5 % uniform}}
sample: {spread: {load.fraction: 0 .. 0.5}}
sample: {spread: {supply.voltage: -20 % .. 5 %}}
sample: {spread: {supply.voltage: -20 % .. }}
sample: {spread: {supply.voltage: 396 V .. 484 V}}
threats: {s: {kind: surge, angle: [any, {a: 3}]}}
sample: {n: 4, spread: {supply.voltage: 5 A uniform}}
sample: {n: 4, spread: {supply.voltage: 5 % gaussian}}
sample: {n: 4, spread: {supply.voltage: [440 V, 400 V]}}
sample: {n: 4, spread: {run.tier: 5 % normal}}
sample: {n: 4, spread: {supply.voltage: 5 % normal}, method: lhs}
sample: {spread: {supply.voltage: 5 % normal}, method: corners}
sample: {n: 4, spread: {supply.voltage: 5 % normal}, method: hypercube}
sample: {n: 4.5, spread: {supply.voltage: 5 % normal}}
sample: {n: 4, spred: {supply.voltage: 5 % normal}}
sample: {n: 4}
sample: {seed: seven, spread: {supply.voltage: 5 % normal}}
sample: {n: 4, spread: {supply.voltage: 5 % normal, supply.frequency: 1 % normal}, correlation: [[supply.voltage, supply.frequency, 0.5]]}
sample: {n: 4, spread: {supply.voltage: 5 % normal, supply.frequency: 1 % normal}, correlation: [[supply.voltage, 0.5]]}
find: {worst: max i_peak, n: 20, seed: 7, finest: 0.2 %}
find: {worst: max i_peak, finest: 0.2 deg}
find: {best: max i_peak}
find: {n: 20}
sensitivity: {of: i_peak, to: [actuator.gap, supply.voltage]}
sensitivity: {of: [i_peak]}
sensitivity: {of: [i_peak], to: actuator.gap, by: 3}
steady: false
steady: maybe
steady: {period: 1.5}
steady: {periods: 1}
report: [i_peak, p_min]
report: i_peak
report: [[i_peak]]
report: {i_peak: 1}
report:"""
WITH_RANGE = "vary: {firing.angle: {from: 95 deg, to: 100 deg}}"

MACHINE = """coordinates: {x: {unit: m, text: trough}, y: {unit: m}}
parameters: {a: {default: 6 kg, range: 0 kg .., text: mass}, k: {default: 4e5 N/m}}
mass: [[a, 0], [0, a]]
stiffness: [[k, 0], [0, k]]
gap: {along: {x: 1, y: -1}}"""
MACHINES = """title: a machine
title: [a, machine]
titel: a machine
coordinates: {x: {unit: m}, y: {unit: m, text: "it, too"}}
coordinates: {x: {unit: m}, y: {text: without}}
coordinates: {x: {unit: m}, y: {unit: m, txt: y}}
coordinates: [x, y]
coordinates: {x: m, y: m}
parameters: {a: {default: 6 kg}, k: {default: 4e5 N/m, range: 0 N/m .. 1e9 N/m, open: true}}
parameters: {a: {default: 6 kg}, k: {default: 4e5 N/m, open: perhaps}}
parameters: {a: {default: 6 kg}, k: {range: 0 N/m ..}}
parameters: {a: {default: 6 kg}, k: {default: 4e5 N/m, limits: 0 N/m ..}}
parameters: {a: {default: 6 kg}, k: {default: 4e5 N/m}, b: {default: [1 mm, 2 mm]}}
parameters: {a: {default: 6 kg}, k: {default: 4e5 N/m}, b: {default: [1 mm, 2 mm, 3 mm]}}
parameters: {a: {default: 6 kg}, k: {default: 4e5 N/m}, b: {default: one, choices: one|other}}
parameters: {a: {default: 6 kg}, k: {default: 4e5 N/m}, b: {default: one, choices: [one, other]}}
parameters: {a: {default: 6 kg}, k: {default: 4e5 N/m}, b: {default: one, choices: {one: other}}}
parameters: {a: 6 kg, k: 4e5 N/m}
let: {b: 2*k}
let: {b: [2*k]}
let: [b]
let:
mass: [[a, 0], [0, 2*a]]
mass: {x: a, y: a}
mass: [[a, {b: 0}], [0, a]]
mass: []
damping: [[1 N.s/m, 0], [0, 0]]
damping: [1, [2, 3]]
forces: {x: 1 N}
forces: {x: [1 N]}
forces: [1 N]
gap: {along: {x: 1}}
gap: {along: [1, -1]}
gap: {allong: {x: 1}}
gap: {}
load: {adds: a, to: [mass], along: x}
load: {adds: a, to: mass, up: x, forward: y}
load: {adds: a, to: [masses]}
load: {adds: a}
load: {adds: a, to: [mass], down: x}
probes: {s: {of: x - y, unit: m, text: stroke}}
probes: {s: {unit: m}}
probes: {s: {of: x - y, unit: m, test: stroke}}
probes: {s: x - y}
actuator: {gap: 2 mm, inductance: 0.46 H}
actuator: {gap: 2 s}
actuator: {gab: 2 mm}
actuator: {stop: {at: 1 mm}}
actuator: {stop: {att: 1 mm}}
actuator: {current: lambda*z/0.002, force: -lambda^2/0.004}
actuator: {current: [lambda]}
instruments: {s: {channel: x, range: [-1 mm, 1 mm]}}
instruments: {s: {channel: x, reach: [-1 mm, 1 mm]}}
instruments: [s]"""
BODIES = """coordinates: {x: {unit: m}, y: {unit: m}}
gap: {along: {x: 1, y: -1}}
bodies: {b: {mass: 4 kg, at: [0, 0], moves: {x: x, y: y}}}
springs: {s: {to: {b: [0, 0]}, stiffness: [1e4 N/m, 1e4 N/m]}}"""
OF_BODIES = """bodies: {b: {mass: 4 kg, inertia: 0.1 kg.m2, at: [0, 0], on: ground, moves: {x: x, y: y}}}
bodies: {b: {mass: 4 kg, moves: {x: x, y: y}}}
bodies: {b: {mass: 4 kg, at: [0], moves: {x: x, y: y}}}
bodies: {b: {mass: 4 kg, at: [0, 0], moves: {x: x, y: y, z: 0}}}
bodies: {b: {mass: 4 kg, at: [0, 0], move: {x: x, y: y}}}
bodies: [b]
springs: {s: {from: {ground: [0, 0]}, to: {b: [0, 0]}, stiffness: [1e4 N/m, 1e4 N/m], damping: [1 N.s/m, 1 N.s/m]}}
springs: {s: {stiffness: [1e4 N/m, 1e4 N/m]}}
springs: {s: {to: [0, 0], stiffness: [1e4 N/m, 1e4 N/m]}}
springs: {s: {to: {b: [0, 0]}, stifness: [1e4 N/m, 1e4 N/m]}}
springs: {s: {to: {b: [0, 0], ground: [0, 0]}, stiffness: [1e4 N/m, 1e4 N/m]}}
springs: {s: {to: {b: [0, 0]}, stiffness: [1e4 N/m]}}"""


class Loader(yaml.SafeLoader):
    """YAML 1.2 as the program has it: `on`, `off`, `yes` and `no` are words."""


Loader.yaml_implicit_resolvers = {
    first: [(tag, regexp) for tag, regexp in resolvers if tag != "tag:yaml.org,2002:bool"]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
Loader.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile("^(?:true|false)$"), list("tf"))


def mutated(base, line):
    """The base with its line of the same key replaced, or with one more."""
    key = line.split(":")[0]
    return "\n".join([x for x in base.splitlines() if x.split(":")[0] != key] + [line])


def scene(line):
    """The scene of that line, with what the section needs besides."""
    key = line.split(":")[0]
    base = {
        "start": "firing: {every: 1}" if line == "start: steady" else "",
        "quality": "measure: {last: 2 cycles}",
        "control": "firing: {every: 1}\ninstruments: {}",
    }.get(key, "")
    return mutated(base, line.replace("}, start", "}\nstart"))


def study(line):
    base = STUDY
    if line.startswith("find"):
        base = mutated(base, WITH_RANGE)
    return mutated(base, line)


def cases():
    yield from (("scene", scene(line)) for line in SCENES.splitlines() + NAMING.splitlines())
    yield from (("study", study(line)) for line in STUDIES.splitlines())
    yield from (("machine", mutated(MACHINE, line)) for line in MACHINES.splitlines())
    yield from (("machine", mutated(BODIES, line)) for line in OF_BODIES.splitlines())


def main():
    program, spice = sys.argv[1:]
    of_kind = {}
    for kind in ("scene", "study", "machine"):
        out = subprocess.run([program, "schema", kind], check=True, capture_output=True, text=True).stdout
        of_kind[kind] = Draft202012Validator(json.loads(out))
    wrong, count = 0, {"scene": 0, "study": 0, "machine": 0}
    for kind, text in cases():
        count[kind] += 1
        with open("mutated.yaml", "w", encoding="utf-8") as file:
            file.write(text + "\n")
        checked = subprocess.run([program, "check", "mutated.yaml", "--quiet"], capture_output=True, text=True)
        taken = of_kind[kind].is_valid(yaml.load(text, Loader))
        if taken != (checked.returncode == 0):
            last = text.splitlines()[-1]
            print(f"{last}: the schema {'takes' if taken else 'refuses'} it; check: {checked.stderr.splitlines()[:1]}")
            wrong += 1
    for kind, folder in (("scene", "scenes"), ("study", "studies"), ("machine", "machines")):
        for path in sorted(glob.glob(os.path.join(spice, folder, "*.yaml"))):
            with open(path, encoding="utf-8") as file:
                for error in of_kind[kind].iter_errors(yaml.load(file, Loader) or {}):
                    print(f"{path}: {error.json_path}: {error.message[:200]}")
                    wrong += 1
    print(f"{count['scene']} scenes, {count['study']} studies, {count['machine']} machines; {wrong} disagreements")
    sys.exit(1 if wrong else 0)


main()
