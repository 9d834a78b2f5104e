#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""scipy solve_ivp with events; --method RK45|DOP853|LSODA|Radau|BDF"""
import time, numpy as np
from scipy.integrate import solve_ivp
from model import *
a=parse('RK45'); m=build(); G=1/(m['L0']*m['z0']); grid=np.arange(20001)*1e-4
A=np.zeros((8,8)); A[:4,4:]=np.eye(4); A[4:,:4]=-m['AK']; A[4:,4:]=-m['AB']; g8=np.r_[np.zeros(4),m['g']]
def on(t,x):
    l=x[8]; d=np.empty(9); d[:8]=A@x[:8]+g8*(l*l*G/2); d[8]=m['Um']*np.sin(m['w']*t)-m['R']*l*(m['z0']+x[0])*G; return d
def off(t,x):
    d=np.zeros(9); d[:8]=A@x[:8]; return d
def zero(t,x): return x[8]
zero.terminal=True; zero.direction=-1
best=1e9
for _ in range(a.repeat):
    w=time.perf_counter(); Y=np.zeros((20001,5)); t=0.; x=np.zeros(9); k=0; kf=0; ison=False; toff=0; steps=rhs=0
    while t<2.:
        tn=2.; tf=m['tf0']+kf*m['T']; fire=False
        if not ison and kf<a.pulses and tf<tn: tn,fire=tf,True
        ke=np.searchsorted(grid,tn,side='right')
        kw=dict(events=zero) if ison else {}
        s=solve_ivp(on if ison else off,(t,tn),x,method=a.method,rtol=max(a.rtol,2.3e-14),atol=a.rtol*SCALE,dense_output=True,max_step=5e-3,**kw)
        if not s.success: raise SystemExit(s.message)
        t=s.t[-1]; ke=np.searchsorted(grid,t+1e-13,side='right')
        if ke>k:
            z=s.sol(np.minimum(grid[k:ke],t)); Y[k:ke,:4]=z[:4].T
            if ison: Y[k:ke,4]=z[8]*(m['z0']+z[0])*G
            k=ke
        x=s.y[:,-1].copy(); steps+=len(s.t)-1; rhs+=s.nfev
        if ison and s.status==1: ison=False; kf+=1; x[8]=0; toff=toff or t
        elif fire: ison=True; x[8]=0
    best=min(best,time.perf_counter()-w)
report(Y,a,'scipy',best,toff,steps,rhs)
