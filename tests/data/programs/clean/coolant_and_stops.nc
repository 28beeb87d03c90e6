G21 G90 G17 G94 G54
T1 M6
G43 H1
/G0 Z40 (only without block delete)
M3 S10000
G4 P2
M8
G0 X10 Y10
G0 Z2
M1 (look at the edge)
G1 Z-1 F200
G1 X60 F600
G93
G1 X70 Y20 F20
G94
G0 Z20
M9
M5
M0 (turn the part)
M2
