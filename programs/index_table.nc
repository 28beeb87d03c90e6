(left of the table, which this program turns: four wide grooves from the rim)
G21 G90 G17 G94 G64 P0.02
T1 M6
G43 H1
S9000 M3
#1 = 0 (the table)
o100 repeat [4]
  #2 = [180 - #1] (what of the disc is on the left)
  G0 X[135 * COS[#2]] Y[135 * SIN[#2]] Z60 C#1
  (the table stands)
  M200
  G0 Z-2
  G1 X[85 * COS[#2]] Y[85 * SIN[#2]] F900
  G0 Z60
  (both have milled)
  M201
  #1 = [#1 + 90]
o100 endrepeat
M5
M2
