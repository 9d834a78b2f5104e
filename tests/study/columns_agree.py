#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
# tests/study/columns_agree.py DIR - reads DIR/columns by numpy and holds each element against its cell in DIR/study.csv. Prints
# what differs; exit status 1 when something does.
import csv, json, os, sys
import numpy

folder = sys.argv[1]
columns = os.path.join(folder, "columns")
listed = json.load(open(os.path.join(columns, "columns.json"), encoding="utf-8"))
rows = list(csv.reader(open(os.path.join(folder, "study.csv"), newline="", encoding="utf-8")))
header, rows = rows[0], rows[1:]
bad = 0


def expect(good, *what):
    global bad
    if not good:
        bad += 1
        print(*what)


def agrees(column, element, cell):
    if "words" in column:
        return 0 <= element < len(column["words"]) and column["words"][element] == cell
    if column["type"] == "|S16":
        return element == cell.encode()
    if cell == "":
        return numpy.isnan(element)
    return element == (float(cell) if column["type"] == "<f8" else int(cell))  # the same digits: the same double


expect(listed["rows"] == len(rows), "rows", listed["rows"], len(rows))
expect([c["column"] for c in listed["columns"]] == header, "columns", header)
expect(sorted(os.listdir(columns)) == sorted([c["file"] for c in listed["columns"]] + ["columns.json"]), os.listdir(columns))
seen = set()
for position, column in enumerate(listed["columns"]):
    x = numpy.load(os.path.join(columns, column["file"]), allow_pickle=False)
    expect(x.dtype == numpy.dtype(column["type"]) and x.shape == (len(rows),), column, x.dtype, x.shape)
    mapped = numpy.load(os.path.join(columns, column["file"]), mmap_mode="r")
    expect(x.tobytes() == mapped.tobytes(), column["file"], "mapped differs")
    for row, element in zip(rows, x):
        expect(agrees(column, element, row[position]), column["column"], repr(element), repr(row[position]))
    seen.add("words" if "words" in column else column["type"])
print(len(rows), "rows", len(header), "columns", " ".join(sorted(seen)))
sys.exit(bad > 0)
