#!/usr/bin/env python3
"""The same job and seed, by the worker that was built here and by the image's, which has other versions of Embree, of the
compiler and of everything else: the same light."""
import io
import os
import re
import subprocess
import unittest

import numpy

import container_engine  # noqa: F401  (says where Docker is, or ends as skipped)
from container import docker
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

    def embree_of_both(self, service):
        """What each is linked with, as the files are called: they need not be the same version, and are not on Debian 12."""
        native = subprocess.run(["ldd", NATIVE_WORKER], capture_output=True, text=True, check=True).stdout
        contained = docker("cp", f"{service.name}:/usr/bin/keylume", self.folder / "keylume", checked=False)
        self.assertEqual(contained.returncode, 0, contained.stderr)
        found = re.search(rb"libembree\d\.so\.\d", (self.folder / "keylume").read_bytes())
        return re.search(r"libembree\d\.so\.\d", native)[0], found[0].decode()

    def rmse(self, ours, theirs, area):
        """Weighted by area, of the mean"""
        weight = area[None, :, None] * numpy.ones_like(ours)
        mean = (weight * ours).sum() / weight.sum()
        self.assertGreater(mean, 0)
        return float(numpy.sqrt((weight * (ours - theirs) ** 2).sum() / weight.sum()) / mean)

    def test_they_agree(self):
        service = self.service()
        print("ratio: rays by {} here and {} in the container".format(*self.embree_of_both(service)), flush=True)
        for name, options in JOBS.items():
            with self.subTest(job=name):
                ours, error, area = self.native(write_job(self.folder / name, name, **options, seed=1))
                theirs, their_error, their_area = self.contained(service, self.folder / name)
                numpy.testing.assert_array_equal(area, their_area)
                self.assertEqual(ours.shape, theirs.shape)
                difference = numpy.abs(ours - theirs)
                beyond = int((difference > numpy.maximum(error, their_error)).sum())
                rmse = self.rmse(ours, theirs, area)
                print(f"ratio: {name}: native and container differ by {rmse:.1e} of the mean (at most {RMSE_MAX:.0e}); "
                      f"{beyond} of {difference.size} values by more than their standard error; "
                      f"{(difference == 0).mean():.1%} are the same bits", flush=True)
                self.assertLess(rmse, RMSE_MAX)
                self.assertEqual(beyond, 0)
                other, _, _ = self.native(write_job(self.folder / f"{name}_2", name, **options, seed=2))
                self.assertGreater(self.rmse(ours, other, area), RMSE_MAX, "of another seed the comparison tells the difference")


if __name__ == "__main__":
    unittest.main(verbosity=2)
