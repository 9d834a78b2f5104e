# SPDX-License-Identifier: GPL-3.0-or-later
"""The program itself: `python3 -m vibrospice run paper`, and what a wheel installs as `vibrospice`."""

import os
import sys

from .calls import OWN, program
from .tables import Error


def main() -> None:
    """Becomes the program: that of the wheel, whatever $VIBROSPICE says, since it may name this script."""
    try:
        path = OWN if os.path.exists(OWN) else program()
    except Error as error:
        sys.exit(f"vibrospice: {error}")
    os.execv(path, ["vibrospice", *sys.argv[1:]])


if __name__ == "__main__":
    main()
