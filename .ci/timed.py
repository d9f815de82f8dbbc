"""Runs the named steps of a check one after another, stops at the first that fails, and prints what each took.

Steps are pairs: timed.py NAME COMMAND [NAME COMMAND …], commands for bash. Times are wall and
CPU (user + system of all descendants that were waited for) minutes.
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
    lines, start, result = [], time.monotonic(), 0
    for name, command in zip(words[::2], words[1::2]):
        print(f"\n== {name}", flush=True)
        wall_before, cpu_before = time.monotonic(), cpu()
        result = subprocess.run(["bash", "-euo", "pipefail", "-c", command]).returncode
        lines.append((name, time.monotonic() - wall_before, cpu() - cpu_before))
        if result:
            break
    lines.append(("total", time.monotonic() - start, cpu()))
    print(f"\n{'minutes':40} {'wall':>7} {'CPU':>7}")
    for name, wall, used in lines:
        print(f"{name:40} {wall / 60:7.1f} {used / 60:7.1f}")
    if result:
        print(f"FAILED: {lines[-2][0]}")
    sys.exit(result)


if __name__ == "__main__":
    main(sys.argv[1:])
