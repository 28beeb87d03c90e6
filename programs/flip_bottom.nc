(flip, second set-up: turned over about X; the pocket of the lower side, and the hole from below)
(stock as the first set-up left it, zero again top front left; T1 end mill 6, T2 drill 6)
G21 G90 G17 G94 G54 G61
T1 M6
G43 H1
S9000 M3
G0 X23 Y15 Z5
G1 Z-3 F200
G1 X23 Y15 F800
X29
Y23
X23
Y15
G1 X19 Y11 F800
X33
Y27
X19
Y11
G1 X23 Y15 F900
G1 Z-6 F200
G1 X23 Y15 F800
X29
Y23
X23
Y15
G1 X19 Y11 F800
X33
Y27
X19
Y11
G0 Z30
M5
T2 M6
G43 H2
S3000 M3
G0 X24 Y22 Z5
G81 Z-12 R-4 F250
G80
G0 Z30
M5
M2
