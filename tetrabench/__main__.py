"""`python -m tetrabench`: the same as `tetrabench`."""

from tetrabench.cli import main

if __name__ == "__main__":
    main()
