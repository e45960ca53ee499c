"""Visitors of one shared page, all dragging at once: ``python bench/live_class.py [--visitors 30] [--nodes 100]``.

Each visitor has a websocket at a server of its own process, and sends the next load when the last one is answered, but
not more often than a mouse moves. The time is that between a load and its picture. Memory is that of the server.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import math
import subprocess
import sys
import time

import aiohttp
import numpy as np
import psutil

FORCE = 2.42e6
"""Force of the drag, N/m: that of the built-in case."""

LEAST = 1.0 / 60.0
"""Seconds between two loads of a visitor at least."""


async def visit(
    client: aiohttp.ClientSession, address: str, seconds: float, share: float, begins: asyncio.Barrier
) -> list[float]:
    """Open the page, and drag for some seconds in a `share` of the time. Return the seconds from load to picture."""
    times: list[float] = []
    origin = "/".join(address.split("/")[:3])
    async with client.ws_connect(f"{address}socket", headers={"Origin": origin}, max_msg_size=0) as page:
        await page.send_str(json.dumps({"kind": "hello", "id": 0, "session": ""}))
        await answer(page, 0)
        await begins.wait()
        phase = np.random.default_rng().uniform(0.0, 10.0)
        start = time.monotonic()
        number = 0
        while time.monotonic() < start + seconds:
            if (time.monotonic() + phase) % 10.0 > 10.0 * share:
                await asyncio.sleep(0.05)
                continue
            number += 1
            turn = 0.05 * number
            loads = {"P": FORCE * math.cos(0.9 * math.sin(0.3 * turn)), "Q": 0.5 * FORCE * math.sin(turn)}
            began = time.monotonic()
            message = {"kind": "load", "id": number, "loads": loads, "gesture": number // 300, "drag": True}
            await page.send_str(json.dumps(message))
            await answer(page, number)
            times.append(time.monotonic() - began)
            await asyncio.sleep(max(LEAST - times[-1], 0.0))
    return times


async def answer(page: aiohttp.ClientWebSocketResponse, number: int) -> None:
    """Wait for the pictures that answer a message."""
    while True:
        found = json.loads((await page.receive()).data)
        if found["id"] == number and found["kind"] != "welcome":
            assert found["kind"] == "pictures", found
            return


async def measure(address: str, visitors: int, seconds: float, share: float) -> tuple[list[list[float]], float]:
    """Return the times of each visitor, and the seconds until all had their first picture."""
    began, begins = time.monotonic(), asyncio.Barrier(visitors + 1)
    async with aiohttp.ClientSession(connector=aiohttp.TCPConnector(limit=0)) as client:
        tasks = [asyncio.create_task(visit(client, address, seconds, share, begins)) for _ in range(visitors)]
        await begins.wait()
        opened = time.monotonic() - began
        return await asyncio.gather(*tasks), opened


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--visitors", type=int, default=30, help="visitors (default 30)")
    parser.add_argument("--nodes", type=int, default=100, help="nodes round the hole (default 100)")
    parser.add_argument("--seconds", type=float, default=20.0, help="seconds of dragging (default 20)")
    parser.add_argument(
        "--share", type=float, default=1.0, help="part of the time in which a visitor drags (default 1)"
    )
    options = parser.parse_args()
    command = [
        sys.executable,
        "-m",
        "fastpin",
        "live",
        "--host",
        "127.0.0.1",
        "--no-browser",
        "--nodes",
        str(options.nodes),
    ]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        address = server.stdout.readline().split()[-1]
        busy = psutil.cpu_percent(0.5)
        times, opened = asyncio.run(measure(address, options.visitors, options.seconds, options.share))
        memory = 1e-6 * psutil.Process(server.pid).memory_info().rss
        server.terminate()
    rates = [len(each) / options.seconds for each in times]
    every = 1e3 * np.concatenate(times)
    print(
        f"{options.visitors} visitors, {options.nodes} nodes, dragging in {100 * options.share:.0f} % of the time: "
        f"all open after {opened:.1f} s; {min(rates):.1f} to {max(rates):.1f} updates a second each; "
        f"median {np.median(every):.0f} ms, 95 % {np.quantile(every, 0.95):.0f} ms, longest {every.max():.0f} ms; "
        f"server {memory:.0f} MB; others took {busy:.0f} % before"
    )


if __name__ == "__main__":
    main()
