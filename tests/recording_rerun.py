#!/usr/bin/env python3
"""Opens a recording with Rerun: its own check, and a conversion with transforms and points for every body.

usage: recording_rerun.py FILE.mcap

Needs the Python packages rerun-sdk, mcap, mcap-protobuf-support, zstandard and lz4; where one is missing it says so and
ends with status 0. Otherwise the status is 0 if and only if `rerun mcap check` passes, and the converted recording has a transform for every
body, and points for every body whose packing was recorded.
"""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

try:
    from mcap.reader import make_reader
    from mcap_protobuf.decoder import DecoderFactory
except ImportError:
    make_reader = None

TIME_LIMIT = 300


def run(*command):
    """The program's output, error messages included; ends this one where the other fails."""
    done = subprocess.run(command, capture_output=True, text=True, timeout=TIME_LIMIT)
    output = done.stdout + done.stderr
    if done.returncode != 0:
        print(f"{' '.join(map(str, command))} failed:\n{output[-2000:]}")
        sys.exit(1)
    return output


def columns(printed):
    """Entity and columns of every chunk of the converted recording."""
    for line in printed.splitlines():
        found = re.search(r" - (/\S*) - data columns: \[(.*)\]", line)
        if found:
            yield found[1], found[2].split()


def lacking(recording, printed, frames):
    """Yields what the converted recording lacks."""
    chunks = list(columns(printed))
    points = {entity for entity, names in chunks if "Points3D:positions" in names}
    with open(recording, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        channels = reader.get_summary().channels.values()
        clouds = {channel.topic for channel in channels if channel.topic.endswith("/spheres")}
        bodies = set()
        for _, _, _, message in reader.iter_decoded_messages(topics=["/tf"]):
            bodies.update(transform.child_frame_id for transform in message.transforms)
    yield from (f"no points on {topic}" for topic in sorted(clouds - points))
    yield from (f"no transform of {body}" for body in sorted(bodies) if f"[{body}]" not in frames)
    if not bodies:
        yield "the recording has no body"


def main():
    program = Path(sys.executable).with_name("rerun")
    program = str(program) if program.exists() else shutil.which("rerun")
    if program is None or make_reader is None:
        print("skipped: a Python package is not here (pip install rerun-sdk mcap mcap-protobuf-support zstandard lz4)")
        return 0
    recording = Path(sys.argv[1])
    run(program, "mcap", "check", str(recording))
    with tempfile.TemporaryDirectory() as folder:
        converted = Path(folder) / "converted.rrd"
        run(program, "mcap", "convert", str(recording), "-o", str(converted))
        printed = run(program, "rrd", "print", str(converted))
        frames = run(program, "rrd", "print", "-vvv", "--entity", "/tf", str(converted))
    wrong = list(lacking(recording, printed, frames))
    print("\n".join(wrong) or "ok")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
