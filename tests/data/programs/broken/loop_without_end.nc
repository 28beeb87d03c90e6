G21 G90 G17 G94
T1 M6
G43 H1
S8000 M3
G0 X0 Y0 Z5
#1=0
o1 while [#1 LT 0]
o2 repeat [2]
G0 X#1
o2 endrepeat
G0 Z25
M5
M2
