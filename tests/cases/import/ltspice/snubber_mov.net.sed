# SPDX-License-Identifier: GPL-3.0-or-later
# Rser, Cpar, tripdv, the sign of a millionth
s/µ/u/g
s/^L2 N001 N002/&/
s/^L2 N002 a 0.3m.*/L2 N002 LX 0.3m\nRLX LX a 20m/
s/ Rser=0$//
s/ Cpar=300p tripdv=10 tripdt=1u/\nCB1 N006 k 300p/
