# SPDX-License-Identifier: Apache-2.0
"""Long runs, and single cases, of the families of generated systems.

    python3 tests/support/families --count 20000 --seed 1
    python3 tests/support/families --family pages --seed 17 --count 1
    python3 tests/support/families --family pages --seed 17 --write page.poly [--way WAY]

Prints each case that does not hold, with the command that runs it again, and a table.
--write only writes the system, or with --way its twin spoiled in that way.  The engine is
the build folder's ($TETRAD_BUILD, else build/release); the judge is used where it is at
hand."""

import argparse
import sys

import families
import runs
import spoils


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--family", action="append", choices=sorted(families.FAMILIES), help="these alone")
    parser.add_argument("--count", type=int, default=500, help="cases, of all families in turn")
    parser.add_argument("--seed", type=int, default=1, help="of the first case of each family")
    parser.add_argument("--break-points", action="store_true", help="remove local degeneracies; none may be left")
    parser.add_argument("--no-judge", action="store_true", help="the engine's own audit alone")
    parser.add_argument("--way", choices=sorted(spoils.WAYS), help="how --write spoils")
    parser.add_argument("--write", metavar="FILE", help="write one system and end")
    given = parser.parse_args()
    names = given.family or sorted(families.FAMILIES)
    if given.write:
        pls = families.make(names[0], given.seed)
        if given.way:
            _, pls, expected = spoils.spoil(pls, f"{names[0]} {given.seed}", given.way)
            print("to be refused as", *expected.statuses)
        pls.write(given.write)
        return 0
    judge = None if given.no_judge or not runs.models.available() else runs.models.judge()
    found = runs.run(names, given.count, given.seed, judge, lambda r: print(runs.complaint(r), flush=True),
                     runs.BREAKING if given.break_points else runs.CDT)
    print(runs.table(found))
    failed = sum(bool(r.faults()) for rs in found.values() for r in rs)
    print(f"{given.count - failed} hold, {failed} do not; " + ("judged" if judge else "not judged"))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
