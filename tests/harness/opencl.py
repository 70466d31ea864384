# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenCL in tests: whether there is a device, and a device that fails."""
import json
import os
import subprocess

from . import run

POCL = "/etc/OpenCL/vendors/pocl.icd"


def build_faulty_opencl(library):
    """Compiles faulty_opencl.c to a library to preload."""
    source = os.path.join(os.path.dirname(os.path.abspath(__file__)), "faulty_opencl.c")
    subprocess.run([os.environ.get("CC", "cc"), "-O1", "-fPIC", "-shared", "-o", library, source, "-ldl"], check=True)


def no_device():
    """Why the engine opencl cannot be tested; empty where there is a device."""
    result = run("landfall-info", "--devices", "--json")
    if result.returncode != 0:
        return result.stderr.strip()
    usable = [device for device in json.loads(result.stdout)["devices"] if device["is_usable"]]
    return "" if usable else "no OpenCL device can be used"
