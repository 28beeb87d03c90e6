; first part on the router
g21 g90        ; mm, absolute
t1 m6
g43
s8000 m3
g0 x20 y30
   z5
g1 z-2 f200
x70 f600
g0 z20
m5
m2