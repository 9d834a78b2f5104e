#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# tools/check_rooms is quiet about a good tree of two rooms, and says what is wrong with each bad one made of it.
set -eu
rooms=$(cd "$(dirname "$0")/.." && pwd -P)/tools/check_rooms
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
failed=0
licence='/* SPDX-License-Identifier: GPL-3.0-or-later */'

file() { # PATH LINE... - a file with its licence
  path=$tree/$1
  shift
  mkdir -p "$(dirname "$path")"
  printf '%s\n' "$licence" "$@" >"$path"
}

good_tree() {
  rm -rf "${tree:?}"/*
  mkdir -p "$tree/tools"
  cp "$rooms" "$tree/tools/check_rooms"
  file src/base/texts.h 'extern const int vs_text_most[], vs_text_least;' '/* Twice n, in "(" and {. */' \
    'int vs_text_twice(int n)' '    __attribute__((const));' '/* n; for tests. */' 'int vs_texts(int n);'
  file src/base/texts.c '#include "base/texts.h"' '#define BODY \' '  { return n;' 'const int vs_text_most[] = {3, 1},' \
    '          vs_text_least = 1; static int once(int n) { return n; }' "int vs_text_twice(int n) { if (n == '{') return 2; return once(n); }" \
    'int vs_texts(int n) {' '  return n;' '}'
  file src/machine/model.h 'typedef struct vs_model {' '  int n;' '} vs_model;' 'int vs_model_n(const vs_model *m);'
  file src/machine/model.c '#include "machine/model.h"' '#include "base/texts.h"' \
    'int vs_model_n(const vs_model *m) { return vs_text_twice(m->n) + vs_text_most[0] + vs_text_least; }'
  file src/solver/library.h '#include <ngspice/sharedspice.h>'
  file src/main.c '#include "machine/model.h"' 'int main(void) {' '  vs_model m = {3};' '  return vs_model_n(&m);' '}'
  file tests/test_text.c '#include "base/texts.h"' 'int main(void) { return vs_texts(3); }'
}

says() { # WHAT - what check_rooms must say
  if got=$("$tree/tools/check_rooms" 2>&1); then status=0; else status=1; fi
  case "$status $got" in
    "1 "*"$1"*) ;;
    "0 $1") ;;
    *) printf 'check_rooms does not say "%s", but (status %s):\n%s\n' "$1" $status "$got"; failed=1 ;;
  esac
  good_tree
}
add() { # PATH LINE... - to the end of a file
  path=$tree/$1
  shift
  printf '%s\n' "$@" >>"$path"
}

good_tree
says 'check_rooms: fine'

add src/base/texts.c '#include "machine/model.h"'
says 'src/base/texts.c:11: includes machine/model.h, which lies to the right of base'
add src/base/texts.c '#include "machine/model.h"'
says 'a circle: base/texts -> machine/model -> base/texts'
add src/machine/model.c '#include "machine/other.h"'
file src/machine/other.h '#include "machine/model.h"'
says 'a circle: machine/model -> machine/other -> machine/model'
add src/machine/model.c 'int vs_other(int n) { return n; }'
says 'src/machine/model.c:5: vs_other is exported, and its header does not declare it'
add src/machine/model.c 'const int vs_model_table[] = {' '  3' '};'
says 'src/machine/model.c:5: vs_model_table is exported, and its header does not declare it'
add src/machine/model.h 'int vs_other(int n);'
says 'src/machine/model.h:6: vs_other is not named after its file'
add src/machine/model.h 'int vs_model_other(int n);'
says 'src/machine/model.h:6: vs_model_other is declared, and defined nowhere'
add src/machine/model.h 'extern const int vs_model_x,' '    vs_model_y[3];'
says 'src/machine/model.h:6: vs_model_y is declared, and defined nowhere'
add src/machine/model.h 'int vs_text_twice(int n);'
says 'src/machine/model.h:6: vs_text_twice is defined in src/base/texts.c:7'
add src/machine/model.h 'int vs_model_twice(const vs_model *m);'
add src/machine/model.c 'int vs_model_twice(const vs_model *m) { return 2 * vs_model_n(m); }'
says 'src/machine/model.h:6: vs_model_twice is exported, and used in its own file only'
file tests/test_text.c '#include "base/texts.h"' 'int main(void) { return vs_texts(3) + vs_model_n(0); }'
file src/main.c 'int main(void) { return 0; }'
says 'src/machine/model.h:5: vs_model_n is only for tests, which its comment does not say'
add src/machine/model.h 'int twice(const vs_model *m);'
says 'src/machine/model.h:6: twice is exported, and does not begin with vs_'
for name in a b c d e f g h i j k; do file src/machine/$name.c "static int $name;"; done
says 'src/machine: has 12 pairs of .c and .h; at most 11'
file src/attic/old.c ''
says 'src/attic/old.c:1: lies in none of the rooms'
echo >"$tree/notes.txt"
says 'notes.txt:1: does not belong at the root'
add src/base/texts.c 'static char *other(const char *s) { return strdup(s); }'
says 'src/base/texts.c:11: calls strdup(); base/alloc.h has what ends the process where there is no memory'
add src/base/texts.c 'static void *other(void) { return vs_checked(gsl_vector_alloc(1)); }'
says 'check_rooms: fine'
add src/base/texts.c 'static void *other(void) { return gsl_vector_alloc(1); }'
says 'src/base/texts.c:11: calls gsl_vector_alloc() without vs_checked()'
add src/main.c '#include <ngspice/sharedspice.h>'
says 'src/main.c:7: includes ngspice/sharedspice.h, which only src/solver/library.h may'
exit $failed
