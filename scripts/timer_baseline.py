#!/usr/bin/env python3
"""A bare 60 Hz timer loop: how late this machine wakes a process that does nothing.

Prints {"p50":..,"p99":..,"max":..} in microseconds; run beside a match, it is the floor that the
match's tick lateness is compared with.
"""
import argparse
import json
import time


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=int, default=20)
    parser.add_argument("--rate", type=int, default=60)
    options = parser.parse_args()
    period = 1.0 / options.rate
    start = time.monotonic()
    late_us = []
    for tick in range(options.seconds * options.rate):
        due = start + tick * period
        delay = due - time.monotonic()
        if delay > 0:
            time.sleep(delay)
        late_us.append((time.monotonic() - due) * 1e6)
    late_us.sort()
    count = len(late_us)
    print(json.dumps({
        "p50": round(late_us[count // 2]),
        "p99": round(late_us[min(count - 1, count * 99 // 100)]),
        "max": round(late_us[-1]),
    }))


if __name__ == "__main__":
    main()
