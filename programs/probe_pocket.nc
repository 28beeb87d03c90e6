(a pocket is milled, then a probe finds its walls and its middle, and measures the floor in a grid)
G21 G90 G17 G94 G40
T1 M6
G43 H1
S9000 M3
G0 X20 Y15
G0 Z2
F700
G1 Z-4
G1 X13.2 Y11.1
G1 X41.4
G1 Y24.3
G1 X13.2
G1 Y11.1
G1 Y17.7
G1 X41.4
G0 Z100
M5

T2 M6
G43 H2
G0 X27 Y18
G0 Z5
(the first touch is fast, the second one slow)
G38.2 Z-10 F600
G91 G0 Z0.5
G90
G38.2 Z-10 F60
#<floor> = #5063
G91 G0 Z2
G90

(walls in X and Y; the ball touches by its radius)
#<r> = [#5410 / 2]
G38.2 X60 F300
#<right> = [#5061 + #<r>]
G0 X27
G38.2 X-5
#<left> = [#5061 - #<r>]
G0 X[[#<left> + #<right>] / 2]
G38.2 Y40
#<back> = [#5062 + #<r>]
G0 Y18
G38.2 Y-5
#<front> = [#5062 - #<r>]
G0 Y[[#<front> + #<back>] / 2]
(DEBUG, the pocket is #<left> to #<right> by #<front> to #<back>, floor at #<floor>)

(a grid of heights, as smartprobe.ngc does it; the last one of each row is on the rim)
#<lowest> = 0.
#<count> = 0
#<y> = 12
o100 while [#<y> LE 24]
  #<x> = 20
  o200 while [#<x> LE 50]
    G0 Z5
    G0 X#<x> Y#<y>
    G38.3 Z-6 F600
    o300 if [#5070 EQ 1]
      #<count> = [#<count> + 1]
      o310 if [#5063 LT #<lowest>]
        #<lowest> = #5063
      o310 endif
    o300 endif
    #<x> = [#<x> + 15]
  o200 endwhile
  #<y> = [#<y> + 12]
o100 endwhile
(DEBUG, #<count> places are touched, the lowest at #<lowest>)
G0 Z50
M2
