%
(contour: outline of a lever, lines and tangent arcs, three depths)
(stock 110 x 70 x 12, zero top front left; T1 end mill 8)
(path of the tool centre, offset by 4 mm outside the part)
#<depth> = 0
G21 G90 G17 G40 G94
G64 P0.01
T1 M6
G43 H1
S8000 M3
G0 X5 Y35
G0 Z5
o100 repeat [3]
  #<depth> = [#<depth> - 2]
  G1 Z#<depth> F250
  F900
  G2 X30 Y60 I25 J0        (round the large eye)
  G2 X35 Y59.495 I0 J-25
  G1 X83 Y49.697           (upper flank)
  G2 X83 Y20.303 I-3 J-14.697
  G1 X35 Y10.505           (lower flank)
  G2 X5 Y35 I-5 J24.495
o100 endrepeat
G0 Z20
M5
M30
%
