(machine tending: the belt brings a blank, the door opens, the arm puts it into the vise, the jaw closes, the door shuts)
G21 G90 G17 G94
G43 H1
G54
G0 X0 Y0 Z150
M64 P2                 (belt on)
M64 P3                 (door open)
G4 P3
M65 P2
M66 P3 L3 Q5           (wait until the door is open)
G0 X80 Y0 Z100
G1 Z30 F9000
M62 P1
G4 P0.4
G1 Z150 F15000
G55
G0 X0 Y0 Z150
G1 Z30 F6000
M64 P4                 (jaw)
M66 P4 L3 Q2
M63 P1
G4 P0.4
G1 Z150 F15000
G54
G0 X0 Y0 Z200
M65 P3                 (door shut)
G4 P0.5
G0 X0 Y0 Z150
M2
