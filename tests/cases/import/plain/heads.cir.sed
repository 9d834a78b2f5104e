# SPDX-License-Identifier: GPL-3.0-or-later
# no braces around values
s/{RGK=\(.*\)}$/RGK=\1/
