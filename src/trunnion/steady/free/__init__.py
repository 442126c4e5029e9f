"""The periodic steady state of a free–free line, over its mean speed."""
