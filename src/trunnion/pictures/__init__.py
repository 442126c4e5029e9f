"""Pictures of results, described once as data, and drawn by Matplotlib for files and by Bokeh for the browser.

A library is loaded when the first picture is drawn; no global state is touched.
"""
