%
(holes by cycles, a bore by a subroutine, a contour beside its line)
o<bore> sub
  G1 X[#1 + #3] Y#2 F300
  G2 X[#1 + #3] Y#2 I[-#3] J0 Z#4
  G2 X[#1 + #3] Y#2 I[-#3] J0
  G1 X#1 Y#2
o<bore> endsub
G21 G90 G17 G94 G40 G49 G80
G54
T3 M6
G43 H3
S4000 M3
G0 X8 Y8
G0 Z5
G98 G81 X8 Y8 Z-3 R1 F150
X32
G82 Y22 Z-4 R1 P0.4
G80
G0 Z20
T1 M6
G43 H1
S9000 M3
G0 X20 Y15
G0 Z1
G1 Z0.2 F400
o<bore> call [20] [15] [3] [-1.2]
G0 Z10
G55
G0 X-14 Y0
Z1
G1 Z-0.6 F250
G41 D1 G1 X-8 Y-4 F350
G3 X-4 Y0 R4
G1 Y6
G40 X0 Y10
G0 Z20
M5
M30
%
