G21 G90 G17 G94
o<holes> sub
G0 X10
o<holes> endsub
o<slots> sub
G0 X20
o<slots> endsub
o<holes> call
M2
