; nameplate
g21 g90
g0 z5
m3 s8000
g4 p2
g0 x0 y0
g1 z-1 f80
g1 x40 f300
y15
x0
y0
g0 z5
g91
g0 x5 y5
g90
g1 z-0.3 f80
g1 x30
g0 z20
m5
