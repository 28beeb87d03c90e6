G21 G90 G17 G94
G0 X10 (over the part
G0 Y5
M2
