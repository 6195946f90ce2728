#!/usr/bin/python3
"""The checker of instructions finds MMX, and nothing where there is none."""
import os
import subprocess
import tempfile
import unittest

from check_instructions import functions_with_mmx


class CheckInstructionsTest(unittest.TestCase):
    def functions_of(self, assembly):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "code.o")
            subprocess.run(["as", "-o", path, "-"], input=assembly, text=True, check=True)
            return functions_with_mmx(path)

    def test_names_the_function(self):
        self.assertEqual(self.functions_of("f: ret\ng: movq 8(%rsp), %mm0\nmovq2dq %mm0, %xmm1\n"),
                         ["<g>:"])

    def test_passes_other_registers(self):
        self.assertEqual(self.functions_of("f: movq 8(%rsp), %xmm0\npaddq %xmm0, %xmm7\n"), [])


if __name__ == "__main__":
    unittest.main()
