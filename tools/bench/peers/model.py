# SPDX-License-Identifier: GPL-3.0-or-later
"""Paper scene for the Python peers (same definition as model.h)."""
import numpy as np, argparse, sys
def build():
    al=np.deg2rad(70.); mk=.83; mb=4.; Jc=3.86e-3; Jb=.017
    xB,yB,xC,yC,x3,y3,x4,y4=.194,.089,.092,.129,.033,.015,.21183,.015
    k,kx,ky,b,bx,by=.43e5,.08e5,.4e5,1.2,.1,.5
    s,c=np.sin(al),np.cos(al); dx,dy=xC-xB,yC-yB
    M=np.array([[mk,-mk*s,mk*c,0],[-mk*s,mk+mb,0,-mk*dy],[mk*c,0,mk+mb,mk*dx],[0,-mk*dy,mk*dx,Jc+Jb+mk*(dx*dx+dy*dy)]])
    ya,yb,xa,xb=yB-y3,yB-y4,x3-xB,x4-xB
    def q(p,x,y): return np.array([[2*p,0,0,0],[0,2*x,0,x*(ya+yb)],[0,0,2*y,y*(xa+xb)],[0,x*(ya+yb),y*(xa+xb),x*(ya*ya+yb*yb)+y*(xa*xa+xb*xb)]])
    K=q(k,kx,ky); B=q(b,bx,by); Mi=np.linalg.inv(M)
    return dict(M=M,K=K,B=B,AK=Mi@K,AB=Mi@B,g=Mi@np.array([-1.,0,0,0]),R=92.,L0=1.6,z0=6.5e-3,Um=440*np.sqrt(2),w=2*np.pi*50,T=.02,tf0=np.deg2rad(100)/(2*np.pi*50))
HEADER="wall_s,p_peak,i_peak,p_end,u_end,w_end,phi_end,t_off,steps,rhs,tool,method,rtol,pulses"
SCALE=np.array([1e-3,1e-3,1e-3,1e-2,.3,.3,.3,3,1])
def parse(default):
    a=argparse.ArgumentParser(); a.add_argument('--rtol',type=float,default=1e-6); a.add_argument('--pulses',type=int,default=1)
    a.add_argument('--method',default=default); a.add_argument('--out'); a.add_argument('--header',action='store_true'); a.add_argument('--repeat',type=int,default=1)
    a=a.parse_args()
    if a.header: print(HEADER); sys.exit()
    return a
def report(Y,a,tool,wall,t_off,steps,rhs):
    """Y: 20001 x 5 (p,u,w,phi,i) on the 0.1 ms grid"""
    e=Y[-1]; print("%.6f,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%d,%d,%s,%s,%g,%d"%(wall,abs(Y).max(0)[0],Y[:,4].max(),e[0],e[1],e[2],e[3],t_off,steps,rhs,tool,a.method,a.rtol,a.pulses))
    if a.out: np.ascontiguousarray(Y,dtype='<f8').tofile(a.out)
