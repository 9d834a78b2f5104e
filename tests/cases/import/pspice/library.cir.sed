# SPDX-License-Identifier: GPL-3.0-or-later
# the library as ngspice reads it, and its optional node
s/shapes.lib/shapes_plain.lib/
s/MAIN_SCR/0 &/
s/ TC=0,0//
