G21 G90 G17 G94
o100 repeat [3]
G4 P8
M200
o100 endrepeat
M2
