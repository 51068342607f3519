"""The ten cylinders: parameters, kinematics, proportions, and the thesis's stick body."""
