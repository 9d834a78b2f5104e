# SPDX-License-Identifier: GPL-3.0-or-later
# the paragraph sign and that of a millionth, Rser, idt, table
s/§//g
s/µ/u/g
s/^V1 x y \(.*\) Rser=1/V1 VX y \1\nRVX VX x 1/
s/^C1 p 0 .*/C1 p CX 470u\nRCX CX 0 0.08/
s/^L1 p N001.*/L1 p LX 0.12\nRLX LX N001 14/
s/^B1 q 0 .*/B1 0 q I=I(L2)\nCQ q 0 1/
s/^B2 .*/V2 trip 0 PWL(0 0 30m 0 30.01m 6 31m 6 31.01m 0)/
