"""One language of declarations for cells, tools and processes."""
