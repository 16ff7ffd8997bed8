"""Bars of large bodies: the server's memory while they come in, the speed at which they go out."""
import asyncio
import hashlib
import shutil
import socket
import sqlite3
import struct
import time

from bars_service import BOUNDARY, BarService, small_body, until
from bars_table import Bar

UPLOADS = 32
UPLOAD_MIB = 300
MIB = 1 << 20
RADIOSITY_BYTES = 400_000_000
RESERVED_BYTES = 20 << 30  # of the disk, for others


class LargeUpload:
    """The small job's parts; its scene has comments before it: nothing to render more, but bytes to take."""

    def __init__(self, body):
        self.comment = (b"# " + b"x" * 1021 + b"\n") * 256
        scene = body.index(b"\r\n\r\n", body.index(b'name="scene"')) + 4
        self.before, self.after = body[:scene], body[scene:]
        self.pieces = UPLOAD_MIB * MIB // len(self.comment)
        self.size = len(body) + self.pieces * len(self.comment)

    def head(self, port):
        return (f"POST /v1/jobs HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Length: {self.size}\r\n"
                f"Content-Type: multipart/form-data; boundary={BOUNDARY}\r\nExpect: 100-continue\r\n\r\n").encode()


async def upload_once(port, upload):
    """-> status"""
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    try:
        writer.write(upload.head(port))
        head = await reader.readuntil(b"\r\n\r\n")
        status = int(head.split()[1])
        if status != 100:
            return status
        writer.write(upload.before)
        for _ in range(upload.pieces):
            writer.write(upload.comment)
            await writer.drain()
        writer.write(upload.after)
        await writer.drain()
        return int((await reader.readuntil(b"\r\n\r\n")).split()[1])
    finally:
        writer.close()


async def upload_until_taken(port, upload, turned_away):
    """A client that is told to come again comes again."""
    while True:
        status = await upload_once(port, upload)
        if status == 202:
            return
        if status not in (429, 503):
            raise SystemExit(f"an upload is answered {status}")
        turned_away.append(status)
        await asyncio.sleep(1)


async def upload_all(port, upload, turned_away):
    await asyncio.gather(*(upload_until_taken(port, upload, turned_away) for _ in range(UPLOADS)))


def upload_bars(programs, folder, _):
    service = BarService(programs.server, programs.worker, folder / "uploads")
    try:
        client = service.connect()
        client.json("POST", "/v1/queue/pause")
        body = small_body(folder / "upload-job")
        for _ in range(20):
            client.json("GET", "/v1/jobs")
        client.close()
        idle = Bar("memory, idle", 64, "MiB", [[service.memory_mib("VmRSS")]], judged="median")
        needed = UPLOADS * UPLOAD_MIB * MIB + RESERVED_BYTES
        if shutil.disk_usage(folder).free < needed:
            print(f"no uploads: {needed >> 30} GiB of disk are needed", flush=True)
            return [idle]
        service.forget_highest()
        turned_away = []
        begun = time.monotonic()
        asyncio.run(upload_all(service.port, LargeUpload(body), turned_away))
        seconds = time.monotonic() - begun
        note = (f"{UPLOADS} of {UPLOAD_MIB} MiB in {seconds:.0f} s, told to come again {len(turned_away)} times; "
                f"afterwards {service.memory_mib('VmRSS'):.0f} MiB")
        return [idle, Bar(f"memory, {UPLOADS} large uploads", 160, "MiB", [[service.memory_mib("VmHWM")]],
                          judged="median", note=note)]
    finally:
        service.kill()
        shutil.rmtree(folder / "uploads", ignore_errors=True)


def write_radiosity(path):
    """An array of shape (frames, patches, 3), as the worker leaves one. -> bytes, SHA-256"""
    frames = 48
    patches = RADIOSITY_BYTES // (12 * frames)
    shape = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({frames}, {patches}, 3), }}"
    shape = (shape + " " * (-(len(shape) + 11) % 64) + "\n").encode()
    head = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(shape)) + shape
    frame = b"".join(struct.pack("<fff", i, i / 2, i / 4) for i in range(1024)) * (patches // 1024 + 1)
    digest = hashlib.sha256()
    with path.open("wb") as file:
        for piece in [head] + [frame[:12 * patches]] * frames:
            digest.update(piece)
            file.write(piece)
    return path.stat().st_size, digest.hexdigest()


def with_large_radiosity(service, body):
    """A rendered job whose radiosity is then exchanged for a large one: rendering one takes many minutes."""
    client = service.connect()
    job = client.submit(body)
    until(lambda: client.json("GET", f"/v1/jobs/{job}")["state"] == "succeeded", 120, "the job succeeds", 0.1)
    client.close()
    service.stop()
    size, sha256 = write_radiosity(service.data / "jobs" / job / "artefacts/radiosity.npy")
    with sqlite3.connect(service.data / "keylume.db") as database:
        database.execute("UPDATE artefact SET bytes = ?, sha256 = ? WHERE path = 'radiosity.npy'", (size, sha256))
    database.close()
    return f"/v1/jobs/{job}/radiosity.npy", size


def read_ranges_mb_s(port, path, size, range_bytes):
    """All of the file, in ranges one after the other over one connection -> MB/s"""
    buffer = bytearray(4 * MIB)
    got = 0
    begun = time.monotonic()
    with socket.create_connection(("127.0.0.1", port), timeout=60) as connection:
        for first in range(0, size, range_bytes):
            last = min(first + range_bytes, size) - 1
            connection.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\nRange: bytes={first}-{last}\r\n\r\n".encode())
            got += read_answer(connection, buffer, last - first + 1)
    if got != size:
        raise SystemExit(f"{got} bytes came of {size}")
    return size / 1e6 / (time.monotonic() - begun)


def read_answer(connection, buffer, expected):
    filled = 0
    while (end := buffer.find(b"\r\n\r\n", 0, filled)) < 0:
        count = connection.recv_into(memoryview(buffer)[filled:])
        if count == 0:
            raise SystemExit("the connection was closed")
        filled += count
    if not buffer.startswith(b"HTTP/1.1 206"):
        raise SystemExit(f"no range: {bytes(buffer[:200])!r}")
    got = filled - end - 4
    while got < expected:
        count = connection.recv_into(buffer, min(len(buffer), expected - got))
        if count == 0:
            break
        got += count
    return got


def range_bars(programs, folder, _):
    data = folder / "ranges"
    service = BarService(programs.server, programs.worker, data)
    try:
        path, size = with_large_radiosity(service, small_body(folder / "range-job"))
        service = BarService(programs.server, programs.worker, data)
        bars = []
        for name, range_bytes in (("64 MiB", 64 * MIB), ("1 MiB", MIB)):
            read_ranges_mb_s(service.port, path, size, range_bytes)  # into the page cache
            speeds = [read_ranges_mb_s(service.port, path, size, range_bytes) for _ in range(5)]
            bars.append(Bar(f"range reads of {name}", 500, "MB/s", [speeds], at_least=True, judged="median",
                            note=f"of a file of {size / 1e6:.0f} MB, one connection"))
        return bars
    finally:
        service.kill()
        shutil.rmtree(data, ignore_errors=True)
