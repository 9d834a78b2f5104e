# SPDX-License-Identifier: GPL-3.0-or-later
# the paragraph sign, Rser
s/§//g
s/^L1 N001 N002.*/L1 N001 LX 1.1\nRLX LX N002 60/
s/^L2 N005 0 .*/L2 N005 LY 5m\nRLY LY 0 0.2/
s/^L3 N006 0 .*/L3 N006 LZ 1.25m\nRLZ LZ 0 0.1/
