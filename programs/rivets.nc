(rivets: two steel rivets of 6 mm are cut out, so that the cover comes off)
(T1 end mill 6; each bore is a helix of 8 mm, 16 mm deep)
G21 G90 G17 G94 G64 P0.01
T1 M6
G43 H1
S8000 M3
G0 X12 Y15
G0 Z2
G1 X13 Z0.2 F400
G3 X13 Y15 Z-16 I-1 J0 P20 F300
G3 X13 Y15 I-1 J0
G1 X12
G0 Z5
G0 X48 Y15
G0 Z2
G1 X49 Z0.2 F400
G3 X49 Y15 Z-16 I-1 J0 P20 F300
G3 X49 Y15 I-1 J0
G1 X48
G0 Z40
M5
M2
