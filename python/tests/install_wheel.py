"""pip builds a wheel from a build folder, installs it into an empty environment, and it runs there.

Usage: install_wheel.py BUILD_FOLDER
"""

import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = """
import pathlib, sys, stillbase
assert pathlib.Path(stillbase.__file__).is_relative_to(sys.prefix), stillbase.__file__
plan = stillbase.plan(stillbase.Problem.from_file(stillbase.PROBLEMS / "planar_two_link_c2_a.yaml"))
assert plan.status == "optimal" and stillbase.verify(plan).passes
print("planned and verified")
"""


def main(build_dir):
    for module in ("pip", "venv", "ensurepip", "numpy"):
        if importlib.util.find_spec(module) is None:
            print(f"skipped: python3-{module} is not installed")
            return
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "PIP_"))}

    def run(*command):
        subprocess.run([str(c) for c in command], check=True, env=environment, cwd=folder)

    with tempfile.TemporaryDirectory() as folder:
        run(sys.executable, "-m", "venv", "--system-site-packages", "env")  # for numpy
        python = pathlib.Path(folder) / "env/bin/python"
        run(python, "-m", "pip", "--disable-pip-version-check", "install", "--no-index",
            "--config-settings", f"build-dir={build_dir}", ROOT)  # fmt: skip
        run(python, "-c", PROGRAM)


if __name__ == "__main__":
    main(sys.argv[1])
