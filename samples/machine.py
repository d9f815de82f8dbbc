"""The machine that measurements were made on."""
import datetime
import os
import platform
import re


def machine():
    """Cores and processor, for example "2 cores, Intel(R) Xeon(R) Processor"."""
    with open("/proc/cpuinfo") as file:
        model = re.search(r"model name\s*: (.*)", file.read())
    return f"{os.cpu_count()} cores, {model.group(1).strip() if model else platform.machine()}"


def today():
    return datetime.date.today().isoformat()
