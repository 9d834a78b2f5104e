# SPDX-License-Identifier: GPL-3.0-or-later
# the paragraph sign, ratings, Rser
s/§//g
s/ tol=20 pwr=0.25//
s/^L1 out N002.*/L1 out LX 0.3\nRLX LX N002 18/
