# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs that are stepped, over libvibrospice by ctypes. `import vibrospice` has what is for users.

The structs and functions are those of vibrospice/vibrospice.h, whose comments say what holds."""

from __future__ import annotations

import array
import contextlib
import ctypes
import functools
import os
import pathlib
import signal
import threading
import weakref
from typing import Any, Callable, Iterator, Mapping, Optional

from .calls import OWN, __version__, json_of, out_of, program, warn, word
from .results import Result, html_table
from .tables import Error, Path, Quantity, SceneLike, Table, handed_out

_TEXT, _ALLOW_CODE = 1, 2
_INPUT, _STOPPED = 2, 16
_STEP = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(ctypes.c_double),
                         ctypes.c_size_t)

Row = Mapping[str, float]
Law = Callable[["Run", Row], Optional[Mapping[str, float]]]


class _Column(ctypes.Structure):
    _fields_ = [(name, ctypes.c_char_p) for name in ("name", "quantity", "unit", "role", "of")]


class _Input(ctypes.Structure):
    _fields_ = [("name", ctypes.c_char_p), ("unit", ctypes.c_char_p), ("least", ctypes.c_double),
                ("largest", ctypes.c_double), ("value", ctypes.c_double),
                ("text", ctypes.c_char_p)]


# ---- the library ----

# What a function takes after the handle.
_OUT, _SIZE = ctypes.c_void_p, ctypes.c_size_t
_FUNCTIONS: "dict[str, list[Any]]" = {
    "set": [ctypes.c_char_p] * 2, "folder": [ctypes.c_char_p], "columns": [_OUT, _OUT],
    "inputs": [_OUT, _OUT], "set_input": [ctypes.c_char_p, ctypes.c_double],
    "run_to": [ctypes.c_double, _STEP, _OUT], "time": [_OUT, _OUT], "values": [_OUT, _OUT],
    "finish": [], "save": [_OUT], "restore": [_OUT], "free": [], "free_state": []}


def _load(name: str) -> Optional[ctypes.CDLL]:
    """Returns the library of that name or path. None: it is not there, or is another version."""
    try:
        library = ctypes.CDLL(name)
        library.vibrospice_version.restype = ctypes.c_char_p
        if library.vibrospice_version().decode() != __version__:
            return None
    except (OSError, AttributeError):
        return None
    library.vibrospice_error.restype = ctypes.c_char_p
    library.vibrospice_open.argtypes = [ctypes.c_char_p, ctypes.c_uint, _OUT]
    for function, arguments in _FUNCTIONS.items():
        getattr(library, f"vibrospice_{function}").argtypes = [ctypes.c_void_p, *arguments]
    return library


@functools.lru_cache(maxsize=None)
def _library_of(path: str) -> ctypes.CDLL:
    """Returns the library that belongs to the program at this path: from beside it, from the prefix,
    from the wheel, or from where the dynamic linker looks. Error: there is none."""
    folder = pathlib.Path(path).resolve().parent
    own = pathlib.Path(OWN).parent / "../lib"
    for place in (folder, folder / "../lib", folder / "../lib64", own, None):
        library = _load(str(place / "libvibrospice.so.0") if place else "libvibrospice.so.0")
        if library:
            return library
    raise Error(None, [f"a Run needs libvibrospice.so.0 {__version__} beside the program {path}"])


_opening = threading.Lock()


def _open(library: ctypes.CDLL, path: str, scene: bytes, flags: int, handle: Any) -> int:
    """Opens with this program, which the library is told of by the environment."""
    with _opening:
        before = os.environ.get("VIBROSPICE_PROGRAM")
        os.environ["VIBROSPICE_PROGRAM"] = path
        try:
            return library.vibrospice_open(scene, flags, handle)
        finally:
            if before is None:
                del os.environ["VIBROSPICE_PROGRAM"]
            else:
                os.environ["VIBROSPICE_PROGRAM"] = before


@contextlib.contextmanager
def _interrupts_into(raised: "list[BaseException]") -> Iterator[None]:
    """Meanwhile puts an interrupt of Python into the list: one that is raised at a callback's first
    line is lost."""
    if (threading.current_thread() is not threading.main_thread()
            or signal.getsignal(signal.SIGINT) is not signal.default_int_handler):
        yield
        return
    signal.signal(signal.SIGINT, lambda *_: raised.append(KeyboardInterrupt()))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


# ---- what a run has ----

class Input(Quantity):
    """An input of a run: the value that it has as the run begins.

    unit, least, largest    its unit, and the range that is allowed
    about                   what it does, and when
    """

    least: float
    largest: float
    about: str

    def __new__(cls, value: float, unit: str, least: float, largest: float, text: str) -> "Input":
        self = super().__new__(cls, value, unit)
        self.least, self.largest, self.about = least, largest, text
        return self


class _Columns(Mapping[str, Any]):
    """The columns of rows that stand one after another in `cells`; each is made when it is asked for."""

    def __init__(self, names: "list[str]", cells: array.array) -> None:
        self.names, self.cells = names, cells

    def __getitem__(self, name: str) -> Any:
        if name not in self.names:
            raise KeyError(name)
        return handed_out(self.cells[self.names.index(name)::len(self.names)], False)

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)


class _Rows(Table):
    """The rows that a run has shown so far, as a Table in memory."""

    def __init__(self, about: Any, cells: array.array) -> None:
        self.about = {c["name"]: {k: v for k, v in c.items() if k != "name"} for c in about}
        self._words: set = set()
        self.cells = cells

    def _read(self) -> Mapping[str, Any]:
        return _Columns(list(self.about), self.cells)

    def __repr__(self) -> str:
        return f"<Table of {self.rows()} rows: {', '.join(self.about)}>"


class State:
    """The state of a run. It is freed with this object."""

    def __init__(self, library: ctypes.CDLL, handle: ctypes.c_void_p, cells: array.array) -> None:
        self.handle, self.cells = handle, cells
        weakref.finalize(self, library.vibrospice_free_state, handle)


class Run:
    """A run that goes on when it is told to, in a process of its own. There may be any number.

    >>> run = vibrospice.Run("paper", set={"run.until": "0.2 s", "firing.every": 1})
    >>> run.input("firing.angle", 120)
    >>> run.to(0.1)
    >>> run.columns.rows()              # of what it has shown so far
    1001
    >>> result = run.finish()           # a Result, as vibrospice.run() returns

    columns  Table of the rows so far, which are run.sample apart: numpy arrays where numpy is
    inputs   {name: Input}: what may be set on the way; which there are depends on the scene

    Error: see vibrospice.h; `status` is 1 where the run failed, 2 where a scene, key, value or input
    is wrong, 12 where a call comes at the wrong time, 13 for an instant that is past or beyond the
    end.
    """

    def __init__(self, scene: SceneLike, *, set: Optional[dict] = None, out: Optional[Path] = None,
                 allow_code: bool = False) -> None:
        """Arguments are those of vibrospice.run(). What they name is read at once."""
        path = os.path.abspath(program())
        self._library = _library_of(path)
        self._handle = ctypes.c_void_p()
        opened = json_of(scene) if isinstance(scene, dict) else os.fspath(scene)
        self._expect(_open(self._library, path, os.fsencode(opened),
                           _TEXT * isinstance(scene, dict) | _ALLOW_CODE * bool(allow_code),
                           ctypes.byref(self._handle)))
        self._end = weakref.finalize(self, self._library.vibrospice_free, self._handle)
        for key, value in (set or {}).items():
            self._call("set", key.encode(), word(value).encode())
        self._folder, self._owner = out_of(out)
        self._call("folder", os.fsencode(self._folder))
        self._show(array.array("d"))
        self.inputs = {i.name.decode(): Input(i.value, i.unit.decode(), i.least, i.largest,
                                              i.text.decode())
                       for i in self._list("inputs", _Input)}

    def _show(self, cells: array.array) -> None:
        """Takes the columns as they are now, and the rows in `cells`."""
        self.columns = _Rows([{name: getattr(c, name).decode() for name, _ in c._fields_}
                              for c in self._list("columns", _Column)], cells)

    def _expect(self, status: int) -> None:
        if status:
            raise Error(status, [self._library.vibrospice_error().decode("utf-8", "replace")])

    def _call(self, function: str, *arguments: Any) -> None:
        self._expect(getattr(self._library, f"vibrospice_{function}")(self._handle, *arguments))

    def _list(self, function: str, kind: Any) -> list:
        first, count = ctypes.POINTER(kind)(), ctypes.c_size_t()
        self._call(function, ctypes.byref(first), ctypes.byref(count))
        return first[:count.value]

    @property
    def time(self) -> Quantity:
        """Where the run is."""
        return Quantity(self._times()[0], "s")

    @property
    def until(self) -> Quantity:
        """Its end, run.until."""
        return Quantity(self._times()[1], "s")

    def _times(self) -> "tuple[float, float]":
        now, end = ctypes.c_double(), ctypes.c_double()
        self._call("time", ctypes.byref(now), ctypes.byref(end))
        return now.value, end.value

    @property
    def values(self) -> "dict[str, Quantity]":
        """{column: Quantity} at the run's time. NaN: not known before the run begins."""
        return {name: Quantity(value, about["unit"]) for value, (name, about) in
                zip(self._list("values", ctypes.c_double), self.columns.about.items())}

    def input(self, name: str, value: float) -> None:
        """Sets an input from now on; value is in its unit. An input that is to change on the way has
        to be set once before the run begins."""
        unit = getattr(value, "unit", None)
        if unit and name in self.inputs and unit != self.inputs[name].unit:
            raise Error(_INPUT, [f"{name} is in {self.inputs[name].unit}, not in {unit}"])
        self._call("set_input", name.encode(), float(value))
        if not self.columns.cells:
            self._show(self.columns.cells)  # the firing angle is a column of a run that is given one

    def to(self, t: float, step: Optional[Callable[[Row], Any]] = None) -> None:
        """Runs on to t, in s. step: is called with each row on the way, {column: float}; where it
        returns something true the run stops at this row. It must not use the run."""
        names, add = list(self.columns.about), self.columns.cells.frombytes
        raised: "list[BaseException]" = []  # an exception cannot pass through C

        def see(_: Any, value: Any, count: int) -> int:
            try:
                add(ctypes.string_at(value, 8 * count))
                return bool(raised or step and step(dict(zip(names, value[:count]))))
            except BaseException as error:  # pylint: disable=broad-except
                raised.append(error)
                return 1
        with _interrupts_into(raised):
            status = self._library.vibrospice_run_to(self._handle, float(t), _STEP(see), None)
        if raised:
            raise raised[0]
        self._expect(0 if status == _STOPPED else status)

    def control(self, law: Law, every: float, until: Optional[float] = None) -> None:
        """Runs on to `until`, None: to the end, and calls law(run, values) each `every` s from now on:
        with the values at this time. It returns {input: value} to set, or None."""
        if not every > 0:
            raise Error(_INPUT, [f"every is {every!r} s; it has to be above 0"])
        begin, end = self.time, self.until if until is None else until
        k = 0
        while self.time < end:
            for name, value in (law(self, self.values) or {}).items():
                self.input(name, value)
            k += 1
            t = begin + k * every
            self.to(t if end - t > 1e-6 * every else end)  # no last call for a product's last bit

    def save(self) -> State:
        """Returns where the run is, before it is finished."""
        handle = ctypes.c_void_p()
        self._call("save", ctypes.byref(handle))
        return State(self._library, handle, self.columns.cells[:])

    def restore(self, state: State) -> None:
        """Takes the run back, or forth, to a state of this or of another run of the scene. What
        follows is, to the bit, what followed before."""
        self._call("restore", state.handle)
        self._show(state.cells[:])

    def finish(self) -> Result:
        """Runs on to the end, and returns the Result."""
        self._call("finish")
        return warn(Result(self._folder, owner=self._owner), 2)

    def close(self) -> None:
        """Ends the run, wherever it is. It ends with this object, too."""
        self._end()

    def __repr__(self) -> str:
        if not self._end.alive:
            return "<Run: closed>"
        return f"<Run at {self.time} of {self.until}, {self.columns.rows()} rows>"

    def _repr_html_(self) -> str:
        if not self._end.alive:
            return "<p>a run that is closed</p>"
        rows = [(name, f"{q.value:.4g}", q.unit) for name, q in self.values.items()]
        return f"<p>at {self.time} of {self.until}</p>" + html_table(("column", "value", "unit"), rows)

    def __enter__(self) -> "Run":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()


class Scene:
    """A scene with keys set over it.

    >>> scene = vibrospice.Scene("paper").over({"run.until": "60 ms", "firing.every": 1})
    >>> result = scene.run(law=lambda run, now: {"firing.angle": 90 + 400 * now["t_s"]}, every=0.02)
    >>> [text for t, text in result.events if text == "thyristor fires"]
    ['thyristor fires', 'thyristor fires', 'thyristor fires']

    scene, set, allow_code    as in vibrospice.run()
    """

    def __init__(self, scene: SceneLike, *, set: Optional[dict] = None,
                 allow_code: bool = False) -> None:
        self.scene, self.set, self.allow_code = scene, dict(set or {}), allow_code

    def over(self, set: dict) -> "Scene":
        """Returns a Scene with further keys set."""
        return Scene(self.scene, set={**self.set, **set}, allow_code=self.allow_code)

    def start(self, out: Optional[Path] = None) -> Run:
        """Returns a Run of it, at its beginning."""
        return Run(self.scene, set=self.set, out=out, allow_code=self.allow_code)

    def steady(self, **options: Any) -> Result:
        """Returns its periodic orbit; options are those of vibrospice.steady()."""
        from . import steady
        return steady(self.scene, set=self.set, allow_code=self.allow_code, **options)

    def run(self, law: Optional[Law] = None, every: float = 0.02,
            out: Optional[Path] = None) -> Result:
        """Runs it to its end, under a law of control as Run.control() has it, where one is given.
        Without a law and a library it does what vibrospice.run() does."""
        from . import run
        try:
            started = self.start(out)
        except Error as error:
            if law or error.status is not None:
                raise
            return run(self.scene, set=self.set, out=out, allow_code=self.allow_code)
        with started:
            if law:
                started.control(law, every)
            return started.finish()
