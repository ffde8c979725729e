#!/usr/bin/env python3
"""How many tests passed, failed and were skipped, as "PASSED FAILED SKIPPED".

  count_tests.py REPORT [SHARDS]

REPORT: what `ctest --output-junit` wrote. SHARDS: a folder with GoogleTest's XML of the tests that
ran many in one program, NAME.xml for ctest's test NAME; each of theirs counts as one. A program
that did not live to write it counts as one that failed, and so does one that failed although its
tests did not (a leak found at the end)."""

import pathlib
import sys
import xml.etree.ElementTree as xml


class Counts:
    def __init__(self):
        self.passed = self.failed = self.skipped = 0

    def add(self, case):
        if case.find("failure") is not None or case.get("status") == "fail":
            self.failed += 1
        elif case.find("skipped") is not None or case.get("status") in ("notrun", "disabled"):
            self.skipped += 1
        else:
            self.passed += 1


def count(report, shards):
    counts = Counts()
    for case in xml.parse(report).getroot().iter("testcase"):
        shard = shards / (case.get("name") + ".xml") if shards else None
        if shard is None or not shard.exists():
            counts.add(case)
            continue
        failed = counts.failed
        for inner in xml.parse(shard).getroot().iter("testcase"):
            counts.add(inner)
        if case.get("status") == "fail" and counts.failed == failed:
            counts.failed += 1
    return counts


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    shards = pathlib.Path(sys.argv[2]) if len(sys.argv) == 3 else None
    counts = count(sys.argv[1], shards)
    print(counts.passed, counts.failed, counts.skipped)


if __name__ == "__main__":
    main()
