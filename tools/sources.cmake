# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DROOT=. -DTO=sources.h -P tools/sources.cmake - writes the macro VS_SOURCES, a digest over all that src/ holds
# (src/run/version.c).
file(GLOB_RECURSE files RELATIVE ${ROOT}/src ${ROOT}/src/*.c ${ROOT}/src/*.h)
list(SORT files)
set(all "")
foreach(file ${files})
  file(SHA256 ${ROOT}/src/${file} sum)
  string(APPEND all "${file} ${sum}\n")
endforeach()
string(SHA256 digest "${all}")
string(SUBSTRING ${digest} 0 16 digest)
file(WRITE ${TO} "#define VS_SOURCES \"${digest}\"\n")
