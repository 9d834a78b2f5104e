# SPDX-License-Identifier: GPL-3.0-or-later
"""The program as a process: where it is, what it is handed, what it answers. `import vibrospice` has
what is for users."""

import hashlib
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

from .tables import Error, Interrupted, Quantity

__version__ = "0.2.0"

_INTERRUPTED = 75
RATING = 3
OWN = os.path.join(os.path.dirname(os.path.abspath(__file__)), "bin", "vibrospice")  # of a wheel


class Warned(UserWarning):
    """The category of what the program warns of."""


# ---- the program ----

def program() -> str:
    """Returns the program's path as a str.

    It is $VIBROSPICE; else the one in a wheel; else `vibrospice` on the PATH; else bin/vibrospice of
    the prefix that this module is installed in; else build/vibrospice of the source tree that it
    lies in.
    Error: there is none, or $VIBROSPICE names no program.
    """
    named = os.environ.get("VIBROSPICE")
    if named:
        found = shutil.which(named)
        if not found:
            raise Error(None, [f"VIBROSPICE={named}: no such program"])
        return found
    found = shutil.which(OWN) or shutil.which("vibrospice")
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


def call(arguments):
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


def expect_good(status, messages, result=None):
    """Error: the exit status is neither 0 nor 3."""
    if status in (0, RATING):
        return
    if status < 0:
        messages = messages + [f"the program was ended by signal {-status}"]
    kind = Interrupted if status == _INTERRUPTED else Error
    raise kind(status, messages or [f"exit status {status}, and no message"], result)


def warn(result, level):
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


def word(value):
    """Returns a value as text for the command line."""
    value = _plain(value)
    return value if isinstance(value, str) else json.dumps(value)


def options_of(options):
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
            words.append(f"{name}={word(value)}")
    return words


def sets_of(settings):
    return [f"--set={key}={word(value)}" for key, value in (settings or {}).items()]


def write(value, folder, name):
    """Writes a dict into the folder as JSON, which YAML includes; returns its path. Anything but a
    dict is a name or path already."""
    if not isinstance(value, dict):
        return os.fspath(value)
    path = os.path.join(folder, name)
    with open(path, "w", encoding="utf-8") as file:
        file.write(json_of(value))
    return path


def json_of(value):
    return json.dumps(_plain(value), indent=1, ensure_ascii=False)


def keep(scene, inputs):
    """Writes the dict that is a study's scene; returns the file's folder and path. The program
    resumes a study, and merges its shards, if their files have the same text. That text has the
    scene's path, so the same scene is always at the same path: in the user's cache, in a folder
    named by its content. Where there is no such place it is the folder inputs."""
    text = json_of(scene)
    cache = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    folder = os.path.join(os.path.abspath(cache), "vibrospice",
                          hashlib.sha256(text.encode("utf-8", "replace")).hexdigest()[:16])
    path = os.path.join(folder, "scene.yaml")
    try:
        os.makedirs(folder, exist_ok=True)
        with tempfile.NamedTemporaryFile("w", encoding="utf-8", dir=folder, delete=False) as file:
            file.write(text)
        os.replace(file.name, path)  # whole, also where two do this at a time
        return folder, path
    except OSError:
        return inputs, write(scene, inputs, "scene.yaml")


def explain(messages, folder):
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


def out_of(out):
    """Returns the result's folder and its owner; None of a folder that the user named."""
    if out is not None:
        return os.fspath(out), None
    owner = _Owner()
    return os.path.join(owner.name, "out"), owner
