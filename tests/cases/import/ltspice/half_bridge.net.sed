# SPDX-License-Identifier: GPL-3.0-or-later
# the paragraph sign and that of a millionth, Rser, ratings
s/§//g
s/µ/u/g
s/^V1 dcp 0 325.*/V1 VX 0 325\nRVX VX dcp 0.2/
s/ V=250//
s/^L1 out N004.*/L1 out LX 0.5\nRLX LX N004 30/
