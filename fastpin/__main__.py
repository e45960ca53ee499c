"""The entry point of ``python -m fastpin``: run the command line."""

import sys

from fastpin.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
