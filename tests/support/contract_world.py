"""What the generated requests of one client are about: jobs in every state that keep being there."""
import hashlib
import json
import re
import time

from service import wait_until
from small_jobs import changed, write_job

FRAMES = 3
CHURN_MAX = 25  # jobs that generated requests have submitted
SOON_S = 1.0


class World:
    def __init__(self, service, folder, send):
        """`send`: (method, path, headers, body) -> Exchange; not one of the requests that count."""
        self.service, self.send = service, send
        self.churn, self.views, self.etags = [], [], {}
        self.camera = "main"
        self.asset, self.example = self.dashboard_files()
        self.job = write_job(folder, example="cornell_box", frames=FRAMES, width=32, height=18)
        changed(self.job, lambda document: document["lighting"].update(preset="draft", samples_per_light=4))
        changed(self.job, lambda document: document["images"][0].update(formats=["png", "jpg", "exr"]))
        self.files = {"scene": (self.job / "scene.obj").read_bytes(), "animation": (self.job / "animation.json").read_bytes()}
        self.material = next(self.job.glob("*.mtl"))
        self.hashes = {name: self.put(data) for name, data in [*self.files.items(), ("materials", self.material.read_bytes())]}
        self.wanted = {}

    def dashboard_files(self):
        """A name for {file} of /assets, a name and a file of /examples; where there is no dashboard, names of nothing."""
        asset = re.search(rb"/assets/([\w.-]+)", self.ask("GET", "/").body)
        index = self.ask("GET", "/examples/index.json")
        examples = json.loads(index.body)["examples"] if index.status == 200 else []
        self.has_dashboard = bool(asset and examples)
        file = examples[0]["files"][0]["href"].split("/")[-2:] if examples else ["none", "none"]
        return asset[1].decode() if asset else "none", file

    def ask(self, method, path, value=None):
        body = None if value is None else json.dumps(value).encode()
        return self.send(method, path, [("Content-Type", "application/json")] if body else [], body)

    def put(self, data):
        digest = hashlib.sha256(data).hexdigest()
        answer = self.send("PUT", f"/v1/blobs/sha256/{digest}", [("Content-Type", "application/octet-stream")], data)
        assert answer.status in (200, 201), answer
        return digest

    def submit(self, **options):
        files = [{"field": name, "name": self.material.name, "sha256": digest} for name, digest in self.hashes.items()]
        answer = self.ask("POST", "/v1/jobs", {"files": files, "options": options})
        assert answer.status == 202, answer
        return json.loads(answer.body)["id"]

    def prepare(self):
        """One job that succeeds, then the others while the queue is paused."""
        done = self.submit(name="done")
        self.service.wait_for(done, ["succeeded"], 120)
        self.succeeded = done
        view = self.ask("POST", f"/v1/jobs/{done}/views", {"camera": self.camera, "frames": [0], "width": 8, "height": 8})
        self.kept_view = view.headers["location"].rpartition("/")[2]
        wait_until(lambda: json.loads(self.ask("GET", view.headers["location"]).body)["state"] == "ready", 60, "a view")

    def prepare_states(self):
        self.wanted = {self.submit(name=state, labels={"project": "garage"}): state
                       for state in ("queued", "paused", "canceled", "failed")}
        wait_until(self.restore, 20, "a job in each state")

    def looked_at(self, job_id):
        return json.loads(self.ask("GET", f"/v1/jobs/{job_id}").body)

    def restore(self):
        """Undoes what requests have done to these jobs and to the queue; true when all are as they should be."""
        self.ask("POST", "/v1/queue/pause", {"reason": "tests"})
        for job_id, wanted in self.wanted.items():
            job = self.looked_at(job_id)
            if job["state"] != wanted:
                self.one_step(job, wanted)
        self.restore_churn()
        return all(self.looked_at(job_id)["state"] == wanted for job_id, wanted in self.wanted.items())

    def restore_churn(self):
        """Some jobs that requests have submitted, not too many; the first three are over, so that they can be deleted."""
        while len(self.churn) > CHURN_MAX:
            job_id = self.churn.pop(0)
            self.ask("POST", f"/v1/jobs/{job_id}/cancel")
            self.ask("DELETE", f"/v1/jobs/{job_id}")
        self.churn = [job_id for job_id in self.churn if self.ask("GET", f"/v1/jobs/{job_id}").status == 200]
        while len(self.churn) < 3:
            self.churn.append(self.submit(name="more"))
        for job_id in self.churn[:3]:
            self.ask("POST", f"/v1/jobs/{job_id}/cancel")

    def one_step(self, job, wanted):
        job_id, state = job["id"], job["state"]
        if state in ("failed", "canceled"):
            self.ask("POST", f"/v1/jobs/{job_id}/retry")
        elif state == "paused" and wanted != "canceled":
            self.ask("POST", f"/v1/jobs/{job_id}/resume")
        if wanted == "failed" and not job["deadline"]:  # it fails by that
            at = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(time.time() + 1 + SOON_S))
            self.ask("PATCH", f"/v1/jobs/{job_id}", {"deadline": at, "ttl_seconds": None})
        elif wanted in ("paused", "canceled"):
            self.ask("POST", f"/v1/jobs/{job_id}/{'pause' if wanted == 'paused' else 'cancel'}")

    # What the generator asks for.

    def job_id(self, rng, operation):
        ours = [self.succeeded, *self.wanted]
        if operation.name == "deleteJob":
            ours = self.churn[:3]
        if "results" in operation.tags and rng.random() < 0.7:
            return self.succeeded
        return rng.choice(ours * 2 + self.churn[-5:] + ["none", "batch", "job_01JDA2V7Y0K3V9X0Q2M7RA4N5P", "a" * 64, "a" * 65, "-", "_"])

    def path_value(self, rng, name, operation):
        if name == "id":
            return self.job_id(rng, operation)
        if name == "f":
            return str(rng.choice([*range(FRAMES), 0, 1, FRAMES, 1999]))
        if name == "p":
            return str(rng.choice([0, 1, 17, 99999, 19999999]))
        if name == "hex":
            return rng.choice([*self.hashes.values(), "0" * 64, rng.randbytes(32).hex()])
        if name == "view" and operation.method == "GET" and rng.random() < 0.5:
            return self.kept_view
        if name == "view":
            return rng.choice(self.views[-8:] + ["0" * 32])
        if name == "series":
            return rng.choice(["radiosity", "radiosity_se", "radiosity_none", "patches"])
        if name == "example":
            return self.example[0]
        if operation.name in ("getAsset", "getExampleFile"):
            return self.asset if operation.name == "getAsset" else self.example[1]
        if name == "job":
            return self.succeeded
        if operation.name == "getViewFrame":
            return rng.choice(["0.png", "0.png", "1.png", "2.jpg", "0.exr", "9.png"])
        return rng.choice(["radiosity.npy", "radiosity_se.npy", "key_frames.json", "manifest.json", "worker.log", "x"])

    def body(self, rng, operation):
        """Of operations whose bodies name what must be there; None: as the schema says."""
        if operation.name == "changeJobs":
            action = rng.choice(["cancel", "pause", "resume", "retry", "delete"])
            known = self.churn if action == "delete" else [*self.wanted, *self.churn]
            ids = rng.sample(known, min(len(known), rng.randint(1, 4)))
            return {"ids": list(dict.fromkeys(ids or ["none"])), "action": action}
        if operation.name in ("submitJob", "validateJob", "previewJob"):
            return {"files": [{"field": name, "name": self.material.name, "sha256": digest} for name, digest in self.hashes.items()],
                    "options": {"priority": rng.randint(0, 100)}}
        if operation.name == "createView":
            # Small: what is asked for is made. The upper bounds are for the mutations.
            return {"camera": rng.choice([self.camera, {"position": [278, 273, -700], "target": [278, 273, 0]}]),
                    "frames": [rng.randrange(FRAMES)], "width": rng.randint(1, 48), "height": rng.randint(1, 32),
                    "formats": rng.sample(["png", "jpg", "exr"], rng.randint(1, 3)), "samples_per_pixel": 1}
        if operation.name == "queryPatchSeries":
            return {"patches": [rng.randrange(30) for _ in range(rng.randint(1, 5))], "format": rng.choice(["json", "csv"])}
        return None

    def parts(self, rng):
        return [("scene", "scene.obj", "model/obj", self.files["scene"]),
                ("materials", self.material.name, "model/mtl", self.material.read_bytes()),
                ("animation", "animation.json", "application/json", self.files["animation"])]

    def blob_body(self, rng, request):
        """The bytes of the hash in the path, where it is the hash of something."""
        if request.is_mutated:
            return rng.randbytes(rng.choice([0, 1, 1000]))
        data = rng.randbytes(rng.choice([0, 1, 1000]))
        request.path = "/v1/blobs/sha256/" + hashlib.sha256(data).hexdigest()
        return data

    def spare(self, request):
        """Takes out of a request what would end a job that is to stay."""
        keeps = [self.succeeded, *self.wanted]
        if request.operation.name == "deleteView":
            request.path = request.path.replace(self.kept_view, "0" * 32)
        name = request.operation.name
        if name == "changeJob" and any(job_id in request.path for job_id in keeps) and b"ttl" in (request.body or b""):
            request.body = request.body.replace(b"ttl_seconds", b"ttl_second")
        if name == "deleteJob" and any(job_id in request.path for job_id in keeps):
            request.path = request.path.partition("?")[0] + "?dry_run=true"
        if name == "changeJobs" and b"delete" in (request.body or b""):
            for job_id in keeps:
                request.body = request.body.replace(job_id.encode(), b"none")

    def learn(self, request, exchange):
        """What an answer tells of jobs and views that are there now."""
        if exchange.status in (200, 201, 202) and request.method == "POST" and exchange.is_whole:
            path = exchange.headers.get("location", "")
            if "/views/" in path:
                self.views.append(path.rpartition("/")[2])
            elif path.startswith("/v1/jobs/"):
                self.churn.append(path.rpartition("/")[2])
        if exchange.status == 200 and "etag" in exchange.headers:
            self.etags[request.path] = exchange.headers["etag"]
        if request.operation.name == "resumeQueue":
            self.ask("POST", "/v1/queue/pause", {})
