"""Ten bodies of a live run without tritrack: Zenoh and MessagePack. Argument: its endpoint."""

import json
import sys

import msgpack
import zenoh

config = zenoh.Config()
config.insert_json5("mode", '"client"')
config.insert_json5("connect/endpoints", json.dumps(sys.argv[1:2]))
with zenoh.open(config) as session:
    ears = session.declare_subscriber("tritrack/room/body/pose")
    for seen, sample in enumerate(ears, 1):
        body = msgpack.unpackb(sample.payload.to_bytes())
        print(body["frame"], body["status"], body["joints_m"][:1])
        if seen == 10:
            break
