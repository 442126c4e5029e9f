"""Whether a line is fit for its speeds: one check a file, each with its formula, source and inputs."""
