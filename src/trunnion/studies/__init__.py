"""Published studies, a folder a paper: numbers as printed, what is computed anew, errata; and the catalogue."""
