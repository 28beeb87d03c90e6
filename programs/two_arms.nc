(left half of a block that two arms mill: a pocket, then a groove in the middle)
G21 G90 G17 G94 G64 P0.02
T1 M6
G43 H1
S9000 M3
G0 X-190 Y-20 Z30
G4 P1.5
(both wait until the block is clamped)
M200
G0 Z2
o100 repeat [2]
  #1 = [#1 + 1]
  G1 Z[-1 * #1] F300
  G1 Y20 F900
  G1 X-182
  G1 Y-20
  G1 X-174
  G1 Y20
  G1 X-190
  G1 Y-20
o100 endrepeat
G0 Z10
(the groove in the middle, before the other arm comes)
G0 X0 Y-25
G0 Z2
G1 Z-1.5 F300
G1 Y25 F900
G0 Z30
G0 X-190 Y0
(the middle is free)
M201
M5
M2
