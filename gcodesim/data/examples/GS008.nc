G21 G90 G17 G94
o1 loop [#1 LT 5]
o1 endloop
M2
