"""Scripts that complete command lines: a file for each shell, whose `script` writes what it finds in an outline."""
