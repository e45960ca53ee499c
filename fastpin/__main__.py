"""``python -m fastpin``."""

import sys

from fastpin.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
