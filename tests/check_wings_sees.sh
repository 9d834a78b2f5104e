#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# tools/check_wings is quiet about a good tree of three wings, and says what is wrong with each bad one made of it.
set -eu
script=$(cd "$(dirname "$0")/.." && pwd -P)/tools/check_wings
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
  cp "$script" "$tree/tools/check_wings"
  printf 'set(VS_WINGS base plant ngspice)\n' >"$tree/CMakeLists.txt"
  printf '# SPDX-License-Identifier: GPL-3.0-or-later\n' >>"$tree/CMakeLists.txt"
  file src/base/include/base/texts.h 'extern const int vs_text_most[], vs_text_least;' '/* Twice n, in "(" and {. */' \
    'int vs_text_twice(int n)' '    __attribute__((const));' '/* n; for tests. */' 'int vs_texts(int n);'
  file src/base/texts.c '#include "base/texts.h"' '#define BODY \' '  { return n;' 'const int vs_text_most[] = {3, 1},' \
    '          vs_text_least = 1; static int once(int n) { return n; }' "int vs_text_twice(int n) { if (n == '{') return 2; return once(n); }" \
    'int vs_texts(int n) {' '  return n;' '}'
  file src/plant/include/plant/model.h 'typedef struct vs_model {' '  int n;' '} vs_model;' 'int vs_model_n(const vs_model *m);'
  file src/plant/model.c '#include "plant/model.h"' '#include "base/texts.h"' \
    'int vs_model_n(const vs_model *m) { return vs_text_twice(m->n) + vs_text_most[0] + vs_text_least; }'
  file src/ngspice/library.h '#include <ngspice/sharedspice.h>'
  file src/main.c '#include "plant/model.h"' 'int main(void) {' '  vs_model m = {3};' '  return vs_model_n(&m);' '}'
  file tests/test_text.c '#include "base/texts.h"' 'int main(void) { return vs_texts(3); }'
}

says() { # WHAT - what check_wings must say
  if got=$("$tree/tools/check_wings" 2>&1); then status=0; else status=1; fi
  case "$status $got" in
    "1 "*"$1"*) ;;
    "0 $1") ;;
    *) printf 'check_wings does not say "%s", but (status %s):\n%s\n' "$1" $status "$got"; failed=1 ;;
  esac
  good_tree
}
add() { # PATH LINE... - to the end of a file
  path=$tree/$1
  shift
  printf '%s\n' "$@" >>"$path"
}

good_tree
says 'check_wings: fine'

add src/base/texts.c '#include "plant/model.h"'
says 'a circle: base/texts -> plant/model -> base/texts'
add src/plant/model.c '#include "plant/other.h"'
file src/plant/other.h '#include "plant/model.h"'
says 'a circle: plant/model -> plant/other -> plant/model'
add src/plant/model.c 'int vs_other(int n) { return n; }'
says 'src/plant/model.c:5: vs_other is exported, and its header does not declare it'
add src/plant/model.c 'const int vs_model_table[] = {' '  3' '};'
says 'src/plant/model.c:5: vs_model_table is exported, and its header does not declare it'
add src/plant/include/plant/model.h 'int vs_other(int n);'
says 'src/plant/include/plant/model.h:6: vs_other is not named after its file'
add src/plant/include/plant/model.h 'int vs_model_other(int n);'
says 'src/plant/include/plant/model.h:6: vs_model_other is declared, and defined nowhere'
add src/plant/include/plant/model.h 'extern const int vs_model_x,' '    vs_model_y[3];'
says 'src/plant/include/plant/model.h:6: vs_model_y is declared, and defined nowhere'
add src/plant/include/plant/model.h 'int vs_text_twice(int n);'
says 'src/plant/include/plant/model.h:6: vs_text_twice is defined in src/base/texts.c:7'
add src/plant/include/plant/model.h 'int vs_model_twice(const vs_model *m);'
add src/plant/model.c 'int vs_model_twice(const vs_model *m) { return 2 * vs_model_n(m); }'
says 'src/plant/include/plant/model.h:6: vs_model_twice is exported, and used in its own file only'
file tests/test_text.c '#include "base/texts.h"' 'int main(void) { return vs_texts(3) + vs_model_n(0); }'
file src/main.c 'int main(void) { return 0; }'
says 'src/plant/include/plant/model.h:5: vs_model_n is only for tests, which its comment does not say'
add src/plant/include/plant/model.h 'int twice(const vs_model *m);'
says 'src/plant/include/plant/model.h:6: twice is exported, and does not begin with vs_'
file src/plant/law.c 'const int vs_law = 3;'
add src/plant/include/plant/model.h 'extern const int vs_law;'
add src/main.c 'int law(void) { return vs_law; }'
says 'check_wings: fine'
file src/plant/include/plant/alone.h ''
says 'src/plant/include/plant/alone.h:1: is shown, and no other wing includes it'
for name in a b c d e f g h i j k l m n o p q r s t; do
  file src/plant/include/plant/$name.h "extern int $name;"
  add src/main.c "#include \"plant/$name.h\""
done
says 'src/plant/include: shows 21 headers; at most 20'
file src/plant/parts/model.c ''
says 'src/plant/parts/model.c:1: has the name of src/plant/model.c'
for name in 1 2 3 4 5 6 7 8; do printf '%100s' '' | tr ' ' '\n' >>"$tree/src/plant/model.c"; done
says 'src/plant/model.c:804: has more than 800 lines'
file src/attic/old.c ''
says 'src/attic/old.c:1: lies in none of the wings'
echo >"$tree/notes.txt"
says 'notes.txt:1: does not belong at the root'
add src/base/texts.c 'static char *other(const char *s) { return strdup(s); }'
says 'src/base/texts.c:11: calls strdup(); base/alloc.h has what ends the process where there is no memory'
add src/base/texts.c 'static void *other(void) { return vs_checked(gsl_vector_alloc(1)); }'
says 'check_wings: fine'
add src/base/texts.c 'static void *other(void) { return gsl_vector_alloc(1); }'
says 'src/base/texts.c:11: calls gsl_vector_alloc() without vs_checked()'
add src/main.c '#include <ngspice/sharedspice.h>'
says 'src/main.c:7: includes ngspice/sharedspice.h, which only src/ngspice/library.h may'
exit $failed
