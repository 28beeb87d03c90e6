(pocket: a block with one pocket, and one digit that slipped)
(stock 40 x 30 x 10, zero top front left, AlMgSi1; T1 end mill 6)
G21 G90 G17 G94 G54 G61
T1 M6
G43 H1
S8000 M3
G0 X11 Y11 Z3
(upper half)
G1 Z-2 F200
X29 F700
Y19
X11
Y11
X11 Y15
X29
(floor)
G1 Y11
G1 Z-4 F200
X11 F700
Y19
X29
Y11
Y15
X20 Z-4.5 (Z-4 was meant)
X11 Z-4
G0 Z20
M5
M2
