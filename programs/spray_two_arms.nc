(the painter: the gun goes up and down at one place, and the panel comes past)
G21 G90 G17 G94 G64 P0.1
T8 M6
G43 H8
M67 E0 Q1.5
G0 X-150 Y0 Z-130
o100 repeat [3]
  (the panel is there)
  M200
  M10
  G1 Z130 F18000
  M11
  M201
  M200
  M10
  G1 Z-130 F18000
  M11
  M201
o100 endrepeat
M2
