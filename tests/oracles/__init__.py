"""Independent models that the tests hold the package against.

Only ``package_kernels`` calls the package's equations or numerics; everything else is written anew from the
mechanics, in other coordinates and with other integrators.
"""
