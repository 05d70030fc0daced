"""Opens logs with other people's readers and compares what these say.

    check_peers.py FILE...

Readers: mcap-ros2-support, rosbags, and rerun where its command is installed. Prints a line for
each reader and file. Exits with 1 if a reader fails, misses a message or differs from another in
a stamp or a value. For finished logs of the layout that hydrotrace writes.
"""

import math
import shutil
import subprocess
import sys
from pathlib import Path

import numpy
from mcap.reader import make_reader
from mcap.records import Header
from mcap.stream_reader import StreamReader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader


def main(paths):
    failures = 0
    for path in paths:
        expected = None
        for name, check in READERS.items():
            try:
                if name == "rerun" and not shutil.which("rerun"):
                    report = "skipped, not installed"
                elif name == "rerun":
                    report = check(path)
                else:
                    messages = check(path)
                    if not messages:
                        raise ValueError("no messages")
                    expected = expected or (name, messages)
                    compare(*expected, name, messages)
                    report = f"{len(messages)} messages agree"
            except Exception as error:  # whatever a reader throws is a failure of that reader
                failures += 1
                report = f"FAILED: {type(error).__name__}: {error}"
            print(f"{path.name}: {name}: {report}")
    return 1 if failures else 0


def with_mcap(path):
    """Checksums, summary and stamps by the plain reader, values by its ROS 2 decoder."""
    with path.open("rb") as file:
        records = list(StreamReader(file, validate_crcs=True).records)
        header = next(record for record in records if isinstance(record, Header))
        require(header.profile == "ros2", f"profile {header.profile}")
        require(header.library.startswith("hydrotrace "), f"library {header.library}")
    messages = []
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        statistics = reader.get_summary().statistics
        for _, channel, message, decoded in reader.iter_decoded_messages():
            require(message.log_time == message.publish_time, "log time is not publish time")
            for stamp in stamps(decoded):
                require(message.log_time == nanoseconds(stamp), "log time is not the stamp")
            messages.append((message.log_time, channel.topic, dict(flatten(decoded))))
        require(statistics.message_count == len(messages), f"the summary counts {statistics.message_count}")
        require(statistics.attachment_count == len(list(reader.iter_attachments())), "attachments")
        require(statistics.metadata_count == len(list(reader.iter_metadata())), "metadata")
    return ordered(messages)


def with_rosbags(path):
    """Values, and the type hash and quality of service of each topic."""
    with path.open("rb") as file:
        channels = make_reader(file).get_summary().channels.values()
        hashes = {channel.topic: channel.metadata["topic_type_hash"] for channel in channels}
    messages = []
    with AnyReader([path]) as reader:
        for connection in reader.connections:
            hash_ = reader.typestore.hash_rihs01(connection.msgtype)
            require(hashes[connection.topic] == hash_, f"hash of {connection.topic} is {hash_}")
            profiles = connection.ext.offered_qos_profiles
            depth = 1 if connection.topic.endswith(("robot_description", "tf_static")) else 10
            require(len(profiles) == 1 and profiles[0].depth == depth, f"profiles of {connection.topic}")
        for connection, stamp, data in reader.messages():
            decoded = reader.deserialize(data, connection.msgtype)
            messages.append((stamp, connection.topic, dict(flatten(decoded))))
    return ordered(messages)


def with_rerun(path):
    """Whether rerun finds fault."""
    run = subprocess.run(["rerun", "mcap", "check", str(path)], capture_output=True, text=True)
    require(run.returncode == 0, (run.stdout + run.stderr).strip())
    return "check passed"


READERS = {"mcap-ros2-support": with_mcap, "rosbags": with_rosbags, "rerun": with_rerun}


def flatten(value, path=""):
    """Yields every leaf of a message as its path and an array or a text."""
    if isinstance(value, (str, int, float)):
        yield path, value
    elif isinstance(value, (list, numpy.ndarray)):
        if len(value) and not isinstance(value[0], (str, int, float)):
            for k, element in enumerate(value):
                yield from flatten(element, f"{path}[{k}]")
        else:
            yield path, list(value)
    else:
        fields = getattr(value, "__slots__", None) or vars(value)
        for field in fields:
            if not field.startswith("_"):
                yield from flatten(getattr(value, field), f"{path}.{field}")


def stamps(message):
    """Those of a message; a text has none, a list of transforms has many."""
    parts = [message, *getattr(message, "transforms", [])]
    return [part.header.stamp for part in parts if hasattr(part, "header")]


def nanoseconds(stamp):
    return stamp.sec * 1_000_000_000 + stamp.nanosec


def ordered(messages):
    """Readers may order messages of one stamp as they like."""
    return sorted(messages, key=lambda message: message[:2])


def compare(name, expected, other, messages):
    require(len(expected) == len(messages), f"{len(messages)} messages, but {name} has {len(expected)}")
    for (stamp, topic, values), (other_stamp, other_topic, other_values) in zip(expected, messages):
        require((stamp, topic) == (other_stamp, other_topic),
                f"{other_topic} at {other_stamp}, but {name} has {topic} at {stamp}")
        require(values.keys() == other_values.keys(),
                f"fields of {topic} differ from {name}: {values.keys() ^ other_values.keys()}")
        for path, value in values.items():
            require(same(value, other_values[path]),
                    f"{topic} at {stamp}: {path} is {other_values[path]}, but {name} has {value}")


def same(a, b):
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(same, a, b))
    return a == b or (isinstance(a, float) and math.isnan(a) and math.isnan(b))


def require(condition, message):
    if not condition:
        raise ValueError(message)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main([Path(argument) for argument in sys.argv[1:]]))
