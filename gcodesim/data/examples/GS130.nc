G21 G90 G17 G94
o1 if [#1 GT 2]
G0 X10
o2 endif
M2
