G21 G90 G17 G94
#1 = 0
o1 while [#1 LT 10]
G0 X#1
o1 endwhile
M2
