"""A driver behind a socket, for `sgcad drive CASE --driver '{name: external, port: 7700}'`. Python only.

It keeps the report's driver's speed and brakes fully once somebody ahead would be reached within 1.5 s.
"""

import json
import math
import socketserver
import sys


def answer(task, view):
    ego, wanted = view["ego"], min(task["way"], key=lambda row: abs(row[0] - view["station_m"] - 0.05))[4]
    for other in view["others"]:
        dx, dy = other["x_m"] - ego["x_m"], other["y_m"] - ego["y_m"]
        c, s = math.cos(ego["heading_rad"]), math.sin(ego["heading_rad"])
        gap, aside = dx * c + dy * s - (ego["length_m"] + other["length_m"]) / 2, abs(dy * c - dx * s)
        closing = ego["speed_mps"] - other["speed_mps"] * math.cos(other["course_rad"] - ego["heading_rad"])
        if 0 < gap < 1.5 * closing and aside < ego["width_m"] / 2 + other["length_m"] / 2:
            return {"acceleration_mps2": -8.0}
    return {"acceleration_mps2": (wanted - ego["speed_mps"]) / task["step_s"]}


class Driver(socketserver.StreamRequestHandler):
    def handle(self):
        task = None
        for line in self.rfile:
            message = json.loads(line)
            if "leave" in message:
                return
            task = message.get("task", task)
            reply = answer(task, message["view"]) if "view" in message else {}
            self.wfile.write(json.dumps(reply).encode() + b"\n")


if __name__ == "__main__":
    with socketserver.ThreadingTCPServer(("127.0.0.1", int(sys.argv[1])), Driver) as server:
        print(server.server_address[1], flush=True)  # noqa: T201 - whoever gave port 0 wants to know which it is
        server.serve_forever()
