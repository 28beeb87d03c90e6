(heavy: slots in steel with an end mill 20 mm, the load that a large arm has to carry)
(stock 200 x 120 x 40, 42CrMo4, zero top front left)
G21 G90 G17 G94 G64 P0.05
T1 M6
G43 H1
S1200 M3
G0 X-15 Y30
G0 Z10
G0 Z-4
G1 X215 F300
G0 Z10
G0 X-15 Y80
G0 Z-6
G1 X100
G3 X150 Y80 I25 J0
G1 X215
G0 Z60
M5
M2
