# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers with units, and tables of them. `import vibrospice` has what is for users."""

import array
import csv
import io
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
from typing import Any, Iterable, Iterator, List, Mapping, Optional, Type, TypeVar, Union

Path = Union[str, os.PathLike]
SceneLike = Union[str, os.PathLike, dict]


class Error(Exception):
    """The program refused its input or failed, or what it should have written cannot be read.

    status    its exit status: 1 a run, a case or a picture failed; 2 bad usage or input; negative:
              ended by that signal. None: it was not the program that failed.
    messages  its lines on standard error, a list of str, without "vibrospice: "
    result    what there is all the same: the Study of a study with failed cases, the Design of a
              design that came to no answer, the Table of run.partial.csv of a run that failed;
              else None
    """

    def __init__(self, status: Optional[int], messages: List[str], result: Any = None) -> None:
        super().__init__("\n".join(messages))
        self.status = status
        self.messages = list(messages)
        self.result = result


class Interrupted(Error):
    """A signal stopped the program (exit status 75). A study goes on with resume=True."""


_Q = TypeVar("_Q", bound="Quantity")


class Quantity(float):
    """A float that knows its unit. Sums and products of it are plain floats.

    unit      as the program writes it: "m", "V/us"; "" of a pure number
    at        when it was met, in s; None where a measure has no time
    measured  what the scene says was measured, in the same unit; else None

    >>> current = vibrospice.Quantity(0.5, "kA", at=0.01)
    >>> current
    0.5 kA at 0.01 s
    >>> 2 * current, current.text()
    (1.0, '0.5 kA')
    """

    unit: str
    at: Optional[float]
    measured: Optional[float]

    def __new__(cls: Type[_Q], value: float, unit: str = "", at: Optional[float] = None,
                measured: Optional[float] = None) -> _Q:
        self = super().__new__(cls, value)
        self.unit, self.at, self.measured = unit, at, measured
        return self

    def __getnewargs__(self) -> tuple:
        return float(self), self.unit, self.at, self.measured

    @property
    def value(self) -> float:
        """The plain float. NaN: the run has no such value, as no firing has no time."""
        return float(self)

    def text(self) -> str:
        """Returns value and unit as scenes and options take them, with all digits."""
        return f"{float(self)!r} {self.unit}".strip()

    def __repr__(self) -> str:
        at = "" if self.at is None else f" at {self.at:.9g} s"
        return f"{float(self):.9g} {self.unit}".strip() + at

    __str__ = __repr__


# ---- names and units of columns ----

# How the names of columns end, where only the name tells the unit.
_ENDINGS = {"s": "s", "m": "m", "m_s": "m/s", "m_s2": "m/s2", "rad": "rad", "rad_s": "rad/s",
            "rad_s2": "rad/s2", "deg": "deg", "wb": "Wb", "a": "A", "v": "V", "n": "N", "w": "W",
            "j": "J", "k": "K", "hz": "Hz", "n_m": "N.m", "a2_s": "A2.s", "v_s": "V.s"}


def ending_of(unit):
    """Returns what a unit makes of the end of a column's name: "_m_s2" of "m/s2"."""
    return "_" + "".join(c.lower() if c.isalnum() else "_" for c in unit) if unit else ""


def _unit_by_name(name):
    """Returns the unit of the longest ending that is known; None: none is."""
    parts = name.split("_")
    for k in range(1, len(parts)):
        if "_".join(parts[k:]) in _ENDINGS:
            return _ENDINGS["_".join(parts[k:])]
    return None


def load_json(path):
    """Returns what the file holds. Error: it cannot be read."""
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except OSError as e:
        raise Error(None, [f"{path}: {e.strerror}"]) from None
    except ValueError as e:
        raise Error(None, [f"{path}: {e}"]) from None


# ---- rows as text ----

class _NoNumber(Exception):
    """A cell of this column is no number."""


def _open_text(path):
    """Opens a file of text; one whose name ends with .zst is unpacked by Python 3.14 and later, or
    by the program zstd. Error: it cannot be."""
    if pathlib.Path(path).suffix != ".zst":
        return open(path, newline="", encoding="utf-8")
    try:
        from compression import zstd
        return zstd.open(path, "rt", newline="", encoding="utf-8")
    except ImportError:
        pass
    program = shutil.which("zstd")
    if not program:
        raise Error(None, [f"{path}: to unpack it, install the program zstd, or take Python 3.14"])
    unpacked = tempfile.TemporaryFile()
    done = subprocess.run([program, "-qdc", "--", str(path)], stdin=subprocess.DEVNULL,
                          stdout=unpacked, stderr=subprocess.PIPE, check=False)
    if done.returncode:
        unpacked.close()
        said = done.stderr.decode("utf-8", "replace").splitlines()
        raise Error(None, said or [f"{path}: damaged"])
    unpacked.seek(0)
    return io.TextIOWrapper(unpacked, encoding="utf-8", newline="")


def _number(cell):
    return float(cell) if cell else math.nan


def read_columns(path, words):
    """Returns {name: array('d') or list of str} of a CSV file. words: columns that are not read as
    numbers. Error: a row is longer or shorter than the header."""
    with _open_text(path) as file:
        rows = csv.reader(file)
        names = next(rows, [])
        columns = [[] if name in words else array.array("d") for name in names]
        for row in rows:
            if len(row) != len(names):
                raise Error(None, [f"{path}:{rows.line_num}: {len(row)} cells under "
                                   f"{len(names)} names; the file is damaged"])
            for name, column, cell in zip(names, columns, row):
                try:
                    column.append(sys.intern(cell) if name in words else _number(cell))
                except ValueError:
                    raise _NoNumber(name, f"{path}:{rows.line_num}: {name}: {cell!r}") from None
    return dict(zip(names, columns))


def _read_text(path, words):
    """As read_columns, but a column of a study that turns out to have words becomes one of words.
    Error: run.csv or peaks.csv has something else than numbers."""
    while True:
        try:
            return read_columns(path, words)
        except _NoNumber as e:
            if path.name in ("run.csv", "peaks.csv", "run.partial.csv"):
                raise Error(None, [f"{e.args[1]} is no number; the file is damaged"]) from None
            words.add(e.args[0])


# ---- rows as a file for each column, which study(format="npy") makes ----

# Types of elements, all little-endian, and how array calls them.
_ELEMENTS = {"<f8": "d", "<i8": "q", "<i4": "i"}
_ID = 16  # bytes of an id, "|S16"


def _read_npy(path, entry, rows):
    """Returns a column's elements. path: the file, of numpy's format 1.0; entry: what columns.json
    has of it. Error: the file is another."""
    data = path.read_bytes() if path.is_file() else b""
    begin = 10 + int.from_bytes(data[8:10], "little")
    size = rows * (_ID if entry["type"] == "|S16" else 4 if entry["type"] == "<i4" else 8)
    if (data[:8] != b"\x93NUMPY\x01\x00" or len(data) != begin + size
            or f"'{entry['type']}'".encode() not in data[10:begin]):
        raise Error(None, [f"{path}: not the {rows} elements of type {entry['type']} that "
                           "columns.json tells of"])
    if entry["type"] == "|S16":
        return [data[k:k + _ID].rstrip(b"\0").decode("ascii") for k in range(begin, len(data), _ID)]
    column = array.array(_ELEMENTS[entry["type"]])
    column.frombytes(data[begin:])
    if sys.byteorder == "big":
        column.byteswap()
    return [entry["words"][k] for k in column] if "words" in entry else column


def _read_folder(path):
    """Returns {name: elements} of the folder that columns.json, at path, lists."""
    listed = load_json(path)
    return {c["column"]: _read_npy(path.parent / pathlib.Path(c["file"]).name, c, listed["rows"])
            for c in listed["columns"]}


# ---- tables ----

def _numpy():
    try:
        import numpy
        return numpy
    except ImportError:
        return None


def handed_out(column: Any, counts: bool) -> Any:
    """Returns a column as users get it: numpy's array where numpy is, else a list. counts: its cells
    are whole numbers."""
    numpy = _numpy()
    if isinstance(column, list):
        return numpy.array(column, dtype=object) if numpy else column
    if counts and column.typecode == "d" and not any(map(math.isnan, column)):
        column = array.array("q", map(int, column))
    if numpy:
        return numpy.frombuffer(column, dtype=column.typecode).copy()
    return column.tolist()


class Table(Mapping[str, Any]):
    """Columns of a file by their names: table["p_m"], and table["p"], without the unit.

    A column is a numpy array where numpy is installed, else a list: of float, of int (case, rung,
    status) or of str. An empty cell of numbers is NaN. `units` maps each name to its unit: "" for a
    pure number or a word, None where the file's folder does not tell. `about` maps each name to
    what its column is, where the folder tells: a dict with "quantity", "unit", "role" and "of".

    >>> table = vibrospice.run("paper", until="20 ms").columns
    >>> table.units["p_m"], table.name("p"), table.rows()
    ('m', 'p_m', 201)

    The file is read when a column is first asked for. Error: it is not there, is damaged, or is
    another than when the Table was made.
    """

    def __init__(self, path: Path, about: Iterable[dict] = (), words: Iterable[str] = (),
                 owner: Any = None) -> None:
        """path: a CSV file, packed or not, or columns.json of a study. about: what summary.json or
        manifest.json has in "columns". words: further columns of words. owner: what deletes the
        file when it is of no more use."""
        self.path = pathlib.Path(path)
        self._owner = owner
        self.about = {c["name"]: {k: v for k, v in c.items() if k != "name"} for c in about}
        self._words = set(words) | self._of_cells("text")
        self._columns: Optional[Mapping[str, Any]] = None
        self._state = self._stamp()

    def _of_cells(self, cells):
        return {name for name, c in self.about.items() if c.get("cells") == cells}

    def _stamp(self):
        try:
            s = os.stat(self.path)
        except OSError as e:
            raise Error(None, [f"{self.path}: {e.strerror}"]) from None
        return s.st_ino, s.st_mtime_ns, s.st_size

    def _read(self) -> Mapping[str, Any]:
        if self._columns is not None:
            return self._columns
        if self._stamp() != self._state:
            raise Error(None, [f"{self.path}: another run or study has replaced this file"])
        is_text = self.path.suffix != ".json"
        columns = _read_text(self.path, self._words) if is_text else _read_folder(self.path)
        counts = self._of_cells("count")
        handed = {name: handed_out(c, name in counts) for name, c in columns.items()}
        self._columns = handed
        return handed

    @property
    def units(self) -> dict:
        """{column: unit}, in the order of the columns."""
        known = {name: "" for name in self._words} | {n: c["unit"] for n, c in self.about.items()}
        return {name: known[name] if name in known else _unit_by_name(name)
                for name in self._read()}

    def name(self, name: str) -> str:
        """Returns a column's full name for one with or without its unit. KeyError: none or more
        than one has it."""
        columns = self._read()
        if name in columns:
            return name
        full = [c for c, unit in self.units.items() if unit and c == name + ending_of(unit)]
        if len(full) != 1:
            raise KeyError(f"{name!r} is {' and '.join(full) or 'no column'}; "
                           f"there are {', '.join(columns)}")
        return full[0]

    def __getitem__(self, name: str) -> Any:
        return self._read()[self.name(name)]

    def __iter__(self) -> Iterator[str]:
        return iter(self._read())

    def __len__(self) -> int:
        return len(self._read())

    def row(self, k: int) -> dict:
        """Returns row k as a dict of its cells by the columns' names. IndexError: there is none."""
        return {name: column[k].item() if hasattr(column[k], "item") else column[k]
                for name, column in self._read().items()}

    def rows(self) -> int:
        """Returns how many rows there are, in each column."""
        return len(next(iter(self._read().values()), ()))

    def frame(self) -> Any:
        """Returns a pandas DataFrame; its attrs["units"] are the units. ImportError: there is no
        pandas."""
        import pandas
        frame = pandas.DataFrame(dict(self._read()))
        frame.attrs["units"] = self.units
        return frame

    def __repr__(self) -> str:
        return f"<Table {self.path}: {', '.join(self._read())}>"
