(the holder: it brings the next stripe of the panel before the gun)
G21 G90 G17 G94 G64 P0.1
#1 = -100
G0 X30 Y#1 Z0
o100 repeat [6]
  M200
  (wait for the end of the stripe)
  M201
  #1 = [#1 + 40]
  G1 Y#1 F12000
o100 endrepeat
M2
