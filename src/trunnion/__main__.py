"""``python -m trunnion``: the command, where the script is not on the path."""

from trunnion.cli.program import main

main()
