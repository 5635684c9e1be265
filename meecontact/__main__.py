"""``python -m meecontact``: the command ``meecontact``, where no script of that name is on the path."""

import sys

from workflow.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
