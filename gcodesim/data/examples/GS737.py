pressure = 3 / 0
