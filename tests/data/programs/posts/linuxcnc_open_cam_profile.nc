(Exported by an open CAM)
(Post: linuxcnc)
(Output Time: none)
(begin preamble)
G17 G54 G40 G49 G80 G90
G21
(begin operation: G54)
(machine: not set, mm/min)
G54
(finish operation: G54)
(begin operation: TC: 6mm Endmill)
(TC: 6mm Endmill)
(begin toolchange)
M5
M6 T2 
G43 H2 
M3 S10000 
(finish operation: TC: 6mm Endmill)
(begin operation: Profile)
(Compensated Tool Path. Diameter: 6.0)
G0 Z15.000 
G0 X-3.000 Y-3.000 
G0 Z3.000 
G1 X-3.000 Y-3.000 Z-2.500 F200.000
G1 X-3.000 Y30.000 Z-2.500 F600.000
G2 X0.000 Y33.000 Z-2.500 I3.000 J0.000 F600.000
G1 X40.000 Y33.000 Z-2.500 F600.000
G1 X40.000 Y-3.000 Z-2.500 F600.000
G1 X-3.000 Y-3.000 Z-2.500 F600.000
G1 X-3.000 Y-3.000 Z-5.000 F200.000
G1 X-3.000 Y30.000 Z-5.000 F600.000
G2 X0.000 Y33.000 Z-5.000 I3.000 J0.000 F600.000
G1 X40.000 Y33.000 Z-5.000 F600.000
G1 X40.000 Y-3.000 Z-5.000 F600.000
G1 X-3.000 Y-3.000 Z-5.000 F600.000
G0 Z15.000 
(finish operation: Profile)
(begin postamble)
M05
G17 G54 G90 G80 G40
M2
