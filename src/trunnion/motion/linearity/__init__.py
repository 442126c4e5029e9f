"""The linear steady response beside the nonlinear one."""
