"""`python -m gcodesim` is `gcodesim`."""

import sys

from gcodesim.cli import main

sys.exit(main())
