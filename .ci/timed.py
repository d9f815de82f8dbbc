"""Runs the named steps of a check in order and prints their times.

timed.py [--all] NAME COMMAND [NAME COMMAND …]; commands are for bash. A failed step ends the run, unless --all is given.
Times are wall and CPU minutes (user + system of all descendants).
"""

import os
import resource
import subprocess
import sys
import time


def cpu():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main(words):
    go_on = words[0] == "--all"
    steps = words[1:] if go_on else words
    lines, failed, start = [], [], time.monotonic()
    for name, command in zip(steps[::2], steps[1::2]):
        print(f"\n== {name}", flush=True)
        wall_before, cpu_before = time.monotonic(), cpu()
        result = subprocess.run(["bash", "-euo", "pipefail", "-c", command]).returncode
        lines.append((name, time.monotonic() - wall_before, cpu() - cpu_before))
        if result:
            failed.append(name)
            if not go_on:
                break
    lines.append(("total", time.monotonic() - start, cpu()))
    print(f"\n{'minutes':40} {'wall':>7} {'CPU':>7}")
    for name, wall, used in lines:
        print(f"{name:40} {wall / 60:7.1f} {used / 60:7.1f}")
    if failed:
        print(f"FAILED: {', '.join(failed)}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
