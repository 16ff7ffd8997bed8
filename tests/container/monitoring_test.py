#!/usr/bin/env python3
"""docker/compose.yaml with Prometheus beside the service: it finds the service, knows our rules, and has an answer to
everything that the shipped dashboard asks."""
import json
import math
import os
import re
import signal
import subprocess
import unittest
from pathlib import Path

import container_engine  # noqa: F401  (says where Docker is, or ends as skipped)
from compose_project import ComposeProject
from container import docker
from curl import curl
from service import ServiceTestCase, wait_until
from small_jobs import write_job

OPS = Path(__file__).resolve().parent.parent.parent / "api/ops"
SCRAPES_S = 60  # four of those that docker/monitoring/prometheus.yaml has


def expressions():
    """[(panel, query)] of the dashboard that Grafana is given"""
    dashboard = json.loads((OPS / "grafana_dashboard.json").read_text())
    return [(panel["title"], target["expr"]) for panel in dashboard["panels"] for target in panel.get("targets", [])]


class Monitoring(ServiceTestCase):
    def setUp(self):
        super().setUp()
        self.running = ComposeProject("monitoring")
        self.addCleanup(self.running.clean_up)
        self.running.start()

    def api(self, path, **query):
        words = ["-G", *(word for name, value in query.items() for word in ("--data-urlencode", f"{name}={value}"))]
        answer = curl(f"http://127.0.0.1:{self.running.prometheus_port}/api/v1/{path}", *words, checked=False)
        self.assertEqual(answer.status, 200, answer.body)
        return answer.json()["data"]

    def values(self, expression):
        """Of an instant query, those that are numbers"""
        found = [float(each["value"][1]) for each in self.api("query", query=expression)["result"]]
        return [value for value in found if math.isfinite(value)]

    def ready(self):
        try:
            return curl(f"http://127.0.0.1:{self.running.prometheus_port}/-/ready", timeout_s=5, checked=False).status == 200
        except subprocess.CalledProcessError:  # it does not listen yet
            return False

    def begun(self, name, **options):
        return self.running.submitted(write_job(self.folder / name, **options))

    def job_whose_worker_is_killed(self):
        """So that there is something to count; its worker is the machine's process too."""
        job_id = self.begun("killed", frames=16, line_count=3_000_000)
        server = self.running.containers()["keylume"]["Id"]

        def worker():
            lines = docker("top", server, "-eo", "pid,args").splitlines()[1:]
            return [int(line.split()[0]) for line in lines if " render " in line]
        os.kill(wait_until(worker, 60, "a worker")[0], signal.SIGKILL)
        self.ended(job_id)

    def ended(self, job_id):
        self.assertEqual(wait_until(lambda: self.running.ended(job_id), 240, "the job ends")["state"], "succeeded")

    def scraped(self, expression, least):
        wait_until(lambda: sum(self.values(expression)) >= least, SCRAPES_S, f"{expression} is {least}")

    def test_the_service_is_watched_and_the_dashboard_answered(self):
        wait_until(self.ready, 60, "Prometheus is ready")
        self.scraped('up{job="keylume"}', 1)
        targets = self.api("targets")["activeTargets"]
        self.assertEqual([(each["labels"]["job"], each["health"]) for each in targets], [("keylume", "up")], targets)

        # Rates want events on both sides of a scrape.
        count = "keylume_job_duration_seconds_count"
        self.ended(self.begun("first", frames=2, line_count=20_000, patch_edge_m=1.5))
        self.scraped(count, 1)
        if os.getuid() == 0:
            self.job_whose_worker_is_killed()
            self.scraped("keylume_worker_restarts_total", 1)
        self.ended(self.begun("second", frames=2, line_count=20_000, patch_edge_m=1.5))
        self.scraped(count, 3 if os.getuid() == 0 else 2)

        rules = [rule for group in self.api("rules")["groups"] for rule in group["rules"]]
        shipped = re.findall(r"- alert: (\w+)", (OPS / "prometheus_alerts.yaml").read_text())
        self.assertEqual([rule["name"] for rule in rules], shipped)
        for rule in rules:
            self.assertEqual((rule["health"], rule.get("lastError", "")), ("ok", ""), rule["name"])
            self.assertNotEqual(rule["state"], "firing", rule["name"])

        for panel, expression in expressions():
            with self.subTest(panel=panel, expression=expression):
                if "keylume_worker_restarts_total" in expression and os.getuid() != 0:
                    continue  # nobody could kill a worker
                wait_until(lambda: self.values(expression), SCRAPES_S, f"{panel}: {expression} has a value")
        print(f"ratio: Prometheus has {len(shipped)} rules and answers {len(expressions())} queries of the dashboard", flush=True)


if __name__ == "__main__":
    unittest.main(verbosity=2)
