"""Prints the CPU seconds rosbags takes for one controller_state message of an MCAP log.

usage: rosbags_read.py LOG MESSAGES
"""

import itertools
import sys
import time
from pathlib import Path

from rosbags.highlevel import AnyReader

WARM_UP = 200


def main() -> None:
    path, count = Path(sys.argv[1]), int(sys.argv[2])
    rows = []
    with AnyReader([path]) as reader:
        messages = itertools.islice(reader.messages(), count)
        for index, (connection, log_ns, raw) in enumerate(messages):
            if index == WARM_UP:
                start_s = time.process_time()
            message = reader.deserialize(raw, connection.msgtype)
            stamp = message.header.stamp
            rows.append(
                (
                    log_ns,
                    stamp.sec * 1_000_000_000 + stamp.nanosec,
                    message.reference.positions,
                    message.reference.velocities,
                    message.feedback.positions,
                    message.speed_scaling_factor,
                )
            )
        seconds = time.process_time() - start_s
    print(seconds / (len(rows) - WARM_UP))


if __name__ == "__main__":
    main()
