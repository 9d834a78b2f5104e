# SPDX-License-Identifier: GPL-3.0-or-later
# Rser, and one K of three
s/^L1 pri 0 .*/L1 pri LX 8\nRLX LX 0 5/
s/^L2 s1 0 .*/L2 s1 LY 0.5\nRLY LY 0 0.3/
s/^L3 0 s2 .*/L3 0 LZ 0.5\nRLZ LZ s2 0.3/
s/^L4 o N005.*/L4 o LW 0.35\nRLW LW N005 30/
s/^K1 L1 L2 L3 \(.*\)/K1 L1 L2 \1\nK2 L1 L3 \1\nK3 L2 L3 \1/
