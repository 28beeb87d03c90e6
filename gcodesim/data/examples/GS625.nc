G21 G90
M61 Q1 (the tool is put on the flange by hand, and taken off)
M61 Q0
T1 M6
G43 H1
G0 X0 Y0 Z100
M2
