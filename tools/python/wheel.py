# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a wheel of an installed tree; tools/package --wheel runs it.

usage: wheel.py INSTALLED DIR

Standard library alone, and readelf. Prints the wheel's path. Exit status 77: some file needs a
newer glibc than MOST.
"""

import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import time
import tomllib
import zipfile

MOST = (2, 35)
MACHINES = {62: "x86_64", 183: "aarch64"}  # as a head of ELF has them
HERE = pathlib.Path(__file__).resolve().parent
TAKEN = ("bin", "include", "share/vibrospice", "lib/vibrospice", "lib/ngspice", "lib/libngspice.so.0",
         "lib/libgomp.so.1", "lib/libvibrospice.so.0")
# Debian's packages whose code is in the wheel, as a library of its own or linked.
LINKED = ("libngspice0", "libgomp1", "libgsl-dev", "libfyaml-dev", "libzstd-dev", "zlib1g")


def files_below(path):
    """Yields the files of a folder, or the file itself, with their paths from the folder."""
    if path.is_file():
        yield "", path
    for file in path.rglob("*"):
        if file.is_file() and "__pycache__" not in file.parts:
            yield "/" + file.relative_to(path).as_posix(), file


def contents(installed):
    """Returns {path below the package: file}. A link is its file."""
    taken = [("", HERE / "vibrospice"), *((part, installed / part) for part in TAKEN)]
    return {(to + rest).strip("/"): file for to, path in taken for rest, file in files_below(path)}


def glibc_of(files):
    """Returns the newest version of glibc that a file asks for. SystemExit: it is newer than MOST, or
    a table of addresses is of the short kind, which wants 2.36."""
    needed = (2, 17)
    for file in files:
        with open(file, "rb") as f:
            if f.read(4) != b"\x7fELF":
                continue
        said = subprocess.run(["readelf", "-W", "-V", file], stdout=subprocess.PIPE, check=True,
                              encoding="utf-8").stdout
        for word in re.findall(r"Name: GLIBC_(\S+)", said):
            version = (tuple(map(int, word.split(".")[:2])) if word[0].isdigit() else
                       (2, 36) if word == "ABI_DT_RELR" else (0, 0))
            if version > MOST:
                print(f"package: {file} needs GLIBC_{word}, and a wheel at most 2.{MOST[1]}: build it "
                      "on Debian 12", file=sys.stderr)
                sys.exit(77)
            needed = max(needed, version)
    return needed


def machine_of(program):
    with open(program, "rb") as file:
        return MACHINES[int.from_bytes(file.read(20)[18:], "little")]


def licences(installed):
    """Returns {name: text} of the folder licenses."""
    files = {"LICENSE": HERE.parent.parent / "LICENSE",
             "LICENSE.MIT": installed / "share/vibrospice/LICENSE.MIT"}
    files.update((f"{package}.copyright", pathlib.Path("/usr/share/doc", package, "copyright"))
                 for package in LINKED)
    return {name: file.read_bytes() for name, file in files.items()}


def information(tag):
    """Returns {name: text} of the folder dist-info, and the version."""
    project = tomllib.loads((HERE / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    head = [("Metadata-Version", "2.1"), ("Name", project["name"]), ("Version", project["version"]),
            ("Summary", project["description"]), ("License", project["license"]["text"]),
            ("Requires-Python", project["requires-python"])]
    head += [("Provides-Extra", extra) for extra in extras]
    head += [("Requires-Dist", f"{name}; extra == '{extra}'") for extra in extras
             for name in extras[extra]]
    wheel = [("Wheel-Version", "1.0"), ("Generator", "vibrospice"), ("Root-Is-Purelib", "false"),
             ("Tag", tag)]
    return {"METADATA": "".join(f"{k}: {v}\n" for k, v in head),
            "WHEEL": "".join(f"{k}: {v}\n" for k, v in wheel),
            "entry_points.txt": "[console_scripts]\nvibrospice = vibrospice.__main__:main\n"
            }, project["version"]


def write(path, members, record):
    """Writes {name: (bytes, mode)} in the order of the names, and the list of them at last."""
    date = time.gmtime(max(315532800, int(os.environ.get("SOURCE_DATE_EPOCH", 0))))[:6]
    lines = []
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        def add(name, data, mode):
            entry = zipfile.ZipInfo(name, date)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, (0o100000 | mode) << 16
            archive.writestr(entry, data)
        for name, (data, mode) in sorted(members.items()):
            add(name, data, mode)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            lines.append(f"{name},sha256={digest},{len(data)}\n")
        add(record, "".join(lines) + f"{record},,\n", 0o644)


def main(installed, folder):
    files = contents(installed)
    glibc = glibc_of(files.values())
    tag = f"py3-none-manylinux_{glibc[0]}_{glibc[1]}_{machine_of(files['bin/vibrospice'])}"
    texts, version = information(tag)
    about = f"vibrospice-{version}.dist-info"
    members = {f"vibrospice/{to}": (file.read_bytes(), 0o755 if to.startswith("bin/") else 0o644)
               for to, file in files.items()}
    members.update((f"{about}/{name}", (text.encode(), 0o644)) for name, text in texts.items())
    members.update((f"{about}/licenses/{name}", (data, 0o644))
                   for name, data in licences(installed).items())
    path = folder / f"vibrospice-{version}-{tag}.whl"
    write(path, members, f"{about}/RECORD")
    print(path)


main(*map(pathlib.Path, sys.argv[1:]))
