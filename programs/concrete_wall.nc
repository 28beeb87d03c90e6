(hollow block of concrete, 300 x 220 x 150 mm, corners of 40 mm radius, beads 30 x 15 mm)
G21 G90 G17 G94 G64 P0.5
T1 M6
G43 H1
#<layer> = 1
G0 X40 Y0
o100 while [#<layer> LE 10]
  G0 Z[15 * #<layer>]
  M10
  G1 X260 F5975
  G3 X300 Y40 I0 J40
  G1 Y180
  G3 X260 Y220 I-40 J0
  G1 X40
  G3 X0 Y180 I0 J-40
  G1 Y40
  G3 X40 Y0 I40 J0
  M11
  #<layer> = [#<layer> + 1]
o100 endwhile
G0 Z250
M2
