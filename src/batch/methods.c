/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "batch/methods.h"

const vs_method *const vs_methods[] = {&vs_method_list, &vs_method_grid, NULL};
