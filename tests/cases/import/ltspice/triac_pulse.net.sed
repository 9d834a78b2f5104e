# SPDX-License-Identifier: GPL-3.0-or-later
# Rser and Cpar, ratings, the sign of a millionth
s/µ/u/g
s/^L2 line N001.*/L2 line LX 0.2m\nRLX LX N001 0.4\nCLX line N001 50p/
s/^V3 N003 load \(.*\) Rser=20/V3 VX load \1\nRVX VX N003 20/
s/ V=630//
s/ Rser=0$//
