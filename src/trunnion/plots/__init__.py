"""Pictures of results. matplotlib is loaded when the first one is drawn; no global state is touched."""
