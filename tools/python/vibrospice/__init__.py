# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the program vibrospice and reads what it writes.

    import vibrospice
    result = vibrospice.run("paper", set={"firing.angle": "95 deg"}, until="50 ms")
    result.measures["i_peak"]          # 0.9 A at ...: a float that has a unit and a time
    result.columns["i"]                # the current's samples
    vibrospice.plot(result, "i,p")     # a picture; a notebook shows it

The module needs the standard library alone. Columns are numpy arrays where numpy is installed,
lists elsewhere; frame() of a table wants pandas.

Exit statuses of the program become:

    0, 3    a result. Its `held` is False with status 3: a rating is violated or undecided.
    1, 2    vibrospice.Error, with the program's lines
    75      vibrospice.Interrupted, an Error: a signal stopped the program

Each warning of the program is in the result's `warnings`, and is a Python warning, too
(vibrospice.Warned).
"""

import json
import numbers
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import warnings as _warnings
import weakref

from .results import Page, Picture, Result, Study, rows_of
from .tables import Error, Interrupted, Quantity, Table

__version__ = "0.1.0"
__all__ = ["run", "steady", "study", "load", "plot", "report", "program", "Error", "Interrupted",
           "Warned", "Quantity", "Result", "Study", "Table", "Picture", "Page"]

_INTERRUPTED = 75
_RATING = 3


class Warned(UserWarning):
    """The category of what the program warns of."""


# ---- the program ----

def program():
    """Returns the program's path as a str.

    It is $VIBROSPICE; else `vibrospice` on the PATH; else bin/vibrospice of the prefix that this
    module is installed in; else build/vibrospice of the source tree that it lies in.
    Error: there is none, or $VIBROSPICE names no program.
    """
    named = os.environ.get("VIBROSPICE")
    if named:
        found = shutil.which(named)
        if not found:
            raise Error(None, [f"VIBROSPICE={named}: no such program"])
        return found
    found = shutil.which("vibrospice")
    above = pathlib.Path(__file__).resolve().parents
    beside = [above[k] / name for k, name in ((4, "bin/vibrospice"), (3, "build/vibrospice"))
              if k < len(above)]
    for path in beside:
        found = found or shutil.which(str(path))
    if not found:
        raise Error(None, ["no program 'vibrospice' on the PATH or beside the module; "
                           "set VIBROSPICE to its path"])
    return found


def _lines(err):
    """Returns the messages on standard error. A line without the program's name goes on with the
    message before it."""
    lines = []
    for line in err.splitlines():
        if line.startswith("vibrospice: "):
            lines.append(line[len("vibrospice: "):])
        elif lines:
            lines[-1] += "\n" + line
        elif line:
            lines.append(line)
    return lines


def _call(arguments):
    """Runs the program to its end; returns exit status, standard output, messages. When Python is
    interrupted the program is asked to stop, so that a study keeps what it has."""
    child = subprocess.Popen([program(), *arguments], stdin=subprocess.DEVNULL,
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                             encoding="utf-8", errors="replace")
    try:
        out, err = child.communicate()
    except BaseException:
        child.terminate()
        try:
            child.communicate(timeout=20)
        except subprocess.TimeoutExpired:
            child.kill()
            child.communicate()
        raise
    return child.returncode, out, _lines(err)


def _expect_good(status, messages, result=None):
    """Error: the exit status is neither 0 nor 3."""
    if status in (0, _RATING):
        return
    if status < 0:
        messages = messages + [f"the program was ended by signal {-status}"]
    kind = Interrupted if status == _INTERRUPTED else Error
    raise kind(status, messages or [f"exit status {status}, and no message"], result)


def _warn(result, level):
    """Makes Python warnings of the result's; level: how many calls up the user's line stands."""
    for text in result.warnings:
        _warnings.warn(text, Warned, stacklevel=level + 1)
    return result


# ---- what is handed to it ----

def _plain(value):
    """Returns a value as JSON has it. A Quantity becomes a text with its unit."""
    if isinstance(value, Quantity):
        return value.text()
    if isinstance(value, dict):
        return {str(key): _plain(v) for key, v in value.items()}
    if value is None or isinstance(value, (str, bool)):
        return value
    if isinstance(value, numbers.Integral):
        return int(value)
    if isinstance(value, numbers.Real):
        return float(value)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "tolist"):  # numpy's arrays, and its truth values
        return _plain(value.tolist())
    if isinstance(value, (list, tuple, range)):
        return [_plain(v) for v in value]
    raise TypeError(f"{value!r}: a scene has numbers, texts, lists and dicts of these")


def _word(value):
    """Returns a value as text for the command line."""
    value = _plain(value)
    return value if isinstance(value, str) else json.dumps(value)


def _options(options):
    """Returns --name=value for each option; True stands for --name, None and False for nothing."""
    words = []
    for name, value in options.items():
        if not re.fullmatch(r"[a-z][a-z_]*", name):
            raise TypeError(f"{name!r} is no option; a name has small letters and _ for -")
        if name in ("json", "quiet", "output", "help", "usage", "version", "progress"):
            raise TypeError(f"{name}: is not for Python; the result holds everything")
        name = "--" + name.replace("_", "-")
        if value is True:
            words.append(name)
        elif value is not None and value is not False:
            words.append(f"{name}={_word(value)}")
    return words


def _sets(settings):
    return [f"--set={key}={_word(value)}" for key, value in (settings or {}).items()]


def _write(value, folder, name):
    """Writes a dict into the folder as JSON, which YAML includes; returns its path. Anything but a
    dict is a name or path already."""
    if not isinstance(value, dict):
        return os.fspath(value)
    path = os.path.join(folder, name)
    with open(path, "w", encoding="utf-8") as file:
        json.dump(_plain(value), file, indent=1, ensure_ascii=False)
    return path


def _explain(messages, folder):
    """Messages about a dict name a line of the file it was written to. The file's folder is taken
    away, and the line added."""
    def told(message):
        place = re.match(re.escape(folder + os.sep) + r"(\w+\.yaml):(\d+):", message)
        if place:
            with open(os.path.join(folder, place[1]), encoding="utf-8") as file:
                lines = file.read().splitlines()
            if 0 < int(place[2]) <= len(lines):
                message += f"\n  {lines[int(place[2]) - 1].strip()}"
        return message.replace(folder + os.sep, "")
    return [told(message) for message in messages]


class _Owner:
    """A temporary folder that is deleted together with this object, or when Python ends."""

    def __init__(self):
        self.name = tempfile.mkdtemp(prefix="vibrospice-")
        weakref.finalize(self, shutil.rmtree, self.name, ignore_errors=True)


def _out(out):
    """Returns the result's folder and its owner; None of a folder that the user named."""
    if out is not None:
        return os.fspath(out), None
    owner = _Owner()
    return os.path.join(owner.name, "out"), owner


def _compute(command, scene, options, settings, out, kind):
    """Runs a command that writes a folder, and reads the folder."""
    folder, owner = _out(out)
    with tempfile.TemporaryDirectory(prefix="vibrospice-") as inputs:
        if kind is Study and isinstance(scene, dict) and isinstance(scene.get("scene"), dict):
            scene = {**scene, "scene": _write(scene["scene"], inputs, "scene.yaml")}
        path = _write(scene, inputs, "study.yaml" if kind is Study else "scene.yaml")
        status, text, messages = _call([command, f"--output={folder}", *_options(options),
                                        *_sets(settings), "--", path])
        messages = _explain(messages, inputs)
    result = None
    if status in (0, _RATING) or kind is Study and status == 1 and Study.has_failures(folder):
        result = kind(folder, status=status, messages=messages, text=text, owner=owner)
        _warn(result, 3)
    elif messages and "run.partial.csv" in messages[-1]:
        result = Table(os.path.join(folder, "run.partial.csv"))
        len(result)  # reads it, before a temporary folder goes
    _expect_good(status, messages, result)
    return result


# ---- the commands ----

def run(scene, *, set=None, out=None, **options):
    """Runs one scene and returns its Result.

    scene    name of a shipped scene (str), path of a scene file, or a dict with what such a file
             has. Quantities are texts with units ("95 deg"); a Quantity is one, too.
    set      dict of keys that are set over the scene's: {"firing.angle": "95 deg"}
    out      folder to write run.csv, events.csv and summary.json into; an older run's there are
             replaced. None: a temporary folder, deleted together with the Result.
    options  every other option of `vibrospice run --help`, with _ for -: tier="circuit",
             until="50 ms", tolerance=1e-5, angle="95 deg", digits=17, raw=True, allow_code=True

    Paths, also those in a dict, start from the current folder.
    Error: the input is bad (status 2), or the run failed (1); then its `result` is a Table of what
    was computed before, or None. Interrupted: a signal stopped it.
    """
    return _compute("run", scene, options, set, out, Result)


def steady(scene, *, set=None, out=None, **options):
    """Finds the periodic orbit of a machine that is fired again and again; returns its Result.

    Arguments and errors are those of run(). The measures are over one period, and `summary` also
    has "multipliers", "harmonics" and "stable". With along="firing.angle=130deg..70deg" the
    columns are those of branch.csv, and `summary` is branch.json.
    """
    return _compute("steady", scene, options, set, out, Result)


def study(study, *, set=None, out=None, **options):
    """Runs a study and returns it as a Study, whose rows are its cases.

    study    name of a shipped study, path of a study file, or a dict with what such a file has;
             the dict's "scene" may be a dict
    set      as in run(), for every case
    out      folder for study.csv, failures.csv and manifest.json; another study's there is refused
             but for overwrite=True. None: a temporary folder, deleted together with the Study.
    options  of `vibrospice study --help`: jobs=2, shard="1/2", resume=True, overwrite=True,
             keep="runs", case_timeout="60 s", format="npy", allow_code=True

    Error with status 1: cases failed. The error's `result` is the Study of the others, with
    `failures`. Interrupted: a signal stopped it; with `out`, resume=True goes on.
    """
    return _compute("study", study, options, set, out, Study)


def load(folder):
    """Reads a folder that run, steady or study wrote, and returns its Result or Study.

    A folder of shards becomes one Study by `vibrospice merge`, in a temporary folder. A folder
    with run.csv alone, as study(keep="runs") makes them, becomes a Table.
    Error: nothing of the kind is there, it is not finished, or shards are missing.
    """
    folder = os.fspath(folder)
    there = {name for name in ("summary.json", "branch.json", "journal", "run.csv")
             if os.path.exists(os.path.join(folder, name))}
    if there & {"summary.json", "branch.json"}:
        return _warn(Result(folder), 2)
    if rows_of(pathlib.Path(folder)):
        return _warn(Study(folder), 2)
    if "journal" in there:
        raise Error(None, [f"{folder}: this study is not finished; study(..., out=..., "
                           "resume=True) goes on with it"])
    if "run.csv" in there:
        return Table(os.path.join(folder, "run.csv"))
    if any(pathlib.Path(folder).glob("*/journal")):
        merged, owner = _out(None)
        status, text, messages = _call(["merge", f"--output={merged}", "--", folder])
        result = Study(merged, status=status, messages=messages, text=text, owner=owner,
                       shards=folder) if rows_of(pathlib.Path(merged)) else None
        if result:
            _warn(result, 2)
        _expect_good(status, messages, result)
        return result
    raise Error(None, [f"{folder}: neither a run's nor a study's folder"])


def _folders(results):
    one = isinstance(results, (Result, Study, str, os.PathLike))
    return [os.fspath(r) for r in ([results] if one else results)]


def plot(results, probes=None, *, from_=None, to=None, out=None, **options):
    """Draws a run, several runs over one another, or a study; returns a Picture.

    results  a Result, a Study, a folder, or a list of Results and folders of runs
    probes   columns to draw, "v_ak,i" or ["v_ak", "i"]. None: a sheet of the usual ones; a study
             has its first picture.
    from_,to first and last instant, "60 ms" or a measure in s. None: where something happens; the
             Picture's `messages` tell which.
    out      a file to write, .png or .svg. None: a PNG in memory
    options  of `vibrospice plot --help`: fft=True, orbit=True, overlay="measured.csv"

    The program draws by gnuplot. Error: gnuplot is missing, or a folder has no such column.
    """
    if probes is not None and not isinstance(probes, str):
        probes = ",".join(probes)
    options = {"probe": probes, "from": from_, "to": to, **options}
    with tempfile.TemporaryDirectory(prefix="vibrospice-") as folder:
        path = os.path.join(folder, "plot.png") if out is None else os.fspath(out)
        status, text, messages = _call(["plot", f"--output={path}", *_options(options), "--",
                                        *_folders(results)])
        _expect_good(status, messages)
        messages = [line for line in text.splitlines() if line != path] + messages
        with open(path, "rb") as file:
            return Picture(file.read(), None if out is None else pathlib.Path(out), messages)


def report(result):
    """Writes report.html, and pictures, into the folder of a Result or Study, or into a folder;
    returns a Page, which a notebook shows. Error: as plot()."""
    folder, = _folders(result)
    status, _, messages = _call(["plot", "--", folder])
    _expect_good(status, messages)
    return Page(pathlib.Path(folder) / "report.html", messages)
