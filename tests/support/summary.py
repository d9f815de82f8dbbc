"""Reports failures, the slowest ten tests and every skip; fails for skips that tests/expected_skips does not list.

summary.py TESTS.XML PRESET DATA, where DATA is the folder of real scenes or empty.
"""

import fnmatch
import os
import pathlib
import re
import subprocess
import sys
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]


def expected(conditions):
    """Pattern and reason of each test that may be skipped."""
    for line in (ROOT / "tests/expected_skips").read_text().splitlines():
        if line.strip() and not line.startswith("#"):
            condition, pattern, reason = line.split(None, 2)
            if condition in conditions:
                yield pattern, reason


def print_failures(name, output):
    """Prints the last 40 lines of each failed test, because logs of whole runs are often truncated."""
    failed = re.findall(r"^\[ RUN      \] ([\w/.]+)\n((?:(?!\[ RUN ).*\n)*?)\[  FAILED  \] \1", output, re.M)
    for inner, text in failed or [(name, output)]:
        print(f"\nFAILED {inner}")
        print("\n".join(text.splitlines()[-40:]))


def main(report, preset, data):
    times, skipped = [], set()
    for case in xml.etree.ElementTree.parse(report).getroot().iter("testcase"):
        output = case.findtext("system-out") or ""
        if case.find("failure") is not None:
            print_failures(case.get("name"), output)
        # One process may run many tests; it passes if some are skipped.
        inner = set(re.findall(r"^\[  SKIPPED \] ([\w/.]+)(?: \(|$)", output, re.M))
        skipped |= inner
        if case.get("status") not in ("notrun", "disabled"):
            inner_times = re.findall(r"^\[ +(?:OK|FAILED) +\] ([\w/.]+).*\((\d+) ms\)", output, re.M)
            times += [(int(ms) / 1000, name) for name, ms in inner_times]
            if not inner_times:
                times.append((float(case.get("time", 0)), case.get("name")))
        elif not inner:
            skipped.add(case.get("name"))
    print("\nslowest:")
    for seconds, name in sorted(times, reverse=True)[:10]:
        print(f"  {seconds:7.1f} s  {name}")
    conditions = {preset, "any"}
    if not data:
        conditions.add("without-data")
    if "REBAKE_DEEP" not in os.environ:
        conditions.add("quick")
    if subprocess.run(["unshare", "--mount", "true"], capture_output=True).returncode:
        conditions.add("unprivileged")
    allowed = list(expected(conditions))
    unexpected = 0
    for name in sorted(skipped):
        reason = next((reason for pattern, reason in allowed if fnmatch.fnmatch(name, pattern)), None)
        print(f"skipped {name}: {reason}" if reason else f"SKIPPED {name}: tests/expected_skips does not list it")
        unexpected += reason is None
    if unexpected:
        sys.exit(f"{unexpected} tests were skipped that must run")


if __name__ == "__main__":
    main(*sys.argv[1:])
