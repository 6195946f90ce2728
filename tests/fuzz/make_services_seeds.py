#!/usr/bin/python3
"""Writes the first inputs of services_fuzz, one of each file below: tests/fuzz/corpus/services_fuzz.

    /usr/bin/python3 tests/fuzz/make_services_seeds.py        needs protoc

A seed is a list of calls: a method, and its messages in protobuf's text format. Each method has one that
is answered, which fuzz_replay checks.
"""

import pathlib
import re
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
PROTO = HERE.parent.parent / "proto"
GOES_ON = 0x80
RESTART = ord("R")

BALL = 'name: "@ball" levels: 0'
SPHERE = 'spacing: 0.5 scene { nodes { sphere { radius: 2 } } }'
SCENE = """spacing: 0.5 scene {
  nodes { name: "a" ellipsoid { semi_axes: [1, 2, 1.5] } }
  nodes { name: "b" transform { of: "a" scale: [1] axis: [0, 0, 1] angle_deg: 30 translation: [1, 0, 0] } }
  nodes { name: "c" torus { major_radius: 2 minor_radius: 0.5 } }
  nodes { name: "d" repeat { of: "b" count: [2, 1, 1] step: [3, 0, 0] } }
  nodes { union { of: "c" of: "d" smoothing: 0.1 } } }"""
MANY = ('improve: true manifold: true skip_statistics: true inside: INSIDE_BELOW fidelity: true '
        'box { min { x: -1 y: -1 z: -1 } max { x: 9 y: 9 z: 9 } } '
        'preset: PRESET_BOTH_SIDES coordinate_type: COORDINATE_TYPE_FLOAT64')
JOB = f'job {{ mesh {{ {BALL} }} display_name: "one" priority: 1 labels {{ key: "k" value: "v" }} '
POINTS = "\\000" * 24

SEEDS = {
    "grids": [
        ("FindMissingGrids", ['names: ["@ball", "@labels"]']),
        ("UploadGrid", ['start { name: "@data" size_bytes: 5 }', 'data { data: "ab" }',
                        'data { offset: 2 data: "cde" }']),
        ("GetUploadStatus", ['name: "@data"']),
        ("ListGrids", ['page_size: 1', ]),
        ("GetGridInfo", ['name: "@ball" values: true']),
        ("GetGridInfo", ['name: "@labels" values: true']),
        ("GetGridInfo", ['name: "@data"'])],
    "half_a_grid": [
        ("UploadGrid", ['start { name: "@data" size_bytes: 9 }', 'data { data: "abc" }']),
        ("GetUploadStatus", ['name: "@data"']),
        ("UploadGrid", ['start { name: "@data" size_bytes: 8 }', 'data { offset: 1 data: "abc" }'])],
    "meshes": [
        ("GetCapabilities", ['']),
        ("EstimateMesh", [f'mesh {{ {BALL} }}']),
        ("StreamMesh", [f'mesh {{ {BALL} }} encoding: ENCODING_COMPACT']),
        ("StreamMesh", [f'mesh {{ {SPHERE} }} start_chunk: 0 end_chunk: 1 encoding: ENCODING_PACKED'])],
    "scenes": [
        ("EstimateMesh", [f'mesh {{ {SCENE} }}']),
        ("EstimateMesh", [f'mesh {{ {SPHERE} {MANY} }}']),
        ("EstimateMesh", ['mesh { spacing: 0.5 scene { nodes { name: "g" grid { name: "@ball" } } '
                          'nodes { shell { of: "g" thickness: 0.5 } } } }'])],
    "labels": [
        ("StreamMesh", ['mesh { name: "@labels" levels: 0 labels { only { first: 1 last: 2 } '
                        'names { value: 1 name: "one" } kernel: LABEL_KERNEL_GAUSS smooth: 0.7 '
                        'sizes { labels { first: 1 last: 1 } size: 2 } } }']),
        ("EstimateMesh", [f'mesh {{ {BALL} faces: true fields {{ name: "f" grid: "@ball" }} }}'])],
    "session": [
        ("RemeshSession", [f'start {{ {SPHERE} }} tell_refusals: true',
                           'frame { scene { nodes { sphere { radius: 2.1 } } } }']),
        ("RemeshSession", [f'start {{ {BALL} }}', 'part { leaves { x: 8 y: 8 z: 8 values: "\\000\\000\\000\\000" } }',
                           'frame { leaves { x: 0 y: 0 z: 0 values: "\\000\\000\\000\\000" } }'])],
    "samples": [
        ("SamplePoints", [f'start {{ {BALL} }}', f'points {{ positions: "{POINTS}" }}'])],
    "jobs": [
        ("CreateJob", [JOB + '} request_id: "r"']),
        ("WaitJob", ['name: "@job0" timeout { seconds: 60 }']),
        ("GetJob", ['name: "@job0"']),
        ("ListJobs", ['filter { states: [JOB_STATE_SUCCEEDED] labels { key: "k" value: "v" } '
                      'display_name_prefix: "o" created_from { seconds: 1 } } page_size: 1']),
        ("ReadJobResult", ['name: "@job0" start_chunk: 0 end_chunk: 1']),
        ("ListDeadShards", ['name: "@job0" page_size: 1']),
        ("WatchJobs", ['name: "@job0" after_revision: 1']),
        ("ListWorkers", ['page_size: 1']),
        ("DeleteJob", ['name: "@job0"'])],
    "jobs_that_end": [
        ("CreateJob", [JOB + 'ttl { nanos: 1 } timeout { nanos: 1 } max_attempts: 1 skip_cache: true }']),
        ("CreateJob", ['job { mesh { name: "@labels" spacing: 1e-3 } max_attempts: 1 }']),
        ("CancelJob", ['name: "@job0"']),
        ("RetryJob", ['name: "@job0"']),
        ("RetryJob", ['name: "@job1"']),
        ("WatchJobs", [''])],
    "health": [
        ("Check", ['service: "readiness"']),
        ("Watch", ['service: "jobs"'])],
}


def methods():
    """Full names in the order of kMethods."""
    table = (HERE / "fuzzed_services.h").read_text()
    return re.findall(r'"([\w.]+\.\w+\.\w+)"', table[table.index("kMethods{"):table.index("};")])


def inputs():
    """{method: the type of its messages}."""
    files = {path: path.read_text() for path in (PROTO / "tetstream" / "v1").glob("*.proto")}
    return {name: f"tetstream.v1.{kind}" for text in files.values()
            for name, kind in re.findall(r"rpc (\w+)\s*\((?:stream )?(\w+)\)", text)} | {
                "Check": "grpc.health.v1.HealthCheckRequest", "Watch": "grpc.health.v1.HealthCheckRequest"}


def encode(kind, text):
    files = [str(path.relative_to(PROTO)) for path in sorted(PROTO.glob("**/*.proto"))]
    return subprocess.run(["protoc", f"--proto_path={PROTO}", f"--encode={kind}", *files],
                          input=text.encode(), stdout=subprocess.PIPE, check=True).stdout


def main():
    places = {name.rsplit(".", 1)[1]: number for number, name in enumerate(methods())}
    kinds = inputs()
    corpus = HERE / "corpus" / "services_fuzz"
    corpus.mkdir(parents=True, exist_ok=True)
    for name, calls in SEEDS.items():
        seed = bytearray([RESTART if name.startswith("jobs") else 0])
        for method, messages in calls:
            for number, text in enumerate(messages):
                payload = encode(kinds[method], text)
                first = places[method] | (GOES_ON if number else 0)
                seed += bytes([first]) + len(payload).to_bytes(2, "little") + payload
        (corpus / name).write_bytes(seed)


if __name__ == "__main__":
    main()
