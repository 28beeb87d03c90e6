"""What the sensors of a cell read: when, what they see, and where it goes. The sensors themselves are in `sensors`."""
