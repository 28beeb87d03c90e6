(a groove of 1.7 m in a beam, longer than the reach of the arm)
G21 G17 G90 G94 G64 P0.02
T1 M6
G43 H1
S12000 M3
G0 X50 Y30 Z20
G1 Z-4 F2000
G1 X1750 F12000
G0 Z20
M5
M2
