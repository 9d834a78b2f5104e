# SPDX-License-Identifier: GPL-3.0-or-later
# the paragraph sign, Rser, ratings
s/§//g
s/^V1 N001 n \(.*\) Rser=0.3/V1 VX n \1\nRVX VX N001 0.3/
s/^L1 plus N008.*/L1 plus LX 0.8\nRLX LX N008 45/
s/ Vpk=1200 Iave=10//
/^\.meas/d
