"""Runs the named steps of a check in order and prints their times.

timed.py [--all] [--only WORD]… NAME COMMAND [NAME COMMAND …]; commands are for bash. A failed step ends the run, unless
--all is given. With --only, steps whose name has one of the words run; the others are listed as not run. Times are wall
and CPU minutes (user + system of all descendants).
"""

import argparse
import resource
import subprocess
import sys
import time


def cpu():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def chosen(steps, words):
    for word in words:
        if not any(word in name for name, _ in steps):
            sys.exit(f"no step's name has '{word}': {', '.join(name for name, _ in steps)}")
    return [step for step in steps if not words or any(word in step[0] for word in words)]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("steps", nargs="+")
    arguments = parser.parse_args()
    go_on = arguments.all
    steps = list(zip(arguments.steps[::2], arguments.steps[1::2]))
    runs = chosen(steps, arguments.only)
    lines, failed, start = [], [], time.monotonic()
    for name, command in runs:
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
    if len(runs) < len(steps):
        print("not run:", ", ".join(name for name, command in steps if (name, command) not in runs))
    if failed:
        print(f"FAILED: {', '.join(failed)}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
