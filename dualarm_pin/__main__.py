"""`python -m dualarm_pin` is `dualarm-pin`."""

from dualarm_pin.cli import main

if __name__ == "__main__":
    main()
