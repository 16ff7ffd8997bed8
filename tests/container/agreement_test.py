#!/usr/bin/env python3
"""The same job and seed, by the worker that was built here and by the image's, which has other versions of Embree, of the
compiler and of everything else: the same light."""
import io
import os
import subprocess
import unittest

import numpy

import container_engine  # noqa: F401  (says where Docker is, or ends as skipped)
from small_jobs import write_job
from volume_service import VolumeTestCase

NATIVE_WORKER = os.environ["KEYLUME_NATIVE_WORKER"]
RMSE_MAX = 1e-4  # of the mean, weighted by area
JOBS = {
    "garage": {"frames": 12, "line_count": 400_000},
    "cornell_box": {"frames": 4, "line_count": 400_000},
}


class Agreement(VolumeTestCase):
    def native(self, job):
        """-> (radiosity, its standard error, areas), as the worker on this machine leaves them"""
        copy = self.folder / f"{job.name}_native"
        (copy / "input").mkdir(parents=True)
        for path in job.iterdir():
            (copy / "input" / path.name).write_bytes(path.read_bytes())
        run = subprocess.run([NATIVE_WORKER, "render", str(copy)], capture_output=True, text=True, timeout=240,
                             stdin=subprocess.DEVNULL)
        self.assertEqual(run.returncode, 0, run.stderr)
        read = lambda name: (copy / "artefacts" / name).read_bytes()  # noqa: E731
        return self.arrays(read)

    def contained(self, service, job):
        job_id = self.submitted(service, job)
        service.wait_for(job_id, ["succeeded"], 240)
        return self.arrays(lambda name: service.artefact(job_id, name))

    def arrays(self, read):
        load = lambda name: numpy.load(io.BytesIO(read(name)))  # noqa: E731
        return (load("radiosity.npy").astype(float), load("radiosity_se.npy").astype(float),
                load("patches.npz")["area_m2"].astype(float))

    def test_they_agree(self):
        service = self.service()
        for name, options in JOBS.items():
            with self.subTest(job=name):
                job = write_job(self.folder / name, name, **options)
                ours, error, area = self.native(job)
                theirs, their_error, their_area = self.contained(service, job)
                numpy.testing.assert_array_equal(area, their_area)
                self.assertEqual(ours.shape, theirs.shape)
                difference = numpy.abs(ours - theirs)
                weight = area[None, :, None]
                whole = (weight * numpy.ones_like(ours)).sum()
                mean = (weight * ours).sum() / whole
                rmse = float(numpy.sqrt((weight * difference ** 2).sum() / whole) / mean)
                allowed = numpy.maximum(error, their_error)
                beyond = int((difference > allowed).sum())
                equal = float((difference == 0).mean())
                print(f"ratio: {name}: native and container differ by {rmse:.1e} of the mean (at most {RMSE_MAX:.0e}); "
                      f"{beyond} of {difference.size} values by more than their standard error; {equal:.1%} are the same bits",
                      flush=True)
                self.assertGreater(mean, 0)
                self.assertLess(rmse, RMSE_MAX)
                self.assertEqual(beyond, 0)


if __name__ == "__main__":
    unittest.main(verbosity=2)
