# shellcheck shell=sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What tools/bench/work_precision and tools/bench/study share. Wants: the repository as folder, $dir with a build, $work.

libraries=$(pkg-config --cflags --libs gsl libfyaml libzstd zlib ngspice)
tool() { # NAME: of tools/bench/precision
  # shellcheck disable=SC2086 # a list of words
  "${CC:-cc}" -std=gnu11 -O2 -D_GNU_SOURCE -ffp-contract=off $(printf " -iquote %s" src src/*/) $(printf " -I%s" src/*/include) -Itests/support -o "${dir:?}/precision_$1" \
    "tools/bench/precision/$1.c" tools/bench/precision/race.c tests/support/oracle.c tests/support/conveyor.c tests/support/compare.c tests/support/schemes.c "$dir/libvs.a" $libraries -lm
}
# An exported deck with another step and reltol, nothing saved but p; what follows .control goes.
deck() { # FILE RELTOL STEP COMMAND
  sed -e "s/^\.param vs_step=[^ ]*/.param vs_step=$3/" -e "s/ reltol=[^ ]*/ reltol=$2/" -e '/^\.save/d' -e '/^\.control/,$d' "$1"
  printf '.save v(vs_p) v(vs_vp)\n.control\nrun\n%s\nquit 0\n.endc\n.end\n' "$4"
}
# The largest error of p in it, in parts of the peak; inf where ngspice gave up.
deck_error() { # FILE REFERENCE RELTOL STEP
  rm -f "${work:?}/points.txt"
  deck "$1" "$3" "$4" "set wr_singlescale
set numdgt=15
wrdata $work/points.txt v(vs_p) v(vs_vp)" >"$work/points.cir"
  ngspice -b "$work/points.cir" >/dev/null 2>&1 || :
  : >>"$work/points.txt"
  "$dir/precision_errors" deck "$2" "$work/points.txt"
}
