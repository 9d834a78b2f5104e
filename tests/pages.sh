#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# tests/pages.sh PROGRAM - reports as Chromium shows them: tools/pages finds no fault in those of a run, of one with events, of a
# study, of a comparison and of a periodic orbit; it finds faults that are put into a page; and the cursors read what run.csv has.
# 77: there is no Chromium or no gnuplot, or VS_LONG is not set.
set -eu
program=$1
pages=$(cd "$(dirname "$0")/../tools" && pwd -P)/pages
[ -n "${VS_LONG-}" ] || { echo "pages: with VS_LONG=1 alone, as it takes ten seconds" >&2; exit 77; }
command -v gnuplot >/dev/null && { command -v chromium || command -v chromium-browser || command -v google-chrome; } >/dev/null ||
  { echo "pages: there is no Chromium or no gnuplot" >&2; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
make() { "$program" "$@" --quiet || [ $? -eq 3 ]; } # a violated limit is no fault of a page
make run feeder --set run.until=120ms -o feeder
make run paper --tier switched --set run.until=40ms -o paper
make steady paper --tier switched --set firing.every=1 -o steady
cat >spread.yaml <<'END'
set: {run.until: 12 ms, run.tier: switched}
sample: {method: sobol, n: 32, spread: {firing.angle: 5 deg uniform, supply.voltage: 10 % uniform}}
report: [stroke, i_peak]
END
make study spread.yaml -o spread
for folder in feeder paper steady spread; do make plot $folder; done
make compare paper steady -o both
"$pages" feeder/report.html paper/report.html steady/report.html spread/report.html both/report.html

# the values at both cursors as run.csv has them between its rows: to 4 digits, or a thousandth of the curve's range
"$pages" --values paper/report.html >said
grep -q '^p / mm: A at 9[0-9.]* ms: .* mm; B at 29[0-9.]* ms: .* mm; B - A: [0-9.]* ms, .* mm$' said || { cat said >&2; exit 1; }
sed 's/[;:]//g' said | awk '{ print $6, $8; print $12, $14 }' | while read -r t_ms value_mm; do
  awk -F, -v t="$t_ms" -v v="$value_mm" 'NR == 1 { for (k = 1; k <= NF; k++) if ($k == "p_m") c = k; next }
    { now = 1e3 * $1; y = 1e3 * $c; if (before <= t && t <= now) want = old + (y - old) * (t - before) / (now - before)
      before = now; old = y; if (y > most) most = y; if (y < least) least = y }
    END { d = want - v; if ((d < 0 ? -d : d) < 1e-3 * (most - least)) exit 0; print "cursor:", t, v, "run.csv:", want; exit 1 }' paper/run.csv >&2
done

"$pages" --values both/report.html >said # of two runs by their names; the second one has ended before B
grep -q '^p / mm: A at 9[0-9.]* ms: paper [-0-9.]* mm, steady [-0-9.]* mm; B at 29[0-9.]* ms: paper [-0-9.]* mm, steady none; ' said ||
  { cat said >&2; exit 1; }

# faults that are put in
sed 's|<h2>Measures|<p style="white-space:nowrap;width:900px">too wide for a narrow page, far too wide, and wider still than that</p>&|
  s|</svg>|<text x="30" y="60">over</text><text x="32" y="60">another</text><text x="-40" y="20">cut</text>&|' feeder/report.html >faulty.html
if "$pages" faulty.html >said; then echo "no fault found" >&2; exit 1; fi
for fault in 'wider than the page' 'overlap: over | another' 'cut: cut'; do
  grep -q "$fault" said || { echo "not found: $fault" >&2; cat said >&2; exit 1; }
done
