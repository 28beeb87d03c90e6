(six cartons from a stack of two layers onto a pallet; the upper layer of the stack becomes the lower one there)
G21 G90 G17 G94
G43 H1
G54
G0 X0 Y-100 Z160
#1 = 0
o100 while [#1 LT 6]
  #2 = FIX[#1 / 3]                (layer)
  #3 = [#1 MOD 3]                 (place in the layer)
  G54
  G0 X0 Y[[#3 - 1] * 100] Z160
  G1 Z[100 - #2 * 50] F12000
  M62 P1
  G4 P0.3
  G1 Z160 F20000
  G55
  G0 X0 Y[[#3 - 1] * 90] Z310
  G1 Z[50 + #2 * 50] F12000
  M63 P1
  G4 P0.2
  G1 Z310 F30000
  #1 = [#1 + 1]
o100 endwhile
G54
G0 X0 Y0 Z200
M2
