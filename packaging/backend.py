"""PEP 517 back end: builds the Python module with CMake and packs it as a wheel.

It needs nothing from the network: compiler, libraries and pybind11 are those of the system
(`tools/setup --python`). `pip install .` builds in build/wheel, so that a second run is quick;
`-C build-dir=DIR` takes a folder that is configured with STILLBASE_PYTHON instead.
"""

import base64
import hashlib
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[1]


def _version():
    text = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"project\(stillbase VERSION ([0-9.]+)", text).group(1)


def _tag():
    interpreter = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = re.sub(r"[-.]", "_", sysconfig.get_platform())
    return f"{interpreter}-{interpreter}-{platform}"


def _metadata():
    readme = (ROOT / "python/README.md").read_text(encoding="utf-8")
    return (
        "Metadata-Version: 2.1\n"
        "Name: stillbase\n"
        f"Version: {_version()}\n"
        "Summary: Plans the pre-impact configuration of a free-floating space robot\n"
        "Requires-Python: >=3.9\n"
        "Requires-Dist: numpy\n"
        "Description-Content-Type: text/markdown\n"
        f"\n{readme}"
    )


def _wheel_text():
    return f"Wheel-Version: 1.0\nGenerator: stillbase\nRoot-Is-Purelib: false\nTag: {_tag()}\n"


def _run(*command):
    subprocess.run([str(part) for part in command], check=True, cwd=ROOT)


def _build(build_dir):
    """Configures unless a folder is given, builds the module. Returns the folder."""
    if build_dir is None:
        build_dir = ROOT / "build" / "wheel"
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        launcher = ["-D", "CMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
        _run(
            "cmake", "-S", ROOT, "-B", build_dir, *generator, *launcher,
            "-D", "CMAKE_BUILD_TYPE=Release",
            "-D", "STILLBASE_PYTHON=ON",
            "-D", "STILLBASE_BUILD_TESTS=OFF",
            "-D", "STILLBASE_BUILD_EXAMPLES=OFF",
            "-D", f"Python_EXECUTABLE={sys.executable}",
        )  # fmt: skip
    _run("cmake", "--build", build_dir, "--target", "stillbase_python", "--parallel")
    return build_dir


def _hash(data):
    digest = hashlib.sha256(data).digest()
    return "sha256=" + base64.urlsafe_b64encode(digest).rstrip(b"=").decode()


def _pack(path, files):
    """Writes a wheel, with its list of files at the end. Its times are fixed: same input, same bytes."""
    info = f"stillbase-{_version()}.dist-info"
    files = {
        **files,
        f"{info}/METADATA": _metadata().encode(),
        f"{info}/WHEEL": _wheel_text().encode(),
        f"{info}/LICENSE": (ROOT / "LICENSE").read_bytes(),
    }
    record = [f"{name},{_hash(data)},{len(data)}" for name, data in sorted(files.items())]
    files[f"{info}/RECORD"] = "\n".join([*record, f"{info}/RECORD,,", ""]).encode()
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as wheel:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if name.endswith(".so") else 0o644) << 16
            wheel.writestr(entry, data)


def get_requires_for_build_wheel(config_settings=None):
    """Nothing that pip would have to fetch."""
    return []


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Builds the wheel. Returns its file name."""
    build_dir = _build((config_settings or {}).get("build-dir"))
    with tempfile.TemporaryDirectory() as staged:
        _run("cmake", "--install", build_dir, "--component", "python", "--prefix", staged, "--strip")
        package = next(pathlib.Path(staged).rglob("stillbase/__init__.py")).parent
        files = {
            path.relative_to(package.parent).as_posix(): path.read_bytes()
            for path in sorted(package.rglob("*"))
            if path.is_file()
        }
    name = f"stillbase-{_version()}-{_tag()}.whl"
    _pack(pathlib.Path(wheel_directory) / name, files)
    return name


def get_requires_for_build_sdist(config_settings=None):
    """Nothing that pip would have to fetch."""
    return []


def build_sdist(sdist_directory, config_settings=None):
    """Packs the files that git knows. Returns the file name."""
    name = f"stillbase-{_version()}"
    listed = subprocess.run(
        ["git", "ls-files", "-z"], check=True, cwd=ROOT, capture_output=True, text=True
    )
    with tempfile.TemporaryDirectory() as folder:
        info = pathlib.Path(folder) / "PKG-INFO"
        info.write_text(_metadata(), encoding="utf-8")
        with tarfile.open(pathlib.Path(sdist_directory) / f"{name}.tar.gz", "w:gz") as archive:
            archive.add(info, f"{name}/PKG-INFO")
            for path in filter(None, listed.stdout.split("\0")):
                archive.add(ROOT / path, f"{name}/{path}")
    return f"{name}.tar.gz"
