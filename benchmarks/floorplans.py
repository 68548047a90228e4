"""Does the same tree hold on real building maps?  python benchmarks/floorplans.py [--maps GLOB].

Maps come from the folder ``floorplans`` under EXPLORE_BT_DATA; every map is explored from its widest place.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from pathlib import Path

from machine import ROOT, describe_machine

from missions import HEADER, median_row, row, run


def main() -> None:
    """Run ``missions/02_any_map.yaml`` on every map and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--maps", default="*/*.yaml", help="pattern below the folder floorplans")
    parser.add_argument("--slam", default="kiss_gtsam")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    data = os.environ.get("EXPLORE_BT_DATA")
    if not data:
        sys.exit("EXPLORE_BT_DATA is not set: it names the folder that holds floorplans/")
    print(f"02_any_map.yaml, slam {arguments.slam}, seed {arguments.seed}, {describe_machine()}\n\n{HEADER}")
    results = []
    with tempfile.TemporaryDirectory() as folder:
        for path in sorted((Path(data) / "floorplans").glob(arguments.maps)):
            settings = [f"world={path}", f"slam={arguments.slam}"]
            out = Path(folder) / path.stem
            results.append(run(ROOT / "missions/02_any_map.yaml", out, arguments.seed, settings))
            print(row(path.stem, results[-1]), flush=True)
    print(median_row(results))


if __name__ == "__main__":
    main()
