"""What a diagnosis from Python costs beside the command line: python3 benches/python.py QUELL [RUNS]

QUELL is the program `quell` of the same build. Both read one concealed case, diagnose it on one thread and write report,
diagnosis and model; the package is loaded in the interpreter that runs this file. Told is time of the processor, which a
busy machine does not change much, as medians over the runs, which take turns.
"""

import json
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import quell


def by_command(program, case, out):
    """Seconds of the processor that the command line takes, its start included."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [program, "-q", "diagnose", "--jobs", "1", "--force", "--model", case / "model.toml", case / "train"]
    subprocess.run([*command, "--out", out], check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def by_package(case, out):
    """Seconds of the processor that the same takes from Python."""
    start = time.process_time()
    model, recording = quell.Model.load(case / "model.toml"), quell.Recording.load(case / "train")
    diagnosis = quell.diagnose(model, recording, threads=1, progress=False)
    out.mkdir(exist_ok=True)
    diagnosis.save_report(out / "report.html")
    diagnosis.model.save(out / "model.toml")
    (out / "diagnosis.json").write_text(json.dumps(diagnosis.to_dict(), indent=2))
    return time.process_time() - start


def main():
    program, runs = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 5
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        prove = [program, "-q", "prove", "--cases", "1", "--seed", "5", "--keep", folder / "cases"]
        subprocess.run([*prove, "--out", folder / "proof"], check=True, capture_output=True)
        case = folder / "cases/case-00"
        pairs = [(by_command(program, case, folder / "a"), by_package(case, folder / "b")) for _ in range(runs)]
        same = json.loads((folder / "a/diagnosis.json").read_text()) == json.loads((folder / "b/diagnosis.json").read_text())
    command, package = (statistics.median(column) for column in zip(*pairs))
    print(f"command line {command:.3f} s, package {package:.3f} s: {100 * (package / command - 1):+.1f} %")
    print(f"the same diagnosis: {'yes' if same else 'no'}")


if __name__ == "__main__":
    main()
