#!/usr/bin/env python3
"""Compares two files of Google Benchmark (--benchmark_out_format=json).

usage: compare_bench.py [--threshold 0.1] [--counters] BEFORE.json AFTER.json

Prints after / before of each benchmark's real time, the slowest first, then what only one of the files has. Where a
benchmark was repeated, the median counts. --counters: their counters' ratios, too, which do not decide the exit code.
Exit code 1 when a benchmark takes more than 1 + threshold times as long, or is missing or failed in AFTER; 2 when
the files cannot be compared.
"""

import argparse
import json
import statistics
import sys

NANOSECONDS = {"ns": 1, "us": 1e3, "ms": 1e6, "s": 1e9}
# What Google Benchmark writes beside our counters.
OWN_KEYS = {"family_index", "per_family_instance_index", "repetitions", "repetition_index", "threads", "iterations",
            "real_time", "cpu_time"}


def medians(path):
    """{name: {"real_time": nanoseconds, counter: value}} of the runs of a file that did not fail."""
    with open(path, encoding="utf-8") as file:
        runs = json.load(file)["benchmarks"]
    values = {}
    for run in runs:
        if run.get("run_type", "iteration") != "iteration" or run.get("error_occurred"):
            continue
        own = values.setdefault(run.get("run_name", run["name"]), {})
        own.setdefault("real_time", []).append(run["real_time"] * NANOSECONDS[run["time_unit"]])
        for key, value in run.items():
            if key not in OWN_KEYS and isinstance(value, (int, float)) and not isinstance(value, bool):
                own.setdefault(key, []).append(value)
    return {name: {key: statistics.median(all) for key, all in own.items()} for name, own in values.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--threshold", type=float, default=0.1, help="how much slower is too slow (default 0.1)")
    parser.add_argument("--counters", action="store_true", help="print the counters' ratios, too")
    parser.add_argument("before")
    parser.add_argument("after")
    options = parser.parse_args()
    try:
        before, after = medians(options.before), medians(options.after)
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        print(f"compare_bench: not a file of Google Benchmark: {error!r}", file=sys.stderr)
        return 2
    both = before.keys() & after.keys()
    if not both:
        print("compare_bench: the files have no benchmark in common", file=sys.stderr)
        return 2

    def ratio(name, key):
        return after[name][key] / before[name][key] if before[name][key] else float("inf")

    slower = 0
    for name in sorted(both, key=lambda name: (-ratio(name, "real_time"), name)):
        too_slow = ratio(name, "real_time") > 1 + options.threshold
        slower += too_slow
        print(f"{ratio(name, 'real_time'):8.3f}  {before[name]['real_time'] * 1e-6:12.3f} ms "
              f"{after[name]['real_time'] * 1e-6:12.3f} ms  {name}{'  SLOWER' if too_slow else ''}")
        if options.counters:
            for key in sorted((before[name].keys() & after[name].keys()) - {"real_time"}):
                print(f"{ratio(name, key):8.3f}      {key}")
    missing = sorted(before.keys() - after.keys())
    for name in missing:
        print(f"missing in {options.after}: {name}")
    for name in sorted(after.keys() - before.keys()):
        print(f"new in {options.after}: {name}")
    return 1 if slower or missing else 0


if __name__ == "__main__":
    sys.exit(main())
