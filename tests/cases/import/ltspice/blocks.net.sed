# SPDX-License-Identifier: GPL-3.0-or-later
# Rser of a coil and of a capacitor; braces in braces; parameters in the heads; the paragraph sign in names
s/§//g
s/^\.subckt lossy A B/& Rs=1 Cs=1n/
s/^\.subckt ladder P Q/& Rx=1/
s/{3.3\*{Rl}}/{3.3*Rl}/
s/^L1 k b 0.5.*/L1 k bx 0.5\nRLX bx b 20/
s/^C1 m B {Cs}.*/C1 m mx {Cs}\nRCX mx B 0.5/
