G21 G90 G17 G94
o1 sub
o1 call
o1 endsub
o1 call
M2
