% Dynamic factors as Dogan, Kalay, Karpat 2021 compute them: fixed Runge-Kutta steps over the mesh
% period, repeated from the last end until the state repeats; the largest load among the points.
% The paper gives no number of points and no tolerance; Karpat et al. 2012 take 200 points.
%
%     octave-cli dogan.m PROBLEM TOLERANCE POINTS
%
% One line: seconds, then the dynamic factors, relief by relief.
1;

function [K, e] = pair(s, p)
  u = 2*s/p.contact_ratio - 1;
  K = p.stiffness(end);
  for i = numel(p.stiffness)-1:-1:1
    K = K*u + p.stiffness(i);
  end
  e = 0;
  if s > p.whole
    e = p.relief*(s - p.whole)/(p.contact_ratio - p.whole);
  elseif s < p.contact_ratio - p.whole
    e = p.relief*(p.contact_ratio - p.whole - s)/(p.contact_ratio - p.whole);
  end
end

function [a, load] = motion(tau, x, v, p)
  w2 = 0;
  push = p.F*(p.m1 + p.m2)/(p.m1*p.m2);
  load = 0;
  for s = tau:p.contact_ratio
    [K, e] = pair(s, p);
    if x > e
      k = K*(p.m1 + p.m2)/(p.m1*p.m2);
      w2 = w2 + k;
      push = push + k*e;
      load = max(load, K*(x - e));
    end
  end
  a = push - w2*x - 2*p.zeta*sqrt(w2)*v;
end

function [x, v, largest] = period(x, v, T, n, p)
  h = T/n;
  largest = 0;
  for i = 0:n-1
    tau = i/n;
    [a1, load] = motion(tau, x, v, p);
    largest = max(largest, load);
    v2 = v + h/2*a1;
    a2 = motion(tau + 0.5/n, x + h/2*v, v2, p);
    v3 = v + h/2*a2;
    a3 = motion(tau + 0.5/n, x + h/2*v2, v3, p);
    v4 = v + h*a3;
    a4 = motion(tau + 1/n, x + h*v3, v4, p);
    x = x + h/6*(v + 2*v2 + 2*v3 + v4);
    v = v + h/6*(a1 + 2*a2 + 2*a3 + a4);
  end
end

function p = read_problem(file)
  v = fscanf(fopen(file), '%f');
  p = struct('teeth', v(1), 'contact_ratio', v(2), 'm1', v(3), 'm2', v(4), 'F', v(5), 'zeta', v(6), 'relief', 0);
  p.whole = floor(p.contact_ratio);
  v = v(7:end);
  p.stiffness = v(2:1+v(1));
  v = v(2+v(1):end);
  p.reliefs = v(2:1+v(1));
  v = v(2+v(1):end);
  p.rpm = v(2:1+v(1));
end

words = argv();
p = read_problem(words{1});
tolerance = str2double(words{2});
n = str2double(words{3});
mean_stiffness = sum(p.stiffness(1:2:end)'./(1:2:numel(p.stiffness)))*p.contact_ratio;
deflection = p.F/mean_stiffness;
frequency = sqrt(mean_stiffness*(1/p.m1 + 1/p.m2));
factors = [];
from = tic();
for relief = p.reliefs'
  p.relief = relief;
  for rpm = p.rpm'
    T = 60/(p.teeth*rpm);
    x = deflection;
    v = 0;
    for cycle = 1:3000
      x0 = x;
      v0 = v;
      [x, v, largest] = period(x, v, T, n, p);
      if abs(x - x0) < tolerance*deflection && abs(v - v0) < tolerance*deflection*frequency
        break
      end
    end
    factors(end+1) = largest/p.F;
  end
end
printf('%.6e', toc(from));
printf(' %.17g', factors);
printf('\n');
