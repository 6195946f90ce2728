"""A night's batch: one part at several spacings and with several bores, as jobs, and a table of what came of them.

    python3 examples/python/night_batch.py [HOST:PORT]
"""

import sys

import tetstream as ts

client = ts.Client(sys.argv[1] if len(sys.argv) > 1 else ":local:")
night = {"batch": "bores"}


def bracket(bore):
    plate = ts.union(ts.box((2, 2, 0.4), rounding=0.1), ts.cylinder(0.6, 1.2), smoothing=0.3)
    return plate - ts.cylinder(bore, 3)


jobs = [client.jobs.submit(ts.Request(bracket(bore), spacing=spacing, improve=True),
                           display_name=f"bore {bore:.1f} at {spacing:.2f}", labels=night)
        for bore in (0.2, 0.3, 0.8) for spacing in (0.12, 0.08)]
client.jobs.wait_all(jobs)

print(f"{'job':<18} {'state':<10} {'tets':>8} {'volume':>8} {'angles':>14}")
best = None
for job in reversed(client.jobs.list(labels=night)):
    if job.state != "succeeded":
        print(f"{job.display_name:<18} {job.state:<10} {job.error}")
        continue
    mesh = client.jobs.fetch(job)
    quality = mesh.quality()
    print(f"{job.display_name:<18} {job.state:<10} {len(mesh.tets):8d} {quality.volume:8.3f} "
          f"{quality.min_dihedral_deg:6.1f} {quality.max_dihedral_deg:7.1f}")
    best = best or mesh
best.picture("night_batch.png")
