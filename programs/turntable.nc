(a groove across the top while the table turns, then one around the tilted edge)
G21 G17 G90 G94 G64 P0.02
T1 M6
G43 H1
S12000 M3
G0 X-48 Y0 Z20 A0 C0
G0 Z-1
G1 X30 C90 F3000
G0 Z30
G0 A-30 C0
G0 X0 Y-40 Z10
G1 Z-1 F2000
G3 X0 Y40 I0 J40 C-90 F3000
G0 Z30
M5
M2
