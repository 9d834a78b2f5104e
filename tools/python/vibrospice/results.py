# SPDX-License-Identifier: GPL-3.0-or-later
"""What the program wrote, as Python objects. `import vibrospice` has what is for users."""

from __future__ import annotations

import base64
import html
import math
import pathlib
from typing import Any, Iterable, List, Optional, Sequence, Union

from .tables import Error, Path, Quantity, Table, load_json, read_columns


# ---- runs ----

def _told(messages: Iterable[str]) -> "list[str]":
    """Returns those of the messages that warn."""
    return [m[len("warning: "):] for m in messages if m.startswith("warning: ")]


def _merged(first: "list[str]", second: "list[str]") -> "list[str]":
    return first + [w for w in second if w not in first]


def _word_of(verdict: "list[dict]") -> Optional[str]:
    """Returns the verdict's word for the whole: that of its worst line. None: nothing is rated."""
    words = {"violated" if line["violated"] and line["word"] != "undecided" else line["word"]
             for line in verdict}
    return next((w for w in ("violated", "undecided", "unverified", "held", "waived") if w in words), None)


class Result:
    """A run, or a periodic orbit.

    path         its folder (pathlib.Path)
    status       0, or 3 where a rating is violated or undecided
    word         "held", "violated", "undecided" (the margin is within its own numerical error),
                 "unverified" (that error was not computed), "waived" (all of it is); None: nothing
                 is rated
    held         True with status 0, False with status 3, None where nothing is rated
    measures     {name: Quantity}; one with a value the run does not have is NaN
    verdict      list of dict, a line for each limit: "device", "measure", "stress", "limit" or
                 "rating", "least", "largest", "min", "max"; "unit", "margin", "margin_error" (both
                 parts of the limit), "word", ...
    weakest, first_to_fail    names of lines of the verdict, or None
    happened     list of dict: what must not happen and did, with "what", "device", "at_s", "times",
                 "cause", "expected" (by the scene's key `expect`) and "word"
    did_not_happen    the same for what the scene expects and what did not happen
    not_judged   list of str: the limits that the verdict says nothing about
    waived       list of str: the limits that the scene leaves out, by its key `waive`
    energy       {name: J}, with "residual", which has no unit, and "audit", a text
    warnings     list of str
    messages     all lines of the program on standard error, list of str; [] of a loaded run
    text         the table that the program printed; "" of a loaded run
    scene        every effective parameter, as summary.json has it
    summary      all of summary.json, or of branch.json
    columns      Table of run.csv, or of branch.csv
    peaks        Table of peaks.csv: the rows of `columns` and further ones at the peaks between
                 them. It is `columns` itself where these show every peak.
    events       list of (time in s, text)

    >>> result = vibrospice.run({"circuit": {"deck": "halfwave_paper", "thyristor": "BT151-800R"},
    ...                          "firing": {"angle": "100 deg"}, "run": {"until": "20 ms"}})
    >>> result.word, result.held, result.weakest
    ('violated', False, 'thyristor.di_dt')
    >>> [line["word"] for line in result.verdict if line.get("measure") == "di_dt"]
    ['violated']
    """

    def __init__(self, path: Path, status: Optional[int] = None, messages: Sequence[str] = (),
                 text: str = "", owner: Any = None) -> None:
        """Reads the folder. owner: what deletes the folder when it is of no more use. Error: a file
        is missing or damaged."""
        self.path = pathlib.Path(path)
        self._owner = owner
        is_branch = _is_branch(self.path, text)
        self.summary: dict = load_json(self.path / ("branch.json" if is_branch else "summary.json"))
        self.messages, self.text = list(messages), text
        self.scene: dict = self.summary.get("scene", {})
        self.tier: Optional[str] = self.summary.get("tier")
        self.measures = {name: Quantity(math.nan if m["value"] is None else m["value"], m["unit"],
                                        m.get("at_s"), m.get("measured"))
                         for name, m in self.summary.get("measures", {}).items()}
        self.verdict: List[dict] = self.summary.get("verdict", [])
        self.weakest: Optional[str] = self.summary.get("weakest")
        self.first_to_fail: Optional[str] = self.summary.get("first_to_fail")
        self.happened: List[dict] = self.summary.get("happened", [])
        self.did_not_happen: List[dict] = self.summary.get("did_not_happen", [])
        self.not_judged: List[str] = self.summary.get("not_judged", [])
        self.waived: List[str] = self.summary.get("waived", [])
        self.energy: dict = self.summary.get("energy", {})
        self.warnings = _merged(self.summary.get("warnings", []), _told(messages))
        self.word = _word_of(self.verdict)
        breached = self.word in ("violated", "undecided")
        self.status = status if status is not None else 3 if breached else 0
        self.held = self.status == 0 if self.verdict or self.status else None
        about = self.summary.get("columns", ())
        self.columns = Table(self.path / ("branch.csv" if is_branch else "run.csv"), about,
                             {"state", "beyond", "mark"} if is_branch else (), owner)
        peaks = self.path / "peaks.csv"
        self.peaks = (Table(peaks, about, owner=owner) if not is_branch and peaks.exists()
                      else self.columns)
        self.events = [] if is_branch else self._read_events()

    def __fspath__(self) -> str:
        return str(self.path)

    def _read_events(self) -> "list[tuple[float, str]]":
        events = read_columns(self.path / "events.csv", {"what"})
        return list(zip(events["t_s"], events["what"]))

    def __repr__(self) -> str:
        said = self.word or "nothing is rated"
        return f"<Result {self.path}: {said}, {len(self.measures)} measures>"

    def _repr_html_(self) -> str:
        return _html_of_run(self)


def _is_branch(path: pathlib.Path, text: str) -> bool:
    """A folder may have both an orbit and a branch. What was just printed tells, then; else the
    newer one counts."""
    branch, run = path / "branch.json", path / "summary.json"
    if not branch.exists() or not run.exists():
        return branch.exists()
    if text:
        return "branch.csv" in text
    return branch.stat().st_mtime_ns > run.stat().st_mtime_ns


# ---- studies ----

def rows_of(path: pathlib.Path) -> Optional[pathlib.Path]:
    """Returns the file that has a study's rows, or lists those that do; None: there is none. All
    that a study may have hold the same."""
    names = ("columns/columns.json", "study.csv", "study.csv.zst")
    return next((path / name for name in names if (path / name).is_file()), None)


class Study(Sequence[dict]):
    """The cases of a study: len(study), study[0], `for row in study`. A row is a dict.

    path       its folder (pathlib.Path)
    status     0; 3 where a rating is violated or undecided in some case; 1 where a case failed
    held       False where it is in some case; True where all cases are there, none failed and all
               that is rated holds; else None
    columns    Table of study.csv, study.csv.zst or the folder columns, whichever there is
    units      {column: unit}; None: the manifest does not tell
    failures   list of dict: the cases that failed, with "case", "status" and "why"
    manifest   all of manifest.json: "cases", "done", "failed", "violated", "axes", "report", ...
    warnings   list of str; those of a case begin with "case N: "
    messages, text    as a Result has them
    """

    def __init__(self, path: Path, status: Optional[int] = None, messages: Sequence[str] = (),
                 text: str = "", owner: Any = None, shards: Optional[Path] = None) -> None:
        """Reads the folder; as Result. shards: the folder of shards that this one was merged of."""
        self.path = pathlib.Path(path)
        self._owner = owner
        self.manifest = m = load_json(self.path / "manifest.json")
        self.messages, self.text, self.shards = list(messages), text, shards
        if "columns" not in m:
            raise Error(None, [f"{self.path}: manifest.json does not tell what the columns are; it "
                               "is of an older version, or was merged of shards of one: "
                               "load it with that one, or run the study again"])
        words = {a["column"] for a in m["axes"]
                 if any(isinstance(v, str) for v in a.get("values", []))}
        rows = rows_of(self.path)
        if not rows:
            raise Error(None, [f"{self.path}: a study without its rows"])
        self.columns = Table(rows, m["columns"], words)
        failures = Table(self.path / "failures.csv", m["columns"], words | {"why"})
        self.failures = [failures.row(k) for k in range(failures.rows())]
        self.status = status if status is not None else \
            1 if m["failed"] else 3 if m["violated"] else 0
        is_whole = m["done"] == m["cases"] and not m["failed"]
        is_rated = not all(map(math.isnan, self.columns["margin_least"]))
        self.held = False if m["violated"] else True if is_whole and is_rated else None
        self.warnings = self._find_warnings()

    @staticmethod
    def has(path: Path, status: int) -> bool:
        """Is there the result of a study that ended with this status? Status 1: some cases failed."""
        try:
            return status == 1 and bool(load_json(pathlib.Path(path, "manifest.json"))["failed"])
        except Error:
            return False

    def _find_warnings(self) -> "list[str]":
        m = self.manifest
        found = []
        if m["done"] < m["cases"]:
            found.append(f"{self.path}: {m['done']} of {m['cases']} cases are here"
                         + (": shard {} of {}".format(*m["shard"]) if m["shard"][1] > 1 else ""))
        if m["failed"]:
            found.append(f"{m['failed']} of {m['cases']} cases failed; `failures` tells why")
        for case, said in zip(self.columns["case"], self.columns["warnings"]):
            found += [f"case {case}: {w}" for w in said.split(" | ") if w]
        return _merged(found, _told(self.messages))

    @property
    def units(self) -> dict:
        return self.columns.units

    def __fspath__(self) -> str:
        return str(self.path)

    def __len__(self) -> int:
        return self.columns.rows()

    def __getitem__(self, k: Any) -> Any:
        if isinstance(k, slice):
            return [self.columns.row(n) for n in range(*k.indices(len(self)))]
        return self.columns.row(k)

    def frame(self) -> Any:
        """Returns a pandas DataFrame, as Table.frame()."""
        return self.columns.frame()

    def run(self, case: int) -> Table:
        """Returns the Table of a case's run.csv, which keep="runs" stores. Error: there is none."""
        return Table(self.path / "runs" / str(int(case)) / "run.csv")

    def peaks(self, case: int) -> Table:
        """Returns the same with further rows at the peaks between its rows, where there are such.
        Error: as of run()."""
        peaks = self.path / "runs" / str(int(case)) / "peaks.csv"
        return Table(peaks) if peaks.exists() else self.run(case)

    def __repr__(self) -> str:
        m = self.manifest
        return (f"<Study {self.path}: {m['done']} of {m['cases']} cases, {m['failed']} failed, "
                f"in {m['violated']} a rating is violated or undecided>")

    def _repr_html_(self) -> str:
        return _html_of_study(self)


class Design(Study):
    """A design: which parts to buy. Its cases are those of a Study, in the order in which they ran.

    word       "proved", "nothing holds", "budget spent", "not judged"
    held       True where the answer is proved, False where nothing holds, else None
    choice     {key: dict} of the answer, with "chosen", "part", "number", "price_each", and in
               "least" the line of the verdict with the least margin; {}: there is none
    price      what all of it costs, as the design's aim counts; NaN: there is no answer
    proof      list of str: what was proved, and what was not
    bill       Table of bom.csv, the parts to buy; empty where there is no answer
    candidates Table of design.csv, what became of each candidate
    summary    all of design.json
    text       design.txt
    """

    def __init__(self, path: Path, **more: Any) -> None:
        """Reads the folder; as Study."""
        super().__init__(path, **more)
        self.summary: dict = load_json(self.path / "design.json")
        self.status: int = self.summary["status"]
        self.word: str = self.summary["word"]
        self.held = {0: True, 3: False}.get(self.status)
        self.choice: dict = self.summary.get("choice", {})
        self.price = float(self.summary["price"] or "nan")
        self.proof: List[str] = self.summary.get("proof", [])
        self.bill = Table(self.path / "bom.csv", words=("key", "chosen", "part", "kind"))
        self.candidates = Table(self.path / "design.csv")
        self.text = (self.path / "design.txt").read_text(encoding="utf-8")

    @staticmethod
    def has(path: Path, status: int) -> bool:
        """Is there the answer of a design that ended with this status?"""
        try:
            return load_json(pathlib.Path(path, "design.json"))["status"] == status
        except Error:
            return False

    def scene(self, case: int) -> pathlib.Path:
        """Returns the path of a deciding case's scene, for run(). Error: the case decided nothing."""
        path = self.path / "cases" / f"{int(case)}.yaml"
        if not path.exists():
            raise Error(None, [f"{path}: this case decided nothing, and has no scene"])
        return path

    def __repr__(self) -> str:
        return f"<Design {self.path}: {self.word}, price {self.price:.9g}>"

    def _repr_html_(self) -> str:
        said = "".join(f"<p>{html.escape(p)}</p>" for p in [repr(self), *self.proof])
        rows = [[_cell(c) for c in self.bill.row(k).values()] for k in range(self.bill.rows())]
        return said + html_table(list(self.bill), rows)


# ---- what a notebook shows ----

_MOST_ROWS = 20


def html_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    cells = "".join(f"<th>{html.escape(h)}</th>" for h in head)
    lines = "".join("<tr>" + "".join(f"<td>{html.escape(c)}</td>" for c in row) + "</tr>"
                    for row in rows)
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{lines}</tbody></table>"


def _cell(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


_MOST_LINES = 8


def _html_of_verdict(lines: "list[dict]") -> str:
    """The lines with the least margins."""
    judged = sorted((line for line in lines if line.get("margin") is not None),
                    key=lambda line: line["margin"])[:_MOST_LINES]
    rows = [(line.get("rating") or f"{line['device']}.{line['measure']}", line["word"],
             f"{100 * line['margin']:.1f} %") for line in judged]
    return html_table(("limit", "word", "margin"), rows) if rows else ""


def _html_picture(r: Union[Result, Study]) -> str:
    """The usual curves, or a study's first picture. "": the program cannot draw them here, as without gnuplot."""
    from . import plot
    try:
        data = base64.b64encode(plot(r).data).decode("ascii")
    except Error:
        return ""
    return f'<img src="data:image/png;base64,{data}">'


def _html_of_run(r: Result) -> str:
    verdict = f"{r.word or 'none'}" + (f"; weakest: {r.weakest}" if r.weakest else "")
    said = "".join(f"<p>warning: {html.escape(w)}</p>" for w in r.warnings)
    rows = [(name, f"{q.value:.4g}", q.unit, "" if q.at is None else f"{q.at:.4g} s")
            for name, q in r.measures.items()]
    return (f"<p>verdict: {html.escape(verdict)}</p>{said}{_html_of_verdict(r.verdict)}"
            f"{_html_picture(r)}{html_table(('measure', 'value', 'unit', 'at'), rows)}")


def _html_of_study(s: Study) -> str:
    rows = [[_cell(c) for c in row.values()] for row in s[:_MOST_ROWS]]
    more = f"<p>and {len(s) - _MOST_ROWS} more rows</p>" if len(s) > _MOST_ROWS else ""
    return (f"<p>{html.escape(repr(s))}</p>{_html_picture(s)}"
            f"{html_table(list(s.columns), rows)}{more}")


class Picture:
    """A picture. A notebook shows it as the last value of a cell.

    data      the file's bytes, of PNG or SVG
    path      where it was written (pathlib.Path); None: it is in memory alone
    messages  what the program said, such as which time is shown
    """

    def __init__(self, data: bytes, path: Optional[pathlib.Path], messages: "list[str]") -> None:
        self.data, self.path, self.messages = data, path, messages

    def save(self, path: Path) -> None:
        """Writes the picture into a file, which should end as the data does."""
        pathlib.Path(path).write_bytes(self.data)

    @property
    def is_png(self) -> bool:
        return self.data.startswith(b"\x89PNG\r\n\x1a\n")

    def _repr_png_(self) -> Optional[bytes]:
        return self.data if self.is_png else None

    def _repr_svg_(self) -> Optional[str]:
        return None if self.is_png else self.data.decode("utf-8")

    def __repr__(self) -> str:
        return "\n".join([f"<Picture {self.path or 'in memory'}: {len(self.data)} bytes>",
                          *self.messages])


class Page:
    """A report.html at `path` (pathlib.Path). A notebook shows it in a frame."""

    def __init__(self, path: pathlib.Path, messages: "list[str]") -> None:
        self.path, self.messages = path, messages

    def _repr_html_(self) -> str:
        source = base64.b64encode(self.path.read_bytes()).decode("ascii")
        return ('<iframe style="width: 100%; height: 40em; border: 0" '
                f'src="data:text/html;charset=utf-8;base64,{source}"></iframe>')

    def __repr__(self) -> str:
        return f"<Page {self.path}>"
