(a picture, a map of depth, and lines across the step)
G21 G90 G17 G94
T1 M6
G43 H1
G0 X50 Y20 Z120
M110
T2 M6
G43 H2
G0 X50 Y20 Z100
M110
T3 M6
G43 H3
G0 X20 Y20 Z80
#1 = 0
o1 while [#1 LT 5]
  G1 X[20 + #1 * 15] F6000
  M120
  #1 = [#1 + 1]
o1 endwhile
G0 Z150
M2
