#!/usr/bin/python3
"""check_layers.py on small trees that break one rule each."""
import pathlib
import tempfile
import unittest

import check_layers


def errors_of(files):
    """What check_layers says of a tree of {path: text}."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for path, text in files.items():
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (root / path).write_text(text, encoding="utf-8")
        return check_layers.find_errors(root)


class CheckLayers(unittest.TestCase):
    def test_accepts_includes_that_point_upstream(self):
        self.assertEqual(errors_of({
            "core/base/types.h": "#include <array>\n",
            "core/base/parallel.cpp": "#include <tbb/task_arena.h>\n",
            "core/vdb/openvdb/load.cpp": '#include <openvdb/io/File.h>\n#include "core/base/types.h"\n',
            "core/plan/make/mesher.h": '#include "core/vdb/openvdb/load.h"\n',
            "server/service.h": '#include "core/plan/make/mesher.h"\n#include <grpcpp/grpcpp.h>\n',
            "tests/core/vdb/load_test.cpp": "#include <openvdb/openvdb.h>\n",
        }), [])

    def test_refuses_an_include_that_points_downstream(self):
        self.assertEqual(
            errors_of({"core/octree/octree.h": '#include "core/lattice/bcc.h"\n'}),
            ["core/octree/octree.h: core/octree must not include core/lattice/bcc.h"])

    def test_tells_a_folder_from_those_within_it(self):
        self.assertEqual(
            errors_of({
                "core/plan/brick/a.h": '#include "core/plan/b.h"\n',
                "core/plan/b.h": '#include "core/plan/whole/c.h"\n',
            }),
            ["core/plan/b.h: core/plan must not include core/plan/whole/c.h"])

    def test_refuses_a_core_that_knows_the_service(self):
        self.assertEqual(len(errors_of({"core/mesh/a.h": '#include "server/b.h"\n'})), 1)
        self.assertEqual(len(errors_of({"core/mesh/a.h": '#include "proto/b.h"\n'})), 1)
        self.assertEqual(len(errors_of({"core/mesh/a.h": "#include <grpcpp/grpcpp.h>\n"})), 1)

    def test_keeps_server_and_client_apart(self):
        self.assertEqual(len(errors_of({"client/a.h": '#include "server/b.h"\n'})), 1)
        self.assertEqual(len(errors_of({"server/a.h": '#include "client/b.h"\n'})), 1)

    def test_keeps_code_that_ships_from_including_tests(self):
        self.assertEqual(len(errors_of({"core/base/a.h": '#include "tests/support/b.h"\n'})), 1)

    def test_keeps_public_headers_to_themselves_and_the_standard_library(self):
        header = "client/library/include/tetstream/a.h"
        for text in ("#include <vector>", '#include "tetstream/mesh.h"'):
            self.assertEqual(errors_of({header: text + "\n"}), [], text)
        for text in ("#include <absl/status/status.h>", '#include "core/base/types.h"',
                     '#include "client/library/mesh_client.h"', "#include <grpcpp/grpcpp.h>",
                     '#include "tetstream/v1/meshes.pb.h"'):
            self.assertNotEqual(errors_of({header: text + "\n"}), [], text)

    def test_lets_the_python_package_see_what_any_program_sees(self):
        source = "client/python/extension/a.cpp"
        for text in ("#include <vector>", '#include "tetstream/mesh.h"', "#include <pybind11/numpy.h>",
                     '#include "client/python/extension/watch.h"'):
            self.assertEqual(errors_of({source: text + "\n"}), [], text)
        for text in ("#include <absl/status/status.h>", '#include "core/base/types.h"', "#include <Python.h>",
                     '#include "client/library/mesh_client.h"', '#include "client/library/api/work.h"',
                     "#include <grpcpp/grpcpp.h>", '#include "tetstream/v1/meshes.pb.h"'):
            self.assertNotEqual(errors_of({source: text + "\n"}), [], text)

    def test_keeps_each_library_in_its_folders(self):
        for text in ("#include <openvdb/openvdb.h>", "#include <tbb/parallel_for.h>",
                     "#include <oneapi/tbb.h>", "# include <google/protobuf/message.h>",
                     '#include "tetstream/v1/meshes.pb.h"', "#include <sqlite3.h>",
                     "#include <libpq-fe.h>", "#include <emmintrin.h>",
                     "#include <simde/x86/sse4.1.h>", "#include <pybind11/stl.h>"):
            with self.subTest(text):
                self.assertEqual(len(errors_of({"core/mesh/a.cpp": text})), 1)

    def test_reports_a_chain_of_includes_that_is_too_long(self):
        def chain(files):
            return {f"core/base/a{i:02}.h": f'#include "core/base/a{i + 1:02}.h"\n'
                    for i in range(files)}
        most = check_layers.LONGEST_CHAIN
        self.assertEqual(errors_of(chain(most)), [])
        self.assertIn("16 files include each other in a chain, 15 may: core/base/a00.h -> ",
                      "".join(errors_of(chain(most + 1))))

    def test_reports_a_cycle_between_files(self):
        self.assertEqual(
            errors_of({
                "core/base/a.h": '#include "core/base/b.h"\n',
                "core/base/b.h": '#include "core/base/c.h"\n',
                "core/base/c.h": '#include "core/base/a.h"\n',
            }),
            ["include cycle: core/base/a.h -> core/base/b.h -> core/base/c.h -> core/base/a.h"])

    def test_keeps_the_system_calls_for_files_in_one_place(self):
        for call in ("::open(path, 0);", "if (::close(file) != 0)", "pwrite(file, b, 1, 0);",
                     "::rename(a, b);", "return ::fsync(file);"):
            self.assertEqual(len(errors_of({"server/a.cpp": call + "\n"})), 1, call)
            self.assertEqual(errors_of({"core/base/posix/a.cpp": call + "\n"}), [], call)
            self.assertEqual(errors_of({"tests/a.cpp": call + "\n"}), [], call)

    def test_knows_calls_that_only_look_like_files(self):
        for call in ("Journal::open(path);", "file.close();", "fs::rename(a, b);", "read();",
                     "// as ::open( does", "stream->write(x);"):
            self.assertEqual(errors_of({"server/a.cpp": call + "\n"}), [], call)

    def test_refuses_a_tree_without_sources(self):
        self.assertEqual(len(errors_of({"README.md": "nothing here\n"})), 1)


if __name__ == "__main__":
    unittest.main()
