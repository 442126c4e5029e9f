"""Integration of smooth systems, with tangents."""
