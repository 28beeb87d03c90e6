"""Debian's chromium without a window: where it is, and with what flags a page draws and asks nothing of a network."""

from __future__ import annotations

import shutil

PROGRAM = shutil.which("chromium") or shutil.which("chromium-browser")

FLAGS = (
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-features=NetworkTimeServiceQuerying,OptimizationHints,MediaRouter",
    "--hide-scrollbars",
    "--use-angle=swiftshader",  # draws without a graphics card
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
)

ALONE = ("--headless", *FLAGS, "--virtual-time-budget=30000")
"""For a browser that opens one page, waits until nothing moves on it, and ends."""
