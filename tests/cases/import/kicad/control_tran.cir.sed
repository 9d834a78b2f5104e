# SPDX-License-Identifier: GPL-3.0-or-later
# a probe of all currents
/^\.probe/d
