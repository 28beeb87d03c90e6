(mistake: a keyway with three slips that a look at the screen does not show)
G21 G90 G17 G94
T1 M6
G43 H1
G0 X20 Y30 Z5
G1 Z-2 F200
S6000 M3
G1 X70 F600
G0 X20 Y36
G0 Z5
G2 X30 Y36 I4 J0
G1 X3000
M5
M2
