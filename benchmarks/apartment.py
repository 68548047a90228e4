"""Does the main mission finish by itself, seed after seed?  python benchmarks/apartment.py [--seeds 10]."""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

from machine import ROOT, describe_machine

from missions import HEADER, median_row, row, run


def main() -> None:
    """Run ``missions/01_apartment.yaml`` for every seed, one after the other, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=10, help="seeds 0 to N-1")
    parser.add_argument("--mission", type=Path, default=ROOT / "missions/01_apartment.yaml")
    arguments = parser.parse_args()
    print(f"{arguments.mission.name}, {describe_machine()}\n\n{HEADER}")
    results = []
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(arguments.seeds):
            results.append(run(arguments.mission, Path(folder) / str(seed), seed))
            print(row(f"seed {seed}", results[-1]), flush=True)
    print(median_row(results))


if __name__ == "__main__":
    main()
