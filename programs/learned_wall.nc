(a wall that learns: after each layer a probe finds its top, and the next layer begins there)
G21 G90 G17 G94 G64 P0.2
#<top> = 0
#<layer> = 1
o10 while [#<layer> LE 3]
  T1 M6
  G43 H1
  G0 X0 Y10 Z[#<top> + 40]
  G0 Z[#<top> + 4]
  M10
  G1 X100 F2400
  M11
  G0 Z[#<top> + 40]
  T2 M6
  G43 H2
  G0 X50 Y10
  G0 Z[#<top> + 10]
  G38.2 Z[#<top> - 2] F300
  #<top> = #5063
  (DEBUG, layer #<layer> ends at Z#<top>)
  G0 Z[#<top> + 40]
  #<layer> = [#<layer> + 1]
o10 endwhile
M2
