/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "targets.h"

const fuzz_target *const fuzz_targets[] = {
#define ROW(name) &fuzz_##name,
    VS_FUZZ_TARGETS(ROW)
#undef ROW
        NULL};
