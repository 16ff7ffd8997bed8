#!/usr/bin/env python3
"""Archives to be refused, and some to be taken, written byte by byte where no honest tool would make them.

usage: archives.py FOLDER        writes CODE--what.zip and .tar there; CODE is ok or that of the refusal
"""
import io
import struct
import sys
import tarfile
import zipfile
import zlib
from pathlib import Path

OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
JSON = b'{"frames":{"count":1}}'


class Zip:
    """A zip of which every field can lie. Numbers that are not given are right."""

    def __init__(self):
        self.body, self.directory, self.count = b"", b"", 0

    def add(self, name, data, method=0, host=3, mode=0o100644, flags=0x800, **lies):
        """Lies: stored, crc, stored_bytes, bytes, local_name, local_bytes, at (use the bytes of that offset)."""
        name = name.encode() if isinstance(name, str) else name
        deflater = zlib.compressobj(9, zlib.DEFLATED, -15)
        stored = lies.get("stored", deflater.compress(data) + deflater.flush() if method == 8 else data)
        crc = lies.get("crc", zlib.crc32(data))
        stored_bytes = lies.get("stored_bytes", len(stored))
        size = lies.get("bytes", len(data))
        local = lies.get("local_name", name)
        at = lies.get("at", len(self.body))
        if "at" not in lies:
            self.body += struct.pack("<4s5H3I2H", b"PK\3\4", 20, flags, method, 0, 0, crc, stored_bytes,
                                     lies.get("local_bytes", size), len(local), 0) + local + stored
        self.directory += struct.pack("<4sBB5H3I5H2I", b"PK\1\2", 20, host, 20, flags, method, 0, 0, crc,
                                      stored_bytes, size, len(name), 0, 0, 0, 0, mode << 16, at) + name
        self.count += 1
        return self

    def bytes(self, count=None, comment=b"", gap=b"", behind=b""):
        count = self.count if count is None else count
        end = struct.pack("<4s4H2IH", b"PK\5\6", 0, 0, count, count, len(self.directory), len(self.body) + len(gap),
                          len(comment))
        return self.body + gap + self.directory + end + comment + behind


def job_zip():
    return Zip().add("scene.obj", OBJ, 8).add("animation.json", JSON, 8)


def overlapping():
    """Two entries out of the same bytes: repeated, that is petabytes out of megabytes."""
    first = Zip().add("scene.obj", OBJ, 8)
    return first.add("other.obj", OBJ, 8, stored_bytes=len(first.body) - 30 - 9, at=0, local_name=b"scene.obj")


def quoted():
    """The second entry lies within the bytes of the first, as in the bombs that need no nesting."""
    inner = Zip().add("b.obj", OBJ).body
    outer = Zip().add("a.obj", inner)
    outer.add("b.obj", OBJ, at=30 + len(b"a.obj"))
    return outer


def zips():
    many = Zip()
    for i in range(300):
        many.add(f"t{i}.png", b"x")
    big = b"\0" * (8 << 20)
    yield "ok--job.zip", job_zip().bytes()
    yield "ok--comment.zip", job_zip().bytes(comment=b"made by hand")
    yield "ok--folders.zip", Zip().add("room/", b"", mode=0o040755).add("room/scene.obj", OBJ).add(
        "__MACOSX/room/._scene.obj", b"?").add(".DS_Store", b"?").bytes()
    yield "ok--sixty_four_kib.zip", Zip().add("scene.obj", b"# 3456789abcdef\n" * 4096, 8).bytes()
    yield "too_large--bomb.zip", Zip().add("scene.obj", big, 8).bytes()
    yield "bad_archive--bomb_that_denies_it.zip", Zip().add("scene.obj", big, 8, bytes=1000).bytes()
    yield "too_many--entries.zip", many.bytes()
    yield "bad_archive--overlap.zip", overlapping().bytes()
    yield "bad_archive--quoted.zip", quoted().bytes()
    yield "bad_archive--same_bytes_thrice.zip", Zip().add("a.obj", OBJ).add("a.obj", OBJ, at=0).add(
        "a.obj", OBJ, at=0).bytes()
    yield "not_a_file--link.zip", Zip().add("scene.obj", b"/etc/passwd", mode=0o120777).bytes()
    yield "not_a_file--device.zip", Zip().add("scene.obj", b"", mode=0o020666).bytes()
    yield "duplicate_entry--case.zip", Zip().add("Room.obj", OBJ).add("rOOM.OBJ", OBJ).bytes()
    yield "encrypted--flag.zip", Zip().add("scene.obj", OBJ, flags=1).bytes()
    yield "unsupported--method.zip", Zip().add("scene.obj", OBJ, method=14, stored=OBJ).bytes()
    yield "unsupported--zip64.zip", Zip().add("scene.obj", OBJ, bytes=0xFFFFFFFF).bytes()
    yield "bad_archive--says_more.zip", Zip().add("scene.obj", OBJ, 8, bytes=5000).bytes()
    yield "bad_archive--says_less.zip", Zip().add("scene.obj", OBJ, 8, bytes=5).bytes()
    yield "bad_archive--stored_says_more.zip", Zip().add("scene.obj", OBJ, bytes=5000).bytes()
    yield "bad_archive--two_sizes.zip", Zip().add("scene.obj", OBJ, 8, local_bytes=9).bytes()
    yield "bad_archive--two_names.zip", Zip().add("scene.obj", OBJ, local_name=b"../../x.obj").bytes()
    yield "bad_archive--checksum.zip", Zip().add("scene.obj", OBJ, crc=1).bytes()
    yield "bad_archive--garbage.zip", Zip().add("scene.obj", OBJ, 8, stored=b"\xff" * 40).bytes()
    yield "bad_archive--bytes_behind_deflate.zip", Zip().add(
        "scene.obj", OBJ, 8, stored=zlib.compress(OBJ, 9)[2:-4] + b"more").bytes()
    yield "bad_archive--cut.zip", job_zip().bytes()[:-30]
    yield "bad_archive--behind.zip", job_zip().bytes(behind=b"x" * 100)
    yield "bad_archive--gap.zip", Zip().add("scene.obj", OBJ, at=0).bytes(gap=b"PK\3\4" + b"x" * 60)
    yield "bad_archive--far_away.zip", job_zip().add("far.obj", OBJ, at=0x7FFFFFF0).bytes()
    yield "bad_archive--wrong_count.zip", job_zip().bytes(count=1)
    names = {"up": "../scene.obj", "up_within": "a/../../scene.obj", "root": "/scene.obj", "drive": "C:/scene.obj",
             "stream": "scene.obj:more", "backslash": "..\\scene.obj", "newline": "scene\r\nX: y.obj", "nul": "scene\0.obj",
             "here": "./scene.obj", "empty_part": "a//scene.obj", "no_name": "", "long": "x" * 600 + ".obj"}
    for what, name in names.items():
        yield f"bad_name--{what}.zip", Zip().add(name, OBJ).bytes()
    for what, name in {"latin": b"k\xfche.obj", "overlong": b"a\xc0\xafb.obj", "surrogate": b"\xed\xa0\x80.obj"}.items():
        yield f"bad_name--{what}.zip", Zip().add(name, OBJ).bytes()


def tar_of(*members, format=tarfile.USTAR_FORMAT):
    """members: (name, bytes) or (name, bytes, type, link name)"""
    out = io.BytesIO()
    with tarfile.open(fileobj=out, mode="w", format=format) as tar:
        for name, data, *rest in members:
            info = tarfile.TarInfo(name)
            info.size = len(data)
            if rest:
                info.type, info.linkname = rest
            tar.addfile(info, io.BytesIO(data))
    return out.getvalue()


def resealed(tar, at, field):
    """The first header with `field` at `at`, and a checksum that is right again."""
    block = bytearray(tar[:512])
    block[at:at + len(field)] = field
    block[148:156] = b" " * 8
    block[148:156] = b"%06o\0 " % sum(block)
    return bytes(block) + tar[512:]


def tars():
    job = tar_of(("scene.obj", OBJ), ("animation.json", JSON))
    yield "ok--job.tar", job
    yield "ok--here.tar", tar_of(("./scene.obj", OBJ), ("./animation.json", JSON))
    yield "ok--long_pax.tar", tar_of(("d/" * 80 + "scene.obj", OBJ), format=tarfile.PAX_FORMAT)
    yield "ok--long_gnu.tar", tar_of(("d/" * 80 + "scene.obj", OBJ), format=tarfile.GNU_FORMAT)
    yield "ok--folder.tar", tar_of(("room", b"", tarfile.DIRTYPE, ""), ("room/scene.obj", OBJ))
    yield "not_a_file--symlink.tar", tar_of(("scene.obj", b"", tarfile.SYMTYPE, "/etc/passwd"))
    yield "not_a_file--hardlink.tar", tar_of(("scene.obj", b"", tarfile.LNKTYPE, "../../keylume.db"))
    yield "not_a_file--device.tar", tar_of(("scene.obj", b"", tarfile.CHRTYPE, ""))
    yield "not_a_file--pipe.tar", tar_of(("scene.obj", b"", tarfile.FIFOTYPE, ""))
    yield "bad_name--up.tar", tar_of(("../scene.obj", OBJ))
    yield "bad_name--root.tar", tar_of(("/scene.obj", OBJ))
    yield "bad_name--up_by_pax.tar", tar_of(("x/" * 80 + "../../scene.obj", OBJ), format=tarfile.PAX_FORMAT)
    yield "duplicate_entry--case.tar", tar_of(("a/Scene.obj", OBJ), ("A/scene.OBJ", OBJ))
    yield "too_many--entries.tar", tar_of(*((f"t{i}.png", b"x") for i in range(300)))
    yield "bad_archive--cut.tar", job[:600]
    yield "bad_archive--no_end.tar", job[:1024]
    yield "bad_archive--checksum.tar", job[:10] + b"X" + job[11:]
    yield "bad_archive--says_more.tar", resealed(job, 124, b"77777777777\0")
    yield "bad_archive--negative.tar", resealed(job, 124, b"-0000000001\0")
    yield "bad_archive--binary_size.tar", resealed(job, 124, b"\x80" + b"\xff" * 11)
    yield "bad_archive--endless_pax.tar", resealed(tar_of(("scene.obj", b"9" * 2000)), 156, b"x")
    yield "unsupported--gzip.tar", b"\x1f\x8b\x08\0" + b"\0" * 600
    yield "bad_archive--nothing.tar", b""
    yield "bad_archive--text.tar", b"v 0 0 0\n" * 200


def honest_zip(files):
    """{name: bytes} -> what Python's own writer makes of it"""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return out.getvalue()


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in [*zips(), *tars(), ("ok--python.zip", honest_zip({"scene.obj": OBJ, "kü/animation.json": JSON}))]:
        (folder / name).write_bytes(data)


if __name__ == "__main__":
    main()
