# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of the Python module; tests/install/test_python.c runs them, one class at a time.

usage: python_module.py CLASS [without-numpy]

Standard library alone. The work folder is empty at first, and is one for all classes, in this
order. VIBROSPICE is the program, PYTHONPATH has the module.
"""

import copy
import csv
import doctest
import gc
import json
import math
import os
import pathlib
import pickle
import re
import shutil
import signal
import stat
import subprocess
import sys
import threading
import unittest
import unittest.mock
import warnings

if sys.argv[2:] == ["without-numpy"]:
    sys.modules["numpy"] = sys.modules["pandas"] = None

import vibrospice

try:
    import numpy
except ImportError:
    numpy = None
try:
    import pandas
except ImportError:
    pandas = None

TESTS = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = os.environ["VIBROSPICE"]
VIOLATED = {"circuit": {"deck": "halfwave_paper", "c1": "1 uF",
                        "r1": vibrospice.Quantity(100, "ohm")},
            "run": {"tier": "circuit", "until": "6 ms"}}
STUDY = {"scene": "paper", "set": {"run.until": "15 ms", "run.tier": "switched"},
         "vary": {"supply.voltage": ["440 V", "400 V"],
                  "firing.angle": {"lin": ["90 deg", "120 deg"], "n": 3}},
         "report": ["i_peak", "p_min"]}
# its first case drives the armature onto the pole cover
FAILING = {"scene": "paper", "set": {"run.until": "20 ms", "firing.every": 1},
           "vary": {"firing.angle": ["20 deg", "120 deg"]}, "report": ["i_peak"]}


def setUpModule():
    """Makes the folders that several classes read: a run, a run with a violated rating, a study."""
    os.environ["XDG_CACHE_HOME"] = os.path.abspath("cache")  # not the user's own
    if not os.path.exists("run"):
        vibrospice.run("paper", until="30 ms", set={"firing.angle": "95 deg"}, out="run")
        vibrospice.run(VIOLATED, out="violated")
        vibrospice.study(STUDY, jobs=1, keep="runs", out="study")


def printed(*words):
    """What the program itself prints on standard output."""
    return subprocess.run([PROGRAM, *words], stdout=subprocess.PIPE, encoding="utf-8",
                          check=False).stdout


def cells_of(path):
    """{name: cells as they stand} of a CSV file."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    return {name: [row[k] for row in rows[1:]] for k, name in enumerate(rows[0])}


def fake(text):
    """A program that does what a shell script says. It is the program until the test ends."""
    path = pathlib.Path("fake").absolute()
    path.write_text("#!/bin/sh\n" + text)
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    os.environ["VIBROSPICE"] = str(path)


WORDS = {"id", "weakest", "happened", "not_judged", "warnings"}  # columns of study.csv


class Case(unittest.TestCase):
    def setUp(self):
        self.addCleanup(os.environ.__setitem__, "VIBROSPICE", PROGRAM)

    def assert_columns(self, table, path, of_words=()):
        """All cells are those of the file: numbers to the 9 digits of run.csv, or the 12 of studies
        and branches; words alike."""
        digits = ".9g" if pathlib.Path(path).name == "run.csv" else ".12g"
        cells = cells_of(path)
        self.assertEqual(list(table), list(cells))
        for name, column in cells.items():
            if name in of_words:
                self.assertEqual(list(table[name]), column, name)
            else:
                self.assertEqual([f"{x:{digits}}"
                                  for x in table[name]], [c or "nan" for c in column], name)


class Runs(Case):
    def test_peaks_between_rows(self):
        r = vibrospice.run("paper", tier="circuit", until="8 ms", out="peaks")
        told = r.measures["i_thyristor_max"]
        self.assertLess(abs(max(r.peaks["i_thyristor"]) / told - 1), 0.01)
        self.assertLess(max(r.columns["i_thyristor"]), 0.5 * told)
        self.assertEqual(r.peaks.units, r.columns.units)
        self.assertEqual(list(vibrospice.load("peaks").peaks["t_s"]), list(r.peaks["t_s"]))
        smooth = vibrospice.run("paper", until="8 ms")
        self.assertIs(smooth.peaks, smooth.columns)

    def test_measures_and_columns(self):
        r = vibrospice.run("paper", until="30 ms", set={"firing.angle": "95 deg"}, out="one")
        with open("one/summary.json", encoding="utf-8") as file:
            summary = json.load(file)
        self.assertEqual(summary["scene"]["firing"]["angle"], {"value": 95, "unit": "deg"})
        self.assertEqual(list(r.measures), list(summary["measures"]))
        for name, m in summary["measures"].items():
            q = r.measures[name]
            self.assertTrue(q.value == m["value"] or m["value"] is None and math.isnan(q), name)
            self.assertEqual((q.unit, q.at, q.measured),
                             (m["unit"], m.get("at_s"), m.get("measured")), name)
        self.assert_columns(r.columns, "one/run.csv")
        self.assertEqual(len(r.columns["t_s"]), 301)  # 30 ms, a row each 0.1 ms
        self.assertEqual(list(r.columns["vp"]), list(r.columns["vp_m_s"]))
        self.assertEqual([what for _, what in r.events], ["thyristor fires", "thyristor extinct"])
        self.assertAlmostEqual(r.events[0][0], 95 / 360 / 50, delta=1e-11)  # nine digits of 5.3 ms
        self.assertEqual((r.status, r.held, r.word, r.warnings), (0, None, None, []))
        self.assertEqual(r.energy, summary["energy"])
        self.assertEqual((str(r.path), r.tier), ("one", "switched"))
        self.assertIn("i_peak", r.text)
        self.assertIn("<td>i_peak</td>", r._repr_html_())

    def test_what_columns_are(self):
        """A probe named as an acceleration is none, as the summary tells."""
        text = (TESTS.parent / "spice/machines/two_mass.yaml").read_text()
        text = text.replace("\nparameters:\n", "\nparameters:\n  kk: {default: 100 1/s2, text: k}\n")
        text = text.replace("\nprobes:\n", "\nprobes:\n  amax: {of: kk * x, unit: m/s2, text: t}\n")
        pathlib.Path("tm.yaml").write_text(text)
        r = vibrospice.run({"machine": {"model": "./tm.yaml"},
                            "run": {"until": "2 ms", "tier": "switched"}}, out="about")
        about = r.columns.about
        self.assertEqual(list(about), list(r.columns))
        self.assertEqual(about["amax_m_s2"], {"quantity": "amax", "unit": "m/s2", "role": "probe",
                                              "of": "machine"})
        self.assertEqual(about["ax_m_s2"], {"quantity": "ax", "unit": "m/s2",
                                            "role": "acceleration", "of": "x"})
        self.assertEqual([n for n, c in about.items() if c["role"] == "coordinate"],
                         ["x_m", "y_m"])

    def test_all_digits(self):
        """Nothing is lost on the way into Python: 17 digits tell a double exactly."""
        r = vibrospice.run("paper", until="8 ms", digits=17)
        self.assertEqual(max(abs(x) for x in r.columns["i"]),
                         max(abs(float(c)) for c in cells_of(r.path / "run.csv")["i_a"]))

    def test_units_are_the_programs(self):
        r = vibrospice.load("violated")
        probes = json.loads(printed("list", "probes", "--deck", "halfwave_paper", "--json"))
        for p in probes["probes"]:
            self.assertEqual(r.columns.units[r.columns.name(p["name"])], p["unit"], p["name"])
        self.assertEqual(r.columns.units["t_s"], "s")
        with self.assertRaisesRegex(KeyError, "'nope' is no column; there are t_s, p_m"):
            r.columns["nope"]
        # without the program, as on another machine, the names' endings tell
        os.environ["VIBROSPICE"] = "/nowhere/vibrospice"
        again = vibrospice.load("violated")
        self.assertEqual(again.columns.units, r.columns.units)

    def test_violated_is_no_exception(self):
        r = vibrospice.run(VIOLATED)
        self.assertEqual((r.status, r.held, r.word), (3, False, "violated"))
        self.assertEqual((r.weakest, r.first_to_fail), ("thyristor.di_dt", "thyristor.di_dt"))
        self.assertIn("a rating is violated: thyristor.di_dt", r.messages[-1])
        line = next(v for v in r.verdict if v.get("measure") == "di_dt")
        self.assertEqual((line["unit"], line["limit"], line["word"]), ("A/us", 100, "violated"))
        held = vibrospice.run(VIOLATED, set={"circuit.c1": "10 nF", "circuit.r1": "4.7 kohm"})
        self.assertEqual((held.status, held.held, held.word), (0, True, "held"))

    def test_ratings_of_the_user(self):
        """They are lines of the verdict, by the name of what they rate."""
        r = vibrospice.run("paper", until="40 ms", set={
            "run.tier": "switched", "ratings": {"stroke": ".. 2 mm", "r1.power": ".. 2 W"}})
        self.assertEqual((r.status, r.held, r.word), (3, False, "violated"))
        stroke, power = r.verdict
        self.assertEqual((stroke["rating"], stroke["of"], stroke["max"], stroke["unit"]),
                         ("stroke", "scene", 2, "mm"))
        self.assertAlmostEqual(stroke["margin"], 1 - r.measures["stroke"] / 2e-3, places=9)
        self.assertEqual((power["word"], power["margin"], power["unknown"]),
                         ("undecided", None, "this tier has no circuit"))
        r = vibrospice.run("paper", until="40 ms", set={"run.tier": "switched",
                                                        "ratings.stroke": "2 mm .. 4 mm"})
        self.assertEqual((r.status, r.held, r.word, r.weakest), (0, True, "held", "stroke"))

    def test_the_word_of_the_whole(self):
        """It is that of the worst line, as the program prints it."""
        of = vibrospice.results._word_of
        line = {word: {"word": word, "violated": word == "violated"}
                for word in ("held", "unverified", "undecided", "violated")}
        self.assertIsNone(of([]))
        self.assertEqual(of([line["held"], line["unverified"]]), "unverified")
        self.assertEqual(of([line["undecided"], line["unverified"]]), "undecided")
        self.assertEqual(of([line["undecided"], line["violated"], line["held"]]), "violated")
        self.assertEqual(of([{"word": "undecided", "violated": True}]), "undecided")
        self.assertEqual(of([{"word": "unverified", "violated": True}]), "violated")

    def test_loaded_is_the_same(self):
        r, loaded = vibrospice.run(VIOLATED), vibrospice.load("violated")
        for name, q in r.measures.items():
            self.assertTrue(loaded.measures[name] == q or math.isnan(q), name)
        self.assertEqual((loaded.status, loaded.held, loaded.word), (3, False, "violated"))
        self.assertEqual((loaded.messages, loaded.text), ([], ""))

    def test_a_temporary_folder_goes_with_its_result(self):
        r = vibrospice.run("paper", until="1 ms")
        path = r.path
        self.assertTrue((path / "run.csv").is_file())
        del r
        gc.collect()
        self.assertFalse(path.parent.exists())

    def test_a_replaced_run_is_not_mixed_up(self):
        r = vibrospice.run("paper", until="1 ms", out="twice")
        vibrospice.run("paper", until="2 ms", out="twice")
        with self.assertRaisesRegex(vibrospice.Error, "has replaced this file"):
            r.columns["i"]

    def test_a_damaged_file_is_refused(self):
        vibrospice.run("paper", until="1 ms", out="damaged")
        path = pathlib.Path("damaged/run.csv")
        text = path.read_text()
        for torn, why in ((text[:-20], "cells under"),
                          (text.replace("0.0001,0", "0.0001,x"), "'x'")):
            path.write_text(torn)
            with self.assertRaisesRegex(vibrospice.Error, why):
                vibrospice.load("damaged").columns["i"]

    def test_orbits(self):
        r = vibrospice.steady("paper", set={"firing.every": 1})
        self.assertEqual(len(r.summary["multipliers"]), 8)
        self.assertEqual(r.measures["power_in"].unit, "W")
        scene = vibrospice.Scene("paper").over({"firing.every": 1})
        self.assertEqual(scene.steady().measures["power_in"], r.measures["power_in"])
        self.assert_columns(r.columns, r.path / "run.csv")
        branch = vibrospice.steady("paper", set={"firing.every": 1}, out="branch",
                                   along="firing.angle=130deg..129deg")
        for b in (branch, vibrospice.load("branch")):
            self.assert_columns(b.columns, "branch/branch.csv", {"state", "beyond", "mark"})
            self.assertEqual(b.summary["along"], "firing.angle")


class Stepped(Case):
    SCENE = {"firing": {"every": 1}, "run": {"tier": "switched", "until": "60 ms"},
             "record": ["p", "i"]}

    def start(self, **more):
        run = vibrospice.Run(self.SCENE, **more)
        self.addCleanup(run.close)
        return run

    def assert_error(self, status, why, call, *arguments):
        with self.assertRaisesRegex(vibrospice.Error, why) as raised:
            call(*arguments)
        self.assertEqual(raised.exception.status, status)

    def test_the_bytes_of_a_run(self):
        scene = vibrospice.Scene("paper").over({"run.until": "20 ms"})
        r = scene.run(out="stepped")
        printed("run", "paper", "--until=20ms", "--reproducible", "--output=at_once")
        self.assertEqual(*(sorted(os.listdir(folder)) for folder in ("stepped", "at_once")))
        for file in os.listdir("stepped"):
            self.assertEqual(*(pathlib.Path(folder, file).read_bytes()
                               for folder in ("stepped", "at_once")))
        self.assertEqual(r.measures["i_peak"].unit, "A")

    def test_what_a_run_tells(self):
        run = self.start(set={"run.until": "40 ms"})
        self.assertEqual((run.time, run.until, run.until.unit), (0, 0.04, "s"))
        angle = run.inputs["firing.angle"]
        self.assertEqual((angle, angle.unit, angle.least, angle.largest), (100, "deg", 0, 180))
        self.assertIn("angle", angle.about)
        run.to(0.02)
        self.assertEqual(run.time, 0.02)
        self.assertEqual(run.columns.units, {"t_s": "s", "p_m": "m", "i_a": "A"})
        self.assertEqual(run.values["p_m"].unit, "m")
        self.assertIn("<td>p_m</td>", run._repr_html_())
        self.assertRegex(repr(run), r"<Run at 0.02 s of 0.04 s, \d+ rows>")
        so_far = list(run.columns["p"])
        run.to(0.04)
        self.assertEqual(so_far, list(run.columns["p"])[:len(so_far)])
        self.assertEqual(type(run.columns["p"]).__name__, "ndarray" if numpy else "list")

    def test_rows_are_those_of_the_file(self):
        run = self.start()
        run.to(0.025)
        run.to(0.06)
        table = run.finish().columns
        for name in table:
            self.assertEqual([f"{x:.9g}" for x in run.columns[name]],
                             [f"{x:.9g}" for x in table[name]], name)

    def test_inputs_change_what_follows(self):
        run, other = self.start(), self.start()
        other.input("firing.angle", 100)
        run.input("firing.angle", vibrospice.Quantity(100, "deg"))
        self.assertEqual(list(run.columns.units)[-1], "firing_angle_rad")
        run.to(0.02)
        run.input("firing.angle", 150)
        run.to(0.06)
        other.to(0.06)
        row = sum(t < 0.02 for t in other.columns["t"])
        self.assertEqual(list(run.columns["p"])[:row], list(other.columns["p"])[:row])
        self.assertLess(max(run.columns["i"][row:]), 0.5 * max(other.columns["i"][row:]))

    def test_a_law(self):
        called = []

        def law(run, now):
            self.assertEqual(now["t_s"], run.time)
            called.append(now["t_s"].value)
            return {"firing.angle": 150} if len(called) < 3 else None
        scene = vibrospice.Scene(self.SCENE)
        r = scene.run(law=law, every=0.02)
        self.assertEqual([round(t, 9) for t in called], [0, 0.02, 0.04])
        scene.over({"run.until": "55 ms"}).run(law=law, every=0.011)  # five times that is below 0.055
        self.assertEqual(len(called), 3 + 5)
        fixed = vibrospice.run(self.SCENE, angle="150 deg")
        self.assertAlmostEqual(r.measures["i_peak"], fixed.measures["i_peak"], delta=1e-9)

    def test_a_state_is_exact(self):
        run, other = self.start(), self.start()
        run.to(0.02)
        state = run.save()
        run.to(0.06)
        seen = list(run.columns["p"])
        run.restore(state)
        self.assertEqual(run.time, 0.02)
        self.assertLess(run.columns.rows(), len(seen))
        other.restore(state)
        for r in (run, other):
            r.to(0.06)
            self.assertEqual(list(r.columns["p"]), seen)

    def test_a_step_stops(self):
        run = self.start()
        run.to(0.06, step=lambda row: row["t_s"] >= 0.01)
        self.assertLess(run.time, 0.011)
        with self.assertRaises(ZeroDivisionError):
            run.to(0.06, step=lambda row: 1 / 0)
        run.to(0.06)
        self.assertEqual(run.time, 0.06)

    def test_an_interrupt(self):
        run = self.start(set={"run.until": "1000 s", "run.sample": "1 ms"})
        threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
        with self.assertRaises(KeyboardInterrupt):
            run.to(1000)
        now = run.time
        run.to(now + 0.01)
        self.assertIs(signal.getsignal(signal.SIGINT), signal.default_int_handler)

    def test_what_is_wrong(self):
        run = self.start()
        self.assert_error(2, "no input 'angel'", run.input, "angel", 3)
        self.assert_error(2, "in deg, not in rad", run.input, "firing.angle",
                          vibrospice.Quantity(3, "rad"))
        self.assert_error(2, "above 0", run.control, None, 0)
        self.assert_error(2, "has no key 'angel'", vibrospice.Run, {"firing": {"angel": 3}})
        self.assert_error(13, "after the run.s end", run.to, 0.07)
        run.close()
        run.close()
        self.assert_error(10, "no such run", run.to, 0.01)
        self.assertIn("closed", repr(run) and run._repr_html_())

    def test_without_the_library(self):
        none = vibrospice.Error(None, ["a Run needs libvibrospice.so.0"])
        scene = vibrospice.Scene(self.SCENE)
        with unittest.mock.patch("vibrospice.engine._library_of", side_effect=none):
            self.assertGreater(scene.run().measures["i_peak"], 0)
            self.assert_error(None, "needs libvibrospice", scene.run, lambda run, now: None)
        with unittest.mock.patch("vibrospice.engine.__version__", "0.0.0"):
            self.assert_error(None, "0.0.0", vibrospice.engine._library_of.__wrapped__, PROGRAM)


class Inputs(Case):
    def test_a_dict_of_anything_plain(self):
        r = vibrospice.run({"firing": {"angle": [["0 s", "160 deg"], ("1 s", "100 deg")],
                                       "every": 1}, "run": {"until": "5 ms"}}, tolerance=1e-3)
        self.assertEqual(r.scene["run"]["tolerance"]["value"], 1e-3)
        with self.assertRaisesRegex(TypeError, "a scene has numbers"):
            vibrospice.run({"run": {"until": object()}})

    def test_a_quantity_keeps_its_unit(self):
        at = vibrospice.Quantity(6.3, "ms")
        for scene, settings in (({"run": {"until": at}}, {}), ({}, {"run.until": at})):
            r = vibrospice.run(scene, set=settings)
            self.assertEqual(r.columns["t_s"][-1], 0.0063)
        self.assertEqual(vibrospice.run("paper", until=at).columns["t_s"][-1], 0.0063)
        for other in (copy.deepcopy(at), pickle.loads(pickle.dumps(at))):
            self.assertEqual((other.value, other.unit, repr(other)), (6.3, "ms", "6.3 ms"))

    def test_bad_input(self):
        with self.assertRaises(vibrospice.Error) as caught:
            vibrospice.run({"firing": {"angle": "95 deg", "evry": 1}})
        self.assertEqual(caught.exception.status, 2)
        self.assertRegex(str(caught.exception),
                         r"^scene.yaml:4:\d+: firing has no key 'evry'; .*\n  \"evry\": 1$")
        with self.assertRaisesRegex(vibrospice.Error, "440 has no unit"):
            vibrospice.run("paper", set={"supply.voltage": 440})

    def test_a_run_that_fails(self):
        with self.assertRaisesRegex(vibrospice.Error, "meets the pole cover") as caught:
            vibrospice.run("paper", until="60 ms", angle="20 deg", set={"firing.every": 1})
        e = caught.exception
        self.assertEqual(e.status, 1)
        self.assertNotIsInstance(e, vibrospice.Interrupted)
        self.assertTrue(0.005 < e.result["t_s"][-1] < 0.01076, e.result["t_s"][-1])

    def test_a_run_that_is_stopped(self):
        fake("echo 'vibrospice: stopped by a signal' >&2; exit 75\n")
        with self.assertRaises(vibrospice.Interrupted) as caught:
            vibrospice.run("paper")
        self.assertEqual((caught.exception.status, caught.exception.messages),
                         (75, ["stopped by a signal"]))
        fake("kill -9 $$\n")
        with self.assertRaisesRegex(vibrospice.Error, "ended by signal 9"):
            vibrospice.run("paper")

    def test_warnings_are_told_twice(self):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            r = vibrospice.run("paper", tier="circuit", until="1 ms", out="warned",
                               set={"supply.resistance": "0 ohm"})
            loaded = vibrospice.load("warned")
        self.assertTrue(any("ngspice has no resistor of 0 ohm" in w for w in r.warnings))
        self.assertEqual(loaded.warnings, r.warnings)
        self.assertEqual([str(w.message) for w in caught], 2 * r.warnings)
        for w in caught:
            self.assertEqual((w.category, w.filename), (vibrospice.Warned, __file__))

    def test_warnings_that_summary_json_lacks(self):
        fake(f"'{PROGRAM}' \"$@\"\necho 'vibrospice: warning: one more' >&2\n")
        with self.assertWarnsRegex(vibrospice.Warned, "one more"):
            r = vibrospice.run("paper", until="1 ms")
        self.assertEqual(r.warnings[-1], "one more")

    def test_names_are_no_options(self):
        for name in ("-x", "--help", "--version"):
            with self.assertRaisesRegex(vibrospice.Error, f"no scene '{name}'"):
                vibrospice.run(name)
        shutil.copy(TESTS / "../spice/scenes/paper.yaml", "--help")
        self.assertEqual(vibrospice.run("--help", until="1 ms").status, 0)
        with self.assertRaisesRegex(vibrospice.Error, "-o"):
            vibrospice.run("paper", set={"-o": "elsewhere"}, until="1 ms")
        r = vibrospice.run("paper", until="1 ms", out="-o")
        self.assertEqual(len(vibrospice.load("-o").columns), len(r.columns))
        with self.assertRaisesRegex(TypeError, "is no option"):
            vibrospice.run("paper", **{"until=1ms --set": "x"})
        with self.assertRaisesRegex(TypeError, "json: is not for Python"):
            vibrospice.run("paper", json=True)

    def test_no_shell(self):
        with self.assertRaises(vibrospice.Error):
            vibrospice.run("paper; touch made", tier="$(touch made)", set={"a`touch made`": "|"})
        self.assertFalse(os.path.exists("made"))

    def test_where_the_program_is(self):
        del os.environ["VIBROSPICE"]
        path = os.environ["PATH"]
        self.addCleanup(os.environ.__setitem__, "PATH", path)
        python = pathlib.Path(sys.executable).absolute()
        for folder, module in (("there/bin", "there/lib/python3/dist-packages/vibrospice"),
                               ("tree/build", "tree/tools/python/vibrospice")):
            pathlib.Path(folder).mkdir(parents=True)
            pathlib.Path(folder, "vibrospice").symlink_to(PROGRAM)
            shutil.copytree(pathlib.Path(vibrospice.__file__).parent, module)
            found = subprocess.run([python, "-c", "import vibrospice; print(vibrospice.program())"],
                                   stdout=subprocess.PIPE, encoding="utf-8", check=True,
                                   env={"PATH": "/nowhere",
                                        "PYTHONPATH": os.path.abspath(os.path.dirname(module))})
            self.assertEqual(found.stdout.strip(), os.path.abspath(folder) + "/vibrospice")
        os.environ["PATH"] = os.path.abspath("there/bin")
        self.assertEqual(vibrospice.program(), os.path.abspath("there/bin/vibrospice"))
        pathlib.Path("wheel").mkdir()
        shutil.copytree(pathlib.Path(vibrospice.__file__).parent, "wheel/vibrospice")
        pathlib.Path("wheel/vibrospice/bin").mkdir()
        own = pathlib.Path("wheel/vibrospice/bin/vibrospice")
        own.symlink_to(PROGRAM)
        for named in ({}, {"VIBROSPICE": "/nowhere/vibrospice"}):
            said = subprocess.run([python, "-m", "vibrospice", "--version"], stdout=subprocess.PIPE,
                                  encoding="utf-8", check=True,
                                  env={**os.environ, **named, "PYTHONPATH": os.path.abspath("wheel")})
            self.assertEqual(said.stdout, printed("--version"))
        found = subprocess.run([python, "-c", "import vibrospice; print(vibrospice.program())"],
                               stdout=subprocess.PIPE, encoding="utf-8", check=True,
                               env={**os.environ, "PYTHONPATH": os.path.abspath("wheel")})
        self.assertEqual(found.stdout.strip(), os.path.abspath(own))
        os.environ["VIBROSPICE"] = "/nowhere/vibrospice"
        with self.assertRaisesRegex(vibrospice.Error, "no such program"):
            vibrospice.run("paper")

    def test_versions(self):
        self.assertIn(f"vibrospice {vibrospice.__version__}", printed("--version"))
        project = (TESTS / "../tools/python/pyproject.toml").read_text(encoding="utf-8")
        self.assertIn(f'version = "{vibrospice.__version__}"', project)


class Studies(Case):
    def assert_study(self, s, folder):
        self.assert_columns(s.columns, f"{folder}/study.csv", WORDS)
        self.assertEqual([row["firing.angle_deg"] for row in s], [90, 105, 120, 90, 105, 120])
        self.assertEqual([row["case"] for row in s], list(range(6)))

    def test_rows(self):
        s = vibrospice.study(STUDY, jobs=1, keep="runs")
        self.assert_study(s, s.path)
        self.assertEqual((s.status, s.held, s.warnings, s.failures), (0, None, [], []))
        units = s.units
        self.assertEqual([units[c] for c in ("supply.voltage_v", "firing.angle_deg", "i_peak_a",
                                             "p_min_m", "margin_least", "id")],
                         ["V", "deg", "A", "m", "", ""])
        self.assertEqual(list(s.columns["i_peak"]), [row["i_peak_a"] for row in s])
        # a case is the run of its scene, to the 12 digits of summary.json
        r = vibrospice.run("paper", tier="switched", until="15 ms", angle="105 deg")
        self.assertEqual(s[1]["i_peak_a"], r.measures["i_peak"].value)
        self.assertEqual(list(s.run(1)["i"]), list(r.columns["i"]))
        self.assertEqual(list(vibrospice.load("study/runs/1")["i"]), list(r.columns["i"]))
        self.assert_study(vibrospice.load("study"), "study")
        self.assertIn("<th>i_peak_a</th>", s._repr_html_())

    def test_what_columns_are(self):
        s = vibrospice.load("study")
        about = s.columns.about
        self.assertEqual(list(about), list(s.columns))
        self.assertEqual({n for n, c in about.items() if c["cells"] == "text"}, WORDS)
        self.assertEqual([about[n]["role"] for n in ("case", "supply.voltage_v", "p_min_m",
                                                     "margin_least")],
                         ["case", "axis", "measure", "margin_least"])
        self.assertEqual((about["p_min_m"]["quantity"], about["p_min_m"]["of"]), ("p_min", "p"))
        shutil.copytree("study", "unsaid")
        manifest = s.manifest.copy()
        del manifest["columns"]
        pathlib.Path("unsaid/manifest.json").write_text(json.dumps(manifest))
        with self.assertRaisesRegex(vibrospice.Error, "unsaid: .* older version"):
            vibrospice.load("unsaid")

    def test_slices(self):
        s = vibrospice.load("study")
        self.assertEqual([row["case"] for row in s[1:4:2]], [1, 3])
        self.assertEqual(s[-1]["case"], 5)
        with self.assertRaises(IndexError):
            s[6]

    @unittest.skipUnless("--format" in printed("study", "--help"), "the program has one format")
    def test_formats(self):
        """Columns for numpy, and packed rows, hold what study.csv has."""
        plain = vibrospice.load("study")
        arrays = vibrospice.study(STUDY, jobs=1, out="arrays", format="npy")
        self.assertEqual(arrays.columns.path.name, "columns.json")
        self.assertEqual(str(list(arrays)), str(list(plain)))
        self.assertEqual(arrays.units, plain.units)
        with open("arrays/columns/i_peak_a.npy", "r+b") as file:
            file.truncate(os.path.getsize("arrays/columns/i_peak_a.npy") - 1)
        with self.assertRaisesRegex(vibrospice.Error, "not the 6 elements"):
            vibrospice.load("arrays")
        if not shutil.which("zstd"):
            return
        packed = vibrospice.study(STUDY, jobs=1, out="packed", format="csv.zst")
        self.assertEqual(str(list(packed)), str(list(plain)))
        with open("packed/study.csv.zst", "r+b") as file:
            file.truncate(os.path.getsize("packed/study.csv.zst") - 10)
        with self.assertRaisesRegex(vibrospice.Error, "study.csv.zst"):
            vibrospice.load("packed")

    def test_shards(self):
        for k in (1, 2):
            with self.assertWarnsRegex(vibrospice.Warned, f"3 of 6 cases are here: shard {k} of 2"):
                shard = vibrospice.study(STUDY, shard=f"{k}/2", jobs=1, out=f"shards/{k}")
            self.assertEqual((len(shard), shard.held), (3, None))
            if k == 1:
                with self.assertRaises(vibrospice.Error) as caught:
                    vibrospice.load("shards")
                self.assertIn(caught.exception.status, (1, 2))
        merged = vibrospice.load("shards")
        # as texts, in which NaN is equal to itself
        self.assertEqual(str(list(merged)), str(list(vibrospice.load("study"))))
        self.assertFalse(os.path.exists("shards/study.csv"))  # loading writes nothing there
        printed("merge", "shards")
        self.assert_study(vibrospice.load("shards"), "shards")

    def test_ratings(self):
        for other, expected in (("12 nF", (0, True, [0, 0])), ("1 uF", (3, False, [0, 3]))):
            s = vibrospice.study({"scene": VIOLATED, "vary": {"circuit.c1": ["10 nF", other]},
                                  "report": ["thyristor.di_dt"]}, jobs=1)
            self.assertEqual((s.status, s.held, [row["status"] for row in s]), expected)

    def test_failed_cases(self):
        with self.assertRaises(vibrospice.Error) as caught, \
                self.assertWarnsRegex(vibrospice.Warned, "1 of 2 cases failed"):
            vibrospice.study(FAILING, jobs=1)
        self.assertEqual(caught.exception.status, 1)
        s = caught.exception.result
        self.assertEqual(([row["case"] for row in s], s.held), ([1], None))
        self.assertEqual([(f["case"], f["firing.angle_deg"]) for f in s.failures], [(0, 20)])
        self.assertIn("meets the pole cover", s.failures[0]["why"])

    def test_what_is_there_is_not_replaced(self):
        """Status 2 does not hand out the older study, which may be another."""
        with self.assertRaisesRegex(vibrospice.Error, "1 of 2 cases failed"):
            vibrospice.study(FAILING, jobs=1, out="older")
        with self.assertRaisesRegex(vibrospice.Error, "overwrite") as caught:
            vibrospice.study(STUDY, jobs=1, out="older")
        self.assertEqual((caught.exception.status, caught.exception.result), (2, None))
        vibrospice.study(STUDY, jobs=1, out="older", overwrite=True)
        self.assertEqual(len(vibrospice.study(STUDY, jobs=1, out="older", resume=True)), 6)

    def test_a_scene_of_its_own_goes_on(self):
        """A study whose scene is a dict is the same study in the next call, and in each shard; also
        where there is no place to keep the scene in it runs."""
        study = {"scene": {"run": {"until": "10 ms", "tier": "switched"}},
                 "vary": {"firing.angle": ["90 deg", "95 deg"]}, "report": ["i_peak"]}
        for _ in range(2):
            self.assertEqual(len(vibrospice.study(study, jobs=1, out="own", resume=True)), 2)
        for part in ("1", "2"):
            vibrospice.study(study, jobs=1, shard=f"{part}/2", out=f"parts/{part}")
        self.assertEqual(len(vibrospice.load("parts")), 2)
        with unittest.mock.patch.dict(os.environ, {"XDG_CACHE_HOME": "/dev/null"}):
            self.assertEqual(len(vibrospice.study(study, jobs=1)), 2)

    def test_a_study_that_is_not_finished(self):
        os.mkdir("unfinished")
        shutil.copy("study/journal", "unfinished")
        with self.assertRaisesRegex(vibrospice.Error, "resume=True"):
            vibrospice.load("unfinished")
        os.mkdir("empty")
        with self.assertRaisesRegex(vibrospice.Error, "neither a run's nor a study's"):
            vibrospice.load("empty")

    def test_words_that_look_like_numbers(self):
        shutil.copytree("study", "ids")
        path = pathlib.Path("ids/study.csv")
        lines = path.read_text().splitlines()
        names = ["1234567890123456", "12345e6789012345", "0000000000000001"] * 2
        for k, name in enumerate(names):
            lines[k + 1] = re.sub(r"^(\d+),\w+,", rf"\1,{name},", lines[k + 1])
        path.write_text("\n".join(lines) + "\n")
        self.assertEqual([row["id"] for row in vibrospice.load("ids")], names)
        decks = vibrospice.study({"scene": "paper", "set": {"run.until": "1 ms"},
                                  "vary": {"circuit.deck": ["halfwave_bare", "halfwave_paper"]},
                                  "report": ["i_peak"]}, jobs=1)
        self.assertEqual(list(decks.columns["circuit.deck"]), ["halfwave_bare", "halfwave_paper"])


@unittest.skipUnless(shutil.which("gnuplot"), "gnuplot is missing")
class Designs(Case):
    """A converter whose resistor is chosen by the power that it bears."""
    DESIGN = {"scene": "paper", "report": ["i_peak"],
              "set": {"circuit.deck": "halfwave_paper", "run.until": "45 ms"},
              "catalogue": {"prices": "prices.csv",
                            "choose": {"circuit.r1": {"kind": "resistor", "values": ["4.7 kohm"]}}},
              "threats": {"swell": {"kind": "swell", "level": "110 %", "duration": "20 ms"}}}

    def design(self, *sizes, **more):
        rows = "".join(f"R{w},resistor,{w / 10},{w}\n" for w in sizes)
        pathlib.Path("prices.csv").write_text("part,kind,price,p_rated_w\n" + rows, encoding="utf-8")
        return vibrospice.design({**self.DESIGN, **more}, jobs=1)

    def test_an_answer(self):
        d = self.design(20, 50)
        self.assertEqual((d.word, d.held, d.status, d.price), ("proved", True, 0, 2))
        self.assertEqual(d.choice["circuit.r1"]["part"], "R20")
        self.assertEqual((list(d.bill["part"]), d.bill.row(0)["p_rated_w"]), (["R20"], 20))
        self.assertEqual(d.candidates.rows(), 1)
        self.assertIn("holds all", d.proof[0])
        self.assertIn("<td>R20</td>", d._repr_html_())
        self.assertEqual(len(d), d.summary["runs"])
        self.assertIsInstance(vibrospice.load(d.path), vibrospice.Design)
        case = d.choice["circuit.r1"]["least"]["case"]
        self.assertEqual(vibrospice.run(d.scene(case)).measures["i_peak"], d[case]["i_peak_a"])
        with self.assertRaisesRegex(vibrospice.Error, "decided nothing"):
            d.scene(1000)

    def test_no_answer(self):
        d = self.design(0.001)
        self.assertEqual((d.word, d.held, d.status, d.choice), ("nothing holds", False, 3, {}))
        self.assertTrue(math.isnan(d.price))
        self.assertEqual(d.bill.rows(), 0)
        with self.assertRaisesRegex(vibrospice.Error, "budget.runs = 1 is spent") as raised:
            self.design(0.001, 20, budget={"runs": 1})
        self.assertEqual((raised.exception.status, raised.exception.result.held), (4, None))


class Pictures(Case):
    def test_in_a_notebook(self):
        r = vibrospice.run(VIOLATED)
        shown = r._repr_html_()
        self.assertIn("verdict: violated", shown)
        least = min((v for v in r.verdict if v["margin"] is not None), key=lambda v: v["margin"])
        name = least.get("rating") or f"{least['device']}.{least['measure']}"
        self.assertIn(f"<tr><td>{name}</td><td>violated</td><td>{100 * least['margin']:.1f} %", shown)
        self.assertIn('<img src="data:image/png;base64,iVBOR', shown)
        with unittest.mock.patch("vibrospice.plot", side_effect=vibrospice.Error(1, ["gnuplot"])):
            self.assertNotIn("<img", r._repr_html_())

    def test_of_a_run(self):
        r = vibrospice.load("violated")
        for picture in (vibrospice.plot(r), vibrospice.plot(r, "v_ak,i", from_="5 ms", to="6 ms"),
                        vibrospice.plot([r, "violated"], ["p", "i"])):
            self.assertTrue(picture._repr_png_().startswith(b"\x89PNG\r\n\x1a\n"))
            self.assertGreater(len(picture.data), 5000)
            self.assertIsNone(picture._repr_svg_())
        self.assertIn("shown: ", picture.messages[0])
        with self.assertRaisesRegex(vibrospice.Error, "no column 'nope'"):
            vibrospice.plot(r, "nope")

    def test_files(self):
        picture = vibrospice.plot("run", "i", out="i.svg")
        self.assertEqual(pathlib.Path("i.svg").read_bytes(), picture.data)
        self.assertIn("<svg", picture._repr_svg_())
        self.assertIsNone(picture._repr_png_())
        picture.save("again.svg")
        self.assertEqual(pathlib.Path("again.svg").read_bytes(), picture.data)

    def test_of_a_study(self):
        s = vibrospice.load("study")
        self.assertTrue(vibrospice.plot(s)._repr_png_())
        page = vibrospice.report(s)
        self.assertTrue(page.path.samefile("study/report.html"))
        self.assertIn('<img src="data:image/png;base64,iVBOR', s._repr_html_())
        self.assertIn("<iframe", page._repr_html_())


class Tables(Case):
    """As they are with numpy and pandas, and without."""

    def test_kinds_of_columns(self):
        i = vibrospice.load("run").columns["i"]
        s = vibrospice.load("study").columns
        self.assert_columns(s, "study/study.csv", WORDS)
        if numpy is None:
            self.assertEqual((type(i), type(i[0]), type(s["case"][0])), (list, float, int))
            return
        self.assertEqual((type(i), i.dtype, s["case"].dtype, s["id"].dtype),
                         (numpy.ndarray, float, numpy.int64, object))
        file = numpy.genfromtxt("run/run.csv", delimiter=",", names=True)
        self.assertTrue((file["i_a"] == i).all())
        i *= 2  # a column is the user's to change

    def test_numbers_of_numpy_are_taken(self):
        if numpy is None:
            self.skipTest("numpy is missing")
        r = vibrospice.run({"firing": {"first_cycle": numpy.int64(1)}}, until="1 ms",
                           tolerance=numpy.float64(1e-3))
        self.assertEqual(r.scene["run"]["tolerance"]["value"], 1e-3)

    def test_frames(self):
        r, s = vibrospice.load("run"), vibrospice.load("study")
        if pandas is None:
            with self.assertRaises(ImportError):
                r.columns.frame()
            return
        frame = r.columns.frame()
        self.assertEqual(frame.attrs["units"]["i_a"], "A")
        self.assertEqual(list(frame["i_a"]), list(r.columns["i"]))
        self.assertEqual(s.frame()["case"].tolist(), list(range(6)))


class Page(Case):
    """docs/python.md: its examples run, and print what it shows."""

    def test_examples(self):
        page = TESTS / "../docs/python.md"
        blocks = re.findall(r"^```(\w+)\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
        script, tried = "", 0
        for kind, text in blocks:
            if kind == "python":
                script += text
            if kind == "text":
                pathlib.Path("example.py").write_text(script, encoding="utf-8")
                ran = subprocess.run([sys.executable, "example.py"], stdout=subprocess.PIPE,
                                     stderr=subprocess.STDOUT, encoding="utf-8", check=False)
                self.assertEqual((ran.returncode, ran.stdout), (0, text))
                script, tried = "", tried + 1
        self.assertGreaterEqual(tried, 2)

    def test_examples_of_the_module(self):
        for module in (vibrospice, vibrospice.tables, vibrospice.results, vibrospice.engine):
            tried = doctest.testmod(module, extraglobs={"vibrospice": vibrospice})
            self.assertEqual(tried.failed, 0, module.__name__)
            self.assertGreater(tried.attempted, 2, module.__name__)

    def test_links(self):
        page = TESTS / "../docs/python.md"
        for link in re.findall(r"\]\(([^)#]+)", page.read_text(encoding="utf-8")):
            self.assertTrue("://" in link or (page.parent / link).exists(), link)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], sys.argv[1]], verbosity=2, warnings="ignore")
