# SPDX-License-Identifier: GPL-3.0-or-later
# if() and .step
s/if(V(g,gk)>1.5, 2, I(Vs)\/40m)/V(g,gk)>1.5 ? 2 : I(Vs)\/40m/
/^\.step/d
