"""Set-ups of one part: each a program in a cell, one after the other, with the stock handed on."""
