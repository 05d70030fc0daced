"""Prints the messages that the Python package `mcap` gives of a log that may be damaged, as JSON.

    read_messages.py FILE

Two lists, by its index and as a stream, of [log time, topic, CRC-32 of the data]; each as far as the reader goes.
"""

import json
import sys
import zlib

from mcap.reader import NonSeekingReader, SeekingReader


def messages(reader, path):
    found = []
    try:
        with open(path, "rb") as file:
            for _, channel, message in reader(file, validate_crcs=False).iter_messages(log_time_order=False):
                found.append([message.log_time, channel.topic, zlib.crc32(message.data)])
    except Exception:  # whatever it throws, it is where this reader ends
        pass
    return found


json.dump([messages(reader, sys.argv[1]) for reader in (SeekingReader, NonSeekingReader)], sys.stdout)
