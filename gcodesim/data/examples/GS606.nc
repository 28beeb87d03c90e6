G21 G90
T1 M6
S5000 M3
G0 X0 Y0 Z5
G1 Z-2 F200
X20 F600
G0 Z50
M5 (before it stood G92 X0 when it was accepted)
M2
