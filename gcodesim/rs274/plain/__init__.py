"""The compiled lane: runs of plain moves from bytes to arrays, with the meaning that the grammar's lane gives them."""
