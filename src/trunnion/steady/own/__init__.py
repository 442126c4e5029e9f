"""The periodic steady state of a line that starts free, over its mean speed."""
