"""Files and folders that gcodesim writes: whole or not at all, and only where they are its own."""
