"""Published papers, a folder each: numbers as printed, what is computed anew, errata; and the catalogue."""
