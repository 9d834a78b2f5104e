# shellcheck shell=sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What tools/bench/study does in plain ngspice; behind tools/bench/precision/common.sh. `study` is the former's. A setting is
# a tolerance and a largest step in us: of a deck reltol and vs_step, of a study run.tolerance and run.max_step.

# N values of R1, at equal ratios: a study, and a deck of each case as it is exported.
scenes() { # N
  mkdir "${work:?}/$1"
  awk -v n="$1" 'BEGIN { print "circuit.r1"; for (k = 0; k < n; k++) printf "%.9g ohm\n", 10 * 1000 ^ (k / (n - 1)) }' \
    >"$work/$1/r1.csv"
  printf 'set: {run.until: 0.1 s}\nvary: r1.csv\nreport: [p_min]\n' >"$work/$1/study.yaml"
  sed 1d "$work/$1/r1.csv" | awk '{ printf "%03d %s%s\n", NR - 1, $1, $2 }' | while read -r k r1; do
    "${dir:?}/vibrospice" export paper --set run.until=0.1s --set "circuit.r1=$r1" -o "$work/$1/$k.exported" >/dev/null
    [ "$1" -ne 5 ] || "$dir/precision_errors" reference circuit "$work/5/${k#00}.ref" run.until=0.1s "circuit.r1=$r1"
  done
}
set_decks() { # N TOLERANCE STEP
  for exported in "$work/$1"/*.exported; do
    deck "$exported" "$2" "$3e-6" "meas tran least min v(vs_p)" >"${exported%.*}.cir"
    echo "${exported%.*}.cir"
  done >"$work/$1/list"
}
run_decks() { # N JOBS
  "$dir/bench_cases" sh -c "xargs -n 1 -P $2 ngspice -b <'$work/$1/list' >'$work/$1/said_$2' 2>/dev/null"
}
run_study() { # N JOBS TOLERANCE STEP WORD...
  ran=$1/study jobs=$2 with="run.tolerance=$3" steps="run.max_step=$4 us"
  shift 4
  study "$ran" "$jobs" --set "$with" --set "$steps" "$@"
}

# The largest error of p at five R1, in parts of its peak; and the processor time of these five.
decks_error() { # TOLERANCE STEP
  for k in 0 1 2 3 4; do deck_error "$work/5/00$k.exported" "$work/5/$k.ref" "$1" "$2e-6"; done | sort -g | tail -n 1
}
study_error() {
  run_study 5 1 "$1" "$2" --keep runs >/dev/null
  for k in 0 1 2 3 4; do "$dir/precision_errors" csv "$work/5/$k.ref" "$work/out/runs/$k/run.csv"; done | sort -g | tail -n 1
}
decks_time() {
  set_decks 5 "$1" "$2"
  for _ in 1 2 3; do run_decks 5 1; done | cut -d ' ' -f 2 | sort -g | head -n 1
}
study_time() {
  for _ in 1 2 3; do run_study 5 1 "$1" "$2"; done | cut -d ' ' -f 2 | sort -g | head -n 1
}

# Of each tolerance the largest step whose error keeps the bound, to 3 %; of these the cheapest: time, error, setting.
cheapest() { # decks|study BOUND STEP: the first one tried
  for tolerance in 1e-1 1e-2 1e-3; do
    step=$3
    for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15; do
      error=$("$1_error" "$tolerance" "$step")
      next=$(awk -v e="$error" -v bound="$2" -v step="$step" 'BEGIN {
        if (e != "inf" && e + 0 <= bound + 0) exit
        f = e == "inf" ? 0 : (bound / e) ^ 0.4
        print step * (f < 0.6 ? 0.6 : f > 0.97 ? 0.97 : f) }')
      [ -n "$next" ] || break
      step=$next
    done
    [ -n "$next" ] || echo "$("$1_time" "$tolerance" "$step") $error $tolerance $step"
  done | sort -g | head -n 1
}

# The largest difference of p_min between study and decks, in parts of it; nothing where a deck said none.
difference() { # N
  { echo least; sed -n 's/^least *= *\([^ ]*\).*/\1/p' "$work/$1/said_1"; } >"$work/$1/least"
  paste -d, "$work/out/study.csv" "$work/$1/least" | awk -F, -v n="$1" '
    NR == 1 { while ($++column != "p_min_m") if (column > NF) exit; next }
    $NF != "" { got++; d = 1e-3 * $NF / $column - 1; if (d < 0) d = -d; if (d > most) most = d }
    END { if (got == n && NR == n + 1) print most + 0 }'
}

# Into $work/decks_BOUND: error and setting of the deck, of the study, difference of p_min, N; then a line a round: wall and processor time
# and MB of the decks one after the other, of two at a time, of study --jobs 1, of --jobs 2.
against_decks() { # BOUND N ROUNDS
  [ -d "$work/$2" ] || scenes "$2"
  first=$(awk -v bound="$1" 'BEGIN { print 2500 * sqrt(bound) }') # of the second order
  # shellcheck disable=SC2046 # three words each
  set -- "$@" $(cheapest decks "$1" "$first" | cut -d ' ' -f 2-)
  # shellcheck disable=SC2046
  set -- "$@" $(cheapest study "${4:-0}" 200 | cut -d ' ' -f 2-)
  [ $# -eq 9 ] || fail "no setting has an error of $1"
  set_decks "$2" "$5" "$6"
  for _ in $(seq "$3"); do
    echo "$(run_decks "$2" 1) $(run_decks "$2" 2) $(run_study "$2" 1 "$8" "$9") $(run_study "$2" 2 "$8" "$9")"
  done >"$work/rounds"
  differ=$(difference "$2")
  [ "$differ" ] || fail "not every deck and case came to its end"
  { echo "$4 $5 $6 $7 $8 $9 $differ $2"; cat "$work/rounds"; } >"$work/decks_$1"
}
