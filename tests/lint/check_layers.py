#!/usr/bin/python3
"""Checks that includes point one way and in short chains, and that outside libraries and the system's
files stay in place.

    check_layers.py [ROOT]
"""
import pathlib
import re
import sys

# A request passes through these in order; a folder includes itself and those before it.
CORE = ["core/base", "core/surface", "core/triangle_files", "core/volume", "core/image",
        "core/vdb/walk", "core/vdb/plain", "core/vdb/parts", "core/vdb/openvdb", "core/vdb/decoder",
        "core/scene", "core/field", "core/octree", "core/lattice", "core/stuffing",
        "core/stuffing/topology", "core/labels", "core/mesh", "core/mesh/packed", "core/mesh/stable",
        "core/mesh/improve", "core/graded", "core/plan", "core/plan/brick", "core/plan/labelled",
        "core/plan/whole", "core/plan/joined", "core/plan/make", "core/fidelity", "core/remap",
        "core/second_order", "core/transfer", "core/files", "core/manual"]
PROTO = ["proto/wire", "proto/scene", "proto/sizing", "proto/convert", "proto"]
SERVER = ["server/ops", "server/rpc", "server/http", "server/shared_memory", "server/grids", "server/jobs/store", "server/meshing",
          "server/jobs/results", "server/streams", "server/jobs/work", "server/jobs/service",
          "server/upkeep", "server"]
CLIENT = ["client/library", "client/command/process", "client/command/arguments", "client/command/mesh",
          "client/command", "client"]
# What is installed: it may include the standard library, and itself as <tetstream/...>.
PUBLIC = "client/library/include"
# What stands upon it as another program would.
PYTHON = "client/python"


def in_order(folders, before):
    """{folder: all that it may include}: the folders before all of these, then those before it."""
    return {folder: [*before, *folders[:i + 1]] for i, folder in enumerate(folders)}


LAYERS = {**in_order(CORE, []), **in_order(PROTO, CORE), **in_order(SERVER, [*CORE, *PROTO]),
          **in_order(CLIENT, [*CORE, *PROTO])}

# Outside library -> (how its includes look, the folders that may use it).
NETWORK = ["proto", "server", "client", "tests/proto", "tests/server", "tests/client",
           "tests/support", "tests/hostile", "tests/fuzz", "bench", "tests/bench"]
LIBRARIES = {
    "OpenVDB": (r"openvdb/", ["core/vdb/openvdb", "tests/core/vdb", "tests/hostile", "tests/support",
                             "bench"]),
    "blosc": (r"blosc", ["core/vdb/plain"]),
    "the system's loader": (r"dlfcn\.h$", ["core/vdb/parts", "tests/faults"]),
    "seccomp": (r"seccomp", ["core/vdb/decoder"]),
    "HDF5": (r"(hdf5|H5\w+)\.h$", ["core/files"]),
    "oneTBB": (r"(tbb|oneapi)/", ["core/base"]),
    "gRPC": (r"(grpc|grpcpp|google/(protobuf|rpc))/|.*\.pb\.h$", NETWORK),
    "SSE": (r"[a-z]*mmintrin\.h$|simde/", ["core/base/sse.h"]),
    # Its functions end the process where a time is out of range: proto/convert/times.h.
    "protobuf's TimeUtil": (r"google/protobuf/util/time_util", ["proto/convert"]),
    "SQLite": (r"sqlite3", ["server/jobs/store", "tests/server/jobs/store"]),
    "pybind11": (r"pybind11/", ["client/python"]),
    "libpq": (r"libpq|postgresql/", ["server/jobs/store", "tests/server/jobs/store"]),
}

# System calls for files: one place handles signals, short writes and full disks. The decoder's
# sandbox replaces its own descriptors. Without the `::` only names that nothing else can have.
FILE_CALLS = re.compile(
    r"(?<![\w>])::(?:open|openat|creat|close|read|write|rename|pipe|dup2?)\s*\("
    r"|(?<![\w.>])(?:::)?(?:pread|pwrite|readv|writev|fsync|fdatasync|ftruncate|fallocate|flock|pipe2|"
    r"dup3)\s*\(")
FILE_FOLDERS = ["core/base/posix"]
SANDBOX = ["core/vdb/decoder/await_order.cpp", "core/vdb/decoder/sandbox.cpp", "core/vdb/decoder/spawn.cpp"]

# Files in the longest chain of includes of code that ships, the first one and the last one counted: whoever
# changes a header at its end recompiles all of the chain, and whoever reads its beginning needs all of it.
LONGEST_CHAIN = 15
SHIPPED = ["core", "proto", "server", "client"]

SOURCE_FOLDERS = ["core", "proto", "server", "client", "tests", "bench"]
INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)', re.MULTILINE)


def is_inside(path, folder):
    return path == folder or path.startswith(folder + "/")


def read_includes(root):
    """{file: [included, ...]}, as written; files relative to root, sorted."""
    includes = {}
    for folder in SOURCE_FOLDERS:
        for path in (root / folder).rglob("*"):
            if path.suffix in (".h", ".cpp") and path.is_file():
                found = INCLUDE.findall(path.read_text(encoding="utf-8"))
                includes[str(path.relative_to(root))] = [q or a for q, a in found]
    return dict(sorted(includes.items()))


def layer_of(path):
    """The innermost layer that a file lies in; None where it lies in none."""
    return max((f for f in LAYERS if is_inside(path, f)), key=len, default=None)


def layer_errors(file, included):
    """Ours including ours: only its own layer and those before it."""
    layer = layer_of(file)
    if layer is None or included.split("/")[0] not in SOURCE_FOLDERS:
        return
    if layer_of(included) not in LAYERS[layer]:
        yield f"{file}: {layer} must not include {included}"


def public_errors(file, included):
    """A user of the library has its headers alone, and no other project's."""
    if is_inside(file, PUBLIC) and not re.fullmatch(r"[a-z_]+|tetstream/[a-z_]+\.h", included):
        yield f"{file}: a public header must not include {included}"


def python_errors(file, included):
    """The Python package has what any user of the library has, and pybind11."""
    if is_inside(file, PYTHON) and not re.fullmatch(
            r"[a-z_]+|tetstream/[a-z_]+\.h|pybind11/[a-z0-9_]+\.h|client/python/[a-z_/]+\.h", included):
        yield f"{file}: the Python package must not include {included}"


def library_errors(file, included):
    """Ours including a library: only from the folders that may know it."""
    for library, (pattern, folders) in LIBRARIES.items():
        if re.match(pattern, included) and not any(is_inside(file, f) for f in folders):
            yield f"{file}: includes {included}, but only {', '.join(folders)} may use {library}"


def file_call_errors(root):
    """Code that ships and asks the system for files by itself."""
    for folder in SHIPPED:
        for path in sorted((root / folder).rglob("*")):
            file = str(path.relative_to(root))
            if path.suffix not in (".h", ".cpp") or file in SANDBOX or any(
                    is_inside(file, allowed) for allowed in FILE_FOLDERS):
                continue
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                found = FILE_CALLS.search(line.split("//")[0])
                if found:
                    yield (f"{file}:{number}: calls {found.group()[:-1].strip()} itself: use "
                           f"{' or '.join(FILE_FOLDERS)}")


def cycle_errors(includes):
    """One line for each include that closes a cycle."""
    state = {}  # file -> "open" while its includes are being followed, then "done"

    def follow(file, chain):
        state[file] = "open"
        for included in includes[file]:
            if state.get(included) == "open":
                cycle = chain[chain.index(included):]
                yield f"include cycle: {' -> '.join([*cycle, included])}"
            elif included in includes and included not in state:
                yield from follow(included, [*chain, included])
        state[file] = "done"

    for file in includes:
        if file not in state:
            yield from follow(file, [file])


def longest_chains(includes):
    """{file: the longest chain of includes that begins with it}, where includes have no cycle."""
    chains = {}

    def follow(file):
        if file not in chains:
            below = [follow(included) for included in includes[file] if included in includes]
            chains[file] = [file, *max(below, key=len, default=[])]
        return chains[file]

    for file in includes:
        follow(file)
    return chains


def chain_errors(includes):
    """The longest chain, where it is longer than allowed."""
    shipped = {file: included for file, included in includes.items()
               if file.split("/")[0] in SHIPPED}
    longest = max(longest_chains(shipped).values(), key=len, default=[])
    if len(longest) > LONGEST_CHAIN:
        yield (f"{len(longest)} files include each other in a chain, {LONGEST_CHAIN} may: "
               f"{' -> '.join(longest)}")


def find_errors(root):
    includes = read_includes(root)
    errors = [] if includes else [f"there are no sources under {root}"]
    for file, all_included in includes.items():
        for included in all_included:
            errors += layer_errors(file, included)
            errors += public_errors(file, included)
            errors += python_errors(file, included)
            errors += library_errors(file, included)
    cycles = list(cycle_errors(includes))
    chains = [] if cycles else list(chain_errors(includes))
    return errors + list(file_call_errors(root)) + cycles + chains


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    errors = find_errors(root)
    print("\n".join(errors) or "every include points one way")
    sys.exit(1 if errors else 0)


if __name__ == "__main__":
    main()
