"""Runs the code of a notebook in order, in one fresh interpreter, without a notebook server.

    run_notebook.py NOTEBOOK.ipynb            ends with 0 when every cell runs
    run_notebook.py --write NOTEBOOK.ipynb    and keeps what the cells print and draw
"""

import base64
import contextlib
import io
import json
import os
import pathlib
import sys


def figures():
    """The open figures as outputs of a cell; closes them."""
    import matplotlib.pyplot as plt

    outputs = []
    for number in plt.get_fignums():
        picture = io.BytesIO()
        plt.figure(number).savefig(picture, format="png", dpi=60, metadata={"Software": None})
        data = {"image/png": base64.b64encode(picture.getvalue()).decode()}
        outputs.append({"output_type": "display_data", "data": data, "metadata": {}})
    plt.close("all")
    return outputs


def run(path, write):
    notebook = json.loads(path.read_text(encoding="utf-8"))
    names = {"__name__": "__main__"}
    os.chdir(path.parent)
    count = 0
    for cell in notebook["cells"]:
        if cell["cell_type"] != "code":
            continue
        count += 1
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile("".join(cell["source"]), f"{path.name}, cell {count}", "exec"), names)
        print(printed.getvalue(), end="")
        cell["execution_count"] = count
        text = printed.getvalue()
        stream = [{"output_type": "stream", "name": "stdout", "text": text.splitlines(True)}]
        cell["outputs"] = (stream if text else []) + figures()
    if write:
        path.write_text(json.dumps(notebook, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    os.environ["MPLBACKEND"] = "Agg"  # no window
    try:
        run(pathlib.Path(sys.argv[-1]).resolve(), "--write" in sys.argv[1:-1])
    except ModuleNotFoundError as missing:
        if missing.name not in ("matplotlib", "scipy"):
            raise
        print(f"skipped: python3-{missing.name} is not installed")
