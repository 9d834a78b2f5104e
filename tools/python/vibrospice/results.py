# SPDX-License-Identifier: GPL-3.0-or-later
"""What the program wrote, as Python objects. `import vibrospice` has what is for users."""

import array
import base64
import collections.abc
import csv
import html
import json
import math
import os
import pathlib
import subprocess


class Error(Exception):
    """The program refused its input or failed, or what it should have written cannot be read.

    status    its exit status: 1 a run, a case or a picture failed; 2 bad usage or input; negative:
              ended by that signal. None: it was not the program that failed.
    messages  its lines on standard error, a list of str, without "vibrospice: "
    result    what there is all the same: the Study of a study with failed cases, the Table of
              run.partial.csv of a run that failed; else None
    """

    def __init__(self, status, messages, result=None):
        super().__init__("\n".join(messages))
        self.status = status
        self.messages = list(messages)
        self.result = result


class Interrupted(Error):
    """A signal stopped the program (exit status 75). A study goes on with resume=True."""


class Quantity(float):
    """A float that knows its unit. Sums and products of it are plain floats.

    unit      as the program writes it: "m", "V/us"; "" of a pure number
    at        when it was met, in s; None where a measure has no time
    measured  what the scene says was measured, in the same unit; else None
    """

    def __new__(cls, value, unit="", at=None, measured=None):
        self = super().__new__(cls, value)
        self.unit, self.at, self.measured = unit, at, measured
        return self

    def __getnewargs__(self):
        return float(self), self.unit, self.at, self.measured

    @property
    def value(self):
        """The plain float. NaN: the run has no such value, as no firing has no time."""
        return float(self)

    def text(self):
        """Returns value and unit as scenes and options take them, with all digits."""
        return f"{float(self)!r} {self.unit}".strip()

    def __repr__(self):
        at = "" if self.at is None else f" at {self.at:.9g} s"
        return f"{float(self):.9g} {self.unit}".strip() + at

    __str__ = __repr__


# ---- tables ----

# Columns of words. An id is one, too, although it may look like a number.
_WORDS = {"id", "weakest", "warnings", "why", "what", "state", "beyond", "mark"}
_COUNTS = {"case", "rung", "status"}
# How the names of columns end, where only the name tells the unit.
_ENDINGS = {"s": "s", "m": "m", "m_s": "m/s", "m_s2": "m/s2", "rad": "rad", "rad_s": "rad/s",
            "rad_s2": "rad/s2", "deg": "deg", "wb": "Wb", "a": "A", "v": "V", "n": "N", "w": "W",
            "j": "J", "k": "K", "hz": "Hz", "n_m": "N.m", "a2_s": "A2.s", "v_s": "V.s"}


def _ending(unit):
    """Returns what a unit makes of the end of a column's name: "_m_s2" of "m/s2"."""
    return "_" + "".join(c.lower() if c.isalnum() else "_" for c in unit) if unit else ""


def _unit_by_name(name):
    """Returns the unit of the longest ending that is known; None: none is."""
    parts = name.split("_")
    for k in range(1, len(parts)):
        if "_".join(parts[k:]) in _ENDINGS:
            return _ENDINGS["_".join(parts[k:])]
    return None


class _NoNumber(Exception):
    """A cell of this column is no number."""


def _number(cell):
    return float(cell) if cell else math.nan


def _read_columns(path, words):
    """Returns {name: array('d') or list of str} of a CSV file. words: columns that are not read as
    numbers. Error: a row is longer or shorter than the header."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = csv.reader(file)
        names = next(rows, [])
        columns = [[] if name in words else array.array("d") for name in names]
        for row in rows:
            if len(row) != len(names):
                raise Error(None, [f"{path}:{rows.line_num}: {len(row)} cells under "
                                   f"{len(names)} names; the file is damaged"])
            for name, column, cell in zip(names, columns, row):
                try:
                    column.append(cell if name in words else _number(cell))
                except ValueError:
                    raise _NoNumber(name, f"{path}:{rows.line_num}: {name}: {cell!r}") from None
    return dict(zip(names, columns))


def _numpy():
    try:
        import numpy
        return numpy
    except ImportError:
        return None


def _handed_out(name, column):
    """Returns a column as users get it: numpy's array where numpy is, else a list."""
    numpy = _numpy()
    if isinstance(column, list):
        return numpy.array(column, dtype=object) if numpy else column
    if name in _COUNTS and not any(map(math.isnan, column)):
        column = array.array("q", map(int, column))
    if numpy:
        return numpy.frombuffer(column, dtype=column.typecode).copy()
    return column.tolist()


class Table(collections.abc.Mapping):
    """Columns of a CSV file by their names: table["p_m"], and table["p"], without the unit.

    A column is a numpy array where numpy is installed, else a list: of float, of int (case, rung,
    status) or of str. An empty cell of numbers is NaN. `units` maps each name to its unit: "" for a
    pure number or a word, None where the file's folder does not tell.

    The file is read when a column is first asked for. Error: it is not there, is damaged, or is
    another than when the Table was made.
    """

    def __init__(self, path, units=None, words=()):
        """units: {name: unit}, or a function that returns that; words: columns of words."""
        self.path = pathlib.Path(path)
        self._units, self._words = units or {}, set(words) | _WORDS
        self._columns = None
        self._state = self._stamp()

    def _stamp(self):
        try:
            s = os.stat(self.path)
        except OSError as e:
            raise Error(None, [f"{self.path}: {e.strerror}"]) from None
        return s.st_ino, s.st_mtime_ns, s.st_size

    def _read(self):
        if self._columns is not None:
            return self._columns
        if self._stamp() != self._state:
            raise Error(None, [f"{self.path}: another run or study has replaced this file"])
        columns = None
        while columns is None:
            try:
                columns = _read_columns(self.path, self._words)
            except _NoNumber as e:
                if self.path.name == "run.csv":
                    raise Error(None, [f"{e.args[1]} is no number; the file is damaged"]) from None
                self._words.add(e.args[0])
        self._columns = {name: _handed_out(name, c) for name, c in columns.items()}
        return self._columns

    @property
    def units(self):
        """{column: unit}, in the order of the columns."""
        if callable(self._units):
            self._units = self._units()
        known = {name: "" for name in self._words | _COUNTS} | dict(self._units)
        return {name: known[name] if name in known else _unit_by_name(name)
                for name in self._read()}

    def name(self, name):
        """Returns a column's full name for one with or without its unit. KeyError: none or more
        than one has it."""
        columns = self._read()
        if name in columns:
            return name
        full = [c for c, unit in self.units.items() if unit and c == name + _ending(unit)]
        if len(full) != 1:
            raise KeyError(f"{name!r} is {' and '.join(full) or 'no column'}; "
                           f"there are {', '.join(columns)}")
        return full[0]

    def __getitem__(self, name):
        return self._read()[self.name(name)]

    def __iter__(self):
        return iter(self._read())

    def __len__(self):
        return len(self._read())

    def rows(self):
        """Yields each row as a dict of its cells by the columns' names."""
        columns = {n: c.tolist() if hasattr(c, "tolist") else c for n, c in self._read().items()}
        for cells in zip(*columns.values()):
            yield dict(zip(columns, cells))

    def frame(self):
        """Returns a pandas DataFrame; its attrs["units"] are the units. ImportError: there is no
        pandas."""
        import pandas
        frame = pandas.DataFrame(dict(self._read()))
        frame.attrs["units"] = self.units
        return frame

    def __repr__(self):
        return f"<Table {self.path}: {', '.join(self._read())}>"


# ---- runs ----

def _load_json(path):
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except OSError as e:
        raise Error(None, [f"{path}: {e.strerror}"]) from None
    except ValueError as e:
        raise Error(None, [f"{path}: {e}"]) from None


def _told(messages):
    """Returns those of the messages that warn."""
    return [m[len("warning: "):] for m in messages or () if m.startswith("warning: ")]


def _merged(first, second):
    return first + [w for w in second if w not in first]


def _word_of(verdict):
    """Returns the verdict's word for the whole: that of its worst line. None: nothing is rated."""
    words = {"violated" if line["violated"] and line["word"] != "undecided" else line["word"]
             for line in verdict}
    return next((w for w in ("violated", "undecided", "unverified", "held") if w in words), None)


class Result:
    """A run, or a periodic orbit.

    path         its folder (pathlib.Path)
    status       0, or 3 where a rating is violated or undecided
    word         "held", "violated", "undecided" (the margin is within its own numerical error),
                 "unverified" (that error was not computed); None: nothing is rated
    held         True with status 0, False with status 3, None where nothing is rated
    measures     {name: Quantity}; one with a value the run does not have is NaN
    verdict      list of dict, a line for each limit: "device", "measure" or "rating", "stress",
                 "limit", "unit", "margin", "margin_error" (both parts of the limit), "word", ...
    weakest, first_to_fail    names of lines of the verdict, or None
    energy       {name: J}, with "residual", which has no unit, and "audit", a text
    warnings     list of str
    messages     all lines of the program on standard error, list of str; [] of a loaded run
    text         the table that the program printed; "" of a loaded run
    scene        every effective parameter, as summary.json has it
    summary      all of summary.json, or of branch.json
    columns      Table of run.csv, or of branch.csv
    events       list of (time in s, text)
    """

    def __init__(self, path, status=None, messages=(), text="", owner=None):
        """Reads the folder. owner: what deletes the folder when it is of no more use. Error: a file
        is missing or damaged."""
        self.path = pathlib.Path(path)
        self._owner = owner
        is_branch = _is_branch(self.path, text)
        self.summary = _load_json(self.path / ("branch.json" if is_branch else "summary.json"))
        self.messages, self.text = list(messages), text
        self.scene = self.summary.get("scene", {})
        self.tier = self.summary.get("tier")
        self.measures = {name: Quantity(math.nan if m["value"] is None else m["value"], m["unit"],
                                        m.get("at_s"), m.get("measured"))
                         for name, m in self.summary.get("measures", {}).items()}
        self.verdict = self.summary.get("verdict", [])
        self.weakest = self.summary.get("weakest")
        self.first_to_fail = self.summary.get("first_to_fail")
        self.energy = self.summary.get("energy", {})
        self.warnings = _merged(self.summary.get("warnings", []), _told(messages))
        self.word = _word_of(self.verdict)
        breached = self.word in ("violated", "undecided")
        self.status = status if status is not None else 3 if breached else 0
        self.held = self.status == 0 if self.verdict or self.status else None
        self.columns = Table(self.path / ("branch.csv" if is_branch else "run.csv"),
                             {} if is_branch else self._probe_units)
        self.events = [] if is_branch else self._read_events()

    def __fspath__(self):
        return str(self.path)

    def _read_events(self):
        events = _read_columns(self.path / "events.csv", {"what"})
        return list(zip(events["t_s"], events["what"]))

    def _probe_units(self):
        """Returns the columns' units as the program lists them for this deck and machine. {}: it is
        not there, or not the deck; the names' endings tell, then."""
        from . import _call
        of = [f"--{key}={self.scene[section][name]}"
              for key, section, name in (("deck", "circuit", "deck"), ("machine", "machine", "model"))
              if name in self.scene.get(section, {})]
        try:
            status, out, _ = _call(["list", *of, "--json", "--", "probes"])
            probes = json.loads(out)["probes"] if status == 0 else []
        except (Error, OSError, ValueError, KeyError, subprocess.SubprocessError):
            probes = []
        return {p["name"] + _ending(p["unit"]): p["unit"] for p in probes}

    def __repr__(self):
        return f"<Result {self.path}: {self.word or 'nothing is rated'}, {len(self.measures)} measures>"

    def _repr_html_(self):
        return _html_of_run(self)


def _is_branch(path, text):
    """A folder may have both an orbit and a branch. What was just printed tells, then; else the
    newer one counts."""
    branch, run = path / "branch.json", path / "summary.json"
    if not branch.exists() or not run.exists():
        return branch.exists()
    if text:
        return "branch.csv" in text
    return branch.stat().st_mtime_ns > run.stat().st_mtime_ns


# ---- studies ----

class Study(collections.abc.Sequence):
    """The cases of a study: len(study), study[0], `for row in study`. A row is a dict.

    path       its folder (pathlib.Path)
    status     0; 3 where a rating is violated or undecided in some case; 1 where a case failed
    held       False where it is in some case; True where all cases are there, none failed and all
               that is rated holds; else None
    columns    Table of study.csv
    units      {column: unit}; None: the manifest does not tell
    failures   list of dict: the cases that failed, with "case", "status" and "why"
    manifest   all of manifest.json: "cases", "done", "failed", "violated", "axes", "report", ...
    warnings   list of str; those of a case begin with "case N: "
    messages, text    as a Result has them
    """

    def __init__(self, path, status=None, messages=(), text="", owner=None, shards=None):
        """Reads the folder; as Result. shards: the folder of shards that this one was merged of."""
        self.path = pathlib.Path(path)
        self._owner = owner
        self.manifest = m = _load_json(self.path / "manifest.json")
        self.messages, self.text, self.shards = list(messages), text, shards
        units = {c["column"]: c["unit"] for c in m["axes"] + m["report"]}
        units |= {"margin_least": "", "margin_error": "", "leaving_bound": ""}
        words = {a["column"] for a in m["axes"]
                 if any(isinstance(v, str) for v in a.get("values", []))}
        self.columns = Table(self.path / "study.csv", units, words)
        self.failures = list(Table(self.path / "failures.csv", units, words).rows())
        for failure in self.failures:
            failure["case"] = int(failure["case"])
        self._rows = list(self.columns.rows())
        self.status = status if status is not None else \
            1 if m["failed"] else 3 if m["violated"] else 0
        is_whole = m["done"] == m["cases"] and not m["failed"]
        is_rated = any(not math.isnan(row["margin_least"]) for row in self._rows)
        self.held = False if m["violated"] else True if is_whole and is_rated else None
        self.warnings = self._find_warnings()

    @staticmethod
    def has_failures(path):
        """Is a study's result in the folder, with cases that failed?"""
        try:
            return _load_json(pathlib.Path(path) / "manifest.json").get("failed", 0) > 0
        except Error:
            return False

    def _find_warnings(self):
        m = self.manifest
        found = []
        if m["done"] < m["cases"]:
            found.append(f"{self.path}: {m['done']} of {m['cases']} cases are here"
                         + (": shard {} of {}".format(*m["shard"]) if m["shard"][1] > 1 else ""))
        if m["failed"]:
            found.append(f"{m['failed']} of {m['cases']} cases failed; `failures` tells why")
        for row in self._rows:
            if row["warnings"]:
                found += [f"case {row['case']}: {w}" for w in row["warnings"].split(" | ")]
        return _merged(found, _told(self.messages))

    @property
    def units(self):
        return self.columns.units

    def __fspath__(self):
        return str(self.path)

    def __len__(self):
        return len(self._rows)

    def __getitem__(self, k):
        return self._rows[k]

    def rows(self):
        """Returns the rows as a list of dict."""
        return list(self._rows)

    def frame(self):
        """Returns a pandas DataFrame, as Table.frame()."""
        return self.columns.frame()

    def run(self, case):
        """Returns the Table of a case's run.csv, which keep="runs" stores. Error: there is none."""
        return Table(self.path / "runs" / str(int(case)) / "run.csv")

    def __repr__(self):
        m = self.manifest
        return (f"<Study {self.path}: {m['done']} of {m['cases']} cases, {m['failed']} failed, "
                f"in {m['violated']} a rating is violated or undecided>")

    def _repr_html_(self):
        return _html_of_study(self)


# ---- what a notebook shows ----

_MOST_ROWS = 20


def _html_table(head, rows):
    cells = "".join(f"<th>{html.escape(h)}</th>" for h in head)
    lines = "".join("<tr>" + "".join(f"<td>{html.escape(c)}</td>" for c in row) + "</tr>"
                    for row in rows)
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{lines}</tbody></table>"


def _html_of_run(r):
    verdict = f"{r.word or 'none'}" + (f"; weakest: {r.weakest}" if r.weakest else "")
    said = "".join(f"<p>warning: {html.escape(w)}</p>" for w in r.warnings)
    rows = [(name, f"{q.value:.4g}", q.unit, "" if q.at is None else f"{q.at:.4g} s")
            for name, q in r.measures.items()]
    return f"<p>verdict: {html.escape(verdict)}</p>{said}" + _html_table(
        ("measure", "value", "unit", "at"), rows)


def _html_of_study(s):
    rows = [[f"{c:.4g}" if isinstance(c, float) else str(c) for c in row.values()]
            for row in s.rows()[:_MOST_ROWS]]
    more = f"<p>and {len(s) - _MOST_ROWS} more rows</p>" if len(s) > _MOST_ROWS else ""
    return f"<p>{html.escape(repr(s))}</p>{_html_table(list(s.columns), rows)}{more}"


class Picture:
    """A picture. A notebook shows it as the last value of a cell.

    data      the file's bytes, of PNG or SVG
    path      where it was written (pathlib.Path); None: it is in memory alone
    messages  what the program said, such as which time is shown
    """

    def __init__(self, data, path, messages):
        self.data, self.path, self.messages = data, path, messages

    def save(self, path):
        """Writes the picture into a file, which should end as the data does."""
        pathlib.Path(path).write_bytes(self.data)

    @property
    def is_png(self):
        return self.data.startswith(b"\x89PNG\r\n\x1a\n")

    def _repr_png_(self):
        return self.data if self.is_png else None

    def _repr_svg_(self):
        return None if self.is_png else self.data.decode("utf-8")

    def __repr__(self):
        return "\n".join([f"<Picture {self.path or 'in memory'}: {len(self.data)} bytes>",
                          *self.messages])


class Page:
    """A report.html at `path` (pathlib.Path). A notebook shows it in a frame."""

    def __init__(self, path, messages):
        self.path, self.messages = path, messages

    def _repr_html_(self):
        source = base64.b64encode(self.path.read_bytes()).decode("ascii")
        return ('<iframe style="width: 100%; height: 40em; border: 0" '
                f'src="data:text/html;charset=utf-8;base64,{source}"></iframe>')

    def __repr__(self):
        return f"<Page {self.path}>"
