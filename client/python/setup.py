"""Has CMake build the C++ part of the package, and puts it, libtetstream.so and the reader of .vdb files
into the wheel.

The environment's TETSTREAM_BUILD names a build tree to take; unless given it is build/release, which is
configured if it is not there. Everything is built that is missing.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sysconfig
import tempfile

import setuptools
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = "tetstream"
TARGETS = ["tetstream_python", "tetstream_shared", "tetstream-decoder"]
COMPONENTS = ["python", "lib", "common"]


def project_version():
    """The version of the whole project, which is written down once."""
    return re.search(r"project\(tetstream VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text("utf-8"))[1]


def installed(build, folder):
    """Builds what is missing in a build tree, and installs it below a folder."""
    if not (build / "CMakeCache.txt").exists():
        subprocess.run(["cmake", "--preset", "release", "-B", build], cwd=ROOT, check=True)
    subprocess.run(["cmake", "--build", build, "--target", *TARGETS], check=True)
    for component in COMPONENTS:
        subprocess.run(["cmake", "--install", build, "--prefix", folder, "--component", component, "--strip"],
                       check=True, stdout=subprocess.DEVNULL)


def only(folder, pattern):
    found = sorted(folder.rglob(pattern))
    if not found:
        raise SystemExit(f"the build has no {pattern}: does CMake find pybind11 and Python's headers? "
                         "(scripts/install_packages build python)")
    return found[0]


class BuildByCMake(build_ext):
    """The module, and beside it what it needs of this project."""

    def run(self):
        build = pathlib.Path(os.environ.get("TETSTREAM_BUILD", ROOT / "build/release")).resolve()
        target = pathlib.Path(self.build_lib) / PACKAGE
        target.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory() as folder:
            prefix = pathlib.Path(folder)
            installed(build, prefix)
            module = only(prefix, "_tetstream.*.so")
            wanted = "_tetstream" + sysconfig.get_config_var("EXT_SUFFIX")
            if module.name != wanted:
                raise SystemExit(f"the build has {module.name}, and this Python takes {wanted}: "
                                 "run pip by the Python that the build is for, /usr/bin/python3")
            library = only(prefix, "libtetstream.so.*.*.*")
            shutil.copy2(module, target)
            shutil.copy2(library, target / ".".join(library.name.split(".")[:-1]))  # as the loader knows it
            for beside in ["tetstream-decoder", "libtetstream-openvdb.so", "libtetstream-hdf5.so"]:
                shutil.copy2(only(prefix, beside), target)


# pip and build run in this folder: what they leave belongs elsewhere.
SCRATCH = ROOT / "build/wheel"
SCRATCH.mkdir(parents=True, exist_ok=True)

setuptools.setup(
    options={"build": {"build_base": str(SCRATCH)}, "egg_info": {"egg_base": str(SCRATCH)}},
    version=project_version(),
    packages=[PACKAGE],
    package_data={PACKAGE: ["py.typed", "*.pyi"]},
    ext_modules=[setuptools.Extension(f"{PACKAGE}._tetstream", [])],
    cmdclass={"build_ext": BuildByCMake},
    zip_safe=False,
)
