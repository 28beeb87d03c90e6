G21 G90
T1 M6
G43 H1
#1 = 1
o100 while [#1 LE 20]
  G0 Z[20 * #1 + 5] (A WALL OF 400 MM)
  G0 X0 Y0
  G0 Z[20 * #1]
  M10
  G1 X800 F12000
  M11
  #1 = [#1 + 1]
o100 endwhile
M2
