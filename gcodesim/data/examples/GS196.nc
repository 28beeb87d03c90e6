G21 G90 G17 G94
(MSG, turn the part over) G0 Z50 (retract)
M0
M2
