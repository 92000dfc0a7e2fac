"""Every fuzz target for some seconds, one after another; fails where one found something.

    python3 fuzz/run.py --seconds 7200
    python3 fuzz/run.py --total 600 --results

An input that ends in a panic, takes over 10 seconds or over 2 GiB lies in fuzz/artifacts/TARGET/. With --results the runs
a second are written to a section of bench/RESULTS.md.
"""

import argparse
import os
import re
import subprocess
import sys
from pathlib import Path

FUZZ = Path(__file__).resolve().parent
# Seconds and megabytes that one input may take; chosen, far above what a file of a few kilobytes needs.
TIMEOUT_S, MEMORY_MB = 10, 2048
ABOUT = """
Each reader is fed with random bytes by libFuzzer, from the seeds in `fuzz/corpus/`, on one thread. A find is a panic, an
input that takes over 10 seconds, or one over 2 GiB.
""".strip()


def cargo(*words):
    """Runs cargo fuzz on nightly in the repository; no sanitizer, since readers are safe code."""
    command = ["cargo", "+nightly", "fuzz", *words]
    return subprocess.run(command, cwd=FUZZ.parent, check=True, stdout=subprocess.PIPE, text=True).stdout


def run(program, target, seconds):
    """Runs one target; its executions, and whether nothing was found."""
    found, kept = FUZZ / "artifacts" / target, FUZZ / "found" / target
    found.mkdir(parents=True, exist_ok=True)
    kept.mkdir(parents=True, exist_ok=True)
    seeds = [str(folder) for folder in [FUZZ / "corpus" / target] if folder.is_dir()]
    limits = [f"-max_total_time={seconds}", f"-timeout={TIMEOUT_S}", f"-rss_limit_mb={MEMORY_MB}"]
    # libFuzzer writes what it finds new to the first folder, so that committed seeds stay as they are.
    words = [program, kept, *seeds, *limits, f"-artifact_prefix={found}/", "-print_final_stats=1"]
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    text = done.stdout.decode(errors="replace")
    runs = re.search(r"number_of_executed_units: (\d+)", text)
    if done.returncode:
        print(text[-3000:], file=sys.stderr)
    return int(runs[1]) if runs else 0, done.returncode == 0


def write_results(rows, seconds):
    """Writes the section of RESULTS.md."""
    sys.path.insert(0, str(FUZZ.parent / "bench"))
    import section  # noqa: PLC0415

    text = [ABOUT, "", f"{seconds} seconds each.", "", "| target | runs | runs/s | found |", "|---|---|---|---|"]
    for target, runs, is_clean in rows:
        text.append(f"| {target} | {runs:,} | {runs / seconds:,.0f} | {'nothing' if is_clean else 'yes'} |")
    text += ["", f"Measured on {section.machine()}."]
    section.put("Fuzzing the readers", "\n".join(text))


def main():
    """Builds all targets and runs them in turn."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=int, help="seconds for each target")
    parser.add_argument("--total", type=int, help="seconds for all targets together")
    parser.add_argument("--results", action="store_true", help="write a section of bench/RESULTS.md")
    options = parser.parse_args()
    folder = Path(os.environ.get("CARGO_TARGET_DIR", FUZZ.parent / "target")).resolve() / "fuzz"
    targets = cargo("list").split()
    seconds = options.seconds or max(1, (options.total or 600) // len(targets))
    cargo("build", "--release", "--sanitizer", "none", "--target-dir", str(folder))
    rows = []
    for target in targets:
        program = next(path for path in folder.glob(f"*/release/{target}") if path.is_file())
        runs, is_clean = run(program, target, seconds)
        rows.append((target, runs, is_clean))
        print(f"{target}: {runs:,} runs in {seconds} s{'' if is_clean else ', FOUND SOMETHING'}", flush=True)
    if options.results:
        write_results(rows, seconds)
    sys.exit(not all(is_clean for _, _, is_clean in rows))


if __name__ == "__main__":
    main()
