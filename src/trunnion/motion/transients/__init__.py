"""What happens when a line starts, is struck, brakes or slips: motions under torques over time, speed and angle."""
