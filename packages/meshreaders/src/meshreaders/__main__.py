"""`python -m meshreaders` is the command `meshreaders`."""

import sys

from meshreaders.command import main

if __name__ == "__main__":
    sys.exit(main())
