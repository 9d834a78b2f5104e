# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the program vibrospice and reads what it writes.

    >>> import vibrospice
    >>> result = vibrospice.run("paper", set={"firing.angle": "95 deg"}, until="50 ms")
    >>> result.measures["i_peak"]                 # a float that has a unit and a time
    0.910927698 A at 0.00921772359 s
    >>> len(result.columns["i"])                  # the current's samples
    501
    >>> picture = vibrospice.plot(result, "i,p")  # a notebook shows it

A Run is one that goes on when it is told to, with inputs on the way, over libvibrospice.

The module needs the standard library alone. Columns are numpy arrays where numpy is installed,
lists elsewhere; frame() of a table wants pandas.

Exit statuses of the program become:

    0, 3    a result. Its `held` is False with status 3: a rating is violated or undecided.
    1, 2    vibrospice.Error, with the program's lines
    4       vibrospice.Error: a budget is spent. Of design() its `result` is a Design
    75      vibrospice.Interrupted, an Error: a signal stopped the program

Each warning of the program is in the result's `warnings`, and is a Python warning, too
(vibrospice.Warned).
"""

import os
import pathlib
import tempfile
from typing import Any, Optional, Union

from .calls import (RATING, Warned, __version__, call, expect_good, explain, keep, options_of,
                    out_of, program, sets_of, warn, write)
from .engine import Input, Run, Scene, State
from .results import Design, Page, Picture, Result, Study, rows_of
from .tables import Error, Interrupted, Path, Quantity, SceneLike, Table

__all__ = ["run", "steady", "study", "design", "load", "plot", "report", "program", "Scene", "Run", "State",
           "Input", "Error", "Interrupted", "Warned", "Quantity", "Result", "Study", "Design",
           "Table", "Picture", "Page"]


def _compute(command: str, scene: SceneLike, options: dict, settings: Optional[dict],
             out: Optional[Path], kind: Any) -> Any:
    """Runs a command that writes a folder, and reads the folder."""
    folder, owner = out_of(out)
    with tempfile.TemporaryDirectory(prefix="vibrospice-") as inputs:
        kept = inputs
        is_study = issubclass(kind, Study)
        if is_study and isinstance(scene, dict) and isinstance(scene.get("scene"), dict):
            kept, path = keep(scene["scene"], inputs)
            scene = {**scene, "scene": path}
        path = write(scene, inputs, "study.yaml" if is_study else "scene.yaml")
        status, text, messages = call([command, f"--output={folder}", *options_of(options),
                                       *sets_of(settings), "--", path])
        messages = explain(explain(messages, inputs), kept)
    result = None
    if status in (0, RATING) or is_study and kind.has(folder, status):
        result = kind(folder, status=status, messages=messages, text=text, owner=owner)
        warn(result, 3)
    elif messages and "run.partial.csv" in messages[-1]:
        result = Table(os.path.join(folder, "run.partial.csv"))
        len(result)  # reads it, before a temporary folder goes
    expect_good(status, messages, result)
    return result


# ---- the commands ----

def run(scene: SceneLike, *, set: Optional[dict] = None, out: Optional[Path] = None,
        **options: Any) -> Result:
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


def steady(scene: SceneLike, *, set: Optional[dict] = None, out: Optional[Path] = None,
           **options: Any) -> Result:
    """Finds the periodic orbit of a machine that is fired again and again; returns its Result.

    Arguments and errors are those of run(). The measures are over one period, and `summary` also
    has "multipliers", "harmonics" and "stable". With along="firing.angle=130deg..70deg" the
    columns are those of branch.csv, and `summary` is branch.json.
    """
    return _compute("steady", scene, options, set, out, Result)


def study(study: SceneLike, *, set: Optional[dict] = None, out: Optional[Path] = None,
          **options: Any) -> Study:
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


def design(design: SceneLike, *, set: Optional[dict] = None, out: Optional[Path] = None,
           **options: Any) -> Design:
    """Finds the cheapest parts that hold, and returns them as a Design.

    Arguments are those of study(), of `vibrospice design --help`: jobs=2, resume=True,
    overwrite=True. Where nothing holds the Design's `held` is False.
    Error with status 1: a candidate could not be judged; with 4: the budget is spent. The error's
    `result` is the Design as far as it came.
    """
    return _compute("design", design, options, set, out, Design)


def load(folder: Path) -> Union[Result, Study, Table]:
    """Reads a folder that run, steady, study or design wrote, and returns its Result, Study or
    Design.

    A folder of shards becomes one Study by `vibrospice merge`, in a temporary folder. A folder
    with run.csv alone, as study(keep="runs") makes them, becomes a Table.
    Error: nothing of the kind is there, it is not finished, or shards are missing.
    """
    folder = os.fspath(folder)
    there = {name for name in ("summary.json", "branch.json", "journal", "run.csv")
             if os.path.exists(os.path.join(folder, name))}
    if there & {"summary.json", "branch.json"}:
        return warn(Result(folder), 2)
    if rows_of(pathlib.Path(folder)):
        is_design = os.path.exists(os.path.join(folder, "design.json"))
        return warn(Design(folder) if is_design else Study(folder), 2)
    if "journal" in there:
        raise Error(None, [f"{folder}: this study is not finished; study(..., out=..., "
                           "resume=True) goes on with it"])
    if "run.csv" in there:
        return Table(os.path.join(folder, "run.csv"))
    if any(pathlib.Path(folder).glob("*/journal")):
        merged, owner = out_of(None)
        status, text, messages = call(["merge", f"--output={merged}", "--", folder])
        study = Study(merged, status=status, messages=messages, text=text, owner=owner,
                      shards=folder) if rows_of(pathlib.Path(merged)) else None
        if study:
            warn(study, 2)
        expect_good(status, messages, study)
        if study:
            return study
    raise Error(None, [f"{folder}: neither a run's nor a study's folder"])


def _folders(results: Any) -> "list[str]":
    one = isinstance(results, (Result, Study, str, os.PathLike))
    return [os.fspath(r) for r in ([results] if one else results)]


def plot(results: Any, probes: Any = None, *, from_: Any = None, to: Any = None,
         out: Optional[Path] = None, **options: Any) -> Picture:
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
        status, text, messages = call(["plot", f"--output={path}", *options_of(options), "--",
                                       *_folders(results)])
        expect_good(status, messages)
        messages = [line for line in text.splitlines() if line != path] + messages
        with open(path, "rb") as file:
            return Picture(file.read(), None if out is None else pathlib.Path(out), messages)


def report(result: Any) -> Page:
    """Writes report.html, and pictures, into the folder of a Result or Study, or into a folder;
    returns a Page, which a notebook shows. Error: as plot()."""
    folder, = _folders(result)
    status, _, messages = call(["plot", "--", folder])
    expect_good(status, messages)
    return Page(pathlib.Path(folder) / "report.html", messages)
