( hub: turned, then a hexagon, a cross hole, four holes and two slots by driven tools, then parted off )
( X is a radius; C turns the work )
G21 G18 G8 G90 G40 G49
G54

( facing and turning )
T1 M6 G43
G96 S250 D3000 M3
G95 F0.25
G0 X27 Z0
G1 X-0.9
G0 Z2
X22
G1 Z-20
X26
G0 Z2
X19
G1 Z-20
X26
G0 Z2
X16
G1 Z-20
X26
G0 Z2
X15
G1 Z-20
X24
Z-50
X27
G0 X60 Z60
M5

( hexagon of 26 mm across flats )
G94
T2 M6 G43
G97 S4000 M3
G0 X20 Z14
O100 sub
  G0 Z14 C#1
  X13
  G1 Z-7 F1200
  G0 X20
O100 endsub
O100 call [0]
O100 call [60]
O100 call [120]
O100 call [180]
O100 call [240]
O100 call [300]
G0 X60 Z60
M5

( cross hole through two flats of it )
T3 M6 G43
S3000 M3
G0 Z-34
G0 C30
G0 X28
G1 X-28 F400
G0 X60
Z60
M5

( holes and slots in the shoulder )
T4 M6 G43
S6000 M3
G0 X19.5
Z2
O200 sub
  G0 C#1
  Z-18
  G1 Z-28 F300
  G0 Z-18
O200 endsub
O200 call [0]
O200 call [90]
O200 call [180]
O200 call [270]
O300 sub
  G0 C[#1]
  G1 Z-23 F300
  C[#1 + 50] F3000
  G0 Z-18
O300 endsub
O300 call [20]
O300 call [200]
G0 Z60
X60
M5

( parting )
T5 M6 G43
G96 S120 D2500 M3
G95 F0.1
G0 Z-48
X28
G1 X-0.1
G0 X60
Z60
M5
M2
