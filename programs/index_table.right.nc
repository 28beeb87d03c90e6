(right of the table: a narrow groove in each wide one)
G21 G90 G17 G94 G64 P0.02
T2 M6
G43 H2
S12000 M3
#1 = 0 (the table)
o100 repeat [4]
  #2 = [0 - #1] (what of the disc is on the right)
  M200
  G0 X[135 * COS[#2]] Y[135 * SIN[#2]] Z30
  G0 Z-4
  G1 X[87 * COS[#2]] Y[87 * SIN[#2]] F700
  G0 Z30
  M201
  #1 = [#1 + 90]
o100 endrepeat
M5
M2
