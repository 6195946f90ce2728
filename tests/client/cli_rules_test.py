"""What excludes what is the same for the tetstream command as in docs/requests.md, row by row.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_rules_test.py [unittest options]
"""

import json
import pathlib
import re
import unittest

from command_case import REFUSED, CommandTest

DOCUMENT = pathlib.Path(__file__).parents[2] / "docs/requests.md"
ROW = re.compile(r'^\| `(.+?)` \| `(.+?)` \| refused: "(.+)" \| .+ \|$', re.MULTILINE)
GRADED = json.dumps({"coarsest": 0.4, "grade_surface": True})
# What a request's features are as options; those that a command line cannot ask for are missing.
OPTIONS = {
    "grid_name": ("--grid", "ball"),
    "grid_names": ("--grid", "ball", "--grid", "ring"),
    "scene": (),
    "iso": ("--iso", "0.1"),
    "inside": ("--inside", "above"),
    "face_regions": ("--face", "top=facing:0,0,1,30"),
    "labels": ("--labels", "all"),
    "preset both-sides": ("--preset", "both-sides"),
    "box": ("--box", "0", "0", "0", "1", "1", "1"),
    "manifold": ("--manifold",),
    "sizing": ("--sizing", json.dumps({"growth": 0.5})),
    "sizing.grid": ("--sizing-grid", "sizes.vdb"),
    "sizing.grade_surface": ("--sizing", GRADED),
    "improve": ("--improve",),
    "fields": ("--field", "velocity"),
    "encoding ENCODING_COMPACT": ("--compact", "--server", "127.0.0.1:1"),
}
NOT_OPTIONS = {"name", "base_name", "points", "a session", "a job", "fidelity"}


class Rules(CommandTest):
    volumes = {"parts": 0.2}

    def test_are_those_of_the_document(self):
        scene = self.inputs / "scene.json"
        scene.write_text(json.dumps({"nodes": [{"sphere": {"radius": 1}}]}))
        rows = ROW.findall(DOCUMENT.read_text())
        self.assertGreater(len(rows), 10)
        for first, second, message in rows:
            if NOT_OPTIONS & {first, second} or {first, second} == {"grid_name", "grid_names"}:
                continue
            source = scene if "scene" in (first, second) else self.inputs / "parts.vdb"
            # Every word but the names, which are those of the options here.
            names = "|".join(re.escape(name) for name in (first, second, "ENCODING_PACKED"))
            words = [part for part in re.split(names, message) if part.strip()]
            with self.subTest(f"{first} beside {second}"):
                self.assert_fails(
                    self.tetstream("mesh", source, "-o", self.out / "a.vtu",
                                   *OPTIONS[first], *OPTIONS[second]),
                    REFUSED, *words)


if __name__ == "__main__":
    unittest.main()
