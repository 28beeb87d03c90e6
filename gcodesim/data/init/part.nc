(Zero is the top front left corner of the stock, see `zero` in cell.yaml)
(A slot, 6 mm wide and 2 mm deep, from X20 to X70 along the middle of a plate)
G21 G90 G17 G94      (mm, absolute, arcs in XY, feed per minute)
G54                  (work coordinates)
T1 M6                (flat end mill, 6 mm)
G43 H1               (its length)
S12000 M3            (spindle on, clockwise)
G0 X20 Y30           (above the start of the slot)
G0 Z5
G1 Z-2 F200          (plunge)
G1 X70 F600          (cut)
G0 Z25               (out of the part)
M5
M2
