# SPDX-License-Identifier: GPL-3.0-or-later
# the paragraph sign and that of a millionth, Rser, ratings, a node of the name ac
s/§//g
s/µ/u/g
s/\<ac\>/acn/
s/^C1 dcp 0 .*/C1 dcp CX 150u\nRCX CX 0 0.15/
s/ mfg=nobody Vds=400 Ron=90m Qg=20n//
s/^MQ1 sw N004 0 0 NVD/MQ1 sw N004 0 NVD/
