"""A log in the formats of other programs: tables, JSON lines, meshes, ROS 2 bags."""
