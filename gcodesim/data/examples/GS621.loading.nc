G21 G90 G17 G94
o100 repeat [2]
G4 P2
M200
o100 endrepeat
M2
