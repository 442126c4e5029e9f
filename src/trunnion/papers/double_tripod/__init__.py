"""The double tripod driveshaft: what was published, what is computed."""
