% SPDX-License-Identifier: GPL-3.0-or-later
% GNU Octave ode45 / ode23 / ode15s with Events:  octave-cli -q peer_octave.m --rtol 1e-6 [--method ode45] [--pulses 1] [--out f]
1;
function d = f_on(t, x, m), l = x(9); d = [m.A*x(1:8) + m.g8*(l*l*m.G/2); m.Um*sin(m.w*t) - m.R*l*(m.z0+x(1))*m.G]; end
function d = f_off(t, x, m), d = [m.A*x(1:8); 0]; end
function [v, term, dir] = ev(t, x), v = x(9); term = 1; dir = -1; end
a.rtol = 1e-6; a.refine = 1; a.pulses = 1; a.method = 'ode45'; a.out = ''; v = argv();
for i = 1:numel(v)
  switch v{i}, case '--rtol', a.rtol = str2double(v{i+1}); case '--pulses', a.pulses = str2double(v{i+1}); case '--refine', a.refine = str2double(v{i+1}); case '--method', a.method = v{i+1}; case '--out', a.out = v{i+1};
  case '--header', puts("wall_s,p_peak,i_peak,p_end,u_end,w_end,phi_end,t_off,steps,rhs,tool,method,rtol,pulses\n"); exit; end
end
al = 70*pi/180; mk = .83; mb = 4; Jc = 3.86e-3; Jb = .017; xB = .194; yB = .089; xC = .092; yC = .129; x3 = .033; y3 = .015; x4 = .21183; y4 = .015;
k = .43e5; kx = .08e5; ky = .4e5; b = 1.2; bx = .1; by = .5; s = sin(al); c = cos(al); dx = xC-xB; dy = yC-yB;
M = [mk -mk*s mk*c 0; -mk*s mk+mb 0 -mk*dy; mk*c 0 mk+mb mk*dx; 0 -mk*dy mk*dx Jc+Jb+mk*(dx^2+dy^2)];
ya = yB-y3; yb = yB-y4; xa = x3-xB; xb = x4-xB;
q = @(p,x,y) [2*p 0 0 0; 0 2*x 0 x*(ya+yb); 0 0 2*y y*(xa+xb); 0 x*(ya+yb) y*(xa+xb) x*(ya^2+yb^2)+y*(xa^2+xb^2)];
m.A = [zeros(4) eye(4); -(M\q(k,kx,ky)) -(M\q(b,bx,by))]; m.g8 = [zeros(4,1); M\[-1;0;0;0]];
m.R = 92; m.L0 = 1.6; m.z0 = 6.5e-3; m.G = 1/(m.L0*m.z0); m.Um = 440*sqrt(2); m.w = 2*pi*50; T = .02; tf0 = (100*pi/180)/m.w;
grid = (0:20000)'*1e-4; sc = [1e-3 1e-3 1e-3 1e-2 .3 .3 .3 3 1]; solver = str2func(a.method);
opt0 = odeset('RelTol', a.rtol, 'AbsTol', a.rtol*sc, 'MaxStep', 5e-3); if strcmp(a.method,'ode15s'), opt0 = odeset(opt0,'AbsTol',a.rtol*sc(:)); end
opt1 = odeset(opt0, 'Events', @ev);
warning('off','all'); t0 = tic; Y = zeros(20001,5); t = 0; x = zeros(9,1); kf = 0; on = false; toff = 0; kk = 1; steps = 0;
while t < 2 - 1e-12
  tn = 2; fire = false; if (! on && kf < a.pulses && tf0 + kf*T < tn), tn = tf0 + kf*T; fire = true; end
  % output on the 0.1 ms grid inside the solver (same work as the other peers)
  gi = grid(grid > t + 1e-13 & grid < tn - 1e-13); ts = [t; gi; tn];
  if numel(ts) == 2, ts = [t; (t+tn)/2; tn]; end
  te = []; if on, [tt, yy, te, ye] = solver(@(t,x) f_on(t,x,m), ts, x, opt1); else [tt, yy] = solver(@(t,x) f_off(t,x,m), ts, x, opt0); end
  idx = round(tt*1e4); sel = abs(tt - idx*1e-4) < 1e-12; if ! isempty(te), sel = sel & (tt <= te(end)); end; Y(idx(sel)+1,1:4) = yy(sel,1:4);
  if on, Y(idx(sel)+1,5) = yy(sel,9).*(m.z0+yy(sel,1))*m.G; end
  x = yy(end,:)'; tl = tt(end); steps += numel(tt); if on && ! isempty(te), te = te(end);
    if a.refine % Octave 7 interpolates the event linearly between outputs (about 1e-7 s off): restart from the last output before it and do one Newton step
      j = find(tt < te, 1, 'last'); if strcmp(a.method,'ode15s'), j = max(j-1,1); end
      if te - tt(j) > 1e-9, [t2, y2] = solver(@(t,x) f_on(t,x,m), [tt(j); (tt(j)+te)/2; te], yy(j,:)', opt0); x = y2(end,:)'; else x = yy(j,:)'; te = tt(j); end
      dt = -x(9)/(m.Um*sin(m.w*te)); x += dt*f_on(te,x,m); te += dt;
    else x = ye(end,:)'; end
    tl = te; end;
  if on && tl < tn - 1e-9, t = tl; on = false; kf++; x(9) = 0; if toff == 0, toff = t; end
  else t = tn; if fire, on = true; x(9) = 0; end
  end
end
w = toc(t0);
printf("%.6f,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%d,%d,octave,%s,%g,%d\n", w, max(abs(Y(:,1))), max(Y(:,5)), Y(end,1:4), toff, steps, 0, a.method, a.rtol, a.pulses);
if ! isempty(a.out), fid = fopen(a.out,'wb'); fwrite(fid, Y', 'double'); fclose(fid); end
