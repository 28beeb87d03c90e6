G21 G90 G17 G94
o<hole> sub
G0 X0
o<hole> endsub
o<holes> call
M2
