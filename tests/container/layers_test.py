#!/usr/bin/env python3
"""What a build was told in confidence is in no layer of any image: neither the file, nor a part of it, nor its history."""
import gzip
import io
import re
import subprocess
import tarfile
import unittest
from pathlib import Path

import container_engine
from container import docker
from image_setup import IMAGES
from service import ServiceTestCase

ENGINE = Path(__file__).resolve().parent.parent / "support/docker/engine"
CHUNK = 1 << 20


def secrets():
    """{name: its file}, as the images were built with"""
    run = subprocess.run([ENGINE, "secrets", container_engine.FOLDER / "engine"], capture_output=True, text=True, check=True)
    return {name: Path(file) for name, file in re.findall(r"--secret=id=([\w.]+),src=(\S+)", run.stdout)}


def texts_of(secrets_by_name):
    """Texts that no image has by right, one of each secret: the mark that npmrc begins with, and a line in the middle of the
    last certificate, which nobody else has (tests/support/docker/build_secrets.sh)"""
    found = {secrets_by_name["npmrc"].read_bytes().splitlines()[0]}
    certificates = secrets_by_name["certificates"].read_bytes()
    if certificates:
        lines = certificates.split(b"-----BEGIN CERTIFICATE-----")[-1].splitlines()
        found.add(lines[len(lines) // 2])
    return found


def holds(stream, wanted):
    """-> which of the texts `wanted` (bytes) the stream has"""
    found, longest, rest = set(), max(map(len, wanted)), b""
    while piece := stream.read(CHUNK):
        piece = rest + piece
        found.update(text for text in wanted if text in piece)
        rest = piece[-longest:]
    return found


def found_in(image, wanted):
    """-> (the texts that are in a layer, the history or the configuration of the image, how many of these there are)"""
    found, count = set(), 0
    with subprocess.Popen(["docker", "save", image], stdout=subprocess.PIPE) as save:
        with tarfile.open(fileobj=save.stdout, mode="r|") as parts:
            for part in parts:
                if not part.isfile():
                    continue
                stream = io.BufferedReader(parts.extractfile(part), CHUNK)
                packed = stream.peek(2)[:2] == b"\x1f\x8b"
                found |= holds(gzip.open(stream) if packed else stream, wanted)
                count += 1
        save.stdout.read()
    if save.returncode != 0:
        raise AssertionError(f"docker save {image}: {save.returncode}")
    return found, count


class Layers(ServiceTestCase):
    @classmethod
    def setUpClass(cls):
        cls.secrets = secrets()
        cls.wanted = texts_of(cls.secrets)

    def test_each_secret_can_be_told_from_all_else(self):
        self.assertEqual(set(self.secrets), {"npmrc", "certificates"})
        with_something = [name for name, file in self.secrets.items() if file.stat().st_size > 0]
        self.assertEqual(len(self.wanted), len(with_something))
        for text in self.wanted:
            self.assertGreater(len(text), 30, "chance does not find it")

    def test_no_layer_of_any_image_holds_a_secret(self):
        for target, image in IMAGES.items():
            with self.subTest(image=target):
                found, count = found_in(image, self.wanted)
                self.assertGreater(count, 2, "its layers, its configuration and more have been read")
                self.assertEqual(found, set(), f"{image} holds what it was built with in confidence")
                print(f"ratio: {count} parts of image {target} hold no secret of its build", flush=True)

    def test_an_image_that_keeps_a_secret_is_found_out(self):
        (self.folder / "Dockerfile").write_text(
            "FROM debian:trixie-slim AS kept\nRUN --mount=type=secret,id=npmrc cp /run/secrets/npmrc /kept\n"
            "FROM kept\nRUN rm /kept\n")
        image = "keylume-test-keeps-a-secret:test"
        subprocess.run(["docker", "build", "-q", f"--secret=id=npmrc,src={self.secrets['npmrc']}", "-t", image, str(self.folder)],
                       check=True, capture_output=True, timeout=120)
        self.addCleanup(docker, "image", "rm", "-f", image, checked=False)
        found, _ = found_in(image, self.wanted)
        self.assertEqual(found, {text for text in self.wanted if text in self.secrets["npmrc"].read_bytes()})
        self.assertTrue(found)


if __name__ == "__main__":
    unittest.main(verbosity=2)
