/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spoilt.h"

#define DECK(name, more)                                                                           \
  {                                                                                                \
    "deck", name ".cir " more, "%%% s.yaml\n" CIRCUIT(name ".cir"), {0}, {name ".cir"}, {          \
      "check FILE", "run s.yaml", "check s.yaml", "export s.yaml -o x.cir"                         \
    }                                                                                              \
  }
#define CIRCUIT(deck) "circuit: {deck: " deck "}\nrun: {until: 7 ms, tier: circuit}\n"
#define PART(file, kind)                                                                           \
  {                                                                                                \
    "part", "halfwave_paper.cir parts/" file,                                                      \
        "%%% s.yaml\ncircuit: {deck: halfwave_paper.cir, " kind ": " file "}\n"                    \
        "run: {until: 6 ms, tier: circuit}\n",                                                     \
        {0}, {file}, {                                                                             \
      "run s.yaml", "check s.yaml", "run s.yaml", "check s.yaml", "check FILE"                     \
    }                                                                                              \
  }
#define MACHINE(name, more)                                                                        \
  {                                                                                                \
    "machine", "machines/" name ".yaml machines/solenoid_table.csv",                               \
        "%%% s.yaml\nmachine: {model: " name ".yaml}\n" more "run: {until: 20 ms}\n", {0},         \
        {name ".yaml"}, {                                                                          \
      "check FILE", "run s.yaml", "check s.yaml", "modes s.yaml", "list parameters --machine FILE" \
    }                                                                                              \
  }

#define STEP "supply: {kind: step, voltage: 8 V}\nfiring: {valve: none}\n"

const spoilt_bench spoilt_benches[] = {
    {"scene",
     "scenes/paper.yaml scenes/two_mass.yaml scenes/solenoid.yaml scenes/chopper.yaml "
     "scenes/control_sag.yaml scenes/control_setpoint.yaml scenes/bridge_link.yaml "
     "scenes/lds_v203.yaml",
     "%%% events.yaml\n"
     "machine: {model: conveyor, trough_mass: 0.9 kg, mount_3: [33 mm, 15 mm]}\n"
     "load: {density: 1 g/cm3, volume: 300 cm3, fraction: 10 %}\n"
     "supply: {voltage: 230 V, frequency: 50 Hz, inductance: 1 mH}\n"
     "firing: {angle: [[0 s, 120 deg], [0.1 s, 100 deg]], every: 1, pulse_width: 2 ms}\n"
     "circuit: {deck: halfwave_snubbed, r1: 47 ohm, c1: 220 nF, thyristor: TYN1212}\n"
     "actuator: {stop: {stiffness: 1e7 N/m, damping: 300 N.s/m}}\n"
     "events:\n"
     "  notch1: {kind: notch, cycle: 1, angle: 60 deg, duration: 0.5 ms}\n"
     "  surge1: {kind: surge, cycle: 1, level: 1 kV, angle: 45 deg}\n"
     "  burnt: {kind: open, element: Xv1, at: 10 ms}\n"
     "instruments:\n"
     "  p: {range: [-5 mm, 5 mm], noise: 1e-6 m, bits: 12, lowpass: 100 Hz}\n"
     "  i: {range: [-1 A, 1 A], rate: 10 kHz}\n"
     "measure: {from: 5 ms, to: 12 ms}\n"
     "record: [p, i, v_ak]\n"
     "run: {until: 12 ms, tolerance: 1e-3, sample: 0.1 ms, method: gear}\n"
     "%%% control.yaml\n"
     "instruments: {set: paper}\n"
     "firing: {every: 1, angle: 117 deg}\n"
     "control:\n"
     "  law: amplitude\n"
     "  sensor: p\n"
     "  setpoint: [[0 s, 0.7 mm], [0.5 s, 1 mm]]\n"
     "  gain: -5 deg/mm\n"
     "  integral: 60 deg/mm.s\n"
     "  angle: [90 deg, 175 deg]\n"
     "  observer: {kind: kalman}\n"
     "run: {until: 0.2 s, tier: switched}\n",
     {0},
     {"paper.yaml", "two_mass.yaml", "solenoid.yaml", "chopper.yaml", "control_sag.yaml",
      "control_setpoint.yaml", "bridge_link.yaml", "lds_v203.yaml", "events.yaml", "events.yaml",
      "events.yaml", "events.yaml", "control.yaml", "control.yaml"},
     {"check FILE", "run FILE", "run FILE --set run.until=5ms", "modes FILE",
      "export FILE -o x.cir", "steady FILE",
      "sensitivity FILE --of i_peak --to supply.voltage --set run.until=5ms"}},
    DECK("halfwave_snubbed", "varistor_law.inc"),
    DECK("halfwave_paper", ""),
    DECK("halfwave_bare", ""),
    DECK("chopper", ""),
    DECK("bridge_link", ""),
    DECK("bridge_halfcontrolled", ""),
    DECK("fullwave_antiparallel", ""),
    {"include",
     "halfwave_snubbed.cir",
     "%%% s.yaml\n" CIRCUIT(
         "d.cir") "%%% d.cir\n"
                  "*$ port mains = Vm\n*$ port gate = Vg\n*$ probe i_thyristor = i(Vt) A\n"
                  ".include sub.inc\nVm a 0 external\nVg g b external\nVt a t 0\nXs t b g mine "
                  "r={r_on}\n"
                  "*$ param r_on = 1 ohm 1e-3..1e3\nXeva b 0 eva\n"
                  "%%% sub.inc\n"
                  "* a switch with its gate\n.param hold=1k\n"
                  ".subckt mine a k g r=1\nRg g k {hold}\nBk a k I=(v(a,k)*v(g,k)*20m)/r\n"
                  "D1 a k dm\n.model dm d(is=1e-14 n=1.8 rs={r})\n.ends mine\n",
     {0},
     {"d.cir", "sub.inc", "sub.inc"},
     {"check d.cir", "run s.yaml", "check s.yaml"}},
    PART("TYN1212.inc", "thyristor"),
    PART("BT151-800R.inc", "thyristor"),
    PART("thyristor_2t.inc", "thyristor"),
    PART("latch.inc", "thyristor"),
    PART("v511da40.inc", "varistor_1"),
    PART("s20k460.inc", "varistor_1"),
    PART("varistor_siov.inc", "varistor_2"),
    PART("S505H-3-15-R.inc", "fuse_1"),
    PART("fuse.inc", "fuse_2"),
    PART("autotransformer.inc", "transformer"),
    PART("gate_pulse_transformer.inc", "gate_drive"),
    PART("gate_pt20_104.inc", "gate_drive"),
    {"part",
     "chopper.cir parts/mosfet.inc parts/rectifier.inc parts/electrolytic.inc",
     "%%% s.yaml\nmachine: {model: fixed_base}\nsupply: {kind: step, voltage: 100 V}\n"
     "pwm: {carrier: 5 kHz, duty: 0.4}\ncircuit: {deck: chopper.cir, switch: mosfet.inc, "
     "diode: rectifier.inc, link: electrolytic.inc}\nrun: {until: 1 ms}\n",
     {0},
     {"mosfet.inc", "rectifier.inc", "electrolytic.inc"},
     {"check FILE", "run s.yaml", "check s.yaml"}},
    MACHINE("conveyor", ""),
    MACHINE("conveyor_bodies", ""),
    MACHINE("two_mass", ""),
    MACHINE("solenoid", STEP),
    MACHINE("lds_v203", STEP),
    {"table",
     "machines/solenoid_table.csv scenes/solenoid_table.yaml machines/solenoid.yaml",
     "%%% s.yaml\nmachine: {model: solenoid}\nactuator: {law: solenoid_table.csv}\n"
     "supply: {kind: step, voltage: 12 V}\nfiring: {valve: none}\nrun: {until: 5 ms}\n"
     "%%% t.yaml\nmachine: {model: solenoid}\nactuator: {law: small.csv}\n"
     "supply: {kind: step, voltage: 12 V}\nfiring: {valve: none}\nrun: {until: 1 ms}\n"
     "%%% small.csv\nz_mm,i_a,lambda_wb\n"
     "1,0,0\n1,0.3,0.15\n1,0.6,0.3\n1,1,0.5\n"
     "2,0,0\n2,0.3,0.09\n2,0.6,0.18\n2,1,0.3\n"
     "4,0,0\n4,0.3,0.045\n4,0.6,0.09\n4,1,0.15\n"
     "6,0,0\n6,0.3,0.03\n6,0.6,0.06\n6,1,0.1\n",
     {0},
     {"solenoid_table.csv", "small.csv", "small.csv"},
     {"run s.yaml", "check s.yaml", "run t.yaml", "check t.yaml"}},
    {"instruments",
     "instruments/paper.yaml",
     "%%% s.yaml\ninstruments: {set: paper.yaml}\nrun: {until: 10 ms}\n",
     {0},
     {"paper.yaml"},
     {"run s.yaml", "check s.yaml", "check FILE"}},
    {"study",
     "studies/amplitude.yaml studies/control_characteristic.yaml studies/snubber.yaml "
     "studies/tolerances.yaml studies/surge_worst.yaml studies/surge_at_work.yaml "
     "studies/yield.yaml",
     "%%% grid.yaml\nscene: paper\nset: {run.until: 5 ms, run.tier: switched}\n"
     "vary:\n  firing.angle: {from: 90 deg, to: 110 deg, step: 10 deg}\n"
     "  load.fraction: [0, 0.5]\nreport: [p_min, i_peak]\n"
     "%%% sobol.yaml\nscene: s.yaml\n"
     "sample:\n  method: sobol\n  n: 4\n  seed: 7\n  spread:\n"
     "    supply.voltage: 10 % uniform\n    firing.angle: 2 deg normal within 3 sigma\n"
     "    actuator.inductance: 5 % normal\n    actuator.resistance: 3 % normal\n"
     "  correlation: [[actuator.inductance, actuator.resistance, 0.5]]\nreport: [p_min]\n"
     "%%% list.yaml\nscene: s.yaml\nvary: points.csv\nreport: [i_peak]\n"
     "%%% points.csv\nfiring.angle_deg,load.fraction\n90,0\n100,0.1\n110,0.2\n"
     "%%% worst.yaml\nscene: s.yaml\nvary: {firing.angle: {from: 90 deg, to: 120 deg}}\n"
     "find: {worst: max i_peak, n: 10, seed: 7, finest: 5 %}\nreport: [i_peak]\n"
     "%%% slopes.yaml\nscene: s.yaml\nvary: {firing.angle: [90 deg, 100 deg]}\n"
     "sensitivity: {of: [i_peak], to: [supply.voltage]}\n"
     "%%% s.yaml\nrun: {until: 5 ms, tier: switched}\n",
     {0},
     {"grid.yaml", "sobol.yaml", "sobol.yaml", "list.yaml", "points.csv", "worst.yaml",
      "slopes.yaml", "amplitude.yaml", "control_characteristic.yaml", "s.yaml"},
     {"check FILE", "study FILE -o out --jobs 1 --quiet", "check grid.yaml", "check sobol.yaml",
      "study list.yaml -o out --jobs 1 --quiet", "check list.yaml"}},
    {"studies shipped",
     "studies/snubber.yaml studies/surge_at_work.yaml studies/surge_worst.yaml studies/yield.yaml "
     "studies/false_firing.yaml studies/resonance.yaml studies/snubber_map.yaml",
     "",
     {0},
     {"snubber.yaml", "surge_at_work.yaml", "surge_worst.yaml", "yield.yaml", "false_firing.yaml",
      "resonance.yaml", "snubber_map.yaml"},
     {"check FILE"}},
    {"study's folder",
     "",
     "%%% grid.yaml\nscene: paper\nset: {run.until: 5 ms, run.tier: switched}\n"
     "vary:\n  firing.angle: {from: 90 deg, to: 110 deg, step: 10 deg}\n"
     "  load.fraction: [0, 0.5]\nreport: [p_min, i_peak]\n",
     {"study grid.yaml -o d --jobs 1 --quiet", "study grid.yaml -o e --jobs 1 --quiet",
      "study grid.yaml -o one --shard 1/2 --jobs 1 --quiet",
      "study grid.yaml -o two --shard 2/2 --jobs 1 --quiet"},
     {"d/study.csv", "d/manifest.json", "d/failures.csv", "d/journal", "one/journal", "two/journal",
      "one/manifest.json"},
     {"plot d --quiet", "compare d e", "compare e d", "merge one two -o whole --quiet",
      "study grid.yaml -o d --jobs 1 --resume --quiet",
      "study grid.yaml -o one --shard 1/2 --jobs 1 --resume --quiet"}},
    {"run's folder",
     "",
     "%%% measured.csv\nt_ms,p_mm,i_ma\n0,0,0\n2,-0.1,10\n4,-0.2,300\n6,-0.3,500\n",
     {"run paper --set run.until=25ms -o d --quiet", "run paper --set run.until=15ms -o e --quiet",
      "run paper --tier circuit --set run.until=8ms -o f --quiet"},
     {"d/run.csv", "d/events.csv", "d/summary.json", "f/summary.json", "f/run.csv", "measured.csv",
      "measured.csv"},
     {"plot d --quiet", "compare d e", "compare f e", "plot d --overlay measured.csv --quiet",
      "plot d --overlay measured.csv --quiet", "plot d --probe p,i --fft --quiet"}},
    {"fit",
     "fits/paper.yaml",
     "%%% record.yaml\nset: {run: {tier: switched, until: 20 ms, sample: 1 ms}}\n"
     "free: {machine.trough_mass: , firing.angle: }\nstarts: 1\n"
     "data: {file: d/run.csv, columns: {p: 4 um, i: 3 mA}, to: 19 ms}\n"
     "%%% two.yaml\nscene: paper\nset: {run.tier: switched, run.until: 30 ms}\nstarts: 1\n"
     "free: {actuator.gap: {from: 5 mm, to: 8 mm}}\n"
     "measures: {i_peak: {value: 0.95 A, error: 3 %}, force_peak: {value: 90 N, error: 5 %}}\n",
     {"run paper --tier switched --set run.until=20ms --set run.sample=1ms --quiet -o d"},
     {"record.yaml", "record.yaml", "two.yaml", "d/run.csv", "d/run.csv", "paper.yaml"},
     {"check FILE", "check record.yaml", "fit record.yaml --quiet", "fit two.yaml --quiet",
      "fit record.yaml --quiet --set starts=1"}},
    {"import",
     "import/bridge_plain.cir import/dimmer_pspice.cir import/halfwave_ltspice.net "
     "import/triac_kicad.cir import/triac_kicad.lib",
     "",
     {0},
     {"bridge_plain.cir", "dimmer_pspice.cir", "halfwave_ltspice.net", "triac_kicad.cir"},
     {"import FILE -o x.cir --scene x.yaml --quiet", "import FILE -o x.cir --quiet"}},
    {"library of import",
     "import/triac_kicad.cir import/triac_kicad.lib",
     "",
     {0},
     {"triac_kicad.lib"},
     {"import triac_kicad.cir -o x.cir --coil L1+R4 --scene x.yaml --quiet"}},
    {"vendor's model",
     "",
     "%%% vendor.lib\n* a vendor's library\n.SUBCKT SCR12 A G K PARAMS: IGT=10m VDRM=800\n"
     "Q1 1 2 K NM\nQ2 2 1 A PM\nRA G 2 1\nRB 2 K {0.65/IGT}\nD1 A K DB\n"
     ".MODEL NM NPN(IS=1E-15 BF=5)\n.MODEL PM PNP(IS=1E-15 BF=1)\n"
     ".MODEL DB D(IS=1E-15 BV={VDRM*1.2})\n.ENDS\n",
     {"part thyristor --wrap vendor.lib -o scr.inc --quiet"},
     {"vendor.lib", "vendor.lib", "scr.inc"},
     {"part thyristor --wrap vendor.lib -o other.inc --quiet", "check scr.inc",
      "run paper --tier circuit --set circuit.thyristor=scr.inc --set run.until=6ms --quiet"}},
    {"--set",
     "",
     "%%% grid.yaml\nscene: paper\nset: {run.until: 5 ms, run.tier: switched}\n"
     "vary: {firing.angle: [90 deg, 100 deg]}\nreport: [p_min]\n"
     "%%% own.yaml\nrun: {until: 5 ms}\n%%% args\n"
     "firing.angle=95deg\nfiring.every=1\nsupply.voltage=230 V\nmachine.trough_mass=0.9kg\n"
     "machine.model=two_mass\ncircuit.deck=halfwave_snubbed\ncircuit.r1=100ohm\n"
     "run.until=20ms\nrun.tier=switched\nrecord=[p, i]\nactuator.stop.stiffness=1e7N/m\n"
     "events.a.kind=notch\nmachine.mount_3=[33 mm, 15 mm]\nfiring.angle=[[0 s, 160 deg], [1 s, 100 "
     "deg]]\n"
     "load={density: 1 g/cm3, fraction: 0.1}\nmeasure.last=2 cycles\nstart=steady\n",
     {0},
     {"args"},
     {"run paper --quiet --set 'ARGUMENT'", "check own.yaml --set 'ARGUMENT'",
      "study grid.yaml --quiet --jobs 1 -o out --set 'ARGUMENT'", "modes own.yaml --set 'ARGUMENT'",
      "export own.yaml -o x.cir --set 'ARGUMENT'"}},
    {.name = NULL}};
