"""``python -m racs_bif VERB``, the same program as the console script ``racs-bif``."""

import sys

from racs_bif.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
