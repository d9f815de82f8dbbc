"""What a run of all tests should not pass over in silence: the slowest ten, and every one that was skipped."""

import sys
import xml.etree.ElementTree

cases = xml.etree.ElementTree.parse(sys.argv[1]).getroot().iter("testcase")
times, skipped = [], []
for case in cases:
    if case.get("status") in ("notrun", "disabled"):
        skipped.append((case.get("name"), (case.findtext("system-out") or "").strip().splitlines()))
    else:
        times.append((float(case.get("time", 0)), case.get("name")))
print("\nslowest:")
for seconds, name in sorted(times, reverse=True)[:10]:
    print(f"  {seconds:7.1f} s  {name}")
for name, said in skipped:
    print(f"SKIPPED {name}: {said[-1] if said else 'no reason given'}")
