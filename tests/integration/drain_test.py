#!/usr/bin/env python3
"""SIGTERM: no new connections, requests under way end, clients that hang are not waited for, workers are told to stop and
their jobs are taken up again at the next start; a second SIGTERM ends it at once."""
import signal
import socket
import subprocess
import time
import unittest

from service import Service, ServiceTestCase, wait_until
from small_jobs import write_job


class Drain(ServiceTestCase):
    def test_a_request_under_way_is_answered_and_new_ones_are_refused(self):
        service = self.service()
        body = b"a" * 20_000
        with socket.create_connection(("127.0.0.1", service.port), timeout=20) as connection:
            connection.sendall(b"POST /v1/jobs/batch HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
                               b"Content-Length: 20000\r\n\r\n" + body[:10])
            time.sleep(0.5)  # its thread waits for the rest
            service.process.terminate()
            wait_until(lambda: self.is_refused(service), 5, "no new connections")
            connection.sendall(body[10:])
            self.assertTrue(connection.recv(65536).startswith(b"HTTP/1.1 422"), "answered, though it made no sense")
        self.assertEqual(service.process.wait(timeout=15), 0)

    def is_refused(self, service):
        try:
            socket.create_connection(("127.0.0.1", service.port), timeout=2).close()
            return False
        except OSError:
            return True

    def test_a_running_job_is_taken_up_again_at_the_next_start(self):
        service = self.service()
        job_id = self.submitted(service, write_job(self.folder / "job", frames=16, line_count=3_000_000))
        service.wait_for(job_id, ["running"], 30)
        wait_until(service.worker_pids, 10, "a worker")
        begun = time.monotonic()
        self.assertEqual(service.stop(), 0)
        self.assertLess(time.monotonic() - begun, 10)
        self.assertEqual(service.worker_pids(), [])
        service.start()
        self.assertEqual(service.wait_for(job_id, ["succeeded"], 240)["attempt"], 2)

    def test_clients_that_hang_do_not_keep_it_from_stopping(self):
        service = self.service()
        for _ in range(10):
            connection = socket.create_connection(("127.0.0.1", service.port), timeout=20)
            self.addCleanup(connection.close)
            connection.sendall(b"POST /v1/login HTTP/1.1\r\nHost: localhost\r\nContent-Length: 20000\r\n\r\nabc")
        time.sleep(0.3)
        begun = time.monotonic()
        service.process.terminate()
        code = service.process.wait(timeout=20)
        seconds = time.monotonic() - begun
        print(f"with hanging clients it stopped after {seconds:.1f} s")
        self.assertLess(seconds, 10)
        self.assertEqual(code, 0)

    def test_a_second_sigterm_ends_it_at_once(self):
        service = self.service()
        connection = socket.create_connection(("127.0.0.1", service.port), timeout=20)
        self.addCleanup(connection.close)
        connection.sendall(b"POST /v1/login HTTP/1.1\r\nHost: localhost\r\nContent-Length: 20000\r\n\r\nabc")
        time.sleep(0.3)
        service.process.send_signal(signal.SIGTERM)
        time.sleep(0.3)
        begun = time.monotonic()
        service.process.send_signal(signal.SIGTERM)
        self.assertEqual(service.process.wait(timeout=5), 1)
        self.assertLess(time.monotonic() - begun, 2)

    def test_the_second_server_on_a_folder_names_the_first(self):
        first = self.service()
        second = Service(first.data)
        run = subprocess.run(second.command(), capture_output=True, text=True, timeout=20, stdin=subprocess.DEVNULL)
        self.assertEqual(run.returncode, 75)
        self.assertIn(f"process {first.process.pid}", run.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
