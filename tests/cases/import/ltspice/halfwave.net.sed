# SPDX-License-Identifier: GPL-3.0-or-later
# Rser, Rpar of a coil, of a capacitor and of a source; ratings; the paragraph sign in names; a library that is not here
s/§//g
s/µ/u/g
s/^VMAINS L N \(.*\) AC 1 Rser=0.4/VMAINS LI N \1\nRVM LI L 0.4/
s/^LEVA k N003 0.45.*/LEVA k LX 0.45\nRLX LX N003 27\nRLP k N003 200k/
s/^CSN N004 k 47n.*/CSN N004 CX 47n\nRCX CX k 0.1/
s/ tt=0 Iave=8 Vpk=600 mfg=nobody type=fast//
/^\.lib/d
