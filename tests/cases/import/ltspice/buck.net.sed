# SPDX-License-Identifier: GPL-3.0-or-later
# the paragraph sign and that of a millionth, Rser and Lser, PWL REPEAT
s/§//g
s/µ/u/g
s/^V1 in 0 48.*/V1 VX 0 48\nRVX VX in 30m/
s/^C1 in 0 .*/C1 in CX 330u IC=48\nRCX CX CY 50m\nLCY CY 0 5n/
s/PWL REPEAT FOREVER .*/PULSE(0 15 0 0.2u 0.2u 19.8u 50u)/
s/^L1 e N004.*/L1 e LX 30m\nRLX LX N004 4.7/
