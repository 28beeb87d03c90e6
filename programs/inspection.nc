(a slot, and what cameras and a scanner see of it)
G21 G90 G17 G54 G64 P0.01
T1 M6
G43 H1
S8000 M3
G0 X-10 Y20
G0 Z5
G1 Z-3 F600
G1 X70 F1200
G0 Z50
M5
M62 P1 (the camera beside the machine)
G0 X-150
T9 M6
G43 H9
G0 X30 Y20
G0 Z70
M110 (the camera in the spindle)
G0 Y100 (the scanner at the head, 80 mm beside it)
M120
M63 P1
G0 Z120
M2
