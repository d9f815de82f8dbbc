"""Description of the machine and the day, for reports of measurements."""
import datetime
import os
import platform
import re


def machine():
    """Number of cores and name of the processor, for example "2 cores, Intel(R) Xeon(R) Processor"."""
    with open("/proc/cpuinfo") as file:
        model = re.search(r"model name\s*: (.*)", file.read())
    return f"{os.cpu_count()} cores, {model.group(1).strip() if model else platform.machine()}"


def today():
    return datetime.date.today().isoformat()
