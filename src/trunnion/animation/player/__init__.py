"""The player of lines in motion: its sources, what is built of them, and the part of the application that shows it."""
