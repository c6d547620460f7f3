"""Send SIGINT and SIGTERM to commands at random moments, and look at what is left.

    python benchmarks/interrupt.py --moments 200

Each command runs in a forked process that holds the loaded package. It must end with a documented
exit code and without a traceback, and its folder must hold the old files or all of the new ones.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))
import fuzz
import sound_files

from dualarm_pin.cli import main as command_line

CODES = {0, 1, 130, 143}
CHANGE = "cell.arms.arm2.base.xyz=[1.001, 0, 0]"
COMMANDS: dict[str, tuple[int, Callable[[Path], list[str]]]] = {
    "solve": (
        12,
        lambda at: ["solve", f"{at}/task.yaml", "--set", CHANGE, "--out", f"{at}/result"],
    ),
    "solve whole path": (
        3,
        lambda at: [
            "solve", f"{at}/task.yaml", "--set", CHANGE, "--out", f"{at}/result", "--method",
            "global", "--effort", "quick", "--jobs", "1", "--solver", "engine",
        ],
    ),
    "motion": (3, lambda at: ["motion", f"{at}/result", "--law", "time_optimal"]),
    "export": (
        3, lambda at: ["export", f"{at}/result", "--to", "ros2", "--out", f"{at}/program"],
    ),
    "view": (4, lambda at: ["view", f"{at}/result", "--html", f"{at}/page/page.html"]),
    "bench": (1, lambda at: ["bench", f"{at}/few.yaml", "--out", f"{at}/batch", "--jobs", "1"]),
}  # fmt: skip
"""How often each is taken, and its arguments in a folder that `prepare` has filled."""
RATED = {"acceleration_deg_s2": dict.fromkeys(["shoulder", "elbow"], 90)}
SUITE = {"tasks": ["task.yaml"], "methods": ["local"], "seeds": 1, "time_limit": 60}
PATIENCE = 600.0  # seconds until a command that was told to end has hung, on a busy machine too


def run(arguments: list[str], folder: Path, delay: float | None, number: int) -> tuple[int, float]:
    """Run a command in a forked process, stop it after a delay, and return its code and seconds."""
    begun = time.monotonic()
    child = os.fork()
    if not child:
        code = 99
        try:
            with (folder / "said").open("w") as said:
                os.dup2(said.fileno(), 1)
                os.dup2(said.fileno(), 2)
            try:
                command_line(arguments)
            except SystemExit as end:
                code = int(end.code or 0)
        except KeyboardInterrupt:  # outside of the command: not its fault
            code = 130
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            os._exit(code)
    if delay is not None:
        time.sleep(delay)
        os.kill(child, number)
    while not (ended := os.waitpid(child, os.WNOHANG))[0]:
        if time.monotonic() - begun > (delay or 0) + PATIENCE:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            return -signal.SIGKILL, time.monotonic() - begun
        time.sleep(0.002)
    code = os.waitstatus_to_exitcode(ended[1])
    return (128 - code if code < 0 else code), time.monotonic() - begun


def content(folder: Path) -> dict[str, Any]:
    """Return what a folder holds, without the seconds that a run took."""
    found: dict[str, Any] = {}
    for file in sorted(folder.rglob("*")) if folder.is_dir() else ():
        if file.is_dir():
            continue
        found[str(file.relative_to(folder))] = file.read_bytes()
        if file.name == "result.json":
            result = json.loads(file.read_bytes())
            for noise in ("timing", "extra", "evidence"):
                result.pop(noise, None)
            found[file.name] = result
    return found


def outcome(
    name: str,
    moment: random.Random,
    sound: Path,
    longest: dict[str, float],
    whole: dict[str, set[str]],
) -> str:
    """Stop one run of a command; return `old`, `new`, or what is wrong."""
    with tempfile.TemporaryDirectory(prefix="interrupt-") as top:
        folder = Path(top) / "at"
        shutil.copytree(sound, folder)
        arguments = COMMANDS[name][1](folder)
        where = {"view": "page", "bench": "batch", "export": "program"}.get(name, "result")
        old = content(folder / where)
        if name not in longest:
            code, longest[name] = run(arguments, folder, None, 0)
            whole[name] = set(content(folder / where))
            return "new" if code == 0 else f"exit code {code}: {(folder / 'said').read_text()}"
        number = moment.choice([signal.SIGINT, signal.SIGTERM])
        code, _ = run(arguments, folder, moment.uniform(0.0, 1.1 * longest[name]), number)
        said = (folder / "said").read_text() if (folder / "said").exists() else ""
        if code not in CODES or "Traceback" in said:
            return f"exit code {code}: {said[-3000:]}"
        now = content(folder / where)
        if name == "bench":  # grows by rows; what is there must be whole
            rows = now.get("rows.jsonl", b"").splitlines()
            bad = [line for line in rows if "key" not in json.loads(line)]
            half = [file for file in now if Path(file).name.startswith(".")]
            return f"half: {bad} {half}" if bad or half else "new" if code == 0 else "old"
        if now == old:
            return "old" if code or now else f"exit code 0, and nothing was written: {said}"
        # An answer without its motion is whole, where it was stopped while the motion was made.
        answer = {file for file in whole[name] if not file.startswith("motion")}
        allowed = [whole[name], answer] if name.startswith("solve") and code else [whole[name]]
        if set(now) not in allowed:
            return f"files: {sorted(now)}"
        made = [f for f in now if name != "motion" or "motion" in f or f == "result.json"]
        same = [file for file in made if now[file] == old.get(file)]
        return f"of the old result: {same}" if same else "new"


def prepare(sound: Path) -> None:
    """Write a task that can be met, and a result of it."""
    sound_files.sound(sound)
    fuzz.prepare_motion(sound)
    shutil.copy(sound / "easy.yaml", sound / "task.yaml")
    (sound / "moving").rename(sound / "result")


def main() -> int:
    """Stop as many runs as the command line asks for; 1 if any left a mess."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--moments", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--commands", nargs="*", default=list(COMMANDS))
    asked = parser.parse_args()
    moment = random.Random(asked.seed)
    names = [name for name in asked.commands for _ in range(COMMANDS[name][0])]
    counts: Counter[tuple[str, str]] = Counter()
    longest: dict[str, float] = {}
    whole: dict[str, set[str]] = {}
    failed = 0
    with tempfile.TemporaryDirectory(prefix="interrupt-sound-") as top:
        sound = Path(top)
        prepare(sound)
        (sound / "few.yaml").write_text(json.dumps(SUITE))
        for k in range(asked.moments + len(asked.commands)):
            name = asked.commands[k] if k < len(asked.commands) else moment.choice(names)
            how = outcome(name, moment, sound, longest, whole)
            if how not in ("old", "new"):
                failed += 1
                print(f"FAILED {name}: {how}", flush=True)
            if k >= len(asked.commands):
                counts[name, how if how in ("old", "new") else "failed"] += 1
    for name in asked.commands:
        print(f"{name:17}" + "".join(
            f"{counts[name, how]:6} {how}" for how in ("old", "new", "failed")
        ) + f"   {longest[name]:.1f} s uninterrupted")  # fmt: skip
    print(f"{sum(counts.values())} moments, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
