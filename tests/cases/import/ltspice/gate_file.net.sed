# SPDX-License-Identifier: GPL-3.0-or-later
# the points of the file; values in one brace
s/PWL file=.*/PWL(0 0 4.5m 0 4.501m 5 6.5m 5 6.501m 0)/
s/2\*{Rn}+20/{2*Rn+20}/
s/1.462\*{Rl}/{1.462*Rl}/
