"""What comes of a job where nothing goes wrong: the oracle of those who break something."""
from dataclasses import dataclass
from pathlib import Path

from service import ServiceTestCase, hashes_of
from small_jobs import write_job


@dataclass
class FinishedJobs:
    input: Path  # scene.obj, MTL and animation.json, to be submitted again
    data: Path  # of a server that has ended
    ids: list
    expected: dict  # hashes of the artefacts of each, by their paths


def finish_jobs(test_class, count=1, timeout_s=120, **job):
    """Has a server of its own render the job, as write_job takes it, `count` times. For setUpClass: the folders stay as
    long as the class is tested. -> FinishedJobs"""
    shared = ServiceTestCase()
    shared.setUp()
    test_class.addClassCleanup(shared.doCleanups)
    folder = write_job(shared.folder / "job", **job)
    service = shared.service()
    ids = [shared.submitted(service, folder) for _ in range(count)]
    for job_id in ids:
        service.wait_for(job_id, ["succeeded"], timeout_s)
    hashes = [hashes_of(service.job_folder(job_id) / "artefacts") for job_id in ids]
    assert all(each == hashes[0] for each in hashes), "the same job, other bytes"
    assert service.stop() == 0
    return FinishedJobs(folder, service.data, ids, hashes[0])
